#version 460
// cluster_places.comp: stage two of unique keys: each occupied cluster's key to its place, and each
// pixel's key becomes its cluster's place. One subgroup a tile; a key's place in the tile is how
// many smaller ones there are.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "list_make.glsl"
layout(local_size_x = 64) in;

const uint SEEN_WORDS = 1u << (CLUSTER_TILE_SHIFT - 5);
shared uint seen[SUBGROUPS_CAP * SEEN_WORDS];
shared uint smaller[SUBGROUPS_CAP * SEEN_WORDS];

void main() {
    ivec2 size = ivec2(frame.viewport.xy);
    uint side = 1u << TILE_SHIFT, pixels = side * side, set = gl_SubgroupID * SEEN_WORDS;
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        ivec2 corner = ivec2(uvec2(tile % flow.grid.x, tile / flow.grid.x) << TILE_SHIFT);
        for (uint w = gl_SubgroupInvocationID; w < SEEN_WORDS; w += gl_SubgroupSize)
            seen[set + w] = 0u;
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        for (uint q = gl_SubgroupInvocationID; q < pixels; q += gl_SubgroupSize) {
            ivec2 pixel = corner + ivec2(q & (side - 1u), q >> TILE_SHIFT);
            ivec2 clamped = min(pixel, size - 1);
            bool inside = pixel.x < size.x && pixel.y < size.y;
            for (uint i = 0u; i < CELL_SAMPLES; i++) {
                uint key = pixel_clusters[uint(clamped.y * size.x + clamped.x) * CELL_SAMPLES + i];
                bool lit = inside && key != 0xFFFFFFFFu;
                if (lit) atomicOr(seen[set + (key >> 5u)], 1u << (key & 31u));
            }
        }
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        uint base = tile_depths[tile].mask.w, before = 0u;
        for (uint b = 0u; b < SEEN_WORDS; b += gl_SubgroupSize) {
            uint w = b + gl_SubgroupInvocationID;
            uint bits = w < SEEN_WORDS ? seen[set + w] : 0u, count = bitCount(bits);
            uint place = before + subgroupExclusiveAdd(count);
            if (w < SEEN_WORDS) smaller[set + w] = place;
            before += subgroupAdd(count);
            bool writes = base >= CLUSTER_FIRST;
            for (uint key = w << 5u; bits != 0u; bits &= bits - 1u) {
                if (writes)
                    clusters[base + place] =
                        tile << CLUSTER_TILE_SHIFT | key | uint(findLSB(bits));
                place++;
            }
        }
        subgroupMemoryBarrierShared();
        subgroupBarrier();
        for (uint q = gl_SubgroupInvocationID; q < pixels; q += gl_SubgroupSize) {
            ivec2 pixel = corner + ivec2(q & (side - 1u), q >> TILE_SHIFT);
            ivec2 clamped = min(pixel, size - 1);
            bool inside = pixel.x < size.x && pixel.y < size.y;
            for (uint i = 0u; i < CELL_SAMPLES; i++) {
                uint at = uint(clamped.y * size.x + clamped.x) * CELL_SAMPLES + i;
                uint key = pixel_clusters[at], word = set + ((key >> 5u) & (SEEN_WORDS - 1u));
                uint rank = smaller[word] + bitCount(seen[word] & ((1u << (key & 31u)) - 1u));
                uint place = base >= CLUSTER_FIRST ? base + rank : CLUSTER_ALL;
                if (inside) pixel_clusters[at] = key == 0xFFFFFFFFu ? CLUSTER_EMPTY : place;
            }
        }
        // The sets are cleared for the next tile only after all have read them.
        subgroupMemoryBarrierShared();
        subgroupBarrier();
    }
}
