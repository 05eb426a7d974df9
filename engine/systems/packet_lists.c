// packet_lists.c: the light lists of a packet: when it is built, and again for other settings.
// Data in: a frame record, light and spot records, settings. Data out: cells, light indices, grid
// nodes, and what the frame record says of them. Called by: packet_build, and who draws one packet
// in several ways (replay, split views, tests). Does not: look at the world: a captured packet will
// do.
#include "packet_lists.h"
#include <string.h>

LightLists light_lists_plan(FrameRecord *frame, const LightRecord *lights, const SpotRecord *spots,
                            const RenderSettings *settings, bool has_blended, Arena *scratch) {
    LightGridInput input = light_grid_input(frame, lights, spots, settings, scratch);
    LightLists lists = {.has_cells = !settings_lists_on_device(settings) || has_blended};
    bool clustered = settings_clustered(settings);
    input.method = settings->grid;
    if (clustered)
        input.slices =
            light_cluster_slices(&input, lists.has_cells ? CLUSTER_CELLS_CAP : UINT32_MAX);
    u32 tile_px = input.tile_px;
    const u32 grid[4] = {(input.width_px + tile_px - 1) / tile_px,
                         (input.height_px + tile_px - 1) / tile_px, MAX(input.slices.count, 1),
                         tile_px};
    const ClusterSlices *s = &input.slices;
    const f32 slices[4] = {s->scale, s->offset, s->end, s->factor};
    memcpy(frame->grid, grid, sizeof grid);
    memcpy(frame->slices, slices, sizeof slices);
    frame->counts[3] = frame->counts3[2] = frame->counts3[3] = 0;

    lists.lights_listed = input.count;
    if (lists.has_cells) {
        lists.grid = light_grid_plan(&input, scratch);
        lists.cell_count = lists.grid.cell_count;
        lists.index_count = lists.grid.index_count;
        lists.lights_listed = lists.grid.lights_listed;
    }
    if (clustered && settings->clusters == CLUSTERS_GPU && input.count > LIGHT_HIERARCHY_FROM) {
        lists.hierarchy = light_hierarchy_build(&input, scratch);
        frame->counts[3] = lists.node_count = lists.hierarchy.node_count;
        frame->counts3[2] = lists.hierarchy.spots_root;
        frame->counts3[3] = lists.index_count;
        lists.index_count += input.count;
    }
    return lists;
}

void light_lists_write(LightLists *lists, Packet *packet) {
    u32 *indices = PACKET_WRITE(packet, light_indices, u32);
    if (lists->has_cells)
        light_grid_fill(&lists->grid, PACKET_WRITE(packet, cells, CellRecord), indices);
    if (lists->node_count) {
        memcpy(indices + packet->frame.counts3[3], lists->hierarchy.order,
               lists->hierarchy.light_count * sizeof *indices);
        memcpy(PACKET_WRITE(packet, grid_nodes, GridNode), lists->hierarchy.nodes,
               lists->node_count * sizeof(GridNode));
    }
    packet->counts.lights_shaded = lists->lights_listed;
    packet->counts.cell_count = lists->cell_count;
    packet->counts.cell_light_max = lists->grid.longest;
    packet->counts.light_index_count = lists->grid.index_count;
    packet->counts.cell_fallbacks = lists->grid.fallbacks;
}

// Settings that went into the packet's other sections stay what they were.
static RenderSettings keep_settings(const RenderSettings *asked, const RenderSettings *built) {
    RenderSettings s = *asked;
#define KEEP(name) s.name = built->name
    KEEP(scale);
    KEEP(shadows);
    KEEP(mesh_culling);
    KEEP(lod_error_px);
    KEEP(manager);
    KEEP(light_culling);
    KEEP(occlusion);
    KEEP(merge);
    KEEP(drop);
    KEEP(light_lod);
    KEEP(budget);
    KEEP(exposure);
    KEEP(light_gain);
    KEEP(light_limit);
#define KEEP_GI(name, ...) KEEP(gi_##name);
    GI_PARAMS(KEEP_GI, KEEP_GI, KEEP_GI, KEEP_GI)
#undef KEEP_GI
#undef KEEP
    settings_clamp(&s);
    return s;
}

const Packet *packet_relist(const Packet *packet, const RenderSettings *settings, Arena *out,
                            Arena *scratch) {
    LUZ_ASSERT(out != scratch);
    u64 mark = arena_mark(scratch);
    RenderSettings merged = keep_settings(settings, &packet->settings);
    FrameRecord frame = packet->frame;
    LightLists lists = light_lists_plan(&frame, PACKET_DATA(packet, lights, LightRecord),
                                        PACKET_DATA(packet, spots, SpotRecord), &merged,
                                        packet->blend_draws.count > 0, scratch);
    PacketSizes sizes = {
#define X(name, Type) .name = packet->name.count,
        PACKET_SECTIONS(X)
#undef X
    };
    sizes.cells = lists.cell_count;
    sizes.light_indices = lists.index_count;
    sizes.grid_nodes = lists.node_count;
    Packet *copy = packet_allocate(out, &sizes), laid_out = *copy;
    *copy = *packet;
    copy->size = laid_out.size;
    copy->settings = merged;
    copy->frame = frame;
    if (copy->gi.params.enabled) {
        copy->gi.record.show[0] = merged.gi_show;
        copy->gi.record.show[1] = merged.gi_show_level;
        copy->gi.record.show[2] = merged.gi_show_direction;
    }
#define X(name, Type)                                                                              \
    copy->name = laid_out.name;                                                                    \
    if (copy->name.count == packet->name.count)                                                    \
        memcpy(PACKET_WRITE(copy, name, Type), PACKET_DATA(packet, name, Type),                    \
               copy->name.count * sizeof(Type));
    PACKET_SECTIONS(X)
#undef X
    light_lists_write(&lists, copy);
    arena_rewind(scratch, mark);
    return copy;
}
