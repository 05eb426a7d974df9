// Things that shine: lanterns, torch, brazier, candles, crystal, firefly; and the closed white
// interior of the light box level.
//
// Data in: constants. Data out: filled models; the light itself is a component that the level adds.
// Each function's comment says where the flame sits. Called through the table in model.c.
#include "models.h"

// A flame is a drop that leans with height.
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
    soup_use(s, MAT_FLAME);
    shape_surface(s, flame_point, &f, segments, rings, vec2(0, 0));
}

// The six-sided cage of both lanterns, centred on the origin, glass 0.11 m in radius.
static void add_lantern(Soup *s) {
    soup_use(s, MAT_LANTERN_GLASS);
    Vec2 glass[2] = {{0.085f, -0.13f}, {0.115f, 0.12f}};
    shape_turn(s, glass, 2, 6);
    soup_use(s, TINT_IRON);
    for (int i = 0; i < 6; i++) {
        float a = (float)i * PI_F / 3;
        shape_tube(s, vec3(0.09f * cosf(a), -0.14f, -0.09f * sinf(a)),
                   vec3(0.122f * cosf(a), 0.12f, -0.122f * sinf(a)), 0.01f, 0.01f, 3, false);
    }
    Vec2 foot[3] = {{0, -0.21f}, {0.1f, -0.155f}, {0.1f, -0.125f}};
    shape_turn(s, foot, 3, 6);
    Vec2 roof[4] = {{0.1f, 0.11f}, {0.15f, 0.12f}, {0.055f, 0.23f}, {0, 0.3f}};
    shape_turn(s, roof, 4, 6);
}

// Post of 2.3 m; the lantern's middle is at y = 2.05.
void model_make_lantern_post(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_STONE);
    shape_taper_box(&s, vec3(-0.2f, 0, -0.2f), vec3(0.2f, 0.22f, 0.2f), 0.05f, 0.05f, SKIP_BOTTOM);
    soup_use(&s, TINT_IRON);
    Vec2 post[7] = {{0.09f, 0.22f},  {0.045f, 0.33f}, {0.035f, 0.9f}, {0.06f, 0.94f},
                    {0.035f, 0.98f}, {0.03f, 1.74f},  {0.06f, 1.86f}};
    soup_smooth(&s, 75);
    shape_turn(&s, post, 7, 6);
    soup_smooth(&s, 0);
    for (int i = 0; i < 4; i++) { // scrolls under the lantern
        float a = (float)i * PI_F / 2 + PI_F / 4;
        shape_tube(&s, vec3(0.03f * cosf(a), 1.62f, 0.03f * sinf(a)),
                   vec3(0.13f * cosf(a), 1.8f, 0.13f * sinf(a)), 0.01f, 0.01f, 3, false);
        shape_tube(&s, vec3(0.13f * cosf(a), 1.8f, 0.13f * sinf(a)),
                   vec3(0.07f * cosf(a), 1.88f, 0.07f * sinf(a)), 0.01f, 0.008f, 3, false);
    }
    s.transform = affine_translation(0, 2.05f, 0);
    add_lantern(&s);
    model_add_soup(m, "lantern_post", &s);
}

// The lantern's middle is the origin; its rod rises to y = 1.15.
void model_make_lantern_hanging(Model *m) {
    Soup s;
    soup_init(&s);
    add_lantern(&s);
    soup_use(&s, TINT_IRON);
    shape_tube(&s, vec3(0, 0.29f, 0), vec3(0, 1.16f, 0), 0.009f, 0.009f, 3, false);
    for (int i = 0; i < 4; i++) shape_octahedron(&s, vec3(0, 0.36f + 0.2f * (float)i, 0), 0.03f);
    model_add_soup(m, "lantern_hanging", &s);
}

// Bracket on a wall at z = 0 that reaches to +z; the flame's middle is at (0, 0.55, 0.2).
void model_make_torch(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_IRON);
    shape_taper_box(&s, vec3(-0.05f, -0.16f, 0), vec3(0.05f, 0.2f, 0.02f), 0.01f, 0,
                    SKIP_BACK | SKIP_BOTTOM);
    shape_tube(&s, vec3(0, -0.08f, 0.01f), vec3(0, -0.02f, 0.13f), 0.015f, 0.015f, 4, false);
    shape_tube(&s, vec3(0, 0.1f, 0.01f), vec3(0, 0.14f, 0.15f), 0.015f, 0.015f, 4, false);
    Affine tilt = affine_turn_x(12);
    tilt.t = vec3(0, 0.05f, 0.128f);
    s.transform = tilt;
    soup_smooth(&s, 65);
    Vec2 ring[3] = {{0.03f, 0.085f}, {0.05f, 0.1f}, {0.03f, 0.115f}};
    shape_turn(&s, ring, 3, 6);
    soup_use(&s, TINT_BARK);
    Vec2 staff[3] = {{0.0f, -0.3f}, {0.018f, -0.28f}, {0.028f, 0.26f}};
    shape_turn(&s, staff, 3, 6);
    soup_use(&s, TINT_IRON);
    Vec2 cup[4] = {{0.028f, 0.24f}, {0.062f, 0.3f}, {0.07f, 0.37f}, {0, 0.35f}};
    shape_turn(&s, cup, 4, 8);
    s.transform = affine_identity();
    add_flame(&s, vec3(0, 0.38f, 0.2f), 0.31f, 0.068f, 6, 5);
    add_flame(&s, vec3(0.03f, 0.4f, 0.225f), 0.18f, 0.04f, 4, 3);
    add_flame(&s, vec3(-0.035f, 0.39f, 0.19f), 0.15f, 0.035f, 4, 3);
    model_add_soup(m, "torch", &s);
}

// Fire bowl on three legs; the flames' middle is at y = 1.05.
void model_make_brazier(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_IRON);
    soup_smooth(&s, 65);
    Vec2 bowl[6] = {{0, 0.58f},     {0.16f, 0.6f},  {0.27f, 0.68f},
                    {0.35f, 0.82f}, {0.31f, 0.82f}, {0.28f, 0.74f}};
    shape_turn(&s, bowl, 6, 10);
    for (int i = 0; i < 3; i++) {
        float a = (float)i * 2 * PI_F / 3;
        Vec3 foot = vec3(0.34f * cosf(a), 0, 0.34f * sinf(a));
        Vec3 knee = vec3(0.15f * cosf(a), 0.36f, 0.15f * sinf(a));
        Vec3 top = vec3(0.27f * cosf(a), 0.7f, 0.27f * sinf(a));
        shape_tube(&s, foot, knee, 0.024f, 0.018f, 4, false);
        shape_tube(&s, knee, top, 0.018f, 0.018f, 4, false);
    }
    Affine ring = affine_translation(0, 0.36f, 0);
    s.transform = ring;
    shape_torus(&s, 0.15f, 0.015f, 9, 3);
    s.transform = affine_identity();
    soup_use(&s, MAT_EMBER);
    Vec2 coals[4] = {{0.29f, 0.75f}, {0.2f, 0.8f}, {0.1f, 0.83f}, {0, 0.84f}};
    shape_turn(&s, coals, 4, 8);
    soup_smooth(&s, 0);
    for (int i = 0; i < 7; i++) {
        float a = (float)i * 2.4f, r = 0.07f * sqrtf((float)i);
        shape_octahedron(&s, vec3(r * cosf(a), 0.82f, r * sinf(a)), 0.06f);
    }
    add_flame(&s, vec3(0, 0.82f, 0), 0.48f, 0.13f, 7, 5);
    add_flame(&s, vec3(0.13f, 0.8f, 0.05f), 0.3f, 0.085f, 5, 4);
    add_flame(&s, vec3(-0.1f, 0.8f, 0.1f), 0.34f, 0.09f, 5, 4);
    add_flame(&s, vec3(-0.04f, 0.8f, -0.14f), 0.27f, 0.08f, 5, 4);
    model_add_soup(m, "brazier", &s);
}

static void add_candle(Soup *s, Vec3 foot, float height, float radius, int wax) {
    Affine saved = s->transform, place = affine_translation(foot.x, foot.y, foot.z);
    s->transform = affine_mul(&saved, &place);
    soup_use(s, wax);
    Vec2 body[3] = {{radius * 1.08f, 0}, {radius * 0.95f, height}, {0, height - 0.004f}};
    shape_turn(s, body, 3, 5);
    add_flame(s, vec3(0, height + 0.002f, 0), 0.055f, 0.013f, 4, 3);
    s->transform = saved;
}

// One candle in a brass dish; the flame is at y = 0.19.
void model_make_candle(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_DISH);
    Vec2 dish[3] = {{0.05f, 0}, {0.075f, 0.018f}, {0, 0.008f}};
    shape_turn(&s, dish, 3, 6);
    add_candle(&s, vec3(0, 0.006f, 0), 0.15f, 0.022f, MAT_WAX);
    model_add_soup(m, "candle", &s);
}

// A stand with seven candles in two rows; the flames' middle is at y = 1.38.
void model_make_candles(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_IRON);
    Vec2 stem[7] = {{0.17f, 0},     {0.16f, 0.03f},  {0.03f, 0.07f}, {0.022f, 0.6f},
                    {0.04f, 0.63f}, {0.022f, 0.66f}, {0.018f, 1.1f}};
    soup_smooth(&s, 70);
    shape_turn(&s, stem, 7, 6);
    soup_smooth(&s, 0);
    for (int i = 0; i < 7; i++) {
        float a = (float)i * PI_F / 3, r = i < 6 ? 0.22f : 0;
        Vec3 top = vec3(r * cosf(a), i < 6 ? 1.16f : 1.24f, r * sinf(a));
        shape_tube(&s, vec3(0, 1.02f, 0), vec3_sub(top, vec3(0, 0.01f, 0)), 0.012f, 0.012f, 3,
                   false);
        Affine place = affine_translation(top.x, top.y, top.z);
        s.transform = place;
        soup_use(&s, TINT_BRASS);
        Vec2 dish[3] = {{0.02f, -0.012f}, {0.045f, 0.012f}, {0, 0.006f}};
        shape_turn(&s, dish, 3, 6);
        s.transform = affine_identity();
        add_candle(&s, top, 0.1f + 0.07f * (float)((i * 5) % 3) / 2, 0.018f, TINT_WAX);
        soup_use(&s, TINT_IRON);
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
        Vec2 shard[3] = {{r * 0.6f, -0.03f}, {r, h * 0.65f}, {0, h}};
        shape_turn(&s, shard, 3, 5);
    }
    model_add_soup(m, "crystal", &s);
}

void model_make_firefly(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_FIREFLY);
    soup_smooth(&s, 120);
    // Tilted, so that it is no diamond or square from the sides that are seen.
    Affine turn = affine_turn_y(20), tip = affine_turn_x(35);
    s.transform = affine_mul(&tip, &turn);
    shape_octahedron(&s, vec3(0, 0, 0), 0.02f);
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
