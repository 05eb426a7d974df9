// frame_settings.c: the text form of settings, and what a stranger's settings become.
#include "../test.h"
#include "../../engine/base/log.h"
#include "../../engine/base/random.h"
#include "../../engine/frame/settings.h"
#include "../../engine/world/components.h"
#include <stdio.h>
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

// ---- global illumination ----

static const SettingDesc *find(const char *name) {
    for (u32 i = 0; i < render_setting_count; i++)
        if (strcmp(render_setting_descs[i].name, name) == 0) return &render_setting_descs[i];
    fail_msg("no setting %s", name);
    return NULL;
}

// The range in GI_PARAMS is the column's.
static void check_range(const char *name, f64 low, f64 high) {
    for (u32 i = 0; i < gi_component.column_count; i++) {
        const ColumnDesc *column = &gi_component.columns[i];
        if (strcmp(column->name, name) != 0) continue;
        assert_true(column->min == low && column->max == high);
        return;
    }
    fail_msg("no column %s", name);
}

// Settings "gi.NAME" and the component's columns: the same names, words and ranges.
TEST(frame_settings, gi_settings_are_the_components_columns) {
    u32 shared = 0;
    for (u32 i = 0; i < gi_component.column_count; i++) {
        const ColumnDesc *column = &gi_component.columns[i];
        if (strncmp(column->key, "size", 4) == 0 || strncmp(column->key, "center", 6) == 0)
            continue; // the box is the level's alone
        char name[64], words[128];
        snprintf(name, sizeof name, "gi.%s", column->name);
        const SettingDesc *setting = find(name);
        assert_string_equal(column->key, column->name);
        assert_int_equal(setting->group, SETTING_GROUP_GI);
        shared++;
        switch (column->type) {
        case COLUMN_BOOL:
            assert_string_equal(setting->words, "level off on");
            assert_true(setting->max == 2);
            break;
        case COLUMN_ENUM:
            snprintf(words, sizeof words, "level %s", column->unit);
            assert_string_equal(setting->words, words);
            assert_true(setting->max == column->max + 1);
            break;
        case COLUMN_U32:
            assert_true(setting->type == SETTING_U32 && setting->min == 0);
            assert_true(setting->max == column->max && column->min >= 1);
            break;
        default:
            assert_true(column->type == COLUMN_F32 && setting->type == SETTING_F32);
            assert_true(setting->min == -1 && setting->max == column->max && column->min >= 0);
        }
    }
    assert_int_equal(shared * 4, sizeof(GiParams));
#define B(name)               assert_int_equal(find("gi." #name)->max, 2);
#define E(name, words, count) assert_int_equal(find("gi." #name)->max, count);
#define U(name, low, high)    check_range(#name, low, high);
#define F(name, low, high)    check_range(#name, low, high);
    GI_PARAMS(B, E, U, F)
#undef B
#undef E
#undef U
#undef F
}

TEST(frame_settings, gi_texts) {
    RenderSettings s = settings_default(), before = s;
    assert_true(settings_set_list(&s, "gi.enabled=on,gi.grid=256,gi.strength=2.5,gi.bounces=1"));
    assert_true(s.gi_enabled == 2 && s.gi_grid == 4 && s.gi_strength == 2.5f && s.gi_bounces == 1);
    char text[64];
    assert_string_equal(setting_text(&s, find("gi.grid"), text, sizeof text), "256");
    assert_string_equal(setting_text(&s, find("gi.enabled"), text, sizeof text), "on");
    assert_string_equal(setting_text(&s, find("gi.diffuse"), text, sizeof text), "level");
    // What is printed can be read.
    for (u32 i = 0; i < render_setting_count; i++) {
        char line[128];
        snprintf(line, sizeof line, "%s=%s", render_setting_descs[i].name,
                 setting_text(&s, &render_setting_descs[i], text, sizeof text));
        assert_true(settings_set(&before, line));
    }
    assert_memory_equal(&before, &s, sizeof s);
    static const char *const mistakes[][2] = {
        {"gi.gird=64", "'gi.grid'"},       {"gi.grid=63", "'64'"},
        {"gi.diffuse=conse", "'cones'"},    {"gi.bounces=3", "0 to 2"},
        {"gi.step_factor=9", "-1 to 2.5"}, {"gi.show=radience", "'radiance'"}};
    log_set_sink(keep_text, NULL);
    for (u32 i = 0; i < COUNT_OF(mistakes); i++) {
        assert_false(settings_set(&s, mistakes[i][0]));
        if (!strstr(last_text, mistakes[i][1]))
            fail_msg("'%s' gave: %s", mistakes[i][0], last_text);
    }
    log_set_sink(NULL, NULL);
}

// A preset replaces another whole, whatever came before.
TEST(frame_settings, presets) {
    RenderSettings s = settings_default();
    assert_true(settings_set_preset(&s, "thesis"));
    assert_true(s.gi_grid == 2 && s.gi_faces == 1 + GI_FACES_SHARED && s.gi_step_factor == 0.5f);
    assert_true(s.gi_resolution == 1 + GI_RESOLUTION_FULL && s.gi_diffuse_aperture == 60);
    assert_int_equal(s.gi_enabled, 0); // the level's
    static const char *const wanted[] = {"lavapipe", "balanced", "high", "thesis"};
    for (u32 i = 0; i < COUNT_OF(wanted); i++) {
        RenderSettings alone = settings_default(), after = settings_default();
        assert_true(settings_set_preset(&alone, wanted[i]));
        for (u32 k = 0; k < setting_preset_count; k++)
            assert_true(settings_set_preset(&after, setting_presets[k].name));
        assert_true(settings_set_preset(&after, wanted[i]));
        if (memcmp(&alone, &after, sizeof alone) != 0) fail_msg("'%s' names less", wanted[i]);
    }
    RenderSettings before = s;
    log_set_sink(keep_text, NULL);
    assert_false(settings_set_preset(&s, "thesys"));
    assert_non_null(strstr(last_text, "'thesis'"));
    assert_false(settings_set_preset(&s, "qwertyuiop"));
    assert_non_null(strstr(last_text, "balanced"));
    assert_memory_equal(&s, &before, sizeof s);
    log_set_sink(NULL, NULL);
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
    // Without a word from the settings the level may have GI.
    assert_true(has_effect(&s, "gi.grid") && has_effect(&s, "gi.share"));
    assert_false(has_effect(&s, "gi.show"));
    assert_true(settings_set_list(&s, "gi.enabled=on,view=gi_voxels,gi.diffuse=cones"));
    assert_true(has_effect(&s, "gi.show") && has_effect(&s, "gi.bounces"));
    assert_false(has_effect(&s, "gi.share"));
    assert_true(settings_set(&s, "gi.enabled=off"));
    assert_true(has_effect(&s, "gi.enabled"));
    assert_false(has_effect(&s, "gi.show") || has_effect(&s, "gi.bounces"));
    for (u32 i = 0; i < render_setting_count; i++)
        assert_in_range(render_setting_descs[i].group, 0, SETTING_GROUP_COUNT - 1);
}
