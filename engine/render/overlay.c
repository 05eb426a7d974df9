// overlay.c: text of the packet into the picture, triangles of a debug UI over the window.
//
// Data in: the packet's texts and characters; an Overlay. Data out: draws. Called by passes.c.
// Text is stb_easy_font's: quads without a texture, so no font file is needed.
#include "render_internal.h"
#include "../base/log.h"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wconversion"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define TEXT_QUADS_MAX   8192 // more is cut off; a screen of text has about 5,000
#define EASY_FONT_HEIGHT 12.0f

typedef struct EasyFontVertex {
    f32 x, y, z;
    u8 color[4];
} EasyFontVertex;

bool overlay_buffer(Renderer *renderer, GpuBuffer *buffer, const char *label, u64 size,
                    bool vertex) {
    if (buffer->id && gpu_buffer_size(renderer->gpu, *buffer) >= size) return true;
    if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
    u64 cap = 4096;
    while (cap < size) cap *= 2;
    *buffer = gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = label,
                                                                .kind = GPU_BUFFER_DYNAMIC,
                                                                .size = cap,
                                                                .vertex = vertex,
                                                                .index = !vertex});
    return buffer->id != 0;
}

typedef struct TextBuild {
    OverlayVertex *out;
    u32 quad_count;
} TextBuild;

// Characters as quads, twice: a dark copy one step down and right keeps them readable on bright
// pictures.
static void text_build_line(TextBuild *build, f32 x_px, f32 y_px, f32 size_px, u32 text_color,
                            const char *characters, u32 length) {
    static EasyFontVertex quads[TEXT_QUADS_MAX * 4];
    char line[1024];
    length = MIN(length, (u32)sizeof line - 1);
    // The font knows ASCII only; anything else (names from a level) shows as '?'.
    for (u32 k = 0; k < length; k++) {
        u8 c = (u8)characters[k];
        line[k] = (c >= 32 && c < 127) || c == '\n' ? (char)c : '?';
    }
    line[length] = 0;
    f32 scale = size_px / EASY_FONT_HEIGHT;
    u32 room = (TEXT_QUADS_MAX - build->quad_count) * 4 * (u32)sizeof(EasyFontVertex);
    u32 made = (u32)stb_easy_font_print(0, 0, line, NULL, quads, (int)room);
    for (u32 shadow = 0; shadow < 2; shadow++) {
        f32 shift = shadow == 0 ? MAX(scale, 1.0f) : 0.0f;
        u32 color = shadow == 0 ? 0xC0000000u : text_color;
        for (u32 q = 0; q < made && build->quad_count < TEXT_QUADS_MAX; q++, build->quad_count++)
            for (u32 v = 0; v < 4; v++)
                build->out[build->quad_count * 4 + v] =
                    (OverlayVertex){x_px + quads[q * 4 + v].x * scale + shift,
                                    y_px + quads[q * 4 + v].y * scale + shift, -1.0f, -1.0f, color};
    }
}

bool text_upload(Renderer *renderer, const Packet *packet) {
    memset(renderer->text_ends, 0, sizeof renderer->text_ends);
    u32 note_count = renderer->note_count;
    renderer->note_count = 0;
    if (packet->texts.count == 0 && note_count == 0) return true;
    if (!overlay_buffer(renderer, &renderer->text_vertices, "text vertices",
                        TEXT_QUADS_MAX * 4 * sizeof(OverlayVertex), true) ||
        !overlay_buffer(renderer, &renderer->text_indices, "text indices",
                        TEXT_QUADS_MAX * 6 * sizeof(u16), false))
        return false;
    TextBuild build = {.out = gpu_buffer_map(renderer->gpu, renderer->text_vertices)};
    u16 *indices = gpu_buffer_map(renderer->gpu, renderer->text_indices);
    const PacketText *texts = PACKET_DATA(packet, texts, PacketText);
    const char *characters = PACKET_DATA(packet, characters, char);
    for (u32 i = 0; i < packet->texts.count; i++)
        text_build_line(&build, texts[i].x_px, texts[i].y_px, texts[i].size_px, texts[i].color,
                        characters + texts[i].offset, texts[i].length);
    for (u32 layer = 0; layer < TEXT_LAYER_COUNT; layer++) {
        for (u32 i = 0; i < note_count; i++) {
            const Note *note = &renderer->notes[i];
            if (note->layer == layer)
                text_build_line(&build, note->x_px, note->y_px, note->size_px, note->color,
                                note->text, (u32)strlen(note->text));
        }
        renderer->text_ends[layer] = build.quad_count;
    }
    for (u32 q = 0; q < build.quad_count; q++) {
        static const u16 corners[6] = {0, 1, 2, 0, 2, 3};
        for (u32 k = 0; k < 6; k++) indices[q * 6 + k] = (u16)(q * 4 + corners[k]);
    }
    return true;
}

void note_add(Renderer *renderer, TextLayer layer, f32 x_px, f32 y_px, f32 size_px, u32 color,
              const char *format, ...) {
    if (renderer->note_count == NOTES_CAP) return;
    Note *note = &renderer->notes[renderer->note_count++];
    *note = (Note){layer, x_px, y_px, size_px, color, ""};
    va_list args;
    va_start(args, format);
    vsnprintf(note->text, sizeof note->text, format, args);
    va_end(args);
}

// Whole multiples of the font's grid, so that it stays sharp.
f32 note_size(const Packet *packet) {
    u32 times = MAX((packet->height_px + 180) / 540, 1);
    return EASY_FONT_HEIGHT * (f32)times;
}

f32 note_width(f32 size_px, const char *text) {
    char copy[sizeof((Note){0}).text];
    snprintf(copy, sizeof copy, "%s", text);
    return (f32)stb_easy_font_width(copy) * size_px / EASY_FONT_HEIGHT;
}

static void overlay_bind(const PassContext *c, PipelineKind kind, f32 width, f32 height,
                         GpuBuffer vertices, GpuBuffer indices) {
    gpu_cmd_bind_pipeline(c->cmd, pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN));
    gpu_cmd_bind_group(c->cmd, 0, c->renderer->frame_group);
    f32 push[4] = {1.0f / width, 1.0f / height, 0, 0};
    gpu_cmd_push(c->cmd, push, sizeof push);
    gpu_cmd_bind_vertices(c->cmd, 0, vertices, 0);
    gpu_cmd_bind_indices(c->cmd, indices, true);
}

void text_record(const PassContext *c, TextLayer layer) {
    Renderer *r = c->renderer;
    u32 first = layer == 0 ? 0 : r->text_ends[layer - 1], end = r->text_ends[layer];
    if (first == end) return;
    overlay_bind(c, PIPELINE_TEXT, (f32)c->packet->width_px, (f32)c->packet->height_px,
                 r->text_vertices, r->text_indices);
    gpu_cmd_draw_indexed(c->cmd, (end - first) * 6, 1, first * 6, 0, 0);
    r->stats.draw_calls++;
}

void overlay_record(const PassContext *c, const Overlay *overlay) {
    Renderer *r = c->renderer;
    if (overlay->command_count == 0) return;
    if (!overlay_buffer(r, &r->ui_vertices, "ui vertices",
                        overlay->vertex_count * sizeof(OverlayVertex), true) ||
        !overlay_buffer(r, &r->ui_indices, "ui indices", overlay->index_count * sizeof(u16), false))
        return;
    memcpy(gpu_buffer_map(r->gpu, r->ui_vertices), overlay->vertices,
           overlay->vertex_count * sizeof(OverlayVertex));
    memcpy(gpu_buffer_map(r->gpu, r->ui_indices), overlay->indices,
           overlay->index_count * sizeof(u16));
    u32 width, height;
    gpu_swapchain_size(r->gpu, &width, &height);
    overlay_bind(c, PIPELINE_OVERLAY, (f32)width, (f32)height, r->ui_vertices, r->ui_indices);
    for (u32 i = 0; i < overlay->command_count; i++) {
        const OverlayCommand *command = &overlay->commands[i];
        gpu_cmd_scissor(c->cmd, command->clip_x, command->clip_y, command->clip_width,
                        command->clip_height);
        gpu_cmd_draw_indexed(c->cmd, command->index_count, 1, command->first_index,
                             command->vertex_offset, 0);
        r->stats.draw_calls++;
    }
}

bool renderer_set_overlay_texture(Renderer *renderer, const u8 *rgba, u32 width, u32 height) {
    if (renderer->overlay_texture.id) gpu_destroy_texture(renderer->gpu, renderer->overlay_texture);
    renderer->overlay_texture =
        gpu_create_texture(renderer->gpu, &(GpuTextureDesc){.label = "overlay atlas",
                                                            .format = GPU_FORMAT_RGBA8,
                                                            .width = width,
                                                            .height = height,
                                                            .sampled = true});
    renderer->frame_group_stale = true;
    if (!renderer->overlay_texture.id) return false;
    gpu_upload_texture(renderer->gpu, renderer->overlay_texture, rgba, (u64)width * height * 4);
    return true;
}

void overlay_destroy(Renderer *renderer) {
    GpuBuffer buffers[] = {renderer->ui_vertices, renderer->ui_indices};
    for (u32 i = 0; i < COUNT_OF(buffers); i++)
        if (buffers[i].id) gpu_destroy_buffer(renderer->gpu, buffers[i]);
    if (renderer->overlay_texture.id) gpu_destroy_texture(renderer->gpu, renderer->overlay_texture);
}
