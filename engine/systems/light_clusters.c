// light_clusters.c: slices of depth, and the clusters (tile and slice) that each light touches.
// Data in: view-space spheres and cones, the lens, the tile size. Data out: where slices end; one
// rectangle of tiles a light and slice. Called by: packet_lists.c and tests (slices),
// light_grid_plan (boxes). Does not: know which clusters are seen.
//
// Specification of direct lighting, 6.3: slices grow by a constant factor, so that a cluster is as
// deep as it is high: w = 1 + 2 tan(fov_y / 2) / tiles_y. A shader computes
//   slice = clamp(floor(log2(depth) x + y), 0, count - 1);
// x and y in single precision are the definition; the ends of slices follow from them, and a light
// also goes to the neighbour slice if it comes as near to it as a shader's logarithm may err.
#include "light_grid.h"
#include "../base/jobs.h"
#include "../base/maths.h"

#define LIGHTS_PER_JOB 128
// Part of a slice that a shader's slice may be off; float's log2 is good for 1/500 at 256 slices.
#define SLICE_SLACK (1.0 / 128.0)
// The first slice may be this part of the smallest light's radius long: finer tells nothing more.
#define FINEST_PART 0.25f
#define FEW_SLICES  8

// ---- slices ----

// In double from + and * alone, for the same bits everywhere (Taylor series of 2^t on 0..1).
static f64 exp2_exact(f64 t) {
    f64 whole = floor(t), x = (t - whole) * 0.69314718055994530942, term = 1.0, sum = 1.0;
    for (u32 i = 1; i < 20; i++) sum += term *= x / i;
    return ldexp(sum, (int)CLAMP(whole, -1000.0, 1000.0));
}
static f32 log2_of(f32 x) { return det_log(x) * 1.44269504f; }

ClusterSlices light_cluster_slices(const LightGridInput *in, u32 cells_cap) {
    u32 tiles_x = (in->width_px + in->tile_px - 1) / in->tile_px;
    u32 tiles_y = (in->height_px + in->tile_px - 1) / in->tile_px;
    f32 nearest = 1e30f, farthest = 0.0f, smallest = 1e30f;
    for (u32 i = 0; i < in->count; i++) {
        f32 radius = in->radius[i], front = -in->z[i] - radius, back = -in->z[i] + radius;
        if (!(back > in->near)) continue;
        nearest = MIN(nearest, front);
        farthest = MAX(farthest, back);
        smallest = MIN(smallest, radius);
    }
    u32 tiles = tiles_x * tiles_y, cap = MIN(CLUSTER_SLICES_CAP, cells_cap / tiles);
    // Small tiles: a few slices are worth more cells.
    if (cap < FEW_SLICES) cap = (u32)MIN(FEW_SLICES, (u64)cells_cap * FEW_SLICES / tiles);
    f32 part = 2.0f / (in->scale_y * (f32)tiles_y); // a cluster's height by its depth
    // The cap is for lenses from hostile files; a single row of tiles is the widest real one.
    part = part > 1e-4f ? MIN(part, 1e3f) : 1e-4f;
    f32 factor = 1.0f + part, end = in->near * factor;
    end = MAX(end, MAX(nearest, in->near + smallest * FINEST_PART));
    end = CLAMP(end, 1e-6f, 1e18f);
    farthest = CLAMP(farthest, 1e-6f, 1e18f);
    if (cap <= 2 || !(farthest > end))
        return (ClusterSlices){.count = 1, .end = end, .factor = factor};
    // One in front of `end`, one behind `farthest`.
    f32 octaves = log2_of(farthest / end), step = log2_of(factor);
    f32 between = ceilf(octaves / step);
    if (between > (f32)(cap - 2)) {
        between = (f32)(cap - 2);
        step = octaves / between;
    }
    ClusterSlices slices = {.count = (u32)between + 2, .scale = 1.0f / step, .end = end};
    slices.offset = 1.0f - log2_of(end) * slices.scale;
    slices.factor = (f32)exp2_exact(1.0 / (f64)slices.scale);
    slices.end = (f32)exp2_exact((1.0 - (f64)slices.offset) / (f64)slices.scale);
    return slices;
}

// Depths that belong to a slice, with slack.
typedef struct SliceEnds {
    f64 from[CLUSTER_SLICES_CAP], to[CLUSTER_SLICES_CAP];
    u32 count;
} SliceEnds;

static SliceEnds *find_ends(const LightGridInput *in, Arena *scratch) {
    SliceEnds *ends = ARENA_PUSH(scratch, SliceEnds, 1);
    const ClusterSlices *s = &in->slices;
    ends->count = s->count;
    for (u32 k = 0; k < s->count; k++) {
        f64 from = ((f64)k - SLICE_SLACK - s->offset) / s->scale,
            to = ((f64)k + 1.0 + SLICE_SLACK - s->offset) / s->scale;
        ends->from[k] = k ? MAX(exp2_exact(from), (f64)in->near) : (f64)in->near;
        ends->to[k] = k + 1 < s->count ? exp2_exact(to) : INFINITY;
    }
    return ends;
}

// ---- boxes ----

typedef struct ClusterJob {
    LightGridPlan *plan;
    const SliceEnds *ends;
    u16 (*range)[2]; // [light count] first and last slice; first > last: none
} ClusterJob;

// The slice that holds a depth, by bisection: the last that begins at or before it.
static u32 find_slice(const SliceEnds *ends, f64 depth) {
    u32 low = 0, high = ends->count - 1;
    while (low < high) {
        u32 middle = (low + high + 1) / 2;
        if (ends->from[middle] <= depth)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static void job_slices(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const ClusterJob *job = context;
    const LightGridInput *in = &job->plan->input;
    for (u32 i = begin; i < end; i++) {
        f64 front = -(f64)in->z[i] - in->radius[i], back = -(f64)in->z[i] + in->radius[i];
        if (light_is_cone(in, i)) {
            Cone cone = light_grid_cone(in, i);
            const f64 forth[3] = {0, 0, 1}, backwards[3] = {0, 0, -1};
            front = cone.tip[2] - cone_extent(&cone, backwards);
            back = cone.tip[2] + cone_extent(&cone, forth);
        }
        u16 *range = job->range[i];
        range[0] = 1, range[1] = 0;
        if (!(back > in->near)) continue;
        u32 first = find_slice(job->ends, front);
        while (first > 0 && job->ends->to[first - 1] >= front) first--; // the slack
        range[0] = (u16)first;
        range[1] = (u16)find_slice(job->ends, back);
    }
}

static CellBox make_box(const LightGridPlan *plan, u32 slice, const RatioRange r[2]) {
    const LightGridInput *in = &plan->input;
    u16 x0, x1, y0, y1;
    if (!light_grid_tiles(r[0].low * in->scale_x, r[0].high * in->scale_x, in->width_px,
                          in->tile_px, &x0, &x1) ||
        !light_grid_tiles(-r[1].high * in->scale_y, -r[1].low * in->scale_y, in->height_px,
                          in->tile_px, &y0, &y1))
        return (CellBox){slice * plan->tiles_y, 0, 0, 0};
    return (CellBox){slice * plan->tiles_y + y0, (u16)(y1 - y0 + 1), x0, x1};
}

static void ball_boxes(const LightGridPlan *plan, const SliceEnds *ends, u32 i, u32 first, u32 last,
                       CellBox *boxes) {
    const LightGridInput *in = &plan->input;
    const BallAxis axes[2] = {ball_axis(in->x[i], -(f64)in->z[i], in->radius[i]),
                              ball_axis(in->y[i], -(f64)in->z[i], in->radius[i])};
    for (u32 k = first; k <= last; k++) {
        RatioRange r[2];
        bool any = ball_axis_range(&axes[0], ends->from[k], ends->to[k], &r[0]) &&
                   ball_axis_range(&axes[1], ends->from[k], ends->to[k], &r[1]);
        boxes[k - first] = any ? make_box(plan, k, r) : (CellBox){k * plan->tiles_y, 0, 0, 0};
    }
}

static void cone_boxes(const LightGridPlan *plan, const SliceEnds *ends, u32 i, u32 first, u32 last,
                       CellBox *boxes) {
    const LightGridInput *in = &plan->input;
    Cone cone = light_grid_cone(in, i);
    const ConeAxis axes[2] = {cone_axis(&cone, 0), cone_axis(&cone, 1)};
    for (u32 k = first; k <= last; k++) {
        RatioRange r[2];
        bool any = cone_axis_range(&axes[0], ends->from[k], ends->to[k], &r[0]) &&
                   cone_axis_range(&axes[1], ends->from[k], ends->to[k], &r[1]);
        boxes[k - first] = any ? make_box(plan, k, r) : (CellBox){k * plan->tiles_y, 0, 0, 0};
    }
}

static void job_boxes(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const ClusterJob *job = context;
    const LightGridPlan *plan = job->plan;
    for (u32 i = begin; i < end; i++) {
        u32 first = job->range[i][0], last = job->range[i][1];
        if (first > last) continue;
        CellBox *boxes = plan->boxes + plan->box_first[i];
        if (light_is_cone(&plan->input, i))
            cone_boxes(plan, job->ends, i, first, last, boxes);
        else
            ball_boxes(plan, job->ends, i, first, last, boxes);
    }
}

void light_clusters_boxes(LightGridPlan *plan, Arena *scratch) {
    u32 count = plan->input.count;
    ClusterJob job = {.plan = plan, .ends = find_ends(&plan->input, scratch)};
    job.range = arena_push(scratch, sizeof *job.range * (u64)count, CACHE_LINE);
    jobs_for(count, LIGHTS_PER_JOB, job_slices, &job);
    plan->box_first = ARENA_PUSH(scratch, u32, count + 1);
    for (u32 i = 0; i < count; i++) {
        u32 boxes =
            job.range[i][0] > job.range[i][1] ? 0 : (u32)(job.range[i][1] - job.range[i][0]) + 1;
        plan->box_first[i + 1] = plan->box_first[i] + boxes;
    }
    plan->boxes = ARENA_PUSH(scratch, CellBox, plan->box_first[count]);
    jobs_for(count, LIGHTS_PER_JOB, job_boxes, &job);
}
