// gpu_barriers.c: the usage table: complete, consistent, and barriers where there must be some.
#include "gpu_fixture.h"
#include "../../engine/gpu/gpu_internal.h"

static bool has_bits(u64 value, u64 bits) { return (value & bits) == bits; }

TEST(gpu, usage_table_is_complete) {
    for (u32 i = 0; i < GPU_USAGE_COUNT; i++) {
        const GpuUsageInfo *info = &gpu_usage_table[i];
        assert_non_null(info->name);
        for (u32 j = 0; j < i; j++) assert_string_not_equal(info->name, gpu_usage_table[j].name);
        if (i == GPU_USAGE_PRESENT) continue; // no stage of ours
        assert_true(info->stages != 0 && info->access != 0);
        VkAccessFlags2 writes =
            VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
            VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
            VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
        assert_int_equal(info->is_write, (info->access & writes) != 0);
    }
}

TEST(gpu, every_pair_of_usages_has_its_barrier) {
    for (u32 from = 0; from < GPU_USAGE_COUNT; from++)
        for (u32 to = GPU_USAGE_NONE + 1; to < GPU_USAGE_COUNT; to++) {
            const GpuUsageInfo *a = &gpu_usage_table[from], *b = &gpu_usage_table[to];
            bool needs = gpu_usage_needs_barrier((GpuUsage)from, (GpuUsage)to);
            if (a->is_write || b->is_write)
                assert_true(needs); // also write -> the same write
            else if (from == to)
                assert_false(needs);
            else if (a->layout == b->layout)
                assert_false(needs);
        }
    // Depth is tested and sampled in one layout; colour is not sampled in the storage layout.
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_DEPTH_TEST, GPU_USAGE_SAMPLED_FRAGMENT));
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_SAMPLED_COMPUTE, GPU_USAGE_DEPTH_TEST));
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_SAMPLED_COMPUTE, GPU_USAGE_SAMPLED_FRAGMENT));
    assert_true(gpu_usage_needs_barrier(GPU_USAGE_STORAGE_READ_COMPUTE, GPU_USAGE_SAMPLED_COMPUTE));
    assert_true(gpu_usage_needs_barrier(GPU_USAGE_SAMPLED_FRAGMENT, GPU_USAGE_COPY_SOURCE));
    // Buffers have no layout.
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_READ_VERTEX, GPU_USAGE_STORAGE_READ_COMPUTE));
    assert_false(gpu_usage_needs_barrier(GPU_USAGE_INDIRECT, GPU_USAGE_READ_VERTEX));
}

// Barriers of a depth with a stencil name both aspects; of all others the one there is.
TEST(gpu, barriers_name_all_aspects) {
    static const struct {
        GpuFormat format;
        VkImageAspectFlags aspects;
    } cases[] = {
        {GPU_FORMAT_RGBA8, VK_IMAGE_ASPECT_COLOR_BIT},
        {GPU_FORMAT_D32F, VK_IMAGE_ASPECT_DEPTH_BIT},
        {GPU_FORMAT_D32F_S8, VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT},
    };
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        VkImageMemoryBarrier2 barrier = gpu_image_barrier(
            VK_NULL_HANDLE, cases[i].format, GPU_USAGE_NONE, GPU_USAGE_SAMPLED_FRAGMENT, false);
        assert_int_equal(barrier.subresourceRange.aspectMask, cases[i].aspects);
    }
}

// For every write -> read: what the barrier makes visible covers all reads that may follow without
// another one.
TEST(gpu, barriers_cover_the_reads_that_need_none) {
    for (u32 depth = 0; depth < 2; depth++)
        for (u32 from = 0; from < GPU_USAGE_COUNT; from++)
            for (u32 to = 1; to < GPU_USAGE_COUNT; to++) {
                if (!gpu_usage_table[from].is_write || gpu_usage_table[to].is_write) continue;
                if (gpu_usage_table[to].layout == VK_IMAGE_LAYOUT_UNDEFINED) continue;
                if ((to == GPU_USAGE_DEPTH_TEST || from == GPU_USAGE_DEPTH_TARGET) && !depth)
                    continue;
                if (from == GPU_USAGE_COLOR_TARGET && depth) continue;
                GpuFormat format = depth ? GPU_FORMAT_D32F : GPU_FORMAT_RGBA8;
                VkImageMemoryBarrier2 barrier =
                    gpu_image_barrier(VK_NULL_HANDLE, format, (GpuUsage)from, (GpuUsage)to, false);
                assert_true(has_bits(barrier.srcStageMask, gpu_usage_table[from].stages));
                assert_int_equal(barrier.oldLayout, gpu_usage_layout((GpuUsage)from, depth));
                assert_int_equal(barrier.newLayout, gpu_usage_layout((GpuUsage)to, depth));
                for (u32 next = 1; next < GPU_USAGE_COUNT; next++) {
                    const GpuUsageInfo *read = &gpu_usage_table[next];
                    if (read->is_write || read->layout == VK_IMAGE_LAYOUT_UNDEFINED) continue;
                    if (next == GPU_USAGE_DEPTH_TEST && !depth) continue;
                    if (gpu_usage_layout((GpuUsage)next, depth) != barrier.newLayout) continue;
                    assert_true(has_bits(barrier.dstStageMask, read->stages));
                    assert_true(has_bits(barrier.dstAccessMask, read->access));
                    // And a later write waits for that read, whichever read it names.
                    if (next == GPU_USAGE_PRESENT) continue;
                    VkImageMemoryBarrier2 back = gpu_image_barrier(
                        VK_NULL_HANDLE, format, (GpuUsage)to, GPU_USAGE_COPY_TARGET, false);
                    assert_true(has_bits(back.srcStageMask, read->stages));
                }
            }
}

TEST(gpu, discard_forgets_the_contents) {
    VkImageMemoryBarrier2 barrier = gpu_image_barrier(
        VK_NULL_HANDLE, GPU_FORMAT_RGBA8, GPU_USAGE_SAMPLED_FRAGMENT, GPU_USAGE_COLOR_TARGET, true);
    assert_int_equal(barrier.oldLayout, VK_IMAGE_LAYOUT_UNDEFINED);
    assert_true(has_bits(barrier.srcStageMask, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT));
    ASSERT_DIES(gpu_image_barrier(VK_NULL_HANDLE, GPU_FORMAT_RGBA8, GPU_USAGE_COLOR_TARGET,
                                  GPU_USAGE_NONE, false));
    ASSERT_DIES(gpu_image_barrier(VK_NULL_HANDLE, GPU_FORMAT_RGBA8, GPU_USAGE_COLOR_TARGET,
                                  GPU_USAGE_INDIRECT, false));
}
