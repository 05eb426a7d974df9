// transform.c: the hierarchy: world matrices of entities, of drawables and of lights.
// Data in: transform's position, rotation, scale, offset and parent; drawable.l; light's own data.
// Data out: transform.w, drawable.w, light.x .. light.reach, with new stamps on rows that changed.
// Called by: the system table, after everything that moves things. Does not: keep a sorted order
// between ticks (rows move when entities die), or trust the parent links: stale parents count as
// none, and every entity on a cycle counts as a root.
//
// What a tick costs follows from stamps: nothing changed = three compares; else one pass over the
// stamps, a chain walk for rows that have a parent, and matrix work for changed rows only. A row
// whose matrix came out the same keeps its stamp, so downstream nobody works for it.
#include "systems.h"
#include "../base/jobs.h"
#include <string.h>

#define ROWS_PER_JOB 512

// Parent row of each row that has one. Roots are ROW_NONE.
typedef struct Hierarchy {
    TransformTable *transforms;
    u32 *parent_row; // [count]
    u32 *order;      // [child_count] rows with a parent, parents before children
    u32 child_count;
    u32 *level_first; // [level_count + 1] into order: one level needs only the levels above it
    u32 level_count;
} Hierarchy;

#define DEPTH_UNKNOWN  UINT32_MAX
#define DEPTH_ON_CHAIN (UINT32_MAX - 1) // is being walked: meeting it again closes a cycle

// Depth of every row that has a parent, walking up until a known depth; every row is walked once.
static u32 find_depths(const Hierarchy *h, const u32 *children, u32 *depth, u32 *chain) {
    u32 deepest = 0;
    for (u32 i = 0; i < h->child_count; i++) {
        u32 length = 0, row = children[i];
        while (row != ROW_NONE && depth[row] == DEPTH_UNKNOWN) {
            depth[row] = DEPTH_ON_CHAIN;
            chain[length++] = row;
            row = h->parent_row[row];
        }
        if (row != ROW_NONE && depth[row] == DEPTH_ON_CHAIN) {
            // The part of the chain from `row` on is a cycle: each of its members becomes a root.
            u32 member;
            do {
                member = chain[--length];
                h->parent_row[member] = ROW_NONE;
                depth[member] = 0;
            } while (member != row);
        }
        u32 above = length ? h->parent_row[chain[length - 1]] : ROW_NONE;
        u32 level = above == ROW_NONE ? 0 : depth[above] + 1;
        while (length > 0) depth[chain[--length]] = level++;
        deepest = MAX(deepest, depth[children[i]]);
    }
    return deepest;
}

// Orders rows with a parent by depth (counting sort: stable, linear).
static Hierarchy hierarchy_build(TransformTable *transforms, Arena *scratch) {
    const Table *table = &transforms->table;
    Hierarchy h = {.transforms = transforms};
    h.parent_row = ARENA_PUSH(scratch, u32, table->count);
    u32 *children = ARENA_PUSH(scratch, u32, table->count);
    for (u32 row = 0; row < table->count; row++) {
        Entity parent = transforms->parent[row];
        h.parent_row[row] = parent == ENTITY_NONE ? ROW_NONE : table_row(table, parent);
        if (h.parent_row[row] != ROW_NONE) children[h.child_count++] = row;
    }
    if (h.child_count == 0) return h;

    u32 *depth = ARENA_PUSH(scratch, u32, table->count);
    u32 *chain = ARENA_PUSH(scratch, u32, table->count);
    for (u32 row = 0; row < table->count; row++)
        depth[row] = h.parent_row[row] == ROW_NONE ? 0 : DEPTH_UNKNOWN;
    h.level_count = find_depths(&h, children, depth, chain) + 1;

    // Level 0 holds the former members of cycles: they are roots, and are computed with the others.
    h.level_first = ARENA_PUSH(scratch, u32, h.level_count + 1);
    u32 *cursor = ARENA_PUSH(scratch, u32, h.level_count);
    h.order = ARENA_PUSH(scratch, u32, h.child_count);
    for (u32 i = 0; i < h.child_count; i++) h.level_first[depth[children[i]] + 1]++;
    for (u32 i = 0; i < h.level_count; i++) h.level_first[i + 1] += h.level_first[i];
    memcpy(cursor, h.level_first, h.level_count * sizeof *cursor);
    for (u32 i = 0; i < h.child_count; i++) h.order[cursor[depth[children[i]]]++] = children[i];
    return h;
}

static Mat34 local_matrix(const TransformTable *t, u32 row) {
    Vec3 position = {t->x[row] + t->offset_x[row], t->y[row] + t->offset_y[row],
                     t->z[row] + t->offset_z[row]};
    Vec3 scale = {t->scale_x[row], t->scale_y[row], t->scale_z[row]};
    Vec3 rotation = {t->pitch[row], t->yaw[row], t->roll[row]};
    // Most moving things (thousands of lights) are not turned: no trigonometry for them.
    if (rotation.x == 0.0f && rotation.y == 0.0f && rotation.z == 0.0f)
        return (Mat34){
            {scale.x, 0, 0, position.x, 0, scale.y, 0, position.y, 0, 0, scale.z, position.z}};
    return mat34_from_trs(position, rotation, scale);
}

// Writes what differs in any bit; most often that is the translation alone, and a write that is not
// made leaves its cache line clean.
static bool store_if_different(f32 *const *columns, u32 row, const Mat34 *matrix) {
    bool changed = false;
    for (u32 i = 0; i < 12; i++) {
        if (memcmp(&columns[i][row], &matrix->m[i], sizeof(f32)) == 0) continue;
        columns[i][row] = matrix->m[i];
        changed = true;
    }
    return changed;
}

// Jobs stamp their own rows; newest_stamp is one value for the table and belongs to the caller.
typedef struct TransformJob {
    const Hierarchy *hierarchy;
    const u32 *rows; // NULL: the range is rows themselves
    u32 last_stamp, now;
    bool all;
    u32 *changed_by_thread; // [JOBS_THREADS_MAX]
} TransformJob;

static void job_transform_rows(void *context, u32 begin, u32 end, u32 thread_index) {
    const TransformJob *job = context;
    const Hierarchy *h = job->hierarchy;
    TransformTable *t = h->transforms;
    u32 changed = 0;
    for (u32 i = begin; i < end; i++) {
        u32 row = job->rows ? job->rows[i] : i;
        u32 parent = h->parent_row[row];
        if (!job->rows && parent != ROW_NONE) continue; // in a level below
        // A parent that moved in this run carries the stamp of now.
        bool dirty = job->all || t->table.stamp[row] > job->last_stamp ||
                     (parent != ROW_NONE && t->table.stamp[parent] > job->last_stamp);
        if (!dirty) continue;
        Mat34 world = local_matrix(t, row);
        if (parent != ROW_NONE) {
            Mat34 above;
            columns_get_mat34(&t->w00, parent, above.m);
            world = mat34_mul(above, world);
        }
        if (!store_if_different(&t->w00, row, &world)) continue;
        t->table.stamp[row] = job->now;
        changed++;
    }
    job->changed_by_thread[thread_index] += changed;
}

static void update_transforms(TransformTable *transforms, SystemContext *context) {
    Table *table = &transforms->table;
    if (table->count == 0 || !table_changed_since(table, context->last_stamp + 1)) return;
    Hierarchy h = hierarchy_build(transforms, context->scratch);
    u32 changed_by_thread[JOBS_THREADS_MAX] = {0};
    TransformJob job = {.hierarchy = &h,
                        .last_stamp = context->last_stamp,
                        .now = context->world->stamp,
                        // A parent may have gone or come: its children do not tell.
                        .all = table->structure_stamp > context->last_stamp,
                        .changed_by_thread = changed_by_thread};
    jobs_for(table->count, ROWS_PER_JOB, job_transform_rows, &job);
    for (u32 level = 1; level < h.level_count; level++) {
        job.rows = h.order + h.level_first[level];
        u32 count = h.level_first[level + 1] - h.level_first[level];
        jobs_for(count, ROWS_PER_JOB, job_transform_rows, &job);
    }
    for (u32 i = 0; i < JOBS_THREADS_MAX; i++)
        if (changed_by_thread[i]) table->newest_stamp = job.now;
}

// ---- what follows from world matrices ----

typedef struct FollowJob {
    const TransformTable *transforms;
    DrawableTable *drawables;
    LightTable *lights;
    u32 last_stamp, now;
    bool all;
    u32 *changed_by_thread;
} FollowJob;

static void job_drawables(void *context, u32 begin, u32 end, u32 thread_index) {
    const FollowJob *job = context;
    const TransformTable *t = job->transforms;
    DrawableTable *d = job->drawables;
    for (u32 row = begin; row < end; row++) {
        u32 owner = table_row(&t->table, d->owner[row]);
        bool moved = owner != ROW_NONE && t->table.stamp[owner] > job->last_stamp;
        if (!job->all && !moved && d->table.stamp[row] <= job->last_stamp) continue;
        Mat34 world, local;
        columns_get_mat34(&d->l00, row, local.m);
        if (owner != ROW_NONE) {
            columns_get_mat34(&t->w00, owner, world.m);
            local = mat34_mul(world, local);
        }
        if (!store_if_different(&d->w00, row, &local)) continue;
        d->table.stamp[row] = job->now;
        job->changed_by_thread[thread_index] = 1;
    }
}

// Where color * intensity / d^2 falls below 1/256 (specification of direct lighting, section 1).
static f32 light_reach(const LightTable *light, u32 row) {
    if (light->range[row] > 0.0f) return light->range[row];
    f32 brightest = MAX(MAX(light->color_r[row], light->color_g[row]), light->color_b[row]);
    f32 reach = sqrtf(256.0f * MAX(light->intensity[row] * brightest, 0.0f));
    return MIN(reach, 1e4f); // the longest range that level text may give
}

static void job_lights(void *context, u32 begin, u32 end, u32 thread_index) {
    const FollowJob *job = context;
    const TransformTable *t = job->transforms;
    LightTable *light = job->lights;
    for (u32 row = begin; row < end; row++) {
        u32 place = table_row(&t->table, light->table.entity[row]);
        bool moved = place != ROW_NONE && t->table.stamp[place] > job->last_stamp;
        if (!job->all && !moved && light->table.stamp[row] <= job->last_stamp) continue;
        f32 derived[7] = {0, 0, 0, 0, 0, -1, light_reach(light, row)};
        if (place != ROW_NONE) {
            Vec3 back = vec3_normalize(vec3(t->w02[place], t->w12[place], t->w22[place]));
            derived[0] = t->w03[place], derived[1] = t->w13[place], derived[2] = t->w23[place];
            if (vec3_dot(back, back) > 0.0f)
                derived[3] = -back.x, derived[4] = -back.y, derived[5] = -back.z;
        }
        f32 *const columns[7] = {light->x,     light->y,     light->z,    light->dir_x,
                                 light->dir_y, light->dir_z, light->reach};
        bool changed = false;
        for (u32 i = 0; i < 7; i++) {
            if (memcmp(&columns[i][row], &derived[i], sizeof(f32)) == 0) continue;
            columns[i][row] = derived[i];
            changed = true;
        }
        if (!changed) continue;
        light->table.stamp[row] = job->now;
        job->changed_by_thread[thread_index] = 1;
    }
}

static void update_followers(FollowJob job, Table *table, JobFunction function,
                             bool transforms_changed) {
    u32 changed_by_thread[JOBS_THREADS_MAX] = {0};
    if (table->count == 0) return;
    if (!transforms_changed && !table_changed_since(table, job.last_stamp + 1)) return;
    job.changed_by_thread = changed_by_thread;
    jobs_for(table->count, ROWS_PER_JOB, function, &job);
    for (u32 i = 0; i < JOBS_THREADS_MAX; i++)
        if (changed_by_thread[i]) table->newest_stamp = job.now;
}

void system_transform(SystemContext *context) {
    World *world = context->world;
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    FollowJob job = {.transforms = transforms,
                     .drawables = WORLD_TABLE(world, Drawable, drawable),
                     .lights = WORLD_TABLE(world, Light, light),
                     .last_stamp = context->last_stamp,
                     .now = world->stamp,
                     .all = transforms->table.structure_stamp > context->last_stamp};
    update_transforms(transforms, context);
    bool moved = table_changed_since(&transforms->table, context->last_stamp + 1);
    update_followers(job, &job.drawables->table, job_drawables, moved);
    update_followers(job, &job.lights->table, job_lights, moved);
}
