// level_format.h: level text in one shape: what `luz fmt` does.
#ifndef LUZ_LEVEL_FORMAT_H
#define LUZ_LEVEL_FORMAT_H
#include "../base/arena.h"
#ifdef __cplusplus
extern "C" {
#endif
// Text in place: comments, order, line breaks and the spelling of values stay; spaces, indentation
// and blank lines become uniform. Formatting twice changes nothing more. False if the text is not
// TOML (it is then untouched and *out is NULL; level_load tells what is wrong).
bool level_format_text(const char *text, Arena *arena, const char **out);
#ifdef __cplusplus
}
#endif
#endif
