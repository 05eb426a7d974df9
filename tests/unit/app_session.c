// app_session.c: levels that load, fail and are saved while they run; the player.
#include "../test.h"
#include "../../engine/app/session.h"
#include "../../engine/base/log.h"
#include <stdio.h>
#include <string.h>

static const char level_text[] = "[[model]]\n"
                                 "name = \"cube\"\n"
                                 "shape = \"cube\"\n"
                                 "[[entity]]\n"
                                 "name = \"floor\"\n"
                                 "instance = { model = \"cube\", collision = \"mesh\" }\n"
                                 "transform = { position = [0, -0.5, 0], scale = [40, 1, 40] }\n"
                                 "[[entity]]\n"
                                 "name = \"main\"\n"
                                 "camera = {}\n"
                                 "transform = { position = [0, 2, 5] }\n";

static void save(const char *path, const char *more) {
    char text[4096];
    snprintf(text, sizeof text, "%s%s", level_text, more);
    assert_true(file_write(path, text, strlen(text)));
}

static Vec3 player_place(const Session *session) {
    const TransformTable *places = WORLD_TABLE(session->world, Transform, transform);
    u32 row = table_row(&places->table, session->player);
    assert_int_not_equal(row, ROW_NONE);
    return vec3(places->x[row], places->y[row], places->z[row]);
}

static void open_session(Session *session, const char *path) {
    assert_true(session_create(session, &(SessionDesc){0}));
    if (!session_load(session, path)) {
        diagnostics_print(session->diagnostics, stderr);
        fail_msg("%s does not load", path);
    }
}

TEST(app_session, player_stands_at_the_camera) {
    const char *path = test_temp_path("a.toml");
    save(path, "");
    Session session;
    open_session(&session, path);
    Vec3 place = player_place(&session);
    assert_true(place.x == 0.0f && place.y == 2.0f && place.z == 5.0f);
    assert_true(session_camera(&session, NULL) == session.player);
    assert_true(session_camera(&session, "main") != session.player);
    assert_int_equal(session_camera(&session, "floor"), ENTITY_NONE); // has none
    session_advance(&session, 60);
    place = player_place(&session);
    assert_true(place.y > 0.5f && place.y <= 2.0f); // on the floor, not through it
    session_destroy(&session);
}

TEST(app_session, spawn_is_the_player) {
    const char *path = test_temp_path("a.toml");
    save(path, "[[entity]]\nname = \"spawn\"\ntransform = { position = [3, 1.7, 0] }\n");
    Session session;
    open_session(&session, path);
    assert_true(session.player == world_find(session.world, "spawn"));
    assert_true(player_place(&session).x == 3.0f);
    session_destroy(&session);
}

TEST(app_session, reload_keeps_the_player) {
    const char *path = test_temp_path("a.toml");
    save(path, "");
    Session session;
    open_session(&session, path);
    assert_int_equal(session_poll_reload(&session), 0);
    for (u32 i = 0; i < 60; i++) session_tick(&session, (Input){.move_z = 127, .look_x = 10});
    Vec3 before = player_place(&session);
    assert_true(before.z < 4.5f);
    save(path, "[[entity]]\nname = \"new\"\nlight = { intensity = 3 }\n");
    assert_int_equal(session_poll_reload(&session), 1);
    assert_int_not_equal(world_find(session.world, "new"), ENTITY_NONE);
    Vec3 after = player_place(&session);
    assert_true(before.x == after.x && before.y == after.y && before.z == after.z);
    assert_int_equal(session.world->tick, 0);
    assert_int_equal(session_poll_reload(&session), 0);
    session_tick(&session, (Input){0});
    session_destroy(&session);
}

TEST(app_session, a_broken_edit_keeps_the_old_level) {
    const char *path = test_temp_path("a.toml");
    save(path, "");
    Session session;
    open_session(&session, path);
    session_advance(&session, 10);
    u64 hash = world_hash(session.world);
    log_set_level(LOG_SEVERITY_NONE);
    save(path, "[[entity]]\nlight = { intensty = 3 }\n");
    assert_int_equal(session_poll_reload(&session), -1);
    assert_true(session.diagnostics->error_count > 0);
    assert_true(world_hash(session.world) == hash);
    assert_int_equal(session_poll_reload(&session), 0); // said once
    // A load by hand that fails leaves it as well.
    assert_false(session_load(&session, test_temp_path("absent.toml")));
    assert_true(session.diagnostics->error_count > 0);
    assert_true(world_hash(session.world) == hash);
    save(path, "");
    assert_int_equal(session_poll_reload(&session), 1);
    assert_int_equal(session.diagnostics->error_count, 0);
    session_destroy(&session);
}

// Two sessions, and a packet drawn in between: the same worlds.
// A level is saved before the model that it names is exported.
TEST(app_session, a_file_that_comes_later_mends_the_level) {
    const char *path = test_temp_path("a.toml");
    save(path, "");
    Session session;
    open_session(&session, path);
    save(path, "[[material]]\nname = \"paint\"\nalbedo_texture = \"paint.png\"\n");
    log_set_level(LOG_SEVERITY_NONE);
    assert_int_equal(session_poll_reload(&session), -1);
    assert_int_equal(session_poll_reload(&session), 0);
    assert_true(file_write(test_temp_path("paint.png"), "half", 4));
    assert_int_equal(session_poll_reload(&session), -1);
    const u8 pixel[4] = {255, 128, 0, 255};
    assert_true(image_write_png(test_temp_path("paint.png"), pixel, 1, 1, 4));
    assert_int_equal(session_poll_reload(&session), 1);
    assert_int_not_equal(world_find(session.world, "paint"), ENTITY_NONE);
    assert_int_equal(session_poll_reload(&session), 0);
    session_destroy(&session);
}

TEST(app_session, looking_changes_nothing) {
    const char *path = test_temp_path("a.toml");
    save(path, "[[entity]]\nname = \"l\"\nlight = {}\norbit = {}\nflicker = {}\n");
    Session a, b;
    open_session(&a, path);
    open_session(&b, path);
    for (u32 i = 0; i < 30; i++) {
        Input input = {.move_z = 100, .look_x = (i16)(i * 7)};
        session_tick(&a, input);
        session_tick(&b, input);
        session_frame_begin(&b);
        SessionView view = {.settings = settings_default(), .width_px = 64, .height_px = 36};
        assert_non_null(session_packet(&b, &view));
        assert_true(world_hash(a.world) == world_hash(b.world));
    }
    session_destroy(&a);
    session_destroy(&b);
}
