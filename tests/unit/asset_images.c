// asset_images.c: decoding under limits, hostile files, mips, textures of the store.
#include "asset_fixture.h"
#include "../../engine/asset/asset_internal.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include <stdlib.h>
#include <string.h>

#define SEED 77

// 16 x 8, red above blue, 4:2:0.
static const u8 small_jpeg[] = {
    0xFF, 0xD8, 0xFF, 0xE0, 0x00, 0x10, 0x4A, 0x46, 0x49, 0x46, 0x00, 0x01, 0x01, 0x00, 0x00, 0x01,
    0x00, 0x01, 0x00, 0x00, 0xFF, 0xDB, 0x00, 0x43, 0x00, 0x10, 0x0B, 0x0C, 0x0E, 0x0C, 0x0A, 0x10,
    0x0E, 0x0D, 0x0E, 0x12, 0x11, 0x10, 0x13, 0x18, 0x28, 0x1A, 0x18, 0x16, 0x16, 0x18, 0x31, 0x23,
    0x25, 0x1D, 0x28, 0x3A, 0x33, 0x3D, 0x3C, 0x39, 0x33, 0x38, 0x37, 0x40, 0x48, 0x5C, 0x4E, 0x40,
    0x44, 0x57, 0x45, 0x37, 0x38, 0x50, 0x6D, 0x51, 0x57, 0x5F, 0x62, 0x67, 0x68, 0x67, 0x3E, 0x4D,
    0x71, 0x79, 0x70, 0x64, 0x78, 0x5C, 0x65, 0x67, 0x63, 0xFF, 0xDB, 0x00, 0x43, 0x01, 0x11, 0x12,
    0x12, 0x18, 0x15, 0x18, 0x2F, 0x1A, 0x1A, 0x2F, 0x63, 0x42, 0x38, 0x42, 0x63, 0x63, 0x63, 0x63,
    0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63,
    0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63,
    0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0x63, 0xFF, 0xC0,
    0x00, 0x11, 0x08, 0x00, 0x08, 0x00, 0x10, 0x03, 0x01, 0x22, 0x00, 0x02, 0x11, 0x01, 0x03, 0x11,
    0x01, 0xFF, 0xC4, 0x00, 0x15, 0x00, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x06, 0xFF, 0xC4, 0x00, 0x16, 0x10, 0x01, 0x01, 0x01,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x14, 0x61,
    0xFF, 0xC4, 0x00, 0x15, 0x01, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x04, 0x06, 0xFF, 0xC4, 0x00, 0x18, 0x11, 0x00, 0x03, 0x01, 0x01,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x04, 0x15, 0x51,
    0x52, 0xFF, 0xDA, 0x00, 0x0C, 0x03, 0x01, 0x00, 0x02, 0x11, 0x03, 0x11, 0x00, 0x3F, 0x00, 0x99,
    0xAB, 0x4A, 0xB4, 0x14, 0xB2, 0xD6, 0xE4, 0x55, 0x16, 0x34, 0xFF, 0xD9,
};

static u8 *random_pixels(u32 width, u32 height, bool opaque) {
    u8 *pixels = malloc((u64)width * height * 4);
    for (u32 i = 0; i < width * height * 4; i++)
        pixels[i] = i % 4 == 3 && opaque ? 255 : (u8)random_u32(SEED, width, i);
    return pixels;
}

// A PNG of the pixels: its bytes in the fixture's scratch arena.
static Bytes encode_png(AssetFixture *f, const u8 *pixels, u32 width, u32 height, u32 channels) {
    Bytes bytes;
    assert_true(image_write_png(test_temp_path("image.png"), pixels, width, height, channels));
    assert_true(file_root_read(&f->root, "image.png", MIB(64), &f->store.scratch, &bytes));
    return bytes;
}

static void forget_bytes(AssetFixture *f) { arena_reset(&f->store.scratch); }

static Bytes copy_of(Bytes bytes) {
    u8 *copy = malloc(MAX(bytes.size, 1));
    memcpy(copy, bytes.data, bytes.size);
    return (Bytes){copy, bytes.size};
}

TEST(asset_images, png_goes_out_and_comes_back) {
    AssetFixture *f = fixture_open();
    static const u32 sizes[][2] = {{1, 1}, {7, 3}, {64, 33}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++) {
        u32 w = sizes[i][0], h = sizes[i][1], rw, rh;
        u8 *pixels = random_pixels(w, h, false), *back;
        assert_true(image_write_png(test_temp_path("a.png"), pixels, w, h, 4));
        assert_true(image_read(test_temp_path("a.png"), &f->store.scratch, &back, &rw, &rh));
        assert_true(rw == w && rh == h);
        assert_memory_equal(pixels, back, (u64)w * h * 4);
        forget_bytes(f);
        free(pixels);
    }
    u8 rgb[6] = {1, 2, 3, 4, 5, 6}, *back;
    u32 w, h;
    assert_true(image_write_png(test_temp_path("b.png"), rgb, 2, 1, 3));
    assert_true(image_read(test_temp_path("b.png"), &f->store.scratch, &back, &w, &h));
    assert_true(back[0] == 1 && back[3] == 255 && back[4] == 4 && back[7] == 255);
    forget_bytes(f);
    assert_false(image_write_png(test_temp_path("c.png"), rgb, 2, 1, 2)); // channels
    assert_false(image_read(test_temp_path("absent.png"), &f->store.scratch, &back, &w, &h));
    assert_null(back);
    fixture_close(f);
}

TEST(asset_images, jpeg_is_read) {
    AssetFixture *f = fixture_open();
    fixture_write("a.jpg", small_jpeg, sizeof small_jpeg);
    u32 id = asset_load_texture(&f->store, &f->root, "a.jpg", TEXTURE_SRGB);
    const Texture *t = &f->store.textures[id];
    assert_true(id > ASSET_TEXTURE_CHECKER);
    assert_true(t->width == 16 && t->height == 8 && t->mip_count == 5 && !t->has_alpha);
    assert_true(t->pixels[0] > 150 && t->pixels[2] < 100);                       // red
    assert_true(t->pixels[16 * 7 * 4] < 100 && t->pixels[16 * 7 * 4 + 2] > 150); // blue
    fixture_close(f);
}

// ---- hostile files ----

static void assert_no_image(Bytes file, const char *words) {
    char why[ASSET_MESSAGE_CAP] = "";
    u32 w, h;
    Bytes copy = copy_of(file); // at the end of its own block, so that a sanitizer sees over-reads
    bool probed = image_probe(copy, &w, &h, why);
    if (probed) {
        u8 *out = malloc((u64)w * h * 4);
        assert_false(image_decode(copy, w, h, TEXTURE_SRGB, out, why));
        free(out);
    }
    if (!strstr(why, words)) print_error("'%s' is not in '%s'\n", words, why);
    assert_non_null(strstr(why, words));
    free((void *)(uintptr_t)copy.data);
}

TEST(asset_images, files_that_are_no_images_are_refused) {
    u8 garbage[4096];
    for (u32 i = 0; i < sizeof garbage; i++) garbage[i] = (u8)random_u32(SEED, 1, i);
    garbage[0] = 0x80;
    assert_no_image((Bytes){"", 0}, "no bytes");
    assert_no_image((Bytes){"x", 1}, "not a PNG");
    assert_no_image((Bytes){garbage, sizeof garbage}, "not a PNG");
}

static void put_big(u8 *at, u32 value) {
    for (u32 i = 0; i < 4; i++) at[i] = (u8)(value >> (24 - 8 * i));
}

TEST(asset_images, huge_headers_are_refused_before_decoding) {
    u8 png[64] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
    static const u32 sizes[][2] = {{30000, 30000}, {8193, 1}, {1, 8193}, {0x7FFFFFFF, 2}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++) {
        put_big(png + 16, sizes[i][0]);
        put_big(png + 20, sizes[i][1]);
        png[24] = 8, png[25] = 6;
        assert_no_image((Bytes){png, sizeof png}, "");
    }
    u8 bmp[64] = {'B', 'M'};
    bmp[10] = 54, bmp[14] = 40, bmp[26] = 1, bmp[28] = 24;
    bmp[18] = 0x30, bmp[19] = 0x75, bmp[22] = 0x30, bmp[23] = 0x75; // 30000 x 30000
    assert_no_image((Bytes){bmp, sizeof bmp}, "over 8192 px");
    u8 tga[64] = {0, 0, 2};
    tga[12] = 0x30, tga[13] = 0x75, tga[14] = 0x30, tga[15] = 0x75, tga[16] = 32;
    assert_no_image((Bytes){tga, sizeof tga}, "over 8192 px");
}

TEST(asset_images, truncated_files_are_refused) {
    AssetFixture *f = fixture_open();
    u8 *pixels = random_pixels(16, 16, false);
    Bytes png = encode_png(f, pixels, 16, 16, 4);
    for (u64 size = 0; size < png.size - 16; size += 7)
        assert_no_image((Bytes){png.data, size}, "");
    free(pixels);
    forget_bytes(f);
    fixture_close(f);
}

TEST(asset_images, jpeg_tables_that_overflow_the_decoder_are_refused) {
    u8 jpeg[1024] = {0xFF, 0xD8, 0xFF, 0xC4, 0x02, 0x13, 0x00};
    for (u32 i = 0; i < 16; i++) jpeg[7 + i] = 255;
    assert_no_image((Bytes){jpeg, sizeof jpeg}, "Huffman table of 4080");
    u8 *scans = calloc(1, 8192); // a thousand empty scans
    scans[0] = 0xFF, scans[1] = 0xD8;
    for (u32 i = 0; i < 1000; i++) memcpy(scans + 2 + i * 8, "\xFF\xDA\x00\x06\x00\x00\x00\x00", 8);
    assert_no_image((Bytes){scans, 8002}, "scans");
    free(scans);
}

// Bytes of real files changed at random: no crash, and no size but the probed one.
static void mutate_and_decode(Bytes file, u64 stream, u32 rounds) {
    for (u32 round = 0; round < rounds; round++) {
        Bytes copy = copy_of(file);
        u8 *bytes = (u8 *)(uintptr_t)copy.data;
        for (u32 k = 0; k < 1 + round % 4; k++)
            bytes[random_u32(SEED, stream, round * 8 + k) % copy.size] =
                (u8)random_u32(SEED, stream + 1, round * 8 + k);
        char why[ASSET_MESSAGE_CAP] = "";
        u32 w, h;
        if (image_probe(copy, &w, &h, why) && (u64)w * h <= 1 << 16) {
            u8 *out = malloc((u64)w * h * 4);
            if (!image_decode(copy, w, h, TEXTURE_SRGB, out, why)) assert_true(why[0] != 0);
            free(out);
        }
        free(bytes);
    }
}

TEST(asset_images, mutated_files_do_no_harm) {
    AssetFixture *f = fixture_open();
    u8 *pixels = random_pixels(8, 8, false);
    Bytes png = encode_png(f, pixels, 8, 8, 4);
    mutate_and_decode(png, 10, 1500);
    mutate_and_decode((Bytes){small_jpeg, sizeof small_jpeg}, 20, 1500);
    u8 tga[18 + 64] = {0, 0, 10};
    tga[12] = 4, tga[14] = 4, tga[16] = 32, tga[18] = 0x8F;
    mutate_and_decode((Bytes){tga, sizeof tga}, 30, 1500);
    u8 bmp[54 + 48] = {'B', 'M'};
    bmp[10] = 54, bmp[14] = 40, bmp[18] = 4, bmp[22] = 4, bmp[26] = 1, bmp[28] = 24;
    mutate_and_decode((Bytes){bmp, sizeof bmp}, 40, 1500);
    free(pixels);
    forget_bytes(f);
    fixture_close(f);
}

TEST(asset_images, a_missing_or_damaged_texture_is_a_checker) {
    AssetFixture *f = fixture_open();
    assert_int_equal(asset_load_texture(&f->store, &f->root, "absent.png", TEXTURE_SRGB),
                     ASSET_TEXTURE_CHECKER);
    ASSERT_SAID(f, ASSET_IMAGE, "absent.png");
    fixture_write("bad.png", "not a picture", 13);
    StoreShape before = fixture_shape(f);
    assert_int_equal(asset_load_texture(&f->store, &f->root, "bad.png", TEXTURE_LINEAR),
                     ASSET_TEXTURE_CHECKER);
    ASSERT_SAID(f, ASSET_IMAGE, "bad.png: not a PNG");
    assert_int_equal(fixture_shape(f).arena_used, before.arena_used);
    assert_int_equal(asset_load_texture(&f->store, &f->root, "../bad.png", TEXTURE_SRGB),
                     ASSET_TEXTURE_CHECKER);
    const Texture *checker = &f->store.textures[ASSET_TEXTURE_CHECKER];
    assert_true(checker->width == 64 && checker->mip_count == 7);
    fixture_close(f);
}

// ---- textures of the store ----

TEST(asset_images, textures_are_shared_by_path_and_kind) {
    AssetFixture *f = fixture_open();
    u8 *pixels = random_pixels(4, 4, true);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 4, 4, 4));
    u32 a = asset_load_texture(&f->store, &f->root, "t.png", TEXTURE_SRGB);
    u32 b = asset_load_texture(&f->store, &f->root, "t.png", TEXTURE_SRGB);
    u32 c = asset_load_texture(&f->store, &f->root, "t.png", TEXTURE_LINEAR);
    assert_true(a == b && a != c && a > 1 && c > 1);
    assert_string_equal(asset_texture_path(&f->store, c), "t.png");
    assert_string_equal(asset_texture_path(&f->store, ASSET_TEXTURE_CHECKER), "");
    free(pixels);
    fixture_close(f);
}

TEST(asset_images, large_images_are_halved_to_the_cap) {
    AssetFixture *f = fixture_open();
    u8 *pixels = random_pixels(100, 20, true);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 100, 20, 4));
    f->store.texture_side_cap = 32;
    u32 id = asset_load_texture(&f->store, &f->root, "t.png", TEXTURE_LINEAR);
    assert_true(f->store.textures[id].width == 25 && f->store.textures[id].height == 5);
    assert_int_equal(f->store.textures[id].mip_count, 5);
    free(pixels);
    fixture_close(f);
}

TEST(asset_images, raw_textures_give_the_same_mips_as_files) {
    AssetFixture *f = fixture_open();
    u8 *pixels = random_pixels(31, 18, false);
    assert_true(image_write_png(test_temp_path("t.png"), pixels, 31, 18, 4));
    const Texture *a =
        &f->store.textures[asset_load_texture(&f->store, &f->root, "t.png", TEXTURE_SRGB)];
    const Texture *b =
        &f->store.textures[asset_add_texture(&f->store, pixels, 31, 18, TEXTURE_SRGB, true)];
    assert_int_equal(a->mip_count, 5);
    assert_memory_equal(a->pixels, b->pixels, image_mips_size(31, 18, 5));
    assert_true(a->has_alpha && b->has_alpha);
    u32 plain = asset_add_texture(&f->store, pixels, 31, 18, TEXTURE_SRGB, false);
    assert_int_equal(f->store.textures[plain].mip_count, 1);
    assert_int_equal(asset_add_texture(&f->store, pixels, 0, 4, TEXTURE_SRGB, true), 0);
    free(pixels);
    fixture_close(f);
}

// ---- mips ----

static void mean_of(const u8 *pixels, u32 count, bool srgb, f64 mean[4]) {
    for (u32 c = 0; c < 4; c++) mean[c] = 0;
    for (u32 i = 0; i < count; i++)
        for (u32 c = 0; c < 4; c++) {
            f32 value = pixels[i * 4 + c] / 255.0f;
            mean[c] += srgb && c < 3 ? srgb_to_linear(value) : value;
        }
    for (u32 c = 0; c < 4; c++) mean[c] /= count;
}

TEST(asset_images, mips_keep_the_mean_colour) {
    static const u32 sizes[][2] = {{64, 64}, {37, 53}, {1, 40}, {129, 2}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++)
        for (u32 kind = 0; kind < 2; kind++) {
            u32 w = sizes[i][0], h = sizes[i][1], mips = image_mip_count(w, h);
            u8 *pixels = malloc(image_mips_size(w, h, mips)), *source = random_pixels(w, h, true);
            memcpy(pixels, source, (u64)w * h * 4);
            image_build_mips(pixels, w, h, (TextureKind)kind);
            f64 first[4], mean[4];
            mean_of(pixels, w * h, kind == TEXTURE_SRGB, first);
            const u8 *level = pixels;
            for (u32 m = 1; m < mips; m++) {
                level += (u64)w * h * 4;
                w = MAX(w / 2, 1), h = MAX(h / 2, 1);
                mean_of(level, w * h, kind == TEXTURE_SRGB, mean);
                // Rounding to 8 bits, once a level, less where many pixels average it out.
                for (u32 c = 0; c < 3; c++) ASSERT_NEAR(mean[c], first[c], 0.008);
                assert_int_equal(level[3], 255);
            }
            free(source);
            free(pixels);
        }
}

// One pixel of the next level, from the definition: colour as light, weighted by alpha.
static void naive_half(const u8 *in, u32 width, u32 x, u32 y, bool srgb, f64 out[4]) {
    f64 sum[3] = {0}, alpha = 0;
    for (u32 k = 0; k < 4; k++) {
        const u8 *p = in + ((y * 2 + k / 2) * width + x * 2 + k % 2) * 4;
        for (u32 c = 0; c < 3; c++)
            sum[c] += (srgb ? (f64)srgb_to_linear(p[c] / 255.0f) : p[c] / 255.0) * p[3];
        alpha += p[3];
    }
    for (u32 c = 0; c < 3; c++) {
        f64 value = alpha > 0 ? sum[c] / alpha : 0;
        if (srgb) value = value <= 0.0031308 ? value * 12.92 : 1.055 * pow(value, 1 / 2.4) - 0.055;
        out[c] = value * 255;
    }
    out[3] = alpha / 4;
}

TEST(asset_images, halves_agree_with_the_definition_and_in_place) {
    enum { W = 64, H = 48 };
    for (u32 round = 0; round < 4; round++) {
        u8 *pixels = random_pixels(W, H, true), half[W * H];
        for (u32 i = 0; i < W * H / 2 && round >= 2; i++) // the upper half is not opaque
            pixels[i * 4 + 3] = (u8)(1 + random_u32(SEED, 9, i) % 255);
        for (u32 i = 0; i < W * H; i++) // dark colours are where codes are close together
            if (i % 3 == 0) pixels[i * 4] /= 16;
        image_halve(pixels, W, H, (TextureKind)(round % 2), half);
        for (u32 i = 0; i < W * H / 4; i++) {
            f64 want[4];
            naive_half(pixels, W, i % (W / 2), i / (W / 2), round % 2 == TEXTURE_SRGB, want);
            for (u32 c = 0; c < 4; c++) ASSERT_NEAR(half[i * 4 + c], want[c], 0.55);
        }
        image_halve(pixels, W, H, (TextureKind)(round % 2), pixels);
        assert_memory_equal(pixels, half, sizeof half);
        free(pixels);
    }
}

TEST(asset_images, srgb_is_averaged_as_light) {
    u8 pixels[4 * 4 + 4] = {0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255};
    image_build_mips(pixels, 2, 2, TEXTURE_SRGB);
    assert_int_equal(pixels[16], 188); // linear 0.5
    image_build_mips(pixels, 2, 2, TEXTURE_LINEAR);
    assert_int_equal(pixels[16], 128);
}

TEST(asset_images, hidden_colours_do_not_bleed) {
    u8 pixels[4 * 4 + 4] = {255, 0, 0, 0, 0, 255, 0, 255, 255, 0, 0, 0, 0, 255, 0, 255};
    image_build_mips(pixels, 2, 2, TEXTURE_SRGB);
    assert_int_equal(pixels[16], 0);
    assert_int_equal(pixels[17], 255);
}

// A leaf pattern: thin stripes and dots that a plain box filter would thin out or fill in.
TEST(asset_images, cutouts_keep_their_coverage) {
    enum { SIDE = 128 };
    u32 mips = image_mip_count(SIDE, SIDE);
    u8 *pixels = calloc(1, image_mips_size(SIDE, SIDE, mips));
    for (u32 i = 0; i < SIDE * SIDE; i++) {
        u32 x = i % SIDE, y = i / SIDE;
        bool solid = random_u32(SEED, 5, (x / 3) * 100 + y / 2) % 3 == 0;
        memset(pixels + i * 4, solid ? 255 : 0, 4);
    }
    image_build_mips(pixels, SIDE, SIDE, TEXTURE_SRGB);
    f64 coverage[8];
    const u8 *level = pixels;
    for (u32 m = 0, side = SIDE; m < 6; m++, side /= 2) {
        u32 covered = 0;
        for (u32 i = 0; i < side * side; i++) covered += level[i * 4 + 3] >= 128;
        coverage[m] = (f64)covered / (side * side);
        // Halving makes five alphas of two: the nearest threshold among them can be 0.1 away.
        ASSERT_NEAR(coverage[m], coverage[0], m < 4 ? 0.1 : 0.15);
        level += (u64)side * side * 4;
    }
    assert_true(coverage[0] > 0.2 && coverage[0] < 0.5);
    free(pixels);
}
