// schema.c: `luz schema`: the JSON schema of the level format, for editors.
// Data in: the engine's components and the project's. Data out: draft 2020-12 on stdout or in a
// file. Does not: know models or names; `luz check` does.
#include "../engine/base/file.h"
#include "headless.h"
#include <stdio.h>
#include <string.h>

#define SCHEMA_ARENA_CAP GIB(1)

static int schema_write(const char *out, bool check, const char *schema, Arena *arena) {
    if (!out) {
        fputs(schema, stdout);
        return TOOL_OK;
    }
    if (!check) return file_write(out, schema, strlen(schema)) ? TOOL_OK : TOOL_ENVIRONMENT;
    Bytes old;
    if (!file_read(out, MIB(64), arena, &old)) return TOOL_DIFFERENT;
    if (old.size == strlen(schema) && memcmp(old.data, schema, old.size) == 0) return TOOL_OK;
    return tool_fail(TOOL_DIFFERENT, "schema", "'%s' is out of date; run `luz schema -o %s`", out,
                     out);
}

static int schema_run(int argc, char **argv) {
    ToolCommon common = {0};
    const char *out = NULL;
    bool check = false;
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &out, "FILE", "write here instead of stdout"},
        {"check", 0, OPTION_FLAG, &check, NULL, "do not write: fail if FILE differs"},
    };
    const ToolSpec spec = {
        .command = "schema",
        .synopsis = "[-o FILE [--check]]",
        .about =
            "Prints the JSON schema of level text, made from the components' columns. Editors\n"
            "with TOML support use it for completion and checks while typing.",
        .options = options,
        .option_count = COUNT_OF(options),
        .examples = "  luz schema -o data/level.schema.json\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (check && !out) return tool_fail(TOOL_USAGE, "schema", "--check needs -o FILE");
    tool_begin(&common);
    Arena arena;
    int result = TOOL_ENVIRONMENT;
    if (arena_create(&arena, "schema", SCHEMA_ARENA_CAP)) {
        World *world = world_create(0);
        const SessionDesc *project = tool_session();
        for (u32 i = 0; i < project->component_count; i++)
            world_register_component(world, project->components[i]);
        result = schema_write(out, check, level_schema(world, &arena), &arena);
        world_destroy(world);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_schema = {"schema", "print the JSON schema of levels", schema_run};
