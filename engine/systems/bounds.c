// bounds.c: the sphere around every drawable, in world space.
// Data in: drawable.w and mesh, the mesh's own sphere, instance.visible. Data out:
// drawable.bounds_*; radius -1 where the instance is hidden, gone, or has no mesh. Called by: the
// system table, after transform. Does not: look at vertices (asset/ found the mesh's sphere), or
// bound several drawables together.
#include "systems.h"
#include "../base/jobs.h"
#include <string.h>

#define ROWS_PER_JOB 1024

// How much a sphere's radius can grow: an upper bound of the largest singular value of the 3x3
// part. The square root of the largest absolute row sum of A^T A (Gershgorin's circles) is exact
// where the columns are orthogonal, that is for any rotation and scale, and stays an upper bound
// for the shear that a scaled parent of a turned child makes (the longest column would not).
static f32 sphere_growth(const Mat34 *a) {
    Vec3 x = {a->m[0], a->m[4], a->m[8]}, y = {a->m[1], a->m[5], a->m[9]},
         z = {a->m[2], a->m[6], a->m[10]};
    f32 xy = fabsf(vec3_dot(x, y)), yz = fabsf(vec3_dot(y, z)), zx = fabsf(vec3_dot(z, x));
    f32 row_x = vec3_dot(x, x) + xy + zx, row_y = vec3_dot(y, y) + xy + yz,
        row_z = vec3_dot(z, z) + yz + zx;
    return sqrtf(MAX(MAX(row_x, row_y), row_z));
}

typedef struct BoundsJob {
    DrawableTable *drawables;
    const InstanceTable *instances;
    const AssetStore *assets;
    u32 last_stamp, now;
    bool instances_changed, all;
    u32 *changed_by_thread;
} BoundsJob;

static void job_bounds(void *context, u32 begin, u32 end, u32 thread_index) {
    const BoundsJob *job = context;
    DrawableTable *d = job->drawables;
    const InstanceTable *instances = job->instances;
    for (u32 row = begin; row < end; row++) {
        bool dirty = job->all || d->table.stamp[row] > job->last_stamp;
        if (!dirty && !job->instances_changed) continue;
        u32 owner = table_row(&instances->table, d->owner[row]);
        dirty |= owner != ROW_NONE && instances->table.stamp[owner] > job->last_stamp;
        if (!dirty) continue;

        f32 sphere[4] = {d->w03[row], d->w13[row], d->w23[row], -1.0f};
        u32 mesh_id = d->mesh[row];
        if (owner != ROW_NONE && instances->visible[owner] && mesh_id != 0 &&
            mesh_id < job->assets->mesh_count) {
            const Mesh *mesh = &job->assets->meshes[mesh_id];
            Mat34 world;
            columns_get_mat34(&d->w00, row, world.m);
            Vec3 center = mat34_point(&world, mesh->center);
            sphere[0] = center.x, sphere[1] = center.y, sphere[2] = center.z;
            sphere[3] = mesh->radius * sphere_growth(&world);
        }
        f32 *const columns[4] = {d->bounds_x, d->bounds_y, d->bounds_z, d->bounds_radius};
        bool changed = false;
        for (u32 i = 0; i < 4; i++) {
            changed |= memcmp(&columns[i][row], &sphere[i], sizeof(f32)) != 0;
            columns[i][row] = sphere[i];
        }
        if (!changed) continue;
        d->table.stamp[row] = job->now;
        job->changed_by_thread[thread_index] = 1;
    }
}

void system_bounds(SystemContext *context) {
    DrawableTable *drawables = WORLD_TABLE(context->world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(context->world, Instance, instance);
    Table *table = &drawables->table;
    u32 changed_by_thread[JOBS_THREADS_MAX] = {0};
    BoundsJob job = {.drawables = drawables,
                     .instances = instances,
                     .assets = context->assets,
                     .last_stamp = context->last_stamp,
                     .now = context->world->stamp,
                     .instances_changed =
                         table_changed_since(&instances->table, context->last_stamp + 1),
                     .all = instances->table.structure_stamp > context->last_stamp,
                     .changed_by_thread = changed_by_thread};
    if (table->count == 0 || !context->assets) return;
    if (!job.instances_changed && !table_changed_since(table, context->last_stamp + 1)) return;
    jobs_for(table->count, ROWS_PER_JOB, job_bounds, &job);
    for (u32 i = 0; i < JOBS_THREADS_MAX; i++)
        if (changed_by_thread[i]) table->newest_stamp = job.now;
}
