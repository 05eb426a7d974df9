// capture_image.c: the numbers of image_compare on pictures whose answers are known.
#include "../test.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/image_compare.h"
#include <stdlib.h>
#include <string.h>

#define SIDE  64
#define BYTES (SIDE * SIDE * 4)

static ImageDifference compare(const u8 *a, const u8 *b) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(256)));
    ImageDifference difference = image_compare(a, b, SIDE, SIDE, &arena);
    assert_int_equal(arena.used, 0);
    arena_destroy(&arena);
    return difference;
}

static void fill(u8 *pixels, u8 r, u8 g, u8 b) {
    for (u32 i = 0; i < SIDE * SIDE; i++) {
        pixels[i * 4] = r, pixels[i * 4 + 1] = g, pixels[i * 4 + 2] = b, pixels[i * 4 + 3] = 255;
    }
}

static void noise(u8 *pixels, u32 seed) {
    for (u32 i = 0; i < BYTES; i++) pixels[i] = (u8)random_u32(seed, 0, i);
}

TEST(image_compare, equal_pictures) {
    u8 a[BYTES], b[BYTES];
    noise(a, 1);
    memcpy(b, a, sizeof b);
    for (u32 i = 3; i < BYTES; i += 4) b[i] ^= 0xFF; // alpha does not count
    ImageDifference d = compare(a, b);
    assert_int_equal(d.max, 0);
    assert_int_equal(d.different_pixels, 0);
    assert_true(d.mean == 0.0 && d.ssim == 1.0 && d.flip == 0.0 && isinf(d.psnr));
}

TEST(image_compare, one_pixel) {
    u8 a[BYTES], b[BYTES];
    fill(a, 100, 100, 100);
    fill(b, 100, 100, 100);
    b[(20 * SIDE + 30) * 4 + 1] = 90;
    ImageDifference d = compare(a, b);
    assert_int_equal(d.max, 10);
    assert_int_equal(d.max_x, 30);
    assert_int_equal(d.max_y, 20);
    assert_int_equal(d.different_pixels, 1);
    ASSERT_NEAR(d.mean, 10.0 / (SIDE * SIDE * 3), 1e-12);
    ASSERT_NEAR(d.psnr, 10.0 * log10(255.0 * 255.0 * SIDE * SIDE * 3 / 100.0), 1e-9);
    assert_true(d.ssim < 1.0 && d.ssim > 0.9);
    assert_true(d.flip > 0.0 && d.flip < 0.01);
}

TEST(image_compare, constant_offset) {
    u8 a[BYTES], b[BYTES];
    fill(a, 100, 100, 100);
    fill(b, 104, 104, 104);
    ImageDifference d = compare(a, b);
    assert_int_equal(d.max, 4);
    ASSERT_NEAR(d.mean, 4.0, 1e-12);
    ASSERT_NEAR(d.psnr, 20.0 * log10(255.0 / 4.0), 1e-9);
    // Constant pictures: only the luminance term is left, (2ab + C1) / (a^2 + b^2 + C1).
    ASSERT_NEAR(d.ssim, (2 * 100.0 * 104 + 6.5025) / (100.0 * 100 + 104.0 * 104 + 6.5025), 1e-4);
}

TEST(image_compare, noise_is_unlike) {
    u8 a[BYTES], b[BYTES];
    noise(a, 1);
    noise(b, 2);
    ImageDifference d = compare(a, b);
    ASSERT_NEAR(d.mean, 85.0, 2.0); // of two uniform variables: 255 / 3
    ASSERT_NEAR(d.ssim, 0.0, 0.05);
    assert_true(d.flip > 0.1);
}

// LDR-FLIP of constant pictures is the redistributed colour error alone; black against white is 1
// within what the filters keep.
TEST(image_compare, flip_of_constants) {
    static u8 a[BYTES], b[BYTES];
    static f32 errors[SIDE * SIDE];
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(256)));
    fill(a, 0, 0, 0);
    fill(b, 255, 255, 255);
    ASSERT_NEAR(image_flip(a, b, SIDE, SIDE, 0, errors, &arena), 0.9657, 0.02);
    // The largest error there is: green against blue.
    fill(a, 0, 255, 0);
    fill(b, 0, 0, 255);
    ASSERT_NEAR(image_flip(a, b, SIDE, SIDE, 0, errors, &arena), 1.0, 0.001);
    // The same error whichever is the reference, everywhere the same.
    f64 forth = image_flip(b, a, SIDE, SIDE, 0, errors, &arena);
    ASSERT_NEAR(forth, 1.0, 0.001);
    for (u32 i = 1; i < SIDE * SIDE; i++) ASSERT_NEAR((f64)errors[i], (f64)errors[0], 1e-4);
    // A step that nobody sees stays near zero, and grows with the step.
    f64 last = 0.0;
    for (u32 step = 1; step < 100; step += 20) {
        fill(a, 128, 128, 128);
        fill(b, (u8)(128 + step), (u8)(128 + step), (u8)(128 + step));
        f64 error = image_flip(a, b, SIDE, SIDE, 0, errors, &arena);
        assert_true(error > last);
        last = error;
    }
    arena_destroy(&arena);
}

TEST(image_compare, difference_picture) {
    u8 a[BYTES], b[BYTES], out[BYTES];
    fill(a, 10, 10, 10);
    fill(b, 10, 10, 10);
    b[0] = 95;      // a third of white: full red
    b[4 + 2] = 255; // times the gain over white
    image_difference_picture(a, b, SIDE, SIDE, 1.0f, out);
    const u8 red[4] = {255, 0, 0, 255}, black[4] = {0, 0, 0, 255};
    assert_memory_equal(out, red, 4);
    assert_memory_equal(out + 8, black, 4);
    image_difference_picture(a, b, SIDE, SIDE, 10.0f, out);
    const u8 white[4] = {255, 255, 255, 255};
    assert_memory_equal(out + 4, white, 4);
}

TEST(image_compare, reduce) {
    u8 a[BYTES], small[4 * 4 * 3];
    fill(a, 7, 80, 255);
    image_reduce(a, SIDE, SIDE, small, 4, 4);
    for (u32 i = 0; i < 16; i++) {
        assert_int_equal(small[i * 3], 7);
        assert_int_equal(small[i * 3 + 1], 80);
        assert_int_equal(small[i * 3 + 2], 255);
    }
    // Larger than the picture, and odd sizes.
    u8 large[SIDE * 3 * 2 * 3];
    image_reduce(a, 3, 1, large, SIDE, 3);
    assert_int_equal(large[(2 * SIDE + 63) * 3 + 1], 80);
}
