// gi_keys.c: what voxels hang on, as hashes of contents, and the flags that say it changed.
// Data in: a packet whose sections are complete; the world's stamps. Data out: PacketGi's keys,
// PACKET_REVOXELISE and PACKET_RELIGHT. Called by: packet_build. Does not: remember anything.
//
// Keys are of contents, not of places: a material's index in the palette, an entity's handle, an
// asset's order of loading do not matter, so what moves there and back has its old key again.
#include "gi.h"
#include "../base/hash.h"
#include <string.h>

// ---- contents ----

// Of a grid: where its voxels are, and what decides which of them are full.
static u64 hash_grid(const PacketGi *gi, u64 key) {
    const u32 words[] = {gi->params.solid, gi->params.voxeliser};
    key = hash_bytes(gi->record.origin, sizeof gi->record.origin, key);
    key = hash_bytes(gi->record.dims, sizeof gi->record.dims, key);
    return hash_bytes(words, sizeof words, key);
}

static u64 hash_surface(const MaterialRecord *record, const PacketMaterial *binding, u64 key) {
    const u32 words[] = {binding->albedo_texture, binding->normal_texture, binding->alpha_mode,
                         binding->double_sided};
    const f32 receives = record->emissive[3];
    key = hash_bytes(record->albedo, sizeof record->albedo, key);
    key = hash_bytes(&receives, sizeof receives, key);
    return hash_bytes(words, sizeof words, key);
}

static u64 hash_emission(const MaterialRecord *record, const PacketMaterial *binding, u64 key) {
    const f32 numbers[] = {record->emissive[0], record->emissive[1], record->emissive[2],
                           record->extra[1],    record->extra[2],    record->extra[3]};
    key = hash_bytes(numbers, sizeof numbers, key);
    return hash_bytes(&binding->emissive_texture, sizeof binding->emissive_texture, key);
}

typedef struct DrawKeys {
    u64 surface, emission;
} DrawKeys;

static DrawKeys hash_draws(const Packet *packet, PacketSection section, DrawKeys keys) {
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + section.offset);
    const InstanceRecord *instances = PACKET_DATA(packet, gi_instances, InstanceRecord);
    const MaterialRecord *records = PACKET_DATA(packet, materials, MaterialRecord);
    const PacketMaterial *bindings = PACKET_DATA(packet, material_bindings, PacketMaterial);
    for (u32 i = 0; i < section.count; i++) {
        const PacketDraw *draw = &draws[i];
        const u32 words[] = {draw->mesh, draw->instance_count};
        keys.surface = hash_bytes(words, sizeof words, keys.surface);
        keys.surface =
            hash_surface(&records[draw->material], &bindings[draw->material], keys.surface);
        for (u32 k = 0; k < draw->instance_count; k++) {
            const InstanceRecord *instance = &instances[draw->first_instance + k];
            keys.surface = hash_bytes(instance->world, sizeof instance->world, keys.surface);
        }
        keys.emission =
            hash_emission(&records[draw->material], &bindings[draw->material], keys.emission);
    }
    return keys;
}

static bool reads_shadow_map(const Packet *packet) {
    const DirectionalRecord *suns = PACKET_DATA(packet, directionals, DirectionalRecord);
    for (u32 i = 0; i < packet->directionals.count; i++)
        if (suns[i].direction[3] == (f32)VOXEL_SHADOW_MAP) return true;
    return false;
}

// All that a voxel's radiance follows from beside the voxels themselves. Not how the screen shows
// it: strength, resolution, AO.
static u64 hash_lighting(const Packet *packet, u64 key) {
    const GiParams *p = &packet->gi.params;
    const GiRecord *record = &packet->gi.record;
    const FrameRecord *frame = &packet->frame;
    const u32 words[] = {p->format,   p->cosine,  p->faces, p->filter,          p->bounces,
                         p->feedback, p->diffuse, p->mips,  packet->attenuation};
    const f32 numbers[] = {p->byte_radiance, p->hit,    p->step_factor, p->diffuse_aperture,
                           p->distance,      p->offset, p->sky};
    key = hash_bytes(words, sizeof words, key);
    key = hash_bytes(numbers, sizeof numbers, key);
    key = hash_bytes(record->atlas, sizeof record->atlas, key);
    if (p->diffuse == GI_DIFFUSE_PROBES) {
        key = hash_bytes(record->probes, 3 * sizeof record->probes[0], key);
        key = hash_bytes(record->probe_origin, sizeof record->probe_origin, key);
    }
    if (packet->attenuation == ATTENUATION_POLYNOMIAL)
        key = hash_bytes(frame->attenuation, sizeof frame->attenuation, key);
    if (p->sky > 0.0f) {
        key = hash_bytes(frame->sky_zenith, 3 * sizeof(f32), key);
        key = hash_bytes(frame->sky_horizon, 3 * sizeof(f32), key);
    }
    const DirectionalRecord *suns = PACKET_DATA(packet, directionals, DirectionalRecord);
    for (u32 i = 0; i < packet->directionals.count; i++)
        if (suns[i].direction[3] >= 0.0f) key = hash_bytes(&suns[i], sizeof suns[i], key);
    if (reads_shadow_map(packet))
        key = hash_bytes(&packet->shadow_key, sizeof packet->shadow_key, key);
    return hash_bytes(PACKET_DATA(packet, gi_lights, GiLightRecord),
                      (u64)packet->gi_lights.count * sizeof(GiLightRecord), key);
}

// 0 means "nothing" to whoever keeps a key.
static u64 not_zero(u64 key) { return key ? key : 1; }

void gi_write_keys(Packet *packet, u64 asset_stamp) {
    PacketGi *gi = &packet->gi;
    if (!gi->params.enabled) return;
    const u64 grid = hash_grid(gi, asset_stamp);
    DrawKeys still = hash_draws(packet, packet->gi_static_draws, (DrawKeys){grid, grid});
    DrawKeys moving = hash_draws(packet, packet->gi_dynamic_draws, (DrawKeys){grid + 1, grid + 1});
    gi->static_key = not_zero(hash_bytes(&still, sizeof still, 0));
    gi->dynamic_key = not_zero(hash_bytes(&moving, sizeof moving, 0));
    const u64 surfaces[] = {still.surface, moving.surface};
    const u64 emissions[] = {grid, still.emission, moving.emission};
    gi->surface_key = not_zero(hash_bytes(surfaces, sizeof surfaces, 0));
    gi->light_key = not_zero(hash_lighting(packet, hash_bytes(emissions, sizeof emissions, 0)));
}

// ---- flags ----

// Did rows of what is voxelised change? Static ones count if there is GI: its voxels are kept else.
static bool voxelised_changed(const World *world, bool has_gi, bool materials_count, u32 since) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const MaterialTable *materials = WORLD_TABLE(world, Material, material);
    // Rows that came or went, and modes that were switched, do not tell what they were before.
    if (d->table.structure_stamp >= since || table_changed_since(&instances->table, since))
        return true;
    materials_count = materials_count && table_changed_since(&materials->table, since);
    if (!materials_count && !table_changed_since(&d->table, since)) return false;
    for (u32 row = 0; row < d->table.count; row++) {
        u32 place = materials_count ? table_row(&materials->table, d->material[row]) : ROW_NONE;
        bool changed = d->table.stamp[row] >= since ||
                       (place != ROW_NONE && materials->table.stamp[place] >= since);
        if (!changed) continue;
        u32 owner = table_row(&instances->table, d->owner[row]);
        u32 mode = owner == ROW_NONE ? VOXEL_NONE : instances->voxel_mode[owner];
        if (mode == VOXEL_DYNAMIC || (mode == VOXEL_STATIC && has_gi)) return true;
    }
    return false;
}

u32 gi_find_flags(const World *world, const PacketGi *gi, const PacketGi *previous, u32 since) {
    // Stamps at or after the previous packet's: an edit between that packet and the next tick
    // carries the same stamp as the packet saw.
    if (since == 0) return PACKET_REVOXELISE | PACKET_RELIGHT;
    bool has_gi = gi->params.enabled;
    u32 flags = 0;
    if (table_changed_since(&WORLD_TABLE(world, Light, light)->table, since) ||
        table_changed_since(&WORLD_TABLE(world, Material, material)->table, since))
        flags |= PACKET_RELIGHT;
    // A material's stamp does not tell whether it was more than its emission; the keys do.
    if (voxelised_changed(world, has_gi, has_gi && !previous, since)) {
        flags |= PACKET_REVOXELISE;
        if (has_gi && !previous) flags |= PACKET_RELIGHT; // what came or went may have shone
    }
    if (has_gi && table_changed_since(&WORLD_TABLE(world, Environment, environment)->table, since))
        flags |= PACKET_RELIGHT;
    if (table_changed_since(&WORLD_TABLE(world, Gi, gi)->table, since))
        flags |= PACKET_REVOXELISE | PACKET_RELIGHT;
    if (!previous) return flags;
    if (gi->surface_key != previous->surface_key) flags |= PACKET_REVOXELISE;
    if (gi->light_key != previous->light_key) flags |= PACKET_RELIGHT;
    return flags;
}
