// level_entities.c: entity tables ([[entity]] and [[prefab.entity]]) to blueprints.
// Data in: nodes. Data out: reader->entities and reader->prefabs: per table its components, its
// assignments in one shared array, what varies and how often it repeats; references within a prefab
// and cycles of prefabs are settled here. Called by level_read.c. Does not: touch the world; a
// prefab's mistakes are reported once, however often it is used.
#include "level_internal.h"
#include <stdio.h>
#include <string.h>

static const char *const entity_keys[] = {"name", "prefab", "parent", "repeat", "vary"};

static bool is_reserved(const char *reserved, const char *key) {
    const char *word;
    u32 length;
    for (u32 i = 0; (length = level_word(reserved, i, &word)) > 0; i++)
        if (strlen(key) == length && strncmp(word, key, length) == 0) return true;
    return false;
}

static void report_unknown_key(LevelReader *reader, const TomlNode *node,
                               const LevelComponent *component, const char *reserved) {
    Suggestion suggestion = suggest_begin(node->key);
    char words[8][48], hint[160];
    const char *word;
    u32 length;
    for (u32 i = 0; i < COUNT_OF(words) && (length = level_word(reserved, i, &word)) > 0; i++) {
        snprintf(words[i], sizeof words[i], "%.*s", (int)length, word);
        suggest_offer(&suggestion, words[i]);
    }
    for (u32 i = 0; i < component->key_count; i++)
        suggest_offer(&suggestion, component->keys[i].name);
    level_error(reader, node->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                "unknown key '%.80s' of %s", node->key, component->desc->name);
}

void level_read_component(LevelReader *reader, const TomlNode *table, u32 component,
                          const char *reserved, u32 prefab) {
    const LevelComponent *owner = &reader->keys.components[component];
    for (const TomlNode *node = table->first; node; node = node->next) {
        if (is_reserved(reserved, node->key)) continue;
        const LevelKey *key = level_find_key(owner, node->key);
        if (!key) {
            report_unknown_key(reader, node, owner, reserved);
            continue;
        }
        char label[128];
        snprintf(label, sizeof label, "%s.%s", owner->desc->name, key->name);
        LevelValue value;
        if (!level_read_value(reader, node, label, component, key, prefab, &value)) continue;
        for (u32 i = 0; i < value.count; i++) {
            LEVEL_APPEND(&reader->scratch, reader->assignments, reader->assignment_count,
                         reader->assignment_cap,
                         (LevelAssignment){.component = (u16)component,
                                           .column = (u16)(key->column + i),
                                           .kind = value.kind,
                                           .bits = value.bits[i]});
        }
    }
}

// A key that is neither the entity's own nor a component: perhaps a key of some component, written
// without it.
static void report_unknown_component(LevelReader *reader, const TomlNode *node) {
    const LevelKeys *keys = &reader->keys;
    u32 component = level_find_component(keys, node->key);
    if (component != COMPONENT_ANY) {
        const char *hint = keys->components[component].desc->singleton ? "it is a table at the top"
                           : component == COMPONENT_drawable ? "drawables are made from instances"
                           : component == COMPONENT_model    ? "write [[model]] at the top"
                                                             : "write [[material]] at the top";
        level_error(reader, node->key_place, hint, "an entity cannot have '%s'", node->key);
        return;
    }
    char hint[160];
    Suggestion suggestion = suggest_begin(node->key);
    for (u32 i = 0; i < COUNT_OF(entity_keys); i++) suggest_offer(&suggestion, entity_keys[i]);
    for (u32 i = 0; i < keys->count; i++)
        if (level_is_entity_component(keys, i))
            suggest_offer(&suggestion, keys->components[i].desc->name);
    suggest_hint(&suggestion, hint, sizeof hint);
    for (u32 i = 0; i < keys->count; i++) {
        if (!level_is_entity_component(keys, i) || !level_find_key(&keys->components[i], node->key))
            continue;
        snprintf(hint, sizeof hint, "did you mean '%s.%.64s'?", keys->components[i].desc->name,
                 node->key);
        break;
    }
    level_error(reader, node->key_place, hint, "unknown component '%.80s'", node->key);
}

static u32 add_parent(LevelReader *reader, const TomlNode *node, u32 prefab) {
    const char *name;
    if (!level_read_name(reader, node, "parent", &name)) return UINT32_MAX;
    LEVEL_APPEND(&reader->scratch, reader->references, reader->reference_count,
                 reader->reference_cap,
                 (LevelReference){.name = name,
                                  .place = node->place,
                                  .component = COMPONENT_transform,
                                  .prefab = prefab,
                                  .local = UINT32_MAX});
    return reader->reference_count - 1;
}

static void read_prefab_name(LevelReader *reader, const TomlNode *node, Blueprint *blueprint) {
    const char *name;
    if (!level_read_name(reader, node, "prefab", &name)) return;
    const LevelName *found = level_names_find(&reader->names, NAME_PREFAB, name);
    if (!found) {
        char hint[192];
        level_error(reader, node->place,
                    level_suggest_name(reader, NAME_PREFAB, name, hint, sizeof hint),
                    "no prefab is named '%s'", name);
        return;
    }
    blueprint->prefab = found->value;
    blueprint->prefab_place = node->place;
    reader->prefabs[found->value].is_used = true;
}

// prefab: index of the one that the table stands in, or UINT32_MAX.
static void read_blueprint(LevelReader *reader, const TomlNode *table, u32 prefab, bool is_root,
                           Blueprint *blueprint) {
    *blueprint = (Blueprint){
        .place = table->place,
        .prefab = UINT32_MAX,
        .parent = UINT32_MAX,
        .components = 1ull << COMPONENT_transform,
        .assignment_first = reader->assignment_count,
        .copy_count = 1,
    };
    if (table->type != TOML_TABLE) return;
    for (const TomlNode *node = table->first; node; node = node->next) {
        if (strcmp(node->key, "name") == 0) {
            if (level_read_name(reader, node, "name", &blueprint->name))
                blueprint->name_place = node->place;
        } else if (strcmp(node->key, "prefab") == 0) {
            read_prefab_name(reader, node, blueprint);
        } else if (is_root &&
                   (strcmp(node->key, "parent") == 0 || strcmp(node->key, "repeat") == 0)) {
            level_error(reader, node->key_place, "write it where the prefab is used",
                        "the root of a prefab cannot have '%s'", node->key);
        } else if (strcmp(node->key, "parent") == 0) {
            blueprint->parent = add_parent(reader, node, prefab);
        } else if (strcmp(node->key, "repeat") == 0) {
            blueprint->repeat_place = node->key_place;
            level_read_repeat(reader, node, blueprint);
        } else if (strcmp(node->key, "vary") == 0) {
            level_read_vary(reader, node, blueprint, prefab);
        } else {
            u32 component = level_find_component(&reader->keys, node->key);
            if (!level_is_entity_component(&reader->keys, component)) {
                report_unknown_component(reader, node);
                continue;
            }
            blueprint->components |= 1ull << component;
            if (level_is_table(reader, node, node->key))
                level_read_component(reader, node, component, "", prefab);
        }
    }
    blueprint->assignment_count = reader->assignment_count - blueprint->assignment_first;
}

// Names within a prefab: unique, and known to the references written in it.
static void settle_local_names(LevelReader *reader, LevelPrefab *prefab, u32 index,
                               u32 reference_first) {
    LevelNames local = {0};
    for (u32 i = 0; i < prefab->count; i++) {
        const Blueprint *blueprint = &prefab->blueprints[i];
        if (!blueprint->name) continue;
        const LevelName *old =
            level_names_add(&local, &reader->scratch,
                            (LevelName){blueprint->name, i, NAME_ENTITY, blueprint->name_place});
        if (old)
            level_error(reader, blueprint->name_place, NULL,
                        "'%s' is already an entity of this prefab (line %u)", blueprint->name,
                        old->place.line);
    }
    for (u32 i = reference_first; i < reader->reference_count; i++) {
        LevelReference *reference = &reader->references[i];
        if (reference->prefab != index || reference->component == COMPONENT_model ||
            reference->component == COMPONENT_material)
            continue;
        const LevelName *found = level_names_find(&local, NAME_ENTITY, reference->name);
        if (found) reference->local = found->value;
    }
    // A parent inside a prefab is always one of its own.
    for (u32 i = 1; i < prefab->count; i++) {
        Blueprint *blueprint = &prefab->blueprints[i];
        if (blueprint->parent == UINT32_MAX) continue;
        LevelReference *reference = &reader->references[blueprint->parent];
        if (reference->local != UINT32_MAX) continue;
        reference->is_reported = true;
        Suggestion suggestion = suggest_begin(reference->name);
        for (u32 k = 0; k < local.count; k++) suggest_offer(&suggestion, local.list[k].text);
        char hint[192];
        level_error(reader, reference->place, suggest_hint(&suggestion, hint, sizeof hint),
                    "no entity of this prefab is named '%s'", reference->name);
        blueprint->parent = UINT32_MAX;
    }
}

static void read_prefab(LevelReader *reader, const TomlNode *table, u32 index) {
    LevelPrefab *prefab = &reader->prefabs[index];
    u32 reference_first = reader->reference_count;
    const TomlNode *list = NULL;
    for (const TomlNode *node = table->first; node; node = node->next) {
        if (strcmp(node->key, "name") == 0) continue; // read before
        if (strcmp(node->key, "entity") == 0) {
            if (level_is_table_list(reader, node, "prefab.entity")) list = node;
            continue;
        }
        Suggestion suggestion = suggest_begin(node->key);
        suggest_offer(&suggestion, "name");
        suggest_offer(&suggestion, "entity");
        char hint[96];
        suggest_hint(&suggestion, hint, sizeof hint);
        if (level_is_entity_component(&reader->keys,
                                      level_find_component(&reader->keys, node->key)))
            snprintf(hint, sizeof hint, "write it below [[prefab.entity]]");
        level_error(reader, node->key_place, hint, "unknown key '%.80s' of prefab", node->key);
    }
    if (!list || list->count == 0) {
        if (!toml_find(table, "entity"))
            level_error(reader, prefab->place, "write [[prefab.entity]] below it",
                        "the prefab has no entity");
        return;
    }
    prefab->count = list->count;
    prefab->blueprints = ARENA_PUSH(&reader->scratch, Blueprint, list->count);
    u32 i = 0;
    for (const TomlNode *node = list->first; node; node = node->next, i++) {
        read_blueprint(reader, node, index, i == 0, &prefab->blueprints[i]);
        prefab->blueprints[i].unnamed = i;
    }
    settle_local_names(reader, prefab, index, reference_first);
}

// Depth first over prefabs in prefabs: breaks cycles, bounds the depth, counts entities. Recursion
// ends at LEVEL_PREFAB_DEPTH_MAX: what lies deeper on the way is cut there and reported.
static void settle_prefab(LevelReader *reader, u32 index, u32 depth) {
    LevelPrefab *prefab = &reader->prefabs[index];
    prefab->state = 1;
    prefab->size = 0;
    prefab->height = 1;
    for (u32 i = 0; i < prefab->count; i++) {
        Blueprint *blueprint = &prefab->blueprints[i];
        u64 size = 1;
        if (blueprint->prefab != UINT32_MAX) {
            LevelPrefab *inner = &reader->prefabs[blueprint->prefab];
            bool is_deep = depth >= LEVEL_PREFAB_DEPTH_MAX;
            if (inner->state == 0 && !is_deep) settle_prefab(reader, blueprint->prefab, depth + 1);
            if (inner->state == 1) {
                level_error(reader, blueprint->prefab_place, NULL,
                            "prefab '%s' contains itself by way of '%s'", inner->name,
                            prefab->name);
                blueprint->prefab = UINT32_MAX;
            } else if (inner->state == 0 || inner->height >= LEVEL_PREFAB_DEPTH_MAX) {
                level_error(reader, blueprint->prefab_place, NULL,
                            "prefabs are nested more than %u deep", LEVEL_PREFAB_DEPTH_MAX);
                blueprint->prefab = UINT32_MAX;
            } else {
                prefab->height = MAX(prefab->height, inner->height + 1);
                size = MAX(inner->size, 1u);
            }
        }
        prefab->size = MIN(prefab->size + size * blueprint->copy_count, (u64)1 << 32);
    }
    prefab->state = 2;
}

void level_read_prefabs(LevelReader *reader, const TomlNode *list) {
    if (!level_is_table_list(reader, list, "prefab")) return;
    reader->prefabs = ARENA_PUSH(&reader->scratch, LevelPrefab, MAX(list->count, 1u));
    reader->prefab_count = list->count;
    u32 i = 0;
    for (const TomlNode *table = list->first; table; table = table->next, i++) {
        LevelPrefab *prefab = &reader->prefabs[i];
        *prefab = (LevelPrefab){.name = "", .place = table->place};
        const TomlNode *name = toml_find(table, "name");
        if (!name) {
            level_error(reader, table->place, NULL, "the prefab has no name");
        } else if (level_read_name(reader, name, "name", &prefab->name)) {
            const LevelName *old =
                level_names_add(&reader->names, &reader->scratch,
                                (LevelName){prefab->name, i, NAME_PREFAB, name->place});
            if (old)
                level_error(reader, name->place, NULL, "a prefab is already named '%s' (line %u)",
                            prefab->name, old->place.line);
        }
    }
    i = 0;
    for (const TomlNode *table = list->first; table; table = table->next)
        read_prefab(reader, table, i++);
    for (i = 0; i < reader->prefab_count; i++)
        if (reader->prefabs[i].state == 0) settle_prefab(reader, i, 1);
}

void level_read_entities(LevelReader *reader, const TomlNode *list) {
    if (!level_is_table_list(reader, list, "entity")) return;
    reader->entities = ARENA_PUSH(&reader->scratch, Blueprint, MAX(list->count, 1u));
    reader->entity_count = list->count;
    u32 i = 0, unnamed = 0, refused = 0;
    for (const TomlNode *table = list->first; table; table = table->next, i++) {
        Blueprint *blueprint = &reader->entities[i];
        read_blueprint(reader, table, UINT32_MAX, false, blueprint);
        if (!blueprint->name) blueprint->unnamed = unnamed++;
        u64 size =
            blueprint->prefab == UINT32_MAX ? 1 : MAX(reader->prefabs[blueprint->prefab].size, 1u);
        size *= blueprint->copy_count;
        if (reader->entity_total + size > LEVEL_ENTITIES_MAX) {
            if (refused++ == 0)
                level_error(reader,
                            blueprint->repeat_count ? blueprint->repeat_place : blueprint->place,
                            NULL, "with this the level has %llu entities, the limit is %u",
                            (unsigned long long)(reader->entity_total + size), LEVEL_ENTITIES_MAX);
            // One stays, so that its name is known; a list that is itself too long is cut.
            blueprint->copy_count = refused <= 1000 ? 1 : 0;
            blueprint->prefab = UINT32_MAX;
            continue;
        }
        reader->entity_total += size;
    }
}
