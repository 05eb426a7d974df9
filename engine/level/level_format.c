// level_format.c: the formatter of level text.
// Data in: text that parses. Data out: the same tokens with uniform space between them:
//   key = value             one space around '=', none around the dots of a key
//   { a = 1, b = [1, 2] }   braces have inner spaces, brackets have none; ", " between values
//   [[entity]]              one blank line before a header and the comments that belong to it
//   [                       what goes on over lines is indented by 4 per open bracket
// no blank line at the start or the end or twice in a row, no space at the end of a line, lines end
// in \n. Called by `luz fmt`. Does not: break or join lines, sort, or respell values.
#include "level_format.h"
#include "level_text.h"
#include "toml.h"
#include <string.h>

typedef struct Formatter {
    const char *in;
    TextBuilder out;
    char brackets[TOML_NESTING_MAX + 2]; // open ones: '[' or '{'
    u32 depth;
    bool line_has_text; // something was put on this line
    bool expects_key;   // at the start of a line, or behind '{' or ',' in a table
    u32 blank_lines;    // seen and not yet written
    u64 line_start;     // in out: where this line begins
    u64 comments_start; // in out: where the block of comment lines above begins; UINT64_MAX: none
    char last;          // last token: a punctuation mark, 'v' a value or key, 0 none on this line
} Formatter;

static const char *string_end(const char *at) {
    char quote = *at;
    bool is_long = at[1] == quote && at[2] == quote;
    if (is_long) {
        at += 3;
        while (*at && !(at[0] == quote && at[1] == quote && at[2] == quote))
            at += *at == '\\' && quote == '"' && at[1] ? 2 : 1;
        if (*at) at += 3;
        for (u32 i = 0; i < 2 && *at == quote; i++) at++; // quotes that belong to the text
        return at;
    }
    at++;
    while (*at && *at != quote && *at != '\n') at += *at == '\\' && quote == '"' && at[1] ? 2 : 1;
    return *at == quote ? at + 1 : at;
}

static const char *bare_end(const char *at) {
    while (*at && !strchr(" \t\r\n#,=[]{}\"'", *at)) at++;
    return at;
}

// A blank line in front of a header goes in front of the comments right above it.
static void open_header(Formatter *f) {
    bool has_comments = f->comments_start != UINT64_MAX && f->blank_lines == 0;
    u64 at = has_comments ? f->comments_start : f->out.size;
    if (at == 0) return;
    // Already there?
    if (at >= 2 && f->out.data[at - 1] == '\n' && f->out.data[at - 2] == '\n') return;
    text_add_bytes(&f->out, "\n", 1);
    memmove(f->out.data + at + 1, f->out.data + at, f->out.size - at - 1);
    f->out.data[at] = '\n';
}

static void put(Formatter *f, const char *data, u64 size, bool space_before) {
    if (!f->line_has_text) {
        if (f->blank_lines && f->out.size > 0 && f->last != '[' && f->last != '{') {
            text_add_bytes(&f->out, "\n", 1);
            f->comments_start = UINT64_MAX;
        }
        f->blank_lines = 0;
        f->line_start = f->out.size;
        bool closes = f->depth > 0 && (data[0] == ']' || data[0] == '}') && size == 1;
        for (u32 i = 0; i + closes < f->depth; i++) text_add_bytes(&f->out, "    ", 4);
        f->line_has_text = true;
    } else if (space_before) {
        text_add_bytes(&f->out, " ", 1);
    }
    text_add_bytes(&f->out, data, size);
}

static void end_line(Formatter *f) {
    if (!f->line_has_text) {
        f->blank_lines++;
    } else {
        text_add_bytes(&f->out, "\n", 1);
    }
    f->line_has_text = false;
    if (f->depth == 0) {
        f->expects_key = true;
        f->last = 0;
    }
}

// The line's comment. Its distance from the text is the author's (columns of comments stay
// columns), at least one space.
static const char *format_comment(Formatter *f, const char *at, u64 spaces) {
    const char *end = at;
    while (*end && *end != '\n') end++;
    const char *text_end = end;
    while (text_end > at && strchr(" \t\r", text_end[-1])) text_end--;
    bool starts_line = !f->line_has_text;
    if (!starts_line)
        for (u64 i = 1; i < spaces; i++) text_add_bytes(&f->out, " ", 1);
    bool continues = f->comments_start != UINT64_MAX && f->blank_lines == 0;
    put(f, at, (u64)(text_end - at), true);
    if (starts_line && f->depth == 0 && !continues) f->comments_start = f->line_start;
    return end;
}

// [name] or [[name]]: taken as it is, without spaces outside quotes.
static const char *format_header(Formatter *f, const char *at) {
    open_header(f);
    f->blank_lines = 0;
    while (*at && *at != '\n' && at[strspn(at, " \t")] != '#') {
        if (*at == '"' || *at == '\'') {
            const char *end = string_end(at);
            put(f, at, (u64)(end - at), false);
            at = end;
            continue;
        }
        if (!strchr(" \t\r", *at)) put(f, at, 1, false);
        at++;
    }
    f->last = 'v';
    return at;
}

static void format_mark(Formatter *f, const char *at) {
    char c = *at;
    char open = f->depth ? f->brackets[f->depth - 1] : 0;
    if (c == '[' || c == '{') {
        put(f, at, 1, f->last == '=' || f->last == ',' || f->last == '{');
        LUZ_ASSERT(f->depth < COUNT_OF(f->brackets)); // bounded by toml_parse
        f->brackets[f->depth++] = c;
        f->expects_key = c == '{';
    } else if (c == ']' || c == '}') {
        put(f, at, 1, c == '}' && f->last != '{');
        if (f->depth) f->depth--;
        f->expects_key = false;
    } else {
        put(f, at, 1, c == '=');
        f->expects_key = c == ',' && open == '{';
    }
    f->last = c == ']' || c == '}' ? 'v' : c;
}

// A key part, dot or value. Values may hold one space (dates with a time).
static void format_word(Formatter *f, const char *at, u64 size) {
    bool joins = f->expects_key && f->last == 'v';
    put(f, at, size, f->last != 0 && f->last != '[' && !joins);
    f->last = 'v';
}

static void format_all(Formatter *f) {
    const char *at = f->in;
    while (*at) {
        u64 spaces = strspn(at, " \t");
        at += spaces;
        if (*at == '\n' || (*at == '\r' && at[1] == '\n')) {
            at += *at == '\r' ? 2 : 1;
            end_line(f);
        } else if (*at == '\r') {
            at++;
        } else if (*at == '#') {
            at = format_comment(f, at, spaces);
        } else if (*at == '[' && f->depth == 0 && !f->line_has_text) {
            at = format_header(f, at);
            f->comments_start = UINT64_MAX;
        } else if (*at && strchr("[]{},=", *at)) {
            format_mark(f, at);
            if (*at == '=') f->expects_key = false;
            at++;
        } else if (*at) {
            if (f->depth == 0 && !f->line_has_text) f->comments_start = UINT64_MAX;
            const char *end = *at == '"' || *at == '\'' ? string_end(at) : bare_end(at);
            if (end == at) end++;
            format_word(f, at, (u64)(end - at));
            at = end;
        }
    }
    if (f->line_has_text) end_line(f);
}

bool level_format_text(const char *text, Arena *arena, const char **out) {
    *out = NULL;
    Arena scratch;
    if (!arena_create(&scratch, "level format", GIB(1))) return false;
    TomlNode *root;
    TomlError error;
    u64 size = strlen(text);
    bool is_good = toml_parse(text, size, &scratch, &root, &error);
    arena_destroy(&scratch);
    if (!is_good) return false;
    if (strncmp(text, "\xEF\xBB\xBF", 3) == 0) text += 3;
    Formatter f = {.in = text, .expects_key = true, .comments_start = UINT64_MAX};
    format_all(&f);
    *out = text_finish(&f.out, arena);
    return true;
}
