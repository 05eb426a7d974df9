// light_grid.h: the light grid in two steps, for packet_lists.c, which wants the lists written
// right into the packet: plan (counts, offsets) -> memory -> fill. Everybody else:
// light_grid_build.
//
//   light_grid_input.c  a packet's records as columns
//   light_tiles.c       cells that a light touches: tiles, by rectangle or by rows
//   light_clusters.c    the same for clusters, and how depth is sliced
//   light_grid.c        counts, offsets
//   light_grid_fill.c   lists
#ifndef LUZ_LIGHT_GRID_H
#define LUZ_LIGHT_GRID_H
#include "../base/screen_bounds.h"
#include "systems.h"

// Cells that a light touches: columns x0..x1 of `rows` rows. Rows count on from slice to slice:
// row = slice * tiles_y + tile row; a box stays in one slice. rows = 0: none.
typedef struct CellBox {
    u32 row;
    u16 rows, x0, x1;
} CellBox;

// Indices of all lists together. Beyond, cells with many lights share one list of all lights, so
// that nothing is ever lost. 64 MiB: half of what the smallest storage buffers hold.
#define LIGHT_GRID_INDICES_CAP (1u << 24)
// What rounding may lose, as a part of the half screen: 0.0003 px at 720p.
#define LIGHT_GRID_SLACK 1e-6

typedef struct LightGridPlan {
    LightGridInput input;
    u32 tiles_x, tiles_y, slices, cell_count;
    CellBox *boxes;  // a light's: [box_first[light], box_first[light + 1]), rows ascending
    u32 *box_first;  // [light count + 1]
    u32 *list_first; // [cell_count] where its list begins; UINT32_MAX = it shares the list of all
    bool sharing;    // the list of all lights lies at the beginning
    u32 index_count;
    u32 longest;       // lights in the fullest cell
    u32 lights_listed; // lights that touch any cell
    u32 fallbacks;     // cells that share the list of all lights
    // For the fill (light_grid_fill.c). A run is a light's columns in a block: some cells of a row.
    u32 blocks_x, block_count; // a row's, all
    u32 *run_first;            // [block_count + 1] of a block's runs, in the order of the lights
    u32 *run_end;              // [LIGHT_CLASSES * block_count] by class: behind a block's last run
    u32 *run_lights;           // [runs]
    u16 *run_columns;          // [runs]
    u64 *block_bits;           // [threads * block_bits_stride] room for a block
    u64 block_bits_stride;
} LightGridPlan;

// Memory from scratch, to be kept until after the fill.
LightGridPlan light_grid_plan(const LightGridInput *input, Arena *scratch);
// cells [cell_count], indices [index_count]. Uses the plan up.
void light_grid_fill(LightGridPlan *plan, CellRecord *cells, u32 *indices);

// Steps of the plan. Room for the fill, once there are boxes:
void light_grid_plan_fill(LightGridPlan *plan, Arena *scratch);
// Fill in boxes and box_first. Any number of threads.
void light_tiles_boxes(LightGridPlan *plan, Arena *scratch);
void light_clusters_boxes(LightGridPlan *plan, Arena *scratch);

// Parts that both use.
static inline bool light_is_cone(const LightGridInput *in, u32 i) {
    return i >= in->point_count && in->cones.tip_x &&
           in->cones.cos_half[i - in->point_count] > 0.0f;
}
static inline Cone light_grid_cone(const LightGridInput *in, u32 i) {
    const LightCones *c = &in->cones;
    u32 s = i - in->point_count;
    return (Cone){{c->tip_x[s], c->tip_y[s], -c->tip_z[s]},
                  {c->axis_x[s], c->axis_y[s], -c->axis_z[s]},
                  c->cos_half[s],
                  c->sin_half[s],
                  c->reach[s]};
}
// NDC range (y down for rows: pass -high, -low) to tiles. False if it is off the screen.
static inline bool light_grid_tiles(f64 low, f64 high, u32 side_px, u32 tile_px, u16 *first,
                                    u16 *last) {
    f64 from = (low - LIGHT_GRID_SLACK + 1.0) * 0.5 * side_px,
        to = (high + LIGHT_GRID_SLACK + 1.0) * 0.5 * side_px;
    if (!(from <= side_px && to >= 0.0)) return false;
    u32 end = (side_px - 1) / tile_px, shift = (u32)__builtin_ctz(tile_px);
    // Floored in pixels: a light that touches the border between two tiles is in both.
    *first = from > 0.0 ? (u16)MIN((u32)from >> shift, end) : 0;
    *last = to < side_px ? (u16)MIN((u32)to >> shift, end) : (u16)end;
    return true;
}
#endif
