// gi_bricks.c: the base volume in bricks holds what the whole one does, texel by texel, and
// pictures look the same. Data in: small scenes. Data out: read-backs. Called by: the runner.
#include "voxel_fixture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Scene {
    Studio studio;
    AssetStore store;
    VoxelScene voxels;
    u32 draws; // keys of dynamic voxels
} Scene;

// A static mesh of a size (as a share of the box), and a dynamic torus that can be elsewhere.
static void scene_open(Scene *s, Shape shape) {
    memset(s, 0, sizeof *s);
    studio_open(&s->studio, "data/levels/cornell.toml");
    assert_true(asset_store_create(&s->store));
    const Shape shapes[2] = {shape, SHAPE_TORUS};
    voxel_scene_materials(&s->voxels);
    s->voxels.instance_count = 2;
    s->voxels.static_count = s->voxels.dynamic_count = 1;
    for (u32 i = 0; i < 2; i++) {
        u32 model = asset_generate_model(&s->store, &(ShapeDesc){.shape = shapes[i]});
        PacketDraw draw = {.mesh = s->store.models[model].parts[0].mesh,
                           .material = 1 + i,
                           .first_instance = i,
                           .instance_count = 1};
        *(i ? s->voxels.dynamics : s->voxels.statics) = draw;
    }
    assert_true(renderer_set_assets(s->studio.renderer, &s->store));
}
static void scene_close(Scene *s) {
    asset_store_destroy(&s->store);
    studio_close(&s->studio);
}
static VoxelVolumes scene_draw(Scene *s, const char *settings, f32 size, f32 share,
                               const Packet **out) {
    const Packet *base = voxel_packet(&s->studio, settings);
    const GiRecord *record = &base->gi.record;
    f32 axes[3][3] = {{0}}, middle[3], at[3], side = (f32)record->dims[0] * record->origin[0][3];
    u32 coarsest = record->dims[3] - 1;
    for (u32 k = 0; k < 3; k++) {
        f32 voxel = record->origin[coarsest][3];
        middle[k] = record->origin[coarsest][k] + 0.5f * (f32)record->dims[k] * voxel;
        at[k] = middle[k];
        axes[k][k] = size * (f32)record->dims[k] * voxel;
    }
    at[0] += (share - 0.5f) * side;
    voxel_place(&s->voxels.instances[0], axes, middle, 1);
    voxel_place(&s->voxels.instances[1], voxel_askew, at, 2);
    Packet *packet = voxel_scene_packet(&s->studio, base, &s->voxels);
    packet->gi.static_key = 77;
    packet->gi.dynamic_key = ++s->draws;
    packet->flags = 0;
    *out = packet;
    return voxel_draw(&s->studio, packet);
}

static u8 *read_all(Studio *studio, GiVolume which, u64 *size) {
    static u8 bytes[64 << 20];
    *size = renderer_read_gi(studio->renderer, which, bytes, sizeof bytes);
    assert_true(*size > 0 && *size < sizeof bytes);
    u8 *out = ARENA_PUSH(&studio->images, u8, *size);
    memcpy(out, bytes, *size);
    return out;
}

// The naive twin of gi_base_fetch's look-up: each texel of each cell's brick is the voxel's of the
// whole volume; cells without a brick have nothing there.
static u32 compare(Scene *s, const char *settings, f32 size, f32 share) {
    char list[256];
    const Packet *packet;
    u64 bytes;
    snprintf(list, sizeof list, "gi.base=whole,%s", settings);
    scene_draw(s, list, size, share, &packet);
    u8 *whole = read_all(&s->studio, GI_VOLUME_BASE, &bytes);
    u8 *whole_atlas = read_all(&s->studio, GI_VOLUME_ATLAS, &bytes);
    u64 atlas_bytes = bytes;
    snprintf(list, sizeof list, "gi.base=bricks,%s", settings);
    VoxelVolumes v = scene_draw(s, list, size, share, &packet);
    u8 *atlas = read_all(&s->studio, GI_VOLUME_ATLAS, &bytes);
    assert_true(bytes == atlas_bytes);
    assert_memory_equal(atlas, whole_atlas, bytes);
    u8 *index = read_all(&s->studio, GI_VOLUME_BRICKS, &bytes);
    u8 *pool = read_all(&s->studio, GI_VOLUME_BASE, &bytes);
    const u32 *dims = packet->gi.record.dims, depth = dims[2] * dims[3];
    const u32 along = GI_BRICK_ROW * GI_BRICK_SIDE;
    const u64 texel = packet->gi.params.format == GI_FORMAT_BYTE ? 4 : 8;
    const u32 cells[3] = {dims[0] / 8, dims[1] / 8, depth / 8};
    const u8 nothing[8] = {0};
    u32 used = 1;
    for (u32 c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
        u32 cell[3] = {c % cells[0], c / cells[0] % cells[1], c / (cells[0] * cells[1])};
        const u8 *brick = index + 4ull * c;
        if (brick[0] || brick[1] || brick[2]) {
            u32 number = brick[0] + GI_BRICK_ROW * (brick[1] + GI_BRICK_ROW * (u32)brick[2]);
            assert_int_equal(number, used);
            used++;
        }
        for (u32 i = 0; i < 9 * 9 * 9; i++) {
            u32 in[3] = {i % 9, i / 9 % 9, i / 81}, place[3], at[3];
            for (u32 k = 0; k < 3; k++)
                place[k] = cell[k] * 8 + in[k], at[k] = brick[k] * 9u + in[k];
            bool inside = place[0] < dims[0] && place[1] < dims[1] && place[2] < depth;
            u64 from = place[0] + dims[0] * (place[1] + (u64)dims[1] * place[2]);
            u64 to = at[0] + along * (at[1] + (u64)along * at[2]);
            if (memcmp(inside ? whole + from * texel : nothing, pool + to * texel, texel) != 0)
                fail_msg("cell %u %u %u texel %u %u %u is another", cell[0], cell[1], cell[2],
                         in[0], in[1], in[2]);
        }
    }
    assert_int_equal(v.counters[GI_COUNTER_BRICKS], used);
    printf("    %u voxels, %u bricks of %u cells\n", v.slots, used, cells[0] * cells[1] * cells[2]);
    assert_true(used > 20);
    return used;
}

TEST_GPU(gi_bricks, hold_what_the_whole_volume_does) {
    Scene s;
    scene_open(&s, SHAPE_TORUS);
    compare(&s, "gi.grid=64,gi.bounces=1,gi.diffuse=none", 0.4f, 0.5f);
    scene_close(&s);
}
TEST_GPU(gi_bricks, follow_what_moves) {
    Scene s;
    const Packet *packet;
    scene_open(&s, SHAPE_TORUS);
    const char *list = "gi.base=bricks,gi.grid=64,gi.format=byte,gi.bounces=1,gi.diffuse=none";
    scene_draw(&s, list, 0.4f, 0.2f, &packet);
    compare(&s, strchr(list, ',') + 1, 0.4f, 0.7f);
    scene_close(&s);
}
TEST_GPU(gi_bricks, nested_grids_too) {
    Scene s;
    scene_open(&s, SHAPE_TORUS);
    compare(&s, "gi.grid=32,gi.cascades=3,gi.bounces=1,gi.diffuse=none", 0.4f, 0.5f);
    scene_close(&s);
}
// More bricks than were thought of at first: the image grows.
TEST_GPU(gi_bricks, a_full_grid_finds_room) {
    Scene s;
    scene_open(&s, SHAPE_CUBE);
    const char *list = "gi.grid=128,gi.format=byte,gi.solid=on,gi.bounces=1,gi.diffuse=none";
    assert_true(compare(&s, list, 0.8f, 0.5f) > 2 * GI_BRICK_LAYER);
    scene_close(&s);
}

// What is blended differs by rounding alone, wherever it is read: by bounces, cones, probes and
// mirrors.
static void looks_the_same(const char *level, const char *settings) {
    Studio studios[2];
    RenderImage images[2];
    for (u32 i = 0; i < 2; i++) {
        studio_open(&studios[i], level);
        RenderSettings of = settings_default();
        assert_true(settings_set_list(&of, "gi.enabled=on,gi.grid=64"));
        assert_true(settings_set_list(&of, settings));
        assert_true(settings_set_list(&of, i ? "gi.base=bricks" : "gi.base=whole"));
        images[i] = studio_draw(&studios[i], NULL, &of, 192, 108);
    }
    u32 most = 0, other = 0;
    for (u32 i = 0; i < 192 * 108 * 4; i++) {
        u32 off = (u32)abs((i32)images[0].rgba[i] - (i32)images[1].rgba[i]);
        most = MAX(most, off);
        other += off > 0;
    }
    printf("    %s, %s: %u of %u bytes differ, by %u at most\n", level, settings, other,
           192 * 108 * 4, most);
    assert_true(most <= 2 && other < 192 * 108 * 4 / 20);
    for (u32 i = 0; i < 2; i++) studio_close(&studios[i]);
}
TEST_GPU(gi_bricks, look_as_the_whole_volume_by_cones) {
    looks_the_same("data/levels/cornell.toml",
                   "gi.diffuse=cones,gi.resolution=full,gi.mips=linear");
}
TEST_GPU(gi_bricks, look_as_the_whole_volume_by_probes) {
    looks_the_same("data/levels/moving_door.toml", "gi.diffuse=probes,gi.cascades=2");
}
TEST_GPU(gi_bricks, look_as_the_whole_volume_in_views) {
    looks_the_same("data/levels/light_box.toml", "view=gi_voxels");
}
