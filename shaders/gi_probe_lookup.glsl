// gi_probe_lookup.glsl: what the probes say of a surface. Include gi.glsl with GI_SCREEN first.
//
// Of the eight probes around a place each counts with its trilinear share, if it stands before the
// surface and nothing lies between (its three free ways along the axes, see gi_probes.comp): what is
// behind a wall, or in it, does not leak. What speaks against a probe leaves it a tiny weight, so
// that places where something speaks against all eight get the best there is.
#ifndef GI_PROBE_LOOKUP_GLSL
#define GI_PROBE_LOOKUP_GLSL
#include "gi_probe_code.glsl"

layout(set = 2, binding = BINDING_GI_PROBES) uniform sampler3D gi_probes;

// Where between the probes a surface looks: so many spacings before itself.
const float GI_PROBE_OFFSET = 0.25;

struct GiProbeLight {
    vec3 light; // that arrives at a surface facing the normal: irradiance / pi
    float open; // 0..1
};
// count: 8 probes, or 0 for nothing (a branch would not save the work on the software driver).
GiProbeLight gi_probe_light(vec3 world, vec3 normal, uint count) {
    float per_metre = 1.0 / gi.probe_origin.w;
    vec3 place = (world - gi.probe_origin.xyz) * per_metre;
    vec3 last = vec3(gi.probes.xyz) - 2.0;
    vec3 seat = place + normal * GI_PROBE_OFFSET;
    vec3 low = clamp(floor(seat), vec3(0.0), last), share = clamp(seat - low, 0.0, 1.0);
    // A surface is anywhere in its voxel: along its normal. Across it its own voxels are in nobody's
    // way, but those of a wall that it ends at.
    vec3 slack = gi.origin[GI_CASCADES - 1u].w * per_metre * max(abs(normal), vec3(0.5)) +
                 GI_PROBE_STEP;
    vec3 weight = normal * normal;
    ivec3 block = ivec3(normal.x < 0.0 ? 1 : 0, normal.y < 0.0 ? 3 : 2, normal.z < 0.0 ? 5 : 4) *
                  int(gi.probes.x);
    vec4 sum = vec4(0.0);
    float sum_weight = 0.0;
    for (uint i = 0u; i < count; i++) {
        uvec3 corner = uvec3(i & 1u, i >> 1 & 1u, i >> 2);
        vec3 near = mix(1.0 - share, share, vec3(corner));
        ivec3 probe = ivec3(low) + ivec3(corner);
        vec3 way = place - vec3(probe); // from the probe to the surface
        vec4 x = texelFetch(gi_probes, ivec3(probe.x + block.x, probe.yz), 0);
        vec4 y = texelFetch(gi_probes, ivec3(probe.x + block.y, probe.yz), 0);
        vec4 z = texelFetch(gi_probes, ivec3(probe.x + block.z, probe.yz), 0);
        GiProbeCode cx = gi_probe_decode(x.a), cy = gi_probe_decode(y.a),
                    cz = gi_probe_decode(z.a);
        vec4 says = vec4(x.rgb * weight.x + y.rgb * weight.y + z.rgb * weight.z,
                         dot(vec3(cx.open, cy.open, cz.open), weight));
        vec3 free = vec3(way.x > 0.0 ? cx.up : cx.down, way.y > 0.0 ? cy.up : cy.down,
                         way.z > 0.0 ? cz.up : cz.down);
        free += mix(slack, vec3(0.0), equal(free, vec3(0.0))); // 0: behind is wall
        vec3 seen = clamp((free - abs(way)) * 8.0 + 1.0, vec3(1e-3), vec3(1.0));
        float before = clamp(-dot(way, normal) * 8.0 + 0.25, 1e-4, 1.0);
        float valid = cx.up + cx.down > 0.0 ? 1.0 : 1e-6;
        float w = near.x * near.y * near.z * before * valid * (seen.x * seen.y * seen.z) + 1e-20;
        sum += says * w;
        sum_weight += w;
    }
    sum /= max(sum_weight, 1e-20);
    return GiProbeLight(sum.rgb, sum.a);
}
#endif
