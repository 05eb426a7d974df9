// passes_forward.c: passes that shade meshes where they are drawn: one pass over all lights, by
// lists after a depth pre-pass, or in groups of lights; and what their samples become.
// Data in: a packet's draw lists and lights. Data out: commands. Called by: pass_run (passes.c).
// Does not: make lists (the packet's, or passes_lists.c).
#include "passes.h"

// --- All lights at once ---

static void forward_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {color_target(c, true)},
                             .target_count = 1,
                             .depth = depth_target(c, true)});
    draw_list(c, PIPELINE_FORWARD, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_FORWARD, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass forward_pass = {"forward",
                           {OVERWRITE(HDR, COLOR_TARGET), OVERWRITE(HDR_MS, COLOR_TARGET),
                            OVERWRITE(DEPTH, DEPTH_TARGET), OVERWRITE(DEPTH_MS, DEPTH_TARGET),
                            USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                           5,
                           forward_record,
                           NULL,
                           NULL};

// --- Depth first: then every pixel is shaded once, and lists can know what is seen ---

static void prepass_record(const PassContext *c) {
    begin(c, &(GpuRendering){.depth = depth_target(c, true)});
    draw_list(c, PIPELINE_PREPASS, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_PREPASS_MASK, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
// The G-buffer that GI needs has the same depth, of one sample a pixel.
static bool prepass_needed(const PassContext *c) {
    return !gi_is_on(c) || c->renderer->samples > 1;
}
const Pass prepass_pass = {"depth pre-pass",
                           {OVERWRITE(DEPTH, DEPTH_TARGET), OVERWRITE(DEPTH_MS, DEPTH_TARGET)},
                           2,
                           prepass_record,
                           prepass_needed,
                           NULL};

// Holes need no second look: nothing lies at a hole's depth.
static void forward_lists_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {color_target(c, true)},
                             .target_count = 1,
                             .depth = depth_target(c, false),
                             .depth_read_only = true});
    draw_list(c, PIPELINE_FORWARD_LISTS, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_FORWARD_LISTS, c->packet->mask_draws, false);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass forward_lists_pass = {"forward",
                                 {OVERWRITE(HDR, COLOR_TARGET), OVERWRITE(HDR_MS, COLOR_TARGET),
                                  USE(DEPTH, DEPTH_TEST), USE(DEPTH_MS, DEPTH_TEST),
                                  USE(SHADOW_MAP, SAMPLED_FRAGMENT), USE_LISTS(READ_VERTEX)},
                                 10,
                                 forward_lists_record,
                                 NULL,
                                 NULL};

// --- In groups of lights, added up in full precision ---

// The scene once for each group of MULTIPASS_LIGHTS lights [first, first + count).
static void draw_groups(const PassContext *c, PipelineKind kind, u32 first, u32 count) {
    for (u32 i = 0; i < count; i += MULTIPASS_LIGHTS) {
        // Places after the last light are the dummy's.
        const u32 push[4] = {first + i, first + count, c->packet->frame.counts2[2], 0};
        draw_list_with(c, kind, c->packet->opaque_draws, false, push, sizeof push);
        draw_list_with(c, kind, c->packet->mask_draws, false, push, sizeof push);
    }
}

// Where surfaces lie in one plane, the last one drawn is seen, and only that one may be lit: the
// base pass notes whose each pixel is, in HDR_OTHER, which nobody needs before the post chain.
static void multipass_base_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {CLEARED(ACCUMULATION), CLEARED(HDR_OTHER)},
                             .target_count = 2,
                             .depth = TARGET(DEPTH),
                             .depth_read_only = true});
    draw_list(c, PIPELINE_MULTIPASS_BASE, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_MULTIPASS_BASE, c->packet->mask_draws, false);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass multipass_base_pass = {"base",
                                  {OVERWRITE(ACCUMULATION, COLOR_TARGET),
                                   OVERWRITE(HDR_OTHER, COLOR_TARGET), USE(DEPTH, DEPTH_TEST),
                                   USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                                  4,
                                  multipass_base_record,
                                  NULL,
                                  NULL};

static void multipass_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(ACCUMULATION)},
                             .target_count = 1,
                             .depth = TARGET(DEPTH),
                             .depth_read_only = true});
    const FrameRecord *frame = &c->packet->frame;
    draw_groups(c, PIPELINE_MULTIPASS_POINTS, 0, frame->counts[0]);
    draw_groups(c, PIPELINE_MULTIPASS_SPOTS, frame->counts[0], frame->counts[1]);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass multipass_pass = {
    "lighting",
    {USE(ACCUMULATION, COLOR_TARGET), USE(DEPTH, DEPTH_TEST), USE(HDR_OTHER, SAMPLED_FRAGMENT)},
    3,
    multipass_record,
    NULL,
    NULL};

// --- From samples to pixels: the average radiance, the first sample's depth ---

static bool samples_needed(const PassContext *c) { return c->renderer->samples > 1; }
static void samples_record(const PassContext *c) {
    const Renderer *r = c->renderer;
    GpuTarget color = TARGET(HDR_MS), depth = TARGET(DEPTH_MS);
    color.resolve = r->targets[RESOURCE_HDR];
    depth.resolve = r->targets[RESOURCE_DEPTH];
    begin(c, &(GpuRendering){
                 .targets = {color}, .target_count = 1, .depth = depth, .depth_read_only = true});
    gpu_cmd_end_rendering(c->cmd);
}
const Pass samples_pass = {"resolve samples",
                           {OVERWRITE(HDR, COLOR_TARGET), USE(HDR_MS, COLOR_TARGET),
                            OVERWRITE(DEPTH, DEPTH_RESOLVE), USE(DEPTH_MS, DEPTH_TEST)},
                           4,
                           samples_record,
                           samples_needed,
                           NULL};
