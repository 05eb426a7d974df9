// light_surfaces.h: how far the nearest standing surface is from a place among the lights, about.
// A coarse grid of distances over the region of the level's lights, made when a level is loaded.
#ifndef LUZ_LIGHT_SURFACES_H
#define LUZ_LIGHT_SURFACES_H
#include "systems.h"

// distance[(z * ny + y) * nx + x]: from the cell to the nearest one that a triangle passes through,
// in thirds of a cell; capped. The outermost cells are a rim that says nothing: the cap.
typedef struct LightSurfaces {
    Vec3 origin;
    f32 cell_m;
    u32 nx, ny, nz;
    u8 *distance;
} LightSurfaces;
#define LIGHT_SURFACES_CELL_M 0.2f // or larger, so that there are not more cells than
#define LIGHT_SURFACES_CELLS  1200000u
#define LIGHT_SURFACES_CAP    48u // thirds of a cell

// From all drawables but those that move or shine themselves. Memory from the arena; NULL if there
// are no local lights.
LightSurfaces *light_surfaces_build(const World *world, const AssetStore *assets, Arena *arena);
// Metres, within about a cell, no more than the cap; `unknown` outside the grid or without one.
f32 light_surface_distance(const LightSurfaces *surfaces, Vec3 place, f32 unknown);
#endif
