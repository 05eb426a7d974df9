// gpu_fixture.c: see gpu_fixture.h.
#include "gpu_fixture.h"
#include <stdlib.h>
#include <string.h>

void gpu_fixture_pin_driver(void) {
    setenv("VK_DRIVER_FILES", "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", 0);
}

Gpu *gpu_fixture_create_desc(GpuDesc desc) {
    gpu_fixture_pin_driver();
    desc.validation = true;
    Gpu *gpu = gpu_create(&desc);
    if (!gpu) TEST_SKIP("no Vulkan device");
    return gpu;
}

Gpu *gpu_fixture_create(const char *label) {
    return gpu_fixture_create_desc((GpuDesc){.label = label});
}

void gpu_fixture_destroy(Gpu *gpu) {
    gpu_wait_idle(gpu);
    GpuHeapStat heaps[32];
    u32 count = gpu_heap_stats(gpu, heaps, COUNT_OF(heaps));
    for (u32 i = 0; i < MIN(count, COUNT_OF(heaps)); i++) {
        if (strcmp(heaps[i].name, "staging") == 0) continue;
        if (heaps[i].used || heaps[i].allocated || heaps[i].object_count)
            fail_msg("heap %s still has %u objects", heaps[i].name, heaps[i].object_count);
    }
    assert_int_equal(gpu_validation_message_count(gpu), 0);
    gpu_destroy(gpu);
    assert_int_equal(log_count(LOG_GPU_VALIDATION), 0); // also those of the destruction itself
}

GpuBuffer gpu_fixture_readback(Gpu *gpu, u64 size) {
    GpuBuffer buffer = gpu_create_buffer(
        gpu, &(GpuBufferDesc){.label = "readback", .size = size, .kind = GPU_BUFFER_READBACK});
    assert_true(buffer.id);
    return buffer;
}

GpuBindLayout gpu_fixture_layout(Gpu *gpu, GpuBindingKind first, GpuBindingKind second, u32 count) {
    GpuBindLayout layout = gpu_create_bind_layout(
        gpu,
        &(GpuBindLayoutDesc){.label = "test layout", .kinds = {first, second}, .count = count});
    assert_true(layout.id);
    return layout;
}

GpuPipeline gpu_fixture_compute(Gpu *gpu, const char *shader, GpuBindLayout layout, u32 spec_count,
                                const u32 *spec) {
    GpuPipelineDesc desc = {.label = shader,
                            .compute = shader,
                            .layouts = {layout},
                            .layout_count = 1,
                            .push_size = 16,
                            .spec_count = spec_count};
    for (u32 i = 0; i < spec_count; i++) desc.spec[i] = spec[i];
    GpuPipeline pipeline = gpu_create_pipeline(gpu, &desc);
    assert_true(pipeline.id);
    return pipeline;
}

void gpu_fixture_texture_to(Gpu *gpu, GpuTexture texture, GpuUsage from, GpuUsage to) {
    GpuCommands *cmd = gpu_frame_begin(gpu);
    assert_non_null(cmd);
    gpu_cmd_barriers(cmd, &(GpuBarrier){.texture = texture, .from = from, .to = to}, 1);
    assert_true(gpu_frame_end(gpu, true));
}
