// layouts.c: the layouts of the G-buffer, one row each (specification of direct lighting, section
// 2).
//
// Data: what targets a layout has. The coding itself is in shaders/gbuffer.glsl (writing and
// reading side by side), chosen by SPEC_LAYOUT. To add a layout: a word in frame/settings.h, a row
// here, a case there.
#include "render_internal.h"

#define LEAN                                                                                       \
    { "lean", {GPU_FORMAT_RGBA8_SRGB, GPU_FORMAT_RG16}, 4, "nothing to speak of" }
const LayoutRow layout_table[LAYOUT_COUNT] = {
    [LAYOUT_LEAN] = LEAN,       [LAYOUT_WIDE] = LEAN,  [LAYOUT_PACKED] = LEAN,
    [LAYOUT_PACKED24] = LEAN,   [LAYOUT_HALF5] = LEAN, [LAYOUT_KILLZONE2] = LEAN,
    [LAYOUT_STARCRAFT2] = LEAN, [LAYOUT_IL] = LEAN,
};

u32 layout_bytes(const LayoutRow *row) {
    u32 bytes = 0;
    for (u32 i = 0; i < COUNT_OF(row->targets); i++)
        if (row->targets[i]) bytes += gpu_format_bytes(row->targets[i]);
    return bytes;
}
