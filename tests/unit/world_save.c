// world_save.c: saved worlds come back whole; damaged and hostile blocks are refused.
#include "../test.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/log.h"
#include "world_fixture.h"
#include <stdlib.h>
#include <string.h>

#define HEAD_SIZE 24 // magic, version, size, checksum: see engine/world/world_save.c

static Arena arena_for_test(void) {
    Arena arena;
    assert_true(arena_create(&arena, "saves", MIB(64)));
    return arena;
}

TEST(world_save, roundtrip) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *copy = fixture_world(2);
    Bytes saved = world_save(world, &arena);
    assert_non_null(saved.data);
    assert_true(world_load(copy, saved));
    world_check(copy);
    assert_true(world_hash(copy) == world_hash(world));
    for (u32 i = 1; i < world->entity_slots; i++) {
        Entity entity = (u32)world->generation[i] << ENTITY_INDEX_BITS | i;
        assert_string_equal(world_name(copy, entity), world_name(world, entity));
    }
    Bytes again = world_save(copy, &arena);
    assert_int_equal(again.size, saved.size);
    assert_memory_equal(again.data, saved.data, saved.size);
    // The future is the same as well.
    for (u32 i = 0; i < 20; i++) assert_int_equal(world_spawn(copy), world_spawn(world));
    assert_true(world_hash(copy) == world_hash(world));
    world_destroy(world);
    world_destroy(copy);
    arena_destroy(&arena);
}

TEST(world_save, an_empty_world) {
    Arena arena = arena_for_test();
    World *world = world_create(1), *copy = world_create(2);
    table_add(copy->tables[COMPONENT_light], world_spawn(copy));
    assert_true(world_load(copy, world_save(world, &arena)));
    assert_true(world_hash(copy) == world_hash(world));
    assert_int_equal(copy->tables[COMPONENT_light]->count, 0);
    world_check(copy);
    world_destroy(world);
    world_destroy(copy);
    arena_destroy(&arena);
}

TEST(world_save, retired_slots_stay_retired) {
    Arena arena = arena_for_test();
    World *world = world_create(1), *copy = world_create(2);
    for (u32 i = 1; i < GENERATION_RETIRED; i++) world_despawn(world, world_spawn(world));
    world_spawn(world);
    assert_int_equal(world->entity_slots, 3);
    assert_true(world_load(copy, world_save(world, &arena)));
    world_check(copy);
    assert_true(world_hash(copy) == world_hash(world));
    world_destroy(world);
    world_destroy(copy);
    arena_destroy(&arena);
}

TEST(world_save, after_a_load_everything_has_changed_and_nothing_moved) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *copy = fixture_full_world(9);
    for (u32 i = 0; i < 10; i++) world_advance_stamp(copy);
    u32 stamp = copy->stamp;
    Table *lights = copy->tables[COMPONENT_light];
    assert_true(world_load(copy, world_save(world, &arena)));
    assert_ptr_equal(copy->tables[COMPONENT_light], lights);
    assert_true(copy->stamp > stamp);
    for (u32 id = 0; id < copy->component_count; id++) {
        const Table *table = copy->tables[id];
        assert_true(table->clock == &copy->stamp && table->structure_stamp > stamp);
        assert_true(table_changed_since(table, stamp + 1));
        for (u32 row = 0; row < table->count; row++) assert_true(table->stamp[row] > stamp);
    }
    world_destroy(world);
    world_destroy(copy);
    arena_destroy(&arena);
}

TEST(world_save, an_arena_too_small) {
    Arena arena;
    assert_true(arena_create(&arena, "small", 100));
    World *world = world_create(1);
    log_set_level(LOG_SEVERITY_NONE);
    Bytes saved = world_save(world, &arena);
    assert_null(saved.data);
    assert_int_equal(log_count(LOG_WORLD_LIMIT), 1);
    assert_int_equal(arena.used, 0);
    world_destroy(world);
    arena_destroy(&arena);
}

// ---- damage ----

static void write_checksum(u8 *block, u64 size) {
    u64 checksum = hash_bytes(block + HEAD_SIZE, size - HEAD_SIZE, 0);
    memcpy(block + HEAD_SIZE - sizeof checksum, &checksum, sizeof checksum);
}

TEST(world_save, every_flipped_byte_is_refused) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *target = fixture_full_world(2);
    Bytes saved = world_save(world, &arena);
    u8 *block = malloc(saved.size); // exact size: sanitizers see a step beyond
    memcpy(block, saved.data, saved.size);
    u64 before = world_hash(target);
    log_set_level(LOG_SEVERITY_NONE);
    for (u64 i = 0; i < saved.size; i++) {
        u8 flip = (u8)(1 + random_u32(5, 0, i) % 255);
        block[i] ^= flip;
        assert_false(world_load(target, (Bytes){block, saved.size}));
        block[i] ^= flip;
    }
    assert_int_equal(log_count(LOG_WORLD_LOAD), saved.size);
    assert_true(world_hash(target) == before);
    world_check(target);
    free(block);
    world_destroy(world);
    world_destroy(target);
    arena_destroy(&arena);
}

TEST(world_save, every_shorter_or_longer_block_is_refused) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *target = fixture_world(2);
    Bytes saved = world_save(world, &arena);
    log_set_level(LOG_SEVERITY_NONE);
    assert_false(world_load(target, (Bytes){NULL, 0}));
    for (u64 size = 0; size < saved.size; size += size < 200 ? 1 : 37) {
        u8 *block = malloc(MAX(size, 1));
        memcpy(block, saved.data, size);
        assert_false(world_load(target, (Bytes){block, size}));
        // The same by one who knows the format: right size, right checksum.
        if (size >= HEAD_SIZE) {
            memcpy(block + 8, &size, sizeof size);
            write_checksum(block, size);
            assert_false(world_load(target, (Bytes){block, size}));
        }
        free(block);
    }
    u64 size = saved.size + 4;
    u8 *block = calloc(1, size);
    memcpy(block, saved.data, saved.size);
    memcpy(block + 8, &size, sizeof size);
    write_checksum(block, size);
    assert_false(world_load(target, (Bytes){block, size}));
    free(block);
    world_destroy(world);
    world_destroy(target);
    arena_destroy(&arena);
}

// A stranger repairs the checksum after each change: then a load may succeed (a float is as good
// as another), but what it makes must be sound, and a refusal must leave no trace.
TEST(world_save, hostile_blocks_never_break_a_world) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *target = fixture_world(2);
    Bytes saved = world_save(world, &arena);
    u8 *block = malloc(saved.size);
    memcpy(block, saved.data, saved.size);
    log_set_level(LOG_SEVERITY_NONE);
    u32 loaded = 0, refused = 0;
    for (u64 i = HEAD_SIZE; i < saved.size; i++) {
        static const u8 flips[] = {0xFF, 0x01, 0x80};
        u8 flip = flips[i % 3];
        block[i] ^= flip;
        write_checksum(block, saved.size);
        u64 before = world_hash(target);
        if (world_load(target, (Bytes){block, saved.size})) {
            loaded++;
            world_check(target);
            const GadgetTable *gadgets = (GadgetTable *)target->tables[COMPONENT_gadget];
            for (u32 row = 0; row < gadgets->table.count; row++) {
                const f32 *points;
                assert_true(gadgets->on[row] <= 1 && gadgets->mode[row] <= 2);
                assert_true(gadgets->route[row] < target->point_list_count);
                world_points(target, gadgets->route[row], &points);
            }
        } else {
            refused++;
            assert_true(world_hash(target) == before);
        }
        block[i] ^= flip;
    }
    assert_true(loaded > 1000 && refused > 1000);
    // Numbers as large as they get, in every place where one could be.
    for (u64 i = HEAD_SIZE; i + 4 <= saved.size; i += 1 + i % 3) {
        u8 old[4];
        memcpy(old, block + i, 4);
        memset(block + i, 0xFF, 4);
        write_checksum(block, saved.size);
        if (world_load(target, (Bytes){block, saved.size})) world_check(target);
        memcpy(block + i, old, 4);
    }
    free(block);
    world_destroy(world);
    world_destroy(target);
    arena_destroy(&arena);
}

static void assert_refused(World *target, u8 *block, u64 size) {
    memcpy(block + 8, &size, sizeof size);
    write_checksum(block, size);
    u64 before = world_hash(target);
    assert_false(world_load(target, (Bytes){block, size}));
    assert_true(world_hash(target) == before);
}

TEST(world_save, a_free_slot_listed_twice_is_refused) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *target = fixture_world(2);
    Bytes saved = world_save(world, &arena);
    u8 *block = (u8 *)saved.data;
    // After seed, tick, slots, generations and alive flags: the stack's count, then the stack.
    u8 *stack = block + HEAD_SIZE + 8 + 4 + 4 + (world->entity_slots - 1) * 3;
    u32 count;
    memcpy(&count, stack, sizeof count);
    assert_int_equal(count, world->free_count);
    memcpy(stack + 4, stack + 8, 4);
    log_set_level(LOG_SEVERITY_NONE);
    assert_refused(target, block, saved.size);
    world_destroy(world);
    world_destroy(target);
    arena_destroy(&arena);
}

// More rows than there can be entities, with bytes enough to back them.
TEST(world_save, more_rows_than_entities_are_refused) {
    Arena arena = arena_for_test();
    World *world = fixture_full_world(1), *target = fixture_world(2);
    Bytes saved = world_save(world, &arena);
    const u8 *name = memmem(saved.data, saved.size, "light", sizeof "light");
    assert_non_null(name);
    u64 head = (u64)(name - (const u8 *)saved.data) + sizeof "light"; // up to the row count
    u32 rows = ENTITY_CAP + 1;
    u64 size = saved.size + rows * 4ull * 50;
    u8 *block = calloc(1, size);
    memcpy(block, saved.data, head);
    memcpy(block + head, &rows, sizeof rows);
    log_set_level(LOG_SEVERITY_NONE);
    assert_refused(target, block, size);
    free(block);
    world_destroy(world);
    world_destroy(target);
    arena_destroy(&arena);
}

// ---- other versions of a component ----

#define OLD_COLUMNS(C)                                                                             \
    C(F32, ratio, "", 0.5, "ratio", 0, 1, "a float")                                               \
    C(U32, gone, "", 0, "", 0, 0, "no longer there")                                               \
    C(F32, offset, "", 0, "", 0, 0, "has another type today")
TABLE_STRUCT(Old, OLD_COLUMNS)
static const ColumnDesc old_columns[] = {OLD_COLUMNS(COLUMN_DESC_)};
static const ComponentDesc old_gadget = {
    "gadget", "for tests", old_columns, COUNT_OF(old_columns), sizeof(OldTable), false};
static const ComponentDesc old_stranger = {
    "stranger", "for tests", old_columns, COUNT_OF(old_columns), sizeof(OldTable), false};

TEST(world_save, unknown_columns_are_dropped_and_new_ones_get_defaults) {
    Arena arena = arena_for_test();
    World *old = world_create(1), *world = fixture_world(2);
    OldTable *table = (OldTable *)old->tables[world_register_component(old, &old_gadget)];
    Table *stranger = old->tables[world_register_component(old, &old_stranger)];
    for (u32 i = 0; i < 3; i++) {
        Entity entity = world_spawn(old);
        u32 row = table_add(&table->table, entity);
        table_add(stranger, entity);
        table->ratio[row] = (f32)i;
        table->gone[row] = 1;
        table->offset[row] = 1e9f;
    }
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    assert_true(world_load(world, world_save(old, &arena)));
    assert_int_equal(log_count(LOG_NOTE), 1);
    const GadgetTable *gadgets = (GadgetTable *)world->tables[COMPONENT_gadget];
    assert_int_equal(gadgets->table.count, 3);
    for (u32 row = 0; row < 3; row++) {
        assert_true(gadgets->ratio[row] == (f32)row);
        assert_int_equal(gadgets->offset[row], -7);
        assert_int_equal(gadgets->mode[row], 2);
        assert_int_equal(gadgets->table.entity[row], table->table.entity[row]);
    }
    world_check(world);
    world_destroy(old);
    world_destroy(world);
    arena_destroy(&arena);
}
