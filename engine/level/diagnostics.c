// diagnostics.c: errors and warnings with their place, source line, caret and hint.
// Data in: a place in the text and a message. Data out: items of a Diagnostics, sorted by place,
// and their printed form. Called by the level readers (add, sort) and by whoever shows them
// (format, print). Does not: decide what is an error, or keep more than LEVEL_DIAGNOSTICS_MAX (the
// rest is counted).
#include "level_internal.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SOURCE_SHOWN_MAX 160 // bytes of a source line that are kept
#define SOURCE_LEAD      60  // of them before the place, in a longer line

// Bytes of the UTF-8 character at text, or 0 if it is none that a terminal should see: damaged, or
// a control character.
static u32 shown_size(const char *text, u64 left) {
    u8 c = (u8)text[0];
    if (c < 0x80) return c >= 32 && c != 127;
    u32 size = c >= 0xF0 ? 4 : c >= 0xE0 ? 3 : 2;
    if (c < 0xC2 || c > 0xF4 || size > left) return 0;
    for (u32 i = 1; i < size; i++)
        if (((u8)text[i] & 0xC0) != 0x80) return 0;
    return c == 0xC2 && (u8)text[1] < 0xA0 ? 0 : size;
}

// The text of a line, cut to a window around the column if it is long.
static void take_source(Diagnostic *diagnostic, const LevelText *text, Arena *arena) {
    diagnostic->source = "";
    diagnostic->caret = 0;
    if (diagnostic->line == 0 || diagnostic->line > text->line_count) return;
    u64 first = text->line_first[diagnostic->line - 1];
    u64 end = text->size; // not searched for: a line can be the whole of a hostile file
    if (diagnostic->line < text->line_count) end = text->line_first[diagnostic->line] - 1;
    if (end > first && text->data[end - 1] == '\r') end--;
    u64 at = MIN(first + diagnostic->column - 1, end);
    u64 from = first;
    if (end - first > SOURCE_SHOWN_MAX && at - first > SOURCE_LEAD) {
        from = at - SOURCE_LEAD;
        while (from > first && ((u8)text->data[from] & 0xC0) == 0x80) from--;
    }
    u64 to = MIN(end, from + SOURCE_SHOWN_MAX);
    char *copy = ARENA_PUSH(arena, char, to - from + 1);
    for (u64 i = from; i < to;) {
        // Tabs would move the caret away, control characters do harm to a terminal.
        u32 size = shown_size(text->data + i, to - i);
        if (size == 0) copy[i - from] = (u8)text->data[i] < 0x80 ? ' ' : '?';
        if (size > 0) memcpy(copy + (i - from), text->data + i, size);
        i += MAX(size, 1u);
    }
    diagnostic->source = copy;
    diagnostic->caret = (u32)(at - from);
}

static void add(Diagnostics *diagnostics, bool is_error, const char *file, const LevelText *text,
                TomlPlace place, const char *hint, const char *format, va_list args) {
    if (is_error) {
        diagnostics->error_count++;
    } else {
        diagnostics->warning_count++;
    }
    if (diagnostics->count >= LEVEL_DIAGNOSTICS_MAX) return;
    char message[512];
    vsnprintf(message, sizeof message, format, args);
    Diagnostic *diagnostic = &diagnostics->items[diagnostics->count++];
    *diagnostic = (Diagnostic){
        .is_error = is_error,
        .file = file,
        .line = place.line,
        .column = place.column,
        .length = MAX(place.length, 1u),
        .text = arena_copy_string(diagnostics->arena, message),
        .hint = hint && hint[0] ? arena_copy_string(diagnostics->arena, hint) : "",
    };
    take_source(diagnostic, text, diagnostics->arena);
}

void level_error(LevelReader *reader, TomlPlace place, const char *hint, const char *format, ...) {
    va_list args;
    va_start(args, format);
    add(reader->diagnostics, true, reader->file, &reader->text, place, hint, format, args);
    va_end(args);
}

void level_warning(LevelReader *reader, TomlPlace place, const char *hint, const char *format,
                   ...) {
    va_list args;
    va_start(args, format);
    add(reader->diagnostics, false, reader->file, &reader->text, place, hint, format, args);
    va_end(args);
}

static int compare_places(const void *a, const void *b) {
    const Diagnostic *x = a, *y = b;
    if (x->line != y->line) return x->line < y->line ? -1 : 1;
    if (x->column != y->column) return x->column < y->column ? -1 : 1;
    return strcmp(x->text, y->text);
}

void level_sort_diagnostics(Diagnostics *diagnostics) {
    qsort(diagnostics->items, diagnostics->count, sizeof(Diagnostic), compare_places);
}

// Columns that a terminal shows for the first `bytes` bytes of UTF-8 text.
static u32 shown_width(const char *text, u32 bytes) {
    u32 width = 0;
    for (u32 i = 0; i < bytes && text[i]; i++) width += ((u8)text[i] & 0xC0) != 0x80;
    return width;
}

void diagnostic_format(const Diagnostic *diagnostic, char *out, u64 out_cap) {
    if (out_cap == 0) return;
    u32 source_size = (u32)strlen(diagnostic->source);
    u32 caret = MIN(diagnostic->caret, source_size);
    u32 marked = MIN(diagnostic->length, source_size - caret);
    u32 lead = shown_width(diagnostic->source, caret);
    u32 width = MAX(shown_width(diagnostic->source + caret, marked), 1u);
    char place[32] = "";
    if (diagnostic->line)
        snprintf(place, sizeof place, ":%u:%u", diagnostic->line, diagnostic->column);
    const char *severity = diagnostic->is_error ? "error" : "warning";
    if (!diagnostic->source[0]) {
        snprintf(out, out_cap, "%s%s: %s: %s%s%s\n", diagnostic->file, place, severity,
                 diagnostic->text, diagnostic->hint[0] ? "; " : "", diagnostic->hint);
        return;
    }
    char tildes[SOURCE_SHOWN_MAX + 1];
    width = MIN(width, SOURCE_SHOWN_MAX);
    memset(tildes, '~', width);
    tildes[0] = '^';
    tildes[width] = 0;
    snprintf(out, out_cap, "%s%s: %s: %s\n  %s\n  %*s%s%s%s\n", diagnostic->file, place, severity,
             diagnostic->text, diagnostic->source, (int)lead, "", tildes,
             diagnostic->hint[0] ? " " : "", diagnostic->hint);
}

void diagnostics_print(const Diagnostics *diagnostics, void *file_stream) {
    FILE *stream = file_stream;
    char text[2048];
    for (u32 i = 0; i < diagnostics->count; i++) {
        diagnostic_format(&diagnostics->items[i], text, sizeof text);
        fputs(text, stream);
    }
    u32 hidden = diagnostics->error_count + diagnostics->warning_count - diagnostics->count;
    if (hidden > 0) fprintf(stream, "%u more are not shown\n", hidden);
    fprintf(stream, "%u error%s, %u warning%s\n", diagnostics->error_count,
            diagnostics->error_count == 1 ? "" : "s", diagnostics->warning_count,
            diagnostics->warning_count == 1 ? "" : "s");
}
