// frame_settings.c: the text form of settings, and what a stranger's settings become.
#include "../test.h"
#include "../../engine/base/log.h"
#include "../../engine/base/random.h"
#include "../../engine/frame/settings.h"
#include <string.h>

TEST(frame_settings, defaults_are_in_range_and_complete) {
    RenderSettings settings = settings_default(), clamped = settings;
    settings_clamp(&clamped);
    assert_memory_equal(&settings, &clamped, sizeof settings);
    assert_int_equal(settings.path, PATH_TILED_DEFERRED);
    assert_true(settings.scale == 1.0f && settings.shadows == 1);
    assert_int_equal(render_setting_count * 4, sizeof settings); // 4-byte values without holes
    for (u32 i = 0; i < render_setting_count; i++)
        assert_int_equal(render_setting_descs[i].offset, i * 4);
}

TEST(frame_settings, texts_set_values) {
    RenderSettings s = settings_default();
    assert_true(settings_set(&s, "path=forward"));
    assert_int_equal(s.path, PATH_FORWARD);
    assert_true(settings_set(&s, "view=cell_lights"));
    assert_int_equal(s.view, VIEW_CELL_LIGHTS);
    assert_true(settings_set(&s, "scale=0.5"));
    assert_true(s.scale == 0.5f);
    assert_true(settings_set(&s, "light_limit=123"));
    assert_int_equal(s.light_limit, 123);
    const char *const words[] = {"on", "true", "1", "yes", "off", "false", "0", "no"};
    for (u32 i = 0; i < COUNT_OF(words); i++) {
        char text[32] = "shadows=";
        strcat(text, words[i]);
        assert_true(settings_set(&s, text));
        assert_int_equal(s.shadows, i < 4);
    }
}

static char last_text[512];
static void keep_text(LogId id, LogLevel level, const char *text, void *user) {
    (void)id, (void)level, (void)user;
    strncpy(last_text, text, sizeof last_text - 1);
}

TEST(frame_settings, mistakes_change_nothing_and_suggest) {
    const struct {
        const char *text, *hint;
    } mistakes[] = {{"pth=forward", "'path'"},
                    {"path=foward", "'forward'"},
                    {"veiw=final", "'view'"},
                    {"path=tiled_defered", "'tiled_deferred'"},
                    {"tonemapp=1", "'tonemap'"},
                    {"scale=2", "0.25 to 1"},
                    {"scale=0.5x", "number"},
                    {"scale=", "number"},
                    {"scale=nan", "number"},
                    {"scale=inf", "number"},
                    {"scale= 1", "number"},
                    {"scale=1e999", "0.25 to 1"},
                    {"light_limit=1.5", "whole"},
                    {"light_limit=-1", "0 to"},
                    {"shadows=maybe", "true or false"},
                    {"path", "key=value"},
                    {"=1", "unknown setting ''"},
                    {"", "key=value"},
                    {"completely_different=1", "unknown setting"},
                    {"path=", "it can be"}};
    RenderSettings before = settings_default(), s = before;
    log_set_sink(keep_text, NULL);
    for (u32 i = 0; i < COUNT_OF(mistakes); i++) {
        u32 count = log_count(LOG_RENDER_SETTING);
        if (settings_set(&s, mistakes[i].text)) fail_msg("'%s' was taken", mistakes[i].text);
        assert_memory_equal(&s, &before, sizeof s);
        assert_int_equal(log_count(LOG_RENDER_SETTING), count + 1);
        if (!strstr(last_text, mistakes[i].hint))
            fail_msg("'%s' gave: %s", mistakes[i].text, last_text);
    }
    // Longer than any buffer.
    static char long_text[100000];
    memset(long_text, 'a', sizeof long_text - 1);
    assert_false(settings_set(&s, long_text));
    long_text[5] = '=';
    assert_false(settings_set(&s, long_text));
    memcpy(long_text, "path=", 5);
    assert_false(settings_set(&s, long_text));
    log_set_sink(NULL, NULL);
}

TEST(frame_settings, clamp_survives_any_bits) {
    const u64 seed = 0x5E77;
    for (u32 round = 0; round < 20000; round++) {
        RenderSettings s;
        u32 bits[sizeof s / 4];
        for (u32 i = 0; i < COUNT_OF(bits); i++) {
            bits[i] = random_u32(seed, i, round);
            if (round % 7 == i % 7) bits[i] = 0x7FC00000u; // NaN
        }
        memcpy(&s, bits, sizeof s);
        settings_clamp(&s);
        for (u32 i = 0; i < render_setting_count; i++) {
            const SettingDesc *desc = &render_setting_descs[i];
            f32 number;
            u32 whole;
            memcpy(&number, (u8 *)&s + desc->offset, 4);
            memcpy(&whole, (u8 *)&s + desc->offset, 4);
            f64 value = desc->type == SETTING_F32 ? number : whole;
            assert_true(value >= desc->min && value <= desc->max);
        }
    }
}

TEST(frame_settings, words_of_values) {
    char out[32];
    assert_string_equal(settings_word("path", PATH_TILED_DEFERRED, out, sizeof out),
                        "tiled_deferred");
    assert_string_equal(settings_word("view", 0, out, sizeof out), "final");
    assert_string_equal(settings_word("path", 99, out, sizeof out), "");
    assert_string_equal(settings_word("nothing", 0, out, sizeof out), "");
    assert_string_equal(settings_word("scale", 0, out, sizeof out), "");
    assert_string_equal(settings_word("path", PATH_TILED_DEFERRED, out, 6), "tiled");
}

TEST(frame_settings, lists_of_settings) {
    RenderSettings s = settings_default();
    assert_true(settings_set_list(&s, "deferred,layout=packed,shadows=off"));
    assert_int_equal(s.path, PATH_DEFERRED);
    assert_int_equal(s.layout, LAYOUT_PACKED);
    assert_int_equal(s.shadows, 0);
    assert_true(settings_set_list(&s, "layout=lean"));
    assert_int_equal(s.path, PATH_DEFERRED);
    assert_int_equal(s.layout, LAYOUT_LEAN);
    RenderSettings before = s;
    static const char *const mistakes[] = {"",         "foward",        "forward,,",
                                           "forward,", "layout=lean,x", "shadows=off,exposure=x",
                                           ",forward"};
    for (u32 i = 0; i < COUNT_OF(mistakes); i++) {
        assert_false(settings_set_list(&s, mistakes[i]));
        assert_memory_equal(&s, &before, sizeof s); // also when an earlier word was right
    }
}

static bool has_effect(const RenderSettings *settings, const char *name) {
    for (u32 i = 0; i < render_setting_count; i++)
        if (strcmp(render_setting_descs[i].name, name) == 0)
            return setting_has_effect(settings, &render_setting_descs[i]);
    fail_msg("no setting %s", name);
    return false;
}

TEST(frame_settings, effect_depends_on_the_path) {
    RenderSettings s = settings_default();
    assert_true(settings_set_list(&s, "forward"));
    assert_true(has_effect(&s, "msaa") && has_effect(&s, "exposure") && has_effect(&s, "merge"));
    assert_false(has_effect(&s, "layout") || has_effect(&s, "tile_px") ||
                 has_effect(&s, "light_scissor") || has_effect(&s, "clusters"));
    assert_true(settings_set_list(&s, "deferred_volumes,manager=off"));
    assert_true(has_effect(&s, "light_scissor") && has_effect(&s, "layout"));
    assert_false(has_effect(&s, "msaa") || has_effect(&s, "merge"));
    assert_true(settings_set_list(&s, "clustered_forward,clusters=gpu"));
    assert_true(has_effect(&s, "cluster_normals") && has_effect(&s, "tile_px"));
    assert_false(has_effect(&s, "grid"));
    for (u32 i = 0; i < render_setting_count; i++)
        assert_in_range(render_setting_descs[i].group, 0, SETTING_GROUP_COUNT - 1);
}
