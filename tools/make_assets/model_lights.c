// Things that shine: lanterns, torch, brazier, candles, crystal, firefly; and the closed white
// interior of the light box level.
//
// Data in: constants. Data out: filled models; the light itself is a component that the level adds.
// Each function's comment says where the flame sits. Called through the table in model.c.
#include "models.h"

// A flame is a drop that leans with height: bright core material below, orange above.
typedef struct Flame {
    Vec3 foot;
    float height, radius, lean;
} Flame;

static Vec3 flame_point(const void *context, float u, float v) {
    const Flame *f = context;
    float angle = u * 2 * PI_F;
    float r = f->radius * sinf(PI_F * powf(v, 0.62f)) * (1 + 0.16f * cosf(3 * angle + 5 * v));
    float sway = f->lean * v * v;
    return vec3(f->foot.x + r * cosf(angle) + sway, f->foot.y + f->height * v,
                f->foot.z - r * sinf(angle) + sway * 0.4f);
}

static void add_flame(Soup *s, Vec3 foot, float height, float radius, int segments, int rings) {
    Flame f = {foot, height, radius, radius * 0.5f};
    uint32_t first = s->triangle_count;
    soup_use(s, MAT_FLAME);
    shape_surface(s, flame_point, &f, segments, rings, vec2(1, 1));
    for (uint32_t t = first; t < s->triangle_count; t++)
        if (s->position[t * 3].y < foot.y + height * 0.42f) s->material[t] = MAT_FLAME_CORE;
}

// The six-sided cage of both lanterns, centred on the origin, glass 0.11 m in radius.
static void add_lantern(Soup *s) {
    soup_use(s, MAT_LANTERN_GLASS);
    Vec2 glass[3] = {{0.085f, -0.13f}, {0.115f, 0.1f}, {0.1f, 0.13f}};
    shape_turn(s, glass, 3, 6);
    soup_use(s, MAT_IRON);
    for (int i = 0; i < 6; i++) {
        float a = (float)i * PI_F / 3;
        shape_tube(s, vec3(0.09f * cosf(a), -0.14f, -0.09f * sinf(a)),
                   vec3(0.122f * cosf(a), 0.12f, -0.122f * sinf(a)), 0.009f, 0.009f, 4, false);
    }
    Vec2 foot[5] = {{0, -0.21f}, {0.02f, -0.2f}, {0.03f, -0.17f}, {0.1f, -0.155f}, {0.1f, -0.13f}};
    shape_turn(s, foot, 5, 6);
    Vec2 lid[2] = {{0.1f, -0.13f}, {0, -0.13f}};
    shape_turn(s, lid, 2, 6);
    Vec2 roof[7] = {{0.0f, 0.11f},   {0.15f, 0.11f},  {0.15f, 0.13f}, {0.09f, 0.2f},
                    {0.045f, 0.23f}, {0.045f, 0.27f}, {0, 0.3f}};
    shape_turn(s, roof, 7, 6);
}

// Post of 2.3 m; the lantern's middle is at y = 2.05.
void model_make_lantern_post(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED_DARK);
    shape_taper_box(&s, vec3(-0.2f, 0, -0.2f), vec3(0.2f, 0.22f, 0.2f), 0.05f, 0.05f, SKIP_BOTTOM);
    soup_use(&s, MAT_IRON);
    Vec2 post[9] = {{0.09f, 0.22f}, {0.09f, 0.28f},  {0.05f, 0.34f},
                    {0.035f, 0.9f}, {0.055f, 0.93f}, {0.035f, 0.97f},
                    {0.03f, 1.74f}, {0.06f, 1.8f},   {0.05f, 1.86f}};
    shape_turn(&s, post, 9, 8);
    for (int i = 0; i < 4; i++) { // scrolls under the lantern
        float a = (float)i * PI_F / 2 + PI_F / 4;
        shape_tube(&s, vec3(0.03f * cosf(a), 1.62f, 0.03f * sinf(a)),
                   vec3(0.13f * cosf(a), 1.8f, 0.13f * sinf(a)), 0.01f, 0.01f, 5, false);
        shape_tube(&s, vec3(0.13f * cosf(a), 1.8f, 0.13f * sinf(a)),
                   vec3(0.07f * cosf(a), 1.88f, 0.07f * sinf(a)), 0.01f, 0.008f, 5, true);
    }
    s.transform = affine_translation(0, 2.05f, 0);
    add_lantern(&s);
    model_add_soup(m, "lantern_post", &s);
}

// The lantern's middle is the origin; its chain rises to y = 1.15.
void model_make_lantern_hanging(Model *m) {
    Soup s;
    soup_init(&s);
    add_lantern(&s);
    soup_use(&s, MAT_IRON);
    for (int i = 0; i < 8; i++) {
        Affine stand = affine_turn_x(90), turn = affine_turn_y(i % 2 ? 90.0f : 0.0f);
        Affine long_link = affine_scaling(0.66f, 1, 1.9f);
        s.transform = affine_mul(&turn, &stand);
        s.transform = affine_mul(&s.transform, &long_link);
        s.transform.t = vec3(0, 0.345f + 0.108f * (float)i, 0);
        shape_torus(&s, 0.034f, 0.008f, 6, 3);
    }
    model_add_soup(m, "lantern_hanging", &s);
}

// Bracket on a wall at z = 0 that reaches to +z; the flame's middle is at (0, 0.55, 0.2).
void model_make_torch(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_IRON);
    shape_taper_box(&s, vec3(-0.05f, -0.16f, 0), vec3(0.05f, 0.2f, 0.02f), 0.01f, 0, SKIP_BACK);
    shape_tube(&s, vec3(0, -0.08f, 0.01f), vec3(0, -0.02f, 0.13f), 0.013f, 0.013f, 6, false);
    shape_tube(&s, vec3(0, 0.1f, 0.01f), vec3(0, 0.14f, 0.15f), 0.013f, 0.013f, 6, false);
    Affine tilt = affine_turn_x(12);
    tilt.t = vec3(0, 0.05f, 0.128f);
    s.transform = tilt;
    Affine ring = affine_translation(0, 0.1f, 0);
    s.transform = affine_mul(&tilt, &ring);
    shape_torus(&s, 0.04f, 0.01f, 10, 5);
    s.transform = tilt;
    soup_use(&s, MAT_BARK);
    Vec2 staff[3] = {{0.0f, -0.3f}, {0.018f, -0.28f}, {0.028f, 0.26f}};
    shape_turn(&s, staff, 3, 8);
    soup_use(&s, MAT_IRON);
    Vec2 cup[5] = {{0.028f, 0.24f}, {0.062f, 0.3f}, {0.07f, 0.37f}, {0.06f, 0.37f}, {0, 0.33f}};
    shape_turn(&s, cup, 5, 10);
    soup_use(&s, MAT_EMBER);
    Vec2 coals[3] = {{0.058f, 0.36f}, {0.04f, 0.385f}, {0, 0.39f}};
    shape_turn(&s, coals, 3, 8);
    s.transform = affine_identity();
    add_flame(&s, vec3(0, 0.39f, 0.2f), 0.3f, 0.068f, 9, 7);
    add_flame(&s, vec3(0.03f, 0.41f, 0.225f), 0.17f, 0.04f, 7, 5);
    add_flame(&s, vec3(-0.035f, 0.4f, 0.19f), 0.14f, 0.035f, 7, 5);
    model_add_soup(m, "torch", &s);
}

// Fire bowl on three legs; the flames' middle is at y = 1.05.
void model_make_brazier(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_IRON);
    Vec2 bowl[7] = {{0, 0.58f},     {0.16f, 0.6f},  {0.27f, 0.68f}, {0.32f, 0.8f},
                    {0.35f, 0.82f}, {0.31f, 0.82f}, {0.28f, 0.72f}};
    shape_turn(&s, bowl, 7, 14);
    for (int i = 0; i < 3; i++) {
        float a = (float)i * 2 * PI_F / 3;
        Vec3 foot = vec3(0.34f * cosf(a), 0, 0.34f * sinf(a));
        Vec3 knee = vec3(0.15f * cosf(a), 0.36f, 0.15f * sinf(a));
        Vec3 top = vec3(0.27f * cosf(a), 0.7f, 0.27f * sinf(a));
        shape_tube(&s, foot, knee, 0.022f, 0.018f, 6, true);
        shape_tube(&s, knee, top, 0.018f, 0.018f, 6, false);
        shape_ball(&s, vec3(foot.x, 0.025f, foot.z), vec3(0.04f, 0.025f, 0.04f), 8, 4);
    }
    Affine ring = affine_translation(0, 0.36f, 0);
    s.transform = ring;
    shape_torus(&s, 0.15f, 0.013f, 14, 5);
    s.transform = affine_identity();
    soup_use(&s, MAT_EMBER);
    Vec2 coals[4] = {{0.29f, 0.75f}, {0.2f, 0.8f}, {0.1f, 0.83f}, {0, 0.84f}};
    shape_turn(&s, coals, 4, 9);
    for (int i = 0; i < 7; i++) {
        float a = (float)i * 2.4f, r = 0.07f * sqrtf((float)i);
        shape_icosahedron(&s, vec3(r * cosf(a), 0.82f, r * sinf(a)), 0.055f);
    }
    add_flame(&s, vec3(0, 0.82f, 0), 0.48f, 0.13f, 10, 7);
    add_flame(&s, vec3(0.13f, 0.8f, 0.05f), 0.3f, 0.085f, 8, 6);
    add_flame(&s, vec3(-0.1f, 0.8f, 0.1f), 0.34f, 0.09f, 8, 6);
    add_flame(&s, vec3(-0.04f, 0.8f, -0.14f), 0.27f, 0.08f, 8, 6);
    model_add_soup(m, "brazier", &s);
}

static void add_candle(Soup *s, Vec3 foot, float height, float radius) {
    Affine saved = s->transform, place = affine_translation(foot.x, foot.y, foot.z);
    s->transform = affine_mul(&saved, &place);
    soup_use(s, MAT_WAX);
    Vec2 wax[5] = {{radius * 1.1f, 0},
                   {radius, 0.02f},
                   {radius * 0.95f, height - 0.012f},
                   {radius * 0.7f, height},
                   {0, height - 0.008f}};
    shape_turn(s, wax, 5, 8);
    add_flame(s, vec3(0, height + 0.006f, 0), 0.05f, 0.011f, 6, 4);
    s->transform = saved;
}

// One candle in a brass dish; the flame is at y = 0.19.
void model_make_candle(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_BRASS);
    Vec2 dish[6] = {{0, 0},          {0.06f, 0.002f}, {0.075f, 0.016f},
                    {0.07f, 0.016f}, {0.05f, 0.008f}, {0, 0.008f}};
    shape_turn(&s, dish, 6, 9);
    add_candle(&s, vec3(0, 0.006f, 0), 0.15f, 0.022f);
    model_add_soup(m, "candle", &s);
}

// A stand with seven candles in two rows; the flames' middle is at y = 1.38.
void model_make_candles(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_IRON);
    Vec2 stem[7] = {{0.17f, 0},     {0.16f, 0.03f},  {0.03f, 0.07f}, {0.022f, 0.6f},
                    {0.04f, 0.63f}, {0.022f, 0.66f}, {0.018f, 1.1f}};
    shape_turn(&s, stem, 7, 9);
    for (int i = 0; i < 7; i++) {
        float a = (float)i * PI_F / 3, r = i < 6 ? 0.22f : 0;
        Vec3 top = vec3(r * cosf(a), i < 6 ? 1.16f : 1.24f, r * sinf(a));
        shape_tube(&s, vec3(0, 1.02f, 0), vec3_sub(top, vec3(0, 0.01f, 0)), 0.011f, 0.011f, 5,
                   false);
        Affine place = affine_translation(top.x, top.y, top.z);
        s.transform = place;
        soup_use(&s, MAT_BRASS);
        Vec2 dish[4] = {{0, -0.012f}, {0.036f, 0}, {0.045f, 0.012f}, {0, 0.006f}};
        shape_turn(&s, dish, 4, 8);
        s.transform = affine_identity();
        add_candle(&s, top, 0.1f + 0.07f * (float)((i * 5) % 3) / 2, 0.018f);
        soup_use(&s, MAT_IRON);
    }
    model_add_soup(m, "candles", &s);
}

// A cluster of glowing crystals, 0.6 m high.
void model_make_crystal(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CRYSTAL);
    for (int i = 0; i < 6; i++) {
        float a = (float)i * 2.4f, lean = i ? 24.0f + 5.0f * (float)(i % 3) : 4.0f;
        float h = i ? 0.24f + 0.06f * (float)(i % 4) : 0.6f, r = i ? 0.045f : 0.075f;
        Affine turn = affine_turn_y(a * 57.29578f), tilt = affine_turn_x(lean);
        s.transform = affine_mul(&turn, &tilt);
        Vec2 shard[4] = {{r * 0.6f, -0.03f}, {r, h * 0.62f}, {r * 0.8f, h * 0.72f}, {0, h}};
        shape_turn(&s, shard, 4, 6);
    }
    model_add_soup(m, "crystal", &s);
}

void model_make_firefly(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_FIREFLY);
    shape_icosahedron(&s, vec3(0, 0, 0), 0.02f);
    model_add_soup(m, "firefly", &s);
}

// A smooth room seen from inside: a rounded box of 8 m by 4 m by 8 m on the ground, no edge
// anywhere, so that every change of light on it comes from the lights.
static Vec3 light_box_point(const void *context, float u, float v) {
    (void)context;
    float angle = -u * 2 * PI_F, lat = (v - 0.5f) * PI_F;
    float c = cosf(lat), d[3] = {c * cosf(angle), sinf(lat), -c * sinf(angle)};
    float norm = 0;
    for (int k = 0; k < 3; k++) norm += powf(fabsf(d[k]), 5);
    norm = powf(norm, -1.0f / 5);
    return vec3(4 * d[0] * norm, 2 + 2 * d[1] * norm, 4 * d[2] * norm);
}

void model_make_light_box(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_PLASTER_WHITE);
    shape_surface(&s, light_box_point, NULL, 64, 40, vec2(8, 4));
    model_add_node(m, "light_box", model_add_mesh(m, "light_box", &s, 75), vec3(0, 0, 0), 0);
}
