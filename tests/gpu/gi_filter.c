// gi_filter.c: the filter's shaders on given voxels, without a renderer, against the naive twin
// (gi_filter_twin.h); and what any filter must keep: a uniformly lit opaque wall its radiance, two
// walls back to back their colours. Data in: volumes of a fixed seed. Data out: pass or fail.
// Called by: the runner.
#include "gi_filter_twin.h"
#include "gpu_fixture.h"
#include "../../engine/base/random.h"
#include "../../engine/render/render_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Filter {
    GiTwin twin; // shape, and the levels as they should be
    GiRecord gi;
    bool thirds;  // with what is between levels: gi_filter_thirds.glsl
    bool at_once; // last levels by one group, and what is gone with the parents
    u32 voxels, slots, *masks, *places, *radiance[2];
    u32 counters[GI_COUNTER_COUNT];
    f32 *light;       // as gi_twin_filter reads it
    u8 *base, *atlas; // what images hold: before the run, then after it
    u64 base_bytes, atlas_bytes;
} Filter;

static u16 half_bits(f32 value) { // not negative; to the nearest
    f32 rounded = gi_twin_half(value);
    int exponent;
    if (rounded < 0x1p-14f) return (u16)(rounded * 0x1p24f);
    f32 mantissa = frexpf(rounded, &exponent); // 0.5..1
    return (u16)((u32)(exponent + 14) << 10 | ((u32)(mantissa * 2048.0f) & 0x3FF));
}
static f32 half_value(u16 half) {
    u32 exponent = half >> 10 & 31, fraction = half & 0x3FF;
    return exponent ? ldexpf((f32)(fraction | 0x400), (i32)exponent - 25)
                    : ldexpf((f32)fraction, -24);
}

static void filter_open(Filter *f, u32 x, u32 y, u32 z, u32 cascades, bool apart, bool isotropic,
                        bool bytes) {
    *f = (Filter){.twin = {.dims = {x, y, z},
                           .cascades = cascades,
                           .apart = apart,
                           .isotropic = isotropic,
                           .bytes = bytes,
                           .scale = 4.0f}};
    f->voxels = x * y * z * cascades;
    f->light = calloc((u64)f->voxels * (apart ? 24 : 4), sizeof(f32));
    f->masks = calloc(f->voxels / 32 * GI_MASK_COUNT, sizeof(u32));
    f->places = calloc(f->voxels, sizeof(u32));
    for (u32 i = 0; i < 2; i++) f->radiance[i] = calloc((u64)f->voxels * 6, sizeof(u32));
}
static void filter_close(Filter *f) {
    gi_twin_free(&f->twin);
    free(f->light), free(f->masks), free(f->places), free(f->radiance[0]), free(f->radiance[1]);
    free(f->base), free(f->atlas);
}

static f32 *voxel_light(const Filter *f, u32 x, u32 y, u32 z) {
    const u32 *dims = f->twin.dims;
    return f->light + (x + dims[0] * (y + (u64)dims[1] * z)) * (f->twin.apart ? 24 : 4);
}

// Masks, places and radiance of what `light` says; static voxels where x + y + z is even.
static void filter_fill(Filter *f) {
    const u32 *dims = f->twin.dims, faces = f->twin.apart ? 6 : 1;
    u32 words = f->voxels / 32;
    memset(f->masks, 0, 2ull * words * sizeof(u32)); // what is lit stays
    f->slots = 0;
    memset(f->counters, 0, sizeof f->counters);
    for (u32 layer = 0; layer < 2; layer++)
        for (u32 bit = 0; bit < f->voxels; bit++) {
            u32 x = bit % dims[0], y = bit / dims[0] % dims[1], z = bit / (dims[0] * dims[1]);
            const f32 *light = voxel_light(f, x, y, z);
            bool occupied = false;
            for (u32 i = 0; i < faces; i++) occupied |= light[4 * i + 3] > 0.0f;
            if (!occupied || (x + y + z) % 2 != layer) continue;
            f->masks[layer * words + bit / 32] |= 1u << bit % 32;
            f->places[f->slots] =
                x << GI_VOXEL_X_SHIFT | y << GI_VOXEL_Y_SHIFT | z << GI_VOXEL_Z_SHIFT;
            for (u32 i = 0; i < 4 * faces; i++) {
                u32 face = i / 4, at = f->twin.apart ? f->slots * 3 + face % 3 : f->slots;
                u32 *word = &f->radiance[face / 3][at * 2 + i % 4 / 2];
                *word = i % 2 == 0 ? half_bits(light[i]) : *word | (u32)half_bits(light[i]) << 16;
            }
            f->slots++;
            f->counters[layer == 0 ? GI_COUNTER_STATIC : GI_COUNTER_DYNAMIC]++;
        }
    f->counters[GI_COUNTER_ALL_ARGS] = (f->slots + 63) / 64;
    f->counters[GI_COUNTER_ALL_ARGS + 1] = f->counters[GI_COUNTER_ALL_ARGS + 2] = 1;
}

// --- The device ---

typedef struct Device {
    Gpu *gpu;
    GpuBuffer record, masks, places, radiance[2], counters, masks_back, base_back, atlas_back;
    GpuTexture base, atlas, bricks; // bricks: bound, not read
    GpuBindLayout layout;
    GpuBindGroup groups[GI_TWIN_LEVELS_CAP];
    GpuPipeline base_steps[4], mip, tail, thirds[2];
} Device;
#define IMAGES(use_from, use_to)                                                                   \
    (GpuBarrier[]) {                                                                               \
        {.texture = d.base, .from = use_from, .to = use_to},                                       \
            {.texture = d.atlas, .from = use_from, .to = use_to},                                  \
            {.buffer = d.masks,                                                                    \
             .from = GPU_USAGE_STORAGE_COMPUTE,                                                    \
             .to = GPU_USAGE_STORAGE_COMPUTE},                                                     \
    }

static GpuBuffer buffer_of(Gpu *gpu, const char *label, const void *data, u64 size) {
    GpuBuffer buffer =
        gpu_create_buffer(gpu, &(GpuBufferDesc){.label = label, .size = size, .indirect = true});
    gpu_upload_buffer(gpu, buffer, 0, data, size);
    return buffer;
}

static GpuTexture volume_of(Gpu *gpu, const char *label, GpuFormat format, u32 x, u32 y, u32 z,
                            u32 mips, u8 **pixels, u64 *bytes) {
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = label,
                                                                   .format = format,
                                                                   .width = x,
                                                                   .height = y,
                                                                   .depth = z,
                                                                   .mip_count = mips,
                                                                   .storage = true,
                                                                   .sampled = true});
    *bytes = gpu_texture_size(gpu, texture);
    if (!*pixels) *pixels = calloc(1, *bytes);
    gpu_upload_texture(gpu, texture, *pixels, *bytes);
    return texture;
}

static void device_bind(Device *d, const Filter *f, GpuSampler sampler) {
    GpuBindLayoutDesc kinds = {.label = "filter", .count = BUILD_COUNT};
    for (u32 i = 0; i < BUILD_COUNT; i++)
        kinds.kinds[i] = i < BUILD_FIRST_STORAGE         ? GPU_BINDING_UNIFORM_BUFFER
                         : i < BUILD_FIRST_IMAGE         ? GPU_BINDING_STORAGE_BUFFER
                         : i < BUILD_FIRST_STORAGE_IMAGE ? GPU_BINDING_SAMPLED_TEXTURE
                                                         : GPU_BINDING_STORAGE_TEXTURE;
    d->layout = gpu_create_bind_layout(d->gpu, &kinds);
    for (u32 level = 0; level < f->twin.levels; level++) {
        GpuBindGroupDesc desc = {.label = "filter", .layout = d->layout};
        for (u32 i = 0; i < BUILD_COUNT; i++)
            desc.bindings[i] = i < BUILD_FIRST_IMAGE ? (GpuBinding){.buffer = d->record}
                               : i < BUILD_FIRST_STORAGE_IMAGE
                                   ? (GpuBinding){.texture = d->base, .sampler = sampler}
                                   : (GpuBinding){.texture = d->base};
        desc.bindings[BUILD_MASKS].buffer = d->masks;
        desc.bindings[BUILD_VOXELS].buffer = d->places;
        desc.bindings[BUILD_RADIANCE].buffer = d->radiance[0];
        desc.bindings[BUILD_RADIANCE_2].buffer = d->radiance[1];
        desc.bindings[BUILD_COUNTERS].buffer = d->counters;
        desc.bindings[BUILD_ATLAS].texture = d->atlas;
        desc.bindings[BUILD_BRICKS].texture = d->bricks;
        desc.bindings[BUILD_MIP_SOURCE] =
            (GpuBinding){.texture = d->atlas, .mip = level ? level - 1 : 0};
        desc.bindings[BUILD_MIP_TARGET] = (GpuBinding){.texture = d->atlas, .mip = level};
        for (u32 i = 0; i < GI_MIP_TAIL - 1; i++)
            desc.bindings[BUILD_MIP_TARGET_1 + i] =
                (GpuBinding){.texture = d->atlas, .mip = MIN(level + 1 + i, f->twin.levels - 1)};
        d->groups[level] = gpu_create_bind_group(d->gpu, &desc);
    }
}

// Levels that one group makes, if it does (Filter.at_once): as many as there can be.
static u32 tail_levels(const GiTwin *twin) {
    return MIN(twin->levels - (twin->apart ? 2 : 1), GI_MIP_TAIL);
}

static void device_pipelines(Device *d, const GiTwin *twin, bool thirds) {
    u32 spec[SPEC_COUNT] = {[SPEC_GI_DIRECTIONS] = twin->isotropic ? 1 : 6,
                            [SPEC_GI_FACES] = twin->apart,
                            [SPEC_GI_CASCADES] = twin->cascades,
                            [SPEC_GI_MIPS] = thirds ? GI_READ_THIRDS : GI_READ_LINEAR,
                            [SPEC_GI_FORMAT] = twin->bytes};
    for (u32 step = 0; step < 4; step++) {
        spec[SPEC_GI_STEP] = step;
        d->base_steps[step] = gpu_fixture_compute(
            d->gpu, twin->bytes ? "gi_filter_base_byte.comp" : "gi_filter_base.comp", d->layout,
            SPEC_COUNT, spec);
    }
    spec[SPEC_GI_STEP] = tail_levels(twin);
    d->tail = gpu_fixture_compute(d->gpu,
                                  twin->bytes ? "gi_filter_tail_byte.comp" : "gi_filter_tail.comp",
                                  d->layout, SPEC_COUNT, spec);
    spec[SPEC_GI_STEP] = 0;
    d->mip =
        gpu_fixture_compute(d->gpu, twin->bytes ? "gi_filter_mip_byte.comp" : "gi_filter_mip.comp",
                            d->layout, SPEC_COUNT, spec);
    for (u32 odd = 0; odd < 2; odd++) {
        spec[SPEC_GI_STEP] = odd;
        d->thirds[odd] = gpu_fixture_compute(
            d->gpu, twin->bytes ? "gi_filter_thirds_byte.comp" : "gi_filter_thirds.comp", d->layout,
            SPEC_COUNT, spec);
    }
}

// As gi_filter.c does; the base volume is made by whoever lights voxels.
static void filter_run(Filter *f) {
    GiTwin *twin = &f->twin;
    u32 smallest = MIN(twin->dims[0], MIN(twin->dims[1], twin->dims[2])), shift = !twin->apart;
    f->gi = (GiRecord){.scale = {twin->scale}, .counts = {0, 0, f->voxels, 0}};
    for (u32 a = 0; a < 3; a++) {
        f->gi.dims[a] = twin->dims[a];
        f->gi.atlas[a] = twin->block[a] = twin->dims[a] >> shift;
    }
    f->gi.dims[3] = twin->cascades;
    for (twin->levels = 1; smallest >> shift >> twin->levels; twin->levels++) {
    }
    f->gi.atlas[3] = twin->levels;
    Device d = {.gpu = gpu_fixture_create("filter")};
    GpuFormat format = twin->bytes ? GPU_FORMAT_RGBA8 : GPU_FORMAT_RGBA16F;
    d.record = buffer_of(d.gpu, "gi", &f->gi, sizeof f->gi);
    d.masks = buffer_of(d.gpu, "masks", f->masks, f->voxels / 8ull * GI_MASK_COUNT);
    d.places = buffer_of(d.gpu, "places", f->places, f->voxels * 4ull);
    for (u32 i = 0; i < 2; i++)
        d.radiance[i] = buffer_of(d.gpu, "radiance", f->radiance[i], f->voxels * 24ull);
    d.counters = buffer_of(d.gpu, "counters", f->counters, sizeof f->counters);
    bool has_base = !twin->apart;
    d.base =
        volume_of(d.gpu, "base", format, has_base ? twin->dims[0] : 2, has_base ? twin->dims[1] : 2,
                  has_base ? twin->dims[2] * twin->cascades : 2, 1, &f->base, &f->base_bytes);
    d.atlas = volume_of(d.gpu, "atlas", format, gi_twin_width(twin, 0), twin->block[1],
                        twin->block[2] * twin->cascades * (f->thirds ? 2 : 1), twin->levels,
                        &f->atlas, &f->atlas_bytes);
    u8 *nothing = NULL;
    u64 nothing_bytes;
    d.bricks = volume_of(d.gpu, "bricks", GPU_FORMAT_RGBA8, 2, 2, 2, 1, &nothing, &nothing_bytes);
    free(nothing);
    GpuSampler sampler = gpu_create_sampler(d.gpu, &(GpuSamplerDesc){.label = "filter"});
    device_bind(&d, f, sampler);
    device_pipelines(&d, twin, f->thirds);
    d.masks_back = gpu_fixture_readback(d.gpu, f->voxels / 8ull * GI_MASK_COUNT);
    d.base_back = gpu_fixture_readback(d.gpu, f->base_bytes);
    d.atlas_back = gpu_fixture_readback(d.gpu, f->atlas_bytes);

    GpuCommands *cmd = gpu_frame_begin(d.gpu);
    gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_SAMPLED_COMPUTE, GPU_USAGE_STORAGE_COMPUTE), 2);
    u32 first = twin->apart ? 1 : 0;
    for (u32 step = 0; step < 3; step++) {
        if (step == 1 && !twin->apart) continue;
        if (step == 0 && f->at_once) continue;
        gpu_cmd_bind_pipeline(cmd, d.base_steps[step == 2 && f->at_once ? 3 : step]);
        gpu_cmd_bind_group(cmd, 0, d.groups[step == 1 ? 0 : first]);
        if (step == 0)
            gpu_cmd_dispatch(cmd, (f->voxels / 32 + 63) / 64, 1, 1);
        else if (step == 2)
            gpu_cmd_dispatch(cmd, gi_parent_groups(f->gi.dims), 1, 1);
        else
            gpu_cmd_dispatch_indirect(cmd, d.counters, GI_COUNTER_ALL_ARGS * sizeof(u32));
        gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_STORAGE_COMPUTE, GPU_USAGE_STORAGE_COMPUTE), 3);
    }
    for (u32 level = first + 1; level < twin->levels; level++) {
        if (f->at_once && twin->levels - level == tail_levels(twin)) {
            gpu_cmd_bind_pipeline(cmd, d.tail);
            gpu_cmd_bind_group(cmd, 0, d.groups[level]);
            gpu_cmd_dispatch(cmd, 1, 1, 1);
            gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_STORAGE_COMPUTE, GPU_USAGE_STORAGE_COMPUTE), 2);
            break;
        }
        gpu_cmd_bind_pipeline(cmd, d.mip);
        gpu_cmd_bind_group(cmd, 0, d.groups[level]);
        u32 z = (twin->block[2] >> level) * twin->cascades;
        gpu_cmd_dispatch(cmd, (gi_twin_width(twin, level) + 7) / 8,
                         ((twin->block[1] >> level) + 3) / 4, (z + 1) / 2);
        gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_STORAGE_COMPUTE, GPU_USAGE_STORAGE_COMPUTE), 2);
    }
    for (u32 level = 0; f->thirds && level + 1 < twin->levels; level++) {
        gpu_cmd_bind_pipeline(cmd, d.thirds[level & 1]);
        gpu_cmd_bind_group(cmd, 0, d.groups[level + 1]);
        gpu_cmd_dispatch(cmd, (gi_twin_width(twin, level) + 7) / 8,
                         ((twin->block[1] >> level) + 3) / 4, ((twin->block[2] >> level) + 1) / 2);
        gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_STORAGE_COMPUTE, GPU_USAGE_STORAGE_COMPUTE), 2);
    }
    gpu_cmd_barriers(cmd, IMAGES(GPU_USAGE_STORAGE_COMPUTE, GPU_USAGE_COPY_SOURCE), 2);
    gpu_cmd_copy_mips_to_buffer(cmd, d.base, d.base_back);
    gpu_cmd_copy_mips_to_buffer(cmd, d.atlas, d.atlas_back);
    gpu_cmd_barriers(cmd,
                     &(GpuBarrier){.buffer = d.masks,
                                   .from = GPU_USAGE_STORAGE_COMPUTE,
                                   .to = GPU_USAGE_COPY_SOURCE},
                     1);
    gpu_cmd_copy_buffer(cmd, d.masks, 0, d.masks_back, 0, f->voxels / 8ull * GI_MASK_COUNT);
    assert_true(gpu_frame_end(d.gpu, true));
    memcpy(f->base, gpu_buffer_map(d.gpu, d.base_back), f->base_bytes);
    memcpy(f->atlas, gpu_buffer_map(d.gpu, d.atlas_back), f->atlas_bytes);
    memcpy(f->masks, gpu_buffer_map(d.gpu, d.masks_back), f->voxels / 8ull * GI_MASK_COUNT);

    for (u32 level = 0; level < twin->levels; level++)
        gpu_destroy_bind_group(d.gpu, d.groups[level]);
    for (u32 step = 0; step < 4; step++) gpu_destroy_pipeline(d.gpu, d.base_steps[step]);
    gpu_destroy_pipeline(d.gpu, d.mip);
    gpu_destroy_pipeline(d.gpu, d.tail);
    for (u32 odd = 0; odd < 2; odd++) gpu_destroy_pipeline(d.gpu, d.thirds[odd]);
    gpu_destroy_sampler(d.gpu, sampler);
    gpu_destroy_texture(d.gpu, d.base);
    gpu_destroy_texture(d.gpu, d.atlas);
    gpu_destroy_texture(d.gpu, d.bricks);
    const GpuBuffer buffers[] = {d.record,      d.masks,       d.places,
                                 d.radiance[0], d.radiance[1], d.counters,
                                 d.masks_back,  d.base_back,   d.atlas_back};
    for (u32 i = 0; i < COUNT_OF(buffers); i++) gpu_destroy_buffer(d.gpu, buffers[i]);
    gpu_fixture_destroy(d.gpu);
}

// Channel `at` of the image of all levels.
static f32 atlas_value(const Filter *f, u64 at) {
    if (f->twin.bytes) return (f32)f->atlas[at] / 255.0f;
    u16 half;
    memcpy(&half, f->atlas + 2 * at, sizeof half);
    return half_value(half);
}
static f32 atlas_at(const Filter *f, u32 level, u32 block, u32 x, u32 y, u32 z, u32 channel) {
    u64 at = 0;
    for (u32 l = 0; l < level; l++) at += gi_twin_texels(&f->twin, l) * 4;
    at += (u64)(gi_twin_texel(&f->twin, level, block, x, y, z) - f->twin.level[level]);
    return atlas_value(f, at + channel);
}

// --- The same as the twin ---

// share: of space that is full; colours up to 4, opacities of any size.
static void random_light(Filter *f, u64 seed, f32 share) {
    u32 faces = f->twin.apart ? 6 : 1;
    for (u32 v = 0; v < f->voxels; v++) {
        bool full = random_f32(seed, 1, v) < share;
        for (u32 i = 0; i < 4 * faces; i++) {
            f32 value = random_f32(seed, 2, (u64)v * 24 + i);
            f->light[(u64)v * 4 * faces + i] =
                full ? gi_twin_half(i % 4 == 3 ? MIN(0.2f + value, 1.0f) : 4.0f * value) : 0.0f;
        }
    }
}

// What lights voxels writes the base volume of those that are there; others keep what they have.
static void light_base(Filter *f) {
    if (f->twin.apart || !f->base) return;
    for (u32 v = 0; v < f->voxels; v++)
        for (u32 k = 0; k < 4 && f->light[4 * v + 3] > 0.0f; k++) {
            f32 value = f->light[4 * v + k];
            if (f->twin.bytes)
                f->base[4 * v + k] =
                    (u8)nearbyintf(MIN(k < 3 ? value / f->twin.scale : value, 1.0f) * 255.0f);
            else
                memcpy(f->base + 2 * (4ull * v + k), &(u16){half_bits(value)}, 2);
        }
}

// What lies between a level and the next at the middle of a texel, read as samplers do.
static f32 between_levels(const GiTwin *twin, u32 level, u32 x, u32 y, u32 z, u32 channel) {
    u32 side[3], low[3];
    f32 share[3], coarse = 0.0f;
    const u32 place[3] = {x % (twin->block[0] >> level), y, z};
    for (u32 a = 0; a < 3; a++) {
        side[a] = twin->block[a] >> (level + 1);
        f32 at = ((f32)place[a] + 0.5f) * 0.5f - 0.5f;
        at = at < 0.0f ? 0.0f : MIN(at, (f32)side[a] - 1.0f);
        low[a] = (u32)at;
        share[a] = at - (f32)low[a];
    }
    u32 block = x / (twin->block[0] >> level);
    for (u32 corner = 0; corner < 8; corner++) {
        f32 weight = 1.0f;
        u32 at[3];
        for (u32 a = 0; a < 3; a++) {
            bool is_high = corner >> a & 1;
            at[a] = MIN(low[a] + is_high, side[a] - 1);
            weight *= is_high ? share[a] : 1.0f - share[a];
        }
        coarse += weight * gi_twin_texel(twin, level + 1, block, at[0], at[1], at[2])[channel];
    }
    f32 fine = gi_twin_texel(twin, level, block, place[0], y, z)[channel];
    return fine + (coarse - fine) * (level & 1 ? 2.0f / 3.0f : 1.0f / 3.0f);
}

static void compare_thirds(const Filter *f, u32 level, u64 at) {
    const GiTwin *twin = &f->twin;
    u32 width = gi_twin_width(twin, level), height = twin->block[1] >> level;
    // As in compare, of the coarser level; half a step more for what is stored here.
    f32 step = f->twin.bytes ? 1.01f / 255.0f : 0x1p-10f;
    for (u64 i = 0; i < gi_twin_texels(twin, level) * 4 && level + 1 < twin->levels; i++) {
        u32 x = (u32)(i / 4 % width), y = (u32)(i / 4 / width % height);
        f32 want = between_levels(twin, level, x, y, (u32)(i / 4 / width / height), i % 4);
        f32 got = atlas_value(f, at + i), allowed = twin->bytes ? step : step * MAX(want, 0.01f);
        if (!(fabsf(want - got) <= allowed * ((f32)level + 2.5f)))
            fail_msg("above level %u, number %llu is %g, should be %g", level,
                     (unsigned long long)i, (f64)got, (f64)want);
    }
}

static void compare(Filter *f, const char *what) {
    gi_twin_free(&f->twin);
    gi_twin_filter(&f->twin, f->light);
    u64 at = 0;
    for (u32 level = 0; level < f->twin.levels; level++) {
        // Rounding adds up: half a step of the format a level, of radiance up to 4.
        f32 step = f->twin.bytes ? 1.01f / 255.0f : 0x1p-10f;
        for (u64 i = 0; i < gi_twin_texels(&f->twin, level) * 4; i++, at++) {
            f32 want = f->twin.level[level][i], got = atlas_value(f, at);
            f32 allowed = f->twin.bytes ? step : step * MAX(fabsf(want), 0x1p-10f);
            if (!(fabsf(want - got) <= allowed * (f32)(level + 1)))
                fail_msg("%s: level %u, number %llu is %g, should be %g", what, level,
                         (unsigned long long)i, (f64)got, (f64)want);
        }
        if (!f->thirds) continue;
        compare_thirds(f, level, at);
        at += gi_twin_texels(&f->twin, level) * 4;
    }
    u32 words = f->voxels / 32;
    for (u32 i = 0; i < words; i++)
        assert_int_equal(f->masks[GI_MASK_LIT * words + i], f->masks[i] | f->masks[words + i]);
}

// Twice: the second time other voxels are there, and what is gone must be so in all levels.
static void check_way(u32 x, u32 y, u32 z, u32 cascades, bool apart, bool isotropic, bool bytes,
                      bool thirds, bool at_once) {
    Filter f;
    filter_open(&f, x, y, z, cascades, apart, isotropic, bytes);
    f.thirds = thirds;
    f.at_once = at_once;
    u64 halves = bytes ? 1 : 2;
    if (!apart) f.base = calloc(f.voxels * 4ull, halves);
    for (u32 round = 0; round < 2; round++) {
        random_light(&f, 0xF117E5 + round, round ? 0.05f : 0.3f);
        filter_fill(&f);
        light_base(&f);
        filter_run(&f);
        compare(&f, round ? "other voxels" : "first voxels");
    }
    filter_close(&f);
}

static void check_filter(u32 x, u32 y, u32 z, u32 cascades, bool apart, bool isotropic, bool bytes,
                         bool thirds) {
    check_way(x, y, z, cascades, apart, isotropic, bytes, thirds, false);
    // Steps in one dispatch, where rows of voxels are whole words.
    if (x >= 32) check_way(x, y, z, cascades, apart, isotropic, bytes, thirds, true);
}

static void check_chain(u32 x, u32 y, u32 z, u32 cascades, bool apart, bool isotropic, bool bytes) {
    check_filter(x, y, z, cascades, apart, isotropic, bytes, false);
}

TEST_GPU(gi_filter, thirds_as_the_twin) {
    check_filter(32, 16, 64, 1, false, false, false, true);
    check_filter(16, 32, 16, 1, false, false, true, true);
}
TEST_GPU(gi_filter, shared_as_the_twin) { check_chain(32, 16, 64, 1, false, false, false); }
TEST_GPU(gi_filter, apart_as_the_twin) { check_chain(32, 16, 32, 1, true, false, false); }
TEST_GPU(gi_filter, isotropic_as_the_twin) {
    check_chain(32, 32, 16, 1, false, true, false);
    check_chain(16, 16, 32, 1, true, true, false);
}
TEST_GPU(gi_filter, bytes_as_the_twin) {
    check_chain(16, 32, 16, 1, false, false, true);
    check_chain(32, 16, 16, 1, true, false, true);
}
TEST_GPU(gi_filter, cascades_as_the_twin) {
    check_chain(8, 16, 8, 3, false, false, false);
    check_chain(8, 8, 16, 3, true, false, false);
    check_chain(16, 8, 8, 2, true, true, true);
}

// --- Walls ---

enum { SIDE = 32 };

// A wall across axis a at place `at`: its sides' colours, that towards + first. Shared faces take
// their mean.
static void wall(Filter *f, u32 a, u32 at, const f32 ahead[3], const f32 behind[3]) {
    for (u32 i = 0; i < SIDE * SIDE; i++) {
        u32 p[3];
        p[a] = at, p[(a + 1) % 3] = i % SIDE, p[(a + 2) % 3] = i / SIDE;
        f32 *light = voxel_light(f, p[0], p[1], p[2]);
        for (u32 k = 0; k < 3; k++) {
            if (!f->twin.apart) {
                light[k] = 0.5f * (ahead[k] + behind[k]);
                continue;
            }
            light[4 * (2 * a) + k] = ahead[k];
            light[4 * (2 * a + 1) + k] = behind[k];
        }
        for (u32 d = 0; d < (f->twin.apart ? 6u : 1u); d++)
            light[4 * d + 3] = !f->twin.apart || d / 2 == a ? 1.0f : 0.0f;
    }
}

// The texel of a level that one sees first in the middle of a wall whose front is at `at`.
static f32 front_at(const Filter *f, u32 level, u32 d, u32 at, u32 channel) {
    u32 shift = level + (f->twin.apart ? 0 : 1), p[3];
    for (u32 a = 0; a < 3; a++) p[a] = (a == d / 2 ? at : SIDE / 2 - 1) >> shift;
    return atlas_at(f, level, d, p[0], p[1], p[2], channel);
}

// Seen along its normal, a uniform wall of one voxel keeps radiance and opacity in all levels.
TEST_GPU(gi_filter, uniform_wall_keeps_its_radiance) {
    const f32 color[3] = {0.9f, 0.6f, 0.3f};
    for (u32 apart = 0; apart < 2; apart++)
        for (u32 a = 0; a < 3; a++) {
            Filter f;
            filter_open(&f, SIDE, SIDE, SIDE, 1, apart, false, false);
            if (!apart) f.base = calloc(f.voxels * 4ull, 2);
            u32 at = 13 + a;
            wall(&f, a, at, color, color);
            filter_fill(&f);
            light_base(&f);
            filter_run(&f);
            gi_twin_filter(&f.twin, f.light); // for its addresses
            for (u32 level = 0; level < f.twin.levels; level++)
                for (u32 d = 2 * a; d < 2 * a + 2; d++) {
                    for (u32 k = 0; k < 3; k++)
                        ASSERT_NEAR(front_at(&f, level, d, at, k), color[k], 0.02 * color[k]);
                    ASSERT_NEAR(front_at(&f, level, d, at, 3), 1.0f, 1e-3);
                }
            filter_close(&f);
        }
}

// Red towards -, green towards +: how much of the wrong colour there is beside the right one, at
// worst, in all levels and both directions.
static f64 mixing(bool apart, u32 a, u32 first, u32 thickness) {
    const f32 red[3] = {0.8f, 0, 0}, green[3] = {0, 0.8f, 0}, dark[3] = {0};
    Filter f;
    filter_open(&f, SIDE, SIDE, SIDE, 1, apart, false, false);
    if (!apart) f.base = calloc(f.voxels * 4ull, 2);
    if (thickness == 1) {
        wall(&f, a, first, green, red);
    } else {
        wall(&f, a, first, apart ? dark : red, red);
        wall(&f, a, first + 1, green, apart ? dark : green);
    }
    filter_fill(&f);
    light_base(&f);
    filter_run(&f);
    gi_twin_filter(&f.twin, f.light);
    f64 worst = 0;
    for (u32 level = 0; level < f.twin.levels; level++) {
        f64 green_seen = (f64)front_at(&f, level, 2 * a, first + thickness - 1, 1);
        f64 red_in_green = (f64)front_at(&f, level, 2 * a, first + thickness - 1, 0);
        f64 red_seen = (f64)front_at(&f, level, 2 * a + 1, first, 0);
        f64 green_in_red = (f64)front_at(&f, level, 2 * a + 1, first, 1);
        worst = fmax(worst, fmax(red_in_green / green_seen, green_in_red / red_seen));
    }
    filter_close(&f);
    return worst;
}

// Two walls back to back do not mix, wherever the borders of texels are; one wall of two colours
// does not either if its faces are apart. Sharing one radiance it has one colour.
TEST_GPU(gi_filter, red_and_green_wall) {
    for (u32 a = 0; a < 3; a++) {
        for (u32 apart = 0; apart < 2; apart++)
            for (u32 first = 14; first < 16; first++)
                ASSERT_NEAR(mixing(apart, a, first, 2), 0.0, 1e-3);
        ASSERT_NEAR(mixing(true, a, 15, 1), 0.0, 1e-3);
        f64 shared = mixing(false, a, 15, 1);
        printf("a wall of one voxel with shared faces, seen along %c: %.0f %% of the other side\n",
               'x' + (char)a, 100.0 * shared);
        ASSERT_NEAR(shared, 1.0, 1e-3);
    }
}
