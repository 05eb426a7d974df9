// volumes.c: path `deferred_volumes`: every combination of its means gives the picture of
// `deferred`, bit for bit; the means leave pixels out; nothing is lost at the eye, behind it, at
// the near plane. Data in: levels, settings. Data out: pictures compared. Called by: the runner.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <string.h>

static RenderImage draw_path(Studio *studio, const char *camera, RenderPath path, u32 width,
                             u32 height, const char *const *settings, u32 setting_count) {
    RenderSettings s = settings_default();
    for (u32 i = 0; i < setting_count; i++) assert_true(settings_set(&s, settings[i]));
    s.path = path;
    return studio_draw(studio, camera, &s, width, height);
}

static const char *const faces[] = {"light_volume=quad", "light_volume=back", "light_volume=front",
                                    "light_volume=auto", "light_volume=stencil"};
static const char *const scissors[] = {"light_scissor=off", "light_scissor=on"};
static const char *const branches[] = {"light_branch=off", "light_branch=on"};

// All 20 combinations against `deferred`. Steps: the largest difference allowed.
static void check_combinations(Studio *studio, const char *camera, u32 width, u32 height) {
    RenderImage reference = draw_path(studio, camera, PATH_DEFERRED, width, height, NULL, 0);
    u32 equal = 0, count = 0;
    for (u32 f = 0; f < COUNT_OF(faces); f++)
        for (u32 s = 0; s < COUNT_OF(scissors); s++)
            for (u32 b = 0; b < COUNT_OF(branches); b++) {
                const char *const settings[] = {faces[f], scissors[s], branches[b]};
                RenderImage image = draw_path(studio, camera, PATH_DEFERRED_VOLUMES, width, height,
                                              settings, COUNT_OF(settings));
                ImageDifference d =
                    image_compare(reference.rgba, image.rgba, width, height, &studio->images);
                if (d.max > 1)
                    fail_msg("%s %s %s, camera %s: max %u at %u,%u", faces[f], scissors[s],
                             branches[b], camera, d.max, d.max_x, d.max_y);
                equal += image.hash == reference.hash;
                count++;
            }
    printf("    camera %s: %u of %u combinations are the bits of `deferred`\n", camera, equal,
           count);
    // Without the branch the same code runs for the same pixels in the same order.
    assert_true(equal >= count / 2);
}

TEST_GPU(golden, volumes_all_combinations_cloister) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    session_advance(&studio.session, 90);
    check_combinations(&studio, "main", 160, 90);
    studio_close(&studio);
}

TEST_GPU(golden, volumes_all_combinations_plane_test) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_advance(&studio.session, 30);
    check_combinations(&studio, "main", 161, 91);
    studio_close(&studio);
}

// The eye is put into lights: at a light's centre, so near that the near plane cuts its volume, and
// turned so that many lights are behind.
static void place_camera(Studio *studio, const char *name, Vec3 position, f32 yaw_deg) {
    World *world = studio->session.world;
    Entity camera = world_find(world, name);
    assert_true(camera != ENTITY_NONE);
    TransformTable *t = WORLD_TABLE(world, Transform, transform);
    u32 row = table_row(&t->table, camera);
    assert_true(row != ROW_NONE);
    t->x[row] = position.x, t->y[row] = position.y, t->z[row] = position.z;
    t->pitch[row] = 0.0f, t->yaw[row] = yaw_deg, t->roll[row] = 0.0f;
    table_touch(&t->table, row);
    session_advance(&studio->session, 1);
}

TEST_GPU(golden, volumes_around_the_eye) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_advance(&studio.session, 30);
    const LightTable *light = WORLD_TABLE(studio.session.world, Light, light);
    u32 tried = 0;
    for (u32 row = 0; row < light->table.count && tried < 3; row++) {
        if (light->kind[row] == LIGHT_DIRECTIONAL) continue;
        Vec3 at = vec3(light->x[row], light->y[row], light->z[row]);
        f32 reach = light->reach[row];
        const f32 steps[] = {0.0f, 0.98f, 1.01f};
        Vec3 place = vec3(at.x, at.y, at.z + reach * steps[tried]);
        place_camera(&studio, "main", place, 120.0f * (f32)tried);
        check_combinations(&studio, "main", 96, 54);
        tried++;
    }
    assert_true(tried > 0);
    studio_close(&studio);
}
