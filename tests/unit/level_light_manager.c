// level_light_manager.c: the keys of light_manager and occluder: read, checked, written back.
#include "level_common.h"
#include <stdio.h>

static const char *const text =
    "[light_manager]\nlod_near = 12\nlod_far = 33.5\nmerge_distance = 9\nmerge_error = 0.25\n"
    "drop_area = 40\ndrop_contribution = 0.01\nbudget = 24\nvertex_lighting = 18\n"
    "[[entity]]\nname = \"wall\"\noccluder = { size = [4, 3, 0.5], center = [0, 1.5, 0] }\n"
    "[[model]]\nname = \"cube\"\nshape = \"cube\"\n"
    "[[entity]]\nname = \"house\"\ninstance.model = \"cube\"\noccluder.shape = \"mesh\"\n"
    "[[entity]]\nname = \"sun\"\nlight = { kind = \"point\", priority = 100 }\n";

static void check(const TestLevel *level) {
    const LightManagerTable *m = WORLD_TABLE(level->world, LightManager, light_manager);
    assert_int_equal(m->table.count, 1);
    assert_true(m->lod_near[0] == 12 && m->lod_far[0] == 33.5f && m->merge_distance[0] == 9);
    assert_true(m->merge_error[0] == 0.25f && m->drop_area[0] == 40);
    assert_true(m->drop_contribution[0] == 0.01f && m->vertex_lighting[0] == 18);
    assert_int_equal(m->budget[0], 24);
    const OccluderTable *o = WORLD_TABLE(level->world, Occluder, occluder);
    u32 wall = test_level_row(level, COMPONENT_occluder, "wall"),
        house = test_level_row(level, COMPONENT_occluder, "house");
    assert_int_equal(o->shape[wall], OCCLUDER_BOX);
    assert_int_equal(o->shape[house], OCCLUDER_MESH);
    assert_true(o->size_x[wall] == 4 && o->size_y[wall] == 3 && o->size_z[wall] == 0.5f);
    assert_true(o->center_y[wall] == 1.5f && o->center_x[wall] == 0);
    assert_true(o->size_x[house] == 1);
    // What stands somewhere has a place, also if the text gives none.
    assert_true(test_level_row(level, COMPONENT_transform, "wall") != ROW_NONE);
}

TEST(level_light_manager, keys_are_read_and_written_back) {
    TestLevel a, b;
    test_level_load_good(&a, text);
    check(&a);
    const char *written = level_write(a.world, &a.store, &a.arena);
    test_level_load_good(&b, written);
    check(&b);
    assert_true(world_hash(a.world) == world_hash(b.world));
    test_level_close(&b);
    test_level_close(&a);
}

TEST(level_light_manager, mistakes_are_reported) {
    static const char *const wrong[] = {
        "[light_manager]\nmerge_eror = 0.1\n",   "[light_manager]\nmerge_error = 2\n",
        "[light_manager]\nbudget = -1\n",        "[light_manager]\nbudget = 5000\n",
        "[light_manager]\nlod_near = \"far\"\n", "[[entity]]\noccluder.shape = \"ball\"\n",
        "[[entity]]\noccluder.size = [1, 2]\n",  "[[entity]]\noccluder.size = [-1, 2, 3]\n",
        "[[entity]]\nlight.priority = 101\n"};
    for (u32 i = 0; i < COUNT_OF(wrong); i++) {
        TestLevel level;
        test_level_load(&level, wrong[i]);
        if (level.is_good) fail_msg("accepted: %s", wrong[i]);
        assert_int_equal(level.diagnostics->error_count, 1);
        test_level_close(&level);
    }
}
