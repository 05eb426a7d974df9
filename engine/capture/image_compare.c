// image_compare.c: mean, maximum, PSNR and SSIM of two pictures; difference pictures; thumbnails.
// Data in: two RGBA8 pictures of the same size. Data out: an ImageDifference, or a picture.
// Called by: tools (compare, replay), tests of golden images, recordings (thumbnails).
// Does not: read files, judge; limits are the caller's. FLIP: image_flip.c.
#include "image_compare.h"
#include <math.h>
#include <string.h>

#define SSIM_RADIUS 5
#define SSIM_SIGMA  1.5
// Wang et al. 2004: C1 = (0.01 L)^2, C2 = (0.03 L)^2 with L = 255.
#define SSIM_C1 6.5025
#define SSIM_C2 58.5225

static void compare_channels(const u8 *a, const u8 *b, u32 width, u32 height,
                             ImageDifference *out) {
    u64 sum = 0, square_sum = 0;
    for (u32 y = 0; y < height; y++)
        for (u32 x = 0; x < width; x++) {
            u64 at = ((u64)y * width + x) * 4;
            u32 pixel_max = 0;
            for (u32 c = 0; c < 3; c++) {
                i32 signed_difference = (i32)a[at + c] - (i32)b[at + c];
                u32 difference =
                    (u32)(signed_difference < 0 ? -signed_difference : signed_difference);
                sum += difference;
                square_sum += (u64)difference * difference;
                pixel_max = MAX(pixel_max, difference);
            }
            out->different_pixels += pixel_max > 0;
            if (pixel_max > out->max) out->max = pixel_max, out->max_x = x, out->max_y = y;
        }
    f64 value_count = 3.0 * width * height;
    out->mean = (f64)sum / value_count;
    f64 mean_square = (f64)square_sum / value_count;
    out->psnr = square_sum ? 10.0 * log10(255.0 * 255.0 / mean_square) : INFINITY;
}

// Rec. 601 luma of the encoded values, as the SSIM of the paper's authors takes it.
static void luma(const u8 *rgba, u64 count, f32 *out) {
    for (u64 i = 0; i < count; i++)
        out[i] = 0.299f * rgba[i * 4] + 0.587f * rgba[i * 4 + 1] + 0.114f * rgba[i * 4 + 2];
}

// Separable Gaussian with the window cut (and renormalised) at the rims; tmp has the same size.
static void blur(const f32 *in, u32 width, u32 height, const f64 *weights, f32 *tmp, f32 *out) {
    for (u32 pass = 0; pass < 2; pass++) {
        const f32 *from = pass ? tmp : in;
        f32 *to = pass ? out : tmp;
        i32 length = (i32)(pass ? height : width);
        u64 stride = pass ? width : 1;
        for (u32 y = 0; y < height; y++)
            for (u32 x = 0; x < width; x++) {
                u64 center = (u64)y * width + x;
                i32 at = (i32)(pass ? y : x);
                f64 sum = 0.0, weight = 0.0;
                for (i32 k = -SSIM_RADIUS; k <= SSIM_RADIUS; k++) {
                    if (at + k < 0 || at + k >= length) continue;
                    f64 w = weights[k + SSIM_RADIUS];
                    sum += w * (f64)from[(i64)center + (i64)k * (i64)stride];
                    weight += w;
                }
                to[center] = (f32)(sum / weight);
            }
    }
}

static f64 compare_structure(const u8 *a, const u8 *b, u32 width, u32 height, Arena *scratch) {
    u64 mark = arena_mark(scratch), count = (u64)width * height;
    f32 *la = ARENA_PUSH_COLUMN(scratch, f32, count), *lb = ARENA_PUSH_COLUMN(scratch, f32, count);
    f32 *product = ARENA_PUSH_COLUMN(scratch, f32, count);
    f32 *tmp = ARENA_PUSH_COLUMN(scratch, f32, count);
    f32 *blurred[5]; // a, b, aa, bb, ab
    for (u32 i = 0; i < 5; i++) blurred[i] = ARENA_PUSH_COLUMN(scratch, f32, count);
    f64 weights[2 * SSIM_RADIUS + 1];
    for (i32 k = -SSIM_RADIUS; k <= SSIM_RADIUS; k++)
        weights[k + SSIM_RADIUS] = exp(-0.5 * k * k / (SSIM_SIGMA * SSIM_SIGMA));
    luma(a, count, la);
    luma(b, count, lb);
    blur(la, width, height, weights, tmp, blurred[0]);
    blur(lb, width, height, weights, tmp, blurred[1]);
    const f32 *factors[3][2] = {{la, la}, {lb, lb}, {la, lb}};
    for (u32 i = 0; i < 3; i++) {
        for (u64 p = 0; p < count; p++) product[p] = factors[i][0][p] * factors[i][1][p];
        blur(product, width, height, weights, tmp, blurred[2 + i]);
    }
    f64 sum = 0.0;
    for (u64 p = 0; p < count; p++) {
        f64 ma = (f64)blurred[0][p], mb = (f64)blurred[1][p];
        f64 va = (f64)blurred[2][p] - ma * ma, vb = (f64)blurred[3][p] - mb * mb;
        f64 cov = (f64)blurred[4][p] - ma * mb;
        sum += (2 * ma * mb + SSIM_C1) * (2 * cov + SSIM_C2) /
               ((ma * ma + mb * mb + SSIM_C1) * (va + vb + SSIM_C2));
    }
    arena_rewind(scratch, mark);
    return sum / (f64)count;
}

ImageDifference image_compare(const u8 *a, const u8 *b, u32 width, u32 height, Arena *scratch) {
    ImageDifference out = {.psnr = INFINITY, .ssim = 1.0};
    if (width == 0 || height == 0) return out;
    compare_channels(a, b, width, height, &out);
    // Equal pictures are the common case, and the rest is slow.
    if (out.max == 0) return out;
    out.ssim = compare_structure(a, b, width, height, scratch);
    u64 mark = arena_mark(scratch);
    f32 *errors = ARENA_PUSH_COLUMN(scratch, f32, (u64)width * height);
    out.flip = image_flip(a, b, width, height, 0.0f, errors, scratch);
    arena_rewind(scratch, mark);
    return out;
}

void image_difference_picture(const u8 *a, const u8 *b, u32 width, u32 height, f32 gain, u8 *out) {
    for (u64 p = 0; p < (u64)width * height; p++) {
        i32 largest = 0;
        for (u32 c = 0; c < 3; c++) {
            i32 difference = (i32)a[p * 4 + c] - (i32)b[p * 4 + c];
            largest = MAX(largest, difference < 0 ? -difference : difference);
        }
        // Three ramps after each other: red, then green, then blue.
        f32 heat = MIN((f32)largest * gain / 255.0f, 1.0f) * 3.0f;
        for (u32 c = 0; c < 3; c++) {
            f32 channel = CLAMP(heat - (f32)c, 0.0f, 1.0f);
            out[p * 4 + c] = (u8)(channel * 255.0f + 0.5f);
        }
        out[p * 4 + 3] = 255;
    }
}

void image_reduce(const u8 *rgba, u32 width, u32 height, u8 *rgb, u32 out_width, u32 out_height) {
    for (u32 y = 0; y < out_height; y++)
        for (u32 x = 0; x < out_width; x++) {
            u32 x0 = (u32)((u64)x * width / out_width), y0 = (u32)((u64)y * height / out_height);
            u32 x1 = (u32)((u64)(x + 1) * width / out_width);
            u32 y1 = (u32)((u64)(y + 1) * height / out_height);
            // Enlarging: the box is at least one pixel.
            x1 = MAX(x1, x0 + 1), y1 = MAX(y1, y0 + 1);
            u64 sum[3] = {0};
            for (u32 sy = y0; sy < y1; sy++)
                for (u32 sx = x0; sx < x1; sx++)
                    for (u32 c = 0; c < 3; c++) sum[c] += rgba[((u64)sy * width + sx) * 4 + c];
            u64 count = (u64)(x1 - x0) * (y1 - y0);
            u8 *pixel = rgb + ((u64)y * out_width + x) * 3;
            for (u32 c = 0; c < 3; c++) pixel[c] = (u8)((sum[c] + count / 2) / count);
        }
}
