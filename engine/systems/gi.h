// gi.h: what a packet says of global illumination, and who makes it. Private to these files:
//   gi_volume.c  parameters, the box and its grids, the record
//   gi_lists.c   the light grid over the box
//   gi_keys.c    what the voxels hang on, as hashes; the flags
// All arrays lie in the scratch arena until the packet's size is known.
#ifndef LUZ_GI_H
#define LUZ_GI_H
#include "packet_parts.h"

// Words of all lists together (cells' offsets and counts too). A grid whose lists are longer gets
// cells twice as large, so that no light is ever missing. 16 MiB.
#define GI_LISTS_CAP      (1u << 22)
#define GI_LIST_CELLS_CAP 32 // along a side
#define GI_PROBES_CAP     64 // along a side
#define GI_ATLAS_LEVELS   10

// Cells' offsets and counts, then light indices, as the packet has them.
typedef struct GiLists {
    u32 *words;
    u32 count, index_count;
} GiLists;

// ---- gi_volume.c ----

// The settings' words over the level's `gi`; without that component the columns' defaults and off.
GiParams gi_params_resolve(const World *world, const RenderSettings *settings);
// Box of what is voxelised, world: the bounds of all static drawables, seen or not; if there are
// none, of the dynamic ones. False: there is nothing, or its bounds are not finite.
bool gi_level_bounds(const World *world, const AssetStore *assets, f32 low[3], f32 high[3]);
// Parameters and record for a view. enabled becomes 0 if there is nothing to voxelise.
GiParts gi_begin_packet(const PacketBuildDesc *desc, const PacketView *view);

// ---- gi_lists.c ----

// Lights that touch each cell of record->light_grid, ascending; its shape, origin and rate are set
// from the box of the coarsest cascade, and the count of lights.
GiLists gi_lists_make(GiRecord *record, const GiLightRecord *lights, u32 light_count,
                      Arena *scratch);

// ---- gi_keys.c ----

// Fills in the keys of a packet whose sections are complete. asset_stamp: of the store.
void gi_write_keys(Packet *packet, u64 asset_stamp);
// PACKET_REVOXELISE and PACKET_RELIGHT, see packet.h. previous: of the view's last packet or NULL.
u32 gi_find_flags(const World *world, const PacketGi *gi, const PacketGi *previous, u32 since);
#endif
