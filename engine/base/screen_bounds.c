// screen_bounds.c: see screen_bounds.h.
// Data in: a ball or a cone in view space, depths. Data out: ranges of x / depth or y / depth.
// Called by: the light grids (systems/), sphere_bounds.c. Does not: know pixels, tiles or lenses.
//
// The ratio coordinate / depth of a convex body is greatest where a plane through the eye touches
// it, or, where that is cut away by a depth, on the cut. So every function here collects the few
// points that can be the place: they are exact bounds, not estimates.
#include "screen_bounds.h"
#include <math.h>

// A candidate that misses by rounding is taken: that adds less than rounding does.
#define FEASIBLE 1e-9

// ---- ball ----

// The ball's shadow on the plane of this axis and depth is a disc. The touching points of its
// tangents are those of Lengyel's planes N (specification of direct lighting, 6.1, after Lengyel,
// "The mechanics of robust stencil shadows", 2002), written as the centre's direction turned by
// +-asin(r / |L|): with l2 = c^2 + d^2 and t = sqrt(l2 - r^2),
//   point = (c t -+ d r, d t +- c r) t / l2,
// which has no division that fails at Lz = 0 or Nx = 0.
BallAxis ball_axis(f64 center, f64 depth, f64 radius) {
    BallAxis ball = {.center = center, .depth = depth, .radius = radius};
    f64 l2 = center * center + depth * depth, t2 = l2 - radius * radius;
    if (!(t2 > 0.0)) return ball;
    f64 t = sqrt(t2), low = depth * t + center * radius, high = depth * t - center * radius;
    ball.low_depth = low * t / l2;
    ball.high_depth = high * t / l2;
    if (low > 0.0) ball.low_ratio = (center * t - depth * radius) / low;
    if (high > 0.0) ball.high_ratio = (center * t + depth * radius) / high;
    return ball;
}

// On the disc's upper half the ratio rises up to the touching point and falls behind it (a point
// behind the eye: it only falls), so its maximum is at the depth nearest to that point.
bool ball_axis_range(const BallAxis *ball, f64 from, f64 to, RatioRange *range) {
    f64 d = ball->depth, r = ball->radius;
    f64 first = MAX(from, d - r), last = MIN(to, d + r);
    if (!(r > 0.0) || !(first <= last) || !(first > 0.0)) return false;
    f64 depth = CLAMP(ball->low_depth, first, last);
    f64 half2 = r * r - (depth - d) * (depth - d), half = half2 > 0.0 ? sqrt(half2) : 0.0;
    range->low = depth == ball->low_depth ? ball->low_ratio : (ball->center - half) / depth;
    depth = CLAMP(ball->high_depth, first, last);
    half2 = r * r - (depth - d) * (depth - d), half = half2 > 0.0 ? sqrt(half2) : 0.0;
    range->high = depth == ball->high_depth ? ball->high_ratio : (ball->center + half) / depth;
    return true;
}

// Rays (X, Y, 1) that touch the ball: (v . L)^2 = t2 |v|^2, for fixed Y a quadratic in X:
//   X = (Lx e +- sqrt(t2 (e^2 - a (1 + Y^2)))) / a,  e = Ly Y + Ld,  a = t2 - Lx^2.
// a > 0 if the ball is in front of the eye as seen along x.
bool ball_outline(f64 x, f64 y, f64 depth, f64 radius, f64 near, BallOutline *outline) {
    if (!(depth - radius > near)) return false;
    BallAxis across = ball_axis(x, depth, radius), up = ball_axis(y, depth, radius);
    f64 touch2 = x * x + y * y + depth * depth - radius * radius;
    *outline = (BallOutline){.x = x,
                             .y = y,
                             .depth = depth,
                             .flat = touch2 - x * x,
                             .touch2 = touch2,
                             .low_y = y / across.low_depth,
                             .high_y = y / across.high_depth,
                             .rows = {up.low_ratio, up.high_ratio}};
    return outline->flat > 0.0;
}

static f64 outline_root(const BallOutline *o, f64 y, f64 *middle) {
    f64 e = o->y * y + o->depth, root2 = o->touch2 * (e * e - o->flat * (1.0 + y * y));
    *middle = o->x * e;
    return root2 > 0.0 ? sqrt(root2) : 0.0;
}

bool ball_outline_range(const BallOutline *o, f64 y_from, f64 y_to, RatioRange *range) {
    f64 from = MAX(y_from, o->rows.low), to = MIN(y_to, o->rows.high), middle;
    if (!(from <= to)) return false;
    f64 root = outline_root(o, CLAMP(o->low_y, from, to), &middle);
    range->low = (middle - root) / o->flat;
    root = outline_root(o, CLAMP(o->high_y, from, to), &middle);
    range->high = (middle + root) / o->flat;
    return true;
}

// ---- cone ----

f64 cone_extent(const Cone *cone, const f64 direction[3]) {
    f64 a =
        cone->axis[0] * direction[0] + cone->axis[1] * direction[1] + cone->axis[2] * direction[2];
    if (a >= cone->cos_half) return cone->reach; // the cap's inside
    if (a <= -cone->sin_half) return 0.0;        // the tip
    f64 across2 = 1.0 - a * a;
    f64 rim = a * cone->cos_half + (across2 > 0.0 ? sqrt(across2) : 0.0) * cone->sin_half;
    return MAX(rim, 0.0) * cone->reach;
}

static void add_point(ConeAxis *c, f64 depth, f64 ratio) {
    if (!(depth > 0.0) || !isfinite(ratio)) return;
    c->points[c->point_count].depth = depth;
    c->points[c->point_count++].ratio = ratio;
}

// Tangents to the rim's circle C + rho (u cos + v sin): planes with N . C = +-rho |N x A|, for the
// ratio m with N = (1, -m): m^2 (Cd^2 - rho^2 (1 - Ad^2)) - 2 m (C Cd + rho^2 A Ad) + (C^2 - rho^2
// (1 - A^2)) = 0.
static void add_rim_tangents(ConeAxis *c, f64 rho) {
    f64 k = c->rim, d = c->rim_depth, a = c->axis, ad = c->axis_depth, rho2 = rho * rho;
    f64 square = d * d - rho2 * (1.0 - ad * ad), cross = k * d + rho2 * a * ad;
    f64 constant = k * k - rho2 * (1.0 - a * a), root2 = cross * cross - square * constant;
    if (root2 < -FEASIBLE * cross * cross) return; // the eye looks through the circle
    f64 root = root2 > 0.0 ? sqrt(root2) : 0.0, q = cross + (cross < 0.0 ? -root : root);
    const f64 ratios[2] = {q / square, constant / q};
    for (u32 i = 0; i < 2; i++) {
        f64 m = ratios[i];
        if (!isfinite(m)) continue;
        // The touching point lies off the centre along the part of (1, -m) within the circle.
        f64 off = k - m * d, along = -a * ad - m * (1.0 - ad * ad);
        f64 length2 = 1.0 - a * a + 2.0 * m * a * ad + m * m * (1.0 - ad * ad);
        f64 step = length2 > 1e-30 ? rho * along / sqrt(length2) : 0.0;
        add_point(c, off > 0.0 ? d - step : d + step, m);
    }
}

ConeAxis cone_axis(const Cone *cone, u32 axis) {
    ConeAxis c = {.tip = cone->tip[axis],
                  .tip_depth = cone->tip[2],
                  .axis = cone->axis[axis],
                  .axis_depth = cone->axis[2],
                  .cos_half = cone->cos_half,
                  .reach = cone->reach};
    f64 rho = cone->reach * cone->sin_half, height = cone->reach * cone->cos_half;
    c.rim = c.tip + c.axis * height;
    c.rim_depth = c.tip_depth + c.axis_depth * height;
    // In the rim's circle: the way that gains most depth, and the one that gains none.
    f64 rise2 = 1.0 - c.axis_depth * c.axis_depth, rise = rise2 > 0.0 ? sqrt(rise2) : 0.0;
    if (rise > 1e-12) {
        c.rim_rise = rho * rise;
        c.rim_along = -c.axis_depth * c.axis / rise * rho;
        c.rim_across = cone->axis[1 - axis] / rise * rho;
    }

    add_point(&c, c.tip_depth, c.tip / c.tip_depth);
    BallAxis ball = ball_axis(c.tip, c.tip_depth, c.reach);
    const f64 tangents[2][2] = {{ball.low_depth, ball.low_ratio},
                                {ball.high_depth, ball.high_ratio}};
    for (u32 i = 0; i < 2; i++) {
        f64 q = tangents[i][0] * tangents[i][1] - c.tip, qd = tangents[i][0] - c.tip_depth;
        if (q * c.axis + qd * c.axis_depth >= c.reach * (c.cos_half - FEASIBLE))
            add_point(&c, tangents[i][0], tangents[i][1]);
    }
    add_rim_tangents(&c, rho);

    // Planes along the other axis that touch the cone: N . A = -sin; the generator that they touch
    // is (A + sin N) / cos. None if the cone, seen along the other axis, looks all ways.
    f64 a2 = c.axis * c.axis + c.axis_depth * c.axis_depth, sin2 = cone->sin_half * cone->sin_half;
    if (a2 <= sin2 || !(a2 > 0.0)) return c;
    f64 part = -cone->sin_half / a2, rest = sqrt((1.0 - sin2 / a2) / a2);
    for (i32 sign = -1; sign <= 1; sign += 2) {
        f64 n = part * c.axis - sign * rest * c.axis_depth;
        f64 nd = part * c.axis_depth + sign * rest * c.axis;
        c.sides[c.side_count].along = (c.axis + cone->sin_half * n) / c.cos_half;
        c.sides[c.side_count++].depth = (c.axis_depth + cone->sin_half * nd) / c.cos_half;
    }
    return c;
}

// The section is a part of a disc and of a conic: its ends are an end of the disc, an end of the
// conic, or a point of the rim.
bool cone_axis_section(const ConeAxis *c, f64 depth, RatioRange *range) {
    f64 low = INFINITY, high = -INFINITY, h = depth - c->tip_depth;
    f64 half2 = c->reach * c->reach - h * h;
    if (half2 < 0.0) return false;
    f64 half = sqrt(half2), needed = c->reach * (c->cos_half - FEASIBLE);
    if (-half * c->axis + h * c->axis_depth >= needed) low = c->tip - half;
    if (half * c->axis + h * c->axis_depth >= needed) high = c->tip + half;
    for (u32 i = 0; i < c->side_count; i++) {
        f64 length = h / c->sides[i].depth;
        if (!(length >= -FEASIBLE * c->reach && length <= c->reach * (1.0 + FEASIBLE))) continue;
        f64 at = c->tip + length * c->sides[i].along;
        low = MIN(low, at), high = MAX(high, at);
    }
    f64 cosine = (depth - c->rim_depth) / c->rim_rise;
    if (c->rim_rise > 0.0 && fabs(cosine) <= 1.0) {
        f64 middle = c->rim + c->rim_along * cosine;
        f64 across = fabs(c->rim_across) * sqrt(1.0 - cosine * cosine);
        low = MIN(low, middle - across), high = MAX(high, middle + across);
    }
    if (!(low <= high)) return false;
    *range = (RatioRange){low / depth, high / depth};
    return true;
}

bool cone_axis_between(const ConeAxis *c, f64 from, f64 to, const RatioRange *section_from,
                       const RatioRange *section_to, RatioRange *range) {
    RatioRange r = {INFINITY, -INFINITY};
    if (section_from) r = *section_from;
    if (section_to) r.low = MIN(r.low, section_to->low), r.high = MAX(r.high, section_to->high);
    for (u32 i = 0; i < c->point_count; i++) {
        if (c->points[i].depth < from || c->points[i].depth > to) continue;
        r.low = MIN(r.low, c->points[i].ratio), r.high = MAX(r.high, c->points[i].ratio);
    }
    *range = r;
    return r.low <= r.high;
}

bool cone_axis_range(const ConeAxis *c, f64 from, f64 to, RatioRange *range) {
    RatioRange first, last;
    bool has_first = cone_axis_section(c, from, &first);
    bool has_last = to < 1e30 && cone_axis_section(c, to, &last);
    return cone_axis_between(c, from, to, has_first ? &first : NULL, has_last ? &last : NULL,
                             range);
}

// Planes through eye and tip with N . A = -sin: N = cos u + sin v in the basis across the tip's
// direction, u along the axis's part of it.
u32 cone_silhouettes(const Cone *cone, f64 planes[2][3]) {
    const f64 *t = cone->tip, *a = cone->axis;
    f64 length = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
    if (!(length > 1e-9 * cone->reach)) return 0;
    f64 d[3] = {t[0] / length, t[1] / length, t[2] / length};
    f64 along = a[0] * d[0] + a[1] * d[1] + a[2] * d[2];
    f64 u[3] = {a[0] - along * d[0], a[1] - along * d[1], a[2] - along * d[2]};
    f64 across = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    // A little apart, so that rounding cannot turn a plane into the cone.
    if (!(across > cone->sin_half + 1e-6)) return 0;
    for (u32 i = 0; i < 3; i++) u[i] /= across;
    f64 v[3] = {d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]};
    f64 cosine = -cone->sin_half / across, sine = sqrt(1.0 - cosine * cosine);
    for (u32 i = 0; i < 3; i++) {
        planes[0][i] = cosine * u[i] + sine * v[i];
        planes[1][i] = cosine * u[i] - sine * v[i];
    }
    return 2;
}
