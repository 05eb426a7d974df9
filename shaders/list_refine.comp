#version 460
// list_refine.comp: the packet's tile lists without the lights that no depth seen in the tile
// meets. One subgroup a tile; the order within a list stays. A list keeps its place, so that no
// sum over tiles is needed: behind the list of all lights. Tiles that share the packet's list of
// all lights (which has one place for many tiles) use that one as it is.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "list_make.glsl"
layout(local_size_x = 64) in;

// Entries [first, last) of the packet's indices that stay, stored from `at`; returns the end.
uint refine(Volume v, uint first, uint last, uint at, bool spot) {
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint k = b + gl_SubgroupInvocationID;
        uint index = light_indices[min(k, last - 1u)];
        bool hit = k < last && light_in_depths(v, view_light(index, spot), spot);
        uvec4 ballot = subgroupBallot(hit);
        if (hit) list_indices[at + subgroupBallotExclusiveBitCount(ballot)] = index;
        at += subgroupBallotBitCount(ballot);
    }
    return at;
}

void main() {
    write_list_of_all();
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        uvec4 list = cells[tile].list, ends = cell_classes(list);
        bool shares = list.x == 0u && list.yz == flow.counts.xy;
        Volume v = tile_volume_seen(tile);
        uint start = light_total() + list.x;
        if (shares) ends = uvec4(0u); // no loop: a branch would not save the work
        uint points = refine(v, list.x, ends.x, start, false);
        uint diffuse_points = refine(v, ends.x, ends.y, points, false);
        uint spots = diffuse_points, diffuse_spots = diffuse_points;
        if (SPOTS != 0u) {
            spots = refine(v, ends.y, ends.z, diffuse_points, true);
            diffuse_spots = refine(v, ends.z, ends.w, spots, true);
        }
        uvec4 refined = uvec4(start, diffuse_points - start, diffuse_spots - diffuse_points,
                              code_diffuse(diffuse_points - points, diffuse_spots - spots));
        if (shares) refined = list_of_all();
        if (gl_SubgroupInvocationID == 0u) {
            list_cells[tile].list = refined;
            uint count = refined.y + refined.z;
            atomicAdd(grid_counters[GRID_COUNTER_INDICES], shares ? 0u : count);
            atomicAdd(grid_counters[GRID_COUNTER_FALLBACKS], shares ? 1u : 0u);
            atomicMax(grid_counters[GRID_COUNTER_LONGEST], count);
        }
    }
}
