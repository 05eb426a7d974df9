// systems_hierarchy.c: the tree over many lights: shape, boxes, order, and what a walk finds
// against asking every light.
#include "light_twin.h"
#include "../test.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/light_hierarchy.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static u32 bits_of(f32 x) {
    u32 bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

// Checks a tree from its root; returns how many nodes it has.
static u32 check_tree(const LightHierarchy *tree, u32 node, u32 begin, u32 end, u8 *seen) {
    const GridNode *n = &tree->nodes[node];
    u32 first = bits_of(n->low[3]), bits = bits_of(n->high[3]), count = bits & 0x7FFFFFFFu;
    assert_true(count >= 1 && count <= GRID_NODE_WIDTH);
    if (bits >> 31) {
        for (u32 i = first; i < first + count; i++) {
            assert_true(i >= begin && i < end);
            seen[i]++;
        }
        return 1;
    }
    u32 nodes = 1;
    for (u32 child = first; child < first + count; child++) {
        assert_true(child > node && child < tree->node_count);
        for (u32 a = 0; a < 3; a++) {
            assert_true(tree->nodes[child].low[a] >= n->low[a]);
            assert_true(tree->nodes[child].high[a] <= n->high[a]);
        }
        nodes += check_tree(tree, child, begin, end, seen);
    }
    return nodes;
}

static LightGridInput twin_input(const LightTwin *twin, Arena *arena) {
    RenderSettings settings = settings_default();
    return light_grid_input(&twin->frame, twin->lights, twin->spots, &settings, arena);
}

TEST(systems_hierarchy, every_light_is_a_leaf_once) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    const u32 counts[] = {0, 1, 2, 3, 8, 9, 12, 64, 65, 96, 97, 1000, 1537, 5000};
    for (u32 round = 0; round < COUNT_OF(counts) * 2; round++) {
        LightTwin *twin =
            light_twin_create(0x7EE + round, counts[round / 2], 640, 360, 0.1f, 30, 3);
        LightGridInput input = twin_input(twin, &arenas.scratch);
        if (round % 2) { // all of one kind
            input.point_count = round % 4 == 1 ? 0 : input.count;
            input.cones.tip_x = NULL;
        }
        LightHierarchy tree = light_hierarchy_build(&input, &arenas.scratch);
        u32 points = input.point_count, spots = input.count - points, nodes = 0;
        u8 *seen = calloc(input.count + 1, 1), *named = calloc(input.count + 1, 1);
        if (points) nodes += check_tree(&tree, 0, 0, points, seen);
        assert_int_equal(tree.spots_root, spots ? nodes : 0);
        if (spots) nodes += check_tree(&tree, tree.spots_root, points, input.count, seen);
        assert_int_equal(nodes, tree.node_count);
        for (u32 i = 0; i < input.count; i++) {
            assert_int_equal(seen[i], 1);
            assert_int_equal(tree.order[i] < points, i < points);
            named[tree.order[i]]++;
        }
        for (u32 i = 0; i < input.count; i++) assert_int_equal(named[i], 1);
        free(seen);
        free(named);
        light_twin_destroy(twin);
        arena_reset(&arenas.scratch);
    }
    arenas_destroy(&arenas);
}

// Boxes hold all of their lights' points; a walk finds a light wherever one of its points is.
TEST(systems_hierarchy, a_walk_finds_what_asking_every_light_finds) {
    const u64 seed = 0x3A1C;
    printf("seed %llx\n", (unsigned long long)seed);
    enum { LIGHTS = 3000 };
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    LightTwin *twin = light_twin_create(seed, LIGHTS, 640, 360, 0.1f, 60, 3);
    LightGridInput input = twin_input(twin, &arenas.scratch);
    LightHierarchy tree = light_hierarchy_build(&input, &arenas.scratch);
    u32 *found = calloc(LIGHTS, sizeof *found);
    u64 boxes_found = 0, touching = 0;
    for (u32 round = 0; round < 400; round++) {
        bool spots = round % 3 == 2;
        u32 begin = spots ? input.point_count : 0, end = spots ? input.count : input.point_count;
        f32 low[3], high[3];
        for (u32 a = 0; a < 3; a++) {
            low[a] = random_range(seed, 40 + a, round, -30, 30) - (a == 2 ? 30 : 0);
            high[a] = low[a] + random_range(seed, 43 + a, round, 0.01f, 4);
        }
        u32 count = light_hierarchy_find(&tree, spots, low, high, found);
        bool listed[LIGHTS] = {false};
        for (u32 i = 0; i < count; i++) {
            assert_true(i == 0 || found[i] > found[i - 1]);
            assert_true(found[i] >= begin && found[i] < end);
            listed[tree.order[found[i]]] = true;
        }
        boxes_found += count;
        for (u32 i = begin; i < end; i++) {
            f64 distance2 = 0;
            const f32 at[3] = {input.x[i], input.y[i], input.z[i]};
            for (u32 a = 0; a < 3; a++) {
                f64 off = MAX(MAX((f64)low[a] - at[a], (f64)at[a] - high[a]), 0);
                distance2 += off * off;
            }
            bool touches = distance2 < (f64)input.radius[i] * input.radius[i];
            // Whether a cone meets a box is asked at its points.
            if (spots && touches) {
                touches = false;
                for (u32 draw = 0; draw < 20 && !touches; draw++) {
                    f64 world[3];
                    twin_point_in_light(twin, i, seed, (u64)round * 20 + draw, world);
                    TwinPoint p = twin_point(&twin->frame, world);
                    touches = twin_light_reaches(twin, i, world) && p.x > low[0] && p.x < high[0] &&
                              p.y > low[1] && p.y < high[1] && -p.depth > low[2] &&
                              -p.depth < high[2];
                }
            }
            touching += touches;
            if (touches && !listed[i]) fail_msg("box %u: light %u is missing", round, i);
        }
    }
    printf("a box finds %.1f lights, %.1f touch it\n", (f64)boxes_found / 400, (f64)touching / 400);
    assert_true(boxes_found < 400ull * LIGHTS / 20);
    free(found);
    light_twin_destroy(twin);
    arenas_destroy(&arenas);
}

TEST(systems_hierarchy, threads_do_not_matter) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    LightTwin *twin = light_twin_create(0x71, 20000, 640, 360, 0.1f, 60, 3);
    LightHierarchy trees[2];
    for (u32 threads = 0; threads < 2; threads++) {
        jobs_start(threads ? 4 : 1);
        LightGridInput input = twin_input(twin, &arenas.scratch);
        trees[threads] = light_hierarchy_build(&input, &arenas.scratch);
        jobs_stop();
    }
    assert_memory_equal(trees[0].nodes, trees[1].nodes, trees[0].node_count * sizeof(GridNode));
    assert_memory_equal(trees[0].order, trees[1].order, trees[0].light_count * sizeof(u32));
    light_twin_destroy(twin);
    arenas_destroy(&arenas);
}

// Lights in one place, in a line, or at infinity do not break the order.
TEST(systems_hierarchy, degenerate_places_are_sorted_too) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    enum { COUNT = 100 };
    f32 zero[COUNT] = {0}, line[COUNT], far[COUNT], radius[COUNT];
    for (u32 i = 0; i < COUNT; i++)
        line[i] = (f32)i, far[i] = i % 2 ? 3e38f : -3e38f, radius[i] = 1;
    const f32 *columns[] = {zero, line, far};
    for (u32 c = 0; c < COUNT_OF(columns); c++) {
        LightGridInput input = {.x = columns[c],
                                .y = zero,
                                .z = columns[c],
                                .radius = radius,
                                .count = COUNT,
                                .point_count = COUNT};
        LightHierarchy tree = light_hierarchy_build(&input, &arenas.scratch);
        u8 seen[COUNT] = {0};
        assert_int_equal(check_tree(&tree, 0, 0, COUNT, seen), tree.node_count);
        for (u32 i = 0; i < COUNT && c < 2; i++) assert_int_equal(tree.order[i], i); // stable
    }
    arenas_destroy(&arenas);
}
