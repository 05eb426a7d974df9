// level_text.c: a growing text. Data in: pieces. Data out: one zero-terminated string in an arena.
// Called by level_write.c, level_schema.c, level_format.c. Does not: know TOML or JSON beyond
// quotes.
#include "level_text.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void reserve(TextBuilder *text, u64 more) {
    if (text->size + more + 1 <= text->cap) return;
    text->cap = MAX(text->cap * 2, text->size + more + 1);
    text->cap = MAX(text->cap, KIB(4));
    text->data = realloc(text->data, text->cap);
    LUZ_ASSERT(text->data);
}

void text_add_bytes(TextBuilder *text, const char *data, u64 size) {
    reserve(text, size);
    memcpy(text->data + text->size, data, size);
    text->size += size;
    text->data[text->size] = 0;
}

void text_add(TextBuilder *text, const char *format, ...) {
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int size = vsnprintf(NULL, 0, format, args);
    LUZ_ASSERT(size >= 0);
    reserve(text, (u64)size);
    vsnprintf(text->data + text->size, (u64)size + 1, format, again);
    text->size += (u64)size;
    va_end(again);
    va_end(args);
}

void text_add_quoted(TextBuilder *text, const char *string) {
    text_add_bytes(text, "\"", 1);
    for (const char *c = string; *c; c++) {
        if (*c == '"' || *c == '\\') {
            text_add(text, "\\%c", *c);
        } else if ((u8)*c < 32 || (u8)*c == 127) {
            text_add(text, "\\u%04x", (u8)*c);
        } else {
            text_add_bytes(text, c, 1);
        }
    }
    text_add_bytes(text, "\"", 1);
}

void text_add_number(TextBuilder *text, f64 value, bool is_f32) {
    char number[32];
    if (is_f32) {
        // Nine digits always tell two floats apart.
        for (int digits = 6; digits <= 9; digits++) {
            snprintf(number, sizeof number, "%.*g", digits, value);
            if ((f32)strtod(number, NULL) == (f32)value) break;
        }
        // Without a fraction -0 would be read as the integer 0 and lose its sign.
        if (strcmp(number, "-0") == 0) snprintf(number, sizeof number, "-0.0");
    } else {
        snprintf(number, sizeof number, "%.0f", value);
    }
    text_add(text, "%s", number);
}

const char *text_finish(TextBuilder *text, Arena *arena) {
    char *copy = ARENA_PUSH(arena, char, text->size + 1);
    if (text->size > 0) memcpy(copy, text->data, text->size);
    free(text->data);
    *text = (TextBuilder){0};
    return copy;
}
