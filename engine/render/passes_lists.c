// passes_lists.c: passes that make light lists on the device, and the buffers they fill.
// Data in: a packet's lights, the depth buffer. Data out: commands. Called by: pass_run (passes.c).
#include "passes.h"

static const char *const labels[RESOURCE_COUNT] = {
#define X(id, label, format) label,
    RENDER_RESOURCES(X)
#undef X
};

bool device_lists_resize(Renderer *renderer, const Packet *packet) {
    (void)packet;
    for (u32 id = RESOURCE_FIRST_BUFFER; id < RESOURCE_COUNT; id++) {
        if (renderer->device_buffers[id].id) continue;
        renderer->device_buffers[id] =
            gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = labels[id],
                                                              .heap = "lists",
                                                              .kind = GPU_BUFFER_STATIC,
                                                              .size = 1024,
                                                              .indirect = true});
        renderer->usage[id] = GPU_USAGE_NONE;
        renderer->frame_group_stale = true;
        if (!renderer->device_buffers[id].id) return false;
    }
    return true;
}
