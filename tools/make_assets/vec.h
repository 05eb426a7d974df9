// Small vectors and matrices for the asset generator, all inline.
//
// Data in, data out: values. Called by every file of this tool. It does not share code with the
// engine on purpose: the generator compiles alone, so that a level's models can be rebuilt
// without a GPU, a library or the engine.
#ifndef MAKE_ASSETS_VEC_H
#define MAKE_ASSETS_VEC_H

#include <math.h>

#define PI_F 3.14159265358979f

typedef struct Vec2 {
    float x, y;
} Vec2;

typedef struct Vec3 {
    float x, y, z;
} Vec3;

// Affine transform: three columns and a translation; the last row is always 0 0 0 1.
typedef struct Affine {
    Vec3 x, y, z, t;
} Affine;

static inline Vec2 vec2(float x, float y) { return (Vec2){x, y}; }
static inline Vec3 vec3(float x, float y, float z) { return (Vec3){x, y, z}; }
static inline Vec3 vec3_add(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec3 vec3_sub(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec3 vec3_scale(Vec3 a, float s) { return vec3(a.x * s, a.y * s, a.z * s); }
static inline Vec3 vec3_mad(Vec3 a, Vec3 b, float s) { return vec3_add(a, vec3_scale(b, s)); }
static inline float vec3_dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec3 vec3_cross(Vec3 a, Vec3 b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float vec3_length(Vec3 a) { return sqrtf(vec3_dot(a, a)); }
static inline Vec3 vec3_lerp(Vec3 a, Vec3 b, float t) { return vec3_mad(a, vec3_sub(b, a), t); }

// The zero vector stays zero: callers use that to recognise degenerate triangles.
static inline Vec3 vec3_normalize(Vec3 a) {
    float l = vec3_length(a);
    return l > 1e-12f ? vec3_scale(a, 1.0f / l) : vec3(0, 0, 0);
}

static inline float float_clamp(float v, float lo, float hi) {
    return v < lo ? lo : (v > hi ? hi : v);
}
static inline float float_lerp(float a, float b, float t) { return a + (b - a) * t; }
static inline float float_smooth(float lo, float hi, float v) {
    float t = float_clamp((v - lo) / (hi - lo), 0, 1);
    return t * t * (3 - 2 * t);
}

static inline Affine affine_identity(void) {
    return (Affine){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
}
static inline Vec3 affine_vector(const Affine *a, Vec3 v) {
    return vec3_add(vec3_scale(a->x, v.x), vec3_add(vec3_scale(a->y, v.y), vec3_scale(a->z, v.z)));
}
static inline Vec3 affine_point(const Affine *a, Vec3 p) {
    return vec3_add(affine_vector(a, p), a->t);
}
static inline Affine affine_mul(const Affine *a, const Affine *b) {
    return (Affine){affine_vector(a, b->x), affine_vector(a, b->y), affine_vector(a, b->z),
                    affine_point(a, b->t)};
}
static inline Affine affine_translation(float x, float y, float z) {
    Affine a = affine_identity();
    a.t = vec3(x, y, z);
    return a;
}
static inline Affine affine_scaling(float x, float y, float z) {
    return (Affine){{x, 0, 0}, {0, y, 0}, {0, 0, z}, {0, 0, 0}};
}
// Right-handed turn about +y: a quarter turn takes +z to +x.
static inline Affine affine_turn_y(float degrees) {
    float r = degrees * PI_F / 180, c = cosf(r), s = sinf(r);
    return (Affine){{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {0, 0, 0}};
}
static inline Affine affine_turn_x(float degrees) {
    float r = degrees * PI_F / 180, c = cosf(r), s = sinf(r);
    return (Affine){{1, 0, 0}, {0, c, s}, {0, -s, c}, {0, 0, 0}};
}
static inline Affine affine_turn_z(float degrees) {
    float r = degrees * PI_F / 180, c = cosf(r), s = sinf(r);
    return (Affine){{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {0, 0, 0}};
}
static inline float affine_determinant(const Affine *a) {
    return vec3_dot(a->x, vec3_cross(a->y, a->z));
}

#endif
