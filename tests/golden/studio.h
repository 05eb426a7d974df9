// studio.h: a level, a device and a renderer for tests that draw. Validation is always on: the
// runner fails a test that made the layer speak.
#ifndef LUZ_TESTS_STUDIO_H
#define LUZ_TESTS_STUDIO_H
#include "../test.h"
#include "../../engine/app/session.h"
#include "../../engine/render/render.h"

typedef struct Studio {
    Session session;
    Gpu *gpu;
    Renderer *renderer;
    Arena images; // pictures drawn; grows until closed
} Studio;

// The project's own levels: what every picture test draws.
extern const char *const studio_levels[];
extern const u32 studio_level_count;

// Fails the test if the level has errors or there is no device.
void studio_open(Studio *studio, const char *level);
void studio_close(Studio *studio);
// The default settings without light that bounces: of tests whose bounds are those of direct light.
RenderSettings studio_direct_light(void);
// One picture by the settings; camera NULL = the player's.
RenderImage studio_draw(Studio *studio, const char *camera, const RenderSettings *settings,
                        u32 width_px, u32 height_px);
// Runs a shell command; its output (stdout and stderr) in static storage; *exit_code gets its code.
const char *studio_shell(int *exit_code, const char *format, ...) PRINTF_LIKE(2, 3);
// Directory of the programs of the variant under test ("build/release").
const char *studio_build_directory(void);

#endif
