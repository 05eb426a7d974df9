// voxel_fixture.c: see voxel_fixture.h.
#include "voxel_fixture.h"
#include <string.h>

#define WIDTH  32
#define HEIGHT 18

// --- What the device made ---

static u32 layer_words(const Packet *packet) {
    const u32 *dims = packet->gi.record.dims;
    return dims[0] * dims[1] * dims[2] * dims[3] / 32;
}

u32 *voxel_read_words(Studio *studio, GiVolume which, u32 count) {
    u32 *out = ARENA_PUSH(&studio->images, u32, MAX(count, 1));
    if (count)
        assert_int_equal(renderer_read_gi(studio->renderer, which, out, count * 4ull),
                         count * 4ull);
    return out;
}

VoxelVolumes voxel_draw(Studio *studio, const Packet *packet) {
    VoxelVolumes v = {.words = layer_words(packet)};
    assert_true(
        renderer_render_image(studio->renderer, packet, &studio->images, &(RenderImage){0}));
    renderer_read_gi(studio->renderer, GI_VOLUME_COUNTERS, v.counters, sizeof v.counters);
    assert_int_equal(v.counters[GI_COUNTER_LOST], 0);
    v.slots = v.counters[GI_COUNTER_STATIC] + v.counters[GI_COUNTER_DYNAMIC];
    v.masks = voxel_read_words(studio, GI_VOLUME_MASKS, v.words * 2);
    v.ranks = voxel_read_words(studio, GI_VOLUME_RANKS, v.words * 2 / GI_RANK_WORDS);
    v.voxels = voxel_read_words(studio, GI_VOLUME_VOXELS, v.slots);
    v.attributes = voxel_read_words(studio, GI_VOLUME_ATTRIBUTES, v.slots * GI_ATTRIBUTE_WORDS);
    return v;
}

void voxel_assert_same(const VoxelVolumes *a, const VoxelVolumes *b, const char *what) {
    assert_int_equal(a->words, b->words);
    if (memcmp(a->masks, b->masks, a->words * 8ull) != 0) fail_msg("%s: other voxels", what);
    if (memcmp(a->counters, b->counters, sizeof a->counters) != 0)
        fail_msg("%s: other counters", what);
    if (memcmp(a->ranks, b->ranks, a->words * 8ull / GI_RANK_WORDS) != 0)
        fail_msg("%s: other ranks", what);
    if (memcmp(a->voxels, b->voxels, a->slots * 4ull) != 0) fail_msg("%s: other places", what);
    for (u32 i = 0; i < a->slots * GI_ATTRIBUTE_WORDS; i++)
        if (a->attributes[i] != b->attributes[i])
            fail_msg("%s: attribute %u of slot %u of %u is %08x, %08x", what,
                     i % GI_ATTRIBUTE_WORDS, i / GI_ATTRIBUTE_WORDS, a->slots, a->attributes[i],
                     b->attributes[i]);
}

void voxel_assert_masks(const VoxelVolumes *v, const TwinVoxels *twin, const char *what) {
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

// --- Packets ---

const Packet *voxel_packet(Studio *studio, const char *settings_list) {
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

Packet *voxel_scene_packet(Studio *studio, const Packet *base, const VoxelScene *scene) {
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

void voxel_place(InstanceRecord *out, const f32 axes[3][3], const f32 at[3], u32 material) {
    for (u32 k = 0; k < 3; k++)
        for (u32 i = 0; i < 3; i++) out->world[k][i] = axes[i][k];
    for (u32 k = 0; k < 3; k++) out->world[k][3] = at[k];
    out->ids[0] = material;
}

const f32 voxel_upright[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const f32 voxel_askew[3][3] = {
    {0.804738f, 0.310617f, -0.505879f}, {-0.505879f, 0.804738f, -0.310617f}, {0.45f, 0.7f, 1.2f}};

void voxel_scene_materials(VoxelScene *scene) {
    for (u32 i = 0; i < 4; i++) {
        const f32 albedo[4] = {0.2f + 0.2f * (f32)i, 0.9f - 0.2f * (f32)i, 0.5f, 0.5f};
        memcpy(scene->materials[i].albedo, albedo, sizeof albedo);
        scene->bindings[i] = (PacketMaterial){.double_sided = i == 3};
    }
    const f32 glow[3] = {30.0f, 4.0f, 0.01f};
    memcpy(scene->materials[2].emissive, glow, sizeof glow);
}
