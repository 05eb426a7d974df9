// device_lists.c: the buffers that hold light lists made on the device, and what frames report
// about them.
// Data in: a packet; counters of earlier frames. Data out: buffers as large as this packet is known
// to need, stats. Called by frame_upload.c and renderer.c. Does not: record passes
// (passes_lists.c).
//
// How long lists become is known only when the device has made them. So a frame whose lists do not
// fit falls back to the list of all lights for those that are left over (slower, the same picture),
// reports what it wanted, and the next frame's buffer is large enough. Buffers only grow.
#include "render_internal.h"
#include "../base/log.h"
#include <string.h>

#define FIRST_INDEX_CAP   (1u << 16)
#define FIRST_CLUSTER_CAP (1u << 14)

bool tile_lists_refined(const RenderSettings *settings) {
    return settings_tiled(settings) && settings->grid != GRID_GPU &&
           settings->tile_depth != TILE_DEPTH_OFF;
}
bool tile_lists_made(const RenderSettings *settings) {
    return settings_tiled(settings) && settings->grid == GRID_GPU;
}
bool cluster_lists_made(const RenderSettings *settings) {
    return settings_clustered(settings) && settings->clusters == CLUSTERS_GPU;
}
bool device_lists_used(const RenderSettings *settings) {
    return tile_lists_refined(settings) || tile_lists_made(settings) ||
           cluster_lists_made(settings);
}

// At least so many bytes; grows by powers of two, but not beyond the limit (0 = the device's).
static bool buffer_ensure(Renderer *renderer, RenderResource id, u64 size, u64 limit) {
    GpuBuffer *buffer = &renderer->device_buffers[id];
    u64 device_limit = gpu_info(renderer->gpu)->max_storage_buffer_size;
    limit = limit ? MIN(limit, device_limit) : device_limit;
    u64 cap = 1024;
    while (cap < size) cap *= 2;
    cap = MAX(MIN(cap, limit), size);
    if (buffer->id && gpu_buffer_size(renderer->gpu, *buffer) >= MIN(cap, MAX(size, 1024)))
        return true;
    if (size > device_limit) {
        LOG(RENDER_LIMIT, "%s of this frame need %llu bytes, the device binds %llu at most",
            resource_labels[id], (unsigned long long)size, (unsigned long long)device_limit);
        return false;
    }
    if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
    *buffer = gpu_create_buffer(renderer->gpu, &(GpuBufferDesc){.label = resource_labels[id],
                                                                .heap = "lists",
                                                                .kind = GPU_BUFFER_STATIC,
                                                                .size = cap});
    renderer->usage[id] = GPU_USAGE_NONE;
    renderer->frame_group_stale = true;
    return buffer->id != 0;
}

// Entries of LIST_INDICES: the list of all lights, and what frames before wanted. Lists of the
// packet keep their places, so their size is known.
static u64 index_count_wanted(const DeviceLists *lists, const Packet *packet) {
    const RenderSettings *settings = &packet->settings;
    u64 light_count = packet->lights.count - 1;
    if (tile_lists_refined(settings)) return light_count + packet->light_indices.count;
    if (!device_lists_used(settings)) return 0;
    u64 wanted = MAX(lists->index_cap, FIRST_INDEX_CAP);
    if (lists->index_limit) wanted = MIN(wanted, lists->index_limit);
    return MAX(wanted, light_count);
}

bool device_lists_resize(Renderer *renderer, const Packet *packet) {
    DeviceLists *lists = &renderer->lists;
    const RenderSettings *settings = &packet->settings;
    u64 device_limit = gpu_info(renderer->gpu)->max_storage_buffer_size;
    u64 tiles = (u64)packet->frame.grid[0] * packet->frame.grid[1];
    u64 pixels = (u64)packet->width_px * packet->height_px;
    bool clusters = cluster_lists_made(settings);
    u64 indices = index_count_wanted(lists, packet);
    u64 cells = device_lists_used(settings) ? tiles : 0, places = 0;
    if (clusters) {
        if (tiles > UINT32_MAX >> CLUSTER_TILE_SHIFT) {
            LOG(RENDER_LIMIT, "clusters of %llu tiles have no keys: larger tiles are needed",
                (unsigned long long)tiles);
            return false;
        }
        cells = MAX(lists->cluster_cap, FIRST_CLUSTER_CAP);
        if (lists->cluster_limit) cells = MIN(cells, lists->cluster_limit);
        cells = MIN(MAX(cells, CLUSTER_FIRST), device_limit / sizeof(CellRecord));
        places = cells;
    }
    bool depths = clusters || tile_lists_refined(settings) || tile_lists_made(settings) ||
                  settings->view == VIEW_TILE_DEPTH;
    u64 index_limit = lists->index_limit * sizeof(u32);
    u64 cluster_limit = lists->cluster_limit;
    bool ok = buffer_ensure(renderer, RESOURCE_LIST_CELLS, cells * sizeof(CellRecord),
                            clusters ? cluster_limit * sizeof(CellRecord) : 0) &&
              buffer_ensure(renderer, RESOURCE_LIST_INDICES,
                            MIN(indices * sizeof(u32), device_limit), index_limit) &&
              buffer_ensure(renderer, RESOURCE_TILE_DEPTHS,
                            depths ? tiles * sizeof(TileDepthRecord) : 0, 0) &&
              buffer_ensure(renderer, RESOURCE_CLUSTERS, places * sizeof(u32),
                            cluster_limit * sizeof(u32)) &&
              buffer_ensure(renderer, RESOURCE_PIXEL_CLUSTERS,
                            clusters ? pixels * renderer->samples * sizeof(u32) : 0, 0) &&
              buffer_ensure(renderer, RESOURCE_GRID_COUNTERS, GRID_COUNTER_COUNT * sizeof(u32), 0);
    if (!lists->reports.id)
        lists->reports = gpu_create_buffer(
            renderer->gpu,
            &(GpuBufferDesc){.label = "list reports",
                             .heap = "staging",
                             .kind = GPU_BUFFER_READBACK,
                             .size = LIST_REPORTS_CAP * GRID_COUNTER_COUNT * sizeof(u32)});
    return ok && lists->reports.id;
}

// The next power of two, as long as the device could bind so many.
static u32 grown(const Renderer *renderer, u32 cap, u32 wanted, u64 element_size,
                 const char *what) {
    u64 limit = gpu_info(renderer->gpu)->max_storage_buffer_size / element_size;
    static bool told;
    if (wanted > limit && !told) {
        LOG(RENDER_LIMIT, "%u %s are wanted, the device binds %llu; the rest uses all lights",
            wanted, what, (unsigned long long)limit);
        told = true;
    }
    u64 next = MAX(cap, 1024);
    while (next < wanted) next *= 2;
    return (u32)MIN(next, limit);
}

void device_lists_read(Renderer *renderer, u32 slot) {
    DeviceLists *lists = &renderer->lists;
    if (!lists->reports.id) return;
    const u32 *all = gpu_buffer_map(renderer->gpu, lists->reports);
    for (u32 i = slot * 2; i < slot * 2 + 2; i++) {
        if (!lists->reported[i]) continue;
        lists->reported[i] = false;
        memcpy(lists->counters, all + (u64)i * GRID_COUNTER_COUNT, sizeof lists->counters);
        u32 indices = lists->counters[GRID_COUNTER_INDICES];
        u32 places = lists->counters[GRID_COUNTER_CLUSTERS] + CLUSTER_FIRST;
        if (indices > MAX(lists->index_cap, FIRST_INDEX_CAP))
            lists->index_cap =
                grown(renderer, lists->index_cap, indices, sizeof(u32), "list entries");
        if (places > MAX(lists->cluster_cap, FIRST_CLUSTER_CAP))
            lists->cluster_cap =
                grown(renderer, lists->cluster_cap, places, sizeof(CellRecord), "clusters");
    }
}

void device_lists_stats(Renderer *renderer, const Packet *packet) {
    RendererStats *stats = &renderer->stats;
    const PacketCounts *counts = &packet->counts;
    const u32 *counters = renderer->lists.counters;
    bool device = device_lists_used(&packet->settings);
    stats->list_indices = device ? counters[GRID_COUNTER_INDICES] : counts->light_index_count;
    stats->list_fallbacks = device ? counters[GRID_COUNTER_FALLBACKS] : counts->cell_fallbacks;
    stats->list_longest = device ? counters[GRID_COUNTER_LONGEST] : counts->cell_light_max;
    stats->clusters = cluster_lists_made(&packet->settings) ? counters[GRID_COUNTER_CLUSTERS] : 0;
}

void device_lists_destroy(Renderer *renderer) {
    if (renderer->lists.reports.id) gpu_destroy_buffer(renderer->gpu, renderer->lists.reports);
}

// --- For tests ---

void renderer_limit_lists(Renderer *renderer, u32 index_limit, u32 cluster_limit) {
    renderer->lists.index_cap = renderer->lists.cluster_cap = 0;
    renderer->lists.index_limit = index_limit;
    renderer->lists.cluster_limit = cluster_limit;
    static const RenderResource ids[] = {RESOURCE_LIST_CELLS, RESOURCE_LIST_INDICES,
                                         RESOURCE_CLUSTERS};
    for (u32 i = 0; i < COUNT_OF(ids); i++) {
        GpuBuffer *buffer = &renderer->device_buffers[ids[i]];
        if (buffer->id) gpu_destroy_buffer(renderer->gpu, *buffer);
        *buffer = (GpuBuffer){0};
    }
    renderer->frame_group_stale = true;
}

u64 renderer_read_lists(Renderer *renderer, ListBuffer which, void *out, u64 size) {
    static const RenderResource ids[] = {RESOURCE_LIST_CELLS,     RESOURCE_LIST_INDICES,
                                         RESOURCE_TILE_DEPTHS,    RESOURCE_CLUSTERS,
                                         RESOURCE_PIXEL_CLUSTERS, RESOURCE_GRID_COUNTERS};
    return resource_read(renderer, ids[which], out, size);
}
