// matrix.c: one frame of every level in every path, G-buffer layout and light grid, against brute
// force; what the light manager's simplifications cost; and all of it switched every frame.
//
// Data: the project's levels at a small size. Brute force is path `forward` with every light of
// the level (manager off). The exact layouts hold 2 / 255 from it. What a lossy layout loses is
// stated in the table of layouts.c; here it must lose the same in every path with every grid: 2 /
// 255 from its own first picture.
#include "studio.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <string.h>

#define WIDTH  128
#define HEIGHT 72
// Of the worst layout on the worst level, see layouts.c.
#define LOSSY_SSIM 0.96

// What of the settings matters to a path: without the others the same picture would be drawn again.
typedef struct MatrixPath {
    RenderPath path;
    bool has_layout, is_tiled, is_clustered;
} MatrixPath;
static const MatrixPath matrix_paths[] = {
    {PATH_FORWARD, false, false, false},          {PATH_MULTIPASS, false, false, false},
    {PATH_DEFERRED, true, false, false},          {PATH_DEFERRED_VOLUMES, true, false, false},
    {PATH_TILED_DEFERRED, true, true, false},     {PATH_TILED_FORWARD, false, true, false},
    {PATH_CLUSTERED_DEFERRED, true, false, true}, {PATH_CLUSTERED_FORWARD, false, false, true},
};
_Static_assert(COUNT_OF(matrix_paths) == PATH_COUNT, "every path is in the matrix");

// Nothing is simplified: the picture is that of all lights. Light that bounces is compared in
// gi_screen.c: at less than full resolution it tells surfaces apart by normals that layouts keep
// with few bits.
static RenderSettings exact_settings(u32 light_limit) {
    RenderSettings settings = studio_direct_light();
    settings.light_limit = light_limit;
    settings.merge = settings.drop = settings.light_lod = settings.vertex_lighting = 0;
    settings.budget = 0;
    return settings;
}

static void describe(const RenderSettings *s, char *out, u64 out_cap) {
    char path[64], layout[64], grid[64], clusters[64];
    settings_word("path", s->path, path, sizeof path);
    settings_word("layout", s->layout, layout, sizeof layout);
    settings_word("grid", s->grid, grid, sizeof grid);
    settings_word("clusters", s->clusters, clusters, sizeof clusters);
    snprintf(out, out_cap, "%s, %s, %s", path, layout,
             settings_clustered(s) ? clusters
             : settings_tiled(s)   ? grid
                                   : "no grid");
}

static void compare_matrix(const char *level, u32 light_limit) {
    Studio studio;
    studio_open(&studio, level);
    session_advance(&studio.session, 90);
    RenderSettings brute = exact_settings(light_limit);
    brute.path = PATH_FORWARD;
    brute.manager = 0;
    RenderImage truth = studio_draw(&studio, "main", &brute, WIDTH, HEIGHT);
    RenderImage first[LAYOUT_COUNT] = {0}; // of each layout
    u32 drawn = 0, worst_exact = 0;
    for (u32 p = 0; p < COUNT_OF(matrix_paths); p++) {
        const MatrixPath *row = &matrix_paths[p];
        u32 layouts = row->has_layout ? LAYOUT_COUNT : 1;
        u32 grids = row->is_tiled ? GRID_METHOD_COUNT : row->is_clustered ? CLUSTER_BUILD_COUNT : 1;
        for (u32 layout = 0; layout < layouts; layout++)
            for (u32 grid = 0; grid < grids; grid++) {
                RenderSettings settings = exact_settings(light_limit);
                settings.path = row->path;
                settings.layout = layout;
                if (row->is_tiled) settings.grid = grid;
                if (row->is_clustered) settings.clusters = grid;
                RenderImage image = studio_draw(&studio, "main", &settings, WIDTH, HEIGHT);
                bool exact = layout == LAYOUT_LEAN || layout == LAYOUT_WIDE;
                if (!first[layout].rgba) first[layout] = image;
                const u8 *expected = exact ? truth.rgba : first[layout].rgba;
                ImageDifference d =
                    image_compare(expected, image.rgba, WIDTH, HEIGHT, &studio.images);
                char words[256];
                describe(&settings, words, sizeof words);
                if (d.max > 2)
                    fail_msg("%s in %s: max %u at %u,%u, mean %.4f", level, words, d.max, d.max_x,
                             d.max_y, d.mean);
                if (exact) worst_exact = MAX(worst_exact, d.max);
                drawn++;
            }
    }
    f64 worst_ssim = 1.0;
    for (u32 layout = 0; layout < LAYOUT_COUNT; layout++) {
        ImageDifference d =
            image_compare(truth.rgba, first[layout].rgba, WIDTH, HEIGHT, &studio.images);
        worst_ssim = MIN(worst_ssim, d.ssim);
    }
    printf(
        "    %s: %u ways; exact layouts at most %u / 255 from brute force, lossy ones SSIM %.4f\n",
        level, drawn, worst_exact, worst_ssim);
    assert_int_equal(drawn, 1 + 1 + 8 + 8 + 8 * 3 + 3 + 8 * 2 + 2);
    assert_true(worst_ssim >= LOSSY_SSIM);
    studio_close(&studio);
}

TEST_GPU(matrix, every_way_cloister) { compare_matrix("data/levels/cloister.toml", 0); }
TEST_GPU(matrix, every_way_cornell) { compare_matrix("data/levels/cornell.toml", 0); }
TEST_GPU(matrix, every_way_cornell_empty) { compare_matrix("data/levels/cornell_empty.toml", 0); }
TEST_GPU(matrix, every_way_light_box) { compare_matrix("data/levels/light_box.toml", 0); }
TEST_GPU(matrix, every_way_lights_4096) { compare_matrix("data/levels/lights_4096.toml", 0); }
// Its 10,000 lights would be 1,250 passes over the scene for `multipass`.
TEST_GPU(matrix, every_way_hall) { compare_matrix("data/levels/hall.toml", 1000); }
TEST_GPU(matrix, every_way_plane_test) { compare_matrix("data/levels/plane_test.toml", 0); }

// The light manager as it is by default against all lights, on every level.
TEST_GPU(matrix, what_the_manager_costs) {
    for (u32 i = 0; i < studio_level_count; i++) {
        Studio studio;
        studio_open(&studio, studio_levels[i]);
        session_advance(&studio.session, 90);
        RenderSettings settings = settings_default();
        RenderImage with = studio_draw(&studio, "main", &settings, 320, 180);
        settings.manager = settings.vertex_lighting = 0;
        RenderImage without = studio_draw(&studio, "main", &settings, 320, 180);
        ImageDifference d = image_compare(without.rgba, with.rgba, 320, 180, &studio.images);
        printf("    %s: manager on against off: max %u, SSIM %.5f, FLIP %.5f\n", studio_levels[i],
               d.max, d.ssim, d.flip);
        assert_true(d.ssim >= 0.98);
        assert_true(d.flip <= 0.02);
        studio_close(&studio);
    }
}

// Every setting jumps every frame while the world moves: the validation layer stays silent (the
// fixture fails otherwise), frames come at all, and afterwards the picture is what it was.
TEST_GPU(matrix, all_settings_switched_for_300_frames) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    RenderSettings settings = settings_default();
    RenderImage first = studio_draw(&studio, "main", &settings, WIDTH, HEIGHT);
    u32 per_path[PATH_COUNT] = {0};
    for (u32 frame = 0; frame < 300; frame++) {
        RenderSettings random = settings_default();
        for (u32 i = 0; i < render_setting_count; i++) {
            const SettingDesc *desc = &render_setting_descs[i];
            if (desc->type != SETTING_ENUM && desc->type != SETTING_BOOL) continue;
            // Ways of global illumination stay for ten frames: each has shaders of its own to
            // compile, and they jump in tests of their own. So do finer voxels, which take seconds.
            bool is_gi = strncmp(desc->name, "gi.", 3) == 0;
            u32 value = random_u32(0x5E77, i, is_gi ? frame / 10 : frame) % ((u32)desc->max + 1);
            if (strcmp(desc->name, "gi.grid") == 0) value = MIN(value, 2);
            memcpy((u8 *)&random + desc->offset, &value, sizeof value);
        }
        per_path[random.path]++;
        arena_reset(&studio.images);
        studio_draw(&studio, "main", &random, 64, 36);
    }
    for (u32 path = 0; path < PATH_COUNT; path++) assert_true(per_path[path] > 10);
    RenderImage last = studio_draw(&studio, "main", &settings, WIDTH, HEIGHT);
    assert_true(first.hash == last.hash);
    studio_close(&studio);
}
