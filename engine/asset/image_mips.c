// image_mips.c: halving images and building mip chains.
//
// Data in: RGBA8 pixels of level 0. Data out: the levels behind it, each side max(1, side / 2).
// Called by the store and the importer, also from jobs (no shared state but tables made once).
// Does not: decode, or know what a texture is used for beyond its kind.
//
// The filter is an exact box: an odd side of 2n + 1 gives n pixels of three weighted taps, so
// no row is dropped and the mean stays. sRGB is averaged as linear light. Where there is alpha,
// colours are weighted by it (else the hidden colour of a leaf's surroundings bleeds into its
// rim), and in cut-outs alpha is scaled so that each level keeps the coverage of level 0:
// Castano, "Computing Alpha Mipmaps", 2010; here by a histogram instead of a search.
#include "asset_internal.h"
#include <math.h>
#include <pthread.h>
#include <string.h>

#define ENCODE_STEPS 65536
#define CUTOUT_LOW   32  // alpha below is "hole", at 255 - LOW and above "solid"
#define CUTOUT_CUT   128 // the cutoff whose coverage is kept

static f32 decode_table[256];         // sRGB code to linear 0..1
static u16 decode_steps[256];         // the same in 16 bits
static u8 encode_table[ENCODE_STEPS]; // linear in 16 bits to the nearest sRGB code
static pthread_once_t tables_once = PTHREAD_ONCE_INIT;

static void make_tables(void) {
    for (u32 i = 0; i < 256; i++) {
        decode_table[i] = srgb_to_linear((f32)i / 255.0f);
        decode_steps[i] = (u16)(decode_table[i] * (ENCODE_STEPS - 1) + 0.5f);
    }
    // Codes change where the encoded value passes k + 1/2: 255 thresholds instead of 65,536 powers.
    u32 step = 0;
    for (u32 code = 0; code < 256; code++) {
        f32 until = code == 255 ? 2.0f : srgb_to_linear(((f32)code + 0.5f) / 255.0f);
        for (; step < ENCODE_STEPS && (f32)step / (ENCODE_STEPS - 1) < until; step++)
            encode_table[step] = (u8)code;
    }
}

u32 image_mip_count(u32 width, u32 height) {
    u32 side = MAX(width, height), count = 1;
    while (side > 1) side /= 2, count++;
    return count;
}

u64 image_mips_size(u32 width, u32 height, u32 mip_count) {
    u64 size = 0;
    for (u32 i = 0; i < mip_count; i++) {
        size += (u64)width * height * 4;
        width = MAX(width / 2, 1);
        height = MAX(height / 2, 1);
    }
    return size;
}

bool image_has_alpha(const u8 *rgba, u64 pixel_count) {
    for (u64 i = 0; i < pixel_count; i++)
        if (rgba[i * 4 + 3] != 255) return true;
    return false;
}

// Source pixels under one pixel of the next level, with weights that sum to 1.
typedef struct Taps {
    u32 first, count;
    f32 weight[3];
} Taps;

static Taps taps_of(u32 index, u32 side) {
    if (side == 1) return (Taps){0, 1, {1, 0, 0}};
    if (side % 2 == 0) return (Taps){index * 2, 2, {0.5f, 0.5f, 0}};
    f32 n = (f32)(side / 2), i = (f32)index, total = (f32)side;
    return (Taps){index * 2, 3, {(n - i) / total, n / total, (i + 1) / total}};
}

static u8 encode(f32 value, bool srgb) {
    value = f32_saturate(value);
    return srgb ? encode_table[(u32)(value * (ENCODE_STEPS - 1) + 0.5f)]
                : (u8)(value * 255.0f + 0.5f);
}

static void filter_pixel(const u8 *in, u32 width, Taps tx, Taps ty, bool srgb, u8 *out) {
    f32 plain[3] = {0}, weighted[3] = {0}, alpha = 0;
    for (u32 y = 0; y < ty.count; y++)
        for (u32 x = 0; x < tx.count; x++) {
            const u8 *p = in + ((u64)(ty.first + y) * width + tx.first + x) * 4;
            f32 w = ty.weight[y] * tx.weight[x], wa = w * (f32)p[3] * (1.0f / 255.0f);
            for (u32 c = 0; c < 3; c++) {
                f32 value = srgb ? decode_table[p[c]] : (f32)p[c] * (1.0f / 255.0f);
                plain[c] += w * value;
                weighted[c] += wa * value;
            }
            alpha += wa;
        }
    // Weighting by alpha only where there is some: opaque sums stay exactly as they are.
    bool weigh = alpha > 0.0f && alpha < 0.9999f;
    for (u32 c = 0; c < 3; c++) out[c] = encode(weigh ? weighted[c] / alpha : plain[c], srgb);
    out[3] = encode(alpha, false);
}

// Two rows of even width to one, in whole numbers; pixels with some alpha go the general way.
static void halve_rows(const u8 *in, u32 width, bool srgb, u8 *out) {
    const Taps two = {0, 2, {0.5f, 0.5f, 0}};
    for (u32 x = 0; x < width; x += 2, out += 4) {
        const u8 *a = in + (u64)x * 4, *b = a + (u64)width * 4;
        if ((a[3] & a[7] & b[3] & b[7]) != 255) {
            filter_pixel(a, width, two, two, srgb, out);
            continue;
        }
        u8 pixel[4] = {0, 0, 0, 255};
        for (u32 c = 0; c < 3; c++) {
            if (srgb) {
                u32 sum = (u32)decode_steps[a[c]] + decode_steps[a[c + 4]] + decode_steps[b[c]] +
                          decode_steps[b[c + 4]];
                pixel[c] = encode_table[(sum + 2) / 4];
            } else {
                pixel[c] = (u8)(((u32)a[c] + a[c + 4] + b[c] + b[c + 4] + 2) / 4);
            }
        }
        memcpy(out, pixel, 4);
    }
}

// In place works: a pixel is written at or before the first one it was read from, and pixels
// are made in memory order. (A pixel's taps are all read before it is written.)
void image_halve(const u8 *in, u32 width, u32 height, TextureKind kind, u8 *out) {
    pthread_once(&tables_once, make_tables);
    bool srgb = kind == TEXTURE_SRGB, even = width % 2 == 0 && height % 2 == 0;
    u32 out_width = MAX(width / 2, 1), out_height = MAX(height / 2, 1);
    for (u32 y = 0; y < out_height; y++) {
        u8 *row = out + (u64)y * out_width * 4;
        if (even) {
            const u8 *from = in + (u64)y * 2 * width * 4;
            if (srgb)
                halve_rows(from, width, true, row);
            else
                halve_rows(from, width, false, row);
            continue;
        }
        Taps ty = taps_of(y, height);
        for (u32 x = 0; x < out_width; x++)
            filter_pixel(in, width, taps_of(x, width), ty, srgb, row + (u64)x * 4);
    }
}

// ---- coverage of cut-outs ----

static void alpha_histogram(const u8 *pixels, u64 count, u64 histogram[256]) {
    memset(histogram, 0, 256 * sizeof histogram[0]);
    for (u64 i = 0; i < count; i++) histogram[pixels[i * 4 + 3]]++;
}

// A picture whose alpha is nearly everywhere hole or solid, and both occur.
static bool is_cutout(const u64 histogram[256], u64 count, f64 *coverage) {
    u64 low = 0, high = 0, covered = 0;
    for (u32 a = 0; a < 256; a++) {
        if (a < CUTOUT_LOW) low += histogram[a];
        if (a >= 255 - CUTOUT_LOW) high += histogram[a];
        if (a >= CUTOUT_CUT) covered += histogram[a];
    }
    *coverage = (f64)covered / (f64)count;
    return low > 0 && high > 0 && low + high >= count - count / 5;
}

// Scales alpha so that the share of pixels at or over the cut comes as near as it can.
static void keep_coverage(u8 *pixels, u64 count, f64 coverage) {
    u64 histogram[256], above = 0;
    alpha_histogram(pixels, count, histogram);
    u32 threshold = CUTOUT_CUT;
    f64 best = 2.0;
    for (u32 a = 255; a > 0; a--) {
        above += histogram[a];
        f64 miss = fabs((f64)above / (f64)count - coverage);
        if (miss < best) {
            best = miss;
            threshold = a;
        }
    }
    for (u64 i = 0; i < count; i++) {
        u32 alpha = (pixels[i * 4 + 3] * (u32)CUTOUT_CUT + threshold / 2) / threshold;
        pixels[i * 4 + 3] = (u8)MIN(alpha, 255);
    }
}

void image_build_mips(u8 *pixels, u32 width, u32 height, TextureKind kind) {
    u32 mip_count = image_mip_count(width, height);
    u64 histogram[256];
    f64 coverage = 0;
    alpha_histogram(pixels, (u64)width * height, histogram);
    bool cutout = is_cutout(histogram, (u64)width * height, &coverage);
    for (u32 level = 1; level < mip_count; level++) {
        u8 *next = pixels + (u64)width * height * 4;
        image_halve(pixels, width, height, kind, next);
        width = MAX(width / 2, 1);
        height = MAX(height / 2, 1);
        if (cutout) keep_coverage(next, (u64)width * height, coverage);
        pixels = next;
    }
}
