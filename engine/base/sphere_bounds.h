// sphere_bounds.h: what part of the screen a ball or a cone can cover, and the ball around a cone.
//
// Used by the light grids (systems/) and by the renderer's scissors: one formula, so that what a
// tile's list holds and what a scissor lets through agree.
#ifndef LUZ_SPHERE_BOUNDS_H
#define LUZ_SPHERE_BOUNDS_H
#include "base.h"
#ifdef __cplusplus
extern "C" {
#endif

// Exact screen bounds of a sphere (specification of direct lighting, section 6.1, after Lengyel):
// view-space centre and radius; projection scale = cot(fov/2) along the axis, near plane in m.
// Result in NDC, clipped to [-1, 1]. Returns false if no part of it is in front of the near plane
// within the view along this axis.
bool sphere_bounds_axis(f32 center, f32 center_z, f32 radius, f32 near, f32 scale, f32 *ndc_min,
                        f32 *ndc_max);

// The same for the part of a ball of radius `reach` around the tip that is within the half angle of
// the direction (unit; from 90 degrees on: the whole ball). axis: 0 = x, 1 = y.
bool cone_bounds_axis(const f32 tip[3], const f32 direction[3], f32 cos_half, f32 reach, u32 axis,
                      f32 near, f32 scale, f32 *ndc_min, f32 *ndc_max);

// Smallest sphere around the part of a ball of radius `reach` that lies in a cone with its tip in
// the centre, by the cosine and sine of the cone's half angle: up to 45 degrees through tip and
// rim, beyond around the rim's circle, from 90 on the whole ball. Returns how far along the axis
// its centre lies.
f32 cone_bounding_sphere(f32 reach, f32 cos_half, f32 sin_half, f32 *radius);

#ifdef __cplusplus
}
#endif
#endif
