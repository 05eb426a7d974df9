// light_rank.c: which lights are worth their price: dropping, budget, and the decision as a whole.
// Data in: a scene, visible candidates, pairs that are held. Data out: by row the share of its
// brightness that shall be shown, and why. Called by: packet_lights.c (a packet without memory) and
// light_manager.c (the state). Does not: know time; cull; touch directional lights.
//
// Lights here are units: single lights, and merged ones for pairs that shall be merged. A pair that
// splits is two units again.
#include "light_decide.h"
#include "../base/clock.h"
#include <string.h>

#define AREA_INSIDE 1e30f
// A light's contribution is that on a surface so far away, or a pixel's width if that is more:
// nothing nearer is resolved.
#define CONTRIBUTION_AT_M 0.25f
// A light in a cell that a surface passes through is taken to be so far from it.
#define NEAREST_SURFACE_M 0.05f
// Importance above that of the most important refused light, as a part of it, at which a light is
// shown in full.
#define BUDGET_BAND 0.25f

LightManagerConfig light_manager_config(const World *world) {
    const LightManagerTable *t = WORLD_TABLE(world, LightManager, light_manager);
    bool present = t->table.count > 0;
#define READ_(type, name, unit, initial, ...)                                                      \
    .name = present ? t->name[0] : (Column##type)(initial),
    return (LightManagerConfig){LIGHT_MANAGER_COLUMNS(READ_)};
#undef READ_
}

LightDecision light_decision_make(u32 count, Arena *scratch) {
    LightDecision d = {.partner = ARENA_PUSH(scratch, u32, count),
                       .pair_error = ARENA_PUSH(scratch, f32, count),
                       .pair_weight = ARENA_PUSH(scratch, f32, count),
                       .weight = ARENA_PUSH(scratch, f32, count),
                       .fate = ARENA_PUSH(scratch, u8, count)};
    memset(d.partner, 0xFF, count * sizeof(u32)); // ROW_NONE
    for (u32 i = 0; i < count; i++) d.weight[i] = 1.0f;
    return d;
}

// ---- drop ----

f32 light_attenuation(const LightScene *scene, f32 d, f32 range) {
    f32 x = d / range, x2 = x * x, window = f32_saturate(1.0f - x2);
    switch (scene->attenuation) {
    case ATTENUATION_WINDOW:
        return window;
    case ATTENUATION_POLYNOMIAL: {
        const f32 *k = scene->falloff;
        return window / MAX(k[0] + k[1] * d + k[2] * d * d, 1e-6f);
    }
    default:
        window = f32_saturate(1.0f - x2 * x2);
        return window * window / MAX(d * d, 1e-4f);
    }
}

f32 light_area_px(const LightScene *scene, Vec3 center, f32 radius) {
    Vec3 to = vec3_sub(center, scene->view.position);
    f32 rest2 = vec3_dot(to, to) - radius * radius;
    if (!(rest2 > 0.0f)) return AREA_INSIDE;
    return MIN(PI_F * scene->focal_px * scene->focal_px * radius * radius / rest2, AREA_INSIDE);
}

// From the eye to the nearest point of a sphere; at least the near plane's distance.
static f32 nearest_distance(const LightScene *scene, Vec3 center, f32 radius) {
    f32 distance = vec3_length(vec3_sub(center, scene->view.position)) - radius;
    return MAX(distance, scene->view.near);
}

static f32 brightest(Vec3 color) {
    return MAX(MAX(fabsf(color.x), fabsf(color.y)), fabsf(color.z));
}

static f32 peak(const LightScene *scene, Vec3 center, f32 radius, Vec3 color, f32 range) {
    f32 pixel_m = nearest_distance(scene, center, radius) / scene->focal_px;
    f32 at = MAX(pixel_m, CONTRIBUTION_AT_M);
    // A range that ends before: half of it.
    at = MIN(at, 0.5f * range);
    return brightest(color) * light_attenuation(scene, at, range) * scene->white;
}

f32 light_brightest(const LightScene *scene, u32 row) {
    const LightTable *light = scene->light;
    f32 range = light->reach[row];
    Vec3 place = {light->x[row], light->y[row], light->z[row]};
    f32 h = light_surface_distance(scene->surfaces, place, CONTRIBUTION_AT_M);
    h = MIN(MAX(h, NEAREST_SURFACE_M), 0.5f * range);
    // Not as bright as it is now: one that flickers is at its brightest soon.
    f32 factor = light->intensity[row] * MAX(light->gain[row], 1.0f);
    Vec3 color = {light->color_r[row], light->color_g[row], light->color_b[row]};
    return 2.0f * scene->white * fabsf(factor) * brightest(color) *
           light_attenuation(scene, h, range);
}

// 0 up to the threshold, 1 from twice the threshold on.
static f32 band(f32 value, f32 threshold) {
    return threshold > 0.0f ? f32_saturate(value / threshold - 1.0f) : 1.0f;
}

f32 light_drop_weight(const LightScene *scene, Vec3 center, f32 radius, Vec3 color, f32 range) {
    f32 area = band(light_area_px(scene, center, radius), scene->config.drop_area);
    f32 contribution =
        band(peak(scene, center, radius, color, range), scene->config.drop_contribution);
    return MIN(area, contribution);
}

// ---- budget ----

f32 light_importance(const LightScene *scene, Vec3 center, f32 radius, Vec3 color, f32 range,
                     f32 priority) {
    // An eye within the light sees it all around: no more than the whole reference picture.
    f32 area = MIN(light_area_px(scene, center, radius), (f32)REGION_COUNT * REGION_PX * REGION_PX);
    f32 nearness = 1.0f / (1.0f + nearest_distance(scene, center, radius));
    return sqrtf(area) * peak(scene, center, radius, color, range) * nearness * MAX(priority, 0.0f);
}

typedef struct RegionRect {
    u8 x0, y0, x1, y1; // inclusive; x0 > x1 = none
} RegionRect;

static RegionRect region_rect(const PacketView *view, Vec3 center, f32 radius) {
    Vec3 to = vec3_sub(center, view->position);
    f32 z = -vec3_dot(to, view->forward), x0, x1, y0, y1;
    if (!sphere_bounds_axis(vec3_dot(to, view->right), z, radius, view->near, 1.0f / view->tan_x,
                            &x0, &x1) ||
        !sphere_bounds_axis(vec3_dot(to, view->up), z, radius, view->near, 1.0f / view->tan_y, &y0,
                            &y1))
        return (RegionRect){1, 1, 0, 0};
#define REGION(ndc, count) (u8) CLAMP(((ndc)*0.5f + 0.5f) * (count), 0.0f, (count)-1.0f)
    return (RegionRect){REGION(x0, REGIONS_X), REGION(-y1, REGIONS_Y), REGION(x1, REGIONS_X),
                        REGION(-y0, REGIONS_Y)};
#undef REGION
}

typedef struct RankItem {
    u32 key, index;
} RankItem;

// Least significant byte first; stable.
static RankItem *sort_items(RankItem *items, RankItem *spare, u32 count) {
    for (u32 shift = 0; shift < 32; shift += 8) {
        u32 places[256] = {0};
        for (u32 i = 0; i < count; i++) places[items[i].key >> shift & 255]++;
        for (u32 value = 0, sum = 0; value < 256; value++) {
            u32 here = places[value];
            places[value] = sum, sum += here;
        }
        for (u32 i = 0; i < count; i++) spare[places[items[i].key >> shift & 255]++] = items[i];
        RankItem *swap = items;
        items = spare, spare = swap;
    }
    return items;
}

// Most important first, pinned ones before all, equal ones in their order.
static RankItem *rank(const BudgetLight *lights, u32 count, Arena *scratch) {
    RankItem *items = ARENA_PUSH(scratch, RankItem, count),
             *spare = ARENA_PUSH(scratch, RankItem, count);
    for (u32 i = 0; i < count; i++) {
        f32 importance = MAX(lights[i].importance, 0.0f); // the bits of such sort like numbers
        u32 bits;
        memcpy(&bits, &importance, sizeof bits);
        items[i] = (RankItem){lights[i].pinned ? 0 : ~bits, i};
    }
    return sort_items(items, spare, count);
}

void light_budget(const LightScene *scene, const BudgetLight *lights, u32 count, u32 budget,
                  f32 *weight, Arena *scratch) {
    for (u32 i = 0; i < count; i++) weight[i] = 1.0f;
    if (budget == 0) return;
    u64 mark = arena_mark(scratch);
    u32 *taken = ARENA_PUSH(scratch, u32, REGION_COUNT);
    f32 *refused = ARENA_PUSH(scratch, f32, REGION_COUNT); // importance of the first, 0 = none
    RegionRect *rects = ARENA_PUSH(scratch, RegionRect, count);
    const RankItem *items = rank(lights, count, scratch);
    for (u32 k = 0; k < count; k++) {
        u32 i = items[k].index;
        RegionRect r = rects[i] = region_rect(&scene->view, lights[i].center, lights[i].radius);
        if (r.x0 > r.x1) continue;
        bool full = false;
        for (u32 y = r.y0; y <= r.y1 && !lights[i].pinned; y++)
            for (u32 x = r.x0; x <= r.x1; x++) {
                u32 region = y * REGIONS_X + x;
                if (taken[region] < budget) continue;
                full = true;
                if (refused[region] == 0.0f) refused[region] = lights[i].importance;
            }
        if (full) weight[i] = 0.0f;
        for (u32 y = r.y0; y <= r.y1 && !full; y++)
            for (u32 x = r.x0; x <= r.x1; x++) taken[y * REGIONS_X + x]++;
    }
    // The last ones before the cut fade, so that two that change places do not pop.
    for (u32 i = 0; i < count; i++) {
        RegionRect r = rects[i];
        if (weight[i] == 0.0f || lights[i].pinned || r.x0 > r.x1) continue;
        f32 limit = 0.0f;
        for (u32 y = r.y0; y <= r.y1; y++)
            for (u32 x = r.x0; x <= r.x1; x++) limit = MAX(limit, refused[y * REGIONS_X + x]);
        if (limit > 0.0f)
            weight[i] = f32_saturate((lights[i].importance / limit - 1.0f) / BUDGET_BAND);
    }
    arena_rewind(scratch, mark);
}

// ---- the decision ----

typedef struct Units {
    u32 *row;   // [count] of a merged light: of its first partner
    f32 *drop;  // [count] weight that dropping leaves
    u8 *merged; // [count]
    BudgetLight *measures;
    Vec3 *color;
    f32 *range;
    u32 count;
} Units;

static Units gather_units(const LightScene *scene, const LightDecision *d, Arena *scratch) {
    const LightTable *light = scene->light;
    const LightCandidates *c = &scene->candidates;
    u32 cap = scene->count;
    Units u = {ARENA_PUSH(scratch, u32, cap),
               ARENA_PUSH(scratch, f32, cap),
               ARENA_PUSH(scratch, u8, cap),
               ARENA_PUSH(scratch, BudgetLight, cap),
               ARENA_PUSH(scratch, Vec3, cap),
               ARENA_PUSH(scratch, f32, cap),
               0};
    for (u32 row = 0; row < scene->count; row++) {
        u32 i = u.count, other = d->partner[row];
        bool merged = other != ROW_NONE && d->pair_weight[row] > 0.0f;
        if (merged && other < row) continue;
        u.row[i] = row;
        u.drop[i] = 1.0f;
        u.merged[i] = merged;
        if (merged) {
            MergedLight m = light_merge_pair(light, c, row, other);
            if (m.radius < 0.0f) continue;
            u.measures[i] = (BudgetLight){.center = m.center, .radius = m.radius};
            u.color[i] = m.color;
            u.range[i] = m.range;
        } else {
            if (c->radius[row] < 0.0f) continue;
            u.measures[i] = (BudgetLight){.center = vec3(c->x[row], c->y[row], c->z[row]),
                                          .radius = c->radius[row],
                                          .pinned = light_pinned(light, row)};
            u.color[i] = vec3(c->r[row], c->g[row], c->b[row]);
            u.range[i] = light->reach[row];
        }
        u.count++;
    }
    return u;
}

// Only visible units compete: seen by row, a merged one if either partner is.
static void decide_budget(const LightScene *scene, const LightDecideDesc *desc,
                          const LightDecision *d, const Units *u, f32 *weight, Arena *scratch) {
    u8 *seen = ARENA_PUSH(scratch, u8, scene->count);
    for (u32 i = 0; i < desc->row_count; i++) seen[desc->rows[i]] = 1;
    BudgetLight *lights = ARENA_PUSH(scratch, BudgetLight, u->count);
    u32 *unit = ARENA_PUSH(scratch, u32, u->count), count = 0;
    for (u32 i = 0; i < u->count; i++) {
        u32 row = u->row[i];
        weight[i] = 1.0f;
        bool visible = seen[row] || (u->merged[i] && seen[d->partner[row]]);
        if (!visible || u->drop[i] == 0.0f) continue;
        f32 priority = scene->light->priority[row];
        if (u->merged[i]) priority = MAX(priority, scene->light->priority[d->partner[row]]);
        lights[count] = u->measures[i];
        lights[count].importance =
            light_importance(scene, u->measures[i].center, u->measures[i].radius, u->color[i],
                             u->range[i], priority);
        unit[count++] = i;
    }
    f32 *result = ARENA_PUSH(scratch, f32, count);
    light_budget(scene, lights, count, desc->budget, result, scratch);
    for (u32 i = 0; i < count; i++) weight[unit[i]] = result[i];
}

static f32 lap_ms(f64 *start_ms) {
    f64 now = clock_now_ms(), lap = now - *start_ms;
    *start_ms = now;
    return (f32)lap;
}

LightDecision light_decide(const LightScene *scene, const LightDecideDesc *desc, f32 *ms,
                           Arena *scratch) {
    LightDecision d = light_decision_make(scene->count, scratch);
    u64 mark = arena_mark(scratch);
    f64 clock_ms = clock_now_ms();
    if (desc->merge) light_merge_find(scene, desc->held, desc->rows, desc->row_count, &d, scratch);
    ms[LIGHT_STAGE_MERGE] = lap_ms(&clock_ms);

    for (u32 row = 0; row < scene->count; row++)
        if (d.pair_weight[row] > 0.0f) d.weight[row] = 0.0f; // also of pairs that are dark now
    Units u = gather_units(scene, &d, scratch);
    for (u32 i = 0; i < u.count && desc->drop; i++)
        if (!u.measures[i].pinned)
            u.drop[i] = light_drop_weight(scene, u.measures[i].center, u.measures[i].radius,
                                          u.color[i], u.range[i]);
    ms[LIGHT_STAGE_DROP] = lap_ms(&clock_ms);

    f32 *weight = ARENA_PUSH(scratch, f32, u.count);
    for (u32 i = 0; i < u.count; i++) weight[i] = 1.0f;
    if (desc->budget > 0) decide_budget(scene, desc, &d, &u, weight, scratch);
    for (u32 i = 0; i < u.count; i++) {
        u32 row = u.row[i];
        f32 shown = u.drop[i] * weight[i];
        u8 fate = u.drop[i] == 0.0f ? LIGHT_DROPPED
                  : shown == 0.0f   ? LIGHT_OVER_BUDGET
                                    : LIGHT_KEPT;
        if (!u.merged[i]) {
            d.weight[row] = shown;
            d.fate[row] = fate;
            continue;
        }
        u32 rows[2] = {row, d.partner[row]};
        for (u32 k = 0; k < 2; k++) {
            d.weight[rows[k]] = 0.0f;
            d.pair_weight[rows[k]] = shown;
            d.fate[rows[k]] = fate; // of what stands for it
        }
    }
    ms[LIGHT_STAGE_BUDGET] = lap_ms(&clock_ms);
    arena_rewind(scratch, mark);
    return d;
}
