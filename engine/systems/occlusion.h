// occlusion.h: what hides what, on the CPU: occluders in a small depth buffer, spheres tested
// against it.
//
// Conservative on both sides: a texel counts as covered only where one convex piece of an occluder
// covers all of it, at the farthest depth that the piece has in it; a sphere is hidden only if all
// texels of its exact screen rectangle are covered nearer than the sphere's nearest point.
#ifndef LUZ_OCCLUSION_H
#define LUZ_OCCLUSION_H
#include "light_manager.h"
#include "packet_parts.h"

#define OCCLUSION_WIDTH      256
#define OCCLUSION_HEIGHT_MAX 1024
#define OCCLUSION_LEVELS_CAP 12

// Nearness = 1 / depth along the view direction, 1/m; it is linear on the screen. 0 = not covered.
// Level 0 are the texels, rows from the upper left; each further level halves both sides, rounded
// up: low = the least of the four below, high = the greatest.
struct OcclusionBuffer {
    u32 width[OCCLUSION_LEVELS_CAP], height[OCCLUSION_LEVELS_CAP], level_count;
    f32 *low[OCCLUSION_LEVELS_CAP],
        *high[OCCLUSION_LEVELS_CAP]; // [width * height]; equal at level 0
    PacketView view;
    u32 occluders; // of which any piece faced the eye
};

// ---- meshes as occluders (occluder_mesh.c) ----

// Convex polygons of the meshes that occluders of shape `mesh` use: neighbouring triangles that lie
// in one plane are joined as long as the outline stays convex. Mesh space.
struct OccluderPolygons {
    u32 *first;   // [mesh_count + 1] a mesh's polygons in `begin`
    u32 *begin;   // [polygon_count + 1] a polygon's points
    Vec3 *points; // counter-clockwise seen from the front
    u32 mesh_count, polygon_count;
};
#define OCCLUDER_TRIANGLES_MAX 65536 // a mesh with more hides nothing
#define OCCLUDER_POLYGONS_MAX  256   // of a mesh: the largest ones
#define OCCLUDER_POINTS_MAX    16    // of a polygon

// Memory from `arena`; scratch is given back.
OccluderPolygons *occluder_polygons_build(const World *world, const AssetStore *assets,
                                          Arena *arena, Arena *scratch);

// ---- the buffer (occlusion.c) ----

// Draws all occluders of the world. polygons NULL = made here, slow. Memory from the arena. NULL if
// the world has no occluders.
OcclusionBuffer *occlusion_draw(const World *world, const AssetStore *assets,
                                const OccluderPolygons *polygons, const PacketView *view,
                                Arena *arena);
// Is no part of the sphere (world) seen? Spheres that reach over the near plane never are hidden.
bool occlusion_hides_sphere(const OcclusionBuffer *buffer, Vec3 center, f32 radius);
// Takes the hidden ones out of rows[count] (ascending), which name spheres of the columns; returns
// how many stay, in order.
u32 occlusion_cull(const OcclusionBuffer *buffer, const f32 *x, const f32 *y, const f32 *z,
                   const f32 *radius, u32 *rows, u32 count, Arena *scratch);
#endif
