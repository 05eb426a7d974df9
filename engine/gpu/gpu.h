// gpu.h: a small Vulkan 1.3 layer; the only door to the device. Nobody outside engine/gpu/ sees
// a Vulkan name.
//
// What it does: picks a device; names everything (a label is mandatory); suballocates memory from
// named heaps; compiles pipelines from embedded SPIR-V by shader name; one command stream a
// frame with timers and labels; barriers from usages; uploads, read-backs, a swapchain; destroys
// later what a running frame may still read. With validation on, every message of the layer is
// LOG_GPU_VALIDATION. What it does not: threads (one thread owns a Gpu), multiple queues, secondary
// command buffers.
//
// Handles have generations: a stale one asserts. {0} is "none". In every desc zero means default.
//
//   Gpu *gpu = gpu_create(&(GpuDesc){.label = "demo"});
//   GpuCommands *cmd = gpu_frame_begin(gpu); ... gpu_cmd_*(cmd, ...) ... gpu_frame_end(gpu);
#ifndef LUZ_GPU_H
#define LUZ_GPU_H
#include "../base/arena.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct Gpu Gpu;
typedef struct GpuCommands GpuCommands; // the frame being recorded

typedef struct GpuBuffer { u32 id; } GpuBuffer;
typedef struct GpuTexture { u32 id; } GpuTexture;
typedef struct GpuSampler { u32 id; } GpuSampler;
typedef struct GpuPipeline { u32 id; } GpuPipeline;
typedef struct GpuBindLayout { u32 id; } GpuBindLayout;
typedef struct GpuBindGroup { u32 id; } GpuBindGroup;

// --- Device ---

#define GPU_FRAMES_IN_FLIGHT_MAX 3

typedef struct GpuDesc {
    const char *label;
    // Part of a device's name to prefer ("llvmpipe", "NVIDIA"); NULL = $LUZ_DEVICE, else discrete
    // GPU, then integrated, then software.
    const char *device;
    bool validation;         // core + synchronisation validation; also by LUZ_VALIDATION=1
    u32 frames_in_flight;    // 0 = 2
    bool accurate_timers;    // a full barrier after each timestamp: sums are right on the software
                             // driver (a plain timestamp blames the wrong pass there)
    // For a window: instance extensions that its surface needs, and the function that makes one
    // (GLFW's glfwCreateWindowSurface fits). NULL = headless.
    const char *const *instance_extensions;
    u32 instance_extension_count;
    int (*create_surface)(void *vk_instance, void *window, const void *allocator, u64 *vk_surface);
    void *window;
} GpuDesc;

typedef struct GpuInfo {
    char device_name[256], driver_name[256], driver_info[256];
    u32 api_version, driver_version; // Vulkan encoded
    u32 subgroup_size;
    bool is_software;
    bool rgba32f_blend;              // RGBA32F render targets can blend
    u64 max_storage_buffer_size;
    u32 max_texture_side;
    u32 max_groups_x; // of a dispatch
    f32 max_anisotropy;
    bool timestamps;
    // Subgroup basic, ballot, shuffle and arithmetic operations work in these stages.
    bool subgroup_compute, subgroup_fragment;
    bool depth_clamp;                // GpuPipelineDesc.depth_clamp works (else it is ignored)
    bool samples_4;                  // 4 samples a pixel, of RGBA16F and D32F
    bool primitive_id;               // fragment shaders may ask for gl_PrimitiveID
} GpuInfo;

// NULL with LOG GPU_NONE that says what to do (install a driver package ...) when there is no
// usable device.
Gpu *gpu_create(const GpuDesc *desc);
void gpu_destroy(Gpu *gpu); // waits; objects still alive are reported (LOG DEBUG_NOTE) and freed
const GpuInfo *gpu_info(const Gpu *gpu);
void gpu_wait_idle(Gpu *gpu);
bool gpu_is_lost(const Gpu *gpu); // after VK_ERROR_DEVICE_LOST: destroy all, create again
u32 gpu_validation_message_count(const Gpu *gpu);

// Bytes in use by heap name, for stats. Returns the count of heaps.
typedef struct GpuHeapStat { const char *name; u64 used, allocated; u32 object_count; } GpuHeapStat;
u32 gpu_heap_stats(const Gpu *gpu, GpuHeapStat *out, u32 out_cap);

// --- Formats ---

typedef enum GpuFormat {
    GPU_FORMAT_NONE,
    GPU_FORMAT_RGBA8,
    GPU_FORMAT_RGBA8_SRGB,
    GPU_FORMAT_RG16,      // unorm
    GPU_FORMAT_RG16_SNORM,
    GPU_FORMAT_RGBA16F,
    GPU_FORMAT_RGBA32F,
    GPU_FORMAT_RG16F,
    GPU_FORMAT_RG32F,
    GPU_FORMAT_R32F,
    GPU_FORMAT_R32U,
    GPU_FORMAT_R8,
    GPU_FORMAT_D32F,
    GPU_FORMAT_D32F_S8, // with a stencil; shaders see its depth only
    GPU_FORMAT_SWAPCHAIN, // of pipelines that draw to the window (BGRA8 or RGBA8, not sRGB)
    GPU_FORMAT_COUNT
} GpuFormat;
u32 gpu_format_bytes(GpuFormat format); // per pixel

// --- Resources. Every creation can fail (out of memory: LOG GPU_RESULT): the handle is {0}. ---

typedef enum GpuBufferKind {
    GPU_BUFFER_STATIC,   // device-local; filled by gpu_upload_buffer
    GPU_BUFFER_DYNAMIC,  // written by the CPU every frame, read by the GPU: mapped for good, one copy
                         // a frame in flight (gpu_buffer_map gives the current frame's)
    GPU_BUFFER_READBACK, // written by the GPU, read by the CPU after the frame is done
} GpuBufferKind;

typedef struct GpuBufferDesc {
    const char *label; // mandatory
    const char *heap;  // NULL = "buffers"
    u64 size;
    GpuBufferKind kind;
    bool vertex, index, indirect; // usages beside storage + transfer
} GpuBufferDesc;
GpuBuffer gpu_create_buffer(Gpu *gpu, const GpuBufferDesc *desc);
void gpu_destroy_buffer(Gpu *gpu, GpuBuffer buffer);
void *gpu_buffer_map(Gpu *gpu, GpuBuffer buffer); // DYNAMIC (current frame's copy) or READBACK
u64 gpu_buffer_size(const Gpu *gpu, GpuBuffer buffer);
// Copies through staging before the next frame's commands; blocks only when staging is full.
void gpu_upload_buffer(Gpu *gpu, GpuBuffer buffer, u64 offset, const void *data, u64 size);

typedef struct GpuTextureDesc {
    const char *label; // mandatory
    const char *heap;  // NULL = "textures"
    GpuFormat format;
    u32 width, height, depth; // depth 0/1 = 2D, else 3D
    u32 mip_count;            // 0 = 1
    u32 samples;              // 0 = 1; 4 if GpuInfo.samples_4 (2D, 1 mip, no storage)
    bool render_target, storage, sampled; // sampled also allows copies to it
} GpuTextureDesc;
GpuTexture gpu_create_texture(Gpu *gpu, const GpuTextureDesc *desc);
void gpu_destroy_texture(Gpu *gpu, GpuTexture texture);
u64 gpu_texture_size(const Gpu *gpu, GpuTexture texture); // bytes of all mips, tightly packed
// All mips tightly packed after each other. Leaves it readable by shaders.
void gpu_upload_texture(Gpu *gpu, GpuTexture texture, const void *pixels, u64 size);

typedef struct GpuSamplerDesc {
    const char *label;
    bool nearest, repeat; // defaults: linear (with linear mips), clamp to edge
    bool nearest_mips;
    bool compare_greater; // depth comparison GREATER_OR_EQUAL (reversed depth), linear = 2x2 PCF
    f32 anisotropy;       // 0 = off
} GpuSamplerDesc;
GpuSampler gpu_create_sampler(Gpu *gpu, const GpuSamplerDesc *desc);
void gpu_destroy_sampler(Gpu *gpu, GpuSampler sampler);

// --- Bindings: layouts and groups (descriptor sets) ---

typedef enum GpuBindingKind {
    GPU_BINDING_STORAGE_BUFFER,
    GPU_BINDING_SAMPLED_TEXTURE, // combined with a sampler
    GPU_BINDING_STORAGE_TEXTURE,
    GPU_BINDING_UNIFORM_BUFFER,  // at most GPU_UNIFORM_RANGE bytes from the offset are seen
    GPU_BINDING_KIND_COUNT
} GpuBindingKind;
#define GPU_UNIFORM_RANGE 65536 // what every device of today and the software driver offer
#define GPU_BINDINGS_CAP 48
typedef struct GpuBindLayoutDesc {
    const char *label;
    GpuBindingKind kinds[GPU_BINDINGS_CAP];
    u32 count; // bindings 0..count-1, visible to all stages
} GpuBindLayoutDesc;
GpuBindLayout gpu_create_bind_layout(Gpu *gpu, const GpuBindLayoutDesc *desc);

typedef struct GpuBinding {
    GpuBuffer buffer; // DYNAMIC buffers: each frame in flight binds its own copy
    u64 offset;       // into the buffer, a multiple of 256
    GpuTexture texture;
    GpuSampler sampler;
    u32 mip; // of a storage texture: the one that is seen
} GpuBinding;
typedef struct GpuBindGroupDesc {
    const char *label;
    GpuBindLayout layout;
    GpuBinding bindings[GPU_BINDINGS_CAP]; // every one of the layout must be given
} GpuBindGroupDesc;
// Immutable: to change a binding, destroy (deferred) and create again.
GpuBindGroup gpu_create_bind_group(Gpu *gpu, const GpuBindGroupDesc *desc);
void gpu_destroy_bind_group(Gpu *gpu, GpuBindGroup group);

// --- Pipelines ---

// SCALE_ADD: what is there times the shader's alpha, plus its colour.
typedef enum GpuBlend {
    GPU_BLEND_NONE,
    GPU_BLEND_ADD,
    GPU_BLEND_ALPHA,
    GPU_BLEND_SCALE_ADD
} GpuBlend;
typedef enum GpuDepth {
    GPU_DEPTH_NONE,
    GPU_DEPTH_WRITE, // GREATER_OR_EQUAL (reversed) and write
    GPU_DEPTH_TEST,  // GREATER_OR_EQUAL, no write
    GPU_DEPTH_EQUAL,  // EQUAL, no write
    GPU_DEPTH_BEHIND, // LESS_OR_EQUAL, no write: passes at or behind what is there
} GpuDepth;
// Closed volumes against the depth that is there ("z-fail", Everitt and Kilgard 2002). The stencil
// must be 0 everywhere first; SHADE leaves it so.
typedef enum GpuStencil {
    GPU_STENCIL_NONE,
    GPU_STENCIL_MARK,  // faces behind the surface count: back ones up, front ones down; draws no
                       // colour. Not 0 = the surface is inside the volume
    GPU_STENCIL_SHADE, // only where it is not 0, which becomes 0
} GpuStencil;
typedef enum GpuCull { GPU_CULL_BACK, GPU_CULL_NONE, GPU_CULL_FRONT } GpuCull;
// Vertex input. MESH: stream 0 = MeshVertex of shaders/shared.h at locations 0 position, 1 normal
// (uint), 2 uv, 3 tangent (uint), 4 color (unorm rgba8); stream 1 = InstanceRecord, one an
// instance, at 5, 6, 7 (rows of the world matrix) and 8 (ids). UI: pos vec2, uv vec2, color rgba8
// unorm (20 bytes) at 0, 1, 2. LIGHT, one an instance: stream 0 = LightRecord at 0, 1; stream 1 =
// SpotRecord at 2, 3. VOLUME: the same, and stream 2 = position vec4 at 4, one a vertex.
typedef enum GpuVertexLayout {
    GPU_VERTEX_NONE,
    GPU_VERTEX_MESH,
    GPU_VERTEX_UI,
    GPU_VERTEX_LIGHT,
    GPU_VERTEX_VOLUME
} GpuVertexLayout;

#define GPU_TARGETS_CAP   8
#define GPU_SPEC_CAP      48
#define GPU_GROUPS_CAP    4
typedef struct GpuPipelineDesc {
    const char *label;
    const char *vertex, *fragment; // shader names: "gbuffer.vert" = shaders/gbuffer.vert
    const char *compute;           // instead of the two above
    GpuBindLayout layouts[GPU_GROUPS_CAP];
    u32 layout_count;
    u32 push_size; // bytes of push constants, <= 128
    u32 spec[GPU_SPEC_CAP]; // specialisation constants 0..spec_count-1
    u32 spec_count;
    GpuFormat targets[GPU_TARGETS_CAP];
    u32 target_count;
    GpuFormat depth_format; // GPU_FORMAT_NONE = no depth attachment
    GpuDepth depth;
    GpuStencil stencil; // needs GPU_FORMAT_D32F_S8
    u32 samples;        // 0 = 1; that of all targets
    GpuCull cull;
    GpuBlend blend; // of all targets
    f32 depth_bias, depth_bias_slope;
    bool depth_clamp;
    GpuVertexLayout vertex_layout;
} GpuPipelineDesc;
GpuPipeline gpu_create_pipeline(Gpu *gpu, const GpuPipelineDesc *desc);
void gpu_destroy_pipeline(Gpu *gpu, GpuPipeline pipeline);
// Development: recompiles shaders whose source below `directory` (or anything it includes) is newer
// than what runs, and rebuilds the pipelines that use them in place (handles stay). A broken one
// keeps the old: LOG SHADER_ERROR with file and line, text in gpu_shader_error ("" = all well).
// Returns the number of pipelines rebuilt.
u32 gpu_reload_shaders(Gpu *gpu, const char *directory);
const char *gpu_shader_error(const Gpu *gpu);

// --- Frame ---

// Waits until this slot's earlier frame is done. NULL if the device is lost.
GpuCommands *gpu_frame_begin(Gpu *gpu);
// Submits. wait: returns only when the GPU is done (read-backs and timers are then valid).
bool gpu_frame_end(Gpu *gpu, bool wait);
// Inside a frame: submits what was recorded so far, waits until it is done, and goes on in the same
// slot (DYNAMIC buffers hold what they held). Not inside rendering or a timer. What was acquired of
// the swapchain can then be presented. NULL if the device is lost: the frame is over.
GpuCommands *gpu_frame_continue(Gpu *gpu);
bool gpu_frame_is_open(const Gpu *gpu); // between begin and end
u32 gpu_frame_slot(const Gpu *gpu); // 0..frames_in_flight-1 of the frame being recorded

// What a pass does with a resource: stage, access and layout in one word.
typedef enum GpuUsage {
    GPU_USAGE_NONE,             // before first use: contents undefined
    GPU_USAGE_COLOR_TARGET,
    GPU_USAGE_DEPTH_TARGET,
    GPU_USAGE_DEPTH_TEST,       // read-only attachment that shaders may sample at the same time
    GPU_USAGE_DEPTH_STENCIL,    // the same, but its stencil is written (GpuRendering.stencil)
    GPU_USAGE_DEPTH_RESOLVE,    // one sample of a multisampled depth is written to it
    GPU_USAGE_SAMPLED_FRAGMENT,
    GPU_USAGE_SAMPLED_COMPUTE,
    GPU_USAGE_STORAGE_COMPUTE,  // read and write
    GPU_USAGE_STORAGE_READ_COMPUTE,
    GPU_USAGE_READ_VERTEX,      // storage buffer read by vertex or fragment shaders
    GPU_USAGE_STORAGE_DRAW,     // storage buffer read and written by vertex or fragment shaders
    GPU_USAGE_INDIRECT,
    GPU_USAGE_COPY_SOURCE,
    GPU_USAGE_COPY_TARGET,
    GPU_USAGE_PRESENT,
    GPU_USAGE_COUNT
} GpuUsage;
// One barrier call: resources go from one usage to the next. discard: old contents not needed.
typedef struct GpuBarrier {
    GpuTexture texture; // or
    GpuBuffer buffer;
    GpuUsage from, to;
    bool discard;
} GpuBarrier;
void gpu_cmd_barriers(GpuCommands *cmd, const GpuBarrier *barriers, u32 count);
// True if going from one usage to the other needs a barrier (any write involved or layout change).
bool gpu_usage_needs_barrier(GpuUsage from, GpuUsage to);

// resolve: of a multisampled texture, where its samples go at the end of the rendering: a colour's
// average (usage COLOR_TARGET), a depth's first sample (usage DEPTH_RESOLVE).
typedef struct GpuTarget {
    GpuTexture texture;
    bool clear;
    f32 clear_value[4];
    GpuTexture resolve;
} GpuTarget;
typedef struct GpuRendering {
    GpuTarget targets[GPU_TARGETS_CAP];
    u32 target_count;
    GpuTarget depth;      // texture {0} = none; clear_value[0]
    bool depth_read_only; // layout of GPU_USAGE_DEPTH_TEST
    bool stencil;         // with depth_read_only: GPU_USAGE_DEPTH_STENCIL; begins with 0 everywhere
    bool to_swapchain;    // instead of targets[0]
    u32 width, height;
} GpuRendering;
// Sets a full viewport (NDC y up: the negative-height viewport) and scissor.
void gpu_cmd_begin_rendering(GpuCommands *cmd, const GpuRendering *rendering);
void gpu_cmd_end_rendering(GpuCommands *cmd);
void gpu_cmd_scissor(GpuCommands *cmd, i32 x, i32 y, u32 width, u32 height);

void gpu_cmd_bind_pipeline(GpuCommands *cmd, GpuPipeline pipeline);
void gpu_cmd_bind_group(GpuCommands *cmd, u32 set, GpuBindGroup group); // after bind_pipeline
void gpu_cmd_push(GpuCommands *cmd, const void *data, u32 size);        // after bind_pipeline
void gpu_cmd_bind_vertices(GpuCommands *cmd, u32 stream, GpuBuffer vertices, u64 offset);
void gpu_cmd_bind_indices(GpuCommands *cmd, GpuBuffer indices, bool are_u16);
void gpu_cmd_draw(GpuCommands *cmd, u32 vertex_count, u32 instance_count, u32 first_vertex,
                  u32 first_instance);
void gpu_cmd_draw_indexed(GpuCommands *cmd, u32 index_count, u32 instance_count, u32 first_index,
                          i32 vertex_offset, u32 first_instance);
void gpu_cmd_dispatch(GpuCommands *cmd, u32 x, u32 y, u32 z);
// Group counts (3 x u32) from a buffer made with `indirect`, GPU_USAGE_INDIRECT.
void gpu_cmd_dispatch_indirect(GpuCommands *cmd, GpuBuffer buffer, u64 offset);
// Mip 0, tightly packed; texture in GPU_USAGE_COPY_SOURCE.
void gpu_cmd_copy_texture_to_buffer(GpuCommands *cmd, GpuTexture texture, GpuBuffer buffer);
// All mips, from the finest, each tightly packed.
void gpu_cmd_copy_mips_to_buffer(GpuCommands *cmd, GpuTexture texture, GpuBuffer buffer);
// The source in GPU_USAGE_COPY_SOURCE; ranges must lie within the buffers.
void gpu_cmd_copy_buffer(GpuCommands *cmd, GpuBuffer from, u64 from_offset, GpuBuffer to,
                         u64 to_offset, u64 size);

// A range of a buffer in GPU_USAGE_COPY_TARGET gets one word everywhere; offset and size in bytes,
// multiples of 4.
void gpu_cmd_fill_buffer(GpuCommands *cmd, GpuBuffer buffer, u64 offset, u64 size, u32 word);
// All mips of a texture (of numbers, not depth) in GPU_USAGE_COPY_TARGET become 0.
void gpu_cmd_clear_texture(GpuCommands *cmd, GpuTexture texture);

void gpu_cmd_label_begin(GpuCommands *cmd, const char *name);
void gpu_cmd_label_end(GpuCommands *cmd);
// Timers: pairs of timestamps by name (static storage); results of the newest finished frame, none
// if it had no timers. A timer begins where the last one ended, if no other began between.
#define GPU_TIMERS_CAP 128
// Whether frames that begin from now on have timers (they do until told otherwise). They cost: on
// the software driver a third of a frame's switches between its threads.
void gpu_timers_enable(Gpu *gpu, bool on);
void gpu_cmd_timer_begin(GpuCommands *cmd, const char *name);
void gpu_cmd_timer_end(GpuCommands *cmd);
typedef struct GpuTimer { const char *name; f32 ms; } GpuTimer;
u32 gpu_timers(const Gpu *gpu, GpuTimer *out, u32 out_cap);

// --- Window (only with GpuDesc.window) ---

// (Re)creates the swapchain for a framebuffer size; call on resize, and when acquire says so.
bool gpu_swapchain_resize(Gpu *gpu, u32 width, u32 height, bool vsync);
// Acquire within a frame (after gpu_frame_begin). false: minimised, out of date or lost surface:
// skip drawing to the window this frame (still call gpu_frame_end) and resize (a lost surface is
// created anew there).
bool gpu_swapchain_acquire(Gpu *gpu, GpuCommands *cmd);
void gpu_swapchain_size(const Gpu *gpu, u32 *width, u32 *height);
// After gpu_frame_end: shows it. false: call gpu_swapchain_resize.
bool gpu_swapchain_present(Gpu *gpu);

#ifdef __cplusplus
}
#endif
#endif
