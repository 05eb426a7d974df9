// layouts.c: every layout of the G-buffer in every path that reads it, against brute force; the
// look-up textures against arithmetic; debug pictures of all layouts.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include "../../engine/render/render_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const u32 deferred_paths[] = {PATH_TILED_DEFERRED, PATH_CLUSTERED_DEFERRED, PATH_DEFERRED,
                                     PATH_DEFERRED_VOLUMES};

// How far a layout's picture may be from the brute-force path's, over all levels, in 255ths of a
// channel. A rim of mirrored normals is a few bright pixels, so the maximum says little: the
// 99th percentile over the pixels and SSIM tell whether the picture is the same. Measured, with
// about a third on top; why they are what they are:
static const struct {
    u32 max, p99;
    f64 mean, ssim;
} bounds[LAYOUT_COUNT] = {
    // Exact up to rounding: the specification's 2 / 255.
    [LAYOUT_LEAN] = {2, 1, 0.15, 0.999},
    [LAYOUT_WIDE] = {2, 1, 0.15, 0.999},
    // View normals, mirrored where they face away: in the cloister these are the soffits of arches
    // and what lies low or high in the picture. Their bytes and the distance's add little.
    [LAYOUT_PACKED] = {130, 47, 1.45, 0.964},
    [LAYOUT_PACKED24] = {130, 47, 1.45, 0.964},
    // Positions are off by a few millimetres: close to a small light that is bright or dark.
    [LAYOUT_HALF5] = {84, 3, 0.15, 0.999},
    // Mirrored normals, and highlights without a colour or a lobe of their own.
    [LAYOUT_KILLZONE2] = {130, 47, 1.45, 0.964},
    // As half5; Phong, Oren-Nayar and Fresnel among other lobes are lost.
    [LAYOUT_STARCRAFT2] = {84, 3, 0.15, 0.999},
    // As killzone2, but Oren-Nayar is there in ten steps.
    [LAYOUT_IL] = {130, 47, 1.45, 0.964},
};

// Largest difference of a channel, by pixel; the value that `share` of the pixels do not pass, and
// the share over 2.
static u32 percentile(const RenderImage *a, const RenderImage *b, f64 share, f64 *over_2) {
    u32 histogram[256] = {0}, count = a->width_px * a->height_px, above = 0;
    for (u32 i = 0; i < count; i++) {
        u32 worst = 0;
        for (u32 k = 0; k < 3; k++)
            worst = MAX(worst, (u32)abs(a->rgba[i * 4 + k] - b->rgba[i * 4 + k]));
        histogram[worst]++;
        above += worst > 2;
    }
    *over_2 = (f64)above / count;
    u32 value = 0;
    for (u32 sum = histogram[0]; value < 255 && sum < share * count; sum += histogram[++value]) {
    }
    return value;
}

static RenderSettings settings_of(u32 path, u32 layout) {
    RenderSettings settings = studio_direct_light(); // see matrix.c
    settings.path = path;
    settings.layout = layout;
    settings.vertex_lighting = 0;
    return settings;
}

static void compare_layouts(const char *level, u32 width, u32 height, u32 path_count) {
    Studio studio;
    studio_open(&studio, level);
    session_advance(&studio.session, 90);
    RenderSettings settings = settings_of(PATH_FORWARD, LAYOUT_LEAN);
    RenderImage truth = studio_draw(&studio, "main", &settings, width, height);
    for (u32 layout = 0; layout < LAYOUT_COUNT; layout++) {
        RenderImage first = {0};
        for (u32 i = 0; i < path_count; i++) {
            settings = settings_of(deferred_paths[i], layout);
            RenderImage image = studio_draw(&studio, "main", &settings, width, height);
            ImageDifference d =
                image_compare(truth.rgba, image.rgba, width, height, &studio.images);
            if (i == 0) {
                first = image;
                f64 over_2;
                u32 p99 = percentile(&truth, &image, 0.99, &over_2);
                printf("    %-10s max %3u, 99 %% within %2u, mean %.3f, over 2: %5.2f %%, "
                       "SSIM %.5f\n",
                       layout_table[layout].name, d.max, p99, d.mean, over_2 * 100.0, d.ssim);
                assert_in_range(d.max, 0, bounds[layout].max);
                assert_in_range(p99, 0, bounds[layout].p99);
                assert_true(d.mean <= bounds[layout].mean);
                assert_true(d.ssim >= bounds[layout].ssim);
                continue;
            }
            // What a layout loses it loses alike in all paths.
            d = image_compare(first.rgba, image.rgba, width, height, &studio.images);
            if (d.max > 2) {
                char word[64];
                fail_msg("%s in %s differs by %u from %s at %u,%u", layout_table[layout].name,
                         settings_word("path", deferred_paths[i], word, sizeof word), d.max,
                         "tiled_deferred", d.max_x, d.max_y);
            }
        }
    }
    studio_close(&studio);
}

TEST_GPU(layouts, agree_cloister) { compare_layouts("data/levels/cloister.toml", 160, 90, 4); }
TEST_GPU(layouts, agree_cornell) { compare_layouts("data/levels/cornell.toml", 160, 90, 4); }
TEST_GPU(layouts, agree_cornell_empty) {
    compare_layouts("data/levels/cornell_empty.toml", 160, 90, 4);
}
// Its thousands of lights would take the paths with a draw a light half a minute.
TEST_GPU(layouts, agree_hall) { compare_layouts("data/levels/hall.toml", 64, 36, 2); }
TEST_GPU(layouts, agree_light_box) { compare_layouts("data/levels/light_box.toml", 160, 90, 4); }
TEST_GPU(layouts, agree_lights_4096) { compare_layouts("data/levels/lights_4096.toml", 80, 45, 4); }
TEST_GPU(layouts, agree_plane_test) { compare_layouts("data/levels/plane_test.toml", 160, 90, 4); }

// Bytes a pixel, as the targets that the renderer made have them.
TEST_GPU(layouts, bytes_a_pixel) {
    const LayoutRow *wide = &layout_table[LAYOUT_WIDE];
    assert_int_equal(wide->position_normal_bytes, 32);
    Gpu *gpu = gpu_create(&(GpuDesc){.label = "bytes", .validation = true});
    assert_non_null(gpu);
    for (u32 layout = 0; layout < LAYOUT_COUNT; layout++) {
        const LayoutRow *row = &layout_table[layout];
        char word[64];
        assert_string_equal(row->name, settings_word("layout", layout, word, sizeof word));
        assert_true(strlen(row->loses) > 0);
        u32 bytes = 0;
        GpuTexture targets[5] = {0};
        GpuHeapStat before[32], after[32];
        gpu_heap_stats(gpu, before, COUNT_OF(before));
        for (u32 i = 0; i < 5; i++) {
            if (!row->targets[i]) continue;
            assert_true(i == 0 || row->targets[i - 1]); // no holes
            targets[i] = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "target",
                                                                   .heap = row->name,
                                                                   .format = row->targets[i],
                                                                   .width = 256,
                                                                   .height = 256,
                                                                   .render_target = true,
                                                                   .sampled = true});
            assert_true(targets[i].id);
        }
        u32 heaps = gpu_heap_stats(gpu, after, COUNT_OF(after));
        for (u32 i = 0; i < heaps; i++)
            if (strcmp(after[i].name, row->name) == 0) bytes = (u32)(after[i].used / 65536);
        printf("    %-10s %2u bytes a pixel, %2u of them position and normal (%.1f %% of wide's)\n",
               row->name, bytes, row->position_normal_bytes,
               100.0 * row->position_normal_bytes / wide->position_normal_bytes);
        assert_int_equal(bytes, layout_bytes(row));
        for (u32 i = 0; i < 5; i++)
            if (targets[i].id) gpu_destroy_texture(gpu, targets[i]);
    }
    assert_true(layout_table[LAYOUT_PACKED].position_normal_bytes <=
                0.17 * wide->position_normal_bytes);
    gpu_destroy(gpu);
}

// --- Look-ups ---

// The same level and frame with a setting on and off.
static ImageDifference difference_by(Studio *studio, RenderSettings settings, const char *change,
                                     RenderImage *changed) {
    RenderImage plain = studio_draw(studio, "main", &settings, 160, 90);
    assert_true(settings_set(&settings, change));
    *changed = studio_draw(studio, "main", &settings, 160, 90);
    return image_compare(plain.rgba, changed->rgba, 160, 90, &studio->images);
}

static void check_falloff(const char *level, bool all_paths) {
    Studio studio;
    studio_open(&studio, level);
    session_advance(&studio.session, 30);
    EnvironmentTable *environment = WORLD_TABLE(studio.session.world, Environment, environment);
    u32 row = world_singleton(studio.session.world, COMPONENT_environment);
    static const struct {
        u32 attenuation;
        f32 constant, linear, quadratic;
    } cases[] = {{ATTENUATION_INVERSE_SQUARE, 1, 0, 1},   {ATTENUATION_WINDOW, 1, 0, 1},
                 {ATTENUATION_POLYNOMIAL, 1, 0.7f, 1.8f}, {ATTENUATION_POLYNOMIAL, 0.2f, 0, 4},
                 {ATTENUATION_POLYNOMIAL, 1, 2, 0},       {ATTENUATION_POLYNOMIAL, 2, 0, 0},
                 {ATTENUATION_POLYNOMIAL, 0, 1, 0.5f},    {ATTENUATION_POLYNOMIAL, 0, 0, 1}};
    static const u32 paths[] = {PATH_TILED_DEFERRED, PATH_DEFERRED, PATH_FORWARD};
    for (u32 c = 0; c < COUNT_OF(cases); c++) {
        environment->attenuation[row] = cases[c].attenuation;
        environment->attenuation_constant[row] = cases[c].constant;
        environment->attenuation_linear[row] = cases[c].linear;
        environment->attenuation_quadratic[row] = cases[c].quadratic;
        for (u32 p = 0; p < (all_paths ? COUNT_OF(paths) : 1); p++) {
            RenderImage changed;
            ImageDifference d = difference_by(&studio, settings_of(paths[p], LAYOUT_LEAN),
                                              "attenuation_lookup=on", &changed);
            if (p == 0)
                printf("    %s: attenuation %u (%g %g %g): max %u, %u pixels differ\n", level,
                       cases[c].attenuation, (f64)cases[c].constant, (f64)cases[c].linear,
                       (f64)cases[c].quadratic, d.max, d.different_pixels);
            assert_in_range(d.max, 0, 1);
        }
    }
    studio_close(&studio);
}
TEST_GPU(layouts, attenuation_lookup_cloister) {
    check_falloff("data/levels/cloister.toml", false);
}
TEST_GPU(layouts, attenuation_lookup_light_box) {
    check_falloff("data/levels/light_box.toml", true);
}
TEST_GPU(layouts, attenuation_lookup_plane_test) {
    check_falloff("data/levels/plane_test.toml", false);
}

TEST_GPU(layouts, normal_lookup) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    static const u32 with[] = {LAYOUT_PACKED, LAYOUT_PACKED24};
    for (u32 i = 0; i < COUNT_OF(with); i++) {
        RenderImage changed;
        ImageDifference d = difference_by(&studio, settings_of(PATH_TILED_DEFERRED, with[i]),
                                          "normal_lookup=on", &changed);
        printf("    %s: max %u, %u pixels differ\n", layout_table[with[i]].name, d.max,
               d.different_pixels);
        assert_in_range(d.max, 0, 1);
    }
    studio_close(&studio);
}

// The palette as a texture: the same bits, also after materials changed.
TEST_GPU(layouts, palette_texture) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    MaterialTable *materials = WORLD_TABLE(studio.session.world, Material, material);
    for (u32 round = 0; round < 2; round++) {
        for (u32 path = 0; path < PATH_COUNT; path++) {
            RenderImage changed;
            ImageDifference d =
                difference_by(&studio, settings_of(path, LAYOUT_LEAN), "palette=texture", &changed);
            assert_int_equal(d.different_pixels, 0);
        }
        for (u32 layout = 0; layout < LAYOUT_COUNT; layout++) {
            RenderImage changed;
            ImageDifference d = difference_by(&studio, settings_of(PATH_TILED_DEFERRED, layout),
                                              "palette=texture", &changed);
            assert_int_equal(d.different_pixels, 0);
        }
        for (u32 row = 0; row < materials->table.count; row++)
            materials->albedo_r[row] = 1.0f - materials->albedo_r[row];
    }
    studio_close(&studio);
}

// --- Normals that face away from the eye ---

// What z = sqrt(1 - x^2 - y^2) costs in a real scene: the pictures of normals, in view space.
TEST_GPU(layouts, normals_that_face_away) {
    static const char *const cameras[] = {"main", "chapter_house", "garden"};
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    for (u32 c = 0; c < COUNT_OF(cameras); c++) {
        RenderSettings settings = settings_of(PATH_TILED_DEFERRED, LAYOUT_LEAN);
        settings.view = VIEW_NORMAL;
        RenderImage image = studio_draw(&studio, cameras[c], &settings, 320, 180);
        const Packet *packet = session_packet(&studio.session, &(SessionView){.camera = cameras[c],
                                                                              .settings = settings,
                                                                              .width_px = 320,
                                                                              .height_px = 180});
        const f32 *view = packet->frame.view;
        u32 away = 0, count = 0;
        f64 worst = 0;
        for (u32 i = 0; i < 320 * 180; i++) {
            f64 n[3], length = 0, z = 0;
            for (u32 k = 0; k < 3; k++) {
                n[k] = image.rgba[i * 4 + k] / 127.5 - 1.0;
                length += n[k] * n[k];
                z += (f64)view[k * 4 + 2] * n[k];
            }
            if (length < 0.9 || length > 1.1) continue; // background
            count++;
            z /= sqrt(length);
            if (z >= -0.01) continue; // the picture's own rounding
            away++;
            worst = fmax(worst, asin(-z) * 57.29577951308232);
        }
        printf("    cloister, %s: %.2f %% of normals face away, by %.1f degrees at most (rebuilt "
               "twice that off)\n",
               cameras[c], 100.0 * away / count, worst);
        assert_true(count > 1000);
    }
    studio_close(&studio);
}

// --- Debug pictures ---

TEST_GPU(layouts, debug_views) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_advance(&studio.session, 10);
    u64 albedo = 0;
    for (u32 layout = 0; layout < LAYOUT_COUNT; layout++)
        for (u32 view = VIEW_ALBEDO; view <= VIEW_GBUFFER_4; view++) {
            RenderSettings settings = settings_of(PATH_TILED_DEFERRED, layout);
            settings.view = view;
            RenderImage image = studio_draw(&studio, "main", &settings, 160, 90);
            u32 bright = 0;
            for (u32 i = 0; i < 160 * 90; i++)
                bright += image.rgba[i * 4] + image.rgba[i * 4 + 1] + image.rgba[i * 4 + 2] > 12;
            bool is_there =
                view < VIEW_GBUFFER_0 || layout_table[layout].targets[view - VIEW_GBUFFER_0];
            char word[64];
            bool may_be_dark =
                view == VIEW_EMISSIVE || (layout == LAYOUT_STARCRAFT2 && view == VIEW_GBUFFER_0);
            if (is_there && !may_be_dark && bright < 160 * 90 / 10)
                fail_msg("%s of %s: only %u pixels are not black",
                         settings_word("view", view, word, sizeof word), layout_table[layout].name,
                         bright);
            if (!is_there) assert_in_range(bright, 0, 160 * 90 / 10); // its caption
            if (view == VIEW_ALBEDO && layout == LAYOUT_LEAN) albedo = image.hash;
            if (view == VIEW_ALBEDO && layout == LAYOUT_WIDE) assert_true(albedo == image.hash);
        }
    studio_close(&studio);
}

// Motion of a camera that walks: from the position, or as a layout stored it; none when it stands.
TEST_GPU(layouts, motion_view) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    RenderSettings settings = settings_of(PATH_TILED_DEFERRED, LAYOUT_LEAN);
    settings.view = VIEW_MOTION;
    const Packet *packet = session_packet(
        &studio.session,
        &(SessionView){.camera = "main", .settings = settings, .width_px = 160, .height_px = 90});
    assert_non_null(packet);
    Packet *copy = arena_push(&studio.images, packet->size, CACHE_LINE);
    memcpy(copy, packet, packet->size);
    RenderImage images[LAYOUT_COUNT] = {0};
    for (u32 moves = 0; moves < 2; moves++) {
        // As if the camera had been 0.2 m to the side: the same matrix, of points moved by that.
        f32 *before = copy->frame.previous_view_projection;
        memcpy(before, copy->frame.view_projection, sizeof copy->frame.view_projection);
        for (u32 k = 0; k < 4; k++) before[12 + k] += (f32)moves * 0.2f * before[k];
        for (u32 layout = 0; layout < LAYOUT_COUNT; layout++) {
            copy->settings.layout = layout;
            assert_true(
                renderer_render_image(studio.renderer, copy, &studio.images, &images[layout]));
            ImageDifference d =
                image_compare(images[0].rgba, images[layout].rgba, 160, 90, &studio.images);
            // A byte holds the root of the motion: steps of one in the picture.
            if (moves) printf("    %-10s max %u\n", layout_table[layout].name, d.max);
            assert_in_range(d.max, 0, 2);
        }
        u32 moving = 0, seen = 0;
        for (u32 i = 160 * 30; i < 160 * 90; i++) { // below the caption
            const u8 *p = &images[0].rgba[i * 4];
            if (p[2] == 0) continue; // background
            seen++;
            moving += abs(p[0] - 128) > 2;
        }
        assert_true(seen > 160 * 60 / 2);
        if (moves)
            assert_true(moving > seen * 9 / 10);
        else
            assert_int_equal(moving, 0);
    }
    studio_close(&studio);
}
