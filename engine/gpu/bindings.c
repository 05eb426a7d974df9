// bindings.c: bind layouts and bind groups, that is descriptor sets.
//
// Data in: lists of binding kinds; lists of resources. Data out: handles. Called by the renderer
// when it loads or resizes. Does not change a group once made: make a new one and destroy the old.
//
// A group that holds a DYNAMIC buffer has one set a frame slot, each with that slot's copy; the
// others have one. Descriptor pools are added as they fill; what a pool has left is counted here,
// because drivers differ in what they do about an exhausted pool.
#include "gpu_internal.h"
#include <stdlib.h>
#include <string.h>

#define POOL_SETS        128u
#define POOL_DESCRIPTORS 512u // of each kind; at least GPU_BINDINGS_CAP

static VkDescriptorType descriptor_type(GpuBindingKind kind) {
    static const VkDescriptorType types[] = {
        [GPU_BINDING_STORAGE_BUFFER] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [GPU_BINDING_UNIFORM_BUFFER] = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        [GPU_BINDING_SAMPLED_TEXTURE] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [GPU_BINDING_STORAGE_TEXTURE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
    };
    LUZ_ASSERT((u32)kind < COUNT_OF(types));
    return types[kind];
}

// --- Layouts ---

GpuBindLayout gpu_create_bind_layout(Gpu *gpu, const GpuBindLayoutDesc *desc) {
    GpuBindLayoutItem *item;
    u32 id = gpu_pool_add(&gpu->bind_layouts, desc->label, (void **)&item);
    if (!id) return (GpuBindLayout){0};
    LUZ_ASSERT(desc->count <= GPU_BINDINGS_CAP);
    VkDescriptorSetLayoutBinding bindings[GPU_BINDINGS_CAP];
    for (u32 i = 0; i < desc->count; i++) {
        item->kinds[i] = desc->kinds[i];
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = descriptor_type(desc->kinds[i]),
            .descriptorCount = 1,
            .stageFlags = GPU_STAGES,
        };
    }
    item->count = desc->count;
    VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = desc->count,
        .pBindings = bindings,
    };
    if (!GPU_CHECK(gpu, desc->label,
                   gpu->vk.vkCreateDescriptorSetLayout(gpu->device, &info, NULL, &item->layout))) {
        gpu_pool_remove(&gpu->bind_layouts, id);
        return (GpuBindLayout){0};
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, GPU_HANDLE(item->layout), "%s",
                    desc->label);
    return (GpuBindLayout){id};
}

// --- Descriptor pools ---

static void count_kinds(const GpuBindLayoutItem *layout, u32 out[GPU_BINDING_KIND_COUNT]) {
    memset(out, 0, GPU_BINDING_KIND_COUNT * sizeof *out);
    for (u32 i = 0; i < layout->count; i++) out[layout->kinds[i]]++;
}

static bool descriptor_pool_add(Gpu *gpu, const char *label) {
    GpuDescriptorPool *grown =
        realloc(gpu->descriptor_pools, (gpu->descriptor_pool_count + 1) * sizeof *grown);
    if (!grown) return false;
    gpu->descriptor_pools = grown;
    GpuDescriptorPool *pool = &grown[gpu->descriptor_pool_count];
    *pool = (GpuDescriptorPool){.sets_left = POOL_SETS};
    VkDescriptorPoolSize sizes[GPU_BINDING_KIND_COUNT];
    for (u32 kind = 0; kind < GPU_BINDING_KIND_COUNT; kind++) {
        sizes[kind] =
            (VkDescriptorPoolSize){descriptor_type((GpuBindingKind)kind), POOL_DESCRIPTORS};
        pool->left[kind] = POOL_DESCRIPTORS;
    }
    VkDescriptorPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
        .maxSets = POOL_SETS,
        .poolSizeCount = GPU_BINDING_KIND_COUNT,
        .pPoolSizes = sizes,
    };
    if (!GPU_CHECK(gpu, label,
                   gpu->vk.vkCreateDescriptorPool(gpu->device, &info, NULL, &pool->pool)))
        return false;
    gpu_name_object(gpu, VK_OBJECT_TYPE_DESCRIPTOR_POOL, GPU_HANDLE(pool->pool),
                    "descriptor pool %u", gpu->descriptor_pool_count);
    gpu->descriptor_pool_count++;
    return true;
}

static bool descriptor_set_from_pool(Gpu *gpu, u32 index, const GpuBindLayoutItem *layout,
                                     VkDescriptorSet *set) {
    GpuDescriptorPool *pool = &gpu->descriptor_pools[index];
    u32 counts[GPU_BINDING_KIND_COUNT];
    count_kinds(layout, counts);
    if (pool->sets_left == 0) return false;
    for (u32 kind = 0; kind < GPU_BINDING_KIND_COUNT; kind++)
        if (counts[kind] > pool->left[kind]) return false;
    VkDescriptorSetAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = pool->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &layout->layout,
    };
    // Fragmentation may refuse what the counts allow: the next pool is tried, so no log.
    if (gpu->vk.vkAllocateDescriptorSets(gpu->device, &info, set) < 0) return false;
    pool->sets_left--;
    for (u32 kind = 0; kind < GPU_BINDING_KIND_COUNT; kind++) pool->left[kind] -= counts[kind];
    return true;
}

static bool descriptor_set_allocate(Gpu *gpu, const GpuBindLayoutItem *layout, const char *label,
                                    VkDescriptorSet *set, u32 *pool_index) {
    for (u32 i = gpu->descriptor_pool_count; i-- > 0;)
        if (descriptor_set_from_pool(gpu, i, layout, set)) {
            *pool_index = i;
            return true;
        }
    if (descriptor_pool_add(gpu, label)) {
        *pool_index = gpu->descriptor_pool_count - 1;
        if (descriptor_set_from_pool(gpu, *pool_index, layout, set)) return true;
    }
    LOG(GPU_RESULT, "no descriptor set for bind group \"%s\"", label);
    return false;
}

void gpu_descriptor_set_freed(Gpu *gpu, u32 descriptor_pool, u32 layout_id, VkDescriptorSet set) {
    GpuDescriptorPool *pool = &gpu->descriptor_pools[descriptor_pool];
    u32 counts[GPU_BINDING_KIND_COUNT];
    count_kinds(gpu_pool_get(&gpu->bind_layouts, layout_id), counts);
    gpu->vk.vkFreeDescriptorSets(gpu->device, pool->pool, 1, &set);
    pool->sets_left++;
    for (u32 kind = 0; kind < GPU_BINDING_KIND_COUNT; kind++) pool->left[kind] += counts[kind];
}

void gpu_bindings_destroy(Gpu *gpu) {
    for (u32 i = 0; i < gpu->descriptor_pool_count; i++)
        gpu->vk.vkDestroyDescriptorPool(gpu->device, gpu->descriptor_pools[i].pool, NULL);
    free(gpu->descriptor_pools);
    for (u32 i = 0; i < gpu->bind_layouts.count; i++) {
        GpuBindLayoutItem *item = gpu_pool_at(&gpu->bind_layouts, i);
        if (item) gpu->vk.vkDestroyDescriptorSetLayout(gpu->device, item->layout, NULL);
    }
}

// --- Groups ---

static bool binding_is_buffer(GpuBindingKind kind) {
    return kind == GPU_BINDING_STORAGE_BUFFER || kind == GPU_BINDING_UNIFORM_BUFFER;
}

// Writes all bindings of one set; the DYNAMIC buffers as of this frame slot.
static void set_write(Gpu *gpu, const GpuBindGroupDesc *desc, const GpuBindLayoutItem *layout,
                      VkDescriptorSet set, u32 slot) {
    VkWriteDescriptorSet writes[GPU_BINDINGS_CAP];
    VkDescriptorBufferInfo buffers[GPU_BINDINGS_CAP];
    VkDescriptorImageInfo images[GPU_BINDINGS_CAP];
    for (u32 i = 0; i < layout->count; i++) {
        const GpuBinding *binding = &desc->bindings[i];
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = set,
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = descriptor_type(layout->kinds[i]),
            .pImageInfo = &images[i],
            .pBufferInfo = &buffers[i],
        };
        if (binding_is_buffer(layout->kinds[i])) {
            const GpuBufferItem *buffer = gpu_buffer_get(gpu, binding->buffer);
            LUZ_ASSERT(binding->offset < buffer->size);
            u64 range = buffer->size - binding->offset;
            if (layout->kinds[i] == GPU_BINDING_UNIFORM_BUFFER)
                range = MIN(range, GPU_UNIFORM_RANGE);
            buffers[i] = (VkDescriptorBufferInfo){buffer->buffer,
                                                  buffer->stride * slot + binding->offset, range};
            continue;
        }
        const GpuTextureItem *texture = gpu_texture_get(gpu, binding->texture);
        if (layout->kinds[i] == GPU_BINDING_STORAGE_TEXTURE) {
            LUZ_ASSERT(binding->mip == 0 ||
                       (binding->mip < GPU_MIP_VIEWS_CAP && texture->mip_views[binding->mip]));
            images[i] = (VkDescriptorImageInfo){VK_NULL_HANDLE,
                                                binding->mip ? texture->mip_views[binding->mip]
                                                             : texture->target_view,
                                                VK_IMAGE_LAYOUT_GENERAL};
        } else {
            const GpuSamplerItem *sampler = gpu_pool_get(&gpu->samplers, binding->sampler.id);
            images[i] = (VkDescriptorImageInfo){
                sampler->sampler, texture->view,
                gpu_usage_layout(GPU_USAGE_SAMPLED_FRAGMENT, gpu_format_is_depth(texture->format))};
        }
    }
    gpu->vk.vkUpdateDescriptorSets(gpu->device, layout->count, writes, 0, NULL);
}

GpuBindGroup gpu_create_bind_group(Gpu *gpu, const GpuBindGroupDesc *desc) {
    const GpuBindLayoutItem *layout = gpu_pool_get(&gpu->bind_layouts, desc->layout.id);
    u32 set_count = 1;
    for (u32 i = 0; i < layout->count; i++) {
        if (!binding_is_buffer(layout->kinds[i])) continue;
        const GpuBufferItem *buffer = gpu_buffer_get(gpu, desc->bindings[i].buffer);
        if (buffer->kind == GPU_BUFFER_DYNAMIC) set_count = gpu->frame_count;
        if (layout->kinds[i] == GPU_BINDING_STORAGE_BUFFER &&
            buffer->size > gpu->info.max_storage_buffer_size) {
            LOG(GPU_LIMIT,
                "bind group \"%s\": buffer \"%s\" of %.1f MiB, shaders here see %.1f MiB",
                desc->label, buffer->pool.label, (f64)buffer->size / (f64)MIB(1),
                (f64)gpu->info.max_storage_buffer_size / (f64)MIB(1));
            return (GpuBindGroup){0};
        }
    }
    GpuBindGroupItem *item;
    u32 id = gpu_pool_add(&gpu->bind_groups, desc->label, (void **)&item);
    if (!id) return (GpuBindGroup){0};
    item->layout_id = desc->layout.id;
    for (u32 slot = 0; slot < set_count; slot++) {
        if (!descriptor_set_allocate(gpu, layout, desc->label, &item->sets[slot],
                                     &item->descriptor_pools[slot])) {
            gpu_destroy_bind_group(gpu, (GpuBindGroup){id});
            return (GpuBindGroup){0};
        }
        item->set_count++;
        set_write(gpu, desc, layout, item->sets[slot], slot);
        gpu_name_object(gpu, VK_OBJECT_TYPE_DESCRIPTOR_SET, GPU_HANDLE(item->sets[slot]), "%s %u",
                        desc->label, slot);
    }
    return (GpuBindGroup){id};
}

void gpu_destroy_bind_group(Gpu *gpu, GpuBindGroup group) {
    if (!group.id) return;
    GpuBindGroupItem *item = gpu_pool_get(&gpu->bind_groups, group.id);
    for (u32 i = 0; i < item->set_count; i++)
        gpu_destroy_later_set(gpu, item->sets[i], item->descriptor_pools[i], item->layout_id);
    gpu_pool_remove(&gpu->bind_groups, group.id);
}
