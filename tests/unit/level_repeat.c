// level_repeat.c: repetition maths and values that vary.
#include "level_common.h"
#include <stdio.h>

static void expect_place(const TestLevel *level, const char *name, f64 x, f64 y, f64 z, f64 yaw) {
    const TransformTable *t = WORLD_TABLE(level->world, Transform, transform);
    u32 row = test_level_row(level, COMPONENT_transform, name);
    ASSERT_NEAR(t->x[row], x, 1e-5);
    ASSERT_NEAR(t->y[row], y, 1e-5);
    ASSERT_NEAR(t->z[row], z, 1e-5);
    ASSERT_NEAR(t->yaw[row], yaw, 1e-4);
}

TEST(level_repeat, rows_and_grids_step) {
    TestLevel level;
    test_level_load_good(&level, "[[entity]]\nname = \"r\"\ntransform.position = [1, 2, 3]\n"
                                 "repeat.row = { count = 3, step = [0, 0, -2] }\n"
                                 "[[entity]]\nname = \"g\"\n"
                                 "repeat.grid = { count = [2, 3, 2], step = [1, 10, 100] }\n");
    assert_int_equal(WORLD_TABLE(level.world, Transform, transform)->table.count, 3 + 12);
    expect_place(&level, "r", 1, 2, 3, 0);
    expect_place(&level, "r.2", 1, 2, -1, 0);
    expect_place(&level, "g", 0, 0, 0, 0);
    expect_place(&level, "g.1", 1, 0, 0, 0);
    expect_place(&level, "g.2", 0, 10, 0, 0);
    expect_place(&level, "g.11", 1, 20, 100, 0);
    test_level_close(&level);
}

TEST(level_repeat, rings_turn_their_copies) {
    TestLevel level;
    test_level_load_good(&level,
                         "[[entity]]\nname = \"a\"\ntransform.position = [0, 1, 0]\n"
                         "transform.rotation = [0, 10, 0]\n"
                         "repeat.ring = { count = 4, radius = 2 }\n"
                         "[[entity]]\nname = \"b\"\n"
                         "repeat.ring = { count = 4, radius = 2, start = 45, face = false }\n"
                         "[[entity]]\nname = \"z\"\n"
                         "repeat.ring = { count = 4, radius = 2, axis = \"z\" }\n"
                         "[[entity]]\nname = \"x\"\ntransform.rotation = [0, 0, 30]\n"
                         "repeat.ring = { count = 2, radius = 1, axis = \"x\" }\n");
    expect_place(&level, "a", 2, 1, 0, 10);
    expect_place(&level, "a.1", 0, 1, -2, 100);
    expect_place(&level, "a.2", -2, 1, 0, 190);
    f64 d = 2 * 0.70710678;
    expect_place(&level, "b", d, 0, -d, 0);
    expect_place(&level, "z.1", 0, 2, 0, 0);
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    ASSERT_NEAR(t->roll[test_level_row(&level, COMPONENT_transform, "z.1")], 90, 1e-3);
    // Half a turn about x in front of a roll of 30 degrees: the rotation matrices must agree.
    u32 row = test_level_row(&level, COMPONENT_transform, "x.1");
    Mat34 got = mat34_from_trs(vec3(0, 0, 0), vec3(t->pitch[row], t->yaw[row], t->roll[row]),
                               vec3(1, 1, 1));
    Mat34 want = mat34_mul(mat34_from_trs(vec3(0, 0, 0), vec3(180, 0, 0), vec3(1, 1, 1)),
                           mat34_from_trs(vec3(0, 0, 0), vec3(0, 0, 30), vec3(1, 1, 1)));
    for (u32 i = 0; i < 12; i++) ASSERT_NEAR(got.m[i], want.m[i], 1e-5);
    ASSERT_NEAR(t->y[row], -1, 1e-5);
    test_level_close(&level);
}

TEST(level_repeat, a_list_is_a_product_with_the_first_outermost) {
    TestLevel level;
    test_level_load_good(
        &level, "[[entity]]\nname = \"a\"\nrepeat = [{ ring = { count = 2, radius = 10 } }, { "
                "row = { count = 3, step = [1, 0, 0] } }]\n"
                "[[entity]]\nname = \"b\"\nrepeat = [{ row = { count = 3, step = [1, 0, 0] } }, "
                "{ ring = { count = 2, radius = 10, face = false } }]\n");
    expect_place(&level, "a.2", 12, 0, 0, 0);
    expect_place(&level, "a.5", -12, 0, 0, 180); // the ring turns the row
    expect_place(&level, "b.1", -10, 0, 0, 0);
    expect_place(&level, "b.4", 12, 0, 0, 0);
    test_level_close(&level);
}

TEST(level_repeat, scatter_fills_its_box_and_obeys_its_seed) {
    static const char text[] =
        "[[entity]]\nname = \"a\"\n"
        "repeat.scatter = { count = 500, min = [-1, 0, 2], max = [1, 0, 6] }\n"
        "[[entity]]\nname = \"b\"\n"
        "repeat.scatter = { count = 9, seed = 3, min = [0, 0, 0], max = [1, 1, 1] }\n"
        "[[entity]]\nname = \"c\"\n"
        "repeat.scatter = { count = 9, seed = 3, min = [0, 0, 0], max = [1, 1, 1] }\n"
        "[[entity]]\nname = \"d\"\n"
        "repeat.scatter = { count = 9, min = [0, 0, 0], max = [1, 1, 1] }\n";
    TestLevel level;
    test_level_load_good(&level, text);
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    f64 sum_x = 0, sum_z = 0;
    for (u32 i = 0; i < 500; i++) {
        assert_true(t->x[i] >= -1 && t->x[i] <= 1 && t->z[i] >= 2 && t->z[i] <= 6);
        ASSERT_NEAR(t->y[i], 0, 0);
        sum_x += t->x[i];
        sum_z += t->z[i];
    }
    ASSERT_NEAR(sum_x / 500, 0, 0.1);
    ASSERT_NEAR(sum_z / 500, 4, 0.2);
    for (u32 i = 0; i < 9; i++) {
        ASSERT_NEAR(t->x[500 + i], t->x[509 + i], 0);
        assert_true(t->x[500 + i] != t->x[518 + i]);
    }
    test_level_close(&level);
}

static const char varied[] = "[[entity]]\nname = \"v\"\nlight = {}\n"
                             "repeat.row = { count = 64, step = [1, 0, 0] }\n"
                             "vary.light.color = { choose = [\"#f00\", \"#0f0\", [0, 0, 1]] }\n"
                             "vary.light.range = { min = 2, max = 4 }\n"
                             "vary.transform.scale = { min = 1, max = 2 }\n"
                             "vary.transform.rotation = { min = [0, 0, 0], max = [0, 90, 45] }\n"
                             "vary.door.lock = { min = 3, max = 5 }\n"
                             "vary.light.kind = { choose = [\"spot\", \"point\"] }\n";

TEST(level_vary, values_stay_in_range_and_are_all_used) {
    TestLevel level;
    test_level_load_good(&level, varied);
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    const TransformTable *t = WORLD_TABLE(level.world, Transform, transform);
    const DoorTable *doors = test_level_doors(&level);
    u32 reds = 0, greens = 0, blues = 0, spots = 0, locks[8] = {0}, differ = 0;
    assert_int_equal(doors->table.count, 64); // the varied component is added
    for (u32 i = 0; i < 64; i++) {
        reds += l->color_r[i] == 1;
        greens += l->color_g[i] == 1;
        blues += l->color_b[i] == 1;
        spots += l->kind[i] == LIGHT_SPOT;
        assert_true(l->range[i] >= 2 && l->range[i] < 4);
        assert_true(t->scale_x[i] >= 1 && t->scale_x[i] < 2);
        ASSERT_NEAR(t->scale_x[i], t->scale_z[i], 0); // one draw for all
        ASSERT_NEAR(t->pitch[i], 0, 0);
        differ += t->yaw[i] != t->roll[i] * 2; // one draw each
        assert_in_range(doors->lock[i], 3, 5);
        locks[doors->lock[i]]++;
    }
    assert_int_equal(reds + greens + blues, 64);
    assert_true(reds > 5 && greens > 5 && blues > 5 && spots > 10 && spots < 54 && differ > 60);
    assert_true(locks[3] > 5 && locks[4] > 5 && locks[5] > 5);
    test_level_close(&level);
}

static void ranges(const char *before, const char *inside, const char *after, f32 out[64]) {
    static char text[4096];
    snprintf(text, sizeof text, "%s%s%s%s", before, varied, inside, after);
    TestLevel level;
    test_level_load_good(&level, text);
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    u32 first = test_level_row(&level, COMPONENT_light, "v");
    memcpy(out, l->range + first, 64 * sizeof(f32));
    test_level_close(&level);
}

TEST(level_vary, draws_depend_on_nothing_else) {
    f32 a[64], b[64];
    ranges("", "", "", a);
    ranges("", "", "", b);
    assert_memory_equal(a, b, sizeof a);
    // Other entities before and after, another varied key, another component: the same values.
    ranges("[[entity]]\nlight = {}\n[[entity]]\nname = \"w\"\nlight = {}\nvary.light.range = { min "
           "= 1, max "
           "= 9 }\n",
           "vary.light.intensity = { min = 1, max = 2 }\npulse = {}\n", "[[entity]]\n", b);
    assert_memory_equal(a, b, sizeof a);
    // Another seed: others.
    ranges("[level]\nseed = 99\n", "", "", b);
    assert_memory_not_equal(a, b, sizeof a);
}

TEST(level_vary, unnamed_entities_go_by_their_number_among_the_unnamed) {
    static const char tail[] = "[[entity]]\nvary.light.range = { min = 1, max = 9 }\n";
    char text[256];
    f32 first = 0;
    for (u32 i = 0; i < 3; i++) {
        snprintf(text, sizeof text, "%s%s",
                 i == 0   ? ""
                 : i == 1 ? "[[entity]]\nname = \"n\"\n"
                          : "[[entity]]\n",
                 tail);
        TestLevel level;
        test_level_load_good(&level, text);
        f32 range = WORLD_TABLE(level.world, Light, light)->range[0];
        if (i == 0) first = range;
        if (i == 1) ASSERT_NEAR(range, first, 0);
        if (i == 2) assert_true(range != first);
        test_level_close(&level);
    }
}

TEST(level_vary, prefab_members_vary_by_themselves) {
    TestLevel level;
    test_level_load_good(
        &level, "[[prefab]]\nname = \"p\"\n[[prefab.entity]]\n[[prefab.entity]]\n"
                "vary.light.range = { min = 1, max = 9 }\n[[prefab.entity]]\n"
                "vary.light.range = { min = 1, max = 9 }\n"
                "[[entity]]\nprefab = \"p\"\nrepeat.row = { count = 2, step = [1, 0, 0] }\n");
    const LightTable *l = WORLD_TABLE(level.world, Light, light);
    assert_int_equal(l->table.count, 4);
    for (u32 i = 0; i < 4; i++)
        for (u32 k = 0; k < i; k++) assert_true(l->range[i] != l->range[k]);
    test_level_close(&level);
}
