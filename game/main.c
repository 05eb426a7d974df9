// main.c: the demo: a walk through a level full of moving lights.
//
// The whole game is here: three components of its own (doors, shy fireflies, a touring camera),
// their systems, a HUD and a key. The engine does the rest: ../engine/luz.h is its manual.
#include "../engine/luz.h"
#include "door.h"
#include "hud.h"
#include "shy.h"
#include "tour.h"
#include <string.h>

#define FIRST_LEVEL "data/levels/cloister.toml"

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

// T starts and ends the tour.
static bool on_key(Luz *luz, int key, void *user) {
    (void)user;
    if (key != 'T') return false;
    bool touring = strcmp(luz->camera, TOUR_CAMERA) == 0;
    luz_set_camera(luz, touring ? NULL : TOUR_CAMERA);
    return true;
}

// Our own option; taken out, so that the engine's parser sees only what it knows.
static bool take_flag(int *argc, char **argv, const char *flag) {
    bool found = false;
    int kept = 0;
    for (int i = 0; i < *argc; i++) {
        if (strcmp(argv[i], flag) == 0) found = true;
        else argv[kept++] = argv[i];
    }
    *argc = kept;
    return found;
}

int main(int argc, char **argv) {
    LuzDesc desc = {
        .title = "luz: the cloister",
        .help = "  --tour             fly from camera to camera (T in the window)",
        .level = FIRST_LEVEL,
        .components = components,
        .component_count = COUNT_OF(components),
        .systems = systems,
        .system_count = COUNT_OF(systems),
        .hud = hud_lines,
        .key = on_key,
        .on_load = on_load,
    };
    if (take_flag(&argc, argv, "--tour")) desc.camera = TOUR_CAMERA;
    LuzOptions options;
    int code = luz_options(argc, argv, &desc, &options);
    return code == LUZ_GO_ON ? luz_run(&desc) : code;
}
