#version 460
// gi_rank.comp: how many voxels are set before every GI_RANK_WORDS words of a layer of the masks: with
// it a voxel's bit says its slot (gi_rank), the same on every run. A scan in three steps:
// 0: set bits of each block of words. 1, one group: what lies before each block, and the counters.
// 2: what lies before each rank's words.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 128) in;
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; };

const uint WORDS = GI_RANK_BLOCK / 128u; // of an invocation
shared uint sums[128];

// sums[] becomes what lies before each invocation's own, from `before` on; returns the end.
uint scan(uint before) {
    for (uint i = 0u; i < 128u; i++) {
        uint own = sums[i];
        sums[i] = before;
        before += own;
    }
    return before;
}

void count_slots(uint layer, uint count) {
    uint before = layer == 0u ? 0u : gi_counters[GI_COUNTER_STATIC];
    uint cap = gi_flow.counts.z, all = before + count;
    uint kept = min(all, cap), kept_dynamic = layer == 0u ? 0u : kept - min(before, cap);
    if (layer == 0u) gi_counters[GI_COUNTER_STATIC] = count;
    gi_counters[GI_COUNTER_DYNAMIC] = layer == 0u ? 0u : count;
    gi_counters[GI_COUNTER_LOST] = all - kept;
    gi_counters[GI_COUNTER_ALL_ARGS] = (kept + 63u) / 64u;
    gi_counters[GI_COUNTER_ALL_ARGS + 1u] = 1u;
    gi_counters[GI_COUNTER_ALL_ARGS + 2u] = 1u;
    gi_counters[GI_COUNTER_DYNAMIC_ARGS] = (kept_dynamic + 63u) / 64u;
    gi_counters[GI_COUNTER_DYNAMIC_ARGS + 1u] = 1u;
    gi_counters[GI_COUNTER_DYNAMIC_ARGS + 2u] = 1u;
}

void main() {
    uint lane = gl_LocalInvocationIndex, layer = draw.how.x & GI_DRAW_DYNAMIC;
    uvec4 dims = gi_flow.dims;
    uint words = (dims.x * dims.y * dims.z * dims.w) >> 5, blocks = (words - 1u) / GI_RANK_BLOCK + 1u;
    uint first, last; // own words, or blocks
    if (GI_STEP == 1u) {
        uint stretch = (blocks + 127u) / 128u;
        first = min(lane * stretch, blocks);
        last = min(first + stretch, blocks);
    } else {
        first = min(gl_WorkGroupID.x * GI_RANK_BLOCK + lane * WORDS, words);
        last = min(first + WORDS, words);
    }
    uint base = layer * words, sum = 0u;
    for (uint i = first; i < last; i++)
        sum += GI_STEP == 1u ? gi_counters[GI_COUNTER_BLOCKS + i]
                             : uint(bitCount(gi_masks[base + i]));
    sums[lane] = sum;
    barrier();
    if (lane == 0u) {
        uint before = 0u;
        if (GI_STEP == 1u) before = layer == 0u ? 0u : gi_counters[GI_COUNTER_STATIC];
        if (GI_STEP == 2u) before = gi_counters[GI_COUNTER_BLOCKS + gl_WorkGroupID.x];
        uint end = scan(before);
        if (GI_STEP == 0u) gi_counters[GI_COUNTER_BLOCKS + gl_WorkGroupID.x] = end;
        if (GI_STEP == 1u) count_slots(layer, end - before);
    }
    barrier();
    if (GI_STEP == 0u) return;
    uint at = sums[lane];
    for (uint i = first; i < last; i++) {
        if (GI_STEP == 1u) {
            uint own = gi_counters[GI_COUNTER_BLOCKS + i];
            gi_counters[GI_COUNTER_BLOCKS + i] = at;
            at += own;
        } else {
            if (i % GI_RANK_WORDS == 0u) gi_ranks[(base + i) / GI_RANK_WORDS] = at;
            at += uint(bitCount(gi_masks[base + i]));
        }
    }
}
