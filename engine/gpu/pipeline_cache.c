// pipeline_cache.c: what the driver wants to keep of compiled pipelines, on disk between runs.
//
// Data in: $XDG_CACHE_HOME/luz or ~/.cache/luz. Data out: gpu->pipeline_cache. Called at the start
// and the end of a Gpu. Losing the file costs time only: all trouble is silent. The file is the
// hash of the rest, then the driver's bytes: a damaged one is not shown to the driver.
#include "gpu_internal.h"
#include "../base/file.h"
#include "../base/hash.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CACHE_SIZE_MAX MIB(256)
#define CACHE_EMPTY    64 // bytes: a header and nothing to speak of (the software driver)

static bool cache_directory(char *out, u64 cap) {
    const char *base = getenv("XDG_CACHE_HOME");
    const char *home = getenv("HOME");
    int length = 0;
    if (base && base[0] == '/')
        length = snprintf(out, cap, "%s/luz", base);
    else if (home && home[0] == '/')
        length = snprintf(out, cap, "%s/.cache/luz", home);
    return length > 0 && (u64)length < cap;
}

static bool cache_path(const Gpu *gpu, char *out, u64 cap) {
    char directory[900];
    if (!cache_directory(directory, sizeof directory)) return false;
    char uuid[2 * VK_UUID_SIZE + 1];
    for (u32 i = 0; i < VK_UUID_SIZE; i++) snprintf(uuid + 2 * i, 3, "%02x", gpu->cache_uuid[i]);
    int length = snprintf(out, cap, "%s/pipelines-%s.bin", directory, uuid);
    return length > 0 && (u64)length < cap;
}

void gpu_pipeline_cache_load(Gpu *gpu) {
    char path[1024];
    Arena arena = {0};
    Bytes file = {0};
    VkPipelineCacheCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    if (cache_path(gpu, path, sizeof path) && access(path, R_OK) == 0 &&
        arena_create(&arena, "pipeline cache", CACHE_SIZE_MAX + KIB(4)) &&
        file_read(path, CACHE_SIZE_MAX, &arena, &file) && file.size > sizeof(u64)) {
        const u8 *data = (const u8 *)file.data + sizeof(u64);
        u64 size = file.size - sizeof(u64), hash;
        memcpy(&hash, file.data, sizeof hash);
        if (hash == hash_bytes(data, size, 0)) {
            gpu->pipeline_cache_hash = hash;
            info.initialDataSize = size;
            info.pInitialData = data;
        }
    }
    if (!GPU_CHECK(gpu, gpu->label,
                   gpu->vk.vkCreatePipelineCache(gpu->device, &info, NULL, &gpu->pipeline_cache)))
        gpu->pipeline_cache = VK_NULL_HANDLE; // pipelines can do without
    gpu_name_object(gpu, VK_OBJECT_TYPE_PIPELINE_CACHE, GPU_HANDLE(gpu->pipeline_cache),
                    "%s pipelines", gpu->label);
    if (arena.memory) arena_destroy(&arena);
}

void gpu_pipeline_cache_save(Gpu *gpu) {
    size_t size = 0;
    char path[1024], directory[1024];
    if (!gpu->pipeline_cache || gpu->is_lost ||
        gpu->vk.vkGetPipelineCacheData(gpu->device, gpu->pipeline_cache, &size, NULL) < 0 ||
        size <= CACHE_EMPTY || size > CACHE_SIZE_MAX || !cache_path(gpu, path, sizeof path) ||
        !cache_directory(directory, sizeof directory))
        return;
    u8 *data = malloc(size + sizeof(u64));
    if (!data) return;
    if (gpu->vk.vkGetPipelineCacheData(gpu->device, gpu->pipeline_cache, &size,
                                       data + sizeof(u64)) == VK_SUCCESS) {
        u64 hash = hash_bytes(data + sizeof(u64), size, 0);
        memcpy(data, &hash, sizeof hash);
        // Asked for first, so that a read-only home is no error message.
        if (hash != gpu->pipeline_cache_hash && file_make_directories(directory) &&
            access(directory, W_OK) == 0)
            (void)file_write(path, data, size + sizeof(u64));
    }
    free(data);
}
