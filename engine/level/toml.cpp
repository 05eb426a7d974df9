// toml.cpp: the C face of toml++: pre-scan of hostile text, parse, copy into plain nodes.
//
// Data in: zero-terminated text. Data out: TomlNode tree in an arena. Called through toml.h only.
// The pre-scan refuses what is known to hurt the parser (key parts by the million, deep nesting,
// zero bytes, non-ASCII outside strings and comments); it is not a validator. toml++ counts columns
// in code points and sorts tables by key: both are put right here (bytes, file order).
#include "toml.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <vector>

namespace {

// Lines longer than this are not searched for multi-byte characters again and again: their columns
// stay code points.
constexpr u64 COLUMN_SEARCH_MAX = 65536;

struct Source {
    const char *text;
    u64 size;
    std::vector<u64> line_first; // offset of each line, and one past the end
};

struct ArenaFull {};

void list_lines(Source &source) {
    source.line_first.push_back(0);
    for (u64 i = 0; i < source.size; i++)
        if (source.text[i] == '\n') source.line_first.push_back(i + 1);
}

// Byte column of a code point column.
u32 byte_column(const Source &source, u32 line, u32 column) {
    if (line == 0 || line > source.line_first.size()) return column;
    u64 first = source.line_first[line - 1];
    u64 end = line < source.line_first.size() ? source.line_first[line] : source.size;
    if (end - first > COLUMN_SEARCH_MAX) return column;
    u64 at = first;
    for (u32 c = 1; c < column && at < end; c++) {
        at++;
        while (at < end && (source.text[at] & 0xC0) == 0x80) at++;
    }
    return static_cast<u32>(at - first) + 1;
}

// Of a text that goes over several lines only the first is marked.
TomlPlace place_of(const Source &source, const toml::source_region &region) {
    TomlPlace place = {region.begin.line, region.begin.column, 1};
    if (place.line == 0) place.line = 1;
    if (place.column == 0) place.column = 1;
    place.column = byte_column(source, place.line, place.column);
    if (place.line < source.line_first.size()) // the end of the file counts as behind its last line
        place.column = std::min(place.column, static_cast<u32>(source.line_first[place.line] -
                                                               source.line_first[place.line - 1]));
    u32 end = place.column + 1;
    if (region.end.line == region.begin.line) {
        end = byte_column(source, region.end.line, region.end.column);
    } else if (region.end.line > region.begin.line && place.line < source.line_first.size()) {
        end = static_cast<u32>(source.line_first[place.line] - source.line_first[place.line - 1]);
    }
    if (end > place.column) place.length = end - place.column;
    return place;
}

void *push(Arena *arena, u64 size, u64 align) {
    if (!arena_can_push(arena, size, align)) throw ArenaFull{};
    return arena_push(arena, size, align);
}

const char *push_string(Arena *arena, std::string_view text) {
    char *copy = static_cast<char *>(push(arena, text.size() + 1, 1));
    std::memcpy(copy, text.data(), text.size());
    return copy;
}

struct Refused {
    toml::source_region region;
    const char *text;
};

void fill(TomlNode &out, const toml::node &node, const Source &source, Arena *arena);

void fill_table(TomlNode &out, const toml::table &table, const Source &source, Arena *arena) {
    struct Entry {
        const toml::key *key;
        const toml::node *node;
    };
    std::vector<Entry> entries;
    entries.reserve(table.size());
    for (auto &&[key, value] : table) entries.push_back({&key, &value});
    std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) {
        const auto &x = a.key->source().begin, &y = b.key->source().begin;
        return x.line != y.line ? x.line < y.line : x.column < y.column;
    });
    TomlNode **link = &out.first;
    for (const Entry &entry : entries) {
        auto *child = static_cast<TomlNode *>(push(arena, sizeof(TomlNode), alignof(TomlNode)));
        std::string_view key = entry.key->str();
        if (std::memchr(key.data(), 0, key.size()))
            throw Refused{entry.key->source(), "a key must not contain a zero character"};
        child->key = push_string(arena, key);
        child->key_place = place_of(source, entry.key->source());
        fill(*child, *entry.node, source, arena);
        *link = child;
        link = &child->next;
        out.count++;
    }
}

// Depth is bounded by TOML_NESTING_MAX brackets of at most TOML_DOTS_MAX parts.
void fill(TomlNode &out, const toml::node &node, const Source &source, Arena *arena) {
    out.place = place_of(source, node.source());
    if (const auto *table = node.as_table()) {
        out.type = TOML_TABLE;
        fill_table(out, *table, source, arena);
    } else if (const auto *array = node.as_array()) {
        out.type = TOML_ARRAY;
        TomlNode **link = &out.first;
        for (const toml::node &element : *array) {
            auto *child = static_cast<TomlNode *>(push(arena, sizeof(TomlNode), alignof(TomlNode)));
            fill(*child, element, source, arena);
            *link = child;
            link = &child->next;
            out.count++;
        }
    } else if (const auto *string = node.as_string()) {
        out.type = TOML_STRING;
        if (std::memchr(string->get().data(), 0, string->get().size()))
            throw Refused{node.source(), "a string must not contain a zero character"};
        out.string = push_string(arena, string->get());
    } else if (const auto *integer = node.as_integer()) {
        out.type = TOML_INTEGER;
        out.integer = integer->get();
    } else if (const auto *number = node.as_floating_point()) {
        out.type = TOML_FLOAT;
        out.number = number->get();
    } else if (const auto *boolean = node.as_boolean()) {
        out.type = TOML_BOOLEAN;
        out.boolean = boolean->get();
    } else {
        out.type = TOML_DATE;
    }
}

bool refuse(TomlError *error, const char *text, u64 offset, u32 line, u64 line_first) {
    error->place = {line, static_cast<u32>(offset - line_first) + 1, 1};
    std::snprintf(error->text, sizeof error->text, "%s", text);
    return false;
}

// End of a string that opens at i; multi-line strings move line and line_first along.
u64 skip_string(const char *text, u64 size, u64 i, u32 *line, u64 *line_first) {
    char quote = text[i];
    bool is_multi_line = i + 2 < size && text[i + 1] == quote && text[i + 2] == quote;
    i += is_multi_line ? 3 : 1;
    while (i < size && text[i]) {
        if (text[i] == '\\' && quote == '"' && i + 1 < size && text[i + 1] != '\n') {
            i += 2;
        } else if (text[i] == '\n') {
            if (!is_multi_line) return i; // the parser reports it
            ++*line;
            *line_first = ++i;
        } else if (text[i] == quote && !is_multi_line) {
            return i + 1;
        } else if (text[i] == quote && i + 2 < size && text[i + 1] == quote &&
                   text[i + 2] == quote) {
            i += 3;
            while (i < size && text[i] == quote) i++; // up to two quotes may belong to the text
            return i;
        } else {
            i++;
        }
    }
    return MIN(i, size);
}

bool scan(const char *text, u64 size, TomlError *error) {
    u32 line = 1, dots = 0, nesting = 0, values = 0;
    u64 line_first = 0, i = 0;
    if (size >= 3 && std::memcmp(text, "\xEF\xBB\xBF", 3) == 0) i = 3;
    while (i < size) {
        unsigned char c = static_cast<unsigned char>(text[i]);
        if (c == 0) return refuse(error, "the file contains a zero byte", i, line, line_first);
        if (c >= 0x80)
            return refuse(error, "only ASCII may stand outside of strings and comments", i, line,
                          line_first);
        if (c == '"' || c == '\'') {
            i = skip_string(text, size, i, &line, &line_first);
            continue;
        }
        if (c == '#') {
            while (i < size && text[i] && text[i] != '\n') i++;
            continue;
        }
        if (c == '.' && ++dots > TOML_DOTS_MAX)
            return refuse(error, "a key has more than 32 parts", i, line, line_first);
        if (c == '[' || c == '{') {
            if (++nesting > TOML_NESTING_MAX)
                return refuse(error, "brackets are nested more than 64 deep", i, line, line_first);
        }
        if ((c == ']' || c == '}') && nesting > 0) nesting--;
        if (c == '=' || c == ',' || c == '[') {
            if (++values > TOML_VALUES_MAX)
                return refuse(error, "the file has more than 2000000 values", i, line, line_first);
        }
        if (std::strchr("=,[]{}\n", c)) dots = 0;
        i++;
        if (c == '\n') {
            line++;
            line_first = i;
        }
    }
    return true;
}

// "Error while parsing x: y" says no more than "y" next to the marked place. Control characters
// and backslashes are already escaped by the parser.
void set_error(TomlError *error, const Source &source, const toml::source_region &region,
               std::string_view text) {
    error->place = place_of(source, region);
    std::string_view lead = "Error while parsing ";
    std::size_t colon = text.find(": ");
    if (text.substr(0, lead.size()) == lead && colon != std::string_view::npos)
        text = text.substr(colon + 2);
    std::snprintf(error->text, sizeof error->text, "%.*s", static_cast<int>(text.size()),
                  text.data());
}

} // namespace

extern "C" bool toml_parse(const char *text, u64 size, Arena *arena, TomlNode **root,
                           TomlError *error) {
    *error = TomlError{};
    *root = nullptr;
    error->place = {1, 1, 1};
    if (!scan(text, size, error)) return false;
    u64 mark = arena_mark(arena);
    try {
        Source source{text, size, {}};
        list_lines(source);
        toml::table table = toml::parse(std::string_view(text, size));
        auto *node = static_cast<TomlNode *>(push(arena, sizeof(TomlNode), alignof(TomlNode)));
        fill(*node, table, source, arena);
        *root = node;
        return true;
    } catch (const toml::parse_error &e) {
        Source source{text, size, {}};
        list_lines(source);
        set_error(error, source, e.source(), e.description());
    } catch (const Refused &e) {
        Source source{text, size, {}};
        list_lines(source);
        set_error(error, source, e.region, e.text);
    } catch (const ArenaFull &) {
        std::snprintf(error->text, sizeof error->text,
                      "the file has more values than memory allows");
    } catch (const std::exception &e) {
        std::snprintf(error->text, sizeof error->text, "the file cannot be parsed: %s", e.what());
    }
    arena_rewind(arena, mark);
    return false;
}

extern "C" const TomlNode *toml_find(const TomlNode *table, const char *key) {
    for (const TomlNode *child = table->first; child; child = child->next)
        if (std::strcmp(child->key, key) == 0) return child;
    return nullptr;
}

extern "C" const char *toml_type_name(TomlType type) {
    static const char *const names[] = {"a string", "an integer", "a number", "true or false",
                                        "a date",   "a list",     "a table"};
    return names[type];
}
