// world_fixture.h: a component with a column of every type, and a world full of everything.
#ifndef LUZ_TEST_WORLD_FIXTURE_H
#define LUZ_TEST_WORLD_FIXTURE_H
#include "../../engine/base/random.h"
#include "../../engine/world/world.h"

#define GADGET_COLUMNS(C)                                                                          \
    C(F32, ratio, "", 0.25, "ratio", 0, 1, "a float")                                              \
    C(U32, serial, "", 4000000000.0, "", 0, 0, "more than an i32")                                 \
    C(I32, offset, "", -7, "offset", -10, 10, "a signed number")                                   \
    C(BOOL, on, "", 1, "on", 0, 1, "a switch")                                                     \
    C(ENUM, mode, "off low high", 2, "mode", 0, 2, "a word")                                       \
    C(ENTITY, target, "light", 0, "target", 0, 0, "somebody")                                      \
    C(TEXTURE, picture, "srgb", 0, "picture", 0, 0, "a texture")                                   \
    C(POINTS, route, "m", 0, "route", 0, 0, "a point list")
TABLE_STRUCT(Gadget, GADGET_COLUMNS)
extern const ComponentDesc gadget_component;
#define COMPONENT_gadget COMPONENT_ENGINE_COUNT // the first one that fixture_world registers

// An empty world that knows gadgets.
World *fixture_world(u64 seed);
// The same with some rows in every table, dead and reused slots, names and point lists.
World *fixture_full_world(u64 seed);
#endif
