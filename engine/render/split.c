// split.c: two packets of one view in one picture.
// Data in: two packets of one size, where the line is. Data out: commands; pixels. Called by:
// shells and tools. Does not: make the packets, or measure their difference (capture/).
//
// B is drawn first, with the parked set of buffers, and leaves its picture in LDR_OTHER; then A is
// drawn as ever. So A's pixels are the bits that it has alone. The pictures are joined in place:
// where A stays nothing is written.
#include "passes.h"
#include "../base/log.h"

#define BAND_SHARE 6 // of SPLIT_BOTH: the band reaches width / so much to each side of the line

static bool reads_a(const PassContext *c) { return c->split->mode != SPLIT_LINE; }

// A needs a second place only where the difference is formed: a picture cannot be read and written
// at once.
static void copy_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR_OTHER)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_SPLIT_COPY);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass split_copy_pass = {
    "split copy",
    {OVERWRITE(HDR_OTHER, COLOR_TARGET), USE(LDR, SAMPLED_FRAGMENT)},
    2,
    copy_record,
    reads_a,
    NULL};

static void split_record(const PassContext *c) {
    const SplitView *split = c->split;
    f32 width = (f32)c->packet->width_px;
    f32 line = (f32)(i32)(CLAMP(split->at, 0.0f, 1.0f) * width + 0.5f);
    f32 band = (f32)(i32)(width / BAND_SHARE);
    f32 first = split->mode == SPLIT_LINE   ? line - 1.0f
                : split->mode == SPLIT_BOTH ? line - band - 1.0f
                                            : 0.0f;
    u32 left = (u32)CLAMP(first, 0.0f, width - 1.0f);
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    gpu_cmd_scissor(c->cmd, (i32)left, 0, c->packet->width_px - left, c->packet->height_px);
    f32 push[3] = {line, band, split->gain > 0.0f ? split->gain : SPLIT_GAIN};
    draw_fullscreen_with(c, PIPELINE_SPLIT, MIN(split->mode, SPLIT_MODE_COUNT - 1), push, 3);
    gpu_cmd_scissor(c->cmd, 0, 0, c->packet->width_px, c->packet->height_px);
    text_record(c, TEXT_CAPTION);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass split_pass = {
    "split",
    {USE(LDR, COLOR_TARGET), USE(LDR_OTHER, SAMPLED_FRAGMENT), USE(HDR_OTHER, SAMPLED_FRAGMENT)},
    3,
    split_record,
    NULL,
    NULL};

// Captions beside the line, at the lower rim.
static void add_captions(Renderer *r, const Packet *packet, const SplitView *split) {
    f32 width = (f32)packet->width_px, height = (f32)packet->height_px;
    f32 size = note_size(packet), y = height - 1.5f * size;
    if (split->label_a) note_add(r, TEXT_CAPTION, size, y, size, NOTE_COLOR, "%s", split->label_a);
    if (split->label_b) {
        f32 x = width - note_width(size, split->label_b) - size;
        note_add(r, TEXT_CAPTION, MAX(x, 0.0f), y, size, NOTE_COLOR, "%s", split->label_b);
    }
}

// Where B's part begins, if there is room for a legend.
static f32 legend_left(const Packet *b, const SplitView *split) {
    f32 share = CLAMP(split->at, 0.0f, 1.0f);
    if (split->mode == SPLIT_BOTH) share += 1.0f / BAND_SHARE;
    return split->mode != SPLIT_DIFFERENCE && share < 0.8f ? share * (f32)b->width_px : 0.0f;
}

bool renderer_draw_split(Renderer *renderer, GpuCommands *cmd, const Packet *a, const Packet *b,
                         const SplitView *split, bool to_swapchain, const Overlay *overlay) {
    if (a->width_px != b->width_px || a->height_px != b->height_px) {
        LOG(USAGE, "a split picture needs two of one size, not %ux%u and %ux%u", a->width_px,
            a->height_px, b->width_px, b->height_px);
        return false;
    }
    renderer->stats = (RendererStats){.pipelines = renderer->stats.pipelines};
    device_lists_read(renderer, gpu_frame_slot(renderer->gpu));
    gi_read_reports(renderer, gpu_frame_slot(renderer->gpu));
    frame_sets_exchange(renderer);
    renderer->legend_left_px = legend_left(b, split);
    bool ok = packet_draw(renderer, cmd, b);
    renderer->legend_left_px = 0.0f;
    frame_sets_exchange(renderer);
    add_captions(renderer, a, split);
    if (!ok || !packet_draw(renderer, cmd, a)) return false;
    PassContext context = {
        .renderer = renderer, .cmd = cmd, .packet = a, .overlay = overlay, .split = split};
    pass_run(&context, &split_copy_pass);
    pass_run(&context, &split_pass);
    if (to_swapchain) pass_run(&context, &present_pass);
    return true;
}
