// gpu_internal.h: what the files of engine/gpu/ share. Nobody else includes it (tests of the inside
// of the layer may).
//
// Data: one Gpu owns everything. Objects live in pools (handle = generation and index), their
// memory in named heaps, dead ones in a queue ordered by timeline value. One queue and one timeline
// semaphore order all work: each submit signals the next value, so "is it done" is one comparison.
#ifndef LUZ_GPU_INTERNAL_H
#define LUZ_GPU_INTERNAL_H
#include "gpu.h"
#include "shader_blobs.h"
#include "../base/log.h"
#include <volk.h>

#define GPU_LABEL_CAP        64
#define GPU_HEAPS_CAP        32
#define GPU_SWAP_IMAGES_CAP  8
#define GPU_PUSH_SIZE_MAX    128 // the size that every device has
#define GPU_UPLOAD_SLOTS     4
#define GPU_STAGING_SIZE     MIB(16)
#define GPU_SHADER_ERROR_CAP 4096
#define GPU_STAGES                                                                                 \
    (VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT)

// --- Pools (pool.c): id = generation << 16 | index + 1; 0 is none ---

typedef struct GpuPoolItem { // first member of every pooled struct
    u16 generation;
    bool alive;
    u32 next_free; // index + 1
    char label[GPU_LABEL_CAP];
} GpuPoolItem;
typedef struct GpuPool {
    const char *what; // for messages
    u8 *items;
    u32 item_size, count, cap, first_free, alive_count;
} GpuPool;
// A zeroed item with its label; 0 and LOG GPU_LIMIT when the pool is full. Pointers into a pool
// hold until the next add.
u32 gpu_pool_add(GpuPool *pool, const char *label, void **item);
void *gpu_pool_get(const GpuPool *pool, u32 id); // asserts that the handle is alive
void gpu_pool_remove(GpuPool *pool, u32 id);
void *gpu_pool_at(const GpuPool *pool, u32 index); // NULL if dead; for loops over index < count
u32 gpu_pool_id_at(const GpuPool *pool, u32 index);

// --- Memory (memory.c) ---

typedef struct GpuFreeRange {
    u64 offset, size;
} GpuFreeRange;
typedef struct GpuBlock {
    struct GpuBlock *next;
    VkDeviceMemory memory;
    u64 size, used;
    u8 *mapped; // NULL = not host-visible
    u32 heap, memory_type;
    bool for_images; // images and buffers never share a block: no granularity trouble
    bool dedicated;
    GpuFreeRange *ranges; // sorted by offset, never adjacent
    u32 range_count, range_cap;
} GpuBlock;
typedef struct GpuHeap {
    char name[32];
    GpuBlock *blocks;
    u64 used, allocated;
    u32 object_count;
} GpuHeap;
typedef struct GpuAllocation {
    GpuBlock *block; // NULL = none
    u64 offset, size;
} GpuAllocation;
typedef enum GpuMemoryUse {
    GPU_MEMORY_DEVICE,
    GPU_MEMORY_UPLOAD,
    GPU_MEMORY_READBACK
} GpuMemoryUse;

// --- Pooled objects ---

typedef struct GpuBufferItem {
    GpuPoolItem pool;
    VkBuffer buffer;
    GpuAllocation allocation;
    u64 size, stride; // stride: bytes from one frame slot's copy to the next, 0 = one copy
    GpuBufferKind kind;
    u64 upload_epoch;
    bool vertex, index, indirect;
} GpuBufferItem;
#define GPU_MIP_VIEWS_CAP 12
typedef struct GpuTextureItem {
    GpuPoolItem pool;
    VkImage image;
    VkImageView view;        // all mips: sampling
    VkImageView target_view; // mip 0, all aspects: rendering and storage; equals view if it can
    VkImageView mip_views[GPU_MIP_VIEWS_CAP]; // of storage textures: one mip each, from 1 on
    GpuAllocation allocation;
    GpuFormat format;
    u32 width, height, depth, mip_count, samples;
    u64 upload_epoch;
} GpuTextureItem;
typedef struct GpuSamplerItem {
    GpuPoolItem pool;
    VkSampler sampler;
} GpuSamplerItem;
typedef struct GpuBindLayoutItem {
    GpuPoolItem pool;
    VkDescriptorSetLayout layout;
    GpuBindingKind kinds[GPU_BINDINGS_CAP];
    u32 count;
} GpuBindLayoutItem;
typedef struct GpuBindGroupItem {
    GpuPoolItem pool;
    VkDescriptorSet sets[GPU_FRAMES_IN_FLIGHT_MAX];
    u32 set_count; // 1, or one a frame slot if a DYNAMIC buffer is in it
    u32 descriptor_pools[GPU_FRAMES_IN_FLIGHT_MAX];
    u32 layout_id;
} GpuBindGroupItem;
typedef struct GpuPipelineItem {
    GpuPoolItem pool;
    VkPipeline pipeline;
    VkPipelineLayout layout;
    bool is_compute;
    // Kept for rebuilding: the desc with its strings replaced by shader indices.
    GpuPipelineDesc desc;
    u32 shaders[2]; // index into Gpu.shaders; [1] unused by compute
} GpuPipelineItem;

typedef struct GpuDescriptorPool {
    VkDescriptorPool pool;
    u32 sets_left, left[GPU_BINDING_KIND_COUNT]; // by GpuBindingKind
} GpuDescriptorPool;

// A shader in use: the embedded blob, or what the reload compiled last.
typedef struct GpuShader {
    char name[GPU_LABEL_CAP];
    const u32 *words;
    u32 byte_count;
    u32 *owned;        // malloc'd words of a reload
    u64 stamp;         // newest source stamp that `words` was made from; 0 = embedded
    u64 refused_stamp; // newest source stamp that did not compile
    bool is_broken, is_changed;
} GpuShader;

// --- Deferred destruction (destroy.c) ---

typedef struct GpuDoomed {
    u64 value;         // free when the timeline has reached it; 0 = not submitted yet
    VkObjectType type; // VK_OBJECT_TYPE_DEVICE_MEMORY = `allocation`
    u64 handle;
    u32 descriptor_pool, layout_id;
    GpuAllocation allocation;
} GpuDoomed;

// --- Frames ---

// A descriptor set that stays bound as long as pipelines agree on the layouts up to its own.
typedef struct GpuBoundGroup {
    VkDescriptorSet set; // VK_NULL_HANDLE = none
    GpuBindLayout layouts[GPU_GROUPS_CAP];
} GpuBoundGroup;
struct GpuCommands {
    Gpu *gpu;
    VkCommandBuffer buffer;
    VkPipelineLayout layout; // of the bound pipeline
    u32 push_size;
    VkPipelineBindPoint bind_point;
    GpuBindLayout layouts[GPU_GROUPS_CAP];  // of its groups
    GpuBoundGroup bound[2][GPU_GROUPS_CAP]; // graphics, compute
    bool is_rendering;
};
typedef struct GpuTimerQueries {
    const char *name;
    u32 begin, end;
} GpuTimerQueries;
typedef struct GpuFrameSlot {
    VkCommandPool pool;
    VkCommandBuffer buffer;
    u64 value; // timeline value that ends this slot's newest frame
    VkSemaphore acquired;
    VkQueryPool queries;
    GpuTimerQueries timers[GPU_TIMERS_CAP];
    u32 timer_count, query_count;
    u32 last_end;      // query at which a timer ended, and none began since
    bool timers_taken; // this slot's newest frame's results
} GpuFrameSlot;
typedef struct GpuUploadSlot {
    VkCommandPool pool;
    VkCommandBuffer buffer;
    u64 value; // timeline value that ends its newest batch
} GpuUploadSlot;
typedef struct GpuSwapchain {
    VkSurfaceKHR surface;
    VkSwapchainKHR swapchain;
    VkImage images[GPU_SWAP_IMAGES_CAP];
    VkImageView views[GPU_SWAP_IMAGES_CAP];
    VkSemaphore rendered[GPU_SWAP_IMAGES_CAP]; // by image: its present may wait long
    u32 image_count, image_index, width, height;
    VkSurfaceFormatKHR format;
    bool is_acquired; // an image is held, from acquire to present
    bool is_awaited;  // this frame's submit has to wait for that image
    bool is_drawn;    // the image is in the colour layout
    bool is_stale, is_surface_lost;
} GpuSwapchain;

struct Gpu {
    char label[GPU_LABEL_CAP];
    GpuInfo info;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    u32 queue_family;
    struct VolkDeviceTable
        vk; // of this device; 1.2 devices have the KHR functions under the core names
    bool has_debug_utils, is_vulkan_12, is_lost, accurate_timers;
    bool has_timers, writes_timers; // as asked for; in this frame
    u32 validation_count;
    VkPhysicalDeviceMemoryProperties memory_properties;
    VkPhysicalDeviceLimits limits;
    VkPhysicalDeviceFeatures features;
    u64 max_allocation_size;
    u64 timestamp_mask;
    u8 cache_uuid[VK_UUID_SIZE];
    int (*create_surface)(void *, void *, const void *, u64 *);
    void *window;

    GpuPool buffers, textures, samplers, bind_layouts, bind_groups, pipelines;
    GpuHeap heaps[GPU_HEAPS_CAP];
    u32 heap_count;
    GpuDescriptorPool *descriptor_pools;
    u32 descriptor_pool_count;
    GpuShader *shaders;
    u32 shader_count;
    VkPipelineCache pipeline_cache;
    u64 pipeline_cache_hash; // of what is on disk
    char shader_error[GPU_SHADER_ERROR_CAP];
    Arena reload_arena;

    GpuDoomed *doomed; // a queue: [doomed_first, doomed_count)
    u32 doomed_first, doomed_count, doomed_cap;

    VkSemaphore timeline;
    u64 submitted; // newest value given to a submit
    u32 frame_count, frame_slot;
    bool is_recording;
    GpuFrameSlot slots[GPU_FRAMES_IN_FLIGHT_MAX];
    struct GpuCommands commands;
    GpuTimer timers[GPU_TIMERS_CAP];
    u32 timer_count;
    u32 timer_stack[GPU_TIMERS_CAP], timer_depth;

    GpuUploadSlot uploads[GPU_UPLOAD_SLOTS];
    u32 upload_slot;
    bool is_uploading; // uploads[upload_slot] is being recorded
    u64 upload_epoch;  // uploads of one epoch do not overlap
    VkBuffer staging;
    GpuAllocation staging_memory;
    u64 staging_head, staging_tail; // bytes ever taken, and ever given back

    GpuSwapchain swap;
};

// --- Names and results (gpu_names.c) ---

const char *gpu_result_name(VkResult result);
// True if the result is no error. Else LOG GPU_RESULT "vkCreateBuffer "label": VK_ERROR_..."; a
// lost device is remembered. `call` is the text of the call.
bool gpu_check_at(Gpu *gpu, VkResult result, const char *call, const char *label, const char *file,
                  int line);
#define GPU_CHECK(gpu, label, call) gpu_check_at((gpu), (call), #call, (label), __FILE__, __LINE__)
void gpu_name_object(Gpu *gpu, VkObjectType type, u64 handle, const char *format, ...)
    PRINTF_LIKE(4, 5);
#define GPU_HANDLE(object) ((u64)(uintptr_t)(object))

// --- instance.c, device.c ---

bool gpu_instance_create(Gpu *gpu, const GpuDesc *desc);
void gpu_instance_destroy(Gpu *gpu);
bool gpu_device_pick(Gpu *gpu, const char *wanted);
bool gpu_device_create(Gpu *gpu);

// --- memory.c ---

// Index of the heap with this name (made at need).
u32 gpu_heap_index(Gpu *gpu, const char *name);
// Memory for one buffer or image. False with a log line if there is none.
bool gpu_memory_allocate(Gpu *gpu, u32 heap, GpuMemoryUse use, const VkMemoryRequirements *needs,
                         VkBuffer buffer, VkImage image, bool wants_dedicated, const char *label,
                         GpuAllocation *out);
void gpu_memory_free(Gpu *gpu, GpuAllocation allocation);
static inline u8 *gpu_memory_mapped(const GpuAllocation *a) {
    return a->block->mapped ? a->block->mapped + a->offset : NULL;
}

// --- resources.c ---

VkFormat gpu_format_vk(const Gpu *gpu, GpuFormat format);
static inline bool gpu_format_is_depth(GpuFormat format) {
    return format == GPU_FORMAT_D32F || format == GPU_FORMAT_D32F_S8;
}
static inline bool gpu_format_has_stencil(GpuFormat format) { return format == GPU_FORMAT_D32F_S8; }
VkImageAspectFlags gpu_format_aspect(GpuFormat format);  // of shaders and copies: one aspect
VkImageAspectFlags gpu_format_aspects(GpuFormat format); // of barriers and attachments: all
u64 gpu_texture_bytes(const GpuTextureItem *texture);
bool gpu_raw_buffer_create(Gpu *gpu, u32 heap, GpuMemoryUse use, u64 size, VkBufferUsageFlags usage,
                           const char *label, VkBuffer *buffer, GpuAllocation *allocation);
// Offset of the current frame's copy.
static inline u64 gpu_buffer_offset(const Gpu *gpu, const GpuBufferItem *buffer) {
    return buffer->stride * gpu_frame_slot(gpu);
}
static inline GpuBufferItem *gpu_buffer_get(const Gpu *gpu, GpuBuffer handle) {
    return (GpuBufferItem *)gpu_pool_get(&gpu->buffers, handle.id);
}
static inline GpuTextureItem *gpu_texture_get(const Gpu *gpu, GpuTexture handle) {
    return (GpuTextureItem *)gpu_pool_get(&gpu->textures, handle.id);
}

// --- destroy.c ---

void gpu_destroy_later(Gpu *gpu, VkObjectType type, u64 handle);
void gpu_destroy_later_memory(Gpu *gpu, GpuAllocation allocation);
void gpu_destroy_later_set(Gpu *gpu, VkDescriptorSet set, u32 descriptor_pool, u32 layout_id);
void gpu_destroy_stamp(Gpu *gpu, u64 value); // what was doomed so far waits for this value
void gpu_destroy_collect(Gpu *gpu, u64 done);

// --- bindings.c, pipeline.c, shader_reload.c ---

void gpu_bindings_destroy(Gpu *gpu);
void gpu_descriptor_set_freed(Gpu *gpu, u32 descriptor_pool, u32 layout_id, VkDescriptorSet set);
void gpu_pipeline_cache_load(Gpu *gpu);
void gpu_pipeline_cache_save(Gpu *gpu);
bool gpu_pipeline_build(Gpu *gpu, GpuPipelineItem *item, VkPipeline *out);
u32 gpu_shader_find(Gpu *gpu,
                    const char *name); // index into Gpu.shaders, UINT32_MAX + log if unknown
void gpu_shaders_destroy(Gpu *gpu);

// --- barriers.c ---

typedef struct GpuUsageInfo {
    const char *name;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
    VkImageLayout layout; // of colour textures; UNDEFINED = not for textures
    bool is_write;
} GpuUsageInfo;
extern const GpuUsageInfo gpu_usage_table[GPU_USAGE_COUNT];
VkImageLayout gpu_usage_layout(GpuUsage usage, bool is_depth);
VkImageMemoryBarrier2 gpu_image_barrier(VkImage image, GpuFormat format, GpuUsage from, GpuUsage to,
                                        bool discard);
void gpu_record_barriers(Gpu *gpu, VkCommandBuffer buffer, const VkMemoryBarrier2 *memory,
                         const VkImageMemoryBarrier2 *images, u32 image_count);
// Everything before against everything after, the host's reads included.
void gpu_record_full_barrier(Gpu *gpu, VkCommandBuffer buffer);

// --- frame.c, timers.c, upload.c, swapchain.c ---

// A transient pool with one primary command buffer, named; nothing is left behind on failure.
bool gpu_command_buffer_create(Gpu *gpu, const char *label, VkCommandPool *pool,
                               VkCommandBuffer *buffer);
bool gpu_frames_create(Gpu *gpu, u32 count);
void gpu_frames_destroy(Gpu *gpu);
bool gpu_wait_value(Gpu *gpu, u64 value);
u64 gpu_done_value(Gpu *gpu);
// Submits one or two command buffers; returns the timeline value they signal, 0 on failure.
u64 gpu_submit(Gpu *gpu, const VkCommandBuffer *buffers, u32 count, VkSemaphore wait,
               VkSemaphore signal);
bool gpu_timers_create(Gpu *gpu, GpuFrameSlot *slot, u32 index);
void gpu_timers_reset(Gpu *gpu, GpuFrameSlot *slot);
void gpu_timers_collect(Gpu *gpu, GpuFrameSlot *slot);
// Ends the command buffer of pending uploads and returns it (NULL if none): the caller submits it
// before anything that reads them, then calls gpu_uploads_submitted.
VkCommandBuffer gpu_uploads_end(Gpu *gpu);
void gpu_uploads_submitted(Gpu *gpu, u64 value);
void gpu_uploads_flush(Gpu *gpu); // the same with a submit of its own
void gpu_uploads_destroy(Gpu *gpu);
bool gpu_surface_create(Gpu *gpu);
bool gpu_surface_pick_format(Gpu *gpu);
void gpu_swapchain_finish(Gpu *gpu); // records the change to the present layout
void gpu_swapchain_to_color(Gpu *gpu);
void gpu_swapchain_destroy(Gpu *gpu);

#endif
