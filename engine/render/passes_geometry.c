// passes_geometry.c: passes that draw meshes: shadow map, G-buffer, and what comes over the lit
// picture.
// Data in: a packet's draw lists. Data out: commands. Called by: pass_run (passes.c).
#include "passes.h"

// --- Shadow map: drawn only when what it shows changed (shadow_key) ---

static bool shadow_needed(const PassContext *c) {
    return c->packet->shadow_size_px > 0 && c->renderer->shadow_key != c->packet->shadow_key;
}
static void shadow_record(const PassContext *c) {
    gpu_cmd_begin_rendering(c->cmd, &(GpuRendering){.depth = CLEARED(SHADOW_MAP),
                                                    .width = c->packet->shadow_size_px,
                                                    .height = c->packet->shadow_size_px});
    draw_list(c, PIPELINE_SHADOW, c->packet->shadow_draws, false);
    draw_list(c, PIPELINE_SHADOW_MASK, c->packet->shadow_mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
    c->renderer->shadow_key = c->packet->shadow_key;
    c->renderer->stats.shadow_redrawn = 1;
}
const Pass shadow_pass = {
    "shadow", {OVERWRITE(SHADOW_MAP, DEPTH_TARGET)}, 1, shadow_record, shadow_needed};

// --- Geometry ---

static void gbuffer_record(const PassContext *c) {
    // Colour is cleared as well: the background's material must be an index that exists.
    GpuRendering rendering = {.depth = CLEARED(DEPTH)};
    const LayoutRow *layout = &layout_table[layout_of(c->packet)];
    while (rendering.target_count < COUNT_OF(layout->targets) &&
           layout->targets[rendering.target_count]) {
        u32 i = rendering.target_count++;
        rendering.targets[i] =
            (GpuTarget){.texture = c->renderer->targets[RESOURCE_GBUFFER_0 + i], .clear = true};
    }
    begin(c, &rendering);
    draw_list(c, PIPELINE_GBUFFER, c->packet->opaque_draws, false);
    draw_list(c, PIPELINE_GBUFFER, c->packet->mask_draws, true);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass gbuffer_pass = {"gbuffer",
                           {OVERWRITE_GBUFFER(COLOR_TARGET), OVERWRITE(DEPTH, DEPTH_TARGET),
                            USE(SHADOW_MAP, SAMPLED_FRAGMENT)}, // layout killzone2
                           7,
                           gbuffer_record,
                           NULL};

// --- What is drawn over the lit picture: sky, textured emission, blended surfaces ---

static bool over_needed(const PassContext *c) {
    const Packet *packet = c->packet;
    const f32 *zenith = packet->frame.sky_zenith, *horizon = packet->frame.sky_horizon;
    // All paths leave black where there is no surface.
    bool has_sky = zenith[0] != 0.0f || zenith[1] != 0.0f || zenith[2] != 0.0f ||
                   zenith[3] != 0.0f || horizon[0] != 0.0f || horizon[1] != 0.0f ||
                   horizon[2] != 0.0f;
    return has_sky || packet->emissive_draws.count || packet->blend_draws.count ||
           c->renderer->is_warming_up;
}
static void over_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {color_target(c, false)},
                             .target_count = 1,
                             .depth = depth_target(c, false),
                             .depth_read_only = true});
    draw_fullscreen(c, PIPELINE_SKY);
    draw_list(c, PIPELINE_EMISSIVE, c->packet->emissive_draws, false);
    draw_list(c, gi_is_on(c) ? PIPELINE_GI_FORWARD_BLEND : PIPELINE_FORWARD_BLEND,
              c->packet->blend_draws, false);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass over_pass = {"sky and glow",
                        {USE(HDR, COLOR_TARGET), USE(HDR_MS, COLOR_TARGET), USE(DEPTH, DEPTH_TEST),
                         USE(DEPTH_MS, DEPTH_TEST), USE(SHADOW_MAP, SAMPLED_FRAGMENT),
                         USE_VOXEL_LIGHT(SAMPLED_FRAGMENT), USE(GI_VISIBILITY, SAMPLED_FRAGMENT),
                         USE(GI_PROBES, SAMPLED_FRAGMENT)},
                        10,
                        over_record,
                        over_needed};
