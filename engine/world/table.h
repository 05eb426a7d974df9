// table.h: one component = one table: a sparse set of rows whose columns are separate arrays.
//
// Data: dense rows [0, count); entity[row]; row_of[entity index] back; stamp[row] of the last
// change; the columns, each an array of 4-byte values, aligned to CACHE_LINE and padded to
// SIMD_WIDTH rows (padding is zero), so that a system reads just what it needs, 8 rows at a time.
// Removing a row moves the last one into its place (order is therefore a function of history,
// which is deterministic). A table's columns are declared once, in an X-macro list:
//
//   #define DOOR_COLUMNS(C)
//       C(F32, angle_max, "deg", 90, "angle", 0, 180, "how far it opens")
//       C(ENUM, state, "closed opening open closing", 0, "", 0, 3, "what it does")
//
// (each line continued by a backslash), where an entry is
// C(type, name, unit, default, level key, min, max, help). An empty level key makes a derived
// column: computed by systems, not read from level text. "position[0]" is element 0 of the array
// key "position". An ENUM's unit lists its words in order. From this list come the struct, the
// allocation, swap-remove, hashing, saving, the level keys with their checks, the JSON schema and
// the inspector.
#ifndef LUZ_TABLE_H
#define LUZ_TABLE_H
#include "../base/base.h"
#ifdef __cplusplus
extern "C" {
#endif

// 32-bit handle: index in the low ENTITY_INDEX_BITS, generation above; 0 is never valid (slot 0
// is never handed out). A slot whose generation would wrap is retired.
typedef u32 Entity;
#define ENTITY_NONE       0u
#define ENTITY_INDEX_BITS 20
#define ENTITY_INDEX(e)   ((e) & ((1u << ENTITY_INDEX_BITS) - 1))
#define ENTITY_GENERATION(e) ((e) >> ENTITY_INDEX_BITS)
#define ENTITY_CAP        (1u << ENTITY_INDEX_BITS)

typedef enum ColumnType {
    COLUMN_F32,
    COLUMN_U32,
    COLUMN_I32,
    COLUMN_BOOL,    // u32 0 or 1
    COLUMN_ENUM,    // u32 index into the words of `unit`
    COLUMN_ENTITY,  // Entity; `unit` names the component that the target must have ("" = any);
                    // level text gives the target's name
    COLUMN_TEXTURE, // u32 texture id of the asset store, 0 = none; level text gives a path
    COLUMN_POINTS,  // u32 point list id of the world, 0 = none; level text gives [[x,y,z], ...]
} ColumnType;
typedef f32 ColumnF32;
typedef u32 ColumnU32, ColumnBOOL, ColumnENUM, ColumnENTITY, ColumnTEXTURE, ColumnPOINTS;
typedef i32 ColumnI32;

typedef struct ColumnDesc {
    const char *name, *unit, *key, *help;
    ColumnType type;
    f64 initial;  // default value
    f64 min, max; // of what level text may say, inclusive
} ColumnDesc;

typedef struct ComponentDesc {
    const char *name; // the level's key for it
    const char *help;
    const ColumnDesc *columns;
    u32 column_count;
    u32 table_size;  // sizeof the typed table struct
    bool singleton;  // at most one row; level text writes it as a top-level [name]
} ComponentDesc;

#define ROW_NONE          UINT32_MAX
#define TABLE_COLUMNS_CAP 256 // columns of one component

typedef struct Table {
    const ComponentDesc *desc;
    u32 id;              // component id in its world
    u32 count, cap;      // rows
    Entity *entity;      // [cap]
    u32 *stamp;          // [cap] the world's stamp when the row last changed
    u32 *row_of;         // [ENTITY_CAP used part] row of an entity index, ROW_NONE = has none
    u32 row_of_cap;
    u32 structure_stamp; // the world's stamp when a row was last added or removed
    u32 newest_stamp;    // max of stamp[] and structure_stamp ever: "did anything change since?"
    const u32 *clock;    // the world's stamp counter
} Table;

// A typed table: struct LightTable { Table table; f32 *color_r; ... }. Its column pointers lie
// directly after the Table in declaration order; generic code reaches them through
// table_column.
#define COLUMN_POINTER_(type, name, ...) Column##type *name;
#define COLUMN_DESC_(type, name, unit, initial, key, min, max, help) \
    {#name, unit, key, help, COLUMN_##type, initial, min, max},
#define TABLE_STRUCT(Name, COLUMNS) \
    typedef struct Name##Table { Table table; COLUMNS(COLUMN_POINTER_) } Name##Table;
// Defines `const ComponentDesc name##_component`.
#define COMPONENT_DEFINE(Name, name, COLUMNS, is_singleton, help)                     \
    static const ColumnDesc name##_columns_[] = {COLUMNS(COLUMN_DESC_)};              \
    const ComponentDesc name##_component = {                                          \
        #name, help, name##_columns_, COUNT_OF(name##_columns_), sizeof(Name##Table), \
        is_singleton};

static inline void **table_columns(Table *table) { return (void **)(table + 1); }
static inline const void *table_column(const Table *table, u32 column) {
    return ((void *const *)(table + 1))[column];
}

// Made and freed by the world; `clock` is its stamp counter.
Table *table_create(const ComponentDesc *desc, u32 id, const u32 *clock);
void table_destroy(Table *table);

// Adds a row with the columns' defaults (all derived columns likewise); if the entity has one
// already, returns that one unchanged. Column pointers are invalid after a call that grows.
u32 table_add(Table *table, Entity entity);
// False if it has no row.
bool table_remove(Table *table, Entity entity);
// Row of an entity or ROW_NONE, also for stale handles.
static inline u32 table_row(const Table *table, Entity entity) {
    u32 index = ENTITY_INDEX(entity);
    if (index >= table->row_of_cap) return ROW_NONE;
    u32 row = table->row_of[index];
    return row != ROW_NONE && table->entity[row] == entity ? row : ROW_NONE;
}
// Says that a row's data changed: everything derived from it follows by comparing stamps. Not from
// jobs (newest_stamp is shared): there a job sets stamp[row] = *clock of its own rows, and the
// caller sets newest_stamp after the loop.
static inline void table_touch(Table *table, u32 row) {
    table->stamp[row] = table->newest_stamp = *table->clock;
}
// True if anything in the table changed at or after `stamp`.
static inline bool table_changed_since(const Table *table, u32 stamp) {
    return table->newest_stamp >= stamp;
}
void table_reserve(Table *table, u32 row_cap);
// Sanity check of the sparse set (both maps agree, padding is zero); asserts. Debug builds
// (LUZ_POISON) run it after each mutation of a small table and now and then on a large one.
void table_check(const Table *table);
// Column index by name, or -1.
i32 table_find_column(const Table *table, const char *name);

#ifdef __cplusplus
}
#endif
#endif
