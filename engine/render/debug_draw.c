// debug_draw.c: shapes of the world as triangles in pixels.
// Data in: shapes, a packet's camera. Data out: vertices of GPU_VERTEX_UI, with a depth in place of
// a texture coordinate: it is linear on the screen, so a triangle's corners carry all of it.
// Called by: debug_views.c. Does not: draw, or keep anything.
#include "debug_draw.h"

#define LINE_HALF_PX 0.6f
#define CIRCLE_MAX   48 // segments

static OverlayVertex vertex(f32 x, f32 y, f32 depth, u32 color) {
    return (OverlayVertex){x, y, depth, 0.0f, color};
}

// Corners in order around it.
static void add_quad(DebugDraw *draw, const OverlayVertex corners[4]) {
    static const u32 order[6] = {0, 1, 2, 0, 2, 3};
    if (draw->count + 6 > draw->cap) {
        draw->left_out++;
        return;
    }
    for (u32 i = 0; i < 6; i++) draw->vertices[draw->count++] = corners[order[i]];
}

// --- Projection ---

typedef struct Clip {
    f32 x, y, w; // z is the near plane's distance everywhere (reversed depth, infinite far)
} Clip;

static Clip to_clip(const DebugDraw *draw, Vec3 p) {
    const f32 *m = draw->packet->frame.view_projection;
    return (Clip){m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
                  m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                  m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15]};
}

static Vec3 to_pixels(const DebugDraw *draw, Clip c) {
    const f32 *viewport = draw->packet->frame.viewport;
    return vec3((c.x / c.w * 0.5f + 0.5f) * viewport[0], (0.5f - c.y / c.w * 0.5f) * viewport[1],
                draw->packet->frame.camera[3] / c.w);
}

bool debug_project(const DebugDraw *draw, Vec3 point, Vec3 *out) {
    Clip c = to_clip(draw, point);
    if (!(c.w >= draw->packet->frame.camera[3])) return false;
    *out = to_pixels(draw, c);
    return true;
}

// --- Lines ---

static void line_px(DebugDraw *draw, Vec3 a, Vec3 b, u32 color) {
    f32 x = b.x - a.x, y = b.y - a.y, length = sqrtf(x * x + y * y);
    if (!(length > 1e-3f)) return;
    f32 nx = -y / length * LINE_HALF_PX, ny = x / length * LINE_HALF_PX;
    add_quad(draw, (OverlayVertex[4]){vertex(a.x + nx, a.y + ny, a.z, color),
                                      vertex(b.x + nx, b.y + ny, b.z, color),
                                      vertex(b.x - nx, b.y - ny, b.z, color),
                                      vertex(a.x - nx, a.y - ny, a.z, color)});
}

void debug_line(DebugDraw *draw, Vec3 a, Vec3 b, u32 color) {
    f32 near = draw->packet->frame.camera[3];
    Clip p = to_clip(draw, a), q = to_clip(draw, b);
    if (!(p.w > near || q.w > near)) return;
    if ((p.x < -p.w && q.x < -q.w) || (p.x > p.w && q.x > q.w) || (p.y < -p.w && q.y < -q.w) ||
        (p.y > p.w && q.y > q.w))
        return; // beside the picture
    // The part behind the near plane is cut off.
    if (p.w < near || q.w < near) {
        f32 t = (near - p.w) / (q.w - p.w);
        Clip cut = {p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t, near};
        if (p.w < near)
            p = cut;
        else
            q = cut;
    }
    line_px(draw, to_pixels(draw, p), to_pixels(draw, q), color);
}

static const f32 (*unit_circle(void))[2] {
    static f32 points[CIRCLE_MAX + 1][2];
    for (u32 i = 0; i <= CIRCLE_MAX && points[0][0] == 0.0f; i++) {
        f32 angle_rad = (f32)(CIRCLE_MAX - i) * (2.0f * 3.14159265f / CIRCLE_MAX);
        points[CIRCLE_MAX - i][0] = det_cos(angle_rad);
        points[CIRCLE_MAX - i][1] = det_sin(angle_rad);
    }
    return (const f32(*)[2])points;
}

// u and v: half-axes.
static void circle(DebugDraw *draw, Vec3 center, Vec3 u, Vec3 v, u32 step, u32 color) {
    const f32(*points)[2] = unit_circle();
    Vec3 last = vec3_add(center, u);
    for (u32 i = step; i <= CIRCLE_MAX; i += step) {
        Vec3 next =
            vec3_add(center, vec3_add(vec3_scale(u, points[i][0]), vec3_scale(v, points[i][1])));
        debug_line(draw, last, next, color);
        last = next;
    }
}

// Every how many of the circle's points is enough for a ball of this size on the picture.
static u32 circle_step(const DebugDraw *draw, Vec3 center, f32 radius) {
    Clip c = to_clip(draw, center);
    f32 scale = draw->packet->frame.viewport[1] * 0.5f /
                vec3_length(vec3(draw->packet->frame.ray_up[0], draw->packet->frame.ray_up[1],
                                 draw->packet->frame.ray_up[2]));
    f32 radius_px = radius * scale / MAX(c.w, draw->packet->frame.camera[3]);
    return radius_px > 80.0f ? 1 : radius_px > 30.0f ? 2 : radius_px > 12.0f ? 4 : 6;
}

void debug_ball(DebugDraw *draw, Vec3 center, f32 radius, u32 color) {
    Vec3 eye = vec3(draw->packet->frame.camera[0], draw->packet->frame.camera[1],
                    draw->packet->frame.camera[2]);
    Vec3 to = vec3_sub(center, eye);
    f32 distance = vec3_length(to);
    if (!(distance > radius)) return; // seen from inside
    // The circle where rays from the eye touch the ball.
    f32 sine = radius / distance, cosine = sqrtf(MAX(1.0f - sine * sine, 0.0f));
    Vec3 axis = vec3_scale(to, 1.0f / distance);
    Vec3 side = fabsf(axis.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    Vec3 u = vec3_normalize(vec3_cross(axis, side)), v = vec3_cross(axis, u);
    circle(draw, vec3_sub(center, vec3_scale(axis, radius * sine)), vec3_scale(u, radius * cosine),
           vec3_scale(v, radius * cosine), circle_step(draw, center, radius), color);
}

void debug_sphere(DebugDraw *draw, Vec3 center, f32 radius, u32 color) {
    u32 step = circle_step(draw, center, radius);
    Vec3 x = vec3(radius, 0, 0), y = vec3(0, radius, 0), z = vec3(0, 0, radius);
    circle(draw, center, x, y, step, color);
    circle(draw, center, y, z, step, color);
    circle(draw, center, z, x, step, color);
}

void debug_cone(DebugDraw *draw, Vec3 tip, Vec3 axis, f32 reach, f32 cos_half, u32 color) {
    f32 sin_half = sqrtf(MAX(1.0f - cos_half * cos_half, 0.0f));
    Vec3 side = fabsf(axis.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
    Vec3 u = vec3_normalize(vec3_cross(axis, side)), v = vec3_cross(axis, u);
    Vec3 center = vec3_add(tip, vec3_scale(axis, reach * cos_half));
    u = vec3_scale(u, reach * sin_half);
    v = vec3_scale(v, reach * sin_half);
    circle(draw, center, u, v, circle_step(draw, center, reach * sin_half), color);
    debug_line(draw, tip, vec3_add(center, u), color);
    debug_line(draw, tip, vec3_sub(center, u), color);
    debug_line(draw, tip, vec3_add(center, v), color);
    debug_line(draw, tip, vec3_sub(center, v), color);
    debug_line(draw, tip, vec3_add(tip, vec3_scale(axis, reach)), color);
}

// --- Marks ---

void debug_disc(DebugDraw *draw, Vec3 point, f32 radius_px, u32 color) {
    Vec3 p;
    if (!debug_project(draw, point, &p)) return;
    // An octagon of three quads: wide enough to be seen, round enough to tell it from a pixel.
    f32 r = radius_px, k = r * 0.414f;
    const f32 quads[3][4][2] = {{{-k, -r}, {k, -r}, {r, -k}, {-r, -k}},
                                {{-r, -k}, {r, -k}, {r, k}, {-r, k}},
                                {{-r, k}, {r, k}, {k, r}, {-k, r}}};
    for (u32 q = 0; q < 3; q++) {
        OverlayVertex corners[4];
        for (u32 i = 0; i < 4; i++)
            corners[i] = vertex(p.x + quads[q][i][0], p.y + quads[q][i][1], p.z, color);
        add_quad(draw, corners);
    }
}

void debug_cross(DebugDraw *draw, Vec3 point, f32 radius_px, u32 color) {
    Vec3 p;
    if (!debug_project(draw, point, &p)) return;
    f32 r = radius_px;
    line_px(draw, vec3(p.x - r, p.y - r, p.z), vec3(p.x + r, p.y + r, p.z), color);
    line_px(draw, vec3(p.x - r, p.y + r, p.z), vec3(p.x + r, p.y - r, p.z), color);
}

void debug_patch(DebugDraw *draw, f32 left, f32 top, f32 right, f32 bottom, u32 color) {
    add_quad(draw,
             (OverlayVertex[4]){vertex(left, top, -1, color), vertex(right, top, -1, color),
                                vertex(right, bottom, -1, color), vertex(left, bottom, -1, color)});
}

void debug_frame(DebugDraw *draw, f32 left, f32 top, f32 right, f32 bottom, u32 color) {
    debug_patch(draw, left, top, right, top + 1.0f, color);
    debug_patch(draw, left, bottom - 1.0f, right, bottom, color);
    debug_patch(draw, left, top + 1.0f, left + 1.0f, bottom - 1.0f, color);
    debug_patch(draw, right - 1.0f, top + 1.0f, right, bottom - 1.0f, color);
}
