// passes_lighting.c: passes that light what the G-buffer holds.
// Data in: a packet's lights and light lists. Data out: commands. Called by: pass_run (passes.c).
#include "passes.h"

// One full-screen triangle a light, lights [first, first + count).
static void draw_lights(const PassContext *c, PipelineKind kind, u32 first, u32 count) {
    if (count == 0) return;
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_bind_vertices(c->cmd, 0, c->renderer->buffers[FRAME_BUFFER_LIGHTS],
                          first * sizeof(LightRecord));
    // Points have no spot record; something of the same size must be there for each.
    FrameBuffer second = kind == PIPELINE_DEFERRED_SPOTS ? FRAME_BUFFER_SPOTS : FRAME_BUFFER_LIGHTS;
    gpu_cmd_bind_vertices(c->cmd, 1, c->renderer->buffers[second], 0);
    gpu_cmd_draw(c->cmd, 3, count, 0, 0);
    c->renderer->stats.draw_calls++;
}

// --- Lighting ---

static void deferred_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {CLEARED(ACCUMULATION)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEFERRED_BASE);
    u32 point_count = c->packet->frame.counts[0], spot_count = c->packet->frame.counts[1];
    draw_lights(c, PIPELINE_DEFERRED_POINTS, 0, point_count);
    draw_lights(c, PIPELINE_DEFERRED_SPOTS, point_count, spot_count);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass deferred_pass = {"lighting",
                            {OVERWRITE(ACCUMULATION, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT),
                             USE(DEPTH, SAMPLED_FRAGMENT), USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                            8,
                            deferred_record,
                            NULL};

static void resolve_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEFERRED_RESOLVE);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass resolve_pass = {"resolve",
                           {OVERWRITE(HDR, COLOR_TARGET), USE(ACCUMULATION, SAMPLED_FRAGMENT)},
                           2,
                           resolve_record,
                           NULL};

void warm_up_list_kinds(const PassContext *c, PipelineKind kind) {
    if (!c->renderer->is_warming_up) return;
    bool may_be_long = c->packet->lights.count > SURVIVORS_CAP;
    for (u32 kinds = 1; kinds <= (LIST_KIND_LONG | LIST_KIND_DIFFUSE); kinds++) {
        if (kinds & LIST_KIND_LONG && !may_be_long) continue;
        if (kinds & LIST_KIND_DIFFUSE && !c->packet->settings.light_lod) continue;
        PipelineVariant variant = {.list_kinds = kinds};
        GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, variant);
        if (!pipeline.id) continue;
        if (kind == PIPELINE_GI_TILED)
            gi_bind_screen(c, pipeline);
        else
            bind_frame(c, pipeline);
        gpu_cmd_dispatch(c->cmd, 1, 1, 1);
    }
}

static bool tiled_needed(const PassContext *c) { return !gi_shades_tiles(c); }
static void tiled_record(const PassContext *c) {
    warm_up_list_kinds(c, PIPELINE_TILED);
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_TILED, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_dispatch(c->cmd, (c->packet->width_px + 7) / 8, (c->packet->height_px + 7) / 8, 1);
}
const Pass tiled_pass = {"lighting",
                         {OVERWRITE(HDR, STORAGE_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
                          USE(DEPTH, SAMPLED_COMPUTE), USE(SHADOW_MAP, SAMPLED_COMPUTE),
                          USE_LISTS(STORAGE_READ_COMPUTE)},
                         13,
                         tiled_record,
                         tiled_needed};
