// gi_voxelise.c: from triangles to voxels: passes gi_static_pass and gi_dynamic_pass.
//
// Data in: the packet's gi_instances and draws, meshes, materials. Data out: masks, ranks, places
// by slot, attributes by slot, counters (shaders/shared.h). Called by: pass_run. Does not: decide
// when (gi.c), or light anything.
//
// One layer of the masks is made at a time: mark the voxels that triangles touch; fill the insides
// of closed meshes if asked to; rank the bits, which gives each voxel its slot, the same on every
// run; then add up what falls into each slot and divide. Sums are whole numbers, so no order of
// triangles shows. Two ways make the fragments, and agree to the bit (gi_vox.glsl): rasterising,
// cheap for large triangles, and an invocation a triangle, cheap for small ones.
#include "passes.h"
#include <math.h>
#include <string.h>

// Columns of voxels that one invocation may walk: each takes a few iterations of loops, and the
// software driver stops an invocation after 65,535, silently.
#define COLUMNS_PER_INVOCATION 4096
// Draws of so few triangles, if large ones are among them, take a group of invocations each:
// telling small from large, or rendering passes for them, would cost more.
#define WIDE_TRIANGLES 256
// Layers of so few words (64^3 voxels have 8,192) are ranked and listed by one dispatch, in which
// each group counts all words before its own: work that grows with the square.
#define RANK_AT_ONCE_WORDS 16384
#define RANK_GROUP_RANKS   512 // gi_rank.comp
#define GROUP              64
#define GROUPS_MAX         65535u

#define ALPHA_MODE_MASK 1 // AlphaMode of world/components.h, which nobody here sees

typedef enum VoxelStep { STEP_MARK, STEP_ADD } VoxelStep;
enum { SOLID_CROSS, SOLID_FILL };
enum { RANK_BLOCKS, RANK_SCAN, RANK_WORDS, RANK_AND_LIST };
enum { CLEAR_IMAGES, CLEAR_SOLIDS };

// A layer that is being made.
typedef struct Layer {
    const PassContext *c;
    PacketSection draws;
    u32 flags;     // GI_DRAW_DYNAMIC or 0
    u32 sum_bits;  // of a fragment's numbers
    f32 brightest; // emission of the layer's materials
} Layer;

static u64 cascade_voxels(const PassContext *c) {
    const u32 *dims = c->packet->gi.record.dims;
    return (u64)dims[0] * dims[1] * dims[2];
}
static u32 layer_words(const PassContext *c) {
    return (u32)(cascade_voxels(c) * c->packet->gi.record.dims[3] / 32);
}

u32 gi_rank_blocks(u64 voxels) { return (u32)((voxels / 32 + GI_RANK_BLOCK - 1) / GI_RANK_BLOCK); }

u64 gi_accumulator_bytes(u64 voxels, u32 slots, bool solid) {
    u64 words = (u64)MIN(slots, GI_WINDOW_SLOTS) * GI_SUM_WORDS;
    if (solid) words = MAX(words, (voxels + 31) / 32); // parity of crossings
    return words * sizeof(u32);
}

// --- Barriers ---

static void to_usage(const PassContext *c, RenderResource id, GpuUsage usage) {
    Renderer *r = c->renderer;
    if (gpu_usage_needs_barrier(r->usage[id], usage)) {
        gpu_cmd_barriers(c->cmd,
                         &(GpuBarrier){.texture = r->targets[id],
                                       .buffer = r->device_buffers[id],
                                       .from = r->usage[id],
                                       .to = usage},
                         1);
        r->stats.barriers++;
    }
    r->usage[id] = usage;
}

// --- Pipelines ---

static GpuPipeline pipeline_of(const PassContext *c, PipelineKind kind, u32 step) {
    return pipeline_get(c->renderer, c->packet, kind, (PipelineVariant){.post = step});
}

static bool bind_step(const PassContext *c, PipelineKind kind, u32 step,
                      const GiDrawRecord *record) {
    GpuPipeline pipeline = pipeline_of(c, kind, step);
    if (!pipeline.id) return false;
    gi_bind_build(c, pipeline, 0);
    gpu_cmd_push(c->cmd, record, sizeof *record);
    return true;
}

// Groups of 64 invocations, in z where x is full.
static void dispatch_many(const PassContext *c, u64 invocations, u32 parts) {
    u64 groups = (invocations + GROUP - 1) / GROUP;
    u32 x = (u32)MIN(groups, GROUPS_MAX);
    if (x) gpu_cmd_dispatch(c->cmd, x, parts, (u32)((groups + x - 1) / x));
}

// --- Draws ---

typedef struct VoxelDraw {
    const PacketDraw *draw;
    const MaterialRecord *record;
    const PacketMaterial *material;
    const GpuMesh *mesh;
    const MeshLod *lod;
    u32 triangles;
} VoxelDraw;

static bool draw_at(const Layer *layer, u32 index, VoxelDraw *out) {
    const Renderer *r = layer->c->renderer;
    const Packet *packet = layer->c->packet;
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + layer->draws.offset);
    const PacketDraw *draw = &draws[index];
    if (draw->mesh >= r->mesh_count || draw->instance_count == 0) return false;
    const GpuMesh *mesh = &r->meshes[draw->mesh];
    if (mesh->lod_count == 0) return false;
    *out = (VoxelDraw){.draw = draw,
                       .record = &PACKET_DATA(packet, materials, MaterialRecord)[draw->material],
                       .material =
                           &PACKET_DATA(packet, material_bindings, PacketMaterial)[draw->material],
                       .mesh = mesh,
                       .lod = &mesh->lods[MIN(draw->lod, mesh->lod_count - 1)]};
    out->triangles = out->lod->index_count / 3;
    return out->triangles > 0;
}

static GiDrawRecord record_of(const Layer *layer, const VoxelDraw *d, u32 flags, u32 window) {
    GiDrawRecord record = {
        .mesh = {d->lod->first_index, (u32)d->mesh->vertex_offset, d->draw->first_instance,
                 d->triangles},
        .how = {layer->flags | flags | layer->sum_bits << GI_DRAW_BITS_SHIFT, window, 0,
                d->draw->instance_count},
    };
    memcpy(&record.how[2], &layer->brightest, sizeof layer->brightest);
    return record;
}

// The longest edge of the draw's triangles, in voxels: about, and never less (bound).
static f32 edge_voxels(const Layer *layer, const VoxelDraw *d, f32 voxel_m, f32 *bound) {
    const InstanceRecord *instances =
        PACKET_DATA(layer->c->packet, gi_instances, InstanceRecord) + d->draw->first_instance;
    f32 longest = 0.0f, all = 0.0f;
    for (u32 i = 0; i < d->draw->instance_count; i++) {
        f32 sum = 0.0f;
        for (u32 k = 0; k < 3; k++) {
            f32 x = instances[i].world[0][k], y = instances[i].world[1][k],
                z = instances[i].world[2][k];
            f32 square = x * x + y * y + z * z;
            longest = MAX(longest, square);
            sum += square;
        }
        all = MAX(all, sum);
    }
    f32 edge = d->mesh->longest_edge / voxel_m;
    *bound = edge * sqrtf(all);
    return edge * sqrtf(longest);
}

typedef struct Ways {
    u32 raster, compute; // GI_DRAW_SMALL | GI_DRAW_LARGE, 0 = not this way
    u32 parts;           // groups that share a triangle, by compute
    bool wide;           // all invocations of a group do
} Ways;

static Ways choose_ways(const Layer *layer, const VoxelDraw *d, u32 cascade) {
    const GiRecord *record = &layer->c->packet->gi.record;
    const u32 all = GI_DRAW_SMALL | GI_DRAW_LARGE, *dims = record->dims;
    f32 bound, edge = edge_voxels(layer, d, record->origin[cascade][3], &bound);
    f32 side = (f32)MAX(MAX(dims[0], dims[1]), dims[2]), walked = MIN(bound + 3.0f, side);
    u32 parts = (u32)(walked * walked / COLUMNS_PER_INVOCATION) + 1;
    switch (layer->c->packet->gi.params.voxeliser) {
    case GI_VOXELISER_RASTER:
        return (Ways){.raster = all};
    case GI_VOXELISER_COMPUTE:
        return (Ways){.compute = all, .parts = parts};
    default:
        break;
    }
    if ((edge + 3.0f) * (edge + 3.0f) <= GI_LARGE_COLUMNS)
        return (Ways){.compute = all, .parts = parts};
    if ((u64)d->triangles * d->draw->instance_count <= WIDE_TRIANGLES)
        return (Ways){.compute = all, .parts = (parts + GROUP - 1) / GROUP, .wide = true};
    return (Ways){.compute = GI_DRAW_SMALL, .parts = 1, .raster = GI_DRAW_LARGE};
}

static PipelineVariant variant_of(const VoxelDraw *d, VoxelStep step) {
    const f32 *emissive = d->record->emissive;
    bool is_mask = d->material->alpha_mode == ALPHA_MODE_MASK;
    // Each kind is among the longest of all shaders to compile, so there are few: without a texture
    // its stand-in is white, and an emission or its texture that is not there is black or nothing.
    bool glows = d->material->emissive_pass || emissive[0] > 0.0f || emissive[1] > 0.0f ||
                 emissive[2] > 0.0f;
    u32 textures = 0;
    if (step == STEP_ADD) textures = glows ? 1 | 4 | 8 : 1;
    if (step == STEP_MARK && is_mask && d->material->albedo_texture) textures = 1;
    return (PipelineVariant){.alpha_mask = is_mask, .textures = textures, .post = step};
}

// One way through all draws.
static void record_way(const Layer *layer, PipelineKind kind, VoxelStep step, u32 window) {
    const PassContext *c = layer->c;
    Renderer *r = c->renderer;
    bool is_raster = kind == PIPELINE_GI_VOXELISE_RASTER;
    for (u32 cascade = 0; cascade < c->packet->gi.record.dims[3]; cascade++)
        for (u32 i = 0; i < layer->draws.count; i++) {
            VoxelDraw d;
            if (!draw_at(layer, i, &d)) continue;
            Ways ways = choose_ways(layer, &d, cascade);
            u32 sizes = is_raster ? ways.raster : ways.compute;
            if (!sizes) continue;
            GpuPipeline pipeline = pipeline_get(r, c->packet, kind, variant_of(&d, step));
            if (!pipeline.id) continue;
            u32 flags = sizes | cascade << GI_DRAW_CASCADE_SHIFT |
                        (d.material->double_sided ? GI_DRAW_TWO_SIDED : 0) |
                        (ways.wide && !is_raster ? GI_DRAW_WIDE : 0);
            GiDrawRecord record = record_of(layer, &d, flags, window);
            gi_bind_build(c, pipeline, 0);
            gpu_cmd_bind_group(c->cmd, 1, render_material_group(r, d.material));
            gpu_cmd_push(c->cmd, &record, sizeof record);
            if (is_raster)
                gpu_cmd_draw(c->cmd, d.triangles * 3, d.draw->instance_count, 0,
                             d.draw->first_instance);
            else
                dispatch_many(c,
                              (u64)d.triangles * d.draw->instance_count * (ways.wide ? GROUP : 1),
                              ways.parts);
            r->stats.draw_calls++;
        }
}

static bool uses_way(const Layer *layer, bool raster) {
    bool used = false;
    for (u32 cascade = 0; cascade < layer->c->packet->gi.record.dims[3]; cascade++)
        for (u32 i = 0; i < layer->draws.count; i++) {
            VoxelDraw d;
            if (!draw_at(layer, i, &d)) continue;
            Ways ways = choose_ways(layer, &d, cascade);
            used |= (raster ? ways.raster : ways.compute) != 0;
        }
    return used;
}

static void voxelise(const Layer *layer, VoxelStep step, u32 window) {
    const PassContext *c = layer->c;
    RenderResource written = step == STEP_MARK ? RESOURCE_GI_MASKS : RESOURCE_GI_ACCUMULATORS;
    if (step == STEP_ADD) to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_READ_COMPUTE);
    if (uses_way(layer, false)) {
        to_usage(c, written, GPU_USAGE_STORAGE_COMPUTE);
        record_way(layer, PIPELINE_GI_VOXELISE_COMPUTE, step, window);
    }
    if (!uses_way(layer, true)) return;
    const u32 *dims = c->packet->gi.record.dims;
    u32 side = MAX(MAX(dims[0], dims[1]), dims[2]);
    to_usage(c, written, GPU_USAGE_STORAGE_DRAW);
    gpu_cmd_begin_rendering(c->cmd, &(GpuRendering){.width = side, .height = side});
    record_way(layer, PIPELINE_GI_VOXELISE_RASTER, step, window);
    gpu_cmd_end_rendering(c->cmd);
}

// --- Insides ---

static void fill_solids(const Layer *layer) {
    const PassContext *c = layer->c;
    const GiRecord *grid = &c->packet->gi.record;
    u64 rows = cascade_voxels(c) / MAX(grid->dims[0], 32);
    u32 parts = (u32)(((u64)grid->dims[1] + 2) * (grid->dims[2] + 2) / COLUMNS_PER_INVOCATION) + 1;
    to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_COMPUTE);
    for (u32 i = 0; i < layer->draws.count; i++) {
        VoxelDraw d;
        if (!draw_at(layer, i, &d) || !d.mesh->is_closed ||
            d.material->alpha_mode == ALPHA_MODE_MASK)
            continue;
        for (u32 k = 0; k < d.draw->instance_count * grid->dims[3]; k++) {
            u32 cascade = k % grid->dims[3];
            GiDrawRecord record = record_of(layer, &d, cascade << GI_DRAW_CASCADE_SHIFT, 0);
            record.mesh[2] += k / grid->dims[3];
            to_usage(c, RESOURCE_GI_ACCUMULATORS, GPU_USAGE_STORAGE_COMPUTE);
            if (!bind_step(c, PIPELINE_GI_SOLID, SOLID_CROSS, &record)) return;
            dispatch_many(c, d.triangles, parts);
            to_usage(c, RESOURCE_GI_ACCUMULATORS, GPU_USAGE_STORAGE_COMPUTE);
            to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_COMPUTE);
            if (!bind_step(c, PIPELINE_GI_SOLID, SOLID_FILL, &record)) return;
            gi_dispatch_words(c, rows);
        }
    }
}

// --- Slots ---

static void rank_and_list(const Layer *layer) {
    const PassContext *c = layer->c;
    GiDrawRecord record = {.how = {layer->flags}};
    if (layer_words(c) <= RANK_AT_ONCE_WORDS) {
        u32 words = RANK_GROUP_RANKS * GI_RANK_WORDS; // of a group
        to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_READ_COMPUTE);
        to_usage(c, RESOURCE_GI_RANKS, GPU_USAGE_STORAGE_COMPUTE);
        to_usage(c, RESOURCE_GI_COUNTERS, GPU_USAGE_STORAGE_COMPUTE);
        to_usage(c, RESOURCE_GI_VOXELS, GPU_USAGE_STORAGE_COMPUTE);
        if (!bind_step(c, PIPELINE_GI_RANK, RANK_AND_LIST, &record)) return;
        gpu_cmd_dispatch(c->cmd, (layer_words(c) + words - 1) / words, 1, 1);
        // From here on these are only read, by any stage.
        to_usage(c, RESOURCE_GI_COUNTERS, GPU_USAGE_STORAGE_READ_COMPUTE);
        to_usage(c, RESOURCE_GI_RANKS, GPU_USAGE_STORAGE_READ_COMPUTE);
        return;
    }
    u32 blocks = gi_rank_blocks((u64)layer_words(c) * 32);
    to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_READ_COMPUTE);
    to_usage(c, RESOURCE_GI_RANKS, GPU_USAGE_STORAGE_COMPUTE);
    for (u32 step = RANK_BLOCKS; step <= RANK_WORDS; step++) {
        to_usage(c, RESOURCE_GI_COUNTERS, GPU_USAGE_STORAGE_COMPUTE);
        if (!bind_step(c, PIPELINE_GI_RANK, step, &record)) return;
        gpu_cmd_dispatch(c->cmd, step == RANK_SCAN ? 1 : blocks, 1, 1);
    }
    // From here on both are only read, by any stage.
    to_usage(c, RESOURCE_GI_COUNTERS, GPU_USAGE_STORAGE_READ_COMPUTE);
    to_usage(c, RESOURCE_GI_RANKS, GPU_USAGE_STORAGE_READ_COMPUTE);
    to_usage(c, RESOURCE_GI_VOXELS, GPU_USAGE_STORAGE_COMPUTE);
    if (!bind_step(c, PIPELINE_GI_LIST, 0, &record)) return;
    gi_dispatch_words(c, layer_words(c));
}

static void add_up(const Layer *layer) {
    const PassContext *c = layer->c;
    u32 cap = c->renderer->gi.slot_cap;
    for (u32 window = 0; window < cap; window += GI_WINDOW_SLOTS) {
        voxelise(layer, STEP_ADD, window);
        to_usage(c, RESOURCE_GI_ACCUMULATORS, GPU_USAGE_STORAGE_COMPUTE);
        to_usage(c, RESOURCE_GI_ATTRIBUTES, GPU_USAGE_STORAGE_COMPUTE);
        GiDrawRecord record = {
            .how = {layer->flags | layer->sum_bits << GI_DRAW_BITS_SHIFT, window}};
        memcpy(&record.how[2], &layer->brightest, sizeof layer->brightest);
        if (!bind_step(c, PIPELINE_GI_RESOLVE, 0, &record)) return;
        // As many as the device counted; of later windows, which are rare, as many as can be.
        u32 args = layer->flags ? GI_COUNTER_DYNAMIC_ARGS : GI_COUNTER_ALL_ARGS;
        if (window == 0)
            gi_dispatch_slots(c, args);
        else
            gi_dispatch_words(c, MIN(cap - window, GI_WINDOW_SLOTS));
    }
}

u32 gi_sum_bits(u64 triangles) {
    // A triangle has at most one fragment in a voxel of a cascade: so many numbers below 2^bits add
    // up to less than 2^32. Twice as many bits must still be exact in 32.
    u32 bits = 15;
    while (bits > 1 && triangles << bits > UINT32_MAX) bits--;
    return bits;
}

static Layer layer_of(const PassContext *c, PacketSection draws, u32 flags) {
    Layer layer = {.c = c, .draws = draws, .flags = flags};
    u64 triangles = 0;
    for (u32 i = 0; i < draws.count; i++) {
        VoxelDraw d;
        if (!draw_at(&layer, i, &d)) continue;
        triangles += (u64)d.triangles * d.draw->instance_count;
        for (u32 k = 0; k < 3; k++) {
            f32 textured = d.material->emissive_pass ? d.record->extra[1 + k] : 0.0f;
            layer.brightest = MAX(layer.brightest, d.record->emissive[k] + textured);
        }
    }
    layer.sum_bits = gi_sum_bits(triangles);
    return layer;
}

static void make_layer(const PassContext *c, PacketSection draws, u32 flags) {
    Layer layer = layer_of(c, draws, flags);
    voxelise(&layer, STEP_MARK, 0);
    if (c->packet->gi.params.solid) fill_solids(&layer);
    rank_and_list(&layer);
    add_up(&layer);
}

// --- Passes ---

static void fill_layers(const PassContext *c, u32 first, u32 count) {
    u64 bytes = (u64)layer_words(c) * sizeof(u32);
    gpu_cmd_fill_buffer(c->cmd, c->renderer->device_buffers[RESOURCE_GI_MASKS], first * bytes,
                        count * bytes, 0);
}
static void fill_whole(const PassContext *c, RenderResource id) {
    GpuBuffer buffer = c->renderer->device_buffers[id];
    gpu_cmd_fill_buffer(c->cmd, buffer, 0, gpu_buffer_size(c->renderer->gpu, buffer) & ~3ull, 0);
}

static bool static_needed(const PassContext *c) {
    return gi_is_on(c) && c->renderer->gi.voxelise_static;
}
static void static_record(const PassContext *c) {
    fill_layers(c, GI_MASK_STATIC, 2);
    if (c->packet->gi.params.solid) fill_layers(c, GI_MASK_SOLID, 1);
    fill_whole(c, RESOURCE_GI_RANKS);
    fill_whole(c, RESOURCE_GI_ACCUMULATORS); // zero between uses from here on
    gpu_cmd_clear_texture(c->cmd, c->renderer->targets[RESOURCE_GI_IRRADIANCE]);
    gpu_cmd_clear_texture(c->cmd, c->renderer->targets[RESOURCE_GI_VISIBILITY]);
    make_layer(c, c->packet->gi_static_draws, 0);
}
const Pass gi_static_pass = {
    "voxelise static",
    {USE(GI_MASKS, COPY_TARGET), OVERWRITE(GI_RANKS, COPY_TARGET),
     OVERWRITE(GI_ACCUMULATORS, COPY_TARGET), OVERWRITE(GI_IRRADIANCE, COPY_TARGET),
     OVERWRITE(GI_VISIBILITY, COPY_TARGET), OVERWRITE(GI_VOXELS, STORAGE_COMPUTE),
     OVERWRITE(GI_ATTRIBUTES, STORAGE_COMPUTE), OVERWRITE(GI_COUNTERS, STORAGE_COMPUTE)},
    8,
    static_record,
    static_needed};

static bool dynamic_needed(const PassContext *c) {
    return gi_is_on(c) && c->renderer->gi.voxelise_dynamic;
}
static void dynamic_record(const PassContext *c) {
    // The last dynamic voxels go, by their list; static slots stay as they are.
    const GiDrawRecord record = {.how = {GI_DRAW_DYNAMIC}};
    const GiState *gi = &c->renderer->gi;
    bool has_images = gi_wants_irradiance(c->packet) || (gi->voxel_shadows & GI_VISIBILITY_KEPT);
    if (has_images && !gi->voxelise_static &&
        bind_step(c, PIPELINE_GI_CLEAR, CLEAR_IMAGES, &record))
        gi_dispatch_slots(c, GI_COUNTER_DYNAMIC_ARGS);
    to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_COPY_TARGET);
    fill_layers(c, GI_MASK_DYNAMIC, 1);
    if (c->packet->gi.params.solid) {
        to_usage(c, RESOURCE_GI_MASKS, GPU_USAGE_STORAGE_COMPUTE);
        if (bind_step(c, PIPELINE_GI_CLEAR, CLEAR_SOLIDS, &record))
            gi_dispatch_words(c, layer_words(c));
    }
    make_layer(c, c->packet->gi_dynamic_draws, GI_DRAW_DYNAMIC);
}
const Pass gi_dynamic_pass = {"voxelise dynamic",
                              {USE(GI_MASKS, STORAGE_COMPUTE), USE(GI_RANKS, STORAGE_COMPUTE),
                               USE(GI_ACCUMULATORS, STORAGE_COMPUTE),
                               USE(GI_IRRADIANCE, STORAGE_COMPUTE),
                               USE(GI_VISIBILITY, STORAGE_COMPUTE), USE(GI_VOXELS, STORAGE_COMPUTE),
                               USE(GI_ATTRIBUTES, STORAGE_COMPUTE), USE(GI_COUNTERS, INDIRECT)},
                              8,
                              dynamic_record,
                              dynamic_needed};
