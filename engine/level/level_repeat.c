// level_repeat.c: repetition: rows, rings, scatters, grids and their products.
// Data in: the node of an entity's `repeat`. Data out: the blueprint's list of factors, and later
// the placement of each copy. Called by level_entities.c (read) and level_spawn.c (place). Does
// not: know components; a placement is a rotation and an offset in the parent's space, put before
// the entity's own transform, the first factor outermost.
#include "level_internal.h"
#include "../base/random.h"
#include <stdio.h>
#include <string.h>

#define DISTANCE_MAX       1e5 // m
#define REPEAT_FACTORS_MAX 8

static const char *const repeat_names[] = {"row", "ring", "scatter", "grid"};

static void report_unknown(LevelReader *reader, const TomlNode *node, const char *what,
                           const char *const *known, u32 known_count) {
    Suggestion suggestion = suggest_begin(node->key);
    for (u32 i = 0; i < known_count; i++) suggest_offer(&suggestion, known[i]);
    char hint[96];
    level_error(reader, node->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                "unknown key '%.80s' of %s", node->key, what);
}

static bool read_count(LevelReader *reader, const TomlNode *node, const char *label, u32 *out) {
    i64 count;
    if (!level_read_integer(reader, node, label, 1, LEVEL_ENTITIES_MAX, &count)) return false;
    *out = (u32)count;
    return true;
}

static bool read_grid_counts(LevelReader *reader, const TomlNode *node, LevelRepeat *repeat) {
    if (node->type != TOML_ARRAY || node->count != 3) {
        level_error(reader, node->place, NULL, "grid.count: expected 3 integers, got %s",
                    toml_type_name(node->type));
        return false;
    }
    u32 i = 0;
    u64 product = 1;
    for (const TomlNode *n = node->first; n; n = n->next, i++) {
        if (!read_count(reader, n, "grid.count", &repeat->counts[i])) return false;
        product = MIN(product * repeat->counts[i], (u64)1 << 32);
    }
    if (product > LEVEL_ENTITIES_MAX) {
        level_error(reader, node->place, NULL, "grid.count: %llu copies, the limit is %u",
                    (unsigned long long)product, LEVEL_ENTITIES_MAX);
        return false;
    }
    repeat->count = (u32)product;
    return true;
}

static bool read_axis(LevelReader *reader, const TomlNode *node, LevelRepeat *repeat) {
    const char *axis;
    if (!level_read_string(reader, node, "ring.axis", &axis)) return false;
    if (axis[0] >= 'x' && axis[0] <= 'z' && axis[1] == 0) {
        repeat->axis = (u32)(axis[0] - 'x');
        return true;
    }
    level_error(reader, node->place, NULL, "ring.axis: '%.20s' is not one of x, y, z", axis);
    return false;
}

// One key of one factor; false only if the key is unknown.
static bool read_key(LevelReader *reader, const TomlNode *node, LevelRepeat *repeat) {
    char label[64];
    snprintf(label, sizeof label, "%s.%.32s", repeat_names[repeat->kind], node->key);
    f64 number;
    i64 integer;
    const char *key = node->key;
    RepeatKind kind = repeat->kind;
    if (strcmp(key, "count") == 0) {
        if (kind == REPEAT_GRID) {
            read_grid_counts(reader, node, repeat);
        } else {
            read_count(reader, node, label, &repeat->count);
        }
    } else if (strcmp(key, "step") == 0 && (kind == REPEAT_ROW || kind == REPEAT_GRID)) {
        level_read_vec3(reader, node, label, DISTANCE_MAX, &repeat->a);
    } else if (strcmp(key, "min") == 0 && kind == REPEAT_SCATTER) {
        level_read_vec3(reader, node, label, DISTANCE_MAX, &repeat->a);
    } else if (strcmp(key, "max") == 0 && kind == REPEAT_SCATTER) {
        level_read_vec3(reader, node, label, DISTANCE_MAX, &repeat->b);
    } else if (strcmp(key, "seed") == 0 && kind == REPEAT_SCATTER) {
        repeat->has_seed = level_read_integer(reader, node, label, INT64_MIN, INT64_MAX, &integer);
        if (repeat->has_seed) repeat->seed = (u64)integer;
    } else if (strcmp(key, "radius") == 0 && kind == REPEAT_RING) {
        if (level_read_number(reader, node, label, 0, DISTANCE_MAX, &number))
            repeat->radius = (f32)number;
    } else if (strcmp(key, "start") == 0 && kind == REPEAT_RING) {
        if (level_read_number(reader, node, label, -3600, 3600, &number))
            repeat->start_deg = (f32)number;
    } else if (strcmp(key, "face") == 0 && kind == REPEAT_RING) {
        level_read_bool(reader, node, label, &repeat->face);
    } else if (strcmp(key, "axis") == 0 && kind == REPEAT_RING) {
        read_axis(reader, node, repeat);
    } else {
        return false;
    }
    return true;
}

static void require(LevelReader *reader, const TomlNode *table, TomlPlace place, const char *what,
                    const char *key) {
    if (!toml_find(table, key)) level_error(reader, place, NULL, "%s needs '%s'", what, key);
}

static LevelRepeat read_factor(LevelReader *reader, const TomlNode *node, RepeatKind kind) {
    LevelRepeat repeat = {.kind = kind, .count = 1, .counts = {1, 1, 1}, .axis = 1, .face = true};
    const char *what = repeat_names[kind];
    if (!level_is_table(reader, node, what)) return repeat;
    static const char *const keys[][6] = {{"count", "step"},
                                          {"count", "radius", "axis", "start", "face"},
                                          {"count", "seed", "min", "max"},
                                          {"count", "step"}};
    static const u32 key_counts[] = {2, 5, 4, 2};
    for (const TomlNode *child = node->first; child; child = child->next)
        if (!read_key(reader, child, &repeat))
            report_unknown(reader, child, what, keys[kind], key_counts[kind]);
    TomlPlace place = node->key_place;
    require(reader, node, place, what, "count");
    if (kind == REPEAT_ROW || kind == REPEAT_GRID) require(reader, node, place, what, "step");
    if (kind == REPEAT_RING) require(reader, node, place, what, "radius");
    if (kind == REPEAT_SCATTER) {
        require(reader, node, place, what, "min");
        require(reader, node, place, what, "max");
        if (repeat.a.x > repeat.b.x || repeat.a.y > repeat.b.y || repeat.a.z > repeat.b.z)
            level_error(reader, place, NULL, "scatter: min is above max");
    }
    return repeat;
}

// A table of kinds ({row = {...}}), each a factor.
static void read_table(LevelReader *reader, const TomlNode *table, Blueprint *blueprint) {
    if (!level_is_table(reader, table, "repeat")) return;
    if (table->count == 0)
        level_error(reader, table->place, "write 'row', 'ring', 'scatter' or 'grid'",
                    "repeat is empty");
    for (const TomlNode *node = table->first; node; node = node->next) {
        u32 kind = 0;
        while (kind < COUNT_OF(repeat_names) && strcmp(node->key, repeat_names[kind]) != 0) kind++;
        if (kind == COUNT_OF(repeat_names)) {
            report_unknown(reader, node, "repeat", repeat_names, COUNT_OF(repeat_names));
            continue;
        }
        if (blueprint->repeat_count == REPEAT_FACTORS_MAX) {
            level_error(reader, node->key_place, NULL, "more than %u repetitions of one entity",
                        REPEAT_FACTORS_MAX);
            return;
        }
        blueprint->repeats[blueprint->repeat_count++] = read_factor(reader, node, (RepeatKind)kind);
    }
}

void level_read_repeat(LevelReader *reader, const TomlNode *node, Blueprint *blueprint) {
    blueprint->repeats = ARENA_PUSH(&reader->scratch, LevelRepeat, REPEAT_FACTORS_MAX);
    if (node->type == TOML_ARRAY) {
        for (const TomlNode *factor = node->first; factor; factor = factor->next)
            read_table(reader, factor, blueprint);
    } else {
        read_table(reader, node, blueprint);
    }
    u64 product = 1;
    for (u32 i = 0; i < blueprint->repeat_count; i++)
        product = MIN(product * blueprint->repeats[i].count, (u64)1 << 32);
    if (product > LEVEL_ENTITIES_MAX) {
        level_error(reader, node->key_place, NULL, "repeat: %llu copies, the limit is %u",
                    (unsigned long long)product, LEVEL_ENTITIES_MAX);
        product = 1;
        blueprint->repeat_count = 0;
    }
    blueprint->copy_count = (u32)product;
}

// Offset and rotation of copy i of one factor. Rings start at +x (about x: at +y) and go against
// the clock seen from the axis' end.
static Vec3 place_factor(const LevelRepeat *repeat, u32 i, u32 factor, u64 seed, u64 stream,
                         Vec3 *rotation_deg) {
    *rotation_deg = (Vec3){0};
    switch (repeat->kind) {
    case REPEAT_ROW:
        return vec3_scale(repeat->a, (f32)i);
    case REPEAT_GRID:
        return vec3(repeat->a.x * (f32)(i % repeat->counts[0]),
                    repeat->a.y * (f32)(i / repeat->counts[0] % repeat->counts[1]),
                    repeat->a.z * (f32)(i / repeat->counts[0] / repeat->counts[1]));
    case REPEAT_SCATTER: {
        // With a seed of its own a scatter is the same wherever it is written.
        u64 s = repeat->has_seed ? repeat->seed : stream + factor;
        f32 r[3];
        for (u32 k = 0; k < 3; k++) r[k] = random_f32(seed ^ 0x5CA77E2, s, (u64)i * 3 + k);
        return vec3(f32_lerp(repeat->a.x, repeat->b.x, r[0]),
                    f32_lerp(repeat->a.y, repeat->b.y, r[1]),
                    f32_lerp(repeat->a.z, repeat->b.z, r[2]));
    }
    case REPEAT_RING: {
        f32 degrees = repeat->start_deg + 360.0f * (f32)i / (f32)repeat->count;
        f32 c = det_cos(DEG_TO_RAD(degrees)) * repeat->radius;
        f32 s = det_sin(DEG_TO_RAD(degrees)) * repeat->radius;
        if (repeat->axis == 0) {
            rotation_deg->x = degrees;
            return vec3(0, c, s);
        }
        if (repeat->axis == 1) {
            rotation_deg->y = degrees;
            return vec3(c, 0, -s);
        }
        rotation_deg->z = degrees;
        return vec3(c, s, 0);
    }
    }
    return (Vec3){0};
}

LevelPlacement level_place_copy(const LevelRepeat *repeats, u32 repeat_count, u32 copy, u64 seed,
                                u64 stream) {
    LevelPlacement placement = {.rotation = mat34_identity(), .is_yaw_only = true};
    u32 counts_after = 1;
    for (u32 i = 0; i < repeat_count; i++) counts_after *= repeats[i].count;
    for (u32 i = 0; i < repeat_count; i++) {
        const LevelRepeat *repeat = &repeats[i];
        counts_after /= repeat->count;
        Vec3 rotation_deg;
        Vec3 offset = place_factor(repeat, copy / counts_after % repeat->count, i, seed, stream,
                                   &rotation_deg);
        if (placement.is_rotated) offset = mat34_vector(&placement.rotation, offset);
        placement.offset = vec3_add(placement.offset, offset);
        if (repeat->kind != REPEAT_RING || !repeat->face) continue;
        placement.is_rotated = true;
        placement.is_yaw_only &= repeat->axis == 1;
        placement.yaw_deg += rotation_deg.y;
        placement.rotation = mat34_mul(placement.rotation,
                                       mat34_from_trs(vec3(0, 0, 0), rotation_deg, vec3(1, 1, 1)));
    }
    return placement;
}
