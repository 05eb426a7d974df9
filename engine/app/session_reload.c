// session_reload.c: a level whose files changed on disk is loaded again while it runs.
// Data in: stamps of the files that the level was made from. Data out: the session with a fresh
// world (the player keeps place and view), or diagnostics and the old world.
// Called by: the shells, a few times a second. Does not: watch by inotify (one stat a file is
// cheap, and works on every file system), keep anything else of the old world.
#include "../base/log.h"
#include "session_internal.h"
#include <stdlib.h>
#include <string.h>

static void row_save(const Table *table, Entity entity, u32 *out) {
    u32 row = table_row(table, entity);
    for (u32 c = 0; c < table->desc->column_count && c < PLAYER_COLUMNS_CAP; c++)
        out[c] = ((const u32 *)table_column(table, c))[row];
}

static void row_restore(Table *table, Entity entity, const u32 *values) {
    u32 row = table_row(table, entity);
    for (u32 c = 0; c < table->desc->column_count && c < PLAYER_COLUMNS_CAP; c++) {
        // Handles and lists of the old world mean nothing in the new one.
        ColumnType type = table->desc->columns[c].type;
        if (type == COLUMN_ENTITY || type == COLUMN_POINTS || type == COLUMN_TEXTURE) continue;
        ((u32 *)table_columns(table)[c])[row] = values[c];
    }
    table_touch(table, row);
}

static bool player_is_whole(const Session *session) {
    return session->world && session->player != ENTITY_NONE &&
           table_row(session->world->tables[COMPONENT_transform], session->player) != ROW_NONE &&
           table_row(session->world->tables[COMPONENT_walker], session->player) != ROW_NONE;
}

void player_place_save(const Session *session, PlayerPlace *out) {
    out->valid = player_is_whole(session);
    if (!out->valid) return;
    row_save(session->world->tables[COMPONENT_transform], session->player, out->transform);
    row_save(session->world->tables[COMPONENT_walker], session->player, out->walker);
}

void player_place_restore(Session *session, const PlayerPlace *place) {
    if (!place->valid || !player_is_whole(session)) return;
    row_restore(session->world->tables[COMPONENT_transform], session->player, place->transform);
    row_restore(session->world->tables[COMPONENT_walker], session->player, place->walker);
}

int session_poll_reload(Session *session) {
    if (!session->world) return 0;
    u32 file_count = session->level.file_count;
    u64 *now = calloc(MAX(file_count, 1), sizeof *now);
    LUZ_ASSERT(now);
    bool changed = false;
    for (u32 i = 0; i < file_count; i++) {
        now[i] = file_root_stamp(&session->root, session->level.files[i]);
        // Editors replace a file in two steps; while it is away there is nothing to load.
        if (now[i] == 0) now[i] = session->file_stamps[i];
        changed |= now[i] != session->file_stamps[i];
    }
    for (u32 i = 0; i < session->refused_count && session->refused_stamps; i++) {
        u64 stamp = file_root_stamp(&session->root, session->refused_files[i]);
        changed |= stamp != 0 && stamp != session->refused_stamps[i];
    }
    if (!changed) {
        free(now);
        return 0;
    }
    PlayerPlace place;
    player_place_save(session, &place);
    char root[sizeof session->root_path], relative[sizeof session->level_path];
    memcpy(root, session->root_path, sizeof root);
    memcpy(relative, session->level_path, sizeof relative);
    session->stamps_before_load = now;
    bool ok = session_load_below(session, root, relative, &place);
    session->stamps_before_load = NULL;
    if (ok) {
        LOG(LEVEL_RELOADED, "'%s': %u entities", relative, session->level.entity_count);
        free(now);
        return 1;
    }
    // The broken state is known now: the next poll waits for the next edit.
    free(session->file_stamps);
    session->file_stamps = now;
    session->refused_stamps = calloc(MAX(session->refused_count, 1), sizeof(u64));
    LUZ_ASSERT(session->refused_stamps);
    for (u32 i = 0; i < session->refused_count; i++)
        session->refused_stamps[i] = file_root_stamp(&session->root, session->refused_files[i]);
    return -1;
}
