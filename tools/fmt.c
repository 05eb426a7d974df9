// fmt.c: `luz fmt`: level text in one shape.
// Data in: level files. Data out: the same files with uniform spacing; comments, order and values
// stay. Does not: check what the text means; that is `luz check`.
#include "../engine/base/file.h"
#include "../engine/level/level.h"
#include "../engine/level/level_format.h"
#include "json.h"
#include "tool.h"
#include <stdio.h>
#include <string.h>

#define FMT_ARENA_CAP GIB(4)

typedef struct FmtOptions {
    bool check, print;
} FmtOptions;

// *changed: the text is not in form yet.
static int fmt_file(const char *path, const FmtOptions *options, const ToolCommon *common,
                    Arena *arena, bool *changed) {
    *changed = false;
    Bytes text;
    const char *formatted;
    if (!file_read(path, LEVEL_TEXT_SIZE_MAX, arena, &text)) return TOOL_DIFFERENT;
    // A zero byte would end the text early, and writing it back would lose the rest.
    if (strlen(text.data) != text.size || !level_format_text(text.data, arena, &formatted))
        return tool_fail(TOOL_DIFFERENT, "fmt", "'%s' is no TOML; `luz check` tells where", path);
    if (options->print) {
        fputs(formatted, stdout);
        return TOOL_OK;
    }
    u64 size = strlen(formatted);
    *changed = size != text.size || memcmp(formatted, text.data, size) != 0;
    if (!*changed) return TOOL_OK;
    if (options->check) return tool_fail(TOOL_DIFFERENT, "fmt", "'%s' is not formatted", path);
    if (!file_write(path, formatted, size)) return TOOL_ENVIRONMENT;
    if (!common->quiet && !common->json) printf("formatted %s\n", path);
    return TOOL_OK;
}

static int fmt_run(int argc, char **argv) {
    ToolCommon common = {0};
    FmtOptions o = {0};
    const ToolOption options[] = {
        {"check", 0, OPTION_FLAG, &o.check, NULL, "do not write: fail if a file would change"},
        {"print", 'p', OPTION_FLAG, &o.print, NULL, "print the result instead of writing it"},
    };
    const ToolSpec spec = {
        .command = "fmt",
        .synopsis = "LEVEL.toml... [--check | --print]",
        .about = "Gives level text uniform spacing, in place. Comments, order and values stay.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = TOOL_LIST_CAP,
        .examples = "  luz fmt data/levels/*.toml\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (o.print && (o.check || common.json))
        return tool_fail(TOOL_USAGE, "fmt", "--print and --%s contradict each other",
                         o.check ? "check" : "json");
    tool_begin(&common);
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_open_array(&json, "files");
    int result = TOOL_ENVIRONMENT;
    Arena arena;
    if (arena_create(&arena, "fmt", FMT_ARENA_CAP)) {
        result = TOOL_OK;
        for (u32 i = 0; i < positional.count; i++) {
            bool changed;
            int one = fmt_file(positional.items[i], &o, &common, &arena, &changed);
            result = MAX(result, one);
            json_open_flat_object(&json, NULL);
            json_text(&json, "file", positional.items[i]);
            json_bool(&json, "ok", one == TOOL_OK);
            json_bool(&json, "changed", changed);
            json_close(&json);
            arena_reset(&arena);
        }
        arena_destroy(&arena);
    }
    json_close(&json);
    json_close(&json);
    if (common.json) json_print(&json);
    json_free(&json);
    tool_end();
    return result;
}

const ToolCommand tool_fmt = {"fmt", "give level text one shape", fmt_run};
