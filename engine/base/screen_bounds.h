// screen_bounds.h: how far a ball or a cone reaches on the screen, whole or between two depths.
//
// Everything is seen along one axis of the screen, x or y: positions are (coordinate, depth) with
// depth = -z of view space, and results are ratios coordinate / depth; times the projection scale
// cot(fov / 2) they are NDC. In double: the touching points lose their digits when the eye is near
// a surface. Pure functions, any thread. sphere_bounds.h has the same for whole balls in NDC.
#ifndef LUZ_SCREEN_BOUNDS_H
#define LUZ_SCREEN_BOUNDS_H
#include "base.h"

typedef struct RatioRange {
    f64 low, high;
} RatioRange;

// --- Ball ---

// What does not depend on the depths: the two tangents from the eye, where there are.
typedef struct BallAxis {
    f64 center, depth, radius;
    f64 low_depth, low_ratio, high_depth, high_ratio; // touching points; depth <= 0: behind the eye
} BallAxis;
BallAxis ball_axis(f64 center, f64 depth, f64 radius);
// Exact range of the part between the depths 0 < from <= to (to may be infinite). False if there is
// none.
bool ball_axis_range(const BallAxis *ball, f64 from, f64 to, RatioRange *range);

// A ball in front of the eye is seen as an ellipse; this is its widest part between two lines
// y / depth = const.
typedef struct BallOutline {
    f64 x, y, depth, flat, touch2; // centre; coefficients of the ellipse
    f64 low_y, high_y;             // y / depth where it is widest to either side
    RatioRange rows;               // all of its y / depth
} BallOutline;
// False if no part of the ball may be as near as `near`, or the eye is too close for an ellipse.
bool ball_outline(f64 x, f64 y, f64 depth, f64 radius, f64 near, BallOutline *outline);
// False if the ellipse lies outside of these rows.
bool ball_outline_range(const BallOutline *outline, f64 y_from, f64 y_to, RatioRange *range);

// --- Cone: the part of a ball around its tip that is within an angle of its axis ---

typedef struct Cone {
    f64 tip[3], axis[3];           // x, y, depth; axis unit
    f64 cos_half, sin_half, reach; // half angle under 90 degrees (beyond: not convex, use the ball)
} Cone;
// How far it reaches from its tip in a unit direction, 0..reach.
f64 cone_extent(const Cone *cone, const f64 direction[3]);

typedef struct ConeAxis {
    f64 tip, tip_depth, axis, axis_depth, cos_half, reach;
    f64 rim, rim_depth, rim_rise, rim_along, rim_across; // the rim's circle
    struct {
        f64 depth, ratio;
    } points[5]; // where its outline may turn: tip, tangents
    u32 point_count, side_count;
    struct {
        f64 along, depth;
    } sides[2]; // unit generators that touch planes through the eye's axis
} ConeAxis;
ConeAxis cone_axis(const Cone *cone, u32 axis); // 0 = x, 1 = y
// Exact range at one depth > 0, and of the part between two. False if there is none.
bool cone_axis_section(const ConeAxis *cone, f64 depth, RatioRange *range);
bool cone_axis_range(const ConeAxis *cone, f64 from, f64 to, RatioRange *range);
// The same from the sections at the two ends, for who has them: NULL = there is none.
bool cone_axis_between(const ConeAxis *cone, f64 from, f64 to, const RatioRange *section_from,
                       const RatioRange *section_to, RatioRange *range);

// The straight sides of its outline: planes through the eye and the tip, n . (x, y, depth) <= 0
// for all points. 0 or 2: none if the eye looks along the inside.
u32 cone_silhouettes(const Cone *cone, f64 planes[2][3]);
#endif
