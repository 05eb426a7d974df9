// Arches: the moulded ring, the wall around it and the plate that closes it. See shapes.h.
#include "shapes.h"

// Both halves are arcs of one radius around centres that lie `pointed` half spans beyond the
// axis. Parallel curves share the centres, so their apex angles differ: each offset has its own.
Vec2 arch_point(const Arch *a, float offset, float t) {
    float center = a->pointed * a->half_span;
    float radius = a->half_span + center + offset;
    float apex = acosf(float_clamp(center / radius, -1, 1));
    float side = t < 0.5f ? -1.0f : 1.0f;
    float angle = apex * (t < 0.5f ? t * 2 : 2 - t * 2);
    return vec2(side * (radius * cosf(angle) - center), a->spring_y + radius * sinf(angle));
}

float arch_rise(const Arch *a, float offset) { return arch_point(a, offset, 0.5f).y - a->spring_y; }

void shape_arch_moulding(Soup *s, const Arch *a, const Vec2 *profile, int count, int segments,
                         int stones, int other) {
    int surface = s->surface_now;
    float across = 0, k = 1 / s->tile_m;
    for (int j = 0; j + 1 < count; j++) {
        Vec2 p = profile[j], q = profile[j + 1];
        float width = sqrtf((q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y));
        float along = 0;
        for (int i = 0; i < segments; i++) {
            float t0 = (float)i / (float)segments, t1 = (float)(i + 1) / (float)segments;
            Vec2 p0 = arch_point(a, p.x, t0), p1 = arch_point(a, p.x, t1);
            Vec2 q0 = arch_point(a, q.x, t0), q1 = arch_point(a, q.x, t1);
            float step = sqrtf((p1.x - p0.x) * (p1.x - p0.x) + (p1.y - p0.y) * (p1.y - p0.y));
            if (other >= 0) {
                bool odd = ((i * stones) / segments) & 1;
                soup_use(s, odd ? other : surface);
            }
            soup_quad(s, vec3(p0.x, p0.y, p.y), vec3(q0.x, q0.y, q.y), vec3(q1.x, q1.y, q.y),
                      vec3(p1.x, p1.y, p.y), vec2(across * k, along * k),
                      vec2((across + width) * k, along * k),
                      vec2((across + width) * k, (along + step) * k),
                      vec2(across * k, (along + step) * k));
            along += step;
        }
        across += width;
    }
    soup_use(s, surface);
}

static void quad_facing(Soup *s, float facing, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    if (facing > 0)
        soup_quad_box(s, a, b, c, d);
    else
        soup_quad_box(s, d, c, b, a);
}

void shape_spandrel(Soup *s, const Arch *a, float offset, float x_lo, float x_hi, float y_bottom,
                    float y_top, float z, float facing, int segments) {
    float edge = arch_point(a, offset, 1).x;
    for (int i = 0; i < segments; i++) {
        Vec2 p = arch_point(a, offset, (float)i / (float)segments);
        Vec2 q = arch_point(a, offset, (float)(i + 1) / (float)segments);
        quad_facing(s, facing, vec3(p.x, p.y, z), vec3(q.x, q.y, z), vec3(q.x, y_top, z),
                    vec3(p.x, y_top, z));
    }
    if (x_lo < -edge)
        quad_facing(s, facing, vec3(x_lo, y_bottom, z), vec3(-edge, y_bottom, z),
                    vec3(-edge, y_top, z), vec3(x_lo, y_top, z));
    if (x_hi > edge)
        quad_facing(s, facing, vec3(edge, y_bottom, z), vec3(x_hi, y_bottom, z),
                    vec3(x_hi, y_top, z), vec3(edge, y_top, z));
}

void shape_arch_plate(Soup *s, const Arch *a, float offset, float y_bottom, float z, float facing,
                      int segments) {
    for (int i = 0; i < segments; i++) {
        Vec2 p = arch_point(a, offset, (float)i / (float)segments);
        Vec2 q = arch_point(a, offset, (float)(i + 1) / (float)segments);
        quad_facing(s, facing, vec3(p.x, y_bottom, z), vec3(q.x, y_bottom, z), vec3(q.x, q.y, z),
                    vec3(p.x, p.y, z));
    }
}

void shape_jambs(Soup *s, const Arch *a, const Vec2 *profile, int count, float y_bottom) {
    float across = 0, k = 1 / s->tile_m, y0 = y_bottom, y1 = a->spring_y;
    for (int j = 0; j + 1 < count; j++) {
        Vec2 p = profile[j], q = profile[j + 1];
        float width = sqrtf((q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y));
        float xp = a->half_span + p.x, xq = a->half_span + q.x;
        Vec2 u0 = vec2(across * k, y0 * k), u1 = vec2((across + width) * k, y0 * k);
        Vec2 u2 = vec2((across + width) * k, y1 * k), u3 = vec2(across * k, y1 * k);
        soup_quad(s, vec3(-xp, y0, p.y), vec3(-xq, y0, q.y), vec3(-xq, y1, q.y), vec3(-xp, y1, p.y),
                  u0, u1, u2, u3);
        soup_quad(s, vec3(xp, y1, p.y), vec3(xq, y1, q.y), vec3(xq, y0, q.y), vec3(xp, y0, p.y), u3,
                  u2, u1, u0);
        across += width;
    }
}
