// shy.c: fireflies keep their distance.
//
// Data in: shy, the first walker's place, transform. Data out: shy.flee_*, transform.x and z.
// Called by: the system table. It moves the resting place, not the offset, so an orbit goes on
// around it. Does not: look at heights (fireflies flee sideways), or at parents that are turned.
#include "shy.h"

COMPONENT_DEFINE(Shy, shy, SHY_COLUMNS, false, "drifts aside when a walker comes near")

// Movements below this (m) are not worth telling anybody.
#define STILL 1e-4f

void system_shy(SystemContext *context) {
    World *world = context->world;
    ShyTable *shy = (ShyTable *)world_find_table(world, "shy");
    TransformTable *places = WORLD_TABLE(world, Transform, transform);
    const Table *walkers = world->tables[COMPONENT_walker];
    u32 walker = walkers->count > 0 ? table_row(&places->table, walkers->entity[0]) : ROW_NONE;
    if (walker == ROW_NONE) return;
    f32 walker_x = places->w03[walker], walker_z = places->w23[walker];
    for (u32 i = 0; i < shy->table.count; i++) {
        u32 row = table_row(&places->table, shy->table.entity[i]);
        if (row == ROW_NONE) continue;
        if (!shy->at_home[i]) {
            shy->home_x[i] = places->x[row];
            shy->home_z[i] = places->z[row];
            shy->at_home[i] = 1;
        }
        // Fear falls from 1 at the walker to 0 at `distance`; the way out is straight away.
        f32 x = shy->home_x[i] - walker_x, z = shy->home_z[i] - walker_z;
        f32 length = sqrtf(x * x + z * z);
        f32 fear = f32_saturate(1.0f - length / shy->distance[i]);
        f32 scale = length > STILL ? shy->reach[i] * fear / length : 0.0f;
        f32 follow = f32_saturate(TICK_SECONDS / shy->calm[i]);
        f32 step_x = (x * scale - shy->flee_x[i]) * follow;
        f32 step_z = (z * scale - shy->flee_z[i]) * follow;
        if (fabsf(step_x) + fabsf(step_z) < STILL) continue;
        shy->flee_x[i] += step_x;
        shy->flee_z[i] += step_z;
        places->x[row] = shy->home_x[i] + shy->flee_x[i];
        places->z[row] = shy->home_z[i] + shy->flee_z[i];
        table_touch(&places->table, row);
    }
}
