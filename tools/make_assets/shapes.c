// Solids and sweeps: see shapes.h. Arches have a file of their own (shapes_arch.c).
#include "shapes.h"

#define PROFILE_MAX 64

void shape_box(Soup *s, Vec3 lo, Vec3 hi, unsigned skip) { shape_taper_box(s, lo, hi, 0, 0, skip); }

void shape_taper_box(Soup *s, Vec3 lo, Vec3 hi, float ix, float iz, unsigned skip) {
    Vec3 p[8];
    for (int i = 0; i < 8; i++) {
        float kx = (i & 2) ? ix : 0, kz = (i & 2) ? iz : 0;
        p[i] = vec3((i & 1) ? hi.x - kx : lo.x + kx, (i & 2) ? hi.y : lo.y,
                    (i & 4) ? hi.z - kz : lo.z + kz);
    }
    if (!(skip & SKIP_LEFT)) soup_quad_box(s, p[0], p[4], p[6], p[2]);
    if (!(skip & SKIP_RIGHT)) soup_quad_box(s, p[5], p[1], p[3], p[7]);
    if (!(skip & SKIP_BOTTOM)) soup_quad_box(s, p[0], p[1], p[5], p[4]);
    if (!(skip & SKIP_TOP)) soup_quad_box(s, p[6], p[7], p[3], p[2]);
    if (!(skip & SKIP_BACK)) soup_quad_box(s, p[1], p[0], p[2], p[3]);
    if (!(skip & SKIP_FRONT)) soup_quad_box(s, p[4], p[5], p[7], p[6]);
}

// A corner of the bevelled box: the face's own coordinate is full, the other two are cut.
static Vec3 bevel_corner(Vec3 lo, Vec3 hi, float b, int corner, int full_axis) {
    float c[3];
    const float l[3] = {lo.x, lo.y, lo.z}, h[3] = {hi.x, hi.y, hi.z};
    for (int k = 0; k < 3; k++) {
        bool high = (corner >> k) & 1;
        float cut = k == full_axis ? 0 : b;
        c[k] = high ? h[k] - cut : l[k] + cut;
    }
    return vec3(c[0], c[1], c[2]);
}

// Adds a face with the winding that looks away from `inside`.
static void quad_away(Soup *s, Vec3 inside, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    Vec3 n = vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
    if (vec3_dot(n, vec3_sub(a, inside)) > 0)
        soup_quad_box(s, a, b, c, d);
    else
        soup_quad_box(s, d, c, b, a);
}

void shape_bevel_box(Soup *s, Vec3 lo, Vec3 hi, float b) {
    Vec3 mid = vec3_lerp(lo, hi, 0.5f);
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int side = 0; side < 2; side++) {
            int base = side << axis;
            quad_away(s, mid, bevel_corner(lo, hi, b, base, axis),
                      bevel_corner(lo, hi, b, base | 1 << u, axis),
                      bevel_corner(lo, hi, b, base | 1 << u | 1 << v, axis),
                      bevel_corner(lo, hi, b, base | 1 << v, axis));
        }
        // The four cut edges along this axis lie between the faces of the other two.
        for (int e = 0; e < 4; e++) {
            int base = (e & 1) << u | (e >> 1) << v;
            quad_away(s, mid, bevel_corner(lo, hi, b, base, u), bevel_corner(lo, hi, b, base, v),
                      bevel_corner(lo, hi, b, base | 1 << axis, v),
                      bevel_corner(lo, hi, b, base | 1 << axis, u));
        }
    }
    for (int c = 0; c < 8; c++) {
        Vec3 p[3];
        for (int k = 0; k < 3; k++) p[k] = bevel_corner(lo, hi, b, c, k);
        Vec3 n = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
        if (vec3_dot(n, vec3_sub(p[0], mid)) > 0)
            soup_triangle_box(s, p[0], p[1], p[2]);
        else
            soup_triangle_box(s, p[2], p[1], p[0]);
    }
}

void shape_post(Soup *s, Vec3 lo, Vec3 hi, float b, bool open) {
    const float x[8] = {lo.x + b, hi.x - b, hi.x, hi.x, hi.x - b, lo.x + b, lo.x, lo.x};
    const float z[8] = {hi.z, hi.z, hi.z - b, lo.z + b, lo.z, lo.z, lo.z + b, hi.z - b};
    for (int i = 0; i < 8; i++) {
        int k = (i + 1) % 8;
        soup_quad_box(s, vec3(x[i], lo.y, z[i]), vec3(x[k], lo.y, z[k]), vec3(x[k], hi.y, z[k]),
                      vec3(x[i], hi.y, z[i]));
        if (!open && i > 0 && i < 7)
            soup_triangle_box(s, vec3(x[0], hi.y, z[0]), vec3(x[i], hi.y, z[i]),
                              vec3(x[k], hi.y, z[k]));
    }
}

void shape_lathe(Soup *s, const Vec2 *profile, int count, int segments, float start_deg,
                 float sweep_deg) {
    float widest = 0, along = 0;
    for (int i = 0; i < count; i++) widest = fmaxf(widest, profile[i].x);
    // A whole number of repeats, so that the texture closes behind the seam.
    float around = fmaxf(1, roundf(widest * sweep_deg * PI_F / 180 / s->tile_m));
    if (widest * 4 < s->tile_m) around = widest * sweep_deg * PI_F / 180 / s->tile_m;
    for (int i = 0; i + 1 < count; i++) {
        Vec2 a = profile[i], b = profile[i + 1];
        float length = sqrtf((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
        float v0 = along / s->tile_m, v1 = (along + length) / s->tile_m;
        along += length;
        for (int k = 0; k < segments; k++) {
            float u0 = (float)k / (float)segments, u1 = (float)(k + 1) / (float)segments;
            float t0 = (start_deg + sweep_deg * u0) * PI_F / 180;
            float t1 = (start_deg + sweep_deg * u1) * PI_F / 180;
            Vec3 p0 = vec3(a.x * cosf(t0), a.y, -a.x * sinf(t0));
            Vec3 p1 = vec3(a.x * cosf(t1), a.y, -a.x * sinf(t1));
            Vec3 p2 = vec3(b.x * cosf(t1), b.y, -b.x * sinf(t1));
            Vec3 p3 = vec3(b.x * cosf(t0), b.y, -b.x * sinf(t0));
            soup_quad(s, p0, p1, p2, p3, vec2(u0 * around, v0), vec2(u1 * around, v0),
                      vec2(u1 * around, v1), vec2(u0 * around, v1));
        }
    }
}

void shape_turn(Soup *s, const Vec2 *profile, int count, int segments) {
    shape_lathe(s, profile, count, segments, 0, 360);
}

void shape_surface(Soup *s, ShapeSurface surface, const void *context, int nu, int nv,
                   Vec2 repeat) {
    for (int j = 0; j < nv; j++) {
        for (int i = 0; i < nu; i++) {
            float u0 = (float)i / (float)nu, u1 = (float)(i + 1) / (float)nu;
            float v0 = (float)j / (float)nv, v1 = (float)(j + 1) / (float)nv;
            soup_quad(s, surface(context, u0, v0), surface(context, u1, v0),
                      surface(context, u1, v1), surface(context, u0, v1),
                      vec2(u0 * repeat.x, v0 * repeat.y), vec2(u1 * repeat.x, v0 * repeat.y),
                      vec2(u1 * repeat.x, v1 * repeat.y), vec2(u0 * repeat.x, v1 * repeat.y));
        }
    }
}

static Vec3 frame_point(const SweepFrame *f, Vec2 p) {
    return vec3_mad(vec3_mad(f->origin, f->a, p.x), f->b, p.y);
}

void shape_sweep(Soup *s, const SweepFrame *frames, int frame_count, const Vec2 *profile,
                 int point_count, bool closed) {
    float along = 0;
    for (int i = 0; i + 1 < frame_count; i++) {
        float step = vec3_length(vec3_sub(frames[i + 1].origin, frames[i].origin));
        float v0 = along / s->tile_m, v1 = (along + step) / s->tile_m, across = 0;
        along += step;
        for (int j = 0; j + (closed ? 0 : 1) < point_count; j++) {
            Vec2 a = profile[j], b = profile[(j + 1) % point_count];
            float width = sqrtf((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
            float u0 = across / s->tile_m, u1 = (across + width) / s->tile_m;
            across += width;
            soup_quad(s, frame_point(frames + i, a), frame_point(frames + i, b),
                      frame_point(frames + i + 1, b), frame_point(frames + i + 1, a), vec2(u0, v0),
                      vec2(u1, v0), vec2(u1, v1), vec2(u0, v1));
        }
    }
}

void shape_moulding_x(Soup *s, float x0, float x1, float z, const Vec2 *profile, int count) {
    for (int j = 0; j + 1 < count; j++) {
        Vec2 a = profile[j], b = profile[j + 1];
        float width = sqrtf((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
        float k = 1 / s->tile_m;
        float v0 = a.y * k, v1 = v0 + width * k;
        soup_quad(s, vec3(x1, a.y, z - a.x), vec3(x0, a.y, z - a.x), vec3(x0, b.y, z - b.x),
                  vec3(x1, b.y, z - b.x), vec2(-x1 * k, v0), vec2(-x0 * k, v0), vec2(-x0 * k, v1),
                  vec2(-x1 * k, v1));
    }
}

void shape_tube(Soup *s, Vec3 from, Vec3 to, float r0, float r1, int segments, bool caps) {
    Affine saved = s->transform;
    Vec3 y = vec3_normalize(vec3_sub(to, from));
    Vec3 side = fabsf(y.y) < 0.95f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    Vec3 x = vec3_normalize(vec3_cross(side, y));
    Affine place = {x, y, vec3_cross(x, y), from};
    s->transform = affine_mul(&saved, &place);
    float h = vec3_length(vec3_sub(to, from));
    Vec2 profile[4] = {{0, 0}, {r0, 0}, {r1, h}, {0, h}};
    if (caps)
        shape_turn(s, profile, 4, segments);
    else
        shape_turn(s, profile + 1, 2, segments);
    s->transform = saved;
}

typedef struct TorusSize {
    float major, minor;
} TorusSize;

static Vec3 torus_point(const void *context, float u, float v) {
    const TorusSize *t = context;
    float a = u * 2 * PI_F, b = v * 2 * PI_F, r = t->major + t->minor * cosf(b);
    return vec3(r * cosf(a), t->minor * sinf(b), -r * sinf(a));
}

void shape_torus(Soup *s, float major, float minor, int segments, int sides) {
    TorusSize t = {major, minor};
    float around = fmaxf(1, roundf(2 * PI_F * major / s->tile_m));
    float across = 2 * PI_F * minor / s->tile_m;
    shape_surface(s, torus_point, &t, segments, sides, vec2(around, across));
}

void shape_ball(Soup *s, Vec3 center, Vec3 radius, int segments, int rings) {
    Affine saved = s->transform;
    Affine place = affine_scaling(radius.x, radius.y, radius.z);
    place.t = center;
    s->transform = affine_mul(&saved, &place);
    Vec2 profile[PROFILE_MAX];
    for (int i = 0; i <= rings; i++) {
        float a = -PI_F / 2 + PI_F * (float)i / (float)rings;
        profile[i] = vec2(i == 0 || i == rings ? 0 : cosf(a), sinf(a));
    }
    shape_turn(s, profile, rings + 1, segments);
    s->transform = saved;
}

void shape_octahedron(Soup *s, Vec3 c, float radius) {
    for (int i = 0; i < 8; i++) {
        Vec3 x = vec3(c.x + (i & 1 ? -radius : radius), c.y, c.z);
        Vec3 y = vec3(c.x, c.y + (i & 2 ? -radius : radius), c.z);
        Vec3 z = vec3(c.x, c.y, c.z + (i & 4 ? -radius : radius));
        bool flip = (i & 1) ^ (i >> 1 & 1) ^ (i >> 2 & 1);
        soup_triangle(s, x, flip ? z : y, flip ? y : z, vec2(0, 0), vec2(0, 0), vec2(0, 0));
    }
}

void shape_card_uv(Soup *s, Vec3 c, Vec3 r, Vec3 u, Vec2 lo, Vec2 hi) {
    soup_quad(s, vec3_sub(vec3_sub(c, r), u), vec3_sub(vec3_add(c, r), u),
              vec3_add(vec3_add(c, r), u), vec3_add(vec3_sub(c, r), u), lo, vec2(hi.x, lo.y), hi,
              vec2(lo.x, hi.y));
}

void shape_card(Soup *s, Vec3 c, Vec3 r, Vec3 u) {
    shape_card_uv(s, c, r, u, vec2(0, 0), vec2(1, 1));
}
