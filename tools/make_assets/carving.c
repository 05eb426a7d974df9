// Columns and vaults: see carving.h. A vault's webs are ruled surfaces, so they need few triangles
// and the arcs stay exact.
#include "carving.h"

#include <stdlib.h>

// A turned and carved shaft is one skin of rows over a fixed number of edges: corners that the rows
// share keep it cheap, and let it lose detail evenly in the distance. Leaves and rolls have their
// ridges on the even edges and their valleys on the odd ones, so that few edges draw them well.
typedef struct SkinRow {
    float y, ridge, valley; // radii of even and odd edges
    float turn;             // of the whole row, in turns
} SkinRow;

#define SKIN_ROWS_MAX 24

typedef struct Skin {
    SkinRow rows[SKIN_ROWS_MAX];
    int count;
} Skin;

static void skin_row(Skin *k, float y, float ridge, float valley, float turn) {
    if (k->count == SKIN_ROWS_MAX) abort();
    k->rows[k->count++] = (SkinRow){y, ridge, valley, turn};
}

// Two tiers of leaves around a bell that widens from r0 to r1: the upper tier stands between the
// lower leaves.
static void skin_capital(Skin *k, float y0, float y1, float r0, float r1, float turn) {
    float height = y1 - y0, wide = r1 - r0;
    skin_row(k, y0, r0, r0, turn);
    skin_row(k, y0 + height * 0.45f, r0 + wide * 0.8f, r0, turn);
    skin_row(k, y0 + height * 0.85f, r0 + wide * 0.4f, r0 + wide * 1.25f, turn);
    skin_row(k, y1, r1 - wide * 0.1f, r1 - wide * 0.1f, turn);
}

static void skin_add(Soup *s, const Skin *k, int edges, float start_deg, float sweep_deg) {
    float widest = 0, along = 0;
    for (int j = 0; j < k->count; j++) widest = fmaxf(widest, k->rows[j].ridge);
    float around = 0.7f * widest * sweep_deg * PI_F / 180 / s->tile_m;
    soup_carve(s, 66);
    for (int j = 0; j + 1 < k->count; j++) {
        const SkinRow *pair[2] = {k->rows + j, k->rows + j + 1};
        float dr = pair[1]->ridge - pair[0]->ridge, dy = pair[1]->y - pair[0]->y;
        float v[2] = {along / s->tile_m, 0};
        along += sqrtf(dr * dr + dy * dy);
        v[1] = along / s->tile_m;
        for (int i = 0; i < edges; i++) {
            Vec3 p[2][2];
            Vec2 uv[2][2];
            for (int c = 0; c < 4; c++) {
                int edge = i + (c & 1), row = c >> 1;
                float u = (float)edge / (float)edges + pair[row]->turn;
                float a = (start_deg + sweep_deg * u) * PI_F / 180;
                float r = edge & 1 ? pair[row]->valley : pair[row]->ridge;
                p[row][c & 1] = vec3(r * cosf(a), pair[row]->y, -r * sinf(a));
                uv[row][c & 1] = vec2(u * around, v[row]);
            }
            soup_quad(s, p[0][0], p[0][1], p[1][1], p[1][0], uv[0][0], uv[0][1], uv[1][1],
                      uv[1][0]);
        }
    }
    soup_smooth(s, 0);
}

void carve_column(Soup *s, Vec3 foot, float y1, float radius, float twist) {
    Affine saved = s->transform, place = affine_translation(foot.x, 0, foot.z);
    s->transform = affine_mul(&saved, &place);
    bool round = radius > 0.1f; // the thick ones stand alone and get a closer look
    float r = radius, y0 = foot.y, base_top = y0 + r * 1.25f, cap_y = y1 - fmaxf(r * 3.4f, 0.2f);
    Skin k = {.count = 0};
    skin_row(&k, y0, r * 1.62f, r * 1.62f, 0);
    if (round) skin_row(&k, y0 + r * 0.55f, r * 1.56f, r * 1.56f, 0);
    skin_row(&k, base_top, r, r, 0);
    float top = cap_y - r * 0.3f, turn = 0;
    if (twist != 0) {
        const int steps = (int)(fabsf(twist) * 6 + 0.5f);
        turn = twist;
        for (int i = 0; i <= steps; i++) {
            float t = (float)i / (float)steps, end = i == 0 || i == steps ? 0.1f : 1;
            skin_row(&k, float_lerp(base_top + r * 0.3f, top - r * 0.3f, t), r * (1 + 0.14f * end),
                     r * (1 - 0.2f * end), turn * t);
        }
    }
    skin_row(&k, top, r * 0.9f, r * 0.9f, turn);
    skin_row(&k, cap_y - r * 0.1f, r * 1.2f, r * 1.2f, turn);
    skin_capital(&k, cap_y + r * 0.1f, y1, r * 0.9f, r * 1.75f, turn);
    skin_add(s, &k, round ? 12 : 8, 0, 360);
    s->transform = saved;
}

void carve_wall_shaft(Soup *s, Vec3 foot, float y1, float radius, float start_deg,
                      float sweep_deg) {
    Affine saved = s->transform, place = affine_translation(foot.x, 0, foot.z);
    s->transform = affine_mul(&saved, &place);
    float r = radius, y0 = foot.y, cap_y = y1 - fmaxf(r * 2.6f, 0.22f);
    Skin k = {.count = 0};
    skin_row(&k, y0, r * 1.7f, r * 1.7f, 0);
    skin_row(&k, y0 + 0.12f + r * 0.5f, r * 1.62f, r * 1.62f, 0);
    skin_row(&k, y0 + 0.12f + r * 1.25f, r, r, 0);
    skin_row(&k, cap_y, r * 0.92f, r * 0.92f, 0);
    float wide = r * 0.58f, height = y1 - 0.06f - cap_y;
    skin_row(&k, cap_y + height * 0.45f, r + wide * 0.7f, r + wide * 0.1f, 0);
    skin_row(&k, cap_y + height * 0.85f, r + wide * 0.5f, r + wide * 1.15f, 0);
    skin_row(&k, y1 - 0.06f, r * 1.9f, r * 1.9f, 0);
    skin_row(&k, y1, r * 1.9f, r * 1.9f, 0);
    int edges = (int)(sweep_deg / 45 + 0.5f);
    skin_add(s, &k, edges < 4 ? edges + 1 : edges, start_deg, sweep_deg);
    s->transform = saved;
}

void carve_bud(Soup *s, float y0, float y1, float r0, float r1) {
    Skin k = {.count = 0};
    skin_capital(&k, y0, y1, r0, r1, 0);
    skin_add(s, &k, 8, 0, 360);
}

#define SMALL_ROSETTE 0.141f // radius in m, below which a flower has no hollow

typedef struct Rosette {
    Vec3 center;
    float radius, depth, petals, facing;
} Rosette;

// v: 0 the heart, 1/3 its hollow (which small flowers do not have), 2/3 the petals' crest, 1 the
// rim, which lies in the wall. Three edges to a petal: the valley before it and its two shoulders.
static Vec3 rosette_point(const void *context, float u, float v) {
    const Rosette *r = context;
    int ring = (int)(v * 3 + 0.5f);
    if (r->radius < SMALL_ROSETTE) ring = v < 0.25f ? 0 : v < 0.75f ? 2 : 3;
    int edge = (int)(u * r->petals * 3 + 0.5f) % 3;
    float angle = u * 2 * PI_F, petal = edge ? 1 : 0;
    const float dist[4] = {0, 0.26f, 0.5f + 0.2f * petal, 0.72f + 0.28f * petal};
    const float relief[4] = {r->radius < SMALL_ROSETTE ? 0.2f : 0.9f, 0.15f, 0.05f + 0.95f * petal,
                             -0.02f};
    float d = dist[ring] * r->radius;
    return vec3(r->center.x + d * cosf(angle) * -r->facing, r->center.y + d * sinf(angle),
                r->center.z + r->facing * r->depth * relief[ring]);
}

void carve_rosette(Soup *s, Vec3 center, float radius, float depth, int petals, float facing) {
    Rosette r = {center, radius, depth, (float)petals, facing};
    soup_carve(s, 70);
    shape_surface(s, rosette_point, &r, petals * 3, radius < SMALL_ROSETTE ? 2 : 3,
                  vec2(1, radius / s->tile_m));
    soup_smooth(s, 0);
}

// ---- vaults -------------------------------------------------------------------------------------

static void quad_down(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec2 ua, Vec2 ub, Vec2 uc, Vec2 ud) {
    Vec3 n = vec3_add(vec3_cross(vec3_sub(b, a), vec3_sub(c, a)),
                      vec3_cross(vec3_sub(c, a), vec3_sub(d, a)));
    if (n.y < 0)
        soup_quad(s, a, b, c, d, ua, ub, uc, ud);
    else
        soup_quad(s, d, c, b, a, ud, uc, ub, ua);
}

// In each of the four cells the courses run straight from the diagonal to the edge, at the height
// of the edge's arch: the intersection of two barrels of equal rise.
void carve_vault_webs(Soup *s, const Vault *v, int segments) {
    Arch unit = {1, 0, v->pointed};
    float apex = arch_rise(&unit, 0), k = 1 / s->tile_m;
    float cx = (v->x0 + v->x1) / 2, cz = (v->z0 + v->z1) / 2;
    float hx = (v->x1 - v->x0) / 2, hz = (v->z1 - v->z0) / 2;
    for (int cell = 0; cell < 4; cell++) {
        bool along_x = cell < 2; // courses run along x, the edge arch spans z
        float side = cell & 1 ? 1.0f : -1.0f, arc = 0;
        for (int i = 0; i < segments; i++) {
            Vec2 p = arch_point(&unit, 0, (float)i / (float)segments);
            Vec2 q = arch_point(&unit, 0, (float)(i + 1) / (float)segments);
            float hp = v->spring_y + v->rise * p.y / apex, hq = v->spring_y + v->rise * q.y / apex;
            float half = along_x ? hz : hx, run = along_x ? hx : hz;
            float dx = (q.x - p.x) * half, dy = hq - hp, step = sqrtf(dx * dx + dy * dy);
            float pa = fabsf(p.x), qa = fabsf(q.x);
            Vec3 outer_p, outer_q, inner_p, inner_q;
            if (along_x) {
                outer_p = vec3(cx + side * hx, hp, cz + p.x * hz);
                outer_q = vec3(cx + side * hx, hq, cz + q.x * hz);
                inner_p = vec3(cx + side * hx * pa, hp, cz + p.x * hz);
                inner_q = vec3(cx + side * hx * qa, hq, cz + q.x * hz);
            } else {
                outer_p = vec3(cx + p.x * hx, hp, cz + side * hz);
                outer_q = vec3(cx + q.x * hx, hq, cz + side * hz);
                inner_p = vec3(cx + p.x * hx, hp, cz + side * hz * pa);
                inner_q = vec3(cx + q.x * hx, hq, cz + side * hz * qa);
            }
            float v0 = arc * k, v1 = (arc + step) * k;
            arc += step;
            quad_down(s, outer_p, outer_q, inner_q, inner_p, vec2(run * k, v0), vec2(run * k, v1),
                      vec2(run * qa * k, v1), vec2(run * pa * k, v0));
        }
    }
}

// Ribs are arches of unit span, stretched to their place; the profile hangs below the web and
// bites a little into it, so that no slit shows.
static void carve_rib(Soup *s, const Vault *v, Affine place, float half, float width, float depth,
                      int segments) {
    Affine saved = s->transform;
    float tile = s->tile_m;
    Arch unit = {1, 0, v->pointed};
    float scale_y = v->rise / arch_rise(&unit, 0), d = depth / half, w = width / 2;
    Affine stretch = affine_scaling(half, scale_y, 1);
    s->transform = affine_mul(&saved, &place);
    s->transform = affine_mul(&s->transform, &stretch);
    s->tile_m = tile / half;
    Vec2 profile[4] = {{d * 0.2f, w}, {-d, w * 0.5f}, {-d, -w * 0.5f}, {d * 0.2f, -w}};
    soup_smooth(s, 72);
    shape_arch_moulding(s, &unit, profile, 4, segments, 0, -1);
    soup_smooth(s, 0);
    s->tile_m = tile;
    s->transform = saved;
}

void carve_vault_diagonals(Soup *s, const Vault *v, float width, float depth, int segments) {
    float cx = (v->x0 + v->x1) / 2, cz = (v->z0 + v->z1) / 2;
    float hx = (v->x1 - v->x0) / 2, hz = (v->z1 - v->z0) / 2, half = sqrtf(hx * hx + hz * hz);
    for (int k = 0; k < 2; k++) {
        float angle = atan2f(hz, hx) * 180 / PI_F;
        Affine place = affine_turn_y(k ? angle : -angle);
        place.t = vec3(cx, v->spring_y, cz);
        carve_rib(s, v, place, half, width, depth, segments);
    }
    // The boss hides the crossing.
    Affine saved = s->transform, place = affine_turn_x(180);
    place.t = vec3(cx, v->spring_y + v->rise + 0.02f, cz);
    s->transform = affine_mul(&saved, &place);
    soup_smooth(s, 60);
    Vec2 cap[3] = {{width * 0.8f, 0}, {width * 1.1f, depth * 1.3f}, {0, depth * 1.6f}};
    shape_turn(s, cap, 3, 6);
    soup_smooth(s, 0);
    s->transform = saved;
}

void carve_vault_rib_z(Soup *s, const Vault *v, float x, float width, float depth, int segments) {
    Affine place = affine_turn_y(-90);
    place.t = vec3(x, v->spring_y, (v->z0 + v->z1) / 2);
    carve_rib(s, v, place, (v->z1 - v->z0) / 2, width, depth, segments);
}

void carve_vault_rib_x(Soup *s, const Vault *v, float z, float width, float depth, int segments) {
    Affine place = affine_translation((v->x0 + v->x1) / 2, v->spring_y, z);
    carve_rib(s, v, place, (v->x1 - v->x0) / 2, width, depth, segments);
}
