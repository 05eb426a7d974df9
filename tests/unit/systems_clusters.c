// systems_clusters.c: slices of depth as shaders compute them, and clusters' lists against points
// of lights, against the tiles' lists and against a slice cut out by hand.
#include "light_twin.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What a shader's slice of a depth is before it is floored.
static f64 slice_of(const ClusterSlices *s, f64 depth) {
    return log2(depth) * (f64)s->scale + (f64)s->offset;
}

static LightGridInput one_light(f32 columns[4], u32 width_px, u32 height_px, u32 tile_px,
                                f32 near) {
    f32 scale_y = 1.7320508f;
    return (LightGridInput){.x = &columns[0],
                            .y = &columns[1],
                            .z = &columns[2],
                            .radius = &columns[3],
                            .count = 1,
                            .point_count = 1,
                            .highlight_points = 1,
                            .width_px = width_px,
                            .height_px = height_px,
                            .tile_px = tile_px,
                            .near = near,
                            .scale_x = scale_y * (f32)height_px / (f32)width_px,
                            .scale_y = scale_y};
}

TEST(systems_clusters, slices_are_near_cubes_up_to_the_farthest_light) {
    f32 light[4] = {0, 0, -20.25f, 19.75f}; // from 0.5 m to 40 m
    const u32 tiles[] = {16, 32, 64};
    for (u32 i = 0; i < COUNT_OF(tiles); i++) {
        LightGridInput in = one_light(light, 1280, 720, tiles[i], 0.1f);
        ClusterSlices s = light_cluster_slices(&in, UINT32_MAX);
        u32 tiles_y = (720 + tiles[i] - 1) / tiles[i];
        f64 factor = 1 + 2 * 0.5773502692 / tiles_y;
        printf("%u px: %u slices, factor %g, the first ends at %g m\n", tiles[i], s.count,
               (f64)s.factor, (f64)s.end);
        assert_true(s.count > 2 && s.count <= CLUSTER_SLICES_CAP);
        ASSERT_NEAR(s.factor, factor, 1e-4);
        // As deep as they are high, within what the factor allows.
        f64 from = s.end, to = from * s.factor, height = to * 2 / (1.7320508 * tiles_y);
        assert_true((to - from) / height > 0.85 && (to - from) / height < 1.18);
        // The formula says the same as the fields; the light ends before the last slice ends.
        ASSERT_NEAR(slice_of(&s, s.end), 1, 1e-3);
        ASSERT_NEAR(slice_of(&s, (f64)s.end * s.factor) - slice_of(&s, s.end), 1, 1e-4);
        assert_true(slice_of(&s, 40.0) <= s.count - 1 + 1e-3);
        assert_true(slice_of(&s, 40.0) >= s.count - 2.01);
    }
}

TEST(systems_clusters, caps_hold_for_any_lens_and_lights) {
    const u64 seed = 0x51CE;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 at_cap = 0, single = 0;
    for (u32 i = 0; i < 5000; i++) {
        f32 r = random_f32(seed, 1, i);
        f32 light[4] = {0, 0, random_range(seed, 2, i, -200, 20), 0.01f + r * r * 40};
        u32 side = 8u << i % 4, width = 1 + random_u32(seed, 3, i) % 3000,
            height = 1 + random_u32(seed, 4, i) % 2000;
        f32 near = i % 3 ? 0.1f : 0.0001f;
        LightGridInput in = one_light(light, width, height, side, near);
        in.scale_y = random_range(seed, 5, i, 0.1f, 20);
        u32 tiles = ((width + side - 1) / side) * ((height + side - 1) / side);
        u32 cap = i % 2 ? CLUSTER_CELLS_CAP : UINT32_MAX;
        ClusterSlices s = light_cluster_slices(&in, cap);
        assert_true(s.count >= 1 && s.count <= CLUSTER_SLICES_CAP);
        assert_true(s.count == 1 || (u64)s.count * tiles <= (u64)cap * (s.count <= 8 ? 8 : 1));
        assert_true(s.end > 0 && s.factor > 1 && s.scale >= 0 && isfinite(s.offset));
        at_cap += s.count == CLUSTER_SLICES_CAP;
        single += s.count == 1;
        if (s.count == 1) continue;
        ASSERT_NEAR(slice_of(&s, s.end), 1, 0.01);
        // The last slice begins where the light ends, or nearer.
        f64 back = light[3] - light[2];
        assert_true(slice_of(&s, back) <= s.count - 1 + 0.01);
    }
    printf("%u with all slices, %u with one\n", at_cap, single);
    assert_true(at_cap > 50 && single > 50);
    // No light, and none in front of the eye.
    f32 light[4] = {0, 0, 5, 1};
    LightGridInput in = one_light(light, 640, 360, 32, 0.1f);
    assert_int_equal(light_cluster_slices(&in, UINT32_MAX).count, 1);
    in.count = in.point_count = 0;
    assert_int_equal(light_cluster_slices(&in, UINT32_MAX).count, 1);
}

// ---- lists ----

static bool lists_light(const LightGrid *grid, u32 cell, u32 light) {
    const u32 *list = grid->cells[cell].list;
    for (u32 i = 0; i < list[1] + list[2]; i++)
        if (grid->indices[list[0] + i] == light) return true;
    return false;
}

TEST(systems_clusters, no_point_of_a_light_is_missed) {
    const u64 seed = 0xC1057;
    printf("seed %llx\n", (unsigned long long)seed);
    static const u32 sizes[][2] = {{640, 360}, {333, 217}, {61, 700}};
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    u32 seen = 0, spots_seen = 0, slices_max = 0;
    for (u32 round = 0; round < 24; round++) {
        const u32 *size = sizes[round % COUNT_OF(sizes)];
        LightTwin *twin =
            light_twin_create(seed + round, 120, size[0], size[1], round % 5 ? 0.1f : 0.001f, 30.0f,
                              round % 2 ? 2.0f : 8.0f);
        RenderSettings settings = settings_default();
        settings.tile_px = round % TILE_SIZE_COUNT;
        LightGridInput input =
            light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, &arenas.scratch);
        input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
        LightGrid grid = light_grid_build(&input, &arenas.scratch);
        const u32 cells[4] = {grid.tiles_x, grid.tiles_y, grid.slices, input.tile_px};
        memcpy(twin->frame.grid, cells, sizeof cells);
        twin->frame.slices[0] = input.slices.scale;
        twin->frame.slices[1] = input.slices.offset;
        slices_max = MAX(slices_max, grid.slices);
        for (u32 draw = 0; draw < 60000; draw++) {
            u32 light = draw % twin->count;
            f64 world[3];
            twin_point_in_light(twin, light, seed + round, draw, world);
            TwinPoint point = twin_point(&twin->frame, world);
            if (!point.visible || !twin_light_reaches(twin, light, world)) continue;
            if (!lists_light(&grid, twin_cell(&twin->frame, &point), light))
                fail_msg("round %u: light %u is missing at %g, %g px, %g m", round, light,
                         point.x_px, point.y_px, point.depth);
            seen++;
            spots_seen += light >= input.point_count;
        }
        arena_reset(&arenas.scratch);
        light_twin_destroy(twin);
    }
    printf("%u points, %u of them in cones; up to %u slices\n", seen, spots_seen, slices_max);
    assert_true(seen > 250000 && spots_seen > 50000 && slices_max > 60);
    arenas_destroy(&arenas);
}

// A cluster's list is a part of its tile's (by rectangle), and most of the tile's lights are in
// some slice: all but the rectangles' corners.
TEST(systems_clusters, slices_share_out_the_tiles_lists) {
    const u64 seed = 0x51A;
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    for (u32 round = 0; round < 4; round++) {
        LightTwin *twin = light_twin_create(seed + round, 200, 640, 360, 0.1f, 30.0f, 6.0f);
        RenderSettings settings = settings_default();
        settings.tile_px = round % TILE_SIZE_COUNT;
        LightGridInput input =
            light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, &arenas.scratch);
        input.method = GRID_RECT;
        LightGrid tiles = light_grid_build(&input, &arenas.scratch);
        input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
        LightGrid clusters = light_grid_build(&input, &arenas.scratch);
        u32 cursor = 0, tile_lights = 0, slice_lights = 0;
        for (u32 cell = 0; cell < clusters.cell_count; cell++) {
            assert_int_equal(clusters.cells[cell].list[0], cursor);
            cursor += clusters.cells[cell].list[1] + clusters.cells[cell].list[2];
        }
        assert_int_equal(cursor, clusters.index_count);
        for (u32 t = 0; t < tiles.cell_count; t++) {
            bool in_tile[200] = {false}, in_slices[200] = {false};
            const u32 *list = tiles.cells[t].list;
            for (u32 i = 0; i < list[1] + list[2]; i++) in_tile[tiles.indices[list[0] + i]] = true;
            for (u32 z = 0; z < clusters.slices; z++) {
                list = clusters.cells[z * tiles.cell_count + t].list;
                u32 last = 0, diffuse[2] = {0, 0};
                for (u32 i = 0; i < list[1] + list[2]; i++) {
                    u32 light = clusters.indices[list[0] + i];
                    assert_true(i == 0 || light > last);
                    assert_true(in_tile[light]);
                    in_slices[light] = true;
                    bool spot = light >= input.point_count;
                    assert_int_equal(spot, i >= list[1]);
                    diffuse[spot] += spot ? light - input.point_count >= input.highlight_spots
                                          : light >= input.highlight_points;
                    last = light;
                }
                assert_int_equal(list[3], diffuse[0] | diffuse[1] << 16);
            }
            for (u32 i = 0; i < 200; i++) tile_lights += in_tile[i], slice_lights += in_slices[i];
        }
        printf("%u in tiles, %u in some slice\n", tile_lights, slice_lights);
        assert_true(slice_lights <= tile_lights && slice_lights > tile_lights * 4 / 5);
        arena_reset(&arenas.scratch);
        light_twin_destroy(twin);
    }
    arenas_destroy(&arenas);
}

// One small light: the clusters that list it are about as many as its volume fills.
TEST(systems_clusters, a_light_fills_its_volume_of_clusters) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    f32 light[4] = {0.3f, -0.4f, -10, 1.5f};
    LightGridInput in = one_light(light, 1280, 720, 32, 0.1f);
    in.slices = light_cluster_slices(&in, CLUSTER_CELLS_CAP);
    LightGrid grid = light_grid_build(&in, &arenas.scratch);
    f64 side = 10 * (in.slices.factor - 1), volume = 4.19 * 1.5 * 1.5 * 1.5;
    f64 clusters = volume / (side * side * side), reach = 1.5 + 1.5 * side;
    printf("%u clusters of %.2f m, %.0f by volume\n", grid.index_count, side, clusters);
    assert_true(grid.index_count >= clusters);
    // A box around each slice's disc, and clusters at the border.
    assert_true(grid.index_count < 4.19 * 1.3 * reach * reach * reach / (side * side * side));
    arenas_destroy(&arenas);
}

TEST(systems_clusters, too_long_lists_share_one) {
    enum { COUNT = 4000 };
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    f32 *columns[4];
    for (u32 c = 0; c < 4; c++) columns[c] = calloc(COUNT, sizeof(f32));
    for (u32 i = 0; i < COUNT; i++) {
        columns[2][i] = -10;
        columns[3][i] = i % 4 ? 0.5f : 9; // some are large, the others a ball in the middle
    }
    f32 scale = 1.7f;
    LightGridInput in = {.x = columns[0],
                         .y = columns[1],
                         .z = columns[2],
                         .radius = columns[3],
                         .count = COUNT,
                         .point_count = COUNT,
                         .width_px = 1280,
                         .height_px = 720,
                         .tile_px = 16,
                         .near = 0.1f,
                         .scale_x = scale,
                         .scale_y = scale};
    in.slices = light_cluster_slices(&in, CLUSTER_CELLS_CAP);
    LightGrid grid = light_grid_build(&in, &arenas.scratch);
    assert_true(grid.fallbacks > 0 && grid.fallbacks < grid.cell_count);
    assert_true(grid.index_count <= 1u << 24);
    u32 shared = 0;
    for (u32 cell = 0; cell < grid.cell_count; cell++) {
        const u32 *list = grid.cells[cell].list;
        shared += list[0] == 0 && list[1] == COUNT;
        assert_true(list[0] + list[1] <= grid.index_count);
    }
    assert_int_equal(shared, grid.fallbacks);
    for (u32 i = 0; i < COUNT; i++) assert_int_equal(grid.indices[i], i);
    for (u32 c = 0; c < 4; c++) free(columns[c]);
    arenas_destroy(&arenas);
}
