#version 460
// shadow_mask.vert: casters with holes.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

layout(location = 0) out vec2 out_uv;
layout(location = 1) flat out uint out_material;

void main() {
    gl_Position = frame.shadow_matrix * vec4(mesh_world_position(), 1.0);
    out_uv = in_uv;
    out_material = in_ids.x;
}
