// level_vary.c: values that differ from copy to copy.
// Data in: the node of an entity's `vary`. Data out: the blueprint's list of varied keys, and later
// the value of each copy. Called by level_entities.c (read) and level_spawn.c (draw). A draw is a
// pure function of the level's seed, the entity's own name (or number), the key and the copy:
// entities, keys and copies that come or go elsewhere change nothing here.
#include "level_internal.h"
#include "../base/hash.h"
#include "../base/random.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_number(ColumnType type) {
    return type == COLUMN_F32 || type == COLUMN_U32 || type == COLUMN_I32;
}

static f64 number_of_bits(ColumnType type, u32 bits) {
    if (type == COLUMN_U32) return bits;
    if (type == COLUMN_I32) return (i32)bits;
    f32 value;
    memcpy(&value, &bits, 4);
    return value;
}

static void read_choices(LevelReader *reader, const TomlNode *node, const char *label,
                         u32 component, const LevelKey *key, u32 prefab, LevelVary *vary) {
    if (node->type != TOML_ARRAY || node->count == 0) {
        level_error(reader, node->place, NULL, "%s.choose: expected a list of values, got %s",
                    label, node->type == TOML_ARRAY ? "an empty one" : toml_type_name(node->type));
        return;
    }
    LevelValue *choices = ARENA_PUSH(&reader->scratch, LevelValue, node->count);
    for (const TomlNode *value = node->first; value; value = value->next)
        if (level_read_value(reader, value, label, component, key, prefab,
                             &choices[vary->choice_count]))
            vary->choice_count++;
    vary->choices = vary->choice_count ? choices : NULL;
}

// One end of a range. A single number stands for all elements of an array key.
static bool read_end(LevelReader *reader, const TomlNode *node, const char *label, u32 component,
                     const LevelKey *key, f64 out[LEVEL_ELEMENTS_MAX]) {
    const LevelComponent *owner = &reader->keys.components[component];
    ColumnType type = level_key_column(owner, key)->type;
    LevelValue value;
    bool is_scalar = node->type == TOML_INTEGER || node->type == TOML_FLOAT;
    LevelKey first = {key->name, key->column, 1};
    if (!level_read_value(reader, node, label, component, is_scalar ? &first : key, UINT32_MAX,
                          &value))
        return false;
    for (u32 i = 0; i < key->count; i++)
        out[i] = number_of_bits(type, value.bits[is_scalar ? 0 : i]);
    return true;
}

static void read_range(LevelReader *reader, const TomlNode *table, const TomlNode *min,
                       const TomlNode *max, const char *label, u32 component, const LevelKey *key,
                       LevelVary *vary) {
    if (!min || !max) {
        level_error(reader, table->key_place, NULL, "%s: needs 'choose', or 'min' and 'max'",
                    label);
        return;
    }
    if (!is_number(vary->type)) {
        level_error(reader, min->key_place, "use 'choose'", "%s: only numbers have a range", label);
        return;
    }
    if (!read_end(reader, min, label, component, key, vary->lo) ||
        !read_end(reader, max, label, component, key, vary->hi))
        return;
    for (u32 i = 0; i < key->count; i++) {
        if (vary->lo[i] <= vary->hi[i]) continue;
        level_error(reader, min->place, NULL, "%s: min %g is above max %g", label, vary->lo[i],
                    vary->hi[i]);
        return;
    }
    vary->is_uniform = key->count > 1 && min->type != TOML_ARRAY && min->type != TOML_STRING &&
                       max->type != TOML_ARRAY && max->type != TOML_STRING;
}

static void read_key(LevelReader *reader, const TomlNode *node, u32 component, const LevelKey *key,
                     u32 prefab, LevelVary *vary) {
    const LevelComponent *owner = &reader->keys.components[component];
    char label[128];
    snprintf(label, sizeof label, "%s.%s", owner->desc->name, key->name);
    *vary = (LevelVary){.component = (u16)component,
                        .column = (u16)key->column,
                        .count = key->count,
                        .type = level_key_column(owner, key)->type,
                        .key_hash = hash_string(label)};
    if (node->type != TOML_TABLE) {
        level_error(reader, node->place, "write { min = a, max = b } or { choose = [a, b] }",
                    "vary.%s: expected a table, got %s", label, toml_type_name(node->type));
        return;
    }
    const TomlNode *min = NULL, *max = NULL, *choose = NULL;
    for (const TomlNode *child = node->first; child; child = child->next) {
        if (strcmp(child->key, "min") == 0) {
            min = child;
        } else if (strcmp(child->key, "max") == 0) {
            max = child;
        } else if (strcmp(child->key, "choose") == 0) {
            choose = child;
        } else {
            Suggestion suggestion = suggest_begin(child->key);
            suggest_offer(&suggestion, "min");
            suggest_offer(&suggestion, "max");
            suggest_offer(&suggestion, "choose");
            char hint[96];
            level_error(reader, child->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                        "unknown key '%.80s' of vary.%s", child->key, label);
        }
    }
    if (choose && (min || max)) {
        level_error(reader, choose->key_place, NULL,
                    "vary.%s: 'choose' and a range exclude each other", label);
    } else if (choose) {
        read_choices(reader, choose, label, component, key, prefab, vary);
    } else {
        read_range(reader, node, min, max, label, component, key, vary);
    }
}

void level_read_vary(LevelReader *reader, const TomlNode *node, Blueprint *blueprint, u32 prefab) {
    if (!level_is_table(reader, node, "vary")) return;
    u32 cap = 0;
    for (const TomlNode *table = node->first; table; table = table->next)
        if (table->type == TOML_TABLE) cap += table->count;
    blueprint->varies = ARENA_PUSH(&reader->scratch, LevelVary, MAX(cap, 1u));
    for (const TomlNode *table = node->first; table; table = table->next) {
        u32 component = level_find_component(&reader->keys, table->key);
        char hint[160];
        if (!level_is_entity_component(&reader->keys, component)) {
            Suggestion suggestion = suggest_begin(table->key);
            for (u32 i = 0; i < reader->keys.count; i++)
                if (level_is_entity_component(&reader->keys, i))
                    suggest_offer(&suggestion, reader->keys.components[i].desc->name);
            level_error(reader, table->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                        "vary: no component '%.80s'", table->key);
            continue;
        }
        if (!level_is_table(reader, table, table->key)) continue;
        blueprint->components |= 1ull << component;
        const LevelComponent *owner = &reader->keys.components[component];
        for (const TomlNode *child = table->first; child; child = child->next) {
            const LevelKey *key = level_find_key(owner, child->key);
            if (key) {
                LevelVary *vary = &blueprint->varies[blueprint->vary_count++];
                read_key(reader, child, component, key, prefab, vary);
                continue;
            }
            Suggestion suggestion = suggest_begin(child->key);
            for (u32 i = 0; i < owner->key_count; i++)
                suggest_offer(&suggestion, owner->keys[i].name);
            level_error(reader, child->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                        "vary: unknown key '%.80s' of %s", child->key, owner->desc->name);
        }
    }
}

static u32 draw_number(const LevelVary *vary, u32 element, u64 random) {
    f64 lo = vary->lo[element], hi = vary->hi[element];
    u32 bits;
    if (vary->type == COLUMN_F32) {
        f32 value = f32_lerp((f32)lo, (f32)hi, (f32)(random >> 40) * 0x1p-24f);
        memcpy(&bits, &value, 4);
        return bits;
    }
    u64 span = (u64)(hi - lo) + 1; // inclusive
    i64 value = (i64)lo + (i64)((random >> 32) % span);
    return (u32)value;
}

LevelValue level_draw_vary(const LevelVary *vary, u64 seed, u64 stream, u32 copy) {
    u64 key_stream = hash_bytes(&stream, sizeof stream, vary->key_hash);
    u64 counter = (u64)copy * LEVEL_ELEMENTS_MAX;
    if (vary->choices) {
        u64 random = random_u64(seed, key_stream, counter) >> 32;
        return vary->choices[random * vary->choice_count >> 32];
    }
    LevelValue value = {.kind = VALUE_BITS, .count = vary->count};
    for (u32 i = 0; i < vary->count; i++)
        value.bits[i] = draw_number(
            vary, i, random_u64(seed, key_stream, counter + (vary->is_uniform ? 0 : i)));
    return value;
}
