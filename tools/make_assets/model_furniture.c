// Furniture of court and walk: bench, urn with a fern, statue, door leaf.
//
// Data in: constants. Data out: filled models, origin on the ground (door leaf: at the hinge).
// Called through the table in model.c.
#include "carving.h"
#include "models.h"
#include "noise.h"

void model_make_bench(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED);
    shape_taper_box(&s, vec3(-0.8f, 0.4f, -0.22f), vec3(0.8f, 0.49f, 0.22f), 0.015f, 0.015f, 0);
    for (int side = -1; side <= 1; side += 2) {
        // Each leg is a scroll in outline, extruded over the bench's depth.
        static const Vec2 OUTLINE[9] = {{0.1f, 0},       {0.1f, 0.06f},  {0.05f, 0.1f},
                                        {0.045f, 0.22f}, {0.09f, 0.32f}, {0.14f, 0.36f},
                                        {0.14f, 0.4f},   {-0.1f, 0.4f},  {-0.1f, 0}};
        float x = 0.55f * (float)side;
        SweepFrame frames[2] = {{vec3(x, 0, -0.18f), vec3((float)side, 0, 0), vec3(0, 1, 0)},
                                {vec3(x, 0, 0.18f), vec3((float)side, 0, 0), vec3(0, 1, 0)}};
        if (side < 0) {
            SweepFrame swap = frames[0];
            frames[0] = frames[1];
            frames[1] = swap;
        }
        shape_sweep(&s, frames, 2, OUTLINE, 9, true);
        for (int end = 0; end < 2; end++) {
            float z = end ? 0.18f : -0.18f;
            for (int j = 1; j + 1 < 8; j++) {
                Vec3 a = vec3(x - 0.1f * (float)side, 0, z);
                Vec3 b = vec3(x + OUTLINE[j - 1].x * (float)side, OUTLINE[j - 1].y, z);
                Vec3 c = vec3(x + OUTLINE[j].x * (float)side, OUTLINE[j].y, z);
                bool flip = (end == 1) == (side < 0);
                if (flip)
                    soup_triangle_box(&s, a, c, b);
                else
                    soup_triangle_box(&s, a, b, c);
            }
            Vec3 a = vec3(x - 0.1f * (float)side, 0, z);
            Vec3 b = vec3(x + 0.14f * (float)side, 0.4f, z);
            Vec3 c = vec3(x - 0.1f * (float)side, 0.4f, z);
            if ((end == 1) == (side < 0))
                soup_triangle_box(&s, a, c, b);
            else
                soup_triangle_box(&s, a, b, c);
        }
    }
    model_add_soup(m, "bench", &s);
}

void model_make_urn(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED);
    shape_taper_box(&s, vec3(-0.22f, 0, -0.22f), vec3(0.22f, 0.1f, 0.22f), 0.02f, 0.02f,
                    SKIP_BOTTOM);
    Vec2 urn[9] = {{0.18f, 0.1f},  {0.08f, 0.18f}, {0.08f, 0.23f}, {0.2f, 0.33f}, {0.28f, 0.5f},
                   {0.25f, 0.62f}, {0.32f, 0.69f}, {0.32f, 0.72f}, {0, 0.7f}};
    soup_smooth(&s, 62);
    shape_turn(&s, urn, 9, 10);
    soup_smooth(&s, 0);
    soup_use(&s, MAT_LEAF_FERN);
    uint32_t first = s.triangle_count;
    for (int i = 0; i < 7; i++) {
        float a = (float)i * 2 * PI_F / 7, lean = i % 2 ? 0.62f : 0.3f;
        Vec3 out = vec3(cosf(a), 0, sinf(a)), right = vec3(-out.z, 0, out.x);
        Vec3 up = vec3_normalize(vec3_add(vec3(0, 1, 0), vec3_scale(out, lean)));
        float size = 0.34f;
        Vec3 c = vec3_add(vec3(0, 0.66f, 0), vec3_scale(up, size * 0.95f));
        shape_card(&s, c, vec3_scale(right, size), vec3_scale(up, size));
    }
    soup_set_crown_normals(&s, first, vec3(0, 0.6f, 0), 0.3f);
    model_add_soup(m, "urn", &s);
}

// ---- statue -------------------------------------------------------------------------------------

// A robed figure: folds run down from the girdle and widen; the cloak is open in front (+z).
static Vec3 robe_point(const void *context, float u, float v) {
    (void)context;
    static const Vec2 BODY[9] = {{0.36f, 0},     {0.335f, 0.25f}, {0.28f, 0.6f},
                                 {0.235f, 0.9f}, {0.23f, 1.05f},  {0.265f, 1.25f},
                                 {0.27f, 1.38f}, {0.17f, 1.5f},   {0.09f, 1.56f}};
    float at = v * 8, angle = u * 2 * PI_F;
    int i = at >= 8 ? 7 : (int)at;
    float f = at - (float)i;
    float r = float_lerp(BODY[i].x, BODY[i + 1].x, f), y = float_lerp(BODY[i].y, BODY[i + 1].y, f);
    float fold = cosf(angle * 9 + 1.2f * sinf(y * 3) + angle) * 0.5f;
    fold += cosf(angle * 5 - y * 1.4f) * 0.5f;
    float below = 1 - float_smooth(0.75f, 1.35f, y);
    r *= 1 + 0.13f * fold * below + 0.04f * fold * (1 - below) * (1 - v);
    float flat = y > 1.0f ? float_smooth(1.0f, 1.35f, y) : 0; // shoulders are wide, not deep
    return vec3(r * cosf(angle) * (1 + 0.12f * flat), y, -r * sinf(angle) * (1 - 0.3f * flat));
}

static Vec3 hood_point(const void *context, float u, float v) {
    (void)context;
    float angle = (0.06f + 0.88f * u) * 2 * PI_F - PI_F / 2, lat = -0.9f + 2.4f * v;
    float r = 0.155f + 0.03f * sinf(v * PI_F);
    float pull = 0.05f * (1 - v) * (1 - v);
    return vec3((r + pull) * cosf(angle) * cosf(lat), 1.70f + (r + 0.04f) * sinf(lat),
                -(r + pull) * sinf(angle) * cosf(lat) - 0.02f);
}

void model_make_statue(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED);
    shape_taper_box(&s, vec3(-0.5f, 0, -0.5f), vec3(0.5f, 0.16f, 0.5f), 0.03f, 0.03f, SKIP_BOTTOM);
    shape_post(&s, vec3(-0.38f, 0.16f, -0.38f), vec3(0.38f, 0.78f, 0.38f), 0.04f, true);
    shape_taper_box(&s, vec3(-0.4f, 0.74f, -0.4f), vec3(0.4f, 0.84f, 0.4f), -0.05f, -0.05f, 0);
    shape_taper_box(&s, vec3(-0.46f, 0.84f, -0.46f), vec3(0.46f, 0.9f, 0.46f), 0.02f, 0.02f, 0);
    for (int i = 0; i < 4; i++) {
        s.transform = affine_turn_y(90.0f * (float)i);
        carve_rosette(&s, vec3(0, 0.46f, 0.38f), 0.2f, 0.05f, 6, 1);
    }
    soup_use(&s, MAT_MARBLE);
    s.transform = affine_translation(0, 0.9f, 0);
    soup_carve(&s, 60);
    shape_surface(&s, robe_point, NULL, 36, 12, vec2(2, 2));
    shape_ball(&s, vec3(0, 1.7f, 0.01f), vec3(0.105f, 0.145f, 0.125f), 10, 6);
    shape_ball(&s, vec3(0, 1.685f, 0.125f), vec3(0.018f, 0.036f, 0.026f), 4, 3);
    shape_surface(&s, hood_point, NULL, 12, 6, vec2(1, 0.6f));
    for (int side = -1; side <= 1; side += 2) {
        float k = (float)side;
        // Sleeves meet in front of the breast and hold a bowl of light.
        shape_tube(&s, vec3(0.27f * k, 1.36f, 0.0f), vec3(0.31f * k, 1.08f, 0.1f), 0.075f, 0.085f,
                   7, true);
        shape_ball(&s, vec3(0.31f * k, 1.08f, 0.1f), vec3(0.088f, 0.088f, 0.088f), 7, 4);
        shape_tube(&s, vec3(0.31f * k, 1.07f, 0.1f), vec3(0.08f * k, 1.12f, 0.31f), 0.08f, 0.1f, 7,
                   true);
        shape_tube(&s, vec3(0.09f * k, 1.115f, 0.3f), vec3(0.03f * k, 1.14f, 0.36f), 0.04f, 0.03f,
                   5, true);
    }
    Vec2 bowl[6] = {{0.03f, 1.13f}, {0.08f, 1.15f}, {0.115f, 1.2f},
                    {0.12f, 1.24f}, {0.1f, 1.24f},  {0, 1.2f}};
    Affine saved = s.transform, place = affine_translation(0, 0, 0.37f);
    s.transform = affine_mul(&saved, &place);
    shape_turn(&s, bowl, 6, 9);
    soup_smooth(&s, 0);
    soup_use(&s, MAT_CRYSTAL);
    shape_octahedron(&s, vec3(0, 1.27f, 0), 0.075f);
    model_add_soup(m, "statue", &s);
}

// ---- door leaf ----------------------------------------------------------------------------------

// A pyramid's head on a strap's face.
static void add_nail(Soup *s, float x, float y, float face) {
    const float r = 0.02f, z = 0.052f * face;
    const Vec3 tip = vec3(x, y, 0.068f * face);
    for (int i = 0; i < 4; i++) {
        float a = (float)i * PI_F / 2, b = a + face * PI_F / 2;
        soup_triangle_box(s, vec3(x + r * cosf(a), y + r * sinf(a), z),
                          vec3(x + r * cosf(b), y + r * sinf(b), z), tip);
    }
}

// Iron strap with a forked end, on both faces of the leaf.
static void add_strap(Soup *s, float y) {
    for (int face = -1; face <= 1; face += 2) {
        float z0 = face > 0 ? 0.04f : -0.052f, z1 = face > 0 ? 0.052f : -0.04f;
        unsigned inside = face > 0 ? SKIP_BACK : SKIP_FRONT;
        shape_box(s, vec3(0.0f, y - 0.045f, z0), vec3(0.86f, y + 0.045f, z1), inside);
        for (int k = -1; k <= 1; k += 2) {
            Affine saved = s->transform, place = affine_turn_z(34.0f * (float)k);
            place.t = vec3(0.83f, y, 0);
            s->transform = affine_mul(&saved, &place);
            shape_box(s, vec3(0, -0.028f, z0), vec3(0.25f, 0.028f, z1), inside | SKIP_LEFT);
            s->transform = saved;
        }
        for (int i = 0; i < 4; i++) add_nail(s, 0.1f + 0.22f * (float)i, y, (float)face);
    }
}

void model_make_door_leaf(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_WOOD);
    // Five planks, each a little deeper or shallower than its neighbour.
    for (int i = 0; i < 5; i++) {
        float x0 = 0.006f + 0.2384f * (float)i, x1 = x0 + 0.2344f;
        float d = 0.036f + 0.004f * noise_random((uint32_t)i, 1, 51);
        shape_box(&s, vec3(x0, 0.012f, -d), vec3(x1, 2.79f, d), SKIP_BOTTOM | SKIP_TOP);
    }
    soup_use(&s, MAT_IRON);
    add_strap(&s, 0.42f);
    add_strap(&s, 1.4f);
    add_strap(&s, 2.38f);
    shape_tube(&s, vec3(0, 0.05f, 0), vec3(0, 2.75f, 0), 0.032f, 0.032f, 6, false);
    // Ring handles near the closing edge.
    for (int face = -1; face <= 1; face += 2) {
        Affine saved = s.transform, place = affine_turn_x(90);
        place.t = vec3(1.06f, 1.08f, 0.062f * (float)face);
        s.transform = affine_mul(&saved, &place);
        shape_torus(&s, 0.075f, 0.014f, 10, 3);
        s.transform = saved;
        shape_ball(&s, vec3(1.06f, 1.16f, 0.055f * (float)face), vec3(0.035f, 0.035f, 0.025f), 6,
                   3);
    }
    model_add_soup(m, "door_leaf", &s);
}
