// packet.c: lays out a frame packet, and decides whether a stranger's one is safe to render.
// Data in: section counts; or a block of bytes of unknown origin. Data out: a zeroed packet; or
// the first reason to refuse. Called by: systems/packet_build.c (allocate), capture/ and tests
// (validate); any thread. Does not: fill sections, read files, or know what a mesh id means.
//
// There is one layout for given counts (section after section in declaration order, each on a cache
// line), and validation demands exactly that one: sections cannot overlap, leave holes or reach
// outside, and two equal packets are equal bytes. Padding between sections is zero.
#include "packet.h"
#include <math.h>
#include <string.h>

#define BLOCK_ALIGN 16 // what any allocator gives; the sections' own alignment is relative

typedef struct Layout {
#define X(name, Type) PacketSection name;
    PACKET_SECTIONS(X)
#undef X
    u64 size; // of the whole block
} Layout;

// False if the block would not be addressable by u32 offsets.
static bool layout_sections(const PacketSizes *sizes, Layout *layout) {
    u64 offset = ALIGN_UP(sizeof(Packet), CACHE_LINE);
#define X(name, Type)                                                                              \
    layout->name = (PacketSection){(u32)offset, sizes->name};                                      \
    offset = ALIGN_UP(offset + (u64)sizes->name * sizeof(Type), CACHE_LINE);                       \
    if (offset > UINT32_MAX) return false;
    PACKET_SECTIONS(X)
#undef X
    layout->size = offset;
    return true;
}

Packet *packet_allocate(Arena *arena, const PacketSizes *sizes) {
    Layout layout;
    LUZ_ASSERT(layout_sections(sizes, &layout));
    Packet *packet = arena_push(arena, layout.size, CACHE_LINE);
    packet->magic = PACKET_MAGIC;
    packet->version = PACKET_VERSION;
    packet->size = layout.size;
#define X(name, Type) packet->name = layout.name;
    PACKET_SECTIONS(X)
#undef X
    return packet;
}

// ---- validation ----

static bool floats_finite(const void *data, u64 count) {
    // An f32 is finite unless all its exponent bits are set: integer compares, no branches.
    const u32 *bits = data;
    u32 bad = 0;
    for (u64 i = 0; i < count; i++) bad |= (bits[i] & 0x7F800000u) == 0x7F800000u;
    return !bad;
}

static const char *check_layout(const Packet *packet, u64 size) {
    PacketSizes sizes = {
#define X(name, Type) .name = packet->name.count,
        PACKET_SECTIONS(X)
#undef X
    };
    Layout layout;
    if (!layout_sections(&sizes, &layout)) return "sections are larger than a packet can be";
    if (layout.size != size) return "section counts do not add up to the packet's size";
#define X(name, Type)                                                                              \
    if (packet->name.offset != layout.name.offset)                                                 \
        return "section '" #name "' does not lie where it belongs";
    PACKET_SECTIONS(X)
#undef X
    return NULL;
}

static const char *check_header(const Packet *packet) {
    if (packet->flags & ~(u32)(PACKET_REVOXELISE | PACKET_RELIGHT)) return "unknown flags";
    if (packet->reserved != 0) return "reserved field is not zero";
    if (packet->width_px < 1 || packet->width_px > PACKET_SIDE_MAX || packet->height_px < 1 ||
        packet->height_px > PACKET_SIDE_MAX)
        return "picture size out of range";
    if (packet->shadow_size_px != 0 &&
        (packet->shadow_size_px < 64 || packet->shadow_size_px > 4096))
        return "shadow map size out of range";
    if (packet->shadow_size_px != 0 && packet->directionals.count == 0)
        return "shadow map without a directional light";
    if (packet->brdf_mask & ~(u32)(15 | BRDF_MASK_OREN_NAYAR | BRDF_MASK_FRESNEL))
        return "unknown reflectance models";
    if (packet->attenuation > 2) return "unknown attenuation";
    RenderSettings clamped = packet->settings;
    settings_clamp(&clamped);
    if (memcmp(&clamped, &packet->settings, sizeof clamped) != 0) return "setting out of range";
    return NULL;
}

static const char *check_frame(const Packet *packet) {
    const FrameRecord *frame = &packet->frame;
    if (!floats_finite(frame, offsetof(FrameRecord, counts) / sizeof(f32)))
        return "frame record has a number that is not finite";
    if (!(frame->camera[3] > 0.0f)) return "near plane is not in front of the eye";
    f32 width = (f32)packet->width_px, height = (f32)packet->height_px;
    if (frame->viewport[0] != width || frame->viewport[1] != height ||
        frame->viewport[2] != 1.0f / width || frame->viewport[3] != 1.0f / height)
        return "viewport differs from the picture size";

    u32 side_px = settings_tile_px(&packet->settings);
    const u32 *grid = frame->grid;
    if (grid[3] != side_px || grid[0] != (packet->width_px + side_px - 1) / side_px ||
        grid[1] != (packet->height_px + side_px - 1) / side_px || grid[2] < 1 ||
        grid[2] > CLUSTER_SLICES_CAP)
        return "the light grid differs from the picture size";
    bool may_be_empty = settings_lists_on_device(&packet->settings);
    if (packet->cells.count != grid[0] * grid[1] * grid[2] &&
        !(may_be_empty && packet->cells.count == 0))
        return "the light grid has another number of cells";
    if (packet->lights.count == 0 || frame->counts2[2] != packet->lights.count - 1)
        return "the dummy light is not the last one";
    if ((u64)frame->counts[0] + frame->counts[1] != packet->lights.count - 1 ||
        frame->counts[1] != packet->spots.count)
        return "light counts differ from the light sections";
    if (frame->counts3[0] > frame->counts[0] || frame->counts3[1] > frame->counts[1])
        return "more lights with a highlight than lights";
    if (frame->counts[3] != packet->grid_nodes.count || frame->counts3[3] != 0 ||
        (frame->counts3[2] != 0 && frame->counts3[2] >= packet->grid_nodes.count))
        return "the hierarchy over the lights has another size";
    if (packet->directionals.count > DIRECTIONALS_CAP ||
        frame->counts[2] != packet->directionals.count)
        return "directional light count out of range";
    if (packet->materials.count > MATERIALS_CAP || frame->counts2[0] != packet->materials.count)
        return "material count out of range";
    if (packet->material_bindings.count != packet->materials.count)
        return "material bindings differ in count from materials";
    if (frame->counts2[1] != packet->instances.count)
        return "instance count differs from the instance section";
    if (frame->counts2[3] != packet->tick) return "the frame record is of another tick";
    return NULL;
}

static const char *check_materials(const Packet *packet, u32 texture_count) {
    const PacketMaterial *bindings = PACKET_DATA(packet, material_bindings, PacketMaterial);
    const MaterialRecord *records = PACKET_DATA(packet, materials, MaterialRecord);
    if (!floats_finite(records, (u64)packet->materials.count * sizeof *records / sizeof(f32)))
        return "material has a number that is not finite";
    for (u32 i = 0; i < packet->materials.count; i++) {
        const PacketMaterial *binding = &bindings[i];
        // 0 means none and must be accepted by a store without textures as well.
        u32 top =
            MAX(MAX(binding->albedo_texture, binding->normal_texture), binding->emissive_texture);
        if (top != 0 && top >= texture_count) return "material names a texture that is not there";
        if (binding->alpha_mode > 2 || binding->double_sided > 1 || binding->emissive_pass > 1)
            return "material has an unknown mode";
        f32 brdf = records[i].lobes[0];
        if (brdf != 0.0f && brdf != 1.0f && brdf != 2.0f && brdf != 3.0f)
            return "material has an unknown reflectance model";
    }
    return NULL;
}

static const char *check_instances(const Packet *packet) {
    const InstanceRecord *instances = PACKET_DATA(packet, instances, InstanceRecord);
    for (u32 i = 0; i < packet->instances.count; i++) {
        if (!floats_finite(instances[i].world, 12)) return "instance matrix is not finite";
        if (instances[i].ids[0] >= packet->materials.count)
            return "instance names a material that is not there";
    }
    return NULL;
}

// *budget: instances that lists may still draw. Lists share none in a packet from packet_build, so
// a list that repeats the same instances over and over (to stall a machine) is refused.
static const char *check_draws(const Packet *packet, PacketSection section, u32 mesh_count,
                               u64 *budget) {
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + section.offset);
    for (u32 i = 0; i < section.count; i++) {
        const PacketDraw *draw = &draws[i];
        if (draw->mesh == 0 || draw->mesh >= mesh_count)
            return "draw names a mesh that is not there";
        if (draw->material >= packet->materials.count)
            return "draw names a material that is not there";
        if (draw->lod >= MESH_LODS_CAP) return "draw names a level of detail that no mesh has";
        if (draw->instance_count == 0 ||
            (u64)draw->first_instance + draw->instance_count > packet->instances.count)
            return "draw names instances that are not there";
        if (draw->instance_count > *budget) return "draws repeat instances";
        *budget -= draw->instance_count;
    }
    return NULL;
}

static const char *check_lights(const Packet *packet) {
    const struct {
        PacketSection section;
        u32 size;
    } records[] = {{packet->lights, sizeof(LightRecord)},
                   {packet->spots, sizeof(SpotRecord)},
                   {packet->directionals, sizeof(DirectionalRecord)},
                   {packet->gi_lights, sizeof(LightRecord)}};
    for (u32 i = 0; i < COUNT_OF(records); i++) {
        const u8 *data = (const u8 *)packet + records[i].section.offset;
        if (!floats_finite(data, (u64)records[i].section.count * records[i].size / sizeof(f32)))
            return "light has a number that is not finite";
    }
    return NULL;
}

// One list: points, then spots, each part ascending.
static bool list_is_good(const u32 *indices, u32 points, u32 spots, u32 point_count,
                         u32 light_count) {
    bool good = true;
    for (u32 i = 0; i < points; i++)
        good &= indices[i] < point_count && (i == 0 || indices[i] > indices[i - 1]);
    indices += points;
    for (u32 i = 0; i < spots; i++)
        good &= indices[i] >= point_count && indices[i] < light_count &&
                (i == 0 || indices[i] > indices[i - 1]);
    return good;
}

// The lists of the cells follow each other without holes, in cell order. The one exception is a
// list of all lights at the very beginning, which any number of cells may share (light_grid.c).
// So the time of this check is linear in the packet's size, whatever the cells say.
static const char *check_cells(const Packet *packet) {
    const CellRecord *cells = PACKET_DATA(packet, cells, CellRecord);
    const u32 *indices = PACKET_DATA(packet, light_indices, u32);
    u32 point_count = packet->frame.counts[0], spot_count = packet->frame.counts[1];
    u32 light_count = point_count + spot_count; // without the dummy
    u64 cursor = 0;
    bool shared = false;
    if (packet->cells.count > 0 && cells[0].list[0] == light_count && light_count > 0) {
        if (packet->light_indices.count < light_count ||
            !list_is_good(indices, point_count, spot_count, point_count, light_count))
            return "the shared light list is damaged";
        shared = true;
        cursor = light_count;
    }
    for (u32 i = 0; i < packet->cells.count; i++) {
        u32 offset = cells[i].list[0], points = cells[i].list[1], spots = cells[i].list[2];
        if ((cells[i].list[3] & 0xFFFF) > points || cells[i].list[3] >> 16 > spots)
            return "cell has more diffuse lights than lights";
        if (points > point_count || spots > spot_count)
            return "cell has more lights than there are";
        bool all = points == point_count && spots == spot_count;
        if (offset == 0 && all && shared) continue;
        if (offset != cursor) return "cell's light list does not lie where it belongs";
        if (cursor + points + spots > packet->light_indices.count)
            return "cell's light list reaches outside";
        if (!list_is_good(indices + offset, points, spots, point_count, light_count))
            return "cell's light list is damaged";
        if (offset == 0 && all) shared = true;
        cursor += points + spots;
    }
    return cursor == packet->light_indices.count ? NULL : "light lists do not add up";
}

static const char *check_texts(const Packet *packet) {
    const PacketText *texts = PACKET_DATA(packet, texts, PacketText);
    for (u32 i = 0; i < packet->texts.count; i++) {
        if (!floats_finite(&texts[i], 3)) return "text place is not finite";
        if (fabsf(texts[i].x_px) > 1e6f || fabsf(texts[i].y_px) > 1e6f ||
            !(texts[i].size_px > 0.0f && texts[i].size_px <= 1024.0f))
            return "text place or size out of range";
        if ((u64)texts[i].offset + texts[i].length > packet->characters.count)
            return "text reaches outside";
    }
    return NULL;
}

const char *packet_validate(const void *block, u64 size, u32 mesh_count, u32 texture_count) {
    if (!block || size < sizeof(Packet)) return "too small for a packet";
    if ((uintptr_t)block % BLOCK_ALIGN != 0) return "packet is not aligned in memory";
    const Packet *packet = block;
    if (packet->magic != PACKET_MAGIC) return "not a frame packet";
    if (packet->version != PACKET_VERSION) return "packet of another version";
    if (packet->size != size) return "packet is cut off or has a tail";

    // Order matters: each check relies on those before it.
    const char *problem = check_layout(packet, size);
    if (!problem) problem = check_header(packet);
    if (!problem) problem = check_frame(packet);
    if (!problem) problem = check_materials(packet, texture_count);
    if (!problem) problem = check_instances(packet);
    u64 budget = packet->instances.count, emissive_budget = packet->instances.count;
    const PacketSection lists[] = {packet->opaque_draws, packet->mask_draws, packet->blend_draws,
                                   packet->shadow_draws, packet->shadow_mask_draws};
    for (u32 i = 0; i < COUNT_OF(lists) && !problem; i++)
        problem = check_draws(packet, lists[i], mesh_count, &budget);
    if (!problem)
        problem = check_draws(packet, packet->emissive_draws, mesh_count, &emissive_budget);
    if (!problem) problem = check_lights(packet);
    if (!problem) problem = check_cells(packet);
    if (!problem) problem = check_texts(packet);
    return problem;
}
