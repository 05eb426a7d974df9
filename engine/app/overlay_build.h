// overlay_build.h: draw lists of a UI become one Overlay: plain data in and out, no UI library.
#ifndef LUZ_OVERLAY_BUILD_H
#define LUZ_OVERLAY_BUILD_H
#include "../render/render.h"
#ifdef __cplusplus
extern "C" {
#endif

#define OVERLAY_VERTICES_CAP 65536
#define OVERLAY_INDICES_CAP  (3 * OVERLAY_VERTICES_CAP)
#define OVERLAY_COMMANDS_CAP 512

typedef struct OverlayBuild {
    OverlayVertex vertices[OVERLAY_VERTICES_CAP];
    u16 indices[OVERLAY_INDICES_CAP];
    OverlayCommand commands[OVERLAY_COMMANDS_CAP];
    Overlay overlay;
    u32 width_px, height_px;       // of the window
    u32 first_vertex, first_index; // of the current list
} OverlayBuild;

void overlay_build_begin(OverlayBuild *build, u32 width_px, u32 height_px);
// Vertices and indices that the following commands refer to; positions are multiplied by scale.
// False at a cap: the list is left out.
bool overlay_build_list(OverlayBuild *build, const OverlayVertex *vertices, u32 vertex_count,
                        const u16 *indices, u32 index_count, f32 scale);
// A command of the current list. The clip rectangle is min x, min y, max x, max y in window pixels
// and may reach beyond the window; what nobody could see is left out.
void overlay_build_command(OverlayBuild *build, const f32 clip[4], u32 vertex_offset,
                           u32 first_index, u32 index_count);
const Overlay *overlay_build_end(OverlayBuild *build);

#ifdef __cplusplus
}
#endif
#endif
