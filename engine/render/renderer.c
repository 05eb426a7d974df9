// renderer.c: the renderer's life, one frame, and the image that comes of it.
//
// Data in: packet, asset store. Data out: commands of one frame, or pixels. The only state that
// survives a frame is what was uploaded, the pipelines, and a shadow map whose key says what it
// shows: the same packet gives the same image whatever was drawn before.
#include "passes.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <stdlib.h>
#include <string.h>

Renderer *renderer_create(Gpu *gpu) {
    Renderer *renderer = calloc(1, sizeof *renderer);
    LUZ_ASSERT(renderer);
    renderer->gpu = gpu;
    if (!arena_create(&renderer->arena, "renderer", MIB(256))) {
        free(renderer);
        return NULL;
    }
    GpuBindLayoutDesc frame = {.label = "frame", .count = BINDING_FRAME_COUNT};
    for (u32 i = 0; i < BINDING_FRAME_COUNT; i++)
        frame.kinds[i] = i <= BINDING_SPOT_BLOCK    ? GPU_BINDING_UNIFORM_BUFFER
                         : i < BINDING_FIRST_IMAGE  ? GPU_BINDING_STORAGE_BUFFER
                         : i == BINDING_HDR_STORAGE ? GPU_BINDING_STORAGE_TEXTURE
                                                    : GPU_BINDING_SAMPLED_TEXTURE;
    renderer->frame_layout = gpu_create_bind_layout(gpu, &frame);
    renderer->material_layout =
        gpu_create_bind_layout(gpu, &(GpuBindLayoutDesc){.label = "material",
                                                         .count = BINDING_MATERIAL_COUNT,
                                                         .kinds = {GPU_BINDING_SAMPLED_TEXTURE,
                                                                   GPU_BINDING_SAMPLED_TEXTURE,
                                                                   GPU_BINDING_SAMPLED_TEXTURE}});
    if (!render_assets_create(renderer) || !volumes_create(renderer) || !gi_create(renderer)) {
        renderer_destroy(renderer);
        return NULL;
    }
    return renderer;
}

void renderer_destroy(Renderer *renderer) {
    if (!renderer) return;
    gpu_wait_idle(renderer->gpu);
    pipelines_destroy(renderer);
    frame_upload_destroy(renderer);
    gi_destroy(renderer);
    overlay_destroy(renderer);
    volumes_destroy(renderer);
    render_assets_destroy(renderer);
    arena_destroy(&renderer->arena);
    free(renderer);
}

// The shadow map is bound even when no light casts: it must have a layout that shaders can read.
static void shadow_map_ready(const PassContext *c) {
    Renderer *r = c->renderer;
    if (r->usage[RESOURCE_SHADOW_MAP] != GPU_USAGE_NONE || c->packet->shadow_size_px > 0) return;
    gpu_cmd_barriers(c->cmd,
                     &(GpuBarrier){.texture = r->targets[RESOURCE_SHADOW_MAP],
                                   .from = GPU_USAGE_NONE,
                                   .to = GPU_USAGE_SAMPLED_FRAGMENT,
                                   .discard = true},
                     1);
    r->usage[RESOURCE_SHADOW_MAP] = GPU_USAGE_SAMPLED_FRAGMENT;
}

// Tells how far the warm-up is; what compiles in a pass then does so in a submit of its own.
static bool warm_up_step(PassContext *context, const Pass *next, u32 done, u32 total) {
    Renderer *renderer = context->renderer;
    // Another round, for larger buffers, compiles nothing.
    renderer->progress_done = MAX(renderer->progress_done, done);
    renderer->progress_total = total;
    context->cmd = gpu_frame_continue(renderer->gpu);
    if (context->cmd && renderer->progress)
        renderer->progress(renderer->progress_user, renderer->progress_done, total, next->name);
    return context->cmd && gpu_frame_is_open(renderer->gpu);
}

bool packet_draw(Renderer *renderer, GpuCommands *cmd, const Packet *packet) {
    if (!frame_upload(renderer, packet)) return false;
    PassContext context = {.renderer = renderer, .cmd = cmd, .packet = packet};
    shadow_map_ready(&context);
    const PathRow *path = path_of(packet);
    u32 count = 0;
    while (count < PATH_PASSES_CAP && path->passes[count]) count++;
    for (u32 i = 0; i < count; i++) {
        if (renderer->is_warming_up && !warm_up_step(&context, path->passes[i], i, count))
            return false;
        pass_run(&context, path->passes[i]);
    }
    pass_run(&context, &debug_overlay_pass);
    device_lists_stats(renderer, packet);
    return true;
}

// What is counted since the renderer was made stays.
static void stats_begin(Renderer *renderer) {
    RendererStats *s = &renderer->stats;
    *s = (RendererStats){.pipelines = s->pipelines,
                         .gi_static_voxelised = s->gi_static_voxelised,
                         .gi_dynamic_voxelised = s->gi_dynamic_voxelised,
                         .gi_relit = s->gi_relit,
                         .gi_probes_traced = s->gi_probes_traced};
}

bool renderer_draw(Renderer *renderer, GpuCommands *cmd, const Packet *packet, bool to_swapchain,
                   const Overlay *overlay) {
    stats_begin(renderer);
    device_lists_read(renderer, gpu_frame_slot(renderer->gpu));
    gi_read_reports(renderer, gpu_frame_slot(renderer->gpu));
    if (!packet_draw(renderer, cmd, packet)) return false;
    PassContext context = {.renderer = renderer, .cmd = cmd, .packet = packet, .overlay = overlay};
    if (to_swapchain) pass_run(&context, &present_pass);
    return true;
}

// *again: the voxels did not fit into their buffers, which are larger now.
static bool draw_once(Renderer *renderer, const Packet *packet, const Packet *other,
                      const SplitView *split, Arena *arena, RenderImage *out, bool *again) {
    GpuCommands *cmd = gpu_frame_begin(renderer->gpu);
    if (!cmd) return false;
    bool drawn = split ? renderer_draw_split(renderer, cmd, packet, other, split, false, NULL)
                       : renderer_draw(renderer, cmd, packet, false, NULL);
    if (drawn && out) {
        GpuBarrier barrier = {.texture = renderer->targets[RESOURCE_LDR],
                              .from = renderer->usage[RESOURCE_LDR],
                              .to = GPU_USAGE_COPY_SOURCE};
        gpu_cmd_barriers(cmd, &barrier, 1);
        renderer->usage[RESOURCE_LDR] = GPU_USAGE_COPY_SOURCE;
        gpu_cmd_copy_texture_to_buffer(cmd, renderer->targets[RESOURCE_LDR], renderer->readback);
    }
    if (!gpu_frame_is_open(renderer->gpu)) return false; // lost while warming up
    // A frame that failed half-way is still submitted: the slot must come free.
    u32 slot = gpu_frame_slot(renderer->gpu);
    if (!gpu_frame_end(renderer->gpu, true) || !drawn) return false;
    device_lists_read(renderer, slot);
    device_lists_stats(renderer, packet);
    *again = gi_read_reports(renderer, slot);
    if (out && !*again) {
        u64 size = (u64)packet->width_px * packet->height_px * 4;
        out->width_px = packet->width_px;
        out->height_px = packet->height_px;
        out->rgba = ARENA_PUSH(arena, u8, size);
        memcpy(out->rgba, gpu_buffer_map(renderer->gpu, renderer->readback), size);
        out->hash = render_image_hash(out->rgba, out->width_px, out->height_px);
    }
    return true;
}

static bool draw_and_wait(Renderer *renderer, const Packet *packet, const Packet *other,
                          const SplitView *split, Arena *arena, RenderImage *out) {
    // Each round knows exactly how many voxels the last one wanted; a split has two sets of them.
    bool again = true;
    for (u32 round = 0; round < 4 && again; round++)
        if (!draw_once(renderer, packet, other, split, arena, out, &again)) return false;
    return !again;
}

bool renderer_render_image(Renderer *renderer, const Packet *packet, Arena *arena,
                           RenderImage *out) {
    return draw_and_wait(renderer, packet, NULL, NULL, arena, out);
}

bool renderer_render_split(Renderer *renderer, const Packet *a, const Packet *b,
                           const SplitView *split, Arena *arena, RenderImage *out) {
    return draw_and_wait(renderer, a, b, split, arena, out);
}

u64 render_image_hash(const u8 *rgba, u32 width_px, u32 height_px) {
    u32 size[2] = {width_px, height_px};
    return hash_bytes(rgba, (u64)width_px * height_px * 4, hash_bytes(size, sizeof size, 0));
}

u64 resource_read(Renderer *renderer, RenderResource id, void *out, u64 size) {
    Gpu *gpu = renderer->gpu;
    GpuTexture texture = renderer->targets[id];
    GpuBuffer buffer = renderer->device_buffers[id];
    bool is_buffer = id >= RESOURCE_FIRST_BUFFER;
    if (is_buffer ? !buffer.id : !texture.id) return 0;
    u64 whole = is_buffer ? gpu_buffer_size(gpu, buffer) : gpu_texture_size(gpu, texture);
    GpuBuffer to = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "read back",
                                                           .heap = "staging",
                                                           .kind = GPU_BUFFER_READBACK,
                                                           .size = whole});
    if (!to.id) return 0;
    GpuCommands *cmd = gpu_frame_begin(gpu);
    bool ok = cmd != NULL;
    if (ok) {
        GpuBarrier barrier = {.texture = texture,
                              .buffer = buffer,
                              .from = renderer->usage[id],
                              .to = GPU_USAGE_COPY_SOURCE};
        gpu_cmd_barriers(cmd, &barrier, 1);
        if (is_buffer)
            gpu_cmd_copy_buffer(cmd, buffer, 0, to, 0, whole);
        else
            gpu_cmd_copy_mips_to_buffer(cmd, texture, to);
        // As before: not every pass that reads it says so again.
        if (barrier.from != GPU_USAGE_NONE) {
            barrier.from = GPU_USAGE_COPY_SOURCE;
            barrier.to = renderer->usage[id];
            gpu_cmd_barriers(cmd, &barrier, 1);
        } else {
            renderer->usage[id] = GPU_USAGE_COPY_SOURCE;
        }
        ok = gpu_frame_end(gpu, true);
    }
    size = MIN(size, whole);
    if (ok) memcpy(out, gpu_buffer_map(gpu, to), size);
    gpu_destroy_buffer(gpu, to);
    return ok ? size : 0;
}

u32 renderer_pass_names(RenderPath path, const char **out, u32 out_cap) {
    u32 count = 0;
    for (u32 i = 0; i < PATH_PASSES_CAP && path_table[path].passes[i] && count < out_cap; i++)
        out[count++] = path_table[path].passes[i]->name;
    return count;
}

RendererStats renderer_stats(const Renderer *renderer) {
    RendererStats stats = renderer->stats;
    if (!renderer->gi.is_on) return stats;
    const u32 *counters = renderer->gi_reports.counters;
    stats.gi_dynamic_voxels = counters[GI_COUNTER_DYNAMIC];
    stats.gi_voxels = counters[GI_COUNTER_STATIC] + counters[GI_COUNTER_DYNAMIC];
    stats.gi_lost_voxels = counters[GI_COUNTER_LOST];
    stats.gi_bytes = gi_memory(renderer);
    return stats;
}

// --- Warm-up: shaders compile when they first run (up to 150 ms each on the software driver) ---

bool renderer_warm_up(Renderer *renderer, const Packet *packet, RenderProgress progress,
                      void *user) {
    Arena scratch;
    if (!arena_create(&scratch, "warm-up", packet->size + MIB(1))) return false;
    Packet *copy = arena_push(&scratch, packet->size, CACHE_LINE);
    memcpy(copy, packet, packet->size);
    // One light of each kind that is there (counting the dummy) and empty lists: thousands would
    // make the slow paths' first frame take seconds, and the shaders compile just the same.
    CellRecord *cells = (CellRecord *)((u8 *)copy + copy->cells.offset);
    memset(cells, 0, copy->cells.count * sizeof *cells);
    copy->grid_nodes.count = 0;
    copy->frame.counts[0] = 1;
    copy->frame.counts[1] = MIN(copy->frame.counts[1], 1);
    copy->frame.counts[3] = 0;
    for (u32 i = 0; i < 4; i++)
        copy->frame.counts3[i] = i < 2 ? MIN(copy->frame.counts3[i], copy->frame.counts[i]) : 0;
    renderer->is_warming_up = true;
    renderer->progress = progress;
    renderer->progress_user = user;
    renderer->progress_done = 0;
    bool ok = renderer_render_image(renderer, copy, NULL, NULL);
    renderer->is_warming_up = false;
    renderer->progress = NULL;
    if (ok && progress) progress(user, renderer->progress_total, renderer->progress_total, "ready");
    arena_destroy(&scratch);
    return ok;
}

bool renderer_warm_up_path(Renderer *renderer, const Packet *packet) {
    return renderer_render_image(renderer, packet, NULL, NULL);
}
