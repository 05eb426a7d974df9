// Outer walls of the walk, 3 m each, z = 4 inside to z = 4.6 outside: with a blind niche, with two
// stained lancets, with a doorway for two leaves of 1.2 m by 2.8 m.
//
// Data in: the measures of walk.h. Data out: filled models. Called through the table in model.c.
#include "carving.h"
#include "models.h"
#include "walk.h"

#define HALF (WALK_BAY / 2)

// Outer face, coping, a pilaster at the left joint; `door` leaves the doorway open.
static void add_outside(Soup *s, bool door) {
    float top = WALK_WALL_TOP, z = WALK_WALL_BACK;
    soup_use(s, TINT_ASHLAR_DARK);
    if (door) {
        soup_quad_box(s, vec3(-HALF, 0, z), vec3(-1.2f, 0, z), vec3(-1.2f, top, z),
                      vec3(-HALF, top, z));
        soup_quad_box(s, vec3(1.2f, 0, z), vec3(HALF, 0, z), vec3(HALF, top, z),
                      vec3(1.2f, top, z));
        soup_quad_box(s, vec3(-1.2f, 2.8f, z), vec3(1.2f, 2.8f, z), vec3(1.2f, top, z),
                      vec3(-1.2f, top, z));
    } else {
        soup_quad_box(s, vec3(-HALF, 0, z), vec3(HALF, 0, z), vec3(HALF, top, z),
                      vec3(-HALF, top, z));
    }
    shape_box(s, vec3(-HALF - 0.2f, 0, z), vec3(-HALF + 0.2f, top - 0.3f, z + 0.12f),
              SKIP_BACK | SKIP_BOTTOM);
    soup_use(s, TINT_CARVED_DARK);
    shape_box(s, vec3(-HALF, top, WALK_DEPTH - 0.06f), vec3(HALF, top + 0.12f, z + 0.06f),
              SKIP_ENDS);
}

// A stone seat along the foot of the wall.
static void add_seat(Soup *s) {
    soup_use(s, MAT_ASHLAR);
    shape_box(s, vec3(-HALF + 0.16f, 0, 3.62f), vec3(HALF - 0.16f, 0.42f, 4.02f),
              SKIP_BOTTOM | SKIP_FRONT | SKIP_TOP);
    soup_use(s, MAT_CARVED);
    shape_taper_box(s, vec3(-HALF + 0.12f, 0.42f, 3.56f), vec3(HALF - 0.12f, 0.5f, 4.1f), 0.01f,
                    0.02f, SKIP_FRONT);
}

void model_make_wall(Model *m) {
    Soup s;
    soup_init(&s);
    add_outside(&s, false);
    add_seat(&s);
    Arch arch = {0.9f, 1.75f, 0.34f};
    static const Vec2 RING[5] = {
        {0.0f, 4.24f}, {0.0f, 4.05f}, {0.06f, 3.94f}, {0.15f, 3.94f}, {0.16f, 4.02f}};
    soup_use(&s, MAT_CARVED);
    soup_smooth(&s, 45);
    shape_arch_moulding(&s, &arch, RING, 5, 12, 0, -1);
    shape_jambs(&s, &arch, RING, 5, 0.5f);
    soup_smooth(&s, 0);
    soup_use(&s, MAT_ASHLAR);
    shape_arch_plate(&s, &arch, 0.0f, 0.45f, 4.22f, -1, 10);
    shape_spandrel(&s, &arch, 0.12f, -HALF, HALF, 0, WALK_WALL_TOP, WALK_DEPTH, -1, 6);
    soup_use(&s, MAT_CARVED);
    carve_rosette(&s, vec3(0, 2.36f, 4.22f), 0.27f, 0.07f, 6, -1);
    model_add_soup(m, "wall", &s);
}

void model_make_wall_window(Model *m) {
    Soup s;
    soup_init(&s);
    add_outside(&s, false);
    add_seat(&s);
    Arch lancet = {0.36f, 2.2f, 0.7f};
    static const Vec2 REVEAL[5] = {
        {-0.04f, 4.32f}, {0.0f, 4.22f}, {0.1f, 3.98f}, {0.16f, 3.96f}, {0.17f, 4.02f}};
    for (int side = -1; side <= 1; side += 2) {
        float x = 0.53f * (float)side;
        s.transform = affine_translation(x, 0, 0);
        soup_use(&s, MAT_CARVED);
        soup_smooth(&s, 45);
        shape_arch_moulding(&s, &lancet, REVEAL, 5, 8, 0, -1);
        shape_jambs(&s, &lancet, REVEAL, 5, 1.2f);
        soup_smooth(&s, 0);
        // The sill slopes into the walk.
        soup_quad_box(&s, vec3(0.54f, 1.16f, 3.95f), vec3(-0.54f, 1.16f, 3.95f),
                      vec3(-0.36f, 1.3f, 4.32f), vec3(0.36f, 1.3f, 4.32f));
        soup_quad_box(&s, vec3(0.54f, 1.08f, 3.95f), vec3(-0.54f, 1.08f, 3.95f),
                      vec3(-0.54f, 1.16f, 3.95f), vec3(0.54f, 1.16f, 3.95f));
        soup_quad_box(&s, vec3(-0.54f, 1.08f, 3.95f), vec3(0.54f, 1.08f, 3.95f),
                      vec3(0.54f, 1.08f, 4.02f), vec3(-0.54f, 1.08f, 4.02f));
        soup_use(&s, MAT_GLASS_LANCET);
        float k = 0.72f; // one repeat over the light's width
        for (int i = 0; i < 8; i++) {
            Vec2 p = arch_point(&lancet, 0, (float)i / 8);
            Vec2 q = arch_point(&lancet, 0, (float)(i + 1) / 8);
            soup_quad(&s, vec3(q.x, 1.2f, 4.3f), vec3(p.x, 1.2f, 4.3f), vec3(p.x, p.y, 4.3f),
                      vec3(q.x, q.y, 4.3f), vec2(0.5f - q.x / k, 1.2f / k),
                      vec2(0.5f - p.x / k, 1.2f / k), vec2(0.5f - p.x / k, p.y / k),
                      vec2(0.5f - q.x / k, q.y / k));
        }
        soup_use(&s, MAT_ASHLAR);
        float lo = side < 0 ? -HALF - x : -x, hi = side < 0 ? -x : HALF - x;
        shape_spandrel(&s, &lancet, 0.14f, lo, hi, 1.1f, WALK_WALL_TOP, WALK_DEPTH, -1, 4);
    }
    s.transform = affine_identity();
    soup_quad_box(&s, vec3(HALF, 0, WALK_DEPTH), vec3(-HALF, 0, WALK_DEPTH),
                  vec3(-HALF, 1.1f, WALK_DEPTH), vec3(HALF, 1.1f, WALK_DEPTH));
    soup_use(&s, MAT_CARVED);
    carve_rosette(&s, vec3(0, 3.15f, WALK_DEPTH), 0.3f, 0.09f, 6, -1);
    carve_column(&s, vec3(0, 1.16f, 3.97f), 2.2f, 0.05f, 0);
    model_add_soup(m, "wall_window", &s);
}

void model_make_wall_door(Model *m) {
    Soup s;
    soup_init(&s);
    add_outside(&s, true);
    Arch arch = {1.2f, 2.12f, 0.14f};
    // Splayed orders: roll, hollow, roll; the innermost stands behind the leaves' arc.
    static const Vec2 ORDERS[7] = {{0.0f, 4.32f},   {0.0f, 4.24f},  {0.06f, 4.16f}, {0.05f, 4.12f},
                                   {0.115f, 3.94f}, {0.19f, 3.94f}, {0.2f, 4.02f}};
    soup_use(&s, MAT_CARVED);
    soup_smooth(&s, 50);
    shape_arch_moulding(&s, &arch, ORDERS, 7, 12, 12, TINT_CARVED_RED);
    shape_jambs(&s, &arch, ORDERS, 7, 0);
    soup_smooth(&s, 0);
    soup_use(&s, MAT_ASHLAR);
    shape_spandrel(&s, &arch, 0.17f, -HALF, HALF, 0, WALK_WALL_TOP, WALK_DEPTH, -1, 6);
    // Passage through the wall: straight jambs, lintel, threshold.
    soup_use(&s, MAT_CARVED);
    float x = 1.2f, h = 2.8f, z0 = 4.3f, z1 = WALK_WALL_BACK;
    soup_quad_box(&s, vec3(-x, 0, z1), vec3(-x, 0, z0), vec3(-x, h, z0), vec3(-x, h, z1));
    soup_quad_box(&s, vec3(x, 0, z0), vec3(x, 0, z1), vec3(x, h, z1), vec3(x, h, z0));
    soup_quad_box(&s, vec3(-x, h, z0), vec3(x, h, z0), vec3(x, h, z1), vec3(-x, h, z1));
    soup_use(&s, TINT_CARVED_DARK);
    soup_quad_box(&s, vec3(-HALF, 0.005f, z1 + 0.1f), vec3(HALF, 0.005f, z1 + 0.1f),
                  vec3(HALF, 0.005f, 3.98f), vec3(-HALF, 0.005f, 3.98f));
    // Tympanum above the lintel, with a relief.
    soup_use(&s, MAT_CARVED);
    for (int i = 0; i < 12; i++) {
        Vec2 p = arch_point(&arch, 0, (float)i / 12), q = arch_point(&arch, 0, (float)(i + 1) / 12);
        float yp = fmaxf(p.y, h), yq = fmaxf(q.y, h);
        soup_quad_box(&s, vec3(q.x, h, z0), vec3(p.x, h, z0), vec3(p.x, yp, z0), vec3(q.x, yq, z0));
    }
    shape_box(&s, vec3(-x, h - 0.01f, 4.22f), vec3(x, h + 0.1f, z0 + 0.02f),
              SKIP_ENDS | SKIP_FRONT);
    carve_rosette(&s, vec3(0, 3.2f, z0), 0.24f, 0.08f, 6, -1);
    carve_rosette(&s, vec3(-0.48f, 3.06f, z0), 0.13f, 0.06f, 6, -1);
    carve_rosette(&s, vec3(0.48f, 3.06f, z0), 0.13f, 0.06f, 6, -1);
    model_add_soup(m, "wall_door", &s);
}
