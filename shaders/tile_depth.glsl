// tile_depth.glsl: depths seen in each tile: nearest, farthest, and which of 32 slices between them
// are occupied (specification of direct lighting, 6.2; the mask: 2.5D culling). Background does not
// count; all samples do. One subgroup a tile; minima and ors are the same in any order.
#include "list_make.glsl"
#include "depth_read.glsl"
layout(local_size_x = 64) in;

// With samples, a pixel that a triangle only touches is shaded at its centre, nearer or farther than the
// samples: this part of the distance is added on either side, enough for surfaces seen at 1:16.
#define TOUCHED_MARGIN (CELL_SAMPLES > 1u ? 0.02 : 0.0)

void main() {
    // Cleared for the passes that count (the others overwrite).
    if (gl_GlobalInvocationID.x < GRID_COUNTER_COUNT) grid_counters[gl_GlobalInvocationID.x] = 0u;
    ivec2 size = ivec2(frame.viewport.xy);
    uint side = 1u << TILE_SHIFT, pixels = side * side;
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        ivec2 corner = ivec2(uvec2(tile % flow.grid.x, tile / flow.grid.x) << TILE_SHIFT);
        float near = 1e30, far = 0.0;
        uint covered = 0u;
        for (uint q = gl_SubgroupInvocationID; q < pixels; q += gl_SubgroupSize) {
            ivec2 pixel = corner + ivec2(q & (side - 1u), q >> TILE_SHIFT);
            bool inside = pixel.x < size.x && pixel.y < size.y;
            bool is_covered = false;
            for (uint i = 0u; i < CELL_SAMPLES; i++) {
                float depth = depth_read(min(pixel, size - 1), i);
                bool seen = inside && depth > 0.0;
                float view_depth = frame.camera.w / max(depth, 1e-30);
                near = min(near, seen ? view_depth : 1e30);
                far = max(far, seen ? view_depth : 0.0);
                is_covered = is_covered || seen;
            }
            covered += is_covered ? 1u : 0u;
        }
        near = subgroupMin(near) * (1.0 - TOUCHED_MARGIN);
        far = subgroupMax(far) * (1.0 + TOUCHED_MARGIN);
        covered = subgroupAdd(covered);
        float scale = far > near ? 32.0 / (far - near) : 0.0;
        uint mask = 0u;
        // Only its loop is left out where nobody asks: views of the mask ask as well.
        for (uint q = gl_SubgroupInvocationID; q < pixels; q += gl_SubgroupSize) {
            ivec2 pixel = corner + ivec2(q & (side - 1u), q >> TILE_SHIFT);
            bool inside = pixel.x < size.x && pixel.y < size.y;
            for (uint i = 0u; i < CELL_SAMPLES; i++) {
                float depth = depth_read(min(pixel, size - 1), i);
                float view_depth = frame.camera.w / max(depth, 1e-30);
                uint first = depth_slice(view_depth * (1.0 - TOUCHED_MARGIN), near, scale);
                uint last = depth_slice(view_depth * (1.0 + TOUCHED_MARGIN), near, scale);
                mask |= inside && depth > 0.0 ? (2u << last) - (1u << first) : 0u;
            }
        }
        mask = subgroupOr(mask);
        if (gl_SubgroupInvocationID == 0u) {
            tile_depths[tile].range = vec4(near, far, scale, 0.0);
            tile_depths[tile].mask = uvec4(mask, covered, 0u, 0u);
        }
    }
}
