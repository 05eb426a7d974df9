// level_internal.h: what the files of level/ share: the reader's state and its intermediate data.
//
// Text becomes nodes (toml.h), nodes become blueprints (one per entity table: which components,
// which values, how often), blueprints become rows. Everything here lives in the reader's own arena
// and is gone when level_load returns; only diagnostics and LevelInfo outlive it.
#ifndef LUZ_LEVEL_INTERNAL_H
#define LUZ_LEVEL_INTERNAL_H
#include "level.h"
#include "suggest.h"
#include "toml.h"

#define LEVEL_ELEMENTS_MAX 16 // of an array key
// Comparisons of names in one run: a hostile file with many wrong names among many stays cheap.
#define LEVEL_SUGGESTIONS_MAX 4000000
#define COMPONENT_ANY UINT32_MAX

// --- Keys of components (level_keys.c) ---

// One key of level text: one column, or the columns key[0], key[1] ... as an array.
typedef struct LevelKey {
    const char *name;
    u32 column; // the first
    u32 count;
} LevelKey;

typedef struct LevelComponent {
    const ComponentDesc *desc;
    LevelKey *keys;
    u32 key_count;
} LevelComponent;

// By component id.
typedef struct LevelKeys {
    LevelComponent components[WORLD_COMPONENTS_CAP];
    u32 count;
} LevelKeys;

void level_keys_create(LevelKeys *keys, const World *world, Arena *arena);
const LevelKey *level_find_key(const LevelComponent *component, const char *name);
// Component id by name, or COMPONENT_ANY.
u32 level_find_component(const LevelKeys *keys, const char *name);
// True if entity tables of level text may have it (not: singletons, models, materials, drawables).
bool level_is_entity_component(const LevelKeys *keys, u32 component);
static inline const ColumnDesc *level_key_column(const LevelComponent *component,
                                                 const LevelKey *key) {
    return &component->desc->columns[key->column];
}
// True if the key takes "#rrggbb" and [r, g, b].
bool level_key_is_color(const LevelComponent *component, const LevelKey *key);
// True if a key of three elements also takes one number for all.
bool level_key_takes_scalar(const LevelComponent *component, const LevelKey *key);
// False if min and max are both 0: the column has no range.
static inline bool level_column_has_range(const ColumnDesc *column) {
    return column->min != 0 || column->max != 0;
}
// Word `index` of a list of words parted by spaces: its length, 0 past the end.
u32 level_word(const char *words, u32 index, const char **word);

// --- Names (level_names.c) ---

typedef enum LevelNameKind {
    NAME_ENTITY,
    NAME_MODEL,
    NAME_MATERIAL,
    NAME_PREFAB,
    NAME_POINTS, // hash of a point list's content
} LevelNameKind;

typedef struct LevelName {
    const char *text;
    u32 value; // Entity, or index of a prefab
    LevelNameKind kind;
    TomlPlace place;
} LevelName;

// Open addressing over (kind, text); `list` keeps the order of insertion, for suggestions.
typedef struct LevelNames {
    LevelName *list;
    u32 *slots; // index into list + 1, 0 = free
    u32 count, list_cap, slot_cap;
} LevelNames;

// NULL if it was new and is now in; else the one that was there first.
const LevelName *level_names_add(LevelNames *names, Arena *arena, LevelName name);
const LevelName *level_names_find(const LevelNames *names, LevelNameKind kind, const char *text);

// --- Values (level_values.c) ---

// References, textures and points get their ids when all rows are there, in the order of the
// tables: ids are then a function of the world and not of the order of the text. Until then a cell
// holds LATE_VALUE | index, which no id of a fresh world or store can be.
#define LATE_VALUE 0x80000000u

typedef enum LevelValueKind {
    VALUE_BITS,      // bits are what goes into the columns
    VALUE_REFERENCE, // bits[0] is an index into reader->references
    VALUE_TEXTURE,   // bits[0] is an index into reader->textures
    VALUE_POINTS,    // bits[0] is an index into reader->points
} LevelValueKind;

typedef struct LevelValue {
    LevelValueKind kind;
    u32 count;
    u32 bits[LEVEL_ELEMENTS_MAX];
} LevelValue;

// A name in level text that must become an Entity once all of them are there.
typedef struct LevelReference {
    const char *name;
    TomlPlace place;
    u32 component; // that the target must have, or COMPONENT_ANY
    u32 prefab;    // index of the prefab that it is written in, or UINT32_MAX
    u32 local;     // index of the target within that prefab, or UINT32_MAX: a global name
    Entity target; // of a global name, once found
    bool is_reported;
} LevelReference;

typedef struct LevelTexture {
    const char *path;
    const char *label; // of the key, for the message
    TomlPlace place;
    TextureKind kind;
    u32 id;
    bool is_loaded;
} LevelTexture;

typedef struct LevelPoints {
    f32 *xyz;
    u32 count;
    u32 list; // of the world, 0 until used
} LevelPoints;

// --- Blueprints (level_entities.c, level_repeat.c, level_vary.c) ---

typedef struct LevelAssignment {
    u16 component, column;
    LevelValueKind kind;
    u32 bits;
} LevelAssignment;

typedef enum RepeatKind { REPEAT_ROW, REPEAT_RING, REPEAT_SCATTER, REPEAT_GRID } RepeatKind;

typedef struct LevelRepeat {
    RepeatKind kind;
    u32 count;     // copies of this factor
    u32 counts[3]; // grid
    Vec3 a, b;     // row, grid: a = step; scatter: a = min, b = max
    f32 radius, start_deg;
    u32 axis; // 0 x, 1 y, 2 z
    bool face;
    bool has_seed;
    u64 seed;
} LevelRepeat;

typedef struct LevelVary {
    u16 component, column; // the first
    u32 count;             // elements
    ColumnType type;
    u64 key_hash;              // of "component.key"
    const LevelValue *choices; // or NULL: range
    u32 choice_count;
    bool is_uniform; // one draw for all elements
    f64 lo[LEVEL_ELEMENTS_MAX], hi[LEVEL_ELEMENTS_MAX];
} LevelVary;

typedef struct Blueprint {
    const char *name; // or NULL
    TomlPlace place, name_place, prefab_place, repeat_place;
    u32 prefab;     // index, or UINT32_MAX
    u32 parent;     // index into references, or UINT32_MAX
    u32 unnamed;    // how many unnamed entities came before: the key of random streams
    u64 components; // bit per component id
    u32 assignment_first, assignment_count; // in reader->assignments
    LevelVary *varies;
    LevelRepeat *repeats;
    u32 vary_count, repeat_count, copy_count;
    bool is_reported; // its name is taken, or its instance has no model
} Blueprint;

typedef struct LevelPrefab {
    const char *name;
    TomlPlace place;
    Blueprint *blueprints; // the first is the root
    u32 count;
    u32 height; // 1 + that of the highest prefab within
    u64 size;   // entities of one instance, saturated
    u8 state;   // of the search for cycles: 0 new, 1 on the way, 2 done
    bool is_used;
} LevelPrefab;

typedef struct LevelText {
    const char *data;
    u64 size;
    u64 *line_first; // offset of each line
    u32 line_count;
} LevelText;

// A reference that waits in a cell of the world.
typedef struct LevelPending {
    Entity entity; // ENTITY_NONE: done
    u16 component, column;
    u32 reference;
} LevelPending;

typedef struct LevelReader {
    const FileRoot *root;
    World *world;
    AssetStore *store;
    LevelInfo *info;
    Diagnostics *diagnostics;
    Arena *arena;     // the caller's: texts that outlive the load
    Arena scratch;    // everything else
    const char *file; // for messages
    LevelText text;
    LevelKeys keys;
    LevelNames names;
    LevelReference *references;
    LevelTexture *textures;
    LevelPoints *points;
    LevelAssignment *assignments;
    LevelPending *pendings;
    u32 reference_count, reference_cap, texture_count, texture_cap, point_count, point_cap,
        assignment_count, assignment_cap, pending_count, pending_cap, file_cap;
    LevelPrefab *prefabs;
    Blueprint *entities;
    u32 prefab_count, entity_count;
    u64 entity_total; // after repetition
    u32 suggestions_left;
} LevelReader;

// Makes room for one more element behind `count` (array doubled in the arena).
void *level_grow(Arena *arena, void *array, u32 count, u32 *cap, u64 element_size);
#define LEVEL_APPEND(arena, array, count, cap, ...)                                                \
    ((array) = level_grow((arena), (array), (count), &(cap), sizeof *(array)),                     \
     (array)[(count)++] = (__VA_ARGS__))

// --- Diagnostics (diagnostics.c) ---

// The place of what is wrong with the file as a whole.
#define LEVEL_WHOLE_FILE ((TomlPlace){0, 0, 0})

// hint may be NULL.
void level_error(LevelReader *reader, TomlPlace place, const char *hint, const char *format, ...)
    PRINTF_LIKE(4, 5);
void level_warning(LevelReader *reader, TomlPlace place, const char *hint, const char *format, ...)
    PRINTF_LIKE(4, 5);
void level_sort_diagnostics(Diagnostics *diagnostics);
// "did you mean" among the names of one kind, into out.
const char *level_suggest_name(LevelReader *reader, LevelNameKind kind, const char *word, char *out,
                               u64 out_cap);

// --- Readers. All report what they refuse; a false means "no value", never "stop". ---

// label names the key in messages: "light.intensity".
bool level_read_value(LevelReader *reader, const TomlNode *node, const char *label, u32 component,
                      const LevelKey *key, u32 prefab, LevelValue *out);
bool level_read_number(LevelReader *reader, const TomlNode *node, const char *label, f64 min,
                       f64 max, f64 *out);
bool level_read_integer(LevelReader *reader, const TomlNode *node, const char *label, i64 min,
                        i64 max, i64 *out);
bool level_read_bool(LevelReader *reader, const TomlNode *node, const char *label, bool *out);
bool level_read_string(LevelReader *reader, const TomlNode *node, const char *label,
                       const char **out);
// Three numbers, or one for all of them if takes_scalar.
bool level_read_vec3(LevelReader *reader, const TomlNode *node, const char *label, f64 limit,
                     Vec3 *out);
// A name: one line of 1 to LEVEL_NAME_MAX bytes ("a/b": twice that).
bool level_read_name(LevelReader *reader, const TomlNode *node, const char *label,
                     const char **out);
// A path that stays below the root, of a file that is there; it is added to info->files.
bool level_read_path(LevelReader *reader, const TomlNode *node, const char *label,
                     const char **out);
// "#rgb" or "#rrggbb" (sRGB) to linear. False if it is neither.
bool level_parse_color(const char *text, f32 rgb[3]);
bool level_is_table(LevelReader *reader, const TomlNode *node, const char *label);
// The list of tables [[name]] at the top or in a prefab: false (reported) if it is something else.
bool level_is_table_list(LevelReader *reader, const TomlNode *node, const char *label);
void level_add_file(LevelReader *reader, const char *path);

// Keys of one component table. `reserved` keys (parted by spaces) are skipped.
void level_read_component(LevelReader *reader, const TomlNode *table, u32 component,
                          const char *reserved, u32 prefab);

// [[prefab]] and [[entity]] into reader->prefabs and reader->entities.
void level_read_prefabs(LevelReader *reader, const TomlNode *list);
void level_read_entities(LevelReader *reader, const TomlNode *list);
void level_read_repeat(LevelReader *reader, const TomlNode *node, Blueprint *blueprint);
void level_read_vary(LevelReader *reader, const TomlNode *node, Blueprint *blueprint, u32 prefab);

// Where copy number `copy` of a repeated entity stands relative to the entity's own transform.
typedef struct LevelPlacement {
    Vec3 offset;
    bool is_rotated;
    bool is_yaw_only;
    f32 yaw_deg;
    Mat34 rotation;
} LevelPlacement;
LevelPlacement level_place_copy(const LevelRepeat *repeats, u32 repeat_count, u32 copy, u64 seed,
                                u64 stream);
// The value of one copy.
LevelValue level_draw_vary(const LevelVary *vary, u64 seed, u64 stream, u32 copy);

// [[model]] and [[material]] straight into the world.
void level_read_models(LevelReader *reader, const TomlNode *list);
void level_read_materials(LevelReader *reader, const TomlNode *list);
void level_fill_material(MaterialTable *materials, u32 row, const ModelMaterial *material);
const char *level_material_name(const Model *model, u32 index, const char *model_name, char *out,
                                u64 out_cap);

// Rows for all blueprints, references, drawables.
void level_spawn_all(LevelReader *reader);
// Writes a value into a cell of an entity that has the component.
void level_assign(LevelReader *reader, Entity entity, u32 component, u32 column,
                  LevelValueKind kind, u32 bits);
void level_spawn_all_drawables(LevelReader *reader, TomlPlace place);

// A .gltf or .glb file as a level.
void level_read_gltf(LevelReader *reader, const char *path);

#endif
