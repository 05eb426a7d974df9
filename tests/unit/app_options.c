// app_options.c: tests of the command line.
#include "../../engine/app/options.h"
#include "../../engine/base/log.h"
#include "../test.h"
#include <string.h>

// argv from words; the parser never writes to them.
#define PARSE(desc, options, ...)                                                                  \
    app_parse_options((int)(sizeof((char *[]){"demo", __VA_ARGS__}) / sizeof(char *)),             \
                      (char *[]){"demo", __VA_ARGS__}, (desc), (options))

TEST(app_options, everything) {
    AppDesc desc = {.level = "first.toml"};
    AppOptions options;
    assert_int_equal(PARSE(&desc, &options, "--size", "640x360", "--seconds=2.5", "--threads", "3",
                           "--validation", "--headless", "--set", "path=forward", "--set=scale=0.5",
                           "--status", "s.json", "--camera=main", "other.toml"),
                     OPTIONS_GO_ON);
    assert_int_equal(desc.width_px, 640);
    assert_int_equal(desc.height_px, 360);
    assert_true(desc.seconds == 2.5f);
    assert_int_equal(desc.threads, 3);
    assert_true(desc.validation && desc.headless && !desc.fullscreen);
    assert_string_equal(desc.level, "other.toml");
    assert_string_equal(desc.status_path, "s.json");
    assert_string_equal(desc.camera, "main");
    assert_ptr_equal(desc.settings, &options.settings);
    assert_int_equal(options.settings.path, PATH_FORWARD);
    assert_true(options.settings.scale == 0.5f);
}

TEST(app_options, none) {
    AppDesc desc = {.level = "first.toml"};
    AppOptions options;
    char *argv[] = {"demo"};
    assert_int_equal(app_parse_options(1, argv, &desc, &options), OPTIONS_GO_ON);
    assert_string_equal(desc.level, "first.toml");
    RenderSettings defaults = settings_default();
    assert_memory_equal(&options.settings, &defaults, sizeof defaults);
}

TEST(app_options, mistakes_end_with_2) {
    AppDesc desc = {0};
    AppOptions options;
    log_set_level(LOG_SEVERITY_NONE);
    char text[256];
    assert_int_equal(PARSE(&desc, &options, "--fulscreen"), 2);
    log_last_error(text, sizeof text);
    assert_non_null(strstr(text, "--fullscreen"));
    assert_int_equal(PARSE(&desc, &options, "--size", "640"), 2);
    assert_int_equal(PARSE(&desc, &options, "--size", "0x0"), 2);
    assert_int_equal(PARSE(&desc, &options, "--size", "640x360x2"), 2);
    assert_int_equal(PARSE(&desc, &options, "--size", "-5x7"), 2);
    assert_int_equal(PARSE(&desc, &options, "--threads", "many"), 2);
    assert_int_equal(PARSE(&desc, &options, "--threads", "1.5"), 2);
    assert_int_equal(PARSE(&desc, &options, "--seconds", "nan"), 2);
    assert_int_equal(PARSE(&desc, &options, "--set", "pth=forward"), 2);
    assert_int_equal(PARSE(&desc, &options, "--level"), 2);
    assert_true(log_count(LOG_USAGE) >= 9);
    assert_int_equal(log_count(LOG_RENDER_SETTING), 1);
}

TEST(app_options, help_ends_with_0) {
    AppDesc desc = {.title = "demo"};
    AppOptions options;
    assert_int_equal(PARSE(&desc, &options, "--help"), 0);
    assert_int_equal(PARSE(&desc, &options, "-h"), 0);
}

TEST(app_options, split) {
    AppDesc desc = {0};
    AppOptions options;
    assert_int_equal(PARSE(&desc, &options, "--split", "deferred", "layout=packed,shadows=off",
                           "--set", "scale=0.5", "--set", "exposure=2"),
                     OPTIONS_GO_ON);
    assert_ptr_equal(desc.split, &options.split);
    assert_int_equal(options.settings.path, PATH_DEFERRED);
    assert_int_equal(options.split.path,
                     settings_default().path); // what is not named is as in A's base
    assert_int_equal(options.split.layout, LAYOUT_PACKED);
    assert_true(options.settings.scale == 0.5f && options.split.scale == 0.5f);
    assert_true(options.settings.exposure == 2.0f && options.split.exposure == 2.0f);
    assert_int_equal(options.settings.shadows, 1);
    assert_int_equal(options.split.shadows, 0);
    log_set_level(LOG_SEVERITY_NONE);
    desc = (AppDesc){0};
    assert_int_equal(PARSE(&desc, &options, "--split", "deferred"), 2);
    assert_int_equal(PARSE(&desc, &options, "--split"), 2);
    assert_int_equal(PARSE(&desc, &options, "--split", "deferred", "foward"), 2);
    assert_int_equal(PARSE(&desc, &options, "--split", "deferred", "forward,scale=0.5"), 2);
    assert_int_equal(PARSE(&desc, &options, "--split", "target_ms=20", "forward"), 2);
    log_set_level(LOG_SEVERITY_INFO);
}
