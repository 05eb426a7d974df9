// light_grid.c: which lights touch which cell of the light grid: a tile of the screen, or a cluster
// (tile and slice of depth).
// Data in: view-space spheres and cones by class (points, diffuse points, spots, diffuse spots).
// Data out: per cell a record (offset, counts of the classes), and one list of light indices,
// ascending within a cell. Called by: packet_lists.c, tests, bench. Does not: look at what is seen
// (shaders narrow the lists), or drop a light: lists too long for memory become the list of all.
//
// Three linear steps (specification of direct lighting, 6.2): boxes of cells of every light ->
// counts and their prefix sum -> fill. Counting costs four additions a box, not one a cell: a box
// is four corners of a difference image, whose running sums are the counts. Filling goes by bands
// of rows, each written by one job, class after class: where a cell's cursor stands between two
// classes is their border. So the result does not depend on the number of threads.
#include "light_grid.h"
#include "../base/jobs.h"
#include "../base/log.h"

#define FILL_ROWS_PER_JOB 8
#define FILL_BANDS        16 // of a cluster grid, at most

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
    return plan;
}

// ---- filling ----

typedef struct FillJob {
    const LightGridPlan *plan;
    u32 *cursor; // [cell_count] next place in a cell's list
    u32 *indices;
    CellRecord *cells;
    u32 class_end[LIGHT_CLASSES]; // light index
} FillJob;

// Writes the lights [begin, end) into the rows [row_begin, row_end).
static void fill_lights(const FillJob *job, u32 begin, u32 end, u32 row_begin, u32 row_end) {
    const LightGridPlan *plan = job->plan;
    u32 tiles_x = plan->tiles_x, *indices = job->indices;
    for (u32 i = begin; i < end; i++) {
        for (u32 b = plan->box_first[i]; b < plan->box_first[i + 1]; b++) {
            CellBox box = plan->boxes[b];
            if (box.row >= row_end) break;
            u32 y_end = MIN(box.row + box.rows, row_end);
            for (u32 y = MAX(box.row, row_begin); y < y_end; y++) {
                u32 *cursor = job->cursor + (u64)y * tiles_x;
                if (plan->sharing) {
                    for (u32 x = box.x0; x <= box.x1; x++)
                        if (cursor[x] != UINT32_MAX) indices[cursor[x]++] = i;
                } else {
                    for (u32 x = box.x0; x <= box.x1; x++) indices[cursor[x]++] = i;
                }
            }
        }
    }
}

static void job_fill(void *context, u32 row_begin, u32 row_end, u32 thread_index) {
    (void)thread_index;
    const FillJob *job = context;
    u32 first = row_begin * job->plan->tiles_x, last = row_end * job->plan->tiles_x;
    const u32 *end = job->class_end;
    // Records hold the classes' ends until all are known.
    for (u32 i = first; i < last; i++) job->cells[i].list[0] = job->cursor[i];
    for (u32 class = 0; class < LIGHT_CLASSES; class ++) {
        fill_lights(job, class ? end[class - 1] : 0, end[class], row_begin, row_end);
        if (class + 1 == LIGHT_CLASSES) break;
        for (u32 i = first; i < last; i++) job->cells[i].list[class + 1] = job->cursor[i];
    }
    for (u32 i = first; i < last; i++) {
        u32 *list = job->cells[i].list, at[LIGHT_CLASSES + 1];
        for (u32 class = 0; class < LIGHT_CLASSES; class ++) at[class] = list[class];
        at[LIGHT_CLASSES] = job->cursor[i];
        if (at[0] == UINT32_MAX) {
            at[0] = 0;
            for (u32 class = 0; class < LIGHT_CLASSES; class ++) at[class + 1] = end[class];
        }
        list[0] = at[0];
        list[1] = at[2] - at[0];
        list[2] = at[4] - at[2];
        list[3] = MIN(at[2] - at[1], 0xFFFF) | MIN(at[4] - at[3], 0xFFFF) << 16;
    }
}

void light_grid_fill(LightGridPlan *plan, CellRecord *cells, u32 *indices) {
    const LightGridInput *in = &plan->input;
    FillJob job = {.plan = plan,
                   .cursor = plan->list_first,
                   .indices = indices,
                   .cells = cells,
                   .class_end = {MIN(in->highlight_points, in->point_count), in->point_count,
                                 MIN(in->point_count + in->highlight_spots, in->count), in->count}};
    if (plan->sharing)
        for (u32 i = 0; i < in->count; i++) indices[i] = i;
    u32 rows = plan->tiles_y * plan->slices, slices = (plan->slices + FILL_BANDS - 1) / FILL_BANDS;
    u32 grain = plan->slices > 1 ? slices * plan->tiles_y : FILL_ROWS_PER_JOB;
    jobs_for(rows, grain, job_fill, &job);
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
    grid.cells = ARENA_PUSH(arena, CellRecord, plan.cell_count);
    grid.indices = ARENA_PUSH(arena, u32, plan.index_count);
    light_grid_fill(&plan, grid.cells, grid.indices);
    return grid;
}
