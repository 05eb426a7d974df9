// gpu_names.c: names of results, names of objects.
//
// Data in: results of Vulkan calls, objects. Data out: log lines that say which call failed on
// which object; debug names that validation messages and capture tools show. Called by all files
// here.
#include "gpu_internal.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *gpu_result_name(VkResult result) {
    switch (result) {
#define NAME(r)                                                                                    \
    case r:                                                                                        \
        return #r
        NAME(VK_SUCCESS);
        NAME(VK_NOT_READY);
        NAME(VK_TIMEOUT);
        NAME(VK_INCOMPLETE);
        NAME(VK_SUBOPTIMAL_KHR);
        NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
        NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
        NAME(VK_ERROR_INITIALIZATION_FAILED);
        NAME(VK_ERROR_DEVICE_LOST);
        NAME(VK_ERROR_MEMORY_MAP_FAILED);
        NAME(VK_ERROR_LAYER_NOT_PRESENT);
        NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
        NAME(VK_ERROR_FEATURE_NOT_PRESENT);
        NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
        NAME(VK_ERROR_TOO_MANY_OBJECTS);
        NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
        NAME(VK_ERROR_FRAGMENTED_POOL);
        NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
        NAME(VK_ERROR_SURFACE_LOST_KHR);
        NAME(VK_ERROR_NATIVE_WINDOW_IN_USE_KHR);
        NAME(VK_ERROR_OUT_OF_DATE_KHR);
#undef NAME
    default:
        return "an error without a name here";
    }
}

bool gpu_check_at(Gpu *gpu, VkResult result, const char *call, const char *label, const char *file,
                  int line) {
    if (result >= 0) return true;
    // "gpu->vk.vkCreateBuffer(gpu->device, ...)": the name of the function is enough.
    const char *name = call;
    for (const char *c = call; *c; c++)
        if (c[0] == 'v' && c[1] == 'k' && c[2] >= 'A' && c[2] <= 'Z') {
            name = c;
            break;
        }
    log_write(LOG_GPU_RESULT, file, line, "%.*s on \"%s\": %s (%d)", (int)strcspn(name, "("), name,
              label ? label : "?", gpu_result_name(result), (int)result);
    if (result == VK_ERROR_DEVICE_LOST && gpu && !gpu->is_lost) {
        gpu->is_lost = true;
        LOG(GPU_LOST, "the device \"%s\" is lost", gpu->info.device_name);
    }
    return false;
}

void gpu_name_object(Gpu *gpu, VkObjectType type, u64 handle, const char *format, ...) {
    if (!gpu->has_debug_utils || !handle) return;
    char name[GPU_LABEL_CAP + 32];
    va_list list;
    va_start(list, format);
    vsnprintf(name, sizeof name, format, list);
    va_end(list);
    vkSetDebugUtilsObjectNameEXT(gpu->device,
                                 &(VkDebugUtilsObjectNameInfoEXT){
                                     .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                     .objectType = type,
                                     .objectHandle = handle,
                                     .pObjectName = name,
                                 });
}
