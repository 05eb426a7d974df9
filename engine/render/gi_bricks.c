// gi_bricks.c: the base volume in bricks: texels only where voxels are (shaders/gi.glsl says how
// they lie). Of 512^3 voxels a surface fills few: a ninth to a third of the whole volume's bytes
// are left.
//
// Data in: places of the voxels by slot. Data out: GI_BRICKS, which says where a cell's brick is,
// and a base volume of zeros, which gi_light.c fills. Called by the pass table whenever voxels were
// made anew, and by gi.c for shapes. Does not: grow the image (gi.c does, by what was counted).
#include "passes.h"

enum { STEP_MARK, STEP_PLACE }; // gi_bricks.comp

bool gi_has_bricks(const Packet *packet) {
    const GiParams *params = &packet->gi.params;
    if (!params->enabled || params->faces != GI_FACES_SHARED) return false;
    u32 base = packet->settings.gi_base;
    return base == GI_BASE_BRICKS || (base == GI_BASE_AUTO && 32u << params->grid >= 512);
}

// A surface through every row of the box, two cells thick, as in slots_at_first.
u32 gi_bricks_at_first(const u32 dims[4]) {
    u32 x = dims[0] / GI_BRICK_CELL, y = dims[1] / GI_BRICK_CELL, z = dims[2] / GI_BRICK_CELL;
    u32 bricks = (x * y + y * z + z * x) * 2 * dims[3], cells = x * y * z * dims[3];
    return MIN(bricks, cells) + 1;
}

void gi_brick_shape(u32 bricks, u32 out[4]) {
    u32 layers = MAX((bricks + GI_BRICK_LAYER - 1) / GI_BRICK_LAYER, 1);
    out[0] = out[1] = GI_BRICK_ROW * GI_BRICK_SIDE;
    out[2] = MIN(layers, GI_BRICK_DEPTH_MAX / GI_BRICK_SIDE) * GI_BRICK_SIDE;
    out[3] = 1;
}

static bool bricks_needed(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    return gi_is_on(c) && gi->has_bricks && (gi->voxelise_static || gi->voxelise_dynamic);
}

static bool bind(const PassContext *c, u32 step) {
    u32 shape[4];
    gi_brick_shape(c->renderer->gi.brick_cap, shape);
    const GiDrawRecord record = {.how = {0, shape[2] / GI_BRICK_SIDE * GI_BRICK_LAYER, 0, 0}};
    GpuPipeline pipeline =
        pipeline_get(c->renderer, c->packet, PIPELINE_GI_BRICKS, (PipelineVariant){.post = step});
    if (!pipeline.id) return false;
    gi_bind_build(c, pipeline, 0);
    gpu_cmd_push(c->cmd, &record, sizeof record);
    return true;
}

static void mark_record(const PassContext *c) {
    gpu_cmd_clear_texture(c->cmd, c->renderer->targets[RESOURCE_GI_BASE]);
    if (bind(c, STEP_MARK)) gi_dispatch_slots(c, GI_COUNTER_ALL_ARGS);
}
static void place_record(const PassContext *c) {
    if (bind(c, STEP_PLACE)) gpu_cmd_dispatch(c->cmd, 1, 1, 1);
}
static const Pass mark_pass = {"voxel bricks",
                               {OVERWRITE(GI_BASE, COPY_TARGET),
                                USE(GI_VOXELS, STORAGE_READ_COMPUTE), USE(GI_COUNTERS, INDIRECT),
                                USE(GI_ACCUMULATORS, STORAGE_COMPUTE),
                                OVERWRITE(GI_BRICKS, STORAGE_COMPUTE)},
                               5,
                               mark_record,
                               NULL,
                               NULL};
static const Pass place_pass = {"voxel bricks",
                                {USE(GI_ACCUMULATORS, STORAGE_COMPUTE),
                                 USE(GI_COUNTERS, STORAGE_COMPUTE),
                                 USE(GI_BRICKS, STORAGE_COMPUTE)},
                                3,
                                place_record,
                                NULL,
                                NULL};

static void bricks_expand(const PassContext *c) {
    pass_run(c, &mark_pass);
    pass_run(c, &place_pass);
}
const Pass gi_bricks_pass = {
    .name = "voxel bricks", .needed = bricks_needed, .expand = bricks_expand};
