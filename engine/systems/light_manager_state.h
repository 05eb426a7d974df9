// light_manager_state.h: the state's insides, for light_manager.c, light_fade.c and
// packet_lights.c.
#ifndef LUZ_LIGHT_MANAGER_STATE_H
#define LUZ_LIGHT_MANAGER_STATE_H
#include "light_decide.h"
#include "light_manager.h"

// As of the state's tick; the shares then move towards their targets.
typedef struct LightSlot {
    Entity entity, partner;
    f32 weight, target;           // of the light's own brightness
    f32 pair_weight, pair_target; // of the merged light's; the same in both partners' slots
    f32 pair_error;
    u32 fate;         // LightDecision.fate
    f32 tail;         // light_share_step; the same in both partners' slots
    bool takes_place; // what one share loses another gains; the same in both partners' slots
    bool in_step;     // and this light's share is what its pair's leaves of one, now and at the end
} LightSlot;

struct LightManagerState {
    LightSlot *slots; // by entity index
    u32 slot_count;
    bool decided;
    u32 tick; // of the newest step
    Entity camera;
    f32 stage_ms[LIGHT_STAGE_COUNT]; // of the newest step
    Arena polygon_arena;
    OccluderPolygons *polygons; // of meshes that occlude
    u64 polygons_stamp;
    Arena surface_arena;
    LightSurfaces *surfaces; // as of the last cut to another level
    u64 surfaces_stamp;
};

// NULL if the state does not know this entity.
const LightSlot *light_slot(const LightManagerState *state, Entity entity);

// ---- light_fade.c ----

// Radiance (1 = what exposure makes 1) of the brightest pixel that a change of the row's share, and
// its partner's, can show. other: ROW_NONE = in no pair.
f32 light_fade_brightest(const LightScene *scene, u32 row, u32 other, bool takes_place);
// The slot's `tail` for shares of lights that are no brighter.
f32 light_fade_tail(f32 brightest);
// A share (0..1) a tick later, on its way to the target. It changes by the part LIGHT_FADE_RATE of
// itself, or, where that is more, its square root changes by `tail`. takes_place: what it loses
// another gains, and the other one changes by no larger part either.
f32 light_share_step(f32 share, f32 target, f32 tail, bool takes_place);
// A slot's shares `ticks` after the state's: its own and its pair's.
f32 light_slot_weight(const LightSlot *slot, u32 ticks);
f32 light_slot_pair_weight(const LightSlot *slot, u32 ticks);
#endif
