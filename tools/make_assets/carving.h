// Carved architecture shared by several models: columns, capitals, wall shafts, vaults.
//
// Data in: places and sizes in metres. Data out: triangles in the soup. Called by the models of
// the walk, the chapter house and the garden.
#ifndef MAKE_ASSETS_CARVING_H
#define MAKE_ASSETS_CARVING_H

#include "materials.h"
#include "shapes.h"

// A slender column with base, shaft and leaf capital, from y0 to y1 including both; `twist` turns
// of four rolls around the shaft, 0 for a smooth one.
void carve_column(Soup *s, Vec3 foot, float y1, float radius, float twist);

// Two tiers of leaves around a bell, from radius r0 at y0 to r1 at y1.
void carve_bud(Soup *s, float y0, float y1, float r0, float r1);

// A shaft that is engaged in a wall, with base and capital; it covers sweep_deg from start_deg.
void carve_wall_shaft(Soup *s, Vec3 foot, float y1, float radius, float start_deg, float sweep_deg);

// A flower in relief in the xy plane, facing -z (facing < 0) or +z.
void carve_rosette(Soup *s, Vec3 center, float radius, float depth, int petals, float facing);

// A cross vault over a rectangle: two pointed barrels that meet.
typedef struct Vault {
    float x0, x1, z0, z1, spring_y, rise, pointed;
} Vault;

void carve_vault_webs(Soup *s, const Vault *v, int segments);
void carve_vault_diagonals(Soup *s, const Vault *v, float width, float depth, int segments);

// A rib along the vault's edge across z (at x) or across x (at z).
void carve_vault_rib_z(Soup *s, const Vault *v, float x, float width, float depth, int segments);
void carve_vault_rib_x(Soup *s, const Vault *v, float z, float width, float depth, int segments);

#endif
