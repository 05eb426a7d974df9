#version 460
// gbuffer.frag: a mesh's surface into the targets of the layout (gbuffer.glsl).
#extension GL_GOOGLE_include_directive : require
#define GBUFFER_WRITES
#include "material.glsl"
#include "gbuffer.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;
layout(location = 5) in vec3 in_position;

// A layout may have fewer targets: what is written beyond goes nowhere.
layout(location = 0) out vec4 out_0;
layout(location = 1) out vec4 out_1;
layout(location = 2) out vec4 out_2;
layout(location = 3) out vec4 out_3;
layout(location = 4) out vec4 out_4;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    vec4 t[5];
    gbuffer_write(in_position, normal, albedo.rgb, in_material, t);
    out_0 = t[0];
    out_1 = t[1];
    out_2 = t[2];
    out_3 = t[3];
    out_4 = t[4];
}
