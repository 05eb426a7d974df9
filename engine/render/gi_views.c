// gi_views.c: the debug pictures of global illumination: voxels, probes, the parts of indirect
// light.
// Data in: the voxels' volumes, the G-buffer, what was traced; settings view, gi.show and its level
// and direction. Data out: commands. Called by: pass_run (passes.c); the legends are in
// debug_views.c. Does not: make any of it; the passes before it in its path do.
#include "passes.h"

static PipelineKind kind_of(const Packet *packet) {
    switch (packet->settings.view) {
    case VIEW_GI_VOXELS:
        return PIPELINE_GI_VIEW_VOXELS;
    case VIEW_GI_PROBES:
        return PIPELINE_GI_VIEW_PROBES;
    default:
        return PIPELINE_GI_VIEW_TRACE;
    }
}

static void gi_view_record(const PassContext *c) {
    const RenderSettings *settings = &c->packet->settings;
    // Filtered levels are drawn in a way of their own (SPEC_GI_STEP).
    u32 step = settings->view == VIEW_GI_VOXELS && settings->gi_show == GI_SHOW_RADIANCE &&
               settings->gi_show_level > 0;
    GpuPipeline pipeline = {0};
    if (gi_is_on(c))
        pipeline = pipeline_get(c->renderer, c->packet, kind_of(c->packet),
                                (PipelineVariant){.post = step});
    begin(c, &(GpuRendering){.targets = {CLEARED(LDR)}, .target_count = 1});
    if (pipeline.id) {
        gi_bind_screen(c, pipeline);
        // Some pictures take long; compiling takes a few pixels.
        if (c->renderer->is_warming_up) gpu_cmd_scissor(c->cmd, 0, 0, 8, 8);
        gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
        c->renderer->stats.draw_calls++;
    }
    debug_view_record(c);
    text_record(c, TEXT_PACKET);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass gi_view_pass = {
    "gi view",
    {OVERWRITE(LDR, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT),
     USE_VOXEL_LIGHT(SAMPLED_FRAGMENT), USE(GI_IRRADIANCE, SAMPLED_FRAGMENT),
     USE(GI_VISIBILITY, SAMPLED_FRAGMENT), USE(GI_PROBES, SAMPLED_FRAGMENT),
     USE(GI_TRACE_0, SAMPLED_FRAGMENT), USE(GI_TRACE_1, SAMPLED_FRAGMENT),
     USE(GI_MASKS, READ_VERTEX), USE(GI_RANKS, READ_VERTEX), USE(GI_ATTRIBUTES, READ_VERTEX)},
    18,
    gi_view_record,
    NULL,
    NULL};
