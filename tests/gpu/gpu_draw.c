// gpu_draw.c: textures, rendering, depth, culling, blending: exact pixels.
#include "gpu_fixture.h"
#include <stdlib.h>
#include <string.h>

#define SIDE  32u
#define RED   0xFF0000FFu // RGBA8, red lowest
#define GREEN 0xFF00FF00u
#define BLUE  0xFFFF0000u
#define BLACK 0xFF000000u

static MeshVertex vertex(f32 x, f32 y, f32 z, u32 color) {
    return (MeshVertex){.position = {x, y, z}, .color = color};
}

static GpuTexture make_target(Gpu *gpu, const char *label, GpuFormat format) {
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = label,
                                                                   .heap = "targets",
                                                                   .format = format,
                                                                   .width = SIDE,
                                                                   .height = SIDE,
                                                                   .render_target = true,
                                                                   .sampled = true});
    assert_true(texture.id);
    return texture;
}

static GpuPipeline make_pipeline(Gpu *gpu, GpuFormat format, GpuBlend blend, GpuDepth depth,
                                 GpuCull cull) {
    return gpu_create_pipeline(
        gpu, &(GpuPipelineDesc){.label = "draw",
                                .vertex = "test_draw.vert",
                                .fragment = "test_draw.frag",
                                .push_size = 16,
                                .targets = {format},
                                .target_count = 1,
                                .depth_format = depth ? GPU_FORMAT_D32F : GPU_FORMAT_NONE,
                                .depth = depth,
                                .cull = cull,
                                .blend = blend,
                                .vertex_layout = GPU_VERTEX_MESH});
}

// Serves as the instance stream as well. As long as one instance a vertex: synchronisation
// validation 1.3.239 takes instance streams for vertex streams, and reads beyond the end would be
// its verdict.
static GpuBuffer make_vertices(Gpu *gpu, const MeshVertex *vertices, u32 count) {
    GpuBuffer buffer = gpu_create_buffer(
        gpu, &(GpuBufferDesc){
                 .label = "vertices", .size = count * sizeof(InstanceRecord), .vertex = true});
    gpu_upload_buffer(gpu, buffer, 0, vertices, count * sizeof(MeshVertex));
    return buffer;
}

// After the last rendering of a frame: the target's pixels into a buffer.
static void copy_out(GpuCommands *cmd, GpuTexture texture, GpuUsage from, GpuBuffer buffer) {
    gpu_cmd_barriers(
        cmd, &(GpuBarrier){.texture = texture, .from = from, .to = GPU_USAGE_COPY_SOURCE}, 1);
    gpu_cmd_copy_texture_to_buffer(cmd, texture, buffer);
}

// A near triangle in the lower left half, then a far one over everything, then one that faces away.
// Row 0 of the picture is the top: NDC y = 1.
TEST_GPU(gpu, draws_with_depth_and_culling) {
    Gpu *gpu = gpu_fixture_create("draws_with_depth_and_culling");
    MeshVertex vertices[] = {
        vertex(-1, -1, 0.75f, RED),   vertex(1, -1, 0.75f, RED),  vertex(-1, 1, 0.75f, RED),
        vertex(-1, -3, 0.25f, GREEN), vertex(3, 1, 0.25f, GREEN), vertex(-1, 1, 0.25f, GREEN),
        vertex(-1, -1, 1.0f, BLUE),   vertex(-1, 1, 1.0f, BLUE),  vertex(1, -1, 1.0f, BLUE),
    };
    GpuBuffer buffer = make_vertices(gpu, vertices, COUNT_OF(vertices));
    u16 index_list[] = {0, 1, 2, 0, 1, 2}; // the second three start at vertex_offset
    GpuBuffer indices = gpu_create_buffer(
        gpu, &(GpuBufferDesc){.label = "indices", .size = sizeof index_list, .index = true});
    gpu_upload_buffer(gpu, indices, 0, index_list, sizeof index_list);
    GpuTexture color = make_target(gpu, "color", GPU_FORMAT_RGBA8);
    GpuTexture depth = make_target(gpu, "depth", GPU_FORMAT_D32F);
    GpuPipeline pipeline =
        make_pipeline(gpu, GPU_FORMAT_RGBA8, GPU_BLEND_NONE, GPU_DEPTH_WRITE, GPU_CULL_BACK);
    assert_true(pipeline.id);
    GpuBuffer pixels = gpu_fixture_readback(gpu, SIDE * SIDE * 4);
    GpuBuffer depths = gpu_fixture_readback(gpu, SIDE * SIDE * 4);

    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_barriers(cmd,
                     (GpuBarrier[]){{.texture = color, .to = GPU_USAGE_COLOR_TARGET},
                                    {.texture = depth, .to = GPU_USAGE_DEPTH_TARGET}},
                     2);
    gpu_cmd_begin_rendering(cmd, &(GpuRendering){.targets = {{color, true, {0, 0, 0, 1}}},
                                                 .target_count = 1,
                                                 .depth = {depth, true, {0}},
                                                 .width = SIDE,
                                                 .height = SIDE});
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_push(cmd, (f32[]){1, 1, 1, 1}, 16);
    gpu_cmd_bind_vertices(cmd, 0, buffer, 0);
    gpu_cmd_bind_vertices(cmd, 1, buffer, 0); // the test shader reads no instance
    gpu_cmd_bind_indices(cmd, indices, true);
    gpu_cmd_draw_indexed(cmd, 3, 1, 0, 0, 0);
    gpu_cmd_draw_indexed(cmd, 3, 1, 3, 3, 0);
    gpu_cmd_draw(cmd, 3, 1, 6, 0);
    gpu_cmd_end_rendering(cmd);
    copy_out(cmd, color, GPU_USAGE_COLOR_TARGET, pixels);
    copy_out(cmd, depth, GPU_USAGE_DEPTH_TARGET, depths);
    assert_true(gpu_frame_end(gpu, true));

    const u32 *c = gpu_buffer_map(gpu, pixels);
    const f32 *d = gpu_buffer_map(gpu, depths);
    for (u32 y = 0; y < SIDE; y++)
        for (u32 x = 0; x < SIDE; x++) {
            // Pixel centres on the diagonal are on the edge of both: leave them out.
            if (x == y) continue;
            bool is_near = y > x; // below the diagonal from the top left to the bottom right
            assert_int_equal(c[y * SIDE + x], is_near ? RED : GREEN);
            assert_true(d[y * SIDE + x] == (is_near ? 0.75f : 0.25f));
        }
    gpu_destroy_buffer(gpu, buffer);
    gpu_destroy_buffer(gpu, indices);
    gpu_destroy_buffer(gpu, pixels);
    gpu_destroy_buffer(gpu, depths);
    gpu_destroy_texture(gpu, color);
    gpu_destroy_texture(gpu, depth);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_fixture_destroy(gpu);
}

// Depth is tested and sampled at once in its read-only layout, and read by compute without a
// barrier between.
TEST_GPU(gpu, depth_is_tested_and_sampled) {
    Gpu *gpu = gpu_fixture_create("depth_is_tested_and_sampled");
    // Upper right half; lower right half at the same depth; lower right half further away.
    MeshVertex vertices[] = {
        vertex(1, -1, 0.5f, RED),    vertex(1, 1, 0.5f, RED),    vertex(-1, 1, 0.5f, RED),
        vertex(-1, -1, 0.5f, GREEN), vertex(1, -1, 0.5f, GREEN), vertex(1, 1, 0.5f, GREEN),
        vertex(-1, -1, 0.25f, BLUE), vertex(1, -1, 0.25f, BLUE), vertex(1, 1, 0.25f, BLUE)};
    GpuBuffer buffer = make_vertices(gpu, vertices, COUNT_OF(vertices));
    GpuTexture color = make_target(gpu, "color", GPU_FORMAT_RGBA8);
    GpuTexture depth = make_target(gpu, "depth", GPU_FORMAT_D32F);
    GpuPipeline write =
        make_pipeline(gpu, GPU_FORMAT_RGBA8, GPU_BLEND_NONE, GPU_DEPTH_WRITE, GPU_CULL_NONE);
    GpuPipeline equal =
        make_pipeline(gpu, GPU_FORMAT_RGBA8, GPU_BLEND_NONE, GPU_DEPTH_EQUAL, GPU_CULL_NONE);
    GpuPipeline test =
        make_pipeline(gpu, GPU_FORMAT_RGBA8, GPU_BLEND_NONE, GPU_DEPTH_TEST, GPU_CULL_NONE);
    GpuBuffer pixels = gpu_fixture_readback(gpu, SIDE * SIDE * 4);
    GpuBuffer sampled = gpu_fixture_readback(gpu, SIDE * SIDE * 16);
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_SAMPLED_TEXTURE, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline sample = gpu_fixture_compute(gpu, "test_sample.comp", layout, 0, NULL);
    GpuSampler nearest =
        gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "nearest", .nearest = true});
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){
                 .label = "depth group",
                 .layout = layout,
                 .bindings = {{.texture = depth, .sampler = nearest}, {.buffer = sampled}}});

    GpuCommands *cmd = gpu_frame_begin(gpu);
    GpuRendering rendering = {.targets = {{color, true, {0, 0, 0, 1}}},
                              .target_count = 1,
                              .depth = {depth, true, {0}},
                              .width = SIDE,
                              .height = SIDE};
    gpu_cmd_barriers(cmd,
                     (GpuBarrier[]){{.texture = color, .to = GPU_USAGE_COLOR_TARGET},
                                    {.texture = depth, .to = GPU_USAGE_DEPTH_TARGET}},
                     2);
    gpu_cmd_begin_rendering(cmd, &rendering);
    gpu_cmd_bind_pipeline(cmd, write);
    gpu_cmd_push(cmd, (f32[]){1, 1, 1, 1}, 16);
    gpu_cmd_bind_vertices(cmd, 0, buffer, 0);
    gpu_cmd_bind_vertices(cmd, 1, buffer, 0); // the test shader reads no instance
    gpu_cmd_draw(cmd, 3, 1, 0, 0);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(
        cmd,
        (GpuBarrier[]){
            {.texture = depth, .from = GPU_USAGE_DEPTH_TARGET, .to = GPU_USAGE_DEPTH_TEST},
            {.texture = color, .from = GPU_USAGE_COLOR_TARGET, .to = GPU_USAGE_COLOR_TARGET}},
        2);
    rendering.targets[0].clear = rendering.depth.clear = false;
    rendering.depth_read_only = true;
    gpu_cmd_begin_rendering(cmd, &rendering);
    gpu_cmd_bind_pipeline(cmd, equal);
    gpu_cmd_push(cmd, (f32[]){1, 1, 1, 1}, 16);
    gpu_cmd_bind_vertices(cmd, 0, buffer, 0);
    gpu_cmd_bind_vertices(cmd, 1, buffer, 0); // the test shader reads no instance
    gpu_cmd_draw(cmd, 3, 1, 3, 0);            // equal where both triangles are
    gpu_cmd_bind_pipeline(cmd, test);
    gpu_cmd_draw(cmd, 3, 1, 6, 0); // behind the first, before nothing
    gpu_cmd_end_rendering(cmd);
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_DEPTH_TEST, GPU_USAGE_SAMPLED_COMPUTE));
    gpu_cmd_bind_pipeline(cmd, sample);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_push(cmd, (u32[]){SIDE, SIDE, 0}, 12);
    gpu_cmd_dispatch(cmd, SIDE / 8, SIDE / 8, 1);
    copy_out(cmd, color, GPU_USAGE_COLOR_TARGET, pixels);
    assert_true(gpu_frame_end(gpu, true));

    const u32 *c = gpu_buffer_map(gpu, pixels);
    const f32 *s = gpu_buffer_map(gpu, sampled);
    for (u32 y = 0; y < SIDE; y++)
        for (u32 x = 0; x < SIDE; x++) {
            if (x == y || x + y == SIDE - 1) continue; // edges
            bool first = x > y, second = x + y > SIDE - 1;
            // EQUAL draws where the first one was; the far one shows only where it was not.
            u32 expected = first && second ? GREEN : first ? RED : second ? BLUE : BLACK;
            assert_int_equal(c[y * SIDE + x], expected);
            assert_true(s[(y * SIDE + x) * 4] == (first ? 0.5f : 0.0f));
        }
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_sampler(gpu, nearest);
    gpu_destroy_pipeline(gpu, write);
    gpu_destroy_pipeline(gpu, equal);
    gpu_destroy_pipeline(gpu, test);
    gpu_destroy_pipeline(gpu, sample);
    gpu_destroy_buffer(gpu, buffer);
    gpu_destroy_buffer(gpu, pixels);
    gpu_destroy_buffer(gpu, sampled);
    gpu_destroy_texture(gpu, color);
    gpu_destroy_texture(gpu, depth);
    gpu_fixture_destroy(gpu);
}

static f32 half_to_f32(u16 h) {
    u32 exponent = h >> 10 & 31, mantissa = h & 1023;
    f32 value =
        exponent ? ldexpf((f32)(mantissa + 1024), (int)exponent - 25) : ldexpf((f32)mantissa, -24);
    return h >> 15 ? -value : value;
}

// 1000 layers of a small value add up beyond what 8 bits could hold.
static void blend_layers(GpuFormat format, GpuBlend blend, f32 out[4]) {
    Gpu *gpu = gpu_fixture_create("blend");
    MeshVertex vertices[] = {vertex(-1, -1, 0.5f, 0xFFFFFFFF), vertex(3, -1, 0.5f, 0xFFFFFFFF),
                             vertex(-1, 3, 0.5f, 0xFFFFFFFF)};
    GpuBuffer buffer = make_vertices(gpu, vertices, COUNT_OF(vertices));
    GpuTexture color = make_target(gpu, "color", format);
    GpuPipeline pipeline = make_pipeline(gpu, format, blend, GPU_DEPTH_NONE, GPU_CULL_BACK);
    assert_true(pipeline.id);
    GpuBuffer pixels = gpu_fixture_readback(gpu, SIDE * SIDE * 16);
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_barriers(cmd, &(GpuBarrier){.texture = color, .to = GPU_USAGE_COLOR_TARGET}, 1);
    gpu_cmd_begin_rendering(cmd, &(GpuRendering){.targets = {{color, true, {1, 2, 0, 0}}},
                                                 .target_count = 1,
                                                 .width = SIDE,
                                                 .height = SIDE});
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_vertices(cmd, 0, buffer, 0);
    gpu_cmd_bind_vertices(cmd, 1, buffer, 0); // the test shader reads no instance
    if (blend == GPU_BLEND_ADD) {
        gpu_cmd_push(cmd, (f32[]){0.25f, 0.5f, 1.0f, 0.0f}, 16);
        for (u32 i = 0; i < 64; i++) gpu_cmd_draw(cmd, 3, 1, 0, 0);
    } else {
        gpu_cmd_push(cmd, (f32[]){4.0f, 4.0f, 4.0f, 0.25f}, 16);
        gpu_cmd_draw(cmd, 3, 1, 0, 0);
    }
    gpu_cmd_end_rendering(cmd);
    copy_out(cmd, color, GPU_USAGE_COLOR_TARGET, pixels);
    assert_true(gpu_frame_end(gpu, true));
    const void *data = gpu_buffer_map(gpu, pixels);
    u32 middle = (SIDE / 2 * SIDE + SIDE / 2) * 4;
    for (u32 i = 0; i < 4; i++)
        out[i] = format == GPU_FORMAT_RGBA32F ? ((const f32 *)data)[middle + i]
                                              : half_to_f32(((const u16 *)data)[middle + i]);
    gpu_destroy_buffer(gpu, buffer);
    gpu_destroy_buffer(gpu, pixels);
    gpu_destroy_texture(gpu, color);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_fixture_destroy(gpu);
}

TEST_GPU(gpu, blends) {
    GpuFormat formats[] = {GPU_FORMAT_RGBA16F, GPU_FORMAT_RGBA32F};
    for (u32 i = 0; i < 2; i++) {
        f32 c[4];
        blend_layers(formats[i], GPU_BLEND_ADD, c);
        assert_true(c[0] == 17.0f && c[1] == 34.0f && c[2] == 64.0f && c[3] == 0.0f);
        blend_layers(formats[i], GPU_BLEND_ALPHA, c); // source 0.25, target 0.75
        assert_true(c[0] == 1.75f && c[1] == 2.5f && c[2] == 1.0f && c[3] == 0.25f);
    }
}

TEST_GPU(gpu, uploads_and_samples_every_mip) {
    Gpu *gpu = gpu_fixture_create("uploads_and_samples_every_mip");
    // 37 x 19: odd sizes, rows that are no multiple of anything.
    enum { WIDTH = 37, HEIGHT = 19, MIPS = 6 };
    u32 texel_count = 0;
    for (u32 m = 0; m < MIPS; m++) texel_count += MAX(WIDTH >> m, 1) * MAX(HEIGHT >> m, 1);
    u8(*texels)[4] = malloc(texel_count * sizeof *texels);
    for (u32 i = 0; i < texel_count; i++) {
        texels[i][0] = (u8)(i * 7);
        texels[i][1] = (u8)(i >> 3);
        texels[i][2] = (u8)(255 - i);
        texels[i][3] = (u8)(i % 3 * 100);
    }
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "texture",
                                                                   .format = GPU_FORMAT_RGBA8,
                                                                   .width = WIDTH,
                                                                   .height = HEIGHT,
                                                                   .mip_count = MIPS,
                                                                   .sampled = true});
    gpu_upload_texture(gpu, texture, texels, texel_count * sizeof *texels);
    gpu_upload_texture(gpu, texture, texels, texel_count * sizeof *texels); // again: still in order
    GpuSampler nearest =
        gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "nearest", .nearest = true});
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_SAMPLED_TEXTURE, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_sample.comp", layout, 0, NULL);
    GpuBuffer out = gpu_fixture_readback(gpu, WIDTH * HEIGHT * 16);
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){
                 .label = "group",
                 .layout = layout,
                 .bindings = {{.texture = texture, .sampler = nearest}, {.buffer = out}}});
    u32 first = 0;
    for (u32 m = 0; m < MIPS; m++) {
        u32 width = MAX(WIDTH >> m, 1), height = MAX(HEIGHT >> m, 1);
        GpuCommands *cmd = gpu_frame_begin(gpu);
        gpu_cmd_bind_pipeline(cmd, pipeline);
        gpu_cmd_bind_group(cmd, 0, group);
        gpu_cmd_push(cmd, (u32[]){width, height, m}, 12);
        gpu_cmd_dispatch(cmd, (width + 7) / 8, (height + 7) / 8, 1);
        assert_true(gpu_frame_end(gpu, true));
        const f32 *values = gpu_buffer_map(gpu, out);
        for (u32 i = 0; i < width * height; i++)
            for (u32 c = 0; c < 4; c++)
                ASSERT_NEAR(values[i * 4 + c] * 255.0f, texels[first + i][c], 0.01);
        first += width * height;
    }
    free(texels);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_sampler(gpu, nearest);
    gpu_destroy_texture(gpu, texture);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

// Larger than a staging chunk, in rows and in slices.
TEST_GPU(gpu, uploads_large_textures) {
    Gpu *gpu = gpu_fixture_create("uploads_large_textures");
    u32 sizes[2][3] = {{2048, 700, 1}, {128, 128, 65}};
    for (u32 t = 0; t < 2; t++) {
        u64 count = (u64)sizes[t][0] * sizes[t][1] * sizes[t][2];
        u32 *texels = malloc(count * 4);
        for (u64 i = 0; i < count; i++) texels[i] = (u32)i * 2654435761u;
        GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "large",
                                                                       .format = GPU_FORMAT_R32U,
                                                                       .width = sizes[t][0],
                                                                       .height = sizes[t][1],
                                                                       .depth = sizes[t][2],
                                                                       .sampled = true});
        GpuBuffer out = gpu_fixture_readback(gpu, count * 4);
        gpu_upload_texture(gpu, texture, texels, count * 4);
        GpuCommands *cmd = gpu_frame_begin(gpu);
        copy_out(cmd, texture, GPU_USAGE_SAMPLED_FRAGMENT, out);
        assert_true(gpu_frame_end(gpu, true));
        assert_memory_equal(gpu_buffer_map(gpu, out), texels, count * 4);
        free(texels);
        gpu_destroy_texture(gpu, texture);
        gpu_destroy_buffer(gpu, out);
    }
    gpu_fixture_destroy(gpu);
}

TEST_GPU(gpu, stores_to_a_texture) {
    Gpu *gpu = gpu_fixture_create("stores_to_a_texture");
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "stored",
                                                                   .format = GPU_FORMAT_RGBA32F,
                                                                   .width = 20,
                                                                   .height = 12,
                                                                   .storage = true});
    GpuBindLayout layout = gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_TEXTURE, 0, 1);
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_store.comp", layout, 0, NULL);
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){
                 .label = "group", .layout = layout, .bindings = {{.texture = texture}}});
    GpuBuffer out = gpu_fixture_readback(gpu, 20 * 12 * 16);
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_barriers(cmd, &(GpuBarrier){.texture = texture, .to = GPU_USAGE_STORAGE_COMPUTE}, 1);
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_dispatch(cmd, 3, 2, 1);
    copy_out(cmd, texture, GPU_USAGE_STORAGE_COMPUTE, out);
    assert_true(gpu_frame_end(gpu, true));
    const f32 *values = gpu_buffer_map(gpu, out);
    for (u32 y = 0; y < 12; y++)
        for (u32 x = 0; x < 20; x++) {
            const f32 *v = values + (y * 20 + x) * 4;
            assert_true(v[0] == (f32)x && v[1] == (f32)y && v[2] == 0.5f && v[3] == -1.0f);
        }
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_texture(gpu, texture);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}
