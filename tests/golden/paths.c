// paths.c: every path gives the same picture, the same bits each time, and nothing is black.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include "../../engine/base/log.h"
#include <dirent.h>
#include <stdio.h>
#include <string.h>

// Small: the slow paths cost pixels x lights, and one level has 4,096 of them; there, `multipass`
// (the scene once for every 8 lights) has to do with the first of them.
#define MULTIPASS_LIGHTS_MAX 128
static void compare_paths(const char *level, u32 width, u32 height) {
    Studio studio;
    studio_open(&studio, level);
    session_advance(&studio.session, 90);
    bool is_large = WORLD_TABLE(studio.session.world, Light, light)->table.count > 1024;
    RenderImage images[PATH_COUNT];
    for (u32 path = 0; path < PATH_COUNT; path++) {
        RenderSettings settings = settings_default();
        settings.path = path;
        if (path == PATH_MULTIPASS && is_large) {
            images[path] = images[PATH_FORWARD];
            settings.light_limit = MULTIPASS_LIGHTS_MAX;
            RenderImage few = studio_draw(&studio, "main", &settings, width, height);
            settings.path = PATH_FORWARD;
            RenderImage expected = studio_draw(&studio, "main", &settings, width, height);
            assert_in_range(
                image_compare(expected.rgba, few.rgba, width, height, &studio.images).max, 0, 2);
            continue;
        }
        images[path] = studio_draw(&studio, "main", &settings, width, height);
        // Without culling by subgroups and in another order of paths: the same bits.
        if (path == PATH_TILED_DEFERRED) {
            settings.subgroup_cull = 0;
            RenderImage plain = studio_draw(&studio, "main", &settings, width, height);
            assert_true(plain.hash == images[path].hash);
            settings.subgroup_cull = 1;
        }
        RenderImage again = studio_draw(&studio, "main", &settings, width, height);
        assert_true(again.hash == images[path].hash);
    }
    for (u32 path = 1; path < PATH_COUNT; path++) {
        ImageDifference d = image_compare(images[PATH_FORWARD].rgba, images[path].rgba, width,
                                          height, &studio.images);
        char word[64];
        printf("    %s forward against %s: max %u at %u,%u, mean %.4f\n", level,
               settings_word("path", path, word, sizeof word), d.max, d.max_x, d.max_y, d.mean);
        assert_in_range(d.max, 0, 2);
    }
    // A picture has light and dark: black frames and constant ones are failures.
    u64 sum = 0, squares = 0, count = (u64)width * height;
    for (u64 i = 0; i < count; i++) {
        u64 green = images[PATH_TILED_DEFERRED].rgba[i * 4 + 1];
        sum += green;
        squares += green * green;
    }
    f64 mean = (f64)sum / (f64)count, variance = (f64)squares / (f64)count - mean * mean;
    assert_true(mean > 5.0);
    assert_true(variance > 25.0);
    studio_close(&studio);
}

TEST_GPU(golden, paths_agree_cloister) { compare_paths("data/levels/cloister.toml", 256, 144); }
TEST_GPU(golden, paths_agree_cornell) { compare_paths("data/levels/cornell.toml", 256, 144); }
TEST_GPU(golden, paths_agree_cornell_empty) {
    compare_paths("data/levels/cornell_empty.toml", 256, 144);
}
TEST_GPU(golden, paths_agree_light_box) { compare_paths("data/levels/light_box.toml", 256, 144); }
TEST_GPU(golden, paths_agree_lights_4096) {
    compare_paths("data/levels/lights_4096.toml", 128, 72);
}
TEST_GPU(golden, paths_agree_plane_test) { compare_paths("data/levels/plane_test.toml", 256, 144); }

TEST(golden, every_level_is_in_the_list) {
    DIR *directory = opendir("data/levels");
    assert_non_null(directory);
    u32 count = 0;
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (!strstr(entry->d_name, ".toml")) continue;
        char path[512];
        snprintf(path, sizeof path, "data/levels/%s", entry->d_name);
        bool found = false;
        for (u32 i = 0; i < studio_level_count; i++) found |= strcmp(path, studio_levels[i]) == 0;
        if (!found) fail_msg("%s is in no picture test", path);
        count++;
    }
    closedir(directory);
    assert_int_equal(count, studio_level_count);
}

// Each attenuation and each switch draws without a message of the validation layer, in all paths.
TEST_GPU(golden, settings_in_all_paths) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    static const char *const variants[] = {"shadows=off",      "tonemap=off",  "light_culling=off",
                                           "mesh_culling=off", "light_gain=0", "exposure=2"};
    for (u32 v = 0; v < COUNT_OF(variants); v++)
        for (u32 path = 0; path < PATH_COUNT; path++) {
            RenderSettings settings = settings_default();
            assert_true(settings_set(&settings, variants[v]));
            settings.path = path;
            studio_draw(&studio, "main", &settings, 96, 54);
        }
    EnvironmentTable *environment = WORLD_TABLE(studio.session.world, Environment, environment);
    u32 row = world_singleton(studio.session.world, COMPONENT_environment);
    for (u32 attenuation = 0; attenuation < 3; attenuation++) {
        environment->attenuation[row] = attenuation;
        RenderImage images[PATH_COUNT];
        for (u32 path = 0; path < PATH_COUNT; path++) {
            RenderSettings settings = settings_default();
            settings.path = path;
            images[path] = studio_draw(&studio, "main", &settings, 160, 90);
            ImageDifference d =
                image_compare(images[0].rgba, images[path].rgba, 160, 90, &studio.images);
            assert_in_range(d.max, 0, 2);
        }
    }
    studio_close(&studio);
}

TEST_GPU(golden, debug_views_differ) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    u64 hashes[VIEW_COUNT];
    for (u32 view = 0; view < VIEW_COUNT; view++) {
        RenderSettings settings = settings_default();
        settings.view = view;
        // Clusters need their path, five targets their layout, mirrored light its cones.
        if (view == VIEW_GI_SPECULAR) settings.gi_specular = 2; // on
        if (view == VIEW_CLUSTERS) settings.path = PATH_CLUSTERED_DEFERRED;
        if (view >= VIEW_GBUFFER_0 && view <= VIEW_GBUFFER_4) settings.layout = LAYOUT_HALF5;
        RenderImage image = studio_draw(&studio, "main", &settings, 160, 90);
        hashes[view] = image.hash;
        for (u32 other = 0; other < view; other++)
            if (hashes[other] == hashes[view])
                fail_msg("views %u and %u are the same", other, view);
        // Not black below the caption; the caption (and the legend) stand in the upper left corner.
        u32 lit = 0, letters = 0;
        for (u32 i = 40 * 160; i < 90 * 160; i++)
            lit += image.rgba[i * 4] + image.rgba[i * 4 + 1] + image.rgba[i * 4 + 2] > 12;
        for (u32 y = 10; y < 26; y++)
            for (u32 x = 10; x < 80; x++) letters += image.rgba[(y * 160 + x) * 4] == 240;
        // Emission and specular colours of this level are dark, nothing mirrors, no light leaks
        // into it.
        bool may_be_empty = view == VIEW_EMISSIVE || view == VIEW_GBUFFER_3 ||
                            view == VIEW_GBUFFER_4 || view == VIEW_GI_LEAKS ||
                            view == VIEW_GI_SPECULAR;
        if (lit < 500 && !may_be_empty) fail_msg("view %u is black", view);
        if (view != VIEW_FINAL && letters < 60) fail_msg("view %u has no caption", view);
    }
    studio_close(&studio);
}

typedef struct Steps {
    u32 calls, last;
    bool is_ready, went_back;
} Steps;
static void count_step(void *user, u32 done, u32 total, const char *what) {
    Steps *steps = user;
    steps->calls++;
    steps->went_back |= done < steps->last || done > total;
    steps->last = done;
    steps->is_ready = strcmp(what, "ready") == 0;
}

// Odd sizes cut tiles and groups; sizes change while running; the warm-up leaves no trace.
TEST_GPU(golden, sizes_and_warm_up) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    RenderSettings settings = settings_default();
    RenderImage first = studio_draw(&studio, "main", &settings, 161, 91);
    static const u32 sizes[][2] = {{1, 1}, {7, 5}, {16, 16}, {17, 33}, {640, 360}, {64, 360}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++)
        for (u32 path = 0; path < PATH_COUNT; path++) {
            settings.path = path;
            studio_draw(&studio, "main", &settings, sizes[i][0], sizes[i][1]);
        }
    settings = settings_default();
    for (u32 path = PATH_COUNT; path-- > 0;) {
        settings.path = path;
        const Packet *packet = session_packet(&studio.session, &(SessionView){.camera = "main",
                                                                              .settings = settings,
                                                                              .width_px = 161,
                                                                              .height_px = 91});
        Steps steps = {0};
        assert_true(renderer_warm_up(studio.renderer, packet, count_step, &steps));
        assert_true(steps.calls > 3 && steps.is_ready && !steps.went_back);
    }
    settings = settings_default();
    u32 pipelines = renderer_stats(studio.renderer).pipelines;
    RenderImage last = studio_draw(&studio, "main", &settings, 161, 91);
    assert_true(first.hash == last.hash);
    assert_int_equal(renderer_stats(studio.renderer).pipelines, pipelines);
    // No path makes a pipeline that the warm-up did not.
    for (u32 path = 0; path < PATH_COUNT; path++) {
        settings.path = path;
        studio_draw(&studio, "main", &settings, 161, 91);
        assert_int_equal(renderer_stats(studio.renderer).pipelines, pipelines);
    }
    studio_close(&studio);
}
