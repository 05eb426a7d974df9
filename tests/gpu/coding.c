// coding.c: the codings of G-buffer layouts (shaders/coding.glsl), each through a real target of
// the format that the layout has: values in, drawn, sampled, decoded, and back.
#include "gpu_fixture.h"
#include "../../engine/base/random.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE  256u
#define COUNT (SIDE * SIDE)

enum {
    CODING_DISTANCE16,
    CODING_DISTANCE24,
    CODING_OCTAHEDRAL,
    CODING_FACING8,
    CODING_OREN_NAYAR,
    CODING_LIGHT8,
    CODING_POWER8,
    CODING_MOTION8,
    CODING_ALBEDO8
};

typedef f32 Value[4];
static Value values[COUNT], decoded[COUNT];

// Fills `decoded` from `values`.
static void round_trip(u32 coding, GpuFormat format, f32 reach) {
    Gpu *gpu = gpu_fixture_create("round_trip");
    GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = sizeof values});
    gpu_upload_buffer(gpu, in, 0, values, sizeof values);
    GpuBuffer out = gpu_fixture_readback(gpu, sizeof decoded);
    GpuTexture codes = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "codes",
                                                                 .format = format,
                                                                 .width = SIDE,
                                                                 .height = SIDE,
                                                                 .render_target = true,
                                                                 .sampled = true});
    GpuSampler sampler =
        gpu_create_sampler(gpu, &(GpuSamplerDesc){.label = "nearest", .nearest = true});
    assert_true(in.id && codes.id && sampler.id);
    GpuBindLayout draw_layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 1);
    GpuBindLayout read_layout =
        gpu_fixture_layout(gpu, GPU_BINDING_SAMPLED_TEXTURE, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuBindGroup draw_group = gpu_create_bind_group(
        gpu,
        &(GpuBindGroupDesc){.label = "draw", .layout = draw_layout, .bindings = {{.buffer = in}}});
    GpuBindGroup read_group = gpu_create_bind_group(
        gpu,
        &(GpuBindGroupDesc){.label = "read",
                            .layout = read_layout,
                            .bindings = {{.texture = codes, .sampler = sampler}, {.buffer = out}}});
    GpuPipeline draw = gpu_create_pipeline(gpu, &(GpuPipelineDesc){.label = "encode",
                                                                   .vertex = "fullscreen.vert",
                                                                   .fragment = "test_coding.frag",
                                                                   .layouts = {draw_layout},
                                                                   .layout_count = 1,
                                                                   .push_size = 8,
                                                                   .spec = {coding},
                                                                   .spec_count = 1,
                                                                   .targets = {format},
                                                                   .target_count = 1,
                                                                   .cull = GPU_CULL_NONE});
    GpuPipeline read = gpu_fixture_compute(gpu, "test_coding.comp", read_layout, 1, &coding);
    assert_true(draw.id && read.id && draw_group.id && read_group.id);
    struct {
        u32 side;
        f32 reach;
    } push = {SIDE, reach};

    GpuCommands *cmd = gpu_frame_begin(gpu);
    assert_non_null(cmd);
    gpu_cmd_barriers(cmd,
                     (GpuBarrier[]){{.texture = codes, .to = GPU_USAGE_COLOR_TARGET},
                                    {.buffer = out, .to = GPU_USAGE_STORAGE_COMPUTE}},
                     2);
    gpu_cmd_begin_rendering(cmd, &(GpuRendering){.targets = {{codes, true, {0}}},
                                                 .target_count = 1,
                                                 .width = SIDE,
                                                 .height = SIDE});
    gpu_cmd_bind_pipeline(cmd, draw);
    gpu_cmd_bind_group(cmd, 0, draw_group);
    gpu_cmd_push(cmd, &push, sizeof push);
    gpu_cmd_draw(cmd, 3, 1, 0, 0);
    gpu_cmd_end_rendering(cmd);
    gpu_cmd_barriers(cmd,
                     &(GpuBarrier){.texture = codes,
                                   .from = GPU_USAGE_COLOR_TARGET,
                                   .to = GPU_USAGE_SAMPLED_COMPUTE},
                     1);
    gpu_cmd_bind_pipeline(cmd, read);
    gpu_cmd_bind_group(cmd, 0, read_group);
    gpu_cmd_push(cmd, &push, sizeof push);
    gpu_cmd_dispatch(cmd, SIDE / 8, SIDE / 8, 1);
    assert_true(gpu_frame_end(gpu, true));
    memcpy(decoded, gpu_buffer_map(gpu, out), sizeof decoded);

    gpu_destroy_bind_group(gpu, draw_group);
    gpu_destroy_bind_group(gpu, read_group);
    gpu_destroy_pipeline(gpu, draw);
    gpu_destroy_pipeline(gpu, read);
    gpu_destroy_sampler(gpu, sampler);
    gpu_destroy_texture(gpu, codes);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

static f64 random_in(u32 i, u32 stream, f64 low, f64 high) {
    return low + (high - low) * (f64)random_u32(20060101, stream, i) / 4294967296.0;
}

static f64 worst_distance(void) {
    f64 worst = 0;
    for (u32 i = 0; i < COUNT; i++)
        worst = fmax(worst, fabs((f64)values[i][0] - (f64)decoded[i][0]));
    return worst;
}

// Specification: within 4/256 m for 1..1,000 m. Half of the values lie on and around the places
// where a byte carries.
TEST_GPU(coding, distance_in_two_bytes) {
    for (u32 i = 0; i < COUNT; i++) {
        f64 d = i & 1 ? random_in(i, 0, 1.0, 1000.0)
                      : 1.0 + (i / 2 % 250) * 4.0 + ((i64)(i / 500) - 32) * 1e-4;
        values[i][0] = (f32)CLAMP(d, 1.0, 1000.0);
    }
    round_trip(CODING_DISTANCE16, GPU_FORMAT_RGBA8, 1024.0f);
    f64 worst = worst_distance();
    printf("    16 bits of 1,024 m: off by %.5f m at most (allowed %.5f)\n", worst, 4.0 / 256.0);
    assert_true(worst <= 4.0 / 256.0);
    // Another reach scales the step.
    for (u32 i = 0; i < COUNT; i++) values[i][0] = (f32)random_in(i, 1, 0.05, 15.999);
    round_trip(CODING_DISTANCE16, GPU_FORMAT_RGBA8, 16.0f);
    worst = worst_distance();
    printf("    16 bits of 16 m: off by %.6f m at most\n", worst);
    assert_true(worst <= 16.0 / 131072.0 * 1.01);
    // Beyond the reach the last step answers.
    for (u32 i = 0; i < COUNT; i++) values[i][0] = 16.0f + (f32)i;
    round_trip(CODING_DISTANCE16, GPU_FORMAT_RGBA8, 16.0f);
    for (u32 i = 0; i < COUNT; i++) ASSERT_NEAR(decoded[i][0], 16.0, 0.001);
}

TEST_GPU(coding, distance_in_three_bytes) {
    for (u32 i = 0; i < COUNT; i++) values[i][0] = (f32)random_in(i, 2, 0.05, 1023.99);
    round_trip(CODING_DISTANCE24, GPU_FORMAT_RGBA8, 1024.0f);
    f64 worst = worst_distance();
    printf("    24 bits of 1,024 m: off by %.7f m at most\n", worst);
    assert_true(worst <= 1024.0 / 16777216.0 * 1.01 + 1000.0 * 6e-8);
}

// A direction on the sphere, with z from z_low on.
static void random_direction(u32 i, f64 z_low, Value out) {
    f64 z = random_in(i, 3, z_low, 1.0), angle = random_in(i, 4, 0.0, 6.283185307179586);
    f64 r = sqrt(fmax(1.0 - z * z, 0.0));
    out[0] = (f32)(r * cos(angle)), out[1] = (f32)(r * sin(angle)), out[2] = (f32)z;
}

static f64 angle_deg(const Value a, const Value b) {
    f64 d = 0;
    for (u32 k = 0; k < 3; k++) d += ((f64)a[k] - (f64)b[k]) * ((f64)a[k] - (f64)b[k]);
    return 2.0 * asin(fmin(sqrt(d) / 2.0, 1.0)) * 57.29577951308232;
}

TEST_GPU(coding, octahedral_normals) {
    for (u32 i = 0; i < COUNT; i++) random_direction(i, -1.0, values[i]);
    f32 axes[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (u32 i = 0; i < 6; i++) memcpy(values[i], axes[i], sizeof axes[i]);
    round_trip(CODING_OCTAHEDRAL, GPU_FORMAT_RG16, 0);
    f64 worst = 0;
    for (u32 i = 0; i < COUNT; i++) worst = fmax(worst, angle_deg(values[i], decoded[i]));
    printf("    octahedral in 2 x 16 bits: off by %.5f degrees at most\n", worst);
    assert_true(worst < 0.004);
}

// Two bytes and z rebuilt: fine where the surface faces the eye, degrees near the rim, mirrored
// where it faces away.
TEST_GPU(coding, facing_normals_in_two_bytes) {
    for (u32 i = 0; i < COUNT; i++) random_direction(i, -0.2, values[i]);
    values[0][0] = values[0][1] = 0, values[0][2] = 1;
    round_trip(CODING_FACING8, GPU_FORMAT_RGBA8, 0);
    static const struct {
        f64 z_low, z_high, bound_deg;
    } bands[] = {{0.7, 1.0, 0.5}, {0.3, 0.7, 1.1}, {0.1, 0.3, 6.2}, {0.0, 0.1, 6.2}, {-0.2, 0, 25}};
    for (u32 b = 0; b < COUNT_OF(bands); b++) {
        f64 worst = 0, sum = 0;
        u32 count = 0;
        for (u32 i = 0; i < COUNT; i++) {
            if ((f64)values[i][2] < bands[b].z_low || (f64)values[i][2] > bands[b].z_high) continue;
            f64 angle = angle_deg(values[i], decoded[i]);
            worst = fmax(worst, angle), sum += angle, count++;
        }
        printf("    view normal in 2 x 8 bits, z %.1f to %.1f: off by %.2f degrees, mean %.2f\n",
               bands[b].z_low, bands[b].z_high, worst, sum / count);
        assert_true(worst <= bands[b].bound_deg);
    }
    assert_true(decoded[0][0] == 0.0f || fabsf(decoded[0][0]) < 1e-6f); // the eye's axis is exact
    assert_true(decoded[0][2] == 1.0f);
}

TEST_GPU(coding, oren_nayar_pair) {
    for (u32 i = 0; i < COUNT; i++) {
        f64 sigma = random_in(i, 5, 0.0, 2.0), sigma2 = sigma * sigma;
        values[i][0] = (f32)(1.0 - 0.5 * sigma2 / (sigma2 + 0.33));
        values[i][1] = (f32)(0.45 * sigma2 / (sigma2 + 0.09));
    }
    values[0][0] = 1, values[0][1] = 0; // Lambert
    round_trip(CODING_OREN_NAYAR, GPU_FORMAT_RG32F, 0);
    f64 worst_a = 0, worst_b = 0;
    for (u32 i = 0; i < COUNT; i++) {
        worst_a = fmax(worst_a, fabs((f64)values[i][0] - (f64)decoded[i][0]));
        worst_b = fmax(worst_b, fabs((f64)values[i][1] - (f64)decoded[i][1]));
    }
    printf("    Oren-Nayar pair: A off by %.4f, B by %.7f at most\n", worst_a, worst_b);
    assert_true(worst_a <= 1.0 / 36.0 + 1e-6);
    assert_true(worst_b <= 1e-5);
    assert_true(decoded[0][0] == 1.0f && decoded[0][1] == 0.0f);
}

static f64 shown(f64 radiance) { // what the default tone mapping makes of it, 0..255
    f64 c = radiance / (1.0 + radiance);
    return 255.0 * (c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055);
}

TEST_GPU(coding, light_in_bytes) {
    for (u32 i = 0; i < COUNT; i++)
        for (u32 k = 0; k < 3; k++)
            values[i][k] = (f32)exp2(random_in(i, 6, -12.0, 7.5) + random_in(i, 7 + k, -6.0, 0.0));
    for (u32 k = 0; k < 3; k++) values[0][k] = 0;
    round_trip(CODING_LIGHT8, GPU_FORMAT_RGBA8, 0);
    f64 worst = 0, worst_steps = 0;
    for (u32 i = 0; i < COUNT; i++) {
        f64 largest = fmax((f64)values[i][0], fmax((f64)values[i][1], (f64)values[i][2]));
        for (u32 k = 0; k < 3; k++) {
            f64 v = (f64)values[i][k], d = (f64)decoded[i][k];
            if (largest > 1.5e-4) worst = fmax(worst, fabs(v - d) / largest);
            worst_steps = fmax(worst_steps, fabs(shown(v) - shown(d)));
        }
    }
    printf("    light in bytes: off by %.2f %% of the largest channel, %.2f of 255 steps shown\n",
           worst * 100.0, worst_steps);
    assert_true(worst <= 0.005);
    assert_true(worst_steps <= 1.5); // a faint channel beside one of 100 times white
    for (u32 k = 0; k < 3; k++) assert_true(decoded[0][k] == 0.0f);
}

TEST_GPU(coding, power_and_motion_in_bytes) {
    for (u32 i = 0; i < COUNT; i++) values[i][0] = (f32)exp2(random_in(i, 10, 0.0, 11.0));
    round_trip(CODING_POWER8, GPU_FORMAT_RGBA8, 0);
    f64 worst = 0;
    for (u32 i = 0; i < COUNT; i++)
        worst = fmax(worst, fabs((f64)decoded[i][0] / (f64)values[i][0] - 1.0));
    printf("    power in a byte: off by %.2f %% at most\n", worst * 100.0);
    assert_true(worst <= 0.0155);

    for (u32 i = 0; i < COUNT; i++)
        for (u32 k = 0; k < 2; k++) values[i][k] = (f32)random_in(i, 11 + k, -1.0, 1.0);
    values[0][0] = values[0][1] = 0;
    round_trip(CODING_MOTION8, GPU_FORMAT_RGBA8, 0);
    worst = 0;
    for (u32 i = 0; i < COUNT; i++)
        for (u32 k = 0; k < 2; k++)
            worst = fmax(worst, fabs((f64)decoded[i][k] - (f64)values[i][k]));
    printf("    motion in bytes: off by %.4f of the picture at most\n", worst);
    assert_true(worst <= 0.0085);
    assert_true(fabsf(decoded[0][0]) < 1e-9f);
}

// The sRGB curve's inverse (IEC 61966-2-1).
static f64 srgb_to_linear(f64 v) {
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

// Against what an sRGB target would lose: half a step between two of its bytes.
TEST_GPU(coding, albedo_in_bytes) {
    for (u32 i = 0; i < COUNT; i++)
        for (u32 k = 0; k < 3; k++) {
            f64 v = random_in(i, 13 + k, 0.0, 1.0);
            values[i][k] = (f32)(v * v);
        }
    for (u32 k = 0; k < 3; k++) values[0][k] = 0.0f, values[1][k] = 1.0f, values[2][k] = 9.0f;
    round_trip(CODING_ALBEDO8, GPU_FORMAT_RGBA8, 0);
    f64 worst = 0, worst_srgb_steps = 0;
    for (u32 i = 3; i < COUNT; i++)
        for (u32 k = 0; k < 3; k++) {
            f64 v = (f64)values[i][k], off = fabs(v - (f64)decoded[i][k]);
            f64 code = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
            f64 byte = fmin(floor(code * 255.0), 254.0);
            f64 step = srgb_to_linear((byte + 1.0) / 255.0) - srgb_to_linear(byte / 255.0);
            worst = fmax(worst, off);
            worst_srgb_steps = fmax(worst_srgb_steps, off / step);
        }
    printf("    albedo in bytes: off by %.5f at most, %.2f steps of an sRGB byte\n", worst,
           worst_srgb_steps);
    assert_true(worst <= 0.00394);         // half a step at white: 1 / 255
    assert_true(worst_srgb_steps <= 0.75); // 0.5 is what an sRGB byte itself loses
    for (u32 k = 0; k < 3; k++) {          // nothing, all and too much
        assert_true(decoded[0][k] == 0.0f && decoded[1][k] == 1.0f && decoded[2][k] == 1.0f);
    }
}
