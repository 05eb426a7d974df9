// shy.h: the component `shy`: drifts aside when a walker comes near, and back when it is gone.
//
// In a level, beside a light (and an orbit, if it has one):  shy = { distance = 2.5, reach = 1.2 }
#ifndef GAME_SHY_H
#define GAME_SHY_H
#include "../engine/luz.h"

#define SHY_COLUMNS(C)                                                                             \
    C(F32, distance, "m", 2.5, "distance", 0.1, 50, "a walker nearer than this is feared")         \
    C(F32, reach, "m", 1.2, "reach", 0, 50, "how far it flees from its place")                     \
    C(F32, calm, "s", 0.6, "calm", 0.02, 60, "how slowly it makes up its mind")                    \
    C(F32, flee_x, "m", 0, "", 0, 0, "shy: from home, now")                                        \
    C(F32, flee_z, "m", 0, "", 0, 0, "shy: from home, now")                                        \
    C(F32, home_x, "m", 0, "", 0, 0, "shy: place in the level")                                    \
    C(F32, home_z, "m", 0, "", 0, 0, "shy: place in the level")                                    \
    C(BOOL, at_home, "", 0, "", 0, 0, "shy: home is known")

TABLE_STRUCT(Shy, SHY_COLUMNS)
extern const ComponentDesc shy_component;

void system_shy(SystemContext *context);
#endif
