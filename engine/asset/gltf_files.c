// gltf_files.c: what a model may read from disk, and how its names are understood.
//
// Data in: uris as written in the file, or decoded by the parser. Data out: bytes of regular
// files below the root. Called by the other glTF files, also back from the parser. Does not:
// fetch anything, or trust a name: the kernel keeps the path below the root (file_root_read),
// the checks here only say early and clearly what is wrong.
#include "gltf_raw.h"
#include "../base/hash.h"
#include <stdio.h>
#include <string.h>

#define TEXT_MAX 120

const char *gltf_copy_text(Arena *arena, const char *text, u64 size) {
    if (size > TEXT_MAX) {
        size = TEXT_MAX;
        while (size > 0 && ((u8)text[size] & 0xC0) == 0x80) size--; // not within a character
    }
    char *copy = arena_push(arena, size + 1, 1);
    for (u64 i = 0; i < size; i++) {
        u8 byte = (u8)text[i];
        copy[i] = byte < 32 || byte == 127 ? '_' : (char)byte;
    }
    return copy;
}

// Whether directory/name stays below the root, by its text.
static bool stays_inside(const char *directory, const char *name) {
    i32 depth = 0;
    const char *parts[2] = {directory, name};
    for (u32 i = 0; i < 2; i++)
        for (const char *p = parts[i]; *p;) {
            u64 length = strcspn(p, "/");
            if (length == 2 && p[0] == '.' && p[1] == '.') {
                if (--depth < 0) return false;
            } else if (length > 0 && !(length == 1 && p[0] == '.')) {
                depth++;
            }
            p += length;
            while (*p == '/') p++;
        }
    return depth > 0;
}

// What holds for a name after decoding. `name` is terminated; size counts what was meant.
static GltfUri check_name(const GltfFiles *files, const char *name, u64 size, char *why) {
    if (strlen(name) != size) {
        snprintf(why, ASSET_MESSAGE_CAP, "a file name holds a NUL character");
        return GLTF_URI_BAD;
    }
    for (u64 i = 0; i < size; i++)
        if ((u8)name[i] < 32 || name[i] == '\\') {
            snprintf(why, ASSET_MESSAGE_CAP, "a file name holds the character 0x%02x", (u8)name[i]);
            return GLTF_URI_BAD;
        }
    if (size == 0) {
        snprintf(why, ASSET_MESSAGE_CAP, "a file name is empty");
        return GLTF_URI_BAD;
    }
    u64 word = strcspn(name, ":/");
    if (name[word] == ':') {
        snprintf(why, ASSET_MESSAGE_CAP, "the uri scheme '%.*s:' is not supported",
                 (int)MIN(word, 24), name);
        return GLTF_URI_SCHEME;
    }
    if (name[0] == '/' || !stays_inside(files->directory, name)) {
        snprintf(why, ASSET_MESSAGE_CAP, "the file name '%.80s' leaves the data root", name);
        return GLTF_URI_BAD;
    }
    return GLTF_URI_OK;
}

static i32 hex_digit(u8 c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

GltfUri gltf_uri_decode(const GltfFiles *files, Bytes uri, char *out, char *why) {
    const u8 *text = uri.data;
    u64 used = 0;
    for (u64 i = 0; i < uri.size; i++) {
        u8 byte = text[i];
        if (used + 1 >= GLTF_PATH_CAP) {
            // A data uri of a kind that the parser does not know is long and has a scheme.
            out[used] = 0;
            if (check_name(files, out, used, why) == GLTF_URI_SCHEME) return GLTF_URI_SCHEME;
            snprintf(why, ASSET_MESSAGE_CAP, "a uri is longer than %d bytes", GLTF_PATH_CAP);
            return GLTF_URI_BAD;
        }
        if (byte == '%') {
            i32 high = i + 2 < uri.size ? hex_digit(text[i + 1]) : -1;
            i32 low = i + 2 < uri.size ? hex_digit(text[i + 2]) : -1;
            if (high < 0 || low < 0) {
                snprintf(why, ASSET_MESSAGE_CAP, "a uri has a '%%' without two hex digits");
                return GLTF_URI_BAD;
            }
            byte = (u8)(high << 4 | low);
            i += 2;
            if (byte == '/' || byte == '\\') {
                snprintf(why, ASSET_MESSAGE_CAP, "a uri hides a slash as %%%02x", byte);
                return GLTF_URI_BAD;
            }
        }
        out[used++] = (char)byte;
    }
    out[used] = 0;
    return check_name(files, out, used, why);
}

bool gltf_files_read(GltfFiles *files, const char *name, u64 name_size, Bytes *out, char *why) {
    char path[2 * GLTF_PATH_CAP];
    *out = (Bytes){0};
    if (name_size >= GLTF_PATH_CAP) {
        snprintf(why, ASSET_MESSAGE_CAP, "a file name is longer than %d bytes", GLTF_PATH_CAP);
        return false;
    }
    if (check_name(files, name, name_size, why) != GLTF_URI_OK) return false;
    snprintf(path, sizeof path, "%s%s%s", files->directory, files->directory[0] ? "/" : "", name);
    // Asked first, because an absent image is only a remark and must not log an error.
    if (file_root_stamp(files->root, path) == 0) {
        snprintf(why, ASSET_MESSAGE_CAP, "there is no file '%.100s'", path);
        return false;
    }
    if (!file_root_read(files->root, path, files->bytes_left, files->scratch, out)) {
        snprintf(why, ASSET_MESSAGE_CAP,
                 "the file '%.100s' cannot be read, or all files "
                 "together are over %llu MiB",
                 path, (unsigned long long)(ASSET_FILE_SIZE_MAX >> 20));
        return false;
    }
    files->bytes_left -= out->size;
    files->hash = hash_bytes(out->data, out->size, files->hash);
    return true;
}
