// table.c: sparse sets with separate columns, handled through their descriptions alone.
// Data in: a ComponentDesc and entities. Data out: dense rows in 64-byte aligned columns.
// Called by: the world, level/, systems and games. Does not: know any component, or whether an
// entity is alive (world_check compares).
//
// Memory: one block a table, cut into entity[cap], stamp[cap] and the columns in order. cap is a
// multiple of CAP_STEP, so that every array starts on a cache line and a whole SIMD vector can be
// read at any row below count. Invariant: the values of rows [count, cap) are zero in every
// column (a removed row is cleared), so padding lanes compute with zeros, and growing copies only
// what lives.
#include "table.h"
#include <stdlib.h>
#include <string.h>

#define CAP_STEP (CACHE_LINE / 4) // rows; 4-byte values
_Static_assert(CAP_STEP % SIMD_WIDTH == 0, "a column's end is a whole vector");
_Static_assert(sizeof(Table) % sizeof(void *) == 0, "column pointers follow the Table directly");
_Static_assert(sizeof(f32) == 4 && sizeof(Entity) == 4, "columns have 4-byte values");

// Bytes; arrays at such a distance from each other share few lines of a first-level cache.
#define STRIDE_BAD     1024
#define ROWS_FIRST     (4 * CAP_STEP) // rows of a table at its first row
#define ROW_OF_FIRST   256
#define POISON_BYTE    0xDD
#define CHECK_ALWAYS   64   // rows: up to here, table_check follows each mutation ...
#define CHECK_INTERVAL 1024 // ... beyond, it runs when count is a multiple of this

// Any column's values as bits. The pointer itself is always read and written as void *, which may
// stand for a pointer to any type; the values alias f32 and i32.
typedef u32 Bits __attribute__((may_alias));
static Bits *column_bits(Table *table, u32 column) { return table_columns(table)[column]; }

Table *table_create(const ComponentDesc *desc, u32 id, const u32 *clock) {
    LUZ_ASSERT(desc->table_size == sizeof(Table) + desc->column_count * sizeof(void *));
    LUZ_ASSERT(desc->column_count <= TABLE_COLUMNS_CAP);
    Table *table = calloc(1, desc->table_size);
    LUZ_ASSERT(table);
    table->desc = desc;
    table->id = id;
    table->clock = clock;
    table->structure_stamp = table->newest_stamp = *clock;
    return table;
}

static void block_free(void *block, u64 size) {
    if (!block) return;
#ifdef LUZ_POISON
    memset(block, POISON_BYTE, size); // a kept column pointer shows at once
#endif
    (void)size;
    free(block);
}

static u64 table_block_size(const Table *table, u32 cap) {
    return (u64)cap * 4 * (2 + table->desc->column_count);
}

void table_destroy(Table *table) {
    if (!table) return;
    block_free(table->entity, table_block_size(table, table->cap)); // entity[] starts the block
    free(table->row_of);
    free(table);
}

void table_reserve(Table *table, u32 row_cap) {
    LUZ_ASSERT(row_cap <= ENTITY_CAP); // one row an entity at most
    if (row_cap <= table->cap) return;
    u32 cap = (u32)ALIGN_UP(row_cap, CAP_STEP), old_cap = table->cap;
    if ((u64)cap * 4 % STRIDE_BAD == 0) cap += CAP_STEP;
    u64 size = table_block_size(table, cap);
    u32 *block = aligned_alloc(CACHE_LINE, size), *old = table->entity;
    LUZ_ASSERT(block);
    memset(block, 0, size);
    u32 array_count = 2 + table->desc->column_count;
    for (u32 i = 0; old && i < array_count; i++)
        memcpy(block + (u64)i * cap, old + (u64)i * old_cap, (u64)table->count * 4);
    block_free(old, table_block_size(table, old_cap));
    table->entity = block;
    table->stamp = block + cap;
    for (u32 i = 0; i < table->desc->column_count; i++)
        table_columns(table)[i] = block + (u64)(2 + i) * cap;
    table->cap = cap;
}

static void row_of_reserve(Table *table, u32 index) {
    if (index < table->row_of_cap) return;
    u32 cap = MAX(table->row_of_cap, ROW_OF_FIRST);
    while (cap <= index) cap *= 2; // ends: index < ENTITY_CAP = 2^20
    u32 *row_of = realloc(table->row_of, (u64)cap * 4);
    LUZ_ASSERT(row_of);
    memset(row_of + table->row_of_cap, 0xFF, (u64)(cap - table->row_of_cap) * 4); // ROW_NONE
    table->row_of = row_of;
    table->row_of_cap = cap;
}

static u32 column_default(const ColumnDesc *desc) {
    union {
        f32 f;
        i32 i;
        u32 u;
    } value;
    switch (desc->type) {
    case COLUMN_F32:
        value.f = (f32)desc->initial;
        break;
    case COLUMN_I32:
        value.i = (i32)desc->initial;
        break;
    default:
        value.u = (u32)desc->initial;
        break;
    }
    return value.u;
}

static void table_structure_changed(Table *table) {
    table->structure_stamp = table->newest_stamp = *table->clock;
#ifdef LUZ_POISON
    // A full check costs O(rows); after each of n insertions it would be O(n^2), which a level of
    // 200,000 entities does not survive.
    if (table->count <= CHECK_ALWAYS || table->count % CHECK_INTERVAL == 0) table_check(table);
#endif
}

u32 table_add(Table *table, Entity entity) {
    u32 index = ENTITY_INDEX(entity);
    LUZ_ASSERT(index != 0 && ENTITY_GENERATION(entity) != 0);
    u32 row = table_row(table, entity);
    if (row != ROW_NONE) return row;
    // A row under the same index belongs to another generation: the caller holds a stale handle.
    LUZ_ASSERT(index >= table->row_of_cap || table->row_of[index] == ROW_NONE);
    LUZ_ASSERT(!table->desc->singleton || table->count == 0);
    if (table->count == table->cap)
        table_reserve(table, MIN(MAX(table->cap * 2, ROWS_FIRST), ENTITY_CAP));
    row_of_reserve(table, index);

    row = table->count++;
    table->row_of[index] = row;
    table->entity[row] = entity;
    table->stamp[row] = *table->clock;
    for (u32 i = 0; i < table->desc->column_count; i++)
        column_bits(table, i)[row] = column_default(&table->desc->columns[i]);
    table_structure_changed(table);
    return row;
}

bool table_remove(Table *table, Entity entity) {
    u32 row = table_row(table, entity);
    if (row == ROW_NONE) return false;
    u32 last = --table->count;
    // When row == last the moves are self-assignments, and clearing comes after them.
    Entity moved = table->entity[last];
    table->entity[row] = moved;
    table->stamp[row] = table->stamp[last];
    table->row_of[ENTITY_INDEX(moved)] = row;
    table->row_of[ENTITY_INDEX(entity)] = ROW_NONE;
    table->entity[last] = ENTITY_NONE;
    table->stamp[last] = 0;
    for (u32 i = 0; i < table->desc->column_count; i++) {
        Bits *values = column_bits(table, i);
        values[row] = values[last];
        values[last] = 0;
    }
    table_structure_changed(table);
    return true;
}

void table_check(const Table *table) {
    LUZ_ASSERT(table->count <= table->cap && table->cap % CAP_STEP == 0);
    LUZ_ASSERT(!table->desc->singleton || table->count <= 1);
    LUZ_ASSERT(table->structure_stamp <= table->newest_stamp);
    for (u32 row = 0; row < table->count; row++) {
        u32 index = ENTITY_INDEX(table->entity[row]);
        LUZ_ASSERT(index != 0 && index < table->row_of_cap && table->row_of[index] == row);
        LUZ_ASSERT(table->stamp[row] <= table->newest_stamp);
    }
    // As every row is found from its index, one more index would be one too many.
    u32 mapped = 0;
    for (u32 index = 0; index < table->row_of_cap; index++)
        mapped += table->row_of[index] != ROW_NONE;
    LUZ_ASSERT(mapped == table->count);
    u32 padded = (u32)ALIGN_UP(table->count, SIMD_WIDTH);
    LUZ_ASSERT(padded <= table->cap);
    for (u32 i = 0; i < table->desc->column_count; i++) {
        const Bits *values = table_column(table, i);
        LUZ_ASSERT((uintptr_t)values % CACHE_LINE == 0);
        for (u32 row = table->count; row < padded; row++) LUZ_ASSERT(values[row] == 0);
    }
}

i32 table_find_column(const Table *table, const char *name) {
    for (u32 i = 0; i < table->desc->column_count; i++)
        if (strcmp(table->desc->columns[i].name, name) == 0) return (i32)i;
    return -1;
}
