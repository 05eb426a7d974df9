// level_values.c: one node of level text to the 4-byte values of columns, with every check.
// Data in: a node, and the key it stands for (type, unit, range from the column description). Data
// out: a LevelValue, or a diagnostic at the node's place. Called by the readers of components, vary
// and materials. Does not: write to the world; names stay references until all entities are there.
#include "level_internal.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static u32 bits_of_f32(f32 value) {
    u32 bits;
    memcpy(&bits, &value, 4);
    return bits;
}

static bool expect(LevelReader *reader, const TomlNode *node, const char *label, TomlType type,
                   const char *what) {
    if (node->type == type) return true;
    level_error(reader, node->place, NULL, "%s: expected %s, got %s", label, what,
                toml_type_name(node->type));
    return false;
}

bool level_is_table(LevelReader *reader, const TomlNode *node, const char *label) {
    if (node->type == TOML_TABLE) return true;
    char hint[160];
    snprintf(hint, sizeof hint, "write '%s = {}' for one with all defaults", label);
    level_error(reader, node->place, node->type == TOML_BOOLEAN ? hint : NULL,
                "%s: expected a table, got %s", label, toml_type_name(node->type));
    return false;
}

bool level_is_table_list(LevelReader *reader, const TomlNode *node, const char *label) {
    if (node->type != TOML_ARRAY) {
        char hint[160];
        snprintf(hint, sizeof hint, "write '[[%s]]' before each one", label);
        level_error(reader, node->key_place, hint, "%s: expected a list of tables, got %s", label,
                    toml_type_name(node->type));
        return false;
    }
    bool is_good = true;
    for (const TomlNode *element = node->first; element; element = element->next)
        is_good &= expect(reader, element, label, TOML_TABLE, "a table");
    return is_good;
}

// The range is checked in the column's own precision, so that what level_write prints for a value
// on the border is inside.
static bool check_range(LevelReader *reader, const TomlNode *node, const char *label, f64 value,
                        f64 min, f64 max, bool is_f32) {
    bool is_inside =
        is_f32 ? (f32)value >= (f32)min && (f32)value <= (f32)max : value >= min && value <= max;
    if (is_inside) return true;
    level_error(reader, node->place, NULL, "%s: %.9g is out of range %g to %g", label, value, min,
                max);
    return false;
}

static bool read_finite(LevelReader *reader, const TomlNode *node, const char *label, f64 *out) {
    if (node->type == TOML_INTEGER) {
        *out = (f64)node->integer;
        return true;
    }
    if (!expect(reader, node, label, TOML_FLOAT, "a number")) return false;
    *out = node->number;
    if (isfinite((f32)*out)) return true;
    level_error(reader, node->place, NULL, "%s: the number is not finite", label);
    return false;
}

bool level_read_number(LevelReader *reader, const TomlNode *node, const char *label, f64 min,
                       f64 max, f64 *out) {
    return read_finite(reader, node, label, out) &&
           check_range(reader, node, label, *out, min, max, true);
}

bool level_read_integer(LevelReader *reader, const TomlNode *node, const char *label, i64 min,
                        i64 max, i64 *out) {
    if (!expect(reader, node, label, TOML_INTEGER, "an integer")) return false;
    *out = node->integer;
    if (*out >= min && *out <= max) return true;
    level_error(reader, node->place, NULL, "%s: %lld is out of range %lld to %lld", label,
                (long long)*out, (long long)min, (long long)max);
    return false;
}

bool level_read_bool(LevelReader *reader, const TomlNode *node, const char *label, bool *out) {
    if (!expect(reader, node, label, TOML_BOOLEAN, "true or false")) return false;
    *out = node->boolean;
    return true;
}

bool level_read_string(LevelReader *reader, const TomlNode *node, const char *label,
                       const char **out) {
    if (!expect(reader, node, label, TOML_STRING, "a string")) return false;
    *out = node->string;
    return true;
}

bool level_read_vec3(LevelReader *reader, const TomlNode *node, const char *label, f64 limit,
                     Vec3 *out) {
    if (!expect(reader, node, label, TOML_ARRAY, "a list of 3 numbers")) return false;
    if (node->count != 3) {
        level_error(reader, node->place, NULL, "%s: expected 3 numbers, got %u", label,
                    node->count);
        return false;
    }
    f64 v[3];
    u32 i = 0;
    bool is_good = true;
    for (const TomlNode *element = node->first; element; element = element->next)
        is_good &= level_read_number(reader, element, label, -limit, limit, &v[i++]);
    if (is_good) *out = vec3((f32)v[0], (f32)v[1], (f32)v[2]);
    return is_good;
}

bool level_read_name(LevelReader *reader, const TomlNode *node, const char *label,
                     const char **out) {
    const char *name;
    if (!level_read_string(reader, node, label, &name)) return false;
    u64 size = strlen(name);
    // A model's material has the names of both.
    u64 max = strchr(name, '/') ? LEVEL_NAME_MAX * 2 + 1 : LEVEL_NAME_MAX;
    const char *problem = size == 0                 ? "must not be empty"
                          : size > max              ? "is too long (127 bytes)"
                          : strpbrk(name, "\n\r\t") ? "must be one line"
                                                    : NULL;
    if (problem) {
        level_error(reader, node->place, NULL, "%s %s", label, problem);
        return false;
    }
    *out = name;
    return true;
}

void level_add_file(LevelReader *reader, const char *path) {
    LevelInfo *info = reader->info;
    for (u32 i = 0; i < info->file_count; i++)
        if (strcmp(info->files[i], path) == 0) return;
    LEVEL_APPEND(reader->arena, info->files, info->file_count, reader->file_cap,
                 arena_copy_string(reader->arena, path));
}

// FileRoot refuses to leave the root whatever the text says; this only says so in the user's words,
// before anything is opened.
static bool leaves_root(const char *path) {
    if (path[0] == '/' || path[0] == '\\' || (path[0] && path[1] == ':')) return true;
    for (const char *part = path; part; part = strchr(part, '/'), part = part ? part + 1 : NULL)
        if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == '\\' || part[2] == 0))
            return true;
    return strstr(path, "..\\") != NULL;
}

bool level_read_path(LevelReader *reader, const TomlNode *node, const char *label,
                     const char **out) {
    const char *path;
    if (!level_read_string(reader, node, label, &path)) return false;
    if (path[0] == 0 || strlen(path) > 512 || strpbrk(path, "\n\r")) {
        level_error(reader, node->place, NULL, "%s: not a path", label);
        return false;
    }
    if (leaves_root(path)) {
        level_error(reader, node->place, "paths start at the data root",
                    "%s: '%s' leaves the data root", label, path);
        return false;
    }
    level_add_file(reader, path); // also if it is missing: hot reload waits for it
    const char *problem = file_root_problem(reader->root, path);
    if (problem) {
        level_error(reader, node->place, NULL, "%s: '%s' below '%s' %s", label, path,
                    reader->root->path, problem);
        return false;
    }
    *out = path;
    return true;
}

static i32 hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

bool level_parse_color(const char *text, f32 rgb[3]) {
    u64 size = strlen(text);
    if (text[0] != '#' || (size != 4 && size != 7)) return false;
    u32 digits = size == 4 ? 1 : 2;
    for (u32 i = 0; i < 3; i++) {
        i32 hi = hex_digit(text[1 + i * digits]);
        i32 lo = hex_digit(text[digits == 2 ? 2 + i * 2 : 1 + i]);
        if (hi < 0 || lo < 0) return false;
        rgb[i] = srgb_to_linear((f32)(hi * 16 + lo) / 255.0f);
    }
    return true;
}

static bool read_color(LevelReader *reader, const TomlNode *node, const char *label,
                       LevelValue *out) {
    f32 rgb[3];
    if (!level_parse_color(node->string, rgb)) {
        level_error(reader, node->place, "colours are \"#rrggbb\", \"#rgb\" or [r, g, b]",
                    "%s: '%.40s' is not a colour", label, node->string);
        return false;
    }
    out->count = 3;
    for (u32 i = 0; i < 3; i++) out->bits[i] = bits_of_f32(rgb[i]);
    return true;
}

static bool read_enum(LevelReader *reader, const TomlNode *node, const char *label,
                      const ColumnDesc *column, u32 *out) {
    if (!expect(reader, node, label, TOML_STRING, "one of its words as a string")) return false;
    Suggestion suggestion = suggest_begin(node->string);
    char words[16][48];
    char list[256] = "";
    const char *word;
    u32 length;
    for (u32 i = 0; (length = level_word(column->unit, i, &word)) > 0; i++) {
        if (strlen(node->string) == length && strncmp(word, node->string, length) == 0) {
            *out = i;
            return true;
        }
        u64 used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%.*s", i ? ", " : "", (int)length, word);
        if (i >= COUNT_OF(words)) continue;
        snprintf(words[i], sizeof words[i], "%.*s", (int)length, word);
        suggest_offer(&suggestion, words[i]);
    }
    char hint[96];
    level_error(reader, node->place, suggest_hint(&suggestion, hint, sizeof hint),
                "%s: '%.60s' is not one of %s", label, node->string, list);
    return false;
}

static bool read_reference(LevelReader *reader, const TomlNode *node, const char *label,
                           const ColumnDesc *column, u32 prefab, LevelValue *out) {
    const char *name;
    if (!level_read_string(reader, node, label, &name)) return false;
    if (name[0] == 0) return true; // "" = none: bits 0
    out->kind = VALUE_REFERENCE;
    out->bits[0] = reader->reference_count;
    u32 component =
        column->unit[0] ? level_find_component(&reader->keys, column->unit) : COMPONENT_ANY;
    LEVEL_APPEND(&reader->scratch, reader->references, reader->reference_count,
                 reader->reference_cap,
                 (LevelReference){.name = name,
                                  .place = node->place,
                                  .component = component,
                                  .prefab = prefab,
                                  .local = UINT32_MAX});
    return true;
}

static bool read_texture(LevelReader *reader, const TomlNode *node, const char *label,
                         const ColumnDesc *column, LevelValue *out) {
    const char *path;
    if (node->type == TOML_STRING && node->string[0] == 0) return true; // "" = none: bits 0
    if (!level_read_path(reader, node, label, &path)) return false;
    TextureKind kind = strcmp(column->unit, "srgb") == 0 ? TEXTURE_SRGB : TEXTURE_LINEAR;
    out->kind = VALUE_TEXTURE;
    out->bits[0] = reader->texture_count;
    LEVEL_APPEND(&reader->scratch, reader->textures, reader->texture_count, reader->texture_cap,
                 (LevelTexture){.path = path,
                                .label = arena_copy_string(&reader->scratch, label),
                                .place = node->place,
                                .kind = kind});
    return true;
}

static bool read_points(LevelReader *reader, const TomlNode *node, const char *label,
                        const ColumnDesc *column, LevelValue *out) {
    if (!expect(reader, node, label, TOML_ARRAY, "a list of points [[x, y, z], ...]")) return false;
    if (node->count > LEVEL_POINTS_MAX) {
        level_error(reader, node->place, NULL, "%s: %u points, the limit is %u", label, node->count,
                    LEVEL_POINTS_MAX);
        return false;
    }
    if (node->count == 0) return true; // [] = none: bits 0
    f64 limit = level_column_has_range(column) ? MAX(fabs(column->min), fabs(column->max)) : 1e5;
    f32 *xyz = ARENA_PUSH(&reader->scratch, f32, node->count * 3);
    u32 count = 0;
    bool is_good = true;
    for (const TomlNode *point = node->first; point; point = point->next, count++) {
        Vec3 p = {0};
        is_good &= level_read_vec3(reader, point, label, limit, &p);
        memcpy(xyz + count * 3, &p, sizeof p);
    }
    out->kind = VALUE_POINTS;
    out->bits[0] = reader->point_count;
    LEVEL_APPEND(&reader->scratch, reader->points, reader->point_count, reader->point_cap,
                 (LevelPoints){.xyz = xyz, .count = count});
    return is_good;
}

// One element.
static bool read_scalar(LevelReader *reader, const TomlNode *node, const char *label,
                        const ColumnDesc *column, u32 *bits) {
    bool has_range = level_column_has_range(column);
    f64 number;
    i64 integer;
    bool boolean;
    switch (column->type) {
    case COLUMN_F32:
        if (!read_finite(reader, node, label, &number)) return false;
        *bits = bits_of_f32((f32)number);
        return !has_range ||
               check_range(reader, node, label, number, column->min, column->max, true);
    case COLUMN_U32:
        if (!level_read_integer(reader, node, label, has_range ? (i64)column->min : 0,
                                has_range ? (i64)column->max : UINT32_MAX, &integer))
            return false;
        *bits = (u32)integer;
        return true;
    case COLUMN_I32:
        if (!level_read_integer(reader, node, label, has_range ? (i64)column->min : INT32_MIN,
                                has_range ? (i64)column->max : INT32_MAX, &integer))
            return false;
        *bits = (u32)(i32)integer;
        return true;
    case COLUMN_BOOL:
        if (!level_read_bool(reader, node, label, &boolean)) return false;
        *bits = boolean;
        return true;
    case COLUMN_ENUM:
        return read_enum(reader, node, label, column, bits);
    case COLUMN_ENTITY:
    case COLUMN_TEXTURE:
    case COLUMN_POINTS:
        break;
    }
    return false;
}

bool level_read_value(LevelReader *reader, const TomlNode *node, const char *label, u32 component,
                      const LevelKey *key, u32 prefab, LevelValue *out) {
    const LevelComponent *owner = &reader->keys.components[component];
    const ColumnDesc *column = level_key_column(owner, key);
    *out = (LevelValue){.kind = VALUE_BITS, .count = key->count};
    if (key->count == 1) {
        if (column->type == COLUMN_ENTITY)
            return read_reference(reader, node, label, column, prefab, out);
        if (column->type == COLUMN_TEXTURE) return read_texture(reader, node, label, column, out);
        if (column->type == COLUMN_POINTS) return read_points(reader, node, label, column, out);
        return read_scalar(reader, node, label, column, &out->bits[0]);
    }
    if (level_key_is_color(owner, key) && node->type == TOML_STRING)
        return read_color(reader, node, label, out);
    if (level_key_takes_scalar(owner, key) && node->type != TOML_ARRAY) {
        if (!read_scalar(reader, node, label, column, &out->bits[0])) return false;
        for (u32 i = 1; i < key->count; i++) out->bits[i] = out->bits[0];
        return true;
    }
    if (node->type != TOML_ARRAY) {
        level_error(reader, node->place, NULL, "%s: expected a list of %u numbers%s, got %s", label,
                    key->count, level_key_is_color(owner, key) ? " or a colour" : "",
                    toml_type_name(node->type));
        return false;
    }
    if (node->count != key->count) {
        level_error(reader, node->place, NULL, "%s: expected %u numbers, got %u", label, key->count,
                    node->count);
        return false;
    }
    bool is_good = true;
    u32 i = 0;
    for (const TomlNode *element = node->first; element; element = element->next, i++) {
        const ColumnDesc *cell = &owner->desc->columns[key->column + i];
        is_good &= read_scalar(reader, element, label, cell, &out->bits[i]);
    }
    return is_good;
}
