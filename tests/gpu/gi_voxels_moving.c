// gi_voxels_moving.c: voxels of what moves leave nothing behind; counters tell what was voxelised;
// insides of closed meshes.
#include "voxel_fixture.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// --- What moves ---

static u64 hash_volume(Studio *studio, GiVolume which) {
    static u8 bytes[64 << 20];
    u64 size = renderer_read_gi(studio->renderer, which, bytes, sizeof bytes), hash = size;
    assert_true(size < sizeof bytes);
    for (u64 i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 0x100000001B3ull;
    return hash;
}

typedef struct Moving {
    Studio studio;
    AssetStore store;
    VoxelScene scene;
    const Packet *base;
} Moving;

// A static torus, a dynamic one that can be elsewhere.
static void moving_open(Moving *m, const char *settings) {
    memset(m, 0, sizeof *m);
    studio_open(&m->studio, "data/levels/cornell.toml");
    m->base = voxel_packet(&m->studio, settings);
    assert_true(asset_store_create(&m->store));
    u32 model = asset_generate_model(&m->store, &(ShapeDesc){.shape = SHAPE_TORUS});
    u32 mesh = m->store.models[model].parts[0].mesh;
    assert_true(renderer_set_assets(m->studio.renderer, &m->store));
    m->scene.instance_count = 2;
    m->scene.static_count = m->scene.dynamic_count = 1;
    voxel_scene_materials(&m->scene);
    m->scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 1, .instance_count = 1};
    m->scene.dynamics[0] =
        (PacketDraw){.mesh = mesh, .material = 2, .first_instance = 1, .instance_count = 1};
}
static void moving_close(Moving *m) {
    asset_store_destroy(&m->store);
    studio_close(&m->studio);
}
// At a share of the way through the box.
static VoxelVolumes moving_draw(Moving *m, f32 share, u64 key, u32 flags) {
    const GiRecord *record = &m->base->gi.record;
    f32 middle[3], at[3];
    for (u32 k = 0; k < 3; k++) {
        middle[k] = record->origin[0][k] + 0.5f * (f32)record->dims[k] * record->origin[0][3];
        at[k] = middle[k];
    }
    at[0] += (share - 0.5f) * (f32)record->dims[0] * record->origin[0][3];
    voxel_place(&m->scene.instances[0], voxel_upright, middle, 1);
    voxel_place(&m->scene.instances[1], voxel_askew, at, 2);
    Packet *packet = voxel_scene_packet(&m->studio, m->base, &m->scene);
    packet->gi.static_key = 77;
    packet->gi.dynamic_key = key;
    packet->flags = flags;
    return voxel_draw(&m->studio, packet);
}

TEST_GPU(gi_voxels, what_moves_leaves_nothing_behind) {
    Moving m;
    moving_open(&m, "gi.grid=64");
    static const GiVolume volumes[] = {GI_VOLUME_BASE, GI_VOLUME_ATLAS, GI_VOLUME_IRRADIANCE,
                                       GI_VOLUME_VISIBILITY};
    u64 before[COUNT_OF(volumes)];
    VoxelVolumes here = moving_draw(&m, 0.5f, 5, 0);
    for (u32 i = 0; i < COUNT_OF(volumes); i++) before[i] = hash_volume(&m.studio, volumes[i]);
    VoxelVolumes there = moving_draw(&m, 0.2f, 6, 0);
    assert_memory_not_equal(there.masks, here.masks, here.words * 8);
    assert_memory_equal(there.masks, here.masks, here.words * 4); // the static layer
    assert_memory_equal(there.attributes, here.attributes,
                        here.counters[GI_COUNTER_STATIC] * GI_ATTRIBUTE_WORDS * 4);
    VoxelVolumes gone = moving_draw(&m, 9.0f, 7, 0); // out of the box
    assert_int_equal(gone.counters[GI_COUNTER_DYNAMIC], 0);
    VoxelVolumes back = moving_draw(&m, 0.5f, 8, 0);
    voxel_assert_same(&here, &back, "moved and back");
    for (u32 i = 0; i < COUNT_OF(volumes); i++)
        if (before[i] != hash_volume(&m.studio, volumes[i]))
            fail_msg("volume %u is another after it moved and came back", volumes[i]);
    RendererStats stats = renderer_stats(m.studio.renderer);
    assert_int_equal(stats.gi_static_voxelised, 1);
    assert_int_equal(stats.gi_dynamic_voxelised, 4);
    moving_close(&m);
}

TEST_GPU(gi_voxels, counters_tell_what_was_voxelised) {
    Moving m;
    moving_open(&m, "gi.grid=32,gi.diffuse=none");
    moving_draw(&m, 0.5f, 5, 0);
    VoxelVolumes here = moving_draw(&m, 0.5f, 5, 0); // nothing changed
    RendererStats stats = renderer_stats(m.studio.renderer);
    assert_int_equal(stats.gi_static_voxelised, 1);
    assert_int_equal(stats.gi_dynamic_voxelised, 1);
    // Light alone.
    Packet *light = voxel_scene_packet(&m.studio, m.base, &m.scene);
    light->gi.static_key = 77, light->gi.dynamic_key = 5, light->flags = 0;
    light->gi.light_key++;
    u32 relit = stats.gi_relit;
    voxel_draw(&m.studio, light);
    stats = renderer_stats(m.studio.renderer);
    assert_int_equal(stats.gi_relit, relit + 1);
    assert_int_equal(stats.gi_static_voxelised, 1);
    assert_int_equal(stats.gi_dynamic_voxelised, 1);
    // Moved, but never to be voxelised again: unless the picture must not hang on the past.
    Packet *never = arena_push(&m.studio.images, m.base->size, CACHE_LINE);
    memcpy(never, m.base, m.base->size);
    never->gi.params.policy = GI_POLICY_NEVER;
    m.base = never;
    VoxelVolumes kept = moving_draw(&m, 0.2f, 6, 0);
    assert_int_equal(renderer_stats(m.studio.renderer).gi_dynamic_voxelised, 1);
    voxel_assert_same(&here, &kept, "policy never");
    VoxelVolumes cold = moving_draw(&m, 0.2f, 6, PACKET_COLD);
    assert_int_equal(renderer_stats(m.studio.renderer).gi_dynamic_voxelised, 2);
    assert_memory_not_equal(cold.masks, here.masks, here.words * 8);
    never->gi.params.policy = GI_POLICY_EVERY_FRAME;
    moving_draw(&m, 0.2f, 6, 0);
    moving_draw(&m, 0.2f, 6, 0);
    assert_int_equal(renderer_stats(m.studio.renderer).gi_dynamic_voxelised, 4);
    assert_int_equal(renderer_stats(m.studio.renderer).gi_static_voxelised, 1);
    moving_close(&m);
}

// The driver's number of threads shows nowhere.
TEST_GPU(gi_voxels, threads_do_not_show) {
    u64 hashes[2][3];
    for (u32 run = 0; run < 2; run++) {
        setenv("LP_NUM_THREADS", run ? "2" : "1", 1);
        Moving m;
        moving_open(&m, "gi.grid=64");
        moving_draw(&m, 0.3f, 5, 0);
        moving_draw(&m, 0.5f, 6, 0);
        hashes[run][0] = hash_volume(&m.studio, GI_VOLUME_ATTRIBUTES);
        hashes[run][1] = hash_volume(&m.studio, GI_VOLUME_MASKS);
        hashes[run][2] = hash_volume(&m.studio, GI_VOLUME_ATLAS);
        moving_close(&m);
    }
    assert_memory_equal(hashes[0], hashes[1], sizeof hashes[0]);
}

// --- Insides ---

static void check_solid(Shape shape, bool inverted, bool dynamic) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *base = voxel_packet(&studio, "gi.grid=32,gi.diffuse=none,gi.solid=on");
    assert_true(base->gi.params.solid);
    AssetStore store;
    assert_true(asset_store_create(&store));
    u32 model = asset_generate_model(&store, &(ShapeDesc){.shape = shape, .inverted = inverted});
    u32 mesh = store.models[model].parts[0].mesh;
    assert_true(renderer_set_assets(studio.renderer, &store));
    VoxelScene scene = {
        .instance_count = 2, .static_count = dynamic ? 0 : 1, .dynamic_count = dynamic ? 1 : 0};
    voxel_scene_materials(&scene);
    const GiRecord *record = &base->gi.record;
    f32 voxel = record->origin[0][3], axes[3][3], middle[2][3];
    // Two that overlap: parity must not take away what both hold.
    for (u32 k = 0; k < 3; k++) {
        for (u32 i = 0; i < 3; i++) axes[k][i] = voxel_askew[k][i] * voxel * 12.0f;
        for (u32 n = 0; n < 2; n++)
            middle[n][k] = record->origin[0][k] +
                           (0.5f * (f32)record->dims[k] + 0.37f + 2.0f * (f32)n) * voxel;
    }
    for (u32 n = 0; n < 2; n++) voxel_place(&scene.instances[n], axes, middle[n], 0);
    scene.statics[0] = scene.dynamics[0] = (PacketDraw){.mesh = mesh, .instance_count = 2};
    Packet *packet = voxel_scene_packet(&studio, base, &scene);
    VoxelVolumes v = voxel_draw(&studio, packet);
    TwinVoxels twin = twin_voxelise(packet, &store, false, &studio.images);
    u32 *masks = voxel_read_words(&studio, GI_VOLUME_MASKS, v.words * GI_MASK_COUNT);
    const u32 *solid = masks + GI_MASK_SOLID * v.words, *own = masks + v.words * dynamic;
    u32 inside = 0, surface = 0;
    bool is_closed = shape != SHAPE_PLANE && !inverted;
    for (u32 bit = 0; bit < v.words * 32; bit++) {
        // What is not surface and lies inside one of both, by the shape's formula, well off its
        // border.
        u32 at[3] = {bit % record->dims[0], bit / record->dims[0] % record->dims[1],
                     bit / (record->dims[0] * record->dims[1])};
        bool marked = twin.masks[dynamic][bit >> 5] >> (bit & 31) & 1;
        bool filled = solid[bit >> 5] >> (bit & 31) & 1;
        bool there = own[bit >> 5] >> (bit & 31) & 1;
        assert_int_equal(there, marked || filled);
        assert_false(marked && filled);
        bool expected = false, unsure = false;
        for (u32 n = 0; n < 2; n++) {
            f32 local[3] = {0}, d[3];
            for (u32 k = 0; k < 3; k++)
                d[k] = record->origin[0][k] + ((f32)at[k] + 0.5f) * voxel - middle[n][k];
            // The inverse of axes by Cramer.
            f64 det = 0;
            for (u32 k = 0; k < 3; k++) {
                const f32 *a = axes[(k + 1) % 3], *b = axes[(k + 2) % 3];
                f64 c[3] = {(f64)a[1] * (f64)b[2] - (f64)a[2] * (f64)b[1],
                            (f64)a[2] * (f64)b[0] - (f64)a[0] * (f64)b[2],
                            (f64)a[0] * (f64)b[1] - (f64)a[1] * (f64)b[0]};
                det = c[0] * (f64)axes[k][0] + c[1] * (f64)axes[k][1] + c[2] * (f64)axes[k][2];
                local[k] = (f32)((c[0] * (f64)d[0] + c[1] * (f64)d[1] + c[2] * (f64)d[2]) / det);
            }
            f32 x = fabsf(local[0]), y = fabsf(local[1]), z = fabsf(local[2]);
            f32 depth; // 0..: inside
            if (shape == SHAPE_SPHERE)
                depth = 0.5f - sqrtf(x * x + y * y + z * z);
            else if (shape == SHAPE_TORUS) {
                f32 ring = sqrtf(x * x + z * z) - 0.5f;
                depth = 0.2f - sqrtf(ring * ring + y * y);
            } else
                depth = 0.5f - MAX(MAX(x, y), z);
            expected |= depth > 0.02f;
            unsure |= depth > -0.02f && depth <= 0.02f;
        }
        if (!is_closed) expected = unsure = false;
        if (!marked && expected && !filled) fail_msg("voxel %u is inside and not filled", bit);
        if (filled && !expected && !unsure) fail_msg("voxel %u is filled and outside", bit);
        inside += filled, surface += marked;
    }
    printf("    %s%s%s: %u inside, %u on the surface\n", shape_names[shape],
           inverted ? ", inverted" : "", dynamic ? ", dynamic" : "", inside, surface);
    assert_true(is_closed ? inside > 100 : inside == 0);
    assert_int_equal(v.slots, inside + surface);
    // Insides are black.
    for (u32 slot = 0; slot < v.slots; slot++) {
        u32 x = v.voxels[slot] & 511, y = v.voxels[slot] >> 9 & 511, z = v.voxels[slot] >> 18;
        u32 bit = x + record->dims[0] * (y + record->dims[1] * z);
        if (!(solid[bit >> 5] >> (bit & 31) & 1)) continue;
        const u32 *a = &v.attributes[slot * GI_ATTRIBUTE_WORDS];
        assert_int_equal(a[GI_ATTRIBUTE_ALBEDO], dynamic ? 0 : 0xFF000000u);
        assert_int_equal(a[GI_ATTRIBUTE_EMISSION] & 0x7FFFFFF, 0);
        assert_int_equal(a[GI_ATTRIBUTE_FACES_0] | a[GI_ATTRIBUTE_FACES_1], 0);
    }
    // Dynamic insides go as their surface does.
    if (dynamic) {
        packet->gi.dynamic_key++;
        packet->gi_dynamic_draws.count = 0;
        v = voxel_draw(&studio, packet);
        assert_int_equal(v.slots, 0);
        masks = voxel_read_words(&studio, GI_VOLUME_MASKS, v.words * GI_MASK_COUNT);
        for (u32 w = 0; w < v.words; w++) assert_int_equal(masks[GI_MASK_SOLID * v.words + w], 0);
    }
    asset_store_destroy(&store);
    studio_close(&studio);
}
TEST_GPU(gi_voxels, closed_meshes_are_filled) {
    check_solid(SHAPE_CUBE, false, false);
    check_solid(SHAPE_SPHERE, false, false);
    check_solid(SHAPE_TORUS, false, true);
    check_solid(SHAPE_CUBE, true, false);
    check_solid(SHAPE_PLANE, false, false);
}
