// app_luz.c: tests of the public face without a device: a world from code, a component and a system
// of a program's own, recording and replay, keys.
#include "../../engine/luz.h"
#include "../test.h"
#include <string.h>

#define SPIN_COLUMNS(C) C(F32, speed, "deg/s", 90, "speed", -720, 720, "how fast it turns")
TABLE_STRUCT(Spin, SPIN_COLUMNS)
COMPONENT_DEFINE(Spin, spin, SPIN_COLUMNS, false, "turns about y")

static void system_spin(SystemContext *context) {
    SpinTable *spins = (SpinTable *)world_find_table(context->world, "spin");
    TransformTable *places = WORLD_TABLE(context->world, Transform, transform);
    for (u32 i = 0; i < spins->table.count; i++) {
        u32 row = table_row(&places->table, spins->table.entity[i]);
        places->yaw[row] += spins->speed[i] * TICK_SECONDS;
        table_touch(&places->table, row);
    }
}

static bool fill(World *world, AssetStore *assets, void *user) {
    u32 *calls = user;
    if (calls) (*calls)++;
    world->seed = 11;
    Entity floor = luz_add_shape(world, assets, "floor", &(ShapeDesc){.shape = SHAPE_PLANE},
                                 vec3(0, 0, 0), vec3(20, 1, 20), vec3(0.5f, 0.5f, 0.5f));
    Entity top = luz_add_shape(world, assets, "top", &(ShapeDesc){.shape = SHAPE_CUBE},
                               vec3(0, 1, -4), vec3(1, 1, 1), vec3(0.8f, 0.2f, 0.1f));
    table_add(world_find_table(world, "spin"), top);
    luz_add_light(world, "lamp", vec3(0, 3, 0), vec3(1, 0.9f, 0.7f), 40.0f);
    luz_add_camera(world, "main", vec3(0, 1.6f, 4), 0, 0);
    return floor != ENTITY_NONE && top != ENTITY_NONE;
}

static const ComponentDesc *const components[] = {&spin_component};
static const SystemPlacement systems[] = {{{"spin", "spin", "transform", system_spin}}};

static LuzDesc spin_desc(u32 *calls) {
    return (LuzDesc){.fill = fill,
                     .user = calls,
                     .components = components,
                     .component_count = COUNT_OF(components),
                     .systems = systems,
                     .system_count = COUNT_OF(systems),
                     .threads = 1};
}

TEST(app_luz, a_world_from_code_steps) {
    u32 calls = 0;
    LuzDesc desc = spin_desc(&calls);
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    assert_int_equal(calls, 1);
    World *world = luz_world(luz);
    Entity top = world_find(world, "top");
    assert_true(table_row(world->tables[COMPONENT_drawable], top) == ROW_NONE);
    assert_int_equal(world->tables[COMPONENT_drawable]->count, 2);
    for (u32 i = 0; i < TICK_RATE; i++) luz_step(luz, (Input){.move_z = 127});
    TransformTable *places = WORLD_TABLE(world, Transform, transform);
    ASSERT_NEAR(places->yaw[table_row(&places->table, top)], 90.0, 1e-3);
    assert_int_equal(world->tick, TICK_RATE);
    // The player was put at the camera and has walked towards -z.
    u32 player = table_row(&places->table, luz_session(luz)->player);
    assert_true(places->z[player] < 3.5f);
    luz_close(luz);
}

TEST(app_luz, the_same_world_twice) {
    u64 hashes[2];
    for (u32 run = 0; run < 2; run++) {
        LuzDesc desc = spin_desc(NULL);
        desc.threads = 1 + 2 * run;
        Luz *luz = luz_open(&desc);
        assert_non_null(luz);
        for (u32 i = 0; i < 200; i++)
            luz_step(luz, (Input){.move_x = (i8)(i % 50), .look_x = 30, .move_z = 100});
        hashes[run] = world_hash(luz_world(luz));
        luz_close(luz);
    }
    assert_true(hashes[0] == hashes[1]);
}

TEST(app_luz, restart_fills_again) {
    u32 calls = 0;
    LuzDesc desc = spin_desc(&calls);
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    u64 start = world_hash(luz_world(luz));
    for (u32 i = 0; i < 10; i++) luz_step(luz, (Input){0});
    assert_true(world_hash(luz_world(luz)) != start);
    assert_true(app_restart(luz));
    assert_int_equal(calls, 2);
    assert_true(world_hash(luz_world(luz)) == start);
    luz_close(luz);
}

static bool refuse(World *world, AssetStore *assets, void *user) {
    (void)world, (void)assets, (void)user;
    return false;
}

TEST(app_luz, nothing_to_show_is_no_program) {
    log_set_level(LOG_SEVERITY_NONE);
    LuzDesc refused = {.fill = refuse};
    assert_null(luz_open(&refused));
    LuzDesc missing = {.level = "there/is/no.toml"};
    assert_null(luz_open(&missing));
    luz_close(NULL);
}

TEST(app_luz, cameras_in_name_order) {
    LuzDesc desc = spin_desc(NULL);
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    luz_add_camera(luz_world(luz), "zenith", vec3(0, 9, 0), 0, -90);
    luz_add_camera(luz_world(luz), "arch", vec3(1, 1, 1), 0, 0);
    const char *names[8];
    assert_int_equal(app_cameras(luz, names, 8), 3);
    assert_string_equal(names[0], "arch");
    assert_string_equal(names[1], "main");
    assert_string_equal(names[2], "zenith");
    luz_set_camera(luz, "arch");
    assert_string_equal(luz->camera, "arch");
    luz_set_camera(luz, "nowhere");
    assert_string_equal(luz->camera, "");
    luz_close(luz);
}

TEST(app_luz, keys_change_settings) {
    LuzDesc desc = spin_desc(NULL);
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    RenderSettings *settings = luz_settings(luz);
    assert_true(app_key(luz, '1'));
    assert_int_equal(settings->path, PATH_FORWARD);
    assert_true(app_key(luz, '5'));
    assert_int_equal(settings->path, PATH_TILED_DEFERRED);
    assert_true(app_key(luz, 'B'));
    assert_int_equal(settings->view, VIEW_COUNT - 1);
    assert_true(app_key(luz, 'V'));
    assert_int_equal(settings->view, VIEW_FINAL);
    settings->target_ms = 30.0f;
    for (u32 i = 0; i < 20; i++) app_key(luz, '-');
    assert_true(settings->scale == 0.25f && settings->target_ms == 0.0f);
    for (u32 i = 0; i < 20; i++) app_key(luz, '=');
    assert_true(settings->scale == 1.0f);
    app_key(luz, 'P');
    assert_true(luz->paused);
    assert_false(app_key(luz, 'Z'));
    assert_true(app_key_help()[0] != NULL);
    luz_close(luz);
}

static const char level_text[] =
    "[[model]]\nname = \"box\"\nshape = \"cube\"\n"
    "[[entity]]\nname = \"main\"\ntransform.position = [0, 1.7, 6]\n"
    "camera = { fov = 60 }\n"
    "[[entity]]\ninstance = { model = \"box\" }\nspin = { speed = 45 }\n";

TEST(app_luz, a_recording_replays) {
    const char *level = test_temp_path("spin.toml"), *path = test_temp_path("spin.luzr");
    assert_true(file_write(level, level_text, sizeof level_text - 1));
    LuzDesc desc = spin_desc(NULL);
    desc.fill = NULL;
    desc.level = level;
    desc.record_path = path;
    Luz *luz = luz_open(&desc);
    assert_non_null(luz);
    for (u32 i = 0; i < 90; i++)
        luz_step(
            luz,
            (Input){.move_z = 127, .look_x = (i16)(i * 7), .buttons = i == 30 ? INPUT_JUMP : 0});
    luz_close(luz);
    assert_true(file_exists(path));

    LuzDesc replay = spin_desc(NULL);
    replay.fill = NULL;
    replay.replay_path = path;
    replay.headless = true;
    assert_int_equal(luz_run(&replay), 0);

    // A level that differs is noticed.
    log_set_level(LOG_SEVERITY_NONE);
    char other[sizeof level_text];
    memcpy(other, level_text, sizeof other);
    *strstr(other, "45") = '9';
    assert_true(file_write(level, other, sizeof other - 1));
    assert_int_equal(luz_run(&replay), 1);
}
