#version 460
// list_scan.comp: where each cell's list lies: the exclusive sum of the counts before it, behind
// the list of all lights. One group does it all: each invocation sums a stretch of cells.
// A list that would reach beyond the buffer becomes the list of all lights (no light is lost); the
// counters tell how much was asked for, so that the next frame's buffer is large enough. Sums
// saturate, so that lists beyond 2^32 entries are refused and not wrapped.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "list_make.glsl"
layout(local_size_x = 128) in;

shared uint sums[128];
shared uint longest, fallbacks;

uint add(uint a, uint b) { return a + min(b, ~a); }

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint total = CLUSTERED == 2u ? grid_counters[GRID_COUNTER_CLUSTERS] + CLUSTER_FIRST
                                 : tile_total();
    // Clusters that had no room are not there (cluster_scan.comp).
    if (CLUSTERED == 2u) total = min(total, min(list_cells.length(), clusters.length()));
    uint stretch = (total + 127u) / 128u, first = min(lane * stretch, total);
    uint last = min(first + stretch, total);
    if (CLUSTERED == 2u) first = min(max(first, CLUSTER_FIRST), last);
    uint sum = 0u;
    for (uint i = first; i < last; i++) {
        uvec4 list = list_cells[i].list;
        sum = add(sum, list.y + list.z);
    }
    sums[lane] = sum;
    if (lane == 0u) longest = 0u, fallbacks = 0u;
    barrier();
    if (lane == 0u) {
        uint before = light_total();
        for (uint i = 0u; i < 128u; i++) {
            uint own = sums[i];
            sums[i] = before;
            before = add(before, own);
        }
        grid_counters[GRID_COUNTER_INDICES] = before;
        // This pass is the first of those for tiles that writes them.
        if (CLUSTERED != 2u) grid_counters[GRID_COUNTER_CLUSTERS] = 0u;
    }
    barrier();
    uint at = sums[lane], capacity = list_indices.length(), own_longest = 0u, own_fallbacks = 0u;
    for (uint i = first; i < last; i++) {
        uvec4 list = list_cells[i].list;
        uint end = add(at, list.y + list.z);
        bool fits = list.y + list.z == 0u || end <= capacity;
        uvec4 placed = fits ? uvec4(at, list.yzw) : list_of_all();
        list_cells[i].list = placed;
        own_longest = max(own_longest, placed.y + placed.z);
        own_fallbacks += fits ? 0u : 1u;
        at = end;
    }
    atomicMax(longest, own_longest);
    atomicAdd(fallbacks, own_fallbacks);
    barrier();
    if (lane == 0u) {
        // Clusters without room were counted before.
        uint before = CLUSTERED == 2u ? grid_counters[GRID_COUNTER_FALLBACKS] : 0u;
        grid_counters[GRID_COUNTER_LONGEST] = before > 0u ? light_total() : longest;
        grid_counters[GRID_COUNTER_FALLBACKS] = before + fallbacks;
    }
}
