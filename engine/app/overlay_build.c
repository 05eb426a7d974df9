// overlay_build.c: copies draw lists behind each other and cuts clip rectangles to the window.
//
// Data in: vertices, indices, commands of a UI library. Data out: an Overlay. Called by:
// debug_ui.cpp. Does not: draw.
#include "overlay_build.h"
#include <string.h>

void overlay_build_begin(OverlayBuild *build, u32 width_px, u32 height_px) {
    build->overlay = (Overlay){
        .vertices = build->vertices, .indices = build->indices, .commands = build->commands};
    build->width_px = width_px;
    build->height_px = height_px;
    build->first_vertex = build->first_index = 0;
}

bool overlay_build_list(OverlayBuild *build, const OverlayVertex *vertices, u32 vertex_count,
                        const u16 *indices, u32 index_count, f32 scale) {
    Overlay *overlay = &build->overlay;
    if (vertex_count > OVERLAY_VERTICES_CAP - overlay->vertex_count ||
        index_count > OVERLAY_INDICES_CAP - overlay->index_count)
        return false;
    build->first_vertex = overlay->vertex_count;
    build->first_index = overlay->index_count;
    memcpy(build->vertices + build->first_vertex, vertices, vertex_count * sizeof *vertices);
    memcpy(build->indices + build->first_index, indices, index_count * sizeof *indices);
    overlay->vertex_count += vertex_count;
    overlay->index_count += index_count;
    if (scale != 1.0f)
        for (u32 i = build->first_vertex; i < overlay->vertex_count; i++) {
            build->vertices[i].x *= scale;
            build->vertices[i].y *= scale;
        }
    return true;
}

void overlay_build_command(OverlayBuild *build, const f32 clip[4], u32 vertex_offset,
                           u32 first_index, u32 index_count) {
    Overlay *overlay = &build->overlay;
    if (index_count == 0 || overlay->command_count == OVERLAY_COMMANDS_CAP) return;
    // A scissor with a negative corner or beyond the target is an error to the device.
    i32 left = (i32)CLAMP(clip[0], 0.0f, (f32)build->width_px);
    i32 top = (i32)CLAMP(clip[1], 0.0f, (f32)build->height_px);
    i32 right = (i32)CLAMP(clip[2], 0.0f, (f32)build->width_px);
    i32 bottom = (i32)CLAMP(clip[3], 0.0f, (f32)build->height_px);
    if (right <= left || bottom <= top) return;
    build->commands[overlay->command_count++] =
        (OverlayCommand){.index_count = index_count,
                         .first_index = build->first_index + first_index,
                         .vertex_offset = (i32)(build->first_vertex + vertex_offset),
                         .clip_x = left,
                         .clip_y = top,
                         .clip_width = (u32)(right - left),
                         .clip_height = (u32)(bottom - top)};
}

const Overlay *overlay_build_end(OverlayBuild *build) { return &build->overlay; }
