// gi_voxels.c: voxelisation: both ways of it, the twin on the CPU and exact arithmetic agree on
// which voxels triangles touch; sums do not overflow; dynamic voxels leave nothing behind; insides.
#include "voxel_twin.h"
#include "../golden/studio.h"
#include "../../engine/base/random.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH  32
#define HEIGHT 18

// --- What the device made ---

typedef struct Volumes {
    u32 counters[GI_COUNTER_COUNT], words, slots;
    u32 *masks; // static, dynamic; [2 * words]
    u32 *ranks, *voxels, *attributes;
} Volumes;

static u32 layer_words(const Packet *packet) {
    const u32 *dims = packet->gi.record.dims;
    return dims[0] * dims[1] * dims[2] * dims[3] / 32;
}

static u32 *read_words(Studio *studio, GiVolume which, u32 count) {
    u32 *out = ARENA_PUSH(&studio->images, u32, MAX(count, 1));
    if (count)
        assert_int_equal(renderer_read_gi(studio->renderer, which, out, count * 4ull),
                         count * 4ull);
    return out;
}

static Volumes draw(Studio *studio, const Packet *packet) {
    Volumes v = {.words = layer_words(packet)};
    assert_true(
        renderer_render_image(studio->renderer, packet, &studio->images, &(RenderImage){0}));
    renderer_read_gi(studio->renderer, GI_VOLUME_COUNTERS, v.counters, sizeof v.counters);
    assert_int_equal(v.counters[GI_COUNTER_LOST], 0);
    v.slots = v.counters[GI_COUNTER_STATIC] + v.counters[GI_COUNTER_DYNAMIC];
    v.masks = read_words(studio, GI_VOLUME_MASKS, v.words * 2);
    v.ranks = read_words(studio, GI_VOLUME_RANKS, v.words * 2);
    v.voxels = read_words(studio, GI_VOLUME_VOXELS, v.slots);
    v.attributes = read_words(studio, GI_VOLUME_ATTRIBUTES, v.slots * GI_ATTRIBUTE_WORDS);
    return v;
}

static void assert_same(const Volumes *a, const Volumes *b, const char *what) {
    assert_int_equal(a->words, b->words);
    if (memcmp(a->masks, b->masks, a->words * 8ull) != 0) fail_msg("%s: other voxels", what);
    if (memcmp(a->counters, b->counters, sizeof a->counters) != 0)
        fail_msg("%s: other counters", what);
    for (u32 w = 0; w < 2 * a->words; w++)
        if (a->masks[w] && a->ranks[w] != b->ranks[w]) fail_msg("%s: other ranks", what);
    if (memcmp(a->voxels, b->voxels, a->slots * 4ull) != 0) fail_msg("%s: other places", what);
    for (u32 i = 0; i < a->slots * GI_ATTRIBUTE_WORDS; i++)
        if (a->attributes[i] != b->attributes[i])
            fail_msg("%s: attribute %u of slot %u of %u is %08x, %08x", what,
                     i % GI_ATTRIBUTE_WORDS, i / GI_ATTRIBUTE_WORDS, a->slots, a->attributes[i],
                     b->attributes[i]);
}

static void assert_masks(const Volumes *v, const TwinVoxels *twin, const char *what) {
    u32 counted = 0;
    for (u32 layer = 0; layer < 2; layer++)
        for (u32 w = 0; w < v->words; w++) {
            u32 there = v->masks[layer * v->words + w];
            if (there != twin->masks[layer][w])
                fail_msg("%s: layer %u word %u is %08x, the twin's %08x", what, layer, w, there,
                         twin->masks[layer][w]);
            counted += (u32)__builtin_popcount(there);
        }
    if (counted != v->slots) fail_msg("%s: %u voxels, %u slots", what, counted, v->slots);
}

// Ranks count bits, and places are those of the bits, in their order.
static void assert_slots(const Volumes *v, const Packet *packet) {
    const u32 *dims = packet->gi.record.dims;
    u32 slot = 0;
    for (u32 w = 0; w < 2 * v->words; w++) {
        if (v->masks[w]) assert_int_equal(v->ranks[w], slot);
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
static void assert_attributes(const Volumes *v, const TwinVoxels *twin, const char *what) {
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

// --- Packets ---

static const char *const way_names[] = {"auto", "raster", "compute"};

static const Packet *level_packet(Studio *studio, const char *settings_list) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, "gi.enabled=on,gi.cascades=1"));
    assert_true(settings_set_list(&settings, settings_list));
    session_frame_begin(&studio->session);
    const Packet *packet = session_packet(
        &studio->session,
        &(SessionView){.settings = settings, .width_px = WIDTH, .height_px = HEIGHT, .cold = true});
    assert_non_null(packet);
    assert_true(packet->gi.params.enabled);
    return packet;
}

// A copy whose voxels come from these meshes instead: nothing else is drawn. Room for changes.
typedef struct Scene {
    InstanceRecord instances[8];
    PacketDraw statics[8], dynamics[8];
    u32 instance_count, static_count, dynamic_count;
    MaterialRecord materials[4];
    PacketMaterial bindings[4];
} Scene;

static Packet *scene_packet(Studio *studio, const Packet *base, const Scene *scene) {
    u64 size = ALIGN_UP(base->size, CACHE_LINE), at = size;
    Packet *packet = arena_push(&studio->images, size + sizeof *scene + 1024, CACHE_LINE);
    memcpy(packet, base, base->size);
#define APPEND(section, from, how_many)                                                            \
    packet->section = (PacketSection){(u32)at, (how_many)};                                        \
    memcpy((u8 *)packet + at, (from), (how_many) * sizeof *(from));                                \
    at = ALIGN_UP(at + (how_many) * sizeof *(from), CACHE_LINE)
    APPEND(gi_instances, scene->instances, scene->instance_count);
    APPEND(gi_static_draws, scene->statics, scene->static_count);
    APPEND(gi_dynamic_draws, scene->dynamics, scene->dynamic_count);
    APPEND(materials, scene->materials, 4);
    APPEND(material_bindings, scene->bindings, 4);
#undef APPEND
    packet->opaque_draws.count = packet->mask_draws.count = packet->blend_draws.count = 0;
    packet->emissive_draws.count = packet->shadow_draws.count = 0;
    packet->shadow_mask_draws.count = 0;
    packet->size = at;
    static u64 key = 1000;
    packet->gi.static_key = key++;
    packet->gi.dynamic_key = key++;
    return packet;
}

static void place(InstanceRecord *out, const f32 axes[3][3], const f32 at[3], u32 material) {
    for (u32 k = 0; k < 3; k++)
        for (u32 i = 0; i < 3; i++) out->world[k][i] = axes[i][k];
    for (u32 k = 0; k < 3; k++) out->world[k][3] = at[k];
    out->ids[0] = material;
}

static const f32 upright[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
// Turned about an odd axis, and stretched.
static const f32 askew[3][3] = {
    {0.804738f, 0.310617f, -0.505879f}, {-0.505879f, 0.804738f, -0.310617f}, {0.45f, 0.7f, 1.2f}};

static void plain_materials(Scene *scene) {
    for (u32 i = 0; i < 4; i++) {
        const f32 albedo[4] = {0.2f + 0.2f * (f32)i, 0.9f - 0.2f * (f32)i, 0.5f, 0.5f};
        memcpy(scene->materials[i].albedo, albedo, sizeof albedo);
        scene->bindings[i] = (PacketMaterial){.double_sided = i == 3};
    }
    const f32 glow[3] = {30.0f, 4.0f, 0.01f};
    memcpy(scene->materials[2].emissive, glow, sizeof glow);
}

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
    const Packet *base = level_packet(&studio, list);
    AssetStore store;
    assert_true(asset_store_create(&store));
    Scene scene = {.instance_count = 3, .static_count = 2};
    plain_materials(&scene);
    u32 mesh = soup_mesh(&store, &base->gi.record, count);
    const f32 *origin = base->gi.record.origin[0];
    const f32 moved[3] = {0.31f * origin[0], 0.11f, -0.2f}, still[3] = {0};
    place(&scene.instances[0], upright, still, 0);
    place(&scene.instances[1], askew, moved, 0);
    place(&scene.instances[2], upright, (const f32[]){0.013f, 0.02f, 0.07f}, 2);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 0, .instance_count = 2};
    scene.statics[1] =
        (PacketDraw){.mesh = mesh, .material = 2, .first_instance = 2, .instance_count = 1};
    assert_true(renderer_set_assets(studio.renderer, &store));
    Packet *packet = scene_packet(&studio, base, &scene);
    TwinVoxels twin = twin_voxelise(packet, &store, true, &studio.images);
    Volumes first = {0};
    for (u32 way = 0; way < 3; way++) {
        packet->gi.params.voxeliser = way;
        packet->gi.static_key += 10;
        Volumes v = draw(&studio, packet);
        assert_masks(&v, &twin, way_names[way]);
        assert_slots(&v, packet);
        if (way == 0) {
            first = v;
            snprintf(list, sizeof list, "%u^3, %u voxels", side, v.slots);
            assert_attributes(&v, &twin, list);
        }
        assert_same(&first, &v, way_names[way]);
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
    Volumes first = {0};
    for (u32 way = 0; way < 3; way++) {
        char list[160];
        snprintf(list, sizeof list, "gi.diffuse=none,gi.voxeliser=%s,%s", way_names[way], settings);
        const Packet *packet = level_packet(&studio, list);
        u64 mark = arena_mark(&studio.images);
        TwinVoxels twin = {0};
        if (way == 0) twin = twin_voxelise(packet, &studio.session.assets, false, &studio.images);
        Packet *own = arena_push(&studio.images, packet->size, CACHE_LINE);
        memcpy(own, packet, packet->size);
        own->gi.static_key += way, own->gi.dynamic_key += way;
        Volumes v = draw(&studio, own);
        assert_slots(&v, packet);
        const PacketMaterial *materials = PACKET_DATA(packet, material_bindings, PacketMaterial);
        bool has_holes = false;
        for (u32 i = 0; i < packet->material_bindings.count; i++)
            has_holes |= materials[i].alpha_mode == 1;
        if (way == 0) {
            first = v;
            if (!has_holes) assert_masks(&v, &twin, level);
            for (u32 w = 0; w < v.words; w++)
                if (v.masks[w] & ~twin.masks[0][w])
                    fail_msg("%s: a voxel that nothing touches", level);
            printf("    %s %s: %u static, %u dynamic voxels%s\n", level, settings,
                   v.counters[GI_COUNTER_STATIC], v.counters[GI_COUNTER_DYNAMIC],
                   has_holes ? " (with holes)" : "");
            assert_true(v.slots > 100);
        } else {
            assert_same(&first, &v, way_names[way]);
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
    const Packet *base = level_packet(&studio, "gi.grid=32,gi.diffuse=none");
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
    Scene scene = {.instance_count = 1, .static_count = 1};
    place(&scene.instances[0], upright, (const f32[3]){0}, 0);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .instance_count = 1};
    for (u32 k = 0; k < 3; k++) {
        scene.materials[0].albedo[k] = 1.0f;
        scene.materials[0].emissive[k] = (f32)(k + 1) * 20000.0f;
    }
    Volumes v = draw(&studio, scene_packet(&studio, base, &scene));
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

// More occupied voxels than the buffers first have room for: drawn again until none is lost.
TEST_GPU(gi_voxels, a_full_grid_finds_room) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *base = level_packet(&studio, "gi.grid=32,gi.diffuse=none");
    AssetStore store;
    assert_true(asset_store_create(&store));
    u32 mesh = soup_mesh(&store, &base->gi.record, 3000);
    assert_true(renderer_set_assets(studio.renderer, &store));
    Scene scene = {.instance_count = 2, .static_count = 1, .dynamic_count = 1};
    plain_materials(&scene);
    place(&scene.instances[0], upright, (const f32[3]){0}, 1);
    place(&scene.instances[1], askew, (const f32[3]){0}, 1);
    scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 1, .instance_count = 1};
    scene.dynamics[0] =
        (PacketDraw){.mesh = mesh, .material = 1, .first_instance = 1, .instance_count = 1};
    Packet *packet = scene_packet(&studio, base, &scene);
    Volumes v = draw(&studio, packet);
    TwinVoxels twin = twin_voxelise(packet, &store, false, &studio.images);
    assert_masks(&v, &twin, "full grid");
    assert_slots(&v, packet);
    assert_true(v.slots > 20000);
    for (u32 w = 0; w < v.words; w++) assert_int_equal(v.masks[w] & v.masks[v.words + w], 0);
    asset_store_destroy(&store);
    studio_close(&studio);
}

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
    Scene scene;
    const Packet *base;
} Moving;

// A static torus, a dynamic one that can be elsewhere.
static void moving_open(Moving *m, const char *settings) {
    memset(m, 0, sizeof *m);
    studio_open(&m->studio, "data/levels/cornell.toml");
    m->base = level_packet(&m->studio, settings);
    assert_true(asset_store_create(&m->store));
    u32 model = asset_generate_model(&m->store, &(ShapeDesc){.shape = SHAPE_TORUS});
    u32 mesh = m->store.models[model].parts[0].mesh;
    assert_true(renderer_set_assets(m->studio.renderer, &m->store));
    m->scene.instance_count = 2;
    m->scene.static_count = m->scene.dynamic_count = 1;
    plain_materials(&m->scene);
    m->scene.statics[0] = (PacketDraw){.mesh = mesh, .material = 1, .instance_count = 1};
    m->scene.dynamics[0] =
        (PacketDraw){.mesh = mesh, .material = 2, .first_instance = 1, .instance_count = 1};
}
static void moving_close(Moving *m) {
    asset_store_destroy(&m->store);
    studio_close(&m->studio);
}
// At a share of the way through the box.
static Volumes moving_draw(Moving *m, f32 share, u64 key, u32 flags) {
    const GiRecord *record = &m->base->gi.record;
    f32 middle[3], at[3];
    for (u32 k = 0; k < 3; k++) {
        middle[k] = record->origin[0][k] + 0.5f * (f32)record->dims[k] * record->origin[0][3];
        at[k] = middle[k];
    }
    at[0] += (share - 0.5f) * (f32)record->dims[0] * record->origin[0][3];
    place(&m->scene.instances[0], upright, middle, 1);
    place(&m->scene.instances[1], askew, at, 2);
    Packet *packet = scene_packet(&m->studio, m->base, &m->scene);
    packet->gi.static_key = 77;
    packet->gi.dynamic_key = key;
    packet->flags = flags;
    return draw(&m->studio, packet);
}

TEST_GPU(gi_voxels, what_moves_leaves_nothing_behind) {
    Moving m;
    moving_open(&m, "gi.grid=64");
    static const GiVolume volumes[] = {GI_VOLUME_BASE, GI_VOLUME_ATLAS, GI_VOLUME_IRRADIANCE,
                                       GI_VOLUME_VISIBILITY};
    u64 before[COUNT_OF(volumes)];
    Volumes here = moving_draw(&m, 0.5f, 5, 0);
    for (u32 i = 0; i < COUNT_OF(volumes); i++) before[i] = hash_volume(&m.studio, volumes[i]);
    Volumes there = moving_draw(&m, 0.2f, 6, 0);
    assert_memory_not_equal(there.masks, here.masks, here.words * 8);
    assert_memory_equal(there.masks, here.masks, here.words * 4); // the static layer
    assert_memory_equal(there.attributes, here.attributes,
                        here.counters[GI_COUNTER_STATIC] * GI_ATTRIBUTE_WORDS * 4);
    Volumes gone = moving_draw(&m, 9.0f, 7, 0); // out of the box
    assert_int_equal(gone.counters[GI_COUNTER_DYNAMIC], 0);
    Volumes back = moving_draw(&m, 0.5f, 8, 0);
    assert_same(&here, &back, "moved and back");
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
    Volumes here = moving_draw(&m, 0.5f, 5, 0); // nothing changed
    RendererStats stats = renderer_stats(m.studio.renderer);
    assert_int_equal(stats.gi_static_voxelised, 1);
    assert_int_equal(stats.gi_dynamic_voxelised, 1);
    // Light alone.
    Packet *light = scene_packet(&m.studio, m.base, &m.scene);
    light->gi.static_key = 77, light->gi.dynamic_key = 5, light->flags = 0;
    light->gi.light_key++;
    u32 relit = stats.gi_relit;
    draw(&m.studio, light);
    stats = renderer_stats(m.studio.renderer);
    assert_int_equal(stats.gi_relit, relit + 1);
    assert_int_equal(stats.gi_static_voxelised, 1);
    assert_int_equal(stats.gi_dynamic_voxelised, 1);
    // Moved, but never to be voxelised again: unless the picture must not hang on the past.
    Packet *never = arena_push(&m.studio.images, m.base->size, CACHE_LINE);
    memcpy(never, m.base, m.base->size);
    never->gi.params.policy = GI_POLICY_NEVER;
    m.base = never;
    Volumes kept = moving_draw(&m, 0.2f, 6, 0);
    assert_int_equal(renderer_stats(m.studio.renderer).gi_dynamic_voxelised, 1);
    assert_same(&here, &kept, "policy never");
    Volumes cold = moving_draw(&m, 0.2f, 6, PACKET_COLD);
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
    const Packet *base = level_packet(&studio, "gi.grid=32,gi.diffuse=none,gi.solid=on");
    assert_true(base->gi.params.solid);
    AssetStore store;
    assert_true(asset_store_create(&store));
    u32 model = asset_generate_model(&store, &(ShapeDesc){.shape = shape, .inverted = inverted});
    u32 mesh = store.models[model].parts[0].mesh;
    assert_true(renderer_set_assets(studio.renderer, &store));
    Scene scene = {
        .instance_count = 2, .static_count = dynamic ? 0 : 1, .dynamic_count = dynamic ? 1 : 0};
    plain_materials(&scene);
    const GiRecord *record = &base->gi.record;
    f32 voxel = record->origin[0][3], axes[3][3], middle[2][3];
    // Two that overlap: parity must not take away what both hold.
    for (u32 k = 0; k < 3; k++) {
        for (u32 i = 0; i < 3; i++) axes[k][i] = askew[k][i] * voxel * 12.0f;
        for (u32 n = 0; n < 2; n++)
            middle[n][k] = record->origin[0][k] +
                           (0.5f * (f32)record->dims[k] + 0.37f + 2.0f * (f32)n) * voxel;
    }
    for (u32 n = 0; n < 2; n++) place(&scene.instances[n], axes, middle[n], 0);
    scene.statics[0] = scene.dynamics[0] = (PacketDraw){.mesh = mesh, .instance_count = 2};
    Packet *packet = scene_packet(&studio, base, &scene);
    Volumes v = draw(&studio, packet);
    TwinVoxels twin = twin_voxelise(packet, &store, false, &studio.images);
    u32 *masks = read_words(&studio, GI_VOLUME_MASKS, v.words * GI_MASK_COUNT);
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
        v = draw(&studio, packet);
        assert_int_equal(v.slots, 0);
        masks = read_words(&studio, GI_VOLUME_MASKS, v.words * GI_MASK_COUNT);
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
