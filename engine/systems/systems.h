// systems.h: plain functions over whole columns, and the table in which they run.
//
// A tick: for each row of the table: advance the world's stamp, call the function. A frame:
// packet_build reads the world and writes a packet. Systems are single calls on the main thread;
// inside they may use jobs_for over disjoint rows.
#ifndef LUZ_SYSTEMS_H
#define LUZ_SYSTEMS_H
#include "../base/sphere_bounds.h"
#include "../asset/asset.h"
#include "../frame/packet.h"
#include "../world/input.h"
#include "../world/world.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct CollisionWorld CollisionWorld; // collision.c: static triangles in a grid, boxes
typedef struct LightManagerState LightManagerState; // light_manager.h

typedef struct SystemContext {
    World *world;
    const AssetStore *assets;
    CollisionWorld *collision; // NULL = nothing to bump into
    Input input;               // of this tick
    Arena *scratch;
    void *user;                // the game's
    u32 last_stamp;            // world stamp when this system last began (0 at the first time)
} SystemContext;

typedef void (*SystemFunction)(SystemContext *context);
typedef struct System {
    const char *name;
    const char *reads, *writes; // component names, for readers and for the inspector
    SystemFunction function;
} System;

#define SYSTEMS_CAP 64
typedef struct SystemTable {
    System rows[SYSTEMS_CAP];
    u32 last_stamp[SYSTEMS_CAP];
    f32 ms[SYSTEMS_CAP]; // time of the last tick, for the panel
    u32 count;
} SystemTable;

// Engine's table: animate, (game systems are inserted here), walk, transform, bounds.
void systems_create(SystemTable *table);
// Before the row called `before`; NULL = at the end. False at the cap or if there is none such.
bool systems_insert(SystemTable *table, const char *before, const System *system);
// One 60 Hz tick: runs all rows in order, then tick++.
void systems_tick(SystemTable *table, SystemContext *context);
// Derived columns (world matrices, bounds) without advancing time: after loading.
void systems_settle(SystemTable *table, SystemContext *context);

void system_animate(SystemContext *context);   // orbit path flicker pulse -> transform.offset, light.gain
void system_walk(SystemContext *context);      // input -> walker, transform (collision.c)
void system_transform(SystemContext *context); // hierarchy -> transform.w, drawable.w, light.x..reach
void system_bounds(SystemContext *context);    // drawable.bounds

// --- Culling (visibility.c) ---

typedef struct Frustum { f32 planes[6][4]; u32 count; } Frustum; // inside: dot(n, p) + d >= 0
// From a world-to-clip matrix with infinite far plane: left right bottom top near.
Frustum frustum_from_matrix(const Mat4 *view_projection);
// Indices (ascending) of spheres that touch the frustum. Arrays are columns (aligned, padded to
// SIMD_WIDTH); radius < 0 = never visible. out has room for count rounded up to SIMD_WIDTH.
// Returns how many.
u32 cull_spheres(const Frustum *frustum, const f32 *x, const f32 *y, const f32 *z,
                 const f32 *radius, u32 count, u32 *out);

// --- Light grid (light_grid.c) ---

// Screen bounds of a light's sphere: sphere_bounds_axis of base/sphere_bounds.h.
// Spots as cones: the part of the ball of radius `reach` around the tip that is within the half
// angle of the axis. View space, [count - point_count].
typedef struct LightCones {
    f32 *tip_x, *tip_y, *tip_z, *axis_x, *axis_y, *axis_z; // axis: unit
    f32 *cos_half, *sin_half, *reach;
} LightCones;
// How depth is sliced into clusters: slice = clamp(floor(log2(view depth) * scale + offset), 0,
// count - 1). FrameRecord.slices is {scale, offset, end, factor}.
typedef struct ClusterSlices {
    u32 count;         // 0 = no clusters: a grid of tiles
    f32 scale, offset;
    f32 end, factor;   // view depth in m where slice 0 ends; ends of slices grow by the factor
} ClusterSlices;
// How many indices are written at once: what the machine does best, or, for tests, one or eight.
typedef enum GridFill { GRID_FILL_AUTO, GRID_FILL_BY_ONE, GRID_FILL_BY_EIGHT } GridFill;
typedef struct LightGridInput {
    const f32 *x, *y, *z, *radius; // view space; [count]; a spot's is its cone's smallest sphere
    u32 count, point_count;        // lights >= point_count are spots
    u32 width_px, height_px, tile_px;
    f32 near, scale_x, scale_y;    // projection scales
    u32 highlight_points, highlight_spots; // the first so many points and spots have a highlight
    LightCones cones;              // all NULL = spots are taken for their spheres
    GridMethod method;             // of tiles: rectangle, else the tile's frustum
    GridFill fill;
    ClusterSlices slices;
} LightGridInput;
// From a packet's records (light_grid_input.c): counts, camera and lens from `frame`, tile size
// from the settings. Memory from the arena.
LightGridInput light_grid_input(const FrameRecord *frame, const LightRecord *lights,
                                const SpotRecord *spots, const RenderSettings *settings,
                                Arena *arena);
typedef struct LightGrid {
    CellRecord *cells; // [tiles_x * tiles_y * slices], tiles row by row from the upper left
    u32 *indices;      // ascending within a cell
    u32 tiles_x, tiles_y, slices, cell_count, index_count;
    u32 longest;       // lights in the fullest cell
    u32 fallbacks;     // cells that use the list of all lights because memory ran out
} LightGrid;
// Count, prefix sum, fill (stable). Memory from the arena.
LightGrid light_grid_build(const LightGridInput *input, Arena *arena);
// Slices for these lights (light_clusters.c): near-cubic clusters (specification of direct
// lighting, 6.3) from the eye to the farthest light, fewer and longer ones if there would be more
// than CLUSTER_SLICES_CAP slices or cells_cap cells. (With tiles so small that these are not even
// eight slices, up to eight times as many cells.)
#define CLUSTER_CELLS_CAP (1u << 15) // half a MiB of records, made and uploaded every frame
ClusterSlices light_cluster_slices(const LightGridInput *input, u32 cells_cap);

// --- Packet (packet_build.c) ---

typedef struct PacketText2D { f32 x_px, y_px, size_px; u32 color; const char *text; } PacketText2D;
typedef struct PacketBuildDesc {
    const World *world;
    const AssetStore *assets;
    Entity camera;              // entity with transform and camera; ENTITY_NONE = identity, 60 deg
    RenderSettings settings;
    u32 width_px, height_px;    // internal resolution
    const PacketText2D *texts;
    u32 text_count;
    u32 last_stamp;             // world stamp of the previous packet: for the flags
    const f32 *previous_view_projection; // of the previous packet; NULL = there is none
    const LightManagerState *light_manager; // NULL = no memory: decided afresh and applied at once
    const PacketGi *previous_gi; // of the previous packet, makes the flags exact; NULL = stamps alone
    bool cold;                  // PACKET_COLD: the picture must not hang on earlier ones
} PacketBuildDesc;
// Steps of the light manager. merge, drop, budget: where the state decides them, the time of its
// newest decision (one in six ticks), which is no part of the packet's own time.
typedef enum LightStage {
    LIGHT_STAGE_CANDIDATES,
    LIGHT_STAGE_FRUSTUM,
    LIGHT_STAGE_OCCLUSION,
    LIGHT_STAGE_MERGE,
    LIGHT_STAGE_DROP,
    LIGHT_STAGE_BUDGET,
    LIGHT_STAGE_INDIVIDUAL, // level of detail, classes, records
    LIGHT_STAGE_COUNT
} LightStage;
typedef struct PacketBuildTimes {
    f32 cull_ms, lights_ms, grid_ms, pack_ms;
    f32 occluders_ms; // drawing them; a part of cull_ms
    f32 gi_ms;        // box, draws and light lists of the voxels
    f32 light_stage_ms[LIGHT_STAGE_COUNT]; // parts of lights_ms
} PacketBuildTimes;
// The packet lies in `out`; scratch is used and given back. times may be NULL.
const Packet *packet_build(const PacketBuildDesc *desc, Arena *out, Arena *scratch,
                           PacketBuildTimes *times);
// The same frame to be drawn in another way (packet_lists.c): a copy with the path and the other
// settings of drawing taken over and the light lists made anew for them. Settings that shaped the
// rest of the packet when it was built (scale, culling, detail, shadows, the light manager's,
// exposure, gain, limit, GI's but for what is shown of voxels) keep its values. The packet must be
// valid; the copy lies in `out`.
const Packet *packet_relist(const Packet *packet, const RenderSettings *settings, Arena *out,
                            Arena *scratch);

// --- Collision (collision.c) ---

// Gathers triangles of instances with collision = mesh (static ones, by the level's rest pose)
// into a grid; boxes follow their instance every tick. Call after loading a level.
CollisionWorld *collision_create(const World *world, const AssetStore *assets);
void collision_destroy(CollisionWorld *collision);

#ifdef __cplusplus
}
#endif
#endif
