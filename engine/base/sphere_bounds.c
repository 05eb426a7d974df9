// sphere_bounds.c: what part of the screen a ball can cover, and the ball around a cone.
// Data in: a view-space sphere, a lens; a cone. Data out: NDC bounds; a sphere. Called by: the
// light grids (systems/), the scissors of `deferred_volumes` (render/). Does not: know pixels or
// tiles.
#include "sphere_bounds.h"
#include <math.h>

// What single precision may lose in the result, as a part of the half screen: 0.0003 px at 720p.
#define NDC_SLACK 1e-6

// The ball's shadow on the plane of this axis and depth is a disc, and what is behind the near
// plane is cut off it. Seen from the eye, the rest is a convex figure: its outline is met at the
// tangents from the eye, or, where a tangent touches behind the near plane, at that end of the cut.
// The touching points are those of Lengyel's planes N (specification 6.1, after Lengyel, "The
// mechanics of robust stencil shadows", 2002), written as the centre's direction turned by
// +-asin(r / |L|): with l2 = c^2 + d^2 and t = sqrt(l2 - r^2),
//   point = (c t -+ d r, d t +- c r) t / l2,
// which has no division that fails at Lz = 0 or Nx = 0. In double: t loses its digits when the eye
// is near the surface.
bool sphere_bounds_axis(f32 center, f32 center_z, f32 radius, f32 near, f32 scale, f32 *ndc_min,
                        f32 *ndc_max) {
    f64 c = center, d = -(f64)center_z, r = radius, n = near; // d: depth, forward
    if (!(r > 0.0) || !(d + r > n)) return false;
    f64 l2 = c * c + d * d, t2 = l2 - r * r;
    f64 cut2 = r * r - (d - n) * (d - n);
    f64 cut = cut2 > 0.0 ? sqrt(cut2) : 0.0;
    // A disc that reaches over the near plane and has no tangent in front of it has a cut there.
    f64 low = (c - cut) / n, high = (c + cut) / n;
    if (t2 > 0.0) {
        f64 t = sqrt(t2), low_depth = d * t + c * r, high_depth = d * t - c * r;
        if (low_depth * t >= n * l2) low = (c * t - d * r) / low_depth;
        if (high_depth * t >= n * l2) high = (c * t + d * r) / high_depth;
    }
    low = low * scale - NDC_SLACK, high = high * scale + NDC_SLACK;
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
