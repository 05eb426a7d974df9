// pipelines.c: one row a kind of pipeline, and the cache of those that were made.
//
// Data in: kind, packet (its specialisation: which BRDFs, attenuation, switches). Data out:
// pipeline handles. Called by passes.c and warm_up.c. A pipeline is specialised for what the level
// uses, because a feature that is off behind a uniform costs as much as on (software driver).
#include "render_internal.h"
#include "../base/log.h"
#include <string.h>

const char *const resource_labels[RESOURCE_COUNT] = {
#define X(id, label, format) label,
    RENDER_RESOURCES(X)
#undef X
};
const GpuFormat resource_formats[RESOURCE_COUNT] = {
#define X(id, label, format) format,
    RENDER_RESOURCES(X)
#undef X
};

// Which specialisation constants matter to a kind; the others are zeroed in the key, so that two
// settings share a pipeline that does not depend on them.
#define SPEC_BIT(id) (1ull << (id))
#define SPEC_PALETTE (SPEC_BIT(SPEC_PALETTE_TEXTURE))
#define SPEC_LIGHTING                                                                              \
    (SPEC_BIT(SPEC_BRDF_MASK) | SPEC_BIT(SPEC_ATTENUATION) | SPEC_BIT(SPEC_SHADOW) |               \
     SPEC_BIT(SPEC_SPOTS) | SPEC_BIT(SPEC_DIRECTIONALS) | SPEC_BIT(SPEC_LIGHT_BLOCKS) |            \
     SPEC_BIT(SPEC_EXACT_POWER) | SPEC_BIT(SPEC_ATTENUATION_LOOKUP) | SPEC_PALETTE)
// What a pass needs to read the G-buffer.
#define SPEC_READ_GBUFFER (SPEC_BIT(SPEC_LAYOUT) | SPEC_BIT(SPEC_NORMAL_LOOKUP) | SPEC_PALETTE)
// What a pass needs that makes light lists.
#define SPEC_MAKE_LISTS                                                                            \
    (SPEC_BIT(SPEC_SPOTS) | SPEC_BIT(SPEC_LIGHT_BLOCKS) | SPEC_BIT(SPEC_TILE_SHIFT) |              \
     SPEC_BIT(SPEC_TILE_DEPTH) | SPEC_BIT(SPEC_CLUSTERED) | SPEC_BIT(SPEC_CLUSTER_NORMALS) |       \
     SPEC_BIT(SPEC_SAMPLES))
// What a pass needs that shades by lists.
#define SPEC_SHADE_LISTS                                                                           \
    (SPEC_BIT(SPEC_TILE_SHIFT) | SPEC_BIT(SPEC_DEVICE_LISTS) | SPEC_BIT(SPEC_CLUSTERED) |          \
     SPEC_BIT(SPEC_LIST_KINDS))
#define SPEC_TILED                                                                                 \
    (SPEC_LIGHTING | SPEC_READ_GBUFFER | SPEC_SHADE_LISTS | SPEC_BIT(SPEC_SUBGROUP_CULL) |         \
     SPEC_BIT(SPEC_PIXELS_PER_LANE) | SPEC_BIT(SPEC_TILED_GROUP) | SPEC_BIT(SPEC_PALETTE_LANES))
// What a pass needs to read lights by lists.
#define SPEC_LISTS                                                                                 \
    (SPEC_BIT(SPEC_CELL_LISTS) | SPEC_BIT(SPEC_TILE_SHIFT) | SPEC_BIT(SPEC_CLUSTERED) |            \
     SPEC_BIT(SPEC_DEVICE_LISTS) | SPEC_BIT(SPEC_SAMPLES) | SPEC_BIT(SPEC_VERTEX_LIGHTING))
#define SPEC_ONE_LIGHT                                                                             \
    (SPEC_BIT(SPEC_BRDF_MASK) | SPEC_BIT(SPEC_ATTENUATION) | SPEC_BIT(SPEC_EXACT_POWER) |          \
     SPEC_BIT(SPEC_ATTENUATION_LOOKUP) | SPEC_BIT(SPEC_LIGHT_BRANCH) | SPEC_READ_GBUFFER)

// What a pass needs that makes voxels of triangles.
#define SPEC_VOXELISE (SPEC_BIT(SPEC_GI_STEP) | SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES))
// What a pass needs that writes or reads filtered light.
#define SPEC_GI_IMAGES                                                                             \
    (SPEC_BIT(SPEC_GI_DIRECTIONS) | SPEC_BIT(SPEC_GI_FACES) | SPEC_BIT(SPEC_GI_FORMAT) |           \
     SPEC_BIT(SPEC_GI_MIPS) | SPEC_BIT(SPEC_GI_CASCADES) | SPEC_BIT(SPEC_GI_BRICKS))
// What a pass over the screen needs that gathers from the voxels.
#define SPEC_READ_VOXELS                                                                           \
    (SPEC_READ_GBUFFER | SPEC_BIT(SPEC_BRDF_MASK) | SPEC_BIT(SPEC_GI_DIRECTIONS) |                 \
     SPEC_BIT(SPEC_GI_FACES) | SPEC_BIT(SPEC_GI_MIPS) | SPEC_BIT(SPEC_GI_CASCADES) |               \
     SPEC_BIT(SPEC_GI_DIFFUSE) | SPEC_BIT(SPEC_GI_FEATURES) | SPEC_BIT(SPEC_GI_FORMAT) |           \
     SPEC_BIT(SPEC_GI_RESOLUTION) | SPEC_BIT(SPEC_GI_BRICKS))

typedef struct PipelineRow {
    const char *label, *vertex, *fragment, *compute;
    RenderResource targets[2];
    u32 target_count;
    bool to_swapchain, to_gbuffer; // the targets of the layout
    bool has_depth, is_shadow;
    bool needs_primitive_id;
    bool may_be_ms; // drawn to the multisampled targets if the path has them
    GpuStencil stencil;
    GpuDepth depth;
    GpuCull cull;
    GpuBlend blend;
    GpuVertexLayout vertex_layout;
    u64 spec_mask;
    const char *compute_byte; // of shaders that write GI's images: the same for format byte
} PipelineRow;

static const PipelineRow rows[PIPELINE_COUNT] = {
    [PIPELINE_SHADOW] = {.label = "shadow",
                         .vertex = "shadow.vert",
                         .is_shadow = true,
                         .has_depth = true,
                         .depth = GPU_DEPTH_WRITE,
                         .vertex_layout = GPU_VERTEX_MESH},
    [PIPELINE_SHADOW_MASK] = {.label = "shadow mask",
                              .vertex = "shadow_mask.vert",
                              .fragment = "shadow_mask.frag",
                              .is_shadow = true,
                              .has_depth = true,
                              .depth = GPU_DEPTH_WRITE,
                              .cull = GPU_CULL_NONE,
                              .vertex_layout = GPU_VERTEX_MESH,
                              .spec_mask = SPEC_PALETTE},
    [PIPELINE_GBUFFER] = {.label = "gbuffer",
                          .vertex = "geometry.vert",
                          .fragment = "gbuffer.frag",
                          .to_gbuffer = true,
                          .has_depth = true,
                          .depth = GPU_DEPTH_WRITE,
                          .vertex_layout = GPU_VERTEX_MESH,
                          .spec_mask = SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES) |
                                       SPEC_BIT(SPEC_LAYOUT) | SPEC_BIT(SPEC_SHADOW) |
                                       SPEC_PALETTE},
    [PIPELINE_FORWARD] = {.label = "forward",
                          .vertex = "forward.vert",
                          .fragment = "forward.frag",
                          .targets = {RESOURCE_HDR},
                          .target_count = 1,
                          .has_depth = true,
                          .may_be_ms = true,
                          .depth = GPU_DEPTH_WRITE,
                          .vertex_layout = GPU_VERTEX_MESH,
                          .spec_mask = SPEC_LIGHTING | SPEC_BIT(SPEC_ALPHA_MASK) |
                                       SPEC_BIT(SPEC_TEXTURES) | SPEC_BIT(SPEC_VERTEX_LIGHTING)},
    [PIPELINE_FORWARD_BLEND] = {.label = "forward blend",
                                .vertex = "forward.vert",
                                .fragment = "forward.frag",
                                .targets = {RESOURCE_HDR},
                                .target_count = 1,
                                .has_depth = true,
                                .may_be_ms = true,
                                .depth = GPU_DEPTH_TEST,
                                .blend = GPU_BLEND_ALPHA,
                                .vertex_layout = GPU_VERTEX_MESH,
                                .spec_mask = SPEC_LIGHTING | SPEC_LISTS | SPEC_BIT(SPEC_TEXTURES)},
    [PIPELINE_PREPASS] = {.label = "depth pre-pass",
                          .vertex = "prepass.vert",
                          .has_depth = true,
                          .may_be_ms = true,
                          .depth = GPU_DEPTH_WRITE,
                          .vertex_layout = GPU_VERTEX_MESH},
    [PIPELINE_PREPASS_MASK] = {.label = "depth pre-pass mask",
                               .vertex = "prepass_mask.vert",
                               .fragment = "prepass_mask.frag",
                               .has_depth = true,
                               .may_be_ms = true,
                               .depth = GPU_DEPTH_WRITE,
                               .vertex_layout = GPU_VERTEX_MESH,
                               .spec_mask = SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES) |
                                            SPEC_PALETTE},
    [PIPELINE_FORWARD_LISTS] = {.label = "forward by lists",
                                .vertex = "forward.vert",
                                .fragment = "forward.frag",
                                .targets = {RESOURCE_HDR},
                                .target_count = 1,
                                .has_depth = true,
                                .may_be_ms = true,
                                .depth = GPU_DEPTH_EQUAL,
                                .vertex_layout = GPU_VERTEX_MESH,
                                .spec_mask = SPEC_LIGHTING | SPEC_LISTS | SPEC_BIT(SPEC_TEXTURES)},
    [PIPELINE_MULTIPASS_BASE] = {.label = "multipass base",
                                 .needs_primitive_id = true,
                                 .vertex = "forward.vert",
                                 .fragment = "multipass_base.frag",
                                 .targets = {RESOURCE_ACCUMULATION, RESOURCE_HDR_OTHER},
                                 .target_count = 2,
                                 .has_depth = true,
                                 .depth = GPU_DEPTH_EQUAL,
                                 .vertex_layout = GPU_VERTEX_MESH,
                                 .spec_mask = SPEC_LIGHTING | SPEC_BIT(SPEC_TEXTURES)},
#define MULTIPASS(label_, specs)                                                                   \
    {                                                                                              \
        .label = "multipass " label_, .needs_primitive_id = true, .vertex = "forward.vert",        \
        .fragment = "multipass_lights.frag", .targets = {RESOURCE_ACCUMULATION},                   \
        .target_count = 1, .has_depth = true, .depth = GPU_DEPTH_EQUAL, .blend = GPU_BLEND_ADD,    \
        .vertex_layout = GPU_VERTEX_MESH, .spec_mask = (specs) | SPEC_BIT(SPEC_TEXTURES)           \
    }
    [PIPELINE_MULTIPASS_POINTS] = MULTIPASS("points", SPEC_LIGHTING & ~SPEC_BIT(SPEC_SPOTS)),
    [PIPELINE_MULTIPASS_SPOTS] = MULTIPASS("spots", SPEC_LIGHTING),
#undef MULTIPASS
    [PIPELINE_DEFERRED_BASE] = {.label = "deferred base",
                                .vertex = "fullscreen.vert",
                                .fragment = "deferred_base.frag",
                                .targets = {RESOURCE_ACCUMULATION},
                                .target_count = 1,
                                .cull = GPU_CULL_NONE,
                                .spec_mask = SPEC_LIGHTING | SPEC_READ_GBUFFER},
    [PIPELINE_DEFERRED_POINTS] = {.label = "deferred points",
                                  .vertex = "deferred_light.vert",
                                  .fragment = "deferred_light.frag",
                                  .targets = {RESOURCE_ACCUMULATION},
                                  .target_count = 1,
                                  .cull = GPU_CULL_NONE,
                                  .blend = GPU_BLEND_ADD,
                                  .vertex_layout = GPU_VERTEX_LIGHT,
                                  .spec_mask = SPEC_ONE_LIGHT},
    [PIPELINE_DEFERRED_SPOTS] = {.label = "deferred spots",
                                 .vertex = "deferred_light.vert",
                                 .fragment = "deferred_light.frag",
                                 .targets = {RESOURCE_ACCUMULATION},
                                 .target_count = 1,
                                 .cull = GPU_CULL_NONE,
                                 .blend = GPU_BLEND_ADD,
                                 .vertex_layout = GPU_VERTEX_LIGHT,
                                 .spec_mask = SPEC_ONE_LIGHT | SPEC_BIT(SPEC_SPOTS)},
#define VOLUME(label_, fragment_, depth_, cull_, stencil_, specs)                                  \
    {                                                                                              \
        .label = "light volumes " label_, .vertex = "volume.vert", .fragment = fragment_,          \
        .targets = {RESOURCE_ACCUMULATION}, .target_count = 1, .has_depth = true, .depth = depth_, \
        .cull = cull_, .stencil = stencil_, .blend = GPU_BLEND_ADD,                                \
        .vertex_layout = GPU_VERTEX_VOLUME, .spec_mask = specs                                     \
    }
#define VOLUMES(id, label_, ...)                                                                   \
    [PIPELINE_VOLUME_##id##_POINTS] = VOLUME(label_ " points", __VA_ARGS__, SPEC_ONE_LIGHT),       \
    [PIPELINE_VOLUME_##id##_SPOTS] =                                                               \
        VOLUME(label_ " spots", __VA_ARGS__, SPEC_ONE_LIGHT | SPEC_BIT(SPEC_SPOTS))
#define LIGHT_SHADER "deferred_light.frag"
    VOLUMES(BACK, "back", LIGHT_SHADER, GPU_DEPTH_BEHIND, GPU_CULL_FRONT, GPU_STENCIL_NONE),
    VOLUMES(FRONT, "front", LIGHT_SHADER, GPU_DEPTH_TEST, GPU_CULL_BACK, GPU_STENCIL_NONE),
    VOLUMES(MARK, "mark", NULL, GPU_DEPTH_TEST, GPU_CULL_NONE, GPU_STENCIL_MARK),
    VOLUMES(SHADE, "shade", LIGHT_SHADER, GPU_DEPTH_NONE, GPU_CULL_FRONT, GPU_STENCIL_SHADE),
#undef LIGHT_SHADER
#undef VOLUMES
#undef VOLUME
    [PIPELINE_DEFERRED_RESOLVE] = {.label = "deferred resolve",
                                   .vertex = "fullscreen.vert",
                                   .fragment = "deferred_resolve.frag",
                                   .targets = {RESOURCE_HDR},
                                   .target_count = 1,
                                   .cull = GPU_CULL_NONE},
    [PIPELINE_TILED] = {.label = "tiled", .compute = "tiled.comp", .spec_mask = SPEC_TILED},
    [PIPELINE_CLUSTERED] = {.label = "clustered",
                            .compute = "clustered.comp",
                            .spec_mask = SPEC_LIGHTING | SPEC_READ_GBUFFER | SPEC_SHADE_LISTS},
    [PIPELINE_TILE_DEPTH] = {.label = "tile depth",
                             .compute = "tile_depth.comp",
                             .spec_mask = SPEC_BIT(SPEC_TILE_SHIFT)},
    [PIPELINE_TILE_DEPTH_MS] = {.label = "tile depth of samples",
                                .compute = "tile_depth_ms.comp",
                                .spec_mask = SPEC_BIT(SPEC_TILE_SHIFT) | SPEC_BIT(SPEC_SAMPLES)},
    [PIPELINE_LIST_REFINE] = {.label = "list refine",
                              .compute = "list_refine.comp",
                              .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_LIST_COUNT] = {.label = "list count",
                             .compute = "list_count.comp",
                             .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_LIST_SCAN] = {.label = "list scan",
                            .compute = "list_scan.comp",
                            .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_LIST_FILL] = {.label = "list fill",
                            .compute = "list_fill.comp",
                            .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_CLUSTER_KEYS] = {.label = "cluster keys",
                               .compute = "cluster_keys.comp",
                               .spec_mask = SPEC_MAKE_LISTS | SPEC_READ_GBUFFER},
    [PIPELINE_CLUSTER_KEYS_MS] = {.label = "cluster keys of samples",
                                  .compute = "cluster_keys_ms.comp",
                                  .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_CLUSTER_SCAN] = {.label = "cluster scan",
                               .compute = "cluster_scan.comp",
                               .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_CLUSTER_PLACES] = {.label = "cluster places",
                                 .compute = "cluster_places.comp",
                                 .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_CLUSTER_COUNT] = {.label = "cluster count",
                                .compute = "cluster_count.comp",
                                .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_CLUSTER_FILL] = {.label = "cluster fill",
                               .compute = "cluster_fill.comp",
                               .spec_mask = SPEC_MAKE_LISTS},
    [PIPELINE_SKY] = {.label = "sky",
                      .vertex = "fullscreen.vert",
                      .fragment = "sky.frag",
                      .targets = {RESOURCE_HDR},
                      .target_count = 1,
                      .has_depth = true,
                      .may_be_ms = true,
                      .depth = GPU_DEPTH_TEST,
                      .cull = GPU_CULL_NONE},
    [PIPELINE_EMISSIVE] = {.label = "emissive",
                           .vertex = "geometry.vert",
                           .fragment = "emissive.frag",
                           .targets = {RESOURCE_HDR},
                           .target_count = 1,
                           .has_depth = true,
                           .may_be_ms = true,
                           .depth = GPU_DEPTH_TEST,
                           .blend = GPU_BLEND_ADD,
                           .vertex_layout = GPU_VERTEX_MESH,
                           .spec_mask =
                               SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES) | SPEC_PALETTE},
    [PIPELINE_FOG] = {.label = "fog",
                      .vertex = "fullscreen.vert",
                      .fragment = "post_fog.frag",
                      .targets = {RESOURCE_HDR},
                      .target_count = 1,
                      .cull = GPU_CULL_NONE,
                      .blend = GPU_BLEND_ALPHA,
                      .spec_mask = SPEC_BIT(SPEC_POST)},
    [PIPELINE_HEAT] = {.label = "heat",
                       .vertex = "fullscreen.vert",
                       .fragment = "post_heat.frag",
                       .targets = {RESOURCE_HDR},
                       .target_count = 1,
                       .cull = GPU_CULL_NONE},
    [PIPELINE_POST_COPY] = {.label = "post copy",
                            .vertex = "fullscreen.vert",
                            .fragment = "post_copy.frag",
                            .targets = {RESOURCE_HDR_OTHER},
                            .target_count = 1,
                            .cull = GPU_CULL_NONE},
    [PIPELINE_SPLIT_COPY] = {.label = "split copy",
                             .vertex = "fullscreen.vert",
                             .fragment = "split_copy.frag",
                             .targets = {RESOURCE_HDR_OTHER},
                             .target_count = 1,
                             .cull = GPU_CULL_NONE},
    [PIPELINE_SPLIT] = {.label = "split",
                        .vertex = "fullscreen.vert",
                        .fragment = "split.frag",
                        .targets = {RESOURCE_LDR},
                        .target_count = 1,
                        .cull = GPU_CULL_NONE,
                        .spec_mask = SPEC_BIT(SPEC_POST)},
    [PIPELINE_OVERDRAW] = {.label = "overdraw",
                           .vertex = "geometry.vert",
                           .fragment = "overdraw.frag",
                           .targets = {RESOURCE_HDR},
                           .target_count = 1,
                           .has_depth = true,
                           .depth = GPU_DEPTH_WRITE,
                           .blend = GPU_BLEND_ADD,
                           .vertex_layout = GPU_VERTEX_MESH,
                           .spec_mask = SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES)},
    [PIPELINE_LAYERS] = {.label = "layers",
                         .vertex = "geometry.vert",
                         .fragment = "overdraw.frag",
                         .targets = {RESOURCE_HDR},
                         .target_count = 1,
                         .blend = GPU_BLEND_ADD,
                         .vertex_layout = GPU_VERTEX_MESH,
                         .spec_mask = SPEC_BIT(SPEC_ALPHA_MASK) | SPEC_BIT(SPEC_TEXTURES)},
    [PIPELINE_OVERDRAW_SHOW] = {.label = "overdraw heat",
                                .vertex = "fullscreen.vert",
                                .fragment = "overdraw_show.frag",
                                .targets = {RESOURCE_LDR},
                                .target_count = 1,
                                .cull = GPU_CULL_NONE},
    [PIPELINE_LINES] = {.label = "lines",
                        .vertex = "overlay.vert",
                        .fragment = "lines.frag",
                        .targets = {RESOURCE_LDR},
                        .target_count = 1,
                        .cull = GPU_CULL_NONE,
                        .blend = GPU_BLEND_ALPHA,
                        .vertex_layout = GPU_VERTEX_UI},
    [PIPELINE_TONEMAP] = {.label = "tonemap",
                          .vertex = "fullscreen.vert",
                          .fragment = "tonemap.frag",
                          .targets = {RESOURCE_LDR},
                          .target_count = 1,
                          .cull = GPU_CULL_NONE,
                          .spec_mask = SPEC_BIT(SPEC_TONEMAP) | SPEC_BIT(SPEC_POST)},
    [PIPELINE_DEBUG] = {.label = "debug",
                        .vertex = "fullscreen.vert",
                        .fragment = "debug.frag",
                        .targets = {RESOURCE_LDR},
                        .target_count = 1,
                        .cull = GPU_CULL_NONE,
                        .spec_mask =
                            SPEC_BIT(SPEC_DEBUG_VIEW) | SPEC_SHADE_LISTS | SPEC_READ_GBUFFER},
    [PIPELINE_TEXT] = {.label = "text",
                       .vertex = "overlay.vert",
                       .fragment = "overlay.frag",
                       .targets = {RESOURCE_LDR},
                       .target_count = 1,
                       .cull = GPU_CULL_NONE,
                       .blend = GPU_BLEND_ALPHA,
                       .vertex_layout = GPU_VERTEX_UI},
    [PIPELINE_PRESENT] = {.label = "present",
                          .vertex = "fullscreen.vert",
                          .fragment = "present.frag",
                          .to_swapchain = true,
                          .cull = GPU_CULL_NONE},
    [PIPELINE_OVERLAY] = {.label = "overlay",
                          .vertex = "overlay.vert",
                          .fragment = "overlay.frag",
                          .to_swapchain = true,
                          .cull = GPU_CULL_NONE,
                          .blend = GPU_BLEND_ALPHA,
                          .vertex_layout = GPU_VERTEX_UI},
    [PIPELINE_GI_VOXELISE_RASTER] = {.label = "voxelise by drawing",
                                     .vertex = "gi_vox.vert",
                                     .fragment = "gi_vox.frag",
                                     .cull = GPU_CULL_NONE,
                                     .spec_mask = SPEC_VOXELISE},
    [PIPELINE_GI_VOXELISE_COMPUTE] = {.label = "voxelise by compute",
                                      .compute = "gi_vox.comp",
                                      .spec_mask = SPEC_VOXELISE},
    [PIPELINE_GI_SOLID] = {.label = "voxel insides",
                           .compute = "gi_solid.comp",
                           .spec_mask = SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_RANK] = {.label = "voxel ranks",
                          .compute = "gi_rank.comp",
                          .spec_mask = SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_LIST] = {.label = "voxel list", .compute = "gi_list.comp"},
    [PIPELINE_GI_BRICKS] = {.label = "voxel bricks",
                            .compute = "gi_bricks.comp",
                            .spec_mask = SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_RESOLVE] = {.label = "voxel resolve", .compute = "gi_resolve.comp"},
    [PIPELINE_GI_CLEAR] = {.label = "voxel clear",
                           .compute = "gi_clear.comp",
                           .spec_mask = SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_FILTER_BASE] = {.label = "voxel filter base",
                                 .compute = "gi_filter_base.comp",
                                 .compute_byte = "gi_filter_base_byte.comp",
                                 .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_FILTER_MIP] = {.label = "voxel filter mip",
                                .compute = "gi_filter_mip.comp",
                                .compute_byte = "gi_filter_mip_byte.comp",
                                .spec_mask = SPEC_GI_IMAGES},
    [PIPELINE_GI_FILTER_TAIL] = {.label = "voxel filter last mips",
                                 .compute = "gi_filter_tail.comp",
                                 .compute_byte = "gi_filter_tail_byte.comp",
                                 .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_FILTER_THIRDS] = {.label = "voxel filter between mips",
                                   .compute = "gi_filter_thirds.comp",
                                   .compute_byte = "gi_filter_thirds_byte.comp",
                                   .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_PROBES] = {.label = "probes",
                            .compute = "gi_probes.comp",
                            .spec_mask = SPEC_GI_IMAGES},
    [PIPELINE_GI_LIGHT] = {.label = "voxel light",
                           .compute = "gi_light.comp",
                           .compute_byte = "gi_light_byte.comp",
                           .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_ATTENUATION) |
                                        SPEC_BIT(SPEC_SHADOW) | SPEC_BIT(SPEC_DIRECTIONALS) |
                                        SPEC_BIT(SPEC_GI_COSINE) | SPEC_BIT(SPEC_GI_VISIBILITY) |
                                        SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_BOUNCE] = {.label = "voxel bounce",
                            .compute = "gi_bounce.comp",
                            .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_GI_STEP)},
    [PIPELINE_GI_IRRADIANCE] = {.label = "voxel irradiance",
                                .compute = "gi_irradiance.comp",
                                .spec_mask = SPEC_GI_IMAGES},
    [PIPELINE_GI_TRACED_LIGHTS] = {.label = "gi traced lights",
                                   .vertex = "surfaces.vert",
                                   .fragment = "gi_traced_lights.frag",
                                   .targets = {RESOURCE_HDR},
                                   .target_count = 1,
                                   .may_be_ms = true,
                                   .has_depth = true,
                                   .depth = GPU_DEPTH_BEHIND,
                                   .cull = GPU_CULL_NONE,
                                   .blend = GPU_BLEND_ADD,
                                   .spec_mask = SPEC_ONE_LIGHT | SPEC_READ_VOXELS |
                                                SPEC_BIT(SPEC_GI_TRACED)},
    [PIPELINE_GI_FORWARD_BLEND] = {.label = "gi forward blend",
                                   .vertex = "forward.vert",
                                   .fragment = "gi_forward.frag",
                                   .targets = {RESOURCE_HDR},
                                   .target_count = 1,
                                   .has_depth = true,
                                   .may_be_ms = true,
                                   .depth = GPU_DEPTH_TEST,
                                   .blend = GPU_BLEND_ALPHA,
                                   .vertex_layout = GPU_VERTEX_MESH,
                                   .spec_mask = SPEC_LIGHTING | SPEC_LISTS |
                                                SPEC_BIT(SPEC_TEXTURES) | SPEC_GI_IMAGES |
                                                SPEC_BIT(SPEC_GI_DIFFUSE) |
                                                SPEC_BIT(SPEC_GI_TRACED)},
    [PIPELINE_GI_TRACE] = {.label = "gi trace",
                           .compute = "gi_trace.comp",
                           .spec_mask = SPEC_READ_VOXELS | SPEC_BIT(SPEC_GI_WAVES)},
    [PIPELINE_GI_SMOOTH] = {.label = "gi smooth",
                            .compute = "gi_smooth.comp",
                            .spec_mask = SPEC_READ_VOXELS},
    [PIPELINE_GI_COMPOSE] = {.label = "gi compose",
                             .compute = "gi_compose.comp",
                             .spec_mask = SPEC_READ_VOXELS},
    [PIPELINE_GI_TILED] = {.label = "tiled with gi",
                           .compute = "gi_tiled.comp",
                           .spec_mask = SPEC_TILED | SPEC_READ_VOXELS},
    [PIPELINE_GI_ALONE] = {.label = "gi of pixels alone",
                           .compute = "gi_alone.comp",
                           .spec_mask = SPEC_READ_VOXELS},
    [PIPELINE_GI_COMPOSE_MS] = {.label = "gi compose of samples",
                                .vertex = "surfaces.vert",
                                .fragment = "gi_compose_ms.frag",
                                .targets = {RESOURCE_HDR},
                                .target_count = 1,
                                .may_be_ms = true,
                                .has_depth = true,
                                .depth = GPU_DEPTH_BEHIND,
                                .cull = GPU_CULL_NONE,
                                .blend = GPU_BLEND_SCALE_ADD,
                                .spec_mask = SPEC_READ_VOXELS},
    [PIPELINE_GI_VIEW_VOXELS] = {.label = "gi view voxels",
                                 .vertex = "fullscreen.vert",
                                 .fragment = "gi_view_voxels.frag",
                                 .targets = {RESOURCE_LDR},
                                 .target_count = 1,
                                 .cull = GPU_CULL_NONE,
                                 .spec_mask = SPEC_GI_IMAGES | SPEC_BIT(SPEC_GI_STEP) |
                                              SPEC_BIT(SPEC_GI_VISIBILITY)},
    [PIPELINE_GI_VIEW_PROBES] = {.label = "gi view probes",
                                 .vertex = "fullscreen.vert",
                                 .fragment = "gi_view_probes.frag",
                                 .targets = {RESOURCE_LDR},
                                 .target_count = 1,
                                 .cull = GPU_CULL_NONE,
                                 .spec_mask = SPEC_READ_VOXELS},
    [PIPELINE_GI_VIEW_TRACE] = {.label = "gi view trace",
                                .vertex = "fullscreen.vert",
                                .fragment = "gi_view_trace.frag",
                                .targets = {RESOURCE_LDR},
                                .target_count = 1,
                                .cull = GPU_CULL_NONE,
                                .spec_mask = SPEC_READ_VOXELS | SPEC_BIT(SPEC_DEBUG_VIEW)},
};

static GpuPipeline pipeline_create(Renderer *renderer, const PipelineKey *key) {
    const PipelineRow *row = &rows[key->kind];
    bool is_gi_build = key->kind >= PIPELINE_FIRST_GI_BUILD && key->kind < PIPELINE_FIRST_GI_SCREEN;
    bool is_gi_screen = key->kind >= PIPELINE_FIRST_GI_SCREEN;
    GpuPipelineDesc desc = {
        .label = row->label,
        .vertex = row->vertex,
        .fragment = row->fragment,
        .compute =
            key->spec[SPEC_GI_FORMAT] && row->compute_byte ? row->compute_byte : row->compute,
        .layouts = {is_gi_build ? renderer->gi_build_layout : renderer->frame_layout,
                    renderer->material_layout, renderer->gi_screen_layout},
        .layout_count = is_gi_build || !is_gi_screen ? 2 : 3,
        .push_size = PUSH_SIZE,
        .spec_count = SPEC_COUNT,
        .target_count = row->to_swapchain ? 1 : row->target_count,
        .depth_format = key->depth_format,
        .depth = row->depth,
        .stencil = row->stencil,
        .samples = key->samples,
        .cull = key->double_sided ? GPU_CULL_NONE : row->cull,
        .blend = row->blend,
        .vertex_layout = row->vertex_layout,
        .depth_clamp = row->is_shadow,
    };
    if (row->needs_primitive_id && !gpu_info(renderer->gpu)->primitive_id) {
        LOG(RENDER_LIMIT, "\"%s\" needs primitive numbers in fragments, which this device lacks",
            row->label);
        return (GpuPipeline){0};
    }
    memcpy(desc.spec, key->spec, sizeof key->spec);
    const GpuFormat *gbuffer = layout_table[key->spec[SPEC_LAYOUT]].targets;
    while (row->to_gbuffer && desc.target_count < COUNT_OF(layout_table[0].targets) &&
           gbuffer[desc.target_count]) {
        desc.targets[desc.target_count] = gbuffer[desc.target_count];
        desc.target_count++;
    }
    for (u32 i = 0; i < row->target_count; i++) desc.targets[i] = resource_formats[row->targets[i]];
    if (row->to_swapchain) desc.targets[0] = GPU_FORMAT_SWAPCHAIN;
    renderer->stats.pipelines++;
    return gpu_create_pipeline(renderer->gpu, &desc);
}

// Lights of the longest list. Of lists made on the device it is not known here: at most all.
static u64 longest_list(const Packet *packet) {
    return device_lists_used(&packet->settings) ? packet->lights.count
                                                : packet->counts.cell_light_max;
}

// Of the 8 x 8 that a subgroup's cull is for.
u32 tiled_pixels_per_lane(const Renderer *renderer) {
    return CLAMP(64 / MAX(gpu_info(renderer->gpu)->subgroup_size, 1), 1, 8);
}

// Materials that each lane of a subgroup keeps. A level's, not a frame's: all that there are.
static u32 palette_lanes(const Renderer *renderer, const Packet *packet) {
    u32 lanes = MAX(gpu_info(renderer->gpu)->subgroup_size, 1);
    u32 count = (packet->materials.count + lanes - 1) / lanes;
    return gpu_info(renderer->gpu)->is_software && count <= PALETTE_LANES_CAP ? count : 0;
}

// LIST_KIND_* of a packet; `wanted` beside those. Only the tiled path cares about long lists.
static u32 list_kinds(const Packet *packet, PipelineKind kind, u32 wanted) {
    const FrameRecord *frame = &packet->frame;
    u32 kinds = wanted;
    if (longest_list(packet) > SURVIVORS_CAP) kinds |= LIST_KIND_LONG;
    if (frame->counts3[0] < frame->counts[0] || frame->counts3[1] < frame->counts[1])
        kinds |= LIST_KIND_DIFFUSE;
    if (kind != PIPELINE_TILED && kind != PIPELINE_GI_TILED) kinds &= ~(u32)LIST_KIND_LONG;
    if (!(packet->brdf_mask & BRDF_MASK_HIGHLIGHTS)) kinds &= ~(u32)LIST_KIND_DIFFUSE;
    return kinds;
}

GpuPipeline pipeline_get(Renderer *renderer, const Packet *packet, PipelineKind kind,
                         PipelineVariant variant) {
    u32 pixels_per_lane = tiled_pixels_per_lane(renderer);
    const RenderSettings *settings = &packet->settings;
    const GiParams *gi = &packet->gi.params;
    bool is_ms = rows[kind].may_be_ms && renderer->samples > 1;
    PipelineKey key = {.kind = kind,
                       .double_sided = variant.double_sided,
                       .depth_format = !rows[kind].has_depth           ? GPU_FORMAT_NONE
                                       : is_ms || rows[kind].is_shadow ? GPU_FORMAT_D32F
                                                                       : renderer->depth_format,
                       .samples = is_ms ? renderer->samples : 1};
    u32 spec[SPEC_COUNT] = {
        [SPEC_BRDF_MASK] = packet->brdf_mask,
        [SPEC_ATTENUATION] = packet->attenuation,
        [SPEC_SHADOW] = packet_screen_shadow(packet),
        [SPEC_ALPHA_MASK] = variant.alpha_mask,
        [SPEC_TEXTURES] = variant.textures,
        [SPEC_EXACT_POWER] = settings->specular == SPECULAR_EXACT,
        [SPEC_SPOTS] = packet->spots.count > 0,
        [SPEC_DEBUG_VIEW] = settings->view,
        [SPEC_SUBGROUP_CULL] = settings->subgroup_cull,
        [SPEC_LAYOUT] = layout_of(packet),
        [SPEC_TILE_SHIFT] = 3 + settings->tile_px,
        [SPEC_CLUSTERED] = !settings_clustered(settings)        ? 0
                           : settings->clusters == CLUSTERS_CPU ? 1
                                                                : 2,
        [SPEC_TILE_DEPTH] = settings_tiled(settings) ? settings->tile_depth : 0,
        [SPEC_DEVICE_LISTS] = device_lists_used(settings),
        [SPEC_ATTENUATION_LOOKUP] = settings->attenuation_lookup,
        [SPEC_NORMAL_LOOKUP] = settings->normal_lookup,
        [SPEC_PALETTE_TEXTURE] = settings->palette == PALETTE_TEXTURE,
        [SPEC_LIGHT_BRANCH] = settings->light_branch,
        // Forward paths have no normals before they shade.
        [SPEC_CLUSTER_NORMALS] =
            settings->cluster_normals && settings->path == PATH_CLUSTERED_DEFERRED,
        [SPEC_CELL_LISTS] = 1, // only blended surfaces ask: the tile lists are always there
        [SPEC_TONEMAP] = settings->tonemap,
        [SPEC_POST] = variant.post,
        [SPEC_SAMPLES] = renderer->samples,
        [SPEC_VERTEX_LIGHTING] = variant.vertex_lit,
        [SPEC_PIXELS_PER_LANE] = pixels_per_lane,
        [SPEC_TILED_GROUP] = 64 / pixels_per_lane,
        [SPEC_DIRECTIONALS] = packet->frame.counts[2],
        [SPEC_LIGHT_BLOCKS] = packet_fits_light_blocks(packet),
        [SPEC_PALETTE_LANES] = palette_lanes(renderer, packet),
        [SPEC_LIST_KINDS] = list_kinds(packet, kind, variant.list_kinds),
        [SPEC_GI_DIRECTIONS] = gi->filter == GI_FILTER_ISOTROPIC ? 1 : 6,
        [SPEC_GI_FACES] = gi->faces,
        [SPEC_GI_MIPS] = gi->mips == GI_MIPS_NEAREST ? GI_READ_NEAREST
                         : gi_makes_thirds(packet)   ? GI_READ_THIRDS
                                                     : GI_READ_LINEAR,
        [SPEC_GI_CASCADES] = gi->cascades,
        [SPEC_GI_DIFFUSE] = gi->diffuse,
        [SPEC_GI_FEATURES] = (gi->specular ? GI_FEATURE_SPECULAR : 0) |
                             (gi->ao ? GI_FEATURE_AO : 0) | (gi->dither ? GI_FEATURE_DITHER : 0),
        [SPEC_GI_COSINE] = gi->cosine,
        [SPEC_GI_STEP] = variant.post,
        [SPEC_GI_VISIBILITY] = renderer->gi.voxel_shadows,
        [SPEC_GI_FORMAT] = gi->format,
        [SPEC_GI_RESOLUTION] = gi->resolution,
        [SPEC_GI_TRACED] = renderer->gi.traced_shadows,
        [SPEC_GI_BRICKS] = gi_has_bricks(packet),
        [SPEC_GI_WAVES] = gi_traces_by_waves(renderer, packet),
    };
    if (kind == PIPELINE_FORWARD_BLEND || kind == PIPELINE_GI_FORWARD_BLEND) {
        // Blended surfaces lie before those that the device made its lists for.
        spec[SPEC_DEVICE_LISTS] = 0;
        spec[SPEC_CLUSTERED] = MIN(spec[SPEC_CLUSTERED], 1);
    }
    if (kind >= PIPELINE_FIRST_GI_BUILD && kind < PIPELINE_FIRST_GI_SCREEN) {
        spec[SPEC_DIRECTIONALS] = packet->directionals.count; // also those that the screen traces
        spec[SPEC_SHADOW] = packet->shadow_size_px > 0;
    }
    for (u32 i = 0; i < SPEC_COUNT; i++)
        key.spec[i] = rows[kind].spec_mask & SPEC_BIT(i) ? spec[i] : 0;
    for (u32 i = 0; i < renderer->pipeline_count; i++)
        if (memcmp(&renderer->pipelines[i].key, &key, sizeof key) == 0)
            return renderer->pipelines[i].pipeline;
    if (renderer->pipeline_count == PIPELINES_CAP) {
        // Only reachable by changing levels many times: start over.
        LOG(DEBUG_NOTE, "pipeline cache full (%u), emptied", PIPELINES_CAP);
        pipelines_destroy(renderer);
    }
    PipelineSlot *slot = &renderer->pipelines[renderer->pipeline_count++];
    slot->key = key;
    slot->pipeline = pipeline_create(renderer, &key);
    return slot->pipeline;
}

void pipelines_destroy(Renderer *renderer) {
    for (u32 i = 0; i < renderer->pipeline_count; i++)
        if (renderer->pipelines[i].pipeline.id)
            gpu_destroy_pipeline(renderer->gpu, renderer->pipelines[i].pipeline);
    renderer->pipeline_count = 0;
}
