// contact.c: where an upright capsule touches triangles and boxes.
// Data in: shapes near a walker, a capsule. Data out: the deepest contact. Called by: walk.c. Does
// not: move anything, or know what a walker is. Only + - * / sqrt: part of the simulation.
#include "collision.h"
#include <math.h>

#define SAME_DEPTH_M 1e-5f

// C. Ericson, "Real-Time Collision Detection" (2005), section 5.1.5: by Voronoi regions.
Vec3 closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
    Vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), ap = vec3_sub(p, a);
    f32 d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap);
    if (d1 <= 0.0f && d2 <= 0.0f) return a;
    Vec3 bp = vec3_sub(p, b);
    f32 d3 = vec3_dot(ab, bp), d4 = vec3_dot(ac, bp);
    if (d3 >= 0.0f && d4 <= d3) return b;
    f32 vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) return vec3_add(a, vec3_scale(ab, d1 / (d1 - d3)));
    Vec3 cp = vec3_sub(p, c);
    f32 d5 = vec3_dot(ab, cp), d6 = vec3_dot(ac, cp);
    if (d6 >= 0.0f && d5 <= d6) return c;
    f32 vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) return vec3_add(a, vec3_scale(ac, d2 / (d2 - d6)));
    f32 va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f)
        return vec3_add(b, vec3_scale(vec3_sub(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6))));
    f32 sum = va + vb + vc;
    if (!(sum > 0.0f)) return a;
    return vec3_add(a, vec3_add(vec3_scale(ab, vb / sum), vec3_scale(ac, vc / sum)));
}

typedef struct Nearest {
    f32 distance2;
    Vec3 on_axis, on_shape;
} Nearest;

static void keep_nearer(Nearest *best, Vec3 on_axis, Vec3 on_shape) {
    Vec3 d = vec3_sub(on_axis, on_shape);
    f32 distance2 = vec3_dot(d, d);
    if (distance2 < best->distance2) *best = (Nearest){distance2, on_axis, on_shape};
}

// Two segments, the first with length > 0. Ericson, section 5.1.9, shortened: s is clamped, then t,
// then s follows once more.
static void nearest_of_segments(Nearest *best, Vec3 p, Vec3 d, Vec3 q, Vec3 e) {
    Vec3 r = vec3_sub(p, q);
    f32 dd = vec3_dot(d, d), ee = vec3_dot(e, e), de = vec3_dot(d, e), dr = vec3_dot(d, r),
        er = vec3_dot(e, r);
    f32 denominator = dd * ee - de * de;
    f32 s = denominator > 0.0f ? f32_saturate((de * er - dr * ee) / denominator) : 0.0f;
    f32 t = ee > 0.0f ? f32_saturate((de * s + er) / ee) : 0.0f;
    s = dd > 0.0f ? f32_saturate((de * t - dr) / dd) : 0.0f;
    keep_nearer(best, vec3_add(p, vec3_scale(d, s)), vec3_add(q, vec3_scale(e, t)));
}

// The axis (a segment) to a triangle: an end of the axis over the face, or the axis along an edge,
// or straight through the face.
static Nearest nearest_to_triangle(const Capsule *capsule, const NearTriangle *t) {
    Nearest best = {.distance2 = INFINITY};
    Vec3 axis = vec3_sub(capsule->high, capsule->low);
    keep_nearer(&best, capsule->low, closest_on_triangle(capsule->low, t->a, t->b, t->c));
    keep_nearer(&best, capsule->high, closest_on_triangle(capsule->high, t->a, t->b, t->c));
    nearest_of_segments(&best, capsule->low, axis, t->a, vec3_sub(t->b, t->a));
    nearest_of_segments(&best, capsule->low, axis, t->b, vec3_sub(t->c, t->b));
    nearest_of_segments(&best, capsule->low, axis, t->c, vec3_sub(t->a, t->c));
    f32 low = vec3_dot(vec3_sub(capsule->low, t->a), t->normal);
    f32 high = vec3_dot(vec3_sub(capsule->high, t->a), t->normal);
    if ((low < 0.0f) != (high < 0.0f)) {
        Vec3 through = vec3_add(capsule->low, vec3_scale(axis, low / (low - high)));
        keep_nearer(&best, through, closest_on_triangle(through, t->a, t->b, t->c));
    }
    return best;
}

static Contact contact_with_triangle(const Capsule *capsule, const NearTriangle *t) {
    Nearest nearest = nearest_to_triangle(capsule, t);
    Contact contact = {.depth = 0.0f, .point = nearest.on_shape};
    f32 radius2 = capsule->radius * capsule->radius;
    if (!(nearest.distance2 < radius2)) return contact;
    f32 distance = sqrtf(nearest.distance2);
    Vec3 middle = vec3_scale(vec3_add(capsule->low, capsule->high), 0.5f);
    f32 side = vec3_dot(vec3_sub(middle, t->a), t->normal) < 0.0f ? -1.0f : 1.0f;
    Vec3 out = vec3_scale(t->normal, side); // towards the larger part of the capsule
    contact.depth = capsule->radius - distance;
    contact.normal = distance > 1e-5f
                         ? vec3_scale(vec3_sub(nearest.on_axis, nearest.on_shape), 1.0f / distance)
                         : out;
    contact.at_foot = nearest.on_axis.y <= capsule->low.y;
    contact.facing = vec3_dot(vec3_sub(nearest.on_axis, t->a), t->normal) < 0.0f
                         ? vec3_scale(t->normal, -1.0f)
                         : t->normal;
    return contact;
}

// The capsule's axis is inside (a door closed over the walker): out through the nearest face.
// Triangles alone would hold it there.
static Contact contact_inside_box(const Capsule *capsule, const NearBox *box) {
    Contact contact = {.depth = 0.0f};
    Vec3 ends[3] = {capsule->low, vec3_scale(vec3_add(capsule->low, capsule->high), 0.5f),
                    capsule->high};
    for (u32 i = 0; i < 3; i++) {
        Vec3 unit = mat34_point(&box->to_unit, ends[i]);
        f32 place[3] = {unit.x, unit.y, unit.z}, least = INFINITY, to_face = 0.0f;
        if (!(fabsf(unit.x) < 1.0f && fabsf(unit.y) < 1.0f && fabsf(unit.z) < 1.0f)) continue;
        Vec3 normal = {0, 1, 0};
        for (u32 a = 0; a < 3; a++) {
            f32 way = (1.0f - fabsf(place[a])) * box->half_m[a];
            // Sideways rather than up or down, if that is not much farther.
            f32 cost = fabsf(box->axis[a].y) > 0.7f ? way * 2.0f + capsule->radius : way;
            if (cost >= least) continue;
            least = cost;
            to_face = way;
            normal = vec3_scale(box->axis[a], place[a] < 0.0f ? -1.0f : 1.0f);
        }
        if (to_face + capsule->radius > contact.depth)
            contact = (Contact){.depth = to_face + capsule->radius,
                                .normal = normal,
                                .point = ends[i],
                                .facing = normal,
                                .at_foot = false};
    }
    return contact;
}

Contact collision_deepest(const NearShapes *shapes, const Capsule *capsule) {
    Contact deepest = {.depth = 0.0f};
    f32 r = capsule->radius;
    for (u32 i = 0; i < shapes->box_count; i++) {
        Contact contact = contact_inside_box(capsule, &shapes->boxes[i]);
        if (contact.depth > deepest.depth) deepest = contact;
    }
    if (deepest.depth > 0.0f) return deepest;
    for (u32 i = 0; i < shapes->triangle_count; i++) {
        const NearTriangle *t = &shapes->triangles[i];
        if (t->min.x > capsule->low.x + r || t->max.x < capsule->low.x - r ||
            t->min.z > capsule->low.z + r || t->max.z < capsule->low.z - r ||
            t->min.y > capsule->high.y + r || t->max.y < capsule->low.y - r)
            continue;
        Contact contact = contact_with_triangle(capsule, t);
        if (contact.depth <= 0.0f) continue;
        // The edge of a step belongs to its riser and to its top alike: the top decides.
        bool same = fabsf(contact.depth - deepest.depth) < SAME_DEPTH_M;
        if (same ? contact.facing.y > deepest.facing.y : contact.depth > deepest.depth)
            deepest = contact;
    }
    return deepest;
}
