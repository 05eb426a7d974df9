#version 460
// test_cones.comp: of tests/gpu: cones of a list through given volumes. A cone is 12 floats in the
// accumulators: start, tan of half the aperture, direction, first, reach, 3 unused; what it brings
// is 8 floats in the radiance: light, occlusion, steps, 2 unused. Step 1: hemispheres (direction is
// the normal, the rest unused), which bring light and visibility. Step 2: as 0, eight side by side
// (gi_cone_wave), which must have the same tan and first.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define GI_BUILD
#define GI_WAVE
#include "gi.glsl"
#include "gi_cones.glsl"
layout(local_size_x = 64) in;

float number(uint cone, uint at) { return uintBitsToFloat(gi_accumulators[cone * 12u + at]); }
vec3 numbers(uint cone, uint at) {
    return vec3(number(cone, at), number(cone, at + 1u), number(cone, at + 2u));
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= gi_flow.counts.z) return;
    vec4 light;
    vec2 more;
    if (GI_STEP == 2u) {
        GiCone cone = gi_cone_wave(numbers(i, 0u), numbers(i, 4u), number(i, 3u), number(i, 7u),
                                   number(i, 8u));
        light = cone.light;
        more = vec2(cone.occlusion, cone.steps);
    } else if (GI_STEP == 0u) {
        bool has_thirds = GI_MIPS == GI_READ_THIRDS && abs(number(i, 3u) - 0.57735) < 1e-4;
        GiCone cone = gi_cone(numbers(i, 0u), numbers(i, 4u), number(i, 3u), number(i, 7u),
                              number(i, 8u), has_thirds);
        light = cone.light;
        more = vec2(cone.occlusion, cone.steps);
    } else {
        GiHemisphere sum = gi_hemisphere(numbers(i, 0u), numbers(i, 4u), vec2(0.0), GI_START, gi_reach(), 6u,
                                         vec3(1.0), vec3(0.25));
        light = vec4(sum.light, sum.visibility);
        more = vec2(0.0, sum.steps);
    }
    for (uint k = 0u; k < 4u; k++) gi_radiance[i * 8u + k] = floatBitsToUint(light[k]);
    for (uint k = 0u; k < 2u; k++) gi_radiance[i * 8u + 4u + k] = floatBitsToUint(more[k]);
}
