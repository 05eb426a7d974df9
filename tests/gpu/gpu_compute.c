// gpu_compute.c: buffers, uploads, compute, push and specialisation constants, DYNAMIC copies,
// timers.
#include "gpu_fixture.h"
#include "../../engine/base/random.h"
#include "../../engine/gpu/shader_blobs.h"
#include <stdlib.h>
#include <string.h>

// One dispatch of test_buffer.comp from `in` to `out` in a waited frame.
static void run_buffer_shader(Gpu *gpu, GpuPipeline pipeline, GpuBindGroup group, GpuBuffer out,
                              u32 count, u32 add) {
    GpuCommands *cmd = gpu_frame_begin(gpu);
    assert_non_null(cmd);
    gpu_cmd_barriers(
        cmd, &(GpuBarrier){.buffer = out, .from = GPU_USAGE_NONE, .to = GPU_USAGE_STORAGE_COMPUTE},
        1);
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_push(cmd, (u32[]){count, add}, 8);
    gpu_cmd_dispatch(cmd, (count + 63) / 64, 1, 1);
    assert_true(gpu_frame_end(gpu, true));
}

TEST_GPU(gpu, upload_compute_and_read_back) {
    Gpu *gpu = gpu_fixture_create("upload_compute_and_read_back");
    enum { COUNT = 5000 };
    static u32 values[COUNT];
    for (u32 i = 0; i < COUNT; i++) values[i] = random_u32(1, 2, i);
    GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = sizeof values});
    GpuBuffer out = gpu_fixture_readback(gpu, sizeof values);
    gpu_upload_buffer(gpu, in, 0, values, sizeof values);
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline plain = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    GpuPipeline special = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 2, (u32[]){3, 1000});
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){.label = "group",
                                 .layout = layout,
                                 .bindings = {{.buffer = in}, {.buffer = out}}});
    assert_true(group.id);

    const u32 *result = gpu_buffer_map(gpu, out);
    run_buffer_shader(gpu, plain, group, out, COUNT, 7);
    for (u32 i = 0; i < COUNT; i++) assert_int_equal(result[i], values[i] + 7);
    run_buffer_shader(gpu, special, group, out, COUNT, 1);
    for (u32 i = 0; i < COUNT; i++) assert_int_equal(result[i], values[i] * 3 + 1001);

    // A part of the buffer, twice in one batch: the later copy wins.
    u32 patch[2] = {1, 2}, patch2 = 5;
    gpu_upload_buffer(gpu, in, 400, patch, sizeof patch);
    gpu_upload_buffer(gpu, in, 404, &patch2, sizeof patch2);
    run_buffer_shader(gpu, plain, group, out, COUNT, 0);
    assert_int_equal(result[99], values[99]);
    assert_int_equal(result[100], 1);
    assert_int_equal(result[101], 5);
    assert_int_equal(result[102], values[102]);

    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, plain);
    gpu_destroy_pipeline(gpu, special);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

// More than the staging ring holds: pieces, wrap-around, waits.
TEST_GPU(gpu, upload_larger_than_staging) {
    Gpu *gpu = gpu_fixture_create("upload_larger_than_staging");
    enum { COUNT = 10 * 1024 * 1024 };
    u32 *values = malloc(COUNT * sizeof *values);
    for (u32 i = 0; i < COUNT; i++) values[i] = i * 2654435761u;
    GpuBuffer in =
        gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = COUNT * sizeof(u32)});
    GpuBuffer out = gpu_fixture_readback(gpu, COUNT * sizeof(u32));
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){.label = "group",
                                 .layout = layout,
                                 .bindings = {{.buffer = in}, {.buffer = out}}});
    // First some odd pieces, so that the large ones do not start at a round place of the ring.
    gpu_upload_buffer(gpu, in, 0, values, 4);
    gpu_upload_buffer(gpu, in, 4, values + 1, 1000 * 4);
    gpu_upload_buffer(gpu, in, 0, values, COUNT * sizeof(u32));
    // Dispatches of 65535 groups at most.
    const u32 *result = gpu_buffer_map(gpu, out);
    run_buffer_shader(gpu, pipeline, group, out, 65535 * 64, 0);
    for (u32 i = 0; i < 65535 * 64; i++)
        if (result[i] != values[i]) fail_msg("value %u differs", i);
    free(values);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

// Each frame writes other data to its copy while earlier frames may still run.
TEST_GPU(gpu, dynamic_buffers_keep_frames_apart) {
    for (u32 frames = 1; frames <= GPU_FRAMES_IN_FLIGHT_MAX; frames++) {
        Gpu *gpu =
            gpu_fixture_create_desc((GpuDesc){.label = "dynamic", .frames_in_flight = frames});
        enum { COUNT = 20000, FRAMES = 5 };
        GpuBuffer in = gpu_create_buffer(
            gpu, &(GpuBufferDesc){.label = "in", .size = COUNT * 4, .kind = GPU_BUFFER_DYNAMIC});
        GpuBuffer out[FRAMES];
        GpuBindGroup groups[FRAMES];
        GpuBindLayout layout =
            gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
        GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
        for (u32 f = 0; f < FRAMES; f++) {
            out[f] = gpu_fixture_readback(gpu, COUNT * 4);
            groups[f] = gpu_create_bind_group(
                gpu, &(GpuBindGroupDesc){.label = "group",
                                         .layout = layout,
                                         .bindings = {{.buffer = in}, {.buffer = out[f]}}});
        }
        for (u32 f = 0; f < FRAMES; f++) {
            // Both orders are allowed: map before the frame, or in it.
            u32 *data = f % 2 ? gpu_buffer_map(gpu, in) : NULL;
            GpuCommands *cmd = gpu_frame_begin(gpu);
            assert_int_equal(gpu_frame_slot(gpu), f % frames);
            if (data) assert_ptr_equal(data, gpu_buffer_map(gpu, in));
            data = gpu_buffer_map(gpu, in);
            for (u32 i = 0; i < COUNT; i++) data[i] = f * 1000000 + i;
            gpu_cmd_bind_pipeline(cmd, pipeline);
            gpu_cmd_bind_group(cmd, 0, groups[f]);
            gpu_cmd_push(cmd, (u32[]){COUNT, 1}, 8);
            gpu_cmd_dispatch(cmd, (COUNT + 63) / 64, 1, 1);
            assert_true(gpu_frame_end(gpu, false));
        }
        gpu_wait_idle(gpu);
        for (u32 f = 0; f < FRAMES; f++) {
            const u32 *result = gpu_buffer_map(gpu, out[f]);
            for (u32 i = 0; i < COUNT; i++)
                if (result[i] != f * 1000000 + i + 1)
                    fail_msg("frame %u of %u slots: value %u is %u", f, frames, i, result[i]);
            gpu_destroy_buffer(gpu, out[f]);
            gpu_destroy_bind_group(gpu, groups[f]);
        }
        gpu_destroy_buffer(gpu, in);
        gpu_destroy_pipeline(gpu, pipeline);
        gpu_fixture_destroy(gpu);
    }
}

TEST_GPU(gpu, dispatch_indirect) {
    Gpu *gpu = gpu_fixture_create("dispatch_indirect");
    u32 args[4] = {0xFFFF, 2, 1, 1}; // the count starts at byte 4
    static u32 ones[256];
    for (u32 i = 0; i < COUNT_OF(ones); i++) ones[i] = 1;
    GpuBuffer counts = gpu_create_buffer(
        gpu, &(GpuBufferDesc){.label = "counts", .size = sizeof args, .indirect = true});
    GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = sizeof ones});
    GpuBuffer out = gpu_fixture_readback(gpu, sizeof ones);
    memset(gpu_buffer_map(gpu, out), 0, sizeof ones);
    gpu_upload_buffer(gpu, counts, 0, args, sizeof args);
    gpu_upload_buffer(gpu, in, 0, ones, sizeof ones);
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){.label = "group",
                                 .layout = layout,
                                 .bindings = {{.buffer = in}, {.buffer = out}}});
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_barriers(
        cmd,
        (GpuBarrier[]){
            {.buffer = counts, .from = GPU_USAGE_STORAGE_COMPUTE, .to = GPU_USAGE_INDIRECT}},
        1);
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_push(cmd, (u32[]){256, 0}, 8);
    gpu_cmd_dispatch_indirect(cmd, counts, 4);
    assert_true(gpu_frame_end(gpu, true));
    const u32 *result = gpu_buffer_map(gpu, out);
    for (u32 i = 0; i < 256; i++) assert_int_equal(result[i], i < 128 ? 1 : 0);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_buffer(gpu, counts);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

TEST_GPU(gpu, timers_are_named_and_plausible) {
    for (u32 accurate = 0; accurate < 2; accurate++) {
        Gpu *gpu =
            gpu_fixture_create_desc((GpuDesc){.label = "timers", .accurate_timers = accurate});
        if (!gpu_info(gpu)->timestamps) TEST_SKIP("no timestamps on this device");
        enum { COUNT = 1 << 20 };
        GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = COUNT * 4});
        GpuBuffer out = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "out", .size = COUNT * 4});
        GpuBindLayout layout =
            gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
        GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
        GpuBindGroup group = gpu_create_bind_group(
            gpu, &(GpuBindGroupDesc){.label = "group",
                                     .layout = layout,
                                     .bindings = {{.buffer = in}, {.buffer = out}}});
        GpuTimer timers[GPU_TIMERS_CAP];
        assert_int_equal(gpu_timers(gpu, timers, GPU_TIMERS_CAP), 0);
        for (u32 frame = 0; frame < 3; frame++) {
            GpuCommands *cmd = gpu_frame_begin(gpu);
            gpu_cmd_label_begin(cmd, "work");
            gpu_cmd_timer_begin(cmd, "all");
            gpu_cmd_timer_begin(cmd, "dispatch");
            gpu_cmd_bind_pipeline(cmd, pipeline);
            gpu_cmd_bind_group(cmd, 0, group);
            gpu_cmd_push(cmd, (u32[]){COUNT, 0}, 8);
            gpu_cmd_barriers(cmd,
                             &(GpuBarrier){.buffer = out,
                                           .from = GPU_USAGE_STORAGE_COMPUTE,
                                           .to = GPU_USAGE_STORAGE_COMPUTE},
                             1);
            gpu_cmd_dispatch(cmd, COUNT / 64, 1, 1);
            gpu_cmd_timer_end(cmd);
            gpu_cmd_timer_begin(cmd, "nothing");
            gpu_cmd_timer_end(cmd);
            gpu_cmd_timer_end(cmd);
            gpu_cmd_label_end(cmd);
            assert_true(gpu_frame_end(gpu, true));
        }
        assert_int_equal(gpu_timers(gpu, timers, GPU_TIMERS_CAP), 3);
        assert_string_equal(timers[0].name, "all");
        assert_string_equal(timers[1].name, "dispatch");
        assert_string_equal(timers[2].name, "nothing");
        for (u32 i = 0; i < 3; i++) assert_true(timers[i].ms >= 0.0f && timers[i].ms < 10000.0f);
        if (accurate) {
            assert_true(timers[1].ms > 0.0f); // a million values take time
            assert_true(timers[1].ms > timers[2].ms);
            assert_true(timers[0].ms >= timers[1].ms);
        }
        assert_int_equal(gpu_timers(gpu, timers, 2), 2);
        // While nobody asks there are none, and old ones are not told again.
        for (u32 frame = 0; frame < 2; frame++) {
            gpu_timers_enable(gpu, frame == 1);
            GpuCommands *cmd = gpu_frame_begin(gpu);
            gpu_cmd_timer_begin(cmd, "asked for");
            gpu_cmd_timer_end(cmd);
            assert_true(gpu_frame_end(gpu, true));
            assert_int_equal(gpu_timers(gpu, timers, GPU_TIMERS_CAP), frame);
        }
        gpu_destroy_bind_group(gpu, group);
        gpu_destroy_pipeline(gpu, pipeline);
        gpu_destroy_buffer(gpu, in);
        gpu_destroy_buffer(gpu, out);
        gpu_fixture_destroy(gpu);
    }
}

// LUZ_VULKAN12=1 takes the way of a 1.2 device: dynamic rendering and synchronization2 as
// extensions.
TEST_GPU(gpu, vulkan_12_with_extensions) {
    setenv("LUZ_VULKAN12", "1", 1);
    gpu_fixture_pin_driver();
    // Validation is right to refuse SPIR-V 1.6 there; drivers take it.
    const ShaderBlob *blob = shader_blob_find("test_buffer.comp");
    assert_non_null(blob);
    Gpu *gpu =
        gpu_create(&(GpuDesc){.label = "Vulkan 1.2", .validation = blob->words[1] <= 0x00010500});
    if (!gpu) TEST_SKIP("no Vulkan device");
    GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = 64});
    gpu_upload_buffer(gpu, in, 0, &(u32){5}, 4);
    GpuBuffer out = gpu_fixture_readback(gpu, 64);
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline pipeline = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){.label = "group", .layout = layout, .bindings = {{in}, {out}}});
    run_buffer_shader(gpu, pipeline, group, out, 1, 7);
    assert_int_equal(*(const u32 *)gpu_buffer_map(gpu, out), 12);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, pipeline);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}
