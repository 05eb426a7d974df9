// render_internal.h: the renderer's state, private to engine/render/.
//
// Data: one set of targets (sized by the packet), one set of per-frame buffers (filled from the
// packet's sections), one bind group over all of them, a cache of pipelines, the level's meshes
// and textures. pass_table.c says what runs; passes.c how.
#ifndef LUZ_RENDER_INTERNAL_H
#define LUZ_RENDER_INTERNAL_H
#include "render.h"

// X(id, label, format): targets of the internal resolution; SHADOW_MAP has its own size. The
// G-buffer's formats are the layout's (layouts.c); DEPTH gets a stencil if the packet asks for one;
// the multisampled ones (_MS) are there once a packet wanted them. From RESOURCE_FIRST_BUFFER on:
// buffers that the device fills (passes_lists.c).
#define RENDER_RESOURCES(X)                                                                        \
    X(SHADOW_MAP, "shadow map", GPU_FORMAT_D32F)                                                   \
    X(GBUFFER_0, "gbuffer 0", GPU_FORMAT_NONE)                                                     \
    X(GBUFFER_1, "gbuffer 1", GPU_FORMAT_NONE)                                                     \
    X(GBUFFER_2, "gbuffer 2", GPU_FORMAT_NONE)                                                     \
    X(GBUFFER_3, "gbuffer 3", GPU_FORMAT_NONE)                                                     \
    X(GBUFFER_4, "gbuffer 4", GPU_FORMAT_NONE)                                                     \
    X(DEPTH, "depth", GPU_FORMAT_D32F)                                                             \
    X(DEPTH_MS, "depth ms", GPU_FORMAT_D32F)                                                       \
    X(HDR_MS, "hdr ms", GPU_FORMAT_RGBA16F)                                                        \
    X(HDR, "hdr", GPU_FORMAT_RGBA16F)                                                              \
    X(HDR_OTHER, "hdr other", GPU_FORMAT_RGBA16F)                                                  \
    X(ACCUMULATION, "accumulation", GPU_FORMAT_RGBA32F)                                            \
    X(LDR, "ldr", GPU_FORMAT_RGBA8)                                                                \
    X(LDR_OTHER, "ldr other", GPU_FORMAT_RGBA8)                                                    \
    X(GI_BASE, "gi base", GPU_FORMAT_NONE)                                                         \
    X(GI_ATLAS, "gi atlas", GPU_FORMAT_NONE)                                                       \
    X(GI_IRRADIANCE, "gi irradiance", GPU_FORMAT_RGBA16F)                                          \
    X(GI_VISIBILITY, "gi visibility", GPU_FORMAT_R8)                                               \
    X(GI_PROBES, "gi probes", GPU_FORMAT_RGBA16F)                                                  \
    X(GI_BRICKS, "gi bricks", GPU_FORMAT_RGBA8)                                                    \
    X(GI_TRACE_0, "gi trace 0", GPU_FORMAT_RGBA16F)                                                \
    X(GI_TRACE_1, "gi trace 1", GPU_FORMAT_RGBA16F)                                                \
    X(GI_TRACE_RAW, "gi trace raw", GPU_FORMAT_RGBA16F)                                            \
    X(LIST_CELLS, "list cells", GPU_FORMAT_NONE)                                                   \
    X(LIST_INDICES, "list indices", GPU_FORMAT_NONE)                                               \
    X(TILE_DEPTHS, "tile depths", GPU_FORMAT_NONE)                                                 \
    X(CLUSTERS, "clusters", GPU_FORMAT_NONE)                                                       \
    X(PIXEL_CLUSTERS, "pixel clusters", GPU_FORMAT_NONE)                                           \
    X(GRID_COUNTERS, "grid counters", GPU_FORMAT_NONE)                                             \
    X(GI_MASKS, "gi masks", GPU_FORMAT_NONE)                                                       \
    X(GI_RANKS, "gi ranks", GPU_FORMAT_NONE)                                                       \
    X(GI_VOXELS, "gi voxels", GPU_FORMAT_NONE)                                                     \
    X(GI_ATTRIBUTES, "gi attributes", GPU_FORMAT_NONE)                                             \
    X(GI_ACCUMULATORS, "gi accumulators", GPU_FORMAT_NONE)                                         \
    X(GI_RADIANCE, "gi radiance", GPU_FORMAT_NONE)                                                 \
    X(GI_RADIANCE_2, "gi radiance 2", GPU_FORMAT_NONE)                                             \
    X(GI_COUNTERS, "gi counters", GPU_FORMAT_NONE)                                                 \
    X(GI_ALONE, "gi alone", GPU_FORMAT_NONE)
typedef enum RenderResource {
#define X(id, ...) RESOURCE_##id,
    RENDER_RESOURCES(X)
#undef X
        RESOURCE_COUNT,
    RESOURCE_FIRST_GI = RESOURCE_GI_BASE, // volumes and traced pictures: sized by gi.c
    RESOURCE_FIRST_BUFFER = RESOURCE_LIST_CELLS,
    RESOURCE_FIRST_GI_BUFFER = RESOURCE_GI_MASKS // to the end
} RenderResource;
extern const char *const resource_labels[RESOURCE_COUNT];
extern const GpuFormat resource_formats[RESOURCE_COUNT];

// Buffers filled from the packet each frame: X(id, section, element type, smallest count). The
// smallest count makes a buffer cover the uniform block that views it.
#define FRAME_BUFFERS(X)                                                                           \
    X(INSTANCES, instances, InstanceRecord, 1)                                                     \
    X(MATERIALS, materials, MaterialRecord, MATERIALS_CAP)                                         \
    X(DIRECTIONALS, directionals, DirectionalRecord, DIRECTIONALS_CAP)                             \
    X(LIGHTS, lights, LightRecord, 1)                                                              \
    X(SPOTS, spots, SpotRecord, SPOT_BLOCK_CAP)                                                    \
    X(CELLS, cells, CellRecord, 1)                                                                 \
    X(LIGHT_INDICES, light_indices, u32, 1)                                                        \
    X(GRID_NODES, grid_nodes, GridNode, 1)                                                         \
    X(GI_INSTANCES, gi_instances, InstanceRecord, 1)                                               \
    X(GI_LIGHTS, gi_lights, GiLightRecord, GI_LIGHT_BLOCK_CAP)                                     \
    X(GI_LISTS, gi_lists, u32, 1)                                                                  \
    X(TRACED_LIGHTS, traced_lights, TracedLightRecord, GI_TRACED_CAP)
typedef enum FrameBuffer {
    FRAME_BUFFER_FRAME,        // the FrameRecord itself
    FRAME_BUFFER_LIGHT_BLOCKS, // positions of all lights, then colours, if the blocks hold them
    FRAME_BUFFER_GI,           // the GiRecord
#define X(id, ...) FRAME_BUFFER_##id,
    FRAME_BUFFERS(X)
#undef X
        FRAME_BUFFER_COUNT
} FrameBuffer;

// Do the uniform blocks of lights hold all of the packet's? If not, shaders read storage buffers.
static inline bool packet_fits_light_blocks(const Packet *packet) {
    return packet->lights.count <= LIGHT_BLOCK_CAP && packet->spots.count <= SPOT_BLOCK_CAP;
}

// --- Pipelines (pipelines.c) ---

typedef enum PipelineKind {
    PIPELINE_SHADOW,
    PIPELINE_SHADOW_MASK,
    PIPELINE_GBUFFER,
    PIPELINE_FORWARD,
    PIPELINE_FORWARD_BLEND,
    PIPELINE_PREPASS,
    PIPELINE_PREPASS_MASK,
    PIPELINE_FORWARD_LISTS, // after a depth pre-pass: the lights of the pixel's cell
    PIPELINE_MULTIPASS_BASE,
    PIPELINE_MULTIPASS_POINTS,
    PIPELINE_MULTIPASS_SPOTS,
    PIPELINE_DEFERRED_BASE,
    PIPELINE_DEFERRED_POINTS,
    PIPELINE_DEFERRED_SPOTS,
    PIPELINE_VOLUME_BACK_POINTS, // of each kind, spots come after points
    PIPELINE_VOLUME_BACK_SPOTS,
    PIPELINE_VOLUME_FRONT_POINTS,
    PIPELINE_VOLUME_FRONT_SPOTS,
    PIPELINE_VOLUME_MARK_POINTS,
    PIPELINE_VOLUME_MARK_SPOTS,
    PIPELINE_VOLUME_SHADE_POINTS,
    PIPELINE_VOLUME_SHADE_SPOTS,
    PIPELINE_DEFERRED_RESOLVE,
    PIPELINE_TILED,
    PIPELINE_CLUSTERED,
    PIPELINE_TILE_DEPTH,
    PIPELINE_TILE_DEPTH_MS, // of a multisampled depth buffer
    PIPELINE_LIST_REFINE,
    PIPELINE_LIST_COUNT,
    PIPELINE_LIST_SCAN,
    PIPELINE_LIST_FILL,
    PIPELINE_CLUSTER_KEYS,
    PIPELINE_CLUSTER_KEYS_MS,
    PIPELINE_CLUSTER_SCAN,
    PIPELINE_CLUSTER_PLACES,
    PIPELINE_CLUSTER_COUNT,
    PIPELINE_CLUSTER_FILL,
    PIPELINE_SKY,
    PIPELINE_EMISSIVE,
    PIPELINE_FOG,
    PIPELINE_HEAT,
    PIPELINE_POST_COPY,
    PIPELINE_TONEMAP,
    PIPELINE_DEBUG,
    PIPELINE_TEXT,
    PIPELINE_PRESENT,
    PIPELINE_OVERLAY,
    PIPELINE_OVERDRAW,
    PIPELINE_LAYERS,
    PIPELINE_OVERDRAW_SHOW,
    PIPELINE_LINES,
    PIPELINE_SPLIT_COPY,
    PIPELINE_SPLIT,
    // Global illumination; those that make the voxels come first and have a group of their own.
    PIPELINE_GI_VOXELISE_RASTER, // step: 0 marks voxels, 1 adds up what falls into them
    PIPELINE_GI_VOXELISE_COMPUTE,
    PIPELINE_GI_SOLID,
    PIPELINE_GI_RANK,    // step: of the scan that counts set bits
    PIPELINE_GI_LIST,    // places of the voxels by slot
    PIPELINE_GI_BRICKS,  // step: cells that need a brick of the base volume; bricks for them
    PIPELINE_GI_RESOLVE, // sums to attributes
    PIPELINE_GI_CLEAR,   // what dynamic voxels leave behind
    PIPELINE_GI_LIGHT,
    PIPELINE_GI_FILTER_BASE, // level 0 of the atlas
    PIPELINE_GI_FILTER_MIP,
    PIPELINE_GI_FILTER_TAIL,   // step: how many of the last mips
    PIPELINE_GI_FILTER_THIRDS, // between its levels; step: number of the finer one & 1
    PIPELINE_GI_BOUNCE,
    PIPELINE_GI_IRRADIANCE, // of voxels, for diffuse = voxels
    PIPELINE_GI_PROBES,
    PIPELINE_GI_TRACED_LIGHTS, // from here on: passes over the screen
    PIPELINE_GI_FORWARD_BLEND, // blended surfaces, where voxels light them
    PIPELINE_GI_TRACE,
    PIPELINE_GI_SMOOTH, // of dithered cones
    PIPELINE_GI_COMPOSE,
    PIPELINE_GI_TILED, // PIPELINE_TILED and it in one
    PIPELINE_GI_ALONE,
    PIPELINE_GI_COMPOSE_MS, // of several samples a pixel
    PIPELINE_GI_VIEW_VOXELS,
    PIPELINE_GI_VIEW_PROBES,
    PIPELINE_GI_VIEW_TRACE, // views of what was traced
    PIPELINE_COUNT,
    PIPELINE_FIRST_GI_BUILD = PIPELINE_GI_VOXELISE_RASTER,
    PIPELINE_FIRST_GI_SCREEN = PIPELINE_GI_TRACED_LIGHTS
} PipelineKind;
typedef struct PipelineKey {
    u32 kind, double_sided;
    u32 depth_format, samples;
    u32 spec[SPEC_COUNT];
} PipelineKey;
#define PIPELINES_CAP 1024
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
    const PacketPost *post; // step of the post chain that runs; NULL in other passes
    const SplitView *split; // of a split picture's last passes
} PassContext;
typedef struct ResourceUse {
    RenderResource resource;
    GpuUsage usage;
    bool discard; // old contents are not needed
} ResourceUse;
#define PASS_USES_CAP 24
typedef struct Pass {
    const char *name;
    ResourceUse uses[PASS_USES_CAP];
    u32 use_count;
    void (*record)(const PassContext *context);
    bool (*needed)(const PassContext *context); // NULL = always
    // Instead of all that: runs other passes, as many as the packet asks for (the post chain).
    void (*expand)(const PassContext *context);
} Pass;
#define PATH_PASSES_CAP 48
typedef struct PathRow {
    const char *name;
    const Pass *passes[PATH_PASSES_CAP]; // ends with NULL
} PathRow;
extern const PathRow path_table[PATH_COUNT];
// What draws this packet: the path of its settings, or a debug view's own list.
const PathRow *path_of(const Packet *packet);
extern const Pass present_pass; // after any path, when drawing to the window

// --- G-buffer layouts (layouts.c) ---

typedef struct LayoutRow {
    const char *name;
    GpuFormat targets[5];      // GPU_FORMAT_NONE = not there
    u32 position_normal_bytes; // a pixel, of what tells position and normal (without the depth
                               // buffer)
    const char *loses;         // what this layout cannot tell exactly
} LayoutRow;
extern const LayoutRow layout_table[LAYOUT_COUNT];
u32 layout_bytes(const LayoutRow *row); // a pixel, all targets, without the depth buffer
// Of this packet's G-buffer: the settings', but lean where it is drawn for GI alone.
GbufferLayout layout_of(const Packet *packet);

// --- Assets on the device (render_assets.c) ---

typedef struct GpuMesh {
    MeshLod lods[MESH_LODS_CAP]; // first_index in the buffer of all meshes
    u32 lod_count;
    i32 vertex_offset;
    f32 longest_edge; // of its triangles, mesh space
    bool is_closed;   // and its triangles look outwards: it has an inside
} GpuMesh;
typedef struct MaterialGroup {
    u32 albedo, normal, emissive; // texture ids
    GpuBindGroup group;
} MaterialGroup;

// --- Texts in the picture (overlay.c) ---

typedef enum TextLayer {
    TEXT_PACKET,  // the packet's own
    TEXT_LEGEND,  // of a debug view, over its lines
    TEXT_CAPTION, // of a split picture
    TEXT_LAYER_COUNT
} TextLayer;
// A line that the renderer itself adds.
typedef struct Note {
    TextLayer layer;
    f32 x_px, y_px, size_px;
    u32 color; // RGBA8 sRGB, red in the low byte
    char text[96];
} Note;
#define NOTES_CAP 64

// The voxels and what was made of them (gi.c). Contents hang on keys of the packet: see PacketGi.
#define GI_ATLAS_LEVELS_CAP 10
#define GI_TEXTURES         (RESOURCE_FIRST_BUFFER - RESOURCE_FIRST_GI)
#define GI_BUFFERS          (RESOURCE_COUNT - RESOURCE_FIRST_GI_BUFFER)
typedef struct GiState {
    GpuBindGroup build_groups[GI_ATLAS_LEVELS_CAP]; // by level: its mip source is the level before
    GpuBindGroup screen_group;
    u32 bindings_version; // of the bindings in the groups
    // Shape of the volumes that are there.
    u32 dims[4], format, faces, filter, solid, atlas[4]; // dims, atlas: as in GiRecord
    u32 slot_cap;                                        // slots that the buffers by slot hold
    u32 brick_cap;                                       // bricks that the base volume holds
    bool is_guessed, has_bricks; // slot_cap: nothing was counted yet; the base volume is in bricks
    u32 sizes[GI_TEXTURES][4];   // width, height, depth, mips of each texture
    // What they hold: keys of the packet that they were made from, 0 = nothing.
    u64 static_key, dynamic_key, light_key, probe_key;
    u32 dynamic_tick; // of the packet whose dynamic instances were voxelised last
    // Probes: whose turn it is (is_cold: everybody's), frames until all had theirs.
    u32 probe_turn, probe_turns_left;
    u32 feedback_left; // frames in which feedback goes on without a change
    bool has_dynamic;  // dynamic voxels are in the masks
    bool has_lit;      // the volumes were lit since they are there
    bool is_warm;      // every pass has run
    // What this packet asks for, decided once (gi_begin): see the passes' needed functions.
    bool is_on, is_cold; // is_cold: nothing that is spread over frames may be left over
    bool is_fresh;       // nothing was ever written to the volumes
    bool voxelise_static, voxelise_dynamic, relight, trace_probes;
    u32 voxel_shadows, traced_shadows; // bits: SPEC_GI_VISIBILITY, SPEC_GI_TRACED
} GiState;
// What frames report of the voxels: GI_COUNTER_COUNT counters a slot of a frame in flight.
typedef struct GiReports {
    GpuBuffer buffer;
    bool reported[GPU_FRAMES_IN_FLIGHT_MAX][2]; // by slot and frame set
    u32 counters[GI_COUNTER_COUNT];             // of the newest
} GiReports;

// What belongs to one packet of a frame. A split frame draws two packets in one submit: the
// renderer's own fields are those of the one in use, and the other's are parked here
// (frame_sets_exchange). All other targets and buffers serve both, one after the other.
typedef struct FrameSet {
    GpuBuffer buffers[FRAME_BUFFER_COUNT];
    GpuBindGroup frame_group, mesh_group;
    u32 frame_group_version;
    u32 layout, gbuffer_width_px, gbuffer_height_px;
    GpuFormat depth_format;
    GpuTexture gbuffer[6]; // and DEPTH, which comes after them
    GpuUsage gbuffer_usage[6];
    GpuBuffer text_vertices, text_indices, line_vertices;
    u32 text_ends[TEXT_LAYER_COUNT], line_vertex_count;
    GiState gi;
    GpuTexture gi_textures[GI_TEXTURES];
    GpuBuffer gi_buffers[GI_BUFFERS];
    GpuUsage gi_texture_usage[GI_TEXTURES], gi_buffer_usage[GI_BUFFERS];
} FrameSet;

// Light lists that the device makes (passes_lists.c): how large the buffers shall be, and what
// frames report. A split frame has two packets, hence two reports a slot.
#define LIST_REPORTS_CAP (GPU_FRAMES_IN_FLIGHT_MAX * 2)
typedef struct DeviceLists {
    u32 index_cap, index_limit; // list entries; limit 0 = what the device allows
    u32 cluster_cap, cluster_limit;
    GpuBuffer reports;                // GRID_COUNTER_COUNT counters each
    bool reported[LIST_REPORTS_CAP];  // is on the way, or there and not read
    u32 counters[GRID_COUNTER_COUNT]; // of the newest report
} DeviceLists;

struct Renderer {
    Gpu *gpu;
    Arena arena; // level lifetime: mesh and texture tables

    GpuBindLayout frame_layout, material_layout;
    GpuSampler sampler_nearest, sampler_linear, sampler_repeat, sampler_shadow;

    // Targets.
    u32 width_px, height_px, shadow_size_px;
    u32 layout;                               // GbufferLayout of the G-buffer's targets, which
    u32 gbuffer_width_px, gbuffer_height_px;  // have their own size: see FrameSet
    GpuTexture targets[RESOURCE_COUNT];       // of textures
    GpuBuffer device_buffers[RESOURCE_COUNT]; // of buffers
    GpuUsage usage[RESOURCE_COUNT];           // what the newest recorded pass did with it
    GpuBuffer readback;
    u64 shadow_key;                // of the picture in the shadow map; 0 = none
    GpuFormat depth_format;        // of DEPTH
    u32 samples;                   // a pixel, of this packet: 1, or 4 with the _MS targets
    u32 ms_width_px, ms_height_px; // of the _MS targets; 1 x 1 stand-ins at first
    bool is_warming_up;            // all variants of what is drawn run, the picture is nobody's
    RenderProgress progress;       // asked before each pass while warming up; NULL = nobody
    void *progress_user;
    u32 progress_done, progress_total;
    GpuBuffer volume_vertices, volume_indices; // volumes.c: sphere, then cone

    // Per-frame buffers and the group over everything.
    GpuBuffer buffers[FRAME_BUFFER_COUNT];
    GpuBindGroup frame_group, mesh_group; // mesh_group: without the targets (frame_upload.c)
    bool frame_group_stale;               // a bound resource was made anew
    u32 bindings_version;                 // counts how often that was so
    u32 frame_group_version;              // of the bindings in both groups
    FrameSet parked;                      // of the other packet of a split frame
    u32 frame_set; // which is in use: 0, or 1 while the other packet is drawn

    // Level.
    u64 assets_stamp;
    GpuBuffer vertices, indices;
    GpuMesh *meshes;
    GpuTexture *textures;
    u32 mesh_count, texture_count;
    GpuTexture white, flat_normal, black;  // 1x1 stand-ins
    GpuTexture falloff, normal_z, palette; // look-ups (lookups.c), made when first asked for
    u64 falloff_key, palette_key;          // hash of what they hold
    MaterialGroup *material_groups;
    u32 material_group_count, material_group_cap;

    PipelineSlot pipelines[PIPELINES_CAP];
    u32 pipeline_count;

    // Text and UI.
    GpuTexture overlay_texture;
    GpuBuffer text_vertices, text_indices, ui_vertices, ui_indices;
    u32 text_ends[TEXT_LAYER_COUNT]; // in quads: a layer goes from the last one's end to its own
    Note notes[NOTES_CAP];           // for the next text_upload
    u32 note_count;
    f32 legend_left_px; // of debug views; a split picture's second legend stands right of the line
    GpuBuffer line_vertices; // of debug_draw.c
    u32 line_vertex_count;

    DeviceLists lists;
    GpuBindLayout gi_build_layout, gi_screen_layout;
    GpuSampler gi_sampler_linear, gi_sampler_nearest_mip;
    GiState gi;
    GiReports gi_reports;
    RendererStats stats;
};

// What of a material a pipeline is specialised for.
typedef struct PipelineVariant {
    bool alpha_mask, double_sided;
    u32 textures;   // see SPEC_TEXTURES
    u32 vertex_lit; // PacketDraw.vertex_lit
    u32 post;       // SPEC_POST
    u32 list_kinds; // SPEC_LIST_KINDS, beside what the packet needs
} PipelineVariant;
// pipelines.c: from the cache or newly made. {0} if the device refuses (LOG).
GpuPipeline pipeline_get(Renderer *renderer, const Packet *packet, PipelineKind kind,
                         PipelineVariant variant);
#define PIPELINE_PLAIN ((PipelineVariant){0})
void pipelines_destroy(Renderer *renderer);

// renderer.c: what a resource holds after the last frame, which is done: a texture's mips, tightly
// packed, or a buffer. Returns the bytes copied, at most `size`; 0 = not there.
u64 resource_read(Renderer *renderer, RenderResource id, void *out, u64 size);

// render_assets.c
bool render_assets_create(Renderer *renderer); // stand-ins, samplers
void render_assets_destroy(Renderer *renderer);
void render_assets_unload(Renderer *renderer);
// The group of a material's textures, made on first use.
GpuBindGroup render_material_group(Renderer *renderer, const PacketMaterial *material);

// frame_upload.c: buffers and targets as large as the packet needs, then the copies.
bool frame_upload(Renderer *renderer, const Packet *packet);
// The fields that belong to one packet change places with the parked ones; LDR and LDR_OTHER change
// places as well, so that the other packet draws its picture beside the first one's.
void frame_sets_exchange(Renderer *renderer);
void frame_upload_destroy(Renderer *renderer);

// overlay.c
void overlay_record(const PassContext *context, const Overlay *overlay);
void text_record(const PassContext *context, TextLayer layer);
// The packet's texts and the notes, which are used up.
bool text_upload(Renderer *renderer, const Packet *packet);
void note_add(Renderer *renderer, TextLayer layer, f32 x_px, f32 y_px, f32 size_px, u32 color,
              const char *format, ...) PRINTF_LIKE(7, 8);
// A dynamic vertex or index buffer of at least so many bytes.
bool overlay_buffer(Renderer *renderer, GpuBuffer *buffer, const char *label, u64 size,
                    bool vertex);
void overlay_destroy(Renderer *renderer);

f32 note_size(const Packet *packet); // px that suit the picture
f32 note_width(f32 size_px, const char *text);
#define NOTE_COLOR 0xFFF0F0F0u

// debug_views.c: lines, marks and legend of the packet's debug view, if it has any.
bool debug_view_upload(Renderer *renderer, const Packet *packet);
void debug_view_record(const PassContext *context);

// gi.c: volumes, buffers and groups as this packet wants them, and what is to be done in it.
bool gi_create(Renderer *renderer);
void gi_destroy(Renderer *renderer);
void gi_state_destroy(Renderer *renderer); // of the frame set in use
// Before the frame's bind group is made. Out of memory (LOG): the packet is drawn without GI.
void gi_begin(Renderer *renderer, const Packet *packet);
bool gi_update_groups(Renderer *renderer); // after it
// Counters of the frame that had this slot, which is done; true if the buffers by slot or the
// bricks were too few, or far too many: they fit in the next frame, which makes everything anew.
bool gi_read_reports(Renderer *renderer, u32 slot);
// Bytes of a buffer for so many voxels of all cascades and slots.
u64 gi_buffer_bytes(RenderResource buffer, u64 voxels, u32 slots, const GiParams *params);
// gi_bricks.c: is the base volume in bricks? How many are likely to do, and the image for so many.
#define GI_BRICK_DEPTH_MAX 2048 // texels that any device has room for along z of such an image
bool gi_has_bricks(const Packet *packet);
u32 gi_bricks_at_first(const u32 dims[4]);
void gi_brick_shape(u32 bricks, u32 out[4]); // width, height, depth, mips
// gi_voxelise.c: of the sums for a window of slots; groups that count the bits of a layer of the
// masks; bits of each number that a triangle adds to a sum of 32, if there are so many triangles.
u64 gi_accumulator_bytes(u64 voxels, u32 slots, bool solid);
u32 gi_rank_blocks(u64 voxels);
u32 gi_sum_bits(u64 triangles);
// gi_filter.c: groups that make the texels over all voxels.
u32 gi_parent_groups(const u32 dims[4]);
// gi_meshes.c: see GpuMesh.
f32 mesh_longest_edge(const Mesh *mesh);
bool mesh_is_closed(const Mesh *mesh);
// Does this packet have GI, and did gi_begin find room for it?
bool gi_is_on(const PassContext *c);
// Binds a pipeline that makes voxels with its groups; level: of the atlas, for the filter.
void gi_bind_build(const PassContext *c, GpuPipeline pipeline, u32 level);
// Binds a pipeline that reads voxels for the screen: the frame's group, and GI's as set 2.
void gi_bind_screen(const PassContext *c, GpuPipeline pipeline);
// One invocation a slot, as many as the device counted; args: GI_COUNTER_ALL_ARGS or _DYNAMIC_ARGS.
void gi_dispatch_slots(const PassContext *c, u32 args);
// Groups of 64 invocations, in y where x is full.
void gi_dispatch_words(const PassContext *c, u64 invocations);
// Does the picture ask for the irradiance of voxels?
bool gi_wants_irradiance(const Packet *packet);
bool gi_makes_thirds(const Packet *packet); // GI_READ_THIRDS
bool gi_traces_by_waves(const Renderer *renderer, const Packet *packet); // SPEC_GI_WAVES
// Makes what one dispatch of a pass wrote visible to the next; for resources in STORAGE_COMPUTE.
void gi_barrier(const PassContext *c, const RenderResource *resources, u32 count);
// Bytes of all that GI keeps on the device.
u64 gi_memory(const Renderer *renderer);

// lookups.c: the textures that this packet's settings ask for, holding what it needs.
bool lookups_update(Renderer *renderer, const Packet *packet);
void lookups_destroy(Renderer *renderer);

// volumes.c: meshes of light volumes.
bool volumes_create(Renderer *renderer);
void volumes_destroy(Renderer *renderer);

// device_lists.c: buffers that the device fills, as large as the packet needs.
bool device_lists_resize(Renderer *renderer, const Packet *packet);
// Counters of the frame that last used a frame slot, which must be done: buffers grow by them, and
// the stats tell them.
void device_lists_read(Renderer *renderer, u32 slot);
void device_lists_destroy(Renderer *renderer);
// Opaque surfaces are shaded by lists from LIST_CELLS: the packet's, narrowed by depths, or made
// anew for tiles or clusters.
bool device_lists_used(const RenderSettings *settings);
bool tile_lists_refined(const RenderSettings *settings);
bool tile_lists_made(const RenderSettings *settings);
bool cluster_lists_made(const RenderSettings *settings);
// The stats of this packet's lists, as far as they are known.
void device_lists_stats(Renderer *renderer, const Packet *packet);

// renderer.c: one packet's uploads and passes.
bool packet_draw(Renderer *renderer, GpuCommands *cmd, const Packet *packet);

// passes.c
void pass_run(const PassContext *context, const Pass *pass);
// Shortest spelling of drawing lists of the packet.
void draw_list(const PassContext *context, PipelineKind kind, PacketSection section,
               bool alpha_mask);
// The same with push constants of at most PUSH_SIZE bytes.
void draw_list_with(const PassContext *context, PipelineKind kind, PacketSection section,
                    bool alpha_mask, const void *push, u32 push_size);

#endif
