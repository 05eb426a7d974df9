#version 460
// overdraw.frag: one more for every fragment of a surface; blended additively, it counts them.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec4 in_normal_u; // as geometry.vert packs it
layout(location = 1) in vec4 in_tangent_v;
layout(location = 2) in vec4 in_factor;
layout(location = 3) flat in uvec2 in_ids;

layout(location = 0) out vec4 out_color;

void main() {
    vec2 uv = vec2(in_normal_u.w, in_tangent_v.w);
    float alpha = material_texel(in_ids.x, uv, in_factor.a).a; // may discard
    out_color = vec4(1.0, alpha * 0.0, 0.0, 0.0);
}
