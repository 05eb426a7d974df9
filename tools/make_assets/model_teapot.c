// The teapot: the curves of Martin Newell's (1975), turned and swept instead of patched.
//
// Data in: Bezier curves in its own units, 2 of them the belly's radius. Data out: a closed-looking
// model 0.8 m high, origin on the ground in the middle, spout towards +x; plain white, so that a
// level paints it. Called through the table in model.c. The inside is not modelled.
#include "models.h"

#define SCALE      0.25f
#define STEPS      8  // of one curve
#define AROUND     48 // segments of the body
#define TUBE_SIDES 16

static Vec2 bezier(const Vec2 p[4], float t) {
    float s = 1 - t, a = s * s * s, b = 3 * s * s * t, c = 3 * s * t * t, d = t * t * t;
    return vec2((a * p[0].x + b * p[1].x + c * p[2].x + d * p[3].x) * SCALE,
                (a * p[0].y + b * p[1].y + c * p[2].y + d * p[3].y) * SCALE);
}

// Curves of (radius, height), each beginning where the one before ends.
static void turn_curves(Soup *s, const Vec2 (*curves)[4], int count) {
    Vec2 profile[4 * STEPS + 1];
    int points = 0;
    profile[points++] = bezier(curves[0], 0);
    for (int i = 0; i < count; i++)
        for (int k = 1; k <= STEPS; k++) profile[points++] = bezier(curves[i], (float)k / STEPS);
    shape_turn(s, profile, points, AROUND);
}

// A tube in the plane z = 0 between two curves; half as wide as `wide` says at its ends.
static void sweep_between(Soup *s, const Vec2 (*upper)[4], const Vec2 (*lower)[4], int count,
                          float wide_first, float wide_last, float side) {
    SweepFrame frames[2 * STEPS + 1];
    int total = count * STEPS;
    for (int i = 0; i <= total; i++) {
        int curve = i == total ? count - 1 : i / STEPS;
        float t = (float)i / STEPS - (float)curve;
        Vec2 a = bezier(upper[curve], t), b = bezier(lower[curve], t);
        float wide = float_lerp(wide_first, wide_last, (float)i / (float)total) * SCALE;
        frames[i] =
            (SweepFrame){vec3((a.x + b.x) / 2, (a.y + b.y) / 2, 0),
                         vec3((a.x - b.x) / 2, (a.y - b.y) / 2, 0), vec3(0, 0, wide * side)};
    }
    Vec2 ring[TUBE_SIDES];
    for (int i = 0; i < TUBE_SIDES; i++) {
        float angle = 2 * PI_F * (float)i / TUBE_SIDES;
        ring[i] = vec2(cosf(angle), sinf(angle));
    }
    shape_sweep(s, frames, total + 1, ring, TUBE_SIDES, true);
}

void model_make_teapot(Model *m) {
    static const Vec2 body[4][4] = {
        {{0, 0}, {1.425f, 0}, {1.5f, 0.075f}, {1.5f, 0.15f}},
        {{1.5f, 0.15f}, {1.5f, 0.225f}, {2, 0.45f}, {2, 0.9f}},
        {{2, 0.9f}, {2, 1.35f}, {1.75f, 1.875f}, {1.5f, 2.4f}},
        {{1.5f, 2.4f}, {1.4375f, 2.53125f}, {1.3375f, 2.53125f}, {1.4f, 2.4f}}};
    static const Vec2 lid[2][4] = {{{1.3f, 2.4f}, {1.3f, 2.4f}, {0.4f, 2.5f}, {0.2f, 2.7f}},
                                   {{0.2f, 2.7f}, {0, 2.85f}, {0.8f, 3.15f}, {0, 3.15f}}};
    static const Vec2 handle_upper[2][4] = {
        {{-1.5f, 2.25f}, {-2.5f, 2.25f}, {-3, 2.25f}, {-3, 1.8f}},
        {{-3, 1.8f}, {-3, 1.35f}, {-2.65f, 0.9375f}, {-1.9f, 0.6f}}};
    static const Vec2 handle_lower[2][4] = {
        {{-1.6f, 2.025f}, {-2.3f, 2.025f}, {-2.7f, 2.025f}, {-2.7f, 1.8f}},
        {{-2.7f, 1.8f}, {-2.7f, 1.575f}, {-2.5f, 1.125f}, {-2, 0.9f}}};
    static const Vec2 spout_upper[1][4] = {
        {{1.7f, 1.425f}, {2.6f, 1.425f}, {2.3f, 2.1f}, {2.7f, 2.4f}}};
    static const Vec2 spout_lower[1][4] = {
        {{1.7f, 0.6f}, {3.1f, 0.825f}, {2.4f, 2.025f}, {3.3f, 2.4f}}};
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_PLASTER_WHITE);
    turn_curves(&s, body, 4);
    turn_curves(&s, lid, 2);
    sweep_between(&s, handle_upper, handle_lower, 2, 0.22f, 0.22f, -1);
    sweep_between(&s, spout_upper, spout_lower, 1, 0.6f, 0.22f, 1);
    model_add_node(m, "teapot", model_add_mesh(m, "teapot", &s, 60), vec3(0, 0, 0), 0);
}
