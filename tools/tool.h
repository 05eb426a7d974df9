// tool.h: what the commands of `luz` share: exit codes, the option parser, the command table.
//
// A command is one file with one `const ToolCommand`. It fills a struct of options through a
// table of ToolOption rows; --help is printed from the same rows, so it cannot lie.
#ifndef LUZ_TOOL_H
#define LUZ_TOOL_H
#include "../engine/base/base.h"

extern const char *const luz_build_id; // written by build.sh
#define LUZ_VERSION "0.1.0"

enum {
    TOOL_OK = 0,
    TOOL_DIFFERENT = 1,  // errors or differences in what was given
    TOOL_USAGE = 2,      // wrong command line
    TOOL_ENVIRONMENT = 3 // no GPU, cannot write, out of memory
};

typedef struct ToolCommand {
    const char *name, *summary;
    int (*run)(int argc, char **argv); // argv[0] is the command's name
} ToolCommand;

// X(name): one command a line, in the order of `luz --help`.
#define TOOL_COMMANDS(X)                                                                           \
    X(check)                                                                                       \
    X(fmt)                                                                                         \
    X(info)                                                                                        \
    X(shot)                                                                                        \
    X(record)                                                                                      \
    X(replay)                                                                                      \
    X(compare)                                                                                     \
    X(reference)                                                                                   \
    X(import)                                                                                      \
    X(schema)                                                                                      \
    X(bench)
#define X(name) extern const ToolCommand tool_##name;
TOOL_COMMANDS(X)
#undef X

// --- Options (args.c) ---

typedef enum ToolOptionType {
    OPTION_FLAG,  // bool
    OPTION_TEXT,  // const char *
    OPTION_U32,   // u32
    OPTION_F64,   // f64
    OPTION_SIZE,  // u32[2]: "1280x720"
    OPTION_SHARD, // u32[2]: "1/4", 1-based
    OPTION_LIST,  // ToolList: may be given many times
    OPTION_PAIR,  // const char *[2]: two values
} ToolOptionType;

#define TOOL_LIST_CAP 256
typedef struct ToolList {
    const char *items[TOOL_LIST_CAP];
    u32 count;
} ToolList;

typedef struct ToolOption {
    const char *name; // without the dashes
    char letter;      // 0 = none
    ToolOptionType type;
    void *target;
    const char *value; // word for the value in --help, NULL for flags
    const char *help;
} ToolOption;

// Options that every command has.
typedef struct ToolCommon {
    u32 threads; // 0 = one a core
    const char *device;
    bool validation, json, quiet;
} ToolCommon;

typedef struct ToolSpec {
    const char *command;  // "shot"
    const char *synopsis; // "LEVEL -o OUT.png [options]"
    const char *about;    // a paragraph
    const ToolOption *options;
    u32 option_count;
    u32 positional_min, positional_max;
    const char *examples; // lines, or NULL
} ToolSpec;

typedef enum ToolParse { PARSE_RUN, PARSE_HELP, PARSE_ERROR } ToolParse;

// Fills the targets, `common` and the positional arguments. PARSE_HELP: the help was printed on
// stdout, return TOOL_OK. PARSE_ERROR: the mistake was printed on stderr, return TOOL_USAGE.
ToolParse tool_parse(const ToolSpec *spec, int argc, char **argv, ToolCommon *common,
                     ToolList *positional);
// The nearest of the words to a mistyped one, or NULL if none is near.
const char *tool_suggest(const char *wrong, const char *const *words, u32 count);
// A message of this command on stderr: "luz shot: ...". Returns `code`.
int tool_fail(int code, const char *command, const char *format, ...) PRINTF_LIKE(3, 4);
// The sentence that --json gives for a command that failed without a result: that of tool_fail, or
// what was explained here, else the newest error of the log.
void tool_explain(const char *sentence);
const char *tool_explanation(void);

// Sets up what the common options say (threads, log level). Call tool_end before returning.
void tool_begin(const ToolCommon *common);
void tool_end(void);

// --- Progress (progress.c) ---

// A bar on a terminal; else a line for every tenth. One at a time, on stderr.
typedef struct Progress {
    const char *what;
    u32 total, done, shown;
    bool quiet, terminal;
    f64 start_ms, drawn_ms;
} Progress;
Progress progress_begin(const char *what, u32 total, bool quiet);
void progress_set(Progress *progress, u32 done, const char *note);
void progress_end(Progress *progress);

#endif
