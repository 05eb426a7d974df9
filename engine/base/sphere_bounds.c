// sphere_bounds.c: what part of the screen a ball can cover, and the ball around a cone.
// Data in: a view-space sphere, a lens; a cone. Data out: NDC bounds; a sphere. Called by: the
// light grids (systems/), the scissors of `deferred_volumes` (render/). Does not: know pixels or
// tiles.
#include "sphere_bounds.h"
#include "screen_bounds.h"
#include <math.h>

// What single precision may lose in the result, as a part of the half screen: 0.0003 px at 720p.
#define NDC_SLACK 1e-6

bool sphere_bounds_axis(f32 center, f32 center_z, f32 radius, f32 near, f32 scale, f32 *ndc_min,
                        f32 *ndc_max) {
    BallAxis ball = ball_axis(center, -(f64)center_z, radius);
    RatioRange range;
    if (!ball_axis_range(&ball, near, INFINITY, &range)) return false;
    f64 low = range.low * scale - NDC_SLACK, high = range.high * scale + NDC_SLACK;
    if (!(low <= 1.0 && high >= -1.0)) return false;
    *ndc_min = (f32)MAX(low, -1.0);
    *ndc_max = (f32)MIN(high, 1.0);
    return true;
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
