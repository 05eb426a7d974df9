// memory.c: device memory in blocks, shared out by first fit, counted by named heap.
//
// Data in: requirements of a buffer or image, the heap's name. Data out: a place in a block. Called
// by resources.c and upload.c. Does not: defragment, or watch a budget.
//
// A block serves one heap, one memory type, and either buffers or images (so bufferImageGranularity
// never matters). Something larger than half a block gets a block of its own. An empty block goes
// back to the driver at once: heaps end at zero, and levels are loaded rarely enough.
#include "gpu_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_SIZE MIB(16)

u32 gpu_heap_index(Gpu *gpu, const char *name) {
    for (u32 i = 0; i < gpu->heap_count; i++)
        if (strncmp(gpu->heaps[i].name, name, sizeof gpu->heaps[i].name - 1) == 0) return i;
    LUZ_ASSERT(gpu->heap_count < GPU_HEAPS_CAP);
    GpuHeap *heap = &gpu->heaps[gpu->heap_count];
    snprintf(heap->name, sizeof heap->name, "%s", name);
    return gpu->heap_count++;
}

// --- Free ranges of a block ---

static bool ranges_insert_at(GpuBlock *block, u32 index, GpuFreeRange range) {
    if (block->range_count == block->range_cap) {
        u32 cap = MAX(block->range_cap * 2, 16u);
        GpuFreeRange *ranges = realloc(block->ranges, cap * sizeof *ranges);
        if (!ranges) return false;
        block->ranges = ranges;
        block->range_cap = cap;
    }
    memmove(&block->ranges[index + 1], &block->ranges[index],
            (block->range_count - index) * sizeof *block->ranges);
    block->ranges[index] = range;
    block->range_count++;
    return true;
}

static void ranges_remove_at(GpuBlock *block, u32 index) {
    block->range_count--;
    memmove(&block->ranges[index], &block->ranges[index + 1],
            (block->range_count - index) * sizeof *block->ranges);
}

static bool block_take(GpuBlock *block, u64 size, u64 alignment, u64 *out_offset) {
    for (u32 i = 0; i < block->range_count; i++) {
        GpuFreeRange range = block->ranges[i];
        u64 offset = ALIGN_UP(range.offset, alignment);
        u64 end = range.offset + range.size;
        if (offset + size > end) continue;
        GpuFreeRange before = {range.offset, offset - range.offset};
        GpuFreeRange after = {offset + size, end - offset - size};
        if (before.size && after.size) {
            if (!ranges_insert_at(block, i + 1, after)) return false;
            block->ranges[i] = before;
        } else if (before.size || after.size) {
            block->ranges[i] = before.size ? before : after;
        } else {
            ranges_remove_at(block, i);
        }
        block->used += size;
        *out_offset = offset;
        return true;
    }
    return false;
}

static void block_give_back(GpuBlock *block, u64 offset, u64 size) {
    u32 at = 0;
    while (at < block->range_count && block->ranges[at].offset < offset) at++;
    GpuFreeRange *before = at > 0 ? &block->ranges[at - 1] : NULL;
    GpuFreeRange *after = at < block->range_count ? &block->ranges[at] : NULL;
    bool joins_before = before && before->offset + before->size == offset;
    bool joins_after = after && offset + size == after->offset;
    LUZ_ASSERT(!before || before->offset + before->size <= offset); // freed twice?
    LUZ_ASSERT(!after || offset + size <= after->offset);
    block->used -= size;
    if (joins_before && joins_after) {
        before->size += size + after->size;
        ranges_remove_at(block, at);
    } else if (joins_before) {
        before->size += size;
    } else if (joins_after) {
        after->offset = offset;
        after->size += size;
    } else {
        // Without memory for the list the range is lost until the block is freed: harmless.
        ranges_insert_at(block, at, (GpuFreeRange){offset, size});
    }
}

// --- Blocks ---

static void block_destroy(Gpu *gpu, GpuBlock *block) {
    GpuHeap *heap = &gpu->heaps[block->heap];
    for (GpuBlock **link = &heap->blocks; *link; link = &(*link)->next)
        if (*link == block) {
            *link = block->next;
            break;
        }
    heap->allocated -= block->size;
    gpu->vk.vkFreeMemory(gpu->device, block->memory, NULL);
    free(block->ranges);
    free(block);
}

// NULL (with the result) if the driver refuses; no log, since another memory type may do.
static GpuBlock *block_create(Gpu *gpu, u32 heap_index, u32 type, u64 size, bool for_images,
                              const VkMemoryDedicatedAllocateInfo *dedicated, VkResult *result) {
    *result = VK_ERROR_OUT_OF_HOST_MEMORY;
    GpuBlock *block = calloc(1, sizeof *block);
    if (!block) return NULL;
    *block = (GpuBlock){.size = size,
                        .heap = heap_index,
                        .memory_type = type,
                        .for_images = for_images,
                        .dedicated = dedicated != NULL};
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .pNext = dedicated,
                                 .allocationSize = size,
                                 .memoryTypeIndex = type};
    *result = gpu->vk.vkAllocateMemory(gpu->device, &info, NULL, &block->memory);
    if (*result < 0) {
        free(block);
        return NULL;
    }
    // Everything host-visible stays mapped for good; only buffers are ever written through it.
    VkMemoryPropertyFlags flags = gpu->memory_properties.memoryTypes[type].propertyFlags;
    if (!for_images && (flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)) {
        *result = gpu->vk.vkMapMemory(gpu->device, block->memory, 0, VK_WHOLE_SIZE, 0,
                                      (void **)&block->mapped);
    }
    if (*result < 0 || !ranges_insert_at(block, 0, (GpuFreeRange){0, size})) {
        gpu->vk.vkFreeMemory(gpu->device, block->memory, NULL);
        free(block);
        return NULL;
    }
    GpuHeap *heap = &gpu->heaps[heap_index];
    block->next = heap->blocks;
    heap->blocks = block;
    heap->allocated += size;
    gpu_name_object(gpu, VK_OBJECT_TYPE_DEVICE_MEMORY, GPU_HANDLE(block->memory), "heap %s",
                    heap->name);
    return block;
}

static bool allocate_of_type(Gpu *gpu, u32 heap_index, u32 type, const VkMemoryRequirements *needs,
                             const VkMemoryDedicatedAllocateInfo *dedicated, bool for_images,
                             VkResult *result, GpuAllocation *out) {
    GpuHeap *heap = &gpu->heaps[heap_index];
    GpuBlock *block = NULL;
    u64 offset = 0;
    if (!dedicated)
        for (block = heap->blocks; block; block = block->next)
            if (block->memory_type == type && block->for_images == for_images &&
                !block->dedicated && block_take(block, needs->size, needs->alignment, &offset))
                break;
    if (!block) {
        u64 size = dedicated ? needs->size : BLOCK_SIZE;
        block = block_create(gpu, heap_index, type, size, for_images, dedicated, result);
        if (!block) return false;
        bool fits = block_take(block, needs->size, needs->alignment, &offset);
        LUZ_ASSERT(fits);
    }
    heap->used += needs->size;
    heap->object_count++;
    *out = (GpuAllocation){block, offset, needs->size};
    return true;
}

bool gpu_memory_allocate(Gpu *gpu, u32 heap, GpuMemoryUse use, const VkMemoryRequirements *needs,
                         VkBuffer buffer, VkImage image, bool wants_dedicated, const char *label,
                         GpuAllocation *out) {
    enum {
        LOCAL = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
        MAPPED = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
        CACHED = VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
    };
    // Best first; the last is what every device has. UPLOAD: written once by the CPU, read once by
    // the GPU over the bus, or right from video memory that the CPU can see.
    static const VkMemoryPropertyFlags wishes[][2] = {
        [GPU_MEMORY_DEVICE] = {LOCAL, 0},
        [GPU_MEMORY_UPLOAD] = {LOCAL | MAPPED, MAPPED},
        [GPU_MEMORY_READBACK] = {MAPPED | CACHED, MAPPED},
    };
    VkMemoryDedicatedAllocateInfo dedicated = {.sType =
                                                   VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO,
                                               .buffer = buffer,
                                               .image = image};
    bool is_alone = wants_dedicated || needs->size > BLOCK_SIZE / 2;
    VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const VkPhysicalDeviceMemoryProperties *memory = &gpu->memory_properties;
    u32 tried = 0;
    for (u32 wish = 0; wish < 2; wish++)
        for (u32 type = 0; type < memory->memoryTypeCount; type++) {
            VkMemoryPropertyFlags flags = memory->memoryTypes[type].propertyFlags;
            if (!(needs->memoryTypeBits >> type & 1) || (tried >> type & 1) ||
                (flags & wishes[use][wish]) != wishes[use][wish] ||
                (flags & VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT) ||
                (flags & VK_MEMORY_PROPERTY_PROTECTED_BIT))
                continue;
            tried |= 1u << type;
            if (needs->size > memory->memoryHeaps[memory->memoryTypes[type].heapIndex].size ||
                needs->size > gpu->max_allocation_size)
                continue;
            if (allocate_of_type(gpu, heap, type, needs, is_alone ? &dedicated : NULL,
                                 image != VK_NULL_HANDLE, &result, out))
                return true;
        }
    LOG(GPU_RESULT, "no memory for \"%s\": %.1f MiB in heap %s (%s)", label,
        (f64)needs->size / (f64)MIB(1), gpu->heaps[heap].name, gpu_result_name(result));
    return false;
}

void gpu_memory_free(Gpu *gpu, GpuAllocation allocation) {
    GpuBlock *block = allocation.block;
    if (!block) return;
    GpuHeap *heap = &gpu->heaps[block->heap];
    heap->used -= allocation.size;
    heap->object_count--;
    block_give_back(block, allocation.offset, allocation.size);
    if (block->used == 0) block_destroy(gpu, block);
}

u32 gpu_heap_stats(const Gpu *gpu, GpuHeapStat *out, u32 out_cap) {
    for (u32 i = 0; i < MIN(gpu->heap_count, out_cap); i++) {
        const GpuHeap *heap = &gpu->heaps[i];
        out[i] = (GpuHeapStat){heap->name, heap->used, heap->allocated, heap->object_count};
    }
    return gpu->heap_count;
}
