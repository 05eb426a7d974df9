#version 460
// cluster_scan.comp: where each tile's clusters begin in CLUSTERS: the exclusive sum of the tiles'
// counts. One group does it all. Clusters beyond the buffers' ends use the list of all lights, and
// the counters tell how many were asked for.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "list_make.glsl"
layout(local_size_x = 128) in;

shared uint sums[128];
shared uint fallbacks;

void main() {
    uint lane = gl_LocalInvocationID.x, total = tile_total();
    uint stretch = (total + 127u) / 128u, first = min(lane * stretch, total);
    uint last = min(first + stretch, total);
    uint sum = 0u;
    for (uint i = first; i < last; i++) sum += tile_depths[i].mask.z;
    sums[lane] = sum;
    if (lane == 0u) fallbacks = 0u;
    barrier();
    if (lane == 0u) {
        uint before = CLUSTER_FIRST;
        for (uint i = 0u; i < 128u; i++) {
            uint own = sums[i];
            sums[i] = before;
            before += own;
        }
        grid_counters[GRID_COUNTER_CLUSTERS] = before - CLUSTER_FIRST;
        list_cells[CLUSTER_EMPTY].list = uvec4(0u);
        list_cells[CLUSTER_ALL].list = list_of_all();
    }
    barrier();
    uint capacity = min(list_cells.length(), clusters.length());
    uint at = sums[lane], own_fallbacks = 0u;
    for (uint i = first; i < last; i++) {
        uint count = tile_depths[i].mask.z;
        bool fits = at + count <= capacity;
        tile_depths[i].mask.w = fits ? at : CLUSTER_ALL;
        own_fallbacks += fits ? 0u : count;
        // The lists of a place between the last that fits and the end are empty.
        for (uint place = at; place < min(fits ? at : at + count, capacity); place++)
            list_cells[place].list = uvec4(0u);
        at += count;
    }
    atomicAdd(fallbacks, own_fallbacks);
    barrier();
    if (lane == 0u) grid_counters[GRID_COUNTER_FALLBACKS] = fallbacks;
}
