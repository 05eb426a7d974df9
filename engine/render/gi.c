// gi.c: the voxels' volumes and buffers, their bind groups, and what a packet asks to be made anew.
//
// Data in: a packet's PacketGi. Data out: resources RESOURCE_GI_* of the right shape, groups, and
// the decisions in GiState that the passes' needed functions ask for. Called by frame_upload.c once
// a packet, and by renderer.c for reports and read-backs. Does not: record any pass (gi_voxelise.c,
// gi_light.c, gi_filter.c, gi_probes.c, gi_screen.c do).
//
// What the volumes hold hangs on keys: a key that stayed means nothing to do. So a renderer that
// saw the same packet before, or none at all, ends with the same voxels. What is spread over frames
// (a share of the probes a tick, feedback, policies) is made whole for packets that are
// PACKET_COLD.
#include "passes.h"
#include "../base/log.h"
#include <string.h>

#define GI_SLOTS_MIN 4096
// With feedback, frames after a change in which light still bounces on: of walls with an albedo of
// 0.7, 0.3 % of what goes round are left to come.
#define GI_FEEDBACK_FRAMES 16
// Buffers by slot that were too small grow to what was wanted and this share more.
#define GI_SLOTS_SPARE(count) ((count) + (count) / 32)
// What was guessed at first and is more than this too much is given back.
#define GI_SLACK MIB(16)
// Finest level of an atlas that may have what lies between levels too: 256 voxels in bytes, 128 in
// halves. Memory counts for more beyond.
#define GI_THIRDS_MOST MIB(64)

// --- Life ---

bool gi_create(Renderer *renderer) {
    GpuBindLayoutDesc build = {.label = "gi build", .count = BUILD_COUNT};
    for (u32 i = 0; i < BUILD_COUNT; i++)
        build.kinds[i] = i < BUILD_FIRST_STORAGE         ? GPU_BINDING_UNIFORM_BUFFER
                         : i < BUILD_FIRST_IMAGE         ? GPU_BINDING_STORAGE_BUFFER
                         : i < BUILD_FIRST_STORAGE_IMAGE ? GPU_BINDING_SAMPLED_TEXTURE
                                                         : GPU_BINDING_STORAGE_TEXTURE;
    renderer->gi_build_layout = gpu_create_bind_layout(renderer->gpu, &build);
    GpuBindLayoutDesc screen = {.label = "gi screen", .count = BINDING_GI_COUNT};
    for (u32 i = 0; i < BINDING_GI_COUNT; i++)
        screen.kinds[i] = i < BINDING_GI_FLOW              ? GPU_BINDING_UNIFORM_BUFFER
                          : i < BINDING_GI_FIRST_IMAGE     ? GPU_BINDING_STORAGE_BUFFER
                          : i < BINDING_GI_TRACE_0_STORAGE ? GPU_BINDING_SAMPLED_TEXTURE
                                                           : GPU_BINDING_STORAGE_TEXTURE;
    renderer->gi_screen_layout = gpu_create_bind_layout(renderer->gpu, &screen);
    renderer->gi_sampler_linear =
        gpu_create_sampler(renderer->gpu, &(GpuSamplerDesc){.label = "gi linear"});
    renderer->gi_sampler_nearest_mip = gpu_create_sampler(
        renderer->gpu, &(GpuSamplerDesc){.label = "gi nearest mip", .nearest_mips = true});
    renderer->gi_reports.buffer =
        gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = "gi reports",
                                                          .heap = "staging",
                                                          .kind = GPU_BUFFER_READBACK,
                                                          .size = GPU_FRAMES_IN_FLIGHT_MAX * 2 *
                                                                  GI_COUNTER_COUNT * sizeof(u32)});
    return renderer->gi_build_layout.id && renderer->gi_screen_layout.id &&
           renderer->gi_sampler_linear.id && renderer->gi_sampler_nearest_mip.id &&
           renderer->gi_reports.buffer.id;
}

static void groups_destroy(Renderer *renderer) {
    GiState *gi = &renderer->gi;
    for (u32 i = 0; i < GI_ATLAS_LEVELS_CAP; i++) {
        if (gi->build_groups[i].id) gpu_destroy_bind_group(renderer->gpu, gi->build_groups[i]);
        gi->build_groups[i] = (GpuBindGroup){0};
    }
    if (gi->screen_group.id) gpu_destroy_bind_group(renderer->gpu, gi->screen_group);
    gi->screen_group = (GpuBindGroup){0};
    gi->bindings_version = 0;
}

void gi_state_destroy(Renderer *renderer) {
    groups_destroy(renderer);
    for (u32 id = RESOURCE_FIRST_GI; id < RESOURCE_FIRST_BUFFER; id++) {
        if (renderer->targets[id].id) gpu_destroy_texture(renderer->gpu, renderer->targets[id]);
        renderer->targets[id] = (GpuTexture){0};
        renderer->usage[id] = GPU_USAGE_NONE;
    }
    for (u32 id = RESOURCE_FIRST_GI_BUFFER; id < RESOURCE_COUNT; id++) {
        GpuBuffer *buffer = &renderer->device_buffers[id];
        if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
        *buffer = (GpuBuffer){0};
        renderer->usage[id] = GPU_USAGE_NONE;
    }
    renderer->gi = (GiState){0};
}

void gi_destroy(Renderer *renderer) {
    if (renderer->gi_reports.buffer.id)
        gpu_destroy_buffer(renderer->gpu, renderer->gi_reports.buffer);
    if (renderer->gi_sampler_linear.id)
        gpu_destroy_sampler(renderer->gpu, renderer->gi_sampler_linear);
    if (renderer->gi_sampler_nearest_mip.id)
        gpu_destroy_sampler(renderer->gpu, renderer->gi_sampler_nearest_mip);
}

// --- Shapes ---

// Does the picture, or a light, ask for the mean visibility of the voxels?
static bool wants_visibility(const Packet *packet) {
    const TracedLightRecord *traced = PACKET_DATA(packet, traced_lights, TracedLightRecord);
    bool wanted =
        packet->settings.view == VIEW_GI_VOXELS && packet->settings.gi_show == GI_SHOW_VISIBILITY;
    for (u32 i = 0; i < packet->traced_lights.count; i++) wanted |= traced[i].shadow[2] > 0.0f;
    return wanted;
}

bool gi_wants_irradiance(const Packet *packet) {
    return packet->gi.params.diffuse == GI_DIFFUSE_VOXELS ||
           (packet->settings.view == VIEW_GI_VOXELS &&
            packet->settings.gi_show == GI_SHOW_IRRADIANCE);
}

// Is the lod of every sample of a wide cone (gi_cones.glsl) whole, or an odd number of thirds? Its
// length grows by 1 + step from one to the next, which gi_cone_growth rounds to two thirds of an
// octave where that is within 4 %: from 2^(2/3 / 1.04) to 2^(2/3 / 0.96).
bool gi_makes_thirds(const Packet *packet) {
    const GiParams *params = &packet->gi.params;
    const GiRecord *record = &packet->gi.record;
    // They double the atlas.
    u64 texel = params->format == GI_FORMAT_BYTE ? 4 : 8;
    if (6ull * record->atlas[0] * record->atlas[1] * record->atlas[2] * texel > GI_THIRDS_MOST)
        return false;
    f32 tan_half = record->cone[0], step = 2.0f * tan_half * record->cone[1];
    return params->mips == GI_MIPS_LINEAR && params->faces == GI_FACES_SHARED &&
           params->filter == GI_FILTER_DIRECTIONAL && record->dims[3] == 1 &&
           params->diffuse == GI_DIFFUSE_CONES && !params->dither && tan_half >= 0.4f &&
           tan_half <= 2.0f / 3.0f && step > 0.5595f && step < 0.6181f;
}

// Do the lanes of a subgroup read the atlas together (gi_cones_wave.glsl)? A GPU reads a texel that
// several lanes want once anyway.
bool gi_traces_by_waves(const Renderer *renderer, const Packet *packet) {
    const GpuInfo *info = gpu_info(renderer->gpu);
    return info->is_software && info->subgroup_size == 8 && gi_makes_thirds(packet);
}

// A texture that this packet does not use is as small as a 3D texture can be: its binding must hold
// something.
static void texture_shape(const Packet *packet, u32 brick_cap, RenderResource id, u32 out[4]) {
    const GiParams *params = &packet->gi.params;
    const GiRecord *record = &packet->gi.record;
    const u32 *dims = record->dims;
    u32 blocks = params->filter == GI_FILTER_ISOTROPIC ? 1 : 6;
    const u32 unused[4] = {2, 2, 2, 1}, volume[4] = {dims[0], dims[1], dims[2] * dims[3], 1};
    const u32 atlas[4] = {record->atlas[0] * blocks, record->atlas[1],
                          record->atlas[2] * dims[3] * (gi_makes_thirds(packet) ? 2 : 1),
                          record->atlas[3]};
    const u32 probes[4] = {record->probes[0] * 6, record->probes[1], MAX(record->probes[2], 2), 1};
    const u32 traced[4] = {(u32)record->trace[0], (u32)record->trace[1], 1, 1};
    const u32 cells[4] = {dims[0] / GI_BRICK_CELL, dims[1] / GI_BRICK_CELL,
                          dims[2] * dims[3] / GI_BRICK_CELL, 1};
    u32 bricks[4];
    gi_brick_shape(brick_cap, bricks);
    const u32 *shape = unused;
    switch (id) {
    case RESOURCE_GI_BASE:
        if (params->faces == GI_FACES_SHARED) shape = gi_has_bricks(packet) ? bricks : volume;
        break;
    case RESOURCE_GI_BRICKS:
        if (gi_has_bricks(packet)) shape = cells;
        break;
    case RESOURCE_GI_ATLAS:
        shape = atlas;
        break;
    case RESOURCE_GI_IRRADIANCE:
        if (gi_wants_irradiance(packet)) shape = volume;
        break;
    case RESOURCE_GI_VISIBILITY:
        if (wants_visibility(packet)) shape = volume;
        break;
    case RESOURCE_GI_PROBES:
        if (params->diffuse == GI_DIFFUSE_PROBES) shape = probes;
        break;
    case RESOURCE_GI_TRACE_RAW:
        if (params->dither) shape = traced;
        break;
    default:
        shape = traced;
        break;
    }
    memcpy(out, shape, 4 * sizeof *out);
}

static bool texture_ensure(Renderer *renderer, const Packet *packet, RenderResource id,
                           bool *made) {
    GiState *gi = &renderer->gi;
    u32 shape[4], *size = gi->sizes[id - RESOURCE_FIRST_GI];
    texture_shape(packet, gi->brick_cap, id, shape);
    bool is_volume = id == RESOURCE_GI_BASE || id == RESOURCE_GI_ATLAS;
    GpuFormat format = !is_volume                                   ? resource_formats[id]
                       : packet->gi.params.format == GI_FORMAT_BYTE ? GPU_FORMAT_RGBA8
                                                                    : GPU_FORMAT_RGBA16F;
    bool same = memcmp(shape, size, sizeof shape) == 0 &&
                (!is_volume || gi->format == packet->gi.params.format);
    if (renderer->targets[id].id && same) return true;
    if (renderer->targets[id].id) gpu_destroy_texture(renderer->gpu, renderer->targets[id]);
    renderer->targets[id] = gpu_create_texture(
        renderer->gpu, &(GpuTextureDesc){.label = resource_labels[id],
                                         .heap = "gi",
                                         .format = format,
                                         .width = shape[0],
                                         .height = shape[1],
                                         .depth = id >= RESOURCE_GI_TRACE_0 ? 1 : MAX(shape[2], 2),
                                         .mip_count = shape[3],
                                         .storage = true,
                                         .sampled = true});
    renderer->usage[id] = GPU_USAGE_NONE;
    renderer->frame_group_stale = true;
    memcpy(size, shape, sizeof shape);
    *made |= id < RESOURCE_GI_TRACE_0;
    return renderer->targets[id].id != 0;
}

static bool buffer_ensure(Renderer *renderer, RenderResource id, u64 size, bool *made) {
    GpuBuffer *buffer = &renderer->device_buffers[id];
    size = MAX(size, 256);
    if (size > gpu_info(renderer->gpu)->max_storage_buffer_size) return false;
    // What shrank by much is made anew as well: 512^3 voxels leave hundreds of megabytes behind.
    u64 there = buffer->id ? gpu_buffer_size(renderer->gpu, *buffer) : 0;
    if (there >= size && (there / 4 <= size && there - size < MIB(1))) return true;
    if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
    *buffer =
        gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = resource_labels[id],
                                                          .heap = "gi",
                                                          .size = size,
                                                          .indirect = id == RESOURCE_GI_COUNTERS ||
                                                                      id == RESOURCE_GI_ALONE});
    renderer->usage[id] = GPU_USAGE_NONE;
    renderer->frame_group_stale = true;
    *made = true;
    return buffer->id != 0;
}

u64 gi_buffer_bytes(RenderResource buffer, u64 voxels, u32 slots, const GiParams *params) {
    const u64 word = sizeof(u32), layer = (voxels + 31) / 32 * word;
    switch (buffer) {
    case RESOURCE_GI_MASKS:
        return layer * (params->solid ? GI_MASK_COUNT : GI_MASK_SOLID);
    case RESOURCE_GI_RANKS:
        return layer * (GI_MASK_DYNAMIC + 1) / GI_RANK_WORDS;
    case RESOURCE_GI_VOXELS:
        return slots * word;
    case RESOURCE_GI_ATTRIBUTES:
        return (u64)slots * GI_ATTRIBUTE_WORDS * word;
    case RESOURCE_GI_ACCUMULATORS:
        return gi_accumulator_bytes(voxels, slots, params->solid);
    case RESOURCE_GI_RADIANCE:
        return (u64)slots * (params->faces == GI_FACES_APART ? 3 : 1) * 2 * word;
    case RESOURCE_GI_RADIANCE_2:
        return params->faces == GI_FACES_APART ? (u64)slots * 3 * 2 * word : 0;
    case RESOURCE_GI_COUNTERS:
        return (GI_COUNTER_BLOCKS + gi_rank_blocks(voxels)) * word;
    default:
        return 0;
    }
}

// A surface through every row of the box, two voxels thick, is about this; more is found out by the
// first frame.
static u32 slots_at_first(const u32 dims[4]) {
    u64 x = dims[0], y = dims[1], z = dims[2];
    u64 slots = (x * y + y * z + z * x) * 4 * dims[3], voxels = x * y * z * dims[3];
    return (u32)MIN(MAX(slots, GI_SLOTS_MIN), voxels);
}

// Slots that one storage buffer, and one dispatch along x, can hold at most. Voxels beyond have no
// light of their own.
static u32 slots_at_most(const Renderer *renderer, const GiParams *params) {
    const GpuInfo *info = gpu_info(renderer->gpu);
    u64 bytes = MAX(gi_buffer_bytes(RESOURCE_GI_ATTRIBUTES, 0, 1, params),
                    gi_buffer_bytes(RESOURCE_GI_RADIANCE, 0, 1, params));
    return (u32)MIN(info->max_storage_buffer_size / bytes, (u64)info->max_groups_x * 64);
}

// Of a list of pixels, see GI_ALONE_FIRST: room for all.
static u64 alone_bytes(const Renderer *renderer, const Packet *packet) {
    bool is_used = packet->settings.path == PATH_TILED_DEFERRED &&
                   packet->gi.params.resolution != GI_RESOLUTION_FULL &&
                   gpu_info(renderer->gpu)->is_software;
    u64 pixels = is_used ? (u64)packet->width_px * packet->height_px : 0;
    return (GI_ALONE_FIRST + pixels) * sizeof(u32);
}

static bool resize(Renderer *renderer, const Packet *packet) {
    GiState *gi = &renderer->gi;
    const GiParams *params = &packet->gi.params;
    const GiRecord *record = &packet->gi.record;
    bool same = memcmp(gi->dims, record->dims, sizeof gi->dims) == 0 &&
                memcmp(gi->atlas, record->atlas, sizeof gi->atlas) == 0 &&
                gi->faces == params->faces && gi->filter == params->filter &&
                gi->solid == params->solid;
    if (!same || gi->slot_cap == 0) {
        gi->slot_cap = slots_at_first(record->dims);
        gi->brick_cap = gi_bricks_at_first(record->dims);
        gi->is_guessed = true;
    }
    gi->slot_cap = MIN(gi->slot_cap, slots_at_most(renderer, params));
    bool ok = true, made = !same;
    for (u32 id = RESOURCE_FIRST_GI; id < RESOURCE_FIRST_BUFFER && ok; id++)
        ok = texture_ensure(renderer, packet, (RenderResource)id, &made);
    u64 voxels = (u64)record->dims[0] * record->dims[1] * record->dims[2] * record->dims[3];
    for (u32 id = RESOURCE_FIRST_GI_BUFFER; id < RESOURCE_GI_ALONE && ok; id++)
        ok =
            buffer_ensure(renderer, (RenderResource)id,
                          gi_buffer_bytes((RenderResource)id, voxels, gi->slot_cap, params), &made);
    bool ignored; // no voxel hangs on it
    ok = ok && buffer_ensure(renderer, RESOURCE_GI_ALONE, alone_bytes(renderer, packet), &ignored);
    memcpy(gi->dims, record->dims, sizeof gi->dims);
    memcpy(gi->atlas, record->atlas, sizeof gi->atlas);
    gi->format = params->format;
    gi->faces = params->faces;
    gi->filter = params->filter;
    gi->solid = params->solid;
    gi->has_bricks = gi_has_bricks(packet);
    if (made || !ok) {
        gi->static_key = gi->dynamic_key = gi->light_key = gi->probe_key = 0;
        gi->has_dynamic = gi->has_lit = false;
    }
    return ok;
}

// --- Decisions ---

static bool dynamic_is_due(const GiState *gi, const Packet *packet) {
    const GiParams *params = &packet->gi.params;
    if (packet->gi_dynamic_draws.count == 0 && !gi->has_dynamic) return false;
    if (gi->dynamic_key == 0) return true;
    bool changed = gi->dynamic_key != packet->gi.dynamic_key;
    switch (params->policy) {
    case GI_POLICY_EVERY_FRAME:
        return true;
    case GI_POLICY_EVERY_N:
        return changed && (gi->is_cold ||
                           packet->tick / params->every_n != gi->dynamic_tick / params->every_n);
    case GI_POLICY_NEVER:
        return changed && gi->is_cold;
    default:
        return changed;
    }
}

// Keys are taken over here: the passes that follow make it true.
static void decide(Renderer *renderer, const Packet *packet) {
    GiState *gi = &renderer->gi;
    const PacketGi *wanted = &packet->gi;
    gi->is_cold = (packet->flags & PACKET_COLD) != 0 || !gi->has_lit;
    gi->is_fresh = !gi->has_lit;
    bool warming_up = renderer->is_warming_up && !gi->is_warm;
    gi->voxelise_static = gi->static_key != wanted->static_key || warming_up;
    if (gi->voxelise_static) gi->dynamic_key = 0; // what is static now takes voxels from them
    gi->voxelise_dynamic = dynamic_is_due(gi, packet) || warming_up;
    // Bricks are cleared and made anew: they keep nothing of the last frame.
    if (gi_has_bricks(packet)) gi->is_cold |= gi->voxelise_static || gi->voxelise_dynamic;
    gi->relight = gi->voxelise_static || gi->voxelise_dynamic || !gi->has_lit ||
                  gi->light_key != wanted->light_key;
    // A round through the probes takes as many frames as they have turns.
    u32 turns = gi_bounces_by_probes(&wanted->params) ? wanted->params.share : 1;
    if (gi->relight || gi->is_cold) gi->feedback_left = GI_FEEDBACK_FRAMES * turns;
    if (wanted->params.feedback && gi->feedback_left > 0) {
        gi->relight = true;
        gi->feedback_left--;
    }
    bool has_probes = wanted->params.diffuse == GI_DIFFUSE_PROBES;
    if (gi->relight || gi->probe_key != wanted->light_key)
        gi->probe_turns_left = wanted->params.share;
    if (gi->is_cold && gi->probe_turns_left > 0) gi->probe_turns_left = 1; // all at once
    gi->trace_probes = has_probes && gi->probe_turns_left > 0;
    RendererStats *stats = &renderer->stats;
    if (gi->voxelise_static) {
        gi->static_key = wanted->static_key;
        stats->gi_static_voxelised++;
    }
    if (gi->voxelise_dynamic) {
        gi->dynamic_key = wanted->dynamic_key;
        gi->dynamic_tick = packet->tick;
        gi->has_dynamic = packet->gi_dynamic_draws.count > 0;
        stats->gi_dynamic_voxelised++;
    }
    if (gi->relight) {
        gi->light_key = wanted->light_key;
        gi->has_lit = true;
        stats->gi_relit++;
    }
    if (gi->trace_probes) {
        gi->probe_key = wanted->light_key;
        gi->probe_turn++;
        gi->probe_turns_left--;
        stats->gi_probes_traced++;
    }
    gi->is_warm |= renderer->is_warming_up;
}

// Bits of what lights voxels have and the ways in which they ask for them, and surfaces for traced
// lights.
static void find_shadows(GiState *gi, const Packet *packet) {
    const GiLightRecord *lights = PACKET_DATA(packet, gi_lights, GiLightRecord);
    const TracedLightRecord *traced = PACKET_DATA(packet, traced_lights, TracedLightRecord);
    gi->voxel_shadows = gi->traced_shadows = 0;
    for (u32 i = 0; i < packet->gi_lights.count; i++)
        gi->voxel_shadows |= 1u << ((u32)lights[i].color[3] & 3) |
                             (lights[i].extra[1] != 0.0f ? GI_VISIBILITY_SPOTS : 0u);
    if (packet->gi_lights.count <= GI_LIGHT_BLOCK_CAP) gi->voxel_shadows |= GI_VISIBILITY_BLOCK;
    const DirectionalRecord *suns = PACKET_DATA(packet, directionals, DirectionalRecord);
    for (u32 i = 0; i < packet->directionals.count; i++)
        if (suns[i].direction[3] >= 0.0f)
            gi->voxel_shadows |= 1u << ((u32)suns[i].direction[3] & 3);
    if (packet->gi.params.solid) gi->voxel_shadows |= GI_VISIBILITY_SOLID;
    if (wants_visibility(packet)) gi->voxel_shadows |= GI_VISIBILITY_KEPT;
    for (u32 i = 0; i < packet->traced_lights.count; i++)
        gi->traced_shadows |= 1u << ((u32)traced[i].shadow[2] & 1);
}

void gi_begin(Renderer *renderer, const Packet *packet) {
    GiState *gi = &renderer->gi;
    gi->voxelise_static = gi->voxelise_dynamic = gi->relight = gi->trace_probes = false;
    gi->is_on = packet->gi.params.enabled && renderer->vertices.id && renderer->indices.id;
    if (!gi->is_on) return;
    if (!resize(renderer, packet)) {
        static bool told;
        if (!told)
            LOG(RENDER_LIMIT, "no room for %u x %u x %u voxels: drawn without global illumination",
                packet->gi.record.dims[0], packet->gi.record.dims[1], packet->gi.record.dims[2]);
        told = true;
        gi_state_destroy(renderer);
        return;
    }
    find_shadows(gi, packet);
    decide(renderer, packet);
}

bool gi_is_on(const PassContext *c) { return c->renderer->gi.is_on; }

// --- Groups ---

static GpuBinding frame_buffer(const Renderer *r, FrameBuffer id) {
    return (GpuBinding){.buffer = r->buffers[id]};
}
static GpuBinding device_buffer(const Renderer *r, RenderResource id) {
    return (GpuBinding){.buffer = r->device_buffers[id]};
}
static GpuBinding texture(const Renderer *r, RenderResource id, GpuSampler sampler) {
    return (GpuBinding){.texture = r->targets[id], .sampler = sampler};
}

static void bind_build(const Renderer *r, GpuBinding *b, u32 level) {
    b[BUILD_GI] = b[BUILD_FLOW] = frame_buffer(r, FRAME_BUFFER_GI);
    b[BUILD_FRAME] = frame_buffer(r, FRAME_BUFFER_FRAME);
    b[BUILD_MATERIALS] = frame_buffer(r, FRAME_BUFFER_MATERIALS);
    b[BUILD_DIRECTIONALS] = frame_buffer(r, FRAME_BUFFER_DIRECTIONALS);
    b[BUILD_VERTICES] = (GpuBinding){.buffer = r->vertices};
    b[BUILD_MESH_INDICES] = (GpuBinding){.buffer = r->indices};
    b[BUILD_INSTANCES] = frame_buffer(r, FRAME_BUFFER_GI_INSTANCES);
    b[BUILD_MASKS] = device_buffer(r, RESOURCE_GI_MASKS);
    b[BUILD_RANKS] = device_buffer(r, RESOURCE_GI_RANKS);
    b[BUILD_VOXELS] = device_buffer(r, RESOURCE_GI_VOXELS);
    b[BUILD_ATTRIBUTES] = device_buffer(r, RESOURCE_GI_ATTRIBUTES);
    b[BUILD_ACCUMULATORS] = device_buffer(r, RESOURCE_GI_ACCUMULATORS);
    b[BUILD_RADIANCE] = device_buffer(r, RESOURCE_GI_RADIANCE);
    b[BUILD_RADIANCE_2] = device_buffer(r, RESOURCE_GI_RADIANCE_2);
    b[BUILD_COUNTERS] = device_buffer(r, RESOURCE_GI_COUNTERS);
    b[BUILD_LIGHTS] = b[BUILD_LIGHT_BLOCK] = frame_buffer(r, FRAME_BUFFER_GI_LIGHTS);
    b[BUILD_LISTS] = frame_buffer(r, FRAME_BUFFER_GI_LISTS);
    b[BUILD_SHADOW_MAP] = texture(r, RESOURCE_SHADOW_MAP, r->sampler_shadow);
    b[BUILD_BASE] = texture(r, RESOURCE_GI_BASE, r->gi_sampler_linear);
    b[BUILD_ATLAS] = texture(r, RESOURCE_GI_ATLAS, r->gi_sampler_linear);
    b[BUILD_PROBES] = texture(r, RESOURCE_GI_PROBES, r->gi_sampler_linear);
    const GpuSampler none = {0};
    b[BUILD_BASE_STORAGE] = texture(r, RESOURCE_GI_BASE, none);
    b[BUILD_IRRADIANCE] = texture(r, RESOURCE_GI_IRRADIANCE, none);
    b[BUILD_VISIBILITY] = texture(r, RESOURCE_GI_VISIBILITY, none);
    b[BUILD_PROBES_STORAGE] = texture(r, RESOURCE_GI_PROBES, none);
    b[BUILD_BRICKS] = texture(r, RESOURCE_GI_BRICKS, r->sampler_nearest);
    b[BUILD_BRICKS_STORAGE] = texture(r, RESOURCE_GI_BRICKS, none);
    b[BUILD_MIP_SOURCE] = b[BUILD_MIP_TARGET] = texture(r, RESOURCE_GI_ATLAS, none);
    b[BUILD_MIP_SOURCE].mip = level > 0 ? level - 1 : 0;
    b[BUILD_MIP_TARGET].mip = level;
    for (u32 i = 0; i < GI_MIP_TAIL - 1; i++) {
        b[BUILD_MIP_TARGET_1 + i] = b[BUILD_MIP_TARGET];
        b[BUILD_MIP_TARGET_1 + i].mip = MIN(level + 1 + i, r->gi.atlas[3] - 1);
    }
}

static void bind_screen(const Renderer *r, GpuBinding *b) {
    const GpuSampler linear = r->gi_sampler_linear, none = {0};
    b[BINDING_GI] = b[BINDING_GI_FLOW] = frame_buffer(r, FRAME_BUFFER_GI);
    b[BINDING_GI_TRACED] = frame_buffer(r, FRAME_BUFFER_TRACED_LIGHTS);
    b[BINDING_GI_MASKS] = device_buffer(r, RESOURCE_GI_MASKS);
    b[BINDING_GI_RANKS] = device_buffer(r, RESOURCE_GI_RANKS);
    b[BINDING_GI_ATTRIBUTES] = device_buffer(r, RESOURCE_GI_ATTRIBUTES);
    b[BINDING_GI_ALONE] = device_buffer(r, RESOURCE_GI_ALONE);
    b[BINDING_GI_BASE] = texture(r, RESOURCE_GI_BASE, linear);
    b[BINDING_GI_ATLAS] = texture(r, RESOURCE_GI_ATLAS, linear);
    b[BINDING_GI_ATLAS_NEAREST_MIP] = texture(r, RESOURCE_GI_ATLAS, r->gi_sampler_nearest_mip);
    b[BINDING_GI_IRRADIANCE] = texture(r, RESOURCE_GI_IRRADIANCE, linear);
    b[BINDING_GI_VISIBILITY] = texture(r, RESOURCE_GI_VISIBILITY, linear);
    b[BINDING_GI_PROBES] = texture(r, RESOURCE_GI_PROBES, linear);
    b[BINDING_GI_BRICKS] = texture(r, RESOURCE_GI_BRICKS, r->sampler_nearest);
    b[BINDING_GI_TRACE_0] = texture(r, RESOURCE_GI_TRACE_0, r->sampler_nearest);
    b[BINDING_GI_TRACE_1] = texture(r, RESOURCE_GI_TRACE_1, r->sampler_nearest);
    b[BINDING_GI_TRACE_RAW] = texture(r, RESOURCE_GI_TRACE_RAW, r->sampler_nearest);
    b[BINDING_GI_TRACE_RAW_STORAGE] = texture(r, RESOURCE_GI_TRACE_RAW, none);
    b[BINDING_GI_TRACE_0_STORAGE] = texture(r, RESOURCE_GI_TRACE_0, none);
    b[BINDING_GI_TRACE_1_STORAGE] = texture(r, RESOURCE_GI_TRACE_1, none);
}

bool gi_update_groups(Renderer *renderer) {
    GiState *gi = &renderer->gi;
    if (!gi->is_on) return true;
    if (gi->screen_group.id && gi->bindings_version == renderer->bindings_version) return true;
    groups_destroy(renderer);
    GpuBindGroupDesc desc = {.label = "gi screen", .layout = renderer->gi_screen_layout};
    bind_screen(renderer, desc.bindings);
    gi->screen_group = gpu_create_bind_group(renderer->gpu, &desc);
    bool ok = gi->screen_group.id != 0;
    for (u32 level = 0; level < gi->atlas[3] && ok; level++) {
        desc = (GpuBindGroupDesc){.label = "gi build", .layout = renderer->gi_build_layout};
        bind_build(renderer, desc.bindings, level);
        gi->build_groups[level] = gpu_create_bind_group(renderer->gpu, &desc);
        ok = gi->build_groups[level].id != 0;
    }
    gi->bindings_version = renderer->bindings_version;
    return ok;
}

void gi_bind_build(const PassContext *c, GpuPipeline pipeline, u32 level) {
    gpu_cmd_bind_pipeline(c->cmd, pipeline);
    gpu_cmd_bind_group(c->cmd, 0, c->renderer->gi.build_groups[level]);
}

void gi_bind_screen(const PassContext *c, GpuPipeline pipeline) {
    bind_frame(c, pipeline);
    gpu_cmd_bind_group(c->cmd, 2, c->renderer->gi.screen_group);
}

void gi_dispatch_slots(const PassContext *c, u32 args) {
    gpu_cmd_dispatch_indirect(c->cmd, c->renderer->device_buffers[RESOURCE_GI_COUNTERS],
                              args * sizeof(u32));
}

void gi_dispatch_words(const PassContext *c, u64 invocations) {
    u64 groups = (invocations + 63) / 64;
    u32 x = (u32)MIN(groups, gpu_info(c->renderer->gpu)->max_groups_x);
    if (x) gpu_cmd_dispatch(c->cmd, x, (u32)((groups + x - 1) / x), 1);
}

void gi_barrier(const PassContext *c, const RenderResource *resources, u32 count) {
    GpuBarrier barriers[RESOURCE_COUNT];
    LUZ_ASSERT(count <= COUNT_OF(barriers));
    for (u32 i = 0; i < count; i++) {
        GpuUsage usage = c->renderer->usage[resources[i]];
        barriers[i] = (GpuBarrier){.texture = c->renderer->targets[resources[i]],
                                   .buffer = c->renderer->device_buffers[resources[i]],
                                   .from = usage,
                                   .to = usage};
    }
    gpu_cmd_barriers(c->cmd, barriers, count);
}

// --- Reports ---

static bool report_needed(const PassContext *c) {
    const GiState *gi = &c->renderer->gi;
    return gi->is_on && (gi->voxelise_static || gi->voxelise_dynamic);
}
static void report_record(const PassContext *c) {
    GiReports *reports = &c->renderer->gi_reports;
    u32 slot = gpu_frame_slot(c->renderer->gpu), set = c->renderer->frame_set;
    u32 size = GI_COUNTER_COUNT * sizeof(u32);
    gpu_cmd_copy_buffer(c->cmd, c->renderer->device_buffers[RESOURCE_GI_COUNTERS], 0,
                        reports->buffer, (u64)(slot * 2 + set) * size, size);
    reports->reported[slot][set] = true;
}
const Pass gi_report_pass = {
    "voxel report", {USE(GI_COUNTERS, COPY_SOURCE)}, 1, report_record, report_needed};

// Did the base volume find room for all its bricks? If not, there is more for the next frame.
static bool bricks_fit(Renderer *renderer, GiState *gi) {
    u32 wanted = renderer->gi_reports.counters[GI_COUNTER_BRICKS];
    if (!gi->has_bricks || wanted <= gi->brick_cap) return false;
    u32 shape[4], most = GI_BRICK_LAYER * (GI_BRICK_DEPTH_MAX / GI_BRICK_SIDE);
    gi_brick_shape(MIN(GI_SLOTS_SPARE(wanted), most), shape);
    u32 room = shape[2] / GI_BRICK_SIDE * GI_BRICK_LAYER;
    bool grows = room > gi->brick_cap;
    static bool told;
    if (wanted > most && !told)
        LOG(RENDER_LIMIT, "%u bricks of voxels are wanted, there is room for %u: others are empty",
            wanted, most);
    told |= wanted > most;
    gi->brick_cap = room;
    return grows;
}

// Of one frame set: each has buffers of its own, which grow by what it reports itself.
static bool read_report(Renderer *renderer, u32 slot, u32 set) {
    GiReports *reports = &renderer->gi_reports;
    GiState *gi = set == renderer->frame_set ? &renderer->gi : &renderer->parked.gi;
    if (!reports->reported[slot][set]) return false;
    reports->reported[slot][set] = false;
    const u32 *all = gpu_buffer_map(renderer->gpu, reports->buffer);
    memcpy(reports->counters, all + (u64)(slot * 2 + set) * GI_COUNTER_COUNT,
           sizeof reports->counters);
    bool is_other = bricks_fit(renderer, gi);
    u64 wanted = (u64)reports->counters[GI_COUNTER_STATIC] + reports->counters[GI_COUNTER_DYNAMIC];
    bool is_guessed = gi->is_guessed;
    gi->is_guessed = false;
    GiParams params = {.faces = gi->faces};
    u64 bytes = gi_buffer_bytes(RESOURCE_GI_VOXELS, 0, 1, &params) +
                gi_buffer_bytes(RESOURCE_GI_ATTRIBUTES, 0, 1, &params) +
                gi_buffer_bytes(RESOURCE_GI_RADIANCE, 0, 1, &params) +
                gi_buffer_bytes(RESOURCE_GI_RADIANCE_2, 0, 1, &params);
    u64 ample = MAX(GI_SLOTS_SPARE(wanted), GI_SLOTS_MIN);
    if (is_guessed && gi->slot_cap > ample && (gi->slot_cap - ample) * bytes > GI_SLACK) {
        gi->slot_cap = (u32)ample;
        return true;
    }
    if (reports->counters[GI_COUNTER_LOST] == 0 || wanted <= gi->slot_cap) return is_other;
    u32 most = slots_at_most(renderer, &params);
    static bool told;
    if (wanted > most && !told)
        LOG(RENDER_LIMIT,
            "%llu voxels are occupied, the device has room for %u: the others are dark",
            (unsigned long long)wanted, most);
    told |= wanted > most;
    if (gi->slot_cap >= most) return is_other;
    gi->slot_cap = (u32)MIN(GI_SLOTS_SPARE(wanted), most);
    return true;
}

bool gi_read_reports(Renderer *renderer, u32 slot) {
    bool other = read_report(renderer, slot, 1); // the first one's counters are those that are told
    return read_report(renderer, slot, 0) || other;
}

u64 gi_memory(const Renderer *renderer) {
    GpuHeapStat stats[32];
    u32 count = gpu_heap_stats(renderer->gpu, stats, COUNT_OF(stats));
    for (u32 i = 0; i < MIN(count, COUNT_OF(stats)); i++)
        if (strcmp(stats[i].name, "gi") == 0) return stats[i].used;
    return 0;
}

// --- For tests and tools ---

u32 renderer_gi_parts(const Renderer *renderer, RendererGiPart *out, u32 out_cap) {
    u32 count = 0;
    for (u32 id = RESOURCE_FIRST_GI; id < RESOURCE_COUNT && count < out_cap; id++) {
        GpuTexture texture = renderer->targets[id];
        GpuBuffer buffer = renderer->device_buffers[id];
        bool is_texture = id < RESOURCE_FIRST_BUFFER;
        if (!is_texture && id < RESOURCE_FIRST_GI_BUFFER) continue;
        u64 bytes = 0;
        if (is_texture && texture.id) bytes = gpu_texture_size(renderer->gpu, texture);
        if (!is_texture && buffer.id) bytes = gpu_buffer_size(renderer->gpu, buffer);
        out[count++] = (RendererGiPart){resource_labels[id], bytes};
    }
    return count;
}

u64 renderer_read_gi(Renderer *renderer, GiVolume which, void *out, u64 size) {
    static const RenderResource ids[GI_VOLUME_COUNT] = {
        [GI_VOLUME_MASKS] = RESOURCE_GI_MASKS,
        [GI_VOLUME_RANKS] = RESOURCE_GI_RANKS,
        [GI_VOLUME_VOXELS] = RESOURCE_GI_VOXELS,
        [GI_VOLUME_ATTRIBUTES] = RESOURCE_GI_ATTRIBUTES,
        [GI_VOLUME_RADIANCE] = RESOURCE_GI_RADIANCE,
        [GI_VOLUME_RADIANCE_2] = RESOURCE_GI_RADIANCE_2,
        [GI_VOLUME_COUNTERS] = RESOURCE_GI_COUNTERS,
        [GI_VOLUME_BASE] = RESOURCE_GI_BASE,
        [GI_VOLUME_BRICKS] = RESOURCE_GI_BRICKS,
        [GI_VOLUME_ATLAS] = RESOURCE_GI_ATLAS,
        [GI_VOLUME_IRRADIANCE] = RESOURCE_GI_IRRADIANCE,
        [GI_VOLUME_VISIBILITY] = RESOURCE_GI_VISIBILITY,
        [GI_VOLUME_PROBES] = RESOURCE_GI_PROBES,
        [GI_VOLUME_DIFFUSE] = RESOURCE_GI_TRACE_0,
    };
    return resource_read(renderer, ids[which], out, size);
}
