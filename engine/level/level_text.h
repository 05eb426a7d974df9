// level_text.h: text that grows: what the writer, the schema and the formatter build.
#ifndef LUZ_LEVEL_TEXT_H
#define LUZ_LEVEL_TEXT_H
#include "../base/arena.h"

// Zero is an empty text. Memory is the C heap's until text_finish.
typedef struct TextBuilder {
    char *data;
    u64 size, cap;
} TextBuilder;

void text_add(TextBuilder *text, const char *format, ...) PRINTF_LIKE(2, 3);
void text_add_bytes(TextBuilder *text, const char *data, u64 size);
// With quotes and escapes that TOML and JSON have in common.
void text_add_quoted(TextBuilder *text, const char *string);
// The shortest number that reads back to the same bits; as an integer if not is_f32.
void text_add_number(TextBuilder *text, f64 value, bool is_f32);
// Moves the text into the arena and frees the builder.
const char *text_finish(TextBuilder *text, Arena *arena);
#endif
