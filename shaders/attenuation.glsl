// attenuation.glsl: how a light's power falls off with distance and across a spot's cone. One place
// for surfaces and voxels, so that both see the same light.
// The includer declares ATTENUATION (SPEC_ATTENUATION) first.
#ifndef ATTENUATION_GLSL
#define ATTENUATION_GLSL

// From the squared distance, its inverse square root, d2 / range^2, and the polynomial's
// coefficients (FrameRecord.attenuation).
float attenuation_exact(float d2, float inv_d, float x, vec3 k) {
    if (ATTENUATION == 1u) return clamp(1.0 - x, 0.0, 1.0);
    if (ATTENUATION == 2u) return clamp(1.0 - x, 0.0, 1.0) / (k.x + k.y * (d2 * inv_d) + k.z * d2);
    float window = clamp(1.0 - x * x, 0.0, 1.0);
    return window * window * min(inv_d * inv_d, 1e4); // 1 / max(d, 1 cm)^2
}

// Share of a spot's light in direction -l. direction: unit, w cos outer; edge: 1 / (cos inner -
// cos outer).
float spot_cone(vec3 l, vec4 direction, float edge) {
    float t = clamp((-dot(l, direction.xyz) - direction.w) * edge, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
#endif
