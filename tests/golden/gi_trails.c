// gi_trails.c: what moves leaves no light behind: a renderer that has seen other ticks of a level
// with a moving door has the same filtered light, and draws the same picture, as one that has not.
// Data in: level moving_door, settings. Data out: pass or fail. Called by: the runner.
#include "studio.h"
#include <stdlib.h>
#include <string.h>

enum { ATLAS_BYTES = 16 << 20, WIDTH = 96, HEIGHT = 54 };

// What is drawn after `stops` stays at earlier ticks.
static RenderImage draw_after(Studio *studio, const char *list, u32 stops, u8 *atlas) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    studio_open(studio, "data/levels/moving_door.toml");
    for (u32 i = 0; i < 3; i++) {
        session_advance(&studio->session, 70);
        if (i < stops) studio_draw(studio, NULL, &settings, WIDTH, HEIGHT);
    }
    session_advance(&studio->session, 10);
    RenderImage image = studio_draw(studio, NULL, &settings, WIDTH, HEIGHT);
    memset(atlas, 0, ATLAS_BYTES);
    u64 size = renderer_read_gi(studio->renderer, GI_VOLUME_ATLAS, atlas, ATLAS_BYTES);
    assert_true(size > 0 && size < ATLAS_BYTES);
    return image;
}

static void check(const char *list) {
    u8 *fresh = malloc(ATLAS_BYTES), *used = malloc(ATLAS_BYTES);
    assert_true(fresh && used);
    Studio a, b;
    RenderImage first = draw_after(&a, list, 0, fresh);
    RenderImage later = draw_after(&b, list, 3, used);
    if (memcmp(fresh, used, ATLAS_BYTES) != 0) fail_msg("%s: other light in the atlas", list);
    if (first.hash != later.hash) fail_msg("%s: another picture", list);
    studio_close(&a);
    studio_close(&b);
    free(fresh), free(used);
}

TEST_GPU(gi_trails, faces_shared) { check("gi.grid=32,gi.faces=shared"); }
TEST_GPU(gi_trails, faces_apart) { check("gi.grid=32,gi.faces=apart"); }
TEST_GPU(gi_trails, isotropic) { check("gi.grid=32,gi.faces=apart,gi.filter=isotropic"); }
TEST_GPU(gi_trails, bytes) { check("gi.grid=32,gi.faces=shared,gi.format=byte"); }
TEST_GPU(gi_trails, solid) { check("gi.grid=32,gi.faces=apart,gi.solid=on"); }
TEST_GPU(gi_trails, cascades) { check("gi.grid=32,gi.faces=apart,gi.cascades=2"); }
TEST_GPU(gi_trails, irradiance) { check("gi.grid=32,gi.faces=apart,gi.diffuse=voxels"); }
