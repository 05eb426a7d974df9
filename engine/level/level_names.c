// level_names.c: names of entities, models, materials and prefabs, to be found in constant time.
// Data in: names in the order of the file. Data out: who has a name, and the nearest one for a
// hint. Called by the readers while they fill the world. Does not: copy the texts (they live in the
// reader's arena), or forget a name.
#include "level_internal.h"
#include "../base/hash.h"
#include <string.h>

static u32 find_slot(const LevelNames *names, LevelNameKind kind, const char *text) {
    u32 slot = (u32)hash_bytes(text, strlen(text), kind) & (names->slot_cap - 1);
    while (names->slots[slot]) {
        const LevelName *name = &names->list[names->slots[slot] - 1];
        if (name->kind == kind && strcmp(name->text, text) == 0) break;
        slot = (slot + 1) & (names->slot_cap - 1);
    }
    return slot;
}

const LevelName *level_names_find(const LevelNames *names, LevelNameKind kind, const char *text) {
    if (names->slot_cap == 0) return NULL;
    u32 slot = find_slot(names, kind, text);
    return names->slots[slot] ? &names->list[names->slots[slot] - 1] : NULL;
}

const LevelName *level_names_add(LevelNames *names, Arena *arena, LevelName name) {
    const LevelName *old = level_names_find(names, name.kind, name.text);
    if (old) return old;
    LEVEL_APPEND(arena, names->list, names->count, names->list_cap, name);
    if (names->count * 2 > names->slot_cap) {
        names->slot_cap = MAX(names->slot_cap * 2, 256u);
        names->slots = ARENA_PUSH(arena, u32, names->slot_cap);
        for (u32 i = 0; i < names->count; i++)
            names->slots[find_slot(names, names->list[i].kind, names->list[i].text)] = i + 1;
    } else {
        names->slots[find_slot(names, name.kind, name.text)] = names->count;
    }
    return NULL;
}

const char *level_suggest_name(LevelReader *reader, LevelNameKind kind, const char *word, char *out,
                               u64 out_cap) {
    Suggestion suggestion = suggest_begin(word);
    if (reader->diagnostics->count < LEVEL_DIAGNOSTICS_MAX) {
        for (u32 i = 0; i < reader->names.count && reader->suggestions_left > 0; i++) {
            if (reader->names.list[i].kind != kind) continue;
            reader->suggestions_left--;
            suggest_offer(&suggestion, reader->names.list[i].text);
        }
    }
    return suggest_hint(&suggestion, out, out_cap);
}
