#version 460
// emissive.frag: emission with a texture, added over the lit picture at equal depth; emission
// without one is in the palette and costs nothing here.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;

layout(location = 0) out vec4 out_color;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    out_color = vec4(texture(emissive_texture, in_uv).rgb * palette_extra(in_material).yzw,
                     albedo.a * 0.0);
}
