// level_schema.c: the level format as a JSON schema (draft 2020-12), for editors.
// Data in: the registered components' column descriptions. Data out: JSON text: completion, hover
// texts, ranges and words for every key that the reader takes. Called by `luz schema` and by a test
// that compares it with data/level.schema.json. Does not: say what only the reader can know (names
// that exist, files that are there).
#include "level_internal.h"
#include "level_text.h"
#include <stdio.h>
#include <string.h>

// Parts that do not depend on components.
static const char common_defs[] =
    "  \"name\": {\"type\": \"string\", \"minLength\": 1, \"maxLength\": 255},\n"
    "  \"color\": {\"type\": \"string\", \"pattern\": \"^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$\", "
    "\"description\": \"sRGB colour\"},\n"
    "  \"vec3\": {\"type\": \"array\", \"items\": {\"type\": \"number\", \"minimum\": -100000, "
    "\"maximum\": 100000}, \"minItems\": 3, \"maxItems\": 3},\n"
    "  \"count\": {\"type\": \"integer\", \"minimum\": 1, \"maximum\": 200000},\n"
    "  \"repeat\": {\"type\": \"object\", \"minProperties\": 1, \"additionalProperties\": false, "
    "\"properties\": {\n"
    "    \"row\": {\"type\": \"object\", \"description\": \"copies on a line\", "
    "\"additionalProperties\": false, \"required\": [\"count\", \"step\"], \"properties\": {"
    "\"count\": {\"$ref\": \"#/$defs/count\"}, \"step\": {\"$ref\": \"#/$defs/vec3\"}}},\n"
    "    \"ring\": {\"type\": \"object\", \"description\": \"copies on a circle\", "
    "\"additionalProperties\": false, \"required\": [\"count\", \"radius\"], \"properties\": {"
    "\"count\": {\"$ref\": \"#/$defs/count\"}, \"radius\": {\"type\": \"number\", \"minimum\": 0, "
    "\"maximum\": 100000}, \"axis\": {\"enum\": [\"x\", \"y\", \"z\"], \"default\": \"y\"}, "
    "\"start\": {\"type\": \"number\", \"minimum\": -3600, \"maximum\": 3600, \"default\": 0, "
    "\"description\": \"deg\"}, \"face\": {\"type\": \"boolean\", \"default\": true, "
    "\"description\": \"each copy turns with its place\"}}},\n"
    "    \"scatter\": {\"type\": \"object\", \"description\": \"copies at random places in a "
    "box\", "
    "\"additionalProperties\": false, \"required\": [\"count\", \"min\", \"max\"], "
    "\"properties\": {\"count\": {\"$ref\": \"#/$defs/count\"}, \"seed\": {\"type\": \"integer\"}, "
    "\"min\": {\"$ref\": \"#/$defs/vec3\"}, \"max\": {\"$ref\": \"#/$defs/vec3\"}}},\n"
    "    \"grid\": {\"type\": \"object\", \"description\": \"copies on a lattice\", "
    "\"additionalProperties\": false, \"required\": [\"count\", \"step\"], \"properties\": {"
    "\"count\": {\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/count\"}, \"minItems\": 3, "
    "\"maxItems\": 3}, \"step\": {\"$ref\": \"#/$defs/vec3\"}}}}},\n";

static const char top_properties[] =
    "  \"level\": {\"type\": \"object\", \"description\": \"about the file\", "
    "\"additionalProperties\": false, \"properties\": {\"title\": {\"type\": \"string\"}, "
    "\"seed\": {\"type\": \"integer\", \"default\": 1, \"description\": \"of repetition and of the "
    "simulation's random numbers\"}}},\n"
    "  \"prefab\": {\"type\": \"array\", \"description\": \"groups of entities\", \"items\": "
    "{\"type\": \"object\", \"additionalProperties\": false, \"required\": [\"name\", \"entity\"], "
    "\"properties\": {\"name\": {\"$ref\": \"#/$defs/name\"}, \"entity\": {\"type\": \"array\", "
    "\"minItems\": 1, \"items\": {\"$ref\": \"#/$defs/entity\"}, \"description\": \"the first is "
    "the "
    "root\"}}}},\n"
    "  \"entity\": {\"type\": \"array\", \"description\": \"what is in the level\", \"items\": "
    "{\"$ref\": \"#/$defs/entity\"}}";

static void add_range(TextBuilder *text, const ColumnDesc *column) {
    if (!level_column_has_range(column)) return;
    text_add(text, ", \"minimum\": %.9g, \"maximum\": %.9g", column->min, column->max);
}

// Type and range of one element.
static void add_element(TextBuilder *text, const ColumnDesc *column) {
    switch (column->type) {
    case COLUMN_F32:
        text_add(text, "\"type\": \"number\"");
        add_range(text, column);
        break;
    case COLUMN_U32:
        text_add(text, "\"type\": \"integer\"");
        if (level_column_has_range(column)) {
            add_range(text, column);
        } else {
            text_add(text, ", \"minimum\": 0, \"maximum\": 4294967295");
        }
        break;
    case COLUMN_I32:
        text_add(text, "\"type\": \"integer\"");
        add_range(text, column);
        break;
    case COLUMN_BOOL:
        text_add(text, "\"type\": \"boolean\"");
        break;
    case COLUMN_ENUM: {
        const char *word;
        u32 length;
        text_add(text, "\"enum\": [");
        for (u32 i = 0; (length = level_word(column->unit, i, &word)) > 0; i++)
            text_add(text, "%s\"%.*s\"", i ? ", " : "", (int)length, word);
        text_add(text, "]");
        break;
    }
    case COLUMN_ENTITY:
    case COLUMN_TEXTURE:
        text_add(text, "\"type\": \"string\"");
        break;
    case COLUMN_POINTS:
        text_add(text, "\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/vec3\"}");
        break;
    }
}

static void add_default(TextBuilder *text, const ColumnDesc *column) {
    const char *word = "";
    switch (column->type) {
    case COLUMN_F32:
        text_add_number(text, (f32)column->initial, true);
        break;
    case COLUMN_U32:
    case COLUMN_I32:
        text_add_number(text, column->initial, false);
        break;
    case COLUMN_BOOL:
        text_add(text, column->initial != 0 ? "true" : "false");
        break;
    case COLUMN_ENUM: {
        u32 length = level_word(column->unit, (u32)column->initial, &word);
        text_add(text, "\"%.*s\"", (int)length, word);
        break;
    }
    case COLUMN_ENTITY:
    case COLUMN_TEXTURE:
        text_add(text, "\"\"");
        break;
    case COLUMN_POINTS:
        text_add(text, "[]");
        break;
    }
}

static void add_array(TextBuilder *text, const ColumnDesc *column, u32 count) {
    text_add(text, "\"type\": \"array\", \"items\": {");
    add_element(text, column);
    text_add(text, "}, \"minItems\": %u, \"maxItems\": %u", count, count);
}

// What a key takes, without default and description.
static void add_type(TextBuilder *text, const LevelComponent *owner, const LevelKey *key) {
    const ColumnDesc *column = level_key_column(owner, key);
    if (key->count == 1) {
        add_element(text, column);
    } else if (level_key_is_color(owner, key)) {
        text_add(text, "\"anyOf\": [{\"$ref\": \"#/$defs/color\"}, {");
        add_array(text, column, key->count);
        text_add(text, "}]");
    } else if (level_key_takes_scalar(owner, key)) {
        text_add(text, "\"anyOf\": [{");
        add_array(text, column, key->count);
        text_add(text, "}, {");
        add_element(text, column);
        text_add(text, "}]");
    } else {
        add_array(text, column, key->count);
    }
}

static void add_key(TextBuilder *text, const LevelComponent *owner, const LevelKey *key) {
    const ColumnDesc *column = level_key_column(owner, key);
    text_add(text, "    \"%s\": {", key->name);
    add_type(text, owner, key);
    text_add(text, ", \"default\": %s", key->count > 1 ? "[" : "");
    for (u32 i = 0; i < key->count; i++) {
        if (i) text_add(text, ", ");
        add_default(text, &owner->desc->columns[key->column + i]);
    }
    text_add(text, "%s, \"description\": ", key->count > 1 ? "]" : "");
    char help[256];
    bool is_words = column->type == COLUMN_ENUM;
    const char *before = !column->unit[0] || is_words     ? ""
                         : column->type == COLUMN_ENTITY  ? "name of an entity with "
                         : column->type == COLUMN_TEXTURE ? "path of an image, "
                                                          : "in ";
    snprintf(help, sizeof help, "%s%s%s%s%s", column->help, before[0] ? " (" : "", before,
             before[0] ? column->unit : "", before[0] ? ")" : "");
    text_add_quoted(text, help);
    text_add(text, "}");
}

static void add_keys(TextBuilder *text, const LevelComponent *owner) {
    for (u32 i = 0; i < owner->key_count; i++) {
        if (i) text_add(text, ",\n");
        add_key(text, owner, &owner->keys[i]);
    }
}

static void add_component(TextBuilder *text, const LevelComponent *owner, bool has_name) {
    text_add(text, "{\"type\": \"object\", \"description\": ");
    text_add_quoted(text, owner->desc->help);
    text_add(text, ", \"additionalProperties\": false, %s\"properties\": {\n",
             has_name ? "\"required\": [\"name\"], " : "");
    if (has_name)
        text_add(text, "    \"name\": {\"$ref\": \"#/$defs/name\"}%s\n",
                 owner->key_count ? "," : "");
    add_keys(text, owner);
    text_add(text, "}}");
}

static void add_vary(TextBuilder *text, const LevelComponent *owner) {
    text_add(text,
             "    \"%s\": {\"type\": \"object\", \"additionalProperties\": false, "
             "\"properties\": {\n",
             owner->desc->name);
    for (u32 i = 0; i < owner->key_count; i++) {
        const LevelKey *key = &owner->keys[i];
        const ColumnDesc *column = level_key_column(owner, key);
        bool is_number =
            column->type == COLUMN_F32 || column->type == COLUMN_U32 || column->type == COLUMN_I32;
        text_add(text,
                 "%s      \"%s\": {\"type\": \"object\", \"additionalProperties\": false, "
                 "\"properties\": {\"choose\": {\"type\": \"array\", \"minItems\": 1, "
                 "\"items\": {",
                 i ? ",\n" : "", key->name);
        add_type(text, owner, key);
        text_add(text, "}}");
        for (u32 end = 0; is_number && end < 2; end++) {
            text_add(text, ", \"%s\": {", end ? "max" : "min");
            if (key->count > 1 && !level_key_takes_scalar(owner, key)) {
                text_add(text, "\"anyOf\": [{");
                add_type(text, owner, key);
                text_add(text, "}, {");
                add_element(text, column);
                text_add(text, "}]");
            } else {
                add_type(text, owner, key);
            }
            text_add(text, "}");
        }
        text_add(text, "}}");
    }
    text_add(text, "}}");
}

static void add_entity(TextBuilder *text, const LevelKeys *keys) {
    text_add(text,
             "  \"entity\": {\"type\": \"object\", \"additionalProperties\": false, "
             "\"properties\": {\n"
             "    \"name\": {\"$ref\": \"#/$defs/name\", \"description\": \"unique among "
             "entities\"},\n"
             "    \"prefab\": {\"type\": \"string\", \"description\": \"name of a prefab; own "
             "values override those of its root\"},\n"
             "    \"parent\": {\"type\": \"string\", \"description\": \"transform is relative "
             "to the entity of this name\"},\n"
             "    \"repeat\": {\"anyOf\": [{\"$ref\": \"#/$defs/repeat\"}, {\"type\": "
             "\"array\", \"items\": {\"$ref\": \"#/$defs/repeat\"}}], \"description\": "
             "\"copies; a list is a product, the first outermost\"},\n"
             "    \"vary\": {\"$ref\": \"#/$defs/vary\"}");
    for (u32 i = 0; i < keys->count; i++)
        if (level_is_entity_component(keys, i))
            text_add(text, ",\n    \"%s\": {\"$ref\": \"#/$defs/component_%s\"}",
                     keys->components[i].desc->name, keys->components[i].desc->name);
    text_add(text, "}}");
}

static void add_defs(TextBuilder *text, const LevelKeys *keys) {
    text_add(text, "\"$defs\": {\n%s", common_defs);
    text_add(text,
             "  \"vary\": {\"type\": \"object\", \"description\": \"values that differ from copy "
             "to copy\", \"additionalProperties\": false, \"properties\": {\n");
    bool is_first = true;
    for (u32 i = 0; i < keys->count; i++) {
        if (!level_is_entity_component(keys, i)) continue;
        text_add(text, is_first ? "" : ",\n");
        add_vary(text, &keys->components[i]);
        is_first = false;
    }
    text_add(text, "}},\n");
    for (u32 i = 0; i < keys->count; i++) {
        if (!level_is_entity_component(keys, i)) continue;
        text_add(text, "  \"component_%s\": ", keys->components[i].desc->name);
        add_component(text, &keys->components[i], false);
        text_add(text, ",\n");
    }
    add_entity(text, keys);
    text_add(text, "\n}");
}

static void add_model(TextBuilder *text) {
    text_add(text,
             "  \"model\": {\"type\": \"array\", \"description\": \"model files and generated "
             "shapes\", \"items\": {\"type\": \"object\", \"additionalProperties\": false, "
             "\"required\": [\"name\"], \"oneOf\": [{\"required\": [\"file\"]}, {\"required\": "
             "[\"shape\"]}], \"properties\": {\n"
             "    \"name\": {\"$ref\": \"#/$defs/name\"},\n"
             "    \"file\": {\"type\": \"string\", \"description\": \"a .glb or .gltf file below "
             "the data root\"},\n"
             "    \"shape\": {\"enum\": [");
    for (u32 i = 0; i < SHAPE_COUNT; i++) text_add(text, "%s\"%s\"", i ? ", " : "", shape_names[i]);
    text_add(text,
             "]},\n"
             "    \"segments\": {\"type\": \"integer\", \"minimum\": 0, \"maximum\": 512, "
             "\"description\": \"of a shape, around; 0 = 32\"},\n"
             "    \"rings\": {\"type\": \"integer\", \"minimum\": 0, \"maximum\": 512, "
             "\"description\": \"of a shape, along; 0 = half the segments\"},\n"
             "    \"tube\": {\"type\": \"number\", \"minimum\": 0.001, \"maximum\": 0.5, "
             "\"default\": 0.2, \"description\": \"torus: radius of the tube\"},\n"
             "    \"uv_repeat\": {\"type\": \"number\", \"minimum\": 0.001, \"maximum\": 1000, "
             "\"default\": 1, \"description\": \"texture repeats over the shape\"},\n"
             "    \"inverted\": {\"type\": \"boolean\", \"default\": false, \"description\": "
             "\"faces look inwards\"}}}},\n");
}

const char *level_schema(const World *world, Arena *arena) {
    Arena scratch;
    LUZ_ASSERT(arena_create(&scratch, "level schema", MIB(64)));
    LevelKeys keys;
    level_keys_create(&keys, world, &scratch);
    TextBuilder text = {0};
    text_add(&text,
             "{\n\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
             "\"title\": \"luz level\",\n\"description\": \"Metres, degrees, seconds; linear "
             "colour or #rrggbb.\",\n\"type\": \"object\",\n\"additionalProperties\": false,\n"
             "\"properties\": {\n");
    for (u32 i = 0; i < keys.count; i++) {
        const ComponentDesc *desc = keys.components[i].desc;
        if (!desc->singleton) continue;
        text_add(&text, "  \"%s\": ", desc->name);
        add_component(&text, &keys.components[i], false);
        text_add(&text, ",\n");
    }
    add_model(&text);
    text_add(&text, "  \"material\": {\"type\": \"array\", \"description\": \"surfaces; the name "
                    "'model/material' overrides one of a model\", \"items\": ");
    add_component(&text, &keys.components[COMPONENT_material], true);
    text_add(&text, "},\n%s\n},\n", top_properties);
    add_defs(&text, &keys);
    text_add(&text, "\n}\n");
    arena_destroy(&scratch);
    return text_finish(&text, arena);
}
