// light_manager_state.h: the state's insides, for light_manager.c and packet_lights.c.
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
    bool takes_place; // the shares move at a pair's pace; the same in both partners' slots
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
// A slot's shares `ticks` after the state's: its own and its pair's.
f32 light_slot_weight(const LightSlot *slot, u32 ticks);
f32 light_slot_pair_weight(const LightSlot *slot, u32 ticks);
#endif
