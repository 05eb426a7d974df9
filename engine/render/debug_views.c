// debug_views.c: what the debug views show beside the G-buffer: marks of lights, the occluders'
// depth buffer, how often pixels are drawn; and the caption and legend of every view.
// Data in: a packet and its view. Data out: vertices and notes (upload), commands (passes). Called
// by: frame_upload.c once a packet, pass_run. Does not: draw the G-buffer's pictures (debug.frag).
//
// Lights are those of packet.light_marks; a packet without any (it was made for another view) shows
// its lights, all of which are kept.
#include "debug_draw.h"
#include "../base/sphere_bounds.h"
#include "passes.h"
#include <stdarg.h>
#include <stdio.h>

#define CROWD        64u     // more lights than that are drawn with fewer and fainter lines
#define VERTICES_CAP 786432u // 15 MiB; shapes beyond it are counted in the legend

// RGBA8, red in the low byte.
#define RGB(r, g, b) (0xFF000000u | (u32)(b) << 16 | (u32)(g) << 8 | (u32)(r))
#define WHITE        RGB(240, 240, 240)

// --- Lights ---

static u32 mark_count(const Packet *packet) {
    return packet->light_marks.count ? packet->light_marks.count
                                     : packet->frame.counts[0] + packet->frame.counts[1];
}

static PacketLightMark mark_get(const Packet *packet, u32 i) {
    if (packet->light_marks.count) return PACKET_DATA(packet, light_marks, PacketLightMark)[i];
    const LightRecord *light = &PACKET_DATA(packet, lights, LightRecord)[i];
    PacketLightMark mark = {.cos_outer = -2.0f,
                            .weight = 1.0f,
                            .highlight = light->color[3],
                            .fate = LIGHT_KEPT,
                            .light = i};
    f32 inverse_square = light->position[3];
    mark.range = inverse_square > 1e-12f ? 1.0f / sqrtf(inverse_square) : 1e6f;
    for (u32 k = 0; k < 3; k++) mark.position[k] = light->position[k];
    u32 points = packet->frame.counts[0];
    if (i < points) return mark;
    const SpotRecord *spot = &PACKET_DATA(packet, spots, SpotRecord)[i - points];
    for (u32 k = 0; k < 3; k++) mark.direction[k] = spot->direction[k];
    mark.cos_outer = spot->direction[3];
    return mark;
}

static Vec3 from_array(const f32 v[3]) { return vec3(v[0], v[1], v[2]); }
static bool is_spot(const PacketLightMark *mark) { return mark->cos_outer >= -1.0f; }
// Those that the frame shades.
static bool is_shown(const PacketLightMark *mark) {
    return mark->fate == LIGHT_KEPT || mark->fate == LIGHT_MERGER;
}

static const struct {
    const char *name;
    u32 color;
} fates[LIGHT_FATE_COUNT] = {
    [LIGHT_KEPT] = {"kept", RGB(90, 220, 90)},
    [LIGHT_OUTSIDE] = {"outside the view", RGB(110, 110, 110)},
    [LIGHT_OCCLUDED] = {"occluded", RGB(90, 130, 255)},
    [LIGHT_MERGED] = {"merged into another", RGB(255, 210, 60)},
    [LIGHT_MERGER] = {"stands for merged ones", RGB(255, 120, 255)},
    [LIGHT_DROPPED] = {"too small or faint", RGB(255, 80, 60)},
    [LIGHT_OVER_BUDGET] = {"over the budget", RGB(255, 150, 40)},
};

typedef enum LightLod { LOD_NEAR, LOD_BETWEEN, LOD_FAR, LOD_COUNT } LightLod;
static const struct {
    const char *name;
    u32 color;
} lods[LOD_COUNT] = {
    [LOD_NEAR] = {"near: diffuse and highlight", RGB(90, 220, 90)},
    [LOD_BETWEEN] = {"between: highlight fades", RGB(255, 210, 60)},
    [LOD_FAR] = {"far: diffuse only", RGB(255, 80, 60)},
};
static LightLod lod_of(const PacketLightMark *mark) {
    return mark->highlight >= 1.0f ? LOD_NEAR : mark->highlight > 0.0f ? LOD_BETWEEN : LOD_FAR;
}

static u32 with_alpha(u32 color, f32 alpha) {
    return (color & 0xFFFFFFu) | (u32)(CLAMP(alpha, 0.0f, 1.0f) * 255.0f) << 24;
}

static f32 crowd_alpha(u32 lights) {
    return lights <= CROWD ? 0.8f : MAX(0.8f * sqrtf((f32)CROWD / (f32)lights), 0.2f);
}

// --- Legend: swatch and words, from the upper left down ---

typedef struct Legend {
    Renderer *renderer;
    DebugDraw *draw;
    f32 size, x, y;
} Legend;

static Legend legend_begin(Renderer *renderer, DebugDraw *draw, const char *caption) {
    f32 size = note_size(draw->packet), left = renderer->legend_left_px + size;
    note_add(renderer, TEXT_LEGEND, left, size, size, WHITE, "%s", caption);
    return (Legend){renderer, draw, size, left, 2.4f * size};
}

static void legend_row(Legend *legend, u32 color, const char *format, ...) PRINTF_LIKE(3, 4);
static void legend_row(Legend *legend, u32 color, const char *format, ...) {
    char text[sizeof((Note){0}).text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    f32 size = legend->size, x = legend->x, y = legend->y;
    debug_patch(legend->draw, x - 1.0f, y - 0.1f * size - 1.0f, x + size + 1.0f,
                y + 0.7f * size + 1.0f, RGB(0, 0, 0));
    debug_patch(legend->draw, x, y - 0.1f * size, x + size, y + 0.7f * size, color);
    note_add(legend->renderer, TEXT_LEGEND, x + 1.5f * size, y, size, WHITE, "%s", text);
    legend->y += 1.2f * size;
}

// --- Views ---

static void show_rects(Renderer *renderer, DebugDraw *draw) {
    const Packet *packet = draw->packet;
    const FrameRecord *frame = &packet->frame;
    const f32 *m = frame->view;
    f32 scale_x = 1.0f / vec3_length(from_array(frame->ray_right));
    f32 scale_y = 1.0f / vec3_length(from_array(frame->ray_up));
    f32 width = frame->viewport[0], height = frame->viewport[1];
    u32 shown = 0, count = mark_count(packet);
    f32 alpha = crowd_alpha(packet->frame.counts[0] + packet->frame.counts[1]);
    Legend legend = legend_begin(renderer, draw, "screen rectangles of the shaded lights");
    for (u32 i = 0; i < count; i++) {
        PacketLightMark mark = mark_get(packet, i);
        if (!is_shown(&mark)) continue;
        const f32 *p = mark.position, *w = mark.direction;
        f32 tip[3], way[3], left, right, bottom, top, near = frame->camera[3];
        for (u32 a = 0; a < 3; a++) {
            tip[a] = m[a] * p[0] + m[4 + a] * p[1] + m[8 + a] * p[2] + m[12 + a];
            way[a] = m[a] * w[0] + m[4 + a] * w[1] + m[8 + a] * w[2];
        }
        f32 cosine = is_spot(&mark) ? mark.cos_outer : -1.0f;
        if (!cone_bounds_axis(tip, way, cosine, mark.range, 0, near, scale_x, &left, &right) ||
            !cone_bounds_axis(tip, way, cosine, mark.range, 1, near, scale_y, &bottom, &top))
            continue;
        shown++;
        debug_frame(draw, (left * 0.5f + 0.5f) * width, (0.5f - top * 0.5f) * height,
                    (right * 0.5f + 0.5f) * width, (0.5f - bottom * 0.5f) * height,
                    with_alpha(is_spot(&mark) ? RGB(120, 200, 255) : RGB(255, 210, 60), alpha));
    }
    legend_row(&legend, RGB(255, 210, 60), "points");
    legend_row(&legend, RGB(120, 200, 255), "spots; %u rectangles in all", shown);
}

static void show_volumes(Renderer *renderer, DebugDraw *draw) {
    u32 count = mark_count(draw->packet), points = 0, spots = 0, shown = 0;
    for (u32 i = 0; i < count; i++) {
        PacketLightMark mark = mark_get(draw->packet, i);
        shown += is_shown(&mark);
    }
    Legend legend = legend_begin(renderer, draw, "volumes of the shaded lights (dim: hidden)");
    const LightRecord *lights = PACKET_DATA(draw->packet, lights, LightRecord);
    for (u32 i = 0; i < count; i++) {
        PacketLightMark mark = mark_get(draw->packet, i);
        if (!is_shown(&mark)) continue;
        // In the light's own colour, as bright as a line must be.
        u32 color = RGB(255, 210, 60);
        if (mark.light < draw->packet->lights.count) {
            const f32 *c = lights[mark.light].color;
            f32 most = MAX(MAX(c[0], c[1]), MAX(c[2], 1e-6f));
            color = RGB(55.0f + 200.0f * c[0] / most, 55.0f + 200.0f * c[1] / most,
                        55.0f + 200.0f * c[2] / most);
        }
        Vec3 p = from_array(mark.position);
        if (is_spot(&mark)) {
            debug_cone(draw, p, from_array(mark.direction), mark.range, mark.cos_outer, color);
            spots++;
        } else {
            if (shown <= CROWD)
                debug_sphere(draw, p, mark.range, color);
            else
                debug_ball(draw, p, mark.range, with_alpha(color, crowd_alpha(shown)));
            points++;
        }
    }
    legend_row(&legend, RGB(255, 210, 60), "%u spheres", points);
    legend_row(&legend, RGB(255, 210, 60), "%u cones", spots);
    if (draw->left_out) legend_row(&legend, RGB(255, 80, 60), "%u lines more", draw->left_out);
}

static void show_states(Renderer *renderer, DebugDraw *draw) {
    u32 count = mark_count(draw->packet), counts[LIGHT_FATE_COUNT] = {0}, fading = 0;
    f32 radius = note_size(draw->packet) * 0.3f;
    Legend legend = legend_begin(renderer, draw, "what the light manager does with each light");
    for (u32 i = 0; i < count; i++) {
        PacketLightMark mark = mark_get(draw->packet, i);
        u32 fate = MIN(mark.fate, LIGHT_FATE_COUNT - 1);
        counts[fate]++;
        fading += is_shown(&mark) && mark.weight < 1.0f;
        // Discs for what is shaded, as strong as it shines; crosses for what is not.
        if (is_shown(&mark))
            debug_disc(draw, from_array(mark.position), radius,
                       with_alpha(fates[fate].color, 0.35f + 0.65f * mark.weight));
        else
            debug_cross(draw, from_array(mark.position), radius, fates[fate].color);
    }
    for (u32 fate = 0; fate < LIGHT_FATE_COUNT; fate++)
        legend_row(&legend, fates[fate].color, "%5u %s", counts[fate], fates[fate].name);
    legend_row(&legend, WHITE, "%5u of the shaded ones fade", fading);
}

static void show_lods(Renderer *renderer, DebugDraw *draw) {
    u32 count = mark_count(draw->packet), counts[LOD_COUNT] = {0};
    f32 radius = note_size(draw->packet) * 0.35f;
    Legend legend = legend_begin(renderer, draw, "levels of detail of the shaded lights");
    for (u32 i = 0; i < count; i++) {
        PacketLightMark mark = mark_get(draw->packet, i);
        if (!is_shown(&mark)) continue;
        LightLod lod = lod_of(&mark);
        counts[lod]++;
        debug_disc(draw, from_array(mark.position), radius, lods[lod].color);
    }
    for (u32 lod = 0; lod < LOD_COUNT; lod++)
        legend_row(&legend, lods[lod].color, "%5u %s", counts[lod], lods[lod].name);
}

// Near is bright; 64 steps, so that runs of equal ones become one patch.
static u32 depth_color(f32 depth_m) {
    f32 x = 1.0f / (1.0f + 0.08f * MAX(depth_m, 0.0f));
    u32 step = (u32)(CLAMP(x, 0.0f, 1.0f) * 63.0f);
    return RGB(step * 4, step * 3, 40 + step * 2);
}

static void show_occluders(Renderer *renderer, DebugDraw *draw) {
    const Packet *packet = draw->packet;
    u32 columns = packet->counts.occluder_width, rows = packet->counts.occluder_height;
    const f32 *depths = PACKET_DATA(packet, occluder_depths, f32);
    Legend legend = legend_begin(renderer, draw, "depth buffer that lights are tested against");
    if (columns == 0 || (u64)columns * rows > packet->occluder_depths.count) columns = rows = 0;
    f32 width = packet->frame.viewport[0], height = packet->frame.viewport[1];
    for (u32 y = 0; y < rows; y++) {
        f32 top = height * (f32)y / (f32)rows, bottom = height * (f32)(y + 1) / (f32)rows;
        for (u32 x = 0; x < columns;) {
            u32 first = x, color = 0;
            bool empty = false;
            for (; x < columns; x++) {
                f32 depth = depths[y * columns + x];
                bool is_empty = !(depth > 0.0f && depth < 1e6f);
                u32 here = is_empty ? 0 : depth_color(depth);
                if (x > first && (here != color || is_empty != empty)) break;
                color = here, empty = is_empty;
            }
            if (!empty)
                debug_patch(draw, width * (f32)first / (f32)columns, top,
                            width * (f32)x / (f32)columns, bottom, with_alpha(color, 0.8f));
        }
    }
    legend_row(&legend, depth_color(1.0f), "1 m");
    legend_row(&legend, depth_color(10.0f), "10 m");
    legend_row(&legend, depth_color(100.0f), "100 m");
    legend_row(&legend, WHITE, "%u occluders, %u x %u", packet->counts.occluders, columns, rows);
    legend_row(&legend, WHITE, "%u lights, %u drawables behind", packet->counts.lights_occluded,
               packet->counts.drawables_occluded);
}

// heat_map() of common.glsl.
static u32 heat_color(f32 x) {
    f32 rgb[3] = {4.0f * x - 1.5f, 2.0f - fabsf(4.0f * x - 2.0f), 1.5f - 4.0f * x};
    f32 white = CLAMP(x - 1.0f, 0.0f, 1.0f);
    for (u32 i = 0; i < 3; i++) {
        rgb[i] = CLAMP(rgb[i], 0.0f, 1.0f);
        rgb[i] = ((rgb[i] + (1.0f - rgb[i]) * white) * 0.9f + 0.1f) * 255.0f;
    }
    return RGB(rgb[0], rgb[1], rgb[2]);
}

static void show_overdraw(Renderer *renderer, DebugDraw *draw) {
    static const u32 steps[] = {1, 2, 3, 5, 7, 9, 17};
    Legend legend = legend_begin(renderer, draw,
                                 draw->packet->settings.view == VIEW_LAYERS
                                     ? "surfaces of a pixel, hidden ones too"
                                     : "times that a pixel is drawn, near to far, depth test on");
    for (u32 i = 0; i < COUNT_OF(steps); i++)
        legend_row(&legend, heat_color(((f32)steps[i] - 1.0f) / 8.0f), "%u%s", steps[i],
                   i + 1 == COUNT_OF(steps) ? " and more" : "");
}

static void show_cell_lights(Renderer *renderer, DebugDraw *draw) {
    static const u32 steps[] = {1, 4, 16, 64, 256};
    Legend legend = legend_begin(renderer, draw,
                                 settings_clustered(&draw->packet->settings)
                                     ? "lights in the cluster of each pixel"
                                     : "lights in the list of each tile");
    for (u32 i = 0; i < COUNT_OF(steps); i++)
        legend_row(&legend, heat_color((f32)i * 0.25f), "%u", steps[i]); // log2 / 8
    const PacketCounts *counts = &draw->packet->counts;
    if (counts->cell_count)
        legend_row(&legend, WHITE, "%u cells, %u in the fullest", counts->cell_count,
                   counts->cell_light_max);
}

// --- Global illumination ---

// False: there is none in this packet, which is all that the picture tells.
static bool gi_legend(Renderer *renderer, DebugDraw *draw, const char *caption, Legend *legend) {
    bool is_on = renderer->gi.is_on;
    *legend = legend_begin(renderer, draw, is_on ? caption : "global illumination is off");
    return is_on;
}

static void show_gi_voxels(Renderer *renderer, DebugDraw *draw) {
    const RenderSettings *settings = &draw->packet->settings;
    const GiRecord *record = &draw->packet->gi.record;
    char word[48], caption[96], direction[8];
    settings_word("gi.show", settings->gi_show, word, sizeof word);
    settings_word("gi.show_direction", settings->gi_show_direction, direction, sizeof direction);
    bool is_filtered = settings->gi_show == GI_SHOW_RADIANCE && settings->gi_show_level > 0;
    if (is_filtered)
        snprintf(caption, sizeof caption, "filtered radiance, level %u, light towards %s",
                 MIN(settings->gi_show_level, record->atlas[3]), direction);
    else
        snprintf(caption, sizeof caption, "voxels: %s", word);
    Legend legend;
    if (!gi_legend(renderer, draw, caption, &legend)) return;
    if (settings->gi_show == GI_SHOW_STATIC) {
        legend_row(&legend, RGB(89, 191, 89), "static");
        legend_row(&legend, RGB(255, 153, 38), "dynamic");
        if (draw->packet->gi.params.solid) legend_row(&legend, RGB(77, 115, 242), "solid");
    }
    RendererStats stats = renderer_stats(renderer);
    if (stats.gi_lost_voxels)
        legend_row(&legend, RGB(255, 0, 255), "%u found no room", stats.gi_lost_voxels);
    legend_row(&legend, WHITE, "%u x %u x %u of %.3f m, %u cascade%s", record->dims[0],
               record->dims[1], record->dims[2], (f64)record->origin[0][3], record->dims[3],
               record->dims[3] > 1 ? "s" : "");
    legend_row(&legend, WHITE, "%u occupied, %u of them dynamic", stats.gi_voxels,
               stats.gi_dynamic_voxels);
}

static void show_gi_steps(Renderer *renderer, DebugDraw *draw) {
    static const u32 steps[] = {16, 32, 64, 96, 128, 256}; // gi_view_trace.frag: red is 128
    Legend legend;
    if (!gi_legend(renderer, draw, "steps of a pixel's cones together", &legend)) return;
    for (u32 i = 0; i < COUNT_OF(steps); i++)
        legend_row(&legend, heat_color((f32)steps[i] / 128.0f), "%u", steps[i]);
    legend_row(&legend, RGB(0, 0, 0), "no cones: probes, voxels or none");
}

static void show_gi_probes(Renderer *renderer, DebugDraw *draw) {
    const GiRecord *record = &draw->packet->gi.record;
    Legend legend;
    if (!gi_legend(renderer, draw, "probes, each lit by what it says", &legend)) return;
    if (draw->packet->gi.params.diffuse != GI_DIFFUSE_PROBES) {
        legend_row(&legend, WHITE, "there are none: gi.diffuse is not probes");
        return;
    }
    legend_row(&legend, RGB(184, 64, 64), "in a wall");
    legend_row(&legend, WHITE, "%u x %u x %u, %.2f m apart", record->probes[0], record->probes[1],
               record->probes[2], (f64)record->probe_origin[3]);
}

static void show_gi_leaks(Renderer *renderer, DebugDraw *draw) {
    Legend legend;
    if (!gi_legend(renderer, draw, "light that came through a surface", &legend)) return;
    legend_row(&legend, RGB(255, 38, 153), "by cones, where rays bring less than 5 %% of it");
}

static void show_gi_part(Renderer *renderer, DebugDraw *draw) {
    static const char *const captions[VIEW_COUNT] = {
        [VIEW_GI_INDIRECT] = "indirect light",
        [VIEW_GI_DIFFUSE] = "indirect diffuse light, without albedo",
        [VIEW_GI_SPECULAR] = "indirect mirrored light",
        [VIEW_GI_AO] = "ambient visibility: white is open",
    };
    Legend legend;
    gi_legend(renderer, draw, captions[draw->packet->settings.view], &legend);
}

static const struct {
    const char *caption; // of views without a legend
    void (*show)(Renderer *renderer, DebugDraw *draw);
} views[VIEW_COUNT] = {
    [VIEW_ALBEDO] = {"albedo", NULL},
    [VIEW_NORMAL] = {"normal, world: x red, y green, z blue, 0 is grey", NULL},
    [VIEW_DEPTH] = {"depth, near is dark", NULL},
    [VIEW_MATERIAL] = {"material, a colour each", NULL},
    [VIEW_POSITION] = {"position, world, 4 m a period", NULL},
    [VIEW_EMISSIVE] = {"emission", NULL},
    [VIEW_SPECULAR] = {"specular colour and power", NULL},
    [VIEW_MOTION] = {"motion since the last picture, grey is none", NULL},
    [VIEW_GBUFFER_0] = {"G-buffer target 0 as stored", NULL},
    [VIEW_GBUFFER_1] = {"G-buffer target 1 as stored", NULL},
    [VIEW_GBUFFER_2] = {"G-buffer target 2 as stored", NULL},
    [VIEW_GBUFFER_3] = {"G-buffer target 3 as stored", NULL},
    [VIEW_GBUFFER_4] = {"G-buffer target 4 as stored", NULL},
    [VIEW_CELL_LIGHTS] = {NULL, show_cell_lights},
    [VIEW_TILE_DEPTH] = {"nearest and farthest surface of each tile", NULL},
    [VIEW_CLUSTERS] = {"clusters, a colour each", NULL},
    [VIEW_OVERDRAW] = {NULL, show_overdraw},
    [VIEW_LIGHT_RECTS] = {NULL, show_rects},
    [VIEW_LIGHT_VOLUMES] = {NULL, show_volumes},
    [VIEW_LIGHT_STATES] = {NULL, show_states},
    [VIEW_LIGHT_LODS] = {NULL, show_lods},
    [VIEW_OCCLUDERS] = {NULL, show_occluders},
    [VIEW_LAYERS] = {NULL, show_overdraw},
    [VIEW_GI_VOXELS] = {NULL, show_gi_voxels},
    [VIEW_GI_INDIRECT] = {NULL, show_gi_part},
    [VIEW_GI_DIFFUSE] = {NULL, show_gi_part},
    [VIEW_GI_SPECULAR] = {NULL, show_gi_part},
    [VIEW_GI_AO] = {NULL, show_gi_part},
    [VIEW_GI_STEPS] = {NULL, show_gi_steps},
    [VIEW_GI_PROBES] = {NULL, show_gi_probes},
    [VIEW_GI_LEAKS] = {NULL, show_gi_leaks},
};

bool debug_view_upload(Renderer *renderer, const Packet *packet) {
    renderer->line_vertex_count = 0;
    u32 view = packet->settings.view;
    if (view == VIEW_FINAL) return true;
    if (!views[view].show) {
        f32 size = note_size(packet);
        note_add(renderer, TEXT_LEGEND, renderer->legend_left_px + size, size, size, WHITE,
                 "%s%s%s", views[view].caption,
                 view >= VIEW_GBUFFER_0 && view <= VIEW_GBUFFER_4 ? ", layout " : "",
                 view >= VIEW_GBUFFER_0 && view <= VIEW_GBUFFER_4
                     ? layout_table[packet->settings.layout].name
                     : "");
        return true;
    }
    if (!overlay_buffer(renderer, &renderer->line_vertices, "debug lines",
                        VERTICES_CAP * sizeof(OverlayVertex), true))
        return false;
    DebugDraw draw = {.packet = packet,
                      .vertices = gpu_buffer_map(renderer->gpu, renderer->line_vertices),
                      .cap = VERTICES_CAP};
    views[view].show(renderer, &draw);
    renderer->line_vertex_count = draw.count;
    return true;
}

// --- Passes ---

void debug_view_record(const PassContext *c) {
    Renderer *r = c->renderer;
    GpuPipeline pipeline = pipeline_get(r, c->packet, PIPELINE_LINES, PIPELINE_PLAIN);
    if (r->line_vertex_count && pipeline.id) {
        bind_frame(c, pipeline);
        f32 push[4] = {c->packet->frame.viewport[2], c->packet->frame.viewport[3], 0, 0};
        gpu_cmd_push(c->cmd, push, sizeof push);
        gpu_cmd_bind_vertices(c->cmd, 0, r->line_vertices, 0);
        gpu_cmd_draw(c->cmd, r->line_vertex_count, 1, 0, 0);
        r->stats.draw_calls++;
    }
    text_record(c, TEXT_LEGEND);
}

static bool overlay_needed(const PassContext *c) {
    u32 view = c->packet->settings.view;
    return view >= VIEW_LIGHT_RECTS && view <= VIEW_OCCLUDERS;
}
static void overlay_view_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    debug_view_record(c);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass debug_overlay_pass = {"debug overlay",
                                 {USE(LDR, COLOR_TARGET), USE(DEPTH, SAMPLED_FRAGMENT)},
                                 2,
                                 overlay_view_record,
                                 overlay_needed,
                                 NULL};

static void overdraw_record(const PassContext *c) {
    bool layers = c->packet->settings.view == VIEW_LAYERS;
    PipelineKind kind = layers ? PIPELINE_LAYERS : PIPELINE_OVERDRAW;
    GpuRendering rendering = {.targets = {CLEARED(HDR)}, .target_count = 1};
    if (!layers) rendering.depth = (GpuTarget)CLEARED(DEPTH);
    begin(c, &rendering);
    draw_list(c, kind, c->packet->opaque_draws, false);
    draw_list(c, kind, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass overdraw_pass = {
    "overdraw", {OVERWRITE(HDR, COLOR_TARGET), OVERWRITE(DEPTH, DEPTH_TARGET)},
    2,          overdraw_record,
    NULL,       NULL};

static void overdraw_show_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_OVERDRAW_SHOW);
    debug_view_record(c);
    text_record(c, TEXT_PACKET);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass overdraw_show_pass = {
    "overdraw heat",
    {OVERWRITE(LDR, COLOR_TARGET), USE(HDR, SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT)},
    3,
    overdraw_show_record,
    NULL,
    NULL};
