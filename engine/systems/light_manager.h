// light_manager.h: what the light manager remembers: who is merged with whom, and how much of each
// light is shown, so that nothing pops.
//
//   LightManagerState *state = light_manager_create();
//   light_manager_cut(state, world, assets, camera, scratch);      // a level is loaded, a camera
//   cut to after each tick: light_manager_tick(state, world, assets, camera, scratch); packet_build
//   with desc.light_manager = state.
//
// Every LIGHT_MANAGER_STEP ticks the whole decision is taken anew (light_decide.h); what is decided
// is a share of each light's brightness, and of each merged light's, and what is shown moves
// towards it by LIGHT_FADE_RATE of itself a tick at most (light_fade.c). Between two steps it is a
// function of the tick, so the state says the same whatever frames were drawn. It depends on ticks
// and cameras alone: not on settings, on the picture's size, or on threads.
//
// A cut (another camera than the state has seen, a level just loaded, a tick that does not follow)
// takes the decision at once and in full: the cut hides it.
#ifndef LUZ_LIGHT_MANAGER_H
#define LUZ_LIGHT_MANAGER_H
#include "systems.h"
#ifdef __cplusplus
extern "C" {
#endif

#define LIGHT_MANAGER_STEP 6u // ticks
// The part of itself by which a share of brightness changes in a tick: no pixel of the picture by
// more than 2.9 of 255, however many lights. A pair that nobody can tell from its merged light
// takes a quarter of a second to become one, one at a wall two or three.
#define LIGHT_FADE_RATE (1.0f / 16)

LightManagerState *light_manager_create(void);
void light_manager_destroy(LightManagerState *state); // NULL is fine
// Main thread; scratch is used and given back. camera as in PacketBuildDesc.
void light_manager_cut(LightManagerState *state, const World *world, const AssetStore *assets,
                       Entity camera, Arena *scratch);
// To be called after every tick: steps at each tick that LIGHT_MANAGER_STEP divides.
void light_manager_tick(LightManagerState *state, const World *world, const AssetStore *assets,
                        Entity camera, Arena *scratch);
// Does the state hold decisions for this camera at the world's tick? If not, a packet wants a cut.
bool light_manager_knows(const LightManagerState *state, const World *world, Entity camera);
// A copy, for tests: what would be shown, had the next ticks not come.
LightManagerState *light_manager_clone(const LightManagerState *state);
// Shows at the world's tick what was to be shown `ticks` earlier.
void light_manager_delay(LightManagerState *state, u32 ticks);
// Share of a light's own brightness that is shown at the world's tick; 1 for one that is not known.
f32 light_manager_weight(const LightManagerState *state, const World *world, Entity light);
// The other one of its pair, ENTITY_NONE if it is in none; *weight: of the merged light.
Entity light_manager_partner(const LightManagerState *state, const World *world, Entity light,
                             f32 *weight);

// What the occluding meshes of the level look like as polygons; NULL before the first step.
typedef struct OccluderPolygons OccluderPolygons;
const OccluderPolygons *light_manager_polygons(const LightManagerState *state);

#ifdef __cplusplus
}
#endif
#endif
