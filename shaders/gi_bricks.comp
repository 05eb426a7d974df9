#version 460
// gi_bricks.comp: which cells of the base volume have a brick of texels (gi.glsl): those that hold an
// occupied voxel, or have one next to them towards +x +y +z. Bricks are counted in the order of the
// cells, so that the same voxels give the same image.
// Steps: 0, one invocation a slot: a bit for each cell that is needed, in the accumulators, which
// are zero between uses. 1, one group: bricks for the bits, which are zero again. Cells that find no
// room get the empty brick, and the counter tells how many would do.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 128) in;
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; }; // how.y: bricks that there are

layout(set = 0, binding = BUILD_BRICKS_STORAGE, rgba8) uniform writeonly image3D bricks;

shared uint sums[128];

uvec3 cells_along() {
    uvec4 dims = gi_flow.dims;
    return uvec3(dims.xy, dims.z * dims.w) / GI_BRICK_CELL;
}

void mark(uint slot, uvec3 cells) {
    ivec3 place = ivec3(gi_unpack_place(gi_voxels[slot]));
    uint edges = gi_brick_edges(place), subset = edges, more = 1u;
    for (; more != 0u; subset = (subset - 1u) & edges) {
        uvec3 cell = uvec3(place / GI_BRICK_CELL) - uvec3(subset & 1u, subset >> 1 & 1u, subset >> 2);
        uint bit = cell.x + cells.x * (cell.y + cells.y * cell.z);
        atomicOr(gi_accumulators[bit >> 5], 1u << (bit & 31u));
        more = subset;
    }
}

void main() {
    uvec3 cells = cells_along();
    uint lane = gl_LocalInvocationIndex;
    if (GI_STEP == 0u) {
        // Dispatched by groups of 64 slots: half of the invocations have none.
        uint slot = gl_WorkGroupID.x * 64u + lane;
        uint count = min(gi_counters[GI_COUNTER_STATIC] + gi_counters[GI_COUNTER_DYNAMIC],
                         gi_flow.counts.z);
        if (lane >= 64u || slot >= count) return;
        mark(slot, cells);
        return;
    }
    uint words = (cells.x * cells.y * cells.z + 31u) >> 5, stretch = (words + 127u) / 128u;
    uint first = min(lane * stretch, words), last = min(first + stretch, words), sum = 0u;
    for (uint i = first; i < last; i++) sum += uint(bitCount(gi_accumulators[i]));
    sums[lane] = sum;
    barrier();
    uint rank = 1u; // 0 is the empty one
    for (uint i = 0u; i < lane; i++) rank += sums[i];
    if (lane == 127u) gi_counters[GI_COUNTER_BRICKS] = rank + sum;
    uint room = draw.how.y;
    uint count = cells.x * cells.y * cells.z;
    for (uint i = first << 5; i < min(last << 5, count); i++) {
        bool is_needed = (gi_accumulators[i >> 5] >> (i & 31u) & 1u) != 0u;
        uint brick = is_needed && rank < room ? rank : 0u;
        uint row = i / cells.x, slice = row / cells.y;
        uvec3 place = uvec3(brick % GI_BRICK_ROW, brick / GI_BRICK_ROW % GI_BRICK_ROW,
                            brick / GI_BRICK_LAYER);
        imageStore(bricks, ivec3(i - row * cells.x, row - slice * cells.y, slice),
                   vec4(place, 0.0) * (1.0 / 255.0));
        rank += is_needed ? 1u : 0u;
    }
    for (uint i = first; i < last; i++) gi_accumulators[i] = 0u;
}
