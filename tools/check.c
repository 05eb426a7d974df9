// check.c: `luz check`: are these levels sound?
// Data in: level files. Data out: every diagnostic of every file, counts, JSON if wanted.
// Does not: need a GPU.
#include "headless.h"
#include <stdio.h>

typedef struct CheckCounts {
    u32 levels, errors, warnings;
} CheckCounts;

static void json_diagnostics(Json *json, const char *path, const Session *session, bool ok) {
    const Diagnostics *diagnostics = session->diagnostics;
    json_open_object(json, NULL);
    json_text(json, "level", path);
    json_bool(json, "ok", ok);
    json_u64(json, "errors", diagnostics->error_count);
    json_u64(json, "warnings", diagnostics->warning_count);
    if (ok) json_u64(json, "entities", session->level.entity_count);
    json_open_array(json, "diagnostics");
    for (u32 i = 0; i < diagnostics->count; i++) {
        const Diagnostic *item = &diagnostics->items[i];
        json_open_flat_object(json, NULL);
        json_text(json, "severity", item->is_error ? "error" : "warning");
        json_text(json, "file", item->file);
        json_u64(json, "line", item->line);
        json_u64(json, "column", item->column);
        json_u64(json, "length", item->length);
        json_text(json, "text", item->text);
        json_text(json, "hint", item->hint);
        json_close(json);
    }
    json_close(json);
    json_close(json);
}

// A fresh session for each: a failed load leaves the earlier level in place.
static bool check_level(const char *path, const ToolCommon *common, Json *json,
                        CheckCounts *counts) {
    Session session;
    if (!session_create(&session, tool_session())) return false;
    bool ok = session_load(&session, path);
    const Diagnostics *diagnostics = session.diagnostics;
    counts->levels++;
    counts->errors += diagnostics->error_count;
    counts->warnings += diagnostics->warning_count;
    if (common->json)
        json_diagnostics(json, path, &session, ok);
    else if (diagnostics->count > 0)
        diagnostics_print(diagnostics, stdout);
    if (ok && !common->json && !common->quiet)
        printf("%s: ok, %u %s\n", path, session.level.entity_count,
               session.level.entity_count == 1 ? "entity" : "entities");
    session_destroy(&session);
    return true;
}

static int check_run(int argc, char **argv) {
    ToolCommon common = {0};
    const ToolSpec spec = {
        .command = "check",
        .synopsis = "LEVEL...",
        .about = "Loads levels and reports every mistake in them as file:line:column.",
        .positional_min = 1,
        .positional_max = TOOL_LIST_CAP,
        .examples = "  luz check data/levels/*.toml\n"
                    "  luz check --json level.toml\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    tool_begin(&common);
    CheckCounts counts = {0};
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_open_array(&json, "levels");
    bool ok = true;
    for (u32 i = 0; ok && i < positional.count; i++)
        ok = check_level(positional.items[i], &common, &json, &counts);
    json_close(&json);
    json_u64(&json, "errors", counts.errors);
    json_u64(&json, "warnings", counts.warnings);
    json_close(&json);
    if (common.json) json_print(&json);
    json_free(&json);
    if (!common.json && !common.quiet && counts.levels > 1)
        printf("%u levels, %u error%s, %u warning%s\n", counts.levels, counts.errors,
               counts.errors == 1 ? "" : "s", counts.warnings, counts.warnings == 1 ? "" : "s");
    tool_end();
    return !ok ? TOOL_ENVIRONMENT : counts.errors ? TOOL_DIFFERENT : TOOL_OK;
}

const ToolCommand tool_check = {"check", "report every mistake in levels", check_run};
