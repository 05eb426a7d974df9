// The chapter house: 9 m wide, 12 m deep, three by four vault bays on six columns, lancets on three
// sides, seats, a dais with an altar, two tapestries, its own roof.
//
// Data in: measures of walk.h, because it stands where a doorway of the walk stands: the room
// begins at z = 4.6 behind the wall pieces, which are its front. Data out: a model whose vault
// bays, columns, shafts and window bays are shared between nodes. Called through model.c.
#include "carving.h"
#include "models.h"
#include "walk.h"

#define BAY        3.0f
#define HALF_WIDTH 4.5f
#define FRONT      WALK_WALL_BACK
#define BACK       (FRONT + 12.0f)
#define SPRING     2.7f
#define RISE       1.95f
#define WALL       0.6f
#define EAVES      5.55f
#define RIDGE      8.9f

static const Vault ROOM_VAULT = {-BAY / 2, BAY / 2, -BAY / 2, BAY / 2, SPRING, RISE, 0.3f};

// A vault bay around its own middle; it brings the ribs at its left and front edges.
static int add_vault_bay(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, TINT_VAULT);
    carve_vault_webs(&s, &ROOM_VAULT, 8);
    soup_use(&s, MAT_CARVED);
    carve_vault_diagonals(&s, &ROOM_VAULT, 0.14f, 0.15f, 8);
    carve_vault_rib_z(&s, &ROOM_VAULT, -BAY / 2, 0.22f, 0.16f, 8);
    carve_vault_rib_x(&s, &ROOM_VAULT, -BAY / 2, 0.22f, 0.16f, 8);
    return model_add_mesh(m, "vault_bay", &s, 40);
}

static int add_column(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED);
    Vec2 plinth[3] = {{0.34f, 0}, {0.34f, 0.14f}, {0.2f, 0.16f}};
    shape_lathe(&s, plinth, 3, 8, 22.5f, 360);
    carve_column(&s, vec3(0, 0.16f, 0), SPRING - 0.08f, 0.15f, 0);
    Vec2 abacus[4] = {{0.22f, SPRING - 0.09f},
                      {0.33f, SPRING - 0.04f},
                      {0.33f, SPRING + 0.02f},
                      {0, SPRING + 0.02f}};
    shape_lathe(&s, abacus, 4, 8, 22.5f, 360);
    return model_add_mesh(m, "column", &s, 40);
}

static int add_shaft(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_CARVED);
    carve_wall_shaft(&s, vec3(0, 0, 0), SPRING, 0.11f, 0, 180);
    return model_add_mesh(m, "shaft", &s, 40);
}

static const Arch LIGHT = {0.45f, 2.6f, 0.75f};

static void add_glass(Soup *s, const Arch *a, float y0, float z, float facing, float width) {
    for (int i = 0; i < 8; i++) {
        Vec2 p = arch_point(a, 0, (float)i / 8), q = arch_point(a, 0, (float)(i + 1) / 8);
        float k = 1 / width;
        Vec3 c[4] = {vec3(p.x, y0, z), vec3(q.x, y0, z), vec3(q.x, q.y, z), vec3(p.x, p.y, z)};
        Vec2 t[4];
        for (int j = 0; j < 4; j++) t[j] = vec2(0.5f + c[j].x * k * facing, c[j].y * k);
        if (facing > 0)
            soup_quad(s, c[0], c[1], c[2], c[3], t[0], t[1], t[2], t[3]);
        else
            soup_quad(s, c[3], c[2], c[1], c[0], t[3], t[2], t[1], t[0]);
    }
}

// One bay of side wall, inner face at z = 0 looking to -z, outer face at z = 0.6, x centred. One
// lancet shows on both faces; a seat runs along its foot.
static int add_window_bay(Model *m) {
    static const Vec2 INSIDE[4] = {{0.0f, 0.32f}, {0.2f, 0.01f}, {0.24f, -0.04f}, {0.26f, 0.02f}};
    static const Vec2 OUTSIDE[2] = {{0.12f, 0.62f}, {0.0f, 0.34f}};
    Soup s;
    soup_init(&s);
    float top = EAVES, sill = 1.25f;
    soup_use(&s, MAT_ASHLAR);
    // The spandrel leaves out the jambs' column below the spring; plates fill it under the sill.
    shape_spandrel(&s, &LIGHT, 0.22f, -BAY / 2, BAY / 2, sill, top, 0, -1, 4);
    soup_quad_box(&s, vec3(BAY / 2, 0, 0), vec3(-BAY / 2, 0, 0), vec3(-BAY / 2, sill, 0),
                  vec3(BAY / 2, sill, 0));
    shape_box(&s, vec3(-BAY / 2, 0, -0.4f), vec3(BAY / 2, 0.42f, 0), SKIP_FRONT | SKIP_BOTTOM);
    soup_use(&s, TINT_ASHLAR_DARK);
    shape_spandrel(&s, &LIGHT, 0.11f, -BAY / 2, BAY / 2, sill, top, WALL, 1, 4);
    soup_quad_box(&s, vec3(-BAY / 2, -0.1f, WALL), vec3(BAY / 2, -0.1f, WALL),
                  vec3(BAY / 2, sill, WALL), vec3(-BAY / 2, sill, WALL));
    shape_taper_box(&s, vec3(-BAY / 2 - 0.25f, -0.1f, WALL),
                    vec3(-BAY / 2 + 0.25f, 4.6f, WALL + 0.5f), 0, 0.12f, SKIP_BACK | SKIP_BOTTOM);
    soup_use(&s, MAT_CARVED);
    shape_box(&s, vec3(-BAY / 2, 0.42f, -0.44f), vec3(BAY / 2, 0.5f, 0), SKIP_FRONT | SKIP_ENDS);
    shape_arch_moulding(&s, &LIGHT, INSIDE, 4, 8, 0, -1);
    shape_jambs(&s, &LIGHT, INSIDE, 4, sill);
    shape_arch_moulding(&s, &LIGHT, OUTSIDE, 2, 8, 0, -1);
    shape_jambs(&s, &LIGHT, OUTSIDE, 2, sill);
    soup_quad_box(&s, vec3(0.7f, sill - 0.06f, -0.04f), vec3(-0.7f, sill - 0.06f, -0.04f),
                  vec3(-0.45f, sill + 0.16f, 0.32f), vec3(0.45f, sill + 0.16f, 0.32f));
    soup_quad_box(&s, vec3(-0.57f, sill - 0.02f, WALL + 0.02f),
                  vec3(0.57f, sill - 0.02f, WALL + 0.02f), vec3(0.45f, sill + 0.1f, 0.32f),
                  vec3(-0.45f, sill + 0.1f, 0.32f));
    soup_use(&s, MAT_GLASS_LANCET);
    add_glass(&s, &LIGHT, sill, 0.3f, -1, 0.9f);
    add_glass(&s, &LIGHT, sill, 0.33f, 1, 0.9f);
    return model_add_mesh(m, "window_bay", &s, 40);
}

// A floor slab with a quarter turn in the room's middle would repeat; plain tiles are enough.
static void add_floor(Soup *s) {
    soup_use(s, MAT_FLOOR);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++) {
            float x = -HALF_WIDTH + BAY * (float)i, z = FRONT + BAY * (float)j;
            soup_quad_box(s, vec3(x, 0, z + BAY), vec3(x + BAY, 0, z + BAY), vec3(x + BAY, 0, z),
                          vec3(x, 0, z));
        }
}

static void add_altar(Soup *s) {
    soup_use(s, TINT_CARVED_DARK);
    shape_taper_box(s, vec3(-2.4f, 0, BACK - 2.9f), vec3(2.4f, 0.14f, BACK - 0.3f), 0.02f, 0.02f,
                    SKIP_BOTTOM);
    shape_taper_box(s, vec3(-1.9f, 0.14f, BACK - 2.4f), vec3(1.9f, 0.28f, BACK - 0.3f), 0.02f,
                    0.02f, SKIP_BOTTOM);
    soup_use(s, MAT_CARVED);
    float z0 = BACK - 1.75f, z1 = BACK - 0.95f;
    shape_taper_box(s, vec3(-1.05f, 0.28f, z0 + 0.05f), vec3(1.05f, 0.36f, z1 - 0.05f), 0.02f,
                    0.02f, SKIP_BOTTOM);
    shape_box(s, vec3(-0.95f, 0.36f, z0 + 0.12f), vec3(0.95f, 1.14f, z1 - 0.1f), SKIP_BOTTOM);
    soup_carve(s, 70);
    for (int i = 0; i < 5; i++) {
        static const Vec2 SHAFT[5] = {
            {0.072f, 0.36f}, {0.045f, 0.45f}, {0.04f, 0.96f}, {0.05f, 0.99f}, {0.078f, 1.13f}};
        Affine saved = s->transform;
        Affine place = affine_translation(-0.88f + 0.44f * (float)i, 0, z0 + 0.09f);
        s->transform = affine_mul(&saved, &place);
        shape_turn(s, SHAFT, 5, 6);
        s->transform = saved;
    }
    soup_smooth(s, 0);
    for (int i = 0; i < 4; i++)
        carve_rosette(s, vec3(-0.66f + 0.44f * (float)i, 0.74f, z0 + 0.12f), 0.14f, 0.05f, 6, -1);
    soup_use(s, MAT_MARBLE);
    shape_bevel_box(s, vec3(-1.15f, 1.12f, z0 - 0.04f), vec3(1.15f, 1.24f, z1 + 0.02f), 0.02f);
}

// Cloth hangs in soft folds from a rod; it covers the wall between window and corner.
static Vec3 cloth_point(const void *context, float u, float v) {
    (void)context;
    float fold = 0.035f * sinf(u * 21) * (1 - 0.5f * v) + 0.02f * sinf(u * 9 + 1);
    return vec3((u - 0.5f) * 1.7f, 1.35f + 2.1f * v - 0.02f * cosf(u * 21) * (1 - v), 0.08f + fold);
}

static int add_tapestry(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_TAPESTRY);
    shape_surface(&s, cloth_point, NULL, 22, 2, vec2(1, 1));
    soup_use(&s, TINT_BRASS);
    shape_tube(&s, vec3(-0.98f, 3.46f, 0.09f), vec3(0.98f, 3.46f, 0.09f), 0.022f, 0.022f, 5, false);
    shape_ball(&s, vec3(-1.0f, 3.46f, 0.09f), vec3(0.045f, 0.045f, 0.045f), 6, 4);
    shape_ball(&s, vec3(1.0f, 3.46f, 0.09f), vec3(0.045f, 0.045f, 0.045f), 6, 4);
    return model_add_mesh(m, "tapestry", &s, 60);
}

// Gable roof with its underside, end gables, and the strip of wall behind the front pieces.
static void add_roof(Soup *s) {
    float over = HALF_WIDTH + WALL + 0.35f, z0 = FRONT - 0.02f, z1 = BACK + WALL + 0.3f;
    float edge = HALF_WIDTH + WALL, slope = (RIDGE - EAVES) / edge;
    float low = EAVES - slope * (over - edge);
    float length = sqrtf(over * over + (RIDGE - low) * (RIDGE - low));
    for (int side = 0; side < 2; side++) {
        Affine saved = s->transform;
        Affine mirror = affine_scaling(side ? -1.0f : 1.0f, 1, 1);
        s->transform = mirror;
        soup_use(s, MAT_ROOF);
        float k = 1 / s->tile_m;
        soup_quad(s, vec3(over, low, z1), vec3(over, low, z0), vec3(0, RIDGE, z0),
                  vec3(0, RIDGE, z1), vec2(-z1 * k, 0), vec2(-z0 * k, 0), vec2(-z0 * k, length * k),
                  vec2(-z1 * k, length * k));
        soup_use(s, TINT_CARVED_DARK);
        soup_quad_box(s, vec3(over, low - 0.08f, z0), vec3(over, low - 0.08f, z1),
                      vec3(0, RIDGE - 0.08f, z1), vec3(0, RIDGE - 0.08f, z0));
        soup_quad_box(s, vec3(over, low - 0.08f, z1), vec3(over, low - 0.08f, z0),
                      vec3(over, low, z0), vec3(over, low, z1));
        soup_use(s, TINT_ASHLAR_DARK);
        soup_triangle_box(s, vec3(0, EAVES - 0.4f, BACK + WALL),
                          vec3(edge, EAVES - 0.4f, BACK + WALL),
                          vec3(0, RIDGE - 0.06f, BACK + WALL));
        soup_triangle_box(s, vec3(edge, EAVES - 0.4f, FRONT), vec3(0, EAVES - 0.4f, FRONT),
                          vec3(0, RIDGE - 0.06f, FRONT));
        s->transform = saved;
    }
    soup_use(s, TINT_CARVED_CLAY);
    shape_tube(s, vec3(0, RIDGE - 0.02f, z0), vec3(0, RIDGE - 0.02f, z1), 0.11f, 0.11f, 6, true);
}

// The corners between the walls' bays are closed by posts that reach from face to face.
static void add_corner_posts(Soup *s) {
    soup_use(s, TINT_ASHLAR_DARK);
    for (int side = -1; side <= 1; side += 2) {
        float x0 = side < 0 ? -HALF_WIDTH - WALL : HALF_WIDTH, x1 = x0 + WALL;
        shape_box(s, vec3(x0, -0.1f, BACK), vec3(x1, EAVES, BACK + WALL), SKIP_BOTTOM);
    }
}

void model_make_chapter_house(Model *m) {
    int vault = add_vault_bay(m), column = add_column(m), shaft = add_shaft(m);
    int window = add_window_bay(m), tapestry = add_tapestry(m);
    for (int j = 0; j < 4; j++) {
        float z = FRONT + BAY * ((float)j + 0.5f);
        for (int i = -1; i <= 1; i++)
            model_add_node(m, "vault", vault, vec3(BAY * (float)i, 0, z), 0);
        model_add_node(m, "window_east", window, vec3(HALF_WIDTH, 0, z), 90);
        model_add_node(m, "window_west", window, vec3(-HALF_WIDTH, 0, z), -90);
        float edge = FRONT + BAY * (float)j;
        model_add_node(m, "shaft", shaft, vec3(HALF_WIDTH + 0.02f, 0, edge), 90);
        model_add_node(m, "shaft", shaft, vec3(-HALF_WIDTH - 0.02f, 0, edge), -90);
        if (j == 0) continue;
        model_add_node(m, "column", column, vec3(-BAY / 2, 0, edge), 0);
        model_add_node(m, "column", column, vec3(BAY / 2, 0, edge), 0);
    }
    for (int i = -1; i <= 1; i++)
        model_add_node(m, "window_end", window, vec3(BAY * (float)i, 0, BACK), 0);
    for (int i = -1; i <= 1; i += 2) {
        float x = BAY / 2 * (float)i;
        model_add_node(m, "shaft", shaft, vec3(x, 0, BACK + 0.02f), 0);
        model_add_node(m, "shaft", shaft, vec3(x, 0, FRONT - 0.02f), 180);
        model_add_node(m, "shaft", shaft, vec3(HALF_WIDTH * (float)i, 0, BACK), 0);
        model_add_node(m, "tapestry", tapestry, vec3(BAY * (float)i, 0, FRONT + 0.02f), 0);
    }
    Soup s;
    soup_init(&s);
    add_floor(&s);
    add_altar(&s);
    add_roof(&s);
    add_corner_posts(&s);
    model_add_node(m, "room", model_add_mesh(m, "room", &s, 40), vec3(0, 0, 0), 0);
}
