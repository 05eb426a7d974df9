// gi_light.c: occupied voxels are lit: what they send out goes to RADIANCE, with faces shared to
// the base volume too; then one bounce more, and what arrives at each voxel, for surfaces to look
// up.
//
// Data in: places and attributes by slot, masks (for rays), the packet's lights and their lists
// over the volume, the shadow map; for bounces the filtered images. Data out: GI_RADIANCE, GI_BASE,
// GI_VISIBILITY, GI_IRRADIANCE. Called by the pass table. Does not: filter (gi_filter.c), or decide
// whether anything is to be lit (GiState.relight).
//
// Bounces. Without feedback: light, filter, bounce (reads the images, adds to RADIANCE), filter.
// With feedback light bounces on from frame to frame: what went round so far is kept in the images
// alone. So the frame's light leaves them as they are and only starts RADIANCE anew; the bounce
// adds what it reads of the last frame's images; one filter writes the sum. A light that moves or
// goes out takes its bounces along within a few frames. A frame that must not hang on earlier ones
// (PACKET_COLD, or nothing there) makes all rounds by itself.
// Feedback where there are probes: these keep what went round, and lighting a voxel adds what they
// say of it. As one in `share` of them is traced a frame, so one group of static voxels in as many
// is lit: what they send out reaches nobody but the probes. Dynamic voxels, whose slots are new
// whenever they moved, are all lit. No cones are traced but the probes' own (as Majercik et al.
// 2019, "Dynamic diffuse global illumination with ray-traced irradiance fields", light what their
// rays hit).
#include "passes.h"

// Each round after the first counts at most the walls' albedo times what the one before did: of
// walls with 0.7, this many leave 6 % of all light that goes round; of four a quarter was missing.
#define FEEDBACK_ROUNDS 8
#define SLOT_GROUP      64 // invocations of gi_light.glsl

// gi_light.glsl
enum { STEP_LIGHT, STEP_KEEP_BASE, STEP_CLEAR_VISIBILITY, STEP_STORE_BASE, STEP_ADD_PROBES };
enum { STEP_BOUNCE, STEP_FEEDBACK }; // gi_bounce.comp

static bool is_relit(const PassContext *c) { return gi_is_on(c) && c->renderer->gi.relight; }
static bool has_base(const PassContext *c) { return c->packet->gi.params.faces == GI_FACES_SHARED; }

bool gi_bounces_by_probes(const GiParams *params) {
    return params->feedback && params->diffuse == GI_DIFFUSE_PROBES;
}
bool gi_bounces(const PassContext *c) {
    const GiParams *params = &c->packet->gi.params;
    if (gi_bounces_by_probes(params) && !c->renderer->gi.is_cold) return false;
    return is_relit(c) && (params->bounces > 1 || params->feedback);
}
bool gi_feeds_back(const PassContext *c) {
    const GiParams *params = &c->packet->gi.params;
    return is_relit(c) && params->feedback && !gi_bounces_by_probes(params) &&
           !c->renderer->gi.is_cold;
}

static bool bind(const PassContext *c, PipelineKind kind, u32 step) {
    GpuPipeline pipeline =
        pipeline_get(c->renderer, c->packet, kind, (PipelineVariant){.post = step});
    if (!pipeline.id) return false;
    gi_bind_build(c, pipeline, 0);
    return true;
}

// One invocation a slot.
static void by_slot(const PassContext *c, PipelineKind kind, u32 step) {
    if (bind(c, kind, step)) gi_dispatch_slots(c, GI_COUNTER_ALL_ARGS);
}

// --- Light ---

static void clear_visibility(const PassContext *c) {
    const u32 *dims = c->packet->gi.record.dims;
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_GI_LIGHT,
                                        (PipelineVariant){.post = STEP_CLEAR_VISIBILITY});
    if (!pipeline.id) return;
    gi_bind_build(c, pipeline, 0);
    gpu_cmd_dispatch(c->cmd, (dims[0] + 63) / 64, dims[1], dims[2] * dims[3]);
    gi_barrier(c, (RenderResource[]){RESOURCE_GI_VISIBILITY}, 1);
}

static void push_turn(const PassContext *c, u32 first, u32 stride) {
    const u32 push[2] = {first, stride}; // gi_light.glsl
    gpu_cmd_push(c->cmd, push, sizeof push);
}

// Light and what probes say of it, for all voxels.
static void add_probes_record(const PassContext *c) {
    if (!bind(c, PIPELINE_GI_LIGHT, STEP_ADD_PROBES)) return;
    push_turn(c, 0, 1);
    gi_dispatch_slots(c, GI_COUNTER_ALL_ARGS);
}
// The same for those whose turn it is.
static void add_probes_in_turns(const PassContext *c, u32 turns) {
    const GiState *gi = &c->renderer->gi;
    if (!bind(c, PIPELINE_GI_LIGHT, STEP_ADD_PROBES)) return;
    // How many there are only the device knows: of the groups that there could be, those beyond
    // end.
    u32 groups = (gi->slot_cap + SLOT_GROUP - 1) / SLOT_GROUP, first = gi->probe_turn % turns;
    push_turn(c, first, turns);
    if (groups > first) gpu_cmd_dispatch(c->cmd, (groups - first + turns - 1) / turns, 1, 1);
    if (!gi->has_dynamic) return;
    push_turn(c, 0, 0);
    gi_dispatch_slots(c, GI_COUNTER_DYNAMIC_ARGS);
}

static void light_record(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    // Nothing is in the way of what is not voxelised.
    if (gi->voxelise_static && (gi->voxel_shadows & GI_VISIBILITY_KEPT)) clear_visibility(c);
    if (gi_bounces_by_probes(&c->packet->gi.params) && !gi->is_cold) {
        u32 turns = c->packet->gi.params.share;
        if (turns > 1 && !gi->voxelise_static)
            add_probes_in_turns(c, turns);
        else
            add_probes_record(c);
        return;
    }
    by_slot(c, PIPELINE_GI_LIGHT, gi_feeds_back(c) ? STEP_KEEP_BASE : STEP_LIGHT);
}
static void light_again_record(const PassContext *c) {
    by_slot(c, PIPELINE_GI_LIGHT, STEP_KEEP_BASE);
}
static void store_record(const PassContext *c) { by_slot(c, PIPELINE_GI_LIGHT, STEP_STORE_BASE); }

#define LIGHT_USES                                                                                 \
    {                                                                                              \
        USE(GI_MASKS, STORAGE_READ_COMPUTE), USE(GI_VOXELS, STORAGE_READ_COMPUTE),                 \
            USE(GI_ATTRIBUTES, STORAGE_READ_COMPUTE), USE(GI_RADIANCE, STORAGE_COMPUTE),           \
            USE(GI_COUNTERS, INDIRECT), USE(GI_BASE, STORAGE_COMPUTE),                             \
            USE(GI_VISIBILITY, STORAGE_COMPUTE), USE(GI_PROBES, SAMPLED_COMPUTE),                  \
            USE(SHADOW_MAP, SAMPLED_COMPUTE), USE(GI_BRICKS, SAMPLED_COMPUTE),                     \
            USE(GI_RADIANCE_2, STORAGE_COMPUTE)                                                    \
    }
const Pass gi_light_pass = {"voxel light", LIGHT_USES, 11, light_record, is_relit, NULL};
static const Pass light_again_pass = {"voxel light again", LIGHT_USES, 11,
                                      light_again_record,  NULL,       NULL};
static const Pass store_pass = {"voxel bounce store", LIGHT_USES, 11, store_record, has_base, NULL};
static const Pass add_probes_pass = {"voxel light again", LIGHT_USES, 11,
                                     add_probes_record,   NULL,       NULL};

// --- Bounces ---

static void gather_record(const PassContext *c) {
    by_slot(c, PIPELINE_GI_BOUNCE, c->packet->gi.params.feedback ? STEP_FEEDBACK : STEP_BOUNCE);
}
#define GATHER_USES                                                                                \
    USE(GI_VOXELS, STORAGE_READ_COMPUTE), USE(GI_ATTRIBUTES, STORAGE_READ_COMPUTE),                \
        USE(GI_MASKS, STORAGE_READ_COMPUTE), USE(GI_COUNTERS, INDIRECT),                           \
        USE_VOXEL_LIGHT(SAMPLED_COMPUTE)
static const Pass gather_pass = {
    "voxel bounce",
    {GATHER_USES, USE(GI_RADIANCE, STORAGE_COMPUTE), USE(GI_RADIANCE_2, STORAGE_COMPUTE)},
    9,
    gather_record,
    NULL,
    NULL};

static void bounce_expand(const PassContext *c) {
    const GiParams *params = &c->packet->gi.params;
    bool all_rounds = params->feedback && !gi_feeds_back(c);
    for (u32 round = 0; round < (all_rounds ? FEEDBACK_ROUNDS : 1); round++) {
        if (round > 0) pass_run(c, &gi_refilter_pass);
        if (gi_bounces_by_probes(params)) {
            pass_run(c, &gi_probes_pass);
            pass_run(c, &add_probes_pass);
            continue;
        }
        if (round > 0) pass_run(c, &light_again_pass);
        pass_run(c, &gather_pass);
        pass_run(c, &store_pass);
    }
}
const Pass gi_bounce_pass = {.name = "voxel bounce", .needed = gi_bounces, .expand = bounce_expand};

// --- Irradiance ---

static bool wants_irradiance(const PassContext *c) {
    return is_relit(c) && gi_wants_irradiance(c->packet);
}
static void irradiance_record(const PassContext *c) { by_slot(c, PIPELINE_GI_IRRADIANCE, 0); }
const Pass gi_irradiance_pass = {"voxel irradiance",
                                 {GATHER_USES, USE(GI_IRRADIANCE, STORAGE_COMPUTE)},
                                 8,
                                 irradiance_record,
                                 wants_irradiance,
                                 NULL};
