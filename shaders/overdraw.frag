#version 460
// overdraw.frag: one more for every fragment of a surface; blended additively, it counts them.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;

layout(location = 0) out vec4 out_color;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color); // may discard
    out_color = vec4(1.0, albedo.a * 0.0, 0.0, 0.0);
}
