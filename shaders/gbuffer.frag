#version 460
// gbuffer.frag: layout `lean`: RGBA8 (sRGB) albedo + material id, RG16 octahedral normal.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;

layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec2 out_normal;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    out_albedo = vec4(albedo.rgb, float(in_material) / 255.0);
    out_normal = oct_encode(normal) * 0.5 + 0.5;
}
