// gpu_device.c: making and ending a Gpu, handles, heaps, limits, absent and lost devices.
#include "gpu_fixture.h"
#include "../../engine/base/random.h"
#include "../../engine/gpu/gpu_internal.h"
#include <stdlib.h>
#include <string.h>

TEST_GPU(gpu, creates_and_destroys_without_a_message) {
    for (u32 i = 0; i < 3; i++) {
        Gpu *gpu = gpu_fixture_create_desc((GpuDesc){.label = "device", .frames_in_flight = i + 1});
        const GpuInfo *info = gpu_info(gpu);
        assert_true(info->device_name[0] && info->driver_name[0]);
        assert_true(info->subgroup_size >= 1 && info->max_texture_side >= 4096);
        assert_true(info->max_storage_buffer_size >= MIB(128));
        assert_false(gpu_is_lost(gpu));
        for (u32 frame = 0; frame < 4; frame++) {
            assert_non_null(gpu_frame_begin(gpu));
            assert_true(gpu_frame_end(gpu, frame == 3));
        }
        gpu_fixture_destroy(gpu);
    }
}

// The layer is there and heard: a mistake is counted.
TEST_GPU(gpu, validation_is_heard) {
    Gpu *gpu = gpu_fixture_create("validation_is_heard");
    if (!gpu->messenger) TEST_SKIP("the validation layer is not installed");
    GpuTexture texture = gpu_create_texture(gpu, &(GpuTextureDesc){.label = "never filled",
                                                                   .format = GPU_FORMAT_RGBA8,
                                                                   .width = 4,
                                                                   .height = 4,
                                                                   .sampled = true});
    GpuBuffer out = gpu_fixture_readback(gpu, 64);
    log_set_level(LOG_SEVERITY_NONE);
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_copy_texture_to_buffer(cmd, texture, out); // in no layout at all
    gpu_frame_end(gpu, true);
    assert_true(gpu_validation_message_count(gpu) > 0);
    assert_int_equal(log_count(LOG_GPU_VALIDATION), gpu_validation_message_count(gpu));
    gpu_destroy(gpu);
    log_set_level(LOG_SEVERITY_INFO);
    log_reset_counts(); // they were wanted
}

TEST_GPU(gpu, two_devices_at_once) {
    Gpu *first = gpu_fixture_create("first");
    gpu_fixture_pin_driver();
    Gpu *second = gpu_create(&(GpuDesc){.label = "second"}); // without the layer
    assert_non_null(second);
    for (u32 i = 0; i < 3; i++) {
        assert_non_null(gpu_frame_begin(first));
        assert_non_null(gpu_frame_begin(second));
        assert_true(gpu_frame_end(first, false) && gpu_frame_end(second, false));
    }
    gpu_fixture_destroy(first);
    assert_non_null(gpu_frame_begin(second));
    assert_true(gpu_frame_end(second, true));
    gpu_destroy(second);
}

TEST_GPU(gpu, no_device_is_a_message) {
    setenv("VK_DRIVER_FILES", "/nonexistent", 1);
    setenv("VK_ICD_FILENAMES", "/nonexistent", 1);
    assert_null(gpu_create(&(GpuDesc){.label = "none"}));
    assert_int_equal(log_count(LOG_GPU_NONE), 1);
    char text[512];
    log_last_error(text, sizeof text);
    assert_non_null(strstr(text, "mesa-vulkan-drivers"));
}

TEST_GPU(gpu, unknown_device_name_takes_another) {
    Gpu *gpu = gpu_fixture_create_desc((GpuDesc){.label = "device", .device = "Voodoo 2"});
    assert_int_equal(log_count(LOG_GPU_NONE), 0);
    gpu_fixture_destroy(gpu);
}

TEST_GPU(gpu, lost_device_says_no_and_can_be_made_again) {
    Gpu *gpu = gpu_fixture_create("lost");
    GpuBuffer buffer = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "buffer", .size = 64});
    gpu_upload_buffer(gpu, buffer, 0, "0123", 4);
    assert_false(gpu_check_at(gpu, VK_ERROR_DEVICE_LOST, "vkQueueSubmit2(...)", "x", "test", 1));
    assert_true(gpu_is_lost(gpu));
    assert_int_equal(log_count(LOG_GPU_LOST), 1);
    assert_null(gpu_frame_begin(gpu));
    gpu_upload_buffer(gpu, buffer, 0, "0123", 4);
    gpu_wait_idle(gpu);
    gpu_destroy(gpu); // with an object alive and uploads pending
    gpu = gpu_fixture_create("found");
    assert_non_null(gpu_frame_begin(gpu));
    assert_true(gpu_frame_end(gpu, true));
    gpu_fixture_destroy(gpu);
}

TEST_GPU(gpu, stale_handles_die) {
    Gpu *gpu = gpu_fixture_create("stale_handles_die");
    GpuBufferDesc desc = {.label = "buffer", .size = 64};
    GpuBuffer first = gpu_create_buffer(gpu, &desc);
    assert_int_equal(gpu_buffer_size(gpu, first), 64);
    gpu_destroy_buffer(gpu, first);
    ASSERT_DIES(gpu_buffer_size(gpu, first));
    ASSERT_DIES(gpu_destroy_buffer(gpu, first));
    GpuBuffer second = gpu_create_buffer(gpu, &desc); // the same slot
    assert_int_equal(first.id & 0xFFFF, second.id & 0xFFFF);
    assert_true(first.id != second.id);
    ASSERT_DIES(gpu_buffer_size(gpu, first));
    ASSERT_DIES(gpu_buffer_size(gpu, (GpuBuffer){0}));
    ASSERT_DIES(gpu_buffer_size(gpu, (GpuBuffer){0x00010FFF}));
    ASSERT_DIES(gpu_buffer_map(gpu, second)); // STATIC
    gpu_destroy_buffer(gpu, second);
    gpu_destroy_buffer(gpu, (GpuBuffer){0}); // none: nothing to do
    gpu_fixture_destroy(gpu);
}

// A slot whose generation is used up is not used again.
TEST(gpu, pool_retires_slots) {
    GpuPool pool = {.what = "thing", .item_size = sizeof(GpuSamplerItem)};
    void *item;
    u32 first = 0;
    for (u32 i = 0; i < UINT16_MAX; i++) {
        u32 id = gpu_pool_add(&pool, "thing", &item);
        assert_int_equal(id & 0xFFFF, 1);
        if (i == 0)
            first = id;
        else
            assert_true(id != first);
        gpu_pool_remove(&pool, id);
    }
    assert_int_equal(gpu_pool_add(&pool, "thing", &item) & 0xFFFF, 2);
    ASSERT_DIES(gpu_pool_get(&pool, first));
    assert_int_equal(pool.alive_count, 1);
    free(pool.items);
}

TEST(gpu, pool_full_is_a_message) {
    GpuPool pool = {.what = "thing", .item_size = sizeof(GpuPoolItem)};
    void *item;
    for (u32 i = 0; i < 65535; i++) assert_true(gpu_pool_add(&pool, "thing", &item));
    assert_int_equal(gpu_pool_add(&pool, "one too many", &item), 0);
    assert_int_equal(log_count(LOG_GPU_LIMIT), 1);
    free(pool.items);
}

TEST_GPU(gpu, limits_are_refused_politely) {
    Gpu *gpu = gpu_fixture_create("limits");
    log_set_level(LOG_SEVERITY_NONE);
    u32 count = log_count(LOG_GPU_LIMIT) + log_count(LOG_GPU_RESULT);
    u64 sizes[] = {(u64)1 << 40, UINT64_MAX / 2, UINT64_MAX, gpu->max_allocation_size + 1};
    for (u32 i = 0; i < COUNT_OF(sizes); i++)
        for (u32 kind = 0; kind < 3; kind++) {
            GpuBuffer buffer = gpu_create_buffer(
                gpu,
                &(GpuBufferDesc){.label = "huge", .size = sizes[i], .kind = (GpuBufferKind)kind});
            assert_int_equal(buffer.id, 0);
            assert_int_equal(log_count(LOG_GPU_LIMIT) + log_count(LOG_GPU_RESULT), ++count);
        }
    GpuTextureDesc textures[] = {
        {.label = "wide",
         .format = GPU_FORMAT_RGBA8,
         .width = 1 << 20,
         .height = 1,
         .sampled = true},
        {.label = "deep",
         .format = GPU_FORMAT_RGBA32F,
         .width = 16384,
         .height = 16384,
         .depth = 16384,
         .storage = true},
        {.label = "sRGB storage",
         .format = GPU_FORMAT_RGBA8_SRGB,
         .width = 4,
         .height = 4,
         .storage = true},
    };
    for (u32 i = 0; i < COUNT_OF(textures); i++) {
        assert_int_equal(gpu_create_texture(gpu, &textures[i]).id, 0);
        assert_int_equal(log_count(LOG_GPU_LIMIT) + log_count(LOG_GPU_RESULT), ++count);
    }
    assert_int_equal(
        gpu_create_pipeline(gpu, &(GpuPipelineDesc){.label = "none", .compute = "no_such.comp"}).id,
        0);
    assert_int_equal(log_count(LOG_SHADER_ERROR), 1);
    // A buffer that exists but that shaders here cannot see whole.
    if (gpu_info(gpu)->max_storage_buffer_size < MIB(512)) {
        GpuBuffer large = gpu_create_buffer(
            gpu, &(GpuBufferDesc){.label = "large",
                                  .size = gpu_info(gpu)->max_storage_buffer_size + 16});
        GpuBindLayout layout = gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, 0, 1);
        assert_int_equal(
            gpu_create_bind_group(
                gpu, &(GpuBindGroupDesc){.label = "group", .layout = layout, .bindings = {{large}}})
                .id,
            0);
        assert_int_equal(log_count(LOG_GPU_LIMIT) + log_count(LOG_GPU_RESULT), ++count);
        gpu_destroy_buffer(gpu, large);
    }
    log_set_level(LOG_SEVERITY_INFO);
    gpu_fixture_destroy(gpu);
}

static u64 heap_sum(Gpu *gpu, const char *name, u32 *objects) {
    GpuHeapStat heaps[32];
    u32 count = gpu_heap_stats(gpu, heaps, COUNT_OF(heaps));
    for (u32 i = 0; i < count; i++)
        if (strcmp(heaps[i].name, name) == 0) {
            assert_true(heaps[i].used <= heaps[i].allocated);
            *objects = heaps[i].object_count;
            return heaps[i].used;
        }
    *objects = 0;
    return 0;
}

// Random sizes come and go; contents never overlap; in the end everything is given back.
TEST_GPU(gpu, memory_is_shared_out_without_overlap) {
    Gpu *gpu = gpu_fixture_create("memory");
    enum { COUNT = 200, ROUNDS = 1500 };
    GpuBuffer buffers[COUNT] = {0};
    for (u32 round = 0; round < ROUNDS; round++) {
        u32 i = random_u32(7, 1, round) % COUNT;
        if (buffers[i].id) {
            u32 *data = gpu_buffer_map(gpu, buffers[i]);
            u64 words = gpu_buffer_size(gpu, buffers[i]) / 4;
            for (u64 w = 0; w < words; w += MAX(words / 64, 1))
                assert_int_equal(data[w], i * 31 + w);
            gpu_destroy_buffer(gpu, buffers[i]);
            buffers[i] = (GpuBuffer){0};
            if (round % 16 == 0) gpu_wait_idle(gpu); // the deferred ones go
        } else {
            u32 random = random_u32(7, 2, round);
            u64 size = 4 + (random % 8 ? random / 8 % 60000 : random / 8 % MIB(3)) / 4 * 4;
            buffers[i] = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "random",
                                                                 .heap = "random heap",
                                                                 .size = size,
                                                                 .kind = GPU_BUFFER_READBACK});
            assert_true(buffers[i].id);
            u32 *data = gpu_buffer_map(gpu, buffers[i]);
            for (u64 w = 0; w < size / 4; w++) data[w] = (u32)(i * 31 + w);
        }
    }
    u32 objects = 0, alive = 0;
    for (u32 i = 0; i < COUNT; i++) alive += buffers[i].id != 0;
    gpu_wait_idle(gpu);
    assert_true(heap_sum(gpu, "random heap", &objects) > 0);
    assert_int_equal(objects, alive);
    for (u32 i = 0; i < COUNT; i++) gpu_destroy_buffer(gpu, buffers[i]);
    gpu_fixture_destroy(gpu); // asserts that the heap is empty
}

// What a frame in flight reads is not freed under it.
TEST_GPU(gpu, destruction_waits_for_the_frame) {
    Gpu *gpu = gpu_fixture_create("destruction");
    u32 objects;
    for (u32 frame = 0; frame < 4; frame++) {
        GpuBuffer buffer = gpu_create_buffer(
            gpu, &(GpuBufferDesc){.label = "short", .heap = "short", .size = KIB(64)});
        gpu_upload_buffer(gpu, buffer, 0, "abcd", 4);
        assert_non_null(gpu_frame_begin(gpu));
        gpu_destroy_buffer(gpu, buffer); // its upload is not even submitted
        assert_true(heap_sum(gpu, "short", &objects) > 0);
        assert_true(gpu_frame_end(gpu, false));
    }
    gpu_wait_idle(gpu);
    assert_int_equal(heap_sum(gpu, "short", &objects), 0);
    gpu_fixture_destroy(gpu);
}

// More groups than one descriptor pool has sets; freed ones are used again.
TEST_GPU(gpu, bind_groups_by_the_thousand) {
    Gpu *gpu = gpu_fixture_create("bind_groups");
    GpuBuffer buffer = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "b", .size = 64});
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuBindGroup groups[1000];
    u32 pool_count = 0;
    for (u32 round = 0; round < 3; round++) {
        for (u32 i = 0; i < COUNT_OF(groups); i++) {
            groups[i] = gpu_create_bind_group(
                gpu, &(GpuBindGroupDesc){
                         .label = "group", .layout = layout, .bindings = {{buffer}, {buffer}}});
            assert_true(groups[i].id);
        }
        for (u32 i = 0; i < COUNT_OF(groups); i++) gpu_destroy_bind_group(gpu, groups[i]);
        gpu_wait_idle(gpu);
        if (round == 0) pool_count = gpu->descriptor_pool_count;
        assert_int_equal(gpu->descriptor_pool_count, pool_count);
    }
    gpu_destroy_buffer(gpu, buffer);
    gpu_fixture_destroy(gpu);
}
