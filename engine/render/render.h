// render.h: a packet becomes an image. The renderer is a pure function of (loaded assets, packet):
// it never sees the world, and a replayed packet takes the same way as a played one.
//
// Use: renderer_create; renderer_set_assets after each level load; renderer_warm_up with a first
// packet, and one of each change of settings (compiles their pipelines, with progress); then per
// frame either renderer_draw inside gpu_frame_begin/end (window), or renderer_render_image
// (headless: draws, waits, reads back). One thread. Does not: decide what is visible or which
// lights matter (systems/ does).
#ifndef LUZ_RENDER_H
#define LUZ_RENDER_H
#include "../asset/asset.h"
#include "../frame/packet.h"
#include "../gpu/gpu.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct Renderer Renderer;

// done of total steps; `what` names the step.
typedef void (*RenderProgress)(void *user, u32 done, u32 total, const char *what);

Renderer *renderer_create(Gpu *gpu);
void renderer_destroy(Renderer *renderer);
// Uploads meshes, textures; nothing to do if the store's stamp is the one in use. False on out of
// memory (LOG): the renderer then draws without the missing ones.
bool renderer_set_assets(Renderer *renderer, const AssetStore *assets);
// Makes and runs every pipeline that this packet's level can need in the packet's path and view,
// also for what is out of sight, so that no later frame with these settings stalls (shaders compile
// at first use). A pass at a time; progress is called before each, inside an open frame, and may be
// NULL.
bool renderer_warm_up(Renderer *renderer, const Packet *packet, RenderProgress progress,
                      void *user);
// The same for what this very packet shows: what a single picture needs.
bool renderer_warm_up_path(Renderer *renderer, const Packet *packet);

// Triangles over the picture (debug UI): vertices of GPU_VERTEX_UI, in window pixels.
typedef struct OverlayVertex {
    f32 x, y, u, v;
    u32 color;
} OverlayVertex;
typedef struct OverlayCommand {
    u32 index_count, first_index;
    i32 vertex_offset;
    i32 clip_x, clip_y;
    u32 clip_width, clip_height;
} OverlayCommand;
typedef struct Overlay {
    const OverlayVertex *vertices;
    const u16 *indices;
    const OverlayCommand *commands;
    u32 vertex_count, index_count, command_count;
} Overlay;
// The overlay's atlas (RGBA8); call before the first overlay.
bool renderer_set_overlay_texture(Renderer *renderer, const u8 *rgba, u32 width, u32 height);

// Records the packet's passes. to_swapchain: scales the result to the window and draws the overlay
// (may be NULL) over it; else the image stays in the renderer for renderer_read_image.
bool renderer_draw(Renderer *renderer, GpuCommands *cmd, const Packet *packet, bool to_swapchain,
                   const Overlay *overlay);

// Two packets side by side: the same view, drawn in two ways.
typedef enum SplitMode {
    SPLIT_LINE,       // A left of the line, B right of it
    SPLIT_DIFFERENCE, // |A - B| times gain
    SPLIT_BOTH,       // A, the difference in a band about the line, B
    SPLIT_MODE_COUNT
} SplitMode;
#define SPLIT_MODE_WORDS "line difference both"
#define SPLIT_GAIN       16.0f // one step of 255 is visible
typedef struct SplitView {
    f32 at;                        // the line, 0..1 of the width
    u32 mode;                      // SplitMode
    f32 gain;                      // of the difference; 0 = SPLIT_GAIN
    const char *label_a, *label_b; // captions in the picture; NULL = none
} SplitView;
// As renderer_draw, with both packets in one submit. They must have the same size (else LOG USAGE,
// false); paths, layouts and all other settings may differ.
bool renderer_draw_split(Renderer *renderer, GpuCommands *cmd, const Packet *a, const Packet *b,
                         const SplitView *split, bool to_swapchain, const Overlay *overlay);

typedef struct RenderImage {
    u8 *rgba; // width * height * 4, sRGB encoded, rows from the top; in the arena given
    u32 width_px, height_px;
    u64 hash; // of size and pixels
} RenderImage;
// Begin, draw, wait, read back. out may be NULL (only draw and wait).
bool renderer_render_image(Renderer *renderer, const Packet *packet, Arena *arena,
                           RenderImage *out);
// The same for a split picture.
bool renderer_render_split(Renderer *renderer, const Packet *a, const Packet *b,
                           const SplitView *split, Arena *arena, RenderImage *out);
u64 render_image_hash(const u8 *rgba, u32 width_px, u32 height_px);

// What a G-buffer layout takes of each pixel, without the depth buffer that all of them have.
typedef struct RendererLayoutInfo {
    const char *name;
    u32 bytes;                 // all targets
    u32 position_normal_bytes; // what tells position and normal
} RendererLayoutInfo;
RendererLayoutInfo renderer_layout_info(GbufferLayout layout);

// Names of the passes of a path in order, for UIs. Times: gpu_timers of the newest finished frame.
u32 renderer_pass_names(RenderPath path, const char **out, u32 out_cap);

// Stats of the last drawn frame.
typedef struct RendererStats {
    u32 draw_calls, triangles, barriers, pipelines, shadow_redrawn;
    // Light lists of the opaque surfaces: entries asked for, cells that use all lights because
    // memory ran out, the longest list, occupied clusters (device lists only). Of lists made on
    // the device, what the newest finished frame reported.
    u32 list_indices, list_fallbacks, list_longest, clusters;
    // GI: how often each was done since the renderer was made; bytes on the device.
    u32 gi_static_voxelised, gi_dynamic_voxelised, gi_relit, gi_probes_traced;
    u32 gi_probes_refreshed;                          // probes traced by this frame
    u32 gi_voxels, gi_dynamic_voxels, gi_lost_voxels; // of the newest finished frame that counted
    u64 gi_bytes;
} RendererStats;
RendererStats renderer_stats(const Renderer *renderer);

// What the voxels keep on the device, by resource, in bytes as asked for: about
// RendererStats.gi_bytes.
typedef struct RendererGiPart {
    const char *name;
    u64 bytes;
} RendererGiPart;
u32 renderer_gi_parts(const Renderer *renderer, RendererGiPart *out, u32 out_cap);

// For tests: lists made on the device get at most this many entries (0 = what the device allows),
// and the buffers are made anew; cells that find no room use all lights.
void renderer_limit_lists(Renderer *renderer, u32 index_limit, u32 cluster_limit);
// For tests and tools: what the voxel volumes hold after the last frame, which is done. x, y, z
// count as in shaders/shared.h; 3D images come tightly packed, all mips.
typedef enum GiVolume {
    GI_VOLUME_MASKS,
    GI_VOLUME_RANKS,
    GI_VOLUME_VOXELS,
    GI_VOLUME_ATTRIBUTES,
    GI_VOLUME_RADIANCE,
    GI_VOLUME_RADIANCE_2, // faces apart: 3..5, the others lie in the one before
    GI_VOLUME_COUNTERS,
    GI_VOLUME_BASE,   // in bricks (settings gi.base), if it is
    GI_VOLUME_BRICKS, // the brick of each cell
    GI_VOLUME_ATLAS,
    GI_VOLUME_IRRADIANCE,
    GI_VOLUME_VISIBILITY,
    GI_VOLUME_PROBES,
    GI_VOLUME_DIFFUSE, // of traced pixels: indirect diffuse light without albedo, w ambient
                       // visibility
    GI_VOLUME_COUNT
} GiVolume;
// Returns the bytes copied, at most `size`; 0 = not there.
u64 renderer_read_gi(Renderer *renderer, GiVolume which, void *out, u64 size);
// For tests: what the device made in the last frame, which is done: CellRecord[], u32[],
// TileDepthRecord[], u32[], u32[], u32[]. Returns the bytes copied, at most `size`; 0 = not there.
typedef enum ListBuffer {
    LIST_BUFFER_CELLS,
    LIST_BUFFER_INDICES,
    LIST_BUFFER_TILE_DEPTHS,
    LIST_BUFFER_CLUSTERS,
    LIST_BUFFER_PIXEL_CLUSTERS,
    LIST_BUFFER_COUNTERS,
} ListBuffer;
u64 renderer_read_lists(Renderer *renderer, ListBuffer which, void *out, u64 size);

#ifdef __cplusplus
}
#endif
#endif
