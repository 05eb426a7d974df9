// instance.c: the Vulkan loader, the instance, the validation layer's messages.
//
// Data in: GpuDesc. Data out: gpu->instance with debug utils where the loader has it. Called by
// device.c. Does not pick a device. A machine without Vulkan is no bug: LOG GPU_NONE says what to
// install, and the caller gets false.
#include "gpu_internal.h"
#include <stdlib.h>
#include <string.h>

#define INSTANCE_EXTENSIONS_CAP 32
#define LAYER_NAME              "VK_LAYER_KHRONOS_validation"

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user) {
    (void)severity;
    (void)types;
    ((Gpu *)user)->validation_count++;
    LOG(GPU_VALIDATION, "%s", data->pMessage);
    return VK_FALSE;
}

static bool has_layer(const char *name) {
    u32 count = 0;
    if (vkEnumerateInstanceLayerProperties(&count, NULL) != VK_SUCCESS || !count) return false;
    VkLayerProperties *layers = calloc(count, sizeof *layers);
    bool found = false;
    if (layers && vkEnumerateInstanceLayerProperties(&count, layers) >= 0)
        for (u32 i = 0; i < count; i++) found |= strcmp(layers[i].layerName, name) == 0;
    free(layers);
    return found;
}

static bool has_extension(const char *layer, const char *name) {
    u32 count = 0;
    if (vkEnumerateInstanceExtensionProperties(layer, &count, NULL) != VK_SUCCESS || !count)
        return false;
    VkExtensionProperties *extensions = calloc(count, sizeof *extensions);
    bool found = false;
    if (extensions && vkEnumerateInstanceExtensionProperties(layer, &count, extensions) >= 0)
        for (u32 i = 0; i < count; i++) found |= strcmp(extensions[i].extensionName, name) == 0;
    free(extensions);
    return found;
}

static bool env_is_on(const char *name) {
    const char *value = getenv(name);
    return value && value[0] && strcmp(value, "0") != 0;
}

bool gpu_instance_create(Gpu *gpu, const GpuDesc *desc) {
    if (!vkGetInstanceProcAddr && volkInitialize() != VK_SUCCESS) {
        LOG(GPU_NONE,
            "no Vulkan loader (libvulkan.so.1): install libvulkan1 and a driver, for example "
            "mesa-vulkan-drivers");
        return false;
    }
    if (volkGetInstanceVersion() < VK_API_VERSION_1_2) {
        LOG(GPU_NONE, "the Vulkan loader is older than 1.2: update libvulkan1");
        return false;
    }
    const char *extensions[INSTANCE_EXTENSIONS_CAP];
    u32 extension_count = 0;
    LUZ_ASSERT(desc->instance_extension_count < INSTANCE_EXTENSIONS_CAP - 4);
    for (u32 i = 0; i < desc->instance_extension_count; i++)
        extensions[extension_count++] = desc->instance_extensions[i];
    gpu->has_debug_utils = has_extension(NULL, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (gpu->has_debug_utils) extensions[extension_count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;

    bool validate = desc->validation || env_is_on("LUZ_VALIDATION");
    if (validate && (!has_layer(LAYER_NAME) || !gpu->has_debug_utils)) {
        LOG(NOTE, "validation was asked for, but " LAYER_NAME " is not installed "
                  "(package vulkan-validationlayers): running without");
        validate = false;
    }
    bool has_features =
        validate && has_extension(LAYER_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    if (has_features) extensions[extension_count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;

    // Only the layer's own findings count: loader remarks and performance hints are not errors.
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = gpu,
    };
    VkValidationFeatureEnableEXT enable =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = &enable,
    };
    // LUZ_VULKAN12=1: behave as on a 1.2 device (RenderDoc 1.24 shows one), to test that way.
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = desc->label,
        .pEngineName = "luz",
        .apiVersion = env_is_on("LUZ_VULKAN12") ? VK_API_VERSION_1_2 : VK_API_VERSION_1_3,
    };
    gpu->is_vulkan_12 = application.apiVersion == VK_API_VERSION_1_2;
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = has_features ? (const void *)&features
                 : validate   ? (const void *)&messenger
                              : NULL,
        .pApplicationInfo = &application,
        .enabledLayerCount = validate ? 1 : 0,
        .ppEnabledLayerNames = (const char *const[]){LAYER_NAME},
        .enabledExtensionCount = extension_count,
        .ppEnabledExtensionNames = extensions,
    };
    VkResult result = vkCreateInstance(&info, NULL, &gpu->instance);
    if (result != VK_SUCCESS) {
        gpu->instance = VK_NULL_HANDLE;
        LOG(GPU_NONE,
            "no usable Vulkan driver (vkCreateInstance: %s): install one, for example "
            "mesa-vulkan-drivers, and check VK_DRIVER_FILES if it is set",
            gpu_result_name(result));
        return false;
    }
    volkLoadInstanceOnly(gpu->instance);
    if (validate)
        return GPU_CHECK(
            gpu, desc->label,
            vkCreateDebugUtilsMessengerEXT(gpu->instance, &messenger, NULL, &gpu->messenger));
    return true;
}

void gpu_instance_destroy(Gpu *gpu) {
    if (!gpu->instance) return;
    // Another Gpu may have loaded its own functions since.
    volkLoadInstanceOnly(gpu->instance);
    if (gpu->messenger) vkDestroyDebugUtilsMessengerEXT(gpu->instance, gpu->messenger, NULL);
    vkDestroyInstance(gpu->instance, NULL);
    gpu->instance = VK_NULL_HANDLE;
}
