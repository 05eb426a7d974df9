#version 460
// forward.frag: one fragment, all its lights: every light of the frame (path `forward`) or those of
// its tile (blended surfaces of the other paths).
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"
#include "light.glsl"

layout(std430, set = 0, binding = BINDING_TILES) readonly buffer TileBuffer { TileRecord tiles[]; };
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
    uint point_count = frame.counts.x;
    if (TILE_LISTS != 0u) {
        uvec2 tile = uvec2(gl_FragCoord.xy) / TILE_SIZE_PX;
        uvec4 list = tiles[tile.y * frame.counts.w + tile.x].list;
        for (uint i = 0u; i < list.y; i++) {
            LightRecord light = lights[light_indices[list.x + i]];
            sum += light_point(s, light.position, light.color.rgb);
        }
        for (uint i = list.y; i < list.y + list.z; i++) {
            uint index = light_indices[list.x + i];
            LightRecord light = lights[index];
            sum += light_spot(s, light.position, light.color, spots[index - point_count].direction);
        }
    } else {
        for (uint i = 0u; i < point_count; i++)
            sum += light_point(s, lights[i].position, lights[i].color.rgb);
        for (uint i = 0u; i < frame.counts.y; i++)
            sum += light_spot(s, lights[point_count + i].position, lights[point_count + i].color,
                              spots[i].direction);
    }
    vec3 radiance = light_base(s, albedo.rgb, in_material) + sum * materials[in_material].emissive.w;
    out_color = vec4(radiance, albedo.a);
}
