#version 460
// gbuffer.frag: a mesh's surface into the targets of the layout (gbuffer.glsl).
#extension GL_GOOGLE_include_directive : require
#define GBUFFER_WRITES
#include "material.glsl"
#include "gbuffer.glsl"

layout(location = 0) in vec4 in_normal_u; // as geometry.vert packs it
layout(location = 1) in vec4 in_tangent_v;
layout(location = 2) in vec4 in_factor;
layout(location = 3) flat in uvec2 in_ids;
layout(location = 4) in vec3 in_position;

// A layout may have fewer targets: what is written beyond goes nowhere.
layout(location = 0) out vec4 out_0;
layout(location = 1) out vec4 out_1;
layout(location = 2) out vec4 out_2;
layout(location = 3) out vec4 out_3;
layout(location = 4) out vec4 out_4;

void main() {
    vec2 uv = vec2(in_normal_u.w, in_tangent_v.w);
    vec4 texel = material_texel(in_ids.x, uv, in_factor.a);
    vec4 tangent = vec4(in_tangent_v.xyz, uintBitsToFloat(in_ids.y | 0x3F800000u)); // w: 1 or -1
    vec3 direction = material_direction(uv, in_normal_u.xyz, tangent);
    vec4 t[5];
    gbuffer_write(in_position, direction, texel.rgb * in_factor.rgb, in_ids.x, t);
    out_0 = t[0];
    out_1 = t[1];
    out_2 = t[2];
    out_3 = t[3];
    out_4 = t[4];
}
