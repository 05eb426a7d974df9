// world_world.c: entities, names, point lists, registration, hashes.
#include "../test.h"
#include "../../engine/base/log.h"
#include "world_fixture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

TEST(world, spawns_and_despawns) {
    World *world = fixture_world(1);
    Entity a = world_spawn(world), b = world_spawn(world);
    assert_true(a != ENTITY_NONE && b != ENTITY_NONE && a != b);
    assert_true(world_alive(world, a) && world_alive(world, b));
    assert_false(world_alive(world, ENTITY_NONE));
    assert_false(world_alive(world, ENTITY_INDEX(a)));               // no generation
    assert_false(world_alive(world, a + (1u << ENTITY_INDEX_BITS))); // from the future
    assert_false(world_alive(world, UINT32_MAX));
    table_add(world->tables[COMPONENT_light], a);
    table_add(world->tables[COMPONENT_gadget], a);
    assert_true(world_despawn(world, a));
    assert_int_equal(world->tables[COMPONENT_light]->count, 0);
    assert_int_equal(world->tables[COMPONENT_gadget]->count, 0);
    assert_false(world_despawn(world, a));
    Entity c = world_spawn(world); // the slot again, another handle
    assert_int_equal(ENTITY_INDEX(c), ENTITY_INDEX(a));
    assert_true(c != a && !world_alive(world, a) && world_alive(world, c));
    assert_false(world_despawn(world, a));
    assert_int_equal(world->entities_alive, 2);
    world_check(world);
    world_destroy(world);
    world_destroy(NULL); // harmless
}

TEST(world, a_slot_retires_after_its_last_generation) {
    World *world = world_create(1);
    Entity keeper = world_spawn(world), first = world_spawn(world), previous = ENTITY_NONE;
    world_despawn(world, first);
    for (u32 use = 2; use < GENERATION_RETIRED; use++) {
        Entity entity = world_spawn(world);
        assert_int_equal(ENTITY_INDEX(entity), ENTITY_INDEX(first));
        assert_int_equal(ENTITY_GENERATION(entity), use);
        assert_true(entity != previous);
        previous = entity;
        world_despawn(world, entity);
    }
    Entity next = world_spawn(world); // a fresh slot
    assert_int_not_equal(ENTITY_INDEX(next), ENTITY_INDEX(first));
    assert_false(world_alive(world, previous));
    for (u32 generation = 0; generation < GENERATION_RETIRED; generation++)
        assert_false(world_alive(world, generation << ENTITY_INDEX_BITS | ENTITY_INDEX(first)));
    assert_true(world_alive(world, keeper));
    world_check(world);
    world_destroy(world);
}

TEST(world, says_when_it_is_full) {
    World *world = world_create(1);
    for (u32 i = 1; i < ENTITY_CAP; i++) assert_int_not_equal(world_spawn(world), ENTITY_NONE);
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    assert_int_equal(world_spawn(world), ENTITY_NONE);
    assert_int_equal(log_count(LOG_WORLD_LIMIT), 1);
    assert_true(world_despawn(world, 1u << ENTITY_INDEX_BITS | 77));
    assert_int_equal(ENTITY_INDEX(world_spawn(world)), 77);
    world_check(world);
    world_destroy(world);
}

TEST(world, random_life_and_death) {
    const u64 seed = 99;
    World *world = fixture_world(seed);
    Entity living[300], dead[300]; // the twin: who lives, and some who no longer do
    u32 living_count = 0, dead_count = 0, has_light[300], lights = 0;
    for (u64 step = 0; step < 20000; step++) {
        u32 dice = random_u32(seed, 0, step) % 100;
        if (dice < (step / 4000 % 2 ? 40 : 60) && living_count < COUNT_OF(living)) {
            Entity entity = world_spawn(world);
            for (u32 i = 0; i < living_count; i++) assert_true(living[i] != entity);
            for (u32 i = 0; i < dead_count; i++) assert_true(dead[i] != entity);
            has_light[living_count] = dice & 1;
            lights += dice & 1;
            if (dice & 1) table_add(world->tables[COMPONENT_light], entity);
            living[living_count++] = entity;
        } else if (living_count > 0) {
            u32 victim = random_u32(seed, 1, step) % living_count;
            assert_true(world_despawn(world, living[victim]));
            lights -= has_light[victim];
            dead[dead_count < COUNT_OF(dead) ? dead_count++ : step % COUNT_OF(dead)] =
                living[victim];
            living[victim] = living[--living_count];
            has_light[victim] = has_light[living_count];
        }
        assert_int_equal(world->entities_alive, living_count);
        assert_int_equal(world->tables[COMPONENT_light]->count, lights);
        if (step % 100) continue;
        for (u32 i = 0; i < living_count; i++) assert_true(world_alive(world, living[i]));
        for (u32 i = 0; i < dead_count; i++) assert_false(world_alive(world, dead[i]));
        world_check(world);
    }
    world_destroy(world);
}

TEST(world, registers_components_up_to_the_cap) {
    World *world = fixture_world(1);
    assert_ptr_equal(world_find_table(world, "light"), world->tables[COMPONENT_light]);
    assert_ptr_equal(world_find_table(world, "gadget"), world->tables[COMPONENT_gadget]);
    assert_null(world_find_table(world, "Light"));
    ASSERT_DIES(world_register_component(world, &gadget_component)); // twice the same name
    static ComponentDesc descs[WORLD_COMPONENTS_CAP];
    static char names[WORLD_COMPONENTS_CAP][16];
    log_set_level(LOG_SEVERITY_NONE);
    for (u32 i = 0; i < WORLD_COMPONENTS_CAP; i++) {
        snprintf(names[i], sizeof names[i], "extra%u", i);
        descs[i] = gadget_component;
        descs[i].name = names[i];
        u32 expected = COMPONENT_gadget + 1 + i, id = world_register_component(world, &descs[i]);
        assert_int_equal(id, expected < WORLD_COMPONENTS_CAP ? expected : UINT32_MAX);
    }
    assert_int_equal(world->component_count, WORLD_COMPONENTS_CAP);
    assert_true(log_count(LOG_WORLD_LIMIT) > 0);
    world_destroy(world);
}

TEST(world, singletons_are_made_on_first_use) {
    World *world = world_create(1);
    assert_int_equal(world_singleton(world, COMPONENT_environment), 0);
    EnvironmentTable *environment = WORLD_TABLE(world, Environment, environment);
    environment->gravity[0] = 1;
    assert_int_equal(world_singleton(world, COMPONENT_environment), 0);
    assert_true(environment->gravity[0] == 1);
    assert_int_equal(environment->table.count, 1);
    assert_true(world_alive(world, environment->table.entity[0]));
    ASSERT_DIES(world_singleton(world, COMPONENT_light));
    world_destroy(world);
}

TEST(world, names) {
    World *world = world_create(1);
    Entity a = world_spawn(world), b = world_spawn(world);
    assert_string_equal(world_name(world, a), "");
    world_set_name(world, a, "lamp");
    world_set_name(world, b, "");
    assert_string_equal(world_name(world, a), "lamp");
    assert_int_equal(world_find(world, "lamp"), a);
    assert_int_equal(world_find(world, "lam"), ENTITY_NONE);
    assert_int_equal(world_find(world, ""), ENTITY_NONE);
    assert_int_equal(world_find(world, NULL), ENTITY_NONE);
    world_set_name(world, b, world_name(world, a)); // its own memory
    assert_string_equal(world_name(world, b), "lamp");
    world_set_name(world, a, NULL);
    assert_int_equal(world_find(world, "lamp"), b);
    world_despawn(world, b);
    assert_int_equal(world_find(world, "lamp"), ENTITY_NONE);
    assert_string_equal(world_name(world, b), "");
    Entity c = world_spawn(world); // in b's slot, and nameless
    assert_string_equal(world_name(world, c), "");
    world_set_name(world, b, "ghost"); // the dead get no names
    assert_string_equal(world_name(world, c), "");
    world_check(world);
    world_destroy(world);
}

// Renaming for ever must not grow for ever, and must not lose anybody's name.
TEST(world, names_are_compacted) {
    World *world = world_create(1);
    Entity keeper = world_spawn(world), changer = world_spawn(world);
    world_set_name(world, keeper, "keeper");
    for (u32 i = 0; i < 20000; i++) {
        char name[32];
        snprintf(name, sizeof name, "name number %u", i);
        world_set_name(world, changer, name);
        assert_string_equal(world_name(world, changer), name);
        world_set_name(world, keeper, world_name(world, keeper)); // also across a compaction
    }
    assert_string_equal(world_name(world, keeper), "keeper");
    assert_true(world->name_text_cap <= KIB(16));
    char *endless = calloc(1, 100001);
    memset(endless, 'x', 100000);
    world_set_name(world, changer, endless);
    assert_string_equal(world_name(world, changer), endless);
    free(endless);
    world_check(world);
    world_destroy(world);
}

TEST(world, point_lists) {
    World *world = world_create(1);
    const f32 *out = (const f32 *)world;
    assert_int_equal(world_points(world, 0, &out), 0);
    assert_null(out);
    f32 xyz[300];
    for (u32 i = 0; i < 300; i++) xyz[i] = (f32)i;
    for (u32 i = 1; i <= 100; i++) assert_int_equal(world_add_points(world, xyz, i), i);
    for (u32 i = 1; i <= 100; i++) {
        assert_int_equal(world_points(world, i, &out), i);
        assert_memory_equal(out, xyz, i * 3 * sizeof(f32));
    }
    u32 empty = world_add_points(world, NULL, 0);
    assert_int_equal(empty, 101);
    assert_int_equal(world_points(world, empty, &out), 0);
    assert_int_equal(world_points(world, 102, &out), 0); // unknown
    assert_int_equal(world_points(world, UINT32_MAX, &out), 0);
    log_set_level(LOG_SEVERITY_NONE);
    assert_int_equal(world_add_points(world, xyz, UINT32_MAX), 0);
    assert_int_equal(log_count(LOG_WORLD_LIMIT), 1);
    world_check(world);
    world_destroy(world);
}

TEST(world, hash_is_a_function_of_history) {
    World *a = fixture_full_world(3), *b = fixture_full_world(3), *c = fixture_full_world(4);
    assert_true(world_hash(a) == world_hash(b));
    assert_true(world_hash(a) != world_hash(c));
    // What the simulation does not see leaves it alone.
    u64 before = world_hash(a);
    world_advance_stamp(a);
    table_touch(a->tables[COMPONENT_gadget], 0);
    world_set_name(a, a->tables[COMPONENT_gadget]->entity[0], "other");
    table_reserve(a->tables[COMPONENT_light], 5000);
    assert_true(world_hash(a) == before);
    // What decides the next handle does not.
    Entity spawned = world_spawn(a);
    assert_true(world_hash(a) != before);
    world_despawn(a, spawned);
    assert_true(world_hash(a) != before); // its generation went up
    // The same dead in another order: the next handles will differ.
    Entity x[2], y[2];
    for (u32 i = 0; i < 2; i++) x[i] = world_spawn(b);
    World *d = fixture_full_world(3);
    for (u32 i = 0; i < 2; i++) y[i] = world_spawn(d);
    assert_true(world_hash(b) == world_hash(d));
    world_despawn(b, x[0]), world_despawn(b, x[1]);
    world_despawn(d, y[1]), world_despawn(d, y[0]);
    assert_true(world_hash(b) != world_hash(d));
    world_destroy(d);
    world_destroy(a);
    world_destroy(b);
    world_destroy(c);
}

TEST(world, hash_sees_every_value_of_every_column) {
    World *world = fixture_full_world(5);
    u64 before = world_hash(world);
    for (u32 id = 0; id < world->component_count; id++) {
        Table *table = world->tables[id];
        u64 table_before = table_hash(table);
        for (u32 c = 0; c < table->desc->column_count; c++) {
            u64 column_before = column_hash(table, c);
            u64 neighbour = column_hash(table, c ? c - 1 : table->desc->column_count - 1);
            for (u32 row = 0; row < table->count; row++) {
                u8 *byte = (u8 *)table_columns(table)[c] + row * 4 + row % 4;
                *byte ^= 1;
                assert_true(world_hash(world) != before);
                assert_true(table_hash(table) != table_before);
                assert_true(column_hash(table, c) != column_before);
                if (table->desc->column_count > 1)
                    assert_true(column_hash(table, c ? c - 1 : table->desc->column_count - 1) ==
                                neighbour);
                *byte ^= 1;
            }
        }
    }
    assert_true(world_hash(world) == before);
    world_destroy(world);
}

TEST(world, hash_sees_tick_seed_order_and_points) {
    World *world = fixture_full_world(6);
    u64 before = world_hash(world);
    world->tick++;
    assert_true(world_hash(world) != before);
    world->tick--;
    world->seed ^= 1;
    assert_true(world_hash(world) != before);
    world->seed ^= 1;
    world->points[4] += 1;
    assert_true(world_hash(world) != before);
    world->points[4] -= 1;
    assert_true(world_hash(world) == before);
    // The same rows in another order are another world: systems go by rows.
    Table *table = world->tables[COMPONENT_flicker];
    Entity first = table->entity[0];
    f32 amount = ((FlickerTable *)table)->amount[0], rate = ((FlickerTable *)table)->rate[0];
    table_remove(table, first);
    u32 row = table_add(table, first);
    ((FlickerTable *)table)->amount[row] = amount;
    ((FlickerTable *)table)->rate[row] = rate;
    assert_true(world_hash(world) != before);
    world_destroy(world);
}

TEST(world, check_notices_damage) {
    World *world = fixture_full_world(7);
    world_check(world);
    world->entities_alive++;
    ASSERT_DIES(world_check(world));
    world->entities_alive--;
    u32 slot = world->free_slots[0];
    world->free_slots[0] = world->free_slots[1]; // twice on the stack
    ASSERT_DIES(world_check(world));
    world->free_slots[0] = slot;
    world->point_first[2] += 100;
    ASSERT_DIES(world_check(world));
    world->point_first[2] -= 100;
    // A row of an entity that died behind the table's back.
    u32 index = ENTITY_INDEX(world->tables[COMPONENT_light]->entity[0]);
    world->generation[index]++;
    ASSERT_DIES(world_check(world));
    world->generation[index]--;
    world_check(world);
    world_destroy(world);
}
