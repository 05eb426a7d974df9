// level_read.c: level_load: one file to a world, an asset store and diagnostics.
// Data in: a path below the data root. Data out: rows and assets, or every mistake of the file in
// one run. Called by the app, the tools and the tests. Does not: stop at the first mistake, or know
// any component: keys, types, ranges and defaults come from the column descriptions (level_keys.c).
//
// THE FORMAT is TOML 1.0. Units are metres, degrees, seconds; colours are [r, g, b] linear or
// "#rrggbb" / "#rgb" sRGB. Paths start at the data root and never leave it. All tables are
// optional.
//
//   [level]                         # about the file
//   title = "Cloister"
//   seed = 7                        # of repetition and of the simulation's random numbers
//
//   [environment]                   # any singleton component, by its name
//   ambient = "#0b1020"
//
//   [[model]]                       # name, and a file or a shape
//   name = "bay"
//   file = "models/bay.glb"         # its materials are "bay/stone", ...
//   [[model]]
//   name = "ball"
//   shape = "sphere"                # plane cube sphere icosahedron cone cylinder torus
//   segments = 24                   # rings, tube (torus), uv_repeat, inverted
//
//   [[material]]                    # name, and keys of the component `material`
//   name = "brass"
//   albedo = [0.4, 0.3, 0.1]
//   albedo_texture = "textures/brass.png"
//   [[material]]                    # a model's own material: only what shall differ
//   name = "bay/stone"
//   power = 12
//
//   [[prefab]]                      # a group of entities under one name
//   name = "lamp"
//   [[prefab.entity]]               # the first is the root
//   instance.model = "ball"
//   [[prefab.entity]]               # the others hang on it, or on the one named as their `parent`
//   name = "glow"
//   light = { color = "#ffa040", intensity = 5 }
//
//   [[entity]]                      # all keys optional
//   name = "lamp"                   # unique among entities
//   prefab = "lamp"                 # own values override those of the prefab's root
//   parent = "pillar"               # transform is relative to that entity
//   transform.position = [1, 2, 3]  # components by name, dotted or as tables
//   transform.scale = 2             # one number for all three where the key has no unit
//   walker = {}                     # a component with all its defaults
//   repeat = { row = { count = 8, step = [3, 0, 0] } }
//   vary = { flicker.rate = { min = 4, max = 9 }, light.color = { choose = ["#fff", "#fc8"] } }
//
// Every entity has `transform`. A key that refers (instance.model, a key of a game's component)
// takes the name of something that has the needed component; within a prefab its own entities come
// first; "" means none. The entities of a prefab instance "lamp" are named "lamp/glow".
//
// repeat is a table of factors, or a list of such tables: their product, the first outermost:
//   row     { count, step = [x, y, z] }
//   ring    { count, radius, axis = "x|y|z" (y), start = degrees (0), face = bool (true) }
//           from +x (axis x: from +y) about the entity's position; face turns each copy with its
//           place
//   scatter { count, min = [..], max = [..], seed }  within a box; equal seeds give equal places
//   grid    { count = [nx, ny, nz], step = [x, y, z] }  x counts fastest
// Offsets are in the parent's space and are added to transform.position; a factor turned by a ring
// turns what is inside it. Copies are named "name", "name.1", "name.2" ...
// vary draws a value per copy: { min, max } for numbers (two single numbers for an array key: one
// draw for all elements; lists: one each) or { choose = [...] } for anything.
//
// A .gltf or .glb file is a level as well: see level_gltf.c.
#include "level_internal.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCRATCH_SIZE     GIB(4) // of address space, halved where the system refuses so much
#define SCRATCH_SIZE_MIN MIB(256)
#define SCRATCH_PER_BYTE 256 // of text; the densest text ("[{}, {}, ...") takes about 110
#define DEFAULT_SEED     1

static void list_lines(LevelText *text, Arena *arena) {
    u32 count = 1;
    for (u64 i = 0; i < text->size; i++) count += text->data[i] == '\n';
    text->line_first = ARENA_PUSH(arena, u64, count);
    text->line_count = count;
    u32 line = 1;
    for (u64 i = 0; i < text->size; i++)
        if (text->data[i] == '\n') text->line_first[line++] = i + 1;
}

static void read_level_table(LevelReader *reader, const TomlNode *table) {
    if (!level_is_table(reader, table, "level")) return;
    for (const TomlNode *node = table->first; node; node = node->next) {
        const char *title;
        i64 seed;
        if (strcmp(node->key, "title") == 0) {
            if (level_read_string(reader, node, "level.title", &title))
                snprintf(reader->info->title, sizeof reader->info->title, "%s", title);
        } else if (strcmp(node->key, "seed") == 0) {
            if (level_read_integer(reader, node, "level.seed", INT64_MIN, INT64_MAX, &seed))
                reader->world->seed = (u64)seed;
        } else {
            Suggestion suggestion = suggest_begin(node->key);
            suggest_offer(&suggestion, "title");
            suggest_offer(&suggestion, "seed");
            char hint[96];
            level_error(reader, node->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                        "unknown key '%.80s' of level", node->key);
        }
    }
}

// Singletons in the order of their ids, whatever the order of the file: handles do not depend on
// it. The engine's own are always there, but for `gi`, which switches on what it describes.
static void read_singletons(LevelReader *reader, const TomlNode *root) {
    for (u32 i = 0; i < reader->keys.count; i++) {
        const ComponentDesc *desc = reader->keys.components[i].desc;
        if (!desc->singleton) continue;
        const TomlNode *table = toml_find(root, desc->name);
        if (!table && (i >= COMPONENT_ENGINE_COUNT || i == COMPONENT_gi)) continue;
        u32 row = world_singleton(reader->world, i);
        if (!table || !level_is_table(reader, table, desc->name)) continue;
        u32 first = reader->assignment_count;
        level_read_component(reader, table, i, "", UINT32_MAX);
        for (u32 k = first; k < reader->assignment_count; k++) {
            const LevelAssignment *a = &reader->assignments[k];
            level_assign(reader, reader->world->tables[i]->entity[row], i, a->column, a->kind,
                         a->bits);
        }
    }
}

static void report_unknown_tables(LevelReader *reader, const TomlNode *root) {
    static const char *const known[] = {"level", "model", "material", "prefab", "entity"};
    for (const TomlNode *node = root->first; node; node = node->next) {
        Suggestion suggestion = suggest_begin(node->key);
        for (u32 i = 0; i < COUNT_OF(known); i++) suggest_offer(&suggestion, known[i]);
        for (u32 i = 0; i < reader->keys.count; i++)
            if (reader->keys.components[i].desc->singleton)
                suggest_offer(&suggestion, reader->keys.components[i].desc->name);
        if (suggestion.best && strcmp(suggestion.best, node->key) == 0) continue;
        char hint[96];
        suggest_hint(&suggestion, hint, sizeof hint);
        u32 component = level_find_component(&reader->keys, node->key);
        if (level_is_entity_component(&reader->keys, component))
            snprintf(hint, sizeof hint, "components belong to an [[entity]]");
        level_error(reader, node->key_place, hint, "unknown table '%.80s'", node->key);
    }
}

static void warn_of_unused_prefabs(LevelReader *reader) {
    for (u32 i = 0; i < reader->prefab_count; i++)
        if (!reader->prefabs[i].is_used)
            level_warning(reader, reader->prefabs[i].place, NULL, "prefab '%s' is not used",
                          reader->prefabs[i].name);
}

// Does it, or what it hangs on, move by itself?
static bool moves(const World *world, Entity entity) {
    const TransformTable *t = WORLD_TABLE(world, Transform, transform);
    for (u32 row; (row = table_row(&t->table, entity)) != ROW_NONE; entity = t->parent[row])
        if (table_row(world->tables[COMPONENT_orbit], entity) != ROW_NONE ||
            table_row(world->tables[COMPONENT_path], entity) != ROW_NONE)
            return true;
    return false;
}

// Static voxels are made once: what moves would have all of them made anew at every tick.
static void warn_of_moving_voxels(LevelReader *reader, TomlPlace place) {
    const World *world = reader->world;
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    u32 count = 0;
    const char *name = "";
    for (u32 row = 0; row < instances->table.count; row++) {
        Entity entity = instances->table.entity[row];
        if (instances->voxel_mode[row] != VOXEL_STATIC || !moves(world, entity)) continue;
        if (count++ == 0) name = world_name(world, entity);
    }
    if (count > 0)
        level_warning(reader, place, "write instance.voxel_mode = \"dynamic\", or \"none\"",
                      "%u instance%s move%s but %s voxelised as static%s%s%s", count,
                      count == 1 ? "" : "s", count == 1 ? "s" : "", count == 1 ? "is" : "are",
                      name[0] ? ", first '" : "", name, name[0] ? "'" : "");
}

static void read_toml(LevelReader *reader) {
    TomlNode *root;
    TomlError error;
    if (!toml_parse(reader->text.data, reader->text.size, &reader->scratch, &root, &error)) {
        level_error(reader, error.place, NULL, "%s", error.text);
        return;
    }
    const TomlNode *node;
    report_unknown_tables(reader, root);
    if ((node = toml_find(root, "level"))) read_level_table(reader, node);
    read_singletons(reader, root);
    if ((node = toml_find(root, "model"))) level_read_models(reader, node);
    if ((node = toml_find(root, "material"))) level_read_materials(reader, node);
    if ((node = toml_find(root, "prefab"))) level_read_prefabs(reader, node);
    if ((node = toml_find(root, "entity"))) level_read_entities(reader, node);
    level_spawn_all(reader);
    level_spawn_all_drawables(reader, root->place);
    warn_of_unused_prefabs(reader);
    if ((node = toml_find(root, "gi"))) warn_of_moving_voxels(reader, node->key_place);
}

static bool has_suffix(const char *path, const char *suffix) {
    u64 size = strlen(path), suffix_size = strlen(suffix);
    return size >= suffix_size && strcmp(path + size - suffix_size, suffix) == 0;
}

static void hash_assets(LevelInfo *info, const AssetStore *store) {
    for (u32 i = 1; i < store->model_count; i++)
        info->content_hash =
            hash_bytes(&store->models[i].content_hash, sizeof(u64), info->content_hash);
    for (u32 i = 1; i < store->texture_count; i++) {
        const Texture *texture = &store->textures[i];
        info->content_hash = hash_bytes(texture->pixels, (u64)texture->width * texture->height * 4,
                                        info->content_hash);
    }
}

static bool read_file(LevelReader *reader, const char *path) {
    Bytes bytes;
    u64 max_size = MIN(LEVEL_TEXT_SIZE_MAX, reader->scratch.cap / SCRATCH_PER_BYTE);
    log_hush(LOG_SEVERITY_ERROR);
    bool ok = file_root_read(reader->root, path, max_size, &reader->scratch, &bytes);
    log_hush(LOG_SEVERITY_NONE);
    if (ok) {
        reader->text = (LevelText){.data = bytes.data, .size = bytes.size};
        list_lines(&reader->text, &reader->scratch);
        return true;
    }
    char reason[256];
    log_last_error(reason, sizeof reason);
    level_error(reader, LEVEL_WHOLE_FILE, NULL, "the level cannot be read: %s", reason);
    return false;
}

static bool create_scratch(Arena *arena) {
    for (u64 size = SCRATCH_SIZE; size >= SCRATCH_SIZE_MIN; size /= 2)
        if (arena_create(arena, "level reader", size)) return true;
    return false;
}

bool level_load(const FileRoot *root, const char *path, World *world, AssetStore *store,
                Arena *arena, LevelInfo *info, Diagnostics *diagnostics) {
    LevelReader reader = {
        .root = root,
        .world = world,
        .store = store,
        .info = info,
        .diagnostics = diagnostics,
        .arena = arena,
        .file = strcmp(root->path, ".") == 0 ? arena_copy_string(arena, path)
                                             : arena_format(arena, "%s/%s", root->path, path),
        .suggestions_left = LEVEL_SUGGESTIONS_MAX,
    };
    *info = (LevelInfo){0};
    diagnostics->arena = arena;
    diagnostics->count = diagnostics->error_count = diagnostics->warning_count = 0;
    if (!create_scratch(&reader.scratch)) {
        level_error(&reader, LEVEL_WHOLE_FILE, NULL, "no memory to read the level");
        return false;
    }
    level_keys_create(&reader.keys, world, &reader.scratch);
    level_add_file(&reader, path);
    world->seed = DEFAULT_SEED;
    if (has_suffix(path, ".gltf") || has_suffix(path, ".glb")) {
        level_read_gltf(&reader, path);
    } else if (read_file(&reader, path)) {
        info->content_hash = hash_bytes(reader.text.data, reader.text.size, 0);
        read_toml(&reader);
    }
    hash_assets(info, store);
    info->seed = world->seed;
    info->entity_count = (u32)reader.entity_total;
    level_sort_diagnostics(diagnostics);
    arena_destroy(&reader.scratch);
    const Diagnostic *first = diagnostics->items;
    while (first < diagnostics->items + diagnostics->count && !first->is_error) first++;
    if (first < diagnostics->items + diagnostics->count)
        LOG(LEVEL_ERROR, "%s: %u errors, first at line %u: %s", reader.file,
            diagnostics->error_count, first->line, first->text);
    return diagnostics->error_count == 0;
}

bool level_find_root(const char *path, char *root, u64 root_cap, char *relative, u64 relative_cap) {
    char resolved[4096];
    const char *full = path;
    // The nearest "data" in the path as typed keeps messages short; if there is none, or if the
    // path climbs, the real one is searched.
    for (u32 attempt = 0; attempt < 2; attempt++) {
        const char *after = NULL;
        for (const char *part = full; part; part = strchr(part, '/'), part = part ? part + 1 : NULL)
            if (strncmp(part, "data/", 5) == 0) after = part + 5;
        if (after && !strstr(full, "..")) {
            u64 size = (u64)(after - full) - 1;
            if (size >= root_cap || strlen(after) >= relative_cap) return false;
            memcpy(root, full, size);
            root[size] = 0;
            memcpy(relative, after, strlen(after) + 1);
            return true;
        }
        if (attempt == 0 && !realpath(path, resolved)) break;
        full = resolved;
    }
    const char *name;
    file_split_path(path, root, root_cap, &name);
    if (strlen(name) >= relative_cap) return false;
    memcpy(relative, name, strlen(name) + 1);
    return true;
}
