// world_table.c: one sparse set, against a naive twin and by its promises one by one.
#include "../test.h"
#include "world_fixture.h"
#include <string.h>

static const u32 stamp_clock = 5;

TEST(table, new_rows_have_the_defaults) {
    World *world = fixture_world(1);
    GadgetTable *gadgets = (GadgetTable *)world->tables[COMPONENT_gadget];
    u32 row = table_add(&gadgets->table, world_spawn(world));
    assert_int_equal(row, 0);
    assert_true(gadgets->ratio[row] == 0.25f);
    assert_true(gadgets->serial[row] == 4000000000u);
    assert_int_equal(gadgets->offset[row], -7);
    assert_int_equal(gadgets->on[row], 1);
    assert_int_equal(gadgets->mode[row], 2);
    assert_int_equal(gadgets->target[row], ENTITY_NONE);
    LightTable *lights = WORLD_TABLE(world, Light, light);
    row = table_add(&lights->table, world_spawn(world));
    assert_true(lights->color_g[row] == 1 && lights->outer_angle[row] == 35);
    assert_true(lights->gain[row] == 1 && lights->affects_gi[row] == 1); // derived ones too
    world_destroy(world);
}

TEST(table, adding_twice_changes_nothing) {
    Table *table = table_create(&gadget_component, 0, &stamp_clock);
    GadgetTable *gadgets = (GadgetTable *)table;
    Entity entity = 1u << ENTITY_INDEX_BITS | 9;
    u32 row = table_add(table, entity);
    gadgets->ratio[row] = 3;
    assert_int_equal(table_add(table, entity), row);
    assert_int_equal(table->count, 1);
    assert_true(gadgets->ratio[row] == 3);
    table_destroy(table);
}

TEST(table, wrong_handles_are_refused) {
    Table *table = table_create(&gadget_component, 0, &stamp_clock);
    Entity first = 1u << ENTITY_INDEX_BITS | 9, second = 2u << ENTITY_INDEX_BITS | 9;
    table_add(table, second);
    assert_int_equal(table_row(table, first), ROW_NONE);
    assert_int_equal(table_row(table, ENTITY_NONE), ROW_NONE);
    assert_int_equal(table_row(table, UINT32_MAX), ROW_NONE); // index far beyond the map
    assert_false(table_remove(table, first));
    assert_false(table_remove(table, ENTITY_NONE));
    assert_int_equal(table->count, 1);
    ASSERT_DIES(table_add(table, first));
    ASSERT_DIES(table_add(table, ENTITY_NONE));
    ASSERT_DIES(table_add(table, 9)); // no generation
    table_destroy(table);
    table = table_create(&environment_component, 0, &stamp_clock);
    table_add(table, first);
    ASSERT_DIES(table_add(table, 1u << ENTITY_INDEX_BITS | 10)); // a singleton's second row
    table_destroy(table);
    table_destroy(NULL); // harmless
}

TEST(table, stamps_follow_changes) {
    World *world = fixture_world(1);
    Table *table = world->tables[COMPONENT_gadget];
    Entity a = world_spawn(world), b = world_spawn(world);
    u32 start = world_advance_stamp(world);
    table_add(table, a);
    table_add(table, b);
    assert_int_equal(table->structure_stamp, start);
    u32 later = world_advance_stamp(world);
    assert_true(table_changed_since(table, start));
    assert_false(table_changed_since(table, later));
    table_touch(table, 1);
    assert_int_equal(table->stamp[0], start);
    assert_int_equal(table->stamp[1], later);
    assert_int_equal(table->structure_stamp, start);
    assert_true(table_changed_since(table, later));
    u32 last = world_advance_stamp(world);
    table_remove(table, a); // b moves to row 0 and keeps its stamp
    assert_int_equal(table->stamp[0], later);
    assert_int_equal(table->structure_stamp, last);
    assert_true(table_changed_since(table, last));
    world_destroy(world);
}

TEST(table, columns_are_found_by_name) {
    Table *table = table_create(&gadget_component, 0, &stamp_clock);
    assert_int_equal(table_find_column(table, "ratio"), 0);
    assert_int_equal(table_find_column(table, "route"), 7);
    assert_int_equal(table_find_column(table, "Ratio"), -1);
    assert_int_equal(table_find_column(table, ""), -1);
    table_destroy(table);
}

TEST(table, reserve_keeps_rows_and_pointers) {
    Table *table = table_create(&gadget_component, 0, &stamp_clock);
    GadgetTable *gadgets = (GadgetTable *)table;
    table_reserve(table, 1000);
    const f32 *ratio = gadgets->ratio;
    for (u32 i = 1; i <= 1000; i++) gadgets->serial[table_add(table, 1u << 20 | i)] = i;
    assert_ptr_equal(gadgets->ratio, ratio);
    table_reserve(table, 10); // never shrinks
    assert_true(table->cap >= 1000);
    table_add(table, 1u << 20 | 1001); // grows
    for (u32 i = 0; i < 1000; i++) assert_int_equal(gadgets->serial[i], i + 1);
    table_check(table);
    ASSERT_DIES(table_reserve(table, ENTITY_CAP + 1));
    table_destroy(table);
}

TEST(table, check_notices_damage) {
    Table *table = table_create(&gadget_component, 0, &stamp_clock);
    for (u32 i = 1; i <= 5; i++) table_add(table, 1u << 20 | i);
    table_check(table);
    GadgetTable *gadgets = (GadgetTable *)table;
    gadgets->ratio[5] = 1; // padding
    ASSERT_DIES(table_check(table));
    gadgets->ratio[5] = 0;
    table->row_of[2] = 3;
    ASSERT_DIES(table_check(table));
    table->row_of[2] = 1;
    table->row_of[7] = 0; // somebody without a row
    ASSERT_DIES(table_check(table));
    table->row_of[7] = ROW_NONE;
    table->stamp[1] = stamp_clock + 1;
    ASSERT_DIES(table_check(table));
    table->stamp[1] = stamp_clock;
    table_check(table);
    table_destroy(table);
}

// ---- the twin: an array of structs that is searched from the front ----

typedef struct TwinRow {
    Entity entity;
    u32 stamp, serial, on;
    f32 ratio;
    i32 offset;
} TwinRow;

typedef struct Twin {
    TwinRow rows[600];
    u32 count;
} Twin;

static u32 twin_row(const Twin *twin, Entity entity) {
    for (u32 i = 0; i < twin->count; i++)
        if (twin->rows[i].entity == entity) return i;
    return ROW_NONE;
}

static void assert_is_twin(const GadgetTable *gadgets, const Twin *twin) {
    const Table *table = &gadgets->table;
    assert_int_equal(table->count, twin->count);
    for (u32 i = 0; i < twin->count; i++) {
        const TwinRow *row = &twin->rows[i];
        assert_true(table->entity[i] == row->entity && table->stamp[i] == row->stamp);
        assert_true(gadgets->serial[i] == row->serial && gadgets->on[i] == row->on);
        assert_true(gadgets->ratio[i] == row->ratio && gadgets->offset[i] == row->offset);
        assert_int_equal(table_row(table, row->entity), i);
    }
    table_check(table);
}

TEST(table, random_operations_agree_with_the_twin) {
    const u64 seed = 20240601;
    static Twin twin;
    u32 clock = 1;
    Table *table = table_create(&gadget_component, 0, &clock);
    GadgetTable *gadgets = (GadgetTable *)table;
    u16 generation[600];
    for (u32 i = 0; i < 600; i++) generation[i] = 1;
    for (u64 step = 0; step < 20000; step++) {
        // Waves: for a while more is added than removed, then the other way round.
        u32 add_share = step / 2500 % 2 ? 35 : 60;
        u32 dice = random_u32(seed, 0, step) % 100, index = 1 + random_u32(seed, 1, step) % 599;
        Entity entity = (u32)generation[index] << ENTITY_INDEX_BITS | index;
        u32 row = table_row(table, entity);
        assert_int_equal(row, twin_row(&twin, entity));
        clock += dice % 3 == 0;
        if (dice < add_share) {
            u32 added = table_add(table, entity);
            if (row == ROW_NONE) {
                assert_int_equal(added, twin.count);
                twin.rows[twin.count++] = (TwinRow){entity, clock, 4000000000u, 1, 0.25f, -7};
            } else {
                assert_int_equal(added, row);
            }
        } else if (dice < 85) {
            assert_int_equal(table_remove(table, entity), row != ROW_NONE);
            if (row != ROW_NONE) {
                twin.rows[row] = twin.rows[--twin.count];
                generation[index]++; // the next one under this index is somebody else
                assert_int_equal(table_row(table, entity), ROW_NONE);
            }
        } else if (row != ROW_NONE) {
            TwinRow *twin_values = &twin.rows[row];
            twin_values->serial = gadgets->serial[row] = random_u32(seed, 2, step);
            twin_values->ratio = gadgets->ratio[row] = random_f32(seed, 3, step);
            twin_values->offset = gadgets->offset[row] = -(i32)(step % 1000);
            twin_values->on = gadgets->on[row] = step & 1;
            table_touch(table, row);
            twin_values->stamp = clock;
        }
        if (step % 50 == 0 || step < 200) assert_is_twin(gadgets, &twin);
    }
    assert_true(twin.count > 50);
    while (twin.count > 0) { // to the last row, from the front
        assert_true(table_remove(table, twin.rows[0].entity));
        twin.rows[0] = twin.rows[--twin.count];
    }
    assert_is_twin(gadgets, &twin);
    table_destroy(table);
}
