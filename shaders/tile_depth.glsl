// tile_depth.glsl: depths seen in each tile: nearest, farthest, and which of 32 slices between them
// are occupied (specification of direct lighting, 6.2; the mask: 2.5D culling). Background does not
// count; all samples do. One subgroup a tile; minima and ors are the same in any order.
#include "list_make.glsl"
#include "depth_read.glsl"
layout(local_size_x = 64) in;

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
        near = subgroupMin(near);
        far = subgroupMax(far);
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
                uint bit = 1u << depth_slice(view_depth, near, scale);
                mask |= inside && depth > 0.0 ? bit : 0u;
            }
        }
        mask = subgroupOr(mask);
        if (gl_SubgroupInvocationID == 0u) {
            tile_depths[tile].range = vec4(near, far, scale, 0.0);
            tile_depths[tile].mask = uvec4(mask, covered, 0u, 0u);
        }
    }
}
