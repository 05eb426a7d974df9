// recording_check.c: compares a replayed world with its recording, and names what differs.
// Data in: a Recording, the world after each tick. Data out: equal, or the first table, column and
// row that differ, with both values where one row alone differs. Called by: replay in tools and
// shells. Does not: go on after a difference in any useful way: everything follows from the first.
#include "recording_internal.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct CheckTable {
    char name[64];
    const Table *table; // of the replayed world, NULL = this build has none such
    u32 first, column_count;
    u32 rows; // recorded
} CheckTable;

typedef struct CheckColumn {
    char name[64];
    u32 table;
    i32 column;    // in the world's table, -1 = this build has none such
    bool derived;  // follows from others: a worse name for the cause
    ColumnSum sum; // recorded
} CheckColumn;

struct RecordingCheck {
    const Recording *recording;
    ByteReader reader; // behind the last tick that was taken
    u32 tick, sum_tick_count;
    u32 table_count, column_count;
    CheckTable *tables;
    CheckColumn *columns;
};

static void read_sum(ByteReader *reader, ColumnSum *out) {
    out->s0 = byte_read_u64(reader);
    out->s1 = byte_read_u64(reader);
}

static void bind_column(CheckColumn *column, const Table *table) {
    column->column = -1;
    if (!table) return;
    for (u32 c = 0; c < sum_column_count(table); c++)
        if (strcmp(sum_column_name(table, c), column->name) == 0) column->column = (i32)c;
    if (column->column >= 0 && (u32)column->column < table->desc->column_count)
        column->derived = table->desc->columns[column->column].key[0] == 0;
}

RecordingCheck *recording_check_create(const Recording *recording, const World *world,
                                       Arena *arena) {
    RecordingCheck *check = ARENA_PUSH(arena, RecordingCheck, 1);
    check->recording = recording;
    check->reader =
        (ByteReader){.data = recording->column_sums, .size = recording->column_sums_size};
    ByteReader *reader = &check->reader; // recording_read walked it: nothing here can fail
    check->sum_tick_count = byte_read_u32(reader);
    check->table_count = byte_read_u16(reader);
    check->tables = ARENA_PUSH(arena, CheckTable, check->table_count + 1);
    // Counted first: the columns are one array.
    ByteReader ahead = *reader;
    char name[64];
    for (u32 t = 0; t < check->table_count; t++) {
        byte_read_text(&ahead, name, sizeof name);
        u32 column_count = byte_read_u16(&ahead);
        for (u32 c = 0; c < column_count; c++) byte_read_text(&ahead, name, sizeof name);
        check->column_count += column_count;
    }
    check->columns = ARENA_PUSH(arena, CheckColumn, check->column_count + 1);
    u32 flat = 0;
    for (u32 t = 0; t < check->table_count; t++) {
        CheckTable *table = &check->tables[t];
        byte_read_text(reader, table->name, sizeof table->name);
        table->table = world_find_table(world, table->name);
        table->first = flat;
        table->column_count = byte_read_u16(reader);
        for (u32 c = 0; c < table->column_count; c++, flat++) {
            CheckColumn *column = &check->columns[flat];
            column->table = t;
            byte_read_text(reader, column->name, sizeof column->name);
            bind_column(column, table->table);
        }
    }
    for (u32 t = 0; t < check->table_count; t++) {
        CheckTable *table = &check->tables[t];
        table->rows = byte_read_u32(reader);
        for (u32 c = 0; c < table->column_count; c++)
            read_sum(reader, &check->columns[table->first + c].sum);
    }
    return check;
}

// Takes the next tick's changes into the recorded counts and sums.
static void check_advance(RecordingCheck *check) {
    check->tick++;
    if (check->tick > check->sum_tick_count) return;
    ByteReader *reader = &check->reader;
    u32 changed = byte_read_u16(reader);
    for (u32 i = 0; i < changed; i++) {
        u32 table = byte_read_u16(reader);
        check->tables[table].rows = byte_read_u32(reader);
    }
    changed = byte_read_u16(reader);
    for (u32 i = 0; i < changed; i++) {
        u32 column = byte_read_u16(reader);
        read_sum(reader, &check->columns[column].sum);
    }
}

// --- naming the difference ---

__attribute__((format(printf, 2, 3))) static void say(RecordingDifference *out, const char *format,
                                                      ...) {
    u64 used = strlen(out->text);
    va_list args;
    va_start(args, format);
    vsnprintf(out->text + used, sizeof out->text - used, format, args);
    va_end(args);
}

// The fewest digits that read back to the same number.
static void format_f32(f32 number, char *out, u64 out_cap) {
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(out, out_cap, "%.*g", digits, (f64)number);
        if (strtof(out, NULL) == number) return;
    }
}

static void format_value(const ColumnDesc *desc, u32 value, char *out, u64 out_cap) {
    f32 number;
    memcpy(&number, &value, sizeof number);
    const char *word = desc && desc->type == COLUMN_ENUM ? desc->unit : NULL;
    for (u32 i = 0; word && i < value; i++) {
        word = strchr(word, ' ');
        word += word != NULL;
    }
    if (word)
        snprintf(out, out_cap, "%.*s", (int)strcspn(word, " "), word);
    else if (desc && desc->type == COLUMN_F32)
        format_f32(number, out, out_cap);
    else if (desc && desc->type == COLUMN_I32)
        snprintf(out, out_cap, "%d", (i32)value);
    else
        snprintf(out, out_cap, "%u", value);
}

// The one row whose value differs, and the recorded value; ROW_NONE if there are several.
static u32 find_row(const u32 *values, u32 count, ColumnSum now, ColumnSum recorded, u32 *value) {
    u64 d0 = now.s0 - recorded.s0, d1 = now.s1 - recorded.s1;
    u32 found = ROW_NONE;
    for (u32 i = 0; i < count; i++) {
        u32 old;
        if ((i + 1ull) * d0 != d1 || !column_sum_unmix(column_sum_mix(values[i]) - d0, &old))
            continue;
        if (found != ROW_NONE) return ROW_NONE;
        found = i, *value = old;
    }
    return found;
}

static void name_column(const RecordingCheck *check, const World *world, u32 index, ColumnSum now,
                        u32 others, RecordingDifference *out) {
    const CheckColumn *column = &check->columns[index];
    const Table *table = check->tables[column->table].table;
    const u32 *values = sum_column_values(table, (u32)column->column);
    snprintf(out->table, sizeof out->table, "%s", table->desc->name);
    snprintf(out->column, sizeof out->column, "%s", column->name);
    u32 recorded = 0;
    out->row = find_row(values, table->count, now, column->sum, &recorded);
    say(out, "%s.%s ", out->table, out->column);
    if (out->row == ROW_NONE) {
        say(out, "differs in several of %u rows", table->count);
    } else {
        bool is_column = (u32)column->column < table->desc->column_count;
        const ColumnDesc *desc = is_column ? &table->desc->columns[column->column] : NULL;
        char is[64], was[64];
        format_value(desc, values[out->row], is, sizeof is);
        format_value(desc, recorded, was, sizeof was);
        out->entity = table->entity[out->row];
        const char *name = world_name(world, out->entity);
        if (name[0])
            say(out, "of '%.64s' (row %u)", name, out->row);
        else
            say(out, "of row %u (entity %u)", out->row, ENTITY_INDEX(out->entity));
        say(out, " is %s, recorded %s", is, was);
    }
    if (others)
        say(out, "; %u more column%s differ%s", others, others > 1 ? "s" : "",
            others > 1 ? "" : "s");
}

// Tables that are missing or have another count of rows: columns say nothing then.
static bool name_structure(const RecordingCheck *check, RecordingDifference *out) {
    for (u32 t = 0; t < check->table_count; t++) {
        const CheckTable *table = &check->tables[t];
        u32 rows = table->table ? table->table->count : 0;
        if (rows == table->rows) continue;
        snprintf(out->table, sizeof out->table, "%s", table->name);
        if (table->table)
            say(out, "table %s has %u rows, recorded %u", table->name, rows, table->rows);
        else
            say(out, "this build has no table %s, recorded with %u rows", table->name, table->rows);
        return true;
    }
    return false;
}

static void name_difference(const RecordingCheck *check, const World *world,
                            RecordingDifference *out) {
    *out = (RecordingDifference){.tick = check->tick, .row = ROW_NONE};
    if (check->tick == 0)
        say(out, "at the start: ");
    else
        say(out, "tick %u: ", check->tick);
    if (check->tick > check->sum_tick_count) {
        say(out, "the world differs (the recording has no column sums so late)");
        return;
    }
    if (name_structure(check, out)) return;
    // Columns that a level can set come before those that follow from them.
    u32 first[2] = {UINT32_MAX, UINT32_MAX}, differing = 0;
    ColumnSum first_sum[2] = {0};
    for (u32 i = 0; i < check->column_count; i++) {
        const CheckColumn *column = &check->columns[i];
        const Table *table = check->tables[column->table].table;
        if (!table || column->column < 0) continue;
        ColumnSum now = column_sum(sum_column_values(table, (u32)column->column), table->count);
        if (now.s0 == column->sum.s0 && now.s1 == column->sum.s1) continue;
        differing++;
        if (first[column->derived] != UINT32_MAX) continue;
        first[column->derived] = i;
        first_sum[column->derived] = now;
    }
    u32 pick = first[0] != UINT32_MAX ? 0 : 1;
    if (differing)
        name_column(check, world, first[pick], first_sum[pick], differing - 1, out);
    else if (world->seed != check->recording->info.seed)
        say(out, "all columns are equal, and the seed is %llu, recorded %llu",
            (unsigned long long)world->seed, (unsigned long long)check->recording->info.seed);
    else
        say(out, "all columns are equal; entities, point lists or columns unknown to one of the "
                 "builds differ");
}

bool recording_check_tick(RecordingCheck *check, u32 tick, const World *world,
                          RecordingDifference *difference) {
    const Recording *recording = check->recording;
    LUZ_ASSERT(tick <= recording->tick_count && (tick == check->tick || tick == check->tick + 1));
    if (tick > check->tick) check_advance(check);
    u64 expected = tick == 0 ? recording->start_hash : recording->world_hashes[tick - 1];
    if (world_hash(world) == expected) return true;
    name_difference(check, world, difference);
    return false;
}
