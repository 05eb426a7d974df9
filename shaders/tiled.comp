#version 460
// tiled.comp: path `tiled_deferred`: the G-buffer is read once, then the lights of the pixel's tile.
//
// A tile's list is made on the CPU from screen rectangles, so it holds lights in front of and
// behind the surface. A subgroup therefore culls it again for the pixels it is about to shade:
// their positions span a box; every lane tests one light against the box; survivors are compacted,
// in order, into shared memory. The sum has the same terms in the same order as without culling, so
// the bits are the same.
//
// A group is 8x8 pixels; an invocation shades PIXELS_PER_LANE of them in turn, so that one cull
// serves 64 pixels where subgroups are small (software driver: 8 lanes). In the light loop a
// survivor's index is made uniform by a shuffle: a uniform block read at a uniform address is a
// scalar load there, a quarter of the price of shuffling the light's eight floats.
// If a list of survivors overflows SURVIVORS_CAP, the whole tile's list is shaded: no light is lost.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "gbuffer.glsl"

layout(constant_id = SPEC_PIXELS_PER_LANE) const uint PIXELS_PER_LANE = 1;
layout(local_size_x_id = SPEC_TILED_GROUP) in; // 64 / PIXELS_PER_LANE

layout(std430, set = 0, binding = BINDING_CELLS) readonly buffer CellBuffer { CellRecord cells[]; };
layout(std430, set = 0, binding = BINDING_LIGHT_INDICES) readonly buffer IndexBuffer {
    uint light_indices[];
};
layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) writeonly uniform image2D hdr;

// A list for each subgroup; they have 4 lanes at least.
shared uint survivors[(64 / PIXELS_PER_LANE) / 4 * SURVIVORS_CAP];

// The pixel that this lane shades in a round.
ivec2 pixel_of(uint round) {
    uint q = (gl_SubgroupID * PIXELS_PER_LANE + round) * gl_SubgroupSize + gl_SubgroupInvocationID;
    return ivec2(gl_WorkGroupID.xy * 8u) + ivec2(q & 7u, q >> 3u);
}

// Appends list entries [first, last) that touch the box. Returns the new count, which may pass the
// cap: then nothing more was stored.
uint cull(uint first, uint last, vec3 box_min, vec3 box_max, uint list_base, uint count) {
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = light_indices[min(k, last - 1u)];
        vec4 position = light_position(index);
        vec3 outside =
            max(box_min - position.xyz, vec3(0.0)) + max(position.xyz - box_max, vec3(0.0));
        bool hit = k < last && dot(outside, outside) * position.w < 1.0;
        uvec4 ballot = subgroupBallot(hit);
        uint slot = count + subgroupBallotExclusiveBitCount(ballot);
        if (hit && slot < SURVIVORS_CAP) survivors[list_base + slot] = index;
        count += subgroupBallotBitCount(ballot);
    }
    return count;
}

// Entries [first, last) of the survivors, or of the tile's own list.
uint list_entry(bool from_tile, uint at) { return from_tile ? light_indices[at] : survivors[at]; }

vec3 shade_points(Surface s, bool from_tile, uint first, uint last) {
    vec3 sum = vec3(0.0);
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint mine = list_entry(from_tile, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        if (LIGHT_BLOCKS != 0u) {
            for (uint j = 0u; j < end; j++) {
                uint index = subgroupShuffle(mine, j);
                sum += light_point(s, light_position(index), light_color(index));
            }
        } else {
            vec4 position = light_position(mine), color = light_color(mine);
            for (uint j = 0u; j < end; j++)
                sum += light_point(s, subgroupShuffle(position, j), subgroupShuffle(color, j));
        }
    }
    return sum;
}

vec3 shade_spots(Surface s, bool from_tile, uint first, uint last, uint point_count) {
    vec3 sum = vec3(0.0);
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint mine = list_entry(from_tile, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        for (uint j = 0u; j < end; j++) {
            uint index = subgroupShuffle(mine, j);
            sum += light_spot(s, light_position(index), light_color(index),
                              spot_direction(index - point_count), spot_edge(index - point_count));
        }
    }
    return sum;
}

void main() {
    ivec2 size = ivec2(frame.viewport.xy);
    uvec2 tile = gl_WorkGroupID.xy >> (TILE_SHIFT - 3u);
    uvec4 list = cells[tile.y * flow.grid.x + tile.x].list;
    uint point_count = flow.counts.x;

    vec3 lane_min = vec3(1e30), lane_max = vec3(-1e30);
    for (uint round = 0u; round < PIXELS_PER_LANE; round++) {
        ivec2 pixel = min(pixel_of(round), size - 1);
        float depth = texelFetch(gbuffer_depth, pixel, 0).x;
        vec3 position = position_from_depth(vec2(pixel) + 0.5, depth);
        lane_min = min(lane_min, depth > 0.0 ? position : vec3(1e30));
        lane_max = max(lane_max, depth > 0.0 ? position : vec3(-1e30));
    }
    vec3 box_min = subgroupMin(lane_min), box_max = subgroupMax(lane_max);

    // Empty loops where only sky is seen, or where nothing is to be culled: a branch would not save
    // the work on the software driver.
    uint list_base = gl_SubgroupID * SURVIVORS_CAP;
    bool any_lit = box_min.x <= box_max.x, cull_list = any_lit && SUBGROUP_CULL != 0u;
    uint points = 0u, all = 0u;
    if (SUBGROUP_CULL != 0u) {
        points = cull(list.x, cull_list ? list.x + list.y : list.x, box_min, box_max, list_base, 0u);
        all = points;
        if (SPOTS != 0u)
            all = cull(list.x + list.y, cull_list ? list.x + list.y + list.z : 0u, box_min, box_max,
                       list_base, points);
        subgroupMemoryBarrierShared();
        subgroupBarrier();
    }
    bool from_tile = SUBGROUP_CULL == 0u || all > SURVIVORS_CAP;
    uint first = from_tile ? list.x : list_base;
    uint middle = first + (from_tile ? list.y : points);
    uint last = middle + (from_tile ? list.z : all - points);

    for (uint round = 0u; round < PIXELS_PER_LANE; round++) {
        ivec2 pixel = pixel_of(round);
        ivec2 clamped = min(pixel, size - 1);
        GbufferPixel g = gbuffer_read(clamped);
        Surface s = gbuffer_surface(g);
        vec3 sum = shade_points(s, from_tile, any_lit ? first : middle, middle);
        if (SPOTS != 0u) sum += shade_spots(s, from_tile, any_lit ? middle : last, last, point_count);
        vec3 radiance = gbuffer_radiance(g, s, sum);
        if (pixel.x < size.x && pixel.y < size.y)
            imageStore(hdr, pixel, vec4(g.depth > 0.0 ? radiance : vec3(0.0), 1.0));
    }
}
