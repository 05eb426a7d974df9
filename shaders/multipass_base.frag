#version 460
// multipass_base.frag: path `multipass`, first: emission, ambient and directional light; and whose
// the pixel is.
#extension GL_GOOGLE_include_directive : require
#include "material.glsl"
#include "light.glsl"
#include "multipass_owner.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;
layout(location = 5) in vec3 in_position;


layout(location = 0) out vec4 out_color;
layout(location = 1) out vec4 out_owner;

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    Surface s = surface_make(in_position, normal, albedo.rgb, in_material);
    out_owner = pixel_owner();
    out_color = vec4(light_base(s, albedo.rgb, in_material), 1.0);
}
