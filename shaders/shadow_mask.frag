#version 460
// shadow_mask.frag: discards the holes; writes depth only.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"

layout(location = 0) in vec2 in_uv;
layout(location = 1) flat in uint in_material;

void main() {
    if (texture(albedo_texture, in_uv).a < palette_albedo(in_material).w) discard;
}
