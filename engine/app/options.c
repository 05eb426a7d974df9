// options.c: the command line of a luz program: one table of option, argument, help, effect.
//
// Data in: argc, argv. Data out: an AppDesc. Called by: luz.c. Does not: open anything.
#include "options.h"
#include "../base/log.h"
#include "../level/suggest.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum OptionKind {
    OPTION_FLAG,   // sets a bool
    OPTION_TEXT,   // sets a const char *
    OPTION_COUNT,  // sets a u32
    OPTION_NUMBER, // sets an f32
    OPTION_SIZE,   // WxH
    OPTION_SET,    // key=value of the render settings
    OPTION_PRESET, // several of them by a name
    OPTION_SPLIT,  // two words
    OPTION_HELP,
} OptionKind;

typedef struct Option {
    const char *name, *argument, *help;
    OptionKind kind;
    u32 offset; // of the field in AppDesc
} Option;

#define FIELD(name) (u32) offsetof(AppDesc, name)
static const Option options_table[] = {
    {"--level", "PATH", "level to play (.toml, .gltf, .glb)", OPTION_TEXT, FIELD(level)},
    {"--size", "WxH", "size of the window or of the pictures", OPTION_SIZE, 0},
    {"--fullscreen", NULL, "whole screen (F11 toggles)", OPTION_FLAG, FIELD(fullscreen)},
    {"--headless", NULL, "no window: a tour of the cameras as pictures", OPTION_FLAG,
     FIELD(headless)},
    {"--camera", "NAME", "camera to look through", OPTION_TEXT, FIELD(camera)},
    {"--out", "DIR", "where pictures and recordings go (default: out)", OPTION_TEXT,
     FIELD(out_directory)},
    {"--seconds", "N", "end after N seconds", OPTION_NUMBER, FIELD(seconds)},
    {"--threads", "N", "threads for systems (default: all cores)", OPTION_COUNT, FIELD(threads)},
    {"--device", "NAME", "part of a device's name, e.g. llvmpipe", OPTION_TEXT, FIELD(device)},
    {"--validation", NULL, "check every Vulkan call", OPTION_FLAG, FIELD(validation)},
    {"--preset", "NAME", "settings by a name (below); a later --set changes them", OPTION_PRESET,
     0},
    {"--set", "KEY=VALUE", "a setting (below); may be given often", OPTION_SET, 0},
    {"--split", "A B", "draw two ways beside each other: forward deferred,layout=packed",
     OPTION_SPLIT, 0},
    {"--record", "FILE", "record from the first tick on", OPTION_TEXT, FIELD(record_path)},
    {"--replay", "FILE", "play a recording, check every tick", OPTION_TEXT, FIELD(replay_path)},
    {"--fixed", NULL, "one tick a frame, whatever the clock says", OPTION_FLAG, FIELD(fixed_step)},
    {"--panel", NULL, "open the debug panel", OPTION_FLAG, FIELD(panel)},
    {"--status", "FILE", "one line of JSON about the game, every second", OPTION_TEXT,
     FIELD(status_path)},
    {"--help", NULL, "this text", OPTION_HELP, 0},
};

static void print_setting(const SettingDesc *setting) {
    printf("  %-18s %s", setting->name, setting->help);
    if (setting->type == SETTING_ENUM)
        printf(" (%s)", setting->words);
    else if (setting->type != SETTING_BOOL)
        printf(" (%g .. %g)", setting->min, setting->max);
    printf("\n");
}

static void print_help(const char *program, const AppDesc *desc) {
    printf("%s\nusage: %s [options] [level]\n\n", desc->title ? desc->title : "luz", program);
    for (u32 i = 0; i < COUNT_OF(options_table); i++) {
        const Option *option = &options_table[i];
        char left[40];
        snprintf(left, sizeof left, "%s %s", option->name,
                 option->argument ? option->argument : "");
        printf("  %-18s %s\n", left, option->help);
    }
    if (desc->help) printf("%s\n", desc->help);
    printf("\npresets for --preset:\n");
    for (u32 i = 0; i < setting_preset_count; i++)
        printf("  %-18s %s\n", setting_presets[i].name, setting_presets[i].help);
    printf("\nsettings for --set:\n");
    for (u32 group = 0; group < SETTING_GROUP_COUNT; group++) {
        printf(" %s\n", setting_group_titles[group]);
        for (u32 i = 0; i < render_setting_count; i++)
            if ((u32)render_setting_descs[i].group == group)
                print_setting(&render_setting_descs[i]);
    }
    printf("\nIn the window, H lists the keys.\n");
}

static int report_unknown(const char *word) {
    char hint[128];
    Suggestion suggestion = suggest_begin(word);
    for (u32 i = 0; i < COUNT_OF(options_table); i++)
        suggest_offer(&suggestion, options_table[i].name);
    suggest_hint(&suggestion, hint, sizeof hint);
    LOG(USAGE, "unknown option '%s'; %s", word, hint[0] ? hint : "--help lists them");
    return 2;
}

// The whole text must be a number in the range.
static bool parse_number(const char *text, f64 min, f64 max, f64 *out) {
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && *out >= min && *out <= max;
}

static bool parse_size(const char *text, AppDesc *desc) {
    unsigned width, height;
    char rest;
    if (sscanf(text, "%ux%u%c", &width, &height, &rest) != 2) return false;
    if (width < APP_SIDE_MIN_PX || height < APP_SIDE_MIN_PX) return false;
    if (width > PACKET_SIDE_MAX || height > PACKET_SIDE_MAX) return false;
    desc->width_px = width;
    desc->height_px = height;
    return true;
}

// False: `value` makes no sense.
static bool apply_option(const Option *option, const char *value, AppDesc *desc,
                         AppOptions *options) {
    void *field = (u8 *)desc + option->offset;
    f64 number = 0.0;
    switch (option->kind) {
    case OPTION_FLAG:
        *(bool *)field = true;
        return true;
    case OPTION_TEXT:
        *(const char **)field = value;
        return true;
    case OPTION_COUNT:
        if (!parse_number(value, 0.0, 1e6, &number) || number != (f64)(u32)number) return false;
        *(u32 *)field = (u32)number;
        return true;
    case OPTION_NUMBER:
        if (!parse_number(value, 0.0, 1e6, &number)) return false;
        *(f32 *)field = (f32)number;
        return true;
    case OPTION_SIZE:
        return parse_size(value, desc);
    case OPTION_SET:
        desc->fixed_resolution |= strncmp(value, "scale=", 6) == 0;
        desc->fixed_resolution |= strncmp(value, "target_ms=", 10) == 0;
        return settings_set(&options->settings, value);
    case OPTION_PRESET:
        return settings_set_preset(&options->settings, value);
    case OPTION_SPLIT: // its words are read when all settings are known
    case OPTION_HELP:
        break;
    }
    return true;
}

// A over the settings, B beside them; they can differ in all but the resolution.
static bool apply_split(const char *const ways[2], AppDesc *desc, AppOptions *options) {
    options->split = options->settings;
    f32 scale = options->settings.scale, target_ms = options->settings.target_ms;
    if (!settings_set_list(&options->settings, ways[0]) ||
        !settings_set_list(&options->split, ways[1]))
        return false;
    if (options->settings.scale != scale || options->split.scale != scale ||
        options->settings.target_ms != target_ms || options->split.target_ms != target_ms) {
        LOG(USAGE, "--split: both ways have one size; give scale and target_ms with --set");
        return false;
    }
    desc->split = &options->split;
    return true;
}

int app_parse_options(int argc, char **argv, AppDesc *desc, AppOptions *options) {
    options->settings = desc->settings ? *desc->settings : settings_default();
    desc->settings = &options->settings;
    const char *ways[2] = {0};
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        if (word[0] != '-') {
            desc->level = word;
            continue;
        }
        // Both "--size 640x360" and "--size=640x360".
        u64 length = strcspn(word, "=");
        const Option *option = NULL;
        for (u32 j = 0; j < COUNT_OF(options_table) && !option; j++)
            if (strlen(options_table[j].name) == length &&
                strncmp(options_table[j].name, word, length) == 0)
                option = &options_table[j];
        if (!option && strcmp(word, "-h") == 0)
            option = &options_table[COUNT_OF(options_table) - 1];
        if (!option) return report_unknown(word);
        if (option->kind == OPTION_HELP) {
            print_help(argv[0], desc);
            return 0;
        }
        const char *value = NULL;
        if (option->argument && word[length] == '=')
            value = word + length + 1;
        else if (option->argument && i + 1 < argc)
            value = argv[++i];
        if (option->argument && !value) {
            LOG(USAGE, "%s needs %s: %s", option->name, option->argument, option->help);
            return 2;
        }
        if (option->kind == OPTION_SPLIT) {
            if (i + 1 >= argc) {
                LOG(USAGE, "%s needs %s: %s", option->name, option->argument, option->help);
                return 2;
            }
            ways[0] = value;
            ways[1] = argv[++i];
        }
        if (!apply_option(option, value, desc, options)) {
            LOG(USAGE, "%s %s makes no sense: %s", option->name, value, option->help);
            return 2;
        }
    }
    return ways[0] && !apply_split(ways, desc, options) ? 2 : OPTIONS_GO_ON;
}
