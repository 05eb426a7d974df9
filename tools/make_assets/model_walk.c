// The covered walk: a bay with its arcade on a parapet, the bay that opens to the garden, and the
// corner. Each brings floor, vault and lean-to roof; outer walls are pieces of their own.
//
// Data in: the measures of walk.h. Data out: filled models. Called through the table in model.c.
// A bay owns the pier and shafts at its left end (-x) only: its neighbour closes the right one.
#include "carving.h"
#include "models.h"
#include "walk.h"

#define HALF (WALK_BAY / 2)

static const Vault BAY_VAULT = {-HALF,       HALF,      WALK_ARCADE, WALK_DEPTH,
                                WALK_SPRING, WALK_RISE, WALK_POINTED};

static void add_floor(Soup *s, float x0, float z0, float x1, float z1, int surface) {
    soup_use(s, surface);
    soup_quad_box(s, vec3(x0, 0, z1), vec3(x1, 0, z1), vec3(x1, 0, z0), vec3(x0, 0, z0));
}

static void add_vault(Soup *s, const Vault *v) {
    soup_use(s, TINT_VAULT);
    carve_vault_webs(s, v, 8);
    soup_use(s, MAT_CARVED);
    carve_vault_diagonals(s, v, 0.15f, 0.16f, 8);
}

// A pier of the arcade with its buttress towards the garden and a shaft towards the walk.
static void add_pier(Soup *s) {
    soup_use(s, MAT_ASHLAR);
    float x = -HALF;
    shape_post(s, vec3(x - 0.25f, 0, 0), vec3(x + 0.25f, 2.2f, 0.5f), 0.04f, true);
    shape_box(s, vec3(x - 0.18f, 0, -0.3f), vec3(x + 0.18f, 2.75f, 0.02f),
              SKIP_FRONT | SKIP_TOP | SKIP_BOTTOM);
    soup_use(s, MAT_CARVED);
    // The buttress is weathered: its top slopes back to the wall.
    soup_quad_box(s, vec3(x + 0.2f, 2.72f, -0.34f), vec3(x - 0.2f, 2.72f, -0.34f),
                  vec3(x - 0.2f, 3.25f, 0.04f), vec3(x + 0.2f, 3.25f, 0.04f));
    for (int side = -1; side <= 1; side += 2) {
        Vec3 a = vec3(x + 0.2f * (float)side, 2.72f, -0.34f);
        Vec3 b = vec3(a.x, 2.72f, 0.04f), c = vec3(a.x, 3.25f, 0.04f);
        if (side > 0)
            soup_triangle_box(s, b, a, c);
        else
            soup_triangle_box(s, a, b, c);
    }
    soup_quad_box(s, vec3(x - 0.2f, 2.72f, -0.34f), vec3(x + 0.2f, 2.72f, -0.34f),
                  vec3(x + 0.2f, 2.72f, -0.28f), vec3(x - 0.2f, 2.72f, -0.28f));
    shape_taper_box(s, vec3(x - 0.24f, 0, -0.37f), vec3(x + 0.24f, 0.42f, 0.02f), 0.05f, 0.05f,
                    SKIP_FRONT | SKIP_BOTTOM);
    shape_taper_box(s, vec3(x - 0.3f, 2.18f, -0.05f), vec3(x + 0.3f, 2.3f, 0.55f), 0.0f, 0.0f, 0);
    carve_wall_shaft(s, vec3(x, 0, 0.48f), WALK_SPRING, 0.09f, 180, 180);
    carve_wall_shaft(s, vec3(x, 0, WALK_DEPTH + 0.02f), WALK_SPRING, 0.1f, 0, 180);
    carve_vault_rib_z(s, &BAY_VAULT, x, 0.3f, 0.14f, 8);
}

// The arch ring over both faces of the arcade wall, stones in two colours.
static void add_arch_ring(Soup *s, const Arch *a, int stones) {
    static const Vec2 PROFILE[6] = {{0.19f, 0.49f}, {0.09f, 0.49f}, {0.0f, 0.41f},
                                    {0.0f, 0.09f},  {0.09f, 0.01f}, {0.19f, 0.01f}};
    soup_use(s, MAT_CARVED);
    soup_smooth(s, 60);
    shape_arch_moulding(s, a, PROFILE, 6, stones, stones, TINT_CARVED_RED);
    soup_smooth(s, 0);
}

// Their chords cut inwards, where the ring still covers them.
static void add_spandrels(Soup *s, const Arch *a, float x_lo, float x_hi, int segments) {
    soup_use(s, MAT_ASHLAR);
    shape_spandrel(s, a, 0.15f, x_lo, x_hi, 2.3f, walk_roof_y(0.03f) - 0.03f, 0.03f, -1, segments);
    shape_spandrel(s, a, 0.15f, x_lo, x_hi, 2.3f, 4.0f, WALK_ARCADE, 1, segments);
}

static void add_cornice(Soup *s, float x0, float x1) {
    static const Vec2 PROFILE[4] = {{0.0f, 3.5f}, {0.1f, 3.6f}, {0.19f, 3.66f}, {0.19f, 3.74f}};
    soup_use(s, MAT_CARVED);
    shape_moulding_x(s, x0, x1, 0.03f, PROFILE, 4);
    int corbels = (int)((x1 - x0) / 0.6f + 0.5f);
    for (int i = 0; i < corbels; i++) {
        // A wedge: its face leans out of the wall up to the cornice.
        float x = x0 + ((float)i + 0.5f) * (x1 - x0) / (float)corbels, w = 0.08f;
        Vec3 foot_r = vec3(x + w, 3.34f, 0.03f), foot_l = vec3(x - w, 3.34f, 0.03f);
        Vec3 lip_r = vec3(x + w, 3.56f, -0.12f), lip_l = vec3(x - w, 3.56f, -0.12f);
        soup_quad_box(s, foot_r, foot_l, lip_l, lip_r);
        soup_triangle_box(s, foot_r, lip_r, vec3(x + w, 3.56f, 0.03f));
        soup_triangle_box(s, lip_l, foot_l, vec3(x - w, 3.56f, 0.03f));
    }
}

// One plane of roof tiles between the eaves and the outer wall, and the soffit of the eaves: more
// of the underside nobody sees.
static void add_roof(Soup *s, float x0, float x1) {
    soup_use(s, MAT_ROOF);
    float k = 1 / s->tile_m, y0 = WALK_EAVES_Y, y1 = walk_roof_y(WALK_ROOF_END);
    float run = WALK_ROOF_END - WALK_EAVES_Z;
    float slope = run * sqrtf(1 + WALK_ROOF_SLOPE * WALK_ROOF_SLOPE);
    soup_quad(s, vec3(x1, y0, WALK_EAVES_Z), vec3(x0, y0, WALK_EAVES_Z),
              vec3(x0, y1, WALK_ROOF_END), vec3(x1, y1, WALK_ROOF_END), vec2(-x1 * k, 0),
              vec2(-x0 * k, 0), vec2(-x0 * k, slope * k), vec2(-x1 * k, slope * k));
    // The last course is real: round cover tiles over the eaves, where the texture has its own.
    int covers = (int)((x1 - x0) / 0.3f + 0.5f);
    float back_z = WALK_EAVES_Z + 0.3f, front_z = WALK_EAVES_Z - 0.07f;
    float fy = y0 - 0.07f * WALK_ROOF_SLOPE, by = y0 + 0.3f * WALK_ROOF_SLOPE;
    soup_smooth(s, 120);
    for (int i = 0; i < covers; i++) {
        float x = x0 + ((float)i + 0.5f) * 0.3f;
        static const Vec2 ARC[3] = {{-0.085f, -0.02f}, {0, 0.075f}, {0.085f, -0.02f}};
        Vec3 front[3], back[3];
        Vec2 front_uv[3], back_uv[3];
        for (int j = 0; j < 3; j++) {
            front[j] = vec3(x + ARC[j].x, fy + ARC[j].y, front_z);
            back[j] = vec3(x + ARC[j].x, by + ARC[j].y, back_z);
            front_uv[j] = vec2(-front[j].x * k, 0.02f);
            back_uv[j] = vec2(-front[j].x * k, 0.26f);
        }
        for (int j = 0; j < 2; j++)
            soup_quad(s, front[j + 1], front[j], back[j], back[j + 1], front_uv[j + 1], front_uv[j],
                      back_uv[j], back_uv[j + 1]);
        soup_triangle(s, front[2], front[0], front[1], front_uv[2], front_uv[0], front_uv[1]);
    }
    soup_smooth(s, 0);
    soup_use(s, TINT_CARVED_DARK);
    float inner = 0.06f, drop = 0.05f, y2 = walk_roof_y(inner);
    soup_quad_box(s, vec3(x0, y0 - drop, WALK_EAVES_Z), vec3(x1, y0 - drop, WALK_EAVES_Z),
                  vec3(x1, y2 - drop, inner), vec3(x0, y2 - drop, inner));
    soup_quad_box(s, vec3(x1, y0 - drop, WALK_EAVES_Z), vec3(x0, y0 - drop, WALK_EAVES_Z),
                  vec3(x0, y0, WALK_EAVES_Z), vec3(x1, y0, WALK_EAVES_Z));
}

static void add_parapet(Soup *s) {
    soup_use(s, MAT_ASHLAR);
    shape_box(s, vec3(-HALF + 0.2f, 0, 0.06f), vec3(HALF - 0.2f, 0.54f, 0.44f),
              SKIP_ENDS | SKIP_BOTTOM | SKIP_TOP);
    soup_use(s, MAT_CARVED);
    static const Vec2 CAP[5] = {
        {-0.02f, 0.5f}, {0.05f, 0.56f}, {0.05f, 0.605f}, {0.02f, 0.63f}, {-0.2f, 0.63f}};
    shape_moulding_x(s, -HALF + 0.2f, HALF - 0.2f, 0.05f, CAP, 5);
    Affine saved = s->transform, turn = affine_turn_y(180);
    turn.t = vec3(0, 0, 0.5f);
    s->transform = affine_mul(&saved, &turn);
    shape_moulding_x(s, -HALF + 0.2f, HALF - 0.2f, 0.05f, CAP, 5);
    s->transform = saved;
}

static void add_common(Soup *s) {
    add_floor(s, -HALF, 0.5f, HALF, WALK_DEPTH, MAT_FLOOR);
    add_floor(s, -HALF, -0.02f, HALF, 0.5f, TINT_CARVED_DARK);
    add_vault(s, &BAY_VAULT);
    add_pier(s);
    add_cornice(s, -HALF, HALF);
    add_roof(s, -HALF, HALF);
}

void model_make_bay(Model *m) {
    Soup s;
    soup_init(&s);
    add_common(&s);
    add_parapet(&s);
    Arch arch = {0.54f, 2.3f, 0.35f};
    for (int side = -1; side <= 1; side += 2) {
        float center = 0.71f * (float)side;
        s.transform = affine_translation(center, 0, 0);
        add_arch_ring(&s, &arch, 8);
        if (side < 0)
            add_spandrels(&s, &arch, -HALF - center, -center, 4);
        else
            add_spandrels(&s, &arch, -center, HALF - center, 4);
    }
    s.transform = affine_identity();
    soup_use(&s, MAT_CARVED);
    shape_taper_box(&s, vec3(-0.16f, 0.62f, 0.02f), vec3(0.16f, 0.7f, 0.48f), 0.02f, 0.02f,
                    SKIP_BOTTOM);
    carve_column(&s, vec3(0, 0.7f, 0.135f), 2.2f, 0.072f, 0.5f);
    carve_column(&s, vec3(0, 0.7f, 0.365f), 2.2f, 0.072f, 0);
    shape_taper_box(&s, vec3(-0.14f, 2.19f, 0.02f), vec3(0.14f, 2.24f, 0.48f), -0.05f, -0.03f,
                    SKIP_TOP);
    shape_box(&s, vec3(-0.19f, 2.24f, -0.01f), vec3(0.19f, 2.3f, 0.51f), SKIP_BOTTOM);
    carve_rosette(&s, vec3(0, 3.0f, 0.03f), 0.17f, 0.05f, 5, -1);
    model_add_soup(m, "bay", &s);
}

// One wide arch instead of two: a way into the garden.
void model_make_bay_open(Model *m) {
    Soup s;
    soup_init(&s);
    add_common(&s);
    Arch arch = {0.98f, 2.0f, 0.24f};
    add_arch_ring(&s, &arch, 12);
    soup_use(&s, MAT_ASHLAR);
    shape_spandrel(&s, &arch, 0.15f, -HALF, HALF, 2.0f, walk_roof_y(0.03f) - 0.03f, 0.03f, -1, 6);
    shape_spandrel(&s, &arch, 0.15f, -HALF, HALF, 2.0f, 4.0f, WALK_ARCADE, 1, 6);
    for (int side = -1; side <= 1; side += 2) {
        float x = (float)side;
        soup_use(&s, MAT_ASHLAR);
        Vec3 lo = vec3(fminf(x * 1.2f, x * 1.5f), 0, 0.03f);
        Vec3 hi = vec3(fmaxf(x * 1.2f, x * 1.5f), 2.0f, WALK_ARCADE);
        shape_box(&s, lo, hi, SKIP_BOTTOM | SKIP_TOP);
        soup_use(&s, MAT_CARVED);
        shape_post(&s, vec3(x * 1.1f - 0.16f, 0, 0), vec3(x * 1.1f + 0.16f, 0.3f, 0.5f), 0.03f,
                   false);
        carve_column(&s, vec3(x * 1.09f, 0.3f, 0.13f), 1.9f, 0.075f, 0.5f * x);
        carve_column(&s, vec3(x * 1.09f, 0.3f, 0.37f), 1.9f, 0.075f, 0);
        shape_taper_box(&s, vec3(x * 1.12f - 0.15f, 1.89f, 0.01f),
                        vec3(x * 1.12f + 0.15f, 1.94f, 0.49f), -0.04f, -0.03f, SKIP_TOP);
        shape_box(&s, vec3(x * 1.12f - 0.19f, 1.94f, -0.02f), vec3(x * 1.12f + 0.19f, 2.0f, 0.52f),
                  SKIP_BOTTOM);
        carve_rosette(&s, vec3(x * 1.12f, 3.0f, 0.03f), 0.15f, 0.05f, 5, -1);
    }
    model_add_soup(m, "bay_open", &s);
}

// ---- the corner: 4 m by 4 m outwards from the garden's corner at the origin ---------------------

static void add_corner_roof(Soup *s) {
    float e = WALK_ROOF_END, y0 = walk_roof_y(0), y1 = walk_roof_y(e);
    Vec3 low = vec3(0, y0, 0), high = vec3(e, y1, e), left = vec3(0, y1, e), back = vec3(e, y1, 0);
    soup_use(s, MAT_ROOF);
    float k = 1 / s->tile_m, c = sqrtf(1 + WALK_ROOF_SLOPE * WALK_ROOF_SLOPE);
    float v0 = -WALK_EAVES_Z * c * k, v1 = (e - WALK_EAVES_Z) * c * k;
    // Two planes that rise outwards meet in a valley along the diagonal.
    soup_triangle(s, low, left, high, vec2(0, v0), vec2(0, v1), vec2(-e * k, v1));
    soup_triangle(s, low, high, back, vec2(0, v0), vec2(e * k, v1), vec2(0, v1));
    soup_use(s, TINT_CARVED_DARK); // lead in the valley
    soup_quad_box(s, vec3(-0.1f, y0 + 0.02f, 0.1f), vec3(e - 0.1f, y1 + 0.02f, e + 0.1f),
                  vec3(e + 0.1f, y1 + 0.02f, e - 0.1f), vec3(0.1f, y0 + 0.02f, -0.1f));
}

static void add_corner_wall(Soup *s) {
    soup_use(s, MAT_ASHLAR);
    float top = WALK_WALL_TOP, back = WALK_WALL_BACK;
    soup_quad_box(s, vec3(WALK_DEPTH, 0, WALK_DEPTH), vec3(0, 0, WALK_DEPTH),
                  vec3(0, top, WALK_DEPTH), vec3(WALK_DEPTH, top, WALK_DEPTH));
    soup_use(s, TINT_ASHLAR_DARK);
    soup_quad_box(s, vec3(0, 0, back), vec3(back, 0, back), vec3(back, top, back),
                  vec3(0, top, back));
    soup_use(s, TINT_CARVED_DARK);
    shape_box(s, vec3(0, top, WALK_DEPTH - 0.06f), vec3(back + 0.06f, top + 0.12f, back + 0.06f),
              SKIP_LEFT);
    // A blind arch frames the place of a torch.
    Arch arch = {0.8f, 1.9f, 0.3f};
    static const Vec2 RING[5] = {
        {0.14f, 4.02f}, {0.14f, 3.95f}, {0.05f, 3.93f}, {0.0f, 3.96f}, {0.0f, 4.02f}};
    Vec2 reversed[5];
    for (int i = 0; i < 5; i++) reversed[i] = RING[4 - i];
    soup_use(s, MAT_CARVED);
    Affine saved = s->transform, shift = affine_translation(2.1f, 0, 0);
    s->transform = affine_mul(&saved, &shift);
    shape_arch_moulding(s, &arch, reversed, 5, 8, 0, -1);
    shape_jambs(s, &arch, reversed, 5, 0.5f);
    s->transform = saved;
    soup_use(s, MAT_ASHLAR);
    shape_box(s, vec3(0.15f, 0, 3.6f), vec3(WALK_DEPTH, 0.42f, 4.02f),
              SKIP_BOTTOM | SKIP_FRONT | SKIP_RIGHT | SKIP_TOP);
    soup_use(s, MAT_CARVED);
    shape_box(s, vec3(0.12f, 0.42f, 3.55f), vec3(WALK_DEPTH, 0.5f, 4.02f), SKIP_FRONT | SKIP_RIGHT);
}

void model_make_corner(Model *m) {
    Soup s;
    soup_init(&s);
    add_floor(&s, 0, 0.5f, WALK_DEPTH, WALK_DEPTH, MAT_FLOOR);
    add_floor(&s, 0.5f, 0, WALK_DEPTH, 0.5f, MAT_FLOOR);
    Vault vault = {WALK_ARCADE, WALK_DEPTH, WALK_ARCADE, WALK_DEPTH,
                   WALK_SPRING, WALK_RISE,  WALK_POINTED};
    add_vault(&s, &vault);
    // Broad arches bridge the pier's thickness between this vault and those of the bays.
    carve_vault_rib_z(&s, &vault, 0.2f, 0.62f, 0.15f, 8);
    carve_vault_rib_x(&s, &vault, 0.2f, 0.62f, 0.15f, 8);
    soup_use(&s, MAT_ASHLAR);
    shape_post(&s, vec3(-0.3f, 0, -0.3f), vec3(0.5f, 3.75f, 0.5f), 0.05f, false);
    shape_box(&s, vec3(0, 3.5f, 0), vec3(0.5f, 3.84f, 0.5f), SKIP_BOTTOM);
    soup_use(&s, MAT_CARVED);
    shape_taper_box(&s, vec3(-0.38f, 0, -0.38f), vec3(0.54f, 0.5f, 0.54f), 0.05f, 0.05f,
                    SKIP_BOTTOM);
    shape_box(&s, vec3(-0.35f, 2.18f, -0.35f), vec3(0.55f, 2.3f, 0.55f), 0);
    carve_wall_shaft(&s, vec3(0.47f, 0, 0.47f), WALK_SPRING, 0.12f, 180, 270);
    carve_wall_shaft(&s, vec3(0, 0, WALK_DEPTH + 0.02f), WALK_SPRING, 0.1f, 0, 180);
    carve_wall_shaft(&s, vec3(WALK_DEPTH, 0, WALK_DEPTH), WALK_SPRING, 0.1f, 90, 90);
    add_corner_wall(&s);
    // The other wall is the same piece, mirrored over the diagonal.
    Affine mirror = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    s.transform = mirror;
    add_corner_wall(&s);
    s.transform = affine_identity();
    add_corner_roof(&s);
    model_add_soup(m, "corner", &s);
}
