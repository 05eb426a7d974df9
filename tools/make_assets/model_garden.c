// The garden court: 24 m square, gravel cross and ring, four grass quarters with kerbs, clipped
// hedges and a round bed each.
//
// Data in: constants below. Data out: a model of one ground mesh and one quarter, which four nodes
// share. Called through the table in model.c. Trees and bushes are placed by the level.
#include "models.h"
#include "noise.h"

#define COURT      12.0f // half the court
#define PATH       1.5f  // half the width of the cross
#define RING       4.5f  // radius of the round place in the middle
#define OUTER      10.4f // where a quarter ends before the arcade
#define BED_CENTER 6.6f  // of the round bed, both coordinates
#define BED_RADIUS 1.25f

// Border of a quarter for u in 0..1: v = 0 on the round place, v = 1 on the two outer sides.
static Vec3 quarter_point(const void *context, float u, float v) {
    (void)context;
    float a0 = asinf(PATH / RING), a = a0 + (PI_F / 2 - 2 * a0) * u;
    Vec3 inner = vec3(RING * sinf(a), 0, RING * cosf(a));
    float w = u * 2;
    Vec3 outer = w < 1 ? vec3(PATH + (OUTER - PATH) * w, 0, OUTER)
                       : vec3(OUTER, 0, OUTER - (OUTER - PATH) * (w - 1));
    Vec3 p = vec3_lerp(inner, outer, v);
    float edge = fminf(fminf(u, 1 - u) * 4, fminf(v, 1 - v) * 3);
    float swell = float_smooth(0, 1, edge);
    float dx = p.x - BED_CENTER, dz = p.z - BED_CENTER;
    float bed = float_smooth(BED_RADIUS * 0.9f, BED_RADIUS * 1.6f, sqrtf(dx * dx + dz * dz));
    p.y = 0.05f + swell * (0.06f + 0.16f * (noise_value3(p.x * 0.55f, 0, p.z * 0.55f, 5) - 0.4f)) *
                      (0.35f + 0.65f * bed);
    return p;
}

static void add_grass(Soup *s) {
    const int nu = 14, nv = 7;
    soup_use(s, MAT_GRASS);
    for (int j = 0; j < nv; j++) {
        for (int i = 0; i < nu; i++) {
            float u0 = (float)i / (float)nu, u1 = (float)(i + 1) / (float)nu;
            float v0 = (float)j / (float)nv, v1 = (float)(j + 1) / (float)nv;
            soup_quad_box(s, quarter_point(NULL, u0, v0), quarter_point(NULL, u0, v1),
                          quarter_point(NULL, u1, v1), quarter_point(NULL, u1, v0));
        }
    }
}

// A kerb around the quarter: a closed sweep whose profile is its cross-section.
static void add_kerb(Soup *s) {
    enum { STEPS = 8 };
    SweepFrame frames[STEPS + 6];
    Vec3 path[STEPS + 6];
    int n = 0;
    for (int i = 0; i <= STEPS; i++) {
        Vec3 p = quarter_point(NULL, (float)i / STEPS, 0);
        path[n++] = vec3(p.x, 0, p.z);
    }
    path[n++] = vec3(OUTER, 0, PATH);
    path[n++] = vec3(OUTER, 0, OUTER);
    path[n++] = vec3(PATH, 0, OUTER);
    path[n++] = path[0];
    for (int i = 0; i < n; i++) {
        Vec3 prev = path[i == 0 ? n - 2 : i - 1], next = path[i == n - 1 ? 1 : i + 1];
        Vec3 d0 = vec3_normalize(vec3_sub(path[i], prev));
        Vec3 d1 = vec3_normalize(vec3_sub(next, path[i]));
        // Outwards in the plan, lengthened at corners so that the kerb keeps its width.
        Vec3 o0 = vec3(d0.z, 0, -d0.x), o1 = vec3(d1.z, 0, -d1.x);
        Vec3 o = vec3_normalize(vec3_add(o0, o1));
        float miter = 1 / fmaxf(0.5f, vec3_dot(o, o1));
        frames[i] = (SweepFrame){path[i], vec3_scale(o, miter), vec3(0, 1, 0)};
    }
    static const Vec2 PROFILE[4] = {
        {0.08f, 0}, {0.06f, 0.115f}, {-0.06f, 0.115f}, {-0.075f, 0.03f}};
    soup_use(s, MAT_CARVED_DARK);
    shape_sweep(s, frames, n, PROFILE, 4, false);
}

// A clipped hedge along a polyline; noise dents it, since no gardener is that exact.
static void add_hedge(Soup *s, const Vec3 *points, int count, float half, float height) {
    enum { FRAMES_MAX = 64 };
    SweepFrame frames[FRAMES_MAX];
    int n = 0;
    for (int k = 0; k + 1 < count; k++) {
        float length = vec3_length(vec3_sub(points[k + 1], points[k]));
        int steps = (int)(length / 1.3f) + 1;
        for (int i = 0; i < steps + (k + 2 == count ? 1 : 0) && n < FRAMES_MAX; i++) {
            Vec3 d0 = vec3_normalize(vec3_sub(points[k + 1], points[k])), d1 = d0;
            if (i == 0 && k > 0) d0 = vec3_normalize(vec3_sub(points[k], points[k - 1]));
            Vec3 o = vec3_normalize(vec3(d0.z + d1.z, 0, -d0.x - d1.x));
            float miter = 1 / fmaxf(0.5f, o.x * d1.z - o.z * d1.x);
            Vec3 p = vec3_lerp(points[k], points[k + 1], (float)i / (float)steps);
            float wide = half * (0.93f + 0.16f * noise_value3(p.x * 1.7f, 1, p.z * 1.7f, 7));
            float tall = height * (0.93f + 0.14f * noise_value3(p.x * 1.3f, 2, p.z * 1.3f, 8));
            frames[n++] = (SweepFrame){p, vec3_scale(o, miter * wide), vec3(0, tall, 0)};
        }
    }
    static const Vec2 PROFILE[6] = {{0.92f, 0},  {1, 0.8f},  {0.72f, 1},
                                    {-0.72f, 1}, {-1, 0.8f}, {-0.92f, 0}};
    soup_use(s, MAT_HEDGE);
    for (int i = 0; i + 1 < n; i++) {
        for (int j = 0; j + 1 < 6; j++) {
            Vec3 q[4];
            for (int c = 0; c < 4; c++) {
                const SweepFrame *f = frames + i + (c >= 2);
                Vec2 p = PROFILE[j + (c == 1 || c == 2)];
                q[c] = vec3_mad(vec3_mad(f->origin, f->a, p.x), f->b, p.y);
            }
            soup_quad_box(s, q[0], q[1], q[2], q[3]);
        }
    }
    for (int end = 0; end < 2; end++) {
        const SweepFrame *f = frames + (end ? n - 1 : 0);
        for (int j = 1; j + 1 < 6; j++) {
            Vec3 p[3];
            const int index[3] = {0, j, j + 1};
            for (int c = 0; c < 3; c++) {
                Vec2 q = PROFILE[index[c]];
                p[c] = vec3_mad(vec3_mad(f->origin, f->a, q.x), f->b, q.y);
            }
            if (end)
                soup_triangle_box(s, p[0], p[1], p[2]);
            else
                soup_triangle_box(s, p[2], p[1], p[0]);
        }
    }
}

// A ball of box, dented like the hedges.
static Vec3 topiary_point(const void *context, float u, float v) {
    const float *ball = context; // x, z, radius
    float angle = u * 2 * PI_F, lat = (v - 0.5f) * PI_F;
    Vec3 d = vec3(cosf(angle) * cosf(lat), sinf(lat), -sinf(angle) * cosf(lat));
    float dent = noise_value3(d.x * 2.6f + ball[0] + 40, d.y * 2.6f + 40, d.z * 2.6f + 40, 9);
    float r = ball[2] * (0.9f + 0.2f * dent);
    return vec3(ball[0] + d.x * r, 0.55f + ball[2] * 0.75f + d.y * r, ball[1] + d.z * r);
}

static void add_topiary(Soup *s, float x, float z, float radius) {
    float ball[3] = {x, z, radius};
    soup_use(s, MAT_HEDGE);
    shape_surface(s, topiary_point, ball, 12, 7, vec2(3, 2));
}

static void add_bed(Soup *s) {
    Affine saved = s->transform, place = affine_translation(BED_CENTER, 0, BED_CENTER);
    s->transform = affine_mul(&saved, &place);
    soup_use(s, MAT_SOIL);
    Vec2 soil[3] = {{BED_RADIUS, 0.1f}, {BED_RADIUS * 0.6f, 0.24f}, {0, 0.28f}};
    shape_turn(s, soil, 3, 14);
    soup_use(s, MAT_CARVED_DARK);
    Vec2 rim[4] = {{BED_RADIUS + 0.14f, 0},
                   {BED_RADIUS + 0.14f, 0.2f},
                   {BED_RADIUS - 0.02f, 0.2f},
                   {BED_RADIUS - 0.02f, 0.08f}};
    shape_turn(s, rim, 4, 18);
    s->transform = saved;
}

void model_make_garden(Model *m) {
    Soup s;
    soup_init(&s);
    soup_use(&s, MAT_GRAVEL);
    // Slightly crowned towards the middle, in tiles small enough for per-object light lists.
    const int n = 6;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            float x0 = -COURT + 24.0f * (float)i / (float)n, x1 = x0 + 24.0f / (float)n;
            float z0 = -COURT + 24.0f * (float)j / (float)n, z1 = z0 + 24.0f / (float)n;
            soup_quad_box(&s, vec3(x0, 0, z1), vec3(x1, 0, z1), vec3(x1, 0, z0), vec3(x0, 0, z0));
        }
    model_add_node(m, "paths", model_add_mesh(m, "paths", &s, 40), vec3(0, 0, 0), 0);
    soup_init(&s);
    add_grass(&s);
    add_kerb(&s);
    const float lo = PATH + 0.65f, hi = OUTER - 0.6f;
    const Vec3 line[5] = {vec3(lo, 0.04f, 5.1f), vec3(lo, 0.04f, hi), vec3(hi, 0.04f, hi),
                          vec3(hi, 0.04f, lo), vec3(5.1f, 0.04f, lo)};
    add_hedge(&s, line, 5, 0.26f, 0.52f);
    add_topiary(&s, lo, 5.1f, 0.42f);
    add_topiary(&s, 5.1f, lo, 0.42f);
    add_topiary(&s, hi, hi, 0.5f);
    add_bed(&s);
    int quarter = model_add_mesh(m, "quarter", &s, 50);
    static const char *const NAMES[4] = {"quarter_se", "quarter_ne", "quarter_nw", "quarter_sw"};
    for (int i = 0; i < 4; i++)
        model_add_node(m, NAMES[i], quarter, vec3(0, 0, 0), 90.0f * (float)i);
}
