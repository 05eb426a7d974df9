#version 460
// geometry.vert: meshes into the G-buffer. What a triangle carries is packed: the software driver
// sets up and keeps every varying of every triangle as if it were a vec4, and a GPU stores it too.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

layout(location = 0) out vec4 out_normal_u;  // world; w: u of the texture
layout(location = 1) out vec4 out_tangent_v; // world; w: v
layout(location = 2) out vec4 out_factor;    // on the texture: the material's albedo and the vertex's colour
layout(location = 3) flat out uvec2 out_ids; // material; bitangent's sign in the highest bit
layout(location = 4) out vec3 out_position;  // world, for layouts that store something of it

void main() {
    vec3 p = mesh_world_position();
    gl_Position = frame.view_projection * vec4(p, 1.0);
    out_normal_u = vec4(mesh_world_normal(), in_uv.x);
    vec4 tangent = (TEXTURES & 2u) != 0u ? mesh_world_tangent() : vec4(0.0);
    out_tangent_v = vec4(tangent.xyz, in_uv.y);
    // Here and not in the fragment shader: reading a row by an index that lanes may not share is a
    // gather, and there are fewer vertices than fragments.
    out_factor = vec4(palette_albedo(in_ids.x).rgb * in_color.rgb, in_color.a);
    out_ids = uvec2(in_ids.x, in_tangent & 0x80000000u);
    out_position = LAYOUT != GBUFFER_LAYOUT_LEAN ? p : vec3(0.0);
}
