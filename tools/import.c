// import.c: `luz import`: a starter level for a model file.
// Data in: a .gltf or .glb. Data out: level text with the model, its lights and cameras, a place to
// start and an environment, to be edited by hand. Does not: copy or convert the model.
#include "../engine/base/file.h"
#include "headless.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IMPORT_ARENA_CAP GIB(4)

static bool same_directory(const char *a, const char *b) {
    char *real_a = realpath(a, NULL), *real_b = realpath(b, NULL);
    bool same = real_a && real_b && strcmp(real_a, real_b) == 0;
    free(real_a);
    free(real_b);
    return same;
}

// A level names files from its data root: the model must lie below it.
static int check_roots(const char *model_root, const char *out) {
    char root[1024], relative[1024];
    if (!level_find_root(out, root, sizeof root, relative, sizeof relative))
        return tool_fail(TOOL_USAGE, "import", "'%s' is no place for a level", out);
    if (same_directory(model_root, root)) return TOOL_OK;
    return tool_fail(TOOL_DIFFERENT, "import",
                     "the level '%s' would look for files below '%s', but the model lies below "
                     "'%s'; copy the model there, or write the level beside it",
                     out, root, model_root);
}

static char *import_text(const char *model, const World *world, const AssetStore *store,
                         Arena *arena) {
    const char *level = level_write(world, store, arena);
    return arena_format(arena,
                        "# Made by `luz import %s`. Check it with `luz check`, look at it with\n"
                        "# `luz shot`. The keys are described in data/level.schema.json.\n\n%s",
                        model, level);
}

// Where the level was written, or its text.
static void print_json(const char *model, const char *out, const char *text) {
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_text(&json, "model", model);
    if (out) json_text(&json, "level", out);
    if (text) json_text(&json, "text", text);
    json_close(&json);
    json_print(&json);
    json_free(&json);
}

static int import_model(const char *path, const char *out, bool force, const ToolCommon *common,
                        Arena *arena) {
    char root_path[1024], relative[1024];
    FileRoot root;
    if (!level_find_root(path, root_path, sizeof root_path, relative, sizeof relative) ||
        !file_root_open(&root, root_path))
        return tool_fail(TOOL_DIFFERENT, "import", "'%s' cannot be found", path);
    int result = out ? check_roots(root_path, out) : TOOL_OK;
    AssetStore store;
    if (result == TOOL_OK && !asset_store_create(&store)) result = TOOL_ENVIRONMENT;
    if (result != TOOL_OK) {
        file_root_close(&root);
        return result;
    }
    World *world = world_create(0);
    LevelInfo info = {0};
    Diagnostics *diagnostics = ARENA_PUSH(arena, Diagnostics, 1);
    diagnostics->arena = arena;
    bool ok = level_load(&root, relative, world, &store, arena, &info, diagnostics);
    if (!ok || (diagnostics->warning_count && !common->quiet))
        diagnostics_print(diagnostics, stderr);
    if (!ok) {
        headless_explain(diagnostics);
        result = TOOL_DIFFERENT;
    } else {
        const char *text = import_text(relative, world, &store, arena);
        if (!out && common->json)
            print_json(path, NULL, text);
        else if (!out)
            fputs(text, stdout);
        else if (file_exists(out) && !force)
            result =
                tool_fail(TOOL_ENVIRONMENT, "import", "'%s' is there already; use --force", out);
        else
            result = file_write(out, text, strlen(text)) ? TOOL_OK : TOOL_ENVIRONMENT;
        if (result == TOOL_OK && out && common->json)
            print_json(path, out, NULL);
        else if (result == TOOL_OK && out && !common->quiet)
            printf("wrote %s\n", out);
    }
    world_destroy(world);
    asset_store_destroy(&store);
    file_root_close(&root);
    return result;
}

static int import_run(int argc, char **argv) {
    ToolCommon common = {0};
    const char *out = NULL;
    bool force = false;
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &out, "LEVEL", "the level to write; default: print it"},
        {"force", 'f', OPTION_FLAG, &force, NULL, "replace a file that is there"},
    };
    const ToolSpec spec = {
        .command = "import",
        .synopsis = "MODEL [-o LEVEL.toml]",
        .about =
            "Writes a starter level for a model (.gltf, .glb): the model, its lights and cameras,\n"
            "a place to start, an environment. The rest is yours.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = 1,
        .examples = "  luz import data/models/chapel.glb -o data/levels/chapel.toml\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    const char *model = positional.items[0];
    const char *dot = strrchr(model, '.');
    if (!dot || (strcmp(dot, ".gltf") != 0 && strcmp(dot, ".glb") != 0))
        return tool_fail(TOOL_USAGE, "import", "'%s' is no .gltf or .glb file", model);
    tool_begin(&common);
    Arena arena;
    int result = TOOL_ENVIRONMENT;
    if (arena_create(&arena, "import", IMPORT_ARENA_CAP)) {
        result = import_model(model, out, force, &common, &arena);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_import = {"import", "write a starter level for a model", import_run};
