// device.c: which device, which of its features; making and ending a Gpu.
//
// Data in: GpuDesc. Data out: a Gpu with device, queue and function table. Called by the
// application's shells, tests and tools. Does not: multiple queues or devices.
//
// Needed: Vulkan 1.3, or 1.2 with the KHR extensions of dynamic rendering and synchronization2;
// timeline semaphores; one queue for graphics and compute (and the window). All else is used if
// present and reported in GpuInfo.
#include "gpu_internal.h"
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct DeviceChoice {
    VkPhysicalDevice device;
    u32 queue_family;
    bool is_vulkan_12;
    i32 score;
} DeviceChoice;

static bool device_has_extension(VkPhysicalDevice device, const char *name) {
    u32 count = 0;
    vkEnumerateDeviceExtensionProperties(device, NULL, &count, NULL);
    VkExtensionProperties *extensions = calloc(count ? count : 1, sizeof *extensions);
    bool found = false;
    if (extensions && vkEnumerateDeviceExtensionProperties(device, NULL, &count, extensions) >= 0)
        for (u32 i = 0; i < count; i++) found |= strcmp(extensions[i].extensionName, name) == 0;
    free(extensions);
    return found;
}

static bool name_contains(const char *name, const char *part) {
    u64 length = strlen(part);
    for (; *name; name++)
        if (strncasecmp(name, part, length) == 0) return true;
    return false;
}

// Score < 0: cannot be used; `why` says so.
static DeviceChoice device_judge(Gpu *gpu, VkPhysicalDevice device, const char *wanted,
                                 const char **why) {
    DeviceChoice choice = {.device = device, .score = -1};
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    *why = "older than Vulkan 1.2";
    if (properties.apiVersion < VK_API_VERSION_1_2) return choice;
    choice.is_vulkan_12 = gpu->is_vulkan_12 || properties.apiVersion < VK_API_VERSION_1_3;
    *why = "Vulkan 1.2 without VK_KHR_dynamic_rendering and VK_KHR_synchronization2";
    if (choice.is_vulkan_12 &&
        (!device_has_extension(device, VK_KHR_DYNAMIC_RENDERING_EXTENSION_NAME) ||
         !device_has_extension(device, VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME)))
        return choice;
    *why = "uniform blocks smaller than 64 KiB";
    if (properties.limits.maxUniformBufferRange < GPU_UNIFORM_RANGE) return choice;
    *why = "no VK_KHR_swapchain";
    if (gpu->swap.surface && !device_has_extension(device, VK_KHR_SWAPCHAIN_EXTENSION_NAME))
        return choice;
    VkPhysicalDeviceVulkan12Features features12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    vkGetPhysicalDeviceFeatures2(
        device, &(VkPhysicalDeviceFeatures2){.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                             .pNext = &features12});
    *why = "no timeline semaphores";
    if (!features12.timelineSemaphore) return choice;

    *why = "no queue that draws, computes and shows";
    VkQueueFamilyProperties families[32];
    u32 family_count = COUNT_OF(families);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &family_count, families);
    choice.queue_family = UINT32_MAX;
    for (u32 i = 0; i < family_count && choice.queue_family == UINT32_MAX; i++) {
        VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        if ((families[i].queueFlags & both) != both) continue;
        VkBool32 shows = VK_TRUE;
        if (gpu->swap.surface &&
            vkGetPhysicalDeviceSurfaceSupportKHR(device, i, gpu->swap.surface, &shows) < 0)
            shows = VK_FALSE;
        if (shows) choice.queue_family = i;
    }
    if (choice.queue_family == UINT32_MAX) return choice;

    *why = NULL;
    switch (properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        choice.score = 40;
        break;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        choice.score = 30;
        break;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        choice.score = 20;
        break;
    default:
        choice.score = 10;
    }
    if (wanted && name_contains(properties.deviceName, wanted)) choice.score += 1000;
    return choice;
}

bool gpu_device_pick(Gpu *gpu, const char *wanted) {
    VkPhysicalDevice devices[16];
    u32 count = COUNT_OF(devices);
    VkResult result = vkEnumeratePhysicalDevices(gpu->instance, &count, devices);
    if (result < 0) count = 0;
    if (!wanted || !wanted[0]) wanted = getenv("LUZ_DEVICE");
    if (wanted && !wanted[0]) wanted = NULL;
    DeviceChoice best = {.score = -1};
    char reasons[512] = "";
    for (u32 i = 0; i < count; i++) {
        const char *why;
        DeviceChoice choice = device_judge(gpu, devices[i], wanted, &why);
        if (choice.score > best.score) best = choice;
        if (!why) continue;
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        u64 used = strlen(reasons);
        snprintf(reasons + used, sizeof reasons - used, "; %s: %s", properties.deviceName, why);
    }
    if (best.score < 0) {
        LOG(GPU_NONE,
            "none of %u Vulkan devices can be used%s: install a driver, for example "
            "mesa-vulkan-drivers, and check VK_DRIVER_FILES if it is set",
            count, reasons);
        return false;
    }
    if (wanted && best.score < 1000)
        LOG(NOTE, "no usable device is called \"%s\"; taking the best of %u", wanted, count);
    gpu->physical = best.device;
    gpu->queue_family = best.queue_family;
    gpu->is_vulkan_12 = best.is_vulkan_12;
    return true;
}

static void device_read_info(Gpu *gpu) {
    VkPhysicalDeviceMaintenance3Properties maintenance3 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES, .pNext = &maintenance3};
    VkPhysicalDeviceSubgroupProperties subgroup = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, .pNext = &driver};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
    vkGetPhysicalDeviceProperties2(gpu->physical, &properties);
    vkGetPhysicalDeviceMemoryProperties(gpu->physical, &gpu->memory_properties);
    VkQueueFamilyProperties families[32];
    u32 family_count = COUNT_OF(families);
    vkGetPhysicalDeviceQueueFamilyProperties(gpu->physical, &family_count, families);
    u32 timestamp_bits = families[gpu->queue_family].timestampValidBits;

    gpu->limits = properties.properties.limits;
    gpu->max_allocation_size = maintenance3.maxMemoryAllocationSize;
    gpu->timestamp_mask = timestamp_bits >= 64 ? UINT64_MAX : ((u64)1 << timestamp_bits) - 1;
    memcpy(gpu->cache_uuid, properties.properties.pipelineCacheUUID, VK_UUID_SIZE);
    GpuInfo *info = &gpu->info;
    snprintf(info->device_name, sizeof info->device_name, "%s", properties.properties.deviceName);
    snprintf(info->driver_name, sizeof info->driver_name, "%s", driver.driverName);
    snprintf(info->driver_info, sizeof info->driver_info, "%s", driver.driverInfo);
    info->api_version = properties.properties.apiVersion;
    info->driver_version = properties.properties.driverVersion;
    info->subgroup_size = subgroup.subgroupSize;
    VkSubgroupFeatureFlags wanted = VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT |
                                    VK_SUBGROUP_FEATURE_SHUFFLE_BIT |
                                    VK_SUBGROUP_FEATURE_ARITHMETIC_BIT;
    bool has_all = (subgroup.supportedOperations & wanted) == wanted;
    info->subgroup_compute = has_all && (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT);
    info->subgroup_fragment = has_all && (subgroup.supportedStages & VK_SHADER_STAGE_FRAGMENT_BIT);
    info->is_software = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    VkFormatProperties format;
    vkGetPhysicalDeviceFormatProperties(gpu->physical, VK_FORMAT_R32G32B32A32_SFLOAT, &format);
    info->rgba32f_blend =
        (format.optimalTilingFeatures & VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT) != 0;
    const VkFormat sampled[] = {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_D32_SFLOAT};
    const VkImageUsageFlags usage[] = {VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                       VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
    info->samples_4 = true;
    for (u32 i = 0; i < COUNT_OF(sampled); i++) {
        VkImageFormatProperties limits;
        VkResult result = vkGetPhysicalDeviceImageFormatProperties(
            gpu->physical, sampled[i], VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL,
            usage[i] | VK_IMAGE_USAGE_SAMPLED_BIT, 0, &limits);
        info->samples_4 = info->samples_4 && result == VK_SUCCESS &&
                          (limits.sampleCounts & VK_SAMPLE_COUNT_4_BIT);
    }
    info->max_storage_buffer_size = gpu->limits.maxStorageBufferRange;
    info->max_texture_side = gpu->limits.maxImageDimension2D;
    info->max_groups_x = gpu->limits.maxComputeWorkGroupCount[0];
    info->timestamps = timestamp_bits > 0 && gpu->limits.timestampPeriod > 0.0f;
}

// A driver that draws on the CPU keeps a picture's triangles on the heap, megabytes a frame: the
// allocator shall not give them back to the system only to ask for zeroed pages again (about a
// thousand page faults a frame, a quarter of the time that binning takes).
static void keep_heap(void) {
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, (int)MIB(256));
    mallopt(M_MMAP_THRESHOLD, (int)MIB(32)); // the most that it accepts
#endif
}

bool gpu_device_create(Gpu *gpu) {
    device_read_info(gpu);
    if (gpu->info.is_software) keep_heap();
    VkPhysicalDeviceDynamicRenderingFeatures rendering = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES};
    VkPhysicalDeviceSynchronization2Features synchronization = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES, .pNext = &rendering};
    VkPhysicalDeviceVulkan13Features has13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features has12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
        .pNext = gpu->is_vulkan_12 ? (void *)&synchronization : (void *)&has13};
    VkPhysicalDeviceVulkan11Features has11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES, .pNext = &has12};
    VkPhysicalDeviceFeatures2 has = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &has11};
    vkGetPhysicalDeviceFeatures2(gpu->physical, &has);
    bool has_needed = gpu->is_vulkan_12
                          ? rendering.dynamicRendering && synchronization.synchronization2
                          : has13.dynamicRendering && has13.synchronization2;
    if (!has_needed) {
        LOG(GPU_NONE, "\"%s\" has no dynamic rendering or synchronization2: update its driver",
            gpu->info.device_name);
        return false;
    }
    // The structs that were asked become the structs that enable: keep the few that are used.
    gpu->features = (VkPhysicalDeviceFeatures){
        .depthClamp = has.features.depthClamp,
        .geometryShader = has.features.geometryShader, // for gl_PrimitiveID of fragments
        .samplerAnisotropy = has.features.samplerAnisotropy,
        .fragmentStoresAndAtomics = has.features.fragmentStoresAndAtomics,
        .vertexPipelineStoresAndAtomics = has.features.vertexPipelineStoresAndAtomics,
        .shaderStorageImageExtendedFormats = has.features.shaderStorageImageExtendedFormats,
    };
    has.features = gpu->features;
    has11 = (VkPhysicalDeviceVulkan11Features){.sType = has11.sType,
                                               .pNext = has11.pNext,
                                               .shaderDrawParameters = has11.shaderDrawParameters};
    has12 = (VkPhysicalDeviceVulkan12Features){
        .sType = has12.sType, .pNext = has12.pNext, .timelineSemaphore = VK_TRUE};
    has13 = (VkPhysicalDeviceVulkan13Features){
        .sType = has13.sType,
        .dynamicRendering = VK_TRUE,
        .synchronization2 = VK_TRUE,
        .maintenance4 = has13.maintenance4,
        .shaderTerminateInvocation = has13.shaderTerminateInvocation,
        .shaderDemoteToHelperInvocation = has13.shaderDemoteToHelperInvocation,
    };
    gpu->info.depth_clamp = gpu->features.depthClamp;
    gpu->info.primitive_id = gpu->features.geometryShader;
    gpu->info.max_anisotropy =
        gpu->features.samplerAnisotropy ? gpu->limits.maxSamplerAnisotropy : 0.0f;

    const char *extensions[4];
    u32 extension_count = 0;
    if (gpu->swap.surface) extensions[extension_count++] = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    if (gpu->is_vulkan_12) {
        extensions[extension_count++] = VK_KHR_DYNAMIC_RENDERING_EXTENSION_NAME;
        extensions[extension_count++] = VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME;
    }
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &has,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos =
            &(VkDeviceQueueCreateInfo){
                .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                .queueFamilyIndex = gpu->queue_family,
                .queueCount = 1,
                .pQueuePriorities = &(f32){1.0f},
            },
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
    };
    if (!GPU_CHECK(gpu, gpu->info.device_name,
                   vkCreateDevice(gpu->physical, &info, NULL, &gpu->device))) {
        gpu->device = VK_NULL_HANDLE;
        return false;
    }
    volkLoadDeviceTable(&gpu->vk, gpu->device);
    if (gpu->is_vulkan_12) { // the one place that knows the other names
        gpu->vk.vkCmdBeginRendering = gpu->vk.vkCmdBeginRenderingKHR;
        gpu->vk.vkCmdEndRendering = gpu->vk.vkCmdEndRenderingKHR;
        gpu->vk.vkCmdPipelineBarrier2 = gpu->vk.vkCmdPipelineBarrier2KHR;
        gpu->vk.vkCmdWriteTimestamp2 = gpu->vk.vkCmdWriteTimestamp2KHR;
        gpu->vk.vkQueueSubmit2 = gpu->vk.vkQueueSubmit2KHR;
    }
    gpu->vk.vkGetDeviceQueue(gpu->device, gpu->queue_family, 0, &gpu->queue);
    gpu_name_object(gpu, VK_OBJECT_TYPE_DEVICE, GPU_HANDLE(gpu->device), "%s", gpu->label);
    gpu_name_object(gpu, VK_OBJECT_TYPE_QUEUE, GPU_HANDLE(gpu->queue), "%s queue", gpu->label);
    return true;
}

Gpu *gpu_create(const GpuDesc *desc) {
    LUZ_ASSERT(desc->label && desc->label[0]);
    Gpu *gpu = calloc(1, sizeof *gpu);
    if (!gpu) return NULL;
    snprintf(gpu->label, sizeof gpu->label, "%s", desc->label);
    gpu->accurate_timers = desc->accurate_timers;
    gpu->has_timers = true;
    gpu->create_surface = desc->create_surface;
    gpu->window = desc->window;
    gpu->buffers = (GpuPool){.what = "buffer", .item_size = sizeof(GpuBufferItem)};
    gpu->textures = (GpuPool){.what = "texture", .item_size = sizeof(GpuTextureItem)};
    gpu->samplers = (GpuPool){.what = "sampler", .item_size = sizeof(GpuSamplerItem)};
    gpu->bind_layouts = (GpuPool){.what = "bind layout", .item_size = sizeof(GpuBindLayoutItem)};
    gpu->bind_groups = (GpuPool){.what = "bind group", .item_size = sizeof(GpuBindGroupItem)};
    gpu->pipelines = (GpuPool){.what = "pipeline", .item_size = sizeof(GpuPipelineItem)};
    u32 frames = desc->frames_in_flight ? desc->frames_in_flight : 2;
    if (!gpu_instance_create(gpu, desc) || !gpu_surface_create(gpu) ||
        !gpu_device_pick(gpu, desc->device) || !gpu_device_create(gpu) ||
        !gpu_surface_pick_format(gpu) ||
        !gpu_frames_create(gpu, MIN(frames, GPU_FRAMES_IN_FLIGHT_MAX))) {
        gpu_destroy(gpu);
        return NULL;
    }
    gpu_pipeline_cache_load(gpu);
    LOG(GPU_DEVICE, "%s (%s %s), Vulkan %u.%u%s, subgroups of %u", gpu->info.device_name,
        gpu->info.driver_name, gpu->info.driver_info, VK_API_VERSION_MAJOR(gpu->info.api_version),
        VK_API_VERSION_MINOR(gpu->info.api_version),
        gpu->is_vulkan_12 ? " used as 1.2 with extensions" : "", gpu->info.subgroup_size);
    return gpu;
}

// Objects that their owner forgot: named, then freed.
static void destroy_forgotten(Gpu *gpu) {
#define REPORT(pool, Handle, function)                                                             \
    for (u32 i = 0; i < gpu->pool.count; i++) {                                                    \
        GpuPoolItem *item = gpu_pool_at(&gpu->pool, i);                                            \
        if (!item) continue;                                                                       \
        LOG(DEBUG_NOTE, "%s \"%s\" is still alive at the end", gpu->pool.what, item->label);       \
        function(gpu, (Handle){gpu_pool_id_at(&gpu->pool, i)});                                    \
    }
    REPORT(bind_groups, GpuBindGroup, gpu_destroy_bind_group)
    REPORT(pipelines, GpuPipeline, gpu_destroy_pipeline)
    REPORT(samplers, GpuSampler, gpu_destroy_sampler)
    REPORT(textures, GpuTexture, gpu_destroy_texture)
    REPORT(buffers, GpuBuffer, gpu_destroy_buffer)
#undef REPORT
}

void gpu_destroy(Gpu *gpu) {
    if (!gpu) return;
    if (gpu->device) {
        gpu->vk.vkDeviceWaitIdle(gpu->device);
        gpu_pipeline_cache_save(gpu);
        destroy_forgotten(gpu);
        gpu_destroy_stamp(gpu, gpu->submitted);
        gpu_destroy_collect(gpu, UINT64_MAX);
        gpu_uploads_destroy(gpu);
        gpu_shaders_destroy(gpu);
        gpu_bindings_destroy(gpu);
        gpu_swapchain_destroy(gpu);
        gpu_frames_destroy(gpu);
        gpu->vk.vkDestroyPipelineCache(gpu->device, gpu->pipeline_cache, NULL);
        gpu->vk.vkDestroyDevice(gpu->device, NULL);
    }
    if (gpu->swap.surface) vkDestroySurfaceKHR(gpu->instance, gpu->swap.surface, NULL);
    gpu_instance_destroy(gpu);
    GpuPool *pools[] = {&gpu->buffers,      &gpu->textures,    &gpu->samplers,
                        &gpu->bind_layouts, &gpu->bind_groups, &gpu->pipelines};
    for (u32 i = 0; i < COUNT_OF(pools); i++) free(pools[i]->items);
    free(gpu->doomed);
    free(gpu);
}

const GpuInfo *gpu_info(const Gpu *gpu) { return &gpu->info; }
bool gpu_is_lost(const Gpu *gpu) { return gpu->is_lost; }
u32 gpu_validation_message_count(const Gpu *gpu) { return gpu->validation_count; }
