// packet_parts.h: what packet_build.c puts together, and who makes it. Private to these files:
//   packet_build.c   view, flags, texts, the order of it all
//   packet_lights.c  the light manager: lights of the view, GI lights, directional lights
//   packet_shadow.c  the shadow map's matrix
//   packet_draws.c   material palette, drawcalls, instances
//   packet_post.c    the post chain
//   gi_*.c           global illumination (gi.h)
// All arrays lie in the scratch arena until the packet's size is known.
#ifndef LUZ_PACKET_PARTS_H
#define LUZ_PACKET_PARTS_H
#include "environment.h"
#include "systems.h"

typedef struct PacketView {
    Vec3 position, right, up, forward; // world; orthonormal
    f32 tan_x, tan_y, near;            // tangents of the half angles of view
    f32 height_px;
    f32 vertex_lighting; // beyond this distance, m, drawables are lit at their vertices; 0 = never
    Mat4 view, view_projection;
    Frustum frustum;
} PacketView;

// As the camera entity sees; ENTITY_NONE or one without a transform: from the origin. Pixels count
// for aspect and height_px only.
PacketView packet_make_view(const World *world, Entity camera, u32 width_px, u32 height_px);

// ---- packet_lights.c ----

typedef struct OcclusionBuffer OcclusionBuffer; // occlusion.h

typedef struct LightParts {
    u32 total, visible; // local lights: of the level, of the view
    u32 occluded, merged, merged_pairs, dropped, over_budget, fading; // as in PacketCounts
    u32 near, between, far;
    f32 merge_error, vertex_lighting; // the latter: FrameRecord
    PacketLightMark *marks;           // only if the view asks
    u32 mark_count;
    f32 stage_ms[LIGHT_STAGE_COUNT];
    u32 point_count, spot_count;
    LightRecord *lights; // [point_count + spot_count + 1]: points, spots, the dummy
    SpotRecord *spots;   // [spot_count]
    u32 point_highlights, spot_highlights; // the first so many of each have a highlight
    GiLightRecord *gi_lights;              // [gi_count]
    u32 gi_count;
    TracedLightRecord *traced; // [traced_count], in row order; they are not among `lights`
    u32 traced_count, traced_local;
    DirectionalRecord directionals[DIRECTIONALS_CAP]; // see packet.h
    u32 directional_count, screen_directional_count;
    bool casts_shadow; // directional `shadow_index` wants a shadow map
    u32 shadow_index;
    Vec3 shadow_direction; // unit, the way it shines
} LightParts;
// occlusion NULL = nothing hides. gi: with enabled = 0 there are no GI lights and no traced ones.
LightParts packet_collect_lights(const PacketBuildDesc *desc, const PacketView *view,
                                 const OcclusionBuffer *occlusion, const GiParams *gi,
                                 Arena *scratch);

// ---- packet_shadow.c ----

typedef struct ShadowFit {
    Vec3 right, up, back;        // the light looks along -back
    f64 center_right, center_up; // of the square, on a whole texel
    f32 half_m, texel_m;         // half a side of the square, a texel
    f32 front, rear;             // along back: ends of the depth range
    Frustum frustum;             // casters outside shadow nothing in the view
} ShadowFit;
// Square and rear end; front starts at the fitted sphere and grows with shadow_fit_casters.
ShadowFit shadow_fit_view(const PacketView *view, Vec3 direction, f32 distance_m, u32 size_px);
void shadow_fit_casters(ShadowFit *fit, const DrawableTable *drawables, const u32 *rows, u32 count);
Mat4 shadow_fit_matrix(const ShadowFit *fit);

// ---- packet_post.c ----

typedef struct PostParts {
    PacketPost *posts; // in the order in which they run
    u32 count;
} PostParts;
PostParts packet_collect_posts(const PacketBuildDesc *desc, const PacketView *view, Arena *scratch);

// ---- packet_draws.c ----

typedef struct MaterialPalette {
    u16 *index_of_row; // [material rows], PALETTE_NONE = no drawable uses it
    u32 missing;       // index for drawables without a material
    u32 count;
    MaterialRecord records[MATERIALS_CAP];
    PacketMaterial bindings[MATERIALS_CAP];
    u32 brdf_mask;
    f32 common_lobes[4]; // FrameRecord.common_lobes
} MaterialPalette;
#define PALETTE_NONE UINT16_MAX
MaterialPalette *packet_collect_materials(const World *world, Arena *scratch);

typedef struct DrawLists {
    u32 *rows;         // [row_count] drawable row of each instance, in draw order
    u16 *material;     // [row_count] palette index of each
    f32 *vertex_share; // [row_count] of local light that comes from the vertices
    u32 row_count;
    PacketDraw *lists[3]; // by AlphaMode; first_instance counts from this object's first row
    u32 counts[3];
    u32 triangles;
} DrawLists;
// rows: drawables that pass culling. With `shadow` they are casters of its map: opaque draws are
// told apart only by what a depth pass sees, and blended ones are left out.
DrawLists packet_collect_draws(const PacketBuildDesc *desc, const PacketView *view,
                               const MaterialPalette *palette, const u32 *rows, u32 row_count,
                               const ShadowFit *shadow, Arena *scratch);
void packet_write_instances(const World *world, const DrawLists *draws, InstanceRecord *out);
// What is voxelised (mode: VOXEL_STATIC or VOXEL_DYNAMIC), wherever the view is: all draws are
// lists[0], by mesh, then material, in full detail; none are blended.
DrawLists packet_collect_voxelised(const World *world, const AssetStore *assets,
                                   const MaterialPalette *palette, u32 mode, Arena *scratch);

// ---- gi_volume.c and its friends ----

typedef struct GiParts {
    GiParams params;
    GiRecord record;
    DrawLists draws[2]; // static, dynamic
    u32 *lists;         // [list_count]
    u32 list_count, list_index_count;
} GiParts;
#endif
