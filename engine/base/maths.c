// maths.c: matrices (cglm's where it has them) and the deterministic functions.
// Data in, data out: values; no state. Called by: everybody, from any thread. Does not: depend on
// libm, on the rounding of a particular compiler, or on -march (built with -ffp-contract=off).
//
// det_*: each works in f64 with + - * / sqrt only, on an argument that is exact in f64, and rounds
// once to f32 at the end. The f64 result is good to 1e-12 or better (bounds at each function), so
// the f32 result is the correctly rounded one except where the true value lies within 1e-12 of a
// tie: the error is below 0.5001 ulp everywhere, subnormal results included. The polynomials are
// plain Taylor series, long enough for their interval: the coefficients explain themselves, and
// their few extra terms cost less than a cache miss.
#include "maths.h"
#include <float.h>
#include <string.h>

// cglm's type vec3 and our function vec3 share a name.
#define CGLM_ALL_UNALIGNED
#define vec3 cglm_vec3
#include <cglm/mat4.h>
#include <cglm/clipspace/ortho_rh_zo.h>
#undef vec3

#define PI_F64  3.141592653589793238
#define LN2_F64 0.693147180559945309
#define DEG_F64 (PI_F64 / 180.0)

// c[0] + c[1] x + c[2] x^2 ... by Horner's rule, written so that it unrolls.
static inline f64 horner(const f64 *c, u32 count, f64 x) {
    f64 sum = c[count - 1];
    for (u32 i = count - 1; i-- > 0;) sum = sum * x + c[i];
    return sum;
}

static f64 f64_from_bits(u64 bits) {
    f64 x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static u64 f64_bits(f64 x) {
    u64 bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

// Rounds to the nearest integer, ties to even, for |x| < 2^51: adding 1.5 * 2^52 leaves no bits
// for a fraction. (-ffast-math would remove it; the build has none.)
static inline f64 round_f64(f64 x) {
    const f64 magic = 6755399441055744.0;
    return (x + magic) - magic;
}

#define FLT_ROUND_UP 0x1.ffffffp127 // half an ulp above FLT_MAX: a tie, and ties go to even

// f64 to f32 where the value may be out of range, which a plain cast leaves undefined in C.
static inline f32 narrow(f64 x) {
    if (x > FLT_MAX) return x >= FLT_ROUND_UP ? INFINITY : FLT_MAX;
    if (x < -FLT_MAX) return x <= -FLT_ROUND_UP ? -INFINITY : -FLT_MAX;
    return (f32)x;
}

// ---- sine and cosine ----

typedef struct SinCos {
    f64 sin, cos;
} SinCos;

// |r| <= pi/4, relative error below 1e-16: the first term left out is r^17/17! (5e-17) and
// r^18/18! (2e-18).
static SinCos sin_cos_kernel(f64 r) {
    static const f64 s[] = {
        1.0,          -1.0 / 6,          1.0 / 120,          -1.0 / 5040,
        1.0 / 362880, -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0};
    static const f64 c[] = {1.0,
                            -1.0 / 2,
                            1.0 / 24,
                            -1.0 / 720,
                            1.0 / 40320,
                            -1.0 / 3628800.0,
                            1.0 / 479001600.0,
                            -1.0 / 87178291200.0,
                            1.0 / 20922789888000.0};
    f64 r2 = r * r;
    return (SinCos){r * horner(s, COUNT_OF(s), r2), horner(c, COUNT_OF(c), r2)};
}

// The kernel's angle plus `quarters` right angles.
static SinCos sin_cos_turn(SinCos k, i64 quarters) {
    switch (quarters & 3) {
    case 0:
        return k;
    case 1:
        return (SinCos){k.cos, -k.sin};
    case 2:
        return (SinCos){-k.sin, -k.cos};
    default:
        return (SinCos){-k.cos, k.sin};
    }
}

// Cody-Waite: pi/2 = hi + lo, hi with 33 bits, so n * hi is exact for n < 2^20 and x - n * hi
// loses nothing. No f32 below 1e5 comes nearer than 1e-9 to a multiple of pi/2, so the error of
// n * lo (2^-53 * 4e-6) stays below 1e-12 of the result. Beyond 1e5 the angle loses meaning bit
// by bit (an ulp of x is then 0.4 degrees and more); beyond 1e9, and for infinities, it is 0.
static SinCos sin_cos_rad(f64 x) {
    if (!(x > -1e9 && x < 1e9)) return (SinCos){x != x ? x : 0.0, x != x ? x : 1.0};
    const f64 pi_2_hi = 1.57079632673412561417, pi_2_lo = 6.07710050650619224932e-11;
    f64 n = round_f64(x * (2.0 / PI_F64));
    return sin_cos_turn(sin_cos_kernel((x - n * pi_2_hi) - n * pi_2_lo), (i64)n);
}

// Degrees are reduced exactly (90 n and the difference are exact in f64), so that multiples of 90
// give exact zeros and ones: a wall turned by 90 degrees stays on its grid.
static SinCos sin_cos_deg(f64 x) {
    if (!(x > -1e9 && x < 1e9)) return (SinCos){x != x ? x : 0.0, x != x ? x : 1.0};
    f64 n = round_f64(x * (1.0 / 90.0));
    return sin_cos_turn(sin_cos_kernel((x - n * 90.0) * DEG_F64), (i64)n);
}

f32 det_sin(f32 x_rad) { return x_rad == 0.0f ? x_rad : (f32)sin_cos_rad(x_rad).sin; } // keeps -0
f32 det_cos(f32 x_rad) { return (f32)sin_cos_rad(x_rad).cos; }
f32 det_tan(f32 x_rad) {
    if (x_rad == 0.0f) return x_rad;
    SinCos k = sin_cos_rad(x_rad);
    return narrow(k.sin / k.cos);
}

// ---- exponential and logarithm ----

// For |x| <= 745: error below 1e-14 relative. x = k ln2 + r with |r| <= 0.347; the series ends at
// r^13/13!, what is left out is below 5e-18. The error of k * ln2 (one rounding of a value up to
// 150) dominates: 150 * 2^-53.
static f64 exp_f64(f64 x) {
    static const f64 c[] = {1.0,
                            1.0,
                            1.0 / 2,
                            1.0 / 6,
                            1.0 / 24,
                            1.0 / 120,
                            1.0 / 720,
                            1.0 / 5040,
                            1.0 / 40320,
                            1.0 / 362880,
                            1.0 / 3628800.0,
                            1.0 / 39916800.0,
                            1.0 / 479001600.0,
                            1.0 / 6227020800.0};
    if (x != x) return x;
    // Outside of what an f32 can hold, with room to round: exp(89) > FLT_MAX, exp(-105) < 2^-150.
    if (x > 89.0) return INFINITY;
    if (x < -105.0) return 0.0;
    f64 k = round_f64(x * (1.0 / LN2_F64));
    f64 r = x - k * LN2_F64;
    f64 scale = f64_from_bits((u64)((i64)k + 1023) << 52); // 2^k: |k| <= 152, never subnormal
    return horner(c, COUNT_OF(c), r) * scale;
}

// x > 0, finite: error below 3e-16 relative. x = 2^e m, m in [sqrt 1/2, sqrt 2);
// log m = 2 atanh((m - 1) / (m + 1)), series in s^2 <= 0.0295; left out: s^20/21 = 2e-17.
static f64 log_f64(f64 x) {
    static const f64 c[] = {1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,
                            1.0 / 11, 1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19};
    u64 bits = f64_bits(x);
    i64 e = (i64)(bits >> 52) - 1023; // an f32 is never subnormal as f64
    f64 m = f64_from_bits((bits & 0xFFFFFFFFFFFFFull) | 0x3FF0000000000000ull);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        e++;
    }
    f64 s = (m - 1.0) / (m + 1.0);
    return (f64)e * LN2_F64 + 2.0 * s * horner(c, COUNT_OF(c), s * s);
}

f32 det_exp(f32 x) { return narrow(exp_f64(x)); }

f32 det_log(f32 x) {
    if (x != x || x == INFINITY) return x;
    if (x <= 0.0f) return x == 0.0f ? -INFINITY : NAN;
    return (f32)log_f64(x);
}

// x^y for x >= 0 in f64; |y log x| <= 105 where the result is finite, so the relative error is
// below 105 * 4e-16 = 5e-14. pow(x, 0) = pow(1, y) = 1, also for NaN, as in libm.
static f64 pow_f64(f64 x, f64 y) {
    if (y == 0.0 || x == 1.0) return 1.0;
    if (x != x || y != y || x < 0.0) return NAN;
    if (x == 0.0) return y > 0.0 ? 0.0 : INFINITY;
    return exp_f64(y * (x == INFINITY ? x : log_f64(x)));
}

f32 det_pow(f32 x, f32 y) { return narrow(pow_f64(x, y)); }

// ---- inverse trigonometry ----

// 0 <= t <= 1: error below 1e-15. Above tan(pi/8), atan t = pi/4 + atan((t - 1) / (t + 1)); then
// |u| <= 0.4143 and the series in u^2 <= 0.1716 leaves out u^38/39 = 7e-17.
static f64 atan_f64(f64 t) {
    static const f64 c[] = {1.0,       -1.0 / 3,  1.0 / 5,   -1.0 / 7,  1.0 / 9,
                            -1.0 / 11, 1.0 / 13,  -1.0 / 15, 1.0 / 17,  -1.0 / 19,
                            1.0 / 21,  -1.0 / 23, 1.0 / 25,  -1.0 / 27, 1.0 / 29,
                            -1.0 / 31, 1.0 / 33,  -1.0 / 35, 1.0 / 37};
    bool high = t > 0.41421356237309503;
    f64 u = high ? (t - 1.0) / (t + 1.0) : t;
    f64 angle = u * horner(c, COUNT_OF(c), u * u);
    return high ? PI_F64 / 4.0 + angle : angle;
}

// Signs of zeros and quadrants as libm's atan2; infinities count as equal to each other.
static f64 atan2_f64(f64 y, f64 x) {
    if (x != x || y != y) return NAN;
    f64 ax = fabs(x), ay = fabs(y), angle;
    if (ax == INFINITY || ay == INFINITY) {
        ax = ax == INFINITY ? 1.0 : 0.0;
        ay = ay == INFINITY ? 1.0 : 0.0;
    }
    if (ax == 0.0 && ay == 0.0)
        angle = 0.0;
    else
        angle = ay <= ax ? atan_f64(ay / ax) : PI_F64 / 2.0 - atan_f64(ax / ay);
    if (signbit(x)) angle = PI_F64 - angle;
    return signbit(y) ? -angle : angle;
}

f32 det_atan2(f32 y, f32 x) { return narrow(atan2_f64(y, x)); }

// NaN outside -1..1. (1 - x)(1 + x) is exact to one rounding where 1 - x * x would cancel.
f32 det_asin(f32 x) {
    if (!(x >= -1.0f && x <= 1.0f)) return NAN;
    return (f32)atan2_f64(x, sqrt((1.0 - (f64)x) * (1.0 + (f64)x)));
}

// ---- 4x4 matrices: cglm's, on our plain storage ----

_Static_assert(FLT_EVAL_METHOD == 0, "f32 arithmetic must round to f32 at every step");
_Static_assert(sizeof(Mat4) == sizeof(f32[4][4]), "Mat4 is cglm's mat4");
#define CGLM(matrix) ((cglm_vec4 *)(matrix).m)
typedef f32 cglm_vec4[4];

Mat4 mat4_identity(void) { return (Mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}; }

Mat4 mat4_mul(Mat4 a, Mat4 b) {
    Mat4 out;
    glm_mat4_mul(CGLM(a), CGLM(b), CGLM(out));
    return out;
}

Mat4 mat4_inverse(Mat4 a) {
    Mat4 out;
    glm_mat4_inv(CGLM(a), CGLM(out)); // the exact division one, not _fast
    return out;
}

Mat4 mat4_transpose(Mat4 a) {
    Mat4 out;
    glm_mat4_transpose_to(CGLM(a), CGLM(out));
    return out;
}

Vec4 mat4_mul_vec4(Mat4 a, Vec4 v) {
    f32 in[4] = {v.x, v.y, v.z, v.w}, out[4];
    glm_mat4_mulv(CGLM(a), in, out);
    return (Vec4){out[0], out[1], out[2], out[3]};
}

// cglm has no infinite reversed form. z_clip = near, w_clip = -z_view, so depth = near / -z_view
// (Reed, "Depth precision visualized", 2015: with float depth the relative error is nearly the
// same everywhere). y points up in clip space; the renderer flips it with a negative viewport
// height.
Mat4 mat4_perspective_reversed(f32 fov_y_rad, f32 aspect, f32 near) {
    f32 focal = 1.0f / det_tan(fov_y_rad * 0.5f);
    Mat4 out = {{0}};
    out.m[0] = focal / aspect;
    out.m[5] = focal;
    out.m[11] = -1.0f;
    out.m[14] = near;
    return out;
}

// Reversed by handing near and far over in exchange.
Mat4 mat4_ortho_reversed(f32 left, f32 right, f32 bottom, f32 top, f32 near, f32 far) {
    Mat4 out;
    glm_ortho_rh_zo(left, right, bottom, top, far, near, CGLM(out));
    return out;
}

// ---- affine 3x4 matrices, row-major ----

Mat34 mat34_identity(void) { return (Mat34){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}; }

Mat34 mat34_mul(Mat34 a, Mat34 b) {
    Mat34 out;
    for (u32 row = 0; row < 3; row++) {
        const f32 *r = a.m + row * 4;
        for (u32 column = 0; column < 4; column++)
            out.m[row * 4 + column] =
                r[0] * b.m[column] + r[1] * b.m[4 + column] + r[2] * b.m[8 + column];
        out.m[row * 4 + 3] += r[3];
    }
    return out;
}

Mat34 mat34_from_trs(Vec3 position, Vec3 rotation_deg, Vec3 scale) {
    SinCos x = sin_cos_deg(rotation_deg.x), y = sin_cos_deg(rotation_deg.y);
    SinCos z = sin_cos_deg(rotation_deg.z);
    // Ry * Rx * Rz, each column times its scale; f64 until the last step.
    f64 r[9] = {
        y.cos * z.cos + y.sin * x.sin * z.sin,
        -y.cos * z.sin + y.sin * x.sin * z.cos,
        y.sin * x.cos,
        x.cos * z.sin,
        x.cos * z.cos,
        -x.sin,
        -y.sin * z.cos + y.cos * x.sin * z.sin,
        y.sin * z.sin + y.cos * x.sin * z.cos,
        y.cos * x.cos,
    };
    f64 s[3] = {scale.x, scale.y, scale.z};
    Mat34 out;
    for (u32 row = 0; row < 3; row++)
        for (u32 column = 0; column < 3; column++)
            out.m[row * 4 + column] = narrow(r[row * 3 + column] * s[column]);
    out.m[3] = position.x;
    out.m[7] = position.y;
    out.m[11] = position.z;
    return out;
}

Mat34 mat34_from_columns(const f32 column_major_4x4[16]) {
    Mat34 out;
    for (u32 row = 0; row < 3; row++)
        for (u32 column = 0; column < 4; column++)
            out.m[row * 4 + column] = column_major_4x4[column * 4 + row];
    return out;
}

Mat4 mat34_to_mat4(Mat34 a) {
    Mat4 out;
    for (u32 column = 0; column < 4; column++) {
        for (u32 row = 0; row < 3; row++) out.m[column * 4 + row] = a.m[row * 4 + column];
        out.m[column * 4 + 3] = column == 3 ? 1.0f : 0.0f;
    }
    return out;
}

// Cofactors in f64: products of two f32 are exact there, so only the sums round.
Mat34 mat34_inverse(Mat34 a) {
    f64 m[12];
    for (u32 i = 0; i < 12; i++) m[i] = a.m[i];
    f64 c[9] = {
        m[5] * m[10] - m[6] * m[9], m[2] * m[9] - m[1] * m[10], m[1] * m[6] - m[2] * m[5],
        m[6] * m[8] - m[4] * m[10], m[0] * m[10] - m[2] * m[8], m[2] * m[4] - m[0] * m[6],
        m[4] * m[9] - m[5] * m[8],  m[1] * m[8] - m[0] * m[9],  m[0] * m[5] - m[1] * m[4],
    };
    f64 determinant = m[0] * c[0] + m[1] * c[3] + m[2] * c[6];
    Mat34 out;
    for (u32 row = 0; row < 3; row++) {
        f64 *r = c + row * 3;
        for (u32 column = 0; column < 3; column++) r[column] /= determinant;
        f64 t = -(r[0] * m[3] + r[1] * m[7] + r[2] * m[11]);
        f64 values[4] = {r[0], r[1], r[2], t};
        for (u32 column = 0; column < 4; column++) {
            // Catches a determinant of zero (0/0, x/0), NaN input, and an inverse beyond f32.
            if (!(fabs(values[column]) <= FLT_MAX)) return mat34_identity();
            out.m[row * 4 + column] = (f32)values[column];
        }
    }
    return out;
}

Vec3 mat34_point(const Mat34 *a, Vec3 p) {
    return vec3_add(mat34_vector(a, p), mat34_translation(a));
}

Vec3 mat34_vector(const Mat34 *a, Vec3 v) {
    const f32 *m = a->m;
    return (Vec3){m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
                  m[8] * v.x + m[9] * v.y + m[10] * v.z};
}

static Vec3 mat34_basis(const Mat34 *a, u32 column) {
    return (Vec3){a->m[column], a->m[4 + column], a->m[8 + column]};
}

f32 mat34_max_scale(const Mat34 *a) {
    f32 x = vec3_length(mat34_basis(a, 0)), y = vec3_length(mat34_basis(a, 1));
    f32 z = vec3_length(mat34_basis(a, 2));
    return MAX(x, MAX(y, z));
}

// With R = Ry Rx Rz: R12 = -sin x; (R02, R22) = cos x (sin y, cos y);
// (R10, R11) = cos x (sin z, cos z). A mirrored matrix (negative determinant) is read as one whose
// x scale is negative. Looking straight up or down (cos x = 0) only y +- z is defined: z is taken
// as 0.
Vec3 mat34_rotation_deg(const Mat34 *a) {
    Vec3 x = vec3_normalize(mat34_basis(a, 0)), y = vec3_normalize(mat34_basis(a, 1));
    Vec3 z = vec3_normalize(mat34_basis(a, 2));
    if (vec3_dot(vec3_cross(x, y), z) < 0.0f) x = vec3_scale(x, -1.0f);
    f64 cos_pitch = sqrt((f64)x.y * x.y + (f64)y.y * y.y), yaw, roll;
    f64 pitch = atan2_f64(-(f64)z.y, cos_pitch);
    if (cos_pitch > 1e-6) {
        yaw = atan2_f64(z.x, z.z);
        roll = atan2_f64(x.y, y.y);
    } else {
        yaw = atan2_f64(-(f64)x.z, x.x);
        roll = 0.0;
    }
    return (Vec3){(f32)(pitch / DEG_F64), (f32)(yaw / DEG_F64), (f32)(roll / DEG_F64)};
}

// ---- sRGB ----

f32 srgb_to_linear(f32 encoded) {
    f64 e = encoded;
    return (f32)(e <= 0.04045 ? e / 12.92 : pow_f64((e + 0.055) / 1.055, 2.4));
}

f32 linear_to_srgb(f32 linear) {
    f64 l = linear;
    return (f32)(l <= 0.0031308 ? l * 12.92 : 1.055 * pow_f64(l, 1.0 / 2.4) - 0.055);
}
