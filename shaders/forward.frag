#version 460
// forward.frag: one fragment, all its lights: every light of the frame (path `forward`) or those of
// its tile (blended surfaces of the other paths).
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"
#include "light.glsl"

layout(std430, set = 0, binding = BINDING_CELLS) readonly buffer CellBuffer { CellRecord cells[]; };
layout(std430, set = 0, binding = BINDING_LIGHT_INDICES) readonly buffer IndexBuffer {
    uint light_indices[];
};

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;
layout(location = 5) in vec3 in_position;

layout(location = 0) out vec4 out_color;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    Surface s = surface_make(in_position, normal, albedo.rgb, in_material);
    vec3 sum = vec3(0.0);
    uint point_count = flow.counts.x, spot_count = flow.counts.y;
    if (CELL_LISTS != 0u) {
        uvec2 tile = uvec2(gl_FragCoord.xy) >> TILE_SHIFT;
        uvec4 list = cells[tile.y * frame.grid.x + tile.x].list;
        for (uint i = 0u; i < list.y; i++) {
            uint index = light_indices[list.x + i];
            sum += light_point(s, light_position(index), light_color(index));
        }
        for (uint i = list.y; i < list.y + list.z; i++) {
            uint index = light_indices[list.x + i];
            sum += light_spot(s, light_position(index), light_color(index),
                              spot_direction(index - point_count), spot_edge(index - point_count));
        }
    } else if (LIGHT_BLOCKS == 2u) {
        // One loop a block: choosing the block inside would load from both.
        uint end = min(point_count, LIGHT_BLOCK_CAP);
        for (uint i = 0u; i < end; i++)
            sum += light_point(s, light_block_0[i].position, light_block_0[i].color);
        for (uint i = LIGHT_BLOCK_CAP; i < point_count; i++)
            sum += light_point(s, light_block_1[i - LIGHT_BLOCK_CAP].position,
                               light_block_1[i - LIGHT_BLOCK_CAP].color);
        for (uint i = 0u; i < spot_count; i++)
            sum += light_spot(s, light_position(point_count + i), light_color(point_count + i),
                              spot_direction(i), spot_edge(i));
    } else {
        for (uint i = 0u; i < point_count; i++)
            sum += light_point(s, light_position(i), light_color(i));
        for (uint i = 0u; i < spot_count; i++)
            sum += light_spot(s, light_position(point_count + i), light_color(point_count + i),
                              spot_direction(i), spot_edge(i));
    }
    vec3 radiance = light_base(s, albedo.rgb, in_material) + sum * palette_emissive(in_material).w;
    out_color = vec4(radiance, albedo.a);
}
