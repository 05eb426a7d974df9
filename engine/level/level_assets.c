// level_assets.c: [[model]] and [[material]] to asset store and world.
// Data in: nodes. Data out: an entity with `model` per model, its file's materials as entities
// "model/material" with consecutive indices, an entity with `material` per declared material.
// Called by level_read.c before any entity is read, so that ids depend on the order of models and
// materials only. Does not: place anything.
#include "level_internal.h"
#include "../base/log.h"
#include <stdio.h>
#include <string.h>

#define SHAPE_DETAIL_MAX 512 // segments, rings

static const char *const model_keys[] = {"name",  "file", "shape",     "segments",
                                         "rings", "tube", "uv_repeat", "inverted"};

void level_fill_material(MaterialTable *m, u32 row, const ModelMaterial *material) {
    m->albedo_r[row] = CLAMP(material->albedo[0], 0.0f, 1.0f);
    m->albedo_g[row] = CLAMP(material->albedo[1], 0.0f, 1.0f);
    m->albedo_b[row] = CLAMP(material->albedo[2], 0.0f, 1.0f);
    m->specular_r[row] = CLAMP(material->specular[0], 0.0f, 1.0f);
    m->specular_g[row] = CLAMP(material->specular[1], 0.0f, 1.0f);
    m->specular_b[row] = CLAMP(material->specular[2], 0.0f, 1.0f);
    m->power[row] = CLAMP(material->power, 1.0f, 2048.0f);
    m->emissive_r[row] = CLAMP(material->emissive[0], 0.0f, 1.0f);
    m->emissive_g[row] = CLAMP(material->emissive[1], 0.0f, 1.0f);
    m->emissive_b[row] = CLAMP(material->emissive[2], 0.0f, 1.0f);
    m->emissive_strength[row] = CLAMP(material->emissive_strength, 0.0f, 1e5f);
    m->alpha_mode[row] = MIN(material->alpha_mode, (u32)ALPHA_BLEND);
    m->alpha_cutoff[row] = CLAMP(material->alpha_cutoff, 0.0f, 1.0f);
    m->double_sided[row] = material->double_sided;
    m->albedo_texture[row] = material->albedo_texture;
    m->normal_texture[row] = material->normal_texture;
    m->emissive_texture[row] = material->emissive_texture;
}

// Materials of one file may share a name or have none: then their number makes the difference.
const char *level_material_name(const Model *model, u32 index, const char *model_name, char *out,
                                u64 out_cap) {
    const char *own = model->materials[index].name;
    bool is_unique = own && own[0];
    for (u32 i = 0; i < index && is_unique; i++)
        is_unique = !model->materials[i].name || strcmp(model->materials[i].name, own) != 0;
    if (is_unique) {
        snprintf(out, out_cap, "%s/%.120s", model_name, own);
    } else {
        snprintf(out, out_cap, "%s/%.100s%s%u", model_name, own ? own : "",
                 own && own[0] ? "#" : "", index);
    }
    for (char *c = out; *c; c++)
        if ((u8)*c < 32 || (u8)*c == 127) *c = ' ';
    return out;
}

Entity level_spawn_model(World *world, const AssetStore *store, u32 model, const char *name) {
    Entity entity = world_spawn(world);
    ModelTable *models = WORLD_TABLE(world, Model, model);
    u32 row = table_add(&models->table, entity);
    models->model[row] = model;
    world_set_name(world, entity, name);
    const Model *source = &store->models[model];
    MaterialTable *materials = WORLD_TABLE(world, Material, material);
    for (u32 i = 0; i < source->material_count; i++) {
        Entity material = world_spawn(world);
        if (i == 0) models->first_material[row] = material;
        LUZ_ASSERT(ENTITY_INDEX(material) == ENTITY_INDEX(models->first_material[row]) + i);
        level_fill_material(materials, table_add(&materials->table, material),
                            &source->materials[i]);
        char material_name[LEVEL_NAME_MAX * 2 + 2];
        world_set_name(world, material,
                       level_material_name(source, i, name, material_name, sizeof material_name));
    }
    return entity;
}

static bool read_detail(LevelReader *reader, const TomlNode *node, u32 *out) {
    char label[64];
    snprintf(label, sizeof label, "model.%s", node->key);
    i64 value;
    if (!level_read_integer(reader, node, label, 0, SHAPE_DETAIL_MAX, &value)) return false;
    *out = (u32)value;
    return true;
}

static void read_shape_kind(LevelReader *reader, const TomlNode *node, ShapeDesc *shape) {
    const char *name;
    if (!level_read_string(reader, node, "model.shape", &name)) return;
    Suggestion suggestion = suggest_begin(name);
    for (u32 i = 0; i < SHAPE_COUNT; i++) {
        if (strcmp(name, shape_names[i]) == 0) {
            shape->shape = (Shape)i;
            return;
        }
        suggest_offer(&suggestion, shape_names[i]);
    }
    char hint[96];
    level_error(reader, node->place, suggest_hint(&suggestion, hint, sizeof hint),
                "model.shape: there is no shape '%.60s'", name);
}

static u32 load_model_file(LevelReader *reader, const TomlNode *node) {
    const char *path;
    if (!level_read_path(reader, node, "model.file", &path)) return 0;
    log_hush(LOG_SEVERITY_ERROR);
    u32 id = asset_load_model(reader->store, reader->root, path);
    log_hush(LOG_SEVERITY_NONE);
    if (id) return id;
    char reason[256];
    log_last_error(reason, sizeof reason);
    level_error(reader, node->place, NULL, "model.file: %s", reason);
    return 0;
}

static u32 read_model(LevelReader *reader, const TomlNode *table, const char **name,
                      TomlPlace *name_place) {
    ShapeDesc shape = {.shape = SHAPE_COUNT};
    const TomlNode *file = NULL, *shape_key = NULL, *detail = NULL, *tube = NULL;
    f64 number;
    *name = NULL;
    for (const TomlNode *node = table->first; node; node = node->next) {
        if (strcmp(node->key, "name") == 0) {
            *name_place = node->place;
            level_read_name(reader, node, "model.name", name);
            continue;
        } else if (strcmp(node->key, "file") == 0) {
            file = node;
            continue;
        } else if (strcmp(node->key, "shape") == 0) {
            shape_key = node;
            read_shape_kind(reader, node, &shape);
            continue;
        } else if (strcmp(node->key, "segments") == 0) {
            read_detail(reader, node, &shape.segments);
        } else if (strcmp(node->key, "rings") == 0) {
            read_detail(reader, node, &shape.rings);
        } else if (strcmp(node->key, "tube") == 0) {
            if (level_read_number(reader, node, "model.tube", 0.001, 0.5, &number))
                shape.tube = (f32)number;
            tube = node;
        } else if (strcmp(node->key, "uv_repeat") == 0) {
            if (level_read_number(reader, node, "model.uv_repeat", 0.001, 1000, &number))
                shape.uv_repeat = (f32)number;
        } else if (strcmp(node->key, "inverted") == 0) {
            level_read_bool(reader, node, "model.inverted", &shape.inverted);
        } else {
            Suggestion suggestion = suggest_begin(node->key);
            for (u32 i = 0; i < COUNT_OF(model_keys); i++)
                suggest_offer(&suggestion, model_keys[i]);
            char hint[96];
            level_error(reader, node->key_place, suggest_hint(&suggestion, hint, sizeof hint),
                        "unknown key '%.80s' of model", node->key);
            continue;
        }
        if (!detail) detail = node;
    }
    if (!toml_find(table, "name")) level_error(reader, table->place, NULL, "the model has no name");
    if (file && shape_key) {
        level_error(reader, shape_key->key_place, NULL, "a model has a file or a shape, not both");
    } else if (!file && !shape_key) {
        level_error(reader, table->place, "write file = \"models/x.glb\" or shape = \"cube\"",
                    "the model has neither file nor shape");
    } else if (file && detail) {
        level_error(reader, detail->key_place, NULL, "'%s' is for shapes, not for files",
                    detail->key);
    } else if (tube && shape.shape != SHAPE_TORUS && shape.shape != SHAPE_COUNT) {
        level_error(reader, tube->key_place, NULL, "only a torus has a tube");
    }
    if (file) return load_model_file(reader, file);
    if (!shape_key || shape.shape == SHAPE_COUNT) return 0;
    u32 id = asset_generate_model(reader->store, &shape);
    if (!id) level_error(reader, shape_key->place, NULL, "a limit of the asset store is reached");
    return id;
}

void level_read_models(LevelReader *reader, const TomlNode *list) {
    if (!level_is_table_list(reader, list, "model")) return;
    if (list->count > ASSET_MODELS_MAX) {
        level_error(reader, list->place, NULL, "%u models, the limit is %u", list->count,
                    ASSET_MODELS_MAX);
        return;
    }
    for (const TomlNode *table = list->first; table; table = table->next) {
        const char *name;
        TomlPlace name_place = table->place;
        u32 model = read_model(reader, table, &name, &name_place);
        if (!name) continue;
        Entity entity = level_spawn_model(reader->world, reader->store, model, name);
        const LevelName *old = level_names_add(&reader->names, &reader->scratch,
                                               (LevelName){name, entity, NAME_MODEL, name_place});
        if (old) {
            level_error(reader, name_place, NULL, "a model is already named '%s' (line %u)", name,
                        old->place.line);
            continue;
        }
        const Model *source = &reader->store->models[model];
        const ModelTable *models = WORLD_TABLE(reader->world, Model, model);
        Entity first = models->first_material[table_row(&models->table, entity)];
        for (u32 i = 0; i < source->material_count; i++) {
            u32 index = ENTITY_INDEX(first) + i;
            Entity material = (u32)reader->world->generation[index] << ENTITY_INDEX_BITS | index;
            const char *text =
                arena_copy_string(&reader->scratch, world_name(reader->world, material));
            level_names_add(&reader->names, &reader->scratch,
                            (LevelName){text, material, NAME_MATERIAL, name_place});
        }
    }
}

// A new entity, or that of a model's own material ("model/material"), which is then overridden.
static Entity material_entity(LevelReader *reader, const char *name, TomlPlace place) {
    const LevelName *old = level_names_find(&reader->names, NAME_MATERIAL, name);
    if (strchr(name, '/')) {
        if (old) return old->value;
        char hint[192];
        level_error(reader, place,
                    level_suggest_name(reader, NAME_MATERIAL, name, hint, sizeof hint),
                    "no model has a material '%s'", name);
        return ENTITY_NONE;
    }
    if (old) {
        level_error(reader, place, NULL, "a material is already named '%s' (line %u)", name,
                    old->place.line);
        return ENTITY_NONE;
    }
    Entity entity = world_spawn(reader->world);
    table_add(reader->world->tables[COMPONENT_material], entity);
    world_set_name(reader->world, entity, name);
    level_names_add(&reader->names, &reader->scratch,
                    (LevelName){name, entity, NAME_MATERIAL, place});
    return entity;
}

void level_read_materials(LevelReader *reader, const TomlNode *list) {
    if (!level_is_table_list(reader, list, "material")) return;
    if (list->count > LEVEL_ENTITIES_MAX) {
        level_error(reader, list->place, NULL, "%u materials, the limit is %u", list->count,
                    LEVEL_MATERIALS_MAX);
        return;
    }
    for (const TomlNode *table = list->first; table; table = table->next) {
        const TomlNode *node = toml_find(table, "name");
        const char *name;
        Entity entity = ENTITY_NONE;
        if (!node) {
            level_error(reader, table->place, NULL, "the material has no name");
        } else if (level_read_name(reader, node, "material.name", &name)) {
            entity = material_entity(reader, name, node->place);
        }
        u32 first = reader->assignment_count;
        level_read_component(reader, table, COMPONENT_material, "name", UINT32_MAX);
        for (u32 i = first; entity != ENTITY_NONE && i < reader->assignment_count; i++) {
            const LevelAssignment *a = &reader->assignments[i];
            level_assign(reader, entity, a->component, a->column, a->kind, a->bits);
        }
    }
}
