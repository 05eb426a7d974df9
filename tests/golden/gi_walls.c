// gi_walls.c: what filtering must keep, in whole frames: a uniform wall its radiance (level
// uniform_wall), two walls back to back their colours (level red_green_wall), a closed room of one
// brightness all its light (level white_furnace). The filter alone, in
// all directions: tests/gpu/gi_filter.c.
// Data in: levels, settings. Data out: figures, pass or fail. Called by: the runner.
#include "studio.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 64, HEIGHT = 36, SIDE = 64 }; // SIDE: of the levels' grids
#define FURNACE_RADIANCE 0.45

static f32 from_half(u16 half) { // not negative, finite
    u32 exponent = half >> 10, fraction = half & 0x3FF;
    return exponent ? ldexpf((f32)(fraction | 0x400), (i32)exponent - 25)
                    : ldexpf((f32)fraction, -24);
}

// Mean of the indirect light that arrives at what a camera sees, which must be surface everywhere.
static void indirect(Studio *studio, const char *camera, const char *list, f64 mean[3]) {
    static u16 texels[WIDTH * HEIGHT * 4];
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    studio_draw(studio, camera, &settings, WIDTH, HEIGHT);
    u64 size = renderer_read_gi(studio->renderer, GI_VOLUME_DIFFUSE, texels, sizeof texels);
    assert_int_equal(size, sizeof texels);
    memset(mean, 0, 3 * sizeof *mean);
    for (u32 i = 0; i < WIDTH * HEIGHT; i++)
        for (u32 k = 0; k < 3; k++) mean[k] += (f64)from_half(texels[4 * i + k]) / (WIDTH * HEIGHT);
}

// Everything else in the level is grey: what green has over blue on the red side came through, or
// round the end of, the walls.
TEST_GPU(gi_walls, red_and_green) {
    Studio studio;
    studio_open(&studio, "data/levels/red_green_wall.toml");
    static const char *const lists[] = {"gi.enabled=on,gi.faces=shared",
                                        "gi.enabled=on,gi.faces=apart",
                                        "gi.enabled=on,gi.faces=apart,gi.step_factor=0.2"};
    f64 worst[COUNT_OF(lists)];
    for (u32 i = 0; i < COUNT_OF(lists); i++) {
        f64 red[3], green[3];
        indirect(&studio, "beside_red", lists[i], red);
        indirect(&studio, "beside_green", lists[i], green);
        assert_true(red[0] > red[2] && green[1] > green[2]);
        f64 a = (red[1] - red[2]) / (red[0] - red[2]);
        f64 b = (green[0] - green[2]) / (green[1] - green[2]);
        worst[i] = fmax(a, b);
        printf("%-50s green in red %.2f %%, red in green %.2f %%\n", lists[i], 100 * a, 100 * b);
    }
    assert_true(worst[1] < 0.02 && worst[1] < worst[0]);
    assert_true(worst[2] < 0.005);
    studio_close(&studio);
}

// In a room whose walls all shine alike, as much arrives everywhere. What faces apart lack, each
// bounce lacks again.
TEST_GPU(gi_walls, white_furnace) {
    Studio studio;
    studio_open(&studio, "data/levels/white_furnace.toml");
    static const struct {
        const char *list;
        f64 least, most;
    } ways[] = {
        {"gi.enabled=on,gi.faces=shared", 0.98, 1.02},
        {"gi.enabled=on,gi.faces=apart", 0.9, 1.0},
        {"gi.enabled=on,gi.faces=apart,gi.step_factor=0.2", 0.89, 1.0},
    };
    for (u32 i = 0; i < COUNT_OF(ways); i++) {
        f64 arrives[3];
        indirect(&studio, "main", ways[i].list, arrives);
        printf("%-50s %.3f of the light\n", ways[i].list, arrives[0] / FURNACE_RADIANCE);
        assert_true(arrives[0] > ways[i].least * FURNACE_RADIANCE);
        assert_true(arrives[0] < ways[i].most * FURNACE_RADIANCE);
        assert_true(arrives[1] == arrives[0] && arrives[2] == arrives[0]);
    }
    studio_close(&studio);
}

// Along the wall's normal every level of the atlas shows the wall's own radiance.
static void check_levels(Studio *studio, bool apart, const f32 color[3]) {
    u32 side = apart ? SIDE : SIDE / 2;
    u64 texels = 0;
    for (u32 s = side; s > 0; s /= 2) texels += 6ull * s * s * s;
    u16 *atlas = malloc(2 * texels * 8);
    assert_non_null(atlas);
    // Where lods between levels are made ahead the image is twice as deep, levels first.
    u64 size = renderer_read_gi(studio->renderer, GI_VOLUME_ATLAS, atlas, 2 * texels * 8);
    u64 halves = size / (texels * 8);
    assert_true(size == halves * texels * 8 && (halves == 1 || halves == 2));
    // Faces of the wall: z = -3.4 m and -4.4 m in voxels of 0.25 m from -8 m.
    const u32 places[2] = {18, 14};
    u64 start = 0;
    // The last level is one texel, with the observer in it.
    for (u32 s = side; s > 1; start += 6ull * s * s * s * halves, s /= 2)
        for (u32 face = 0; face < 2; face++)
            for (u32 i = 0; i < s * s; i++) {
                u32 x = (4 + face) * s + i % s, y = i / s, z = places[face] * s / SIDE;
                const u16 *texel = atlas + 4 * (start + x + 6ull * s * (y + (u64)s * z));
                for (u32 k = 0; k < 3; k++)
                    ASSERT_NEAR(from_half(texel[k]), color[k], 0.02 * (f64)color[k]);
                ASSERT_NEAR(from_half(texel[3]), 1.0f, 1e-3);
            }
    free(atlas);
}

TEST_GPU(gi_walls, uniform) {
    Studio studio;
    studio_open(&studio, "data/levels/uniform_wall.toml");
    const f32 color[3] = {0.9f, 0.6f, 0.3f};
    // What a point in the middle sees of a square of 16 m in 6.9 m: form factor 0.625 (Howell, "A
    // catalog of radiation heat transfer configuration factors", B-3, four times).
    const f64 factor = 0.625;
    for (u32 apart = 0; apart < 2; apart++) {
        f64 light[3];
        indirect(&studio, "at_observer",
                 apart ? "gi.enabled=on,gi.faces=apart" : "gi.enabled=on,gi.faces=shared", light);
        printf("faces %s: %.3f of the wall's radiance arrives, should be %.3f\n",
               apart ? "apart" : "shared", light[0] / (f64)color[0], factor);
        for (u32 k = 0; k < 3;
             k++) // its colour, exactly; how much, as well as six cones can: wide texels are dimmer
            ASSERT_NEAR(light[k] / light[0], (f64)color[k] / (f64)color[0], 0.01);
        if (apart) ASSERT_NEAR(light[0] / (f64)color[0], factor, 0.1);
        check_levels(&studio, apart != 0, color);
    }
    studio_close(&studio);
}
