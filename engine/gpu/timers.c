// timers.c: how long the GPU worked on what.
//
// Data in: timestamps with names. Data out: GpuTimer of the newest finished frame, in order of
// begin. Called by the renderer around every pass. Does not average or sort.
//
// On the software driver a timestamp costs two waits of all its threads. So there are none while
// nobody asks (gpu_timers_enable), and a timer that begins after another ended takes its timestamp.
//
// accurate_timers: a full barrier after every timestamp. Without it the software driver runs work
// later than the timestamp says, and blames the wrong pass. Within rendering no barrier is allowed:
// put timers around it.
#include "gpu_internal.h"

#define NO_QUERY UINT32_MAX

void gpu_timers_enable(Gpu *gpu, bool on) { gpu->has_timers = on; }

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
    slot->query_count = 0;
    slot->timers_taken = false;
    slot->last_end = NO_QUERY;
    gpu->timer_depth = 0;
    gpu->writes_timers = gpu->has_timers && slot->queries;
    if (gpu->writes_timers)
        gpu->vk.vkCmdResetQueryPool(slot->buffer, slot->queries, 0, 2 * GPU_TIMERS_CAP);
}

// The slot's frame is finished: take its results, once.
void gpu_timers_collect(Gpu *gpu, GpuFrameSlot *slot) {
    if (slot->timers_taken) return;
    slot->timers_taken = true;
    gpu->timer_count = 0;
    u64 stamps[2 * GPU_TIMERS_CAP];
    if (!slot->timer_count ||
        gpu->vk.vkGetQueryPoolResults(gpu->device, slot->queries, 0, slot->query_count,
                                      slot->query_count * sizeof(u64), stamps, sizeof(u64),
                                      VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
        return;
    for (u32 i = 0; i < slot->timer_count; i++) {
        const GpuTimerQueries *timer = &slot->timers[i];
        u64 ticks = (stamps[timer->end] - stamps[timer->begin]) & gpu->timestamp_mask;
        gpu->timers[i] =
            (GpuTimer){timer->name, (f32)((f64)ticks * (f64)gpu->limits.timestampPeriod * 1e-6)};
    }
    gpu->timer_count = slot->timer_count;
}

static u32 write_timestamp(GpuCommands *cmd, GpuFrameSlot *slot) {
    Gpu *gpu = cmd->gpu;
    u32 query = slot->query_count++;
    gpu->vk.vkCmdWriteTimestamp2(cmd->buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot->queries,
                                 query);
    if (gpu->accurate_timers && !cmd->is_rendering) gpu_record_full_barrier(gpu, cmd->buffer);
    return query;
}

void gpu_cmd_timer_begin(GpuCommands *cmd, const char *name) {
    Gpu *gpu = cmd->gpu;
    if (!gpu->writes_timers) return;
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    LUZ_ASSERT(slot->timer_count < GPU_TIMERS_CAP);
    u32 timer = slot->timer_count++;
    u32 begin = slot->last_end != NO_QUERY ? slot->last_end : write_timestamp(cmd, slot);
    slot->last_end = NO_QUERY;
    slot->timers[timer] = (GpuTimerQueries){name, begin, begin};
    gpu->timer_stack[gpu->timer_depth++] = timer;
}

void gpu_cmd_timer_end(GpuCommands *cmd) {
    Gpu *gpu = cmd->gpu;
    if (!gpu->writes_timers) return;
    LUZ_ASSERT(gpu->timer_depth > 0);
    GpuFrameSlot *slot = &gpu->slots[gpu->frame_slot];
    slot->last_end = write_timestamp(cmd, slot);
    slot->timers[gpu->timer_stack[--gpu->timer_depth]].end = slot->last_end;
}

u32 gpu_timers(const Gpu *gpu, GpuTimer *out, u32 out_cap) {
    u32 count = MIN(gpu->timer_count, out_cap);
    for (u32 i = 0; i < count; i++) out[i] = gpu->timers[i];
    return count;
}
