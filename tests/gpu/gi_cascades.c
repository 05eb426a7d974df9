// gi_cascades.c: nested grids end to end: finer near the eye, no seams, made anew only when the eye
// has moved by a step.
// Data in: the Cornell box. Data out: pictures, counts. Called by: the runner.
#include "../golden/studio.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <string.h>

#define WIDTH  160
#define HEIGHT 90

static RenderImage draw(Studio *studio, const char *list) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    return studio_draw(studio, "inside", &settings, WIDTH, HEIGHT);
}

static f64 mean_error(Studio *studio, const RenderImage *reference, const char *list) {
    RenderImage image = draw(studio, list);
    ImageDifference d = image_compare(reference->rgba, image.rgba, WIDTH, HEIGHT, &studio->images);
    printf("%s: mean %.3f, max %u, ssim %.4f\n", list, d.mean, d.max, d.ssim);
    assert_true(d.ssim > 0.95);
    return d.mean;
}

// Against a single fine grid: a second grid about the eye comes closer than the coarse one alone; a
// third costs nothing of that, which it would if its border showed.
#define COMMON                                                                                     \
    "gi.enabled=on,gi.ao=off,gi.specular=off,gi.bounces=1,gi.diffuse=cones,gi.resolution=full,"    \
    "gi.mips=linear"
TEST_GPU(gi_cascades, finer_near) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    RenderImage fine = draw(&studio, COMMON ",gi.grid=64");
    f64 one = mean_error(&studio, &fine, COMMON ",gi.grid=32,gi.cascades=1");
    f64 two = mean_error(&studio, &fine, COMMON ",gi.grid=32,gi.cascades=2");
    f64 three = mean_error(&studio, &fine, COMMON ",gi.grid=32,gi.cascades=3");
    assert_true(two < one);
    assert_true(three < one);
    studio_close(&studio);
}

static void move_eye(Studio *studio, f32 x) {
    Session *session = &studio->session;
    TransformTable *transforms = WORLD_TABLE(session->world, Transform, transform);
    u32 row = table_row(&transforms->table, session_camera(session, "inside"));
    transforms->x[row] = x;
    table_touch(&transforms->table, row);
    session_advance(session, 1);
}

// The grid's step is 8 of its voxels, here about 0.8 m: small moves change no voxel, a large one
// makes them anew, and back again the picture is the old one, bit for bit.
TEST_GPU(gi_cascades, moves_in_steps) {
    const char *list = COMMON ",gi.grid=32,gi.cascades=2";
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    TransformTable *transforms = WORLD_TABLE(studio.session.world, Transform, transform);
    f32 home =
        transforms->x[table_row(&transforms->table, session_camera(&studio.session, "inside"))];
    session_advance(&studio.session, 1);
    RenderImage first = draw(&studio, list);
    u32 before = renderer_stats(studio.renderer).gi_static_voxelised;
    u32 made = 0, moves = 0;
    for (f32 x = home; x > home - 1.6f; x -= 0.1f, moves++) {
        move_eye(&studio, x);
        draw(&studio, list);
    }
    made = renderer_stats(studio.renderer).gi_static_voxelised - before;
    printf("%u moves, made anew %u times\n", moves, made);
    assert_in_range(made, 1, 3);
    move_eye(&studio, home);
    RenderImage again = draw(&studio, list);
    assert_true(again.hash == first.hash);
    studio_close(&studio);
}
