// swapchain.c: the window's images.
//
// Data in: a surface made by GpuDesc.create_surface, a framebuffer size. Data out: an image to draw
// to, shown by present. Called by the window shell: resize, then each frame begin, acquire, draw,
// end, present. Does not know window libraries, and headless none of it runs.
//
// Out of date, minimised and lost surfaces are normal events here: the calls say false, the shell
// calls gpu_swapchain_resize, and that makes whatever is missing.
#include "gpu_internal.h"

#define ACQUIRE_TIMEOUT_NS 1000000000ull // a hidden window may give no image: do not hang

bool gpu_surface_create(Gpu *gpu) {
    if (!gpu->create_surface) return true;
    u64 surface = 0;
    int result = gpu->create_surface(gpu->instance, gpu->window, NULL, &surface);
    if (result != VK_SUCCESS || !surface) {
        LOG(GPU_RESULT, "the window \"%s\" gave no surface: %s", gpu->label,
            gpu_result_name((VkResult)result));
        return false;
    }
    gpu->swap.surface = (VkSurfaceKHR)(uintptr_t)surface;
    return true;
}

// The first entry is often sRGB, whose second encoding would wash out what the tone mapper wrote.
bool gpu_surface_pick_format(Gpu *gpu) {
    GpuSwapchain *swap = &gpu->swap;
    if (!swap->surface) return true;
    VkSurfaceFormatKHR formats[64];
    u32 count = COUNT_OF(formats);
    VkResult result =
        vkGetPhysicalDeviceSurfaceFormatsKHR(gpu->physical, swap->surface, &count, formats);
    if (!GPU_CHECK(gpu, gpu->label, result)) return false;
    for (u32 i = 0; i < count; i++)
        if (formats[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR &&
            (formats[i].format == VK_FORMAT_B8G8R8A8_UNORM ||
             formats[i].format == VK_FORMAT_R8G8B8A8_UNORM)) {
            swap->format = formats[i];
            return true;
        }
    LOG(GPU_NONE, "the window \"%s\" takes neither BGRA8 nor RGBA8 (unorm) images", gpu->label);
    return false;
}

// Remembers what has to be made anew. True if the result is a success.
static bool swapchain_result(Gpu *gpu, VkResult result, const char *call) {
    GpuSwapchain *swap = &gpu->swap;
    if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) swap->is_stale = true;
    if (result == VK_ERROR_SURFACE_LOST_KHR) {
        if (!swap->is_surface_lost) LOG(GPU_LOST, "the window's surface is lost (%s)", call);
        swap->is_stale = swap->is_surface_lost = true;
        return false;
    }
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return false;
    return gpu_check_at(gpu, result, call, gpu->label, __FILE__, __LINE__);
}

static void images_destroy(Gpu *gpu) {
    GpuSwapchain *swap = &gpu->swap;
    for (u32 i = 0; i < swap->image_count; i++) {
        gpu->vk.vkDestroyImageView(gpu->device, swap->views[i], NULL);
        gpu->vk.vkDestroySemaphore(gpu->device, swap->rendered[i], NULL);
        swap->views[i] = VK_NULL_HANDLE;
        swap->rendered[i] = VK_NULL_HANDLE;
    }
    swap->image_count = 0;
}

static void swapchain_drop(Gpu *gpu) {
    images_destroy(gpu);
    if (gpu->swap.swapchain) gpu->vk.vkDestroySwapchainKHR(gpu->device, gpu->swap.swapchain, NULL);
    gpu->swap.swapchain = VK_NULL_HANDLE;
}

void gpu_swapchain_destroy(Gpu *gpu) { swapchain_drop(gpu); }

static VkPresentModeKHR pick_present_mode(Gpu *gpu, bool vsync) {
    VkPresentModeKHR modes[16];
    u32 count = COUNT_OF(modes);
    if (vsync || vkGetPhysicalDeviceSurfacePresentModesKHR(gpu->physical, gpu->swap.surface, &count,
                                                           modes) < 0)
        return VK_PRESENT_MODE_FIFO_KHR; // always there
    VkPresentModeKHR best = VK_PRESENT_MODE_FIFO_KHR;
    for (u32 i = 0; i < count; i++) {
        if (modes[i] == VK_PRESENT_MODE_MAILBOX_KHR) return modes[i];
        if (modes[i] == VK_PRESENT_MODE_IMMEDIATE_KHR) best = modes[i];
    }
    return best;
}

static bool images_create(Gpu *gpu) {
    GpuSwapchain *swap = &gpu->swap;
    u32 count = 0;
    if (!GPU_CHECK(gpu, gpu->label,
                   gpu->vk.vkGetSwapchainImagesKHR(gpu->device, swap->swapchain, &count, NULL)))
        return false;
    if (count > GPU_SWAP_IMAGES_CAP) {
        LOG(GPU_LIMIT, "the swapchain has %u images, %u are handled", count, GPU_SWAP_IMAGES_CAP);
        return false;
    }
    if (!GPU_CHECK(
            gpu, gpu->label,
            gpu->vk.vkGetSwapchainImagesKHR(gpu->device, swap->swapchain, &count, swap->images)))
        return false;
    swap->image_count = count;
    for (u32 i = 0; i < count; i++) {
        VkImageViewCreateInfo view = {
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .image = swap->images[i],
            .viewType = VK_IMAGE_VIEW_TYPE_2D,
            .format = swap->format.format,
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
        };
        VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        if (!GPU_CHECK(gpu, "swapchain",
                       gpu->vk.vkCreateImageView(gpu->device, &view, NULL, &swap->views[i])) ||
            !GPU_CHECK(
                gpu, "swapchain",
                gpu->vk.vkCreateSemaphore(gpu->device, &semaphore, NULL, &swap->rendered[i])))
            return false;
        gpu_name_object(gpu, VK_OBJECT_TYPE_IMAGE, GPU_HANDLE(swap->images[i]), "swapchain %u", i);
        gpu_name_object(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, GPU_HANDLE(swap->views[i]), "swapchain %u",
                        i);
        gpu_name_object(gpu, VK_OBJECT_TYPE_SEMAPHORE, GPU_HANDLE(swap->rendered[i]), "rendered %u",
                        i);
    }
    return true;
}

static bool surface_renew(Gpu *gpu) {
    GpuSwapchain *swap = &gpu->swap;
    swapchain_drop(gpu);
    if (swap->surface) vkDestroySurfaceKHR(gpu->instance, swap->surface, NULL);
    swap->surface = VK_NULL_HANDLE;
    if (!gpu_surface_create(gpu)) return false;
    VkFormat before = swap->format.format;
    VkBool32 shows = VK_FALSE;
    if (!GPU_CHECK(gpu, gpu->label,
                   vkGetPhysicalDeviceSurfaceSupportKHR(gpu->physical, gpu->queue_family,
                                                        swap->surface, &shows)) ||
        !shows || !gpu_surface_pick_format(gpu))
        return false;
    if (swap->format.format != before) { // pipelines were made for the old one
        LOG(GPU_LIMIT, "the new surface has another format than the old one");
        swap->format.format = before;
        return false;
    }
    swap->is_surface_lost = false;
    return true;
}

bool gpu_swapchain_resize(Gpu *gpu, u32 width, u32 height, bool vsync) {
    GpuSwapchain *swap = &gpu->swap;
    LUZ_ASSERT(gpu->create_surface && !gpu->is_recording);
    if (gpu->is_lost) return false;
    swap->is_stale = true; // until a new one is there
    swap->is_acquired = false;
    if (!width || !height) return false;
    if (!GPU_CHECK(gpu, gpu->label, gpu->vk.vkDeviceWaitIdle(gpu->device))) return false;
    if ((swap->is_surface_lost || !swap->surface) && !surface_renew(gpu)) return false;

    VkSurfaceCapabilitiesKHR caps;
    if (!swapchain_result(
            gpu, vkGetPhysicalDeviceSurfaceCapabilitiesKHR(gpu->physical, swap->surface, &caps),
            "vkGetPhysicalDeviceSurfaceCapabilitiesKHR"))
        return false;
    VkExtent2D extent = caps.currentExtent;
    if (extent.width == UINT32_MAX)
        extent = (VkExtent2D){
            CLAMP(width, caps.minImageExtent.width, caps.maxImageExtent.width),
            CLAMP(height, caps.minImageExtent.height, caps.maxImageExtent.height),
        };
    if (!extent.width || !extent.height) return false;
    // One more than the least, so that drawing need not wait for showing.
    u32 image_count = caps.minImageCount + 1;
    if (caps.maxImageCount) image_count = MIN(image_count, caps.maxImageCount);
    VkSwapchainKHR old = swap->swapchain;
    VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = swap->surface,
        .minImageCount = image_count,
        .imageFormat = swap->format.format,
        .imageColorSpace = swap->format.colorSpace,
        .imageExtent = extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
        .preTransform = caps.currentTransform,
        .compositeAlpha = caps.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
        .presentMode = pick_present_mode(gpu, vsync),
        .clipped = VK_TRUE,
        .oldSwapchain = old,
    };
    images_destroy(gpu);
    swap->swapchain = VK_NULL_HANDLE;
    VkResult result = gpu->vk.vkCreateSwapchainKHR(gpu->device, &info, NULL, &swap->swapchain);
    if (old) gpu->vk.vkDestroySwapchainKHR(gpu->device, old, NULL);
    if (!swapchain_result(gpu, result, "vkCreateSwapchainKHR")) {
        swap->swapchain = VK_NULL_HANDLE;
        return false;
    }
    gpu_name_object(gpu, VK_OBJECT_TYPE_SWAPCHAIN_KHR, GPU_HANDLE(swap->swapchain), "swapchain");
    if (!images_create(gpu)) {
        swapchain_drop(gpu);
        return false;
    }
    swap->width = extent.width;
    swap->height = extent.height;
    swap->is_stale = false;
    return true;
}

void gpu_swapchain_size(const Gpu *gpu, u32 *width, u32 *height) {
    *width = gpu->swap.swapchain ? gpu->swap.width : 0;
    *height = gpu->swap.swapchain ? gpu->swap.height : 0;
}

bool gpu_swapchain_acquire(Gpu *gpu, GpuCommands *cmd) {
    GpuSwapchain *swap = &gpu->swap;
    LUZ_ASSERT(cmd == &gpu->commands && gpu->is_recording);
    LUZ_ASSERT(!swap->is_acquired); // one image at a time: present comes first
    if (!swap->swapchain || swap->is_stale) return false;
    VkResult result = gpu->vk.vkAcquireNextImageKHR(
        gpu->device, swap->swapchain, ACQUIRE_TIMEOUT_NS, gpu->slots[gpu->frame_slot].acquired,
        VK_NULL_HANDLE, &swap->image_index);
    if (result == VK_TIMEOUT || result == VK_NOT_READY) return false;
    // A suboptimal image is an image: draw it, and let present say that a resize is due.
    if (!swapchain_result(gpu, result, "vkAcquireNextImageKHR")) return false;
    swap->is_acquired = swap->is_awaited = true;
    swap->is_drawn = false;
    return true;
}

static void swapchain_barrier(Gpu *gpu, GpuUsage to) {
    GpuSwapchain *swap = &gpu->swap;
    GpuUsage from = swap->is_drawn ? GPU_USAGE_COLOR_TARGET : GPU_USAGE_NONE;
    VkImageMemoryBarrier2 barrier = gpu_image_barrier(
        swap->images[swap->image_index], GPU_FORMAT_SWAPCHAIN, from, to, !swap->is_drawn);
    gpu_record_barriers(gpu, gpu->commands.buffer, NULL, &barrier, 1);
}

void gpu_swapchain_to_color(Gpu *gpu) {
    swapchain_barrier(gpu, GPU_USAGE_COLOR_TARGET);
    gpu->swap.is_drawn = true;
}

void gpu_swapchain_finish(Gpu *gpu) { swapchain_barrier(gpu, GPU_USAGE_PRESENT); }

bool gpu_swapchain_present(Gpu *gpu) {
    GpuSwapchain *swap = &gpu->swap;
    if (!swap->is_acquired) return !swap->is_stale;
    LUZ_ASSERT(!swap->is_awaited); // gpu_frame_end comes first
    swap->is_acquired = false;
    if (gpu->is_lost) return false;
    VkPresentInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
        .waitSemaphoreCount = 1,
        .pWaitSemaphores = &swap->rendered[swap->image_index],
        .swapchainCount = 1,
        .pSwapchains = &swap->swapchain,
        .pImageIndices = &swap->image_index,
    };
    bool ok =
        swapchain_result(gpu, gpu->vk.vkQueuePresentKHR(gpu->queue, &info), "vkQueuePresentKHR");
    return ok && !swap->is_stale;
}
