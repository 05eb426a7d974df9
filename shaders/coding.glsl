// coding.glsl: numbers in few bits and back; what the layouts of gbuffer.glsl are made of. Pure
// functions of their arguments, so that tests run them through real targets (tests/gpu/coding.c).
//
// An 8-bit UNORM target stores floor(v * 255 + 0.5) and gives back byte / 255.
#ifndef CODING_GLSL
#define CODING_GLSL

// --- Unit vectors ---

// Octahedral coding of unit vectors (Cigolle et al. 2014), components in [-1, 1].
vec2 oct_encode(vec3 n) {
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    return n.z < 0.0 ? folded : p;
}
vec3 oct_decode(vec2 e) {
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float t = max(-n.z, 0.0);
    n.x += n.x >= 0.0 ? -t : t;
    n.y += n.y >= 0.0 ? -t : t;
    return normalize(n);
}

// z of a unit vector that points to the eye, from x and y (Puig 2006, chapter 3). Interpolated and
// mapped normals can point a little away from the eye: those come back mirrored.
float facing_z(vec2 xy) { return sqrt(max(1.0 - dot(xy, xy), 0.0)); }
vec3 facing_decode(vec2 xy, float z) { return normalize(vec3(xy, max(z, 1e-4))); }

// --- Signed numbers in a byte: bytes 1..255, 128 is 0 exactly ---

vec2 signed8_encode(vec2 v) { return (clamp(v, vec2(-1.0), vec2(1.0)) * 127.0 + 128.0) / 255.0; }
vec2 signed8_decode(vec2 t) { return t * (255.0 / 127.0) - 128.0 / 127.0; }

// --- Distance from the eye in bytes (Puig 2006, chapter 3) ---
// The source: q = d / 4 m, one byte floor(q), one byte frac(q), for d up to 1,000 m. Here q counts
// 256ths of `reach`, a power of two: with 1,024 m these are the source's 4 m. Decoding takes the
// middle of the step, so it is off by reach / 2^17 at most (source: 7.8 mm of the allowed 15.6).

vec2 distance16_encode(float d, float reach) {
    float q = clamp(d / reach, 0.0, 65535.0 / 65536.0) * 256.0;
    return vec2(floor(q), floor(fract(q) * 256.0)) / 255.0;
}
float distance16_decode(vec2 t, float reach) {
    vec2 bytes = floor(t * 255.0 + 0.5);
    return (bytes.x * 256.0 + bytes.y + 0.5) * (reach / 65536.0);
}
vec3 distance24_encode(float d, float reach) {
    float q = clamp(d / reach, 0.0, 16777215.0 / 16777216.0) * 256.0;
    float r = fract(q) * 256.0;
    return vec3(floor(q), floor(r), floor(fract(r) * 256.0)) / 255.0;
}
float distance24_decode(vec3 t, float reach) {
    vec3 bytes = floor(t * 255.0 + 0.5);
    return ((bytes.x * 65536.0 + bytes.y * 256.0) + bytes.z) * (reach / 16777216.0);
}

// --- Oren-Nayar pair in one float: C = 10 A' + B, A' a whole step 0..9, B in [0, 1) ---
// A lies in (0.5, 1]: the steps divide that, the last one is Lambert's 1.

float oren_nayar_encode(vec2 ab) {
    float a = clamp(floor((ab.x - 0.5) * 18.0 + 0.5), 0.0, 9.0);
    return a * 10.0 + clamp(ab.y, 0.0, 0.9999);
}
vec2 oren_nayar_decode(float c) {
    float a = floor(c / 10.0);
    return vec2(a / 18.0 + 0.5, c - a * 10.0);
}

// --- Light and attributes in bytes ---

// Radiance: alpha holds the largest channel in twelfths of an octave (2^-13 to 2^8), rgb the roots
// of the shares of it.
vec4 light8_encode(vec3 c) {
    float largest = max(c.r, max(c.g, c.b));
    if (!(largest > 1e-4)) return vec4(0.0);
    float code = clamp(ceil(log2(largest) * 12.0 + 160.0), 1.0, 255.0);
    float scale = exp2((160.0 - code) / 12.0);
    return vec4(sqrt(clamp(c * scale, vec3(0.0), vec3(1.0))), code / 255.0);
}
vec3 light8_decode(vec4 t) {
    float code = floor(t.a * 255.0 + 0.5);
    return code > 0.0 ? t.rgb * t.rgb * exp2((code - 160.0) / 12.0) : vec3(0.0);
}

// Albedo 0..1 by its root, about as fine as the sRGB curve: drawing into a target whose format is
// sRGB was a quarter of the software driver's instructions for a G-buffer.
vec3 albedo8_encode(vec3 albedo) { return sqrt(max(albedo, vec3(0.0))); }
vec3 albedo8_decode(vec3 t) { return t * t; }

// Specular power 1..2048 on a logarithmic scale, bytes 1..255 (0 is left to the caller).
float power8_encode(float power) {
    return (1.0 + 254.0 / 11.0 * log2(clamp(power, 1.0, 2048.0))) / 255.0;
}
float power8_decode(float t) { return exp2((floor(t * 255.0 + 0.5) - 1.0) * (11.0 / 254.0)); }

// Motion in shares of the picture, finer near 0.
vec2 motion8_encode(vec2 m) { return signed8_encode(sign(m) * sqrt(min(abs(m), vec2(1.0)))); }
vec2 motion8_decode(vec2 t) {
    vec2 r = signed8_decode(t);
    return r * abs(r);
}
#endif
