// split.c: one view drawn in two ways: the halves are the bits of each way alone, the difference is
// what a plain loop finds, nothing of one way leaks into the other.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include "../../engine/base/log.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH  192
#define HEIGHT 108

typedef struct Ways {
    RenderImage split, a, b;
} Ways;

// Both ways beside each other, then each alone by the same packets.
static Ways draw_ways(Studio *studio, const char *a, const char *b, const SplitView *split) {
    RenderSettings settings[2] = {settings_default(), settings_default()};
    assert_true(settings_set_list(&settings[0], a));
    assert_true(settings_set_list(&settings[1], b));
    session_frame_begin(&studio->session);
    const Packet *packets[2];
    SessionView view = {.camera = "main",
                        .settings = settings[0],
                        .width_px = WIDTH,
                        .height_px = HEIGHT,
                        .cold = true};
    assert_true(
        session_packet_split(&studio->session, &view, &settings[1], &packets[0], &packets[1]));
    for (u32 i = 0; i < 2; i++)
        assert_null(packet_validate(packets[i], packets[i]->size, studio->session.assets.mesh_count,
                                    studio->session.assets.texture_count));
    Ways ways;
    assert_true(renderer_render_split(studio->renderer, packets[0], packets[1], split,
                                      &studio->images, &ways.split));
    assert_true(renderer_render_image(studio->renderer, packets[0], &studio->images, &ways.a));
    assert_true(renderer_render_image(studio->renderer, packets[1], &studio->images, &ways.b));
    return ways;
}

static const u8 *pixel(const RenderImage *image, u32 x, u32 y) {
    return image->rgba + (y * WIDTH + x) * 4;
}
static bool same(const RenderImage *a, const RenderImage *b, u32 x, u32 y) {
    return memcmp(pixel(a, x, y), pixel(b, x, y), 3) == 0;
}

// Left of the line A's bits, right of it B's; two columns are the line's own.
static void check_line(const Ways *ways, f32 at) {
    i32 line = (i32)(at * WIDTH + 0.5f);
    for (u32 y = 0; y < HEIGHT; y++)
        for (u32 x = 0; x < WIDTH; x++) {
            if ((i32)x == line || (i32)x == line - 1) continue;
            assert_true(same(&ways->split, (i32)x < line ? &ways->a : &ways->b, x, y));
        }
}

static const char *const path_words[PATH_COUNT] = {
    "forward",        "multipass",     "deferred",           "deferred_volumes",
    "tiled_deferred", "tiled_forward", "clustered_deferred", "clustered_forward"};

TEST_GPU(golden, split_same_ways) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    session_advance(&studio.session, 30);
    for (u32 path = 0; path < PATH_COUNT; path++) {
        SplitView split = {.at = 0.5f};
        Ways ways = draw_ways(&studio, path_words[path], path_words[path], &split);
        assert_true(ways.a.hash == ways.b.hash);
        check_line(&ways, 0.5f);
        split.mode = SPLIT_DIFFERENCE;
        ways = draw_ways(&studio, path_words[path], path_words[path], &split);
        for (u32 i = 0; i < WIDTH * HEIGHT; i++)
            for (u32 k = 0; k < 3; k++) assert_int_equal(ways.split.rgba[i * 4 + k], 0);
    }
    studio_close(&studio);
}

// The light manager remembers; making B's packet must not make it remember twice.
TEST_GPU(golden, split_leaves_no_trace_in_the_session) {
    Studio studios[2];
    u64 hashes[2];
    for (u32 i = 0; i < 2; i++) {
        studio_open(&studios[i], "data/levels/cloister.toml");
        RenderSettings settings = settings_default();
        SplitView split = {.at = 0.5f};
        for (u32 frame = 0; frame < 3; frame++) {
            session_advance(&studios[i].session, 5);
            if (i == 0)
                hashes[i] = studio_draw(&studios[i], "main", &settings, WIDTH, HEIGHT).hash;
            else
                hashes[i] = draw_ways(&studios[i], "tiled_deferred",
                                      "tiled_forward,merge=off,drop=off", &split)
                                .a.hash;
        }
        studio_close(&studios[i]);
    }
    assert_true(hashes[0] == hashes[1]);
}

// Every path and layout beside another: each side is what it is alone.
TEST_GPU(golden, split_paths_and_layouts) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    static const char *const layouts[LAYOUT_COUNT] = {
        "lean", "wide", "packed", "packed24", "half5", "killzone2", "starcraft2", "il"};
    for (u32 i = 0; i < PATH_COUNT; i++) {
        char a[64], b[64];
        snprintf(a, sizeof a, "%s,layout=%s", path_words[i], layouts[i % LAYOUT_COUNT]);
        snprintf(b, sizeof b, "%s,layout=%s", path_words[(i + 3) % PATH_COUNT],
                 layouts[(i + 5) % LAYOUT_COUNT]);
        SplitView split = {.at = 0.37f};
        Ways ways = draw_ways(&studio, a, b, &split);
        check_line(&ways, split.at);
    }
    static const char *const pairs[][2] = {
        {"deferred_volumes,light_volume=stencil", "forward,msaa=4"},
        {"tiled_deferred,grid=gpu,tile_depth=mask", "clustered_deferred,clusters=gpu"},
        {"tiled_forward,tile_px=8", "tiled_forward,tile_px=64"},
        {"shadows=off", "exposure=2"},
        {"post=off", "palette=texture"},
    };
    for (u32 i = 0; i < COUNT_OF(pairs); i++) {
        SplitView split = {.at = 0.61f};
        Ways ways = draw_ways(&studio, pairs[i][0], pairs[i][1], &split);
        check_line(&ways, split.at);
    }
    // Debug views: A's is what it is alone; B's has its legend elsewhere.
    static const char *const views[] = {"view=light_volumes", "view=overdraw", "view=cell_lights",
                                        "view=normal,layout=packed", "view=occluders"};
    for (u32 i = 0; i < COUNT_OF(views); i++) {
        SplitView split = {.at = 0.61f};
        Ways ways = draw_ways(&studio, views[i], views[(i + 1) % COUNT_OF(views)], &split);
        ways.b = ways.split;
        check_line(&ways, split.at);
    }
    studio_close(&studio);
}

// The difference picture against a plain loop over the two pictures.
TEST_GPU(golden, split_difference) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    SplitView split = {.at = 0.5f, .mode = SPLIT_DIFFERENCE, .gain = 8};
    Ways ways = draw_ways(&studio, "forward", "deferred,light_gain=1.1,layout=packed", &split);
    u64 sum = 0;
    for (u32 i = 0; i < WIDTH * HEIGHT; i++) {
        i32 most = 0;
        for (u32 k = 0; k < 3; k++) {
            i32 d = (i32)ways.a.rgba[i * 4 + k] - (i32)ways.b.rgba[i * 4 + k];
            most = MAX(most, d < 0 ? -d : d);
        }
        f32 x = (f32)most * 8.0f / 255.0f;
        f32 expected[3] = {x * 3.0f, x * 3.0f - 1.0f, x * 3.0f - 2.0f};
        for (u32 k = 0; k < 3; k++) {
            f32 value = CLAMP(expected[k], 0.0f, 1.0f) * 255.0f;
            assert_true(fabsf(value - (f32)ways.split.rgba[i * 4 + k]) < 0.51f);
            sum += ways.split.rgba[i * 4 + k];
        }
    }
    assert_true(sum > 1000);
    // In a band: A left of it, B right of it, the difference between.
    RenderImage whole = ways.split;
    split.mode = SPLIT_BOTH;
    ways = draw_ways(&studio, "forward", "deferred,light_gain=1.1,layout=packed", &split);
    const u32 line = WIDTH / 2, band = WIDTH / 6;
    for (u32 y = 0; y < HEIGHT; y++)
        for (u32 x = 0; x < WIDTH; x++) {
            bool rim = (x + 2 > line - band && x < line - band + 2) ||
                       (x + 2 > line + band && x < line + band + 2);
            if (rim) continue;
            const RenderImage *expected = x < line - band   ? &ways.a
                                          : x < line + band ? &whole
                                                            : &ways.b;
            assert_true(same(&ways.split, expected, x, y));
        }
    studio_close(&studio);
}

// A line that moves, ways that change, captions, frames in flight: silent, and always the two ways.
TEST_GPU(golden, split_moving_line) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    for (u32 frame = 0; frame < 60; frame++) {
        SplitView split = {.at = (f32)frame / 59.0f,
                           .mode = frame % 3,
                           .label_a = frame & 4 ? "one way" : NULL,
                           .label_b = "another"};
        session_advance(&studio.session, 1);
        if (frame % 15 == 14) { // the captions' pixels are theirs
            split.mode = SPLIT_LINE;
            split.label_a = split.label_b = NULL;
            Ways ways = draw_ways(&studio, "deferred", "layout=wide", &split);
            check_line(&ways, split.at);
        } else {
            RenderSettings settings[2] = {settings_default(), settings_default()};
            settings[0].path = frame / 8;
            settings[1].layout = frame % LAYOUT_COUNT;
            session_frame_begin(&studio.session);
            const Packet *a, *b;
            SessionView view = {
                .camera = "main", .settings = settings[0], .width_px = 96, .height_px = 54};
            assert_true(session_packet_split(&studio.session, &view, &settings[1], &a, &b));
            assert_true(renderer_render_split(studio.renderer, a, b, &split, NULL, NULL));
        }
    }
    studio_close(&studio);
}

TEST_GPU(golden, split_needs_one_size) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_frame_begin(&studio.session);
    SessionView view = {
        .camera = "main", .settings = settings_default(), .width_px = 64, .height_px = 36};
    const Packet *a = session_packet(&studio.session, &view);
    view.height_px = 40;
    const Packet *b = session_packet(&studio.session, &view);
    SplitView split = {.at = 0.5f};
    u32 messages = log_count(LOG_USAGE);
    assert_false(renderer_render_split(studio.renderer, a, b, &split, NULL, NULL));
    assert_int_equal(log_count(LOG_USAGE), messages + 1);
    // And goes on as if nothing had been.
    RenderImage image;
    assert_true(renderer_render_split(studio.renderer, a, a, &split, &studio.images, &image));
    studio_close(&studio);
}
