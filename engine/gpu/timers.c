// timers.c: how long the GPU worked on what.
//
// Data in: pairs of timestamps with names. Data out: GpuTimer of the newest finished frame, in
// order of begin. Called by the renderer around every pass. Does not average or sort.
//
// accurate_timers: a full barrier after every timestamp. Without it the software driver runs work
// later than the timestamp says, and blames the wrong pass. Within rendering no barrier is allowed:
// put timers around it.
#include "gpu_internal.h"

bool gpu_timers_create(Gpu *gpu, GpuFrameSlot *slot, u32 index) {
    if (!gpu->info.timestamps) return true;
    VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                  .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                  .queryCount = 2 * GPU_TIMERS_CAP};
    if (!GPU_CHECK(gpu, "timers",
                   gpu->vk.vkCreateQueryPool(gpu->device, &info, NULL, &slot->queries)))
        return false;
    gpu_name_object(gpu, VK_OBJECT_TYPE_QUERY_POOL, GPU_HANDLE(slot->queries), "timers %u", index);
    return true;
}

void gpu_timers_reset(Gpu *gpu, GpuFrameSlot *slot) {
    slot->timer_count = 0;
    gpu->timer_depth = 0;
    if (slot->queries)
        gpu->vk.vkCmdResetQueryPool(slot->buffer, slot->queries, 0, 2 * GPU_TIMERS_CAP);
}

// The slot's frame is finished: take its results, once.
void gpu_timers_collect(Gpu *gpu, GpuFrameSlot *slot) {
    if (!slot->queries || !slot->timer_count) return;
    u64 stamps[2 * GPU_TIMERS_CAP];
    u32 count = slot->timer_count;
    slot->timer_count = 0;
    if (gpu->vk.vkGetQueryPoolResults(gpu->device, slot->queries, 0, 2 * count,
                                      2 * count * sizeof(u64), stamps, sizeof(u64),
                                      VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return;
    for (u32 i = 0; i < count; i++) {
        u64 ticks = (stamps[2 * i + 1] - stamps[2 * i]) & gpu->timestamp_mask;
        gpu->timers[i] = (GpuTimer){slot->timer_names[i],
                                    (f32)((f64)ticks * (f64)gpu->limits.timestampPeriod * 1e-6)};
    }
    gpu->timer_count = count;
}

static void write_timestamp(GpuCommands *cmd, u32 query) {
    Gpu *gpu = cmd->gpu;
    VkQueryPool queries = gpu->slots[gpu->frame_slot].queries;
    if (!queries) return;
    gpu->vk.vkCmdWriteTimestamp2(cmd->buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, query);
    if (gpu->accurate_timers && !cmd->is_rendering) gpu_record_full_barrier(gpu, cmd->buffer);
}

void gpu_cmd_timer_begin(GpuCommands *cmd, const char *name) {
    Gpu *gpu = cmd->gpu;
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    LUZ_ASSERT(slot->timer_count < GPU_TIMERS_CAP);
    u32 timer = slot->timer_count++;
    slot->timer_names[timer] = name;
    gpu->timer_stack[gpu->timer_depth++] = timer;
    write_timestamp(cmd, 2 * timer);
}

void gpu_cmd_timer_end(GpuCommands *cmd) {
    LUZ_ASSERT(cmd->gpu->timer_depth > 0);
    write_timestamp(cmd, 2 * cmd->gpu->timer_stack[--cmd->gpu->timer_depth] + 1);
}

u32 gpu_timers(const Gpu *gpu, GpuTimer *out, u32 out_cap) {
    u32 count = MIN(gpu->timer_count, out_cap);
    for (u32 i = 0; i < count; i++) out[i] = gpu->timers[i];
    return count;
}
