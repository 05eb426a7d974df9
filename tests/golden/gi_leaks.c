// gi_leaks.c: how much light gets through walls (specification of voxel GI, 9): level sealed_room,
// four sealed, unlit rooms in bright surroundings. The figure is the mean indirect radiance of a
// room's inner walls over that of its outer ones, for walls of 0.5, 1, 2 and 3 voxels.
// Data in: the level, settings. Data out: figures, pass or fail. Called by: the runner.
#include "studio.h"
#include <stdio.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 54, ROOMS = 4 };

static const char *const rooms[ROOMS] = {"half", "one", "two", "three"};
static const char *const eyes_in[] = {"in_a", "in_b"};
static const char *const eyes_out[] = {"out_left", "out_right", "out_back", "out_front",
                                       "out_above"};

static f32 from_half(u16 half) { // not negative, finite
    u32 exponent = half >> 10, fraction = half & 0x3FF;
    return exponent ? ldexpf((f32)(fraction | 0x400), (i32)exponent - 25)
                    : ldexpf((f32)fraction, -24);
}

// Mean of what arrives at the walls that a camera of a room sees: all of its picture is wall.
static f64 indirect(Studio *studio, const RenderSettings *settings, const char *room,
                    const char *eye) {
    static u16 texels[WIDTH * HEIGHT * 4];
    char camera[64];
    snprintf(camera, sizeof camera, "%s/%s", room, eye);
    studio_draw(studio, camera, settings, WIDTH, HEIGHT);
    u64 size = renderer_read_gi(studio->renderer, GI_VOLUME_DIFFUSE, texels, sizeof texels);
    assert_int_equal(size, sizeof texels);
    f64 sum = 0;
    for (u32 i = 0; i < WIDTH * HEIGHT; i++)
        for (u32 k = 0; k < 3; k++) sum += (f64)from_half(texels[4 * i + k]);
    return sum / (3.0 * WIDTH * HEIGHT);
}

// list: settings after those of a preset.
static void measure(Studio *studio, const char *preset, const char *list, f64 leaks[ROOMS]) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_preset(&settings, preset));
    if (list[0]) assert_true(settings_set_list(&settings, list));
    settings.gi_resolution = 1 + GI_RESOLUTION_FULL; // 0 is the level's
    settings.gi_ao = 1;                              // off
    printf("%-10s %-34s", preset, list);
    for (u32 r = 0; r < ROOMS; r++) {
        f64 in = 0, out = 0;
        for (u32 i = 0; i < COUNT_OF(eyes_in); i++)
            in += indirect(studio, &settings, rooms[r], eyes_in[i]) / COUNT_OF(eyes_in);
        for (u32 i = 0; i < COUNT_OF(eyes_out); i++)
            out += indirect(studio, &settings, rooms[r], eyes_out[i]) / COUNT_OF(eyes_out);
        assert_true(out > 0.1);
        leaks[r] = in / out;
        printf("  %s %.3f %%", rooms[r], 100.0 * leaks[r]);
    }
    printf("\n");
}

// With the steps that the presets take: walls of three voxels let a thousandth through, of two a
// hundredth, thinner ones a third of what comes through where a voxel has one radiance for both its
// sides.
TEST_GPU(gi_leaks, sealed_rooms) {
    enum { HALF, ONE, TWO, THREE };
    Studio studio;
    studio_open(&studio, "data/levels/sealed_room.toml");
    f64 shared[ROOMS], apart[ROOMS], fine[ROOMS], kept[ROOMS], kept_fine[ROOMS];
    measure(&studio, "thesis", "gi.diffuse=voxels", kept);
    measure(&studio, "thesis", "gi.diffuse=voxels,gi.faces=apart,gi.step_factor=0.2", kept_fine);
    measure(&studio, "thesis", "", shared);
    measure(&studio, "thesis", "gi.faces=apart", apart);
    measure(&studio, "thesis", "gi.faces=apart,gi.step_factor=0.2", fine);
    // What is kept a voxel is one number for all that lies in it: thinner walls have nothing to
    // hold light back with, of one voxel the rims; thicker ones hold as well as cones do.
    assert_true(kept[ONE] < 0.7 && kept_fine[HALF] < 0.5 && kept_fine[ONE] < 0.05);
    assert_true(kept_fine[TWO] < 0.001 && kept_fine[THREE] < 0.001);
    for (u32 r = 0; r < ROOMS; r++) assert_true(apart[r] < shared[r] / 3.0);
    assert_true(apart[TWO] < 0.01 && apart[THREE] < 0.001);
    assert_true(fine[TWO] < 0.001 && fine[THREE] < 0.001);
    studio_close(&studio);
}

// What a level can ask for beside that makes none of it worse.
TEST_GPU(gi_leaks, formats_and_solid_voxels) {
    Studio studio;
    studio_open(&studio, "data/levels/sealed_room.toml");
    static const char *const lists[] = {
        "gi.faces=apart,gi.step_factor=0.2,gi.format=byte",
        "gi.faces=apart,gi.solid=on",
        "gi.faces=apart,gi.step_factor=0.2,gi.mips=nearest",
    };
    for (u32 i = 0; i < COUNT_OF(lists); i++) {
        f64 leaks[ROOMS];
        measure(&studio, "thesis", lists[i], leaks);
        assert_true(leaks[0] < 0.04 && leaks[1] < 0.02 && leaks[2] < 0.001 && leaks[3] < 0.001);
    }
    studio_close(&studio);
}
