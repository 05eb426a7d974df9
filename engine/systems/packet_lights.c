// packet_lights.c: the light manager of a frame: from the level's lights to those that it shades.
// Data in: the light table (with derived columns), settings, the view, the state's decisions or
// none. Data out: light records in a stable order (by LIGHT_CLASSES, in row order within a class, a
// merged light at its first partner's place), counts and marks of what became of each light, the GI
// lights, the directional lights. Called by: packet_build. Does not: decide what is merged, dropped
// or over budget (light_decide.h), or which tiles a light touches.
//
// Stages, each over whole arrays: candidates, frustum, occluders, then the shares of brightness
// that merging, dropping and the budget left, then level of detail and classes. The state's
// decisions are those of all stages together; a packet that switches one off, or wants another
// budget, has the decision made afresh for itself.
#include "light_manager_state.h"
#include "../base/clock.h"
#include "../base/log.h"
#include <string.h>

typedef struct LightCull {
    const PacketBuildDesc *desc;
    const PacketView *view;
    const OcclusionBuffer *occlusion; // NULL = nothing hides
    const LightTable *light;
    const GiParams *gi;
    LightCandidates candidates;
    LightDecision decision;
    LightManagerConfig config;
    u8 *seen;   // [rows] 1 = inside the view, 2 = and not hidden
    u8 *traced; // [rows] 1 = its shadow on the screen comes from the voxels
    // Pairs, in the order of their first partners' rows.
    MergedLight *merged;
    u32 *merged_row; // first partner
    u8 *merged_seen;
    u32 merged_count;
} LightCull;

static f32 lap_ms(f64 *start_ms) {
    f64 now = clock_now_ms(), lap = now - *start_ms;
    *start_ms = now;
    return (f32)lap;
}

// ---- frustum, occluders ----

static u32 mark_rows(u8 *marks, const u32 *rows, u32 count, u8 mark) {
    for (u32 i = 0; i < count; i++) marks[rows[i]] = mark;
    return count;
}

// rows[padded count]: those that are seen, ascending. Returns how many.
static u32 cull_rows(LightCull *cull, LightParts *parts, u32 *rows, f64 *clock_ms, Arena *scratch) {
    const LightCandidates *c = &cull->candidates;
    const RenderSettings *settings = &cull->desc->settings;
    Frustum everywhere = {.count = 0};
    bool cuts = settings->manager && settings->light_culling;
    u32 count = cull_spheres(cuts ? &cull->view->frustum : &everywhere, c->x, c->y, c->z, c->radius,
                             cull->light->table.count, rows);
    parts->visible = mark_rows(cull->seen, rows, count, 1);
    parts->stage_ms[LIGHT_STAGE_FRUSTUM] = lap_ms(clock_ms);
    if (settings->manager && settings->occlusion)
        count = occlusion_cull(cull->occlusion, c->x, c->y, c->z, c->radius, rows, count, scratch);
    parts->occluded = parts->visible - mark_rows(cull->seen, rows, count, 2);
    parts->stage_ms[LIGHT_STAGE_OCCLUSION] = lap_ms(clock_ms);
    return count;
}

// Merged lights have spheres of their own, wider than their partners'.
static void collect_merged(LightCull *cull, Arena *scratch) {
    const LightDecision *d = &cull->decision;
    u32 rows = cull->light->table.count, count = 0;
    for (u32 row = 0; row < rows; row++)
        count += d->partner[row] != ROW_NONE && row < d->partner[row] && d->pair_weight[row] > 0.0f;
    u64 padded = ALIGN_UP(count, SIMD_WIDTH);
    cull->merged = ARENA_PUSH(scratch, MergedLight, count);
    cull->merged_row = ARENA_PUSH(scratch, u32, count);
    cull->merged_seen = ARENA_PUSH(scratch, u8, count);
    f32 *sphere[4];
    for (u32 i = 0; i < 4; i++) sphere[i] = ARENA_PUSH_COLUMN(scratch, f32, padded);
    for (u32 row = 0; row < rows; row++) {
        u32 other = d->partner[row];
        if (other == ROW_NONE || row > other || !(d->pair_weight[row] > 0.0f)) continue;
        MergedLight m = light_merge_pair(cull->light, &cull->candidates, row, other);
        u32 i = cull->merged_count++;
        cull->merged[i] = m;
        cull->merged_row[i] = row;
        sphere[0][i] = m.center.x, sphere[1][i] = m.center.y, sphere[2][i] = m.center.z;
        sphere[3][i] = m.radius;
    }
    const RenderSettings *settings = &cull->desc->settings;
    Frustum everywhere = {.count = 0};
    u32 *seen = ARENA_PUSH(scratch, u32, padded);
    u32 seen_count = cull_spheres(settings->light_culling ? &cull->view->frustum : &everywhere,
                                  sphere[0], sphere[1], sphere[2], sphere[3], count, seen);
    if (settings->occlusion)
        seen_count = occlusion_cull(cull->occlusion, sphere[0], sphere[1], sphere[2], sphere[3],
                                    seen, seen_count, scratch);
    mark_rows(cull->merged_seen, seen, seen_count, 1);
}

// ---- decisions ----

static LightDecision read_state(const LightManagerState *state, const World *world,
                                const LightTable *light, Arena *scratch) {
    u32 count = light->table.count, ticks = world->tick - state->tick;
    LightDecision d = light_decision_make(count, scratch);
    for (u32 row = 0; row < count; row++) {
        const LightSlot *slot = light_slot(state, light->table.entity[row]);
        if (!slot) continue; // came after the last step
        d.weight[row] = light_slot_weight(slot, ticks);
        d.fate[row] = (u8)slot->fate;
        if (!slot->partner) continue;
        u32 other = table_row(&light->table, slot->partner);
        if (other == ROW_NONE) continue;
        d.partner[row] = other;
        d.pair_weight[row] = light_slot_pair_weight(slot, ticks);
        d.pair_error[row] = slot->pair_error;
    }
    return d;
}

static bool state_serves(const PacketBuildDesc *desc, const LightManagerConfig *config) {
    const RenderSettings *s = &desc->settings;
    return desc->light_manager && s->light_culling && s->occlusion && s->merge && s->drop &&
           (s->budget == 0 || s->budget == config->budget) && s->light_limit == 0 &&
           light_manager_knows(desc->light_manager, desc->world, desc->camera);
}

static void decide(LightCull *cull, LightParts *parts, const u32 *rows, u32 row_count,
                   f64 *clock_ms, Arena *scratch) {
    const PacketBuildDesc *desc = cull->desc;
    f32 own_ms[LIGHT_STAGE_COUNT] = {0};
    const f32 *ms = own_ms;
    if (!desc->settings.manager) {
        cull->decision = light_decision_make(cull->light->table.count, scratch);
    } else if (state_serves(desc, &cull->config)) {
        cull->decision = read_state(desc->light_manager, desc->world, cull->light, scratch);
        ms = desc->light_manager->stage_ms;
    } else {
        LightScene scene = light_scene_make(desc->world, desc->camera, &cull->candidates);
        if (desc->light_manager) scene.surfaces = desc->light_manager->surfaces;
        LightDecideDesc how = {.rows = rows,
                               .row_count = row_count,
                               .merge = desc->settings.merge,
                               .drop = desc->settings.drop,
                               .budget = desc->settings.budget ? desc->settings.budget
                                                               : cull->config.budget};
        cull->decision = light_decide(&scene, &how, own_ms, scratch);
    }
    for (u32 stage = LIGHT_STAGE_MERGE; stage <= LIGHT_STAGE_BUDGET; stage++)
        parts->stage_ms[stage] = ms[stage];
    lap_ms(clock_ms);
}

// ---- records ----

// Factor on the highlight by the distance from the eye to the nearest point of the light's volume.
static f32 highlight_of(const LightCull *cull, Vec3 center, f32 radius) {
    if (!cull->desc->settings.manager || !cull->desc->settings.light_lod) return 1.0f;
    f32 distance = vec3_length(vec3_sub(center, cull->view->position)) - radius;
    f32 near = cull->config.lod_near, far = cull->config.lod_far;
    if (distance < near) return 1.0f;
    return far > near ? f32_saturate((far - distance) / (far - near)) : 0.0f;
}

typedef struct ShownLight {
    u32 row, merged; // merged: index into LightCull.merged, UINT32_MAX = the row itself
    f32 weight, highlight;
} ShownLight;

// Points, diffuse points, spots, diffuse spots (LIGHT_CLASSES of shared.h).
static u32 class_of(const LightCull *cull, const ShownLight *shown) {
    return (cull->light->kind[shown->row] == LIGHT_SPOT) * 2u + !(shown->highlight > 0.0f);
}

static ShownLight *gather_shown(LightCull *cull, LightParts *parts, u32 *count, Arena *scratch) {
    const LightDecision *d = &cull->decision;
    const LightCandidates *c = &cull->candidates;
    u32 rows = cull->light->table.count, pair = 0;
    ShownLight *shown = ARENA_PUSH(scratch, ShownLight, rows + cull->merged_count);
    *count = 0;
    for (u32 row = 0; row < rows; row++) {
        if (cull->seen[row] == 2 && d->weight[row] > 0.0f && cull->traced[row])
            parts->traced_local++;
        else if (cull->seen[row] == 2 && d->weight[row] > 0.0f)
            shown[(*count)++] = (ShownLight){
                row, UINT32_MAX, d->weight[row],
                highlight_of(cull, vec3(c->x[row], c->y[row], c->z[row]), c->radius[row])};
        else if (cull->seen[row] == 2 && d->pair_weight[row] > 0.0f)
            parts->merged++;
        else if (cull->seen[row] == 2 && (d->fate[row] == LIGHT_OVER_BUDGET))
            parts->over_budget++;
        else if (cull->seen[row] == 2)
            parts->dropped++;
        if (pair == cull->merged_count || cull->merged_row[pair] != row) continue;
        const MergedLight *m = &cull->merged[pair];
        if (cull->merged_seen[pair]) {
            shown[(*count)++] = (ShownLight){row, pair, d->pair_weight[row],
                                             highlight_of(cull, m->center, m->radius)};
            parts->merged_pairs++;
            parts->merge_error += d->pair_error[row];
        }
        pair++;
    }
    return shown;
}

static void count_shown(LightParts *parts, const ShownLight *shown, u32 count) {
    for (u32 i = 0; i < count; i++) {
        parts->fading += shown[i].weight < 1.0f;
        parts->near += shown[i].highlight >= 1.0f;
        parts->far += !(shown[i].highlight > 0.0f);
    }
    parts->between = count - parts->near - parts->far;
}

static LightRecord make_record(Vec3 position, f32 range, Vec3 color, f32 weight, f32 highlight) {
    return (LightRecord){{position.x, position.y, position.z, 1.0f / (range * range)},
                         {color.x * weight, color.y * weight, color.z * weight, highlight}};
}

static LightRecord row_record(const LightCull *cull, u32 row, f32 weight, f32 highlight) {
    const LightTable *light = cull->light;
    const LightCandidates *c = &cull->candidates;
    return make_record(vec3(light->x[row], light->y[row], light->z[row]), light->reach[row],
                       vec3(c->r[row], c->g[row], c->b[row]), weight, highlight);
}

static SpotRecord make_spot(Vec3 direction, f32 inner_deg, f32 outer_deg) {
    f32 inner = det_cos(DEG_TO_RAD(inner_deg)), outer = det_cos(DEG_TO_RAD(outer_deg));
    // An inner angle at or beyond the outer one is a hard edge.
    return (SpotRecord){{direction.x, direction.y, direction.z, outer},
                        {1.0f / MAX(inner - outer, 1e-4f), 0.0f, 0.0f, 0.0f}};
}

static SpotRecord shown_spot(const LightCull *cull, const ShownLight *shown) {
    const LightTable *light = cull->light;
    u32 row = shown->row;
    if (shown->merged != UINT32_MAX) {
        const MergedLight *m = &cull->merged[shown->merged];
        return make_spot(m->direction, m->inner_deg, m->outer_deg);
    }
    return make_spot(vec3(light->dir_x[row], light->dir_y[row], light->dir_z[row]),
                     light->inner_angle[row], light->outer_angle[row]);
}

// Lights far away whose window is closed everywhere: lanes without a light read it.
static const LightRecord dummy_light = {{0.0f, -1e6f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f, 0.0f}};

// place[count]: where each went.
static void write_records(const LightCull *cull, LightParts *parts, const ShownLight *shown,
                          u32 count, u32 *place, Arena *scratch) {
    u32 begin[LIGHT_CLASSES + 1] = {0};
    for (u32 i = 0; i < count; i++) begin[class_of(cull, &shown[i]) + 1]++;
    parts->point_highlights = begin[1];
    parts->point_count = begin[1] + begin[2];
    parts->spot_highlights = begin[3];
    parts->spot_count = begin[3] + begin[4];
    for (u32 i = 0; i < LIGHT_CLASSES; i++) begin[i + 1] += begin[i];
    parts->lights = ARENA_PUSH(scratch, LightRecord, count + 1);
    parts->spots = ARENA_PUSH(scratch, SpotRecord, parts->spot_count);
    for (u32 i = 0; i < count; i++) {
        const ShownLight *s = &shown[i];
        u32 at = place[i] = begin[class_of(cull, s)]++;
        const MergedLight *m = s->merged == UINT32_MAX ? NULL : &cull->merged[s->merged];
        parts->lights[at] =
            m ? make_record(m->position, m->range, m->color, s->weight, s->highlight)
              : row_record(cull, s->row, s->weight, s->highlight);
        if (at >= parts->point_count) parts->spots[at - parts->point_count] = shown_spot(cull, s);
    }
    parts->lights[count] = dummy_light;
}

// ---- marks ----

static PacketLightMark make_mark(Vec3 position, f32 range, bool spot, Vec3 direction,
                                 f32 outer_deg) {
    return (PacketLightMark){.position = {position.x, position.y, position.z},
                             .range = range,
                             .direction = {direction.x, direction.y, direction.z},
                             .cos_outer = spot ? det_cos(DEG_TO_RAD(outer_deg)) : -2.0f,
                             .light = UINT32_MAX};
}

static u32 row_fate(const LightCull *cull, u32 row) {
    const LightDecision *d = &cull->decision;
    if (cull->seen[row] == 0) return LIGHT_OUTSIDE;
    if (cull->seen[row] == 1) return LIGHT_OCCLUDED;
    if (d->partner[row] != ROW_NONE && d->pair_weight[row] > 0.0f) return LIGHT_MERGED;
    if (d->weight[row] > 0.0f) return LIGHT_KEPT;
    return d->fate[row] == LIGHT_OVER_BUDGET ? LIGHT_OVER_BUDGET : LIGHT_DROPPED;
}

static u32 merged_fate(const LightCull *cull, u32 pair) {
    return cull->merged_seen[pair] ? LIGHT_MERGER : LIGHT_OUTSIDE;
}

// All local lights of the level that are lit, then the merged ones; `light` names their records.
static void write_marks(const LightCull *cull, LightParts *parts, const ShownLight *shown,
                        const u32 *place, u32 shown_count, Arena *scratch) {
    const LightTable *light = cull->light;
    u32 rows = light->table.count, count = 0;
    PacketLightMark *marks = ARENA_PUSH(scratch, PacketLightMark, rows + cull->merged_count);
    u32 *mark_of_row = ARENA_PUSH(scratch, u32, rows);
    for (u32 row = 0; row < rows; row++) {
        mark_of_row[row] = count;
        if (cull->candidates.radius[row] < 0.0f) continue;
        marks[count] = make_mark(vec3(light->x[row], light->y[row], light->z[row]),
                                 light->reach[row], light->kind[row] == LIGHT_SPOT,
                                 vec3(light->dir_x[row], light->dir_y[row], light->dir_z[row]),
                                 light->outer_angle[row]);
        marks[count].weight = cull->decision.weight[row];
        marks[count++].fate = row_fate(cull, row);
    }
    u32 own = count;
    for (u32 i = 0; i < cull->merged_count; i++) {
        const MergedLight *m = &cull->merged[i];
        if (m->radius < 0.0f)
            marks[count] = (PacketLightMark){.light = UINT32_MAX};
        else
            marks[count] =
                make_mark(m->position, m->range, m->kind == LIGHT_SPOT, m->direction, m->outer_deg);
        marks[count].weight = cull->decision.pair_weight[cull->merged_row[i]];
        marks[count++].fate = merged_fate(cull, i);
    }
    for (u32 i = 0; i < shown_count; i++) {
        const ShownLight *s = &shown[i];
        PacketLightMark *mark =
            &marks[s->merged == UINT32_MAX ? mark_of_row[s->row] : own + s->merged];
        mark->light = place[i];
        mark->highlight = s->highlight;
    }
    parts->marks = marks;
    parts->mark_count = count;
}

static bool wants_marks(u32 view) { return view >= VIEW_LIGHT_RECTS && view <= VIEW_LIGHT_LODS; }

// ---- GI ----

static bool wants_tracing(const LightTable *light, u32 row) {
    return light->screen_shadow[row] == SCREEN_SHADOW_CONE ||
           light->screen_shadow[row] == SCREEN_SHADOW_VOLUME;
}

static bool is_lit(const LightCull *cull, u32 row) {
    const LightCandidates *c = &cull->candidates;
    if (cull->light->kind[row] != LIGHT_DIRECTIONAL) return c->radius[row] >= 0.0f;
    f32 r = c->r[row], g = c->g[row], b = c->b[row];
    return (r != 0.0f || g != 0.0f || b != 0.0f) && fabsf(r + g + b) < 1e30f;
}

// The first of the level's, in row order, wherever the view is and lit or not: none changes as the
// view turns or a light flickers.
static void mark_traced(LightCull *cull) {
    const LightTable *light = cull->light;
    u32 count = 0, dropped = 0;
    if (!cull->gi->enabled || !cull->gi->cone_shadows) return;
    for (u32 row = 0; row < light->table.count; row++) {
        if (!wants_tracing(light, row)) continue;
        if (count == GI_TRACED_CAP)
            dropped++;
        else
            cull->traced[row] = 1, count++;
    }
    static bool told;
    if (dropped > 0 && !told)
        LOG(RENDER_LIMIT, "%u lights beyond the first %u have no shadow from the voxels", dropped,
            GI_TRACED_CAP);
    told |= dropped > 0;
}

// has_map: the light owns the shadow map. Where there is none, who asked for one gets rays.
static f32 voxel_shadow(const LightCull *cull, u32 row, bool has_map) {
    u32 word = cull->light->voxel_shadow[row];
    if (word == 0) // auto
        return (f32)(has_map                           ? VOXEL_SHADOW_MAP
                     : wants_tracing(cull->light, row) ? VOXEL_SHADOW_RAY
                                                       : VOXEL_SHADOW_NONE);
    u32 shadow = MIN(word - 1, VOXEL_SHADOW_SOFT_RAY);
    return (f32)(shadow == VOXEL_SHADOW_MAP && !has_map ? VOXEL_SHADOW_RAY : shadow);
}

// A light as voxels see it: full brightness, wherever the view is.
static GiLightRecord gi_record(const LightCull *cull, u32 row) {
    const LightTable *light = cull->light;
    const LightCandidates *c = &cull->candidates;
    f32 kind = (f32)MIN(light->kind[row], LIGHT_DIRECTIONAL);
    GiLightRecord out = {
        .color = {c->r[row], c->g[row], c->b[row], voxel_shadow(cull, row, false)},
        .direction = {light->dir_x[row], light->dir_y[row], light->dir_z[row], -2.0f},
        .extra = {0.0f, kind, 0.0f, 0.0f}};
    if (kind == LIGHT_DIRECTIONAL) return out;
    LightRecord record = row_record(cull, row, 1.0f, 1.0f);
    memcpy(out.position, record.position, sizeof out.position);
    if (kind == LIGHT_POINT) {
        out.direction[0] = out.direction[1] = 0.0f, out.direction[2] = -1.0f;
        return out;
    }
    SpotRecord spot = make_spot(vec3(light->dir_x[row], light->dir_y[row], light->dir_z[row]),
                                light->inner_angle[row], light->outer_angle[row]);
    memcpy(out.direction, spot.direction, sizeof out.direction);
    out.extra[0] = spot.edge[0];
    return out;
}

static void collect_gi(LightCull *cull, LightParts *parts, Arena *scratch) {
    const LightTable *light = cull->light;
    const f32 *radius = cull->candidates.radius;
    u32 count = cull->gi->enabled ? light->table.count : 0;
    for (u32 row = 0; row < count; row++)
        parts->gi_count += radius[row] >= 0.0f && light->affects_gi[row];
    parts->gi_lights = ARENA_PUSH(scratch, GiLightRecord, parts->gi_count);
    for (u32 row = 0, i = 0; i < parts->gi_count; row++)
        if (radius[row] >= 0.0f && light->affects_gi[row])
            parts->gi_lights[i++] = gi_record(cull, row);
}

static void collect_traced(LightCull *cull, LightParts *parts, Arena *scratch) {
    const LightTable *light = cull->light;
    parts->traced = ARENA_PUSH(scratch, TracedLightRecord, GI_TRACED_CAP);
    for (u32 row = 0; row < light->table.count; row++) {
        if (!cull->traced[row] || !is_lit(cull, row)) continue;
        bool local = light->kind[row] != LIGHT_DIRECTIONAL;
        f32 weight = local ? cull->decision.weight[row] : 1.0f;
        if (local && (cull->seen[row] != 2 || !(weight > 0.0f))) continue;
        TracedLightRecord *out = &parts->traced[parts->traced_count++];
        const LightCandidates *c = &cull->candidates;
        Vec3 center = {c->x[row], c->y[row], c->z[row]};
        f32 opening_rad = DEG_TO_RAD(CLAMP(light->shadow_aperture[row], 0.1f, 90.0f));
        out->light = gi_record(cull, row);
        for (u32 i = 0; i < 3; i++) out->light.color[i] *= weight;
        out->light.color[3] = local ? highlight_of(cull, center, c->radius[row]) : 1.0f;
        out->shadow[0] = det_tan(0.5f * opening_rad);
        out->shadow[1] = MAX(light->shadow_softness[row], 0.0f);
        out->shadow[2] = light->screen_shadow[row] == SCREEN_SHADOW_VOLUME ? 1.0f : 0.0f;
    }
}

// ---- directional lights ----

// Which one has the shadow map: the first that casts one on the screen, else the first that only
// voxels ask.
static u32 find_mapped(const LightCull *cull) {
    const LightTable *light = cull->light;
    u32 for_voxels = ROW_NONE;
    for (u32 row = 0; row < light->table.count; row++) {
        if (light->kind[row] != LIGHT_DIRECTIONAL || !is_lit(cull, row)) continue;
        bool asks = light->voxel_shadow[row] == 1 + VOXEL_SHADOW_MAP && cull->gi->enabled;
        if (light->casts_shadow[row] && !cull->traced[row]) return row;
        if (for_voxels == ROW_NONE && cull->traced[row] && asks) for_voxels = row;
    }
    return for_voxels;
}

static void add_directional(const LightCull *cull, LightParts *parts, u32 row, bool has_map) {
    const LightTable *light = cull->light;
    const LightCandidates *c = &cull->candidates;
    f32 shadow = light->affects_gi[row] ? voxel_shadow(cull, row, has_map) : -1.0f;
    parts->directionals[parts->directional_count++] =
        (DirectionalRecord){{-light->dir_x[row], -light->dir_y[row], -light->dir_z[row], shadow},
                            {c->r[row], c->g[row], c->b[row], 0.0f}};
}

// Those of the screen: the one with the shadow map first, the others in row order. Then, for the
// voxels, those that the screen traces.
static void collect_directionals(const LightCull *cull, LightParts *parts) {
    const LightTable *light = cull->light;
    u32 dropped = 0, mapped = find_mapped(cull);
    for (u32 pass = 0; pass < 3; pass++) {
        if (pass == 2) parts->screen_directional_count = parts->directional_count;
        for (u32 row = 0; row < light->table.count; row++) {
            bool wanted = light->kind[row] == LIGHT_DIRECTIONAL && is_lit(cull, row) &&
                          (pass == 2) == cull->traced[row] &&
                          (pass == 2 || (pass == 0) == (row == mapped));
            if (!wanted || (pass == 2 && !light->affects_gi[row])) continue;
            if (parts->directional_count == DIRECTIONALS_CAP) {
                dropped++;
                continue;
            }
            if (row == mapped) {
                parts->casts_shadow = true;
                parts->shadow_index = parts->directional_count;
                parts->shadow_direction =
                    vec3(light->dir_x[row], light->dir_y[row], light->dir_z[row]);
            }
            add_directional(cull, parts, row, row == mapped && cull->desc->settings.shadows);
        }
    }
    static bool told;
    if (dropped > 0 && !told)
        LOG(RENDER_LIMIT, "%u directional lights beyond the first %u are left out", dropped,
            DIRECTIONALS_CAP);
    told |= dropped > 0;
}

LightParts packet_collect_lights(const PacketBuildDesc *desc, const PacketView *view,
                                 const OcclusionBuffer *occlusion, const GiParams *gi,
                                 Arena *scratch) {
    const LightTable *light = WORLD_TABLE(desc->world, Light, light);
    u32 count = light->table.count, limit = desc->settings.light_limit;
    LightParts parts = {0};
    f64 clock_ms = clock_now_ms();
    LightCull cull = {.desc = desc,
                      .view = view,
                      .occlusion = occlusion,
                      .light = light,
                      .gi = gi,
                      .candidates = light_candidates(light, desc->settings.light_gain, scratch),
                      .config = light_manager_config(desc->world),
                      .seen = ARENA_PUSH(scratch, u8, count),
                      .traced = ARENA_PUSH(scratch, u8, count)};
    for (u32 row = 0; row < count; row++) {
        if (light->kind[row] == LIGHT_DIRECTIONAL) continue;
        if (parts.total++ >= (limit ? limit : UINT32_MAX)) cull.candidates.radius[row] = -1.0f;
    }
    mark_traced(&cull);
    parts.stage_ms[LIGHT_STAGE_CANDIDATES] = lap_ms(&clock_ms);

    u32 *rows = ARENA_PUSH(scratch, u32, ALIGN_UP(count, SIMD_WIDTH));
    u32 row_count = cull_rows(&cull, &parts, rows, &clock_ms, scratch);
    decide(&cull, &parts, rows, row_count, &clock_ms, scratch);

    collect_merged(&cull, scratch);
    u32 shown_count;
    ShownLight *shown = gather_shown(&cull, &parts, &shown_count, scratch);
    count_shown(&parts, shown, shown_count);
    u32 *place = ARENA_PUSH(scratch, u32, shown_count);
    write_records(&cull, &parts, shown, shown_count, place, scratch);
    parts.marks = ARENA_PUSH(scratch, PacketLightMark, 0);
    if (wants_marks(desc->settings.view))
        write_marks(&cull, &parts, shown, place, shown_count, scratch);
    collect_gi(&cull, &parts, scratch);
    collect_traced(&cull, &parts, scratch);
    collect_directionals(&cull, &parts);
    parts.vertex_lighting = desc->settings.vertex_lighting ? cull.config.vertex_lighting : 0.0f;
    parts.stage_ms[LIGHT_STAGE_INDIVIDUAL] = lap_ms(&clock_ms);
    return parts;
}
