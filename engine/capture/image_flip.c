// image_flip.c: LDR-FLIP, the difference that a person sees when two pictures alternate.
// Data in: reference and test, RGBA8 sRGB. Data out: an error in 0..1 for every pixel, and the
// mean. Called by: image_compare. Does not: HDR-FLIP, colour maps.
//
// Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: "FLIP: A Difference Evaluator
// for Alternating Images", HPG 2020. Colours are filtered by the eye's contrast sensitivity
// (section 4.1.1), compared by the HyAB distance in Hunt-adjusted CIELAB (4.1.2, 4.1.3), and the
// colour error is raised where edges or points differ (4.2, 4.3).
#include "../base/maths.h"
#include "image_compare.h"
#include <math.h>

#define FLIP_PPD   67.0206f
#define FLIP_QC    0.7f
#define FLIP_PC    0.4f
#define FLIP_PT    0.95f
#define FLIP_QF    0.5f
#define FLIP_WIDTH 0.082f // degrees, of the feature detectors
#define RADIUS_CAP 256
// D65, XYZ of linear RGB (1, 1, 1).
#define WHITE_X 0.950428545f
#define WHITE_Y 1.0f
#define WHITE_Z 1.088900371f

typedef struct Planes {
    f32 *channel[3];
} Planes;

// --- colour spaces ---

static Vec3 linear_to_xyz(Vec3 c) {
    return vec3(0.41238656f * c.x + 0.35759149f * c.y + 0.18045049f * c.z,
                0.21263682f * c.x + 0.71518298f * c.y + 0.0721802f * c.z,
                0.01933062f * c.x + 0.11919716f * c.y + 0.95037259f * c.z);
}

static Vec3 xyz_to_linear(Vec3 c) {
    return vec3(3.241003275f * c.x - 1.537398934f * c.y - 0.498615861f * c.z,
                -0.969224334f * c.x + 1.875930071f * c.y + 0.041554224f * c.z,
                0.055639423f * c.x - 0.204011202f * c.y + 1.057148933f * c.z);
}

static Vec3 linear_to_ycxcz(Vec3 linear) {
    Vec3 xyz = linear_to_xyz(linear);
    f32 x = xyz.x / WHITE_X, y = xyz.y / WHITE_Y, z = xyz.z / WHITE_Z;
    return vec3(116.0f * y - 16.0f, 500.0f * (x - y), 200.0f * (y - z));
}

static Vec3 ycxcz_to_linear(Vec3 c) {
    f32 y = (c.x + 16.0f) / 116.0f;
    f32 x = c.y / 500.0f + y, z = y - c.z / 200.0f;
    return xyz_to_linear(vec3(x * WHITE_X, y * WHITE_Y, z * WHITE_Z));
}

static f32 lab_curve(f32 t) {
    const f32 delta = 6.0f / 29.0f;
    return t > delta * delta * delta ? cbrtf(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

// CIELAB with the Hunt effect: chroma counts less in the dark (equation 6).
static Vec3 linear_to_hunt(Vec3 linear) {
    Vec3 xyz = linear_to_xyz(linear);
    f32 fx = lab_curve(xyz.x / WHITE_X), fy = lab_curve(xyz.y / WHITE_Y);
    f32 fz = lab_curve(xyz.z / WHITE_Z);
    f32 lightness = 116.0f * fy - 16.0f;
    return vec3(lightness, 0.01f * lightness * 500.0f * (fx - fy),
                0.01f * lightness * 200.0f * (fy - fz));
}

static f32 hyab(Vec3 a, Vec3 b) {
    f32 da = a.y - b.y, db = a.z - b.z;
    return fabsf(a.x - b.x) + sqrtf(da * da + db * db);
}

// --- filters ---

// in filtered by kernel_x along rows, then kernel_y along columns; clamped at the rims.
static void convolve(const f32 *in, u32 width, u32 height, const f32 *kernel_x, const f32 *kernel_y,
                     i32 radius, f32 *tmp, f32 *out) {
    for (u32 y = 0; y < height; y++)
        for (u32 x = 0; x < width; x++) {
            f32 sum = 0.0f;
            for (i32 k = -radius; k <= radius; k++) {
                i32 sx = CLAMP((i32)x + k, 0, (i32)width - 1);
                sum += kernel_x[k + radius] * in[(u64)y * width + (u32)sx];
            }
            tmp[(u64)y * width + x] = sum;
        }
    for (u32 y = 0; y < height; y++)
        for (u32 x = 0; x < width; x++) {
            f32 sum = 0.0f;
            for (i32 k = -radius; k <= radius; k++) {
                i32 sy = CLAMP((i32)y + k, 0, (i32)height - 1);
                sum += kernel_y[k + radius] * tmp[(u64)(u32)sy * width + x];
            }
            out[(u64)y * width + x] = sum;
        }
}

// Contrast sensitivity as a sum of two Gaussians (table 1): amplitude a, width b.
static const f32 csf[3][2][2] = {
    {{1.0f, 0.0047f}, {0.0f, 1e-5f}},  // achromatic
    {{1.0f, 0.0053f}, {0.0f, 1e-5f}},  // red-green
    {{34.1f, 0.04f}, {13.5f, 0.025f}}, // blue-yellow
};

// Each channel by its own sensitivity; the two Gaussians are separable one by one.
static void filter_csf(const Planes *in, u32 width, u32 height, f32 ppd, f32 *tmp, f32 *part,
                       Planes *out) {
    const f32 pi2 = PI_F * PI_F;
    i32 radius = (i32)ceilf(3.0f * sqrtf(0.04f / (2.0f * pi2)) * ppd);
    radius = MIN(radius, RADIUS_CAP);
    u64 count = (u64)width * height;
    for (u32 c = 0; c < 3; c++) {
        f32 kernels[2][2 * RADIUS_CAP + 1], weights[2], total = 0.0f;
        for (u32 g = 0; g < 2; g++) {
            f32 a = csf[c][g][0], b = csf[c][g][1], sum = 0.0f;
            for (i32 k = -radius; k <= radius; k++) {
                f32 x = (f32)k / ppd;
                sum += kernels[g][k + radius] = expf(-pi2 * x * x / b);
            }
            weights[g] = a * sqrtf(PI_F / b);
            total += weights[g] * sum * sum;
        }
        for (u64 i = 0; i < count; i++) out->channel[c][i] = 0.0f;
        for (u32 g = 0; g < 2; g++) {
            if (weights[g] == 0.0f) continue;
            convolve(in->channel[c], width, height, kernels[g], kernels[g], radius, tmp, part);
            f32 scale = weights[g] / total;
            for (u64 i = 0; i < count; i++) out->channel[c][i] += scale * part[i];
        }
    }
}

// Positive weights of a detector sum to 1, negative ones to -1.
static void normalise_signed(f32 *kernel, i32 radius) {
    f32 positive = 0.0f, negative = 0.0f;
    for (i32 k = 0; k <= 2 * radius; k++) *(kernel[k] > 0.0f ? &positive : &negative) += kernel[k];
    for (i32 k = 0; k <= 2 * radius; k++)
        kernel[k] /= kernel[k] > 0.0f ? positive : negative < 0.0f ? -negative : 1.0f;
}

// Strength of edges (order 1) or points (order 2) of the luminance at every pixel.
static void filter_features(const f32 *luminance, u32 width, u32 height, f32 ppd, u32 order,
                            f32 *tmp, f32 *part, f32 *out) {
    f32 sigma = 0.5f * FLIP_WIDTH * ppd;
    i32 radius = MIN((i32)ceilf(3.0f * sigma), RADIUS_CAP);
    f32 along[2 * RADIUS_CAP + 1], across[2 * RADIUS_CAP + 1], sum = 0.0f;
    for (i32 k = -radius; k <= radius; k++) {
        f32 x = (f32)k, g = expf(-x * x / (2.0f * sigma * sigma));
        sum += across[k + radius] = g;
        along[k + radius] = order == 1 ? -x * g : (x * x / (sigma * sigma) - 1.0f) * g;
    }
    for (i32 k = 0; k <= 2 * radius; k++) across[k] /= sum;
    normalise_signed(along, radius);
    u64 count = (u64)width * height;
    convolve(luminance, width, height, along, across, radius, tmp, out);
    convolve(luminance, width, height, across, along, radius, tmp, part);
    for (u64 i = 0; i < count; i++) out[i] = sqrtf(out[i] * out[i] + part[i] * part[i]);
}

// --- the whole ---

static void to_planes(const u8 *rgba, u64 count, Planes *out) {
    f32 linear[256];
    for (u32 i = 0; i < 256; i++) linear[i] = srgb_to_linear((f32)i / 255.0f);
    for (u64 i = 0; i < count; i++) {
        const u8 *pixel = rgba + i * 4;
        Vec3 c = linear_to_ycxcz(vec3(linear[pixel[0]], linear[pixel[1]], linear[pixel[2]]));
        out->channel[0][i] = c.x, out->channel[1][i] = c.y, out->channel[2][i] = c.z;
    }
}

static Vec3 filtered_hunt(const Planes *planes, u64 i) {
    Vec3 c =
        ycxcz_to_linear(vec3(planes->channel[0][i], planes->channel[1][i], planes->channel[2][i]));
    return linear_to_hunt(vec3(f32_saturate(c.x), f32_saturate(c.y), f32_saturate(c.z)));
}

// Colour errors are compressed so that large ones do not drown the rest (equation 9).
static f32 redistribute(f32 error, f32 error_max) {
    f32 p = powf(error, FLIP_QC), knee = FLIP_PC * error_max;
    if (p < knee) return FLIP_PT / knee * p;
    return FLIP_PT + (p - knee) / (error_max - knee) * (1.0f - FLIP_PT);
}

f64 image_flip(const u8 *reference, const u8 *test, u32 width, u32 height, f32 pixels_per_degree,
               f32 *out, Arena *scratch) {
    u64 mark = arena_mark(scratch), count = (u64)width * height;
    if (count == 0) return 0.0;
    f32 ppd = pixels_per_degree > 0.0f ? pixels_per_degree : FLIP_PPD;
    Planes planes, filtered[2];
    f32 *edges[2], *points[2];
    for (u32 c = 0; c < 3; c++) {
        planes.channel[c] = ARENA_PUSH_COLUMN(scratch, f32, count);
        for (u32 i = 0; i < 2; i++) filtered[i].channel[c] = ARENA_PUSH_COLUMN(scratch, f32, count);
    }
    for (u32 i = 0; i < 2; i++) {
        edges[i] = ARENA_PUSH_COLUMN(scratch, f32, count);
        points[i] = ARENA_PUSH_COLUMN(scratch, f32, count);
    }
    f32 *tmp = ARENA_PUSH_COLUMN(scratch, f32, count),
        *part = ARENA_PUSH_COLUMN(scratch, f32, count);
    const u8 *images[2] = {reference, test};
    for (u32 i = 0; i < 2; i++) {
        to_planes(images[i], count, &planes);
        filter_csf(&planes, width, height, ppd, tmp, part, &filtered[i]);
        f32 *luminance = planes.channel[0];
        for (u64 p = 0; p < count; p++) luminance[p] = (luminance[p] + 16.0f) / 116.0f;
        filter_features(luminance, width, height, ppd, 1, tmp, part, edges[i]);
        filter_features(luminance, width, height, ppd, 2, tmp, part, points[i]);
    }
    f32 error_max =
        powf(hyab(linear_to_hunt(vec3(0, 1, 0)), linear_to_hunt(vec3(0, 0, 1))), FLIP_QC);
    f64 sum = 0.0;
    for (u64 p = 0; p < count; p++) {
        f32 color = redistribute(
            hyab(filtered_hunt(&filtered[0], p), filtered_hunt(&filtered[1], p)), error_max);
        f32 feature = MAX(fabsf(edges[0][p] - edges[1][p]), fabsf(points[0][p] - points[1][p]));
        feature = powf(feature * 0.70710678f, FLIP_QF);
        out[p] = powf(color, 1.0f - f32_saturate(feature));
        sum += (f64)out[p];
    }
    arena_rewind(scratch, mark);
    return sum / (f64)count;
}
