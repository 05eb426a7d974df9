// frame.c: frame slots, submits, waiting.
//
// Data in: recorded command buffers. Data out: work on the queue, each submit signalling the next
// value of one timeline semaphore. Called by the shells once a frame. Does not record anything by
// itself besides the barrier that makes results readable by the host.
//
// Slot of a frame = its number modulo frame_count. Between frames gpu_frame_slot is already that of
// the next frame, so DYNAMIC buffers can be filled before gpu_frame_begin as well.
#include "gpu_internal.h"
#include <stdio.h>

bool gpu_command_buffer_create(Gpu *gpu, const char *label, VkCommandPool *pool,
                               VkCommandBuffer *buffer) {
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                         .queueFamilyIndex = gpu->queue_family};
    if (!GPU_CHECK(gpu, label, gpu->vk.vkCreateCommandPool(gpu->device, &pool_info, NULL, pool)))
        return false;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = *pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    if (!GPU_CHECK(gpu, label, gpu->vk.vkAllocateCommandBuffers(gpu->device, &info, buffer))) {
        gpu->vk.vkDestroyCommandPool(gpu->device, *pool, NULL);
        *pool = VK_NULL_HANDLE;
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_COMMAND_POOL, GPU_HANDLE(*pool), "%s", label);
    gpu_name_object(gpu, VK_OBJECT_TYPE_COMMAND_BUFFER, GPU_HANDLE(*buffer), "%s", label);
    return true;
}

static bool slot_create(Gpu *gpu, GpuFrameSlot *slot, u32 index) {
    char label[32];
    snprintf(label, sizeof label, "frame %u", index);
    if (!gpu_command_buffer_create(gpu, label, &slot->pool, &slot->buffer)) return false;
    VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    if (!GPU_CHECK(gpu, "acquired",
                   gpu->vk.vkCreateSemaphore(gpu->device, &semaphore, NULL, &slot->acquired)))
        return false;
    gpu_name_object(gpu, VK_OBJECT_TYPE_SEMAPHORE, GPU_HANDLE(slot->acquired), "acquired %u",
                    index);
    return gpu_timers_create(gpu, slot, index);
}

bool gpu_frames_create(Gpu *gpu, u32 count) {
    gpu->frame_count = count;
    VkSemaphoreTypeCreateInfo type = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                      .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    if (!GPU_CHECK(gpu, gpu->label,
                   gpu->vk.vkCreateSemaphore(gpu->device, &info, NULL, &gpu->timeline)))
        return false;
    gpu_name_object(gpu, VK_OBJECT_TYPE_SEMAPHORE, GPU_HANDLE(gpu->timeline), "timeline");
    for (u32 i = 0; i < count; i++)
        if (!slot_create(gpu, &gpu->slots[i], i)) return false;
    gpu->commands.gpu = gpu;
    return true;
}

void gpu_frames_destroy(Gpu *gpu) {
    for (u32 i = 0; i < gpu->frame_count; i++) {
        GpuFrameSlot *slot = &gpu->slots[i];
        gpu->vk.vkDestroyCommandPool(gpu->device, slot->pool, NULL);
        gpu->vk.vkDestroySemaphore(gpu->device, slot->acquired, NULL);
        gpu->vk.vkDestroyQueryPool(gpu->device, slot->queries, NULL);
    }
    gpu->vk.vkDestroySemaphore(gpu->device, gpu->timeline, NULL);
}

// --- Waiting ---

bool gpu_wait_value(Gpu *gpu, u64 value) {
    if (gpu->is_lost) return false;
    if (value == 0) return true;
    VkSemaphoreWaitInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                .semaphoreCount = 1,
                                .pSemaphores = &gpu->timeline,
                                .pValues = &value};
    return GPU_CHECK(gpu, "timeline", gpu->vk.vkWaitSemaphores(gpu->device, &info, UINT64_MAX));
}

u64 gpu_done_value(Gpu *gpu) {
    u64 value = 0;
    if (gpu->is_lost ||
        !GPU_CHECK(gpu, "timeline",
                   gpu->vk.vkGetSemaphoreCounterValue(gpu->device, gpu->timeline, &value)))
        return 0;
    return value;
}

void gpu_wait_idle(Gpu *gpu) {
    if (gpu->is_lost) return;
    // Inside a frame its own commands stay what they are: recorded, not submitted.
    gpu_uploads_flush(gpu);
    if (!gpu_wait_value(gpu, gpu->submitted)) return;
    if (gpu->is_recording) {
        gpu_destroy_collect(gpu, gpu->submitted);
        return;
    }
    gpu_destroy_stamp(gpu, gpu->submitted);
    gpu_destroy_collect(gpu, UINT64_MAX); // nothing is under way or being recorded
}

// --- Submits ---

u64 gpu_submit(Gpu *gpu, const VkCommandBuffer *buffers, u32 count, VkSemaphore wait,
               VkSemaphore signal) {
    if (gpu->is_lost) return 0;
    u64 value = gpu->submitted + 1;
    VkCommandBufferSubmitInfo infos[2];
    LUZ_ASSERT(count <= COUNT_OF(infos));
    for (u32 i = 0; i < count; i++)
        infos[i] = (VkCommandBufferSubmitInfo){
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = buffers[i]};
    VkSemaphoreSubmitInfo waits = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                   .semaphore = wait,
                                   .stageMask = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT};
    VkSemaphoreSubmitInfo signals[2] = {
        {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
         .semaphore = gpu->timeline,
         .value = value,
         .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT},
        {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
         .semaphore = signal,
         .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT},
    };
    VkSubmitInfo2 info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
        .waitSemaphoreInfoCount = wait ? 1 : 0,
        .pWaitSemaphoreInfos = &waits,
        .commandBufferInfoCount = count,
        .pCommandBufferInfos = infos,
        .signalSemaphoreInfoCount = signal ? 2 : 1,
        .pSignalSemaphoreInfos = signals,
    };
    if (!GPU_CHECK(gpu, gpu->label, gpu->vk.vkQueueSubmit2(gpu->queue, 1, &info, VK_NULL_HANDLE)))
        return 0;
    gpu->submitted = value;
    return value;
}

u32 gpu_frame_slot(const Gpu *gpu) { return gpu->frame_slot; }

GpuCommands *gpu_frame_begin(Gpu *gpu) {
    LUZ_ASSERT(!gpu->is_recording);
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    if (!gpu_wait_value(gpu, slot->value)) return NULL;
    gpu_destroy_collect(gpu, gpu_done_value(gpu));
    gpu_timers_collect(gpu, slot);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (!GPU_CHECK(gpu, "frame", gpu->vk.vkResetCommandPool(gpu->device, slot->pool, 0)) ||
        !GPU_CHECK(gpu, "frame", gpu->vk.vkBeginCommandBuffer(slot->buffer, &begin)))
        return NULL;
    gpu->commands = (struct GpuCommands){.gpu = gpu, .buffer = slot->buffer};
    gpu->is_recording = true;
    gpu_timers_reset(gpu, slot);
    return &gpu->commands;
}

bool gpu_frame_is_open(const Gpu *gpu) { return gpu->is_recording; }

// Submits the slot's commands; the slot stays. 0 on failure.
static u64 slot_submit(Gpu *gpu, GpuFrameSlot *slot) {
    LUZ_ASSERT(gpu->is_recording && !gpu->commands.is_rendering);
    LUZ_ASSERT(gpu->timer_depth == 0); // a timer was not ended
    GpuSwapchain *swap = &gpu->swap;
    bool shows = swap->is_awaited;
    if (shows) gpu_swapchain_finish(gpu);
    swap->is_awaited = false;
    // A finished submit alone does not make writes visible to the host (READBACK buffers).
    gpu_record_full_barrier(gpu, slot->buffer);
    gpu->is_recording = false;
    if (!GPU_CHECK(gpu, "frame", gpu->vk.vkEndCommandBuffer(slot->buffer))) return 0;

    VkCommandBuffer buffers[2];
    u32 count = 0;
    VkCommandBuffer uploads = gpu_uploads_end(gpu);
    if (uploads) buffers[count++] = uploads;
    buffers[count++] = slot->buffer;
    u64 value = gpu_submit(gpu, buffers, count, shows ? slot->acquired : VK_NULL_HANDLE,
                           shows ? swap->rendered[swap->image_index] : VK_NULL_HANDLE);
    if (!value) return 0;
    if (uploads) gpu_uploads_submitted(gpu, value);
    slot->value = value;
    gpu_destroy_stamp(gpu, value);
    return value;
}

bool gpu_frame_end(Gpu *gpu, bool wait) {
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    u64 value = slot_submit(gpu, slot);
    gpu->frame_slot = (gpu->frame_slot + 1) % gpu->frame_count;
    if (!value) return false;
    if (!wait) return true;
    if (!gpu_wait_value(gpu, value)) return false;
    gpu_destroy_collect(gpu, value);
    gpu_timers_collect(gpu, slot);
    return true;
}

GpuCommands *gpu_frame_continue(Gpu *gpu) {
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    return slot_submit(gpu, slot) ? gpu_frame_begin(gpu) : NULL;
}
