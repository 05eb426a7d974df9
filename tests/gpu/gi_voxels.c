// gi_voxels.c: voxelisation: both ways of it, the twin on the CPU and exact arithmetic agree on
// which voxels triangles touch, and on what falls into them; sums do not overflow.
#include "voxel_fixture.h"
#include "../../engine/base/random.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Ranks count bits, and places are those of the bits, in their order.
static void assert_slots(const VoxelVolumes *v, const Packet *packet) {
    const u32 *dims = packet->gi.record.dims;
    u32 slot = 0, rank = 0;
    for (u32 w = 0; w < 2 * v->words; w++) {
        if (w % GI_RANK_WORDS == 0) rank = slot;
        if (v->masks[w]) assert_int_equal(v->ranks[w / GI_RANK_WORDS], rank);
        for (u32 mask = v->masks[w]; mask; mask &= mask - 1, slot++) {
            u32 bit = w % v->words * 32 + (u32)__builtin_ctz(mask);
            u32 x = bit % dims[0], y = bit / dims[0] % dims[1], z = bit / (dims[0] * dims[1]);
            assert_int_equal(v->voxels[slot],
                             x << GI_VOXEL_X_SHIFT | y << GI_VOXEL_Y_SHIFT | z << GI_VOXEL_Z_SHIFT);
        }
    }
    u32 all = v->slots, moved = v->counters[GI_COUNTER_DYNAMIC];
    assert_int_equal(v->counters[GI_COUNTER_ALL_ARGS], (all + 63) / 64);
    assert_int_equal(v->counters[GI_COUNTER_DYNAMIC_ARGS], (moved + 63) / 64);
}

// Averages of the twin's sums, as far as their bits tell them.
static void assert_attributes(const VoxelVolumes *v, const TwinVoxels *twin, const char *what) {
    f64 worst_albedo = 0, worst_normal = 0, worst_face = 0, worst_emission = 0;
    u32 slot = 0;
    for (u32 bit = 0; bit < v->words * 32; bit++) {
        if (!(v->masks[bit >> 5] >> (bit & 31) & 1)) continue;
        const u32 *a = &v->attributes[slot++ * GI_ATTRIBUTE_WORDS];
        f64 n = twin->counts[bit];
        assert_int_equal(a[GI_ATTRIBUTE_ALBEDO] >> 24, 255);
        f64 unit = exp2((f64)(a[GI_ATTRIBUTE_EMISSION] >> 27) - 24.0);
        for (u32 k = 0; k < 3; k++) {
            f64 albedo = (a[GI_ATTRIBUTE_ALBEDO] >> (8 * k) & 255) / 255.0;
            f64 normal = (a[GI_ATTRIBUTE_NORMAL] >> (10 * k) & 1023) / 1023.0 * 2 - 1;
            f64 emission = (a[GI_ATTRIBUTE_EMISSION] >> (9 * k) & 511) * unit;
            worst_albedo = fmax(worst_albedo, fabs(albedo - (f64)twin->albedo[bit][k] / n));
            worst_normal = fmax(worst_normal, fabs(normal - (f64)twin->normal[bit][k] / n));
            f64 expected = (f64)twin->emission[bit][k] / n;
            worst_emission =
                fmax(worst_emission, fabs(emission - expected) - 0.004 * expected - unit);
        }
        for (u32 k = 0; k < 6; k++) {
            f64 face = (a[GI_ATTRIBUTE_FACES_0 + k / 4] >> (8 * (k & 3)) & 255) / 255.0;
            worst_face = fmax(worst_face, fabs(face - (f64)twin->faces[bit][k] / n));
        }
    }
    printf("    %s: albedo off by %.4f, normal %.4f, faces %.4f at most\n", what, worst_albedo,
           worst_normal, worst_face);
    assert_true(worst_albedo < 0.005 && worst_normal < 0.005 && worst_face < 0.005);
    assert_true(worst_emission <= 0);
}

static const char *const way_names[] = {"auto", "raster", "compute"};

// --- Soups ---

static f32 rnd(u32 i, u32 stream, f32 low, f32 high) {
    return random_range(20170613, stream, i, low, high);
}

// Triangles of all sizes and shapes about the grid, in world units.
static void soup_triangle(const GiRecord *record, u32 i, f32 out[3][3]) {
    const f32 *grid = record->origin[0];
    f32 sizes[] = {0.001f, 0.05f, 0.7f, 3.0f, 12.0f, 40.0f, 300.0f};
    f32 size = sizes[random_u32(7, 1, i) % COUNT_OF(sizes)] * rnd(i, 2, 0.5f, 1.5f);
    for (u32 k = 0; k < 3; k++) {
        f32 middle = rnd(i, 3 + k, -0.1f, 1.1f) * (f32)record->dims[k];
        for (u32 c = 0; c < 3; c++) out[c][k] = middle + rnd(i, 10 + 3 * c + k, -0.5f, 0.5f) * size;
    }
    u32 kind = random_u32(7, 6, i) % 8;
    for (u32 k = 0; k < 3; k++) {
        f32 t = rnd(i, 30, 0, 1);
        if (kind == 1) out[2][k] = out[0][k] + (out[1][k] - out[0][k]) * t;   // no area
        if (kind == 2) out[1][k] = out[2][k] = out[0][k];                     // a point
        if (kind == 3) out[2][k] = out[0][k] + rnd(i, 31 + k, -0.02f, 0.02f); // thin
        if (kind == 4)
            out[0][k] = floorf(out[0][k]), out[1][k] = floorf(out[1][k]),
            out[2][k] = floorf(out[2][k]); // on the voxels' corners
    }
    if (kind == 5) { // flat, on a voxel's side
        u32 k = i % 3;
        out[0][k] = out[1][k] = out[2][k] = floorf(out[0][k]);
    }
    for (u32 c = 0; c < 3; c++)
        for (u32 k = 0; k < 3; k++) out[c][k] = out[c][k] * grid[3] + grid[k];
}

static u32 soup_mesh(AssetStore *store, const GiRecord *record, u32 count) {
    MeshVertex *vertices = calloc(count * 3, sizeof *vertices);
    u32 *indices = calloc(count * 3, sizeof *indices);
    for (u32 i = 0; i < count; i++) {
        f32 corners[3][3];
        soup_triangle(record, i, corners);
        for (u32 c = 0; c < 3; c++) {
            MeshVertex *v = &vertices[i * 3 + c];
            memcpy(v->position, corners[c], sizeof v->position);
            Vec3 n = {rnd(i, 40 + c, -1, 1), rnd(i, 43 + c, -1, 1), rnd(i, 46 + c, -1, 1)};
            n = vec3_scale(n, 1.0f / MAX(vec3_length(n), 1e-3f));
            v->normal = asset_pack_normal(n);
            v->color = random_u32(8, c, i) | 0xFF000000u;
            v->uv[0] = rnd(i, 50 + c, 0, 1), v->uv[1] = rnd(i, 53 + c, 0, 1);
            indices[i * 3 + c] = i * 3 + c;
        }
    }
    u32 mesh = asset_add_mesh(store, vertices, count * 3, indices, count * 3);
    assert_true(mesh);
    free(vertices);
    free(indices);
    return mesh;
}

static void check_soup(u32 side, u32 count) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    char list[64];
    snprintf(list, sizeof list, "gi.grid=%u,gi.diffuse=none", side);
    const Packet *base = voxel_packet(&studio, list);
    AssetStore store;
    assert_true(asset_store_create(&store));
    VoxelScene scene = {.instance_count = 3, .static_count = 2};
    voxel_scene_materials(&scene);
    u32 mesh = soup_mesh(&store, &base->gi.record, count);
    const f32 *origin = base->gi.record.origin[0];
    const f32 moved[3] = {0.31f * origin[0], 0.11f, -0.2f}, still[3] = {0};
    voxel_place(&scene.instances[0], voxel_upright, still, 0);
    voxel_place(&scene.instances[1], voxel_askew, moved, 0);
    voxel_place(&scene.instances[2], voxel_upright, (const f32[]){0.013f, 0.02f, 0.07f}, 2);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 0, .instance_count = 2};
    scene.statics[1] =
        (PacketDraw){.mesh = mesh, .material = 2, .first_instance = 2, .instance_count = 1};
    assert_true(renderer_set_assets(studio.renderer, &store));
    Packet *packet = voxel_scene_packet(&studio, base, &scene);
    TwinVoxels twin = twin_voxelise(packet, &store, true, &studio.images);
    VoxelVolumes first = {0};
    for (u32 way = 0; way < 3; way++) {
        packet->gi.params.voxeliser = way;
        packet->gi.static_key += 10;
        VoxelVolumes v = voxel_draw(&studio, packet);
        voxel_assert_masks(&v, &twin, way_names[way]);
        assert_slots(&v, packet);
        if (way == 0) {
            first = v;
            snprintf(list, sizeof list, "%u^3, %u voxels", side, v.slots);
            assert_attributes(&v, &twin, list);
        }
        voxel_assert_same(&first, &v, way_names[way]);
    }
    asset_store_destroy(&store);
    studio_close(&studio);
}
TEST_GPU(gi_voxels, ways_and_twin_agree_on_soup_32) { check_soup(32, 60); }
TEST_GPU(gi_voxels, ways_and_twin_agree_on_soup_64) { check_soup(64, 150); }
TEST_GPU(gi_voxels, ways_and_twin_agree_on_soup_128) { check_soup(128, 200); }

// The twin against exact arithmetic, over all voxels: what touches is found, and what is found
// touches a box that is larger by a little more than the slack.
TEST(gi_voxels, no_triangle_is_missed) {
    GiRecord record = {.origin = {{-3.7f, 0.3f, 11.1f, 0.0717f}}, .dims = {32, 16, 32, 1}};
    u32 found = 0, spare = 0, exact = 0;
    for (u32 i = 0; i < 3000; i++) {
        f32 world[3][3];
        f64 corners[3][3];
        soup_triangle(&record, i, world);
        TwinTriangle t = twin_triangle(&record, 0, world);
        for (u32 c = 0; c < 3; c++)
            for (u32 k = 0; k < 3; k++)
                corners[c][k] =
                    ((f64)world[c][k] - (f64)record.origin[0][k]) / (f64)record.origin[0][3];
        f64 low[3], high[3];
        for (u32 k = 0; k < 3; k++) {
            low[k] = fmin(fmin(corners[0][k], corners[1][k]), corners[2][k]) - 2.0;
            high[k] = fmax(fmax(corners[0][k], corners[1][k]), corners[2][k]) + 2.0;
        }
        for (u32 n = 0; n < 32 * 16 * 32; n++) {
            u32 voxel[3] = {n & 31, n >> 5 & 15, n >> 9};
            bool is_near = true;
            for (u32 k = 0; k < 3; k++)
                is_near = is_near && voxel[k] >= low[k] && voxel[k] <= high[k];
            if (!is_near) continue;
            i32 v[3];
            bool marked = true;
            for (u32 k = 0; k < 3; k++) {
                v[k] = (i32)voxel[(t.axis + 1 + k) % 3];
                marked = marked && v[k] >= t.low[k] && v[k] <= t.high[k];
            }
            marked = marked && twin_touches(&t, v);
            bool touches = twin_touches_exactly(corners, voxel, 0.0);
            if (touches && !marked)
                fail_msg("triangle %u touches voxel %u %u %u and is missed", i, voxel[0], voxel[1],
                         voxel[2]);
            if (marked && !touches && !twin_touches_exactly(corners, voxel, 4.0 * (f64)t.slack))
                fail_msg("triangle %u marks voxel %u %u %u from afar", i, voxel[0], voxel[1],
                         voxel[2]);
            found += marked, exact += touches, spare += marked && !touches;
        }
    }
    printf("    %u pairs touch, %u more lie within the slack\n", exact, spare);
    assert_true(exact > 50000 && found == exact + spare);
}

// --- Levels ---

static void check_level(const char *level, const char *settings) {
    Studio studio;
    studio_open(&studio, level);
    VoxelVolumes first = {0};
    for (u32 way = 0; way < 3; way++) {
        char list[160];
        snprintf(list, sizeof list, "gi.diffuse=none,gi.voxeliser=%s,%s", way_names[way], settings);
        const Packet *packet = voxel_packet(&studio, list);
        u64 mark = arena_mark(&studio.images);
        TwinVoxels twin = {0};
        if (way == 0) twin = twin_voxelise(packet, &studio.session.assets, false, &studio.images);
        Packet *own = arena_push(&studio.images, packet->size, CACHE_LINE);
        memcpy(own, packet, packet->size);
        own->gi.static_key += way, own->gi.dynamic_key += way;
        VoxelVolumes v = voxel_draw(&studio, own);
        assert_slots(&v, packet);
        const PacketMaterial *materials = PACKET_DATA(packet, material_bindings, PacketMaterial);
        bool has_holes = false;
        for (u32 i = 0; i < packet->material_bindings.count; i++)
            has_holes |= materials[i].alpha_mode == 1;
        if (way == 0) {
            first = v;
            if (!has_holes) voxel_assert_masks(&v, &twin, level);
            for (u32 w = 0; w < v.words; w++)
                if (v.masks[w] & ~twin.masks[0][w])
                    fail_msg("%s: a voxel that nothing touches", level);
            printf("    %s %s: %u static, %u dynamic voxels%s\n", level, settings,
                   v.counters[GI_COUNTER_STATIC], v.counters[GI_COUNTER_DYNAMIC],
                   has_holes ? " (with holes)" : "");
            assert_true(v.slots > 100);
        } else {
            voxel_assert_same(&first, &v, way_names[way]);
            arena_rewind(&studio.images, mark);
        }
    }
    studio_close(&studio);
}
TEST_GPU(gi_voxels, ways_agree_on_cornell) {
    check_level("data/levels/cornell.toml", "gi.grid=32");
    check_level("data/levels/cornell.toml", "gi.grid=128");
}
TEST_GPU(gi_voxels, ways_agree_on_light_box) {
    check_level("data/levels/light_box.toml", "gi.grid=64");
}
TEST_GPU(gi_voxels, ways_agree_on_plane_test) {
    check_level("data/levels/plane_test.toml", "gi.grid=64");
}
TEST_GPU(gi_voxels, ways_agree_on_cloister) {
    check_level("data/levels/cloister.toml", "gi.grid=64");
}
TEST_GPU(gi_voxels, ways_agree_in_cascades) {
    check_level("data/levels/light_box.toml", "gi.grid=32,gi.cascades=3");
}

// --- Sums ---

// 100,000 triangles in one voxel: the average is right, so no sum ran over.
TEST_GPU(gi_voxels, no_density_overflows) {
    const u32 count = 100000;
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *base = voxel_packet(&studio, "gi.grid=32,gi.diffuse=none");
    const f32 *grid = base->gi.record.origin[0];
    AssetStore store;
    assert_true(asset_store_create(&store));
    MeshVertex *vertices = calloc(count * 3, sizeof *vertices);
    u32 *indices = calloc(count * 3, sizeof *indices);
    f64 color[3] = {0}, faces[6] = {0}, mean[3] = {0};
    for (u32 i = 0; i < count; i++) {
        Vec3 n = {rnd(i, 1, -1, 1), rnd(i, 2, -0.2f, 1), 1.0f};
        n = vec3_scale(n, 1.0f / vec3_length(n));
        u32 rgb = (u32)rnd(i, 3, 200, 255.99f) | (u32)rnd(i, 4, 0, 255.99f) << 8 | 255u << 16;
        const f32 own[3] = {n.x, n.y, n.z};
        for (u32 k = 0; k < 3; k++) {
            color[k] += (rgb >> (8 * k) & 255) / 255.0 / count;
            mean[k] += (f64)own[k] / count;
            faces[2 * k] += fmax((f64)own[k], 0) / count;
            faces[2 * k + 1] += fmax(-(f64)own[k], 0) / count;
        }
        for (u32 c = 0; c < 3; c++) {
            MeshVertex *v = &vertices[i * 3 + c];
            for (u32 k = 0; k < 3; k++)
                v->position[k] = grid[k] + grid[3] * (10.0f + rnd(i, 20 + 3 * c + k, 0.1f, 0.9f));
            v->normal = asset_pack_normal(n);
            v->color = rgb | 0xFF000000u;
            indices[i * 3 + c] = i * 3 + c;
        }
    }
    u32 mesh = asset_add_mesh(&store, vertices, count * 3, indices, count * 3);
    assert_true(mesh);
    assert_true(renderer_set_assets(studio.renderer, &store));
    VoxelScene scene = {.instance_count = 1, .static_count = 1};
    voxel_place(&scene.instances[0], voxel_upright, (const f32[3]){0}, 0);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .instance_count = 1};
    for (u32 k = 0; k < 3; k++) {
        scene.materials[0].albedo[k] = 1.0f;
        scene.materials[0].emissive[k] = (f32)(k + 1) * 20000.0f;
    }
    VoxelVolumes v = voxel_draw(&studio, voxel_scene_packet(&studio, base, &scene));
    assert_int_equal(v.slots, 1);
    assert_int_equal(v.voxels[0],
                     10 << GI_VOXEL_X_SHIFT | 10 << GI_VOXEL_Y_SHIFT | 10 << GI_VOXEL_Z_SHIFT);
    const u32 *a = v.attributes;
    f64 unit = exp2((f64)(a[GI_ATTRIBUTE_EMISSION] >> 27) - 24.0);
    for (u32 k = 0; k < 3; k++) {
        ASSERT_NEAR((a[GI_ATTRIBUTE_ALBEDO] >> (8 * k) & 255) / 255.0, color[k], 0.0025);
        ASSERT_NEAR((a[GI_ATTRIBUTE_NORMAL] >> (10 * k) & 1023) / 1023.0 * 2 - 1, mean[k], 0.0015);
        ASSERT_NEAR((a[GI_ATTRIBUTE_EMISSION] >> (9 * k) & 511) * unit, (k + 1) * 20000.0, 80.0);
    }
    for (u32 k = 0; k < 6; k++)
        ASSERT_NEAR((a[GI_ATTRIBUTE_FACES_0 + k / 4] >> (8 * (k & 3)) & 255) / 255.0, faces[k],
                    0.0025);
    free(vertices);
    free(indices);
    asset_store_destroy(&store);
    studio_close(&studio);
}

// Sums are kept for a window of slots at a time: sheets that fill more than one.
TEST_GPU(gi_voxels, sums_go_on_in_the_next_window) {
    const u32 sheets = 20;
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *base = voxel_packet(&studio, "gi.grid=128,gi.diffuse=none");
    const f32 *grid = base->gi.record.origin[0];
    AssetStore store;
    assert_true(asset_store_create(&store));
    MeshVertex vertices[20 * 4] = {0};
    u32 indices[20 * 6];
    for (u32 i = 0; i < sheets; i++) {
        for (u32 c = 0; c < 4; c++) {
            MeshVertex *v = &vertices[i * 4 + c];
            const f32 at[3] = {c & 1 ? 127.5f : 0.5f, 2.0f + 6.0f * (f32)i + rnd(i, c, 0.3f, 0.7f),
                               c & 2 ? 127.5f : 0.5f};
            for (u32 k = 0; k < 3; k++) v->position[k] = grid[k] + grid[3] * at[k];
            v->normal = asset_pack_normal((Vec3){0, 1, 0});
            v->color = random_u32(9, c, i);
        }
        for (u32 k = 0; k < 6; k++) indices[i * 6 + k] = i * 4 + (const u32[]){0, 2, 1, 1, 2, 3}[k];
    }
    u32 mesh = asset_add_mesh(&store, vertices, sheets * 4, indices, sheets * 6);
    assert_true(mesh);
    assert_true(renderer_set_assets(studio.renderer, &store));
    VoxelScene scene = {.instance_count = 1, .static_count = 1};
    voxel_scene_materials(&scene);
    voxel_place(&scene.instances[0], voxel_upright, (const f32[3]){0}, 2);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 2, .instance_count = 1};
    Packet *packet = voxel_scene_packet(&studio, base, &scene);
    VoxelVolumes v = voxel_draw(&studio, packet);
    assert_true(v.slots > GI_WINDOW_SLOTS + 1000);
    TwinVoxels twin = twin_voxelise(packet, &store, true, &studio.images);
    voxel_assert_masks(&v, &twin, "sheets");
    assert_attributes(&v, &twin, "sheets");
    asset_store_destroy(&store);
    studio_close(&studio);
}

// More occupied voxels than the buffers first have room for: drawn again until none is lost.
TEST_GPU(gi_voxels, a_full_grid_finds_room) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *base = voxel_packet(&studio, "gi.grid=32,gi.diffuse=none");
    AssetStore store;
    assert_true(asset_store_create(&store));
    u32 mesh = soup_mesh(&store, &base->gi.record, 3000);
    assert_true(renderer_set_assets(studio.renderer, &store));
    VoxelScene scene = {.instance_count = 2, .static_count = 1, .dynamic_count = 1};
    voxel_scene_materials(&scene);
    voxel_place(&scene.instances[0], voxel_upright, (const f32[3]){0}, 1);
    voxel_place(&scene.instances[1], voxel_askew, (const f32[3]){0}, 1);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 1, .instance_count = 1};
    scene.dynamics[0] =
        (PacketDraw){.mesh = mesh, .material = 1, .first_instance = 1, .instance_count = 1};
    Packet *packet = voxel_scene_packet(&studio, base, &scene);
    VoxelVolumes v = voxel_draw(&studio, packet);
    TwinVoxels twin = twin_voxelise(packet, &store, false, &studio.images);
    voxel_assert_masks(&v, &twin, "full grid");
    assert_slots(&v, packet);
    assert_true(v.slots > 20000);
    for (u32 w = 0; w < v.words; w++) assert_int_equal(v.masks[w] & v.masks[v.words + w], 0);
    asset_store_destroy(&store);
    studio_close(&studio);
}
