// maths.h: vectors, matrices and the deterministic functions of the simulation.
//
// Storage is plain float (no library type is ever stored). Matrix work is cglm's (maths.c), with
// its conventions named in base.h. det_* are the engine's own sin/cos/exp/...: only + - * / sqrt
// and integer operations, so every build of every machine gives the same bits (design: IEEE
// exact operations; -ffp-contract=off).
#ifndef LUZ_MATHS_H
#define LUZ_MATHS_H
#include "base.h"
#include <math.h>
#ifdef __cplusplus
extern "C" {
#endif

#define PI_F          3.14159265358979323846f
#define DEG_TO_RAD(d) ((d) * (PI_F / 180.0f))

typedef struct Vec2 { f32 x, y; } Vec2;
typedef struct Vec3 { f32 x, y, z; } Vec3;
typedef struct Vec4 { f32 x, y, z, w; } Vec4;
// Column-major: m[column * 4 + row].
typedef struct Mat4 { f32 m[16]; } Mat4;
// Affine 3x4, row-major: m[row * 4 + column]; the fourth row (0 0 0 1) is understood. This is
// the form that columns, packets and shaders share (three vec4 rows).
typedef struct Mat34 { f32 m[12]; } Mat34;

static inline Vec3 vec3(f32 x, f32 y, f32 z) { return (Vec3){x, y, z}; }
static inline Vec3 vec3_add(Vec3 a, Vec3 b) { return (Vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline Vec3 vec3_sub(Vec3 a, Vec3 b) { return (Vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vec3 vec3_scale(Vec3 a, f32 s) { return (Vec3){a.x * s, a.y * s, a.z * s}; }
static inline f32 vec3_dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec3 vec3_cross(Vec3 a, Vec3 b) {
    return (Vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline f32 vec3_length(Vec3 a) { return sqrtf(vec3_dot(a, a)); }
// Zero stays zero.
static inline Vec3 vec3_normalize(Vec3 a) {
    f32 length = vec3_length(a);
    return length > 0.0f ? vec3_scale(a, 1.0f / length) : a;
}
static inline f32 f32_lerp(f32 a, f32 b, f32 t) { return a + (b - a) * t; }
static inline f32 f32_saturate(f32 x) { return CLAMP(x, 0.0f, 1.0f); }
static inline f32 f32_smoothstep(f32 lo, f32 hi, f32 x) {
    f32 t = f32_saturate((x - lo) / (hi - lo));
    return t * t * (3.0f - 2.0f * t);
}

// Deterministic functions. Max error in ulp of float is stated in maths.c and tested.
f32 det_sin(f32 x_rad); // any |x| < 1e5
f32 det_cos(f32 x_rad);
f32 det_tan(f32 x_rad); // |x| < pi/2
f32 det_exp(f32 x);
f32 det_log(f32 x); // x > 0
f32 det_pow(f32 x, f32 y); // x >= 0
f32 det_atan2(f32 y, f32 x);
f32 det_asin(f32 x);

Mat4 mat4_identity(void);
Mat4 mat4_mul(Mat4 a, Mat4 b); // a * b
Mat4 mat4_inverse(Mat4 a);
Mat4 mat4_transpose(Mat4 a);
// Reversed depth 0..1 with an infinite far plane: near plane -> 1, infinity -> 0. aspect = w / h.
Mat4 mat4_perspective_reversed(f32 fov_y_rad, f32 aspect, f32 near);
// Orthographic box, reversed depth: z = -near -> 1, z = -far -> 0.
Mat4 mat4_ortho_reversed(f32 left, f32 right, f32 bottom, f32 top, f32 near, f32 far);
Vec4 mat4_mul_vec4(Mat4 a, Vec4 v);

Mat34 mat34_identity(void);
Mat34 mat34_mul(Mat34 a, Mat34 b); // a * b
// T * Ry * Rx * Rz * S; rotation in degrees (pitch x, yaw y, roll z), det_ functions only.
Mat34 mat34_from_trs(Vec3 position, Vec3 rotation_deg, Vec3 scale);
Mat34 mat34_from_columns(const f32 column_major_4x4[16]);
Mat4 mat34_to_mat4(Mat34 a);
// Inverse of any non-singular affine matrix; a singular one gives the identity.
Mat34 mat34_inverse(Mat34 a);
Vec3 mat34_point(const Mat34 *a, Vec3 p);
Vec3 mat34_vector(const Mat34 *a, Vec3 v);
static inline Vec3 mat34_translation(const Mat34 *a) { return (Vec3){a->m[3], a->m[7], a->m[11]}; }
// Largest length of a basis vector: how much a sphere's radius grows.
f32 mat34_max_scale(const Mat34 *a);
// Pitch/yaw/roll in degrees of the rotation part (columns normalised), inverse of from_trs.
Vec3 mat34_rotation_deg(const Mat34 *a);

// sRGB transfer function (exact piecewise form, IEC 61966-2-1), for values in 0..1.
f32 srgb_to_linear(f32 encoded);
f32 linear_to_srgb(f32 linear);

#ifdef __cplusplus
}
#endif
#endif
