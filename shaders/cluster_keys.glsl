// cluster_keys.glsl: which clusters of a tile are seen (specification of direct lighting, 6.3).
// Stage one of unique keys: the key of each pixel's cluster into PIXEL_CLUSTERS (background: all
// bits), and per tile how many different ones there are. One subgroup a tile; a tile's keys are
// few (slices x directions), so that a set of bits sorts and compacts them, in no order of lanes.
//
// Direction bits (CLUSTER_NORMALS): the axis along which the normal is longest, and its sign, in
// the world. They need a G-buffer: forward paths have none before they shade.
#include "list_make.glsl"
#ifdef MULTISAMPLED
#include "depth_read.glsl"
#else
#include "gbuffer.glsl"
float depth_read(ivec2 pixel, uint at) { return texelFetch(gbuffer_depth, pixel, 0).x; }
#endif
layout(local_size_x = 64) in;

const uint SEEN_WORDS = 1u << (CLUSTER_TILE_SHIFT - 5);
shared uint seen[SUBGROUPS_CAP * SEEN_WORDS];

uint normal_direction(vec3 n) {
    vec3 a = abs(n);
    bool is_x = a.x >= a.y && a.x >= a.z, is_y = !is_x && a.y >= a.z;
    float along = is_x ? n.x : is_y ? n.y : n.z;
    return (is_x ? 0u : is_y ? 2u : 4u) + (along < 0.0 ? 1u : 0u);
}

void main() {
    ivec2 size = ivec2(frame.viewport.xy);
    uint side = 1u << TILE_SHIFT, pixels = side * side, set = gl_SubgroupID * SEEN_WORDS;
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        for (uint w = gl_SubgroupInvocationID; w < SEEN_WORDS; w += gl_SubgroupSize)
            seen[set + w] = 0u;
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        ivec2 corner = ivec2(uvec2(tile % flow.grid.x, tile / flow.grid.x) << TILE_SHIFT);
        float near = 1e30, far = 0.0;
        uint covered = 0u;
        for (uint q = gl_SubgroupInvocationID; q < pixels; q += gl_SubgroupSize) {
            ivec2 pixel = corner + ivec2(q & (side - 1u), q >> TILE_SHIFT);
            bool inside = pixel.x < size.x && pixel.y < size.y, is_covered = false;
            ivec2 clamped = min(pixel, size - 1);
            uint direction = 0u;
#ifndef MULTISAMPLED
            if (CLUSTER_NORMALS != 0u) direction = normal_direction(gbuffer_read(clamped).normal);
#endif
            for (uint i = 0u; i < CELL_SAMPLES; i++) {
                float depth = depth_read(clamped, i);
                bool lit = inside && depth > 0.0;
                float view_depth = frame.camera.w / max(depth, 1e-30);
                near = min(near, lit ? view_depth : 1e30);
                far = max(far, lit ? view_depth : 0.0);
                uint key = cell_slice(lit ? view_depth : 1.0) | direction << 8u;
                if (lit) atomicOr(seen[set + (key >> 5u)], 1u << (key & 31u));
                if (inside)
                    pixel_clusters[uint(pixel.y * size.x + pixel.x) * CELL_SAMPLES + i] =
                        lit ? key : 0xFFFFFFFFu;
                is_covered = is_covered || lit;
            }
            covered += is_covered ? 1u : 0u;
        }
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        uint count = 0u;
        for (uint w = gl_SubgroupInvocationID; w < SEEN_WORDS; w += gl_SubgroupSize)
            count += bitCount(seen[set + w]);
        near = subgroupMin(near);
        far = subgroupMax(far);
        covered = subgroupAdd(covered);
        count = subgroupAdd(count);
        if (gl_SubgroupInvocationID == 0u) {
            tile_depths[tile].range = vec4(near, far, 0.0, 0.0);
            tile_depths[tile].mask = uvec4(0u, covered, count, 0u);
        }
    }
}
