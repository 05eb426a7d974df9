// level_schema.c: the published JSON schema: it is JSON, and it knows every key that the reader
// takes.
#include "level_common.h"
#include <stdio.h>

// A strict JSON checker in a few lines: returns the end of one value, or NULL.
static const char *skip_space(const char *at) { return at + strspn(at, " \n\t\r"); }

static const char *check_value(const char *at, u32 depth);

static const char *check_string(const char *at) {
    if (*at++ != '"') return NULL;
    for (; *at && *at != '"'; at++) {
        if ((u8)*at < 32) return NULL;
        if (*at == '\\' && !strchr("\"\\/bfnrtu", *++at)) return NULL;
    }
    return *at == '"' ? at + 1 : NULL;
}

static const char *check_list(const char *at, char close, bool is_object, u32 depth) {
    at = skip_space(at + 1);
    if (*at == close) return at + 1;
    for (;;) {
        if (is_object) {
            if (!(at = check_string(skip_space(at)))) return NULL;
            at = skip_space(at);
            if (*at++ != ':') return NULL;
        }
        if (!(at = check_value(at, depth + 1))) return NULL;
        at = skip_space(at);
        if (*at == close) return at + 1;
        if (*at++ != ',') return NULL;
    }
}

static const char *check_value(const char *at, u32 depth) {
    at = skip_space(at);
    if (depth > 64) return NULL;
    if (*at == '{') return check_list(at, '}', true, depth);
    if (*at == '[') return check_list(at, ']', false, depth);
    if (*at == '"') return check_string(at);
    if (strncmp(at, "true", 4) == 0) return at + 4;
    if (strncmp(at, "false", 5) == 0) return at + 5;
    char *end;
    strtod(at, &end);
    return end > at ? end : NULL;
}

TEST(level_schema, is_json_and_lists_every_key) {
    World *world = test_level_world();
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    const char *schema = level_schema(world, &arena);
    const char *end = check_value(schema, 0);
    assert_non_null(end);
    assert_string_equal(skip_space(end), "");
    u32 keys = 0;
    for (u32 i = 0; i < world->component_count; i++) {
        const ComponentDesc *desc = world->tables[i]->desc;
        // The keys of a component stand together, from its description on.
        const char *part = strstr(schema, desc->help);
        for (u32 k = 0; k < desc->column_count; k++) {
            char key[80];
            u32 length = (u32)strcspn(desc->columns[k].key, "[");
            if (length == 0) continue;
            assert_non_null(part);
            snprintf(key, sizeof key, "\"%.*s\": {", (int)length, desc->columns[k].key);
            assert_non_null(strstr(part, key));
            assert_non_null(strstr(part, desc->columns[k].help));
            keys++;
        }
    }
    assert_true(keys > 90);
    assert_non_null(strstr(schema, "\"enum\": [\"point\", \"spot\", \"directional\"]"));
    assert_non_null(strstr(schema, "\"component_door\""));
    assert_non_null(strstr(schema, "\"rules\": {"));
    assert_null(strstr(schema, "\"component_drawable\""));
    assert_string_equal(schema, level_schema(world, &arena));
    world_destroy(world);
    arena_destroy(&arena);
}
