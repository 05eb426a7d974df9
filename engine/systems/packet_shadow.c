// packet_shadow.c: where the shadow map of directional light 0 looks.
// Data in: the view, the light's direction, reach and size of the map, bounds of casters. Data out:
// an orthographic box: a square across the light, a depth range along it. Called by: packet_build.
// Does not: split the view into cascades, or render.
//
// The square encloses the ball of the shadow distance around the camera, whichever way it looks,
// and a margin. It stands on a lattice as wide as the margin and moves only when the camera leaves
// its cell: while one turns or walks a few metres the map shows the same, its key stays, and it is
// not drawn again. The lattice is a whole number of texels wide, so edges of shadows stand still
// when it does move (M. Valient, "Stable rendering of cascaded shadow maps", ShaderX6, 2008).
#include "packet_parts.h"
#include <math.h>

#define MARGIN 0.125 // of the distance: width of the lattice

ShadowFit shadow_fit_view(const PacketView *view, Vec3 direction, f32 distance_m, u32 size_px) {
    ShadowFit fit = {.back = vec3_scale(direction, -1.0f)};
    // Any direction across the light serves, as long as it hangs on the light alone.
    Vec3 helper = fabsf(fit.back.y) > 0.99f ? vec3(0, 0, 1) : vec3(0, 1, 0);
    fit.right = vec3_normalize(vec3_cross(helper, fit.back));
    fit.up = vec3_cross(fit.back, fit.right);

    // The camera is at most half a cell off the centre. Two texels more: filters read one beyond.
    f64 radius = MAX(distance_m, view->near * 2.0f);
    f64 half = radius * (1.0 + 0.5 * MARGIN) * size_px / (size_px - 2.0);
    f64 texel = 2.0 * half / size_px, cell = floor(radius * MARGIN / texel) * texel;
    Vec3 center = view->position;
    fit.center_right = floor(vec3_dot(center, fit.right) / cell + 0.5) * cell;
    fit.center_up = floor(vec3_dot(center, fit.up) / cell + 0.5) * cell;
    fit.half_m = (f32)half;
    fit.texel_m = (f32)texel;
    f64 middle = floor(vec3_dot(center, fit.back) / cell + 0.5) * cell;
    fit.front = (f32)(middle + half);
    fit.rear = (f32)(middle - half);

    const Vec3 normals[5] = {fit.right, vec3_scale(fit.right, -1.0f), fit.up,
                             vec3_scale(fit.up, -1.0f), fit.back};
    const f64 offsets[5] = {half - fit.center_right, half + fit.center_right, half - fit.center_up,
                            half + fit.center_up, -fit.rear};
    fit.frustum.count = 5;
    for (u32 i = 0; i < 5; i++) {
        f32 *plane = fit.frustum.planes[i];
        plane[0] = normals[i].x, plane[1] = normals[i].y, plane[2] = normals[i].z;
        plane[3] = (f32)offsets[i];
    }
    return fit;
}

// Towards the light there is no end: whatever stands there casts into the view.
void shadow_fit_casters(ShadowFit *fit, const DrawableTable *drawables, const u32 *rows,
                        u32 count) {
    for (u32 i = 0; i < count; i++) {
        u32 row = rows[i];
        Vec3 center = {drawables->bounds_x[row], drawables->bounds_y[row],
                       drawables->bounds_z[row]};
        fit->front = MAX(fit->front, vec3_dot(center, fit->back) + drawables->bounds_radius[row]);
    }
}

Mat4 shadow_fit_matrix(const ShadowFit *fit) {
    // World to light: rows right, up, back; the eye on the front plane, in the middle of the
    // square.
    Mat4 view = {{fit->right.x, fit->up.x, fit->back.x, 0, fit->right.y, fit->up.y, fit->back.y, 0,
                  fit->right.z, fit->up.z, fit->back.z, 0, (f32)-fit->center_right,
                  (f32)-fit->center_up, -fit->front, 1}};
    f32 half = fit->half_m;
    return mat4_mul(mat4_ortho_reversed(-half, half, -half, half, 0.0f, fit->front - fit->rear),
                    view);
}
