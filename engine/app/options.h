// options.h: the command line of a luz program: words in, AppDesc out.
//
// Every program on luz understands the same options; its own arguments it takes out first.
#ifndef LUZ_OPTIONS_H
#define LUZ_OPTIONS_H
#include "app.h"
#ifdef __cplusplus
extern "C" {
#endif

// What the options point to: keep it as long as the desc.
typedef struct AppOptions {
    RenderSettings settings, split;
} AppOptions;

#define OPTIONS_GO_ON (-1)
// Fills the desc with what argv says, over what is in it. Returns OPTIONS_GO_ON, or the exit code
// of a program that is to end now: 0 after --help, 2 after a mistake (LOG USAGE, with a
// suggestion).
int app_parse_options(int argc, char **argv, AppDesc *desc, AppOptions *options);

#ifdef __cplusplus
}
#endif
#endif
