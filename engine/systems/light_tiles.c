// light_tiles.c: the tiles of the screen that each light touches.
// Data in: view-space spheres and cones, the lens, the tile size. Data out: boxes of tiles: one
// rectangle a light (method `rect`), or one run of tiles a row (`frustum`). Called by:
// light_grid_plan. Does not: know depths or lists.
//
// `frustum` is the test of each tile's four side planes against the light, without asking every
// tile: planes through the eye are lines on the screen, so a row of tiles is a strip of it, and a
// light's outline there (a ball's ellipse, a cone's straight sides) has exact ends. What four
// planes tested one by one let through, the corners of the outline's rectangle, is left out too.
#include "light_grid.h"
#include "../base/jobs.h"
#include <string.h>

#define LIGHTS_PER_JOB 256

typedef struct TilesJob {
    LightGridPlan *plan;
    CellBox *rects;     // [light count]
    RatioRange *across; // [light count] x / depth, for the rows
} TilesJob;

// x / depth and y / depth of all of a light that is in front of the near plane.
static bool find_ranges(const LightGridInput *in, u32 i, RatioRange ranges[2]) {
    if (light_is_cone(in, i)) {
        Cone cone = light_grid_cone(in, i);
        for (u32 axis = 0; axis < 2; axis++) {
            ConeAxis a = cone_axis(&cone, axis);
            if (!cone_axis_range(&a, in->near, INFINITY, &ranges[axis])) return false;
        }
        return true;
    }
    const f32 at[2] = {in->x[i], in->y[i]};
    for (u32 axis = 0; axis < 2; axis++) {
        BallAxis a = ball_axis(at[axis], -(f64)in->z[i], in->radius[i]);
        if (!ball_axis_range(&a, in->near, INFINITY, &ranges[axis])) return false;
    }
    return true;
}

static void job_rects(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const TilesJob *job = context;
    const LightGridInput *in = &job->plan->input;
    for (u32 i = begin; i < end; i++) {
        RatioRange r[2];
        u16 x0, x1, y0, y1;
        job->rects[i] = (CellBox){0};
        // NDC y points up, rows go down.
        if (!find_ranges(in, i, r) ||
            !light_grid_tiles(r[0].low * in->scale_x, r[0].high * in->scale_x, in->width_px,
                              in->tile_px, &x0, &x1) ||
            !light_grid_tiles(-r[1].high * in->scale_y, -r[1].low * in->scale_y, in->height_px,
                              in->tile_px, &y0, &y1))
            continue;
        job->rects[i] = (CellBox){y0, (u16)(y1 - y0 + 1), x0, x1};
        if (job->across) job->across[i] = r[0];
    }
}

// Cuts the range by a side of a cone: n . (X, Y, 1) <= 0 for some Y of the row.
static bool cut_by_side(const f64 n[3], f64 y_from, f64 y_to, RatioRange *range) {
    f64 limit = MAX(-(n[1] * y_from + n[2]), -(n[1] * y_to + n[2]));
    if (n[0] > 1e-6)
        range->high = MIN(range->high, limit / n[0]);
    else if (n[0] < -1e-6)
        range->low = MAX(range->low, limit / n[0]);
    return range->low <= range->high;
}

static void job_rows(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const TilesJob *job = context;
    const LightGridPlan *plan = job->plan;
    const LightGridInput *in = &plan->input;
    f64 slack = LIGHT_GRID_SLACK / in->scale_y, step = 2.0 * in->tile_px / in->height_px;
    for (u32 i = begin; i < end; i++) {
        CellBox rect = job->rects[i], *boxes = plan->boxes + plan->box_first[i];
        BallOutline outline;
        bool round =
            ball_outline(in->x[i], in->y[i], -(f64)in->z[i], in->radius[i], in->near, &outline);
        f64 sides[2][3];
        u32 side_count = 0;
        if (light_is_cone(in, i)) {
            Cone cone = light_grid_cone(in, i);
            side_count = cone_silhouettes(&cone, sides);
        }
        for (u32 y = 0; y < rect.rows; y++) {
            f64 top = 1.0 - step * (rect.row + y);
            f64 y_to = top / in->scale_y + slack, y_from = (top - step) / in->scale_y - slack;
            RatioRange row = job->across[i], ball;
            bool any = true;
            if (round) {
                any = ball_outline_range(&outline, y_from, y_to, &ball);
                if (any) row = (RatioRange){MAX(row.low, ball.low), MIN(row.high, ball.high)};
            }
            for (u32 s = 0; s < side_count; s++)
                any = any && cut_by_side(sides[s], y_from, y_to, &row);
            CellBox box = {rect.row + y, 1, 0, 0};
            any = any && row.low <= row.high + slack &&
                  light_grid_tiles(row.low * in->scale_x, row.high * in->scale_x, in->width_px,
                                   in->tile_px, &box.x0, &box.x1);
            if (any) box.x0 = MAX(box.x0, rect.x0), box.x1 = MIN(box.x1, rect.x1);
            box.rows = any && box.x0 <= box.x1;
            boxes[y] = box;
        }
    }
}

void light_tiles_boxes(LightGridPlan *plan, Arena *scratch) {
    u32 count = plan->input.count;
    TilesJob job = {.plan = plan, .rects = ARENA_PUSH(scratch, CellBox, count)};
    bool by_rows = plan->input.method != GRID_RECT;
    if (by_rows) job.across = ARENA_PUSH(scratch, RatioRange, count);
    jobs_for(count, LIGHTS_PER_JOB, job_rects, &job);
    plan->box_first = ARENA_PUSH(scratch, u32, count + 1);
    if (!by_rows) {
        plan->boxes = job.rects;
        for (u32 i = 0; i <= count; i++) plan->box_first[i] = i;
        return;
    }
    for (u32 i = 0; i < count; i++) plan->box_first[i + 1] = plan->box_first[i] + job.rects[i].rows;
    plan->boxes = ARENA_PUSH(scratch, CellBox, plan->box_first[count]);
    jobs_for(count, LIGHTS_PER_JOB, job_rows, &job);
}
