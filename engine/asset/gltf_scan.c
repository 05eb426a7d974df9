// gltf_scan.c: looks at a glTF file before a parser does.
//
// Data in: the file's bytes. Data out: where its JSON lies, or a reason to refuse it. Called by
// asset_load_model. Does not: parse (a text that is not JSON is the parser's to refuse; up to its
// first error this scan and the parser agree on strings and nesting).
//
// Why: the parser recurses once per nesting level in `extras` and `extensions`, makes objects of
// up to 2 KB of two characters ("{}"), copies a container's binary chunk once for every buffer that
// names no file, and reads a negative or huge size as if it were not there.
#include "gltf_raw.h"
#include <stdio.h>
#include <string.h>

#define GLB_MAGIC      0x46546C67u // "glTF"
#define GLB_CHUNK_JSON 0x4E4F534Au
#define GLB_CHUNK_BIN  0x004E4942u

// Elements of arrays at the top level.
static const struct {
    const char *key;
    u32 max;
} array_limits[] = {{"accessors", 1u << 20},
                    {"bufferViews", 1u << 20},
                    {"nodes", 1u << 18},
                    {"meshes", 1u << 16},
                    {"materials", ASSET_MATERIALS_MAX - 1}, // one is our default
                    {"images", 4096},
                    {"textures", 4096},
                    {"samplers", 4096},
                    {"cameras", 4096},
                    {"buffers", 4096},
                    {"scenes", 4096},
                    {"skins", 1u << 14},
                    {"animations", 1u << 14},
                    {"extensionsUsed", 1024},
                    {"extensionsRequired", 1024}};

// Keys whose values must be whole numbers from 0 to 2^32 - 1 (or, for some, something else than a
// number): the parser quietly ignores others.
static const char *const whole_number_keys[] = {
    "byteOffset",    "byteLength", "byteStride", "count",    "bufferView", "buffer",
    "componentType", "mesh",       "camera",     "skin",     "indices",    "material",
    "source",        "index",      "scene",      "texCoord", "mode"};

typedef struct Scan {
    const u8 *text;
    u64 at, size;
    u32 depth, objects;
    u64 values;
    u64 key_start, key_size; // the last string, while it may be or is a key
    u32 array_elements;      // of the top-level array we are in
    i32 array_limit;         // index into array_limits, -1
    u32 free_depth;          // inside extras or extensions: the depth at which they began, else 0
    u32 buffer_elements;
    bool is_object[GLTF_JSON_DEPTH_MAX + 1];
} Scan;

static bool refuse(char *why, const char *text, u64 number) {
    snprintf(why, ASSET_MESSAGE_CAP, text, (unsigned long long)number);
    return false;
}

static bool key_is(const Scan *s, const char *word) {
    return s->key_size == strlen(word) && memcmp(s->text + s->key_start, word, s->key_size) == 0;
}

// Past a string; at its opening quote now. An unclosed one ends the scan.
static bool skip_string(Scan *s, char *why) {
    u64 start = ++s->at;
    bool escaped = false;
    while (s->at < s->size && s->text[s->at] != '"') {
        if (s->text[s->at] == '\\') escaped = true, s->at++;
        s->at++;
    }
    s->key_start = start;
    s->key_size = s->at < s->size ? s->at - start : 0;
    if (s->at < s->size) s->at++;
    // Keys are compared as written; at the top level an escape could hide one from the limits.
    if (escaped && s->depth == 1 && s->is_object[1]) {
        u64 after = s->at;
        while (after < s->size && strchr(" \t\r\n", s->text[after]) && s->text[after]) after++;
        if (after < s->size && s->text[after] == ':')
            return refuse(why, "JSON at byte %llu: a key at the top level has an escape", start);
    }
    return true;
}

static bool check_whole_number(const Scan *s, u64 start, char *why) {
    for (u32 i = 0; i < COUNT_OF(whole_number_keys); i++) {
        if (!key_is(s, whole_number_keys[i])) continue;
        u64 digits = 0;
        while (start + digits < s->size && s->text[start + digits] >= '0' &&
               s->text[start + digits] <= '9')
            digits++;
        u64 end = start + digits, value = 0;
        for (u64 d = start; d < end && digits <= 10; d++) value = value * 10 + (s->text[d] - '0');
        bool ends = end >= s->size || strchr(",]} \t\r\n", s->text[end]);
        if (digits >= 1 && digits <= 10 && value <= UINT32_MAX && ends) return true;
        snprintf(why, ASSET_MESSAGE_CAP,
                 "JSON at byte %llu: %s is not a whole number from 0 to 4294967295",
                 (unsigned long long)start, whole_number_keys[i]);
        return false;
    }
    return true;
}

// A value begins at s->at: count it, against the text and against its top-level array.
static bool count_value(Scan *s, char *why) {
    if (++s->values > GLTF_JSON_VALUES_MAX)
        return refuse(why, "the JSON has more than %llu values", GLTF_JSON_VALUES_MAX);
    if (s->depth == 2 && !s->is_object[2] && s->array_limit >= 0) {
        u32 max = array_limits[s->array_limit].max;
        if (strcmp(array_limits[s->array_limit].key, "buffers") == 0) s->buffer_elements++;
        if (++s->array_elements > max) {
            snprintf(why, ASSET_MESSAGE_CAP, "more than %u %s", max,
                     array_limits[s->array_limit].key);
            return false;
        }
    }
    return true;
}

static bool open_container(Scan *s, bool object, char *why) {
    if (object && ++s->objects > GLTF_JSON_OBJECTS_MAX)
        return refuse(why, "the JSON has more than %llu objects", GLTF_JSON_OBJECTS_MAX);
    if (s->depth == GLTF_JSON_DEPTH_MAX)
        return refuse(why, "the JSON is nested deeper than %llu levels", GLTF_JSON_DEPTH_MAX);
    if (s->depth == 1) {
        s->array_limit = -1;
        s->array_elements = 0;
        for (u32 i = 0; !object && i < COUNT_OF(array_limits); i++)
            if (key_is(s, array_limits[i].key)) s->array_limit = (i32)i;
    }
    bool key_is_ours = s->depth > 0 && s->is_object[s->depth];
    s->is_object[++s->depth] = object;
    if (!s->free_depth && key_is_ours && (key_is(s, "extras") || key_is(s, "extensions")))
        s->free_depth = s->depth;
    s->key_size = 0;
    return true;
}

static bool scan_json(Scan *s, char *why) {
    while (s->at < s->size) {
        u8 c = s->text[s->at];
        if (c == '"') {
            bool may_be_key = s->depth > 0 && s->is_object[s->depth];
            if (!count_value(s, why) || !skip_string(s, why)) return false;
            if (!may_be_key) s->key_size = 0;
            continue;
        }
        s->at++;
        if (c == '{' || c == '[') {
            if (!count_value(s, why) || !open_container(s, c == '{', why)) return false;
        } else if (c == '}' || c == ']') {
            if (s->free_depth == s->depth) s->free_depth = 0;
            if (s->depth == 0) return true; // not JSON: the parser says where
            s->depth--;
            s->key_size = 0;
        } else if (c == ',') {
            s->key_size = 0;
        } else if (c == '-' || (c >= '0' && c <= '9')) {
            u64 start = s->at - 1;
            bool keyed = s->depth > 0 && s->is_object[s->depth] && s->key_size > 0;
            if (!count_value(s, why)) return false;
            if (keyed && !s->free_depth && !check_whole_number(s, start, why)) return false;
            while (s->at < s->size && s->text[s->at] && strchr("0123456789+-.eE", s->text[s->at]))
                s->at++;
        } else if (c >= 'a' && c <= 'z') {
            if (!count_value(s, why)) return false;
            while (s->at < s->size && s->text[s->at] >= 'a' && s->text[s->at] <= 'z') s->at++;
        }
    }
    return true;
}

static u32 read_u32(const u8 *p) {
    return (u32)p[0] | (u32)p[1] << 8 | (u32)p[2] << 16 | (u32)p[3] << 24;
}

// glTF 2.0, section 4: a header of 12 bytes, a JSON chunk, perhaps a BIN chunk, others ignored.
static bool scan_container(Bytes file, Bytes *json, Bytes *bin, char *why) {
    const u8 *data = file.data;
    if (file.size < 20) return refuse(why, "a GLB of %llu bytes is cut off", file.size);
    if (read_u32(data + 4) != 2)
        return refuse(why, "the GLB container has version %llu, not 2", read_u32(data + 4));
    if (read_u32(data + 8) != file.size) {
        snprintf(why, ASSET_MESSAGE_CAP, "the GLB says %u bytes and has %llu", read_u32(data + 8),
                 (unsigned long long)file.size);
        return false;
    }
    u64 at = 12;
    for (u32 chunk = 0; at < file.size; chunk++) {
        if (file.size - at < 8) return refuse(why, "GLB chunk at byte %llu is cut off", at);
        u64 size = read_u32(data + at);
        u32 kind = read_u32(data + at + 4);
        if (size > file.size - at - 8 || size % 4)
            return refuse(why, "GLB chunk at byte %llu has a wrong length", at);
        Bytes bytes = {data + at + 8, size};
        if (chunk == 0 && kind != GLB_CHUNK_JSON)
            return refuse(why, "the first GLB chunk is not JSON (byte %llu)", at);
        if (chunk == 0) *json = bytes;
        if (chunk == 1 && kind == GLB_CHUNK_BIN) *bin = bytes;
        at += 8 + size;
    }
    return true;
}

bool gltf_scan(Bytes file, Bytes *json, bool *binary, char *why) {
    Bytes bin = {0};
    *binary = file.size >= 4 && read_u32(file.data) == GLB_MAGIC;
    *json = file;
    if (*binary && !scan_container(file, json, &bin, why)) return false;
    if (json->size == 0) return refuse(why, "the file has %llu bytes of JSON", 0);
    if (json->size > GLTF_JSON_SIZE_MAX)
        return refuse(why, "the JSON is over %llu bytes", GLTF_JSON_SIZE_MAX);
    Scan scan = {.text = json->data, .size = json->size, .array_limit = -1};
    if (!scan_json(&scan, why)) return false;
    if (scan.buffer_elements * bin.size > ASSET_FILE_SIZE_MAX)
        return refuse(why, "%llu buffers in one GLB are too many", scan.buffer_elements);
    return true;
}
