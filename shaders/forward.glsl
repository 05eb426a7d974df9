// forward.glsl: one fragment, all its lights: every light of the frame (path `forward`), or those of
// its cell (tiled and clustered forward; blended surfaces of all paths). VERTEX_LIGHTING 1: a share
// of the local light comes from the vertices; 2: all of it.
//
// The body of forward.frag, and of gi_forward.frag, which defines GI_SCREEN: a blended surface, which
// no G-buffer shows, gets here what the passes over the screen give to opaque ones: lights with traced
// shadows, and indirect diffuse light (diffuse=voxels: by cones, as blended surfaces leave no voxels).
// It gets no indirect highlights and no ambient occlusion.
#include "subgroups.glsl"
#include "material.glsl"
#include "cells.glsl"
#ifdef GI_SCREEN
#include "gi.glsl"
#include "gi_cones.glsl"
#include "gi_probe_lookup.glsl"
#include "gi_traced.glsl"
#endif

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

#ifdef GI_SCREEN
vec3 voxel_light(Surface s, vec3 albedo) {
    vec3 start = gi_start_at(s.position, s.normal), sum = vec3(0.0);
    if (GI_TRACED != 0u) sum = gi_traced_light(s, start, GI_START + 1.0, true);
    vec3 arriving = vec3(0.0);
    if (GI_DIFFUSE == 2u) arriving = gi_probe_light(s.position, s.normal, 8u).rgb;
    if ((GI_DIFFUSE & 1u) != 0u)
        arriving = gi_hemisphere(start, s.normal, vec2(0.0), GI_START, gi_reach(), 6u,
                                 frame.sky_zenith.rgb * gi.scale.y,
                                 frame.sky_horizon.rgb * gi.scale.y)
                       .light;
    return sum + albedo * arriving * gi.strength.x;
}
#endif

void main() {
    vec4 albedo = material_albedo(in_material, in_uv, in_color);
    vec3 normal = material_normal(in_uv, in_normal, in_tangent);
    Surface s = surface_make(in_position, normal, albedo.rgb, in_material);
    vec3 sum = VERTEX_LIGHTING == 2u ? vec3(0.0) : local_light(s);
    if (VERTEX_LIGHTING != 0u) sum = mix(sum, in_vertex_light * albedo.rgb, in_vertex_share);
#ifdef GI_SCREEN
    sum += voxel_light(s, albedo.rgb);
#endif
    vec3 radiance = light_base(s, albedo.rgb, in_material) + sum * palette_emissive(in_material).w;
    out_color = vec4(radiance, albedo.a);
}
