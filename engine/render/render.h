// render.h: a packet becomes an image. The renderer is a pure function of (loaded assets, packet):
// it never sees the world, and a replayed packet takes the same way as a played one.
//
// Use: renderer_create; renderer_set_assets after each level load; renderer_warm_up with a first
// packet (compiles all pipelines, with progress); then per frame either renderer_draw inside
// gpu_frame_begin/end (window), or renderer_render_image (headless: draws, waits, reads back).
// One thread. Does not: decide what is visible or which lights matter (systems/ does).
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
// Makes and runs every pipeline that this packet's level can need, in all paths and views, so that
// no later frame stalls (shaders compile at first use). Progress may be NULL.
bool renderer_warm_up(Renderer *renderer, const Packet *packet, RenderProgress progress,
                      void *user);
// The same for the packet's own path and view only: what a single picture needs.
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

typedef struct RenderImage {
    u8 *rgba; // width * height * 4, sRGB encoded, rows from the top; in the arena given
    u32 width_px, height_px;
    u64 hash; // of size and pixels
} RenderImage;
// Begin, draw, wait, read back. out may be NULL (only draw and wait).
bool renderer_render_image(Renderer *renderer, const Packet *packet, Arena *arena,
                           RenderImage *out);
u64 render_image_hash(const u8 *rgba, u32 width_px, u32 height_px);

// Names of the passes of a path in order, for UIs. Times: gpu_timers of the newest finished frame.
u32 renderer_pass_names(RenderPath path, const char **out, u32 out_cap);

// Stats of the last drawn frame.
typedef struct RendererStats {
    u32 draw_calls, triangles, barriers, pipelines, shadow_redrawn;
} RendererStats;
RendererStats renderer_stats(const Renderer *renderer);

#ifdef __cplusplus
}
#endif
#endif
