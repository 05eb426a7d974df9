#version 460
// geometry.vert: meshes into the G-buffer.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec4 out_tangent;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out uint out_material;
layout(location = 5) out vec3 out_position; // world, for layouts that store something of it

void main() {
    vec3 p = mesh_world_position();
    gl_Position = frame.view_projection * vec4(p, 1.0);
    out_normal = mesh_world_normal();
    out_tangent = (TEXTURES & 2u) != 0u ? mesh_world_tangent() : vec4(0.0);
    out_uv = in_uv;
    out_color = in_color;
    out_material = in_ids.x;
    out_position = LAYOUT != GBUFFER_LAYOUT_LEAN ? p : vec3(0.0);
}
