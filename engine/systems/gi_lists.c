// gi_lists.c: which lights reach which part of the voxels' box.
// Data in: light records, the shape of the coarsest grid. Data out: a grid of cells over its box,
// for each the lights that touch it, ascending. Called by: packet_build. Does not: look at the
// view: voxels outside it are lit as well.
//
// Cells are 4 to 16 voxels wide, or one is all: few lights that reach most of the box would be
// gone through again for each cell that neighbouring voxels lie in. Two passes over all lights, for
// each layer of cells by itself: count, then fill; so the result does not depend on the number of
// threads. A ball's cells are found row by row, exactly; those of a cone are tested besides, each
// by the ball around it.
#include "gi.h"
#include "../base/jobs.h"
#include <string.h>

#define CELL_VOXELS    4
#define LAYERS_PER_JOB 4
// Of so few lights lists that hold a third of all on average are not worth having.
#define LIGHTS_FEW 64
#define DENSE_PART 3
// Cells are this part of their side larger than they are: positions in shaders are rounded.
#define CELL_SLACK  (1.0f / 64.0f)
#define REACH_SLACK 1e-5f

typedef struct ListShape {
    f32 tip[3], reach;         // ball
    f32 axis[3], cos_h, sin_h; // cone; cos_h < 0: none
    u32 first[3], last[3];     // cells of the ball's box; first > last: none
} ListShape;

typedef struct ListJob {
    const ListShape *shapes;
    u32 shape_count;
    u32 cells[3];
    f32 origin[3], side[3]; // of the grid, of a cell
    f32 radius;             // of the ball around a cell
    u32 *counts;            // [cells] lights, then where each list goes on
    u32 *words;             // NULL: count
} ListJob;

static ListShape make_shape(const ListJob *job, const GiLightRecord *light) {
    ListShape shape = {.cos_h = -1.0f};
    shape.reach = light->position[3] > 0.0f ? 1.0f / sqrtf(light->position[3]) : 0.0f;
    shape.reach += shape.reach * REACH_SLACK;
    memcpy(shape.tip, light->position, sizeof shape.tip);
    memcpy(shape.axis, light->direction, sizeof shape.axis);
    f32 cos_outer = light->direction[3] - REACH_SLACK;
    if (light->extra[1] == 1.0f && cos_outer > 0.0f && cos_outer < 1.0f) {
        shape.cos_h = cos_outer;
        shape.sin_h = sqrtf(1.0f - cos_outer * cos_outer);
    }
    for (u32 a = 0; a < 3; a++) {
        f32 low = (shape.tip[a] - shape.reach - job->origin[a]) / job->side[a] - CELL_SLACK,
            high = (shape.tip[a] + shape.reach - job->origin[a]) / job->side[a] + CELL_SLACK;
        f32 end = (f32)job->cells[a];
        if (!(high >= 0.0f && low <= end)) {
            shape.first[a] = 1, shape.last[a] = 0;
            continue;
        }
        shape.first[a] = low > 0.0f ? MIN((u32)low, job->cells[a] - 1) : 0;
        shape.last[a] = high < end ? (u32)high : job->cells[a] - 1;
    }
    return shape;
}

// How far a coordinate is outside the cell's interval along an axis.
static f32 axis_distance(const ListJob *job, u32 axis, u32 cell, f32 at) {
    f32 slack = job->side[axis] * CELL_SLACK;
    f32 low = job->origin[axis] + (f32)cell * job->side[axis] - slack;
    return MAX(MAX(low - at, at - (low + job->side[axis] + 2.0f * slack)), 0.0f);
}

// The ball around the cell, against the cone as a whole: how far its centre is from a plane that
// touches the cone along the line nearest to it.
static bool cone_touches(const ListJob *job, const ListShape *shape, u32 x, u32 y, u32 z) {
    const u32 cell[3] = {x, y, z};
    f32 v2 = 0.0f, along = 0.0f;
    for (u32 a = 0; a < 3; a++) {
        f32 v = job->origin[a] + ((f32)cell[a] + 0.5f) * job->side[a] - shape->tip[a];
        v2 += v * v;
        along += v * shape->axis[a];
    }
    f32 across = sqrtf(MAX(v2 - along * along, 0.0f));
    return across * shape->cos_h - along * shape->sin_h <= job->radius;
}

// Cells of a row that the ball touches: those whose interval comes within its half width there.
static void list_row(const ListJob *job, const ListShape *shape, u32 index, u32 y, u32 z,
                     f32 half) {
    f32 low = (shape->tip[0] - half - job->origin[0]) / job->side[0] - CELL_SLACK,
        high = (shape->tip[0] + half - job->origin[0]) / job->side[0] + CELL_SLACK;
    if (!(high >= 0.0f && low <= (f32)job->cells[0])) return;
    u32 first = low > 0.0f ? MIN((u32)low, job->cells[0] - 1) : 0;
    u32 last = high < (f32)job->cells[0] ? (u32)high : job->cells[0] - 1;
    u32 *counts = job->counts + job->cells[0] * (y + (u64)job->cells[1] * z);
    bool is_cone = shape->cos_h > 0.0f;
    for (u32 x = first; x <= last; x++) {
        if (is_cone && !cone_touches(job, shape, x, y, z)) continue;
        if (job->words) job->words[counts[x]] = index;
        counts[x]++;
    }
}

static void job_layers(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const ListJob *job = context;
    for (u32 i = 0; i < job->shape_count; i++) {
        const ListShape *shape = &job->shapes[i];
        u32 z_end = MIN(shape->last[2] + 1, end);
        f32 reach2 = shape->reach * shape->reach;
        for (u32 z = MAX(shape->first[2], begin); z < z_end; z++) {
            f32 dz = axis_distance(job, 2, z, shape->tip[2]), left_z = reach2 - dz * dz;
            for (u32 y = shape->first[1]; y <= shape->last[1]; y++) {
                f32 dy = axis_distance(job, 1, y, shape->tip[1]), left = left_z - dy * dy;
                if (left >= 0.0f) list_row(job, shape, i, y, z, sqrtf(left));
            }
        }
    }
}

static bool shape_is_nowhere(const ListShape *s) {
    return s->first[0] > s->last[0] || s->first[1] > s->last[1] || s->first[2] > s->last[2];
}

// Words that the lists of these cells need.
static u64 count_words(ListJob *job, ListShape *shapes, const GiLightRecord *lights, u32 count) {
    u32 cell_count = job->cells[0] * job->cells[1] * job->cells[2];
    for (u32 i = 0; i < count; i++) {
        shapes[i] = make_shape(job, &lights[i]);
        if (shape_is_nowhere(&shapes[i]))
            for (u32 a = 0; a < 3; a++) shapes[i].first[a] = 1, shapes[i].last[a] = 0;
    }
    memset(job->counts, 0, cell_count * sizeof *job->counts);
    jobs_for(job->cells[2], LAYERS_PER_JOB, job_layers, job);
    u64 words = 2ull * cell_count;
    for (u32 i = 0; i < cell_count; i++) words += job->counts[i];
    return words;
}

// divisor: how much wider cells are than they could be.
static void shape_cells(ListJob *job, const GiRecord *record, u32 divisor) {
    const f32 *coarsest = record->origin[record->dims[3] - 1];
    f32 radius2 = 0.0f;
    for (u32 a = 0; a < 3; a++) {
        u32 cells = MIN(MAX(record->dims[a] / CELL_VOXELS, 1), GI_LIST_CELLS_CAP);
        job->cells[a] = MAX(cells / divisor, 1);
        job->origin[a] = coarsest[a];
        job->side[a] = (f32)record->dims[a] * coarsest[3] / (f32)job->cells[a];
        f32 half = job->side[a] * (0.5f + CELL_SLACK);
        radius2 += half * half;
    }
    job->radius = sqrtf(radius2) * (1.0f + REACH_SLACK);
}

_Static_assert(ENTITY_CAP + 2 <= GI_LISTS_CAP, "the lists' last resort fits");

GiLists gi_lists_make(GiRecord *record, const GiLightRecord *lights, u32 light_count,
                      Arena *scratch) {
    ListShape *shapes = ARENA_PUSH(scratch, ListShape, light_count);
    ListJob job = {.shapes = shapes, .shape_count = light_count};
    job.counts =
        ARENA_PUSH(scratch, u32, GI_LIST_CELLS_CAP * GI_LIST_CELLS_CAP * GI_LIST_CELLS_CAP);
    shape_cells(&job, record, 1);
    u64 words = count_words(&job, shapes, lights, light_count);
    u32 cell_count = job.cells[0] * job.cells[1] * job.cells[2];
    bool is_dense = light_count <= LIGHTS_FEW &&
                    (words - 2ull * cell_count) * DENSE_PART >= (u64)light_count * cell_count;
    // A single cell holds at most all lights, and there are fewer of them than words.
    for (u32 wider = is_dense ? GI_LIST_CELLS_CAP : 2; is_dense || words > GI_LISTS_CAP;
         wider *= 2) {
        is_dense = false;
        shape_cells(&job, record, wider);
        words = count_words(&job, shapes, lights, light_count);
        cell_count = job.cells[0] * job.cells[1] * job.cells[2];
    }
    GiLists lists = {.count = (u32)words, .index_count = (u32)words - 2 * cell_count};
    lists.words = ARENA_PUSH(scratch, u32, lists.count);
    u32 cursor = 2 * cell_count;
    for (u32 i = 0; i < cell_count; i++) {
        u32 count = job.counts[i];
        lists.words[2 * i] = job.counts[i] = cursor;
        lists.words[2 * i + 1] = count;
        cursor += count;
    }
    job.words = lists.words;
    jobs_for(job.cells[2], LAYERS_PER_JOB, job_layers, &job);
    for (u32 a = 0; a < 3; a++) {
        record->light_grid[a] = job.cells[a];
        record->light_grid_origin[a] = job.origin[a];
        record->light_grid_rate[a] = 1.0f / job.side[a];
    }
    record->light_grid[3] = light_count;
    return lists;
}
