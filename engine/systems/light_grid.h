// light_grid.h: the light grid in two steps, for packet_build, which wants the lists written right
// into the packet: plan (counts, offsets) -> memory -> fill. Everybody else: light_grid_build.
#ifndef LUZ_LIGHT_GRID_H
#define LUZ_LIGHT_GRID_H
#include "systems.h"

// Tiles that a light touches, inclusive; x0 > x1 = none.
typedef struct TileRect {
    u16 x0, y0, x1, y1;
} TileRect;

// Indices of all lists together. Beyond, tiles with many lights share one list of all lights, so
// that nothing is ever lost. 64 MiB: half of what the smallest storage buffers hold.
#define LIGHT_GRID_INDICES_CAP (1u << 24)

typedef struct LightGridPlan {
    LightGridInput input;
    u32 tiles_x, tiles_y, tile_count;
    TileRect *rects;  // [light count]
    u32 *point_first; // [tile_count] where a tile's points begin in the list
    u32 *spot_first;  // [tile_count] and its spots
    u32 *end;         // [tile_count] and where they end
    u32 share_from;   // tiles with this many lights or more share the list of all
    u32 index_count;
    u32 longest;       // lights in the fullest tile
    u32 lights_listed; // lights that touch any tile
} LightGridPlan;

// Memory from scratch, to be kept until after the fill.
LightGridPlan light_grid_plan(const LightGridInput *input, Arena *scratch);
// tiles [tile_count], indices [index_count].
void light_grid_fill(const LightGridPlan *plan, CellRecord *tiles, u32 *indices, Arena *scratch);
#endif
