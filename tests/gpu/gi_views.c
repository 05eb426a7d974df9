// gi_views.c: tests of the debug pictures of global illumination: each shows something, the same on
// every run, and says so when there is nothing to show.
#include "../golden/studio.h"
#include <stdio.h>
#include <string.h>

#define WIDTH  128
#define HEIGHT 72

static RenderSettings gi_settings(const char *list) {
    RenderSettings settings = settings_default();
    assert_true(settings_set(&settings, "gi.enabled=on"));
    assert_true(settings_set_preset(&settings, "thesis"));
    assert_true(settings_set(&settings, "gi.grid=32"));
    if (list) assert_true(settings_set_list(&settings, list));
    return settings;
}

// Mean colour of a part of the picture; columns and rows in hundredths, below the legend.
static void mean_color(const RenderImage *image, u32 left, u32 right, u32 top, u32 bottom,
                       f64 out[3]) {
    u32 count = 0;
    memset(out, 0, 3 * sizeof *out);
    for (u32 y = top * HEIGHT / 100; y < bottom * HEIGHT / 100; y++)
        for (u32 x = left * WIDTH / 100; x < right * WIDTH / 100; x++, count++)
            for (u32 k = 0; k < 3; k++) out[k] += image->rgba[4 * (y * WIDTH + x) + k];
    for (u32 k = 0; k < 3; k++) out[k] /= count;
}

static f64 luminance(const f64 c[3]) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

static RenderImage draw(Studio *studio, const char *list) {
    RenderSettings settings = gi_settings(list);
    return studio_draw(studio, "main", &settings, WIDTH, HEIGHT);
}

TEST_GPU(gi_views, voxels_show_what_they_hold) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    f64 c[3];
    RenderImage image = draw(&studio, "view=gi_voxels,gi.show=albedo");
    // The left wall is red, the right one green.
    mean_color(&image, 24, 32, 40, 90, c);
    assert_true(c[0] > 1.5 * c[1] && c[0] > 1.5 * c[2]);
    mean_color(&image, 68, 76, 40, 90, c);
    assert_true(c[1] > 1.2 * c[0]);
    image = draw(&studio, "view=gi_voxels,gi.show=static");
    mean_color(&image, 30, 70, 55, 90, c);
    assert_true(c[1] > 1.5 * c[0] && c[1] > 1.5 * c[2]); // all of it is static
    image = draw(&studio, "view=gi_voxels,gi.show=normal");
    mean_color(&image, 24, 30, 40, 90, c);
    assert_true(c[0] > 120); // the left wall looks to +x
    image = draw(&studio, "view=gi_voxels,gi.show=radiance");
    mean_color(&image, 30, 70, 60, 90, c);
    assert_true(luminance(c) > 8.0);
    image = draw(&studio, "view=gi_voxels,gi.show=emission");
    mean_color(&image, 30, 70, 70, 95, c);
    assert_true(luminance(c) < 8.0); // only the lamp above
    static const char *const rest[] = {"view=gi_voxels,gi.show=visibility",
                                       "view=gi_voxels,gi.show=irradiance",
                                       "view=gi_voxels,gi.show_level=1,gi.show_direction=+z",
                                       "view=gi_voxels,gi.show_level=9",
                                       "view=gi_voxels,gi.faces=apart",
                                       "view=gi_voxels,gi.cascades=2"};
    for (u32 i = 0; i < COUNT_OF(rest); i++) {
        image = draw(&studio, rest[i]);
        mean_color(&image, 30, 70, 55, 95, c);
        if (!(luminance(c) > 2.0)) fail_msg("%s shows nothing: %g", rest[i], luminance(c));
    }
    studio_close(&studio);
}

TEST_GPU(gi_views, parts_of_indirect_light) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    f64 c[3];
    static const struct {
        const char *list;
        f64 least;
    } cases[] = {{"view=gi_indirect", 4},
                 {"view=gi_diffuse", 8},
                 {"view=gi_ao", 40},
                 {"view=gi_steps", 20},
                 {"view=gi_probes,gi.diffuse=probes", 8},
                 {"view=gi_leaks", 3},
                 {"view=gi_diffuse,gi.resolution=half", 8},
                 {"view=gi_leaks,gi.faces=apart", 3}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        RenderImage image = draw(&studio, cases[i].list);
        mean_color(&image, 30, 70, 55, 95, c);
        if (!(luminance(c) >= cases[i].least))
            fail_msg("%s: %g, expected at least %g", cases[i].list, luminance(c), cases[i].least);
        RenderImage again = draw(&studio, cases[i].list);
        if (again.hash != image.hash) fail_msg("%s differs between two frames", cases[i].list);
    }
    // No surface of this level mirrors.
    RenderImage image = draw(&studio, "view=gi_specular");
    mean_color(&image, 30, 70, 55, 95, c);
    assert_true(luminance(c) < 1.0);
    studio_close(&studio);
}

// Pixels that stand out from the four around them, which agree, anywhere below the legend.
static u32 specks(const RenderImage *image) {
    u32 count = 0;
    i32 width = (i32)image->width_px, height = (i32)image->height_px;
    for (i32 y = height * 2 / 5; y < height - 1; y++)
        for (i32 x = 1; x < width - 1; x++) {
            const u8 *middle = image->rgba + 4 * (y * width + x);
            const u8 *around[4] = {middle - 4, middle + 4, middle - 4 * width, middle + 4 * width};
            bool is_speck = false, agree = true;
            for (u32 k = 0; k < 3; k++) {
                i32 low = 255, high = 0;
                for (u32 i = 0; i < 4; i++) {
                    low = MIN(low, around[i][k]);
                    high = MAX(high, around[i][k]);
                }
                agree = agree && high - low <= 6;
                is_speck = is_speck || middle[k] < low - 8 || middle[k] > high + 8;
            }
            count += is_speck && agree;
        }
    return count;
}

// A ray that cuts the corner between two voxels would show the wrong side of the next one, or fall
// through.
TEST_GPU(gi_views, voxels_have_no_specks) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    static const char *const lists[] = {"view=gi_voxels,gi.show=albedo,gi.grid=128",
                                        "view=gi_voxels,gi.grid=64,gi.faces=apart"};
    for (u32 i = 0; i < COUNT_OF(lists); i++) {
        RenderSettings settings = gi_settings(lists[i]);
        RenderImage image = studio_draw(&studio, "main", &settings, 320, 180);
        u32 count = specks(&image);
        printf("%s: %u specks\n", lists[i], count);
        if (count > 0) fail_msg("%s: %u specks", lists[i], count);
    }
    studio_close(&studio);
}

// Blocks of pixels that a triangle covers in part run lanes whose pixels are not theirs: along the
// line that the screen's triangle is cut in two by, and at the borders of odd sizes.
TEST_GPU(gi_views, pixels_beside_the_triangle_stop_nobody) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const u32 width = 642, height = 361; // the legend ends above the box
    RenderSettings settings = gi_settings("view=gi_steps");
    RenderImage image = studio_draw(&studio, "main", &settings, width, height);
    // The front of the tall box, which that line crosses: cones take about as many steps all over.
    u32 few = 0, most = 0;
    for (u32 turn = 0; turn < 2; turn++)
        for (u32 y = height * 48 / 100; y < height * 75 / 100; y++)
            for (u32 x = width * 40 / 100; x < width * 48 / 100; x++) {
                u32 green = image.rgba[4 * (y * width + x) + 1];
                most = MAX(most, green);
                few += turn && green < most * 3 / 5;
            }
    assert_true(most > 128);
    if (few > 0) fail_msg("%u pixels' cones take few steps beside others' that take many", few);
    studio_close(&studio);
}

TEST_GPU(gi_views, nothing_to_show) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    for (u32 view = VIEW_GI_VOXELS; view <= VIEW_GI_LEAKS; view++) {
        RenderSettings settings = settings_default();
        assert_true(settings_set(&settings, "gi.enabled=off"));
        settings.view = view;
        RenderImage image = studio_draw(&studio, "main", &settings, WIDTH, HEIGHT);
        f64 c[3];
        mean_color(&image, 0, 100, 40, 100, c);
        assert_true(c[0] + c[1] + c[2] == 0.0); // black below the caption
    }
    studio_close(&studio);
}
