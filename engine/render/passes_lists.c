// passes_lists.c: passes that make light lists on the device, and shading by clusters.
// Data in: a packet's lights and lists, the depth buffer (and the normals, if clusters are told
// apart by them). Data out: commands that fill the buffers of device_lists.c. Called by: pass_run
// (passes.c). Does not: decide which lights there are, or size the buffers.
//
// What runs, by settings (each pass says itself whether it is needed):
//   tiles, lists of the packet    nothing; with tile_depth: depths, refine
//   tiles, grid=gpu               (depths,) count, scan, fill
//   clusters=cpu                  nothing
//   clusters=gpu                  keys, scan of tiles, places, count, scan of clusters, fill
// Every list ends up in LIST_CELLS and LIST_INDICES, behind the list of all lights.
#include "passes.h"

// One subgroup a tile in groups of 64, `parts` times. A subgroup that is narrower or wider than the
// device said takes more or fewer tiles: the shaders loop.
static void dispatch_parts(const PassContext *c, PipelineKind kind, u32 parts) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    u32 tiles = c->packet->frame.grid[0] * c->packet->frame.grid[1];
    u32 per_group = CLAMP(64 / MAX(gpu_info(c->renderer->gpu)->subgroup_size, 1), 1, 16);
    bind_frame(c, pipeline);
    gpu_cmd_dispatch(c->cmd, MIN((tiles + per_group - 1) / per_group, 65535), parts, 1);
}
static void dispatch_tiles(const PassContext *c, PipelineKind kind) { dispatch_parts(c, kind, 1); }

// Iterations of loops that one invocation may spend on a tile's clusters: the software driver stops
// it after 65,535, silently.
#define CLUSTER_ITERATIONS 48000

// Parts for as many clusters as a tile can have: slices and directions of normals, or its pixels.
// Each cluster looks at the tile's lights, a subgroup's size at a time.
static void dispatch_clusters(const PassContext *c, PipelineKind kind) {
    const Packet *packet = c->packet;
    const u32 *grid = packet->frame.grid;
    u64 clusters = grid[2] * (packet->settings.cluster_normals ? 6 : 1);
    clusters = MIN(clusters, (u64)grid[3] * grid[3] * c->renderer->samples);
    u64 lanes = CLAMP(gpu_info(c->renderer->gpu)->subgroup_size, 4, 64);
    u64 goes = (packet->lights.count - 1) / lanes + 1;
    u64 per_part = MAX(CLUSTER_ITERATIONS / goes, 1);
    dispatch_parts(c, kind, (u32)((clusters + per_part - 1) / per_part));
}

// One group.
static void dispatch_one(const PassContext *c, PipelineKind kind) {
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, kind, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_dispatch(c->cmd, 1, 1, 1);
}

// --- Tiles ---

static bool tile_depth_needed(const PassContext *c) {
    const RenderSettings *settings = &c->packet->settings;
    return (settings_tiled(settings) && settings->tile_depth != TILE_DEPTH_OFF) ||
           (settings->view == VIEW_TILE_DEPTH && !cluster_lists_made(settings));
}
static void tile_depth_record(const PassContext *c) {
    dispatch_tiles(c, c->renderer->samples > 1 ? PIPELINE_TILE_DEPTH_MS : PIPELINE_TILE_DEPTH);
}
const Pass tile_depth_pass = {"tile depth",
                              {USE(DEPTH, SAMPLED_COMPUTE), USE(DEPTH_MS, SAMPLED_COMPUTE),
                               OVERWRITE(TILE_DEPTHS, STORAGE_COMPUTE),
                               OVERWRITE(GRID_COUNTERS, STORAGE_COMPUTE)},
                              4,
                              tile_depth_record,
                              tile_depth_needed,
                              NULL};

static bool list_refine_needed(const PassContext *c) {
    return tile_lists_refined(&c->packet->settings);
}
static void list_refine_record(const PassContext *c) { dispatch_tiles(c, PIPELINE_LIST_REFINE); }
const Pass list_refine_pass = {
    "list refine",
    {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE), USE(GRID_COUNTERS, STORAGE_COMPUTE),
     OVERWRITE(LIST_CELLS, STORAGE_COMPUTE), OVERWRITE(LIST_INDICES, STORAGE_COMPUTE)},
    4,
    list_refine_record,
    list_refine_needed,
    NULL};

static bool tile_lists_needed(const PassContext *c) {
    return tile_lists_made(&c->packet->settings);
}
static void list_count_record(const PassContext *c) { dispatch_tiles(c, PIPELINE_LIST_COUNT); }
const Pass list_count_pass = {"list count",
                              {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE),
                               OVERWRITE(LIST_CELLS, STORAGE_COMPUTE),
                               OVERWRITE(LIST_INDICES, STORAGE_COMPUTE)},
                              3,
                              list_count_record,
                              tile_lists_needed,
                              NULL};

static void list_scan_record(const PassContext *c) { dispatch_one(c, PIPELINE_LIST_SCAN); }
const Pass list_scan_pass = {
    "list scan",
    {USE(LIST_CELLS, STORAGE_COMPUTE), USE(GRID_COUNTERS, STORAGE_COMPUTE)},
    2,
    list_scan_record,
    tile_lists_needed,
    NULL};

static void list_fill_record(const PassContext *c) { dispatch_tiles(c, PIPELINE_LIST_FILL); }
const Pass list_fill_pass = {"list fill",
                             {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE),
                              USE(LIST_CELLS, STORAGE_COMPUTE), USE(LIST_INDICES, STORAGE_COMPUTE)},
                             3,
                             list_fill_record,
                             tile_lists_needed,
                             NULL};

// --- Clusters ---

static bool clusters_needed(const PassContext *c) {
    return cluster_lists_made(&c->packet->settings);
}
static void cluster_keys_record(const PassContext *c) {
    dispatch_tiles(c, c->renderer->samples > 1 ? PIPELINE_CLUSTER_KEYS_MS : PIPELINE_CLUSTER_KEYS);
}
const Pass cluster_keys_pass = {
    "cluster keys",
    {USE(DEPTH, SAMPLED_COMPUTE), USE(DEPTH_MS, SAMPLED_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
     OVERWRITE(TILE_DEPTHS, STORAGE_COMPUTE), OVERWRITE(PIXEL_CLUSTERS, STORAGE_COMPUTE)},
    9,
    cluster_keys_record,
    clusters_needed,
    NULL};

static void cluster_scan_record(const PassContext *c) { dispatch_one(c, PIPELINE_CLUSTER_SCAN); }
const Pass cluster_scan_pass = {"cluster scan",
                                {USE(TILE_DEPTHS, STORAGE_COMPUTE),
                                 OVERWRITE(LIST_CELLS, STORAGE_COMPUTE),
                                 OVERWRITE(GRID_COUNTERS, STORAGE_COMPUTE)},
                                3,
                                cluster_scan_record,
                                clusters_needed,
                                NULL};

static void cluster_places_record(const PassContext *c) {
    dispatch_tiles(c, PIPELINE_CLUSTER_PLACES);
}
const Pass cluster_places_pass = {"cluster places",
                                  {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE),
                                   USE(PIXEL_CLUSTERS, STORAGE_COMPUTE),
                                   OVERWRITE(CLUSTERS, STORAGE_COMPUTE)},
                                  3,
                                  cluster_places_record,
                                  clusters_needed,
                                  NULL};

static void cluster_count_record(const PassContext *c) {
    dispatch_clusters(c, PIPELINE_CLUSTER_COUNT);
}
const Pass cluster_count_pass = {
    "cluster count",
    {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE), USE(CLUSTERS, STORAGE_READ_COMPUTE),
     USE(LIST_CELLS, STORAGE_COMPUTE), OVERWRITE(LIST_INDICES, STORAGE_COMPUTE)},
    4,
    cluster_count_record,
    clusters_needed,
    NULL};

const Pass cluster_list_scan_pass = {
    "cluster list scan",
    {USE(LIST_CELLS, STORAGE_COMPUTE), USE(GRID_COUNTERS, STORAGE_COMPUTE)},
    2,
    list_scan_record,
    clusters_needed,
    NULL};

static void cluster_fill_record(const PassContext *c) {
    dispatch_clusters(c, PIPELINE_CLUSTER_FILL);
}
const Pass cluster_fill_pass = {
    "cluster fill",
    {USE(TILE_DEPTHS, STORAGE_READ_COMPUTE), USE(CLUSTERS, STORAGE_READ_COMPUTE),
     USE(LIST_CELLS, STORAGE_COMPUTE), USE(LIST_INDICES, STORAGE_COMPUTE)},
    4,
    cluster_fill_record,
    clusters_needed,
    NULL};

// --- What it took, for the stats and the next frame's buffers ---

static bool tile_report_needed(const PassContext *c) {
    const RenderSettings *settings = &c->packet->settings;
    return tile_lists_refined(settings) || tile_lists_made(settings);
}
static void list_report_record(const PassContext *c) {
    Renderer *r = c->renderer;
    // The first of the slot's places that is free: a split frame has two packets.
    u32 at = gpu_frame_slot(r->gpu) * 2;
    if (r->lists.reported[at]) at++;
    r->lists.reported[at] = true;
    u64 size = GRID_COUNTER_COUNT * sizeof(u32);
    gpu_cmd_copy_buffer(c->cmd, r->device_buffers[RESOURCE_GRID_COUNTERS], 0, r->lists.reports,
                        at * size, size);
}
const Pass list_report_pass = {
    "list report", {USE(GRID_COUNTERS, COPY_SOURCE)}, 1, list_report_record, tile_report_needed,
    NULL};
const Pass cluster_report_pass = {"cluster report",
                                  {USE(GRID_COUNTERS, COPY_SOURCE)},
                                  1,
                                  list_report_record,
                                  clusters_needed,
                                  NULL};

// --- Shading ---

static void clustered_record(const PassContext *c) {
    warm_up_list_kinds(c, PIPELINE_CLUSTERED);
    GpuPipeline pipeline = pipeline_get(c->renderer, c->packet, PIPELINE_CLUSTERED, PIPELINE_PLAIN);
    if (!pipeline.id) return;
    bind_frame(c, pipeline);
    gpu_cmd_dispatch(c->cmd, (c->packet->width_px + 7) / 8, (c->packet->height_px + 7) / 8, 1);
}
const Pass clustered_pass = {"lighting",
                             {OVERWRITE(HDR, STORAGE_COMPUTE), USE_GBUFFER(SAMPLED_COMPUTE),
                              USE(DEPTH, SAMPLED_COMPUTE), USE(SHADOW_MAP, SAMPLED_COMPUTE),
                              USE_LISTS(STORAGE_READ_COMPUTE)},
                             13,
                             clustered_record,
                             NULL,
                             NULL};
