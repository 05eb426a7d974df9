// main.c: the demo: a walk through a level full of moving lights.
//
// The game is three components of its own (doors, shy fireflies, a touring camera) with their
// systems (project.c), a HUD and a key. The engine does the rest: ../engine/luz.h is its manual.
#include "../engine/luz.h"
#include "hud.h"
#include "tour.h"
#include <string.h>

#define FIRST_LEVEL "data/levels/cloister.toml"

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
        if (strcmp(argv[i], flag) == 0)
            found = true;
        else
            argv[kept++] = argv[i];
    }
    *argc = kept;
    return found;
}

int main(int argc, char **argv) {
    LuzDesc desc = {
        .title = "luz: the cloister",
        .help = "  --tour             fly from camera to camera (T in the window)",
        .level = FIRST_LEVEL,
        .components = luz_project.components,
        .component_count = luz_project.component_count,
        .systems = luz_project.systems,
        .system_count = luz_project.system_count,
        .hud = hud_lines,
        .key = on_key,
        .on_load = luz_project.on_load,
    };
    if (take_flag(&argc, argv, "--tour")) desc.camera = TOUR_CAMERA;
    LuzOptions options;
    int code = luz_options(argc, argv, &desc, &options);
    return code == LUZ_GO_ON ? luz_run(&desc) : code;
}
