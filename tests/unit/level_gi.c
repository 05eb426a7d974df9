// level_gi.c: the keys of gi and of lights in the voxels: read, checked, written back; there is no
// GI where a level does not say so.
#include "level_common.h"
#include "../../engine/systems/gi.h"
#include <stdio.h>
#include <string.h>

static const char *const text =
    "[gi]\nsize = [24, 8, 12.5]\ncenter = [1, 2, 3]\ngrid = \"128\"\ncascades = 2\n"
    "format = \"byte\"\nvoxeliser = \"compute\"\nsolid = true\npolicy = \"every_n\"\nevery_n = 5\n"
    "cosine = \"average\"\nhit = 0.25\nfaces = \"apart\"\nfilter = \"isotropic\"\nbounces = 1\n"
    "feedback = true\ndiffuse = \"probes\"\nspecular = false\nao = false\ncone_shadows = false\n"
    "resolution = \"quarter\"\ndither = true\nmips = \"nearest\"\nshare = 8\nprobe_spacing = 2\n"
    "strength = 1.5\nao_lambda = 3\nao_floor = 0.125\nstep_factor = 1\ndiffuse_aperture = 45\n"
    "specular_aperture = 4\ndistance = 20\noffset = 2\nsky = 0.5\nambient = 0.25\n"
    "byte_radiance = 8\n"
    "[[entity]]\nname = \"lamp\"\nlight = { kind = \"spot\", voxel_shadow = \"soft_ray\", "
    "screen_shadow = \"cone\", shadow_aperture = 12, shadow_softness = 2, affects_gi = false }\n"
    "[[model]]\nname = \"cube\"\nshape = \"cube\"\n"
    "[[entity]]\nname = \"door\"\ninstance = { model = \"cube\", voxel_mode = \"dynamic\" }\n";

static void check(const TestLevel *level) {
    const GiTable *g = WORLD_TABLE(level->world, Gi, gi);
    assert_int_equal(g->table.count, 1);
    assert_true(g->size_z[0] == 12.5f && g->center_y[0] == 2);
    RenderSettings settings = settings_default();
    GiParams p = gi_params_resolve(level->world, &settings);
    assert_true(p.enabled && p.grid == 2 && p.cascades == 2 && p.format == GI_FORMAT_BYTE);
    assert_true(p.voxeliser == GI_VOXELISER_COMPUTE && p.solid && p.policy == GI_POLICY_EVERY_N);
    assert_true(p.every_n == 5 && p.cosine == GI_COSINE_AVERAGE && p.hit == 0.25f);
    assert_true(p.faces == GI_FACES_APART && p.filter == GI_FILTER_ISOTROPIC && p.bounces == 1);
    assert_true(p.feedback && p.diffuse == GI_DIFFUSE_PROBES && !p.specular && !p.ao);
    assert_true(!p.cone_shadows && p.resolution == GI_RESOLUTION_QUARTER && p.dither);
    assert_true(p.mips == GI_MIPS_NEAREST && p.share == 8 && p.probe_spacing == 2);
    assert_true(p.strength == 1.5f && p.ao_lambda == 3 && p.ao_floor == 0.125f);
    assert_true(p.step_factor == 1 && p.diffuse_aperture == 45 && p.specular_aperture == 4);
    assert_true(p.distance == 20 && p.offset == 2 && p.sky == 0.5f && p.ambient == 0.25f);
    assert_true(p.byte_radiance == 8);
    const LightTable *light = WORLD_TABLE(level->world, Light, light);
    assert_int_equal(light->voxel_shadow[0], 1 + VOXEL_SHADOW_SOFT_RAY);
    assert_int_equal(light->screen_shadow[0], SCREEN_SHADOW_CONE);
    assert_true(light->shadow_aperture[0] == 12 && light->shadow_softness[0] == 2);
    assert_int_equal(light->affects_gi[0], 0);
    u32 door = test_level_row(level, COMPONENT_instance, "door");
    assert_int_equal(WORLD_TABLE(level->world, Instance, instance)->voxel_mode[door],
                     VOXEL_DYNAMIC);
}

TEST(level_gi, keys_are_read_and_written_back) {
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

TEST(level_gi, a_level_without_the_table_has_none) {
    TestLevel a, b;
    test_level_load_good(&a, "[[entity]]\nname = \"lamp\"\nlight.kind = \"point\"\n");
    assert_int_equal(WORLD_TABLE(a.world, Gi, gi)->table.count, 0);
    RenderSettings settings = settings_default();
    assert_int_equal(gi_params_resolve(a.world, &settings).enabled, 0);
    test_level_load_good(&b, "[gi]\n"); // the table alone is enough
    assert_int_equal(gi_params_resolve(b.world, &settings).enabled, 1);
    test_level_close(&b);
    test_level_close(&a);
}

TEST(level_gi, mistakes_are_reported) {
    static const char *const wrong[] = {
        "[gi]\nenable = true\n",          "[gi]\ngrid = 64\n",
        "[gi]\ngrid = \"100\"\n",         "[gi]\nbounces = 3\n",
        "[gi]\ncascades = 0\n",           "[gi]\nstep_factor = 0\n",
        "[gi]\nsize = [1, 2]\n",          "[gi]\ndiffuse = \"cone\"\n",
        "[gi]\nshow = \"albedo\"\n",      "[[entity]]\nlight.voxel_shadow = \"map\"\n",
        "[[entity]]\ngi.grid = \"64\"\n", "[[entity]]\nlight.shadow_aperture = 0\n"};
    for (u32 i = 0; i < COUNT_OF(wrong); i++) {
        TestLevel level;
        test_level_load(&level, wrong[i]);
        if (level.is_good) fail_msg("accepted: %s", wrong[i]);
        assert_int_equal(level.diagnostics->error_count, 1);
        test_level_close(&level);
    }
}

// What moves and is voxelised as static would have everything made anew at every tick.
TEST(level_gi, moving_static_things_are_warned_of) {
    static const char *const things =
        "[[model]]\nname = \"cube\"\nshape = \"cube\"\n"
        "[[entity]]\nname = \"arm\"\norbit.period = 3\n"
        "[[entity]]\nname = \"hand\"\nparent = \"arm\"\ninstance = { model = \"cube\"%s }\n";
    static const char *const modes[] = {"", ", voxel_mode = \"dynamic\"",
                                        ", voxel_mode = \"none\""};
    for (u32 i = 0; i < 6; i++) {
        char body[512], all[600];
        snprintf(body, sizeof body, things, modes[i / 2]);
        snprintf(all, sizeof all, "%s%s", i & 1 ? "[gi]\n" : "", body);
        TestLevel level;
        test_level_load(&level, all);
        assert_true(level.is_good);
        assert_int_equal(level.diagnostics->warning_count, i == 1);
        if (i == 1) assert_non_null(strstr(level.diagnostics->items[0].text, "'hand'"));
        test_level_close(&level);
    }
}
