// level_gi_levels.c: the levels that are made to show global illumination hold what they promise.
#include "../test.h"
#include "../../engine/app/session.h"
#include <stdio.h>

static void open_level(Session *session, const char *path) {
    assert_true(session_create(session, &(SessionDesc){0}));
    if (!session_load(session, path)) {
        diagnostics_print(session->diagnostics, stderr);
        fail_msg("%s does not load", path);
    }
    assert_int_equal(WORLD_TABLE(session->world, Gi, gi)->table.count, 1);
}

TEST(level_gi_shown, teapot_is_the_only_light) {
    Session session;
    open_level(&session, "data/levels/emissive_teapot.toml");
    assert_int_equal(WORLD_TABLE(session.world, Light, light)->table.count, 0);
    const MaterialTable *materials = WORLD_TABLE(session.world, Material, material);
    u32 shining = 0;
    for (u32 row = 0; row < materials->table.count; row++)
        shining += materials->emissive_r[row] * materials->emissive_strength[row] > 0.0f;
    assert_int_equal(shining, 1);
    assert_true(world_find(session.world, "teapot") != ENTITY_NONE);
    session_destroy(&session);
}

TEST(level_gi_shown, door_opens_and_is_all_that_moves) {
    Session session;
    open_level(&session, "data/levels/moving_door.toml");
    const InstanceTable *instances = WORLD_TABLE(session.world, Instance, instance);
    const TransformTable *places = WORLD_TABLE(session.world, Transform, transform);
    Entity door = ENTITY_NONE;
    u32 dynamic = 0;
    for (u32 i = 0; i < instances->table.count; i++) {
        if (instances->voxel_mode[i] != VOXEL_DYNAMIC) continue;
        door = instances->table.entity[i];
        dynamic++;
    }
    assert_int_equal(dynamic, 1);
    assert_string_equal(world_name(session.world, door), "door");
    u32 row = table_row(&places->table, door);
    f32 least = 1e9f, most = -1e9f;
    for (u32 tick = 0; tick < 9 * TICK_RATE; tick += 15) {
        session_advance(&session, 15);
        least = MIN(least, places->w03[row]);
        most = MAX(most, places->w03[row]);
    }
    // The doorway is 1.4 m wide, the door 1.8 m: shut, and wide open.
    assert_true(least < 0.1f && least > -0.2f);
    assert_true(most > 1.6f && most < 2.0f);
    session_destroy(&session);
}
