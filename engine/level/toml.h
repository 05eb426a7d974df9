// toml.h: TOML 1.0 text as a plain tree of C nodes, in the order of the file.
//
// Data in: text from a stranger. Data out: nodes in an arena, each with the place of its key and of
// its value, so that every later check can point at the text. Called by level_read.c and
// level_format.c. The parser behind it is toml++ (toml.cpp is the only C++ of this folder); nothing
// of it shows here. Does not: write TOML, keep comments, or report more than the first syntax
// error.
#ifndef LUZ_TOML_H
#define LUZ_TOML_H
#include "../base/arena.h"
#ifdef __cplusplus
extern "C" {
#endif

// What is refused before the parser sees it (the parser overflows its stack on such input).
#define TOML_DOTS_MAX    32      // parts of a dotted key
#define TOML_NESTING_MAX 64      // brackets within brackets
#define TOML_VALUES_MAX  2000000 // separators outside strings, an upper bound of the nodes

typedef enum TomlType {
    TOML_STRING,
    TOML_INTEGER,
    TOML_FLOAT,
    TOML_BOOLEAN,
    TOML_DATE, // date, time or both: no level key takes one
    TOML_ARRAY,
    TOML_TABLE,
} TomlType;

// Marked text: 1-based line and column, columns and length count bytes, length is at least 1.
typedef struct TomlPlace {
    u32 line, column, length;
} TomlPlace;

typedef struct TomlNode {
    TomlType type;
    u32 count;       // of children
    const char *key; // in tables, zero-terminated; NULL in arrays
    TomlPlace key_place;
    TomlPlace place; // of the value; of a [table] or [[table]] its header
    union {
        const char *string; // zero-terminated, UTF-8, without zero bytes inside
        i64 integer;
        f64 number;
        bool boolean;
        struct TomlNode *first; // child, in file order
    };
    struct TomlNode *next; // sibling
} TomlNode;

typedef struct TomlError {
    TomlPlace place;
    char text[240];
} TomlError;

// Parses zero-terminated text of `size` bytes. False with one error: syntax, or a limit above, or
// more nodes than the arena can hold. The tree and its strings live in the arena.
bool toml_parse(const char *text, u64 size, Arena *arena, TomlNode **root, TomlError *error);

// Child of a table by key, or NULL.
const TomlNode *toml_find(const TomlNode *table, const char *key);
// "a string", "an integer", ... for messages.
const char *toml_type_name(TomlType type);

#ifdef __cplusplus
}
#endif
#endif
