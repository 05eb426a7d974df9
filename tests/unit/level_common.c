// level_common.c: see level_common.h.
#include "level_common.h"
#include <stdio.h>

COMPONENT_DEFINE(Door, door, DOOR_COLUMNS, false, "a door")
COMPONENT_DEFINE(Rules, rules, RULES_COLUMNS, true, "rules of the game")

World *test_level_world(void) {
    World *world = world_create(0);
    world_register_component(world, &door_component);
    world_register_component(world, &rules_component);
    return world;
}

void test_level_load_bytes(TestLevel *level, const char *name, const void *data, u64 size) {
    memset(level, 0, sizeof *level);
    assert_true(arena_create(&level->arena, "test level", GIB(1)));
    assert_true(asset_store_create(&level->store));
    level->world = test_level_world();
    level->diagnostics = calloc(1, sizeof *level->diagnostics);
    assert_true(file_write(test_temp_path(name), data, size));
    assert_true(file_root_open(&level->root, test_temp_dir()));
    level->is_good = level_load(&level->root, name, level->world, &level->store, &level->arena,
                                &level->info, level->diagnostics);
    assert_int_equal(level->is_good, level->diagnostics->error_count == 0);
}

void test_level_load(TestLevel *level, const char *text) {
    test_level_load_bytes(level, "test.toml", text, strlen(text));
}

void test_level_load_good(TestLevel *level, const char *text) {
    test_level_load(level, text);
    if (!level->is_good) diagnostics_print(level->diagnostics, stderr);
    assert_true(level->is_good);
    world_check(level->world);
}

void test_level_close(TestLevel *level) {
    file_root_close(&level->root);
    world_destroy(level->world);
    asset_store_destroy(&level->store);
    arena_destroy(&level->arena);
    free(level->diagnostics);
}

u32 test_level_row(const TestLevel *level, u32 component, const char *name) {
    // A model and an entity may share a name: the one with the component is meant.
    const Table *table = level->world->tables[component];
    for (u32 row = 0; row < table->count; row++)
        if (strcmp(world_name(level->world, table->entity[row]), name) == 0) return row;
    fprintf(stderr, "nothing named '%s' has %s\n", name, table->desc->name);
    fail();
    return 0;
}

DoorTable *test_level_doors(const TestLevel *level) {
    return (DoorTable *)world_find_table(level->world, "door");
}
