// frame_upload.c: buffers and targets as large as the packet needs, then the packet's sections
// into them.
//
// Data in: a packet. Data out: filled per-frame buffers, targets of the packet's resolution, the
// frame's bind group. Called by renderer.c once a frame, before any pass. Capacities only grow, by
// powers of two, so a steady scene allocates nothing.
#include "render_internal.h"
#include "../base/log.h"
#include <string.h>

static const char *const buffer_labels[FRAME_BUFFER_COUNT] = {"frame", "light blocks", "gi",
#define X(id, section, ...) #section,
                                                              FRAME_BUFFERS(X)
#undef X
};
static GpuFormat target_format(const Renderer *renderer, RenderResource id) {
    if (id == RESOURCE_DEPTH) return renderer->depth_format;
    if (id >= RESOURCE_GBUFFER_0 && id <= RESOURCE_GBUFFER_4)
        return layout_table[renderer->layout].targets[id - RESOURCE_GBUFFER_0];
    return resource_formats[id];
}

static bool is_ms(RenderResource id) { return id == RESOURCE_HDR_MS || id == RESOURCE_DEPTH_MS; }

static bool target_create(Renderer *renderer, RenderResource id, u32 width, u32 height) {
    if (renderer->targets[id].id) gpu_destroy_texture(renderer->gpu, renderer->targets[id]);
    renderer->targets[id] = (GpuTexture){0};
    renderer->frame_group_stale = true;
    if (!target_format(renderer, id)) return true; // the layout lacks it
    renderer->targets[id] =
        gpu_create_texture(renderer->gpu, &(GpuTextureDesc){.label = resource_labels[id],
                                                            .heap = "targets",
                                                            .format = target_format(renderer, id),
                                                            .width = width,
                                                            .height = height,
                                                            .samples = is_ms(id) ? 4 : 1,
                                                            .render_target = true,
                                                            .sampled = true,
                                                            .storage = id == RESOURCE_HDR});
    renderer->usage[id] = GPU_USAGE_NONE;
    return renderer->targets[id].id != 0;
}

// How many samples the packet's path draws, and targets for them. One sample: whatever multisampled
// targets there are stay, so that a path can be changed to and fro; a 1 x 1 depth at least, for its
// binding.
static bool samples_resize(Renderer *renderer, const Packet *packet) {
    const RenderSettings *s = &packet->settings;
    bool wanted = s->msaa == MSAA_4 && path_of(packet) == &path_table[s->path] &&
                  (s->path == PATH_FORWARD || s->path == PATH_TILED_FORWARD ||
                   s->path == PATH_CLUSTERED_FORWARD);
    renderer->samples = 1;
    if (!gpu_info(renderer->gpu)->samples_4) {
        static bool told;
        if (wanted && !told)
            LOG(RENDER_LIMIT, "this device has no 4 samples a pixel: msaa=4 draws as msaa=1");
        told |= wanted;
        return true;
    }
    u32 width = wanted ? packet->width_px : MAX(renderer->ms_width_px, 1);
    u32 height = wanted ? packet->height_px : MAX(renderer->ms_height_px, 1);
    if (renderer->ms_width_px != width || renderer->ms_height_px != height) {
        bool ok = target_create(renderer, RESOURCE_DEPTH_MS, width, height) &&
                  target_create(renderer, RESOURCE_HDR_MS, width, height);
        renderer->ms_width_px = ok ? width : 0;
        renderer->ms_height_px = ok ? height : 0;
        if (!ok) return false;
    }
    if (wanted) renderer->samples = 4;
    return true;
}

static bool targets_resize(Renderer *renderer, const Packet *packet) {
    bool ok = true;
    // A depth with a stencil costs more to test, on the software driver: only for who uses it.
    bool stencil = packet->settings.path == PATH_DEFERRED_VOLUMES &&
                   packet->settings.light_volume == VOLUME_STENCIL;
    GpuFormat depth_format = stencil ? GPU_FORMAT_D32F_S8 : GPU_FORMAT_D32F;
    bool new_size = renderer->gbuffer_width_px != packet->width_px ||
                    renderer->gbuffer_height_px != packet->height_px;
    bool new_depth = renderer->depth_format != depth_format || new_size;
    bool new_gbuffer = renderer->layout != layout_of(packet) || new_size;
    renderer->depth_format = depth_format;
    renderer->layout = layout_of(packet);
    for (u32 i = 0; new_gbuffer && i < 5; i++)
        ok = ok &&
             target_create(renderer, RESOURCE_GBUFFER_0 + i, packet->width_px, packet->height_px);
    if (ok && new_depth)
        ok = target_create(renderer, RESOURCE_DEPTH, packet->width_px, packet->height_px);
    renderer->gbuffer_width_px = ok ? packet->width_px : 0;
    renderer->gbuffer_height_px = ok ? packet->height_px : 0;
    if (renderer->width_px != packet->width_px || renderer->height_px != packet->height_px) {
        for (u32 id = 0; id < RESOURCE_FIRST_GI; id++)
            if (id != RESOURCE_SHADOW_MAP && !is_ms(id) &&
                !(id >= RESOURCE_GBUFFER_0 && id <= RESOURCE_DEPTH))
                ok = ok && target_create(renderer, id, packet->width_px, packet->height_px);
        if (renderer->readback.id) gpu_destroy_buffer(renderer->gpu, renderer->readback);
        renderer->readback = gpu_create_buffer(
            renderer->gpu, &(GpuBufferDesc){.label = "image readback",
                                            .heap = "staging",
                                            .kind = GPU_BUFFER_READBACK,
                                            .size = (u64)packet->width_px * packet->height_px * 4});
        ok = ok && renderer->readback.id;
        renderer->width_px = ok ? packet->width_px : 0;
        renderer->height_px = ok ? packet->height_px : 0;
    }
    ok = ok && samples_resize(renderer, packet);
    // Every binding is always written, so there is a shadow map even when nothing casts.
    u32 shadow_size = MAX(packet->shadow_size_px, 1);
    if (ok && renderer->shadow_size_px != shadow_size &&
        (packet->shadow_size_px > 0 || !renderer->targets[RESOURCE_SHADOW_MAP].id)) {
        ok = target_create(renderer, RESOURCE_SHADOW_MAP, shadow_size, shadow_size);
        renderer->shadow_size_px = ok ? shadow_size : 0;
        renderer->shadow_key = 0;
    }
    return ok;
}

// Data and its size; NULL = the caller fills it. The buffer grows to the next power of two.
static bool buffer_fill(Renderer *renderer, FrameBuffer id, const void *data, u64 size,
                        u64 min_cap) {
    GpuBuffer *buffer = &renderer->buffers[id];
    if (!buffer->id || gpu_buffer_size(renderer->gpu, *buffer) < size) {
        u64 cap = MAX(min_cap, 1024);
        while (cap < size) cap *= 2;
        if (cap > gpu_info(renderer->gpu)->max_storage_buffer_size) cap = size;
        if (size > gpu_info(renderer->gpu)->max_storage_buffer_size) {
            LOG(RENDER_LIMIT, "%s of this frame need %llu bytes, the device binds %llu at most",
                buffer_labels[id], (unsigned long long)size,
                (unsigned long long)gpu_info(renderer->gpu)->max_storage_buffer_size);
            return false;
        }
        if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
        *buffer = gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = buffer_labels[id],
                                                                    .heap = "frame",
                                                                    .kind = GPU_BUFFER_DYNAMIC,
                                                                    .size = cap,
                                                                    .vertex = true});
        renderer->frame_group_stale = true;
        if (!buffer->id) return false;
    }
    if (size && data) memcpy(gpu_buffer_map(renderer->gpu, *buffer), data, size);
    return true;
}

// Positions and colours apart, so that a uniform block of 64 KiB holds one of all lights: from two
// blocks of whole records a shader would read both for each light and choose.
static bool light_blocks_fill(Renderer *renderer, const Packet *packet) {
    const u64 size = 2 * LIGHT_BLOCK_CAP * sizeof(vec4);
    if (!buffer_fill(renderer, FRAME_BUFFER_LIGHT_BLOCKS, NULL, size, size)) return false;
    if (!packet_fits_light_blocks(packet)) return true;
    const LightRecord *lights = PACKET_DATA(packet, lights, LightRecord);
    vec4 *blocks = gpu_buffer_map(renderer->gpu, renderer->buffers[FRAME_BUFFER_LIGHT_BLOCKS]);
    for (u32 i = 0; i < packet->lights.count; i++) {
        memcpy(blocks[i], lights[i].position, sizeof(vec4));
        memcpy(blocks[LIGHT_BLOCK_CAP + i], lights[i].color, sizeof(vec4));
    }
    return true;
}

// Two groups: of everything, and of what shading a mesh may read. In the latter a stand-in takes
// the place of the targets that meshes are drawn to: nothing samples them there, and the software
// driver ends the picture's bins each time that textures are bound while one of them is a render
// target.
static bool frame_group_update(Renderer *renderer) {
    if (renderer->frame_group_stale) renderer->bindings_version++;
    renderer->frame_group_stale = false;
    if (renderer->frame_group_version == renderer->bindings_version && renderer->frame_group.id)
        return true;
    Gpu *gpu = renderer->gpu;
    if (renderer->frame_group.id) gpu_destroy_bind_group(gpu, renderer->frame_group);
    if (renderer->mesh_group.id) gpu_destroy_bind_group(gpu, renderer->mesh_group);
    GpuBindGroupDesc desc = {.label = "frame", .layout = renderer->frame_layout};
    const struct {
        u32 binding;
        FrameBuffer buffer;
        u64 offset;
    } buffers[] = {
        {BINDING_FRAME, FRAME_BUFFER_FRAME, 0},
        {BINDING_MATERIALS, FRAME_BUFFER_MATERIALS, 0},
        {BINDING_DIRECTIONALS, FRAME_BUFFER_DIRECTIONALS, 0},
        {BINDING_LIGHT_POSITIONS, FRAME_BUFFER_LIGHT_BLOCKS, 0},
        {BINDING_LIGHT_COLORS, FRAME_BUFFER_LIGHT_BLOCKS, LIGHT_BLOCK_CAP * sizeof(vec4)},
        {BINDING_SPOT_BLOCK, FRAME_BUFFER_SPOTS, 0},
        {BINDING_FLOW, FRAME_BUFFER_FRAME, 0},
        {BINDING_LIGHTS, FRAME_BUFFER_LIGHTS, 0},
        {BINDING_SPOTS, FRAME_BUFFER_SPOTS, 0},
        {BINDING_CELLS, FRAME_BUFFER_CELLS, 0},
        {BINDING_LIGHT_INDICES, FRAME_BUFFER_LIGHT_INDICES, 0},
        {BINDING_GRID_NODES, FRAME_BUFFER_GRID_NODES, 0},
    };
    for (u32 i = 0; i < COUNT_OF(buffers); i++)
        desc.bindings[buffers[i].binding] = (GpuBinding){
            .buffer = renderer->buffers[buffers[i].buffer], .offset = buffers[i].offset};
    static const u32 device_buffers[][2] = {
        {BINDING_LIST_CELLS, RESOURCE_LIST_CELLS},
        {BINDING_LIST_INDICES, RESOURCE_LIST_INDICES},
        {BINDING_TILE_DEPTHS, RESOURCE_TILE_DEPTHS},
        {BINDING_CLUSTERS, RESOURCE_CLUSTERS},
        {BINDING_PIXEL_CLUSTERS, RESOURCE_PIXEL_CLUSTERS},
        {BINDING_GRID_COUNTERS, RESOURCE_GRID_COUNTERS},
    };
    for (u32 i = 0; i < COUNT_OF(device_buffers); i++)
        desc.bindings[device_buffers[i][0]] =
            (GpuBinding){.buffer = renderer->device_buffers[device_buffers[i][1]]};
    const struct {
        u32 binding;
        RenderResource resource;
        GpuSampler sampler;
    } images[] = {
        {BINDING_GBUFFER_0, RESOURCE_GBUFFER_0, renderer->sampler_nearest},
        {BINDING_GBUFFER_1, RESOURCE_GBUFFER_1, renderer->sampler_nearest},
        {BINDING_GBUFFER_2, RESOURCE_GBUFFER_2, renderer->sampler_nearest},
        {BINDING_GBUFFER_3, RESOURCE_GBUFFER_3, renderer->sampler_nearest},
        {BINDING_GBUFFER_4, RESOURCE_GBUFFER_4, renderer->sampler_nearest},
        {BINDING_DEPTH, RESOURCE_DEPTH, renderer->sampler_nearest},
        {BINDING_DEPTH_MS, RESOURCE_DEPTH_MS, renderer->sampler_nearest},
        {BINDING_SHADOW_MAP, RESOURCE_SHADOW_MAP, renderer->sampler_shadow},
        {BINDING_HDR, RESOURCE_HDR, renderer->sampler_nearest},
        {BINDING_HDR_STORAGE, RESOURCE_HDR, {0}},
        {BINDING_HDR_OTHER, RESOURCE_HDR_OTHER, renderer->sampler_linear},
        {BINDING_LDR, RESOURCE_LDR, renderer->sampler_linear},
        {BINDING_LDR_OTHER, RESOURCE_LDR_OTHER, renderer->sampler_linear},
        {BINDING_ACCUMULATION, RESOURCE_ACCUMULATION, renderer->sampler_nearest},
    };
    for (u32 i = 0; i < COUNT_OF(images); i++)
        desc.bindings[images[i].binding] =
            (GpuBinding){.texture = renderer->targets[images[i].resource].id
                                        ? renderer->targets[images[i].resource]
                                        : renderer->black,
                         .sampler = images[i].sampler};
    const struct {
        u32 binding;
        GpuTexture texture;
        GpuSampler sampler;
    } lookups[] = {{BINDING_PALETTE, renderer->palette, renderer->sampler_nearest},
                   {BINDING_ATTENUATION, renderer->falloff, renderer->sampler_linear},
                   {BINDING_NORMAL_Z, renderer->normal_z, renderer->sampler_nearest}};
    for (u32 i = 0; i < COUNT_OF(lookups); i++)
        desc.bindings[lookups[i].binding] =
            (GpuBinding){.texture = lookups[i].texture.id ? lookups[i].texture : renderer->white,
                         .sampler = lookups[i].sampler};
    desc.bindings[BINDING_OVERLAY] = (GpuBinding){
        .texture = renderer->overlay_texture.id ? renderer->overlay_texture : renderer->white,
        .sampler = renderer->sampler_linear};
    renderer->frame_group = gpu_create_bind_group(gpu, &desc);
    for (u32 i = 0; i < COUNT_OF(images); i++)
        if (images[i].resource != RESOURCE_SHADOW_MAP &&
            images[i].resource != RESOURCE_HDR_OTHER && // multipass_lights.frag
            images[i].binding != BINDING_HDR_STORAGE)
            desc.bindings[images[i].binding].texture = renderer->black;
    desc.label = "frame for meshes";
    renderer->mesh_group = gpu_create_bind_group(gpu, &desc);
    renderer->frame_group_version = renderer->bindings_version;
    return renderer->frame_group.id && renderer->mesh_group.id;
}

bool frame_upload(Renderer *renderer, const Packet *packet) {
    if (!targets_resize(renderer, packet) || !device_lists_resize(renderer, packet) ||
        !lookups_update(renderer, packet))
        return false;
    if (!buffer_fill(renderer, FRAME_BUFFER_FRAME, &packet->frame, sizeof packet->frame, 0) ||
        !light_blocks_fill(renderer, packet))
        return false;
#define X(id, section, Type, min_count)                                                            \
    if (!buffer_fill(renderer, FRAME_BUFFER_##id, PACKET_DATA(packet, section, Type),              \
                     (u64)packet->section.count * sizeof(Type), min_count * sizeof(Type)))         \
        return false;
    FRAME_BUFFERS(X)
#undef X
    gi_begin(renderer, packet);
    GiRecord gi = packet->gi.record;
    gi.counts[2] = renderer->gi.slot_cap;
    if (!buffer_fill(renderer, FRAME_BUFFER_GI, &gi, sizeof gi, 0)) return false;
    return debug_view_upload(renderer, packet) && text_upload(renderer, packet) &&
           frame_group_update(renderer) && gi_update_groups(renderer);
}

static void exchange(void *a, void *b, u64 size) {
    u8 kept[sizeof(FrameSet)];
    LUZ_ASSERT(size <= sizeof kept);
    memcpy(kept, a, size);
    memcpy(a, b, size);
    memcpy(b, kept, size);
}

void frame_sets_exchange(Renderer *renderer) {
    FrameSet *parked = &renderer->parked;
#define EXCHANGE(a, b) exchange(&(a), &(b), sizeof(a))
#define FIELD(name)    EXCHANGE(renderer->name, parked->name)
    FIELD(buffers);
    FIELD(frame_group);
    FIELD(mesh_group);
    FIELD(frame_group_version);
    FIELD(layout);
    FIELD(depth_format);
    FIELD(gbuffer_width_px);
    FIELD(gbuffer_height_px);
    FIELD(text_vertices);
    FIELD(text_indices);
    FIELD(text_ends);
    FIELD(line_vertices);
    FIELD(line_vertex_count);
    for (u32 i = 0; i < COUNT_OF(parked->gbuffer); i++) {
        EXCHANGE(renderer->targets[RESOURCE_GBUFFER_0 + i], parked->gbuffer[i]);
        EXCHANGE(renderer->usage[RESOURCE_GBUFFER_0 + i], parked->gbuffer_usage[i]);
    }
    renderer->frame_set ^= 1;
    FIELD(gi);
    for (u32 i = 0; i < GI_TEXTURES; i++) {
        EXCHANGE(renderer->targets[RESOURCE_FIRST_GI + i], parked->gi_textures[i]);
        EXCHANGE(renderer->usage[RESOURCE_FIRST_GI + i], parked->gi_texture_usage[i]);
    }
    for (u32 i = 0; i < GI_BUFFERS; i++) {
        EXCHANGE(renderer->device_buffers[RESOURCE_FIRST_GI_BUFFER + i], parked->gi_buffers[i]);
        EXCHANGE(renderer->usage[RESOURCE_FIRST_GI_BUFFER + i], parked->gi_buffer_usage[i]);
    }
    EXCHANGE(renderer->targets[RESOURCE_LDR], renderer->targets[RESOURCE_LDR_OTHER]);
    EXCHANGE(renderer->usage[RESOURCE_LDR], renderer->usage[RESOURCE_LDR_OTHER]);
#undef FIELD
#undef EXCHANGE
}

static void frame_set_destroy(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    gi_state_destroy(renderer);
    if (renderer->frame_group.id) gpu_destroy_bind_group(gpu, renderer->frame_group);
    if (renderer->mesh_group.id) gpu_destroy_bind_group(gpu, renderer->mesh_group);
    for (u32 i = 0; i < FRAME_BUFFER_COUNT; i++)
        if (renderer->buffers[i].id) gpu_destroy_buffer(gpu, renderer->buffers[i]);
    GpuBuffer others[] = {renderer->text_vertices, renderer->text_indices, renderer->line_vertices};
    for (u32 i = 0; i < COUNT_OF(others); i++)
        if (others[i].id) gpu_destroy_buffer(gpu, others[i]);
    for (u32 id = RESOURCE_GBUFFER_0; id <= RESOURCE_DEPTH; id++) {
        if (renderer->targets[id].id) gpu_destroy_texture(gpu, renderer->targets[id]);
        renderer->targets[id] = (GpuTexture){0};
    }
}

void frame_upload_destroy(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    frame_set_destroy(renderer);
    frame_sets_exchange(renderer);
    frame_set_destroy(renderer);
    for (u32 i = 0; i < RESOURCE_COUNT; i++)
        if (renderer->targets[i].id) gpu_destroy_texture(gpu, renderer->targets[i]);
    for (u32 i = 0; i < RESOURCE_COUNT; i++)
        if (renderer->device_buffers[i].id) gpu_destroy_buffer(gpu, renderer->device_buffers[i]);
    if (renderer->readback.id) gpu_destroy_buffer(gpu, renderer->readback);
    device_lists_destroy(renderer);
    lookups_destroy(renderer);
}
