// gi_light_stage.c: see gi_light_stage.h. Data in: seeds. Data out: what the shader wrote, and what
// the twin says. Called by: gi_light.c.
#include "gi_light_stage.h"
#include "../../engine/base/random.h"
#include <stdlib.h>
#include <string.h>

#define VOXEL_M 0.25f

static f32 uniform(u64 seed, u32 a, u32 b) {
    return (f32)(random_u32(seed, a, b) >> 8) * (1.0f / 16777216.0f);
}
static void unit_vector(u64 seed, u32 a, f32 out[3]) {
    f32 z = uniform(seed, a, 0) * 2 - 1, turn = uniform(seed, a, 1) * 6.2831853f;
    f32 r = sqrtf(1 - z * z);
    out[0] = r * cosf(turn), out[1] = r * sinf(turn), out[2] = z;
}

// --- Making ---

static u32 pack_normal(const f32 n[3]) {
    u32 q[3];
    for (u32 i = 0; i < 3; i++) q[i] = (u32)((n[i] * 0.5f + 0.5f) * 1023.0f + 0.5f);
    return q[0] | q[1] << 10 | q[2] << 20;
}

// A third of the voxels are thin walls, whose normals cancel out.
static void make_surface(VoxelScene *stage, u64 seed, u32 slot) {
    u32 *words = stage->attributes + (u64)slot * GI_ATTRIBUTE_WORDS;
    f32 n[3], mean[3], faces[6];
    unit_vector(seed, slot, n);
    bool thin = uniform(seed, slot, 2) < 0.33f;
    for (u32 i = 0; i < 3; i++) {
        mean[i] = thin ? 0.0f : n[i] * (0.5f + 0.5f * uniform(seed, slot, 3));
        faces[2 * i] = thin ? fabsf(n[i]) * 0.5f : MAX(n[i], 0.0f);
        faces[2 * i + 1] = thin ? fabsf(n[i]) * 0.5f : MAX(-n[i], 0.0f);
    }
    words[GI_ATTRIBUTE_ALBEDO] = random_u32(seed, slot, 4) | 0xFF000000u;
    words[GI_ATTRIBUTE_NORMAL] = pack_normal(mean);
    // Shared exponent 16: 511 means 511/512 * 2.
    words[GI_ATTRIBUTE_EMISSION] =
        uniform(seed, slot, 5) < 0.1f ? (random_u32(seed, slot, 6) & 0x7FFFFFF) | 16u << 27 : 0;
    words[GI_ATTRIBUTE_FACES_0] = words[GI_ATTRIBUTE_FACES_1] = 0;
    for (u32 f = 0; f < 6; f++)
        words[f < 4 ? GI_ATTRIBUTE_FACES_0 : GI_ATTRIBUTE_FACES_1] |=
            (u32)(faces[f] * 255.0f + 0.5f) << 8 * (f & 3);
}

void voxel_scene_voxels(VoxelScene *stage, u64 seed, u32 x, u32 y, u32 z, u32 cascades, u32 share) {
    memset(stage, 0, sizeof *stage);
    stage->gi.dims[0] = x, stage->gi.dims[1] = y, stage->gi.dims[2] = z;
    stage->gi.dims[3] = cascades;
    for (u32 c = 0; c < cascades; c++) {
        f32 size = VOXEL_M * (f32)(1u << c);
        const u32 dims[3] = {x, y, z};
        for (u32 a = 0; a < 3; a++)
            stage->gi.origin[c][a] = -0.5f * size * (f32)dims[a] + 0.125f * (f32)a;
        stage->gi.origin[c][3] = size;
    }
    stage->gi.strength[3] = 1.0f;
    stage->gi.scale[0] = 4.0f;
    u32 bits = x * y * z * cascades, words = bits / 32;
    stage->masks = calloc(GI_MASK_COUNT * (u64)words, sizeof(u32));
    u32 *layers[2] = {stage->masks + GI_MASK_STATIC * words,
                      stage->masks + GI_MASK_DYNAMIC * words};
    for (u32 bit = 0; bit < bits; bit++) {
        u32 lot = random_u32(seed, 1, bit) % 1000;
        if (lot >= share) continue;
        layers[lot % 4 == 0 ? 1 : 0][bit / 32] |= 1u << bit % 32;
        stage->slot_count++;
    }
    stage->places = calloc(stage->slot_count, sizeof(u32));
    stage->attributes = calloc((u64)stage->slot_count * GI_ATTRIBUTE_WORDS, sizeof(u32));
    u32 slot = 0;
    for (u32 layer = 0; layer < 2; layer++) {
        for (u32 bit = 0; bit < bits; bit++)
            if (layers[layer][bit / 32] >> bit % 32 & 1)
                stage->places[slot++] = bit % x << GI_VOXEL_X_SHIFT |
                                        bit / x % y << GI_VOXEL_Y_SHIFT |
                                        bit / (x * y) << GI_VOXEL_Z_SHIFT;
        if (layer == 0) stage->static_count = slot;
    }
    for (u32 s = 0; s < slot; s++) make_surface(stage, seed + 1, s);
    stage->gi.counts[2] = stage->slot_count;
    stage->spec[SPEC_GI_DIRECTIONS] = 6;
    stage->spec[SPEC_GI_CASCADES] = cascades;
    stage->spec[SPEC_GI_COSINE] = 1;
    stage->frame.attenuation[0] = 1.0f, stage->frame.attenuation[1] = 0.7f;
    stage->frame.attenuation[2] = 1.8f;
    for (u32 i = 0; i < 4; i++) stage->frame.shadow_matrix[5 * i] = 1.0f;
}

void voxel_scene_lights(VoxelScene *stage, u64 seed, u32 count, f32 range_m, u32 ways) {
    stage->light_cap = MAX(count, GI_LIGHT_BLOCK_CAP);
    stage->lights = calloc(stage->light_cap, sizeof *stage->lights);
    stage->light_count = count;
    const f32 *box = stage->gi.origin[stage->gi.dims[3] - 1];
    for (u32 i = 0; i < count; i++) {
        GiLightRecord *light = &stage->lights[i];
        for (u32 a = 0; a < 3; a++) {
            f32 side = box[3] * (f32)stage->gi.dims[a];
            light->position[a] = box[a] + side * (uniform(seed, i, a) * 1.2f - 0.1f);
            light->color[a] = 4.0f * uniform(seed, i, 3 + a);
        }
        f32 range = range_m * (0.5f + uniform(seed, i, 6));
        light->position[3] = 1.0f / (range * range);
        u32 way;
        for (way = random_u32(seed, i, 7) % 4; !(ways >> way & 1); way = (way + 1) % 4) {
        }
        light->color[3] = (f32)way;
        bool spot = uniform(seed, i, 8) < 0.4f;
        unit_vector(seed + 1, i, light->direction);
        light->direction[3] = spot ? 0.3f + 0.5f * uniform(seed, i, 9) : -2.0f;
        light->extra[0] = spot ? 8.0f : 0.0f;
        light->extra[1] = spot ? 1.0f : 0.0f;
    }
    stage->spec[SPEC_GI_VISIBILITY] |= (ways & 0xCu) | GI_VISIBILITY_SPOTS;
    if (count <= GI_LIGHT_BLOCK_CAP) stage->spec[SPEC_GI_VISIBILITY] |= GI_VISIBILITY_BLOCK;
    voxel_scene_list_all(stage);
}

void voxel_scene_list_all(VoxelScene *stage) {
    free(stage->lists);
    stage->list_words = 2 + stage->light_count;
    stage->lists = calloc(stage->list_words, sizeof(u32));
    stage->lists[0] = 2, stage->lists[1] = stage->light_count;
    for (u32 i = 0; i < stage->light_count; i++) stage->lists[2 + i] = i;
    const f32 *box = stage->gi.origin[stage->gi.dims[3] - 1];
    for (u32 a = 0; a < 3; a++) {
        stage->gi.light_grid[a] = 1;
        stage->gi.light_grid_origin[a] = box[a];
        stage->gi.light_grid_rate[a] = 1.0f / (box[3] * (f32)stage->gi.dims[a]);
    }
    stage->gi.light_grid[3] = stage->light_count;
}

void voxel_scene_free(VoxelScene *stage) {
    free(stage->masks);
    free(stage->places);
    free(stage->attributes);
    free(stage->lights);
    free(stage->lists);
    memset(stage, 0, sizeof *stage);
}

// --- Running ---

typedef struct Bench {
    Gpu *gpu;
    GpuBindLayout layout;
    GpuBindGroup group;
    GpuPipeline pipeline;
    GpuSampler linear, compare;
    GpuBuffer buffers[16], dummy, radiance[2], base_bytes, visibility_bytes;
    u32 buffer_count;
    GpuTexture base, visibility, map, stand_in;
} Bench;

static GpuBuffer keep(Bench *b, const char *label, const void *data, u64 size, bool indirect) {
    GpuBuffer buffer = gpu_create_buffer(
        b->gpu, &(GpuBufferDesc){.label = label, .size = MAX(size, 256), .indirect = indirect});
    assert_true(buffer.id);
    if (data && size) gpu_upload_buffer(b->gpu, buffer, 0, data, size);
    b->buffers[b->buffer_count++] = buffer;
    return buffer;
}
static GpuTexture volume(Bench *b, const char *label, GpuFormat format, const u32 *dims) {
    GpuTexture texture =
        gpu_create_texture(b->gpu, &(GpuTextureDesc){.label = label,
                                                     .format = format,
                                                     .width = dims ? dims[0] : 2,
                                                     .height = dims ? dims[1] : 2,
                                                     .depth = dims ? dims[2] * dims[3] : 2,
                                                     .storage = true,
                                                     .sampled = true});
    assert_true(texture.id);
    return texture;
}

static void bench_textures(Bench *b, const VoxelScene *stage) {
    const u32 *dims = stage->gi.dims;
    bool bytes = stage->spec[SPEC_GI_FORMAT] != 0;
    b->base = volume(b, "base", bytes ? GPU_FORMAT_RGBA8 : GPU_FORMAT_RGBA16F, dims);
    b->visibility = volume(b, "visibility", GPU_FORMAT_R8, dims);
    b->stand_in = volume(b, "stand-in", GPU_FORMAT_RGBA16F, NULL);
    b->map = gpu_create_texture(b->gpu, &(GpuTextureDesc){.label = "shadow map",
                                                          .format = GPU_FORMAT_D32F,
                                                          .width = 16,
                                                          .height = 16,
                                                          .render_target = true,
                                                          .sampled = true});
    b->linear = gpu_create_sampler(b->gpu, &(GpuSamplerDesc){.label = "linear"});
    b->compare =
        gpu_create_sampler(b->gpu, &(GpuSamplerDesc){.label = "compare", .compare_greater = true});
}

static void bench_group(Bench *b, const VoxelScene *stage) {
    const u32 *dims = stage->gi.dims;
    u64 slots = stage->slot_count, layer = dims[0] * dims[1] * dims[2] * dims[3] / 8;
    u32 counters[GI_COUNTER_COUNT] = {
        [GI_COUNTER_STATIC] = stage->static_count,
        [GI_COUNTER_DYNAMIC] = stage->slot_count - stage->static_count,
        [GI_COUNTER_ALL_ARGS] = (u32)(slots + 63) / 64,
        [GI_COUNTER_ALL_ARGS + 1] = 1,
        [GI_COUNTER_ALL_ARGS + 2] = 1,
    };
    GpuBindGroupDesc desc = {.label = "build", .layout = b->layout};
    GpuBinding *bind = desc.bindings;
    b->dummy = keep(b, "dummy", NULL, GPU_UNIFORM_RANGE, false);
    for (u32 i = 0; i < BUILD_FIRST_IMAGE; i++) bind[i].buffer = b->dummy;
    for (u32 i = BUILD_FIRST_IMAGE; i < BUILD_COUNT; i++)
        bind[i] = (GpuBinding){.texture = b->stand_in, .sampler = b->linear};
    bind[BUILD_GI].buffer = bind[BUILD_FLOW].buffer =
        keep(b, "gi", &stage->gi, sizeof stage->gi, false);
    bind[BUILD_FRAME].buffer = keep(b, "frame", &stage->frame, sizeof stage->frame, false);
    bind[BUILD_DIRECTIONALS].buffer =
        keep(b, "directionals", stage->directionals, sizeof stage->directionals, false);
    bind[BUILD_MASKS].buffer = keep(b, "masks", stage->masks, GI_MASK_COUNT * layer, false);
    bind[BUILD_VOXELS].buffer = keep(b, "voxels", stage->places, slots * 4, false);
    bind[BUILD_ATTRIBUTES].buffer =
        keep(b, "attributes", stage->attributes, slots * 4 * GI_ATTRIBUTE_WORDS, false);
    bind[BUILD_COUNTERS].buffer = keep(b, "counters", counters, sizeof counters, true);
    bind[BUILD_LIGHTS].buffer = bind[BUILD_LIGHT_BLOCK].buffer =
        keep(b, "lights", stage->lights, stage->light_cap * sizeof(GiLightRecord), false);
    bind[BUILD_LISTS].buffer = keep(b, "lists", stage->lists, stage->list_words * 4, false);
    bind[BUILD_RADIANCE].buffer = b->radiance[0];
    bind[BUILD_RADIANCE_2].buffer = b->radiance[1];
    bind[BUILD_SHADOW_MAP] = (GpuBinding){.texture = b->map, .sampler = b->compare};
    bind[BUILD_BASE] = (GpuBinding){.texture = b->base, .sampler = b->linear};
    bind[BUILD_BASE_STORAGE] = (GpuBinding){.texture = b->base};
    bind[BUILD_VISIBILITY] = (GpuBinding){.texture = b->visibility};
    b->group = gpu_create_bind_group(b->gpu, &desc);
    assert_true(b->group.id);
}

static void bench_frame(Bench *b, const VoxelScene *stage, GpuBuffer counters) {
    GpuCommands *cmd = gpu_frame_begin(b->gpu);
    assert_non_null(cmd);
    gpu_cmd_barriers(
        cmd, &(GpuBarrier){.texture = b->map, .to = GPU_USAGE_DEPTH_TARGET, .discard = true}, 1);
    gpu_cmd_begin_rendering(
        cmd, &(GpuRendering){
                 .depth = {.texture = b->map, .clear = true, .clear_value = {stage->map_depth}},
                 .width = 16,
                 .height = 16});
    gpu_cmd_end_rendering(cmd);
    const GpuTexture written[] = {b->base, b->visibility, b->stand_in};
    for (u32 i = 0; i < COUNT_OF(written); i++) {
        gpu_cmd_barriers(cmd, &(GpuBarrier){.texture = written[i], .to = GPU_USAGE_COPY_TARGET}, 1);
        gpu_cmd_clear_texture(cmd, written[i]);
        gpu_cmd_barriers(
            cmd,
            &(GpuBarrier){.texture = written[i],
                          .from = GPU_USAGE_COPY_TARGET,
                          .to = i == 2 ? GPU_USAGE_SAMPLED_COMPUTE : GPU_USAGE_STORAGE_COMPUTE},
            1);
    }
    gpu_cmd_barriers(cmd,
                     &(GpuBarrier){.texture = b->map,
                                   .from = GPU_USAGE_DEPTH_TARGET,
                                   .to = GPU_USAGE_SAMPLED_COMPUTE},
                     1);
    gpu_cmd_bind_pipeline(cmd, b->pipeline);
    gpu_cmd_bind_group(cmd, 0, b->group);
    gpu_cmd_dispatch_indirect(cmd, counters, GI_COUNTER_ALL_ARGS * sizeof(u32));
    const GpuBuffer to[] = {b->base_bytes, b->visibility_bytes};
    for (u32 i = 0; i < 2; i++) {
        gpu_cmd_barriers(cmd,
                         &(GpuBarrier){.texture = written[i],
                                       .from = GPU_USAGE_STORAGE_COMPUTE,
                                       .to = GPU_USAGE_COPY_SOURCE},
                         1);
        gpu_cmd_copy_texture_to_buffer(cmd, written[i], to[i]);
    }
    assert_true(gpu_frame_end(b->gpu, true));
}

static void bench_read(Bench *b, const VoxelScene *stage, LightResult *result) {
    const u32 *dims = stage->gi.dims;
    u32 faces = stage->spec[SPEC_GI_FACES] ? 6 : 1;
    u64 voxels = dims[0] * dims[1] * dims[2] * dims[3], numbers = (u64)stage->slot_count * faces;
    result->radiance = malloc(numbers * 4 * sizeof(f32));
    const u16 *halves[2] = {gpu_buffer_map(b->gpu, b->radiance[0]),
                            gpu_buffer_map(b->gpu, b->radiance[1])};
    gi_radiance_floats(halves, stage->slot_count, faces, result->radiance);
    result->base_bytes = voxels * (stage->spec[SPEC_GI_FORMAT] ? 4 : 8);
    result->base = malloc(result->base_bytes);
    memcpy(result->base, gpu_buffer_map(b->gpu, b->base_bytes), result->base_bytes);
    result->visibility = malloc(voxels);
    memcpy(result->visibility, gpu_buffer_map(b->gpu, b->visibility_bytes), voxels);
}

LightResult voxel_scene_run(VoxelScene *stage) {
    LightResult result = {0};
    Bench b = {.gpu = gpu_fixture_create("voxel light")};
    const u32 *dims = stage->gi.dims;
    u64 voxels = dims[0] * dims[1] * dims[2] * dims[3];
    GpuBindLayoutDesc layout = {.label = "build", .count = BUILD_COUNT};
    for (u32 i = 0; i < BUILD_COUNT; i++)
        layout.kinds[i] = i < BUILD_FIRST_STORAGE         ? GPU_BINDING_UNIFORM_BUFFER
                          : i < BUILD_FIRST_IMAGE         ? GPU_BINDING_STORAGE_BUFFER
                          : i < BUILD_FIRST_STORAGE_IMAGE ? GPU_BINDING_SAMPLED_TEXTURE
                                                          : GPU_BINDING_STORAGE_TEXTURE;
    b.layout = gpu_create_bind_layout(b.gpu, &layout);
    for (u32 i = 0; i < 2; i++)
        b.radiance[i] = gpu_fixture_readback(b.gpu, (u64)stage->slot_count * 3 * 8);
    b.base_bytes = gpu_fixture_readback(b.gpu, voxels * 8);
    b.visibility_bytes = gpu_fixture_readback(b.gpu, voxels);
    bench_textures(&b, stage);
    bench_group(&b, stage);
    b.pipeline = gpu_fixture_compute(
        b.gpu, stage->spec[SPEC_GI_FORMAT] ? "gi_light_byte.comp" : "gi_light.comp", b.layout,
        SPEC_COUNT, stage->spec);
    bench_frame(&b, stage, b.buffers[7]);
    bench_read(&b, stage, &result);
    gpu_destroy_bind_group(b.gpu, b.group);
    gpu_destroy_pipeline(b.gpu, b.pipeline);
    for (u32 i = 0; i < b.buffer_count; i++) gpu_destroy_buffer(b.gpu, b.buffers[i]);
    for (u32 i = 0; i < 2; i++) gpu_destroy_buffer(b.gpu, b.radiance[i]);
    gpu_destroy_buffer(b.gpu, b.base_bytes);
    gpu_destroy_buffer(b.gpu, b.visibility_bytes);
    gpu_destroy_texture(b.gpu, b.base);
    gpu_destroy_texture(b.gpu, b.visibility);
    gpu_destroy_texture(b.gpu, b.stand_in);
    gpu_destroy_texture(b.gpu, b.map);
    gpu_destroy_sampler(b.gpu, b.linear);
    gpu_destroy_sampler(b.gpu, b.compare);
    gpu_fixture_destroy(b.gpu);
    return result;
}

void light_result_free(LightResult *result) {
    free(result->radiance);
    free(result->base);
    free(result->visibility);
}

f32 half_to_float(u16 half) {
    u32 exponent = half >> 10 & 31, mantissa = half & 1023;
    f32 value =
        exponent ? ldexpf((f32)(1024 + mantissa), (int)exponent - 25) : ldexpf((f32)mantissa, -24);
    return half >> 15 ? -value : value;
}

void gi_radiance_floats(const u16 *const halves[2], u32 slots, u32 faces, f32 *out) {
    u32 each = MIN(faces, 3); // of a slot in one buffer
    for (u32 slot = 0; slot < slots; slot++)
        for (u32 f = 0; f < faces; f++)
            for (u32 k = 0; k < 4; k++)
                *out++ = half_to_float(halves[f / 3][((u64)slot * each + f % 3) * 4 + k]);
}
