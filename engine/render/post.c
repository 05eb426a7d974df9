// post.c: from radiance to the picture: the post chain, the G-buffer's debug pictures, the window.
// Data in: the HDR target and the depth buffer, the packet's list of steps. Data out: commands.
// Called by: pass_run (passes.c).
//
// To add a step to the chain: a word of the component `post`, a PostKind with its numbers
// (frame/packet.h), what fills them (systems/packet_post.c), a row and a pass here, a shader.
#include "passes.h"

// --- Steps on radiance ---

static void fog_record(const PassContext *c) {
    const f32 *v = c->post->values;
    // Blended over the picture: it is read by the blending unit, not by the shader.
    begin(c, &(GpuRendering){.targets = {TARGET(HDR)}, .target_count = 1});
    draw_fullscreen_with(c, PIPELINE_FOG, v[6] > 0.0f, v, 7);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass fog_pass = {
    "fog", {USE(HDR, COLOR_TARGET), USE(DEPTH, SAMPLED_FRAGMENT)}, 2, fog_record, NULL, NULL};

// The pixels that heat can change, within the picture. False: none.
static bool heat_scissor(const PassContext *c) {
    const f32 *v = c->post->values;
    f32 width = (f32)c->packet->width_px, height = (f32)c->packet->height_px;
    i32 left = (i32)CLAMP(v[7], 0.0f, width), right = (i32)CLAMP(v[9], 0.0f, width);
    i32 top = (i32)CLAMP(v[8], 0.0f, height), bottom = (i32)CLAMP(v[10], 0.0f, height);
    if (left >= right || top >= bottom) return false;
    gpu_cmd_scissor(c->cmd, left, top, (u32)(right - left), (u32)(bottom - top));
    return true;
}

// Heat moves pixels about: it reads a copy of its rectangle and writes the picture in place, so the
// steps after it find the picture where it always is.
static void heat_copy_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR_OTHER)}, .target_count = 1});
    if (heat_scissor(c)) draw_fullscreen(c, PIPELINE_POST_COPY);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass heat_copy_pass = {
    "heat copy", {OVERWRITE(HDR_OTHER, COLOR_TARGET), USE(HDR, SAMPLED_FRAGMENT)},
    2,           heat_copy_record,
    NULL,        NULL};

static void heat_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(HDR)}, .target_count = 1});
    if (heat_scissor(c)) draw_fullscreen_with(c, PIPELINE_HEAT, 0, c->post->values, 7);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass heat_pass = {
    "heat",
    {USE(HDR, COLOR_TARGET), USE(HDR_OTHER, SAMPLED_FRAGMENT), USE(DEPTH, SAMPLED_FRAGMENT)},
    3,
    heat_record,
    NULL,
    NULL};

// --- Picture: tone mapping and gamma follow each other always, so they are one shader ---

static void picture_record(const PassContext *c) {
    const PacketPost *posts = PACKET_DATA(c->packet, posts, PacketPost);
    f32 exponent = 0.0f;
    for (u32 i = 0; i < c->packet->posts.count && c->packet->settings.post; i++)
        if (posts[i].kind == POST_GAMMA) exponent = posts[i].values[0];
    f32 push[1] = {exponent > 0.0f ? 1.0f / exponent : 1.0f};
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen_with(c, PIPELINE_TONEMAP, exponent > 0.0f, push, 1);
    text_record(c, TEXT_PACKET);
    gpu_cmd_end_rendering(c->cmd);
}
static const Pass picture_pass = {
    "tonemap", {OVERWRITE(LDR, COLOR_TARGET), USE(HDR, SAMPLED_FRAGMENT)}, 2, picture_record, NULL,
    NULL};

// --- The chain ---

typedef struct PostRow {
    const Pass *passes[2]; // none: a part of picture_pass
} PostRow;
static const PostRow post_table[POST_KIND_COUNT] = {
    [POST_FOG] = {{&fog_pass}},
    [POST_HEAT] = {{&heat_copy_pass, &heat_pass}},
    [POST_TONEMAP] = {{NULL}},
    [POST_GAMMA] = {{NULL}},
};

static void post_expand(const PassContext *c) {
    const PacketPost *posts = PACKET_DATA(c->packet, posts, PacketPost);
    for (u32 i = 0; i < c->packet->posts.count && c->packet->settings.post; i++) {
        PassContext step = *c;
        step.post = &posts[i];
        const PostRow *row = &post_table[MIN(posts[i].kind, POST_GAMMA)];
        for (u32 k = 0; k < COUNT_OF(row->passes) && row->passes[k]; k++)
            pass_run(&step, row->passes[k]);
    }
    pass_run(c, &picture_pass);
}
const Pass post_pass = {.name = "post", .expand = post_expand};

// --- Debug pictures of the G-buffer; the window ---

static void debug_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {TARGET(LDR)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEBUG);
    debug_view_record(c);
    text_record(c, TEXT_PACKET);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass debug_pass = {"debug view",
                         {OVERWRITE(LDR, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT),
                          USE(DEPTH, SAMPLED_FRAGMENT), USE_LISTS(READ_VERTEX)},
                         12,
                         debug_record,
                         NULL,
                         NULL};

static void present_record(const PassContext *c) {
    u32 width, height;
    gpu_swapchain_size(c->renderer->gpu, &width, &height);
    gpu_cmd_begin_rendering(
        c->cmd, &(GpuRendering){.to_swapchain = true, .width = width, .height = height});
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_PRESENT, PIPELINE_PLAIN);
    if (pipeline.id) {
        bind_frame(c, pipeline);
        f32 push[4] = {1.0f / (f32)width, 1.0f / (f32)height, 0, 0};
        gpu_cmd_push(c->cmd, push, sizeof push);
        gpu_cmd_draw(c->cmd, 3, 1, 0, 0);
    }
    if (c->overlay) overlay_record(c, c->overlay);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass present_pass = {"present", {USE(LDR, SAMPLED_FRAGMENT)}, 1, present_record, NULL, NULL};
