// debug_draw.h: lines and patches over the picture, made on the CPU. Private to engine/render/.
//
//   DebugDraw draw = debug_draw_begin(renderer, packet, vertices, cap);
//   debug_line(&draw, a, b, color); ...        count = draw.count;
#ifndef LUZ_DEBUG_DRAW_H
#define LUZ_DEBUG_DRAW_H
#include "../base/maths.h"
#include "render_internal.h"

typedef struct DebugDraw {
    const Packet *packet;
    OverlayVertex *vertices; // triangles; x, y px, u depth (reversed; < 0 = nothing hides it)
    u32 count, cap;
    u32 left_out; // shapes that found no room
} DebugDraw;

// A point of the world on the picture: x, y px, z reversed depth. False: not before the near plane.
bool debug_project(const DebugDraw *draw, Vec3 point, Vec3 *out);
// World space; dimmed where a surface lies before it.
void debug_line(DebugDraw *draw, Vec3 a, Vec3 b, u32 color);
// Its outline as seen from the camera; segments follow the size on the picture.
void debug_ball(DebugDraw *draw, Vec3 center, f32 radius, u32 color);
// Three great circles.
void debug_sphere(DebugDraw *draw, Vec3 center, f32 radius, u32 color);
// Tip, unit axis, length of the edge, cosine of the half angle.
void debug_cone(DebugDraw *draw, Vec3 tip, Vec3 axis, f32 reach, f32 cos_half, u32 color);
// A disc of `radius_px`, or a cross, at a point of the world.
void debug_disc(DebugDraw *draw, Vec3 point, f32 radius_px, u32 color);
void debug_cross(DebugDraw *draw, Vec3 point, f32 radius_px, u32 color);
// Pixels of the picture; nothing hides them.
void debug_patch(DebugDraw *draw, f32 left, f32 top, f32 right, f32 bottom, u32 color);
void debug_frame(DebugDraw *draw, f32 left, f32 top, f32 right, f32 bottom, u32 color);

#endif
