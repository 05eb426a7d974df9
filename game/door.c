// door.c: doors swing open for walkers.
//
// Data in: door, walker, transform (world places of both). Data out: door.opening, transform.yaw.
// Called by: the system table, 60 times a second. Does not: push a walker out of the way; a door
// stays open as long as somebody stands near.
#include "door.h"

COMPONENT_DEFINE(Door, door, DOOR_COLUMNS, false, "opens when a walker comes near")

// Squared distance to the nearest walker; infinite if there is none.
static f32 nearest_walker2(const World *world, Vec3 from) {
    const Table *walkers = world->tables[COMPONENT_walker];
    const TransformTable *places = WORLD_TABLE(world, Transform, transform);
    f32 nearest = INFINITY;
    for (u32 i = 0; i < walkers->count; i++) {
        u32 row = table_row(&places->table, walkers->entity[i]);
        if (row == ROW_NONE) continue;
        Vec3 to = vec3(places->w03[row], places->w13[row], places->w23[row]);
        Vec3 way = vec3_sub(to, from);
        nearest = MIN(nearest, vec3_dot(way, way));
    }
    return nearest;
}

void system_door(SystemContext *context) {
    World *world = context->world;
    DoorTable *doors = (DoorTable *)world_find_table(world, "door");
    TransformTable *places = WORLD_TABLE(world, Transform, transform);
    for (u32 i = 0; i < doors->table.count; i++) {
        u32 row = table_row(&places->table, doors->table.entity[i]);
        if (row == ROW_NONE || doors->angle[i] == 0.0f) continue;
        if (!doors->hung[i]) {
            doors->base_yaw[i] = places->yaw[row];
            doors->hung[i] = 1;
        }
        Vec3 hinge = vec3(places->w03[row], places->w13[row], places->w23[row]);
        f32 radius = doors->radius[i];
        bool open = nearest_walker2(world, hinge) < radius * radius;
        f32 step = doors->speed[i] * TICK_SECONDS / fabsf(doors->angle[i]);
        f32 opening = f32_saturate(doors->opening[i] + (open ? step : -step));
        if (opening == doors->opening[i]) continue; // at rest: nothing downstream has to follow
        doors->opening[i] = opening;
        places->yaw[row] =
            doors->base_yaw[i] + doors->angle[i] * f32_smoothstep(0.0f, 1.0f, opening);
        table_touch(&places->table, row);
        table_touch(&doors->table, i);
    }
}
