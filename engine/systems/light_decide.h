// light_decide.h: the light manager's social phase: what all lights together decide. Private to
//   light_scene.c     candidates, the reference view
//   packet_lights.c   the packet's own view of them, records
//   light_manager.c   the state: decisions in time
//   light_fade.c      how fast they show
//   light_merge.c     pairs that become one
//   light_rank.c      dropping, budget, the decision as a whole
//
// Pixels are those of a reference picture 720 px high with the camera's field of view, seen with
// the level's exposure: so what is decided does not hang on the size or the settings of the
// picture. It has a rim, so that lights are decided before they come into view. Its regions have 64
// px.
#ifndef LUZ_LIGHT_DECIDE_H
#define LUZ_LIGHT_DECIDE_H
#include "light_surfaces.h"
#include "occlusion.h"

#define REFERENCE_HEIGHT_PX 720
#define REGION_PX           64
#define REGIONS_X           28 // 1792 px: pictures up to 2.49 times as wide as high
#define REGIONS_Y           16 // 1024 px
#define REGION_COUNT        (REGIONS_X * REGIONS_Y)

#define LIGHT_PINNED_PRIORITY 100.0f

typedef struct LightCandidates {
    f32 *x, *y, *z, *radius; // bounding sphere, world; radius -1 = no light; [count padded]
    f32 *r, *g, *b;          // colour times all factors
} LightCandidates;

#define LIGHT_MANAGER_FIELD_(type, name, ...) Column##type name;
typedef struct LightManagerConfig {
    LIGHT_MANAGER_COLUMNS(LIGHT_MANAGER_FIELD_)
} LightManagerConfig;
#undef LIGHT_MANAGER_FIELD_
LightManagerConfig light_manager_config(const World *world);

// Everything that decisions are made from.
typedef struct LightScene {
    const LightTable *light;
    LightCandidates candidates;
    u32 count;       // rows
    PacketView view; // of the reference picture, rim included
    f32 focal_px;    // px of a metre across at one metre
    f32 white;       // pixel value (1 = white) of irradiance 1 on a surface that reflects half
    u32 attenuation; // Attenuation
    f32 falloff[3];  // polynomial: kc, kl, kq
    LightManagerConfig config;
    const LightSurfaces *surfaces; // NULL = not known
} LightScene;

// ---- light_scene.c ----

// gain: factor on all colours. Memory from scratch.
LightCandidates light_candidates(const LightTable *light, f32 gain, Arena *scratch);
// camera: as in PacketBuildDesc.
LightScene light_scene_make(const World *world, Entity camera, const LightCandidates *candidates);

// The light that stands for a pair.
typedef struct MergedLight {
    Vec3 position, color, direction; // color: times all factors; direction: unit, spots
    f32 range, inner_deg, outer_deg;
    Vec3 center; // bounding sphere
    f32 radius;
    u32 kind; // LightKind
} MergedLight;

// What the stages found, by row.
typedef struct LightDecision {
    u32 *partner;     // row of the other one of a pair, ROW_NONE = none
    f32 *pair_error;  // predicted, of the pair; the same for both, as is the next
    f32 *pair_weight; // of the merged light's brightness
    f32 *weight;      // of the light's own brightness that is shown
    u8 *fate; // LIGHT_KEPT, LIGHT_DROPPED, LIGHT_OVER_BUDGET; in a pair: of the merged light
} LightDecision;
LightDecision light_decision_make(u32 count, Arena *scratch);

// ---- light_merge.c ----

bool light_pinned(const LightTable *light, u32 row);
// Energy-weighted mean place, a range that covers both spheres, the sum of what both emit. A row
// that is no light now (candidate radius < 0) adds nothing; if neither is, the result's radius is
// -1.
MergedLight light_merge_pair(const LightTable *light, const LightCandidates *candidates, u32 a,
                             u32 b);
// Predicted error of showing the merged light instead of the pair: how much the reference picture
// changes in the worst region, as the mean over its pixels, 1 = white. See light_merge.c.
f32 light_merge_error(const LightScene *scene, u32 a, u32 b);
// Largest change of a single pixel by merging the pair, predicted from how far the nearest surface
// is, 1 = white.
f32 light_merge_peak(const LightScene *scene, u32 a, u32 b);
// May these two become one (held: stay one, with slack against flicker)? *error: predicted.
bool light_may_merge(const LightScene *scene, u32 a, u32 b, bool held, f32 *error);
// Fills partner and pair_error. held[count]: the partner of pairs that are merged or were: those
// that may stay do, the others keep their partner but get pair_weight 0 (they are splitting). NULL
// = none. New pairs only among `rows` (ascending). pair_weight of pairs that shall be merged: 1.
void light_merge_find(const LightScene *scene, const u32 *held, const u32 *rows, u32 row_count,
                      LightDecision *decision, Arena *scratch);

// ---- light_rank.c ----

// As the shaders attenuate: at distance d of a light with this range, for intensity 1.
f32 light_attenuation(const LightScene *scene, f32 d, f32 range);

// Area of a sphere's picture in px of the reference picture, the screen's edges ignored; 1e30 for a
// sphere that the eye is in.
f32 light_area_px(const LightScene *scene, Vec3 center, f32 radius);
// Radiance (before exposure's curve, 1 = what exposure makes 1) of the brightest pixel that the
// row's light makes at its full intensity, about: on the nearest surface, if that is white.
f32 light_brightest(const LightScene *scene, u32 row);
// 0..1 of brightness that the drop stage leaves to a light of these measures.
f32 light_drop_weight(const LightScene *scene, Vec3 center, f32 radius, Vec3 color, f32 range);

// What the budget chooses among.
typedef struct BudgetLight {
    Vec3 center;
    f32 radius;
    f32 importance;
    bool pinned;
} BudgetLight;
f32 light_importance(const LightScene *scene, Vec3 center, f32 radius, Vec3 color, f32 range,
                     f32 priority);
// weight[count]: 0..1; budget: lights of a region.
void light_budget(const LightScene *scene, const BudgetLight *lights, u32 count, u32 budget,
                  f32 *weight, Arena *scratch);

typedef struct LightDecideDesc {
    const u32 *rows; // visible candidates, ascending
    u32 row_count;
    const u32 *held; // see light_merge_find
    bool merge, drop;
    u32 budget; // 0 = any number
} LightDecideDesc;
// Merge, drop, budget over a scene. ms[LIGHT_STAGE_COUNT]: the three are set.
LightDecision light_decide(const LightScene *scene, const LightDecideDesc *desc, f32 *ms,
                           Arena *scratch);
#endif
