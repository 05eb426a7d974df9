// level_write.c: a world back to level text.
// Data in: rows. Data out: text that loads to the same handles, rows and hash (of a world that came
// from a level; derived columns start again at their defaults). Called by the tools and the
// editor's save. Does not: write what loading makes by itself (drawables, models' own materials:
// only what differs from the file's), nor prefabs, repetition, titles and comments: the world does
// not have them any more.
#include "level_internal.h"
#include "level_text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct LevelWriter {
    const World *world;
    const AssetStore *store;
    Arena scratch;
    LevelKeys keys;
    LevelNames names;
    const char **name_of;  // by entity index; "" = has none and needs none
    u8 *is_model_material; // by entity index
    TextBuilder text;
} LevelWriter;

static u32 cell(const Table *table, u32 column, u32 row) {
    return ((const u32 *)table_column(table, column))[row];
}

static f64 number_of(ColumnType type, u32 bits) {
    f32 value;
    memcpy(&value, &bits, 4);
    return type == COLUMN_F32 ? (f64)value : type == COLUMN_I32 ? (f64)(i32)bits : (f64)bits;
}

static u32 initial_bits(const ColumnDesc *column) {
    f32 value = (f32)column->initial;
    u32 bits;
    memcpy(&bits, &value, 4);
    return column->type == COLUMN_F32   ? bits
           : column->type == COLUMN_I32 ? (u32)(i32)column->initial
                                        : (u32)column->initial;
}

static Entity entity_at(const World *world, u32 index) {
    return (u32)world->generation[index] << ENTITY_INDEX_BITS | index;
}

static bool is_written(const LevelWriter *writer, Entity entity) {
    for (u32 i = 0; i < writer->keys.count; i++)
        if (level_is_entity_component(&writer->keys, i) &&
            table_row(writer->world->tables[i], entity) != ROW_NONE)
            return true;
    return false;
}

static LevelNameKind kind_of(const World *world, Entity entity) {
    if (table_row(world->tables[COMPONENT_model], entity) != ROW_NONE) return NAME_MODEL;
    if (table_row(world->tables[COMPONENT_material], entity) != ROW_NONE) return NAME_MATERIAL;
    return NAME_ENTITY;
}

// Gives the entity a name that no other of its kind has, its own if possible.
static void take_name(LevelWriter *writer, Entity entity, const char *wanted) {
    LevelName name = {.value = entity, .kind = kind_of(writer->world, entity)};
    u32 index = ENTITY_INDEX(entity);
    bool is_long = strlen(wanted) > LEVEL_NAME_MAX && !strchr(wanted, '/');
    for (u32 i = is_long;; i++) {
        name.text = i == 0   ? arena_copy_string(&writer->scratch, wanted)
                    : i == 1 ? arena_format(&writer->scratch, "%.80s~%u", wanted, index)
                             : arena_format(&writer->scratch, "%.80s~%u~%u", wanted, index, i);
        if (!level_names_add(&writer->names, &writer->scratch, name)) break;
    }
    writer->name_of[index] = name.text;
}

static void name_models(LevelWriter *writer) {
    const World *world = writer->world;
    const ModelTable *models = WORLD_TABLE(world, Model, model);
    for (u32 row = 0; row < models->table.count; row++) {
        Entity entity = models->table.entity[row];
        const char *name = world_name(world, entity);
        take_name(writer, entity, name[0] ? name : "model");
        name = writer->name_of[ENTITY_INDEX(entity)];
        if (models->model[row] >= writer->store->model_count) continue;
        const Model *model = &writer->store->models[models->model[row]];
        for (u32 i = 0; i < model->material_count; i++) {
            u32 index = ENTITY_INDEX(models->first_material[row]) + i;
            if (index >= world->entity_slots || !world->alive[index]) continue;
            char text[LEVEL_NAME_MAX * 2 + 2];
            level_material_name(model, i, name, text, sizeof text);
            take_name(writer, entity_at(world, index), text);
            writer->is_model_material[index] = 1;
        }
    }
}

static bool is_reference(const LevelWriter *writer, u32 component, u32 column) {
    const ColumnDesc *desc = &writer->keys.components[component].desc->columns[column];
    return desc->type == COLUMN_ENTITY && (desc->key[0] || component == COMPONENT_transform);
}

static void name_entities(LevelWriter *writer) {
    const World *world = writer->world;
    for (u32 i = 1; i < world->entity_slots; i++) {
        const char *name = world->alive[i] ? world_name(world, entity_at(world, i)) : "";
        if (name[0] && !writer->name_of[i][0]) take_name(writer, entity_at(world, i), name);
    }
    // What is referred to needs a name, and so does every material.
    for (u32 c = 0; c < writer->keys.count; c++) {
        const Table *table = world->tables[c];
        for (u32 row = 0; c == COMPONENT_material && row < table->count; row++)
            if (!writer->name_of[ENTITY_INDEX(table->entity[row])][0])
                take_name(writer, table->entity[row], "material");
        for (u32 column = 0; column < table->desc->column_count; column++) {
            if (!is_reference(writer, c, column)) continue;
            for (u32 row = 0; row < table->count; row++) {
                Entity target = cell(table, column, row);
                if (world_alive(world, target) && !writer->name_of[ENTITY_INDEX(target)][0])
                    take_name(writer, target, "unnamed");
            }
        }
    }
}

static void add_points(LevelWriter *writer, u32 list) {
    const f32 *xyz;
    u32 count = world_points(writer->world, list, &xyz);
    text_add(&writer->text, "[");
    for (u32 i = 0; i < count * 3; i++) {
        text_add(&writer->text, i % 3 ? ", " : i ? ", [" : "[");
        text_add_number(&writer->text, xyz[i], true);
        if (i % 3 == 2) text_add(&writer->text, "]");
    }
    text_add(&writer->text, "]");
}

static void add_cell(LevelWriter *writer, const ColumnDesc *column, u32 bits) {
    TextBuilder *text = &writer->text;
    const char *word = "";
    switch (column->type) {
    case COLUMN_F32:
    case COLUMN_U32:
    case COLUMN_I32:
        text_add_number(text, number_of(column->type, bits), column->type == COLUMN_F32);
        break;
    case COLUMN_BOOL:
        text_add(text, bits ? "true" : "false");
        break;
    case COLUMN_ENUM: {
        u32 length = level_word(column->unit, bits, &word);
        text_add(text, "\"%.*s\"", (int)length, word);
        break;
    }
    case COLUMN_ENTITY:
        text_add_quoted(text, world_alive(writer->world, bits) ? writer->name_of[ENTITY_INDEX(bits)]
                                                               : "");
        break;
    case COLUMN_TEXTURE:
        text_add_quoted(text, asset_texture_path(writer->store, bits));
        break;
    case COLUMN_POINTS:
        add_points(writer, bits);
        break;
    }
}

// False for what cannot be said: a texture that came inside a model file, a word past the list.
static bool can_write(const LevelWriter *writer, const ColumnDesc *column, u32 bits) {
    const char *word;
    if (column->type == COLUMN_TEXTURE)
        return bits == 0 || asset_texture_path(writer->store, bits)[0] != 0;
    if (column->type == COLUMN_ENUM) return level_word(column->unit, bits, &word) > 0;
    return true;
}

// Keys of one row that differ from `base` (bits per column), or from the defaults if NULL. Returns
// how many there were.
static u32 add_keys(LevelWriter *writer, u32 component, u32 row, const char *prefix,
                    const u32 *base) {
    const LevelComponent *owner = &writer->keys.components[component];
    const Table *table = writer->world->tables[component];
    u32 written = 0;
    for (u32 k = 0; k < owner->key_count; k++) {
        const LevelKey *key = &owner->keys[k];
        bool differs = false, can = true;
        for (u32 i = 0; i < key->count; i++) {
            const ColumnDesc *column = &owner->desc->columns[key->column + i];
            u32 bits = cell(table, key->column + i, row);
            differs |= bits != (base ? base[key->column + i] : initial_bits(column));
            can &= can_write(writer, column, bits);
        }
        if (!differs || !can) continue;
        written++;
        text_add(&writer->text, "%s%s = %s", prefix, key->name, key->count > 1 ? "[" : "");
        for (u32 i = 0; i < key->count; i++) {
            if (i) text_add(&writer->text, ", ");
            add_cell(writer, &owner->desc->columns[key->column + i],
                     cell(table, key->column + i, row));
        }
        text_add(&writer->text, key->count > 1 ? "]\n" : "\n");
    }
    return written;
}

static void write_singletons(LevelWriter *writer) {
    for (u32 i = 0; i < writer->keys.count; i++) {
        const Table *table = writer->world->tables[i];
        if (!table->desc->singleton || table->count == 0) continue;
        text_add(&writer->text, "\n[%s]\n", table->desc->name);
        add_keys(writer, i, 0, "", NULL);
    }
}

// The store knows a model by its path, or by its shape's parameters: "shape:torus segments=32
// rings=16 tube=0.2 uv=1 inverted" (shapes.c).
static void write_model(LevelWriter *writer, Entity entity, const Model *model) {
    TextBuilder *text = &writer->text;
    text_add(text, "\n[[model]]\nname = ");
    text_add_quoted(text, writer->name_of[ENTITY_INDEX(entity)]);
    char shape[32], inverted[16] = "";
    unsigned segments, rings;
    float tube, uv;
    if (sscanf(model->name, "shape:%31s segments=%u rings=%u tube=%f uv=%f %15s", shape, &segments,
               &rings, &tube, &uv, inverted) < 5) {
        text_add(text, "\nfile = ");
        text_add_quoted(text, model->name);
        text_add(text, "\n");
        return;
    }
    text_add(text, "\nshape = \"%s\"\n", shape);
    if (segments) text_add(text, "segments = %u\n", segments);
    if (rings) text_add(text, "rings = %u\n", rings);
    if (strcmp(shape, "torus") == 0) {
        text_add(text, "tube = ");
        text_add_number(text, tube, true);
        text_add(text, "\n");
    }
    if (uv != 1.0f) {
        text_add(text, "uv_repeat = ");
        text_add_number(text, uv, true);
        text_add(text, "\n");
    }
    if (inverted[0]) text_add(text, "inverted = true\n");
}

// Of a model's own material only what differs from the file. `plain` is an empty world to fill its
// row in the same way as loading does.
static void write_overrides(LevelWriter *writer, World *plain, Entity material,
                            const ModelMaterial *source) {
    MaterialTable *table = WORLD_TABLE(plain, Material, material);
    Entity entity = world_spawn(plain);
    u32 row = table_add(&table->table, entity);
    level_fill_material(table, row, source);
    u32 column_count = table->table.desc->column_count;
    u32 *base = ARENA_PUSH(&writer->scratch, u32, column_count);
    for (u32 i = 0; i < column_count; i++) base[i] = cell(&table->table, i, row);
    world_despawn(plain, entity);
    u32 own = table_row(writer->world->tables[COMPONENT_material], material);
    if (own == ROW_NONE) return;
    u64 start = writer->text.size;
    text_add(&writer->text, "\n[[material]]\nname = ");
    text_add_quoted(&writer->text, writer->name_of[ENTITY_INDEX(material)]);
    text_add(&writer->text, "\n");
    if (add_keys(writer, COMPONENT_material, own, "", base) == 0) {
        writer->text.size = start;
        writer->text.data[start] = 0;
    }
}

static void write_models(LevelWriter *writer) {
    const World *world = writer->world;
    const ModelTable *models = WORLD_TABLE(world, Model, model);
    for (u32 row = 0; row < models->table.count; row++) {
        u32 id = models->model[row];
        if (id > 0 && id < writer->store->model_count)
            write_model(writer, models->table.entity[row], &writer->store->models[id]);
    }
    World *plain = world_create(0);
    for (u32 row = 0; row < models->table.count; row++) {
        u32 id = models->model[row];
        if (id == 0 || id >= writer->store->model_count) continue;
        const Model *model = &writer->store->models[id];
        for (u32 i = 0; i < model->material_count; i++) {
            u32 index = ENTITY_INDEX(models->first_material[row]) + i;
            if (index < world->entity_slots && world->alive[index])
                write_overrides(writer, plain, entity_at(world, index), &model->materials[i]);
        }
    }
    world_destroy(plain);
}

static void write_materials(LevelWriter *writer) {
    const Table *table = writer->world->tables[COMPONENT_material];
    for (u32 row = 0; row < table->count; row++) {
        u32 index = ENTITY_INDEX(table->entity[row]);
        if (writer->is_model_material[index]) continue;
        text_add(&writer->text, "\n[[material]]\nname = ");
        text_add_quoted(&writer->text, writer->name_of[index]);
        text_add(&writer->text, "\n");
        add_keys(writer, COMPONENT_material, row, "", NULL);
    }
}

static void write_entity(LevelWriter *writer, Entity entity) {
    const World *world = writer->world;
    TextBuilder *text = &writer->text;
    text_add(text, "\n[[entity]]\n");
    const char *name = writer->name_of[ENTITY_INDEX(entity)];
    if (name[0]) {
        text_add(text, "name = ");
        text_add_quoted(text, name);
        text_add(text, "\n");
    }
    const TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    u32 transform_row = table_row(&transforms->table, entity);
    if (transform_row != ROW_NONE && world_alive(world, transforms->parent[transform_row])) {
        text_add(text, "parent = ");
        text_add_quoted(text, writer->name_of[ENTITY_INDEX(transforms->parent[transform_row])]);
        text_add(text, "\n");
    }
    for (u32 i = 0; i < writer->keys.count; i++) {
        if (!level_is_entity_component(&writer->keys, i)) continue;
        u32 row = table_row(world->tables[i], entity);
        if (row == ROW_NONE) continue;
        char prefix[80];
        snprintf(prefix, sizeof prefix, "%s.", world->tables[i]->desc->name);
        if (add_keys(writer, i, row, prefix, NULL) == 0 && i != COMPONENT_transform)
            text_add(text, "%s = {}\n", world->tables[i]->desc->name);
    }
}

const char *level_write(const World *world, const AssetStore *store, Arena *arena) {
    LevelWriter writer = {.world = world, .store = store};
    LUZ_ASSERT(arena_create(&writer.scratch, "level writer", GIB(1)));
    level_keys_create(&writer.keys, world, &writer.scratch);
    writer.name_of = ARENA_PUSH(&writer.scratch, const char *, world->entity_slots);
    writer.is_model_material = ARENA_PUSH(&writer.scratch, u8, world->entity_slots);
    for (u32 i = 0; i < world->entity_slots; i++) writer.name_of[i] = "";
    name_models(&writer);
    name_entities(&writer);
    text_add(&writer.text, "[level]\nseed = %lld\n", (long long)world->seed);
    write_singletons(&writer);
    write_models(&writer);
    write_materials(&writer);
    for (u32 i = 1; i < world->entity_slots; i++)
        if (world->alive[i] && is_written(&writer, entity_at(world, i)))
            write_entity(&writer, entity_at(world, i));
    const char *text = text_finish(&writer.text, arena);
    arena_destroy(&writer.scratch);
    return text;
}
