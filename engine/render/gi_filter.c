// gi_filter.c: from lit voxels to the atlas that cones read: radiance of six directions (or one) in
// ever coarser levels.
//
// Data in: RADIANCE by slot, masks, places. Data out: GI_BASE (faces shared) and GI_ATLAS. Called
// by the pass table: after lighting, and again after the bounce. Does not: light anything.
//
// The finest level that is written, and the one over it, hold what is occupied and zeros; only
// voxels that are there or were there are touched (gi_filter_base.glsl). From the next level on
// everything is made anew: an eighth of the texels each. Last, for cones that read them, levels
// between the levels (gi_filter_thirds.glsl).
#include "passes.h"

static bool is_fresh(const PassContext *c) { return gi_is_on(c) && c->renderer->gi.is_fresh; }
// With feedback the bounce still reads what the last frame left: filtered once, after it.
static bool is_relit(const PassContext *c) {
    return gi_is_on(c) && c->renderer->gi.relight && !gi_feeds_back(c);
}

static u64 voxel_count(const PassContext *c) {
    const u32 *dims = c->packet->gi.record.dims;
    return (u64)dims[0] * dims[1] * dims[2] * dims[3];
}

// Volumes that were just made hold anything.
static void fresh_record(const PassContext *c) {
    u64 layer = voxel_count(c) / 8;
    gpu_cmd_clear_texture(c->cmd, c->renderer->targets[RESOURCE_GI_BASE]);
    gpu_cmd_clear_texture(c->cmd, c->renderer->targets[RESOURCE_GI_ATLAS]);
    gpu_cmd_fill_buffer(c->cmd, c->renderer->device_buffers[RESOURCE_GI_MASKS], GI_MASK_LIT * layer,
                        layer, 0);
}
const Pass gi_fresh_pass = {
    "voxel filter start",
    {USE(GI_BASE, COPY_TARGET), USE(GI_ATLAS, COPY_TARGET), USE(GI_MASKS, COPY_TARGET)},
    3,
    fresh_record,
    is_fresh};

enum { STEP_FORGET, STEP_SCATTER, STEP_PARENTS, STEP_FORGET_AND_PARENTS };

// One group makes the last levels, from the first of which it has so many texels at most.
#define TAIL_TEXELS 4096

// Level of the atlas that STEP_PARENTS writes; what is before it is the voxels' own: the base
// volume, which gi_light.c writes, or level 0 by STEP_SCATTER.
static u32 parent_level(const PassContext *c) {
    return c->packet->gi.params.faces == GI_FACES_APART ? 1 : 0;
}

static GpuPipeline base_pipeline(const PassContext *c, u32 step) {
    return pipeline_get(c->renderer, c->packet, PIPELINE_GI_FILTER_BASE,
                        (PipelineVariant){.post = step});
}

static void images_barrier(const PassContext *c) {
    gi_barrier(c, (RenderResource[]){RESOURCE_GI_BASE, RESOURCE_GI_ATLAS, RESOURCE_GI_MASKS}, 3);
}

u32 gi_parent_groups(const u32 dims[4]) {
    u64 row = MIN(dims[0], 32) * 4ull, voxels = (u64)dims[0] * dims[1] * dims[2] * dims[3];
    return (u32)((voxels / row + GI_PARENT_CHUNKS - 1) / GI_PARENT_CHUNKS);
}

// What moved leaves its light behind, and what was voxelised anew.
static bool must_forget(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    return gi->voxelise_static || gi->voxelise_dynamic || gi->is_fresh;
}
// A group of parents forgets as well, if the rows that it goes through are whole words.
static bool forgets_with_parents(const PassContext *c) {
    return c->packet->gi.record.dims[0] >= 32;
}

static void levels_record(const PassContext *c, bool forgets) {
    const GiRecord *record = &c->packet->gi.record;
    u32 blocks = c->packet->gi.params.filter == GI_FILTER_ISOTROPIC ? 1 : 6;
    u32 cascades = record->dims[3], first = parent_level(c);
    if (first > 0) {
        gi_bind_build(c, base_pipeline(c, STEP_SCATTER), 0);
        gi_dispatch_slots(c, GI_COUNTER_ALL_ARGS);
        images_barrier(c);
    }
    gi_bind_build(c, base_pipeline(c, forgets ? STEP_FORGET_AND_PARENTS : STEP_PARENTS), first);
    gpu_cmd_dispatch(c->cmd, gi_parent_groups(record->dims), 1, 1);
    images_barrier(c);
    GpuPipeline mip = pipeline_get(c->renderer, c->packet, PIPELINE_GI_FILTER_MIP, PIPELINE_PLAIN);
    for (u32 level = first + 1; level < record->atlas[3]; level++) {
        u32 x = (record->atlas[0] >> level) * blocks, y = record->atlas[1] >> level;
        u32 z = (record->atlas[2] >> level) * cascades;
        u32 left = record->atlas[3] - level;
        if (left > 1 && left <= GI_MIP_TAIL && x * y * z <= TAIL_TEXELS) {
            gi_bind_build(c,
                          pipeline_get(c->renderer, c->packet, PIPELINE_GI_FILTER_TAIL,
                                       (PipelineVariant){.post = left}),
                          level);
            gpu_cmd_dispatch(c->cmd, 1, 1, 1);
            gi_barrier(c, (RenderResource[]){RESOURCE_GI_ATLAS}, 1);
            break;
        }
        gi_bind_build(c, mip, level);
        gpu_cmd_dispatch(c->cmd, (x + 7) / 8, (y + 3) / 4, (z + 1) / 2);
        gi_barrier(c, (RenderResource[]){RESOURCE_GI_ATLAS}, 1);
    }
    for (u32 level = 0; gi_makes_thirds(c->packet) && level + 1 < record->atlas[3]; level++) {
        GpuPipeline thirds = pipeline_get(c->renderer, c->packet, PIPELINE_GI_FILTER_THIRDS,
                                          (PipelineVariant){.post = level & 1});
        u32 x = (record->atlas[0] >> level) * blocks, y = record->atlas[1] >> level;
        gi_bind_build(c, thirds, level + 1); // its source is this level
        gpu_cmd_dispatch(c->cmd, (x + 7) / 8, (y + 3) / 4, ((record->atlas[2] >> level) + 1) / 2);
        gi_barrier(c, (RenderResource[]){RESOURCE_GI_ATLAS}, 1);
    }
}

static void forget(const PassContext *c) {
    gi_bind_build(c, base_pipeline(c, STEP_FORGET), parent_level(c));
    gi_dispatch_words(c, voxel_count(c) / 32);
    images_barrier(c);
}

static void filter_record(const PassContext *c) {
    bool together = must_forget(c) && forgets_with_parents(c);
    if (must_forget(c) && !together) forget(c);
    levels_record(c, together);
}

#define FILTER_USES                                                                                \
    {                                                                                              \
        USE(GI_BASE, STORAGE_COMPUTE), USE(GI_ATLAS, STORAGE_COMPUTE),                             \
            USE(GI_MASKS, STORAGE_COMPUTE), USE(GI_RANKS, STORAGE_READ_COMPUTE),                   \
            USE(GI_VOXELS, STORAGE_READ_COMPUTE), USE(GI_RADIANCE, STORAGE_READ_COMPUTE),          \
            USE(GI_COUNTERS, INDIRECT), USE(GI_RADIANCE_2, STORAGE_READ_COMPUTE)                   \
    }
const Pass gi_filter_pass = {"voxel filter", FILTER_USES, 8, filter_record, is_relit};

static void refilter_record(const PassContext *c) {
    if (gi_feeds_back(c))
        filter_record(c);
    else
        levels_record(c, false);
}
const Pass gi_refilter_pass = {"voxel filter 2", FILTER_USES, 8, refilter_record, gi_bounces};
