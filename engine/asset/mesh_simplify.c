// mesh_simplify.c: a mesh with fewer and fewer triangles, the least visible loss first.
//
// Data in: a full mesh. Data out: for a number of triangles, indices of its own vertices, and how
// far the surface then lies from the full one. Called by mesh_lods.c. Does not: move vertices, or
// decide how many triangles a level has.
//
// Edges collapse onto one of their ends (Garland and Heckbert, "Surface simplification using
// quadric error metrics", SIGGRAPH 1997). Vertices at one position are one `place` of the surface,
// so nothing opens along seams; each corner of a triangle has its own vertex there, its `wedge`
// (Hoppe, "New quadric metric for simplifying meshes with appearance attributes", 1999). Quadrics
// only guess what comes next: what a collapse costs is the largest distance of the places already
// gone from the triangles that stand for them (Ciampalini et al., "Multiresolution decimation based
// on global error", 1997), and how far normals, uvs and colours there are off. Rims may give way as
// surfaces do, at twice the price: behind them may be something of another colour.
//
// All lengths are in radii of the mesh.
#include "mesh_simplify.h"
#include "asset_internal.h"
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#define NONE         UINT32_MAX
#define STAR_CAP     128    // corners at a place; places with more stay
#define POINTS_CAP   6      // gone places that a triangle remembers
#define GUESS_SHARE  0.5f   // of the distance from a quadric's planes: more than the true cost
#define RIM_PRICE    1.0f   // of the distance from the planes of a rim, likewise
#define NORMAL_PRICE 0.15f  // of a normal off by 1, per length of its triangle
#define COLOR_PRICE  0.15f  // of a colour off by 1, likewise
#define UV_PRICE     0.3f   // of a texture's shift on the surface
#define TURN_MIN     0.1f   // least cosine by which a collapse may turn a triangle
#define AREA_MIN     1e-12f // twice the area; thinner triangles are none

// Sum of squared distances from planes, and of their weights.
typedef struct Quadric {
    f64 xx, xy, xz, yy, yz, zz, x, y, z, one, weight;
} Quadric;

typedef struct Look {
    Vec3 normal, color;
    f32 u, v;
} Look;

// A triangle of the place that goes, as it would be afterwards.
typedef struct FanTriangle {
    u32 corner, vertex; // the corner that moves, its new vertex
    Vec3 p[3];
    Look look[3];
    f32 size, uv_length; // root of the area; length on the surface of a unit of uv
} FanTriangle;

struct Simplifier {
    const Mesh *mesh;
    u32 triangle_count, live_count;
    f32 error; // of the worst collapse so far
    // By corner of a triangle. place: NONE at all three of one that is gone.
    u32 *place, *vertex, *next_corner;
    u32 *first_point; // by triangle: places gone that it stands for
    // By vertex, used at those that are places (the first vertex of their position).
    u32 *first_corner, *next_point, *stamp, *target, *heap_at;
    u32 *next_wedge; // ring of the vertices of a place
    Vec3 *position;
    Look *look;
    Quadric *surface, *rim;
    f32 *cost;
    u8 *exact; // cost is not only a guess
    u32 *heap, heap_count, stamps;
    FanTriangle fan[STAR_CAP];
    u32 fan_count;
};

// ---- quadrics ----

static void quadric_add_plane(Quadric *q, Vec3 n, Vec3 p, f64 weight) {
    f64 d = -((f64)n.x * p.x + (f64)n.y * p.y + (f64)n.z * p.z), w = weight;
    q->xx += w * n.x * n.x, q->xy += w * n.x * n.y, q->xz += w * n.x * n.z;
    q->yy += w * n.y * n.y, q->yz += w * n.y * n.z, q->zz += w * n.z * n.z;
    q->x += w * n.x * d, q->y += w * n.y * d, q->z += w * n.z * d;
    q->one += w * d * d, q->weight += w;
}

static void quadric_add(Quadric *q, const Quadric *b) {
    q->xx += b->xx, q->xy += b->xy, q->xz += b->xz, q->yy += b->yy, q->yz += b->yz, q->zz += b->zz;
    q->x += b->x, q->y += b->y, q->z += b->z, q->one += b->one, q->weight += b->weight;
}

// Root of the mean square distance of the planes.
static f32 quadric_distance(const Quadric *q, Vec3 p) {
    f64 x = p.x, y = p.y, z = p.z;
    f64 sum = x * (q->xx * x + 2 * (q->xy * y + q->xz * z + q->x)) +
              y * (q->yy * y + 2 * (q->yz * z + q->y)) + z * (q->zz * z + 2 * q->z) + q->one;
    return q->weight > 0 && sum > 0 ? (f32)sqrt(sum / q->weight) : 0.0f;
}

// ---- the heap: places by cost, equal ones by number ----

static bool heap_before(const Simplifier *s, u32 a, u32 b) {
    return s->cost[a] < s->cost[b] || (s->cost[a] == s->cost[b] && a < b);
}

static void heap_set(Simplifier *s, u32 at, u32 place) {
    s->heap[at] = place;
    s->heap_at[place] = at;
}

static void heap_sift(Simplifier *s, u32 at) {
    u32 place = s->heap[at];
    for (; at > 0 && heap_before(s, place, s->heap[(at - 1) / 2]); at = (at - 1) / 2)
        heap_set(s, at, s->heap[(at - 1) / 2]);
    for (;;) {
        u32 child = 2 * at + 1;
        if (child >= s->heap_count) break;
        if (child + 1 < s->heap_count && heap_before(s, s->heap[child + 1], s->heap[child]))
            child++;
        if (!heap_before(s, s->heap[child], place)) break;
        heap_set(s, at, s->heap[child]);
        at = child;
    }
    heap_set(s, at, place);
}

static void heap_remove(Simplifier *s, u32 place) {
    u32 at = s->heap_at[place];
    s->heap_at[place] = NONE;
    u32 last = s->heap[--s->heap_count];
    if (at == s->heap_count) return;
    heap_set(s, at, last);
    heap_sift(s, at);
}

// ---- what is around a place ----

static u32 corner_next(u32 c) { return c % 3 == 2 ? c - 2 : c + 1; }
static u32 corner_last(u32 c) { return c % 3 == 0 ? c + 2 : c - 1; }

// Corners at a place, those of triangles that are gone taken out of its list. 0: more than fit.
static u32 gather_star(Simplifier *s, u32 place, u32 star[STAR_CAP]) {
    u32 count = 0;
    for (u32 *link = &s->first_corner[place]; *link != NONE;) {
        u32 c = *link;
        if (s->place[c] == NONE) {
            *link = s->next_corner[c];
            continue;
        }
        if (count == STAR_CAP) return 0;
        star[count++] = c;
        link = &s->next_corner[c];
    }
    return count;
}

// Places joined to those corners by an edge, each once, with the current stamp.
static u32 gather_ring(Simplifier *s, const u32 *star, u32 count, u32 ring[2 * STAR_CAP]) {
    u32 found = 0, stamp = ++s->stamps;
    for (u32 i = 0; i < count; i++)
        for (u32 side = 0; side < 2; side++) {
            u32 other = s->place[side ? corner_next(star[i]) : corner_last(star[i])];
            if (s->stamp[other] == stamp) continue;
            s->stamp[other] = stamp;
            ring[found++] = other;
        }
    return found;
}

static f32 guess_cost(const Simplifier *s, u32 from, u32 to) {
    return fmaxf(GUESS_SHARE * quadric_distance(&s->surface[from], s->position[to]),
                 RIM_PRICE * quadric_distance(&s->rim[from], s->position[to]));
}

static void guess_place(Simplifier *s, u32 place) {
    u32 star[STAR_CAP], ring[2 * STAR_CAP];
    u32 count = gather_ring(s, star, gather_star(s, place, star), ring);
    s->cost[place] = INFINITY, s->exact[place] = 0;
    for (u32 i = 0; i < count; i++) {
        f32 cost = guess_cost(s, place, ring[i]);
        if (cost < s->cost[place]) s->cost[place] = cost;
    }
}

// ---- what a collapse costs ----

static Vec3 cross_of(const Vec3 p[3]) {
    return vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
}

static void measure(FanTriangle *t) {
    const Look *a = &t->look[0], *b = &t->look[1], *c = &t->look[2];
    f32 twice = vec3_length(cross_of(t->p));
    f32 twice_uv = fabsf((b->u - a->u) * (c->v - a->v) - (c->u - a->u) * (b->v - a->v));
    t->size = sqrtf(0.5f * twice);
    // Textures stretched to lines have no length, and are forgiven.
    t->uv_length = twice_uv > 1e-8f * twice ? sqrtf(twice / twice_uv) : 0.0f;
}

// Weights of the corners at the point of a triangle that is nearest to p (Ericson, "Real-Time
// Collision Detection", 5.1.5), and its squared distance.
static f32 nearest_point(const Vec3 t[3], Vec3 p, f32 weights[3]) {
    Vec3 ab = vec3_sub(t[1], t[0]), ac = vec3_sub(t[2], t[0]), ap = vec3_sub(p, t[0]);
    Vec3 bp = vec3_sub(p, t[1]), cp = vec3_sub(p, t[2]);
    f32 d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap), d3 = vec3_dot(ab, bp), d4 = vec3_dot(ac, bp),
        d5 = vec3_dot(ab, cp), d6 = vec3_dot(ac, cp);
    f32 va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    f32 v = 0, w = 0;
    if (d1 <= 0 && d2 <= 0)
        v = w = 0;
    else if (d3 >= 0 && d4 <= d3)
        v = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        v = d1 / (d1 - d3);
    else if (d6 >= 0 && d5 <= d6)
        w = 1;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        w = d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6)), v = 1 - w;
    else
        v = vb / (va + vb + vc), w = vc / (va + vb + vc);
    weights[0] = 1 - v - w, weights[1] = v, weights[2] = w;
    Vec3 at = vec3_add(t[0], vec3_add(vec3_scale(ab, v), vec3_scale(ac, w)));
    Vec3 off = vec3_sub(p, at);
    return vec3_dot(off, off);
}

static f32 look_cost(const Look *a, const Look *b, f32 size, f32 uv_length) {
    f32 du = a->u - b->u, dv = a->v - b->v;
    return size * (NORMAL_PRICE * vec3_length(vec3_sub(a->normal, b->normal)) +
                   COLOR_PRICE * vec3_length(vec3_sub(a->color, b->color))) +
           UV_PRICE * uv_length * sqrtf(du * du + dv * dv);
}

static Look look_between(const Look look[3], const f32 w[3]) {
    Look out = {.u = look[0].u * w[0] + look[1].u * w[1] + look[2].u * w[2],
                .v = look[0].v * w[0] + look[1].v * w[1] + look[2].v * w[2]};
    for (u32 k = 0; k < 3; k++) {
        out.normal = vec3_add(out.normal, vec3_scale(look[k].normal, w[k]));
        out.color = vec3_add(out.color, vec3_scale(look[k].color, w[k]));
    }
    out.normal = vec3_normalize(out.normal);
    return out;
}

// How far a place that is gone lies from the fan, or differs from it; which triangle stands for it.
static f32 point_cost(const Simplifier *s, u32 point, u32 *nearest) {
    f32 best = INFINITY, weights[3] = {1, 0, 0};
    *nearest = 0;
    for (u32 i = 0; i < s->fan_count; i++) {
        f32 w[3], distance2 = nearest_point(s->fan[i].p, s->position[point], w);
        if (!(distance2 < best)) continue;
        best = distance2;
        *nearest = i;
        memcpy(weights, w, sizeof weights);
    }
    const FanTriangle *t = &s->fan[*nearest];
    Look here = look_between(t->look, weights);
    f32 look = INFINITY;
    u32 wedge = point;
    do {
        look = fminf(look, look_cost(&s->look[wedge], &here, t->size, t->uv_length));
        wedge = s->next_wedge[wedge];
    } while (wedge != point);
    return fmaxf(sqrtf(best), look);
}

// The vertex at `to` that a corner now at `from` gets: what the triangles between the two have
// there; else the one most like what the corner's own surface would have there, at the price of the
// difference.
static u32 move_wedge(const Simplifier *s, u32 corner, const u32 *star, u32 star_count, u32 to,
                      f32 *price) {
    u32 old = s->vertex[corner];
    for (u32 i = 0; i < star_count; i++) {
        u32 n = corner_next(star[i]), l = corner_last(star[i]);
        if (s->vertex[star[i]] != old) continue;
        if (s->place[n] == to) return s->vertex[n];
        if (s->place[l] == to) return s->vertex[l];
    }
    FanTriangle own = {0};
    u32 first = corner - corner % 3;
    for (u32 k = 0; k < 3; k++) {
        own.p[k] = s->position[s->place[first + k]];
        own.look[k] = s->look[s->vertex[first + k]];
    }
    measure(&own);
    // The surface's uvs go on in a straight line, normals stay.
    Vec3 ab = vec3_sub(own.p[1], own.p[0]), ac = vec3_sub(own.p[2], own.p[0]);
    Vec3 move = vec3_sub(s->position[to], s->position[s->place[corner]]);
    f32 bb = vec3_dot(ab, ab), bc = vec3_dot(ab, ac), cc = vec3_dot(ac, ac);
    f32 det = bb * cc - bc * bc, mb = vec3_dot(move, ab), mc = vec3_dot(move, ac);
    f32 v = det > 0 ? (mb * cc - mc * bc) / det : 0, w = det > 0 ? (mc * bb - mb * bc) / det : 0;
    Look want = s->look[old];
    want.u += (own.look[1].u - own.look[0].u) * v + (own.look[2].u - own.look[0].u) * w;
    want.v += (own.look[1].v - own.look[0].v) * v + (own.look[2].v - own.look[0].v) * w;
    f32 size = fmaxf(own.size, vec3_length(move)), least = INFINITY;
    u32 wedge = to, best = to;
    do {
        f32 cost = look_cost(&s->look[wedge], &want, size, own.uv_length);
        if (cost < least) least = cost, best = wedge;
        wedge = s->next_wedge[wedge];
    } while (wedge != to);
    *price = fmaxf(*price, least);
    return best;
}

// Cost of moving all corners at `from` to `to`; INFINITY where that would tear or fold the surface,
// or where it costs more than `limit`. Fills the fan.
static f32 collapse_cost(Simplifier *s, u32 from, u32 to, f32 limit) {
    f32 cost = guess_cost(s, from, to);
    if (!(cost < limit)) return INFINITY;
    u32 star[STAR_CAP], star_to[STAR_CAP], ring[2 * STAR_CAP];
    u32 count = gather_star(s, from, star), count_to = gather_star(s, to, star_to);
    if (count == 0 || count_to == 0) return INFINITY;
    // Common neighbours are those of the triangles that vanish, and no others.
    u32 common = 0, thirds = 0, mark;
    gather_ring(s, star, count, ring);
    mark = s->stamps;
    for (u32 i = 0; i < count_to; i++)
        for (u32 side = 0; side < 2; side++) {
            u32 other = s->place[side ? corner_next(star_to[i]) : corner_last(star_to[i])];
            if (s->stamp[other] == mark) common++, s->stamp[other] = mark - 1;
        }
    s->fan_count = 0;
    for (u32 i = 0; i < count; i++) {
        u32 n = corner_next(star[i]), l = corner_last(star[i]);
        bool vanishes = s->place[n] == to || s->place[l] == to;
        u32 third = s->place[n] == to ? s->place[l] : s->place[n];
        if (vanishes) {
            thirds += s->stamp[third] != 0;
            s->stamp[third] = 0;
            continue;
        }
        FanTriangle *t = &s->fan[s->fan_count++];
        Vec3 before[3];
        u32 first = star[i] - star[i] % 3;
        t->corner = star[i];
        t->vertex = move_wedge(s, star[i], star, count, to, &cost);
        for (u32 k = 0; k < 3; k++) {
            u32 c = first + k;
            before[k] = s->position[s->place[c]];
            t->p[k] = c == star[i] ? s->position[to] : before[k];
            t->look[k] = s->look[c == star[i] ? t->vertex : s->vertex[c]];
        }
        Vec3 was = cross_of(before), is = cross_of(t->p);
        f32 lengths = vec3_length(was) * vec3_length(is);
        if (!(vec3_length(is) > AREA_MIN) || !(vec3_dot(was, is) > TURN_MIN * lengths))
            return INFINITY;
        measure(t);
        if (!(cost < limit)) return INFINITY;
    }
    if (common != thirds) return INFINITY;
    if (s->fan_count == 0)
        return fmaxf(cost, vec3_length(vec3_sub(s->position[from], s->position[to])));
    u32 nearest;
    cost = fmaxf(cost, point_cost(s, from, &nearest));
    for (u32 i = 0; i < count && cost < limit; i++)
        for (u32 p = s->first_point[star[i] / 3]; p != NONE && cost < limit; p = s->next_point[p])
            cost = fmaxf(cost, point_cost(s, p, &nearest));
    return cost < limit ? cost : INFINITY; // also not a number
}

static void find_target(Simplifier *s, u32 from) {
    u32 star[STAR_CAP], ring[2 * STAR_CAP];
    u32 count = gather_ring(s, star, gather_star(s, from, star), ring);
    s->cost[from] = INFINITY, s->target[from] = NONE, s->exact[from] = 1;
    for (u32 i = 0; i < count; i++) {
        f32 cost = collapse_cost(s, from, ring[i], s->cost[from]);
        if (cost < s->cost[from]) s->cost[from] = cost, s->target[from] = ring[i];
    }
}

// ---- collapsing ----

static void remember_point(Simplifier *s, u32 point) {
    if (s->fan_count == 0) return;
    u32 nearest, held = 0;
    point_cost(s, point, &nearest);
    u32 *first = &s->first_point[s->fan[nearest].corner / 3];
    for (u32 p = *first; p != NONE; p = s->next_point[p]) held++;
    if (held >= POINTS_CAP) return;
    s->next_point[point] = *first;
    *first = point;
}

// The fan is that of this collapse.
static void collapse(Simplifier *s, u32 from, u32 to) {
    u32 star[STAR_CAP], ring[2 * STAR_CAP];
    u32 count = gather_star(s, from, star), points = from;
    s->next_point[from] = NONE;
    for (u32 i = 0; i < count; i++) {
        u32 triangle = star[i] / 3, *end = &s->first_point[triangle];
        while (*end != NONE) end = &s->next_point[*end];
        *end = points;
        points = s->first_point[triangle];
        s->first_point[triangle] = NONE;
        bool vanishes =
            s->place[corner_next(star[i])] == to || s->place[corner_last(star[i])] == to;
        if (!vanishes) continue;
        for (u32 k = 0; k < 3; k++) s->place[3 * triangle + k] = NONE;
        s->live_count--;
    }
    for (u32 i = 0; i < s->fan_count; i++) {
        u32 c = s->fan[i].corner;
        s->place[c] = to;
        s->vertex[c] = s->fan[i].vertex;
        s->next_corner[c] = s->first_corner[to];
        s->first_corner[to] = c;
    }
    s->first_corner[from] = NONE;
    for (u32 p = points, next; p != NONE; p = next) {
        next = s->next_point[p];
        remember_point(s, p);
    }
    quadric_add(&s->surface[to], &s->surface[from]);
    quadric_add(&s->rim[to], &s->rim[from]);
    heap_remove(s, from);
    u32 ring_count = gather_ring(s, star, gather_star(s, to, star), ring);
    ring[ring_count++] = to;
    for (u32 i = 0; i < ring_count; i++)
        if (s->heap_at[ring[i]] != NONE) {
            guess_place(s, ring[i]);
            heap_sift(s, s->heap_at[ring[i]]);
        }
}

f32 simplify_until(Simplifier *s, u32 triangles, f32 error_max, f32 slack) {
    f32 limit = error_max / s->mesh->radius;
    bool reached = false;
    while (s->heap_count > 0) {
        u32 from = s->heap[0];
        if (!reached && s->live_count <= triangles) {
            reached = true;
            limit = fminf(limit, s->error * slack);
        }
        if (!(s->cost[from] <= limit)) break;
        if (!s->exact[from]) {
            find_target(s, from);
        } else {
            f32 cost = collapse_cost(s, from, s->target[from], INFINITY);
            if (cost <= s->cost[from]) {
                s->error = fmaxf(s->error, s->cost[from]);
                collapse(s, from, s->target[from]);
                continue;
            }
            s->cost[from] = cost; // something farther away has changed
        }
        heap_sift(s, 0);
    }
    return s->error * s->mesh->radius;
}

u32 simplify_triangles(const Simplifier *s) { return s->live_count; }

u32 simplify_write(const Simplifier *s, u32 *indices) {
    u32 count = 0;
    for (u32 c = 0; c < 3 * s->triangle_count; c++)
        if (s->place[c] != NONE) indices[count++] = s->vertex[c];
    return count;
}

// ---- beginning ----

static bool allocate(Simplifier *s, Arena *scratch, u32 vertices, u32 triangles) {
    u32 **by_corner[] = {&s->place, &s->vertex, &s->next_corner};
    u32 **by_vertex[] = {&s->first_corner, &s->next_point, &s->stamp,     &s->target,
                         &s->heap_at,      &s->heap,       &s->next_wedge};
    for (u32 i = 0; i < COUNT_OF(by_corner); i++)
        if (!(*by_corner[i] = scratch_try_push(scratch, 3 * (u64)triangles, sizeof(u32))))
            return false;
    for (u32 i = 0; i < COUNT_OF(by_vertex); i++)
        if (!(*by_vertex[i] = scratch_try_push(scratch, vertices, sizeof(u32)))) return false;
    return (s->first_point = scratch_try_push(scratch, triangles, sizeof(u32))) &&
           (s->position = scratch_try_push(scratch, vertices, sizeof *s->position)) &&
           (s->look = scratch_try_push(scratch, vertices, sizeof *s->look)) &&
           (s->surface = scratch_try_push(scratch, vertices, sizeof *s->surface)) &&
           (s->rim = scratch_try_push(scratch, vertices, sizeof *s->rim)) &&
           (s->cost = scratch_try_push(scratch, vertices, sizeof *s->cost)) &&
           (s->exact = scratch_try_push(scratch, vertices, sizeof *s->exact));
}

static void read_vertices(Simplifier *s) {
    const Mesh *mesh = s->mesh;
    f32 unit = 1.0f / mesh->radius;
    for (u32 i = 0; i < mesh->vertex_count; i++) {
        const MeshVertex *v = &mesh->vertices[i];
        Vec3 p = vec3(v->position[0], v->position[1], v->position[2]);
        s->position[i] = vec3_scale(vec3_sub(p, mesh->center), unit);
        s->look[i] =
            (Look){asset_unpack_normal(v->normal),
                   vec3((f32)(v->color & 255) / 255.0f, (f32)(v->color >> 8 & 255) / 255.0f,
                        (f32)(v->color >> 16 & 255) / 255.0f),
                   v->uv[0], v->uv[1]};
        s->first_corner[i] = s->heap_at[i] = s->next_point[i] = NONE;
        s->next_wedge[i] = i;
        s->stamp[i] = 0;
        s->surface[i] = s->rim[i] = (Quadric){0};
    }
}

// Has the edge that leaves this corner a triangle on its other side?
static bool has_neighbour(const Simplifier *s, u32 corner) {
    u32 from = s->place[corner], to = s->place[corner_next(corner)], looked_at = 0;
    for (u32 c = s->first_corner[to]; c != NONE && looked_at < STAR_CAP; c = s->next_corner[c]) {
        if (s->place[corner_next(c)] == from) return true;
        looked_at++;
    }
    return false;
}

static void read_triangles(Simplifier *s) {
    const Mesh *mesh = s->mesh;
    meshopt_generateShadowIndexBuffer(s->place, mesh->indices, mesh->index_count, mesh->vertices,
                                      mesh->vertex_count, sizeof mesh->vertices->position,
                                      sizeof *mesh->vertices);
    for (u32 c = 0; c < mesh->index_count; c++) {
        u32 place = s->place[c], vertex = s->vertex[c] = mesh->indices[c];
        if (vertex == place || s->next_wedge[vertex] != vertex) continue;
        s->next_wedge[vertex] = s->next_wedge[place];
        s->next_wedge[place] = vertex;
    }
    for (u32 t = 0; t < s->triangle_count; t++) {
        u32 *p = &s->place[3 * t];
        s->first_point[t] = NONE;
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) {
            p[0] = p[1] = p[2] = NONE;
            continue;
        }
        s->live_count++;
        Vec3 corners[3] = {s->position[p[0]], s->position[p[1]], s->position[p[2]]};
        Vec3 cross = cross_of(corners);
        for (u32 k = 0; k < 3; k++) {
            s->next_corner[3 * t + k] = s->first_corner[p[k]];
            s->first_corner[p[k]] = 3 * t + k;
            quadric_add_plane(&s->surface[p[k]], vec3_normalize(cross), corners[0],
                              0.5 * vec3_length(cross));
        }
    }
    for (u32 c = 0; c < mesh->index_count; c++) {
        if (s->place[c] == NONE || has_neighbour(s, c)) continue;
        u32 a = s->place[c], b = s->place[corner_next(c)], o = s->place[corner_last(c)];
        Vec3 p[3] = {s->position[a], s->position[b], s->position[o]};
        Vec3 along = vec3_sub(p[1], p[0]);
        Vec3 out = vec3_normalize(vec3_cross(along, vec3_normalize(cross_of(p))));
        quadric_add_plane(&s->rim[a], out, p[0], vec3_dot(along, along));
        quadric_add_plane(&s->rim[b], out, p[0], vec3_dot(along, along));
    }
}

Simplifier *simplify_begin(Arena *scratch, const Mesh *mesh) {
    Simplifier *s = scratch_try_push(scratch, 1, sizeof *s);
    if (!s) return NULL;
    *s = (Simplifier){.mesh = mesh, .triangle_count = mesh->index_count / 3, .stamps = 1};
    if (!allocate(s, scratch, mesh->vertex_count, s->triangle_count)) return NULL;
    read_vertices(s);
    read_triangles(s);
    for (u32 i = 0; i < mesh->vertex_count; i++)
        if (s->first_corner[i] != NONE) {
            guess_place(s, i);
            heap_set(s, s->heap_count, i);
            heap_sift(s, s->heap_count++);
        }
    return s;
}
