// frame_upload.c: buffers and targets as large as the packet needs, then the packet's sections
// into them.
//
// Data in: a packet. Data out: filled per-frame buffers, targets of the packet's resolution, the
// frame's bind group. Called by renderer.c once a frame, before any pass. Capacities only grow, by
// powers of two, so a steady scene allocates nothing.
#include "render_internal.h"
#include "../base/log.h"
#include <string.h>

static const char *const target_labels[RESOURCE_COUNT] = {
#define X(id, label, format) label,
    RENDER_RESOURCES(X)
#undef X
};
static const char *const buffer_labels[FRAME_BUFFER_COUNT] = {"frame",
#define X(id, section, ...) #section,
                                                              FRAME_BUFFERS(X)
#undef X
};
static GpuFormat target_format(const Renderer *renderer, RenderResource id) {
    if (id >= RESOURCE_GBUFFER_0 && id <= RESOURCE_GBUFFER_4)
        return layout_table[renderer->layout].targets[id - RESOURCE_GBUFFER_0];
    return resource_formats[id];
}

static bool target_create(Renderer *renderer, RenderResource id, u32 width, u32 height) {
    if (renderer->targets[id].id) gpu_destroy_texture(renderer->gpu, renderer->targets[id]);
    renderer->targets[id] = (GpuTexture){0};
    renderer->frame_group_stale = true;
    if (!target_format(renderer, id)) return true; // the layout lacks it
    renderer->targets[id] =
        gpu_create_texture(renderer->gpu, &(GpuTextureDesc){.label = target_labels[id],
                                                            .heap = "targets",
                                                            .format = target_format(renderer, id),
                                                            .width = width,
                                                            .height = height,
                                                            .render_target = true,
                                                            .sampled = true,
                                                            .storage = id == RESOURCE_HDR});
    renderer->usage[id] = GPU_USAGE_NONE;
    return renderer->targets[id].id != 0;
}

static bool targets_resize(Renderer *renderer, const Packet *packet) {
    bool ok = true;
    bool new_layout = renderer->layout != packet->settings.layout;
    renderer->layout = packet->settings.layout;
    for (u32 i = 0; new_layout && i < 5; i++)
        ok = ok &&
             target_create(renderer, RESOURCE_GBUFFER_0 + i, packet->width_px, packet->height_px);
    if (renderer->width_px != packet->width_px || renderer->height_px != packet->height_px) {
        for (u32 id = 0; id < RESOURCE_FIRST_BUFFER; id++)
            if (id != RESOURCE_SHADOW_MAP)
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

// Data and its size; the buffer grows to the next power of two.
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
    if (size) memcpy(gpu_buffer_map(renderer->gpu, *buffer), data, size);
    return true;
}

static bool frame_group_update(Renderer *renderer) {
    if (!renderer->frame_group_stale && renderer->frame_group.id) return true;
    Gpu *gpu = renderer->gpu;
    if (renderer->frame_group.id) gpu_destroy_bind_group(gpu, renderer->frame_group);
    GpuBindGroupDesc desc = {.label = "frame", .layout = renderer->frame_layout};
    const struct {
        u32 binding;
        FrameBuffer buffer;
        u64 offset;
    } buffers[] = {
        {BINDING_FRAME, FRAME_BUFFER_FRAME, 0},
        {BINDING_MATERIALS, FRAME_BUFFER_MATERIALS, 0},
        {BINDING_DIRECTIONALS, FRAME_BUFFER_DIRECTIONALS, 0},
        {BINDING_LIGHT_BLOCK_0, FRAME_BUFFER_LIGHTS, 0},
        {BINDING_LIGHT_BLOCK_1, FRAME_BUFFER_LIGHTS, LIGHT_BLOCK_CAP * sizeof(LightRecord)},
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
    // Stand-ins until somebody fills them.
    static const u32 stand_ins[] = {BINDING_DEPTH_MS};
    for (u32 i = 0; i < COUNT_OF(stand_ins); i++)
        desc.bindings[stand_ins[i]] =
            (GpuBinding){.texture = renderer->white, .sampler = renderer->sampler_nearest};
    const struct {
        u32 binding;
        GpuTexture texture;
        GpuSampler sampler;
    } lookups[] = {{BINDING_PALETTE, renderer->palette, renderer->sampler_nearest},
                   {BINDING_ATTENUATION, renderer->falloff, renderer->sampler_linear},
                   {BINDING_NORMAL_Z, renderer->normal_z, renderer->sampler_nearest}};
    for (u32 i = 0; i < COUNT_OF(lookups); i++)
        desc.bindings[lookups[i].binding] = (GpuBinding){
            .texture = lookups[i].texture.id ? lookups[i].texture : renderer->white,
            .sampler = lookups[i].sampler};
    desc.bindings[BINDING_OVERLAY] = (GpuBinding){
        .texture = renderer->overlay_texture.id ? renderer->overlay_texture : renderer->white,
        .sampler = renderer->sampler_linear};
    renderer->frame_group = gpu_create_bind_group(gpu, &desc);
    renderer->frame_group_stale = false;
    return renderer->frame_group.id != 0;
}

bool frame_upload(Renderer *renderer, const Packet *packet) {
    if (!targets_resize(renderer, packet) || !device_lists_resize(renderer, packet) ||
        !lookups_update(renderer, packet))
        return false;
    if (!buffer_fill(renderer, FRAME_BUFFER_FRAME, &packet->frame, sizeof packet->frame, 0))
        return false;
#define X(id, section, Type, min_count)                                                            \
    if (!buffer_fill(renderer, FRAME_BUFFER_##id, PACKET_DATA(packet, section, Type),              \
                     (u64)packet->section.count * sizeof(Type), min_count * sizeof(Type)))         \
        return false;
    FRAME_BUFFERS(X)
#undef X
    return text_upload(renderer, packet) && frame_group_update(renderer);
}

void frame_upload_destroy(Renderer *renderer) {
    Gpu *gpu = renderer->gpu;
    if (renderer->frame_group.id) gpu_destroy_bind_group(gpu, renderer->frame_group);
    for (u32 i = 0; i < FRAME_BUFFER_COUNT; i++)
        if (renderer->buffers[i].id) gpu_destroy_buffer(gpu, renderer->buffers[i]);
    for (u32 i = 0; i < RESOURCE_COUNT; i++)
        if (renderer->targets[i].id) gpu_destroy_texture(gpu, renderer->targets[i]);
    for (u32 i = 0; i < RESOURCE_COUNT; i++)
        if (renderer->device_buffers[i].id) gpu_destroy_buffer(gpu, renderer->device_buffers[i]);
    if (renderer->readback.id) gpu_destroy_buffer(gpu, renderer->readback);
    lookups_destroy(renderer);
}
    device_lists_destroy(renderer);
