// passes.c: what each path runs, and what all passes share.
//
// Data in: a packet. Data out: commands. pass_run derives the barriers from the rows, sets label
// and timer; a pass only binds and draws. To add a pass: write its record function and its row
// (passes_geometry.c, passes_lighting.c, passes_lists.c, post.c), declare it in passes.h, and name
// it in the paths that want it.
#include "passes.h"
#include <string.h>

void bind_frame(const PassContext *c, GpuPipeline pipeline) {
    gpu_cmd_bind_pipeline(c->cmd, pipeline);
    gpu_cmd_bind_group(c->cmd, 0, c->renderer->frame_group);
}

// Blended surfaces that voxels light need these as well.
static void bind_draws(const PassContext *c, PipelineKind kind, GpuPipeline pipeline) {
    gpu_cmd_bind_pipeline(c->cmd, pipeline);
    gpu_cmd_bind_group(c->cmd, 0, c->renderer->mesh_group);
    if (kind == PIPELINE_GI_FORWARD_BLEND)
        gpu_cmd_bind_group(c->cmd, 2, c->renderer->gi.screen_group);
}

// A list has few kinds of pipelines: looked up once each.
#define VARIANTS (2 * 4 * 3)

static GpuPipeline variant_pipeline(const PassContext *c, PipelineKind kind, bool alpha_mask,
                                    const PacketMaterial *material, u32 vertex_lit,
                                    GpuPipeline cache[VARIANTS]) {
    u32 textures = (material->albedo_texture ? 1 : 0) | (material->normal_texture ? 2 : 0);
    bool double_sided = material->double_sided != 0;
    GpuPipeline *slot = &cache[(vertex_lit * 4 + textures) * 2 + double_sided];
    if (slot->id) return *slot;
    u32 before = c->renderer->pipeline_count;
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind,
                                        (PipelineVariant){.alpha_mask = alpha_mask,
                                                          .double_sided = double_sided,
                                                          .textures = textures,
                                                          .vertex_lit = vertex_lit});
    // Fewer than before: the renderer emptied its cache, which ends what is known here.
    if (c->renderer->pipeline_count < before) memset(cache, 0, VARIANTS * sizeof *cache);
    *slot = pipeline;
    return pipeline;
}

enum { ALPHA_MODE_MASK = 1, ALPHA_MODE_BLEND = 2 }; // AlphaMode of world/components.h

// Warming up: what lists of this kind may draw in another frame, a triangle with each of the
// level's materials. Shadow maps stay as they are: they are kept, and hang on no view.
static void draw_unseen(const PassContext *c, PipelineKind kind, bool alpha_mask, u32 variants,
                        const void *push, u32 push_size) {
    Renderer *r = c->renderer;
    const PacketMaterial *materials = PACKET_DATA(c->packet, material_bindings, PacketMaterial);
    u32 mesh = 0;
    while (mesh < r->mesh_count && r->meshes[mesh].lods[0].index_count == 0) mesh++;
    if (kind == PIPELINE_SHADOW || kind == PIPELINE_SHADOW_MASK || mesh == r->mesh_count ||
        c->packet->instances.count == 0)
        return;
    GpuPipeline cache[VARIANTS] = {{0}};
    for (u32 i = 0; i < c->packet->material_bindings.count * variants; i++) {
        const PacketMaterial *material = &materials[i / variants];
        bool is_blend = kind == PIPELINE_FORWARD_BLEND || kind == PIPELINE_GI_FORWARD_BLEND;
        bool is_drawn = is_blend                    ? material->alpha_mode == ALPHA_MODE_BLEND
                        : kind == PIPELINE_EMISSIVE ? material->emissive_pass
                        : alpha_mask                ? material->alpha_mode == ALPHA_MODE_MASK
                                                    : material->alpha_mode != ALPHA_MODE_BLEND;
        u32 count = r->pipeline_count;
        GpuPipeline pipeline =
            is_drawn ? variant_pipeline(c, kind, alpha_mask, material, i % variants, cache)
                     : (GpuPipeline){0};
        if (!pipeline.id || r->pipeline_count == count) continue; // it has been seen
        bind_draws(c, kind, pipeline);
        if (push_size) gpu_cmd_push(c->cmd, push, push_size);
        gpu_cmd_bind_group(c->cmd, 1, render_material_group(r, material));
        gpu_cmd_draw_indexed(c->cmd, 3, 1, r->meshes[mesh].lods[0].first_index,
                             r->meshes[mesh].vertex_offset, 0);
    }
}

void draw_list_with(const PassContext *c, PipelineKind kind, PacketSection section, bool alpha_mask,
                    const void *push, u32 push_size) {
    if (section.count == 0 && !c->renderer->is_warming_up) return;
    Renderer *r = c->renderer;
    const PacketDraw *draws = (const PacketDraw *)((const u8 *)c->packet + section.offset);
    const PacketMaterial *materials = PACKET_DATA(c->packet, material_bindings, PacketMaterial);
    gpu_cmd_bind_vertices(c->cmd, 0, r->vertices, 0);
    gpu_cmd_bind_vertices(c->cmd, 1, r->buffers[FRAME_BUFFER_INSTANCES], 0);
    gpu_cmd_bind_indices(c->cmd, r->indices, false);
    GpuPipeline bound = {0}, cache[VARIANTS] = {{0}};
    u32 bound_material = UINT32_MAX;
    // Depth alone is the same of every material, but the set must be there.
    bool one_group = kind == PIPELINE_SHADOW || kind == PIPELINE_PREPASS;
    bool by_vertex =
        c->packet->settings.vertex_lighting && c->packet->frame.vertex_lighting[0] > 0.0f;
    // Warming up, what may be lit by its vertices in another frame is so now.
    u32 variants = r->is_warming_up && by_vertex ? 3 : 1;
    for (u32 i = 0; i < section.count * variants; i++) {
        const PacketDraw *draw = &draws[i / variants];
        if (draw->mesh >= r->mesh_count || r->meshes[draw->mesh].lods[0].index_count == 0) continue;
        const PacketMaterial *material = &materials[draw->material];
        u32 vertex_lit = variants > 1 ? i % variants : by_vertex ? draw->vertex_lit : 0;
        GpuPipeline pipeline = variant_pipeline(c, kind, alpha_mask, material, vertex_lit, cache);
        if (!pipeline.id) continue;
        if (pipeline.id != bound.id) {
            bind_draws(c, kind, pipeline);
            if (push_size && !bound.id) gpu_cmd_push(c->cmd, push, push_size);
            bound = pipeline;
            bound_material = UINT32_MAX;
        }
        if (draw->material != bound_material && !(one_group && bound_material != UINT32_MAX)) {
            gpu_cmd_bind_group(c->cmd, 1, render_material_group(r, material));
            bound_material = draw->material;
        }
        const GpuMesh *mesh = &r->meshes[draw->mesh];
        const MeshLod *lod = &mesh->lods[MIN(draw->lod, mesh->lod_count - 1)];
        gpu_cmd_draw_indexed(c->cmd, lod->index_count, draw->instance_count, lod->first_index,
                             mesh->vertex_offset, draw->first_instance);
        r->stats.draw_calls++;
        r->stats.triangles += lod->index_count / 3 * draw->instance_count;
    }
    if (r->is_warming_up) draw_unseen(c, kind, alpha_mask, variants, push, push_size);
}

void draw_list(const PassContext *c, PipelineKind kind, PacketSection section, bool alpha_mask) {
    draw_list_with(c, kind, section, alpha_mask, NULL, 0);
}

void draw_fullscreen(const PassContext *c, PipelineKind kind) {
    draw_fullscreen_with(c, kind, 0, NULL, 0);
}

void draw_fullscreen_with(const PassContext *c, PipelineKind kind, u32 post, const f32 *push,
                          u32 push_count) {
    GpuPipeline pipeline =
        pipeline_get(c->renderer, c->packet, kind, (PipelineVariant){.post = post});
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    if (push_count) gpu_cmd_push(c->cmd, push, push_count * (u32)sizeof(f32));
    gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
    c->renderer->stats.draw_calls++;
}

GpuTarget color_target(const PassContext *c, bool clear) {
    const Renderer *r = c->renderer;
    return (GpuTarget){.texture = r->targets[r->samples > 1 ? RESOURCE_HDR_MS : RESOURCE_HDR],
                       .clear = clear};
}

GpuTarget depth_target(const PassContext *c, bool clear) {
    const Renderer *r = c->renderer;
    return (GpuTarget){.texture = r->targets[r->samples > 1 ? RESOURCE_DEPTH_MS : RESOURCE_DEPTH],
                       .clear = clear};
}

void begin(const PassContext *c, const GpuRendering *rendering) {
    GpuRendering sized = *rendering;
    sized.width = c->packet->width_px;
    sized.height = c->packet->height_px;
    gpu_cmd_begin_rendering(c->cmd, &sized);
}

const PathRow path_table[PATH_COUNT] = {
    [PATH_FORWARD] = {"forward",
                      {&shadow_pass, GI_VOXEL_PASSES, &forward_pass, &gi_gbuffer_pass,
                       GI_SCREEN_PASSES, &over_pass, &samples_pass, &post_pass}},
    [PATH_MULTIPASS] = {"multipass",
                        {&shadow_pass, GI_VOXEL_PASSES, &prepass_pass, &gi_gbuffer_pass,
                         &multipass_base_pass, &multipass_pass, &resolve_pass, GI_SCREEN_PASSES,
                         &over_pass, &post_pass}},
    [PATH_DEFERRED] = {"deferred",
                       {&shadow_pass, GI_VOXEL_PASSES, &gbuffer_pass, &deferred_pass, &resolve_pass,
                        GI_SCREEN_PASSES, &over_pass, &post_pass}},
    [PATH_DEFERRED_VOLUMES] = {"deferred_volumes",
                               {&shadow_pass, GI_VOXEL_PASSES, &gbuffer_pass, &base_pass,
                                &volumes_pass, &volumes_stencil_pass, &resolve_pass,
                                GI_SCREEN_PASSES, &over_pass, &post_pass}},
    [PATH_TILED_DEFERRED] = {"tiled_deferred",
                             {&shadow_pass, GI_VOXEL_PASSES, &gbuffer_pass, TILE_LIST_PASSES,
                              &gi_trace_pass, &gi_smooth_pass, &tiled_pass, &gi_tiled_pass,
                              &gi_alone_pass, &gi_traced_pass, &gi_compose_pass, &over_pass,
                              &post_pass}},
    [PATH_TILED_FORWARD] = {"tiled_forward",
                            {&shadow_pass, GI_VOXEL_PASSES, &prepass_pass, &gi_gbuffer_pass,
                             TILE_LIST_PASSES, &forward_lists_pass, GI_SCREEN_PASSES, &over_pass,
                             &samples_pass, &post_pass}},
    [PATH_CLUSTERED_DEFERRED] = {"clustered_deferred",
                                 {&shadow_pass, GI_VOXEL_PASSES, &gbuffer_pass, CLUSTER_LIST_PASSES,
                                  &clustered_pass, GI_SCREEN_PASSES, &over_pass, &post_pass}},
    [PATH_CLUSTERED_FORWARD] = {"clustered_forward",
                                {&shadow_pass, GI_VOXEL_PASSES, &prepass_pass, &gi_gbuffer_pass,
                                 CLUSTER_LIST_PASSES, &forward_lists_pass, GI_SCREEN_PASSES,
                                 &over_pass, &samples_pass, &post_pass}},
};
static const PathRow debug_path = {
    "debug view",
    {&shadow_pass, &gbuffer_pass, TILE_LIST_PASSES, CLUSTER_LIST_PASSES, &debug_pass}};
static const PathRow gi_view_path = {
    "gi view", {&shadow_pass, GI_VOXEL_PASSES, &gbuffer_pass, &gi_trace_pass, &gi_view_pass}};
static const PathRow overdraw_path = {"overdraw", {&overdraw_pass, &overdraw_show_pass}};

const PathRow *path_of(const Packet *packet) {
    switch (packet->settings.view) {
    case VIEW_FINAL:
    case VIEW_LIGHT_RECTS: // these lie over the final picture: debug_overlay_pass (debug_views.c)
    case VIEW_LIGHT_VOLUMES:
    case VIEW_LIGHT_STATES:
    case VIEW_LIGHT_LODS:
    case VIEW_OCCLUDERS:
        return &path_table[packet->settings.path];
    case VIEW_OVERDRAW:
    case VIEW_LAYERS:
        return &overdraw_path;
    case VIEW_GI_VOXELS:
    case VIEW_GI_INDIRECT:
    case VIEW_GI_DIFFUSE:
    case VIEW_GI_SPECULAR:
    case VIEW_GI_AO:
    case VIEW_GI_STEPS:
    case VIEW_GI_PROBES:
    case VIEW_GI_LEAKS:
        return &gi_view_path;
    default:
        return &debug_path;
    }
}

void pass_run(const PassContext *c, const Pass *pass) {
    if (pass->needed && !pass->needed(c)) return;
    if (pass->expand) {
        pass->expand(c);
        return;
    }
    Renderer *r = c->renderer;
    GpuBarrier barriers[PASS_USES_CAP];
    u32 barrier_count = 0;
    for (u32 i = 0; i < pass->use_count; i++) {
        const ResourceUse *use = &pass->uses[i];
        GpuUsage from = r->usage[use->resource];
        if (!gpu_usage_needs_barrier(from, use->usage)) continue;
        bool is_buffer = use->resource >= RESOURCE_FIRST_BUFFER;
        // What the layout lacks, and global illumination that is off.
        if (is_buffer ? !r->device_buffers[use->resource].id : !r->targets[use->resource].id)
            continue;
        barriers[barrier_count++] = (GpuBarrier){.texture = r->targets[use->resource],
                                                 .buffer = r->device_buffers[use->resource],
                                                 .from = from,
                                                 .to = use->usage,
                                                 .discard = use->discard};
        r->usage[use->resource] = use->usage;
    }
    gpu_cmd_label_begin(c->cmd, pass->name);
    gpu_cmd_timer_begin(c->cmd, pass->name);
    if (barrier_count) gpu_cmd_barriers(c->cmd, barriers, barrier_count);
    r->stats.barriers += barrier_count;
    pass->record(c);
    gpu_cmd_timer_end(c->cmd);
    gpu_cmd_label_end(c->cmd);
}
