// resources.c: buffers, textures, samplers.
//
// Data in: descs. Data out: handles to pooled objects with memory and names. Called by everybody
// who draws. Does not fill them (upload.c) or order accesses (barriers.c). A size or format that
// the device cannot do is LOG GPU_LIMIT and {0}; memory that it does not have is LOG GPU_RESULT and
// {0}.
#include "gpu_internal.h"

static const struct {
    VkFormat format;
    u32 bytes;
} format_table[GPU_FORMAT_COUNT] = {
    [GPU_FORMAT_NONE] = {VK_FORMAT_UNDEFINED, 0},
    [GPU_FORMAT_RGBA8] = {VK_FORMAT_R8G8B8A8_UNORM, 4},
    [GPU_FORMAT_RGBA8_SRGB] = {VK_FORMAT_R8G8B8A8_SRGB, 4},
    [GPU_FORMAT_RG16] = {VK_FORMAT_R16G16_UNORM, 4},
    [GPU_FORMAT_RG16_SNORM] = {VK_FORMAT_R16G16_SNORM, 4},
    [GPU_FORMAT_RGBA16F] = {VK_FORMAT_R16G16B16A16_SFLOAT, 8},
    [GPU_FORMAT_RGBA32F] = {VK_FORMAT_R32G32B32A32_SFLOAT, 16},
    [GPU_FORMAT_RG16F] = {VK_FORMAT_R16G16_SFLOAT, 4},
    [GPU_FORMAT_RG32F] = {VK_FORMAT_R32G32_SFLOAT, 8},
    [GPU_FORMAT_R32F] = {VK_FORMAT_R32_SFLOAT, 4},
    [GPU_FORMAT_R32U] = {VK_FORMAT_R32_UINT, 4},
    [GPU_FORMAT_R8] = {VK_FORMAT_R8_UNORM, 1},
    [GPU_FORMAT_D32F] = {VK_FORMAT_D32_SFLOAT, 4},
    [GPU_FORMAT_D32F_S8] = {VK_FORMAT_D32_SFLOAT_S8_UINT, 4}, // of the depth, as it is copied
    [GPU_FORMAT_SWAPCHAIN] = {VK_FORMAT_B8G8R8A8_UNORM, 4},   // headless; else the surface's
};

u32 gpu_format_bytes(GpuFormat format) {
    LUZ_ASSERT((u32)format < GPU_FORMAT_COUNT);
    return format_table[format].bytes;
}

VkFormat gpu_format_vk(const Gpu *gpu, GpuFormat format) {
    LUZ_ASSERT((u32)format < GPU_FORMAT_COUNT);
    if (format == GPU_FORMAT_SWAPCHAIN && gpu->swap.surface) return gpu->swap.format.format;
    return format_table[format].format;
}

VkImageAspectFlags gpu_format_aspect(GpuFormat format) {
    return gpu_format_is_depth(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkImageAspectFlags gpu_format_aspects(GpuFormat format) {
    return gpu_format_aspect(format) |
           (gpu_format_has_stencil(format) ? VK_IMAGE_ASPECT_STENCIL_BIT : 0u);
}

// --- Buffers ---

bool gpu_raw_buffer_create(Gpu *gpu, u32 heap, GpuMemoryUse use, u64 size, VkBufferUsageFlags usage,
                           const char *label, VkBuffer *buffer, GpuAllocation *allocation) {
    if (size > gpu->max_allocation_size) {
        LOG(GPU_LIMIT, "buffer \"%s\" of %.1f MiB: this device allocates %.1f MiB at most", label,
            (f64)size / (f64)MIB(1), (f64)gpu->max_allocation_size / (f64)MIB(1));
        return false;
    }
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    if (!GPU_CHECK(gpu, label, gpu->vk.vkCreateBuffer(gpu->device, &info, NULL, buffer)))
        return false;
    VkMemoryDedicatedRequirements dedicated = {.sType =
                                                   VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS};
    VkMemoryRequirements2 needs = {.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2,
                                   .pNext = &dedicated};
    gpu->vk.vkGetBufferMemoryRequirements2(
        gpu->device,
        &(VkBufferMemoryRequirementsInfo2){
            .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_REQUIREMENTS_INFO_2, .buffer = *buffer},
        &needs);
    if (!gpu_memory_allocate(gpu, heap, use, &needs.memoryRequirements, *buffer, VK_NULL_HANDLE,
                             dedicated.requiresDedicatedAllocation, label, allocation)) {
        gpu->vk.vkDestroyBuffer(gpu->device, *buffer, NULL);
        return false;
    }
    if (!GPU_CHECK(gpu, label,
                   gpu->vk.vkBindBufferMemory(gpu->device, *buffer, allocation->block->memory,
                                              allocation->offset))) {
        gpu->vk.vkDestroyBuffer(gpu->device, *buffer, NULL);
        gpu_memory_free(gpu, *allocation);
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_BUFFER, GPU_HANDLE(*buffer), "%s", label);
    return true;
}

GpuBuffer gpu_create_buffer(Gpu *gpu, const GpuBufferDesc *desc) {
    GpuBufferItem *item;
    u32 id = gpu_pool_add(&gpu->buffers, desc->label, (void **)&item);
    if (!id) return (GpuBuffer){0};
    item->size = desc->size ? desc->size : 16;
    item->kind = desc->kind;
    item->vertex = desc->vertex;
    item->index = desc->index;
    item->indirect = desc->indirect;
    u64 total = item->size;
    if (desc->kind == GPU_BUFFER_DYNAMIC && item->size <= gpu->max_allocation_size) {
        u64 alignment = MAX(gpu->limits.minStorageBufferOffsetAlignment, 256);
        item->stride = ALIGN_UP(item->size, alignment);
        total = item->stride * gpu->frame_count;
    }
    VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                               VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    if (desc->vertex) usage |= VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    if (desc->index) usage |= VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    if (desc->indirect) usage |= VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    GpuMemoryUse use = desc->kind == GPU_BUFFER_STATIC    ? GPU_MEMORY_DEVICE
                       : desc->kind == GPU_BUFFER_DYNAMIC ? GPU_MEMORY_UPLOAD
                                                          : GPU_MEMORY_READBACK;
    u32 heap = gpu_heap_index(gpu, desc->heap ? desc->heap : "buffers");
    if (!gpu_raw_buffer_create(gpu, heap, use, total, usage, desc->label, &item->buffer,
                               &item->allocation)) {
        gpu_pool_remove(&gpu->buffers, id);
        return (GpuBuffer){0};
    }
    return (GpuBuffer){id};
}

void gpu_destroy_buffer(Gpu *gpu, GpuBuffer buffer) {
    if (!buffer.id) return;
    GpuBufferItem *item = gpu_buffer_get(gpu, buffer);
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_BUFFER, GPU_HANDLE(item->buffer));
    gpu_destroy_later_memory(gpu, item->allocation);
    gpu_pool_remove(&gpu->buffers, buffer.id);
}

void *gpu_buffer_map(Gpu *gpu, GpuBuffer buffer) {
    GpuBufferItem *item = gpu_buffer_get(gpu, buffer);
    LUZ_ASSERT(item->kind != GPU_BUFFER_STATIC);
    // Outside a frame this is the next frame's copy, which an earlier frame may still be reading.
    if (item->kind == GPU_BUFFER_DYNAMIC && !gpu->is_recording)
        gpu_wait_value(gpu, gpu->slots[gpu_frame_slot(gpu)].value);
    return gpu_memory_mapped(&item->allocation) + gpu_buffer_offset(gpu, item);
}

u64 gpu_buffer_size(const Gpu *gpu, GpuBuffer buffer) { return gpu_buffer_get(gpu, buffer)->size; }

// --- Textures ---

static bool texture_view(Gpu *gpu, const GpuTextureItem *item, u32 first_mip, u32 mip_count,
                         VkImageAspectFlags aspects, VkImageView *view) {
    VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = item->image,
        .viewType = item->depth > 1 ? VK_IMAGE_VIEW_TYPE_3D : VK_IMAGE_VIEW_TYPE_2D,
        .format = gpu_format_vk(gpu, item->format),
        .subresourceRange = {aspects, first_mip, mip_count, 0, 1},
    };
    if (!GPU_CHECK(gpu, item->pool.label,
                   gpu->vk.vkCreateImageView(gpu->device, &info, NULL, view))) {
        *view = VK_NULL_HANDLE;
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, GPU_HANDLE(*view), "%s view of %u mips",
                    item->pool.label, mip_count);
    return true;
}

// Each mip from 1 on as a storage texture of its own.
static bool texture_mip_views(Gpu *gpu, GpuTextureItem *item) {
    bool ok = true;
    for (u32 mip = 1; mip < MIN(item->mip_count, GPU_MIP_VIEWS_CAP); mip++)
        ok = ok && texture_view(gpu, item, mip, 1, gpu_format_aspects(item->format),
                                &item->mip_views[mip]);
    return ok;
}

static bool texture_create_image(Gpu *gpu, GpuTextureItem *item, u32 heap,
                                 const VkImageCreateInfo *info) {
    const char *label = item->pool.label;
    if (!GPU_CHECK(gpu, label, gpu->vk.vkCreateImage(gpu->device, info, NULL, &item->image))) {
        item->image = VK_NULL_HANDLE;
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_IMAGE, GPU_HANDLE(item->image), "%s", label);
    VkMemoryDedicatedRequirements dedicated = {.sType =
                                                   VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS};
    VkMemoryRequirements2 needs = {.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2,
                                   .pNext = &dedicated};
    gpu->vk.vkGetImageMemoryRequirements2(
        gpu->device,
        &(VkImageMemoryRequirementsInfo2){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_REQUIREMENTS_INFO_2, .image = item->image},
        &needs);
    return gpu_memory_allocate(gpu, heap, GPU_MEMORY_DEVICE, &needs.memoryRequirements,
                               VK_NULL_HANDLE, item->image, dedicated.requiresDedicatedAllocation,
                               label, &item->allocation) &&
           GPU_CHECK(gpu, label,
                     gpu->vk.vkBindImageMemory(gpu->device, item->image,
                                               item->allocation.block->memory,
                                               item->allocation.offset)) &&
           texture_view(gpu, item, 0, item->mip_count, gpu_format_aspect(item->format),
                        &item->view) &&
           (!(info->usage & VK_IMAGE_USAGE_STORAGE_BIT) || texture_mip_views(gpu, item)) &&
           ((item->mip_count == 1 && !gpu_format_has_stencil(item->format)) ||
            texture_view(gpu, item, 0, 1, gpu_format_aspects(item->format), &item->target_view));
}

GpuTexture gpu_create_texture(Gpu *gpu, const GpuTextureDesc *desc) {
    GpuTextureItem *item;
    u32 id = gpu_pool_add(&gpu->textures, desc->label, (void **)&item);
    if (!id) return (GpuTexture){0};
    item->format = desc->format;
    item->width = MAX(desc->width, 1u);
    item->height = MAX(desc->height, 1u);
    item->depth = MAX(desc->depth, 1u);
    item->mip_count = MAX(desc->mip_count, 1u);
    item->samples = MAX(desc->samples, 1u);
    LUZ_ASSERT(item->samples == 1 ||
               (item->samples == 4 && item->mip_count == 1 && item->depth == 1 && !desc->storage));
    VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    if (desc->render_target)
        usage |= gpu_format_is_depth(desc->format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                   : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if (desc->storage) usage |= VK_IMAGE_USAGE_STORAGE_BIT;
    if (desc->sampled) usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
    if (desc->sampled && item->samples == 1) usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    LUZ_ASSERT(desc->render_target || desc->storage || desc->sampled);
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = item->depth > 1 ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D,
        .format = gpu_format_vk(gpu, desc->format),
        .extent = {item->width, item->height, item->depth},
        .mipLevels = item->mip_count,
        .arrayLayers = 1,
        .samples = (VkSampleCountFlagBits)item->samples, // the bit's value is the count
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage,
    };
    VkImageFormatProperties limits;
    VkResult result = vkGetPhysicalDeviceImageFormatProperties(
        gpu->physical, info.format, info.imageType, info.tiling, usage, 0, &limits);
    bool fits = result == VK_SUCCESS && item->width <= limits.maxExtent.width &&
                item->height <= limits.maxExtent.height && item->depth <= limits.maxExtent.depth &&
                item->mip_count <= limits.maxMipLevels && (limits.sampleCounts & item->samples) &&
                gpu_texture_bytes(item) <= limits.maxResourceSize;
    u32 longest = MAX(MAX(item->width, item->height), item->depth);
    LUZ_ASSERT(longest >> (item->mip_count - 1) > 0); // more mips than the size has
    if (!fits)
        LOG(GPU_LIMIT,
            "texture \"%s\" of %u x %u x %u, %u mips, %u samples, format %d: not possible here "
            "(%s)",
            desc->label, item->width, item->height, item->depth, item->mip_count, item->samples,
            (int)desc->format, result == VK_SUCCESS ? "too large" : gpu_result_name(result));
    u32 heap = gpu_heap_index(gpu, desc->heap ? desc->heap : "textures");
    if (!fits || !texture_create_image(gpu, item, heap, &info)) {
        gpu_destroy_texture(gpu, (GpuTexture){id});
        return (GpuTexture){0};
    }
    if (!item->target_view) item->target_view = item->view;
    return (GpuTexture){id};
}

void gpu_destroy_texture(Gpu *gpu, GpuTexture texture) {
    if (!texture.id) return;
    GpuTextureItem *item = gpu_texture_get(gpu, texture);
    if (item->target_view != item->view)
        gpu_destroy_later(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, GPU_HANDLE(item->target_view));
    for (u32 mip = 1; mip < GPU_MIP_VIEWS_CAP; mip++)
        if (item->mip_views[mip])
            gpu_destroy_later(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, GPU_HANDLE(item->mip_views[mip]));
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, GPU_HANDLE(item->view));
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_IMAGE, GPU_HANDLE(item->image));
    gpu_destroy_later_memory(gpu, item->allocation);
    gpu_pool_remove(&gpu->textures, texture.id);
}

// All mips, tightly packed.
u64 gpu_texture_bytes(const GpuTextureItem *texture) {
    u64 total = 0;
    for (u32 mip = 0; mip < texture->mip_count; mip++)
        total += (u64)MAX(texture->width >> mip, 1u) * MAX(texture->height >> mip, 1u) *
                 MAX(texture->depth >> mip, 1u) * gpu_format_bytes(texture->format);
    return total * texture->samples;
}

u64 gpu_texture_size(const Gpu *gpu, GpuTexture texture) {
    return gpu_texture_bytes(gpu_texture_get((Gpu *)gpu, texture));
}

// --- Samplers ---

GpuSampler gpu_create_sampler(Gpu *gpu, const GpuSamplerDesc *desc) {
    GpuSamplerItem *item;
    u32 id = gpu_pool_add(&gpu->samplers, desc->label, (void **)&item);
    if (!id) return (GpuSampler){0};
    VkFilter filter = desc->nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    VkSamplerAddressMode address =
        desc->repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    f32 anisotropy = MIN(desc->anisotropy, gpu->info.max_anisotropy);
    VkSamplerCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
        .magFilter = filter,
        .minFilter = filter,
        .mipmapMode = desc->nearest || desc->nearest_mips ? VK_SAMPLER_MIPMAP_MODE_NEAREST
                                                          : VK_SAMPLER_MIPMAP_MODE_LINEAR,
        .addressModeU = address,
        .addressModeV = address,
        .addressModeW = address,
        .anisotropyEnable = anisotropy > 1.0f,
        .maxAnisotropy = anisotropy > 1.0f ? anisotropy : 1.0f,
        .compareEnable = desc->compare_greater,
        .compareOp = desc->compare_greater ? VK_COMPARE_OP_GREATER_OR_EQUAL : VK_COMPARE_OP_NEVER,
        .maxLod = VK_LOD_CLAMP_NONE,
    };
    if (!GPU_CHECK(gpu, desc->label,
                   gpu->vk.vkCreateSampler(gpu->device, &info, NULL, &item->sampler))) {
        gpu_pool_remove(&gpu->samplers, id);
        return (GpuSampler){0};
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_SAMPLER, GPU_HANDLE(item->sampler), "%s", desc->label);
    return (GpuSampler){id};
}

void gpu_destroy_sampler(Gpu *gpu, GpuSampler sampler) {
    if (!sampler.id) return;
    GpuSamplerItem *item = gpu_pool_get(&gpu->samplers, sampler.id);
    gpu_destroy_later(gpu, VK_OBJECT_TYPE_SAMPLER, GPU_HANDLE(item->sampler));
    gpu_pool_remove(&gpu->samplers, sampler.id);
}
