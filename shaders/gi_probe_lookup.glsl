// gi_probe_lookup.glsl: what the probes say of a surface. Include gi.glsl first, with GI_SCREEN or
// GI_BUILD.
//
// Of the eight probes around a place each counts with its trilinear share, if it stands before the
// surface and nothing lies between (its three free ways along the axes, see gi_probes.comp): what is
// behind a wall, or in it, does not leak. What speaks against a probe leaves it a tiny weight, so
// that places where something speaks against all eight get the best there is.
#ifndef GI_PROBE_LOOKUP_GLSL
#define GI_PROBE_LOOKUP_GLSL
#include "gi_probe_code.glsl"

#ifdef GI_BUILD
layout(set = 0, binding = BUILD_PROBES) uniform sampler3D gi_probes;
#else
layout(set = 2, binding = BINDING_GI_PROBES) uniform sampler3D gi_probes;
#endif

// Where between the probes a surface looks: so many spacings before itself.
const float GI_PROBE_OFFSET = 0.25;

// What arrives at surfaces that face the axes, on the normal's side of each: irradiance / pi, and how
// open it is there, 0..1.
struct GiProbeLight {
    vec4 x, y, z;
};
// normal: unit. count: 8 probes; 4, the next layer of them before the surface, across the normal's
// main axis; or 0 for nothing (a branch would not save the work on the software driver). is_layer: a
// constant, true for counts of 4.
GiProbeLight gi_probe_axes(vec3 world, vec3 normal, uint count, bool is_layer) {
    float per_metre = 1.0 / gi.probe_origin.w;
    vec3 place = (world - gi.probe_origin.xyz) * per_metre;
    vec3 last = vec3(gi.probes.xyz) - 2.0;
    vec3 seat = place + normal * GI_PROBE_OFFSET;
    vec3 low = clamp(floor(seat), vec3(0.0), last), share = clamp(seat - low, 0.0, 1.0);
    vec3 size = abs(normal);
    bvec3 main = bvec3(size.x >= max(size.y, size.z), size.y > size.x && size.y >= size.z,
                       size.z > max(size.x, size.y));
    if (is_layer) {
        vec3 next = mix(floor(place) + 1.0, ceil(place) - 1.0, lessThan(normal, vec3(0.0)));
        low = mix(low, clamp(next, vec3(0.0), last + 1.0), main);
        share = mix(share, vec3(0.0), main);
    }
    // A surface is anywhere in its voxel: along its normal. Across it its own voxels are in nobody's
    // way, but those of a wall that it ends at.
    vec3 slack = gi.origin[GI_CASCADES - 1u].w * per_metre * max(size, vec3(0.5)) + GI_PROBE_STEP;
    ivec3 block = ivec3(normal.x < 0.0 ? 1 : 0, normal.y < 0.0 ? 3 : 2, normal.z < 0.0 ? 5 : 4) *
                  int(gi.probes.x);
    GiProbeLight sum = GiProbeLight(vec4(0.0), vec4(0.0), vec4(0.0));
    float sum_weight = 0.0;
    uint i = 0u;
    if (count > 0u)
        do {
            uvec3 corner = uvec3(i & 1u, i >> 1 & 1u, i >> 2);
            if (is_layer) corner = mix(uvec3(i & 1u, main.x ? i & 1u : i >> 1, i >> 1), uvec3(0), main);
            vec3 near = mix(1.0 - share, share, vec3(corner));
            ivec3 probe = ivec3(low) + ivec3(corner);
            vec3 way = place - vec3(probe); // from the probe to the surface
            vec4 x = texelFetch(gi_probes, ivec3(probe.x + block.x, probe.yz), 0);
            vec4 y = texelFetch(gi_probes, ivec3(probe.x + block.y, probe.yz), 0);
            vec4 z = texelFetch(gi_probes, ivec3(probe.x + block.z, probe.yz), 0);
            GiProbeCode cx = gi_probe_decode(x.a), cy = gi_probe_decode(y.a),
                        cz = gi_probe_decode(z.a);
            vec3 free = vec3(way.x > 0.0 ? cx.up : cx.down, way.y > 0.0 ? cy.up : cy.down,
                             way.z > 0.0 ? cz.up : cz.down);
            free += mix(slack, vec3(0.0), equal(free, vec3(0.0))); // 0: behind is wall
            vec3 seen = clamp((free - abs(way)) * 8.0 + 1.0, vec3(1e-3), vec3(1.0));
            float before = clamp(-dot(way, normal) * 8.0 + 0.25, 1e-4, 1.0);
            float valid = cx.up + cx.down > 0.0 ? 1.0 : 1e-6;
            float w = near.x * near.y * near.z * before * valid * (seen.x * seen.y * seen.z) + 1e-20;
            sum.x += vec4(x.rgb, cx.open) * w;
            sum.y += vec4(y.rgb, cy.open) * w;
            sum.z += vec4(z.rgb, cz.open) * w;
            sum_weight += w;
        } while (++i < count);
    float scale = 1.0 / max(sum_weight, 1e-20);
    return GiProbeLight(sum.x * scale, sum.y * scale, sum.z * scale);
}

// That of a surface facing the normal: rgb irradiance / pi, a openness.
vec4 gi_probe_light(vec3 world, vec3 normal, uint count) {
    GiProbeLight axes = gi_probe_axes(world, normal, count, false);
    vec3 weight = normal * normal;
    return axes.x * weight.x + axes.y * weight.y + axes.z * weight.z;
}
#endif
