// packet_lists.h: the light lists of a packet in two steps: plan (sizes) -> allocate -> write.
// For packet_build.c; who has a packet already uses packet_relist (systems.h).
#ifndef LUZ_PACKET_LISTS_H
#define LUZ_PACKET_LISTS_H
#include "light_grid.h"
#include "light_hierarchy.h"

typedef struct LightLists {
    LightGridPlan grid;       // if has_cells
    LightHierarchy hierarchy; // if node_count > 0
    bool has_cells;
    u32 cell_count, index_count, node_count; // of the packet's sections
    u32 lights_listed;                       // that touch any cell; without cells: all
} LightLists;

// frame: camera, lens and light counts are read; grid, slices and the hierarchy's numbers are
// written. has_blended: there are blended surfaces, which need the packet's own lists in any case.
// Memory from scratch, to be kept until after the write.
LightLists light_lists_plan(FrameRecord *frame, const LightRecord *lights, const SpotRecord *spots,
                            const RenderSettings *settings, bool has_blended, Arena *scratch);
// The sections, and the packet's counts that speak of lists. Uses the plan up.
void light_lists_write(LightLists *lists, Packet *packet);
#endif
