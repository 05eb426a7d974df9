// What lies around the cloister: meadow, a ring of hills, far cypresses; and the moon as a model of
// its own, which the level keeps out of shadows and voxels. Stars belong to the renderer's sky.
//
// Data in: fixed seeds. Data out: filled models, origin in the middle of the court. Called through
// the table in model.c. Under the buildings the meadow is a hole, so that no floor fights with it.
#include "models.h"
#include "noise.h"

#define INNER       16.3f // just inside the outer walls' outer faces
#define FAR_HILLS   118.0f
#define LAND_AROUND 48
#define LAND_ACROSS 9

static float hill_height(float angle, float seed) {
    float c = cosf(angle) * 3, d = sinf(angle) * 3;
    float h = noise_value3(c + seed, 3, d + seed, 61) * 0.6f +
              noise_value3(c * 2.3f + seed, 5, d * 2.3f + seed, 62) * 0.3f +
              noise_value3(c * 6 + seed, 7, d * 6 + seed, 63) * 0.1f;
    return h;
}

// Ground from the walls outwards: square inside, round outside, rising into hills.
static Vec3 land_point(float u, float v) {
    float angle = u * 2 * PI_F, c = cosf(angle), d = sinf(angle);
    float square = INNER / fmaxf(fabsf(c), fabsf(d));
    float r = float_lerp(square, FAR_HILLS, v * v);
    float rise = float_smooth(0.35f, 1.0f, v);
    float y = -0.06f + rise * (3 + 20 * hill_height(angle, 11)) +
              float_smooth(0.3f, 0.6f, v) * 2.5f *
                  (noise_value3(r * c * 0.08f + 50, 1, r * d * 0.08f + 50, 64) - 0.4f);
    return vec3(r * c, y, -r * d);
}

static void add_land(Soup *s) {
    const int nu = LAND_AROUND, nv = LAND_ACROSS;
    for (int j = 0; j < nv; j++) {
        soup_use(s, j < 6 ? MAT_MEADOW : MAT_HILL);
        for (int i = 0; i < nu; i++) {
            // A multiple of eight around, so that the square's corners get vertices.
            float u0 = (float)i / (float)nu, u1 = (float)(i + 1) / (float)nu;
            float v0 = (float)j / (float)nv, v1 = (float)(j + 1) / (float)nv;
            soup_quad_box(s, land_point(u0, v0), land_point(u0, v1), land_point(u1, v1),
                          land_point(u1, v0));
        }
    }
}

// A second, lower-detail range in front of the far one: cones of dark trees.
static void add_far_trees(Soup *s) {
    soup_use(s, MAT_HILL);
    for (int i = 0; i < 80; i++) {
        // On the land's own vertices, since between them the land is flat and would let trees
        // float.
        float u = floorf(noise_random((uint32_t)i, 1, 65) * LAND_AROUND) / LAND_AROUND;
        float v = floorf(5 + 3 * noise_random((uint32_t)i, 2, 65)) / LAND_ACROSS;
        Vec3 p = land_point(u, v);
        float h = 4 + 5 * noise_random((uint32_t)i, 3, 65), r = h * 0.13f;
        if (i % 3 == 0) {
            h *= 0.6f;
            r = h * 0.5f;
        }
        Affine place = affine_translation(p.x, p.y - 0.4f, p.z);
        s->transform = place;
        Vec2 crown[3] = {{r * 0.9f, -1}, {r, h * 0.35f}, {0, h}};
        shape_turn(s, crown, 3, 5);
    }
    s->transform = affine_identity();
}

void model_make_surroundings(Model *m) {
    Soup s;
    soup_init(&s);
    add_land(&s);
    add_far_trees(&s);
    model_add_node(m, "land", model_add_mesh(m, "land", &s, 60), vec3(0, 0, 0), 0);
}

// The disc stands where the level's moonlight comes from: yaw -65, pitch -40 degrees.
void model_make_moon(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_MOON);
    float yaw = -65 * PI_F / 180, pitch = 40 * PI_F / 180;
    Vec3 d = vec3(sinf(yaw) * cosf(pitch), sinf(pitch), cosf(yaw) * cosf(pitch));
    shape_ball(&s, vec3_scale(d, 150), vec3(3.4f, 3.4f, 3.4f), 18, 8);
    model_add_soup(m, "moon", &s);
}
