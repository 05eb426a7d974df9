// door.h: the component `door`: opens when a walker comes near, closes behind.
//
// In a level, beside an instance whose model has its hinge at the origin:
//     door = { angle = 95, radius = 2.5, speed = 120 }
#ifndef GAME_DOOR_H
#define GAME_DOOR_H
#include "../engine/luz.h"

#define DOOR_COLUMNS(C)                                                                            \
    C(F32, angle, "deg", 90, "angle", -180, 180, "how far it opens; the sign says which way")      \
    C(F32, radius, "m", 2.5, "radius", 0.1, 50, "opens for a walker as near as this")              \
    C(F32, speed, "deg/s", 120, "speed", 1, 1000, "how fast it swings")                            \
    C(F32, opening, "", 0, "", 0, 0, "door: 0 closed .. 1 open")                                   \
    C(F32, base_yaw, "deg", 0, "", 0, 0, "door: yaw when closed")                                  \
    C(BOOL, hung, "", 0, "", 0, 0, "door: base_yaw is known")

TABLE_STRUCT(Door, DOOR_COLUMNS)
extern const ComponentDesc door_component;

void system_door(SystemContext *context);
#endif
