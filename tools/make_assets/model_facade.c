// The church behind one side of the walk: a gabled front with a rose window and a bell tower.
//
// Data in: measures of walk.h; the front stands at z = 4.6 of that side's middle and shows above
// the walk's roof. Data out: one model. Called through the table in model.c. Nobody enters it, so
// it has no inside; belfry and glass glow.
#include "carving.h"
#include "models.h"
#include "walk.h"

#define FRONT      WALK_WALL_BACK
#define HALF_WIDTH 5.0f
#define EAVES      10.2f
#define RIDGE      14.6f
#define DEPTH      15.0f
#define ROSE_Y     9.3f
#define ROSE_R     2.15f
#define TOWER_X    7.3f
#define TOWER_HALF 2.2f
#define TOWER_TOP  17.2f

// Front wall with a round hole: a ring of quads from the circle to the outline.
static void add_front(Soup *s) {
    enum { STEPS = 32 };
    soup_use(s, MAT_ASHLAR);
    Vec3 rim[STEPS + 1], edge[STEPS + 1];
    for (int i = 0; i <= STEPS; i++) {
        float a = 2 * PI_F * (float)i / STEPS, c = cosf(a), d = sinf(a);
        rim[i] = vec3(ROSE_R * c, ROSE_Y + ROSE_R * d, FRONT);
        // Where the ray leaves the gabled outline between y = 5 and the ridge.
        float t = HALF_WIDTH / fmaxf(fabsf(c), 1e-5f);
        if (d < 0) t = fminf(t, (ROSE_Y - 5) / -d);
        float k = (RIDGE - EAVES) / HALF_WIDTH, lean = d + fabsf(c) * k;
        if (lean > 0) t = fminf(t, (RIDGE - ROSE_Y) / lean);
        edge[i] = vec3(t * c, ROSE_Y + t * d, FRONT);
    }
    for (int i = 0; i < STEPS; i++) soup_quad_box(s, rim[i], rim[i + 1], edge[i + 1], edge[i]);
}

static void add_rose(Soup *s) {
    Affine saved = s->transform, place = affine_turn_x(-90);
    place.t = vec3(0, ROSE_Y, FRONT);
    // Lathe around the window's axis: y of the lathe points to -z, out of the wall.
    s->transform = affine_mul(&saved, &place);
    soup_use(s, MAT_CARVED);
    soup_smooth(s, 60);
    Vec2 frame[5] = {{ROSE_R + 0.34f, -0.02f},
                     {ROSE_R + 0.3f, 0.15f},
                     {ROSE_R + 0.05f, 0.1f},
                     {ROSE_R - 0.16f, -0.04f},
                     {ROSE_R - 0.18f, -0.36f}};
    shape_turn(s, frame, 5, 32);
    for (int ring = 0; ring < 2; ring++) {
        float r = ROSE_R * (ring ? 0.72f : 0.2f), w = ring ? 0.06f : 0.075f;
        Vec2 band[3] = {{r + w, -0.32f}, {r, -0.14f}, {r - w, -0.32f}};
        shape_turn(s, band, 3, ring ? 24 : 12);
    }
    s->transform = saved;
    for (int i = 0; i < 12; i++) { // spokes and the small circles between their heads
        float a = 2 * PI_F * (float)i / 12, c = cosf(a), d = sinf(a);
        Vec3 from = vec3(0.2f * ROSE_R * c, ROSE_Y + 0.2f * ROSE_R * d, FRONT + 0.25f);
        Vec3 to = vec3(0.72f * ROSE_R * c, ROSE_Y + 0.72f * ROSE_R * d, FRONT + 0.25f);
        shape_tube(s, from, to, 0.045f, 0.06f, 4, false);
        for (int k = 0; k < 2; k++) {
            float b = a + (k ? 0.13f : 0.39f);
            Affine ring = affine_turn_x(-90);
            ring.t =
                vec3(0.85f * ROSE_R * cosf(b), ROSE_Y + 0.85f * ROSE_R * sinf(b), FRONT + 0.26f);
            s->transform = affine_mul(&saved, &ring);
            static const Vec2 RIM[3] = {{0.265f, -0.06f}, {0.21f, 0.05f}, {0.155f, -0.06f}};
            shape_turn(s, RIM, 3, 6);
            s->transform = saved;
        }
    }
    soup_smooth(s, 0);
    soup_use(s, MAT_GLASS_ROSE);
    float r = ROSE_R, z = FRONT + 0.32f;
    soup_quad(s, vec3(r, ROSE_Y - r, z), vec3(-r, ROSE_Y - r, z), vec3(-r, ROSE_Y + r, z),
              vec3(r, ROSE_Y + r, z), vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1));
}

// A row of blind arches under the rose: colonnettes in front of a plate.
static void add_gallery(Soup *s) {
    Arch arch = {0.36f, 6.15f, 0.4f};
    static const Vec2 RING[3] = {{0.0f, FRONT}, {0.0f, FRONT - 0.14f}, {0.09f, FRONT - 0.15f}};
    Affine saved = s->transform;
    for (int i = 0; i < 9; i++) {
        Affine place = affine_translation(-3.6f + 0.9f * (float)i, 0, 0);
        s->transform = affine_mul(&saved, &place);
        soup_use(s, MAT_CARVED);
        shape_arch_moulding(s, &arch, RING, 3, 6, 0, -1);
        soup_use(s, MAT_ASHLAR);
        shape_spandrel(s, &arch, 0.06f, -0.45f, 0.45f, 6.15f, 6.75f, FRONT - 0.1f, -1, 6);
        s->transform = saved;
    }
    soup_use(s, MAT_CARVED);
    for (int i = 0; i < 10; i++) {
        Vec2 shaft[4] = {{0.085f, 5.3f}, {0.055f, 5.45f}, {0.05f, 5.92f}, {0.095f, 6.15f}};
        Affine place = affine_translation(-4.05f + 0.9f * (float)i, 0, FRONT - 0.08f);
        s->transform = affine_mul(&saved, &place);
        soup_smooth(s, 70);
        shape_lathe(s, shaft, 4, 4, 0, 180);
        soup_smooth(s, 0);
        s->transform = saved;
    }
    shape_box(s, vec3(-4.3f, 5.15f, FRONT - 0.22f), vec3(4.3f, 5.3f, FRONT), SKIP_FRONT);
    shape_box(s, vec3(-4.3f, 6.74f, FRONT - 0.18f), vec3(4.3f, 6.88f, FRONT), SKIP_FRONT);
}

static void add_nave(Soup *s) {
    float back = FRONT + DEPTH, w = HALF_WIDTH;
    soup_use(s, TINT_ASHLAR_DARK);
    soup_quad_box(s, vec3(w, 0, FRONT), vec3(-w, 0, FRONT), vec3(-w, 5, FRONT), vec3(w, 5, FRONT));
    soup_quad_box(s, vec3(w, 0, back), vec3(w, 0, FRONT), vec3(w, EAVES, FRONT),
                  vec3(w, EAVES, back));
    soup_quad_box(s, vec3(-w, 0, FRONT), vec3(-w, 0, back), vec3(-w, EAVES, back),
                  vec3(-w, EAVES, FRONT));
    soup_quad_box(s, vec3(-w, 0, back), vec3(w, 0, back), vec3(w, EAVES, back),
                  vec3(-w, EAVES, back));
    soup_triangle_box(s, vec3(-w, EAVES, back), vec3(w, EAVES, back), vec3(0, RIDGE, back));
    for (int side = -1; side <= 1; side += 2) {
        float k = (float)side;
        // Buttresses end in pinnacles at the front's corners.
        shape_taper_box(s, vec3(k * w - 0.55f, 0, FRONT - 0.5f),
                        vec3(k * w + 0.55f, EAVES, FRONT + 0.5f), 0.1f, 0.1f, SKIP_BOTTOM);
        soup_use(s, MAT_CARVED);
        Affine saved = s->transform, place = affine_translation(k * w, 0, FRONT);
        s->transform = affine_mul(&saved, &place);
        shape_box(s, vec3(-0.52f, EAVES, -0.52f), vec3(0.52f, EAVES + 0.16f, 0.52f), 0);
        Vec2 spire[6] = {{0.36f, EAVES + 0.16f}, {0.36f, EAVES + 0.9f},  {0.46f, EAVES + 1.05f},
                         {0.1f, EAVES + 2.7f},   {0.17f, EAVES + 2.82f}, {0, EAVES + 3.1f}};
        shape_turn(s, spire, 6, 6);
        s->transform = saved;
        soup_use(s, TINT_ASHLAR_DARK);
    }
    // Coped gable: a raking moulding that stands above the roof.
    soup_use(s, MAT_CARVED);
    float run = sqrtf(w * w + (RIDGE - EAVES) * (RIDGE - EAVES));
    for (int side = -1; side <= 1; side += 2) {
        Affine saved = s->transform;
        Affine tilt = affine_turn_z(-atan2f(RIDGE - EAVES, w) * 180 / PI_F);
        Affine mirror = affine_scaling((float)side, 1, 1);
        tilt.t = vec3(0, RIDGE + 0.12f, 0);
        tilt = affine_mul(&mirror, &tilt);
        s->transform = affine_mul(&saved, &tilt);
        shape_box(s, vec3(-0.1f, -0.24f, FRONT - 0.14f), vec3(run, 0.1f, FRONT + 0.45f), 0);
        s->transform = saved;
    }
    Affine saved = s->transform, place = affine_translation(0, 0, FRONT + 0.15f);
    s->transform = affine_mul(&saved, &place);
    shape_box(s, vec3(-0.09f, RIDGE, -0.09f), vec3(0.09f, RIDGE + 1.3f, 0.09f), SKIP_BOTTOM);
    shape_box(s, vec3(-0.42f, RIDGE + 0.72f, -0.08f), vec3(0.42f, RIDGE + 0.9f, 0.08f), 0);
    s->transform = saved;
    soup_use(s, MAT_ROOF);
    float k = 1 / s->tile_m, over = w + 0.3f, slope = (RIDGE - EAVES) / w;
    float low = EAVES - slope * 0.3f, length = sqrtf(over * over + (RIDGE - low) * (RIDGE - low));
    for (int side = 0; side < 2; side++) {
        Affine mirror = affine_scaling(side ? -1.0f : 1.0f, 1, 1);
        s->transform = affine_mul(&saved, &mirror);
        soup_quad(s, vec3(over, low, back), vec3(over, low, FRONT), vec3(0, RIDGE, FRONT),
                  vec3(0, RIDGE, back), vec2(-back * k, 0), vec2(-FRONT * k, 0),
                  vec2(-FRONT * k, length * k), vec2(-back * k, length * k));
        s->transform = saved;
    }
}

// One face of the belfry, at z = -half looking to -z: two openings with glow behind.
static void add_belfry_face(Soup *s) {
    Arch arch = {0.55f, 14.6f, 0.35f};
    static const Vec2 REVEAL[4] = {{0.0f, 0.5f}, {0.0f, 0.1f}, {0.14f, -0.06f}, {0.16f, 0.02f}};
    Affine saved = s->transform;
    for (int side = -1; side <= 1; side += 2) {
        Affine place = affine_translation(0.85f * (float)side, 0, -TOWER_HALF);
        s->transform = affine_mul(&saved, &place);
        soup_use(s, MAT_CARVED);
        shape_arch_moulding(s, &arch, REVEAL, 4, 8, 0, -1);
        shape_jambs(s, &arch, REVEAL, 4, 12.6f);
        soup_use(s, MAT_ASHLAR);
        float lo = side < 0 ? -TOWER_HALF + 0.85f : -0.85f,
              hi = side < 0 ? 0.85f : TOWER_HALF - 0.85f;
        shape_spandrel(s, &arch, 0.13f, lo, hi, 12.6f, TOWER_TOP, 0, -1, 8);
        soup_use(s, TINT_CARVED_DARK);
        for (int i = 0; i < 5; i++) { // louvres
            float y = 12.75f + 0.42f * (float)i;
            soup_quad_box(s, vec3(0.55f, y, 0.16f), vec3(-0.55f, y, 0.16f),
                          vec3(-0.55f, y + 0.2f, 0.45f), vec3(0.55f, y + 0.2f, 0.45f));
        }
        soup_quad_box(s, vec3(0.6f, 12.6f, 0), vec3(-0.6f, 12.6f, 0), vec3(-0.6f, 12.7f, 0.5f),
                      vec3(0.6f, 12.7f, 0.5f));
        soup_use(s, MAT_LANTERN_GLASS);
        shape_arch_plate(s, &arch, 0.02f, 12.6f, 0.48f, -1, 8);
        s->transform = saved;
    }
}

static void add_tower(Soup *s) {
    Affine saved = s->transform, place = affine_translation(TOWER_X, 0, FRONT + TOWER_HALF + 0.2f);
    Affine here = affine_mul(&saved, &place);
    s->transform = here;
    float h = TOWER_HALF;
    soup_use(s, MAT_ASHLAR);
    shape_box(s, vec3(-h, 0, -h), vec3(h, 12.6f, h), SKIP_BOTTOM | SKIP_TOP);
    soup_use(s, MAT_CARVED);
    static const float BANDS[4] = {6.6f, 9.6f, 12.4f, TOWER_TOP};
    for (int i = 0; i < 4; i++)
        shape_taper_box(s, vec3(-h - 0.04f, BANDS[i], -h - 0.04f),
                        vec3(h + 0.04f, BANDS[i] + 0.2f, h + 0.04f), i == 3 ? -0.2f : -0.08f,
                        i == 3 ? -0.2f : -0.08f, 0);
    for (int i = 0; i < 4; i++) {
        Affine turn = affine_turn_y(90.0f * (float)i);
        s->transform = affine_mul(&here, &turn);
        if (i == 2) { // seen from behind the church only
            soup_use(s, MAT_ASHLAR);
            soup_quad_box(s, vec3(h, 12.6f, -h), vec3(-h, 12.6f, -h), vec3(-h, TOWER_TOP, -h),
                          vec3(h, TOWER_TOP, -h));
        } else {
            add_belfry_face(s);
        }
        soup_use(s, MAT_CARVED);
        for (int k = 0; k < 6; k++) { // corbels under the crown
            float x = -h + (2 * h) * ((float)k + 0.5f) / 6;
            shape_box(s, vec3(x - 0.1f, TOWER_TOP - 0.35f, -h - 0.16f),
                      vec3(x + 0.1f, TOWER_TOP, -h), SKIP_FRONT | SKIP_TOP);
        }
        soup_use(s, MAT_ASHLAR);
        shape_taper_box(s, vec3(-h - 0.25f, 0, -h - 0.25f), vec3(-h + 0.35f, 12.4f, -h + 0.35f),
                        0.08f, 0.08f, SKIP_BOTTOM);
        Affine corner = affine_translation(-h + 0.05f, 0, -h + 0.05f), turned = s->transform;
        s->transform = affine_mul(&turned, &corner);
        soup_use(s, MAT_CARVED);
        Vec2 pinnacle[6] = {{0.3f, TOWER_TOP + 0.2f},  {0.3f, TOWER_TOP + 0.9f},
                            {0.38f, TOWER_TOP + 1},    {0.36f, TOWER_TOP + 1.1f},
                            {0.08f, TOWER_TOP + 2.4f}, {0, TOWER_TOP + 2.5f}};
        shape_turn(s, pinnacle, 6, 6);
    }
    s->transform = here;
    soup_use(s, MAT_ROOF);
    Vec2 spire[3] = {{(h - 0.05f) * 1.4142f, TOWER_TOP + 0.2f},
                     {(h - 0.45f) * 1.4142f, TOWER_TOP + 1.4f},
                     {0, TOWER_TOP + 6.6f}};
    shape_lathe(s, spire, 3, 4, 45, 360);
    soup_use(s, TINT_CARVED_CLAY);
    shape_tube(s, vec3(0, TOWER_TOP + 6.4f, 0), vec3(0, TOWER_TOP + 7.8f, 0), 0.05f, 0.02f, 4,
               false);
    shape_ball(s, vec3(0, TOWER_TOP + 6.7f, 0), vec3(0.16f, 0.16f, 0.16f), 6, 4);
    shape_box(s, vec3(-0.34f, TOWER_TOP + 7.25f, -0.03f), vec3(0.34f, TOWER_TOP + 7.33f, 0.03f), 0);
    s->transform = saved;
}

void model_make_facade(Model *m) {
    Soup s;
    soup_init(&s);
    add_front(&s);
    add_rose(&s);
    add_gallery(&s);
    add_nave(&s);
    add_tower(&s);
    model_add_soup(m, "facade", &s);
}
