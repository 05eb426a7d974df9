// light_twin.c: see light_twin.h. Plain loops in double; nothing here is fast.
#include "light_twin.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <stdlib.h>
#include <string.h>

#define TAU 6.283185307179586

static void random_direction(u64 seed, u64 stream, u64 draw, f64 out[3]) {
    f64 z = random_range(seed, stream, draw, -1, 1);
    f64 angle = random_f32(seed, stream + 1, draw) * TAU, ring = sqrt(MAX(1 - z * z, 0));
    out[0] = ring * cos(angle), out[1] = ring * sin(angle), out[2] = z;
}

static Vec3 random_vec3(u64 seed, u64 stream, u64 draw) {
    f64 d[3];
    random_direction(seed, stream, draw, d);
    return vec3((f32)d[0], (f32)d[1], (f32)d[2]);
}

static void make_frame(FrameRecord *frame, u64 seed, u32 width_px, u32 height_px, f32 near) {
    Vec3 eye = vec3_scale(random_vec3(seed, 1, 0), 50.0f);
    Vec3 f = random_vec3(seed, 3, 0);
    Vec3 r = vec3_normalize(vec3_cross(f, fabsf(f.y) > 0.9f ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    Vec3 u = vec3_cross(r, f);
    f32 tan_y = random_range(seed, 5, 0, 0.3f, 1.2f);
    f32 tan_x = tan_y * (f32)width_px / (f32)height_px;
    const f32 view[16] = {r.x,
                          u.x,
                          -f.x,
                          0,
                          r.y,
                          u.y,
                          -f.y,
                          0,
                          r.z,
                          u.z,
                          -f.z,
                          0,
                          -vec3_dot(r, eye),
                          -vec3_dot(u, eye),
                          vec3_dot(f, eye),
                          1};
    memcpy(frame->view, view, sizeof view);
    const Vec3 axes[3] = {vec3_scale(r, tan_x), vec3_scale(u, tan_y), f};
    f32 *rays[3] = {frame->ray_right, frame->ray_up, frame->ray_forward};
    for (u32 i = 0; i < 3; i++) memcpy(rays[i], &axes[i], sizeof axes[i]);
    const f32 camera[4] = {eye.x, eye.y, eye.z, near};
    const f32 viewport[4] = {(f32)width_px, (f32)height_px, 1.0f / (f32)width_px,
                             1.0f / (f32)height_px};
    memcpy(frame->camera, camera, sizeof camera);
    memcpy(frame->viewport, viewport, sizeof viewport);
}

LightTwin *light_twin_create(u64 seed, u32 light_count, u32 width_px, u32 height_px, f32 near,
                             f32 depth_m, f32 range_max_m) {
    LightTwin *twin = calloc(1, sizeof *twin);
    FrameRecord *frame = &twin->frame;
    make_frame(frame, seed, width_px, height_px, near);
    u32 points = light_count - light_count / 3, spots = light_count - points;
    twin->count = light_count;
    twin->lights = calloc(light_count + 1, sizeof *twin->lights);
    twin->spots = calloc(spots + 1, sizeof *twin->spots);
    frame->counts[0] = points;
    frame->counts[1] = spots;
    frame->counts2[2] = light_count;
    frame->counts3[0] = points / 2;
    frame->counts3[1] = spots - spots / 4;
    for (u32 i = 0; i < light_count; i++) {
        f32 depth = random_range(seed, 10, i, -0.1f, 1.0f) * depth_m;
        // Also outside of the view, to either side.
        f32 x = random_range(seed, 11, i, -1.3f, 1.3f), y = random_range(seed, 12, i, -1.3f, 1.3f);
        f32 small = random_f32(seed, 13, i), range = 0.02f + small * small * range_max_m;
        if (i % 16 == 3) depth = random_range(seed, 10, i, -0.5f, 1.0f) * range; // holds the eye
        for (u32 a = 0; a < 3; a++)
            twin->lights[i].position[a] =
                frame->camera[a] +
                depth * (frame->ray_right[a] * x + frame->ray_up[a] * y + frame->ray_forward[a]);
        twin->lights[i].position[3] = 1.0f / (range * range);
        if (i < points) continue;
        SpotRecord *spot = &twin->spots[i - points];
        Vec3 way = random_vec3(seed, 20, i);
        memcpy(spot->direction, &way, sizeof way);
        spot->direction[3] = det_cos(random_range(seed, 22, i, 0.02f, 1.55f));
        // Straight to or away from the eye, and a half angle of nearly nothing.
        if (i % 13 == 0)
            for (u32 a = 0; a < 3; a++)
                spot->direction[a] = frame->ray_forward[a] * (i % 2 ? -1.0f : 1.0f);
        spot->edge[0] = 10.0f;
    }
    return twin;
}

void light_twin_destroy(LightTwin *twin) {
    free(twin->lights);
    free(twin->spots);
    free(twin);
}

static f64 dot3(const f32 *a, const f64 *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static f64 square3(const f32 *a) { return (f64)a[0] * a[0] + (f64)a[1] * a[1] + (f64)a[2] * a[2]; }

TwinPoint twin_point(const FrameRecord *frame, const f64 world[3]) {
    const f64 from_eye[3] = {world[0] - frame->camera[0], world[1] - frame->camera[1],
                             world[2] - frame->camera[2]};
    TwinPoint p = {.world = {world[0], world[1], world[2]}};
    f64 right = sqrt(square3(frame->ray_right)), up = sqrt(square3(frame->ray_up));
    p.x = dot3(frame->ray_right, from_eye) / right;
    p.y = dot3(frame->ray_up, from_eye) / up;
    p.depth = dot3(frame->ray_forward, from_eye);
    p.x_px = (p.x / (p.depth * right) + 1) * 0.5 * frame->viewport[0];
    p.y_px = (1 - p.y / (p.depth * up)) * 0.5 * frame->viewport[1];
    p.visible = p.depth >= frame->camera[3] && p.x_px >= 0 && p.x_px < frame->viewport[0] &&
                p.y_px >= 0 && p.y_px < frame->viewport[1];
    return p;
}

TwinPoint twin_unproject(const FrameRecord *frame, f64 x_px, f64 y_px, f64 depth) {
    f64 x = x_px / frame->viewport[0] * 2 - 1, y = 1 - y_px / frame->viewport[1] * 2, world[3];
    for (u32 a = 0; a < 3; a++)
        world[a] = frame->camera[a] +
                   depth * (frame->ray_right[a] * x + frame->ray_up[a] * y + frame->ray_forward[a]);
    return twin_point(frame, world);
}

void twin_point_in_light(const LightTwin *twin, u32 light, u64 seed, u64 draw, f64 world[3]) {
    const f32 *p = twin->lights[light].position;
    u32 points = twin->frame.counts[0];
    f64 way[3], reach = 1.0 / sqrt(p[3]);
    random_direction(seed, 30, draw, way);
    if (light >= points) {
        // A direction within the cone, half of them at its side.
        const f32 *axis = twin->spots[light - points].direction;
        f64 half = acos(CLAMP(axis[3], -1.0, 1.0)), along = 0, length = 0;
        f64 part = draw % 2 ? 0.99999 : random_f32(seed, 32, draw), angle = half * part;
        for (u32 a = 0; a < 3; a++) along += way[a] * axis[a];
        for (u32 a = 0; a < 3; a++) way[a] -= along * axis[a], length += way[a] * way[a];
        for (u32 a = 0; a < 3; a++)
            way[a] = axis[a] * cos(angle) + way[a] / sqrt(length) * sin(angle);
    }
    f64 far = draw % 3 == 0 ? random_f32(seed, 33, draw) : 0.99999;
    for (u32 a = 0; a < 3; a++) world[a] = p[a] + way[a] * reach * far;
}

bool twin_light_reaches(const LightTwin *twin, u32 light, const f64 world[3]) {
    const f32 *p = twin->lights[light].position;
    const f64 to[3] = {world[0] - p[0], world[1] - p[1], world[2] - p[2]};
    f64 d2 = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
    if (d2 * p[3] >= 1.0) return false;
    if (light < twin->frame.counts[0]) return true;
    const f32 *axis = twin->spots[light - twin->frame.counts[0]].direction;
    return dot3(axis, to) > axis[3] * sqrt(d2);
}

u32 twin_cell(const FrameRecord *frame, const TwinPoint *point) {
    const u32 *grid = frame->grid;
    u32 x = (u32)point->x_px / grid[3], y = (u32)point->y_px / grid[3];
    f32 slice = floorf(log2f((f32)point->depth) * frame->slices[0] + frame->slices[1]);
    u32 z = grid[2] > 1 ? (u32)CLAMP(slice, 0.0f, (f32)(grid[2] - 1)) : 0;
    return (z * grid[1] + y) * grid[0] + x;
}

// ---- tiles ----

// The slice of the range that holds a depth, as the device computes it.
static u32 mask_slice(const TileDepthRecord *tile, f32 depth_m) {
    f32 slice = (depth_m - tile->range[0]) * tile->range[2];
    return (u32)CLAMP(slice, 0.0f, 31.0f);
}

TileDepthRecord twin_tile_depth(const f32 *depths_m, u32 width_px, u32 height_px, u32 tile_px,
                                u32 tile_x, u32 tile_y) {
    TileDepthRecord tile = {.range = {1e30f, 0.0f, 0.0f, 0.0f}};
    u32 x_end = MIN((tile_x + 1) * tile_px, width_px);
    u32 y_end = MIN((tile_y + 1) * tile_px, height_px);
    for (u32 pass = 0; pass < 2; pass++) {
        for (u32 y = tile_y * tile_px; y < y_end; y++) {
            for (u32 x = tile_x * tile_px; x < x_end; x++) {
                f32 depth = depths_m[(u64)y * width_px + x];
                if (!(depth > 0.0f)) continue;
                if (pass == 0) {
                    tile.range[0] = MIN(tile.range[0], depth);
                    tile.range[1] = MAX(tile.range[1], depth);
                    tile.mask[1]++;
                } else {
                    tile.mask[0] |= 1u << mask_slice(&tile, depth);
                }
            }
        }
        f32 size = tile.range[1] - tile.range[0];
        tile.range[2] = size > 0.0f ? 32.0f / size : 0.0f;
    }
    return tile;
}

bool twin_depth_touches(const TileDepthRecord *tile, f32 front_m, f32 back_m, bool mask) {
    if (tile->range[0] > tile->range[1]) return false;
    if (front_m > tile->range[1] || back_m < tile->range[0]) return false;
    if (!mask) return true;
    u32 first = mask_slice(tile, front_m), last = mask_slice(tile, back_m);
    u32 bits = (0xFFFFFFFFu << first) & (0xFFFFFFFFu >> (31 - last));
    return (tile->mask[0] & bits) != 0;
}
