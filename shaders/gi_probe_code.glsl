// gi_probe_code.glsl: 15 bits in the alpha of a probe's texel, a half float: two distances and an
// openness of 5 bits each. Any 15 bits are a half float that is neither tiny nor infinite: 10 bits of
// fraction, 4 of the exponent (1..16), the sign. Such texels must be fetched, not filtered.
#ifndef GI_PROBE_CODE_GLSL
#define GI_PROBE_CODE_GLSL

const float GI_PROBE_REACH = 1.5; // spacings; a distance of so much or more is free

const float GI_PROBE_STEP = GI_PROBE_REACH / 31.0;

// up, down: spacings; open: 0..1. Distances are rounded down, 31 is free, 0 is in a wall.
float gi_probe_code(float up, float down, float open) {
    uvec2 ways = uvec2(clamp(vec2(up, down) * (1.0 / GI_PROBE_STEP) + 1e-3, vec2(0.0), vec2(31.0)));
    uint code = ways.x | ways.y << 5 | uint(clamp(open, 0.0, 1.0) * 31.0 + 0.5) << 10;
    uint half_bits = (code & 1023u) | ((code >> 10 & 15u) + 1u) << 10 | (code >> 14) << 15;
    return unpackHalf2x16(half_bits).x;
}
struct GiProbeCode {
    float up, down, open;
};
GiProbeCode gi_probe_decode(float a) {
    uint bits = packHalf2x16(vec2(a, 0.0));
    uint code = (bits & 1023u) | ((bits >> 10 & 31u) - 1u) << 10 | (bits >> 15 & 1u) << 14;
    vec2 ways = vec2(code & 31u, code >> 5 & 31u) * GI_PROBE_STEP;
    ways = mix(ways, vec2(1e9), equal(uvec2(code & 31u, code >> 5 & 31u), uvec2(31u)));
    return GiProbeCode(ways.x, ways.y, float(code >> 10 & 31u) * (1.0 / 31.0));
}
#endif
