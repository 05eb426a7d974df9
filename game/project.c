// project.c: what the demo adds to the engine's world: components and systems.
//
// Data in: none. Data out: luz_project, which the demo runs with, and which the toolbox finds when
// it is linked with it, so that `luz check`, `shot` and `replay` know the demo's levels. Does not:
// hold a HUD or keys; those are main.c's.
#include "../engine/luz.h"
#include "door.h"
#include "shy.h"
#include "tour.h"

static const ComponentDesc *const components[] = {
    &door_component,
    &shy_component,
    &tour_component,
};

// name, reads, writes, function; in the order in which they run, before the engine's "walk".
static const SystemPlacement systems[] = {
    {{"door", "door walker transform", "door transform", system_door}},
    {{"shy", "shy walker transform", "shy transform", system_shy}},
    {{"tour", "tour camera transform", "camera transform", system_tour}},
};

static void on_load(Session *session, void *user) {
    (void)user;
    tour_on_load(session);
}

const SessionDesc luz_project = {
    .components = components,
    .component_count = COUNT_OF(components),
    .systems = systems,
    .system_count = COUNT_OF(systems),
    .on_load = on_load,
};
