#version 460
// forward.frag: one fragment, all its lights: every light of the frame (path `forward`), or those of
// its cell (tiled and clustered forward; blended surfaces of all paths). VERTEX_LIGHTING 1: a share
// of the local light comes from the vertices; 2: all of it.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "material.glsl"
#include "cells.glsl"

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec4 in_tangent;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_color;
layout(location = 4) flat in uint in_material;
layout(location = 5) in vec3 in_position;
layout(location = 6) in vec3 in_vertex_light;
layout(location = 7) flat in float in_vertex_share;

layout(location = 0) out vec4 out_color;

// All lights of the frame, in their order. The uniform blocks need no uniform index: to make one
// costs more than the read.
vec3 all_light(Surface s) {
    if (LIGHT_BLOCKS == 0u) return cell_light_list(s, cell_list_all(), true);
    vec3 sum = vec3(0.0);
    uint points = flow.counts.x, all = points + flow.counts.y;
    for (uint i = 0u; i < flow.counts3.x; i++)
        sum += light_point(s, light_position(i), light_color(i));
    for (uint i = flow.counts3.x; i < points; i++)
        sum += light_point_diffuse(s, light_position(i), light_color(i));
    if (SPOTS == 0u) return sum;
    uint diffuse = points + flow.counts3.y;
    for (uint i = points; i < diffuse; i++)
        sum += light_spot(s, light_position(i), light_color(i), spot_direction(i - points),
                          spot_edge(i - points));
    for (uint i = diffuse; i < all; i++)
        sum += light_spot_diffuse(s, light_position(i), light_color(i), spot_direction(i - points),
                                  spot_edge(i - points));
    return sum;
}

vec3 local_light(Surface s) {
    if (CELL_LISTS == 0u) return all_light(s);
    // Lanes that only help with derivatives may lie beside the screen.
    uvec2 pixel = uvec2(clamp(gl_FragCoord.xy, vec2(0.0), frame.viewport.xy - 1.0));
    return cell_light(s, cell_of(pixel, frame.camera.w / max(gl_FragCoord.z, 1e-9)));
}

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    Surface s = surface_make(in_position, normal, albedo.rgb, in_material);
    vec3 sum = VERTEX_LIGHTING == 2u ? vec3(0.0) : local_light(s);
    if (VERTEX_LIGHTING != 0u) sum = mix(sum, in_vertex_light * albedo.rgb, in_vertex_share);
    vec3 radiance = light_base(s, albedo.rgb, in_material) + sum * palette_emissive(in_material).w;
    out_color = vec4(radiance, albedo.a);
}
