// gi_cones.c: cones through given volumes against a twin that does literally what the specification
// says: every direction a picture of its own, no precomputed steps; and what must hold for any
// cone. Data in: random volumes and cones of a fixed seed. Data out: pass or fail. Called by: the
// runner.
#include "gpu_fixture.h"
#include "../../engine/base/random.h"
#include <string.h>

enum { SIDE = 16, LEVELS_CAP = 5, CONES = 512 };

#define WIDE_TAN 0.57735f // of a hemisphere's cones

typedef struct Dice {
    u64 seed, stream, counter;
} Dice;
static f32 roll(Dice *dice) { return random_f32(dice->seed, dice->stream, dice->counter++); }

typedef struct Volumes {
    u32 faces, directions, mips, levels; // see SPEC_GI_*
    u32 atlas_side;                      // of a block's level 0
    f32 base[SIDE * SIDE * SIDE][4];
    f32 *blocks[LEVELS_CAP][6]; // rgba, x fastest
    f32 *thirds[LEVELS_CAP][6]; // GI_READ_THIRDS: between a level and the next
    Arena arena;
    GiRecord gi;
} Volumes;

static u16 half_from(f32 value) { // of positive numbers, rounded down; tiny ones are nothing
    if (value < 0x1p-14f) return 0;
    u32 bits;
    memcpy(&bits, &value, sizeof bits);
    return (u16)((((bits >> 23) - 127 + 15) << 10) | (bits >> 13 & 0x3FF));
}

// Numbers in 64ths, so that a half holds them; share: how much of space is not empty.
static void random_texel(Dice *random, f32 share, f32 out[4]) {
    bool there = roll(random) < share;
    for (u32 c = 0; c < 4; c++) out[c] = there ? (f32)(u32)(roll(random) * 65.0f) / 64.0f : 0.0f;
}

static void volumes_make(Volumes *v, u32 faces, u32 directions, u32 mips, f32 share, u64 seed) {
    memset(v, 0, sizeof *v);
    assert_true(arena_create(&v->arena, "volumes", MIB(16)));
    v->faces = faces;
    v->directions = directions;
    v->mips = mips;
    v->atlas_side = faces ? SIDE : SIDE / 2;
    Dice random = (Dice){seed, 1, 0};
    for (u32 i = 0; i < SIDE * SIDE * SIDE; i++) random_texel(&random, share, v->base[i]);
    for (u32 side = v->atlas_side; side > 0; side /= 2, v->levels++)
        for (u32 d = 0; d < directions; d++) {
            f32 *block = v->blocks[v->levels][d] =
                ARENA_PUSH(&v->arena, f32, side * side * side * 4);
            for (u32 i = 0; i < side * side * side; i++)
                random_texel(&random, share, block + (u64)i * 4);
        }
    v->gi = (GiRecord){.origin = {{-2.0f, 1.0f, 3.0f, 0.25f}},
                       .dims = {SIDE, SIDE, SIDE, 1},
                       .atlas = {v->atlas_side, v->atlas_side, v->atlas_side, v->levels},
                       .strength = {1.0f, 0.7f, 0.0f, 1.0f},
                       .cone = {0.577350269f, 0.5f, 0.0f, 1.0f},
                       .specular = {0.0087f},
                       .scale = {1.0f, 1.0f},
                       .counts = {0, 0, CONES, 0}};
}

// --- The twin ---

static f32 clamp_f32(f32 x, f32 low, f32 high) { return x < low ? low : x > high ? high : x; }

// One level, filtered linearly; p: 0..1.
static void read_level(const f32 *texels, u32 side, const f32 p[3], f32 out[4]) {
    u32 low[3], high[3];
    f32 share[3];
    for (u32 a = 0; a < 3; a++) {
        f32 at = clamp_f32(p[a] * (f32)side - 0.5f, 0.0f, (f32)side - 1.0f);
        low[a] = (u32)at;
        high[a] = MIN(low[a] + 1, side - 1);
        share[a] = at - (f32)low[a];
    }
    memset(out, 0, 4 * sizeof *out);
    for (u32 corner = 0; corner < 8; corner++) {
        f32 weight = 1.0f;
        u32 at[3];
        for (u32 a = 0; a < 3; a++) {
            bool is_high = corner >> a & 1;
            at[a] = is_high ? high[a] : low[a];
            weight *= is_high ? share[a] : 1.0f - share[a];
        }
        const f32 *texel = texels + (u64)((at[2] * side + at[1]) * side + at[0]) * 4;
        for (u32 c = 0; c < 4; c++) out[c] += texel[c] * weight;
    }
}

// Level `fine`, or what lies between it and the next one, at a texel's middle.
static f32 thirds_share(u32 fine) { return fine & 1 ? 2.0f / 3.0f : 1.0f / 3.0f; }
static void thirds_make(Volumes *v) {
    for (u32 l = 0, side = v->atlas_side; l < v->levels; l++, side /= 2)
        for (u32 d = 0; d < v->directions; d++) {
            f32 *out = v->thirds[l][d] = ARENA_PUSH(&v->arena, f32, side * side * side * 4);
            const f32 *fine = v->blocks[l][d];
            for (u32 i = 0; i < side * side * side; i++) {
                f32 middle[3], coarse[4];
                const u32 at[3] = {i % side, i / side % side, i / (side * side)};
                for (u32 a = 0; a < 3; a++) middle[a] = ((f32)at[a] + 0.5f) / (f32)side;
                u32 next = MIN(l + 1, v->levels - 1);
                read_level(v->blocks[next][d], v->atlas_side >> next, middle, coarse);
                for (u32 c = 0; c < 4; c++)
                    out[4 * i + c] =
                        fine[4 * i + c] + (coarse[c] - fine[4 * i + c]) * thirds_share(l);
            }
        }
}

// One direction of the atlas. Blocks lie side by side along x: half a texel of the coarser level
// that is read stays between them.
static void read_block(const Volumes *v, u32 d, f32 level, bool has_thirds, const f32 p[3],
                       f32 out[4]) {
    level = clamp_f32(level, 0.0f, (f32)v->levels - 1.0f);
    // Next to a whole level cones read that one alone.
    f32 whole = floorf(level + 0.5f);
    if (v->mips == GI_READ_NEAREST || (!v->faces && fabsf(level - whole) < 0.01f)) level = whole;
    u32 fine = (u32)level, coarse = (u32)ceilf(level);
    f32 share = level - (f32)fine, half_texel = 0.5f * (f32)(1u << coarse) / (f32)v->atlas_side;
    f32 q[3] = {p[0], p[1], p[2]}, texels[2][4];
    if (v->directions == 6) q[0] = clamp_f32(q[0], half_texel, 1.0f - half_texel);
    if (v->mips == GI_READ_THIRDS) q[2] = clamp_f32(q[2], half_texel, 1.0f - half_texel);
    has_thirds = has_thirds && v->mips == GI_READ_THIRDS;
    bool is_third = has_thirds && fabsf(share - thirds_share(fine)) < 0.01f;
    if (is_third) { // read as if it were a level
        half_texel = 0.5f * (f32)(1u << fine) / (f32)v->atlas_side;
        q[0] = clamp_f32(p[0], half_texel, 1.0f - half_texel), q[2] = p[2];
        read_level(v->thirds[fine][d], v->atlas_side >> fine, q, out);
        return;
    }
    read_level(v->blocks[fine][d], v->atlas_side >> fine, q, texels[0]);
    read_level(v->blocks[coarse][d], v->atlas_side >> coarse, q, texels[1]);
    for (u32 c = 0; c < 4; c++) out[c] = texels[0][c] + (texels[1][c] - texels[0][c]) * share;
}

static void read_volumes(const Volumes *v, f32 lod, bool has_thirds, const f32 p[3], const f32 d[3],
                         f32 out[4]) {
    f32 filtered[4] = {0}, length2 = 0.0f;
    for (u32 a = 0; a < (v->directions == 6 ? 3u : 1u); a++) {
        f32 texel[4], weight = v->directions == 1 ? 1.0f : v->faces ? fabsf(d[a]) : d[a] * d[a];
        u32 block = v->directions == 6 ? a * 2 + (d[a] < 0.0f ? 0 : 1) : 0;
        read_block(v, block, lod - (v->faces ? 0.0f : 1.0f), has_thirds, p, texel);
        for (u32 c = 0; c < 4; c++) filtered[c] += texel[c] * weight;
        length2 += texel[3] * weight * texel[3] * weight;
    }
    if (v->faces && v->directions == 6) { // densities of axes are perpendicular
        f32 share = sqrtf(length2) / MAX(filtered[3], 1e-6f);
        for (u32 c = 0; c < 4; c++) filtered[c] *= share;
    }
    memcpy(out, filtered, sizeof filtered);
    if (v->faces) return;
    f32 share = clamp_f32(lod, 0.0f, 1.0f), base[4];
    if (v->mips == GI_READ_NEAREST) share = floorf(share + 0.5f);
    read_level(&v->base[0][0], SIDE, p, base);
    for (u32 c = 0; c < 4; c++) out[c] = base[c] + (filtered[c] - base[c]) * share;
}

typedef struct Cone {
    f32 start[3], tan_half, direction[3], first, reach, unused[3];
} Cone;
typedef struct Result {
    f32 light[4], occlusion, steps, unused[2];
} Result;

static Result twin(const Volumes *v, const Cone *cone) {
    const f32 *origin = v->gi.origin[0], voxel = origin[3];
    Result r = {0};
    for (u32 a = 0; a < 3; a++) { // who stands outside sees nothing
        f32 at = (cone->start[a] - origin[a]) / voxel;
        if (at < 0.0f || at > SIDE) return r;
    }
    f32 last = 0.0f;
    for (f32 t = cone->first; t * voxel < cone->reach && r.light[3] < 0.95f;) {
        f32 p[3];
        bool inside = true;
        for (u32 a = 0; a < 3; a++) {
            p[a] = ((cone->start[a] - origin[a]) / voxel + cone->direction[a] * t) / SIDE;
            inside = inside && p[a] >= 0.0f && p[a] <= 1.0f;
        }
        if (!inside) break;
        f32 diameter = 2.0f * cone->tan_half * t, texel[4];
        diameter = MAX(diameter, 1.0f);
        // With faces apart: finer texels, oftener, of densities (see gi_cones.glsl).
        f32 lod = log2f(diameter) - (v->faces ? log2f(4.5f) : 0.0f), factor = v->gi.cone[1];
        read_volumes(v, MAX(lod, 0.0f), cone->tan_half == WIDE_TAN, p, cone->direction, texel);
        if (v->faces) { // densities, of the way since the last sample in texels
            factor *= 2.0f / 3.0f;
            f32 level = clamp_f32(lod, 0.0f, (f32)v->levels - 1.0f);
            if (v->mips == GI_READ_NEAREST) level = floorf(level + 0.5f);
            f32 way = (t - last) * exp2f(-level);
            last = t;
            f32 opacity = 1.0f - exp2f(-10.0f * texel[3] * way);
            for (u32 c = 0; c < 4; c++) texel[c] *= opacity / MAX(texel[3], 1e-6f);
        }
        f32 seen = 1.0f - r.light[3];
        for (u32 c = 0; c < 4; c++) r.light[c] += texel[c] * seen;
        r.occlusion += texel[3] * seen / (1.0f + v->gi.strength[1] * t * voxel);
        r.steps += 1.0f;
        // Where a cone is wider than a voxel, steps are rounded to what makes lods rise by sixths.
        f32 step = 2.0f * cone->tan_half * factor, rise = log2f(1.0f + step);
        f32 sixths = floorf(rise * 6.0f + 0.5f) / 6.0f;
        bool rounds = !v->faces && fabsf(sixths - rise) < 0.04f * rise;
        t = rounds && 2.0f * cone->tan_half * t > 0.999f ? t * exp2f(sixths)
                                                         : t + diameter * factor;
    }
    if (r.light[3] > 0.95f) {
        f32 whole = 1.0f / r.light[3];
        for (u32 c = 0; c < 4; c++) r.light[c] *= whole;
    }
    return r;
}

// --- The device ---

static void trace(const Volumes *v, const Cone *cones, u32 step, Result *out) {
    Gpu *gpu = gpu_fixture_create("cones");
    GpuBindLayoutDesc desc = {.label = "cones", .count = BUILD_BRICKS + 1};
    for (u32 i = 0; i < desc.count; i++)
        desc.kinds[i] = i < BUILD_FIRST_STORAGE ? GPU_BINDING_UNIFORM_BUFFER
                        : i < BUILD_FIRST_IMAGE ? GPU_BINDING_STORAGE_BUFFER
                                                : GPU_BINDING_SAMPLED_TEXTURE;
    GpuBindLayout layout = gpu_create_bind_layout(gpu, &desc);
    GpuBuffer record = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "gi", .size = 1024});
    GpuBuffer list =
        gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "cones", .size = CONES * sizeof(Cone)});
    GpuBuffer results = gpu_fixture_readback(gpu, CONES * sizeof(Result));
    gpu_upload_buffer(gpu, record, 0, &v->gi, sizeof v->gi);
    gpu_upload_buffer(gpu, list, 0, cones, CONES * sizeof *cones);

    // Halves of all mips, blocks side by side; what is between them above along z.
    Arena scratch;
    assert_true(arena_create(&scratch, "halves", MIB(8)));
    u16 *base = ARENA_PUSH(&scratch, u16, SIDE * SIDE * SIDE * 4);
    for (u32 i = 0; i < SIDE * SIDE * SIDE * 4; i++) base[i] = half_from((&v->base[0][0])[i]);
    u64 count = 0, at = 0;
    u32 parts = v->mips == GI_READ_THIRDS ? 2 : 1;
    for (u32 l = 0, side = v->atlas_side; l < v->levels; l++, side /= 2)
        count += (u64)side * side * side * v->directions * parts * 4;
    u16 *atlas = ARENA_PUSH(&scratch, u16, count);
    for (u32 l = 0, side = v->atlas_side; l < v->levels; l++, side /= 2)
        for (u32 row = 0; row < side * side * parts; row++)
            for (u32 d = 0; d < v->directions; d++) {
                const f32 *from = row < side * side ? v->blocks[l][d] : v->thirds[l][d];
                for (u32 i = 0; i < side * 4; i++)
                    atlas[at++] = half_from(from[row % (side * side) * side * 4 + i]);
            }
    GpuTextureDesc volume = {.label = "base", .format = GPU_FORMAT_RGBA16F, .sampled = true};
    volume.width = volume.height = volume.depth = SIDE;
    GpuTexture base_texture = gpu_create_texture(gpu, &volume);
    gpu_upload_texture(gpu, base_texture, base, SIDE * SIDE * SIDE * 8);
    volume.label = "atlas";
    volume.width = v->atlas_side * v->directions;
    volume.height = v->atlas_side;
    volume.depth = v->atlas_side * parts;
    volume.mip_count = v->levels;
    GpuTexture atlas_texture = gpu_create_texture(gpu, &volume);
    gpu_upload_texture(gpu, atlas_texture, atlas, count * 2);
    GpuSampler sampler = gpu_create_sampler(
        gpu, &(GpuSamplerDesc){.label = "linear", .nearest_mips = v->mips == GI_READ_NEAREST});

    GpuBindGroupDesc group_desc = {.label = "cones", .layout = layout};
    for (u32 i = 0; i < desc.count; i++)
        group_desc.bindings[i] = i < BUILD_FIRST_IMAGE
                                     ? (GpuBinding){.buffer = record}
                                     : (GpuBinding){.texture = base_texture, .sampler = sampler};
    group_desc.bindings[BUILD_ACCUMULATORS].buffer = list;
    group_desc.bindings[BUILD_RADIANCE].buffer = results;
    group_desc.bindings[BUILD_ATLAS].texture = atlas_texture;
    GpuBindGroup group = gpu_create_bind_group(gpu, &group_desc);
    u32 spec[SPEC_COUNT] = {[SPEC_GI_DIRECTIONS] = v->directions,
                            [SPEC_GI_FACES] = v->faces,
                            [SPEC_GI_MIPS] = v->mips,
                            [SPEC_GI_CASCADES] = 1,
                            [SPEC_GI_STEP] = step};
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_cones.comp", layout, SPEC_COUNT, spec);
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_dispatch(cmd, CONES / 64, 1, 1);
    assert_true(gpu_frame_end(gpu, true));
    memcpy(out, gpu_buffer_map(gpu, results), CONES * sizeof *out);

    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_sampler(gpu, sampler);
    gpu_destroy_texture(gpu, base_texture);
    gpu_destroy_texture(gpu, atlas_texture);
    gpu_destroy_buffer(gpu, record);
    gpu_destroy_buffer(gpu, list);
    gpu_destroy_buffer(gpu, results);
    arena_destroy(&scratch);
    gpu_fixture_destroy(gpu);
}

static void unit_vector(Dice *random, f32 out[3]) {
    f32 length2;
    do {
        length2 = 0.0f;
        for (u32 a = 0; a < 3; a++) {
            out[a] = roll(random) * 2.0f - 1.0f;
            length2 += out[a] * out[a];
        }
    } while (length2 > 1.0f || length2 < 0.01f);
    for (u32 a = 0; a < 3; a++) out[a] /= sqrtf(length2);
}

// Starts in the box and a little beside it.
static void random_cones(const Volumes *v, u64 seed, Cone *cones) {
    static const f32 tans[] = {0.0087f, 0.05f, 0.2f, 0.4142f, WIDE_TAN, 1.0f, 1.7f};
    Dice random = (Dice){seed, 2, 0};
    for (u32 i = 0; i < CONES; i++) {
        Cone *cone = &cones[i];
        *cone = (Cone){.tan_half = tans[i % COUNT_OF(tans)], .first = 1.0f};
        for (u32 a = 0; a < 3; a++)
            cone->start[a] = v->gi.origin[0][a] + (roll(&random) * 1.1f - 0.05f) * SIDE * 0.25f;
        unit_vector(&random, cone->direction);
        cone->reach = i % 3 ? 1e9f : roll(&random) * 3.0f;
        if (i % 5 == 4) cone->first = 0.25f + roll(&random);
        // As those of a hemisphere, whose lods are thirds.
        if (v->mips == GI_READ_THIRDS && cone->tan_half == WIDE_TAN) cone->first = 0.866025f;
        if (i % 16 == 15) // along an axis
            for (u32 a = 0; a < 3; a++) cone->direction[a] = a == i / 16 % 3 ? 1.0f : 0.0f;
    }
}

enum { APART, SIDE_BY_SIDE };

// how: SIDE_BY_SIDE as gi_cones_wave.glsl traces a hemisphere's; each second eight of them lie
// close together, as neighbouring pixels' do.
static void check_as(u32 how, u32 faces, u32 directions, u32 mips, f32 share) {
    static Volumes v;
    static Cone cones[CONES];
    static Result results[CONES];
    const u64 seed = 0x6C0 + faces * 4 + directions * 8 + mips;
    volumes_make(&v, faces, directions, mips, share, seed);
    if (mips == GI_READ_THIRDS) thirds_make(&v);
    random_cones(&v, seed, cones);
    for (u32 i = 0; i < CONES && how == SIDE_BY_SIDE; i++) {
        cones[i].tan_half = WIDE_TAN;
        cones[i].first = 0.866025f;
        for (u32 a = 0; a < 3 && i / 8 % 2 == 1; a++) {
            cones[i].start[a] = cones[i & ~7u].start[a] + (f32)(i & 7) * 0.02f;
            cones[i].direction[a] = cones[i & ~7u].direction[a];
        }
    }
    trace(&v, cones, how == SIDE_BY_SIDE ? 2 : 0, results);
    u32 other_steps = 0, traced = 0;
    for (u32 i = 0; i < CONES; i++) {
        Result want = twin(&v, &cones[i]);
        traced += want.steps > 0.0f;
        // A sample on the border of the box, or a level just between two, may fall to either side.
        bool same = fabsf(want.steps - results[i].steps) < 0.5f;
        other_steps += !same;
        for (u32 c = 0; c < 5 && same; c++) {
            f32 difference = fabsf((&want.light[0])[c] - (&results[i].light[0])[c]);
            if (difference > 0.01f)
                fail_msg("seed %llu cone %u (tan %g): number %u is %g, should be %g",
                         (unsigned long long)seed, i, (f64)cones[i].tan_half, c,
                         (f64)(&results[i].light[0])[c], (f64)(&want.light[0])[c]);
        }
    }
    assert_true(traced > CONES / 2);
    if (other_steps > CONES / 100) fail_msg("%u of %u cones take other steps", other_steps, CONES);
    arena_destroy(&v.arena);
}

static void check(u32 faces, u32 directions, u32 mips, f32 share) {
    check_as(APART, faces, directions, mips, share);
}

TEST_GPU(gi_cones, directional_as_the_twin) { check(0, 6, 0, 0.2f); }
TEST_GPU(gi_cones, nearest_mips_as_the_twin) { check(0, 6, 1, 0.2f); }
TEST_GPU(gi_cones, thirds_as_the_twin) { check(0, 6, GI_READ_THIRDS, 0.2f); }
TEST_GPU(gi_cones, side_by_side_as_the_twin) {
    Gpu *gpu = gpu_fixture_create("cones");
    u32 lanes = gpu_info(gpu)->subgroup_size;
    gpu_fixture_destroy(gpu);
    if (lanes == 8) check_as(SIDE_BY_SIDE, 0, 6, GI_READ_THIRDS, 0.2f); // else nobody traces so
}
TEST_GPU(gi_cones, isotropic_as_the_twin) { check(0, 1, 0, 0.2f); }
TEST_GPU(gi_cones, faces_apart_as_the_twin) { check(1, 6, 0, 0.1f); }
TEST_GPU(gi_cones, faces_apart_nearest_as_the_twin) { check(1, 6, 1, 0.1f); }

// Everything opaque and equally bright: so is every cone. Nothing there: nothing comes.
TEST_GPU(gi_cones, furnace_and_void) {
    static Volumes v;
    static Cone cones[CONES];
    static Result results[CONES];
    for (u32 full = 0; full < 2; full++) {
        volumes_make(&v, 0, 6, 0, 0.0f, 1);
        for (u32 i = 0; i < SIDE * SIDE * SIDE && full; i++)
            v.base[i][0] = v.base[i][1] = v.base[i][2] = 0.75f, v.base[i][3] = 1.0f;
        for (u32 l = 0, side = v.atlas_side; l < v.levels && full; l++, side /= 2)
            for (u32 d = 0; d < 6; d++)
                for (u32 i = 0; i < side * side * side * 4; i++)
                    v.blocks[l][d][i] = i % 4 == 3 ? 1.0f : 0.75f;
        random_cones(&v, 7, cones);
        for (u32 i = 0; i < CONES; i++)
            for (u32 a = 0; a < 3; a++) // well inside
                cones[i].start[a] =
                    v.gi.origin[0][a] + 1.0f + 2.0f * (f32)(i * (a + 3) % 17) / 17.0f;
        for (u32 i = 0; i < CONES; i++) cones[i].reach = 1e9f;
        trace(&v, cones, 0, results);
        for (u32 i = 0; i < CONES; i++) {
            ASSERT_NEAR(results[i].light[0], full ? 0.75f : 0.0f, 1e-3);
            ASSERT_NEAR(results[i].light[3], full ? 1.0f : 0.0f, 1e-3);
        }
        // Hemispheres: weights add up to 1; the sky is 0.25 at the horizon and below, 1 above.
        for (u32 i = 0; i < CONES; i++) {
            Dice random = (Dice){i, 3, 0};
            unit_vector(&random, cones[i].direction);
        }
        trace(&v, cones, 1, results);
        for (u32 i = 0; i < CONES; i++) {
            if (full) {
                ASSERT_NEAR(results[i].light[0], 0.75f, 1e-3);
                assert_true(results[i].light[3] < 0.2f);
            } else {
                assert_true(results[i].light[0] > 0.2499f && results[i].light[0] < 1.0001f);
                ASSERT_NEAR(results[i].light[3], 1.0f, 1e-5);
                bool down = cones[i].direction[1] < -0.9f;
                if (down) ASSERT_NEAR(results[i].light[0], 0.25f, 1e-5);
            }
        }
        arena_destroy(&v.arena);
    }
}
