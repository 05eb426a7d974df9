// post.c: from radiance to the picture: the post chain, debug pictures, and the window.
// Data in: the HDR target. Data out: commands. Called by: pass_run (passes.c).
#include "passes.h"

// --- Picture ---

static void tonemap_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_TONEMAP);
    text_record(c);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass tonemap_pass = {
    "tonemap", {OVERWRITE(LDR, COLOR_TARGET), USE(HDR, SAMPLED_FRAGMENT)}, 2, tonemap_record, NULL};

static void debug_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEBUG);
    text_record(c);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass debug_pass = {
    "debug view",
    {OVERWRITE(LDR, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT)},
    7,
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
