#version 460
// gi_rank.comp: how many voxels are set before every GI_RANK_WORDS words of a layer of the masks: with
// it a voxel's bit says its slot (gi_rank), the same on every run. A scan in three steps:
// 0: set bits of each block of words. 1, one group: what lies before each block, and the counters.
// 2: what lies before each rank's words.
// 3: all of it and the places of the slots' voxels (gi_list.comp) at once, for small layers: a lane
// takes the words of a few ranks, and each group counts all words before its own, as many times as there
// are groups, which is less than four dispatches that wait for each other.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 128) in;
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; };
// The masks, as many words at a time as share a rank.
layout(std430, set = 0, binding = BUILD_MASKS) readonly buffer GiQuadBuffer { uvec4 gi_quads[]; };

const uint WORDS = GI_RANK_BLOCK / 128u; // of an invocation
const uint RANKS_OF_LANE = 4u; // gi_voxelise.c
shared uint sums[128];
shared uint sums_before[128];

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

uint bits_of(uvec4 quad) {
    ivec4 bits = bitCount(quad);
    return uint(bits.x + bits.y + bits.z + bits.w);
}

void list(uint mask, uint at, uint slot) {
    uint cap = gi_flow.counts.z;
    uvec4 dims = gi_flow.dims;
    uint shift_x = uint(findMSB(dims.x)), shift_y = uint(findMSB(dims.y));
    for (; mask != 0u && slot < cap; slot++) {
        uint bit = at << 5 | uint(findLSB(mask));
        mask &= mask - 1u;
        gi_voxels[slot] = gi_pack_place(uvec3(bit & (dims.x - 1u), bit >> shift_x & (dims.y - 1u),
                                              bit >> (shift_x + shift_y)));
    }
}

void rank_and_list(uint layer) {
    uvec4 dims = gi_flow.dims;
    uint words = (dims.x * dims.y * dims.z * dims.w) >> 5, quads = words / GI_RANK_WORDS;
    uint base = layer * quads, first_of_group = gl_WorkGroupID.x * 128u * RANKS_OF_LANE, count = 0u;
    for (uint i = gl_LocalInvocationIndex; i < first_of_group; i += 128u)
        count += bits_of(gi_quads[base + i]);
    uint first = min(first_of_group + gl_LocalInvocationIndex * RANKS_OF_LANE, quads);
    uint last = min(first + RANKS_OF_LANE, quads), own_count = 0u;
    for (uint i = first; i < last; i++) own_count += bits_of(gi_quads[base + i]);
    uint within = subgroupExclusiveAdd(own_count);
    sums[gl_SubgroupID] = subgroupAdd(own_count); // the same of all lanes
    sums_before[gl_SubgroupID] = subgroupAdd(count);
    barrier();
    uint start = layer == 0u ? 0u : gi_counters[GI_COUNTER_STATIC], end = start;
    uint before = start + within;
    for (uint i = 0u; i < gl_NumSubgroups; i++) {
        before += sums_before[i] + (i < gl_SubgroupID ? sums[i] : 0u);
        end += sums_before[i] + sums[i];
    }
    if (first < last && last == quads) count_slots(layer, end - start);
    for (uint i = first; i < last; i++) {
        gi_ranks[base + i] = before;
        uvec4 own = gi_quads[base + i];
        uint at = i * GI_RANK_WORDS;
        list(own.x, at, before);
        before += uint(bitCount(own.x));
        list(own.y, at + 1u, before);
        before += uint(bitCount(own.y));
        list(own.z, at + 2u, before);
        before += uint(bitCount(own.z));
        list(own.w, at + 3u, before);
        before += uint(bitCount(own.w));
    }
}

void main() {
    if (GI_STEP == 3u) {
        rank_and_list(draw.how.x & GI_DRAW_DYNAMIC);
        return;
    }
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
