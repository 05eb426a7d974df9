// asset_fixture.c: see asset_fixture.h.
#include "asset_fixture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const TriangleBin triangle_bin = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2, 0}};

static AssetFixture fixture;

static void catch_message(LogId id, LogLevel level, const char *text, void *user) {
    AssetFixture *f = user;
    (void)level;
    f->id_count[id]++;
    snprintf(f->text[id], sizeof f->text[id], "%s", text);
}

AssetFixture *fixture_open(void) {
    memset(&fixture, 0, sizeof fixture);
    log_set_level(LOG_SEVERITY_NONE);
    log_set_sink(catch_message, &fixture);
    assert_true(asset_store_create(&fixture.store));
    assert_true(file_root_open(&fixture.root, test_temp_dir()));
    return &fixture;
}

void fixture_close(AssetFixture *f) {
    assert_int_equal(f->store.scratch.used, 0);
    file_root_close(&f->root);
    asset_store_destroy(&f->store);
    log_set_sink(NULL, NULL);
}

void fixture_forget(AssetFixture *f) {
    memset(f->id_count, 0, sizeof f->id_count);
    memset(f->text, 0, sizeof f->text);
}

void fixture_write(const char *name, const void *data, u64 size) {
    FILE *file = fopen(test_temp_path(name), "wb");
    assert_non_null(file);
    if (size) assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

u32 fixture_load_bytes(AssetFixture *f, const void *data, u64 size) {
    char name[32];
    snprintf(name, sizeof name, "model_%u", f->file_count++);
    fixture_write(name, data, size);
    return asset_load_model(&f->store, &f->root, name);
}

u32 fixture_load_text(AssetFixture *f, const char *json) {
    return fixture_load_bytes(f, json, strlen(json));
}

static void put_u32(u8 *at, u64 value) {
    u32 word = (u32)value;
    memcpy(at, &word, 4);
}

const u8 *fixture_make_glb(const char *json, const void *bin, u64 bin_size, u64 *size) {
    static u8 *glb;
    u64 json_size = ALIGN_UP(strlen(json), 4), padded = ALIGN_UP(bin_size, 4);
    *size = 20 + json_size + (bin ? 8 + padded : 0);
    glb = realloc(glb, *size);
    assert_non_null(glb);
    memset(glb, 0, *size);
    put_u32(glb, 0x46546C67);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, *size);
    put_u32(glb + 12, json_size);
    put_u32(glb + 16, 0x4E4F534A);
    memset(glb + 20, ' ', json_size);
    memcpy(glb + 20, json, strlen(json));
    if (bin) {
        put_u32(glb + 20 + json_size, padded);
        put_u32(glb + 24 + json_size, 0x004E4942);
        memcpy(glb + 28 + json_size, bin, bin_size);
    }
    return glb;
}

u32 fixture_load_glb(AssetFixture *f, const char *json, const void *bin, u64 bin_size) {
    u64 size;
    const u8 *glb = fixture_make_glb(json, bin, bin_size, &size);
    return fixture_load_bytes(f, glb, size);
}

const char *fixture_data_uri(const void *data, u64 size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char head[] = "data:application/octet-stream;base64,";
    static char *text;
    const u8 *in = data;
    text = realloc(text, sizeof head + (size + 2) / 3 * 4);
    assert_non_null(text);
    char *out = text + sizeof head - 1;
    memcpy(text, head, sizeof head);
    for (u64 i = 0; i < size; i += 3) {
        u32 left = (u32)MIN(size - i, 3);
        u32 bits = (u32)in[i] << 16 | (left > 1 ? (u32)in[i + 1] << 8 : 0) |
                   (left > 2 ? (u32)in[i + 2] : 0);
        for (u32 k = 0; k < 4; k++) *out++ = k <= left ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    *out = 0;
    return text;
}

const char *fixture_replace(const char *text, const char *from, const char *to) {
    static char *slots[4];
    static u32 next;
    const char *at = strstr(text, from);
    if (!at) print_error("'%s' is not in the text\n", from);
    assert_non_null(at);
    u64 size = strlen(text) - strlen(from) + strlen(to) + 1;
    char *out = malloc(size);
    assert_non_null(out);
    snprintf(out, size, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    free(slots[next % 4]); // after the copy: text may live in it
    slots[next++ % 4] = out;
    return out;
}

StoreShape fixture_shape(const AssetFixture *f) {
    return (StoreShape){f->store.arena.used, f->store.mesh_count, f->store.texture_count,
                        f->store.model_count};
}

void fixture_assert_said(const AssetFixture *f, LogId id, const char *words, const char *file,
                         int line) {
    if (strstr(f->text[id], words)) return;
    print_error("%s should say '%s', said '%s'\n", log_id_name(id), words, f->text[id]);
    _fail(file, line);
}

void fixture_assert_refused(const AssetFixture *f, StoreShape before, u32 id, const char *words,
                            const char *file, int line) {
    StoreShape after = fixture_shape(f);
    if (id != 0) print_error("the model was not refused (expected: %s)\n", words);
    _assert_int_equal(id, 0, file, line);
    fixture_assert_said(f, LOG_ASSET_MODEL, words, file, line);
    _assert_memory_equal(&before, &after, sizeof before, file, line);
    _assert_int_equal(f->store.scratch.used, 0, file, line);
}
