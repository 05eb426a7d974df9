// barriers.c: from what a pass does with a resource to stages, accesses and layouts.
//
// Data in: usages. Data out: one vkCmdPipelineBarrier2 a call. Called by the renderer's pass table,
// upload.c and swapchain.c. Does not track state: the caller says what was before (the pass table
// knows it for good, and a test checks that table).
//
// A barrier from or to a read covers every read usage of the same layout, not just the named one.
// So after write -> read, further reads in other stages need no barrier (they were made visible
// too), and read -> write waits for all of them. This is why gpu_usage_needs_barrier may say no for
// read -> read.
#include "gpu_internal.h"

#define SHADER_STAGES                                                                              \
    (VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT)
#define DEPTH_STAGES                                                                               \
    (VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT)
#define ANY_WRITE                                                                                  \
    (VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |                       \
     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |       \
     VK_ACCESS_2_TRANSFER_WRITE_BIT)

const GpuUsageInfo gpu_usage_table[GPU_USAGE_COUNT] = {
    // As a source: whatever an earlier frame did to the same memory must be over.
    [GPU_USAGE_NONE] = {"none", VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                        VK_IMAGE_LAYOUT_UNDEFINED, true},
    [GPU_USAGE_COLOR_TARGET] = {"color target", VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT |
                                    VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, true},
    [GPU_USAGE_DEPTH_TARGET] = {"depth target", DEPTH_STAGES,
                                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
                                VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, true},
    [GPU_USAGE_DEPTH_TEST] = {"depth test", DEPTH_STAGES | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                  VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                              VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, false},
    [GPU_USAGE_DEPTH_STENCIL] = {"stencil target",
                                 DEPTH_STAGES | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                 VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                                     VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                 VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL, true},
    // A resolve counts as colour output, whatever it resolves (Vulkan 1.3, 8.1).
    [GPU_USAGE_DEPTH_RESOLVE] = {"depth resolve",
                                 DEPTH_STAGES | VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                 VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                                     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, true},
    [GPU_USAGE_SAMPLED_FRAGMENT] = {"sampled by fragments", VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                    VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                    VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, false},
    [GPU_USAGE_SAMPLED_COMPUTE] = {"sampled by compute", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, false},
    [GPU_USAGE_STORAGE_COMPUTE] = {"storage of compute", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                                       VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_GENERAL, true},
    [GPU_USAGE_STORAGE_READ_COMPUTE] = {"storage read by compute",
                                        VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                        VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
                                        VK_IMAGE_LAYOUT_GENERAL, false},
    [GPU_USAGE_READ_VERTEX] = {"read by drawing",
                               VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | SHADER_STAGES,
                               VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                                   VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT |
                                   VK_ACCESS_2_INDEX_READ_BIT,
                               VK_IMAGE_LAYOUT_UNDEFINED, false},
    [GPU_USAGE_STORAGE_DRAW] = {"storage of drawing", SHADER_STAGES,
                                VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                                    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                                VK_IMAGE_LAYOUT_GENERAL, true},
    [GPU_USAGE_INDIRECT] = {"indirect", VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                            VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                            false},
    [GPU_USAGE_COPY_SOURCE] = {"copy source", VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               false},
    [GPU_USAGE_COPY_TARGET] = {"copy target", VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               true},
    [GPU_USAGE_PRESENT] = {"present", VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE,
                           VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, false},
};

VkImageLayout gpu_usage_layout(GpuUsage usage, bool is_depth) {
    VkImageLayout layout = gpu_usage_table[usage].layout;
    // One read-only layout of depth serves test and sampling alike.
    if (is_depth && layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL)
        return VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
    return layout;
}

bool gpu_usage_needs_barrier(GpuUsage from, GpuUsage to) {
    LUZ_ASSERT((u32)from < GPU_USAGE_COUNT && (u32)to < GPU_USAGE_COUNT);
    if (to == GPU_USAGE_NONE) return false; // nobody waits for nothing
    if (gpu_usage_table[from].is_write || gpu_usage_table[to].is_write) return true;
    bool is_depth = from == GPU_USAGE_DEPTH_TEST || to == GPU_USAGE_DEPTH_TEST;
    VkImageLayout old_layout = gpu_usage_layout(from, is_depth);
    VkImageLayout new_layout = gpu_usage_layout(to, is_depth);
    return old_layout != new_layout && old_layout != VK_IMAGE_LAYOUT_UNDEFINED &&
           new_layout != VK_IMAGE_LAYOUT_UNDEFINED;
}

// Stages and accesses of a usage, widened to all reads of its kind if it is a read.
static void usage_scope(GpuUsage usage, bool is_texture, bool is_depth,
                        VkPipelineStageFlags2 *stages, VkAccessFlags2 *access) {
    const GpuUsageInfo *info = &gpu_usage_table[usage];
    *stages = info->stages;
    *access = info->access;
    if (info->is_write || usage == GPU_USAGE_PRESENT) return;
    VkImageLayout layout = gpu_usage_layout(usage, is_depth);
    for (u32 i = 0; i < GPU_USAGE_COUNT; i++) {
        const GpuUsageInfo *other = &gpu_usage_table[i];
        if (other->is_write || i == GPU_USAGE_PRESENT) continue;
        if (is_texture && gpu_usage_layout((GpuUsage)i, is_depth) != layout) continue;
        if (!is_texture && i == GPU_USAGE_DEPTH_TEST) continue;
        *stages |= other->stages;
        *access |= other->access;
    }
}

VkImageMemoryBarrier2 gpu_image_barrier(VkImage image, GpuFormat format, GpuUsage from, GpuUsage to,
                                        bool discard) {
    bool is_depth = gpu_format_is_depth(format);
    LUZ_ASSERT(to != GPU_USAGE_NONE && gpu_usage_table[to].layout != VK_IMAGE_LAYOUT_UNDEFINED);
    VkImageMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .oldLayout = discard ? VK_IMAGE_LAYOUT_UNDEFINED : gpu_usage_layout(from, is_depth),
        .newLayout = gpu_usage_layout(to, is_depth),
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {gpu_format_aspects(format), 0, VK_REMAINING_MIP_LEVELS, 0,
                             VK_REMAINING_ARRAY_LAYERS},
    };
    usage_scope(from, true, is_depth, &barrier.srcStageMask, &barrier.srcAccessMask);
    usage_scope(to, true, is_depth, &barrier.dstStageMask, &barrier.dstAccessMask);
    barrier.srcAccessMask &= ANY_WRITE; // only writes are made available
    return barrier;
}

void gpu_record_barriers(Gpu *gpu, VkCommandBuffer buffer, const VkMemoryBarrier2 *memory,
                         const VkImageMemoryBarrier2 *images, u32 image_count) {
    if (!memory && !image_count) return;
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = memory ? 1 : 0,
        .pMemoryBarriers = memory,
        .imageMemoryBarrierCount = image_count,
        .pImageMemoryBarriers = images,
    };
    gpu->vk.vkCmdPipelineBarrier2(buffer, &info);
}

void gpu_record_full_barrier(Gpu *gpu, VkCommandBuffer buffer) {
    VkMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
        .dstAccessMask =
            VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT,
    };
    gpu_record_barriers(gpu, buffer, &barrier, NULL, 0);
}

void gpu_cmd_barriers(GpuCommands *cmd, const GpuBarrier *barriers, u32 count) {
    LUZ_ASSERT(!cmd->is_rendering); // not between begin_rendering and end_rendering
    Gpu *gpu = cmd->gpu;
    VkImageMemoryBarrier2 images[32];
    u32 image_count = 0;
    // Buffers share one memory barrier: drivers treat a buffer barrier the same.
    VkMemoryBarrier2 memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    for (u32 i = 0; i < count; i++) {
        const GpuBarrier *b = &barriers[i];
        if (!b->discard && !gpu_usage_needs_barrier(b->from, b->to)) continue;
        if (b->texture.id) {
            const GpuTextureItem *texture = gpu_texture_get(gpu, b->texture);
            if (image_count == COUNT_OF(images)) {
                gpu_record_barriers(gpu, cmd->buffer, NULL, images, image_count);
                image_count = 0;
            }
            images[image_count++] =
                gpu_image_barrier(texture->image, texture->format, b->from, b->to, b->discard);
        } else {
            (void)gpu_buffer_get(gpu, b->buffer); // asserts that it is alive
            VkPipelineStageFlags2 stages;
            VkAccessFlags2 access;
            usage_scope(b->from, false, false, &stages, &access);
            memory.srcStageMask |= stages;
            memory.srcAccessMask |= access & ANY_WRITE;
            usage_scope(b->to, false, false, &stages, &access);
            memory.dstStageMask |= stages;
            memory.dstAccessMask |= access;
        }
    }
    gpu_record_barriers(gpu, cmd->buffer, memory.srcStageMask ? &memory : NULL, images,
                        image_count);
}
