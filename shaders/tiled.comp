#version 460
// tiled.comp: path `tiled_deferred`: the G-buffer is read once, then the lights of the pixel's tile.
//
// A tile's list is made on the CPU from screen rectangles, so it holds lights in front of and
// behind the surface. Each subgroup therefore culls it again: its pixels span a box; every lane
// tests one light against the box; survivors are compacted, in order, into a list in shared
// memory; then every lane loads one survivor and all shade it in turn by shuffle. The sum has the
// same terms in the same order as without culling, so the bits are the same.
// Chunked by SUBGROUP_LIST_CAP: any number of lights works. 8x8 groups: 4x4 waste half the lanes
// of the software driver.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "gbuffer.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, set = 0, binding = BINDING_TILES) readonly buffer TileBuffer { TileRecord tiles[]; };
layout(std430, set = 0, binding = BINDING_LIGHT_INDICES) readonly buffer IndexBuffer {
    uint light_indices[];
};
layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) writeonly uniform image2D hdr;

// 64 invocations in subgroups of at least 4.
shared uint survivors[16 * SUBGROUP_LIST_CAP];

vec3 shade_points(Surface s, uint list_base, uint count) {
    vec3 sum = vec3(0.0);
    uint dummy = flow.counts2.z;
    for (uint b = 0u; b < count; b += gl_SubgroupSize) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = k < count ? survivors[list_base + min(k, count - 1u)] : dummy;
        vec4 position = light_position(index), color = light_color(index);
        uint end = min(gl_SubgroupSize, count - b);
        for (uint j = 0u; j < end; j++)
            sum += light_point(s, subgroupShuffle(position, j), subgroupShuffle(color, j).rgb);
    }
    return sum;
}

vec3 shade_spots(Surface s, uint list_base, uint count) {
    vec3 sum = vec3(0.0);
    uint dummy = flow.counts2.z, point_count = flow.counts.x;
    for (uint b = 0u; b < count; b += gl_SubgroupSize) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = k < count ? survivors[list_base + min(k, count - 1u)] : dummy;
        uint spot = k < count ? index - point_count : 0u;
        vec4 position = light_position(index), color = light_color(index);
        vec4 direction = spot_direction(spot);
        uint end = min(gl_SubgroupSize, count - b);
        for (uint j = 0u; j < end; j++)
            sum += light_spot(s, subgroupShuffle(position, j), subgroupShuffle(color, j),
                              subgroupShuffle(direction, j));
    }
    return sum;
}

// Compacts list entries [first, last) that touch the box into this subgroup's shared list, until
// the list might overflow. Returns the count; *next is where to go on.
uint cull(uint first, uint last, vec3 box_min, vec3 box_max, uint list_base, out uint next) {
    uint count = 0u, b = first;
    subgroupBarrier(); // nobody still reads the list of the chunk before
    for (; b < last && count + gl_SubgroupSize <= SUBGROUP_LIST_CAP; b += gl_SubgroupSize) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = light_indices[min(k, last - 1u)];
        vec4 position = light_position(index);
        vec3 outside = max(box_min - position.xyz, vec3(0.0)) + max(position.xyz - box_max, vec3(0.0));
        bool hit = k < last && (SUBGROUP_CULL == 0u || dot(outside, outside) * position.w < 1.0);
        uvec4 ballot = subgroupBallot(hit);
        if (hit) survivors[list_base + count + subgroupBallotExclusiveBitCount(ballot)] = index;
        count += subgroupBallotBitCount(ballot);
    }
    subgroupMemoryBarrierShared();
    subgroupBarrier();
    next = b;
    return count;
}

void main() {
    ivec2 size = ivec2(frame.viewport.xy);
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 clamped = min(pixel, size - 1);
    GbufferPixel g = gbuffer_read(clamped);
    vec3 position = position_from_depth(vec2(clamped) + 0.5, g.depth);
    Surface s = surface_make(position, g.normal, g.albedo, g.material);

    bool lit = g.depth > 0.0;
    vec3 box_min = subgroupMin(lit ? position : vec3(1e30));
    vec3 box_max = subgroupMax(lit ? position : vec3(-1e30));

    uvec2 tile = gl_WorkGroupID.xy / (TILE_SIZE_PX / 8);
    uvec4 list = tiles[tile.y * flow.counts.w + tile.x].list;
    uint list_base = gl_SubgroupID * SUBGROUP_LIST_CAP;
    // A subgroup that sees only sky has nothing to shade: an empty loop, not a branch.
    bool any_lit = subgroupAny(lit);

    vec3 sum = vec3(0.0);
    uint next = list.x, end = any_lit ? list.x + list.y : list.x;
    while (next < end) {
        uint count = cull(next, end, box_min, box_max, list_base, next);
        sum += shade_points(s, list_base, count);
    }
    if (SPOTS != 0u) {
        next = list.x + list.y;
        end = any_lit ? next + list.z : next;
        while (next < end) {
            uint count = cull(next, end, box_min, box_max, list_base, next);
            sum += shade_spots(s, list_base, count);
        }
    }
    vec3 radiance = light_base(s, g.albedo, g.material) + sum * materials[g.material].emissive.w;
    if (all(lessThan(pixel, size)))
        imageStore(hdr, pixel, vec4(lit ? radiance : vec3(0.0), 1.0));
}
