// system_table.c: the order in which systems run, and how long each took.
// Data in: rows (name, reads, writes, function). Data out: one tick of the world; ms per row.
// Called by: shells, tools and tests on the main thread. Does not: decide what a system does, check
// `reads`/`writes` (they inform people), or let a clock into the simulation (times go out only).
//
// Stamps: the world's stamp advances before every row, so what row r writes in this tick is newer
// than everything r saw, and `stamp > last_stamp` finds exactly what others changed since r last
// began. It advances once more after the last row, so that edits between ticks (loading, hot
// reload, the inspector) are seen by all rows.
#include "systems.h"
#include "../base/clock.h"
#include <string.h>

void systems_create(SystemTable *table) {
    static const System engine_rows[] = {
        {"animate", "orbit path flicker pulse", "transform light", system_animate},
        {"walk", "instance camera environment", "walker transform", system_walk},
        {"transform", "transform", "transform drawable light", system_transform},
        {"bounds", "drawable instance", "drawable", system_bounds},
    };
    memset(table, 0, sizeof *table);
    for (u32 i = 0; i < COUNT_OF(engine_rows); i++) systems_insert(table, NULL, &engine_rows[i]);
}

bool systems_insert(SystemTable *table, const char *before, const System *system) {
    if (table->count == SYSTEMS_CAP) return false;
    u32 place = table->count;
    if (before) {
        for (place = 0; place < table->count; place++)
            if (strcmp(table->rows[place].name, before) == 0) break;
        if (place == table->count) return false;
    }
    u32 moved = table->count - place;
    memmove(&table->rows[place + 1], &table->rows[place], moved * sizeof table->rows[0]);
    memmove(&table->last_stamp[place + 1], &table->last_stamp[place], moved * sizeof(u32));
    memmove(&table->ms[place + 1], &table->ms[place], moved * sizeof(f32));
    table->rows[place] = *system;
    table->last_stamp[place] = 0;
    table->ms[place] = 0;
    table->count++;
    return true;
}

static void run_row(SystemTable *table, u32 row, SystemContext *context) {
    context->last_stamp = table->last_stamp[row];
    table->last_stamp[row] = world_advance_stamp(context->world);
    u64 mark = arena_mark(context->scratch);
    f64 start_ms = clock_now_ms();
    table->rows[row].function(context);
    table->ms[row] = (f32)(clock_now_ms() - start_ms);
    arena_rewind(context->scratch, mark);
}

void systems_tick(SystemTable *table, SystemContext *context) {
    for (u32 row = 0; row < table->count; row++) run_row(table, row, context);
    world_advance_stamp(context->world);
    context->world->tick++;
}

void systems_settle(SystemTable *table, SystemContext *context) {
    for (u32 row = 0; row < table->count; row++) {
        SystemFunction function = table->rows[row].function;
        if (function == system_transform || function == system_bounds) run_row(table, row, context);
    }
    world_advance_stamp(context->world);
}
