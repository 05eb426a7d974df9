// compare.c: `luz compare`: how different are two pictures?
// Data in: two PNG files (JPEG, TGA, BMP as well), limits. Data out: numbers, a difference picture,
// exit status. Does not: scale pictures to a common size.
#include "../engine/asset/asset.h"
#include "../engine/capture/image_compare.h"
#include "json.h"
#include "tool.h"
#include <math.h>
#include <stdio.h>

#define COMPARE_ARENA_CAP GIB(16)

typedef struct CompareOptions {
    const char *out;
    f64 max, mean, psnr, ssim, flip, gain;
} CompareOptions;

// The first limit that is broken, as a sentence in out; "" if none.
static void judge(const CompareOptions *limits, const ImageDifference *d, char *out, u64 cap) {
    out[0] = 0;
    if ((f64)d->max > limits->max)
        snprintf(out, cap, "maximum difference %u is over %g (first at %u, %u)", d->max,
                 limits->max, d->max_x, d->max_y);
    else if (d->mean > limits->mean)
        snprintf(out, cap, "mean difference %.4f is over %g", d->mean, limits->mean);
    else if (d->psnr < limits->psnr)
        snprintf(out, cap, "PSNR %.2f dB is under %g dB", d->psnr, limits->psnr);
    else if (d->ssim < limits->ssim)
        snprintf(out, cap, "SSIM %.5f is under %g", d->ssim, limits->ssim);
    else if (d->flip > limits->flip)
        snprintf(out, cap, "FLIP %.5f is over %g", d->flip, limits->flip);
}

static void print_result(const ImageDifference *d, const u32 size[2], const char *verdict,
                         const ToolCommon *common) {
    if (common->json) {
        Json json = json_begin();
        json_open_object(&json, NULL);
        json_bool(&json, "ok", !verdict[0]);
        json_text(&json, "verdict", verdict);
        json_u64(&json, "width", size[0]);
        json_u64(&json, "height", size[1]);
        json_u64(&json, "different_pixels", d->different_pixels);
        json_u64(&json, "max", d->max);
        json_f64(&json, "mean", d->mean);
        json_f64(&json, "psnr_db", d->psnr); // null: equal
        json_f64(&json, "ssim", d->ssim);
        json_f64(&json, "flip", d->flip);
        json_close(&json);
        json_print(&json);
        json_free(&json);
        return;
    }
    if (common->quiet) return;
    printf("pixels     %u of %u differ\n", d->different_pixels, size[0] * size[1]);
    printf("max        %u", d->max);
    if (d->max) printf("   at %u, %u", d->max_x, d->max_y);
    printf("\nmean       %.5f\n", d->mean);
    if (isinf(d->psnr))
        printf("PSNR       equal\n");
    else
        printf("PSNR       %.3f dB\n", d->psnr);
    printf("SSIM       %.6f\nFLIP       %.6f\n", d->ssim, d->flip);
}

static int compare_files(const CompareOptions *options, const ToolList *files,
                         const ToolCommon *common, Arena *arena) {
    u8 *pixels[2];
    u32 width[2], height[2];
    for (u32 i = 0; i < 2; i++)
        if (!image_read(files->items[i], arena, &pixels[i], &width[i], &height[i]))
            return tool_fail(TOOL_DIFFERENT, "compare", "'%s' cannot be read as a picture",
                             files->items[i]);
    if (width[0] != width[1] || height[0] != height[1])
        return tool_fail(TOOL_DIFFERENT, "compare", "sizes differ: '%s' is %ux%u, '%s' is %ux%u",
                         files->items[0], width[0], height[0], files->items[1], width[1],
                         height[1]);
    u32 size[2] = {width[0], height[0]};
    ImageDifference difference = image_compare(pixels[0], pixels[1], size[0], size[1], arena);
    char verdict[256];
    judge(options, &difference, verdict, sizeof verdict);
    print_result(&difference, size, verdict, common);
    if (options->out) {
        u8 *picture = arena_push(arena, 4ull * size[0] * size[1], CACHE_LINE);
        f64 gain = options->gain > 0.0 ? options->gain
                   : difference.max    ? 255.0 / difference.max
                                       : 1;
        image_difference_picture(pixels[0], pixels[1], size[0], size[1], (f32)gain, picture);
        if (!image_write_png(options->out, picture, size[0], size[1], 4)) return TOOL_ENVIRONMENT;
    }
    if (!verdict[0]) return TOOL_OK;
    return tool_fail(TOOL_DIFFERENT, "compare", "%s", verdict);
}

static int compare_run(int argc, char **argv) {
    ToolCommon common = {0};
    CompareOptions o = {.max = 0, .mean = 255, .psnr = 0, .ssim = -1, .flip = 1};
    f64 max = -1;
    const ToolOption options[] = {
        {"max", 0, OPTION_F64, &max, "N",
         "largest allowed difference of a channel, 0..255;\ndefault 0, or 255 if another limit is "
         "given"},
        {"mean", 0, OPTION_F64, &o.mean, "X", "largest allowed mean difference, 0..255"},
        {"psnr", 0, OPTION_F64, &o.psnr, "DB", "smallest allowed PSNR"},
        {"ssim", 0, OPTION_F64, &o.ssim, "X", "smallest allowed SSIM, up to 1"},
        {"flip", 0, OPTION_F64, &o.flip, "X", "largest allowed mean FLIP error, 0..1"},
        {"out", 'o', OPTION_TEXT, &o.out, "FILE", "picture of the differences (PNG)"},
        {"gain", 0, OPTION_F64, &o.gain, "X",
         "factor on the differences in it; default: the largest is white"},
    };
    const ToolSpec spec = {
        .command = "compare",
        .synopsis = "A.png B.png [limits]",
        .about = "Compares two pictures of the same size. A is the reference (FLIP asks for one).",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 2,
        .positional_max = 2,
        .examples = "  luz compare golden.png new.png               # equal?\n"
                    "  luz compare golden.png new.png --flip 0.01 -o diff.png\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    bool other_limit = o.mean < 255 || o.psnr > 0 || o.ssim > -1 || o.flip < 1;
    o.max = max >= 0 ? max : other_limit ? 255 : 0;
    tool_begin(&common);
    Arena arena;
    int result = TOOL_ENVIRONMENT;
    if (arena_create(&arena, "compare", COMPARE_ARENA_CAP)) {
        result = compare_files(&o, &positional, &common, &arena);
        arena_destroy(&arena);
    }
    tool_end();
    return result;
}

const ToolCommand tool_compare = {"compare", "compare two pictures", compare_run};
