// app_overlay.c: tests of draw lists to Overlay, and of small pure parts of the shells.
#include "../../engine/app/app.h"
#include "../../engine/app/overlay_build.h"
#include "../test.h"
#include <stdlib.h>

static OverlayBuild *build_new(void) {
    OverlayBuild *build = malloc(sizeof *build);
    assert_non_null(build);
    overlay_build_begin(build, 640, 360);
    return build;
}

TEST(app_overlay, lists_lie_behind_each_other) {
    OverlayBuild *build = build_new();
    const OverlayVertex vertices[3] = {{1, 2, 0, 0, 5}, {3, 4, 0, 0, 6}, {5, 6, 0, 0, 7}};
    const u16 indices[3] = {0, 1, 2};
    const f32 clip[4] = {0, 0, 640, 360};
    for (u32 i = 0; i < 3; i++) {
        assert_true(overlay_build_list(build, vertices, 3, indices, 3, 1.0f));
        overlay_build_command(build, clip, 0, 0, 3);
    }
    const Overlay *overlay = overlay_build_end(build);
    assert_int_equal(overlay->vertex_count, 9);
    assert_int_equal(overlay->index_count, 9);
    assert_int_equal(overlay->command_count, 3);
    for (u32 i = 0; i < 3; i++) {
        assert_int_equal(overlay->commands[i].first_index, 3 * i);
        assert_int_equal(overlay->commands[i].vertex_offset, 3 * i);
        assert_true(overlay->vertices[3 * i + 1].x == 3.0f);
    }
    free(build);
}

TEST(app_overlay, positions_scale) {
    OverlayBuild *build = build_new();
    const OverlayVertex vertex = {10, 20, 0.5f, 0.25f, 1};
    const u16 index = 0;
    assert_true(overlay_build_list(build, &vertex, 1, &index, 1, 2.0f));
    const OverlayVertex *out = overlay_build_end(build)->vertices;
    assert_true(out->x == 20.0f && out->y == 40.0f && out->u == 0.5f && out->v == 0.25f);
    free(build);
}

TEST(app_overlay, clips_are_cut_to_the_window) {
    OverlayBuild *build = build_new();
    const f32 clips[][4] = {
        {-50, -20, 100, 90},    // beyond the corner
        {600, 300, 9000, 9000}, // beyond the other
        {700, 0, 800, 100},     // outside
        {100, 100, 100, 200},   // empty
        {200, 200, 100, 100},   // inside out
        {NAN, NAN, NAN, NAN},
    };
    for (u32 i = 0; i < COUNT_OF(clips); i++) overlay_build_command(build, clips[i], 0, 0, 3);
    const Overlay *overlay = overlay_build_end(build);
    assert_true(overlay->command_count >= 2);
    for (u32 i = 0; i < overlay->command_count; i++) {
        const OverlayCommand *command = &overlay->commands[i];
        assert_true(command->clip_x >= 0 && command->clip_y >= 0);
        assert_true((u32)command->clip_x + command->clip_width <= 640);
        assert_true((u32)command->clip_y + command->clip_height <= 360);
        assert_true(command->clip_width > 0 && command->clip_height > 0);
    }
    assert_int_equal(overlay->commands[0].clip_width, 100);
    assert_int_equal(overlay->commands[0].clip_height, 90);
    assert_int_equal(overlay->commands[1].clip_x, 600);
    assert_int_equal(overlay->commands[1].clip_width, 40);
    free(build);
}

TEST(app_overlay, caps_hold) {
    OverlayBuild *build = build_new();
    OverlayVertex *vertices = calloc(60000, sizeof *vertices);
    const u16 index = 0;
    assert_true(overlay_build_list(build, vertices, 60000, &index, 1, 1.0f));
    assert_false(overlay_build_list(build, vertices, 60000, &index, 1, 1.0f));
    const f32 clip[4] = {0, 0, 10, 10};
    for (u32 i = 0; i < OVERLAY_COMMANDS_CAP + 10; i++) overlay_build_command(build, clip, 0, 0, 1);
    assert_int_equal(overlay_build_end(build)->command_count, OVERLAY_COMMANDS_CAP);
    free(vertices);
    free(build);
}

TEST(app_overlay, internal_size) {
    u32 width, height;
    app_internal_size(1.0f, 1280, 720, &width, &height);
    assert_int_equal(width, 1280);
    assert_int_equal(height, 720);
    app_internal_size(0.5f, 1281, 721, &width, &height);
    assert_int_equal(width, 641);
    assert_int_equal(height, 361);
    app_internal_size(0.25f, 8, 8, &width, &height);
    assert_int_equal(width, APP_SIDE_MIN_PX);
    assert_int_equal(height, APP_SIDE_MIN_PX);
}
