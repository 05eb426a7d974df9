// systems_light_grid.c: screen bounds of spheres against samples and against trigonometry; tile
// lists against asking every tile about every light, and against points of lights; what the ways to
// make lists leave out.
#include "light_twin.h"
#include "../test.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/light_grid.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NEAR_M 0.1f

typedef struct Interval {
    f64 low, high;
    bool any;
} Interval;

// The same by another way: angles of the tangents, and the cut at the near plane where a tangent
// does not reach in front of it. In double, with libm.
static Interval exact_interval(f64 c, f64 depth, f64 r, f64 scale) {
    if (depth + r <= NEAR_M) return (Interval){0};
    f64 distance = hypot(c, depth), half = (depth - NEAR_M) * (depth - NEAR_M);
    f64 cut = r * r > half ? sqrt(r * r - half) : 0.0;
    f64 ends[2] = {(c - cut) / NEAR_M, (c + cut) / NEAR_M};
    if (distance > r) {
        f64 middle = atan2(c, depth), open = asin(r / distance);
        f64 reach = sqrt(distance * distance - r * r); // eye to the touching point
        for (u32 side = 0; side < 2; side++) {
            f64 angle = middle + (side ? open : -open);
            if (reach * cos(angle) >= NEAR_M) ends[side] = tan(angle);
        }
    }
    ends[0] *= scale, ends[1] *= scale;
    if (ends[0] > 1.0 || ends[1] < -1.0) return (Interval){0};
    return (Interval){MAX(ends[0], -1.0), MIN(ends[1], 1.0), true};
}

TEST(systems_light_grid, sphere_bounds_contain_all_samples_and_are_tight) {
    const u64 seed = 0x11647;
    printf("seed %llx\n", (unsigned long long)seed);
    const f64 half_px = 640.0;
    u32 visible = 0, crossing = 0, inside = 0;
    for (u32 i = 0; i < 1000000; i++) {
        // One light in eight is at the eye or the near plane, or exactly on an axis.
        f32 r = random_range(seed, 1, i, 0.05f, 3), z = random_range(seed, 2, i, -30, 3);
        f32 c = random_range(seed, 3, i, -20, 20), scale = random_range(seed, 4, i, 0.5f, 3);
        if (i % 8 == 0) {
            z = random_range(seed, 2, i, -2, 1);
            c = random_range(seed, 3, i, -2, 2);
            if (i % 32 == 0) z = 0;
            if (i % 64 == 8) c = 0;
        }
        f32 low = 0, high = 0;
        bool any = sphere_bounds_axis(c, z, r, NEAR_M, scale, &low, &high);
        Interval exact = exact_interval(c, -(f64)z, r, scale);
        if (exact.any) {
            assert_true(any);
            assert_true(low <= exact.low && high >= exact.high);
            f64 extra_px = MAX(exact.low - low, high - exact.high) * half_px;
            if (!(extra_px <= 1.0)) fail_msg("light %u is %g px too large", i, extra_px);
        } else if (any) { // only at the very edge of the picture
            assert_true((low >= 1.0 - 1.0 / half_px) || (high <= -1.0 + 1.0 / half_px));
        }
        visible += any;
        crossing += any && z + r > -NEAR_M && z - r < -NEAR_M;
        inside += c * c + z * z < r * r;
        // Samples of the surface, in the plane of the axis and outside of it.
        for (u32 k = 0; k < 4; k++) {
            u64 s = (u64)i * 4 + k;
            f64 y = random_range(seed, 5, s, -1, 1),
                angle = random_range(seed, 6, s, 0, 6.2831853f);
            if (k < 2) y = 0;
            f64 ring = sqrt(1 - y * y);
            f64 x = c + r * ring * cos(angle), depth = -(f64)z + r * ring * sin(angle);
            if (depth < NEAR_M) continue;
            f64 ndc = scale * x / depth;
            if (ndc < -1 || ndc > 1) continue;
            assert_true(any);
            if (!(ndc >= low && ndc <= high)) fail_msg("light %u: sample %g outside", i, ndc);
        }
    }
    assert_true(visible > 200000 && crossing > 10000 && inside > 10000);
}

// ---- the grid ----

typedef struct GridCase {
    f32 *x, *y, *z, *radius;
    LightGridInput input;
} GridCase;

static GridCase make_case(u64 seed, u32 count, u32 width_px, u32 height_px, f32 radius_max) {
    GridCase c = {calloc(count + 8, 4),
                  calloc(count + 8, 4),
                  calloc(count + 8, 4),
                  calloc(count + 8, 4),
                  {0}};
    for (u32 i = 0; i < count; i++) {
        c.z[i] = random_range(seed, 1, i, -25, 1);
        c.x[i] = random_range(seed, 2, i, -1.3f, 1.3f) * -c.z[i];
        c.y[i] = random_range(seed, 3, i, -0.8f, 0.8f) * -c.z[i];
        c.radius[i] = random_range(seed, 4, i, 0.05f, radius_max);
    }
    f32 scale_y = 1.7f;
    c.input = (LightGridInput){.x = c.x,
                               .y = c.y,
                               .z = c.z,
                               .radius = c.radius,
                               .count = count,
                               .point_count = count * 2 / 3,
                               .width_px = width_px,
                               .height_px = height_px,
                               .tile_px = 16,
                               .near = NEAR_M,
                               .scale_x = scale_y * (f32)height_px / (f32)width_px,
                               .scale_y = scale_y};
    return c;
}

static void free_case(GridCase *c) { free(c->x), free(c->y), free(c->z), free(c->radius); }

// How far the light's rectangle reaches over the border of a tile, in pixels; negative = outside.
static f64 overlap_px(Interval i, f64 side_px, u32 tile, u32 tile_px, bool flip) {
    f64 low = flip ? -i.high : i.low, high = flip ? -i.low : i.high;
    f64 from = (low * 0.5 + 0.5) * side_px, to = (high * 0.5 + 0.5) * side_px;
    f64 begin = tile * (f64)tile_px, end = MIN(begin + tile_px, side_px);
    return MIN(to - begin, end - from);
}

TEST(systems_light_grid, lists_equal_asking_every_tile) {
    const u64 seed = 0x6417;
    printf("seed %llx\n", (unsigned long long)seed);
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    const u32 sizes[][2] = {{640, 360}, {333, 217}, {16, 16}, {1, 1}, {15, 700}};
    for (u32 round = 0; round < COUNT_OF(sizes); round++) {
        GridCase c = make_case(seed + round, 150, sizes[round][0], sizes[round][1], 4);
        LightGrid grid = light_grid_build(&c.input, &arenas.scratch);
        assert_int_equal(grid.tiles_x, (sizes[round][0] + 15) / 16);
        assert_int_equal(grid.tiles_y, (sizes[round][1] + 15) / 16);
        u32 cursor = 0, longest = 0;
        for (u32 t = 0; t < grid.tiles_x * grid.tiles_y; t++) {
            const u32 *list = grid.cells[t].list;
            assert_int_equal(list[0], cursor);
            cursor += list[1] + list[2];
            longest = MAX(longest, list[1] + list[2]);
            u32 next = 0;
            for (u32 i = 0; i < c.input.count; i++) {
                bool listed = next < list[1] + list[2] && grid.indices[list[0] + next] == i;
                if (listed) assert_int_equal(next < list[1], i < c.input.point_count);
                next += listed;
                Interval h = exact_interval(c.x[i], -(f64)c.z[i], c.radius[i], c.input.scale_x);
                Interval v = exact_interval(c.y[i], -(f64)c.z[i], c.radius[i], c.input.scale_y);
                f64 overlap = -1;
                if (h.any && v.any)
                    overlap = MIN(overlap_px(h, sizes[round][0], t % grid.tiles_x, 16, false),
                                  overlap_px(v, sizes[round][1], t / grid.tiles_x, 16, true));
                if (overlap > 0) assert_true(listed);
                if (overlap < -0.01) assert_false(listed);
            }
            assert_int_equal(next, list[1] + list[2]); // ascending, nothing else
        }
        assert_int_equal(cursor, grid.index_count);
        assert_int_equal(longest, grid.longest);
        arena_reset(&arenas.scratch);
        free_case(&c);
    }
    arenas_destroy(&arenas);
}

TEST(systems_light_grid, no_lights_give_empty_lists) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    LightGridInput input = {.width_px = 100,
                            .height_px = 50,
                            .tile_px = 16,
                            .near = NEAR_M,
                            .scale_x = 1,
                            .scale_y = 1};
    LightGrid grid = light_grid_build(&input, &arenas.scratch);
    assert_int_equal(grid.index_count, 0);
    assert_int_equal(grid.tiles_x * grid.tiles_y, 28);
    arenas_destroy(&arenas);
}

// Lists that would not fit into memory: full tiles share the list of all lights, others keep
// theirs.
TEST(systems_light_grid, too_long_lists_share_one) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    enum { COUNT = 8000 };
    GridCase c = make_case(0x5A4E, COUNT, 1280, 720, 1);
    // Most lights surround the eye; a few are small and far.
    for (u32 i = 0; i < COUNT; i++) {
        if (i % 100 == 0) continue;
        c.x[i] = c.y[i] = c.z[i] = 0;
        c.radius[i] = i % 5 < 2 ? 50 : 0.11f; // in view everywhere, or in the middle only
    }
    c.input.highlight_points = c.input.point_count / 2;
    LightGrid grid = light_grid_build(&c.input, &arenas.scratch);
    assert_true(grid.index_count <= 1u << 24);
    assert_int_equal(grid.longest, COUNT);
    u32 shared = 0, own = 0;
    for (u32 t = 0; t < grid.tiles_x * grid.tiles_y; t++) {
        const u32 *list = grid.cells[t].list;
        bool all = list[1] == c.input.point_count && list[1] + list[2] == COUNT;
        if (all && list[0] == 0)
            shared++;
        else
            own++;
        u32 diffuse = 0;
        for (u32 i = 0; i < list[1]; i++)
            diffuse += grid.indices[list[0] + i] >= c.input.highlight_points;
        assert_int_equal(list[3] & 0xFFFF, diffuse);
        assert_int_equal(list[3] >> 16, list[2]);
        bool ascending = true;
        for (u32 i = 1; i < list[1] + list[2]; i++)
            ascending &= grid.indices[list[0] + i] > grid.indices[list[0] + i - 1];
        assert_true(ascending);
        // The large lights are in every list.
        assert_true(list[1] + list[2] >= COUNT * 2 / 5 - COUNT / 100);
    }
    assert_true(shared > 0 && own > 0);
    assert_int_equal(grid.fallbacks, shared);
    printf("%u tiles share, %u have their own\n", shared, own);
    free_case(&c);
    arenas_destroy(&arenas);
}

// ---- points of lights ----

static const struct {
    u32 width_px, height_px;
} picture_sizes[] = {{640, 360}, {333, 217}, {61, 700}};

// A point that a light reaches is in a tile whose list has the light, for every way to make lists.
TEST(systems_light_grid, no_point_of_a_light_is_missed) {
    const u64 seed = 0x90147;
    printf("seed %llx\n", (unsigned long long)seed);
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    u32 seen = 0, spots_seen = 0;
    for (u32 round = 0; round < 48; round++) {
        u32 size = round % COUNT_OF(picture_sizes);
        LightTwin *twin = light_twin_create(
            seed + round, 120, picture_sizes[size].width_px, picture_sizes[size].height_px,
            round % 5 ? 0.1f : 0.001f, 30.0f, round % 2 ? 2.0f : 8.0f);
        RenderSettings settings = settings_default();
        settings.tile_px = round % TILE_SIZE_COUNT;
        LightGridInput input =
            light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, &arenas.scratch);
        input.method = round / 2 % 2 ? GRID_RECT : GRID_FRUSTUM;
        LightGrid grid = light_grid_build(&input, &arenas.scratch);
        const u32 cells[4] = {grid.tiles_x, grid.tiles_y, 1, input.tile_px};
        memcpy(twin->frame.grid, cells, sizeof cells);
        for (u32 draw = 0; draw < 60000; draw++) {
            u32 light = draw % twin->count;
            f64 world[3];
            twin_point_in_light(twin, light, seed + round, draw, world);
            TwinPoint point = twin_point(&twin->frame, world);
            if (!point.visible || !twin_light_reaches(twin, light, world)) continue;
            const u32 *list = grid.cells[twin_cell(&twin->frame, &point)].list;
            bool listed = false;
            for (u32 i = 0; i < list[1] + list[2]; i++)
                listed |= grid.indices[list[0] + i] == light;
            if (!listed)
                fail_msg("round %u: light %u is missing at %g, %g px", round, light, point.x_px,
                         point.y_px);
            seen++;
            spots_seen += light >= input.point_count;
        }
        arena_reset(&arenas.scratch);
        light_twin_destroy(twin);
    }
    printf("%u points, %u of them in cones\n", seen, spots_seen);
    assert_true(seen > 500000 && spots_seen > 100000);
    arenas_destroy(&arenas);
}

// Ascending lists, classes counted, tiles' frustums within rectangles.
TEST(systems_light_grid, rows_are_parts_of_rectangles) {
    const u64 seed = 0x20E5;
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    for (u32 round = 0; round < 8; round++) {
        LightTwin *twin =
            light_twin_create(seed + round, 300, 640, 360, 0.1f, 30.0f, round % 2 ? 2.0f : 8.0f);
        RenderSettings settings = settings_default();
        settings.tile_px = round % TILE_SIZE_COUNT;
        LightGridInput input =
            light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, &arenas.scratch);
        input.method = GRID_RECT;
        LightGrid rect = light_grid_build(&input, &arenas.scratch);
        input.method = GRID_FRUSTUM;
        LightGrid rows = light_grid_build(&input, &arenas.scratch);
        assert_int_equal(rows.cell_count, rect.cell_count);
        for (u32 t = 0; t < rows.cell_count; t++) {
            const u32 *inner = rows.cells[t].list, *outer = rect.cells[t].list;
            u32 at = 0, diffuse[2] = {0, 0};
            for (u32 i = 0; i < inner[1] + inner[2]; i++) {
                u32 light = rows.indices[inner[0] + i];
                assert_int_equal(i < inner[1], light < input.point_count);
                while (at < outer[1] + outer[2] && rect.indices[outer[0] + at] < light) at++;
                assert_true(at < outer[1] + outer[2] && rect.indices[outer[0] + at] == light);
                if (light < input.point_count)
                    diffuse[0] += light >= input.highlight_points;
                else
                    diffuse[1] += light - input.point_count >= input.highlight_spots;
            }
            assert_int_equal(inner[3], diffuse[0] | diffuse[1] << 16);
        }
        printf("tiles of %u px: %u entries by rectangles, %u by rows\n", input.tile_px,
               rect.index_count, rows.index_count);
        assert_true(rows.index_count < rect.index_count);
        arena_reset(&arenas.scratch);
        light_twin_destroy(twin);
    }
    arenas_destroy(&arenas);
}

TEST(systems_light_grid, threads_do_not_matter) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    LightTwin *twin = light_twin_create(0x7EAD, 3000, 1280, 720, 0.1f, 30.0f, 4.0f);
    RenderSettings settings = settings_default();
    for (u32 method = 0; method < 3; method++) {
        LightGrid grids[2];
        for (u32 threads = 0; threads < 2; threads++) {
            jobs_start(threads ? 4 : 1);
            settings.tile_px = method == 2 ? TILE_32 : TILE_16;
            LightGridInput input = light_grid_input(&twin->frame, twin->lights, twin->spots,
                                                    &settings, &arenas.scratch);
            input.method = method == 1 ? GRID_FRUSTUM : GRID_RECT;
            if (method == 2) input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
            grids[threads] = light_grid_build(&input, &arenas.scratch);
            jobs_stop();
        }
        assert_int_equal(grids[0].index_count, grids[1].index_count);
        assert_memory_equal(grids[0].cells, grids[1].cells,
                            grids[0].cell_count * sizeof(CellRecord));
        assert_memory_equal(grids[0].indices, grids[1].indices, grids[0].index_count * sizeof(u32));
        arena_reset(&arenas.scratch);
    }
    light_twin_destroy(twin);
    arenas_destroy(&arenas);
}

// ---- filling ----

// The list of a cell, by asking every box of every light.
static u32 naive_list(const LightGridPlan *plan, u32 cell, u32 *list) {
    u32 row = cell / plan->tiles_x, x = cell % plan->tiles_x, count = 0;
    for (u32 i = 0; i < plan->input.count; i++)
        for (u32 b = plan->box_first[i]; b < plan->box_first[i + 1]; b++) {
            const CellBox *box = &plan->boxes[b];
            if (row >= box->row && row < box->row + box->rows && x >= box->x0 && x <= box->x1)
                list[count++] = i;
        }
    return count;
}

// One index at a time or eight at once: the same lists, and nothing is written beyond them.
TEST(systems_light_grid, lists_by_one_and_by_eight_equal_asking_every_box) {
    enum { MARK = 0xFEEDBEEF };
    const u64 seed = 0xF111;
    printf("seed %llx\n", (unsigned long long)seed);
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    // Numbers of lights around the words of bits; pictures of one block of columns, and of more.
    const u32 counts[] = {1, 63, 64, 65, 192, 256, 300};
    const u32 sizes[][2] = {{320, 180}, {61, 90}, {2570, 40}};
    u64 entries = 0;
    for (u32 round = 0; round < COUNT_OF(counts) * COUNT_OF(sizes); round++) {
        const u32 *size = sizes[round % COUNT_OF(sizes)], count = counts[round % COUNT_OF(counts)];
        LightTwin *twin = light_twin_create(seed + round, count, size[0], size[1], 0.1f, 20.0f,
                                            round % 2 ? 6.0f : 1.0f);
        RenderSettings settings = settings_default();
        settings.tile_px = TILE_8;
        LightGridInput input =
            light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, &arenas.scratch);
        input.method = round % 2 ? GRID_RECT : GRID_FRUSTUM;
        if (round % 3 == 1) input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
        u32 *list = calloc(input.count + 1, sizeof *list);
        for (GridFill fill = GRID_FILL_AUTO; fill <= GRID_FILL_BY_EIGHT; fill++) {
            input.fill = fill;
            LightGridPlan plan = light_grid_plan(&input, &arenas.scratch);
            CellRecord *cells = calloc(plan.cell_count, sizeof *cells);
            u32 *indices = calloc(plan.index_count + 1, sizeof *indices), cursor = 0;
            indices[plan.index_count] = MARK;
            light_grid_fill(&plan, cells, indices);
            assert_int_equal(indices[plan.index_count], MARK);
            for (u32 cell = 0; cell < plan.cell_count; cell++) {
                u32 length = naive_list(&plan, cell, list), classes[4] = {0};
                for (u32 k = 0; k < length; k++) {
                    bool spot = list[k] >= input.point_count;
                    bool diffuse = spot ? list[k] - input.point_count >= input.highlight_spots
                                        : list[k] >= input.highlight_points;
                    classes[spot * 2 + diffuse]++;
                }
                assert_int_equal(cells[cell].list[0], cursor);
                assert_int_equal(cells[cell].list[1], classes[0] + classes[1]);
                assert_int_equal(cells[cell].list[2], classes[2] + classes[3]);
                assert_int_equal(cells[cell].list[3], classes[1] | classes[3] << 16);
                if (length) assert_memory_equal(indices + cursor, list, length * sizeof *list);
                cursor += length;
            }
            assert_int_equal(cursor, plan.index_count);
            entries += cursor;
            free(indices), free(cells);
        }
        free(list);
        arena_reset(&arenas.scratch);
        light_twin_destroy(twin);
    }
    printf("%llu entries\n", (unsigned long long)entries);
    assert_true(entries > 100000);
    arenas_destroy(&arenas);
}

// ---- needless lights ----

// A hall of columns, seen from one end: what a ray from the eye meets. View space; 0 = the open
// end, far away.
static f32 hall_depth(f64 x, f64 y) {
    f64 nearest = 1e9;
    const f64 half = 3, ceiling = 2.5, floor_y = -1.6;
    if (x != 0) nearest = MIN(nearest, half / fabs(x));
    if (y != 0) nearest = MIN(nearest, y > 0 ? ceiling / y : floor_y / y);
    for (u32 row = 0; row < 10; row++) {
        for (i32 side = -1; side <= 1; side += 2) {
            // A column of radius 0.35 stands upright: a circle in the plane of x and depth.
            f64 cx = side * 1.7, cz = 4 + 3.5 * row, a = x * x + 1, b = cx * x + cz;
            f64 c = cx * cx + cz * cz - 0.35 * 0.35, root = b * b - a * c;
            if (root > 0) nearest = MIN(nearest, (b - sqrt(root)) / a);
        }
    }
    return nearest > 60 ? 0 : (f32)nearest;
}

typedef struct Needless {
    const char *name;
    u64 tile_lights, tile_needless;   // pairs of a tile and a light of its list
    u64 pixel_lights, pixel_needless; // of a pixel and a light that it is shaded with
} Needless;

// Shares of lights in lists that light nothing: of a tile's lights those that reach none of its
// pixels, of a pixel's those that do not reach it.
TEST(systems_light_grid, finer_lists_have_fewer_needless_lights) {
    enum { WIDTH = 320, HEIGHT = 180, LIGHTS = 400, TILE = 16, METHODS = 5 };
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    LightTwin *twin = light_twin_create(0x9A11, LIGHTS, WIDTH, HEIGHT, 0.1f, 40.0f, 1.0f);
    FrameRecord *frame = &twin->frame;
    // Into the hall, and some behind its walls.
    for (u32 i = 0; i < LIGHTS; i++) {
        f64 at[3] = {random_range(7, 1, i, -5, 5), random_range(7, 2, i, -2, 3),
                     random_range(7, 3, i, 0, 42)};
        f32 range = random_range(7, 4, i, 0.8f, 3.0f);
        f64 tan_x = sqrt(frame->ray_right[0] * frame->ray_right[0] +
                         frame->ray_right[1] * frame->ray_right[1] +
                         frame->ray_right[2] * frame->ray_right[2]);
        f64 tan_y = tan_x * HEIGHT / WIDTH;
        for (u32 a = 0; a < 3; a++)
            twin->lights[i].position[a] =
                (f32)(frame->camera[a] + at[0] * frame->ray_right[a] / tan_x +
                      at[1] * frame->ray_up[a] / tan_y + at[2] * frame->ray_forward[a]);
        twin->lights[i].position[3] = 1 / (range * range);
    }
    RenderSettings settings = settings_default();
    settings.tile_px = TILE_16;
    LightGridInput input =
        light_grid_input(frame, twin->lights, twin->spots, &settings, &arenas.scratch);
    input.method = GRID_RECT;
    LightGrid rect = light_grid_build(&input, &arenas.scratch);
    input.method = GRID_FRUSTUM;
    LightGrid rows = light_grid_build(&input, &arenas.scratch);
    input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
    LightGrid clusters = light_grid_build(&input, &arenas.scratch);
    const u32 cells[4] = {clusters.tiles_x, clusters.tiles_y, clusters.slices, TILE};
    memcpy(frame->grid, cells, sizeof cells);
    frame->slices[0] = input.slices.scale;
    frame->slices[1] = input.slices.offset;

    f32 *depths = calloc(WIDTH * HEIGHT, sizeof *depths);
    for (u32 p = 0; p < WIDTH * HEIGHT; p++) {
        f64 x = ((p % WIDTH + 0.5) / WIDTH * 2 - 1) / input.scale_x;
        depths[p] = hall_depth(x, (1 - (p / WIDTH + 0.5) / HEIGHT * 2) / input.scale_y);
    }
    Needless needless[METHODS] = {{"rectangle"},
                                  {"frustum"},
                                  {"frustum, min and max depth"},
                                  {"frustum, 32 slices of depth"},
                                  {"clusters"}};
    for (u32 t = 0; t < rect.cell_count; t++) {
        u32 tile_x = t % rect.tiles_x, tile_y = t / rect.tiles_x;
        TileDepthRecord seen = twin_tile_depth(depths, WIDTH, HEIGHT, TILE, tile_x, tile_y);
        bool in[METHODS][LIGHTS] = {{false}}, reaches[LIGHTS] = {false};
        const LightGrid *grids[2] = {&rect, &rows};
        for (u32 m = 0; m < 2; m++) {
            const u32 *list = grids[m]->cells[t].list;
            for (u32 i = 0; i < list[1] + list[2]; i++)
                in[m][grids[m]->indices[list[0] + i]] = true;
        }
        for (u32 i = 0; i < LIGHTS; i++) {
            f32 front = -input.z[i] - input.radius[i], back = -input.z[i] + input.radius[i];
            in[2][i] = in[1][i] && twin_depth_touches(&seen, front, back, false);
            in[3][i] = in[1][i] && twin_depth_touches(&seen, front, back, true);
        }
        for (u32 k = 0; k < TILE * TILE; k++) {
            u32 x = tile_x * TILE + k % TILE, y = tile_y * TILE + k / TILE;
            if (x >= WIDTH || y >= HEIGHT || depths[y * WIDTH + x] == 0) continue;
            TwinPoint point = twin_unproject(frame, x + 0.5, y + 0.5, depths[y * WIDTH + x]);
            bool in_cluster[LIGHTS] = {false};
            const u32 *list = clusters.cells[twin_cell(frame, &point)].list;
            for (u32 i = 0; i < list[1] + list[2]; i++)
                in_cluster[clusters.indices[list[0] + i]] = true;
            for (u32 i = 0; i < LIGHTS; i++) {
                bool lit = twin_light_reaches(twin, i, point.world);
                reaches[i] |= lit;
                in[4][i] |= in_cluster[i];
                for (u32 m = 0; m < METHODS; m++) {
                    bool listed = m < 4 ? in[m][i] : in_cluster[i];
                    assert_true(listed || !lit);
                    needless[m].pixel_lights += listed;
                    needless[m].pixel_needless += listed && !lit;
                }
            }
        }
        for (u32 m = 0; m < METHODS; m++) {
            for (u32 i = 0; i < LIGHTS; i++) {
                needless[m].tile_lights += in[m][i];
                needless[m].tile_needless += in[m][i] && !reaches[i];
            }
        }
    }
    f64 last = 1, last_tile = 1;
    for (u32 m = 0; m < METHODS; m++) {
        f64 tile = (f64)needless[m].tile_needless / (f64)needless[m].tile_lights,
            pixel = (f64)needless[m].pixel_needless / (f64)needless[m].pixel_lights;
        printf("%-28s %6.1f lights a tile, %4.1f %% needless; %6.1f a pixel, %4.1f %% needless\n",
               needless[m].name, (f64)needless[m].tile_lights / rect.cell_count, tile * 100,
               (f64)needless[m].pixel_lights / (WIDTH * HEIGHT), pixel * 100);
        assert_true(pixel < last && (m == 4 || tile < last_tile));
        last = pixel, last_tile = tile;
    }
    free(depths);
    light_twin_destroy(twin);
    arenas_destroy(&arenas);
}
