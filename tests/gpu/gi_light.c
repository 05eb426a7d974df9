// gi_light.c: light of voxels (shaders/gi_light.glsl) against its naive twin: every kind of light,
// falloff, cosine, faces and way to ask for visibility, on random voxels. Data in: seeds. Data out:
// radiance by slot. Called by: the runner.
#include "gi_light_stage.h"
#include "../../engine/systems/gi.h"
#include <stdlib.h>
#include <string.h>

// Half floats keep 11 bits; sums run in another order of operations.
#define HALF_STEP  0x1p-11f
#define NEAR(a, b) (fabsf((a) - (b)) <= 2 * HALF_STEP * fabsf(b) + 2e-4f)

// Compares all slots; returns how many differ. allowed: slots whose rays run so close past a corner
// that rounding decides.
static u32 count_differing(const VoxelScene *stage, const LightResult *result) {
    u32 faces = stage->spec[SPEC_GI_FACES] ? 6 : 1, differing = 0;
    for (u32 slot = 0; slot < stage->slot_count; slot++) {
        LightSum sum = light_twin(stage, slot);
        bool same = true;
        for (u32 f = 0; f < faces; f++) {
            const f32 *light = result->radiance + (slot * (u64)faces + f) * 4;
            for (u32 k = 0; k < 3; k++) same &= NEAR(light[k], sum.face[f][k]);
            same &= fabsf(light[3] - sum.opacity[f]) <= HALF_STEP;
        }
        if (stage->spec[SPEC_GI_VISIBILITY] & GI_VISIBILITY_KEPT) {
            u32 place = stage->places[slot];
            const u32 *dims = stage->gi.dims;
            u64 at = (place & 511) + dims[0] * ((place >> 9 & 511) + (u64)dims[1] * (place >> 18));
            same &= fabsf(result->visibility[at] / 255.0f - sum.visibility) <= 1.5f / 255;
        }
        differing += !same;
    }
    return differing;
}

static void check(VoxelScene *stage, u32 allowed) {
    LightResult result = voxel_scene_run(stage);
    u32 differing = count_differing(stage, &result);
    if (differing > allowed)
        fail_msg("%u of %u voxels are lit otherwise than the twin says", differing,
                 stage->slot_count);
    light_result_free(&result);
}

TEST_GPU(gi_light, falloffs_and_cosines) {
    VoxelScene stage;
    for (u32 kind = 0; kind < 3; kind++)
        for (u32 cosine = 0; cosine < 2; cosine++) {
            voxel_scene_voxels(&stage, 11 + kind, 32, 16, 8, 1, 200);
            voxel_scene_lights(&stage, 5 + kind, 40, 4.0f, 1);
            stage.spec[SPEC_ATTENUATION] = kind;
            stage.spec[SPEC_GI_COSINE] = cosine;
            check(&stage, 0);
            voxel_scene_free(&stage);
        }
}

TEST_GPU(gi_light, faces_apart) {
    VoxelScene stage;
    voxel_scene_voxels(&stage, 21, 16, 32, 8, 1, 200);
    voxel_scene_lights(&stage, 22, 40, 4.0f, 1);
    stage.spec[SPEC_GI_FACES] = 1;
    check(&stage, 0);
    voxel_scene_free(&stage);
}

static void add_suns(VoxelScene *stage) {
    const DirectionalRecord suns[3] = {{{0.6f, 0.64f, 0.48f, 1.0f}, {2, 1, 0.5f, 1.0f}},
                                       {{-0.48f, 0.6f, 0.64f, 0.0f}, {0.2f, 0.4f, 1, 0.0f}},
                                       {{0, 1, 0, -1.0f}, {9, 9, 9, 0.0f}}};
    memcpy(stage->directionals, suns, sizeof suns);
    stage->spec[SPEC_DIRECTIONALS] = 3;
}

// The map says: what lies above a plane is lit. It covers a part of the box only.
TEST_GPU(gi_light, shadow_map) {
    VoxelScene stage;
    voxel_scene_voxels(&stage, 31, 32, 32, 16, 1, 100);
    voxel_scene_lights(&stage, 32, 0, 1.0f, 1);
    add_suns(&stage);
    stage.spec[SPEC_SHADOW] = 1;
    stage.spec[SPEC_GI_VISIBILITY] |= 1u << 1 | GI_VISIBILITY_KEPT;
    f32 *m = stage.frame.shadow_matrix;
    memset(m, 0, sizeof stage.frame.shadow_matrix);
    m[0] = 1.0f / 3.0f;  // x: +-3 m of +-4
    m[9] = 1.0f / 3.0f;  // from z
    m[6] = 1.0f / 16.0f; // depth grows with y
    m[14] = 0.5f, m[15] = 1.0f;
    stage.map_depth = 0.53f;
    check(&stage, 0);
    voxel_scene_free(&stage);
}

// Sparse voxels, so that rays get through.
TEST_GPU(gi_light, rays) {
    for (u32 way = 2; way < 4; way++) {
        VoxelScene stage;
        voxel_scene_voxels(&stage, 41 + way, 32, 32, 16, 1, 12);
        voxel_scene_lights(&stage, 42 + way, 24, 6.0f, 1u << way | 1);
        stage.spec[SPEC_GI_VISIBILITY] |= GI_VISIBILITY_KEPT;
        stage.gi.strength[3] = way == 2 ? 1.0f : 0.1f;
        add_suns(&stage);
        stage.directionals[1].direction[3] = (f32)way;
        check(&stage, stage.slot_count / 100);
        voxel_scene_free(&stage);
    }
}

// A ray that leaves its cascade goes on in the next.
TEST_GPU(gi_light, rays_through_cascades) {
    VoxelScene stage;
    voxel_scene_voxels(&stage, 51, 16, 16, 16, 3, 15);
    voxel_scene_lights(&stage, 52, 16, 12.0f, 1u << 2);
    stage.spec[SPEC_GI_VISIBILITY] |= GI_VISIBILITY_KEPT;
    check(&stage, stage.slot_count / 50);
    voxel_scene_free(&stage);
}

// A plate through the box, with a lamp above it.
TEST_GPU(gi_light, solid_voxels_stop_rays) {
    for (u32 solid = 0; solid < 2; solid++) {
        VoxelScene stage;
        voxel_scene_voxels(&stage, 61, 32, 32, 32, 1, 3);
        u32 layer = 32 * 32 * 32 / 32;
        // A plate of solid voxels: a word is a row.
        for (u32 z = 0; z < 32; z++) stage.masks[GI_MASK_SOLID * layer + 16 + 32 * z] = 0xFFFFFFFFu;
        voxel_scene_lights(&stage, 62, 1, 100.0f, 1u << 2);
        stage.lights[0].position[1] = 2.0f;
        stage.spec[SPEC_GI_VISIBILITY] |= GI_VISIBILITY_KEPT | (solid ? GI_VISIBILITY_SOLID : 0);
        check(&stage, 4);
        voxel_scene_free(&stage);
    }
}

// By lists over a grid, and all lights for everybody: the same bits. More lights than a subgroup
// has lanes, lists of all lengths.
TEST_GPU(gi_light, grid_is_all_lights) {
    VoxelScene stage;
    voxel_scene_voxels(&stage, 71, 32, 32, 32, 1, 150);
    voxel_scene_lights(&stage, 72, 1000, 1.5f, 1);
    LightResult all = voxel_scene_run(&stage);
    Arena arena;
    assert_true(arena_create(&arena, "lists", MIB(64)));
    GiLists lists = gi_lists_make(&stage.gi, stage.lights, stage.light_count, &arena);
    assert_true(stage.gi.light_grid[0] > 1);
    assert_true(lists.index_count < 1000 * 8 * 8 * 8 / 4); // the grid is of use
    free(stage.lists);
    stage.list_words = lists.count;
    stage.lists = malloc(lists.count * sizeof(u32));
    memcpy(stage.lists, lists.words, lists.count * sizeof(u32));
    // Nor does it matter where lights are read.
    stage.spec[SPEC_GI_VISIBILITY] &= ~(u32)GI_VISIBILITY_BLOCK;
    LightResult grid = voxel_scene_run(&stage);
    assert_memory_equal(all.radiance, grid.radiance, stage.slot_count * 4 * sizeof(f32));
    assert_memory_equal(all.base, grid.base, all.base_bytes);
    assert_int_equal(count_differing(&stage, &grid), 0);
    arena_destroy(&arena);
    light_result_free(&all);
    light_result_free(&grid);
    voxel_scene_free(&stage);
}

// The base volume holds what RADIANCE does, and nothing elsewhere; in bytes, what bytes can.
TEST_GPU(gi_light, base_volume) {
    for (u32 format = 0; format < 2; format++) {
        VoxelScene stage;
        voxel_scene_voxels(&stage, 81, 16, 16, 16, 2, 100);
        voxel_scene_lights(&stage, 82, 30, 4.0f, 1);
        stage.spec[SPEC_GI_FORMAT] = format;
        LightResult result = voxel_scene_run(&stage);
        u64 filled = 0;
        for (u64 i = 0; i < result.base_bytes; i += format ? 4 : 8)
            filled += format ? result.base[i + 3] == 255 : result.base[i + 7] == 0x3C;
        assert_int_equal(filled, stage.slot_count);
        for (u32 slot = 0; slot < stage.slot_count; slot++) {
            u32 place = stage.places[slot];
            u64 at = (place & 511) + 16 * ((place >> 9 & 511) + 16ull * (place >> 18));
            for (u32 k = 0; k < 3; k++) {
                f32 radiance = result.radiance[slot * 4 + k];
                f32 found = format ? result.base[at * 4 + k] / 255.0f * stage.gi.scale[0]
                                   : half_to_float(((const u16 *)result.base)[at * 4 + k]);
                f32 wanted = format ? MIN(radiance, stage.gi.scale[0]) : radiance;
                assert_true(format ? fabsf(found - wanted) <= stage.gi.scale[0] / 255
                                   : NEAR(found, wanted));
            }
        }
        light_result_free(&result);
        voxel_scene_free(&stage);
    }
}
