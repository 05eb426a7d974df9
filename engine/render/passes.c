// passes.c: the pass table: what each path runs, what each pass reads and writes, and how it
// records itself.
//
// Data in: a packet. Data out: commands. pass_run derives the barriers from the rows, sets label
// and timer; a pass only binds and draws. To add a pass: write its record function, its row, and
// name the row in the paths that want it.
#include "render_internal.h"
#include <string.h>

#define USE(id, use_)                                                                              \
    { RESOURCE_##id, GPU_USAGE_##use_, false }
#define OVERWRITE(id, use_)                                                                        \
    { RESOURCE_##id, GPU_USAGE_##use_, true }

static void bind_frame(const PassContext *c, GpuPipeline pipeline) {
    gpu_cmd_bind_pipeline(c->cmd, pipeline);
    gpu_cmd_bind_group(c->cmd, 0, c->renderer->frame_group);
}

void draw_list(const PassContext *c, PipelineKind kind, PacketSection section, bool alpha_mask) {
    if (section.count == 0) return;
    Renderer *r = c->renderer;
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)c->packet + section.offset);
    const PacketMaterial *materials = PACKET_DATA(c->packet, material_bindings, PacketMaterial);
    gpu_cmd_bind_vertices(c->cmd, 0, r->vertices, 0);
    gpu_cmd_bind_vertices(c->cmd, 1, r->buffers[FRAME_BUFFER_INSTANCES], 0);
    gpu_cmd_bind_indices(c->cmd, r->indices, false);
    GpuPipeline bound = {0};
    u32 bound_material = UINT32_MAX;
    for (u32 i = 0; i < section.count; i++) {
        const PacketDraw *draw = &draws[i];
        if (draw->mesh >= r->mesh_count || r->meshes[draw->mesh].lods[0].index_count == 0) continue;
        const PacketMaterial *material = &materials[draw->material];
        GpuPipeline pipeline =
            pipeline_get(r, c->packet, kind,
                         (PipelineVariant){.alpha_mask = alpha_mask,
                                           .double_sided = material->double_sided != 0,
                                           .textures = (material->albedo_texture ? 1 : 0) |
                                                       (material->normal_texture ? 2 : 0)});
        if (!pipeline.id) continue;
        if (pipeline.id != bound.id) {
            bind_frame(c, pipeline);
            bound = pipeline;
            bound_material = UINT32_MAX;
        }
        if (draw->material != bound_material) {
            gpu_cmd_bind_group(c->cmd, 1, render_material_group(r, material));
            bound_material = draw->material;
        }
        const GpuMesh *mesh = &r->meshes[draw->mesh];
        const MeshLod *lod = &mesh->lods[MIN(draw->lod, mesh->lod_count - 1)];
        gpu_cmd_draw_indexed(c->cmd, lod->index_count, draw->instance_count, lod->first_index,
                             mesh->vertex_offset, draw->first_instance);
        r->stats.draw_calls++;
        r->stats.triangles += lod->index_count / 3 * draw->instance_count;
    }
}

static void draw_fullscreen(const PassContext *c, PipelineKind kind) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
    c->renderer->stats.draw_calls++;
}

// One full-screen triangle a light, lights [first, first + count).
static void draw_lights(const PassContext *c, PipelineKind kind, u32 first, u32 count) {
    if (count == 0) return;
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_bind_vertices(c->cmd, 0, c->renderer->buffers[FRAME_BUFFER_LIGHTS],
                          first * sizeof(LightRecord));
    gpu_cmd_bind_vertices(c->cmd, 1, c->renderer->buffers[FRAME_BUFFER_SPOTS], 0);
    gpu_cmd_draw(c->cmd, 3, count, 0, 0);
    c->renderer->stats.draw_calls++;
}

static void begin(const PassContext *c, const GpuRendering *rendering) {
    GpuRendering sized = *rendering;
    sized.width = c->packet->width_px;
    sized.height = c->packet->height_px;
    gpu_cmd_begin_rendering(c->cmd, &sized);
}
#define TARGET(id)                                                                                 \
    { .texture = c->renderer->targets[RESOURCE_##id] }
#define CLEARED(id)                                                                                \
    { .texture = c->renderer->targets[RESOURCE_##id], .clear = true }

// --- Shadow map: drawn only when what it shows changed (shadow_key) ---

static bool shadow_needed(const PassContext *c) {
    return c->packet->shadow_size_px > 0 && c->renderer->shadow_key != c->packet->shadow_key;
}
static void shadow_record(const PassContext *c) {
    gpu_cmd_begin_rendering(c->cmd, &(GpuRendering){.depth = CLEARED(SHADOW_MAP),
                                                    .width = c->packet->shadow_size_px,
                                                    .height = c->packet->shadow_size_px});
    draw_list(c, PIPELINE_SHADOW, c->packet->shadow_draws, false);
    draw_list(c, PIPELINE_SHADOW_MASK, c->packet->shadow_mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
    c->renderer->shadow_key = c->packet->shadow_key;
    c->renderer->stats.shadow_redrawn = 1;
}
static const Pass shadow_pass = {
    "shadow", {OVERWRITE(SHADOW_MAP, DEPTH_TARGET)}, 1, shadow_record, shadow_needed};

// --- Geometry ---

static void gbuffer_record(const PassContext *c) {
    // Colour is cleared as well: the background's material must be an index that exists.
    begin(c, &(GpuRendering){.targets = {CLEARED(GBUFFER_ALBEDO), CLEARED(GBUFFER_NORMAL)},
                             .target_count = 2,
                             .depth = CLEARED(DEPTH)});
    draw_list(c, PIPELINE_GBUFFER, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_GBUFFER, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass gbuffer_pass = {"gbuffer",
                                  {OVERWRITE(GBUFFER_ALBEDO, COLOR_TARGET),
                                   OVERWRITE(GBUFFER_NORMAL, COLOR_TARGET),
                                   OVERWRITE(DEPTH, DEPTH_TARGET)},
                                  3,
                                  gbuffer_record,
                                  NULL};

static void forward_record(const PassContext *c) {
    begin(c,
          &(GpuRendering){.targets = {CLEARED(HDR)}, .target_count = 1, .depth = CLEARED(DEPTH)});
    draw_list(c, PIPELINE_FORWARD, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_FORWARD, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass forward_pass = {"forward",
                                  {OVERWRITE(HDR, COLOR_TARGET), OVERWRITE(DEPTH, DEPTH_TARGET),
                                   USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                                  3,
                                  forward_record,
                                  NULL};

// --- Lighting ---

static void deferred_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {CLEARED(ACCUMULATION)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEFERRED_BASE);
    u32 point_count = c->packet->frame.counts[0], spot_count = c->packet->frame.counts[1];
    draw_lights(c, PIPELINE_DEFERRED_POINTS, 0, point_count);
    draw_lights(c, PIPELINE_DEFERRED_SPOTS, point_count, spot_count);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass deferred_pass = {
    "lighting",
    {OVERWRITE(ACCUMULATION, COLOR_TARGET), USE(GBUFFER_ALBEDO, SAMPLED_FRAGMENT),
     USE(GBUFFER_NORMAL, SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT),
     USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
    5,
    deferred_record,
    NULL};

static void resolve_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEFERRED_RESOLVE);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass resolve_pass = {
    "resolve",
    {OVERWRITE(HDR, COLOR_TARGET), USE(ACCUMULATION, SAMPLED_FRAGMENT)},
    2,
    resolve_record,
    NULL};

static void tiled_record(const PassContext *c) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_TILED, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_dispatch(c->cmd, (c->packet->width_px + 7) / 8, (c->packet->height_px + 7) / 8, 1);
}
static const Pass tiled_pass = {"lighting",
                                {OVERWRITE(HDR, STORAGE_COMPUTE),
                                 USE(GBUFFER_ALBEDO, SAMPLED_COMPUTE),
                                 USE(GBUFFER_NORMAL, SAMPLED_COMPUTE), USE(DEPTH, SAMPLED_COMPUTE),
                                 USE(SHADOW_MAP, SAMPLED_COMPUTE)},
                                5,
                                tiled_record,
                                NULL};

// --- What is drawn over the lit picture: sky, textured emission, blended surfaces ---

static void over_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR)},
                             .target_count = 1,
                             .depth = TARGET(DEPTH),
                             .depth_read_only = true});
    draw_fullscreen(c, PIPELINE_SKY);
    draw_list(c, PIPELINE_EMISSIVE, c->packet->emissive_draws, false);
    draw_list(c, PIPELINE_FORWARD_BLEND, c->packet->blend_draws, false);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass over_pass = {
    "sky and glow",
    {USE(HDR, COLOR_TARGET), USE(DEPTH, DEPTH_TEST), USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
    3,
    over_record,
    NULL};

// --- Picture ---

static void tonemap_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_TONEMAP);
    text_record(c);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass tonemap_pass = {
    "tonemap", {OVERWRITE(LDR, COLOR_TARGET), USE(HDR, SAMPLED_FRAGMENT)}, 2, tonemap_record, NULL};

static void debug_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEBUG);
    text_record(c);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass debug_pass = {
    "debug view",
    {OVERWRITE(LDR, COLOR_TARGET), USE(GBUFFER_ALBEDO, SAMPLED_FRAGMENT),
     USE(GBUFFER_NORMAL, SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT)},
    4,
    debug_record,
    NULL};

static void present_record(const PassContext *c) {
    u32 width, height;
    gpu_swapchain_size(c->renderer->gpu, &width, &height);
    gpu_cmd_begin_rendering(
        c->cmd, &(GpuRendering){.to_swapchain = true, .width = width, .height = height});
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_PRESENT, PIPELINE_PLAIN);
    if (pipeline.id) {
        bind_frame(c, pipeline);
        f32 push[4] = {1.0f / (f32)width, 1.0f / (f32)height, 0, 0};
        gpu_cmd_push(c->cmd, push, sizeof push);
        gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
    }
    if (c->overlay) overlay_record(c, c->overlay);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass present_pass = {"present", {USE(LDR, SAMPLED_FRAGMENT)}, 1, present_record, NULL};

const PathRow path_table[PATH_COUNT] = {
    [PATH_FORWARD] = {"forward", {&shadow_pass, &forward_pass, &over_pass, &tonemap_pass}},
    [PATH_DEFERRED] = {"deferred",
                       {&shadow_pass, &gbuffer_pass, &deferred_pass, &resolve_pass, &over_pass,
                        &tonemap_pass}},
    [PATH_TILED_DEFERRED] = {"tiled_deferred",
                             {&shadow_pass, &gbuffer_pass, &tiled_pass, &over_pass, &tonemap_pass}},
};
const PathRow debug_path = {"debug view", {&gbuffer_pass, &debug_pass}};

void pass_run(const PassContext *c, const Pass *pass) {
    if (pass->needed && !pass->needed(c)) return;
    Renderer *r = c->renderer;
    GpuBarrier barriers[PASS_USES_CAP];
    u32 barrier_count = 0;
    for (u32 i = 0; i < pass->use_count; i++) {
        const ResourceUse *use = &pass->uses[i];
        GpuUsage from = r->usage[use->resource];
        if (!gpu_usage_needs_barrier(from, use->usage)) continue;
        barriers[barrier_count++] = (GpuBarrier){.texture = r->targets[use->resource],
                                                 .from = from,
                                                 .to = use->usage,
                                                 .discard = use->discard};
        r->usage[use->resource] = use->usage;
    }
    gpu_cmd_label_begin(c->cmd, pass->name);
    gpu_cmd_timer_begin(c->cmd, pass->name);
    if (barrier_count) gpu_cmd_barriers(c->cmd, barriers, barrier_count);
    r->stats.barriers += barrier_count;
    pass->record(c);
    gpu_cmd_timer_end(c->cmd);
    gpu_cmd_label_end(c->cmd);
}
