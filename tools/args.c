// args.c: the option parser of all commands.
// Data in: a ToolSpec (table of options with their targets) and argv. Data out: filled targets,
// positional arguments, or a message with a suggestion; --help from the same table.
// Called by: every command. Does not: abbreviate option names, read the environment.
#include "../engine/base/log.h"
#include "../engine/level/suggest.h"
#include "tool.h"
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPTIONS_CAP 64
#define HELP_COLUMN 28

int tool_fail(int code, const char *command, const char *format, ...) {
    char text[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(stderr, command[0] ? "luz %s: %s\n" : "luz%s: %s\n", command, text);
    tool_explain(text);
    return code;
}

static char explanation[2048];
void tool_explain(const char *sentence) {
    snprintf(explanation, sizeof explanation, "%s", sentence);
}

const char *tool_explanation(void) {
    if (!explanation[0]) log_last_error(explanation, sizeof explanation);
    return explanation;
}

const char *tool_suggest(const char *wrong, const char *const *words, u32 count) {
    Suggestion suggestion = suggest_begin(wrong);
    for (u32 i = 0; i < count; i++) suggest_offer(&suggestion, words[i]);
    return suggestion.best;
}

// --- the table with the common options ---

typedef struct OptionTable {
    ToolOption rows[OPTIONS_CAP];
    u32 count;
} OptionTable;

static void option_table_fill(OptionTable *table, const ToolSpec *spec, ToolCommon *common) {
    LUZ_ASSERT(spec->option_count + 6 <= OPTIONS_CAP);
    table->count = spec->option_count;
    if (spec->option_count)
        memcpy(table->rows, spec->options, spec->option_count * sizeof(ToolOption));
    const ToolOption shared[] = {
        {"threads", 't', OPTION_U32, &common->threads, "N",
         "worker threads; 0 = one a core, 1 = serial"},
        {"device", 0, OPTION_TEXT, &common->device, "NAME",
         "GPU whose name contains NAME (\"llvmpipe\", \"NVIDIA\")"},
        {"validation", 0, OPTION_FLAG, &common->validation, NULL,
         "run under the Vulkan validation layer; any message is a failure"},
        {"json", 0, OPTION_FLAG, &common->json, NULL, "machine-readable result on stdout"},
        {"quiet", 'q', OPTION_FLAG, &common->quiet, NULL, "no progress, no notes"},
    };
    for (u32 i = 0; i < COUNT_OF(shared); i++) table->rows[table->count++] = shared[i];
}

static void print_option(const ToolOption *option) {
    char left[96];
    int length =
        snprintf(left, sizeof left, "  %c%c%c--%s%s%s", option->letter ? '-' : ' ',
                 option->letter ? option->letter : ' ', option->letter ? ' ' : ' ', option->name,
                 option->value ? " " : "", option->value ? option->value : "");
    // Help text goes on in its column; a long option pushes it to the next line.
    if (length >= HELP_COLUMN)
        printf("%s\n%*s", left, HELP_COLUMN, "");
    else
        printf("%-*s", HELP_COLUMN, left);
    for (const char *c = option->help; *c; c++) {
        putchar(*c);
        if (*c == '\n') printf("%*s", HELP_COLUMN, "");
    }
    putchar('\n');
}

static void print_help(const ToolSpec *spec, const OptionTable *table) {
    printf("usage: luz %s %s\n\n%s\n", spec->command, spec->synopsis, spec->about);
    if (spec->option_count) printf("\noptions:\n");
    for (u32 i = 0; i < spec->option_count; i++) print_option(&table->rows[i]);
    printf("\noptions of every command:\n");
    for (u32 i = spec->option_count; i < table->count; i++) print_option(&table->rows[i]);
    const ToolOption help = {"help", 'h', OPTION_FLAG, NULL, NULL, "this text"};
    print_option(&help);
    printf("\nexit status: 0 all well, 1 errors or differences in what was given,\n"
           "             2 wrong command line, 3 environment (no GPU, cannot write, ...)\n");
    if (spec->examples) printf("\nexamples:\n%s", spec->examples);
}

// --- values ---

static bool parse_u32(const char *text, const char **end, u32 *out) {
    if (text[0] < '0' || text[0] > '9') return false;
    errno = 0;
    char *stop;
    unsigned long long value = strtoull(text, &stop, 10);
    if (errno || value > UINT32_MAX) return false;
    *out = (u32)value;
    *end = stop;
    return true;
}

static bool parse_pair(const char *text, char separator, u32 out[2]) {
    const char *end;
    u32 pair[2];
    if (!parse_u32(text, &end, &pair[0]) || *end != separator) return false;
    if (!parse_u32(end + 1, &end, &pair[1]) || *end) return false;
    memcpy(out, pair, sizeof pair);
    return true;
}

// Returns NULL or what was expected.
static const char *option_set(const ToolOption *option, const char *value) {
    const char *end;
    switch (option->type) {
    case OPTION_FLAG:
        *(bool *)option->target = true;
        return NULL;
    case OPTION_TEXT:
        *(const char **)option->target = value;
        return NULL;
    case OPTION_U32:
        return parse_u32(value, &end, option->target) && !*end ? NULL : "a whole number";
    case OPTION_F64: {
        char *stop;
        f64 number = strtod(value, &stop);
        if (stop == value || *stop || !isfinite(number)) return "a number";
        *(f64 *)option->target = number;
        return NULL;
    }
    case OPTION_SIZE: {
        u32 *size = option->target;
        bool ok = parse_pair(value, 'x', size) && size[0] >= 1 && size[1] >= 1 &&
                  size[0] <= 16384 && size[1] <= 16384;
        return ok ? NULL : "WIDTHxHEIGHT, each 1 to 16384";
    }
    case OPTION_SHARD: {
        u32 *shard = option->target;
        bool ok = parse_pair(value, '/', shard) && shard[0] >= 1 && shard[0] <= shard[1];
        return ok ? NULL : "I/N with 1 <= I <= N";
    }
    case OPTION_LIST: {
        ToolList *list = option->target;
        if (list->count == TOOL_LIST_CAP) return "fewer of them";
        list->items[list->count++] = value;
        return NULL;
    }
    case OPTION_PAIR: {
        const char **pair = option->target;
        pair[pair[0] != NULL] = value;
        return NULL;
    }
    }
    return "something else";
}

// --- parsing ---

static const ToolOption *find_option(const OptionTable *table, const char *argument, u64 length) {
    for (u32 i = 0; i < table->count; i++) {
        const ToolOption *option = &table->rows[i];
        if (argument[1] == '-') {
            if (strlen(option->name) == length - 2 &&
                strncmp(option->name, argument + 2, length - 2) == 0)
                return option;
        } else if (length == 2 && option->letter && option->letter == argument[1]) {
            return option;
        }
    }
    return NULL;
}

static ToolParse report_unknown(const ToolSpec *spec, const OptionTable *table,
                                const char *argument, u64 length) {
    const char *names[OPTIONS_CAP];
    for (u32 i = 0; i < table->count; i++) names[i] = table->rows[i].name;
    char name[SUGGEST_WORD_MAX + 1];
    const char *bare = argument + strspn(argument, "-");
    snprintf(name, sizeof name, "%.*s", (int)(length - (u64)(bare - argument)), bare);
    const char *near = tool_suggest(name, names, table->count);
    if (near)
        tool_fail(0, spec->command, "unknown option '%.*s'; did you mean '--%s'?", (int)length,
                  argument, near);
    else
        tool_fail(0, spec->command, "unknown option '%.*s'; see `luz %s --help`", (int)length,
                  argument, spec->command);
    return PARSE_ERROR;
}

// One option at argv[*i]; *i moves over its value.
static ToolParse parse_option(const ToolSpec *spec, const OptionTable *table, int argc, char **argv,
                              int *i) {
    const char *argument = argv[*i];
    u64 length = strcspn(argument, "=");
    if (argument[1] != '-') length = strlen(argument);
    const ToolOption *option = find_option(table, argument, length);
    if (!option) return report_unknown(spec, table, argument, length);
    const char *value = argument[length] ? argument + length + 1 : NULL;
    if (option->type == OPTION_PAIR) {
        // Given again, it starts over; the first value may stand behind a '='.
        memset(option->target, 0, 2 * sizeof(const char *));
        if (*i + (value ? 1 : 2) >= argc) {
            tool_fail(0, spec->command, "option '--%s' needs two values (%s)", option->name,
                      option->value);
            return PARSE_ERROR;
        }
        option_set(option, value ? value : argv[++*i]);
        value = argv[++*i];
    }
    if (option->type == OPTION_FLAG) {
        if (value) {
            tool_fail(0, spec->command, "option '--%s' takes no value", option->name);
            return PARSE_ERROR;
        }
    } else if (!value) {
        if (*i + 1 >= argc) {
            tool_fail(0, spec->command, "option '--%s' needs a value (%s)", option->name,
                      option->value);
            return PARSE_ERROR;
        }
        value = argv[++*i];
    }
    const char *expected = option_set(option, value);
    if (!expected) return PARSE_RUN;
    tool_fail(0, spec->command, "option '--%s' expects %s, not '%s'", option->name, expected,
              value);
    return PARSE_ERROR;
}

ToolParse tool_parse(const ToolSpec *spec, int argc, char **argv, ToolCommon *common,
                     ToolList *positional) {
    static OptionTable table;
    option_table_fill(&table, spec, common);
    positional->count = 0;
    // Help wins over any mistake beside it.
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--help") != 0 && strcmp(argv[i], "-h") != 0) continue;
        print_help(spec, &table);
        return PARSE_HELP;
    }
    bool only_positional = false;
    for (int i = 1; i < argc; i++) {
        if (!only_positional && strcmp(argv[i], "--") == 0) {
            only_positional = true;
        } else if (!only_positional && argv[i][0] == '-' && argv[i][1]) {
            if (parse_option(spec, &table, argc, argv, &i) == PARSE_ERROR) return PARSE_ERROR;
        } else if (positional->count == MIN(spec->positional_max, TOOL_LIST_CAP)) {
            tool_fail(0, spec->command, "'%s' is one argument too many; usage: luz %s %s", argv[i],
                      spec->command, spec->synopsis);
            return PARSE_ERROR;
        } else {
            positional->items[positional->count++] = argv[i];
        }
    }
    if (positional->count >= spec->positional_min) return PARSE_RUN;
    tool_fail(0, spec->command, "something is missing; usage: luz %s %s", spec->command,
              spec->synopsis);
    return PARSE_ERROR;
}
