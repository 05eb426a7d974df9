// world_fixture.c: worlds for the tests of world/ and of what builds on it.
// Data in: a seed. Data out: worlds that are functions of it. Called by: world_*.c.
#include "world_fixture.h"
#include <stdio.h>
#include <string.h>

COMPONENT_DEFINE(Gadget, gadget, GADGET_COLUMNS, false, "for tests")

World *fixture_world(u64 seed) {
    World *world = world_create(seed);
    LUZ_ASSERT(world_register_component(world, &gadget_component) == COMPONENT_gadget);
    return world;
}

// A value that a column of this type may hold.
static u32 fixture_value(const World *world, const ColumnDesc *desc, u64 counter) {
    u32 bits = random_u32(77, 0, counter);
    f32 number = random_range(77, 1, counter, -100, 100);
    switch (desc->type) {
    case COLUMN_F32:
        memcpy(&bits, &number, sizeof bits);
        return bits;
    case COLUMN_BOOL:
        return bits & 1;
    case COLUMN_ENUM:
        return bits % 2; // every list of words has two
    case COLUMN_POINTS:
        return bits % world->point_list_count;
    default:
        return bits; // numbers, handles that may be stale, ids
    }
}

World *fixture_full_world(u64 seed) {
    World *world = fixture_world(seed);
    static const f32 points[] = {0, 0, 0, 1, 2, 3, 4, 5, 6};
    world_add_points(world, points, 3);
    world_add_points(world, points, 0);
    world_add_points(world, points + 3, 1);
    world->tick = 1234;
    Entity entities[40];
    u64 counter = seed * 100000;
    for (u32 i = 0; i < COUNT_OF(entities); i++) entities[i] = world_spawn(world);
    for (u32 i = 0; i < COUNT_OF(entities); i += 5) world_despawn(world, entities[i]);
    for (u32 i = 0; i < 3; i++) world_spawn(world); // reused slots, and five stay free
    for (u32 id = 0; id < world->component_count; id++) {
        Table *table = world->tables[id];
        u32 wanted = table->desc->singleton ? 1 : 5 + id % 7;
        for (u32 i = 0; table->count < wanted; i++) {
            if (!world_alive(world, entities[i])) continue;
            u32 row = table_add(table, entities[i]);
            for (u32 c = 0; c < table->desc->column_count; c++) {
                u32 value = fixture_value(world, &table->desc->columns[c], counter++);
                memcpy((u8 *)table_columns(table)[c] + row * 4, &value, 4);
            }
        }
    }
    for (u32 i = 1; i < COUNT_OF(entities); i += 3) {
        char name[32];
        snprintf(name, sizeof name, "thing %u", i);
        world_set_name(world, entities[i], name); // the dead stay nameless
    }
    world_check(world);
    return world;
}
