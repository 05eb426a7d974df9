// destroy.c: objects die when no submitted work can read them any more.
//
// Data in: Vulkan objects whose owner let go. Data out: none. A queue in the order of letting go:
// an entry gets the timeline value of the next submit that may still use it (the frame being
// recorded, or the next one), and is freed when that value is reached. Called by whatever destroys;
// collected at each frame begin and wait.
#include "gpu_internal.h"
#include <stdlib.h>
#include <string.h>

static void doomed_free(Gpu *gpu, const GpuDoomed *doomed) {
    VkDevice device = gpu->device;
    u64 handle = doomed->handle;
#define OBJECT(Type) ((Type)(uintptr_t)handle)
    switch (doomed->type) {
    case VK_OBJECT_TYPE_BUFFER:
        gpu->vk.vkDestroyBuffer(device, OBJECT(VkBuffer), NULL);
        break;
    case VK_OBJECT_TYPE_IMAGE:
        gpu->vk.vkDestroyImage(device, OBJECT(VkImage), NULL);
        break;
    case VK_OBJECT_TYPE_IMAGE_VIEW:
        gpu->vk.vkDestroyImageView(device, OBJECT(VkImageView), NULL);
        break;
    case VK_OBJECT_TYPE_SAMPLER:
        gpu->vk.vkDestroySampler(device, OBJECT(VkSampler), NULL);
        break;
    case VK_OBJECT_TYPE_PIPELINE:
        gpu->vk.vkDestroyPipeline(device, OBJECT(VkPipeline), NULL);
        break;
    case VK_OBJECT_TYPE_PIPELINE_LAYOUT:
        gpu->vk.vkDestroyPipelineLayout(device, OBJECT(VkPipelineLayout), NULL);
        break;
    case VK_OBJECT_TYPE_DESCRIPTOR_SET:
        gpu_descriptor_set_freed(gpu, doomed->descriptor_pool, doomed->layout_id,
                                 OBJECT(VkDescriptorSet));
        break;
    case VK_OBJECT_TYPE_DEVICE_MEMORY:
        gpu_memory_free(gpu, doomed->allocation);
        break;
    default:
        LUZ_ASSERT(!"an object type that nobody destroys later");
    }
#undef OBJECT
}

static void doomed_push(Gpu *gpu, GpuDoomed doomed) {
    if (gpu->doomed_count == gpu->doomed_cap) {
        if (gpu->doomed_first > gpu->doomed_cap / 2) {
            gpu->doomed_count -= gpu->doomed_first;
            memmove(gpu->doomed, gpu->doomed + gpu->doomed_first,
                    gpu->doomed_count * sizeof *gpu->doomed);
            gpu->doomed_first = 0;
        } else {
            u32 cap = MAX(gpu->doomed_cap * 2, 256u);
            GpuDoomed *grown = realloc(gpu->doomed, cap * sizeof *grown);
            LUZ_ASSERT(grown); // some bytes for the note that an object is to be freed
            gpu->doomed = grown;
            gpu->doomed_cap = cap;
        }
    }
    gpu->doomed[gpu->doomed_count++] = doomed;
}

void gpu_destroy_later(Gpu *gpu, VkObjectType type, u64 handle) {
    if (handle) doomed_push(gpu, (GpuDoomed){.type = type, .handle = handle});
}

void gpu_destroy_later_memory(Gpu *gpu, GpuAllocation allocation) {
    if (!allocation.block) return;
    doomed_push(
        gpu,
        (GpuDoomed){.type = VK_OBJECT_TYPE_DEVICE_MEMORY, .handle = 1, .allocation = allocation});
}

void gpu_destroy_later_set(Gpu *gpu, VkDescriptorSet set, u32 descriptor_pool, u32 layout_id) {
    doomed_push(gpu, (GpuDoomed){.type = VK_OBJECT_TYPE_DESCRIPTOR_SET,
                                 .handle = GPU_HANDLE(set),
                                 .descriptor_pool = descriptor_pool,
                                 .layout_id = layout_id});
}

void gpu_destroy_stamp(Gpu *gpu, u64 value) {
    for (u32 i = gpu->doomed_count; i > gpu->doomed_first && gpu->doomed[i - 1].value == 0; i--)
        gpu->doomed[i - 1].value = value ? value : 1;
}

void gpu_destroy_collect(Gpu *gpu, u64 done) {
    while (gpu->doomed_first < gpu->doomed_count) {
        GpuDoomed doomed = gpu->doomed[gpu->doomed_first];
        if (doomed.value == 0 || doomed.value > done) break;
        gpu->doomed_first++;
        doomed_free(gpu, &doomed);
    }
    if (gpu->doomed_first == gpu->doomed_count) gpu->doomed_first = gpu->doomed_count = 0;
}
