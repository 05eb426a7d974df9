// systems_light_grid.c: screen bounds of spheres against samples and against trigonometry; tile
// lists against asking every tile about every light.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
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
    c.input = (LightGridInput){c.x,
                               c.y,
                               c.z,
                               c.radius,
                               count,
                               count * 2 / 3,
                               width_px,
                               height_px,
                               16,
                               NEAR_M,
                               scale_y * (f32)height_px / (f32)width_px,
                               scale_y};
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
    LightGrid grid = light_grid_build(&c.input, &arenas.scratch);
    assert_true(grid.index_count <= 1u << 24);
    u32 shared = 0, own = 0;
    for (u32 t = 0; t < grid.tiles_x * grid.tiles_y; t++) {
        const u32 *list = grid.cells[t].list;
        bool all = list[1] == c.input.point_count && list[1] + list[2] == COUNT;
        if (all && list[0] == 0)
            shared++;
        else
            own++;
        bool ascending = true;
        for (u32 i = 1; i < list[1] + list[2]; i++)
            ascending &= grid.indices[list[0] + i] > grid.indices[list[0] + i - 1];
        assert_true(ascending);
        // The large lights are in every list.
        assert_true(list[1] + list[2] >= COUNT * 2 / 5 - COUNT / 100);
    }
    assert_true(shared > 0 && own > 0);
    printf("%u tiles share, %u have their own\n", shared, own);
    free_case(&c);
    arenas_destroy(&arenas);
}
