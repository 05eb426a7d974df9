// level_spawn.c: blueprints to entities and rows; then references, cycles of parents, drawables.
// Data in: the reader's blueprints and prefabs, models and materials already in the world. Data
// out: rows, in an order that is a function of the file alone: entities as written, copies after
// each other, a prefab's entities after their root. So text that level_write makes of a loaded
// level spawns the same handles and rows again. Called by level_read.c; level_spawn_drawables also
// by games while they run. Does not: stop at a mistake; the world of a level with errors is thrown
// away by the caller.
//
// Material of a drawable: that of the instance if it has one; else of the model: its materials are
// entities with consecutive indices, so part.material is added to the index of
// model.first_material.
#include "level_internal.h"
#include "../base/log.h"
#include "../base/hash.h"
#include <stdio.h>
#include <string.h>

static u32 point_list(LevelReader *reader, u32 index) {
    LevelPoints *points = &reader->points[index];
    if (points->list) return points->list;
    // Equal lists are one, so that ids depend on what is used and not on how it is written. They
    // are found by the hash of their content, as a name.
    u64 size = (u64)points->count * 3 * sizeof(f32);
    const char *name = arena_format(&reader->scratch, "%u:%016llx", points->count,
                                    (unsigned long long)hash_bytes(points->xyz, size, 0));
    const LevelName *old = level_names_find(&reader->names, NAME_POINTS, name);
    const f32 *xyz;
    if (old && world_points(reader->world, old->value, &xyz) == points->count &&
        memcmp(xyz, points->xyz, size) == 0)
        return points->list = old->value;
    points->list = world_add_points(reader->world, points->xyz, points->count);
    level_names_add(&reader->names, &reader->scratch,
                    (LevelName){name, points->list, NAME_POINTS, (TomlPlace){0}});
    return points->list;
}

void level_assign(LevelReader *reader, Entity entity, u32 component, u32 column,
                  LevelValueKind kind, u32 bits) {
    Table *table = reader->world->tables[component];
    u32 row = table_row(table, entity);
    u32 *cells = table_columns(table)[column];
    cells[row] = kind == VALUE_BITS ? bits : LATE_VALUE | bits;
    if (kind == VALUE_REFERENCE)
        LEVEL_APPEND(&reader->scratch, reader->pendings, reader->pending_count, reader->pending_cap,
                     (LevelPending){entity, (u16)component, (u16)column, bits});
}

// Writes what a reference means, unless another value has overridden it since.
static void settle_pending(LevelReader *reader, const LevelPending *pending, Entity target) {
    Table *table = reader->world->tables[pending->component];
    u32 *cell = (u32 *)table_columns(table)[pending->column] + table_row(table, pending->entity);
    if (*cell == (LATE_VALUE | pending->reference)) *cell = target;
}

static u64 all_components(const LevelReader *reader, const Blueprint *blueprint) {
    u64 components = blueprint->components;
    while (blueprint->prefab != UINT32_MAX && reader->prefabs[blueprint->prefab].count > 0) {
        blueprint = &reader->prefabs[blueprint->prefab].blueprints[0];
        components |= blueprint->components;
    }
    return components;
}

// The values of the prefab's root first, so that the entity's own override them.
static void apply_values(LevelReader *reader, const Blueprint *blueprint, Entity entity, u64 stream,
                         u32 copy) {
    if (blueprint->prefab != UINT32_MAX && reader->prefabs[blueprint->prefab].count > 0)
        apply_values(reader, &reader->prefabs[blueprint->prefab].blueprints[0], entity, stream,
                     copy);
    const LevelAssignment *assignments = reader->assignments + blueprint->assignment_first;
    for (u32 i = 0; i < blueprint->assignment_count; i++) {
        const LevelAssignment *a = &assignments[i];
        level_assign(reader, entity, a->component, a->column, a->kind, a->bits);
    }
    for (u32 i = 0; i < blueprint->vary_count; i++) {
        const LevelVary *vary = &blueprint->varies[i];
        LevelValue value = level_draw_vary(vary, reader->world->seed, stream, copy);
        for (u32 k = 0; k < value.count; k++)
            level_assign(reader, entity, vary->component, vary->column + k, value.kind,
                         value.bits[k]);
    }
}

static void apply_placement(World *world, Entity entity, const LevelPlacement *placement) {
    TransformTable *t = WORLD_TABLE(world, Transform, transform);
    u32 row = table_row(&t->table, entity);
    t->x[row] += placement->offset.x;
    t->y[row] += placement->offset.y;
    t->z[row] += placement->offset.z;
    if (!placement->is_rotated) return;
    if (placement->is_yaw_only) {
        t->yaw[row] += placement->yaw_deg; // exact: yaw is the outermost rotation
        return;
    }
    Mat34 own = mat34_from_trs(vec3(0, 0, 0), vec3(t->pitch[row], t->yaw[row], t->roll[row]),
                               vec3(1, 1, 1));
    own = mat34_mul(placement->rotation, own);
    Vec3 rotation = mat34_rotation_deg(&own);
    t->pitch[row] = rotation.x;
    t->yaw[row] = rotation.y;
    t->roll[row] = rotation.z;
}

// An instance that nothing gives a model draws nothing: hardly what was meant.
static void check_instance(LevelReader *reader, Blueprint *blueprint, u32 pending_first) {
    for (u32 i = pending_first; i < reader->pending_count; i++)
        if (reader->pendings[i].component == COMPONENT_instance) return;
    if (!blueprint->is_reported)
        level_warning(reader, blueprint->place, "write instance.model = \"...\"",
                      "the instance has no model");
    blueprint->is_reported = true;
}

static void name_entity(LevelReader *reader, Blueprint *blueprint, Entity entity, const char *name,
                        bool is_top) {
    const LevelName *old = level_names_add(
        &reader->names, &reader->scratch,
        (LevelName){name, entity, NAME_ENTITY, is_top ? blueprint->name_place : blueprint->place});
    if (!old) {
        world_set_name(reader->world, entity, name);
        return;
    }
    if (blueprint->is_reported) return;
    blueprint->is_reported = true;
    level_error(reader, blueprint->name_place, NULL, "an entity is already named '%s' (line %u)",
                name, old->place.line);
}

static Entity spawn_copies(LevelReader *reader, Blueprint *blueprint, const char *prefix,
                           Entity parent, u64 stream);

// The entities of a prefab beside its root, which is `root`; then the references between them.
static void spawn_prefab(LevelReader *reader, u32 index, const char *name, Entity root, u64 stream,
                         u32 pending_first) {
    LevelPrefab *prefab = &reader->prefabs[index];
    if (prefab->count == 0) return;
    if (prefab->blueprints[0].prefab != UINT32_MAX)
        spawn_prefab(reader, prefab->blueprints[0].prefab, name, root, stream, pending_first);
    Entity *members = ARENA_PUSH(&reader->scratch, Entity, prefab->count);
    members[0] = root;
    for (u32 i = 1; i < prefab->count; i++)
        members[i] = spawn_copies(reader, &prefab->blueprints[i], name, root, stream);
    for (u32 i = pending_first; i < reader->pending_count; i++) {
        LevelPending *pending = &reader->pendings[i];
        if (pending->entity == ENTITY_NONE) continue;
        LevelReference *reference = &reader->references[pending->reference];
        if (reference->prefab != index || reference->local == UINT32_MAX) continue;
        Entity target = members[reference->local];
        if (reference->component != COMPONENT_ANY && !reference->is_reported &&
            table_row(reader->world->tables[reference->component], target) == ROW_NONE) {
            reference->is_reported = true;
            level_error(reader, reference->place, NULL, "'%s' has no %s", reference->name,
                        reader->keys.components[reference->component].desc->name);
        }
        settle_pending(reader, pending, target);
        // Parents stay listed for the search for cycles.
        if (pending->component != COMPONENT_transform) pending->entity = ENTITY_NONE;
    }
}

// Own stream of random numbers: by name if it has one, else by its number among the unnamed, within
// the stream of what it stands in.
static u64 stream_of(const Blueprint *blueprint, u64 outer) {
    return blueprint->name ? hash_bytes(blueprint->name, strlen(blueprint->name), outer)
                           : hash_bytes(&blueprint->unnamed, sizeof blueprint->unnamed, ~outer);
}

// All copies of one blueprint; the first of them. prefix: name of the prefab instance around it, or
// NULL at the top, or "" in an unnamed one (its entities have no names).
static Entity spawn_copies(LevelReader *reader, Blueprint *blueprint, const char *prefix,
                           Entity parent, u64 outer_stream) {
    World *world = reader->world;
    Entity first = ENTITY_NONE;
    u64 stream = stream_of(blueprint, outer_stream);
    u64 components = all_components(reader, blueprint);
    for (u32 copy = 0; copy < blueprint->copy_count; copy++) {
        Entity entity = world_spawn(world);
        if (entity == ENTITY_NONE) return first; // bounded before: not reached in a fresh world
        if (copy == 0) first = entity;
        u32 pending_first = reader->pending_count;
        for (u32 i = 0; i < world->component_count; i++)
            if (components >> i & 1) table_add(world->tables[i], entity);
        const char *name = "";
        if (blueprint->name && (!prefix || prefix[0])) {
            name = arena_format(&reader->scratch, copy ? "%s%s%s.%u" : "%s%s%s",
                                prefix ? prefix : "", prefix ? "/" : "", blueprint->name, copy);
            name_entity(reader, blueprint, entity, name, prefix == NULL);
        }
        apply_values(reader, blueprint, entity, stream, copy);
        if (components >> COMPONENT_instance & 1) check_instance(reader, blueprint, pending_first);
        if (blueprint->repeat_count > 0) {
            LevelPlacement placement = level_place_copy(blueprint->repeats, blueprint->repeat_count,
                                                        copy, world->seed, stream);
            apply_placement(world, entity, &placement);
        }
        TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
        if (blueprint->parent == UINT32_MAX) {
            transforms->parent[table_row(&transforms->table, entity)] = parent;
        } else {
            i32 column = table_find_column(&transforms->table, "parent");
            level_assign(reader, entity, COMPONENT_transform, (u32)column, VALUE_REFERENCE,
                         blueprint->parent);
        }
        if (blueprint->prefab != UINT32_MAX) {
            u64 inner = hash_bytes(&copy, sizeof copy, stream);
            spawn_prefab(reader, blueprint->prefab, name, entity, inner, pending_first);
        }
    }
    return first;
}

// Kind of name that a reference means: by the component that its target must have.
static LevelNameKind kind_of(const LevelReference *reference) {
    return reference->component == COMPONENT_model      ? NAME_MODEL
           : reference->component == COMPONENT_material ? NAME_MATERIAL
                                                        : NAME_ENTITY;
}

static void find_target(LevelReader *reader, LevelReference *reference) {
    LevelNameKind kind = kind_of(reference);
    const LevelName *found = level_names_find(&reader->names, kind, reference->name);
    if (!found && reference->component == COMPONENT_ANY) {
        found = level_names_find(&reader->names, NAME_MODEL, reference->name);
        if (!found) found = level_names_find(&reader->names, NAME_MATERIAL, reference->name);
    }
    const char *what = kind == NAME_MODEL ? "model" : kind == NAME_MATERIAL ? "material" : "entity";
    if (!found) {
        char hint[192];
        reference->is_reported = true;
        level_error(reader, reference->place,
                    level_suggest_name(reader, kind, reference->name, hint, sizeof hint),
                    "no %s is named '%.127s'", what, reference->name);
        return;
    }
    reference->target = found->value;
    if (reference->component == COMPONENT_ANY ||
        table_row(reader->world->tables[reference->component], found->value) != ROW_NONE)
        return;
    reference->is_reported = true;
    level_error(reader, reference->place, NULL, "entity '%s' has no %s", reference->name,
                reader->keys.components[reference->component].desc->name);
}

static void settle_references(LevelReader *reader) {
    for (u32 i = 0; i < reader->pending_count; i++) {
        LevelPending *pending = &reader->pendings[i];
        LevelReference *reference = &reader->references[pending->reference];
        if (pending->entity == ENTITY_NONE || reference->local != UINT32_MAX) continue;
        if (!reference->target && !reference->is_reported) find_target(reader, reference);
        settle_pending(reader, pending, reference->target);
    }
    // A prefab that nothing uses, a value that another overrides: names there are checked as well.
    for (u32 i = 0; i < reader->reference_count; i++) {
        LevelReference *reference = &reader->references[i];
        if (reference->local == UINT32_MAX && !reference->target && !reference->is_reported)
            find_target(reader, reference);
    }
}

static u32 load_texture(LevelReader *reader, LevelTexture *texture) {
    if (texture->is_loaded) return texture->id;
    texture->is_loaded = true;
    log_hush(LOG_SEVERITY_WARNING);
    texture->id = asset_load_texture(reader->store, reader->root, texture->path, texture->kind);
    log_hush(LOG_SEVERITY_NONE);
    if (texture->id > 1) return texture->id; // 1 is the checker for damaged images
    char reason[256];
    log_last_error(reason, sizeof reason);
    level_error(reader, texture->place, NULL, "%s: %s", texture->label, reason);
    return texture->id;
}

static void settle_textures_and_points(LevelReader *reader) {
    for (u32 i = 0; i < reader->world->component_count; i++) {
        Table *table = reader->world->tables[i];
        for (u32 column = 0; column < table->desc->column_count; column++) {
            ColumnType type = table->desc->columns[column].type;
            if (type != COLUMN_TEXTURE && type != COLUMN_POINTS) continue;
            u32 *cells = table_columns(table)[column];
            for (u32 row = 0; row < table->count; row++) {
                if (!(cells[row] & LATE_VALUE)) continue;
                u32 index = cells[row] & ~LATE_VALUE;
                cells[row] = type == COLUMN_POINTS ? point_list(reader, index)
                                                   : load_texture(reader, &reader->textures[index]);
            }
        }
    }
    // What nothing uses in the end is checked as well.
    for (u32 i = 0; i < reader->texture_count; i++) load_texture(reader, &reader->textures[i]);
}

static void report_parent_cycle(LevelReader *reader, Entity entity) {
    for (u32 i = 0; i < reader->pending_count; i++) {
        const LevelPending *pending = &reader->pendings[i];
        if (pending->entity != entity || pending->component != COMPONENT_transform) continue;
        LevelReference *reference = &reader->references[pending->reference];
        if (!reference->is_reported)
            level_error(reader, reference->place, NULL,
                        "'%s' makes a circle of parents: each must lead to one without",
                        reference->name);
        reference->is_reported = true;
        return;
    }
}

// Every chain of parents must end. Rows are marked with the round in which they were first seen; a
// chain that meets its own round is a cycle, and is cut there.
static void cut_parent_cycles(LevelReader *reader) {
    TransformTable *t = WORLD_TABLE(reader->world, Transform, transform);
    u32 *round = ARENA_PUSH(&reader->scratch, u32, t->table.count + 1);
    for (u32 start = 0; start < t->table.count; start++) {
        u32 row = start;
        while (row != ROW_NONE && round[row] == 0) {
            round[row] = start + 1;
            u32 next = t->parent[row] ? table_row(&t->table, t->parent[row]) : ROW_NONE;
            if (next != ROW_NONE && round[next] == start + 1) {
                report_parent_cycle(reader, t->table.entity[row]);
                t->parent[row] = ENTITY_NONE;
                break;
            }
            row = next;
        }
    }
}

void level_spawn_drawables(World *world, const AssetStore *store, Entity entity) {
    InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    ModelTable *models = WORLD_TABLE(world, Model, model);
    u32 row = table_row(&instances->table, entity);
    if (row == ROW_NONE) return;
    u32 model_row = table_row(&models->table, instances->model[row]);
    if (model_row == ROW_NONE || models->model[model_row] >= store->model_count) return;
    const Model *model = &store->models[models->model[model_row]];
    u32 first_material = ENTITY_INDEX(models->first_material[model_row]);
    for (u32 i = 0; i < model->part_count; i++) {
        const ModelPart *part = &model->parts[i];
        Entity material = instances->material[row];
        u32 index = first_material + part->material;
        if (material == ENTITY_NONE && index < world->entity_slots)
            material = (u32)world->generation[index] << ENTITY_INDEX_BITS | index;
        Entity drawable = world_spawn(world);
        if (drawable == ENTITY_NONE) return;
        DrawableTable *drawables = WORLD_TABLE(world, Drawable, drawable);
        u32 to = table_add(&drawables->table, drawable);
        drawables->owner[to] = entity;
        drawables->mesh[to] = part->mesh;
        drawables->material[to] = material;
        columns_set_mat34(&drawables->l00, to, part->local.m);
        table_touch(&drawables->table, to);
    }
}

static u64 count_parts(const World *world, const AssetStore *store) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const ModelTable *models = WORLD_TABLE(world, Model, model);
    u64 parts = 0;
    for (u32 i = 0; i < instances->table.count; i++) {
        u32 row = table_row(&models->table, instances->model[i]);
        if (row != ROW_NONE && models->model[row] < store->model_count)
            parts += store->models[models->model[row]].part_count;
    }
    return parts;
}

void level_spawn_all_drawables(LevelReader *reader, TomlPlace place) {
    World *world = reader->world;
    u64 parts = count_parts(world, reader->store);
    if (world->entities_alive + parts >= ENTITY_CAP) {
        level_error(reader, place, NULL,
                    "the level's instances have %llu parts, the limit with all entities is %u",
                    (unsigned long long)parts, ENTITY_CAP - 1);
        return;
    }
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    for (u32 i = 0; i < instances->table.count; i++)
        level_spawn_drawables(world, reader->store, instances->table.entity[i]);
    const DrawableTable *drawables = WORLD_TABLE(world, Drawable, drawable);
    const MaterialTable *materials = WORLD_TABLE(world, Material, material);
    u8 *is_used = ARENA_PUSH(&reader->scratch, u8, materials->table.count + 1);
    u32 used = 0;
    for (u32 i = 0; i < drawables->table.count; i++) {
        u32 row = table_row(&materials->table, drawables->material[i]);
        if (row == ROW_NONE || is_used[row]) continue;
        is_used[row] = 1;
        used++;
    }
    if (used > LEVEL_MATERIALS_MAX)
        level_error(reader, place, NULL, "the level uses %u materials, the limit is %u", used,
                    LEVEL_MATERIALS_MAX);
}

void level_spawn_all(LevelReader *reader) {
    for (u32 i = 0; i < reader->entity_count; i++)
        spawn_copies(reader, &reader->entities[i], NULL, ENTITY_NONE, 0);
    settle_references(reader);
    settle_textures_and_points(reader);
    cut_parent_cycles(reader);
}
