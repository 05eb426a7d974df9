// layouts.c: the layouts of the G-buffer, one row each (specification of direct lighting, section
// 2).
//
// Data: what targets a layout has, what it cannot tell. The coding itself is in
// shaders/gbuffer.glsl (writing and reading side by side) and shaders/coding.glsl, chosen by
// SPEC_LAYOUT. To add a layout: a word in frame/settings.h, its number in shaders/shared.h, a row
// here, a case there, its bounds in tests/golden/layouts.c. The depth buffer is always there as
// well: sky, textured emission and blended surfaces need it.
//
// clang-format off
// lean        albedo, material; octahedral normal; position from the depth buffer (ours)
// wide        world position; world normal; albedo, material (Puig 2006, chapter 2)
// packed      view normal x y, distance in two bytes; albedo, material (Puig 2006, chapter 3)
// packed24    view normal x y; distance in three bytes; albedo, material (Puig 2006, figure 26)
// half5       position from the eye; normal, power; albedo, material; specular, Fresnel; ambient
//             light and emission (Kubovcik 2014, 6.1)
// killzone2   ambient light and emission, intensity; view normal x y; motion x y, power, specular
//             intensity; albedo, sun's visibility (iL-engine)
// starcraft2  emission, mask; normal, view depth; albedo, ambient occlusion; specular, power
//             (iL-engine)
// il          albedo, mask; view normal x y, power, specular intensity; Oren-Nayar pair, view
//             depth; lightmap (ambient light, emission), mask (iL-engine)
// clang-format on
#include "render_internal.h"

const LayoutRow layout_table[LAYOUT_COUNT] = {
    [LAYOUT_LEAN] = {.name = "lean",
                     .targets = {GPU_FORMAT_RGBA8, GPU_FORMAT_RG16},
                     .position_normal_bytes = 4,
                     .loses = "nothing to speak of: normals within 0.004 degrees"},
    [LAYOUT_WIDE] = {.name = "wide",
                     .targets = {GPU_FORMAT_RGBA32F, GPU_FORMAT_RGBA32F, GPU_FORMAT_RGBA8},
                     .position_normal_bytes = 32,
                     .loses = "nothing"},
    [LAYOUT_PACKED] = {.name = "packed",
                       .targets = {GPU_FORMAT_RGBA8, GPU_FORMAT_RGBA8},
                       .position_normal_bytes = 4,
                       .loses = "normals within half a degree facing the eye, some degrees at "
                                "grazing angles, mirrored where they face away; distance within "
                                "1/131,072 of its reach"},
    [LAYOUT_PACKED24] = {.name = "packed24",
                         .targets = {GPU_FORMAT_RGBA8, GPU_FORMAT_RGBA8, GPU_FORMAT_RGBA8},
                         .position_normal_bytes = 8,
                         .loses = "normals as `packed`"},
    [LAYOUT_HALF5] = {.name = "half5",
                      .targets = {GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F,
                                  GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F},
                      .position_normal_bytes = 16,
                      .loses = "position within 1/4,096 of the distance (it is stored from the "
                               "eye: a world position would lose more), 11 bits of all else"},
    [LAYOUT_KILLZONE2] = {.name = "killzone2",
                          .targets = {GPU_FORMAT_RGBA8, GPU_FORMAT_RG16F, GPU_FORMAT_RGBA8,
                                      GPU_FORMAT_RGBA8},
                          .position_normal_bytes = 4,
                          .loses = "the colour of highlights, whose lobe and whose material's "
                                   "diffuse lobe are the level's most common; power within 2 %; "
                                   "normals that face away"},
    [LAYOUT_STARCRAFT2] = {.name = "starcraft2",
                           .targets = {GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F,
                                       GPU_FORMAT_RGBA16F},
                           .position_normal_bytes = 8,
                           .loses = "the lobes, which are the level's most common; view depth "
                                    "within 1/4,096"},
    [LAYOUT_IL] = {.name = "il",
                   .targets = {GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA16F, GPU_FORMAT_RG32F,
                               GPU_FORMAT_RGBA16F},
                   .position_normal_bytes = 8,
                   .loses = "the colour and the lobe of highlights; A of Oren-Nayar within 1/36; "
                            "normals that face away"},
};

u32 layout_bytes(const LayoutRow *row) {
    u32 bytes = 0;
    for (u32 i = 0; i < COUNT_OF(row->targets); i++)
        if (row->targets[i]) bytes += gpu_format_bytes(row->targets[i]);
    return bytes;
}

GbufferLayout layout_of(const Packet *packet) {
    const RenderSettings *s = &packet->settings;
    bool shades_meshes = s->path == PATH_FORWARD || s->path == PATH_MULTIPASS ||
                         s->path == PATH_TILED_FORWARD || s->path == PATH_CLUSTERED_FORWARD;
    bool for_gi = packet->gi.params.enabled && shades_meshes;
    return for_gi && path_of(packet) == &path_table[s->path] ? LAYOUT_LEAN : s->layout;
}

RendererLayoutInfo renderer_layout_info(GbufferLayout layout) {
    const LayoutRow *row = &layout_table[layout];
    return (RendererLayoutInfo){.name = row->name,
                                .bytes = layout_bytes(row),
                                .position_normal_bytes = row->position_normal_bytes};
}

// Shaders know these enums as numbers of shared.h.
_Static_assert((u32)LAYOUT_LEAN == GBUFFER_LAYOUT_LEAN && (u32)LAYOUT_WIDE == GBUFFER_LAYOUT_WIDE &&
                   (u32)LAYOUT_PACKED == GBUFFER_LAYOUT_PACKED &&
                   (u32)LAYOUT_PACKED24 == GBUFFER_LAYOUT_PACKED24 &&
                   (u32)LAYOUT_HALF5 == GBUFFER_LAYOUT_HALF5 &&
                   (u32)LAYOUT_KILLZONE2 == GBUFFER_LAYOUT_KILLZONE2 &&
                   (u32)LAYOUT_STARCRAFT2 == GBUFFER_LAYOUT_STARCRAFT2 &&
                   (u32)LAYOUT_IL == GBUFFER_LAYOUT_IL,
               "layouts of frame/settings.h and shaders/shared.h");
_Static_assert((u32)VIEW_ALBEDO == DEBUG_ALBEDO && (u32)VIEW_NORMAL == DEBUG_NORMAL &&
                   (u32)VIEW_DEPTH == DEBUG_DEPTH && (u32)VIEW_MATERIAL == DEBUG_MATERIAL &&
                   (u32)VIEW_POSITION == DEBUG_POSITION && (u32)VIEW_EMISSIVE == DEBUG_EMISSIVE &&
                   (u32)VIEW_SPECULAR == DEBUG_SPECULAR && (u32)VIEW_MOTION == DEBUG_MOTION &&
                   (u32)VIEW_GBUFFER_0 == DEBUG_GBUFFER_0,
               "views of frame/settings.h and shaders/shared.h");
