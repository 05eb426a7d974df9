// tiled.glsl: the G-buffer is read once, then the lights of the pixel's tile. For tiled.comp and,
// with TILED_GI, gi_tiled.comp: what that needs more is there in gi_block.glsl.
//
// A tile's list holds lights in front of and behind the surface (also after its depths narrowed it:
// a tile is up to 64 pixels wide). A subgroup therefore culls it again for the pixels it is about to
// shade: their positions span a box; every lane tests one light against the box; survivors are
// compacted, in order, into shared memory. The sum has the same terms in the same order as without
// culling, so the bits are the same.
// Normals would not help: hardly a light is behind all 64 pixels, with normal maps (cloister: 2 %).
//
// A group is 8x8 pixels; an invocation shades PIXELS_PER_LANE of them side by side, so that one cull,
// and one fetch of a light, serves 64 pixels where subgroups are small (software driver: 8 lanes).
// Every tile is at least 8 pixels wide: a group has one list.
// If a list of survivors overflows SURVIVORS_CAP, the whole tile's list is shaded: no light is lost.
// Loops end with their test where they can (why: list_shade.glsl).
#ifndef TILED_GLSL
#define TILED_GLSL
#define PALETTE_BY_LANES
#include "gbuffer.glsl"
#include "cells.glsl"

layout(constant_id = SPEC_PIXELS_PER_LANE) const uint PIXELS_PER_LANE = 1;
layout(local_size_x_id = SPEC_TILED_GROUP) in; // 64 / PIXELS_PER_LANE

layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) writeonly uniform image2D hdr;

// A list for each subgroup; they have 4 lanes at least.
shared uint survivors[(64 / PIXELS_PER_LANE) / 4 * SURVIVORS_CAP];

// The pixel that this lane shades as its i-th.
ivec2 pixel_of(uint i) {
    uint q = (gl_SubgroupID * PIXELS_PER_LANE + i) * gl_SubgroupSize + gl_SubgroupInvocationID;
    return ivec2(gl_WorkGroupID.xy * 8u) + ivec2(q & 7u, q >> 3u);
}

// Appends list entries [first, last) that touch the box. Returns the new count, which may pass the
// cap: then nothing more was stored.
uint cull(uint first, uint last, vec3 box_min, vec3 box_max, uint list_base, uint count) {
    if (first >= last) return count;
    for (uint b = first;;) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = cell_index(min(k, last - 1u));
        vec4 position = light_position(index);
        vec3 outside =
            max(box_min - position.xyz, vec3(0.0)) + max(position.xyz - box_max, vec3(0.0));
        bool hit = k < last && dot(outside, outside) * position.w < 1.0;
        uvec4 ballot = wave_ballot(hit);
        uint slot = count + subgroupBallotExclusiveBitCount(ballot);
        if (hit && slot < SURVIVORS_CAP) survivors[list_base + slot] = index;
        count += subgroupBallotBitCount(ballot);
        b += gl_SubgroupSize;
        if (b >= last) break;
    }
    return count;
}

// Entries of the survivors, or of the tile's own list; a constant says which.
uint list_entry(bool from_tile, uint at) { return from_tile ? cell_index(at) : survivors[at]; }
const uint SURFACES = PIXELS_PER_LANE;
#include "list_shade.glsl"

#ifdef TILED_GI
#include "gi_block.glsl"
#endif

void main() {
    palette_keep();
    ivec2 size = ivec2(frame.viewport.xy);
    uvec2 tile = gl_WorkGroupID.xy >> (TILE_SHIFT - 3u);
    uvec4 list = cell_list(tile.y * flow.grid.x + tile.x), list_ends = cell_classes(list);

    GbufferPixel g[PIXELS_PER_LANE];
    Surfaces s;
    vec3 lane_min = vec3(1e30), lane_max = vec3(-1e30);
    [[unroll]] for (uint i = 0u; i < PIXELS_PER_LANE; i++) {
        g[i] = gbuffer_read(min(pixel_of(i), size - 1));
        s.at[i] = gbuffer_surface(g[i]);
        lane_min = min(lane_min, g[i].depth > 0.0 ? g[i].position : vec3(1e30));
        lane_max = max(lane_max, g[i].depth > 0.0 ? g[i].position : vec3(-1e30));
    }
    vec3 box_min = wave_min(lane_min), box_max = wave_max(lane_max);

    // Empty loops where only sky is seen, or where nothing is to be culled: a branch would not save
    // the work on the software driver.
    uint list_base = gl_SubgroupID * SURVIVORS_CAP;
    bool any_lit = box_min.x <= box_max.x;
    uvec4 counts = uvec4(0u); // survivors up to the end of each class
    if (SUBGROUP_CULL != 0u) {
        uvec4 ends = any_lit ? list_ends : uvec4(0u);
        bool split = (LIST_KINDS & LIST_KIND_DIFFUSE) != 0u; // else the first of two is not needed
        if (split) counts.x = cull(list.x, ends.x, box_min, box_max, list_base, 0u);
        counts.y = cull(split ? list_ends.x : list.x, ends.y, box_min, box_max, list_base, counts.x);
        counts.zw = counts.yy;
        if (SPOTS != 0u) {
            if (split) counts.z = cull(list_ends.y, ends.z, box_min, box_max, list_base, counts.y);
            counts.w = cull(split ? list_ends.z : list_ends.y, ends.w, box_min, box_max, list_base,
                            counts.z);
        }
        subgroupMemoryBarrierShared();
        subgroupBarrier();
    }
    // One of the two lists is empty. To choose inside the loops would read both.
    bool may_overflow = (LIST_KINDS & LIST_KIND_LONG) != 0u;
    bool from_tile = SUBGROUP_CULL == 0u || may_overflow && counts.w > SURVIVORS_CAP;
    uvec4 ends = from_tile || !any_lit ? uvec4(list_base) : list_base + counts;
    uvec4 tile_ends = from_tile && any_lit ? list_ends : uvec4(list.x);

    Sums sum;
    if (SUBGROUP_CULL != 0u) {
        sum = shade_list(s, false, list_base, ends);
        if (may_overflow) sum = sums_add(sum, shade_list_merged(s, true, list.x, tile_ends));
    } else {
        sum = shade_list(s, true, list.x, tile_ends);
    }
#ifdef TILED_GI
    BlockTaps block = block_taps();
    uint alone = 0u;
#endif
    [[unroll]] for (uint i = 0u; i < PIXELS_PER_LANE; i++) {
        ivec2 pixel = pixel_of(i);
        vec3 radiance = gbuffer_radiance(g[i], s.at[i], sum.at[i]);
        bool inside = pixel.x < size.x && pixel.y < size.y;
#ifdef TILED_GI
        bool is_alone;
        radiance = block_compose(block, i, pixel, g[i], s.at[i], radiance, is_alone);
        alone |= is_alone && inside ? 1u << i : 0u;
#endif
        if (inside)
            imageStore(hdr, pixel, vec4(g[i].depth > 0.0 ? radiance : vec3(0.0), 1.0));
    }
#ifdef TILED_GI
    block_list_alone(alone);
#endif
}
#endif
