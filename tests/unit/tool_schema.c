// tool_schema.c: the published schema is the one that the components give.
#include "../test.h"
#include "../../engine/app/session.h"
#include <string.h>

TEST(tool_schema, published_file_is_up_to_date) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    World *world = world_create(0);
    for (u32 i = 0; i < luz_project.component_count; i++)
        world_register_component(world, luz_project.components[i]);
    const char *schema = level_schema(world, &arena);
    Bytes file;
    assert_true(file_read("data/level.schema.json", MIB(16), &arena, &file));
    if (strcmp(file.data, schema) != 0)
        fail_msg("out of date: run `luz schema -o data/level.schema.json`");
    world_destroy(world);
    arena_destroy(&arena);
}
