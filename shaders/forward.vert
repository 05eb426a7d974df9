#version 460
// forward.vert: meshes that are shaded where they are drawn. VERTEX_LIGHTING: far ones get their
// local lights here, diffuse only (specification of direct lighting, section 5, after Puig 2006).
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"
#include "vertex_light.glsl"

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec4 out_tangent;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec4 out_color;
layout(location = 4) flat out uint out_material;
layout(location = 5) out vec3 out_position;
layout(location = 6) out vec3 out_vertex_light;   // irradiance / pi
layout(location = 7) flat out float out_vertex_share; // of it, 0..1
layout(location = 8) flat out uint out_entity;    // drawable's: path `multipass`

void main() {
    vec3 p = mesh_world_position();
    gl_Position = frame.view_projection * vec4(p, 1.0);
    out_normal = mesh_world_normal();
    out_tangent = (TEXTURES & 2u) != 0u ? mesh_world_tangent() : vec4(0.0);
    out_uv = in_uv;
    out_color = in_color;
    out_material = in_ids.x;
    out_position = p;
    out_entity = in_ids.y;
    out_vertex_light = VERTEX_LIGHTING != 0u ? vertex_light(p, out_normal, gl_Position) : vec3(0.0);
    out_vertex_share = VERTEX_LIGHTING != 0u ? uintBitsToFloat(in_ids.z) : 0.0;
}
