// gpu_volumes.c: what closed volumes and multisampling need: stencil marks, the depth test from
// behind, resolves. Exact pixels.
// Data in: triangles. Data out: pixels read back. Called by: the runner.
#include "gpu_fixture.h"

#define SIDE  16u
#define RED   0xFF0000FFu // RGBA8, red lowest
#define GREEN 0xFF00FF00u
#define BLACK 0xFF000000u

typedef struct Stage {
    Gpu *gpu;
    GpuTexture color, depth;
    GpuBuffer vertices, pixels;
    GpuPipeline pipelines[8];
    u32 pipeline_count;
} Stage;

static GpuTexture make_target(Gpu *gpu, const char *label, GpuFormat format, u32 samples) {
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = label,
                                                                   .heap = "targets",
                                                                   .format = format,
                                                                   .width = SIDE,
                                                                   .height = SIDE,
                                                                   .samples = samples,
                                                                   .render_target = true,
                                                                   .sampled = true});
    assert_true(texture.id);
    return texture;
}

// Columns of the picture: a rectangle of two triangles over x in [x0, x1) px, at a depth, facing
// the eye or away from it.
static void push_rectangle(MeshVertex *out, f32 x0, f32 x1, f32 depth, bool faces, u32 color) {
    f32 l = x0 / SIDE * 2.0f - 1.0f, r = x1 / SIDE * 2.0f - 1.0f;
    f32 corners[6][2] = {{l, -1}, {r, -1}, {r, 1}, {l, -1}, {r, 1}, {l, 1}};
    for (u32 i = 0; i < 6; i++) {
        const f32 *c = corners[faces ? i : 5 - i];
        out[i] = (MeshVertex){.position = {c[0], c[1], depth}, .color = color};
    }
}

static Stage stage_open(const char *label, GpuFormat depth_format, const MeshVertex *vertices,
                        u32 vertex_count) {
    Stage stage = {.gpu = gpu_fixture_create(label)};
    stage.color = make_target(stage.gpu, "color", GPU_FORMAT_RGBA8, 1);
    stage.depth = make_target(stage.gpu, "depth", depth_format, 1);
    stage.pixels = gpu_fixture_readback(stage.gpu, SIDE * SIDE * 4);
    // Long enough to serve as the instance stream as well.
    stage.vertices =
        gpu_create_buffer(stage.gpu, &(GpuBufferDesc){.label = "vertices",
                                                      .size = vertex_count * sizeof(InstanceRecord),
                                                      .vertex = true});
    gpu_upload_buffer(stage.gpu, stage.vertices, 0, vertices, vertex_count * sizeof *vertices);
    return stage;
}

static GpuPipeline stage_pipeline(Stage *stage, GpuPipelineDesc desc) {
    desc.label = "draw";
    desc.vertex = "test_draw.vert";
    desc.fragment = "test_draw.frag";
    desc.push_size = 16;
    desc.target_count = 1;
    desc.vertex_layout = GPU_VERTEX_MESH;
    if (!desc.targets[0]) desc.targets[0] = GPU_FORMAT_RGBA8;
    GpuPipeline pipeline = gpu_create_pipeline(stage->gpu, &desc);
    assert_true(pipeline.id);
    stage->pipelines[stage->pipeline_count++] = pipeline;
    return pipeline;
}

static void stage_draw(Stage *stage, GpuCommands *cmd, GpuPipeline pipeline, u32 first, u32 count) {
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_push(cmd, (f32[]){1, 1, 1, 1}, 16);
    gpu_cmd_bind_vertices(cmd, 0, stage->vertices, 0);
    gpu_cmd_bind_vertices(cmd, 1, stage->vertices, 0); // the test shader reads no instance
    gpu_cmd_draw(cmd, count, 1, first, 0);
}

static void stage_close(Stage *stage) {
    for (u32 i = 0; i < stage->pipeline_count; i++)
        gpu_destroy_pipeline(stage->gpu, stage->pipelines[i]);
    gpu_destroy_texture(stage->gpu, stage->color);
    gpu_destroy_texture(stage->gpu, stage->depth);
    gpu_destroy_buffer(stage->gpu, stage->vertices);
    gpu_destroy_buffer(stage->gpu, stage->pixels);
    gpu_fixture_destroy(stage->gpu);
}

// Surfaces in columns: 0..3 before the volume, 4..7 inside it, 8..11 behind it, 12..15 nothing. The
// volume: a front at 0.75 and a back at 0.25 over all. Reversed depth: larger is nearer.
enum { SURFACES = 0, FRONT = 18, BACK = 24, VERTEX_COUNT = 30 };
static void make_scene(MeshVertex *v) {
    push_rectangle(v, 0, 4, 0.875f, true, RED);
    push_rectangle(v + 6, 4, 8, 0.5f, true, RED);
    push_rectangle(v + 12, 8, 12, 0.125f, true, RED);
    push_rectangle(v + FRONT, 0, SIDE, 0.75f, true, GREEN);
    push_rectangle(v + BACK, 0, SIDE, 0.25f, false, GREEN);
}

// Draws the surfaces, then `draw` in a second rendering that may not write depth.
static const u32 *draw_over(Stage *stage, bool stencil, void (*draw)(Stage *, GpuCommands *)) {
    Gpu *gpu = stage->gpu;
    GpuFormat format = stencil ? GPU_FORMAT_D32F_S8 : GPU_FORMAT_D32F;
    GpuPipeline write =
        stage_pipeline(stage, (GpuPipelineDesc){.depth_format = format, .depth = GPU_DEPTH_WRITE});
    GpuCommands *cmd = gpu_frame_begin(gpu);
    GpuRendering rendering = {.targets = {{.texture = stage->color, .clear = true}},
                              .target_count = 1,
                              .depth = {.texture = stage->depth, .clear = true}};
    rendering.targets[0].clear_value[3] = 1.0f;
    gpu_cmd_barriers(cmd,
                     (GpuBarrier[]){{.texture = stage->color, .to = GPU_USAGE_COLOR_TARGET},
                                    {.texture = stage->depth, .to = GPU_USAGE_DEPTH_TARGET}},
                     2);
    gpu_cmd_begin_rendering(cmd, &rendering);
    stage_draw(stage, cmd, write, SURFACES, 18);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(
        cmd,
        (GpuBarrier[]){
            {.texture = stage->color, .from = GPU_USAGE_COLOR_TARGET, .to = GPU_USAGE_COLOR_TARGET},
            {.texture = stage->depth,
             .from = GPU_USAGE_DEPTH_TARGET,
             .to = stencil ? GPU_USAGE_DEPTH_STENCIL : GPU_USAGE_DEPTH_TEST}},
        2);
    rendering.targets[0].clear = rendering.depth.clear = false;
    rendering.depth_read_only = true;
    rendering.stencil = stencil;
    gpu_cmd_begin_rendering(cmd, &rendering);
    draw(stage, cmd);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(cmd,
                     &(GpuBarrier){.texture = stage->color,
                                   .from = GPU_USAGE_COLOR_TARGET,
                                   .to = GPU_USAGE_COPY_SOURCE},
                     1);
    gpu_cmd_copy_texture_to_buffer(cmd, stage->color, stage->pixels);
    assert_true(gpu_frame_end(gpu, true));
    return gpu_buffer_map(gpu, stage->pixels);
}

static void check_columns(const u32 *pixels, const u32 expected[4]) {
    for (u32 y = 0; y < SIDE; y++)
        for (u32 x = 0; x < SIDE; x++) assert_int_equal(pixels[y * SIDE + x], expected[x / 4]);
}

static void draw_marked(Stage *stage, GpuCommands *cmd) {
    GpuPipeline mark = stage_pipeline(stage, (GpuPipelineDesc){.depth_format = GPU_FORMAT_D32F_S8,
                                                               .depth = GPU_DEPTH_TEST,
                                                               .stencil = GPU_STENCIL_MARK,
                                                               .cull = GPU_CULL_NONE});
    GpuPipeline shade = stage_pipeline(stage, (GpuPipelineDesc){.depth_format = GPU_FORMAT_D32F_S8,
                                                                .stencil = GPU_STENCIL_SHADE,
                                                                .cull = GPU_CULL_FRONT,
                                                                .blend = GPU_BLEND_ADD});
    stage_draw(stage, cmd, mark, FRONT, 12);
    stage_draw(stage, cmd, shade, BACK, 6);
    stage_draw(stage, cmd, shade, BACK, 6); // finds no mark any more
}

// Marks and shades exactly the surface inside; the marks are used up; marking draws no colour.
TEST_GPU(gpu, stencil_marks_what_is_inside) {
    MeshVertex vertices[VERTEX_COUNT];
    make_scene(vertices);
    Stage stage = stage_open("stencil", GPU_FORMAT_D32F_S8, vertices, VERTEX_COUNT);
    const u32 expected[4] = {RED, RED | GREEN, RED, BLACK};
    check_columns(draw_over(&stage, true, draw_marked), expected);
    stage_close(&stage);
}

static void draw_back(Stage *stage, GpuCommands *cmd) {
    GpuPipeline behind = stage_pipeline(stage, (GpuPipelineDesc){.depth_format = GPU_FORMAT_D32F,
                                                                 .depth = GPU_DEPTH_BEHIND,
                                                                 .cull = GPU_CULL_FRONT,
                                                                 .blend = GPU_BLEND_ADD});
    stage_draw(stage, cmd, behind, FRONT, 12);
}

// A back face passes where it lies behind the surface: not over nothing, not before it.
TEST_GPU(gpu, depth_test_from_behind) {
    MeshVertex vertices[VERTEX_COUNT];
    make_scene(vertices);
    Stage stage = stage_open("behind", GPU_FORMAT_D32F, vertices, VERTEX_COUNT);
    const u32 expected[4] = {RED | GREEN, RED | GREEN, RED, BLACK};
    check_columns(draw_over(&stage, false, draw_back), expected);
    stage_close(&stage);
}

// An edge through the middle of pixels: the average of four samples; depth keeps the first. Both
// resolves happen in a rendering that draws nothing.
TEST_GPU(gpu, multisampled_targets_resolve) {
    MeshVertex vertices[12];
    push_rectangle(vertices, 0, 4.5f, 0.5f, true, 0xFFFFFFFF); // half a pixel's columns
    push_rectangle(vertices + 6, 8, 12, 0.25f, true, 0xFFFFFFFF);
    Stage stage = stage_open("multisampled", GPU_FORMAT_D32F, vertices, 12);
    Gpu *gpu = stage.gpu;
    if (!gpu_info(gpu)->samples_4) TEST_SKIP("no multisampling here");
    GpuTexture color_ms = make_target(gpu, "color ms", GPU_FORMAT_RGBA8, 4);
    GpuTexture depth_ms = make_target(gpu, "depth ms", GPU_FORMAT_D32F, 4);
    GpuBuffer depths = gpu_fixture_readback(gpu, SIDE * SIDE * 4);
    GpuPipeline write = stage_pipeline(
        &stage,
        (GpuPipelineDesc){.depth_format = GPU_FORMAT_D32F, .depth = GPU_DEPTH_WRITE, .samples = 4});
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_barriers(cmd,
                     (GpuBarrier[]){{.texture = color_ms, .to = GPU_USAGE_COLOR_TARGET},
                                    {.texture = depth_ms, .to = GPU_USAGE_DEPTH_TARGET},
                                    {.texture = stage.color, .to = GPU_USAGE_COLOR_TARGET},
                                    {.texture = stage.depth, .to = GPU_USAGE_DEPTH_RESOLVE}},
                     4);
    GpuRendering rendering = {.targets = {{.texture = color_ms, .clear = true}},
                              .target_count = 1,
                              .depth = {.texture = depth_ms, .clear = true}};
    gpu_cmd_begin_rendering(cmd, &rendering);
    stage_draw(&stage, cmd, write, 0, 12);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(
        cmd,
        (GpuBarrier[]){
            {.texture = color_ms, .from = GPU_USAGE_COLOR_TARGET, .to = GPU_USAGE_COLOR_TARGET},
            {.texture = depth_ms, .from = GPU_USAGE_DEPTH_TARGET, .to = GPU_USAGE_DEPTH_TEST}},
        2);
    rendering = (GpuRendering){.targets = {{.texture = color_ms, .resolve = stage.color}},
                               .target_count = 1,
                               .depth = {.texture = depth_ms, .resolve = stage.depth},
                               .depth_read_only = true};
    gpu_cmd_begin_rendering(cmd, &rendering);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(
        cmd,
        (GpuBarrier[]){
            {.texture = stage.color, .from = GPU_USAGE_COLOR_TARGET, .to = GPU_USAGE_COPY_SOURCE},
            {.texture = stage.depth, .from = GPU_USAGE_DEPTH_RESOLVE, .to = GPU_USAGE_COPY_SOURCE}},
        2);
    gpu_cmd_copy_texture_to_buffer(cmd, stage.color, stage.pixels);
    gpu_cmd_copy_texture_to_buffer(cmd, stage.depth, depths);
    assert_true(gpu_frame_end(gpu, true));
    const u32 *c = gpu_buffer_map(gpu, stage.pixels);
    const f32 *d = gpu_buffer_map(gpu, depths);
    for (u32 y = 0; y < SIDE; y++)
        for (u32 x = 0; x < SIDE; x++) {
            u32 red = c[y * SIDE + x] & 255;
            // Two of the four standard samples lie left of the middle.
            if (x == 4)
                assert_in_range(red, 127, 128);
            else
                assert_int_equal(red, x < 4 || (x >= 8 && x < 12) ? 255 : 0);
            if (x == 4) continue; // whichever sample is the first
            assert_true(d[y * SIDE + x] == (x < 4 ? 0.5f : x >= 8 && x < 12 ? 0.25f : 0.0f));
        }
    gpu_destroy_texture(gpu, color_ms);
    gpu_destroy_texture(gpu, depth_ms);
    gpu_destroy_buffer(gpu, depths);
    stage_close(&stage);
}
