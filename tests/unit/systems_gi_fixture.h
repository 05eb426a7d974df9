// systems_gi_fixture.h: packets with global illumination, of 317 x 201 px.
#ifndef LUZ_TEST_SYSTEMS_GI_FIXTURE_H
#define LUZ_TEST_SYSTEMS_GI_FIXTURE_H
#include "systems_fixture.h"
#include "../test.h"
#include <string.h>

// settings: a list as settings_set_list reads it, "" = defaults.
static inline PacketBuildDesc gi_desc(SystemsFixture *f, Entity camera, const char *settings) {
    PacketBuildDesc desc = {.world = f->world,
                            .assets = &f->assets,
                            .camera = camera,
                            .settings = settings_default(),
                            .width_px = 317,
                            .height_px = 201};
    if (settings[0]) assert_true(settings_set_list(&desc.settings, settings));
    return desc;
}

static inline const Packet *gi_packet(SystemsFixture *f, Entity camera, const char *settings) {
    PacketBuildDesc desc = gi_desc(f, camera, settings);
    return packet_build(&desc, &f->arenas.frame, &f->arenas.scratch, NULL);
}

// A parameter by its column's name; `other` if there is none of that name (the box).
static inline f64 gi_column_param(const GiParams *params, const char *name, f64 other) {
#define WHOLE(param, ...)                                                                          \
    if (strcmp(name, #param) == 0) return (f64)params->param;
    GI_PARAMS(WHOLE, WHOLE, WHOLE, WHOLE)
#undef WHOLE
    return other;
}
#endif
