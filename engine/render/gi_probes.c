// gi_probes.c: the pass that traces the grid of irradiance probes.
//
// Data in: the filtered voxels, GiRecord.probes, whose turn it is (GiState.probe_turn). Data out:
// RESOURCE_GI_PROBES: what each probe says is written in gi_probes.comp. Called by pass_run, with
// diffuse = probes. Does not: decide when probes are traced (gi.c), or read them (gi_screen.c).
//
// With share n, one probe in n is traced a frame: those whose index leaves the same remainder. A
// probe's value follows from the voxels alone, so n frames of a still scene end with the same bits
// as one cold frame.
#include "passes.h"

#define PROBES_GROUP 64

static bool probes_needed(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    return gi->is_on && gi->trace_probes;
}

static void probes_record(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    const u32 *size = c->packet->gi.record.probes;
    u32 all = size[0] * size[1] * size[2];
    u32 stride = gi->is_cold ? 1 : CLAMP(c->packet->gi.params.share, 1, all);
    u32 first = gi->probe_turn % stride;
    const u32 push[3] = {first, stride, (all - first + stride - 1) / stride};
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_GI_PROBES, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    gi_bind_build(c, pipeline, 0);
    gpu_cmd_push(c->cmd, push, sizeof push);
    gpu_cmd_dispatch(c->cmd, (push[2] + PROBES_GROUP - 1) / PROBES_GROUP, 1, 1);
    c->renderer->stats.gi_probes_refreshed += push[2];
}
const Pass gi_probes_pass = {"probes",
                             {USE(GI_MASKS, STORAGE_COMPUTE), USE(GI_RANKS, STORAGE_COMPUTE),
                              USE(GI_VOXELS, STORAGE_COMPUTE), USE(GI_ATTRIBUTES, STORAGE_COMPUTE),
                              USE(GI_ACCUMULATORS, STORAGE_COMPUTE),
                              USE(GI_RADIANCE, STORAGE_COMPUTE), USE(GI_COUNTERS, STORAGE_COMPUTE),
                              USE_VOXEL_LIGHT(SAMPLED_COMPUTE), USE(SHADOW_MAP, SAMPLED_COMPUTE),
                              USE(GI_PROBES, STORAGE_COMPUTE)},
                             12,
                             probes_record,
                             probes_needed,
                             NULL};
