#version 460
// prepass_mask.vert: the same for meshes with holes.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec4 out_color;
layout(location = 2) flat out uint out_material;

void main() {
    gl_Position = frame.view_projection * vec4(mesh_world_position(), 1.0);
    out_uv = in_uv;
    out_color = in_color;
    out_material = in_ids.x;
}
