// main.c: `luz`, the toolbox: picks the command.
// Data in: argv. Data out: the exit status of the command that ran.
// Does not: know what any command does; one file each, listed in TOOL_COMMANDS.
#include "../engine/base/jobs.h"
#include "../engine/base/log.h"
#include "json.h"
#include "tool.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const ToolCommand *const commands[] = {
#define X(name) &tool_##name,
    TOOL_COMMANDS(X)
#undef X
};

static void print_help(void) {
    printf("usage: luz COMMAND [arguments]\n\n"
           "The toolbox of luz, a small engine for scenes with very many lights.\n\n"
           "commands:\n");
    for (u32 i = 0; i < COUNT_OF(commands); i++)
        printf("  %-10s %s\n", commands[i]->name, commands[i]->summary);
    printf("\n`luz COMMAND --help` tells more. `luz --version` tells the version.\n\n"
           "exit status: 0 all well, 1 errors or differences in what was given,\n"
           "             2 wrong command line, 3 environment (no GPU, cannot write, ...)\n\n"
           "environment: LUZ_DEVICE chooses the GPU by a part of its name,\n"
           "             LUZ_VALIDATION=1 turns the validation layer on,\n"
           "             LUZ_LOG=debug|info|warning|error|none sets what is printed\n");
}

static bool wants_json;

void tool_begin(const ToolCommon *common) {
    wants_json = common->json;
    // Facts of the engine (the device in use, ...) are for those who ask with LUZ_LOG.
    if (!getenv("LUZ_LOG")) log_set_level(LOG_SEVERITY_WARNING);
    jobs_start(common->threads);
}

void tool_end(void) { jobs_stop(); }

static int run(int argc, char **argv) {
    if (argc < 2) {
        print_help();
        return TOOL_USAGE;
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        // `luz help shot` reads as well as `luz shot --help`.
        for (u32 i = 0; argc > 2 && i < COUNT_OF(commands); i++)
            if (strcmp(argv[2], commands[i]->name) == 0)
                return commands[i]->run(2, (char *[]){argv[2], (char *)"--help", NULL});
        print_help();
        return TOOL_OK;
    }
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        printf("luz %s (%s)\n", LUZ_VERSION, luz_build_id);
        return TOOL_OK;
    }
    const char *names[COUNT_OF(commands)];
    for (u32 i = 0; i < COUNT_OF(commands); i++) {
        names[i] = commands[i]->name;
        if (strcmp(name, names[i]) == 0) return commands[i]->run(argc - 1, argv + 1);
    }
    const char *near = tool_suggest(name, names, COUNT_OF(names));
    if (near)
        return tool_fail(TOOL_USAGE, "", "unknown command '%s'; did you mean '%s'?", name, near);
    return tool_fail(TOOL_USAGE, "", "unknown command '%s'; see `luz --help`", name);
}

// A reader of JSON gets some whatever happens.
static void print_failure(int code) {
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_bool(&json, "ok", false);
    json_u64(&json, "status", (u64)code);
    json_text(&json, "error", tool_explanation());
    json_close(&json);
    json_print(&json);
    json_free(&json);
}

int main(int argc, char **argv) {
    int code = run(argc, argv);
    if (wants_json && code != TOOL_OK && !json_was_printed()) print_failure(code);
    // A result that nobody got is no success.
    if (fflush(stdout) == 0 && !ferror(stdout)) return code;
    return tool_fail(TOOL_ENVIRONMENT, "", "the output cannot be written: %s", strerror(errno));
}
