// json.c: a JSON writer.
// Data in: keys and values in order. Data out: text with two-blank indentation.
// Called by: commands with --json or --stats. Does not: parse, sort, or check duplicate keys.
#include "json.h"
#include "../engine/base/file.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(Json *json, const char *text, u64 size) {
    if (json->size + size + 1 > json->cap) {
        json->cap = MAX(json->cap * 2, json->size + size + 1);
        json->text = realloc(json->text, json->cap);
        LUZ_ASSERT(json->text);
    }
    memcpy(json->text + json->size, text, size);
    json->size += size;
    json->text[json->size] = 0;
}

static void put_text(Json *json, const char *text) { put(json, text, strlen(text)); }

// Length of the valid UTF-8 sequence at text, 0 if there is none (RFC 3629: no overlong forms, no
// surrogates, nothing above U+10FFFF).
static u32 utf8_length(const u8 *text) {
    u8 first = text[0];
    if (first < 0x80) return 1;
    u32 length = first >= 0xF0 && first <= 0xF4   ? 4
                 : first >= 0xE0                  ? 3
                 : first >= 0xC2 && first <= 0xDF ? 2
                                                  : 0;
    if (length == 0 || first > 0xF4) return 0;
    for (u32 i = 1; i < length; i++)
        if ((text[i] & 0xC0) != 0x80) return 0; // also stops at the terminating zero
    bool bad = (first == 0xE0 && text[1] < 0xA0) || (first == 0xED && text[1] > 0x9F) ||
               (first == 0xF0 && text[1] < 0x90) || (first == 0xF4 && text[1] > 0x8F);
    return bad ? 0 : length;
}

static void put_escaped(Json *json, const char *value) {
    put_text(json, "\"");
    for (const u8 *c = (const u8 *)value; *c;) {
        char escape[8];
        u32 length = utf8_length(c);
        if (length == 0) {
            put_text(json, "\xEF\xBF\xBD");
            c++;
            continue;
        }
        if (*c == '"' || *c == '\\') {
            put(json, (char[]){'\\', (char)*c}, 2);
        } else if (*c == '\n') {
            put_text(json, "\\n");
        } else if (*c == '\t') {
            put_text(json, "\\t");
        } else if (*c < 0x20 || *c == 0x7F) {
            snprintf(escape, sizeof escape, "\\u%04x", *c);
            put_text(json, escape);
        } else {
            put(json, (const char *)c, length);
        }
        c += length;
    }
    put_text(json, "\"");
}

static void new_line(Json *json) {
    put_text(json, "\n");
    for (u32 i = 0; i < json->depth; i++) put_text(json, "  ");
}

// Comma, line, key: what comes before every value.
static void lead(Json *json, const char *key) {
    bool flat = json->flat[json->depth];
    if (json->has_items[json->depth]) put_text(json, flat ? ", " : ",");
    json->has_items[json->depth] = true;
    if (json->depth > 0 && !flat) new_line(json);
    if (!key) return;
    put_escaped(json, key);
    put_text(json, ": ");
}

Json json_begin(void) {
    Json json = {0};
    put(&json, "", 0);
    return json;
}

void json_free(Json *json) {
    free(json->text);
    *json = (Json){0};
}

static void open(Json *json, const char *key, const char *bracket, char closing, bool flat) {
    LUZ_ASSERT(json->depth < JSON_DEPTH_CAP);
    lead(json, key);
    put_text(json, bracket);
    bool parent_flat = json->flat[json->depth];
    json->closing[json->depth++] = closing;
    json->has_items[json->depth] = false;
    json->flat[json->depth] = flat || parent_flat;
}

void json_open_object(Json *json, const char *key) { open(json, key, "{", '}', false); }
void json_open_array(Json *json, const char *key) { open(json, key, "[", ']', false); }
void json_open_flat_object(Json *json, const char *key) { open(json, key, "{", '}', true); }
void json_open_flat_array(Json *json, const char *key) { open(json, key, "[", ']', true); }

void json_close(Json *json) {
    LUZ_ASSERT(json->depth > 0);
    bool line = json->has_items[json->depth] && !json->flat[json->depth];
    json->depth--;
    if (line) new_line(json);
    put(json, &json->closing[json->depth], 1);
}

void json_text(Json *json, const char *key, const char *value) {
    lead(json, key);
    put_escaped(json, value);
}

void json_u64(Json *json, const char *key, u64 value) {
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    lead(json, key);
    put_text(json, text);
}

void json_f64(Json *json, const char *key, f64 value) {
    char text[40];
    snprintf(text, sizeof text, "%.6g", value);
    lead(json, key);
    put_text(json, isfinite(value) ? text : "null");
}

void json_bool(Json *json, const char *key, bool value) {
    lead(json, key);
    put_text(json, value ? "true" : "false");
}

void json_hash(Json *json, const char *key, u64 hash) {
    char text[24];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    json_text(json, key, text);
}

static bool was_printed;
bool json_was_printed(void) { return was_printed; }

void json_print(Json *json) {
    LUZ_ASSERT(json->depth == 0);
    was_printed = true;
    puts(json->text);
    fflush(stdout);
}

bool json_save(Json *json, const char *path) {
    LUZ_ASSERT(json->depth == 0);
    put_text(json, "\n");
    return file_write(path, json->text, json->size);
}
