// level_common.h: what the tests of engine/level share: a level from a string, loaded into a world
// that also has two components of a game. Data in: text. Data out: world, store, diagnostics.
#ifndef LUZ_TEST_LEVEL_COMMON_H
#define LUZ_TEST_LEVEL_COMMON_H
#include "../test.h"
#include "../../engine/level/level.h"
#include <stdlib.h>
#include <string.h>

// The demo's own door is linked into the tests, too.
#define door_component test_door_component

#define DOOR_COLUMNS(C)                                                                            \
    C(F32, angle_max, "deg", 90, "angle", 0, 180, "how far it opens")                              \
    C(ENTITY, lamp, "light", 0, "lamp", 0, 0, "goes on when it opens")                             \
    C(ENTITY, other, "", 0, "other", 0, 0, "anything")                                             \
    C(I32, offset, "", -3, "offset", -10, 10, "a signed number")                                   \
    C(U32, lock, "", 2, "lock", 0, 100, "which key opens it")                                      \
    C(ENUM, state, "closed opening open", 0, "", 0, 2, "what it does")
#define RULES_COLUMNS(C) C(F32, limit, "s", 60, "limit", 1, 1000, "time to win")
TABLE_STRUCT(Door, DOOR_COLUMNS);
TABLE_STRUCT(Rules, RULES_COLUMNS);
extern const ComponentDesc door_component, rules_component;

typedef struct TestLevel {
    Arena arena;
    FileRoot root;
    World *world;
    AssetStore store;
    LevelInfo info;
    Diagnostics *diagnostics;
    bool is_good;
} TestLevel;

World *test_level_world(void);
// Loads text of any size (with zero bytes, if need be) written to `name` in the test's directory.
void test_level_load_bytes(TestLevel *level, const char *name, const void *data, u64 size);
void test_level_load(TestLevel *level, const char *text);
void test_level_close(TestLevel *level);
// Fails with all diagnostics if the level has errors.
void test_level_load_good(TestLevel *level, const char *text);
// Row of a named entity in a component's table; fails if there is none.
u32 test_level_row(const TestLevel *level, u32 component, const char *name);
DoorTable *test_level_doors(const TestLevel *level);

#endif
