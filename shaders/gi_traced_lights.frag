#version 460
// gi_traced_lights.frag: lights whose shadows come from the voxels, added to the lit picture: a cone
// towards the light that gathers opacity alone, or the voxels' mean visibility.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"

layout(set = 2, binding = BINDING_GI_VISIBILITY) uniform sampler3D gi_visibility;

layout(location = 0) out vec4 out_color;

const uint TRACED_BY_CONE = 1u, TRACED_BY_VOLUME = 2u;
const uint KIND_SPOT = 1u, KIND_DIRECTIONAL = 2u;

// Mean visibility of the voxel that the surface lies in.
float volume_visibility(GbufferPixel g) {
    uint cascade = min(gi_cascade(g.position, 0.0), GI_CASCADES - 1u);
    vec3 place = clamp(gi_to_voxels(g.position, cascade), vec3(0.0), vec3(gi.dims.xyz) - 0.5);
    ivec3 voxel = ivec3(place);
    voxel.z += int(gi.dims.z * cascade);
    return texelFetch(gi_visibility, voxel, 0).x;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    Surface s = gbuffer_surface(g);
    vec3 start = gi_start(g);
    // As rays (specification of voxel GI, 4) two voxels out: in a corner the other wall is near.
    float first = gi_first(uvec2(pixel)) + 1.0;
    float by_volume = (GI_TRACED & TRACED_BY_VOLUME) != 0u ? volume_visibility(g) : 1.0;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < gi_flow.counts.x; i++) {
        GiLightRecord light = gi_traced[i].light;
        vec4 shadow = gi_traced[i].shadow;
        uint kind = uint(light.extra.y);
        Arrival a = light_arrival(s, light.position);
        if (kind == KIND_DIRECTIONAL) {
            a.l = -light.direction.xyz;
            a.n_dot_l = a.falloff = max(dot(s.normal, a.l), 0.0);
        }
        float cone_share = spot_cone(a.l, light.direction, light.extra.x);
        a.falloff *= kind == KIND_SPOT ? cone_share : 1.0;
        float visibility = by_volume;
        if ((GI_TRACED & TRACED_BY_CONE) != 0u) {
            bool by_cone = shadow.z < 0.5;
            // To the light, not through what it hangs in; nothing where it does not shine.
            float distance = length(light.position.xyz - start) - gi_voxel_at(start);
            float reach = kind == KIND_DIRECTIONAL ? 1e9 : distance;
            bool is_lit = by_cone && g.depth > 0.0 && a.falloff > 0.0;
            float opacity = gi_shadow_cone(start, a.l, shadow.x, first, is_lit ? reach : 0.0);
            visibility = by_cone ? clamp(1.0 - opacity * shadow.y, 0.0, 1.0) : visibility;
        }
        sum += light.color.rgb * brdf(s, a.l, a.n_dot_l, light.color.w) * (a.falloff * visibility);
    }
    out_color = vec4(g.depth > 0.0 ? sum * gbuffer_receives(g) : vec3(0.0), 0.0);
}
