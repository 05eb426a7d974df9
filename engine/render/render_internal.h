// render_internal.h: the renderer's state, private to engine/render/.
//
// Data: one set of targets (sized by the packet), one set of per-frame buffers (filled from the
// packet's sections), one bind group over all of them, a cache of pipelines, the level's meshes
// and textures. pass_table.c says what runs; passes.c how.
#ifndef LUZ_RENDER_INTERNAL_H
#define LUZ_RENDER_INTERNAL_H
#include "render.h"

// X(id, label, format, kind): targets of the internal resolution; SHADOW_MAP has its own size.
#define RENDER_RESOURCES(X)                                                                        \
    X(SHADOW_MAP, "shadow map", GPU_FORMAT_D32F)                                                   \
    X(GBUFFER_ALBEDO, "gbuffer albedo", GPU_FORMAT_RGBA8_SRGB)                                     \
    X(GBUFFER_NORMAL, "gbuffer normal", GPU_FORMAT_RG16)                                           \
    X(DEPTH, "depth", GPU_FORMAT_D32F)                                                             \
    X(HDR, "hdr", GPU_FORMAT_RGBA16F)                                                              \
    X(ACCUMULATION, "accumulation", GPU_FORMAT_RGBA32F)                                            \
    X(LDR, "ldr", GPU_FORMAT_RGBA8)
typedef enum RenderResource {
#define X(id, ...) RESOURCE_##id,
    RENDER_RESOURCES(X)
#undef X
        RESOURCE_COUNT
} RenderResource;
extern const GpuFormat resource_formats[RESOURCE_COUNT];

// Buffers filled from the packet each frame: X(id, section, element type, smallest count). The
// smallest count makes a buffer cover the uniform block that views it.
#define FRAME_BUFFERS(X)                                                                           \
    X(INSTANCES, instances, InstanceRecord, 1)                                                     \
    X(MATERIALS, materials, MaterialRecord, MATERIALS_CAP)                                         \
    X(DIRECTIONALS, directionals, DirectionalRecord, DIRECTIONALS_CAP)                             \
    X(LIGHTS, lights, LightRecord, 2 * LIGHT_BLOCK_CAP)                                            \
    X(SPOTS, spots, SpotRecord, SPOT_BLOCK_CAP)                                                    \
    X(TILES, tiles, TileRecord, 1)                                                                 \
    X(LIGHT_INDICES, light_indices, u32, 1)
typedef enum FrameBuffer {
    FRAME_BUFFER_FRAME, // the FrameRecord itself
#define X(id, ...) FRAME_BUFFER_##id,
    FRAME_BUFFERS(X)
#undef X
        FRAME_BUFFER_COUNT
} FrameBuffer;

// --- Pipelines (pipelines.c) ---

typedef enum PipelineKind {
    PIPELINE_SHADOW,
    PIPELINE_SHADOW_MASK,
    PIPELINE_GBUFFER,
    PIPELINE_FORWARD,
    PIPELINE_FORWARD_BLEND,
    PIPELINE_DEFERRED_BASE,
    PIPELINE_DEFERRED_POINTS,
    PIPELINE_DEFERRED_SPOTS,
    PIPELINE_DEFERRED_RESOLVE,
    PIPELINE_TILED,
    PIPELINE_SKY,
    PIPELINE_EMISSIVE,
    PIPELINE_TONEMAP,
    PIPELINE_DEBUG,
    PIPELINE_TEXT,
    PIPELINE_PRESENT,
    PIPELINE_OVERLAY,
    PIPELINE_COUNT
} PipelineKind;
typedef struct PipelineKey {
    u32 kind, double_sided;
    u32 spec[SPEC_COUNT];
} PipelineKey;
#define PIPELINES_CAP 256
typedef struct PipelineSlot {
    PipelineKey key;
    GpuPipeline pipeline;
} PipelineSlot;

// --- Passes (pass_table.c, passes.c) ---

typedef struct Renderer Renderer;
typedef struct PassContext {
    Renderer *renderer;
    GpuCommands *cmd;
    const Packet *packet;
    const Overlay *overlay; // window only
} PassContext;
typedef struct ResourceUse {
    RenderResource resource;
    GpuUsage usage;
    bool discard; // old contents are not needed
} ResourceUse;
#define PASS_USES_CAP 6
typedef struct Pass {
    const char *name;
    ResourceUse uses[PASS_USES_CAP];
    u32 use_count;
    void (*record)(const PassContext *context);
    bool (*needed)(const PassContext *context); // NULL = always
} Pass;
#define PATH_PASSES_CAP 12
typedef struct PathRow {
    const char *name;
    const Pass *passes[PATH_PASSES_CAP]; // ends with NULL
} PathRow;
extern const PathRow path_table[PATH_COUNT];
extern const PathRow debug_path; // any picture but VIEW_FINAL
extern const Pass present_pass;  // after any path, when drawing to the window

// --- Assets on the device (render_assets.c) ---

typedef struct GpuMesh {
    MeshLod lods[MESH_LODS_CAP]; // first_index in the buffer of all meshes
    u32 lod_count;
    i32 vertex_offset;
} GpuMesh;
typedef struct MaterialGroup {
    u32 albedo, normal, emissive; // texture ids
    GpuBindGroup group;
} MaterialGroup;

struct Renderer {
    Gpu *gpu;
    Arena arena; // level lifetime: mesh and texture tables

    GpuBindLayout frame_layout, material_layout;
    GpuSampler sampler_nearest, sampler_linear, sampler_repeat, sampler_shadow;

    // Targets.
    u32 width_px, height_px, shadow_size_px;
    GpuTexture targets[RESOURCE_COUNT];
    GpuUsage usage[RESOURCE_COUNT]; // what the newest recorded pass did with it
    GpuBuffer readback;
    u64 shadow_key; // of the picture in the shadow map; 0 = none

    // Per-frame buffers and the group over everything.
    GpuBuffer buffers[FRAME_BUFFER_COUNT];
    GpuBindGroup frame_group;
    bool frame_group_stale;

    // Level.
    u64 assets_stamp;
    GpuBuffer vertices, indices;
    GpuMesh *meshes;
    GpuTexture *textures;
    u32 mesh_count, texture_count;
    GpuTexture white, flat_normal, black; // 1x1 stand-ins
    MaterialGroup *material_groups;
    u32 material_group_count, material_group_cap;

    PipelineSlot pipelines[PIPELINES_CAP];
    u32 pipeline_count;

    // Text and UI.
    GpuTexture overlay_texture;
    GpuBuffer text_vertices, text_indices, ui_vertices, ui_indices;
    u32 text_quad_count;

    RendererStats stats;
};

// What of a material a pipeline is specialised for.
typedef struct PipelineVariant {
    bool alpha_mask, double_sided;
    u32 textures; // see SPEC_TEXTURES
} PipelineVariant;
// pipelines.c: from the cache or newly made. {0} if the device refuses (LOG).
GpuPipeline pipeline_get(Renderer *renderer, const Packet *packet, PipelineKind kind,
                         PipelineVariant variant);
#define PIPELINE_PLAIN ((PipelineVariant){0})
void pipelines_destroy(Renderer *renderer);

// render_assets.c
bool render_assets_create(Renderer *renderer); // stand-ins, samplers
void render_assets_destroy(Renderer *renderer);
void render_assets_unload(Renderer *renderer);
// The group of a material's textures, made on first use.
GpuBindGroup render_material_group(Renderer *renderer, const PacketMaterial *material);

// frame_upload.c: buffers and targets as large as the packet needs, then the copies.
bool frame_upload(Renderer *renderer, const Packet *packet);
void frame_upload_destroy(Renderer *renderer);

// overlay.c
void overlay_record(const PassContext *context, const Overlay *overlay);
void text_record(const PassContext *context);
bool text_upload(Renderer *renderer, const Packet *packet);
void overlay_destroy(Renderer *renderer);

// passes.c
void pass_run(const PassContext *context, const Pass *pass);
// Shortest spelling of drawing lists of the packet.
void draw_list(const PassContext *context, PipelineKind kind, PacketSection section,
               bool alpha_mask);

#endif
