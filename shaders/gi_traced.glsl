// gi_traced.glsl: lights whose shadows come from the voxels, on one surface: a cone towards the light
// that gathers opacity alone, or the voxels' mean visibility. Of opaque pixels (gi_traced_lights.frag)
// and of blended fragments (forward.glsl). Include light.glsl, gi.glsl with GI_SCREEN, and
// gi_cones.glsl first.
#ifndef GI_TRACED_GLSL
#define GI_TRACED_GLSL

layout(set = 2, binding = BINDING_GI_VISIBILITY) uniform sampler3D gi_visibility;

const uint TRACED_BY_CONE = 1u, TRACED_BY_VOLUME = 2u;
const uint KIND_SPOT = 1u, KIND_DIRECTIONAL = 2u;

// Mean visibility of the voxel that the surface lies in.
float volume_visibility(vec3 position) {
    uint cascade = min(gi_cascade(position, 0.0), GI_CASCADES - 1u);
    vec3 place = clamp(gi_to_voxels(position, cascade), vec3(0.0), vec3(gi.dims.xyz) - 0.5);
    ivec3 voxel = ivec3(place);
    voxel.z += int(gi.dims.z * cascade);
    return texelFetch(gi_visibility, voxel, 0).x;
}

// start, first: of the cones (gi_cone); is_on: false traces none.
vec3 gi_traced_light(Surface s, vec3 start, float first, bool is_on) {
    float by_volume = (GI_TRACED & TRACED_BY_VOLUME) != 0u ? volume_visibility(s.position) : 1.0;
    vec3 sum = vec3(0.0);
    uint count = gi_flow.counts.x;
    if (count > 0u) for (uint i = 0u;;) { // ends with its test, which saves a round (gi_cones.glsl)
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
            bool is_lit = by_cone && is_on && a.falloff > 0.0;
            float opacity = gi_shadow_cone(start, a.l, shadow.x, first, is_lit ? reach : 0.0);
            visibility = by_cone ? clamp(1.0 - opacity * shadow.y, 0.0, 1.0) : visibility;
        }
        sum += light.color.rgb * brdf(s, a.l, a.n_dot_l, light.color.w) * (a.falloff * visibility);
        if (++i >= count) break;
    }
    return sum;
}
#endif
