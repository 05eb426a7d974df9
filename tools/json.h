// json.h: writes JSON into memory: objects, arrays, escaped text, hashes as hexadecimal text.
//
//   Json json = json_begin();
//   json_open_object(&json, NULL); json_u64(&json, "tick", 3); ... json_close(&json);
//   json_print(&json) or json_save(&json, path); json_free(&json);
// Inside arrays the key is NULL. Not a parser.
#ifndef LUZ_JSON_H
#define LUZ_JSON_H
#include "../engine/base/base.h"

#define JSON_DEPTH_CAP 16

typedef struct Json {
    char *text; // zero-terminated
    u64 size, cap;
    u32 depth;
    char closing[JSON_DEPTH_CAP];
    bool has_items[JSON_DEPTH_CAP + 1];
    bool flat[JSON_DEPTH_CAP + 1]; // on one line
} Json;

Json json_begin(void);
void json_free(Json *json);
void json_open_object(Json *json, const char *key);
void json_open_array(Json *json, const char *key);
// The same on one line.
void json_open_flat_object(Json *json, const char *key);
void json_open_flat_array(Json *json, const char *key);
void json_close(Json *json);
// Invalid UTF-8 becomes U+FFFD, so that every reader takes the result.
void json_text(Json *json, const char *key, const char *value);
void json_u64(Json *json, const char *key, u64 value);
// Not finite numbers become null.
void json_f64(Json *json, const char *key, f64 value);
void json_bool(Json *json, const char *key, bool value);
void json_hash(Json *json, const char *key, u64 hash); // "0123456789abcdef"
void json_print(Json *json);                           // to stdout, with a newline
bool json_was_printed(void);
bool json_save(Json *json, const char *path);
#endif
