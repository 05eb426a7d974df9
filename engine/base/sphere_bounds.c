// sphere_bounds.c: what part of the screen a ball or a cone can cover, and the ball around a cone.
// Data in: a view-space sphere, a lens; a cone. Data out: NDC bounds; a sphere. Called by: the
// light grids (systems/), the scissors of `deferred_volumes` (render/). Does not: know pixels or
// tiles.
#include "sphere_bounds.h"
#include "screen_bounds.h"
#include <math.h>

// What single precision may lose in the result, as a part of the half screen: 0.0003 px at 720p.
#define NDC_SLACK 1e-6

static bool to_ndc(const RatioRange *range, f32 scale, f32 *ndc_min, f32 *ndc_max) {
    f64 low = range->low * scale - NDC_SLACK, high = range->high * scale + NDC_SLACK;
    if (!(low <= 1.0 && high >= -1.0)) return false;
    *ndc_min = (f32)MAX(low, -1.0);
    *ndc_max = (f32)MIN(high, 1.0);
    return true;
}

bool sphere_bounds_axis(f32 center, f32 center_z, f32 radius, f32 near, f32 scale, f32 *ndc_min,
                        f32 *ndc_max) {
    BallAxis ball = ball_axis(center, -(f64)center_z, radius);
    RatioRange range;
    return ball_axis_range(&ball, near, INFINITY, &range) &&
           to_ndc(&range, scale, ndc_min, ndc_max);
}

bool cone_bounds_axis(const f32 tip[3], const f32 direction[3], f32 cos_half, f32 reach, u32 axis,
                      f32 near, f32 scale, f32 *ndc_min, f32 *ndc_max) {
    if (!(cos_half > 0.0f))
        return sphere_bounds_axis(tip[axis], tip[2], reach, near, scale, ndc_min, ndc_max);
    f64 cosine = cos_half, sine2 = 1.0 - cosine * cosine;
    Cone cone = {{tip[0], tip[1], -tip[2]},
                 {direction[0], direction[1], -direction[2]},
                 cosine,
                 sine2 > 0.0 ? sqrt(sine2) : 0.0,
                 reach};
    ConeAxis c = cone_axis(&cone, axis);
    RatioRange range;
    return cone_axis_range(&c, near, INFINITY, &range) && to_ndc(&range, scale, ndc_min, ndc_max);
}

f32 cone_bounding_sphere(f32 reach, f32 cos_half, f32 sin_half, f32 *radius) {
    if (cos_half > 0.70710678f) {
        *radius = reach / (2.0f * cos_half);
        return *radius;
    }
    *radius = reach * sin_half;
    if (cos_half > 0.0f) return reach * cos_half;
    *radius = reach;
    return 0.0f;
}
