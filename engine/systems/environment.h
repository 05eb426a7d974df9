// environment.h: the level's singleton as plain values, with the columns' defaults where a world
// has no row of it (worlds made by code and by tests).
#ifndef LUZ_ENVIRONMENT_H
#define LUZ_ENVIRONMENT_H
#include "../world/world.h"

#define ENVIRONMENT_FIELD_(type, name, ...) Column##type name;
typedef struct Environment {
    ENVIRONMENT_COLUMNS(ENVIRONMENT_FIELD_)
} Environment;
#undef ENVIRONMENT_FIELD_

static inline Environment environment_read(const World *world) {
    const EnvironmentTable *t = WORLD_TABLE(world, Environment, environment);
    bool present = t->table.count > 0;
#define ENVIRONMENT_READ_(type, name, unit, initial, ...)                                          \
    .name = present ? t->name[0] : (Column##type)(initial),
    return (Environment){ENVIRONMENT_COLUMNS(ENVIRONMENT_READ_)};
#undef ENVIRONMENT_READ_
}
#endif
