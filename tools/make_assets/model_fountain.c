// The fountain: octagonal steps and basin, a carved pedestal, a lobed bowl, a finial, water.
//
// Data in: constants. Data out: a filled model, origin on the ground in the middle, about 2.6 m
// high. Called through the table in model.c. Ripples are a normal map; nothing moves here.
#include "carving.h"
#include "models.h"

// Octagons are lathes of eight segments; turned by half a segment, flat sides face the paths.
static void turn_octagon(Soup *s, const Vec2 *profile, int count) {
    shape_lathe(s, profile, count, 8, 22.5f, 360);
}

static void add_basin(Soup *s) {
    soup_use(s, MAT_CARVED_DARK);
    Vec2 steps[5] = {{3.0f, 0}, {2.98f, 0.14f}, {2.6f, 0.15f}, {2.58f, 0.29f}, {2.1f, 0.3f}};
    turn_octagon(s, steps, 5);
    soup_use(s, MAT_CARVED);
    Vec2 wall[10] = {{2.32f, 0.3f},  {2.32f, 0.36f}, {2.17f, 0.45f}, {2.17f, 0.79f}, {2.33f, 0.86f},
                     {2.34f, 0.92f}, {2.31f, 0.95f}, {1.98f, 0.95f}, {1.95f, 0.9f},  {1.88f, 0.7f}};
    turn_octagon(s, wall, 10);
    // Each side carries a rosette between two colonnettes at the corners.
    Affine saved = s->transform;
    for (int i = 0; i < 8; i++) {
        Affine turn = affine_turn_y(45.0f * (float)i);
        s->transform = affine_mul(&saved, &turn);
        float side = 2.17f * cosf(PI_F / 8);
        carve_rosette(s, vec3(0, 0.62f, side), 0.16f, 0.045f, 6, 1);
        for (int k = -1; k <= 1; k += 2)
            carve_rosette(s, vec3(0.46f * (float)k, 0.62f, side), 0.1f, 0.035f, 5, 1);
        Affine corner = affine_turn_y(45.0f * (float)i + 22.5f);
        s->transform = affine_mul(&saved, &corner);
        Vec2 shaft[4] = {{0.1f, 0.36f}, {0.065f, 0.48f}, {0.065f, 0.74f}, {0.1f, 0.86f}};
        Affine out = affine_translation(0, 0, 2.16f), here = s->transform;
        s->transform = affine_mul(&here, &out);
        soup_smooth(s, 70);
        shape_lathe(s, shaft, 4, 4, 180, 180);
        soup_smooth(s, 0);
    }
    s->transform = saved;
}

typedef struct Bowl {
    float inner;
} Bowl;

// Lobed like a shell; the same function makes outside (0) and inside (1).
static Vec3 bowl_point(const void *context, float u, float v) {
    const Bowl *b = context;
    float angle = u * 2 * PI_F * (b->inner > 0 ? -1 : 1);
    float r = 0.16f + 0.80f * sinf(v * PI_F / 2), lobe = fabsf(cosf(6 * angle));
    r *= 1 + 0.07f * (lobe - 0.5f) * v;
    float y = 1.52f + 0.34f * powf(v, 2.2f) + 0.02f * lobe * v;
    if (b->inner > 0) {
        r -= 0.05f;
        y += 0.03f * (1 - v);
    }
    return vec3(r * cosf(angle), y, -r * sinf(angle));
}

// Twice the lobes, so that each has its ridge and its valley.
#define BOWL_EDGES 24

static void add_tower(Soup *s) {
    soup_use(s, MAT_CARVED);
    Vec2 foot[6] = {{0.62f, 0.7f},  {0.56f, 0.74f}, {0.42f, 0.78f},
                    {0.31f, 0.88f}, {0.3f, 0.94f},  {0.2f, 1.0f}};
    turn_octagon(s, foot, 6);
    carve_column(s, vec3(0, 0.98f, 0), 1.56f, 0.17f, 0.4f);
    Bowl outside = {0}, inside = {1};
    soup_smooth(s, 50);
    shape_surface(s, bowl_point, &outside, BOWL_EDGES, 4, vec2(5, 1));
    // The rim joins the two shells; the inner one reaches below the water, no further.
    for (int i = 0; i < BOWL_EDGES; i++) {
        float u0 = (float)i / BOWL_EDGES, u1 = (float)(i + 1) / BOWL_EDGES;
        soup_quad_box(s, bowl_point(&outside, u0, 1), bowl_point(&outside, u1, 1),
                      bowl_point(&inside, 1 - u1, 1), bowl_point(&inside, 1 - u0, 1));
        soup_quad_box(s, bowl_point(&inside, 1 - u0, 1), bowl_point(&inside, 1 - u1, 1),
                      bowl_point(&inside, 1 - u1, 0.7f), bowl_point(&inside, 1 - u0, 0.7f));
    }
    Vec2 stem[8] = {{0.2f, 1.8f},   {0.2f, 1.9f},   {0.12f, 1.96f}, {0.09f, 2.04f},
                    {0.14f, 2.12f}, {0.07f, 2.18f}, {0.06f, 2.24f}, {0.1f, 2.28f}};
    soup_smooth(s, 60);
    shape_turn(s, stem, 8, 10);
    carve_bud(s, 2.28f, 2.52f, 0.05f, 0.1f);
    soup_smooth(s, 60);
    Vec2 cone[5] = {{0.1f, 2.5f}, {0.15f, 2.58f}, {0.12f, 2.7f}, {0.05f, 2.8f}, {0, 2.83f}};
    shape_turn(s, cone, 5, 8);
    soup_smooth(s, 0);
}

static void add_disc(Soup *s, float radius, float y, int segments, float start_deg) {
    for (int i = 0; i < segments; i++) {
        float a0 = (start_deg + 360.0f * (float)i / (float)segments) * PI_F / 180;
        float a1 = (start_deg + 360.0f * (float)(i + 1) / (float)segments) * PI_F / 180;
        soup_triangle_box(s, vec3(0, y, 0), vec3(radius * cosf(a0), y, -radius * sinf(a0)),
                          vec3(radius * cosf(a1), y, -radius * sinf(a1)));
    }
}

static void add_water(Soup *s) {
    soup_use(s, MAT_WATER);
    add_disc(s, 1.95f, 0.76f, 8, 22.5f);
    add_disc(s, 0.9f, 1.84f, 12, 0);
    soup_use(s, MAT_SPRAY);
    // Thin threads fall from the bowl's rim between the lobes.
    for (int i = 0; i < 6; i++) {
        float a = ((float)i + 0.25f) * PI_F / 3, r = 0.97f, y = 1.845f;
        for (int k = 0; k < 5; k++) {
            float t0 = (float)k / 5 * 0.46f, t1 = (float)(k + 1) / 5 * 0.46f;
            float r0 = r + 0.5f * t0, r1 = r + 0.5f * t1;
            Vec3 from = vec3(r0 * cosf(a), y - 5.0f * t0 * t0, r0 * sinf(a));
            Vec3 to = vec3(r1 * cosf(a), y - 5.0f * t1 * t1, r1 * sinf(a));
            shape_tube(s, to, from, 0.007f, k == 0 ? 0.013f : 0.008f, 3, false);
        }
    }
}

void model_make_fountain(Model *m) {
    Soup s;
    soup_init(&s);
    add_basin(&s);
    add_tower(&s);
    add_water(&s);
    model_add_soup(m, "fountain", &s);
}
