#version 460
// prepass_mask.frag: discards the holes; writes depth only.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 2) flat in uint in_material;

void main() { material_albedo(in_material, in_uv, in_color); }
