// gi_screen.c: passes that bring the voxels' light to the screen: lights with traced shadows, cones
// from every pixel (or one in 2 x 2, 4 x 4), their mean over neighbours if they are dithered, and
// the sum with what lies in HDR. Data in: G-buffer, depth, the voxels' volumes, a packet's traced
// lights. Data out: commands. Called by: pass_run (passes.c), after the lit surfaces and before the
// sky. Does not: make voxels or filter them.
//
// Paths that shade where they draw have no G-buffer: gi_gbuffer_pass draws one (layout_of: lean) of
// one sample a pixel. With several samples, all of a pixel's get the same light: that of its
// middle, or at edges the mean of what they show.
#include "passes.h"

static void gi_gbuffer_record(const PassContext *c) { gbuffer_pass.record(c); }
const Pass gi_gbuffer_pass = {"gi gbuffer",
                              {OVERWRITE_GBUFFER(COLOR_TARGET), OVERWRITE(DEPTH, DEPTH_TARGET),
                               USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                              7,
                              gi_gbuffer_record,
                              gi_is_on};

// Over every surface; the sky is passed over.
static void draw_over(const PassContext *c, PipelineKind kind) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    begin(c, &(GpuRendering){.targets = {color_target(c, false)},
                             .target_count = 1,
                             .depth = depth_target(c, false),
                             .depth_read_only = true});
    gi_bind_screen(c, pipeline);
    gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
    gpu_cmd_end_rendering(c->cmd);
    c->renderer->stats.draw_calls++;
}

static bool traced_needed(const PassContext *c) {
    return gi_is_on(c) && c->packet->traced_lights.count > 0;
}
static void traced_record(const PassContext *c) { draw_over(c, PIPELINE_GI_TRACED_LIGHTS); }
const Pass gi_traced_pass = {"gi traced lights",
                             {USE(HDR, COLOR_TARGET), USE(HDR_MS, COLOR_TARGET),
                              USE_GBUFFER(SAMPLED_FRAGMENT), USE(DEPTH, DEPTH_TEST),
                              USE(DEPTH_MS, DEPTH_TEST), USE_VOXEL_LIGHT(SAMPLED_FRAGMENT),
                              USE(GI_VISIBILITY, SAMPLED_FRAGMENT)},
                             13,
                             traced_record,
                             traced_needed};

// One invocation a traced pixel.
static void by_traced_pixel(const PassContext *c, PipelineKind kind) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    gi_bind_screen(c, pipeline);
    const GiRecord *gi = &c->packet->gi.record;
    gpu_cmd_dispatch(c->cmd, ((u32)gi->trace[0] + 7) / 8, ((u32)gi->trace[1] + 7) / 8, 1);
}

// No pixel is alone before gi_tiled_pass says so.
static void clear_alone(const PassContext *c) {
    const u32 word = sizeof(u32);
    GpuBuffer alone = c->renderer->device_buffers[RESOURCE_GI_ALONE];
    gpu_cmd_fill_buffer(c->cmd, alone, GI_ALONE_COUNT * word, 2 * word, 0);
    gpu_cmd_fill_buffer(c->cmd, alone, (GI_ALONE_GROUPS + 1) * word, 2 * word, 1);
}

static void trace_record(const PassContext *c) {
    if (gi_shades_tiles(c)) clear_alone(c);
    by_traced_pixel(c, PIPELINE_GI_TRACE);
}
const Pass gi_trace_pass = {"gi trace",
                            {OVERWRITE(GI_TRACE_0, STORAGE_COMPUTE),
                             OVERWRITE(GI_TRACE_1, STORAGE_COMPUTE),
                             OVERWRITE(GI_TRACE_RAW, STORAGE_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
                             USE(DEPTH, SAMPLED_COMPUTE), USE_VOXEL_LIGHT(SAMPLED_COMPUTE),
                             USE(GI_IRRADIANCE, SAMPLED_COMPUTE), USE(GI_PROBES, SAMPLED_COMPUTE),
                             USE(GI_ALONE, COPY_TARGET)},
                            15,
                            trace_record,
                            gi_is_on};

static bool smooth_needed(const PassContext *c) {
    return gi_is_on(c) && c->packet->gi.params.dither;
}
static void smooth_record(const PassContext *c) { by_traced_pixel(c, PIPELINE_GI_SMOOTH); }
const Pass gi_smooth_pass = {"gi smooth",
                             {OVERWRITE(GI_TRACE_0, STORAGE_COMPUTE),
                              USE(GI_TRACE_RAW, SAMPLED_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
                              USE(DEPTH, SAMPLED_COMPUTE)},
                             8,
                             smooth_record,
                             smooth_needed};

// With one sample a pixel by squares of pixels between the same traced ones.
static bool compose_needed(const PassContext *c) {
    return gi_is_on(c) && c->renderer->samples == 1 && !gi_shades_tiles(c);
}
static void compose_record(const PassContext *c) {
    GpuPipeline pipeline =
        pipeline_get(c->renderer, c->packet, PIPELINE_GI_COMPOSE, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    gi_bind_screen(c, pipeline);
    const GiRecord *gi = &c->packet->gi.record;
    u32 squares[2]; // those at the border begin half a square before it
    for (u32 i = 0; i < 2; i++)
        squares[i] = (u32)gi->trace[i] + (c->packet->gi.params.resolution != GI_RESOLUTION_FULL);
    gpu_cmd_dispatch(c->cmd, (squares[0] + 7) / 8, (squares[1] + 7) / 8, 1);
}
#define COMPOSE_READS(stage)                                                                       \
    USE_GBUFFER(stage), USE(GI_TRACE_0, stage), USE(GI_TRACE_1, stage), USE_VOXEL_LIGHT(stage),    \
        USE(GI_IRRADIANCE, stage), USE(GI_PROBES, stage)
const Pass gi_compose_pass = {
    "gi compose",
    {USE(HDR, STORAGE_COMPUTE), USE(DEPTH, SAMPLED_COMPUTE), COMPOSE_READS(SAMPLED_COMPUTE)},
    14,
    compose_record,
    compose_needed};

// As a part of shading tiles, where the driver is such that reading the G-buffer and the picture
// again costs more than the sum itself. Lights with traced shadows come between the two.
bool gi_shades_tiles(const PassContext *c) {
    const GpuInfo *info = gpu_info(c->renderer->gpu);
    return gi_is_on(c) && c->packet->settings.path == PATH_TILED_DEFERRED && info->is_software &&
           info->subgroup_size * tiled_pixels_per_lane(c->renderer) == 64 &&
           c->renderer->samples == 1 && !traced_needed(c);
}

static void tiled_record(const PassContext *c) {
    warm_up_list_kinds(c, PIPELINE_GI_TILED);
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_GI_TILED, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    gi_bind_screen(c, pipeline);
    gpu_cmd_dispatch(c->cmd, (c->packet->width_px + 7) / 8, (c->packet->height_px + 7) / 8, 1);
}
const Pass gi_tiled_pass = {"lighting",
                            {OVERWRITE(HDR, STORAGE_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
                             USE(DEPTH, SAMPLED_COMPUTE), USE(SHADOW_MAP, SAMPLED_COMPUTE),
                             USE_LISTS(STORAGE_READ_COMPUTE), USE(GI_TRACE_0, SAMPLED_COMPUTE),
                             USE(GI_TRACE_1, SAMPLED_COMPUTE), USE(GI_ALONE, STORAGE_COMPUTE)},
                            16,
                            tiled_record,
                            gi_shades_tiles};

static bool alone_needed(const PassContext *c) {
    return gi_shades_tiles(c) && c->packet->gi.params.resolution != GI_RESOLUTION_FULL;
}
static void alone_record(const PassContext *c) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_GI_ALONE, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    gi_bind_screen(c, pipeline);
    gpu_cmd_dispatch_indirect(c->cmd, c->renderer->device_buffers[RESOURCE_GI_ALONE],
                              GI_ALONE_GROUPS * sizeof(u32));
}
const Pass gi_alone_pass = {"gi alone",
                            {USE(HDR, STORAGE_COMPUTE), USE(DEPTH, SAMPLED_COMPUTE),
                             COMPOSE_READS(SAMPLED_COMPUTE), USE(GI_ALONE, INDIRECT)},
                            15,
                            alone_record,
                            alone_needed};

static bool compose_ms_needed(const PassContext *c) {
    return gi_is_on(c) && c->renderer->samples > 1;
}
static void compose_ms_record(const PassContext *c) { draw_over(c, PIPELINE_GI_COMPOSE_MS); }
const Pass gi_compose_ms_pass = {"gi compose of samples",
                                 {USE(HDR_MS, COLOR_TARGET), USE(DEPTH, SAMPLED_FRAGMENT),
                                  USE(DEPTH_MS, DEPTH_TEST), COMPOSE_READS(SAMPLED_FRAGMENT)},
                                 15,
                                 compose_ms_record,
                                 compose_ms_needed};
