// level_keys.c: the keys of level text, from the column descriptions of the registered components.
// Data in: a world's ComponentDescs. Data out: per component its keys; "position[0]",
// "position[1]", "position[2]" are one key of three columns. Called by reader, writer and schema,
// so that the three cannot disagree. Does not: know any component by name, except those that entity
// tables cannot have.
#include "level_internal.h"
#include <stdlib.h>
#include <string.h>

// Length of the key's name without "[i]".
static u32 base_length(const char *key) {
    const char *bracket = strchr(key, '[');
    return bracket ? (u32)(bracket - key) : (u32)strlen(key);
}

static void create_component(LevelComponent *component, const ComponentDesc *desc, Arena *arena) {
    component->desc = desc;
    component->keys = ARENA_PUSH(arena, LevelKey, MAX(desc->column_count, 1u));
    for (u32 i = 0; i < desc->column_count; i++) {
        const char *text = desc->columns[i].key;
        if (!text[0]) continue;
        u32 length = base_length(text);
        LevelKey *last = component->key_count ? &component->keys[component->key_count - 1] : NULL;
        if (text[length] == '[' && last && strlen(last->name) == length &&
            strncmp(last->name, text, length) == 0) {
            // Elements of an array stand together, in order, with one type.
            LUZ_ASSERT((u32)atoi(text + length + 1) == last->count);
            LUZ_ASSERT(last->column + last->count == i && last->count < LEVEL_ELEMENTS_MAX);
            LUZ_ASSERT(desc->columns[last->column].type == desc->columns[i].type);
            last->count++;
            continue;
        }
        char *name = ARENA_PUSH(arena, char, length + 1);
        memcpy(name, text, length);
        component->keys[component->key_count++] = (LevelKey){name, i, 1};
    }
}

void level_keys_create(LevelKeys *keys, const World *world, Arena *arena) {
    *keys = (LevelKeys){.count = world->component_count};
    for (u32 i = 0; i < keys->count; i++)
        create_component(&keys->components[i], world->tables[i]->desc, arena);
}

const LevelKey *level_find_key(const LevelComponent *component, const char *name) {
    for (u32 i = 0; i < component->key_count; i++)
        if (strcmp(component->keys[i].name, name) == 0) return &component->keys[i];
    return NULL;
}

u32 level_find_component(const LevelKeys *keys, const char *name) {
    for (u32 i = 0; i < keys->count; i++)
        if (strcmp(keys->components[i].desc->name, name) == 0) return i;
    return COMPONENT_ANY;
}

bool level_is_entity_component(const LevelKeys *keys, u32 component) {
    return component < keys->count && !keys->components[component].desc->singleton &&
           component != COMPONENT_model && component != COMPONENT_material &&
           component != COMPONENT_drawable;
}

bool level_key_is_color(const LevelComponent *component, const LevelKey *key) {
    const ColumnDesc *column = level_key_column(component, key);
    return key->count == 3 && column->type == COLUMN_F32 && strcmp(column->unit, "linear") == 0;
}

bool level_key_takes_scalar(const LevelComponent *component, const LevelKey *key) {
    const ColumnDesc *column = level_key_column(component, key);
    return key->count == 3 && column->type == COLUMN_F32 && column->unit[0] == 0;
}

u32 level_word(const char *words, u32 index, const char **word) {
    for (;;) {
        while (*words == ' ') words++;
        u32 length = (u32)strcspn(words, " ");
        if (length == 0) return 0;
        if (index-- == 0) {
            *word = words;
            return length;
        }
        words += length;
    }
}

void *level_grow(Arena *arena, void *array, u32 count, u32 *cap, u64 element_size) {
    if (count < *cap) return array;
    u32 larger = *cap ? *cap * 2 : 64;
    void *copy = arena_push(arena, larger * element_size, 16);
    if (count > 0) memcpy(copy, array, count * element_size);
    *cap = larger;
    return copy;
}
