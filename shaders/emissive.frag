#version 460
// emissive.frag: emission with a texture, added over the lit picture at equal depth; emission
// without one is in the palette and costs nothing here.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec4 in_normal_u; // as geometry.vert packs it
layout(location = 1) in vec4 in_tangent_v;
layout(location = 2) in vec4 in_factor;
layout(location = 3) flat in uvec2 in_ids;

layout(location = 0) out vec4 out_color;

void main() {
    vec2 uv = vec2(in_normal_u.w, in_tangent_v.w);
    float alpha = material_texel(in_ids.x, uv, in_factor.a).a;
    out_color = vec4(texture(emissive_texture, uv).rgb * palette_extra(in_ids.x).yzw, alpha * 0.0);
}
