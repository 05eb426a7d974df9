// base_bounds.c: how far cones and parts of balls reach on the screen: against samples, and against
// the greatest ratio found by another way (support functions and a search, no list of candidates).
#include "../test.h"
#include "../../engine/base/random.h"
#include "../../engine/base/screen_bounds.h"
#include "../../engine/base/sphere_bounds.h"
#include <stdio.h>

#define NEAR_M 0.1
#define TAU    6.283185307179586

static f64 dot(const f64 *a, const f64 *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void random_direction(u64 seed, u64 stream, u64 draw, f64 out[3]) {
    f64 z = random_range(seed, stream, draw, -1, 1), ring = sqrt(MAX(1 - z * z, 0));
    f64 angle = random_f32(seed, stream + 1, draw) * TAU;
    out[0] = ring * cos(angle), out[1] = ring * sin(angle), out[2] = z;
}

// Any cone; one in eight at the eye or the near plane, or with its axis along an axis.
static Cone random_cone(u64 seed, u32 i) {
    Cone cone;
    f64 half = random_range(seed, 1, i, 0.01f, 1.55f);
    cone.cos_half = cos(half), cone.sin_half = sin(half);
    cone.reach = random_range(seed, 2, i, 0.05f, 4);
    cone.tip[0] = random_range(seed, 3, i, -15, 15);
    cone.tip[1] = random_range(seed, 4, i, -15, 15);
    cone.tip[2] = random_range(seed, 5, i, -3, 30);
    random_direction(seed, 6, i, cone.axis);
    if (i % 8 == 0) {
        for (u32 a = 0; a < 3; a++) cone.tip[a] = random_range(seed, 10 + a, i, -2, 2);
        if (i % 16 == 0) {
            u32 along = random_u32(seed, 14, i) % 3;
            for (u32 a = 0; a < 3; a++) cone.axis[a] = a == along ? (i % 32 ? 1 : -1) : 0;
        }
        if (i % 64 == 8) cone.tip[0] = cone.tip[1] = 0;
    }
    return cone;
}

// Points of the cone: inside, of its side, of its rim, of its cap.
static void cone_sample(const Cone *cone, u64 seed, u64 draw, f64 out[3]) {
    f64 way[3], along, length = 0;
    random_direction(seed, 20, draw, way);
    along = dot(way, cone->axis);
    f64 half = atan2(cone->sin_half, cone->cos_half);
    f64 angle = half * (draw & 1 ? 1.0 : random_f32(seed, 22, draw));
    for (u32 a = 0; a < 3; a++) way[a] -= along * cone->axis[a], length += way[a] * way[a];
    f64 far = cone->reach * (draw & 2 ? 1.0 : random_f32(seed, 23, draw));
    for (u32 a = 0; a < 3; a++)
        out[a] =
            cone->tip[a] + far * (cone->axis[a] * cos(angle) + way[a] / sqrt(length) * sin(angle));
}

// ---- the other way ----

// Farthest of the cone along any vector, by its angle to the axis.
static f64 support(const Cone *cone, const f64 v[3]) {
    f64 length = sqrt(dot(v, v)), half = atan2(cone->sin_half, cone->cos_half);
    if (length == 0) return 0;
    f64 angle = acos(CLAMP(dot(v, cone->axis) / length, -1.0, 1.0));
    f64 part = angle <= half ? 1.0 : MAX(cos(angle - half), 0.0);
    return dot(v, cone->tip) + length * cone->reach * part;
}

// Greatest of (coordinate - ratio * depth) over the cone between two depths: the least, over
// multipliers of the two depths, of the support (Lagrange's dual; the part is convex).
static f64 greatest(const Cone *cone, u32 axis, f64 sign, f64 ratio, f64 from, f64 to) {
    f64 low = -2000, high = 2000;
    const f64 golden = 0.6180339887498949;
    f64 at[2] = {high - golden * (high - low), low + golden * (high - low)}, value[2];
    for (u32 step = 0; step < 64; step++) {
        for (u32 k = 0; k < 2; k++) {
            f64 v[3] = {0, 0, -ratio + at[k]};
            v[axis] = sign;
            value[k] = support(cone, v) - at[k] * (at[k] > 0 ? from : to);
        }
        if (value[0] < value[1])
            high = at[1];
        else
            low = at[0];
        at[0] = high - golden * (high - low), at[1] = low + golden * (high - low);
    }
    return MIN(value[0], value[1]);
}

// sign * greatest ratio between two depths, by bisection.
static f64 search_ratio(const Cone *cone, u32 axis, f64 sign, f64 from, f64 to) {
    f64 low = -200, high = 200;
    for (u32 step = 0; step < 44; step++) {
        f64 middle = (low + high) / 2;
        if (greatest(cone, axis, sign, middle, from, to) > 0)
            low = middle;
        else
            high = middle;
    }
    return sign * (low + high) / 2;
}

static void check_cone(const Cone *cone, u32 i, f64 from, f64 to, f64 half_px) {
    for (u32 axis = 0; axis < 2; axis++) {
        ConeAxis c = cone_axis(cone, axis);
        RatioRange range;
        assert_true(cone_axis_range(&c, from, to, &range));
        f64 low = search_ratio(cone, axis, -1, from, to);
        f64 high = search_ratio(cone, axis, 1, from, to);
        // Only what is on the screen matters.
        if (high > -1 && high < 1 && fabs(range.high - high) * half_px > 1e-3)
            fail_msg("cone %u: %g, but %g by search", i, range.high, high);
        if (low > -1 && low < 1 && fabs(range.low - low) * half_px > 1e-3)
            fail_msg("cone %u: %g, but %g by search", i, range.low, low);
        if (high >= 1) assert_true(range.high >= 1);
        if (low <= -1) assert_true(range.low <= -1);
    }
}

static void search_cones(u64 seed, u32 count) {
    printf("seed %llx\n", (unsigned long long)seed);
    u32 checked = 0, cut = 0;
    for (u32 i = 0; i < count; i++) {
        Cone cone = random_cone(seed, i);
        const f64 forth[3] = {0, 0, 1}, back[3] = {0, 0, -1};
        f64 nearest = cone.tip[2] - cone_extent(&cone, back);
        f64 farthest = cone.tip[2] + cone_extent(&cone, forth);
        ASSERT_NEAR(farthest, support(&cone, forth), 1e-9);
        ASSERT_NEAR(nearest, -support(&cone, back), 1e-9);
        // Parts too thin for the search's multipliers are left to the samples.
        f64 from = NEAR_M, to = 1e9;
        if (i % 2) {
            f64 thick = (farthest - nearest) * random_range(seed, 30, i, 0.1f, 1);
            from = MAX(nearest + random_f32(seed, 31, i) * (farthest - nearest - thick), NEAR_M);
            to = from + thick;
        }
        if (MIN(farthest, to) - MAX(nearest, from) < 0.02) continue;
        check_cone(&cone, i, from, to, 640);
        checked++;
        cut += nearest < from;
    }
    printf("%u cones, %u of them cut\n", checked, cut);
    assert_true(checked > count / 2 && cut > count / 8);
}

TEST(base_bounds, cones_are_as_wide_as_a_search_finds) { search_cones(0xC0E5, 400); }
TEST_SLOW(base_bounds, many_cones_are_as_wide_as_a_search_finds) { search_cones(0xC0E8, 4000); }

TEST(base_bounds, cones_contain_their_samples) {
    const u64 seed = 0xC0E6;
    printf("seed %llx\n", (unsigned long long)seed);
    u64 inside = 0, missed_sides = 0;
    for (u32 i = 0; i < 1000000; i++) {
        Cone cone = random_cone(seed, i);
        f64 from = NEAR_M, to = INFINITY;
        if (i % 2) {
            from = MAX(cone.tip[2] - cone.reach + random_f32(seed, 31, i) * cone.reach, NEAR_M);
            to = from * random_range(seed, 32, i, 1.02f, 1.5f);
        }
        ConeAxis axes[2] = {cone_axis(&cone, 0), cone_axis(&cone, 1)};
        RatioRange ranges[2];
        bool any[2];
        for (u32 a = 0; a < 2; a++) any[a] = cone_axis_range(&axes[a], from, to, &ranges[a]);
        f64 sides[2][3];
        u32 side_count = cone_silhouettes(&cone, sides);
        for (u32 k = 0; k < 4; k++) {
            f64 p[3];
            cone_sample(&cone, seed, (u64)i * 4 + k, p);
            for (u32 s = 0; s < side_count; s++)
                missed_sides += dot(sides[s], p) > 1e-7 * (1 + cone.reach);
            if (p[2] < from || p[2] > to) continue;
            inside++;
            for (u32 a = 0; a < 2; a++) {
                f64 ratio = p[a] / p[2], slack = 1e-9 * (1 + fabs(ratio));
                if (!any[a] || ratio < ranges[a].low - slack || ratio > ranges[a].high + slack)
                    fail_msg("cone %u: sample %g outside of %g..%g", i, ratio, ranges[a].low,
                             ranges[a].high);
            }
        }
    }
    assert_int_equal(missed_sides, 0);
    assert_true(inside > 500000);
}

// In NDC, as scissors use them: never wider than the smallest ball around the cone, and clipped.
TEST(base_bounds, cones_reach_less_far_than_their_balls) {
    const u64 seed = 0xC0E9;
    f64 cone_width = 0, ball_width = 0;
    for (u32 i = 0; i < 20000; i++) {
        Cone cone = random_cone(seed, i);
        const f32 tip[3] = {(f32)cone.tip[0], (f32)cone.tip[1], -(f32)cone.tip[2]};
        const f32 way[3] = {(f32)cone.axis[0], (f32)cone.axis[1], -(f32)cone.axis[2]};
        f32 reach = (f32)cone.reach, cosine = (f32)cone.cos_half, radius, ends[2][2];
        f32 along = cone_bounding_sphere(reach, cosine, (f32)cone.sin_half, &radius);
        bool any =
            cone_bounds_axis(tip, way, cosine, reach, 0, NEAR_M, 1.3f, &ends[0][0], &ends[0][1]);
        bool ball = sphere_bounds_axis(tip[0] + way[0] * along, tip[2] + way[2] * along,
                                       radius * 1.00001f, NEAR_M, 1.3f, &ends[1][0], &ends[1][1]);
        if (!any) continue;
        assert_true(ball && ends[0][0] >= -1 && ends[0][1] <= 1);
        assert_true(ends[0][0] >= ends[1][0] - 1e-5f && ends[0][1] <= ends[1][1] + 1e-5f);
        cone_width += ends[0][1] - ends[0][0];
        ball_width += ends[1][1] - ends[1][0];
        // From 90 degrees on it is the whole ball.
        bool whole[2];
        whole[0] =
            cone_bounds_axis(tip, way, -0.1f, reach, 1, NEAR_M, 1.3f, &ends[0][0], &ends[0][1]);
        whole[1] =
            sphere_bounds_axis(tip[1], tip[2], reach, NEAR_M, 1.3f, &ends[1][0], &ends[1][1]);
        assert_int_equal(whole[0], whole[1]);
        if (whole[0]) assert_memory_equal(ends[0], ends[1], sizeof ends[0]);
    }
    printf("cones are %.2f as wide as their balls\n", cone_width / ball_width);
    assert_true(cone_width < 0.9 * ball_width);
}

// The straight sides touch the cone: some generator lies in the plane.
TEST(base_bounds, sides_of_cones_touch_them) {
    const u64 seed = 0xC0E7;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 with_sides = 0;
    for (u32 i = 0; i < 2000; i++) {
        Cone cone = random_cone(seed, i);
        f64 sides[2][3];
        if (cone_silhouettes(&cone, sides) == 0) continue;
        with_sides++;
        for (u32 s = 0; s < 2; s++) {
            ASSERT_NEAR(dot(sides[s], cone.tip), 0, 1e-9);
            ASSERT_NEAR(dot(sides[s], sides[s]), 1, 1e-9);
            ASSERT_NEAR(dot(sides[s], cone.axis), -cone.sin_half, 1e-9);
        }
    }
    assert_true(with_sides > 1000);
}

// ---- balls ----

TEST(base_bounds, parts_of_balls_are_exact) {
    const u64 seed = 0xBA11;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 cut_far = 0;
    for (u32 i = 0; i < 20000; i++) {
        f64 c = random_range(seed, 1, i, -5, 5), d = random_range(seed, 2, i, -2, 12);
        f64 r = random_range(seed, 3, i, 0.05f, 4);
        f64 from = random_range(seed, 4, i, 0.1f, 10), to = from * random_range(seed, 5, i, 1, 2);
        BallAxis ball = ball_axis(c, d, r);
        RatioRange range;
        bool any = ball_axis_range(&ball, from, to, &range);
        f64 first = MAX(from, d - r), last = MIN(to, d + r), low = INFINITY, high = -INFINITY;
        assert_int_equal(any, first <= last);
        if (!any) continue;
        const u32 steps = 400;
        for (u32 k = 0; k <= steps; k++) {
            f64 depth = first + (last - first) * k / steps;
            f64 half = sqrt(MAX(r * r - (depth - d) * (depth - d), 0));
            low = MIN(low, (c - half) / depth), high = MAX(high, (c + half) / depth);
        }
        assert_true(range.low <= low + 1e-9 && range.high >= high - 1e-9);
        // Between two samples the circle rises by a little more, most at its ends.
        f64 slack = 0.1 * r / sqrt(steps) / first;
        if (range.low < low - slack || range.high > high + slack)
            fail_msg("ball %u: %g..%g, samples %g..%g", i, range.low, range.high, low, high);
        cut_far += last == to;
    }
    printf("%u cut at their far end\n", cut_far);
    assert_true(cut_far > 500);
}

// A ball's outline between two lines, against points of the circle where the eye's rays touch it.
TEST(base_bounds, outlines_of_balls_are_exact) {
    const u64 seed = 0xBA12;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 strips = 0, empty = 0;
    for (u32 i = 0; i < 1500; i++) {
        f64 at[3], r = random_range(seed, 1, i, 0.05f, 3);
        at[0] = random_range(seed, 2, i, -8, 8), at[1] = random_range(seed, 3, i, -8, 8);
        at[2] = r + NEAR_M + random_range(seed, 4, i, 0.001f, 12);
        BallOutline outline;
        assert_true(ball_outline(at[0], at[1], at[2], r, NEAR_M, &outline));
        assert_false(ball_outline(at[0], at[1], r + NEAR_M * 0.5, r, NEAR_M, &outline));
        assert_true(ball_outline(at[0], at[1], at[2], r, NEAR_M, &outline));
        f64 size = outline.rows.high - outline.rows.low;
        f64 y_from = outline.rows.low + random_range(seed, 5, i, -0.2f, 1.1f) * size;
        f64 y_to = y_from + random_range(seed, 6, i, 0.02f, 0.5f) * size;
        RatioRange range;
        bool any = ball_outline_range(&outline, y_from, y_to, &range);
        // The circle: centre L (1 - r^2 / l^2), radius r t / l, across L.
        f64 l2 = dot(at, at), l = sqrt(l2), rho = r * sqrt(l2 - r * r) / l;
        f64 d[3] = {at[0] / l, at[1] / l, at[2] / l};
        f64 side = hypot(d[0], d[2]), u[3] = {d[2] / side, 0, -d[0] / side};
        f64 v[3] = {d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2],
                    d[0] * u[1] - d[1] * u[0]};
        f64 low = INFINITY, high = -INFINITY;
        const u32 steps = 5000;
        for (u32 k = 0; k < steps; k++) {
            f64 p[3], a = k * TAU / steps;
            for (u32 x = 0; x < 3; x++)
                p[x] = at[x] * (1 - r * r / l2) + rho * (u[x] * cos(a) + v[x] * sin(a));
            if (p[1] / p[2] < y_from || p[1] / p[2] > y_to) continue;
            low = MIN(low, p[0] / p[2]), high = MAX(high, p[0] / p[2]);
        }
        if (!any) {
            assert_true(low > high);
            empty++;
            continue;
        }
        if (low > high) continue; // a corner thinner than the steps
        strips++;
        assert_true(range.low <= low + 1e-9 && range.high >= high - 1e-9);
        f64 slack = 0.02 * size + 0.02 * (high - low);
        // The strip's ends may cut off more than the samples show, by a step of the circle.
        if (range.low < low - slack || range.high > high + slack)
            fail_msg("ball %u: %g..%g, samples %g..%g", i, range.low, range.high, low, high);
    }
    printf("%u strips, %u empty\n", strips, empty);
    assert_true(strips > 1000 && empty > 20);
}
