// upload.c: bytes of the CPU to buffers and textures, through a ring of staging memory.
//
// Data in: bytes, copied at the call. Data out: copies in a command buffer of their own, submitted
// before the frame's commands (or alone, when the ring is full: then the call waits). Called at
// load and whenever data changes. Not for data of every frame: that is what DYNAMIC buffers are
// for.
//
// Anything larger than a chunk goes in several pieces, so the ring bounds all staging memory.
// staging_head and staging_tail count bytes for ever; a place in the ring is their rest modulo its
// size.
#include "gpu_internal.h"
#include <string.h>

#define STAGING_ALIGN 16 // a multiple of every format's texel
#define STAGING_CHUNK (GPU_STAGING_SIZE / 4)

static void transfer_barrier(Gpu *gpu, bool before, bool after) {
    VkMemoryBarrier2 barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask =
            before ? VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT : VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
        .srcAccessMask = before ? VK_ACCESS_2_MEMORY_WRITE_BIT : VK_ACCESS_2_TRANSFER_WRITE_BIT,
        .dstStageMask =
            after ? VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT : VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
        .dstAccessMask = after ? VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT
                               : VK_ACCESS_2_TRANSFER_WRITE_BIT,
    };
    gpu_record_barriers(gpu, gpu->uploads[gpu->upload_slot].buffer, &barrier, NULL, 0);
}

// --- Batches ---

// Makes sure that a batch is being recorded.
static bool batch_begin(Gpu *gpu) {
    if (gpu->is_uploading) return true;
    if (gpu->is_lost) return false;
    if (!gpu->staging &&
        !gpu_raw_buffer_create(gpu, gpu_heap_index(gpu, "staging"), GPU_MEMORY_UPLOAD,
                               GPU_STAGING_SIZE, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "staging",
                               &gpu->staging, &gpu->staging_memory)) {
        gpu->staging = VK_NULL_HANDLE;
        return false;
    }
    GpuUploadSlot *slot = &gpu->uploads[gpu->upload_slot];
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if ((!slot->pool && !gpu_command_buffer_create(gpu, "uploads", &slot->pool, &slot->buffer)) ||
        !gpu_wait_value(gpu, slot->value) ||
        !GPU_CHECK(gpu, "uploads", gpu->vk.vkResetCommandPool(gpu->device, slot->pool, 0)) ||
        !GPU_CHECK(gpu, "uploads", gpu->vk.vkBeginCommandBuffer(slot->buffer, &begin)))
        return false;
    gpu->is_uploading = true;
    gpu->upload_epoch++;
    gpu_cmd_label_begin(&(GpuCommands){.gpu = gpu, .buffer = slot->buffer}, "uploads");
    transfer_barrier(gpu, true, false); // earlier frames may still read what is overwritten now
    return true;
}

VkCommandBuffer gpu_uploads_end(Gpu *gpu) {
    if (!gpu->is_uploading) return VK_NULL_HANDLE;
    gpu->is_uploading = false;
    GpuUploadSlot *slot = &gpu->uploads[gpu->upload_slot];
    transfer_barrier(gpu, false, true);
    gpu_cmd_label_end(&(GpuCommands){.gpu = gpu, .buffer = slot->buffer});
    if (!GPU_CHECK(gpu, "uploads", gpu->vk.vkEndCommandBuffer(slot->buffer))) return VK_NULL_HANDLE;
    return slot->buffer;
}

void gpu_uploads_submitted(Gpu *gpu, u64 value) {
    gpu->uploads[gpu->upload_slot].value = value;
    gpu->upload_slot = (gpu->upload_slot + 1) % GPU_UPLOAD_SLOTS;
}

void gpu_uploads_flush(Gpu *gpu) {
    VkCommandBuffer buffer = gpu_uploads_end(gpu);
    u64 value = buffer ? gpu_submit(gpu, &buffer, 1, VK_NULL_HANDLE, VK_NULL_HANDLE) : 0;
    if (value) gpu_uploads_submitted(gpu, value);
}

void gpu_uploads_destroy(Gpu *gpu) {
    for (u32 i = 0; i < GPU_UPLOAD_SLOTS; i++)
        gpu->vk.vkDestroyCommandPool(gpu->device, gpu->uploads[i].pool, NULL);
    gpu->vk.vkDestroyBuffer(gpu->device, gpu->staging, NULL);
    gpu_memory_free(gpu, gpu->staging_memory);
}

// --- The ring ---

// Copies bytes into the ring, within a batch. False if the device is lost or out of memory.
static bool stage(Gpu *gpu, const void *data, u64 size, u64 *offset) {
    LUZ_ASSERT(size <= STAGING_CHUNK);
    if (!batch_begin(gpu)) return false;
    u64 head = ALIGN_UP(gpu->staging_head, STAGING_ALIGN);
    u64 place = head % GPU_STAGING_SIZE;
    if (place + size > GPU_STAGING_SIZE) head += GPU_STAGING_SIZE - place; // no piece wraps around
    if (head + size - gpu->staging_tail > GPU_STAGING_SIZE) {
        gpu_uploads_flush(gpu);
        if (!gpu_wait_value(gpu, gpu->submitted) || !batch_begin(gpu)) return false;
        gpu->staging_tail = head; // everything before is done
    }
    *offset = head % GPU_STAGING_SIZE;
    memcpy(gpu_memory_mapped(&gpu->staging_memory) + *offset, data, size);
    gpu->staging_head = head + size;
    return true;
}

void gpu_upload_buffer(Gpu *gpu, GpuBuffer buffer, u64 offset, const void *data, u64 size) {
    GpuBufferItem *item = gpu_buffer_get(gpu, buffer);
    LUZ_ASSERT(item->kind == GPU_BUFFER_STATIC);
    LUZ_ASSERT(offset <= item->size && size <= item->size - offset);
    for (u64 done = 0; done < size;) {
        u64 piece = MIN(size - done, STAGING_CHUNK), staged;
        if (!stage(gpu, (const u8 *)data + done, piece, &staged)) return;
        // Two copies to one buffer in a batch may overlap: the second waits for the first.
        if (done == 0 && item->upload_epoch == gpu->upload_epoch) {
            transfer_barrier(gpu, false, false);
            gpu->upload_epoch++;
        }
        item->upload_epoch = gpu->upload_epoch;
        VkBufferCopy region = {staged, offset + done, piece};
        gpu->vk.vkCmdCopyBuffer(gpu->uploads[gpu->upload_slot].buffer, gpu->staging, item->buffer,
                                1, &region);
        done += piece;
    }
}

// One mip: whole, or in groups of slices, or in groups of rows, as a chunk allows.
static bool upload_mip(Gpu *gpu, const GpuTextureItem *item, u32 mip, const u8 *pixels) {
    u32 width = MAX(item->width >> mip, 1u), height = MAX(item->height >> mip, 1u);
    u32 depth = MAX(item->depth >> mip, 1u);
    u64 row = (u64)width * gpu_format_bytes(item->format), slice = row * height;
    u32 slices = slice <= STAGING_CHUNK ? (u32)MIN(depth, STAGING_CHUNK / slice) : 1;
    u32 rows = slice <= STAGING_CHUNK ? height : (u32)(STAGING_CHUNK / row);
    for (u32 z = 0; z < depth; z += slices)
        for (u32 y = 0; y < height; y += rows) {
            u32 piece_depth = MIN(slices, depth - z), piece_height = MIN(rows, height - y);
            u64 staged;
            if (!stage(gpu, pixels + z * slice + y * row, row * piece_height * piece_depth,
                       &staged))
                return false;
            VkBufferImageCopy region = {
                .bufferOffset = staged,
                .imageSubresource = {gpu_format_aspect(item->format), mip, 0, 1},
                .imageOffset = {0, (i32)y, (i32)z},
                .imageExtent = {width, piece_height, piece_depth},
            };
            gpu->vk.vkCmdCopyBufferToImage(gpu->uploads[gpu->upload_slot].buffer, gpu->staging,
                                           item->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                                           &region);
        }
    return true;
}

void gpu_upload_texture(Gpu *gpu, GpuTexture texture, const void *pixels, u64 size) {
    const GpuTextureItem *item = gpu_texture_get(gpu, texture);
    LUZ_ASSERT(size == gpu_texture_bytes(item));
    if (!batch_begin(gpu)) return;
    VkImageMemoryBarrier2 barrier =
        gpu_image_barrier(item->image, item->format, GPU_USAGE_NONE, GPU_USAGE_COPY_TARGET, true);
    gpu_record_barriers(gpu, gpu->uploads[gpu->upload_slot].buffer, NULL, &barrier, 1);
    const u8 *mip_pixels = pixels;
    for (u32 mip = 0; mip < item->mip_count; mip++) {
        if (!upload_mip(gpu, item, mip, mip_pixels)) return;
        mip_pixels += (u64)MAX(item->width >> mip, 1u) * MAX(item->height >> mip, 1u) *
                      MAX(item->depth >> mip, 1u) * gpu_format_bytes(item->format);
    }
    barrier = gpu_image_barrier(item->image, item->format, GPU_USAGE_COPY_TARGET,
                                GPU_USAGE_SAMPLED_FRAGMENT, false);
    gpu_record_barriers(gpu, gpu->uploads[gpu->upload_slot].buffer, NULL, &barrier, 1);
}
