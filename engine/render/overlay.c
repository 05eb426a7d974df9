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
#include <string.h>

#define TEXT_QUADS_MAX   8192 // more is cut off; a screen of text has about 5,000
#define EASY_FONT_HEIGHT 12.0f

typedef struct EasyFontVertex {
    f32 x, y, z;
    u8 color[4];
} EasyFontVertex;

static bool buffer_ensure(Renderer *renderer, GpuBuffer *buffer, const char *label, u64 size,
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

bool text_upload(Renderer *renderer, const Packet *packet) {
    renderer->text_quad_count = 0;
    if (packet->texts.count == 0) return true;
    if (!buffer_ensure(renderer, &renderer->text_vertices, "text vertices",
                       TEXT_QUADS_MAX * 4 * sizeof(OverlayVertex), true) ||
        !buffer_ensure(renderer, &renderer->text_indices, "text indices",
                       TEXT_QUADS_MAX * 6 * sizeof(u16), false))
        return false;
    OverlayVertex *out = gpu_buffer_map(renderer->gpu, renderer->text_vertices);
    u16 *indices = gpu_buffer_map(renderer->gpu, renderer->text_indices);
    const PacketText *texts = PACKET_DATA(packet, texts, PacketText);
    const u8 *characters = PACKET_DATA(packet, characters, u8);
    static EasyFontVertex quads[TEXT_QUADS_MAX * 4];
    u32 quad_count = 0;
    for (u32 i = 0; i < packet->texts.count; i++) {
        const PacketText *text = &texts[i];
        char line[1024];
        u32 length = MIN(text->length, (u32)sizeof line - 1);
        // The font knows ASCII only; anything else (names from a level) shows as '?'.
        for (u32 k = 0; k < length; k++) {
            u8 c = characters[text->offset + k];
            line[k] = (c >= 32 && c < 127) || c == '\n' ? (char)c : '?';
        }
        line[length] = 0;
        f32 scale = text->size_px / EASY_FONT_HEIGHT;
        u32 room = (TEXT_QUADS_MAX - quad_count) * 4 * (u32)sizeof(EasyFontVertex);
        u32 made = (u32)stb_easy_font_print(0, 0, line, NULL, quads, (int)room);
        // Twice: a dark copy one step down and right keeps it readable on bright pictures.
        for (u32 shadow = 0; shadow < 2; shadow++) {
            f32 shift = shadow == 0 ? MAX(scale, 1.0f) : 0.0f;
            u32 color = shadow == 0 ? 0xC0000000u : text->color;
            for (u32 q = 0; q < made && quad_count < TEXT_QUADS_MAX; q++, quad_count++)
                for (u32 v = 0; v < 4; v++)
                    out[quad_count * 4 + v] = (OverlayVertex){
                        text->x_px + quads[q * 4 + v].x * scale + shift,
                        text->y_px + quads[q * 4 + v].y * scale + shift, -1.0f, -1.0f, color};
        }
    }
    for (u32 q = 0; q < quad_count; q++) {
        static const u16 corners[6] = {0, 1, 2, 0, 2, 3};
        for (u32 k = 0; k < 6; k++) indices[q * 6 + k] = (u16)(q * 4 + corners[k]);
    }
    renderer->text_quad_count = quad_count;
    return true;
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

void text_record(const PassContext *c) {
    Renderer *r = c->renderer;
    if (r->text_quad_count == 0) return;
    overlay_bind(c, PIPELINE_TEXT, (f32)c->packet->width_px, (f32)c->packet->height_px,
                 r->text_vertices, r->text_indices);
    gpu_cmd_draw_indexed(c->cmd, r->text_quad_count * 6, 1, 0, 0, 0);
    r->stats.draw_calls++;
}

void overlay_record(const PassContext *c, const Overlay *overlay) {
    Renderer *r = c->renderer;
    if (overlay->command_count == 0) return;
    if (!buffer_ensure(r, &r->ui_vertices, "ui vertices",
                       overlay->vertex_count * sizeof(OverlayVertex), true) ||
        !buffer_ensure(r, &r->ui_indices, "ui indices", overlay->index_count * sizeof(u16), false))
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
    GpuBuffer buffers[] = {renderer->text_vertices, renderer->text_indices, renderer->ui_vertices,
                           renderer->ui_indices};
    for (u32 i = 0; i < COUNT_OF(buffers); i++)
        if (buffers[i].id) gpu_destroy_buffer(renderer->gpu, buffers[i]);
    if (renderer->overlay_texture.id) gpu_destroy_texture(renderer->gpu, renderer->overlay_texture);
}
