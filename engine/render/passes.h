// passes.h: the rows of passes, and what their record functions share. Private to engine/render/.
#ifndef LUZ_PASSES_H
#define LUZ_PASSES_H
#include "render_internal.h"

// Rows of Pass.uses.
#define USE(id, use_)                                                                              \
    { RESOURCE_##id, GPU_USAGE_##use_, false }
#define OVERWRITE(id, use_)                                                                        \
    { RESOURCE_##id, GPU_USAGE_##use_, true }
// All targets of the layout in use; those that it lacks are passed over.
#define USE_GBUFFER(use_)                                                                          \
    USE(GBUFFER_0, use_), USE(GBUFFER_1, use_), USE(GBUFFER_2, use_), USE(GBUFFER_3, use_),        \
        USE(GBUFFER_4, use_)
#define OVERWRITE_GBUFFER(use_)                                                                    \
    OVERWRITE(GBUFFER_0, use_), OVERWRITE(GBUFFER_1, use_), OVERWRITE(GBUFFER_2, use_),            \
        OVERWRITE(GBUFFER_3, use_), OVERWRITE(GBUFFER_4, use_)
// Filtered light of the voxels, as cones read it: three of a pass's uses.
#define USE_VOXEL_LIGHT(use_) USE(GI_BASE, use_), USE(GI_BRICKS, use_), USE(GI_ATLAS, use_)
// Targets of GpuRendering.
#define TARGET(id)                                                                                 \
    { .texture = c->renderer->targets[RESOURCE_##id] }
#define CLEARED(id)                                                                                \
    { .texture = c->renderer->targets[RESOURCE_##id], .clear = true }

void bind_frame(const PassContext *c, GpuPipeline pipeline);
// Warming up: compiles a shading pass for all kinds of lists (LIST_KIND_*) that may come.
void warm_up_list_kinds(const PassContext *c, PipelineKind kind);
// Begins rendering at the packet's resolution.
void begin(const PassContext *c, const GpuRendering *rendering);
void draw_fullscreen(const PassContext *c, PipelineKind kind);
// The same with a switch of its own (SPEC_POST) and numbers for the shader: floats, at most
// PUSH_SIZE bytes.
void draw_fullscreen_with(const PassContext *c, PipelineKind kind, u32 post, const f32 *push,
                          u32 push_count);

// Targets of a path that may be multisampled.
GpuTarget color_target(const PassContext *c, bool clear);
GpuTarget depth_target(const PassContext *c, bool clear);

// passes_geometry.c
extern const Pass shadow_pass, gbuffer_pass, over_pass;
// passes_forward.c
extern const Pass prepass_pass, forward_pass, forward_lists_pass, multipass_base_pass,
    multipass_pass, samples_pass;
// volumes.c
extern const Pass base_pass, volumes_pass, volumes_stencil_pass;
// passes_lighting.c
extern const Pass deferred_pass, resolve_pass, tiled_pass;
// passes_lists.c: lists of the path's cells, between the depth buffer and whoever shades; passes
// that the settings do not ask for are passed over.
extern const Pass tile_depth_pass, list_refine_pass, list_count_pass, list_scan_pass,
    list_fill_pass, list_report_pass;
extern const Pass cluster_keys_pass, cluster_scan_pass, cluster_places_pass, cluster_count_pass,
    cluster_list_scan_pass, cluster_fill_pass, cluster_report_pass, clustered_pass;
#define TILE_LIST_PASSES                                                                           \
    &tile_depth_pass, &list_refine_pass, &list_count_pass, &list_scan_pass, &list_fill_pass,       \
        &list_report_pass
#define CLUSTER_LIST_PASSES                                                                        \
    &cluster_keys_pass, &cluster_scan_pass, &cluster_places_pass, &cluster_count_pass,             \
        &cluster_list_scan_pass, &cluster_fill_pass, &cluster_report_pass
// What a pass reads that shades by lists: USE_LISTS(READ_VERTEX) or
// USE_LISTS(STORAGE_READ_COMPUTE).
#define USE_LISTS(use_)                                                                            \
    USE(LIST_CELLS, use_), USE(LIST_INDICES, use_), USE(PIXEL_CLUSTERS, use_),                     \
        USE(CLUSTERS, use_), USE(TILE_DEPTHS, use_)
// gi_voxelise.c, gi_bricks.c, gi_light.c, gi_filter.c, gi_probes.c: the voxels, from the shadow map
// on
extern const Pass gi_fresh_pass, gi_static_pass, gi_dynamic_pass, gi_bricks_pass, gi_light_pass,
    gi_filter_pass, gi_bounce_pass, gi_refilter_pass, gi_irradiance_pass, gi_probes_pass;
// Do probes keep what bounces on from frame to frame (else the filtered images do)?
bool gi_bounces_by_probes(const GiParams *params);
// Are there bounces to add in this frame after its light, and do they read what the last frame left
// in the images (which are then filtered once, after the bounce)?
bool gi_bounces(const PassContext *c);
bool gi_feeds_back(const PassContext *c);
// gi.c
extern const Pass gi_report_pass;
#define GI_VOXEL_PASSES                                                                            \
    &gi_fresh_pass, &gi_static_pass, &gi_dynamic_pass, &gi_bricks_pass, &gi_light_pass,            \
        &gi_filter_pass, &gi_bounce_pass, &gi_refilter_pass, &gi_irradiance_pass, &gi_probes_pass, \
        &gi_report_pass
// gi_screen.c: from lit surfaces to such with indirect light. Forward paths have no G-buffer of
// their own: gi_gbuffer_pass draws one.
extern const Pass gi_gbuffer_pass, gi_traced_pass, gi_trace_pass, gi_smooth_pass, gi_compose_pass,
    gi_compose_ms_pass, gi_tiled_pass, gi_alone_pass;
// Is the compose pass a part of gi_tiled_pass, which then stands in for tiled_pass?
bool gi_shades_tiles(const PassContext *c);
u32 tiled_pixels_per_lane(const Renderer *renderer); // pipelines.c
#define GI_SCREEN_PASSES                                                                           \
    &gi_traced_pass, &gi_trace_pass, &gi_smooth_pass, &gi_compose_pass, &gi_compose_ms_pass
// gi_views.c
extern const Pass gi_view_pass;
// post.c
extern const Pass post_pass, debug_pass;
// debug_views.c
extern const Pass overdraw_pass, overdraw_show_pass, debug_overlay_pass;

#endif
