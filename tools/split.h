// split.h: `--split A B`: one view drawn in two ways, for shot and replay.
#ifndef LUZ_TOOL_SPLIT_H
#define LUZ_TOOL_SPLIT_H
#include "../engine/capture/image_compare.h"
#include "headless.h"

typedef struct SplitOptions {
    const char *ways[2]; // as settings_set_list reads them; NULL = no split
    const char *mode;    // NULL = line
    f64 at;              // the line, 0..1 of the width
} SplitOptions;
#define SPLIT_OPTIONS_DEFAULT                                                                      \
    { .at = 0.5 }

// Rows of a command's option table.
#define SPLIT_TOOL_OPTIONS(options)                                                                \
    {"split",                                                                                      \
     0,                                                                                            \
     OPTION_PAIR,                                                                                  \
     (options).ways,                                                                               \
     "A B",                                                                                        \
     "draw it in two ways, left and right of a line, and print how they\n"                         \
     "differ. A way is a path, settings, or both: deferred,layout=packed"},                        \
        {"split-at", 0, OPTION_F64, &(options).at, "X", "where the line is: 0 to 1, default 0.5"}, \
    {                                                                                              \
        "split-mode", 0, OPTION_TEXT, &(options).mode, "M", "one of: " SPLIT_MODE_WORDS            \
    }

typedef struct Split {
    RenderSettings settings[2]; // of A and B
    SplitView view;
    char labels[2][96]; // captions; the view points to them
    // Of the newest picture.
    RenderImage image, ways[2];
    ImageDifference difference;
} Split;

// Both ways over `base`. False after a message (then: TOOL_USAGE): an unknown setting, two sizes.
bool split_begin(Split *split, const SplitOptions *options, const RenderSettings *base,
                 const char *command);
// Each way alone, the joint picture, the difference; images in the arena. False: no device.
bool split_draw(Split *split, Renderer *renderer, const Packet *a, const Packet *b, Arena *arena);
void split_print(const Split *split);
void split_json(const Split *split, Json *json);
#endif
