// base_maths.c: det_* against libm to a fraction of an ulp, matrices against GLM, roundtrips.
#include "../test.h"
#include "../../engine/base/maths.h"
#include "../../engine/base/random.h"
#include "maths_glm.h"
#include <float.h>
#include <stdlib.h>
#include <string.h>

// ---- det_* ----

static f32 f32_from_bits(u32 bits) {
    f32 x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

// Distance of `got` from the true value in units of the last place of an f32 near it.
static f64 ulps(f32 got, f64 want) {
    if (isnan(want)) return isnan(got) ? 0 : INFINITY;
    if (fabs(want) >= 0x1.ffffffp127) // rounds to infinity
        return got == (want > 0 ? INFINITY : -INFINITY) ? 0 : INFINITY;
    int exponent;
    frexp(want, &exponent); // |want| in [2^(e-1), 2^e)
    return fabs((f64)got - want) / ldexp(1.0, MAX(exponent - 24, -149));
}

#define ULP_BOUND 0.5001 // as maths.c claims
#define SAMPLES   200000

typedef struct Worst {
    f64 ulp;
    f32 x, y;
} Worst;

static void worst_note(Worst *worst, f64 ulp, f32 x, f32 y) {
    if (!(ulp <= worst->ulp)) *worst = (Worst){ulp, x, y};
}

static void worst_check(const Worst *worst, const char *name) {
    if (!(worst->ulp <= ULP_BOUND))
        fail_msg("det_%s(%.9g, %.9g): %.6f ulp", name, worst->x, worst->y, worst->ulp);
}

// Every exponent and sign: bit patterns spread over all finite floats, kept if |x| <= limit.
static f32 any_float(u64 i, f32 limit) {
    for (u64 try = 0;; try++) {
        f32 x = f32_from_bits(random_u32(11, i, try));
        if (fabsf(x) <= limit) return x; // also refuses NaN
    }
}

static void check_unary(f32 (*f)(f32), f64 (*reference)(f64), const char *name, f32 lo, f32 hi) {
    Worst worst = {0};
    for (u64 i = 0; i < SAMPLES; i++) {
        f32 x = i & 1 ? random_range(12, 0, i, lo, hi) : any_float(i, MAX(fabsf(lo), fabsf(hi)));
        if (x < lo || x > hi) x = -x;
        if (x < lo || x > hi) continue;
        worst_note(&worst, ulps(f(x), reference(x)), x, 0);
    }
    worst_check(&worst, name);
}

TEST(maths, det_sin_cos_are_correctly_rounded) {
    check_unary(det_sin, sin, "sin", -1e5f, 1e5f);
    check_unary(det_cos, cos, "cos", -1e5f, 1e5f);
    check_unary(det_sin, sin, "sin", -7.0f, 7.0f);
    check_unary(det_cos, cos, "cos", -7.0f, 7.0f);
    // The floats nearest to multiples of pi/2 cancel most.
    Worst worst = {0};
    for (i32 n = -63661; n <= 63661; n++) {
        f32 x = (f32)(n * 1.57079632679489661923);
        worst_note(&worst, ulps(det_sin(x), sin(x)), x, 0);
        worst_note(&worst, ulps(det_cos(x), cos(x)), x, 0);
    }
    worst_check(&worst, "sin/cos");
}

TEST(maths, det_tan_is_correctly_rounded) {
    check_unary(det_tan, tan, "tan", -1.5707963f, 1.5707963f);
}

TEST(maths, det_exp_log_are_correctly_rounded) {
    check_unary(det_exp, exp, "exp", -110, 100); // beyond both ends: 0, subnormals, infinity
    check_unary(det_log, log, "log", 0, FLT_MAX);
    check_unary(det_log, log, "log", 0.9f, 1.1f);
    check_unary(det_log, log, "log", 0, 1e-38f); // subnormal input
}

TEST(maths, det_pow_is_correctly_rounded) {
    Worst worst = {0};
    for (u64 i = 0; i < SAMPLES; i++) {
        f32 x = fabsf(any_float(i, FLT_MAX)), y = any_float(i + SAMPLES, 1000);
        if (i & 1) x = random_range(13, 0, i, 0, 4), y = random_range(13, 1, i, -20, 20);
        worst_note(&worst, ulps(det_pow(x, y), pow(x, y)), x, y);
    }
    worst_check(&worst, "pow");
}

TEST(maths, det_atan2_asin_are_correctly_rounded) {
    Worst worst = {0};
    for (u64 i = 0; i < SAMPLES; i++) {
        f32 y = any_float(i, FLT_MAX), x = any_float(i + SAMPLES, FLT_MAX);
        if (i & 1) y = random_range(14, 0, i, -2, 2), x = random_range(14, 1, i, -2, 2);
        worst_note(&worst, ulps(det_atan2(y, x), atan2(y, x)), y, x);
    }
    worst_check(&worst, "atan2");
    check_unary(det_asin, asin, "asin", -1, 1);
    check_unary(det_asin, asin, "asin", 0.999f, 1);
}

static void assert_same_bits(f32 got, f32 want) {
    if (isnan(want) && isnan(got)) return;
    assert_memory_equal(&got, &want, sizeof got);
}

TEST(maths, det_functions_at_the_edges) {
    static const f32 values[] = {0.0f,  -0.0f,   1.0f,    -1.0f,    0.5f,
                                 -0.5f, 2.0f,    -3.0f,   INFINITY, -INFINITY,
                                 NAN,   FLT_MIN, FLT_MAX, -FLT_MAX, 0x1p-149f};
    for (u32 i = 0; i < COUNT_OF(values); i++) {
        f32 x = values[i];
        assert_same_bits(det_exp(x), (f32)exp(x));
        assert_same_bits(det_log(x), (f32)log(x));
        assert_same_bits(det_asin(x), (f32)asin(x));
        for (u32 j = 0; j < COUNT_OF(values); j++) {
            f32 y = values[j];
            assert_same_bits(det_atan2(x, y), (f32)atan2(x, y));
            // Not bit for bit: sqrt(FLT_MAX) is nearer to a tie than either pow is exact.
            if (x >= 0 && !signbit(x)) assert_true(ulps(det_pow(x, y), pow(x, y)) <= ULP_BOUND);
        }
    }
    assert_same_bits(det_sin(-0.0f), -0.0f);
    assert_same_bits(det_tan(-0.0f), -0.0f);
    assert_same_bits(det_sin(0x1p-149f), 0x1p-149f);
    // Outside of their domain they stay finite: a NaN would spread through a world.
    assert_same_bits(det_sin(INFINITY), 0);
    assert_same_bits(det_cos(FLT_MAX), 1);
    assert_true(isnan(det_sin(NAN)) && isnan(det_cos(NAN)));
    for (f32 x = 1e5f; x < 1e9f; x *= 1.37f) {
        f32 s = det_sin(x), c = det_cos(x);
        ASSERT_NEAR((f64)s * s + (f64)c * c, 1, 1e-6);
    }
}

// ---- matrices ----

static f32 draw(u64 *counter, f32 lo, f32 hi) { return random_range(21, 0, (*counter)++, lo, hi); }
static Vec3 draw3(u64 *counter, f32 lo, f32 hi) {
    f32 x = draw(counter, lo, hi), y = draw(counter, lo, hi), z = draw(counter, lo, hi);
    return vec3(x, y, z);
}

static void assert_matrices_near(const f32 *a, const f32 *b, u32 count, f64 eps) {
    for (u32 i = 0; i < count; i++) ASSERT_NEAR(a[i], b[i], eps * MAX(1.0, fabs((f64)b[i])));
}

TEST(maths, mat4_agrees_with_glm) {
    u64 counter = 0;
    for (u32 round = 0; round < 500; round++) {
        Mat4 a, b, want;
        for (u32 i = 0; i < 16; i++) {
            a.m[i] = draw(&counter, -2, 2) + (i % 5 == 0 ? 6.0f : 0.0f); // well-conditioned
            b.m[i] = draw(&counter, -2, 2);
        }
        oracle_mul(a.m, b.m, want.m);
        assert_matrices_near(mat4_mul(a, b).m, want.m, 16, 1e-5);
        oracle_transpose(a.m, want.m);
        assert_memory_equal(mat4_transpose(a).m, want.m, sizeof want);
        oracle_inverse(a.m, want.m);
        assert_matrices_near(mat4_inverse(a).m, want.m, 16, 1e-5);
        assert_matrices_near(mat4_mul(a, mat4_inverse(a)).m, mat4_identity().m, 16, 1e-5);
        Vec4 v = {draw(&counter, -1, 1), draw(&counter, -1, 1), draw(&counter, -1, 1), 1}, r;
        f32 v_want[4];
        oracle_mul_vec4(a.m, (const f32 *)&v, v_want);
        r = mat4_mul_vec4(a, v);
        assert_matrices_near((const f32 *)&r, v_want, 4, 1e-5);
    }
}

// depth(reversed) = 1 - depth(plain) for the orthographic box.
TEST(maths, ortho_is_glm_reversed) {
    f32 want[16];
    Mat4 got = mat4_ortho_reversed(-3, 5, -2, 7, 0.5f, 40);
    oracle_ortho(-3, 5, -2, 7, 0.5f, 40, want);
    want[10] = -want[10];
    want[14] = 1 - want[14];
    assert_matrices_near(got.m, want, 16, 1e-6);
    ASSERT_NEAR(mat4_mul_vec4(got, (Vec4){0, 0, -0.5f, 1}).z, 1, 1e-6);
    ASSERT_NEAR(mat4_mul_vec4(got, (Vec4){0, 0, -40, 1}).z, 0, 1e-6);
    ASSERT_NEAR(mat4_mul_vec4(got, (Vec4){5, 7, -1, 1}).x, 1, 1e-6);
    ASSERT_NEAR(mat4_mul_vec4(got, (Vec4){5, 7, -1, 1}).y, 1, 1e-6); // y up
}

TEST(maths, perspective_is_glm_reversed_with_the_far_plane_at_infinity) {
    f32 want[16], fov = DEG_TO_RAD(70), aspect = 16.0f / 9, near = 0.1f;
    Mat4 got = mat4_perspective_reversed(fov, aspect, near);
    oracle_perspective(fov, aspect, near, 1e7f, want);
    for (u64 i = 0; i < 200; i++) {
        Vec4 p = {random_range(3, 0, i, -9, 9), random_range(3, 1, i, -9, 9),
                  -random_range(3, 2, i, 0.1f, 900), 1};
        Vec4 clip = mat4_mul_vec4(got, p);
        f32 plain[4];
        oracle_mul_vec4(want, (const f32 *)&p, plain);
        ASSERT_NEAR(clip.x, plain[0], 1e-5 * MAX(1, fabsf(plain[0])));
        ASSERT_NEAR(clip.y, plain[1], 1e-5 * MAX(1, fabsf(plain[1])));
        ASSERT_NEAR(clip.w, plain[3], 1e-5 * plain[3]);
        ASSERT_NEAR(clip.z / clip.w, 1 - plain[2] / plain[3], 1e-6);
        ASSERT_NEAR(clip.z / clip.w, near / -p.z, 1e-6);
    }
    Vec4 at_near = mat4_mul_vec4(got, (Vec4){0, 0, -near, 1});
    assert_true(at_near.z == at_near.w);
}

TEST(maths, trs_agrees_with_glm) {
    u64 counter = 0;
    for (u32 round = 0; round < 1000; round++) {
        Vec3 position = draw3(&counter, -100, 100), rotation = draw3(&counter, -720, 720);
        Vec3 scale = draw3(&counter, -3, 3);
        f32 want[16];
        oracle_trs((const f32 *)&position, (const f32 *)&rotation, (const f32 *)&scale, want);
        Mat34 got = mat34_from_trs(position, rotation, scale);
        assert_matrices_near(mat34_to_mat4(got).m, want, 16, 1e-6);
        assert_memory_equal(mat34_from_columns(mat34_to_mat4(got).m).m, got.m, sizeof got);
    }
}

TEST(maths, right_angles_are_exact) {
    for (i32 turn = -36000; turn <= 36000; turn += 90) {
        Mat34 m = mat34_from_trs(vec3(0, 0, 0), vec3(0, (f32)turn, 0), vec3(1, 1, 1));
        for (u32 i = 0; i < 12; i++) assert_true(m.m[i] == 0 || fabsf(m.m[i]) == 1);
    }
}

TEST(maths, mat34_products_and_inverses) {
    u64 counter = 0;
    for (u32 round = 0; round < 1000; round++) {
        Mat34 m[2];
        for (u32 i = 0; i < 2; i++) {
            Vec3 position = draw3(&counter, -10, 10), rotation = draw3(&counter, -180, 180);
            m[i] = mat34_from_trs(position, rotation, draw3(&counter, 0.5f, 2));
        }
        Mat34 product = mat34_mul(m[0], m[1]);
        f32 want[16];
        oracle_mul(mat34_to_mat4(m[0]).m, mat34_to_mat4(m[1]).m, want);
        assert_matrices_near(mat34_to_mat4(product).m, want, 16, 1e-5);
        oracle_inverse(mat34_to_mat4(product).m, want);
        Mat34 inverse = mat34_inverse(product);
        assert_matrices_near(mat34_to_mat4(inverse).m, want, 16, 1e-5);
        Vec3 p = draw3(&counter, -5, 5), back = mat34_point(&product, p);
        back = mat34_point(&inverse, back);
        ASSERT_NEAR(vec3_length(vec3_sub(back, p)), 0, 1e-3);
        Vec3 moved = vec3_sub(mat34_point(&product, p), mat34_vector(&product, p));
        ASSERT_NEAR(vec3_length(vec3_sub(moved, mat34_translation(&product))), 0, 1e-4);
    }
}

TEST(maths, singular_matrices_invert_to_the_identity) {
    Mat34 identity = mat34_identity(), flat = identity;
    flat.m[5] = 0;
    assert_memory_equal(mat34_inverse(flat).m, identity.m, sizeof identity);
    Mat34 tiny = mat34_from_trs(vec3(0, 0, 0), vec3(10, 20, 30), vec3(1e-39f, 1e-39f, 1e-39f));
    assert_memory_equal(mat34_inverse(tiny).m, identity.m, sizeof identity); // inverse > FLT_MAX
    Mat34 odd = identity;
    odd.m[0] = NAN;
    assert_memory_equal(mat34_inverse(odd).m, identity.m, sizeof identity);
}

TEST(maths, rotation_is_recovered) {
    u64 counter = 0;
    for (u32 round = 0; round < 1000; round++) {
        Vec3 rotation = draw3(&counter, -179, 179);
        rotation.x = draw(&counter, -89, 89);
        Vec3 scale = draw3(&counter, 0.1f, 4);
        if (round & 1) scale.x = -scale.x; // mirrored: read as a negative x scale
        Mat34 m = mat34_from_trs(vec3(1, 2, 3), rotation, scale);
        Vec3 got = mat34_rotation_deg(&m);
        ASSERT_NEAR(got.x, rotation.x, 1e-3);
        ASSERT_NEAR(got.y, rotation.y, 1e-3);
        ASSERT_NEAR(got.z, rotation.z, 1e-3);
        Vec3 size = {fabsf(scale.x), scale.y, scale.z};
        ASSERT_NEAR(mat34_max_scale(&m), MAX(size.x, MAX(size.y, size.z)), 1e-5);
    }
    // Straight up and down: other angles, the same matrix.
    for (f32 pitch = -90; pitch <= 90; pitch += 180) {
        Mat34 m = mat34_from_trs(vec3(0, 0, 0), vec3(pitch, 50, 20), vec3(1, 1, 1));
        Mat34 again = mat34_from_trs(vec3(0, 0, 0), mat34_rotation_deg(&m), vec3(1, 1, 1));
        assert_matrices_near(again.m, m.m, 12, 1e-5);
    }
}

TEST(maths, vectors) {
    assert_true(vec3_length(vec3_normalize(vec3(0, 0, 0))) == 0);
    ASSERT_NEAR(vec3_length(vec3_normalize(vec3(3, -4, 12))), 1, 1e-6);
    Vec3 z = vec3_cross(vec3(1, 0, 0), vec3(0, 1, 0)); // right-handed
    assert_true(z.x == 0 && z.y == 0 && z.z == 1);
    ASSERT_NEAR(f32_lerp(2, 4, 0.25f), 2.5, 0);
    ASSERT_NEAR(f32_smoothstep(1, 3, 2), 0.5, 0);
    ASSERT_NEAR(f32_smoothstep(1, 3, 9), 1, 0);
    ASSERT_NEAR(f32_saturate(-1), 0, 0);
}

TEST(maths, srgb_is_the_standard_curve) {
    for (u32 i = 0; i <= 255; i++) {
        f32 encoded = (f32)i / 255.0f, linear = srgb_to_linear(encoded);
        ASSERT_NEAR(linear, oracle_srgb_to_linear(encoded), 1e-6);
        ASSERT_NEAR(linear_to_srgb(linear), encoded, 2e-7);
        assert_int_equal((u32)(linear_to_srgb(linear) * 255.0f + 0.5f), i);
    }
    assert_true(srgb_to_linear(0) == 0 && srgb_to_linear(1) == 1);
    assert_true(linear_to_srgb(0) == 0 && linear_to_srgb(1) == 1);
    ASSERT_NEAR(srgb_to_linear(0.5f), 0.21404114, 1e-7);
}
