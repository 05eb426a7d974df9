// light_grid.c: which lights touch which tile of the screen.
// Data in: view-space spheres (a spot's is its cone's), points first, then spots. Data out: per
// tile an offset, a count of points and of spots, and one list of light indices, ascending within a
// tile. Called by: packet_build, tests. Does not: look at depth (the shader narrows lists by its
// own boxes), or drop a light: a list too long for memory becomes the list of all lights.
//
// Three linear steps (specification of direct lighting, 6.2): bounds of every light -> counts and
// their prefix sum -> fill. Counting costs four additions a light, not one a tile: a rectangle is
// four corners of a difference image, whose running sums are the counts. Filling goes by bands of
// tile rows, each written by one job, so the result does not depend on the number of threads.
#include "light_grid.h"
#include "../base/jobs.h"
#include "../base/log.h"
#include <string.h>

#define BOUNDS_PER_JOB    512
#define FILL_ROWS_PER_JOB 8

// NDC to tile index along one axis. Positions are floored in pixels: a light that touches the
// border between two tiles is in both.
static u32 tile_of(f32 ndc, f32 half_px, f32 per_tile, u32 tile_count) {
    f32 tile = (ndc * half_px + half_px) * per_tile;
    return tile <= 0.0f ? 0 : MIN((u32)tile, tile_count - 1);
}

typedef struct BoundsJob {
    const LightGridPlan *plan;
} BoundsJob;

static void job_bounds(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const LightGridPlan *plan = ((const BoundsJob *)context)->plan;
    const LightGridInput *in = &plan->input;
    f32 half_x = (f32)in->width_px * 0.5f, half_y = (f32)in->height_px * 0.5f;
    f32 per_tile = 1.0f / (f32)in->tile_px;
    for (u32 i = begin; i < end; i++) {
        TileRect *rect = &plan->rects[i];
        f32 x0, x1, y0, y1;
        if (!sphere_bounds_axis(in->x[i], in->z[i], in->radius[i], in->near, in->scale_x, &x0,
                                &x1) ||
            !sphere_bounds_axis(in->y[i], in->z[i], in->radius[i], in->near, in->scale_y, &y0,
                                &y1)) {
            *rect = (TileRect){1, 1, 0, 0};
            continue;
        }
        // NDC y points up, tile rows go down.
        rect->x0 = (u16)tile_of(x0, half_x, per_tile, plan->tiles_x);
        rect->x1 = (u16)tile_of(x1, half_x, per_tile, plan->tiles_x);
        rect->y0 = (u16)tile_of(-y1, half_y, per_tile, plan->tiles_y);
        rect->y1 = (u16)tile_of(-y0, half_y, per_tile, plan->tiles_y);
    }
}

// Counts per tile of the lights [begin, end): corner differences, then sums along rows and columns.
// Unsigned wrap-around cancels out.
static u32 count_lights(const LightGridPlan *plan, u32 begin, u32 end, u32 *counts,
                        Arena *scratch) {
    u64 mark = arena_mark(scratch);
    u32 stride = plan->tiles_x + 1, listed = 0;
    u32 *difference = ARENA_PUSH(scratch, u32, (u64)stride * (plan->tiles_y + 1));
    for (u32 i = begin; i < end; i++) {
        TileRect rect = plan->rects[i];
        if (rect.x0 > rect.x1) continue;
        u32 *top = difference + (u64)rect.y0 * stride,
            *under = difference + (u64)(rect.y1 + 1) * stride;
        top[rect.x0]++;
        top[rect.x1 + 1]--;
        under[rect.x0]--;
        under[rect.x1 + 1]++;
        listed++;
    }
    for (u32 y = 0; y < plan->tiles_y; y++) {
        const u32 *row = difference + (u64)y * stride;
        u32 *out = counts + (u64)y * plan->tiles_x, sum = 0;
        for (u32 x = 0; x < plan->tiles_x; x++) {
            sum += row[x];
            out[x] = sum + (y ? out[x - (i64)plan->tiles_x] : 0);
        }
    }
    arena_rewind(scratch, mark);
    return listed;
}

// Lists longer than this share the list of all lights: halved until the rest fits.
static u32 find_share_limit(const LightGridPlan *plan, const u32 *points, const u32 *spots) {
    u32 limit = UINT32_MAX;
    for (;;) {
        u64 total = limit == UINT32_MAX ? 0 : plan->input.count;
        for (u32 i = 0; i < plan->tile_count; i++) {
            u32 count = points[i] + spots[i];
            total += count < limit ? count : 0;
        }
        if (total <= LIGHT_GRID_INDICES_CAP || limit == 0) return limit;
        limit = limit == UINT32_MAX ? plan->input.count : limit / 2;
    }
}

LightGridPlan light_grid_plan(const LightGridInput *input, Arena *scratch) {
    LightGridPlan plan = {.input = *input};
    plan.tiles_x = (input->width_px + input->tile_px - 1) / input->tile_px;
    plan.tiles_y = (input->height_px + input->tile_px - 1) / input->tile_px;
    plan.tile_count = plan.tiles_x * plan.tiles_y;
    LUZ_ASSERT(plan.tiles_x < UINT16_MAX && plan.tiles_y < UINT16_MAX);
    plan.rects = ARENA_PUSH(scratch, TileRect, input->count);
    plan.point_first = ARENA_PUSH(scratch, u32, plan.tile_count);
    plan.spot_first = ARENA_PUSH(scratch, u32, plan.tile_count);
    plan.end = ARENA_PUSH(scratch, u32, plan.tile_count);

    BoundsJob job = {&plan};
    jobs_for(input->count, BOUNDS_PER_JOB, job_bounds, &job);
    // First the counts lie in spot_first and end; the prefix sum replaces them in place.
    u32 *points = plan.spot_first, *spots = plan.end;
    plan.lights_listed = count_lights(&plan, 0, input->point_count, points, scratch) +
                         count_lights(&plan, input->point_count, input->count, spots, scratch);
    plan.share_from = find_share_limit(&plan, points, spots);
    u32 cursor = 0;
    if (plan.share_from != UINT32_MAX) {
        static bool told;
        if (!told)
            LOG(RENDER_LIMIT,
                "light lists of %u lights on %u tiles exceed %u indices; tiles with %u "
                "lights or more use all",
                input->count, plan.tile_count, LIGHT_GRID_INDICES_CAP, plan.share_from);
        told = true;
        cursor = input->count;
    }
    for (u32 i = 0; i < plan.tile_count; i++) {
        u32 point_count = points[i], spot_count = spots[i];
        plan.longest = MAX(plan.longest, point_count + spot_count);
        if (point_count + spot_count >= plan.share_from) {
            plan.point_first[i] = 0;
            plan.spot_first[i] = input->point_count;
            plan.end[i] = input->count;
            plan.longest = input->count;
            continue;
        }
        plan.point_first[i] = cursor;
        plan.spot_first[i] = cursor + point_count;
        plan.end[i] = cursor += point_count + spot_count;
    }
    plan.index_count = cursor;
    return plan;
}

typedef struct FillJob {
    const LightGridPlan *plan;
    u32 *cursor; // [tile_count] next place in a tile's list
    u32 *indices;
} FillJob;

// Writes all lights into the tile rows [y_begin, y_end). Tiles that share the list of all are
// marked in their cursor.
static void fill_rows(const FillJob *job, u32 y_begin, u32 y_end) {
    const LightGridPlan *plan = job->plan;
    u32 tiles_x = plan->tiles_x, *indices = job->indices;
    bool sharing = plan->share_from != UINT32_MAX;
    for (u32 i = 0; i < plan->input.count; i++) {
        TileRect rect = plan->rects[i];
        if (rect.x0 > rect.x1) continue;
        u32 y0 = MAX(rect.y0, y_begin), y1 = MIN(rect.y1 + 1u, y_end);
        for (u32 y = y0; y < y1; y++) {
            u32 *cursor = job->cursor + (u64)y * tiles_x;
            if (sharing) {
                for (u32 x = rect.x0; x <= rect.x1; x++)
                    if (cursor[x] != UINT32_MAX) indices[cursor[x]++] = i;
            } else {
                for (u32 x = rect.x0; x <= rect.x1; x++) indices[cursor[x]++] = i;
            }
        }
    }
}

static void job_fill(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const FillJob *job = context;
    fill_rows(job, begin, end);
}

void light_grid_fill(const LightGridPlan *plan, CellRecord *tiles, u32 *indices, Arena *scratch) {
    u64 mark = arena_mark(scratch);
    FillJob job = {.plan = plan, .indices = indices};
    job.cursor = ARENA_PUSH(scratch, u32, plan->tile_count);
    bool sharing = plan->share_from != UINT32_MAX;
    for (u32 i = 0; i < plan->tile_count; i++) {
        u32 offset = plan->point_first[i], points = plan->spot_first[i] - offset,
            spots = plan->end[i] - plan->spot_first[i];
        tiles[i] = (CellRecord){{offset, points, spots, 0}};
        // Points come before spots in the input, so one cursor writes both parts in order.
        job.cursor[i] = sharing && offset == 0 ? UINT32_MAX : offset;
    }
    if (sharing)
        for (u32 i = 0; i < plan->input.count; i++) indices[i] = i;
    jobs_for(plan->tiles_y, FILL_ROWS_PER_JOB, job_fill, &job);
    arena_rewind(scratch, mark);
}

LightGrid light_grid_build(const LightGridInput *input, Arena *arena) {
    LightGridPlan plan = light_grid_plan(input, arena);
    LightGrid grid = {.tiles_x = plan.tiles_x,
                      .tiles_y = plan.tiles_y,
                      .index_count = plan.index_count,
                      .longest = plan.longest};
    grid.tiles = ARENA_PUSH(arena, CellRecord, plan.tile_count);
    grid.indices = ARENA_PUSH(arena, u32, plan.index_count);
    light_grid_fill(&plan, grid.tiles, grid.indices, arena);
    return grid;
}
