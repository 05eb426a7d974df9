// light_grid.c: which lights touch which cell of the light grid: a tile of the screen, or a cluster
// (tile and slice of depth).
// Data in: view-space spheres and cones by class (points, diffuse points, spots, diffuse spots).
// Data out: per cell a record (offset, counts of the classes), and one list of light indices,
// ascending within a cell. Called by: packet_lists.c, tests, bench. Does not: look at what is seen
// (shaders narrow the lists), or drop a light: lists too long for memory become the list of all.
//
// Three linear steps (specification of direct lighting, 6.2): boxes of cells of every light ->
// counts and their prefix sum -> fill (light_grid_fill.c). Counting costs four additions a box, not
// one a cell: a box is four corners of a difference image, whose running sums are the counts.
#include "light_grid.h"
#include "../base/log.h"

// ---- counting ----

typedef struct GridSum {
    u64 total;   // entries of all lists
    u32 longest; // lights in the fullest cell
} GridSum;

// Counts per cell: corner differences, then running sums along rows and down columns. A box ends
// within its slice, so the columns run on from slice to slice. Unsigned wrap-around cancels out.
static GridSum count_lights(const LightGridPlan *plan, u32 *counts, Arena *scratch) {
    u64 mark = arena_mark(scratch);
    u32 stride = plan->tiles_x + 1, row_count = plan->tiles_y * plan->slices;
    u32 *difference = ARENA_PUSH(scratch, u32, (u64)stride * (row_count + 1));
    GridSum sum = {0};
    for (u32 i = 0; i < plan->box_first[plan->input.count]; i++) {
        CellBox box = plan->boxes[i];
        if (box.rows == 0) continue;
        u32 *top = difference + (u64)box.row * stride, *under = top + (u64)box.rows * stride;
        top[box.x0]++;
        top[box.x1 + 1]--;
        under[box.x0]--;
        under[box.x1 + 1]++;
        sum.total += (u64)box.rows * (u32)(box.x1 - box.x0 + 1);
    }
    for (u32 y = 0; y < row_count; y++) {
        const u32 *row = difference + (u64)y * stride;
        u32 *out = counts + (u64)y * plan->tiles_x, across = 0;
        for (u32 x = 0; x < plan->tiles_x; x++) {
            across += row[x];
            out[x] = across + (y ? out[x - (i64)plan->tiles_x] : 0);
            sum.longest = MAX(sum.longest, out[x]);
        }
    }
    arena_rewind(scratch, mark);
    return sum;
}

// Lists as long as this or longer share the list of all lights: halved until the rest fits.
static u32 find_share_limit(const LightGridPlan *plan, const u32 *counts) {
    for (u32 limit = plan->input.count;; limit /= 2) {
        u64 total = plan->input.count;
        for (u32 i = 0; i < plan->cell_count; i++) total += counts[i] < limit ? counts[i] : 0;
        if (total <= LIGHT_GRID_INDICES_CAP || limit == 0) return limit;
    }
}

static void place_lists(LightGridPlan *plan, GridSum sum) {
    u32 *lists = plan->list_first; // counts at first
    u32 share_from = UINT32_MAX, cursor = 0;
    plan->longest = sum.longest;
    if (sum.total > LIGHT_GRID_INDICES_CAP) {
        share_from = find_share_limit(plan, lists);
        plan->sharing = true;
        plan->longest = cursor = plan->input.count;
        static bool told;
        if (!told)
            LOG(RENDER_LIMIT,
                "light lists of %u lights in %u cells exceed %u indices; cells with %u "
                "lights or more use all",
                plan->input.count, plan->cell_count, LIGHT_GRID_INDICES_CAP, share_from);
        told = true;
    }
    for (u32 i = 0; i < plan->cell_count; i++) {
        u32 count = lists[i];
        bool shares = count >= share_from;
        lists[i] = shares ? UINT32_MAX : cursor;
        cursor += shares ? 0 : count;
        plan->fallbacks += shares;
    }
    plan->index_count = cursor;
}

LightGridPlan light_grid_plan(const LightGridInput *input, Arena *scratch) {
    LightGridPlan plan = {.input = *input, .slices = MAX(input->slices.count, 1)};
    plan.tiles_x = (input->width_px + input->tile_px - 1) / input->tile_px;
    plan.tiles_y = (input->height_px + input->tile_px - 1) / input->tile_px;
    plan.cell_count = plan.tiles_x * plan.tiles_y * plan.slices;
    LUZ_ASSERT(plan.tiles_x < UINT16_MAX && plan.tiles_y < UINT16_MAX);
    plan.list_first = ARENA_PUSH(scratch, u32, plan.cell_count);
    if (input->slices.count > 0)
        light_clusters_boxes(&plan, scratch);
    else
        light_tiles_boxes(&plan, scratch);
    for (u32 i = 0; i < input->count; i++) {
        bool any = false;
        for (u32 b = plan.box_first[i]; b < plan.box_first[i + 1]; b++)
            any |= plan.boxes[b].rows > 0;
        plan.lights_listed += any;
    }
    place_lists(&plan, count_lights(&plan, plan.list_first, scratch));
    light_grid_plan_fill(&plan, scratch);
    return plan;
}

LightGrid light_grid_build(const LightGridInput *input, Arena *arena) {
    LightGridPlan plan = light_grid_plan(input, arena);
    LightGrid grid = {.tiles_x = plan.tiles_x,
                      .tiles_y = plan.tiles_y,
                      .slices = plan.slices,
                      .cell_count = plan.cell_count,
                      .index_count = plan.index_count,
                      .longest = plan.longest,
                      .fallbacks = plan.fallbacks};
    grid.cells = ARENA_PUSH_UNSET(arena, CellRecord, plan.cell_count);
    grid.indices = ARENA_PUSH_UNSET(arena, u32, plan.index_count);
    light_grid_fill(&plan, grid.cells, grid.indices);
    return grid;
}
