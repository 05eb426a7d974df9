// settings.c: the table of render settings and its text form.
// Data in: "key=value" texts from the command line, the panel and captures.
// Data out: a RenderSettings whose every value is in range. Called by: shells, tools, packet_build
// and packet_validate; any thread (no state). Does not: act on a setting; that is the renderer's.
#include "settings.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const SettingDesc render_setting_descs[] = {
#define ROW(key, field, type, group, initial, min, max, words, help)                               \
    {key,                                                                                          \
     words,                                                                                        \
     help,                                                                                         \
     SETTING_##type,                                                                               \
     SETTING_GROUP_##group,                                                                        \
     initial,                                                                                      \
     min,                                                                                          \
     max,                                                                                          \
     offsetof(RenderSettings, field)},
#define S(type, name, ...) ROW(#name, name, type, __VA_ARGS__)
    RENDER_SETTINGS(S)
#undef S
#define S(type, name, ...) ROW("gi." #name, gi_##name, type, __VA_ARGS__)
        GI_SETTINGS(S)
#undef S
// Parameters of the level: the words after "level" are the level's.
#define GI_HELP        "overrules the level's value; level = does not"
#define GI_HELP_NUMBER "overrules the level's value; below the level's range = does not"
#define B(name)        ROW("gi." #name, gi_##name, ENUM, GI, 0, 0, 2, "level off on", GI_HELP)
#define E(name, words, count)                                                                      \
    ROW("gi." #name, gi_##name, ENUM, GI, 0, 0, count, "level " words, GI_HELP)
#define U(name, min, max) ROW("gi." #name, gi_##name, U32, GI, 0, 0, max, "", GI_HELP_NUMBER)
#define F(name, min, max) ROW("gi." #name, gi_##name, F32, GI, -1, -1, max, "", GI_HELP_NUMBER)
            GI_PARAMS(B, E, U, F)
#undef B
#undef E
#undef U
#undef F
#undef ROW
};
const char *const setting_group_titles[SETTING_GROUP_COUNT] = {
#define X(id, title) title,
    SETTING_GROUPS(X)
#undef X
};
const u32 render_setting_count = COUNT_OF(render_setting_descs);

#define NAME_CAP 64 // longest key or word that is compared

// One setting's bits: f32 or u32 by type.
static void setting_write(RenderSettings *settings, const SettingDesc *desc, f64 value) {
    u8 *field = (u8 *)settings + desc->offset;
    if (desc->type == SETTING_F32) {
        f32 number = (f32)value;
        memcpy(field, &number, sizeof number);
    } else {
        u32 number = (u32)value;
        memcpy(field, &number, sizeof number);
    }
}

static f64 setting_read(const RenderSettings *settings, const SettingDesc *desc) {
    const u8 *field = (const u8 *)settings + desc->offset;
    if (desc->type == SETTING_F32) {
        f32 number;
        memcpy(&number, field, sizeof number);
        return number;
    }
    u32 number;
    memcpy(&number, field, sizeof number);
    return number;
}

u64 settings_switches_hash(const RenderSettings *settings) {
    u64 hash = 0;
    for (u32 i = 0; i < render_setting_count; i++) {
        const SettingDesc *desc = &render_setting_descs[i];
        bool is_count = desc->type == SETTING_U32 && desc->group == SETTING_GROUP_GI;
        if (desc->type != SETTING_BOOL && desc->type != SETTING_ENUM && !is_count) continue;
        hash = hash_bytes((const u8 *)settings + desc->offset, sizeof(u32), hash);
    }
    return hash;
}

RenderSettings settings_default(void) {
    RenderSettings settings = {0};
    for (u32 i = 0; i < render_setting_count; i++)
        setting_write(&settings, &render_setting_descs[i], render_setting_descs[i].initial);
    return settings;
}

void settings_clamp(RenderSettings *settings) {
    for (u32 i = 0; i < render_setting_count; i++) {
        const SettingDesc *desc = &render_setting_descs[i];
        f64 value = setting_read(settings, desc);
        if (!(value == value)) value = desc->initial; // NaN
        setting_write(settings, desc, CLAMP(value, desc->min, desc->max));
    }
}

// ---- words and suggestions ----

// The next of the words separated by blanks; returns its length (0 = no more).
static u32 next_word(const char **cursor, const char **word) {
    const char *text = *cursor;
    while (*text == ' ') text++;
    *word = text;
    while (*text && *text != ' ') text++;
    *cursor = text;
    return (u32)(text - *word);
}

// Number of single-character edits between two texts, a swap of neighbours counting as one
// (optimal string alignment distance, Damerau 1964). Longer than NAME_CAP counts as far away.
static u32 edit_distance(const char *a, u32 a_length, const char *b, u32 b_length) {
    if (a_length >= NAME_CAP || b_length >= NAME_CAP) return UINT32_MAX;
    u32 rows[3][NAME_CAP + 1];
    for (u32 j = 0; j <= b_length; j++) rows[0][j] = j;
    for (u32 i = 1; i <= a_length; i++) {
        u32 *row = rows[i % 3], *above = rows[(i - 1) % 3], *two_above = rows[(i + 1) % 3];
        row[0] = i;
        for (u32 j = 1; j <= b_length; j++) {
            u32 best = above[j - 1] + (a[i - 1] != b[j - 1]);
            best = MIN(best, above[j] + 1);
            best = MIN(best, row[j - 1] + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                best = MIN(best, two_above[j - 2] + 1);
            row[j] = best;
        }
    }
    return rows[a_length % 3][b_length];
}

// Keeps the nearest candidate; a third of the letters may be wrong before it is no help.
typedef struct Suggestion {
    char name[NAME_CAP];
    u32 distance;
} Suggestion;

static void suggestion_offer(Suggestion *best, const char *typed, u32 typed_length,
                             const char *name, u32 name_length) {
    if (name_length >= NAME_CAP) return;
    u32 distance = edit_distance(typed, typed_length, name, name_length);
    if (distance >= best->distance || distance > MAX(typed_length, name_length) / 3 + 1) return;
    memcpy(best->name, name, name_length);
    best->name[name_length] = 0;
    best->distance = distance;
}

// ---- text to value ----

static bool parse_enum(const SettingDesc *desc, const char *text, f64 *value) {
    Suggestion best = {.distance = UINT32_MAX};
    const char *cursor = desc->words, *word;
    u32 length, text_length = (u32)strnlen(text, NAME_CAP);
    for (u32 index = 0; (length = next_word(&cursor, &word)) > 0; index++) {
        if (length == text_length && memcmp(word, text, length) == 0) {
            *value = index;
            return true;
        }
        suggestion_offer(&best, text, text_length, word, length);
    }
    if (best.distance != UINT32_MAX)
        LOG(RENDER_SETTING, "setting '%s' has no value '%.64s'; did you mean '%s'?", desc->name,
            text, best.name);
    else
        LOG(RENDER_SETTING, "setting '%s' has no value '%.64s'; it can be: %s", desc->name, text,
            desc->words);
    return false;
}

static bool parse_bool(const SettingDesc *desc, const char *text, f64 *value) {
    static const char *const words[] = {"false", "true", "off", "on", "0", "1", "no", "yes"};
    for (u32 i = 0; i < COUNT_OF(words); i++) {
        if (strcmp(text, words[i]) != 0) continue;
        *value = i & 1;
        return true;
    }
    LOG(RENDER_SETTING, "setting '%s' is true or false, not '%.64s'", desc->name, text);
    return false;
}

static bool parse_number(const SettingDesc *desc, const char *text, f64 *value) {
    char *end;
    f64 number = strtod(text, &end);
    bool whole = desc->type != SETTING_U32 || (number == floor(number));
    // strtod also takes blanks in front, hexadecimal, "nan" and "inf": the first character and the
    // range check leave only what a person means by a number.
    bool starts = (*text >= '0' && *text <= '9') || *text == '.' || *text == '-' || *text == '+';
    if (!starts || end == text || *end || !whole) {
        LOG(RENDER_SETTING, "setting '%s' needs %s number, not '%.64s'", desc->name,
            desc->type == SETTING_U32 ? "a whole" : "a", text);
        return false;
    }
    if (!(number >= desc->min && number <= desc->max)) {
        LOG(RENDER_SETTING, "setting '%s' goes from %g to %g, not '%.64s'", desc->name, desc->min,
            desc->max, text);
        return false;
    }
    *value = number;
    return true;
}

static const SettingDesc *find_setting(const char *key, u32 key_length) {
    Suggestion best = {.distance = UINT32_MAX};
    for (u32 i = 0; i < render_setting_count; i++) {
        const char *name = render_setting_descs[i].name;
        u32 length = (u32)strlen(name);
        if (length == key_length && memcmp(name, key, length) == 0) return &render_setting_descs[i];
        suggestion_offer(&best, key, key_length, name, length);
    }
    int shown = (int)MIN(key_length, NAME_CAP);
    if (best.distance != UINT32_MAX)
        LOG(RENDER_SETTING, "unknown setting '%.*s'; did you mean '%s'?", shown, key, best.name);
    else
        LOG(RENDER_SETTING, "unknown setting '%.*s'", shown, key);
    return NULL;
}

bool settings_set(RenderSettings *settings, const char *key_equals_value) {
    const char *equals = strchr(key_equals_value, '=');
    if (!equals) {
        LOG(RENDER_SETTING, "'%.64s' is not of the form key=value", key_equals_value);
        return false;
    }
    u64 key_length = (u64)(equals - key_equals_value);
    const SettingDesc *desc = find_setting(key_equals_value, (u32)MIN(key_length, UINT32_MAX));
    if (!desc) return false;
    const char *text = equals + 1;
    f64 value = 0;
    bool known = false;
    switch (desc->type) {
    case SETTING_ENUM:
        known = parse_enum(desc, text, &value);
        break;
    case SETTING_BOOL:
        known = parse_bool(desc, text, &value);
        break;
    case SETTING_F32:
    case SETTING_U32:
        known = parse_number(desc, text, &value);
        break;
    }
    if (known) setting_write(settings, desc, value);
    return known;
}

bool settings_set_list(RenderSettings *settings, const char *list) {
    RenderSettings changed = *settings;
    while (true) {
        u32 length = (u32)strcspn(list, ",");
        char item[NAME_CAP * 2];
        if (length >= sizeof item - 5) {
            LOG(RENDER_SETTING, "'%.64s' is too long for a setting", list);
            return false;
        }
        bool bare = !memchr(list, '=', length);
        snprintf(item, sizeof item, "%s%.*s", bare ? "path=" : "", (int)length, list);
        if (!settings_set(&changed, item)) return false;
        if (!list[length]) break;
        list += length + 1;
    }
    *settings = changed;
    return true;
}

bool settings_set_preset(RenderSettings *settings, const char *name) {
    Suggestion best = {.distance = UINT32_MAX};
    u32 length = (u32)strnlen(name, NAME_CAP);
    for (u32 i = 0; i < setting_preset_count; i++) {
        const SettingPreset *preset = &setting_presets[i];
        if (strcmp(preset->name, name) == 0) return settings_set_list(settings, preset->list);
        suggestion_offer(&best, name, length, preset->name, (u32)strlen(preset->name));
    }
    char names[NAME_CAP * 4] = "";
    for (u32 i = 0; i < setting_preset_count; i++) {
        u64 used = strlen(names);
        snprintf(names + used, sizeof names - used, " %s", setting_presets[i].name);
    }
    if (best.distance != UINT32_MAX)
        LOG(RENDER_SETTING, "unknown preset '%.64s'; did you mean '%s'?", name, best.name);
    else
        LOG(RENDER_SETTING, "unknown preset '%.64s'; there are:%s", name, names);
    return false;
}

// ---- effect ----

// States of the other settings that give a setting something to do.
enum {
    WHEN_DEFERRED = 1 << 0,
    WHEN_FORWARD = 1 << 1,
    WHEN_MANAGED = 1 << 2,
    WHEN_TILED = 1 << 3,
    WHEN_CLUSTERED = 1 << 4,
    WHEN_CLUSTERED_ON_GPU = 1 << 5,
    WHEN_TILED_DEFERRED = 1 << 6,
    WHEN_VOLUMES = 1 << 7,
    WHEN_PACKED = 1 << 8,
    WHEN_GI = 1 << 9, // or where the level may have it
    WHEN_GI_VOXELS = 1 << 10,
    WHEN_GI_BYTE = 1 << 11,
    WHEN_GI_PROBES = 1 << 12,
    WHEN_GI_EVERY_N = 1 << 13,
};

// Off for sure, or another word than the level's (0) and this one.
static bool gi_is_off(const RenderSettings *s) { return s->gi_enabled == 1; }
static bool word_may_be(u32 setting, u32 word) { return setting == 0 || setting == 1 + word; }

bool setting_has_effect(const RenderSettings *s, const SettingDesc *desc) {
#define ROW(name, when)                                                                            \
    { (u32) offsetof(RenderSettings, name), when }
    // Those that are not here always have.
    static const u32 rows[][2] = {
        ROW(layout, WHEN_DEFERRED),
        ROW(msaa, WHEN_FORWARD),
        ROW(vertex_lighting, WHEN_FORWARD),
        ROW(light_culling, WHEN_MANAGED),
        ROW(occlusion, WHEN_MANAGED),
        ROW(merge, WHEN_MANAGED),
        ROW(drop, WHEN_MANAGED),
        ROW(light_lod, WHEN_MANAGED),
        ROW(budget, WHEN_MANAGED),
        ROW(grid, WHEN_TILED),
        ROW(tile_depth, WHEN_TILED),
        ROW(tile_px, WHEN_TILED | WHEN_CLUSTERED),
        ROW(subgroup_cull, WHEN_TILED_DEFERRED),
        ROW(clusters, WHEN_CLUSTERED),
        ROW(cluster_normals, WHEN_CLUSTERED_ON_GPU),
        ROW(light_scissor, WHEN_VOLUMES),
        ROW(light_volume, WHEN_VOLUMES),
        ROW(light_branch, WHEN_VOLUMES),
        ROW(normal_lookup, WHEN_PACKED),
        ROW(gi_enabled, WHEN_DEFERRED | WHEN_FORWARD),
        ROW(gi_show, WHEN_GI_VOXELS),
        ROW(gi_show_level, WHEN_GI_VOXELS),
        ROW(gi_show_direction, WHEN_GI_VOXELS),
        ROW(gi_byte_radiance, WHEN_GI_BYTE),
        ROW(gi_share, WHEN_GI_PROBES),
        ROW(gi_probe_spacing, WHEN_GI_PROBES),
        ROW(gi_every_n, WHEN_GI_EVERY_N),
    };
#undef ROW
    bool deferred = s->path == PATH_DEFERRED || s->path == PATH_DEFERRED_VOLUMES ||
                    s->path == PATH_TILED_DEFERRED || s->path == PATH_CLUSTERED_DEFERRED;
    bool packed = s->layout == LAYOUT_PACKED || s->layout == LAYOUT_PACKED24;
    u32 state = deferred ? WHEN_DEFERRED : WHEN_FORWARD;
    if (s->manager) state |= WHEN_MANAGED;
    if (settings_tiled(s)) state |= WHEN_TILED;
    if (settings_clustered(s)) state |= WHEN_CLUSTERED;
    if (settings_clustered(s) && s->clusters == CLUSTERS_GPU) state |= WHEN_CLUSTERED_ON_GPU;
    if (s->path == PATH_TILED_DEFERRED) state |= WHEN_TILED_DEFERRED;
    if (s->path == PATH_DEFERRED_VOLUMES) state |= WHEN_VOLUMES;
    if (deferred && packed) state |= WHEN_PACKED;
    if (!gi_is_off(s)) {
        state |= WHEN_GI;
        if (s->view == VIEW_GI_VOXELS) state |= WHEN_GI_VOXELS;
        if (word_may_be(s->gi_format, GI_FORMAT_BYTE)) state |= WHEN_GI_BYTE;
        if (word_may_be(s->gi_diffuse, GI_DIFFUSE_PROBES)) state |= WHEN_GI_PROBES;
        if (word_may_be(s->gi_policy, GI_POLICY_EVERY_N)) state |= WHEN_GI_EVERY_N;
    }
    for (u32 i = 0; i < COUNT_OF(rows); i++)
        if (rows[i][0] == desc->offset) return (state & rows[i][1]) != 0;
    if (desc->group == SETTING_GROUP_GI) return (state & WHEN_GI) != 0;
    return true;
}

const char *settings_word(const char *name, u32 value, char *out, u64 out_cap) {
    if (out_cap == 0) return "";
    out[0] = 0;
    for (u32 i = 0; i < render_setting_count; i++) {
        const SettingDesc *desc = &render_setting_descs[i];
        if (desc->type != SETTING_ENUM || strcmp(desc->name, name) != 0) continue;
        const char *cursor = desc->words, *word;
        u32 length;
        for (u32 index = 0; (length = next_word(&cursor, &word)) > 0; index++)
            if (index == value) snprintf(out, out_cap, "%.*s", (int)length, word);
    }
    return out;
}

const char *setting_text(const RenderSettings *settings, const SettingDesc *desc, char *out,
                         u64 out_cap) {
    f64 value = setting_read(settings, desc);
    if (desc->type == SETTING_ENUM) return settings_word(desc->name, (u32)value, out, out_cap);
    if (desc->type == SETTING_BOOL)
        snprintf(out, out_cap, "%s", value != 0.0 ? "on" : "off");
    else
        snprintf(out, out_cap, "%.6g", value);
    return out;
}
