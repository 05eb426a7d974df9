// gi_screen.c: indirect light on the screen: the same in every path and layout, also with several
// samples a pixel; what fewer traced pixels cost; and that nothing changes without it.
// Data in: levels, settings. Data out: pictures compared. Called by: the runner.
#include "studio.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <string.h>

enum { WIDTH = 128, HEIGHT = 72 };
#define GI "gi.enabled=on,gi.grid=32"

static RenderImage draw(Studio *studio, const char *list, u32 width, u32 height) {
    RenderSettings settings = settings_default();
    if (!settings_set_list(&settings, list)) fail_msg("settings: %s", list);
    return studio_draw(studio, NULL, &settings, width, height);
}

static ImageDifference difference(Studio *studio, RenderImage a, RenderImage b) {
    return image_compare(a.rgba, b.rgba, a.width_px, a.height_px, &studio->images);
}

// A fifth of the colour channels, at least, is another by more than 4.
static bool is_other_picture(RenderImage a, RenderImage b) {
    u32 changed = 0, count = a.width_px * a.height_px * 4;
    for (u32 i = 0; i < count; i++)
        changed += a.rgba[i] > b.rgba[i] + 4 || b.rgba[i] > a.rgba[i] + 4;
    return changed > count / 20;
}

// --- Every path ---

static const char *const ways[] = {
    "deferred",
    "deferred_volumes",
    "deferred_volumes,light_volume=stencil",
    "tiled_deferred",
    "clustered_deferred",
    "clustered_deferred,clusters=gpu",
    "forward",
    "multipass",
    "tiled_forward",
    "tiled_forward,tile_depth=mask",
    "clustered_forward",
    "clustered_forward,clusters=gpu",
    // Nobody asks for a layout there: what GI draws for itself is lean.
    "tiled_forward,layout=killzone2",
};

// shadow: ScreenShadow of all lights.
static void check_ways(const char *level, u32 ticks, u32 shadow, u32 width, u32 height,
                       const char *more) {
    Studio studio;
    studio_open(&studio, level);
    LightTable *light = WORLD_TABLE(studio.session.world, Light, light);
    for (u32 row = 0; row < light->table.count && shadow != SCREEN_SHADOW_MAP; row++) {
        light->screen_shadow[row] = shadow;
        table_touch(&light->table, row);
    }
    session_advance(&studio.session, ticks);
    RenderImage reference = {0};
    for (u32 i = 0; i < COUNT_OF(ways); i++) {
        char list[256];
        snprintf(list, sizeof list, "%s,%s%s", ways[i], GI, more);
        RenderImage image = draw(&studio, list, width, height);
        if (i == 0) {
            reference = image;
            RenderImage without = draw(&studio, "deferred,gi.enabled=off", width, height);
            if (!is_other_picture(image, without)) fail_msg("%s: GI changes nothing", level);
        }
        if (i == 0 && shadow != SCREEN_SHADOW_MAP) {
            char plain[256];
            snprintf(plain, sizeof plain, "%s,gi.cone_shadows=off", list);
            RenderImage lit = draw(&studio, plain, width, height);
            u64 sums[2] = {0};
            for (u32 k = 0; k < width * height * 4; k++)
                sums[0] += image.rgba[k], sums[1] += lit.rgba[k];
            if (sums[0] >= sums[1]) fail_msg("%s: traced shadows do not darken", level);
        }
        ImageDifference d = difference(&studio, reference, image);
        if (d.max > 2) fail_msg("%s, %s: max %u at %u,%u", level, list, d.max, d.max_x, d.max_y);
    }
    studio_close(&studio);
}

TEST_GPU(golden, gi_paths_agree) {
    check_ways("data/levels/cornell.toml", 30, SCREEN_SHADOW_MAP, WIDTH, HEIGHT, "");
}
TEST_GPU(golden, gi_paths_agree_at_half_resolution) {
    check_ways("data/levels/cornell.toml", 30, SCREEN_SHADOW_MAP, 67, 41, ",gi.resolution=half");
}
TEST_GPU(golden, gi_paths_agree_in_the_cloister) {
    check_ways("data/levels/cloister.toml", 90, SCREEN_SHADOW_MAP, 80, 45,
               ",gi.resolution=quarter");
}
TEST_GPU(golden, gi_paths_agree_on_traced_shadows) {
    check_ways("data/levels/cornell.toml", 30, SCREEN_SHADOW_CONE, 80, 45, ",gi.resolution=half");
    check_ways("data/levels/light_box.toml", 30, SCREEN_SHADOW_VOLUME, 80, 45,
               ",gi.resolution=half");
}

// --- Blended surfaces, which no G-buffer shows ---

// Mean of a picture's part, columns and rows in hundredths.
static f64 mean_of(RenderImage image, u32 left, u32 right, u32 top, u32 bottom) {
    f64 sum = 0.0;
    u32 count = 0;
    for (u32 y = image.height_px * top / 100; y < image.height_px * bottom / 100; y++)
        for (u32 x = image.width_px * left / 100; x < image.width_px * right / 100; x++)
            for (u32 k = 0; k < 3; k++, count++)
                sum += image.rgba[4 * (y * image.width_px + x) + k];
    return sum / count;
}

// The left wall becomes a blended surface that nothing shines through: it still gets the light
// whose shadow is traced, and what bounces.
TEST_GPU(golden, gi_lights_blended_surfaces) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    LightTable *light = WORLD_TABLE(studio.session.world, Light, light);
    for (u32 row = 0; row < light->table.count; row++) {
        light->screen_shadow[row] = SCREEN_SHADOW_CONE;
        table_touch(&light->table, row);
    }
    session_advance(&studio.session, 2);
    static const char *const lists[] = {"gi.diffuse=none", "gi.diffuse=cones",
                                        "gi.diffuse=cones,gi.cascades=2,gi.faces=apart",
                                        "gi.diffuse=probes", "gi.diffuse=voxels"};
    MaterialTable *materials = WORLD_TABLE(studio.session.world, Material, material);
    f64 means[COUNT_OF(lists)][2];
    for (u32 turn = 0; turn < 2; turn++) {
        for (u32 i = 0; i < COUNT_OF(lists); i++) {
            char list[256];
            snprintf(list, sizeof list, "clustered_deferred,gi.ao=off,%s,%s", GI, lists[i]);
            RenderImage image = draw(&studio, list, WIDTH, HEIGHT);
            RenderImage forward =
                draw(&studio, strchr(list, ',') + 1, WIDTH, HEIGHT); // the default path
            if (difference(&studio, image, forward).max > 2) fail_msg("%s differs by path", list);
            means[i][turn] = mean_of(image, 24, 32, 30, 80);
        }
        for (u32 row = 0; row < materials->table.count; row++) {
            if (materials->albedo_r[row] < 4.0f * materials->albedo_g[row]) continue;
            materials->alpha_mode[row] = ALPHA_BLEND; // the red wall alone
            table_touch(&materials->table, row);
        }
    }
    for (u32 i = 0; i < COUNT_OF(lists); i++) {
        printf("%s: opaque %.1f, blended %.1f\n", lists[i], means[i][0], means[i][1]);
        if (means[i][1] < 0.8 * means[i][0] || means[i][1] > 1.25 * means[i][0])
            fail_msg("%s: a blended wall is lit otherwise", lists[i]);
    }
    // Without the light that bounces there is less.
    assert_true(means[1][1] > 1.02 * means[0][1]);
    studio_close(&studio);
}

// --- Every layout: those that lose nothing agree, the others stay near ---

TEST_GPU(golden, gi_layouts_stay_near) {
    static const struct {
        const char *name;
        u32 max;
        f64 mean; // of 255
    } layouts[] = {{"wide", 3, 0.1},  {"packed", 24, 1.0},    {"packed24", 24, 1.0},
                   {"half5", 4, 0.2}, {"killzone2", 40, 2.0}, {"starcraft2", 8, 0.6},
                   {"il", 16, 0.6}};
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    session_advance(&studio.session, 30);
    RenderImage lean = draw(&studio, "clustered_deferred,layout=lean," GI, WIDTH, HEIGHT);
    for (u32 i = 0; i < COUNT_OF(layouts); i++) {
        char list[256];
        snprintf(list, sizeof list, "clustered_deferred,layout=%s,%s", layouts[i].name, GI);
        ImageDifference d = difference(&studio, lean, draw(&studio, list, WIDTH, HEIGHT));
        printf("layout %s: max %u, mean %.3f, SSIM %.4f\n", layouts[i].name, d.max, d.mean, d.ssim);
        if (d.max > layouts[i].max || d.mean > layouts[i].mean)
            fail_msg("layout %s: max %u at %u,%u, mean %g", layouts[i].name, d.max, d.max_x,
                     d.max_y, d.mean);
    }
    studio_close(&studio);
}

// --- Samples ---

// Four samples: the same inside of surfaces; where surfaces end, no pixel leaves the range that its
// neighbours have without samples (no halos of unlit samples).
TEST_GPU(golden, gi_with_samples) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    session_advance(&studio.session, 30);
    static const char *const paths[] = {"forward", "tiled_forward", "clustered_forward"};
    // One sample: a square of pixels at a time. Four: pixel by pixel.
    static const char *const resolutions[] = {"full", "half", "quarter"};
    for (u32 p = 0; p < COUNT_OF(paths); p++)
        for (u32 r = 0; r < COUNT_OF(resolutions); r++) {
            char one[128], four[160];
            snprintf(one, sizeof one, "%s,%s,gi.resolution=%s", paths[p], GI, resolutions[r]);
            snprintf(four, sizeof four, "%s,msaa=4", one);
            RenderImage a = draw(&studio, one, WIDTH, HEIGHT);
            RenderImage b = draw(&studio, four, WIDTH, HEIGHT);
            u32 outside = 0, inside = 0;
            for (u32 y = 1; y + 1 < HEIGHT; y++)
                for (u32 x = 1; x + 1 < WIDTH; x++) {
                    u32 most = 0, contrast = 0;
                    for (u32 c = 0; c < 3; c++) {
                        i32 low = 255, high = 0, value = b.rgba[(y * WIDTH + x) * 4 + c];
                        for (u32 k = 0; k < 9; k++) {
                            i32 near = a.rgba[((y + k / 3 - 1) * WIDTH + x + k % 3 - 1) * 4 + c];
                            low = MIN(low, near), high = MAX(high, near);
                        }
                        i32 beyond = value < low ? low - value : value > high ? value - high : 0;
                        most = MAX(most, (u32)beyond);
                        contrast = MAX(contrast, (u32)(high - low));
                    }
                    outside += most > 6;
                    inside += most > 4 && contrast < 8;
                }
            printf("%s: %u pixels beyond their neighbours, %u of them inside\n", four, outside,
                   inside);
            if (outside > WIDTH * HEIGHT / 500 || inside > 0)
                fail_msg("%s: %u pixels beyond their neighbours, %u inside", four, outside, inside);
        }
    studio_close(&studio);
}

// --- Fewer traced pixels ---

static void check_resolutions(const char *level, u32 ticks, f64 half_ssim, f64 quarter_ssim) {
    Studio studio;
    studio_open(&studio, level);
    session_advance(&studio.session, ticks);
    RenderImage full = draw(&studio, "tiled_deferred," GI ",gi.resolution=full", 192, 108);
    static const char *const words[] = {"half", "quarter"};
    const f64 least[] = {half_ssim, quarter_ssim};
    for (u32 i = 0; i < 2; i++)
        for (u32 dither = 0; dither < 2; dither++) {
            char list[160];
            snprintf(list, sizeof list, "tiled_deferred,%s,gi.resolution=%s,gi.dither=%s", GI,
                     words[i], dither ? "on" : "off");
            RenderImage image = draw(&studio, list, 192, 108);
            ImageDifference d = difference(&studio, full, image);
            printf("%s: %s%s: SSIM %.4f, mean %.3f, max %u\n", level, words[i],
                   dither ? ", dithered" : "", d.ssim, d.mean, d.max);
            // What is dithered is compared with what is not.
            f64 bound = dither ? least[i] - 0.025 : least[i];
            if (d.ssim < bound)
                fail_msg("%s: %s: SSIM %.4f, should be %.4f", level, words[i], d.ssim, bound);
        }
    studio_close(&studio);
}
TEST_GPU(golden, gi_resolutions) { check_resolutions("data/levels/cornell.toml", 30, 0.998, 0.99); }
TEST_GPU(golden, gi_resolutions_in_the_cloister) {
    check_resolutions("data/levels/cloister.toml", 90, 0.97, 0.95);
}

// --- Dithered cones ---

// How much pictures change within a few pixels, in 255ths: what differs between a pixel and the
// mean of those two pixels away to its left and right.
static f64 grain(RenderImage image) {
    f64 sum = 0.0;
    for (u32 y = 0; y < image.height_px; y++)
        for (u32 x = 2; x + 2 < image.width_px; x++)
            for (u32 c = 0; c < 3; c++) {
                const u8 *p = &image.rgba[(y * image.width_px + x) * 4 + c];
                sum += fabs((f64)p[0] - 0.5 * ((f64)p[-8] + (f64)p[8]));
            }
    return sum / ((f64)image.width_px * image.height_px * 3);
}

// Faces apart: every pixel's six cones miss the same parts of the hemisphere, which shows as
// blotches. Dithered, 16 neighbours' cones lean 16 ways, and their mean shows no pattern of 4 x 4.
TEST_GPU(golden, gi_dither_takes_blotches_and_leaves_no_pattern) {
    static const char *const resolutions[] = {"full", "half"};
    Studio studio;
    studio_open(&studio, "data/levels/emissive_teapot.toml");
    for (u32 i = 0; i < COUNT_OF(resolutions); i++) {
        RenderImage images[2];
        for (u32 dither = 0; dither < 2; dither++) {
            char list[200];
            snprintf(list, sizeof list,
                     "tiled_deferred,gi.enabled=on,gi.grid=64,gi.faces=apart,gi.diffuse=cones,"
                     "gi.specular=off,gi.ao=off,gi.resolution=%s,gi.dither=%s",
                     resolutions[i], dither ? "on" : "off");
            images[dither] = draw(&studio, list, 320, 180);
        }
        f64 plain = grain(images[0]), dithered = grain(images[1]);
        printf("%s: grain %.3f, dithered %.3f\n", resolutions[i], plain, dithered);
        if (!is_other_picture(images[0], images[1])) fail_msg("%s: not dithered", resolutions[i]);
        if (dithered > plain) fail_msg("%s: a pattern is left", resolutions[i]);
    }
    studio_close(&studio);
}

// --- Off is off; any settings ---

// Drawn with GI and without by turns, the pictures without are those of a renderer that never had
// it.
TEST_GPU(golden, gi_off_leaves_nothing_behind) {
    Studio fresh, used;
    static const char *const paths[] = {"deferred", "tiled_forward", "multipass", "forward,msaa=4"};
    studio_open(&fresh, "data/levels/cornell.toml");
    studio_open(&used, "data/levels/cornell.toml");
    for (u32 i = 0; i < COUNT_OF(paths); i++) {
        char off[96], on[96];
        snprintf(off, sizeof off, "%s,gi.enabled=off", paths[i]);
        snprintf(on, sizeof on, "%s,%s", paths[i], GI);
        u64 hash = draw(&fresh, off, 96, 54).hash;
        draw(&used, on, 96, 54);
        assert_true(draw(&used, off, 96, 54).hash == hash);
        // And with it, the same as without what came before.
        u64 first = draw(&used, on, 96, 54).hash;
        assert_true(draw(&used, on, 96, 54).hash == first);
    }
    studio_close(&used);
    studio_close(&fresh);
}

// A setting and its values, some of them more often.
static const char *const choices[][5] = {
    {"gi.enabled", "on", "on", "on", "off"},
    {"gi.grid", "32", "64"},
    {"gi.cascades", "1", "1", "2", "3"},
    {"gi.diffuse", "cones", "none", "probes", "voxels"},
    {"gi.resolution", "full", "half", "quarter"},
    {"gi.specular", "on", "off"},
    {"gi.ao", "on", "off"},
    {"gi.dither", "off", "on"},
    {"gi.mips", "linear", "nearest"},
    {"gi.faces", "shared", "apart"},
    {"gi.filter", "directional", "directional", "isotropic"},
    {"gi.format", "half", "byte"},
    {"gi.bounces", "2", "1"},
    {"gi.cone_shadows", "on", "off"},
    {"msaa", "1", "4"},
};

// A hundred frames of random settings, four of each, small ones: the layer has nothing to say (the
// runner looks), and each picture comes out the same the second time.
TEST_OF_KIND(golden, gi_random_settings, TEST_KIND_GPU | TEST_KIND_SLOW) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const u64 seed = 0x5C4EE4;
    for (u32 i = 0; i < 25; i++) {
        char list[768];
        u32 used = (u32)snprintf(list, sizeof list, "%s",
                                 ways[random_u32(seed, i, 1000) % COUNT_OF(ways)]);
        for (u32 k = 0; k < COUNT_OF(choices); k++) {
            u32 count = 0;
            while (count < 4 && choices[k][1 + count]) count++;
            used += (u32)snprintf(list + used, sizeof list - used, ",%s=%s", choices[k][0],
                                  choices[k][1 + random_u32(seed, i, k) % count]);
        }
        u64 first = draw(&studio, list, 40, 24).hash;
        if (draw(&studio, list, 40, 24).hash != first)
            fail_msg("picture %u (seed %llx) comes out different: %s", i, (unsigned long long)seed,
                     list);
        for (u32 frame = 0; frame < 2; frame++) {
            session_advance(&studio.session, 1);
            draw(&studio, list, 40, 24);
        }
    }
    studio_close(&studio);
}
