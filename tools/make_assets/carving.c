// Columns and vaults: see carving.h. Leaves and twists are displaced lathes; a vault's webs are
// ruled surfaces, so they need few triangles and the arcs stay exact.
#include "carving.h"

typedef struct Capital {
    float y0, y1, r0, r1, start, sweep;
} Capital;

// Two tiers of leaves around a bell. Each leaf swells along its axis, curls out at its tip and
// drops back; the upper tier stands between the lower leaves.
static Vec3 capital_point(const void *context, float u, float v) {
    const Capital *c = context;
    float angle = (c->start + c->sweep * u) * PI_F / 180;
    float height = c->y1 - c->y0, bell = c->r0 + (c->r1 - c->r0) * v * v * 0.75f;
    float lower = powf(0.5f + 0.5f * cosf(4 * angle), 0.8f);
    float upper = powf(0.5f - 0.5f * cosf(4 * angle), 0.8f);
    float low_curl = float_smooth(0.0f, 0.42f, v) * (1 - float_smooth(0.5f, 0.62f, v));
    float high_curl = float_smooth(0.45f, 0.85f, v) * (1 - float_smooth(0.93f, 1.05f, v));
    float swell = (c->r1 - c->r0) * (0.55f * lower * low_curl + 0.75f * upper * high_curl);
    float r = bell + swell;
    return vec3(r * cosf(angle), c->y0 + height * v, -r * sinf(angle));
}

void carve_capital(Soup *s, float y0, float y1, float r0, float r1, int segments, float start_deg,
                   float sweep_deg) {
    Capital c = {y0, y1, r0, r1, start_deg, sweep_deg};
    float around = (r0 + r1) * 0.5f * sweep_deg * PI_F / 180 / s->tile_m;
    shape_surface(s, capital_point, &c, segments, 4, vec2(around, (y1 - y0) / s->tile_m));
}

// An attic base in four points: torus, scotia, torus.
static void carve_base(Soup *s, float y0, float r, int segments, float start, float sweep) {
    Vec2 base[4] = {{r * 1.64f, y0},
                    {r * 1.6f, y0 + r * 0.5f},
                    {r * 1.2f, y0 + r * 0.75f},
                    {r * 1.0f, y0 + r * 1.25f}};
    shape_lathe(s, base, 4, segments, start, sweep);
}

typedef struct Twist {
    float y0, y1, radius, turns;
} Twist;

static Vec3 twist_point(const void *context, float u, float v) {
    const Twist *t = context;
    float angle = u * 2 * PI_F, phase = t->turns * v * 2 * PI_F;
    float fade = float_smooth(0, 0.08f, v) * (1 - float_smooth(0.92f, 1, v));
    float r = t->radius * (1 + 0.17f * fade * cosf(4 * (angle - phase)));
    return vec3(r * cosf(angle), t->y0 + (t->y1 - t->y0) * v, -r * sinf(angle));
}

void carve_column(Soup *s, Vec3 foot, float y1, float radius, float twist) {
    Affine saved = s->transform, place = affine_translation(foot.x, 0, foot.z);
    s->transform = affine_mul(&saved, &place);
    float base_top = foot.y + radius * 1.25f, bell = fmaxf(radius * 3.4f, 0.2f);
    float cap_y = y1 - bell;
    carve_base(s, foot.y, radius, 10, 0, 360);
    if (twist != 0) {
        Twist t = {base_top, cap_y, radius, twist};
        shape_surface(s, twist_point, &t, 12, 6, vec2(1, (cap_y - base_top) / s->tile_m));
    } else {
        Vec2 shaft[2] = {{radius, base_top}, {radius * 0.88f, cap_y}};
        shape_turn(s, shaft, 2, 10);
    }
    Vec2 ring[3] = {{radius * 0.88f, cap_y - radius * 0.3f},
                    {radius * 1.17f, cap_y - radius * 0.12f},
                    {radius * 0.9f, cap_y + radius * 0.08f}};
    shape_turn(s, ring, 3, 10);
    carve_capital(s, cap_y, y1, radius * 0.9f, radius * 1.75f, 16, 0, 360);
    s->transform = saved;
}

void carve_wall_shaft(Soup *s, Vec3 foot, float y1, float radius, float start_deg,
                      float sweep_deg) {
    Affine saved = s->transform, place = affine_translation(foot.x, 0, foot.z);
    s->transform = affine_mul(&saved, &place);
    float bell = fmaxf(radius * 2.6f, 0.22f), cap_y = y1 - bell;
    int segments = (int)(sweep_deg / 30 + 0.5f);
    Vec2 plinth[2] = {{radius * 1.7f, foot.y}, {radius * 1.7f, foot.y + 0.12f}};
    shape_lathe(s, plinth, 2, segments, start_deg, sweep_deg);
    carve_base(s, foot.y + 0.12f, radius, segments, start_deg, sweep_deg);
    Vec2 shaft[2] = {{radius, foot.y + 0.12f + radius * 1.25f}, {radius * 0.92f, cap_y}};
    shape_lathe(s, shaft, 2, segments, start_deg, sweep_deg);
    carve_capital(s, cap_y, y1 - 0.06f, radius * 0.92f, radius * 1.5f, segments * 3 / 2, start_deg,
                  sweep_deg);
    Vec2 abacus[4] = {
        {radius * 1.5f, y1 - 0.07f}, {radius * 1.9f, y1 - 0.05f}, {radius * 1.9f, y1}, {0, y1}};
    shape_lathe(s, abacus, 4, segments, start_deg, sweep_deg);
    s->transform = saved;
}

typedef struct Rosette {
    Vec3 center;
    float radius, depth, petals, facing;
} Rosette;

static Vec3 rosette_point(const void *context, float u, float v) {
    const Rosette *r = context;
    float angle = u * 2 * PI_F, petal = fabsf(cosf(angle * r->petals * 0.5f));
    // Petals part from the heart outwards; the rim lies in the wall.
    float dist = v * r->radius * (1 - 0.22f * (1 - petal) * v * v);
    float heart = 0.8f * float_smooth(0.26f, 0.0f, v);
    float bulge = sinf(float_clamp((v - 0.2f) / 0.8f, 0, 1) * PI_F);
    float relief = heart + bulge * (0.25f + 0.6f * sqrtf(petal)) + 0.12f * (1 - v);
    if (v > 0.99f) relief = -0.02f;
    return vec3(r->center.x + dist * cosf(angle) * -r->facing, r->center.y + dist * sinf(angle),
                r->center.z + r->facing * r->depth * relief);
}

void carve_rosette(Soup *s, Vec3 center, float radius, float depth, int petals, float facing) {
    Rosette r = {center, radius, depth, (float)petals, facing};
    shape_surface(s, rosette_point, &r, petals * 4, 4, vec2(1, radius / s->tile_m));
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
    Vec2 profile[6] = {{d * 0.25f, w},   {-d * 0.45f, w},  {-d, w * 0.42f},
                       {-d, -w * 0.42f}, {-d * 0.45f, -w}, {d * 0.25f, -w}};
    shape_arch_moulding(s, &unit, profile, 6, segments, 0, -1);
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
    carve_capital(s, 0, depth * 1.25f, width * 0.9f, width * 1.15f, 8, 0, 360);
    Vec2 cap[3] = {{width * 1.05f, depth * 1.25f}, {width * 0.6f, depth * 1.5f}, {0, depth * 1.6f}};
    shape_turn(s, cap, 3, 10);
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
