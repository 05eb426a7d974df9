// packet.c: lays out a frame packet, and decides whether a stranger's one is safe to render.
// Data in: section counts; or a block of bytes of unknown origin. Data out: a zeroed packet; or
// the first reason to refuse. Called by: systems/packet_build.c (allocate), capture/ and tests
// (validate); any thread. Does not: fill sections, read files, or know what a mesh id means.
//
// There is one layout for given counts (section after section in declaration order, each on a cache
// line), and validation demands exactly that one: sections cannot overlap, leave holes or reach
// outside, and two equal packets are equal bytes. Padding between sections is zero.
#include "packet_check.h"
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
    // Light lists can be most of the packet, and are written as a whole: only what surrounds them.
    u64 lists_begin = layout.light_indices.offset,
        lists_end = lists_begin + layout.light_indices.count * sizeof(u32);
    Packet *packet = arena_push_unset(arena, layout.size, CACHE_LINE);
    memset(packet, 0, lists_begin);
    memset((u8 *)packet + lists_end, 0, layout.size - lists_end);
    packet->magic = PACKET_MAGIC;
    packet->version = PACKET_VERSION;
    packet->size = layout.size;
#define X(name, Type) packet->name = layout.name;
    PACKET_SECTIONS(X)
#undef X
    return packet;
}

u32 packet_tree_levels(u32 light_count, u32 sizes[PACKET_TREE_LEVELS_CAP]) {
    u32 levels = 0;
    for (u32 count = light_count; count > 0 && (levels == 0 || count > 1); levels++)
        sizes[levels] = count = (count - 1) / GRID_NODE_WIDTH + 1;
    for (u32 i = 0; i < levels / 2; i++) {
        u32 swap = sizes[i];
        sizes[i] = sizes[levels - 1 - i];
        sizes[levels - 1 - i] = swap;
    }
    return levels;
}

// ---- validation ----

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
    if (packet->flags & ~(u32)(PACKET_REVOXELISE | PACKET_RELIGHT | PACKET_COLD))
        return "unknown flags";
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
    if (grid[2] > 1 && !settings_clustered(&packet->settings)) return "tiles have no slices";
    bool may_be_empty =
        settings_lists_on_device(&packet->settings) && packet->blend_draws.count == 0;
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
    if (packet->directionals.count > DIRECTIONALS_CAP ||
        frame->counts[2] > packet->directionals.count ||
        (!packet->gi.params.enabled && frame->counts[2] != packet->directionals.count))
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
        f32 share;
        memcpy(&share, &instances[i].ids[2], sizeof share);
        if (!(share >= 0.0f && share <= 1.0f)) return "instance has an impossible share";
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
        if (draw->vertex_lit > 2) return "draw has an unknown way of vertex lighting";
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
                   {packet->gi_lights, sizeof(GiLightRecord)},
                   {packet->traced_lights, sizeof(TracedLightRecord)}};
    for (u32 i = 0; i < COUNT_OF(records); i++) {
        const u8 *data = (const u8 *)packet + records[i].section.offset;
        if (!floats_finite(data, (u64)records[i].section.count * records[i].size / sizeof(f32)))
            return "light has a number that is not finite";
    }
    return NULL;
}

typedef struct LightCounts {
    u32 points, all;                     // spots are the rest
    u32 point_highlights, spots_diffuse; // where the second classes begin, as light indices
    u32 indices;                         // of all lists
} LightCounts;

// One list: points, then spots, each part ascending, and the second class as long as it says.
static bool list_is_good(const u32 *indices, const u32 list[4], const LightCounts *c) {
    bool good = true;
    u32 points = list[1], spots = list[2], diffuse = 0;
    for (u32 i = 0; i < points; i++) {
        good &= indices[i] < c->points && (i == 0 || indices[i] > indices[i - 1]);
        diffuse += indices[i] >= c->point_highlights;
    }
    good &= (list[3] & 0xFFFF) == MIN(diffuse, 0xFFFF);
    indices += points;
    diffuse = 0;
    for (u32 i = 0; i < spots; i++) {
        good &= indices[i] >= c->points && indices[i] < c->all &&
                (i == 0 || indices[i] > indices[i - 1]);
        diffuse += indices[i] >= c->spots_diffuse;
    }
    return good && list[3] >> 16 == MIN(diffuse, 0xFFFF);
}

// The lists of the cells follow each other without holes, in cell order. The one exception is a
// list of all lights at the very beginning, which any number of cells may share (light_grid.c).
// So the time of this check is linear in the packet's size, whatever the cells say.
static const char *check_cells(const Packet *packet, const LightCounts *c) {
    const CellRecord *cells = PACKET_DATA(packet, cells, CellRecord);
    const u32 *indices = PACKET_DATA(packet, light_indices, u32);
    u32 points_diffuse = c->points - c->point_highlights, spots_diffuse = c->all - c->spots_diffuse;
    const u32 all_lights[4] = {0, c->points, c->all - c->points,
                               MIN(points_diffuse, 0xFFFF) | MIN(spots_diffuse, 0xFFFF) << 16};
    u64 cursor = 0;
    bool shared = false;
    if (packet->cells.count > 0 && cells[0].list[0] == c->all && c->all > 0) {
        if (c->indices < c->all || !list_is_good(indices, all_lights, c))
            return "the shared light list is damaged";
        shared = true;
        cursor = c->all;
    }
    for (u32 i = 0; i < packet->cells.count; i++) {
        const u32 *list = cells[i].list;
        u32 points = list[1], spots = list[2];
        if (points > c->points || spots > c->all - c->points)
            return "cell has more lights than there are";
        bool all = memcmp(list, all_lights, sizeof all_lights) == 0;
        if (all && shared) continue;
        if (list[0] != cursor) return "cell's light list does not lie where it belongs";
        if (cursor + points + spots > c->indices) return "cell's light list reaches outside";
        if (!list_is_good(indices + list[0], list, c)) return "cell's light list is damaged";
        shared |= all;
        cursor += points + spots;
    }
    return cursor == c->indices ? NULL : "light lists do not add up";
}

// One tree: the shape follows from the number of lights, so nothing can go in circles.
static bool tree_is_good(const GridNode *nodes, u32 root, u32 place, u32 light_count) {
    u32 sizes[PACKET_TREE_LEVELS_CAP], levels = packet_tree_levels(light_count, sizes);
    bool good = true;
    for (u32 level = 0, node = root; level < levels; level++) {
        bool leaves = level + 1 == levels;
        u32 child = leaves ? place : node + sizes[level];
        u32 left = leaves ? light_count : sizes[level + 1];
        for (u32 i = 0; i < sizes[level]; i++, node++) {
            u32 count = MIN(left, GRID_NODE_WIDTH), first, bits;
            memcpy(&first, &nodes[node].low[3], sizeof first);
            memcpy(&bits, &nodes[node].high[3], sizeof bits);
            good &= first == child && bits == (count | (leaves ? 0x80000000u : 0));
            good &= floats_finite(nodes[node].low, 3) && floats_finite(nodes[node].high, 3);
            child += count, left -= count;
        }
    }
    return good;
}

// The hierarchy and its order, which lies behind the cells' lists.
static const char *check_hierarchy(const Packet *packet, const LightCounts *c) {
    const u32 *order = PACKET_DATA(packet, light_indices, u32) + c->indices;
    const GridNode *nodes = PACKET_DATA(packet, grid_nodes, GridNode);
    u32 sizes[PACKET_TREE_LEVELS_CAP], spots = c->all - c->points, root = 0, count = 0;
    for (u32 i = 0, n = packet_tree_levels(c->points, sizes); i < n; i++) root += sizes[i];
    for (u32 i = 0, n = packet_tree_levels(spots, sizes); i < n; i++) count += sizes[i];
    if (packet->grid_nodes.count != root + count || c->all == 0 ||
        packet->frame.counts3[2] != (spots ? root : 0))
        return "the hierarchy over the lights has another size";
    bool good = true;
    for (u32 i = 0; i < c->all; i++)
        good &= i < c->points ? order[i] < c->points : order[i] >= c->points && order[i] < c->all;
    if (!good) return "the hierarchy's order names lights that are not there";
    if (!tree_is_good(nodes, 0, 0, c->points) || !tree_is_good(nodes, root, c->points, spots))
        return "the hierarchy over the lights is damaged";
    return NULL;
}

static const char *check_lists(const Packet *packet) {
    const FrameRecord *frame = &packet->frame;
    LightCounts c = {.points = frame->counts[0],
                     .all = frame->counts[0] + frame->counts[1],
                     .point_highlights = frame->counts3[0],
                     .spots_diffuse = frame->counts[0] + frame->counts3[1],
                     .indices = packet->light_indices.count};
    if (frame->counts[3] != packet->grid_nodes.count)
        return "the hierarchy over the lights has another size";
    if (packet->grid_nodes.count == 0) {
        if (frame->counts3[2] != 0 || frame->counts3[3] != 0)
            return "the frame record names a hierarchy that is not there";
        return check_cells(packet, &c);
    }
    if (frame->counts3[3] > c.indices || c.indices - frame->counts3[3] != c.all)
        return "the hierarchy's order does not lie where it belongs";
    c.indices = frame->counts3[3];
    const char *problem = check_cells(packet, &c);
    return problem ? problem : check_hierarchy(packet, &c);
}

static const char *check_posts(const Packet *packet) {
    const PacketPost *posts = PACKET_DATA(packet, posts, PacketPost);
    if (packet->posts.count > PACKET_POSTS_CAP) return "too many steps in the post chain";
    for (u32 i = 0; i < packet->posts.count; i++) {
        if (posts[i].kind >= POST_KIND_COUNT) return "unknown step in the post chain";
        if (!floats_finite(posts[i].values, COUNT_OF(posts[i].values)))
            return "step of the post chain has a number that is not finite";
        for (u32 k = 0; k < 4 && posts[i].kind == POST_HEAT; k++)
            if (fabsf(posts[i].values[7 + k]) > PACKET_SIDE_MAX)
                return "heat lies outside the picture";
    }
    return NULL;
}

// What debug pictures of the light manager show.
static const char *check_manager(const Packet *packet) {
    const PacketLightMark *marks = PACKET_DATA(packet, light_marks, PacketLightMark);
    u32 light_count = packet->lights.count - 1; // without the dummy
    for (u32 i = 0; i < packet->light_marks.count; i++) {
        const PacketLightMark *mark = &marks[i];
        if (!floats_finite(mark, offsetof(PacketLightMark, fate) / sizeof(f32)))
            return "light mark has a number that is not finite";
        if (mark->fate >= LIGHT_FATE_COUNT) return "light mark has an unknown fate";
        if (mark->light != UINT32_MAX && mark->light >= light_count)
            return "light mark names a light that is not there";
    }
    const PacketCounts *counts = &packet->counts;
    u64 texels = (u64)counts->occluder_width * counts->occluder_height;
    if (counts->occluder_width > PACKET_SIDE_MAX || counts->occluder_height > PACKET_SIDE_MAX)
        return "occluders' picture size out of range";
    if (packet->occluder_depths.count != 0 && packet->occluder_depths.count != texels)
        return "occluders' picture differs from its size";
    if (!floats_finite(PACKET_DATA(packet, occluder_depths, f32), packet->occluder_depths.count))
        return "occluders' picture has a number that is not finite";
    return floats_finite(&counts->merge_error, 1) ? NULL : "merge error is not finite";
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
    if (!problem) problem = check_lists(packet);
    if (!problem) problem = check_posts(packet);
    if (!problem) problem = check_manager(packet);
    if (!problem) problem = packet_check_gi(packet, mesh_count);
    if (!problem) problem = check_texts(packet);
    return problem;
}
