// packet_lights.c: the light manager: from the level's lights to those that this frame shades.
// Data in: the light table (with derived columns), settings, the view. Data out: light records in
// a stable order (points, spots, each in row order), the GI lights,
// the directional lights. Called by: packet_build. Does not: merge or rank lights, or decide tiles.
//
// Everything is done on whole arrays: one pass over the table computes the candidates (bounding
// sphere, colour; radius -1 for those that cannot matter), one culls, one packs.
#include "packet_parts.h"
#include "../base/jobs.h"
#include "../base/log.h"

#define LIGHTS_PER_JOB 1024

typedef struct LightCandidates {
    f32 *x, *y, *z, *radius; // bounding sphere, world; [count padded]
    f32 *r, *g, *b;          // colour times all factors
} LightCandidates;

typedef struct CandidateJob {
    const LightTable *light;
    LightCandidates out;
    f32 gain;
} CandidateJob;

// Smallest sphere around the part of a ball of radius `reach` that lies in a cone with its tip in
// the centre: up to 45 degrees through tip and rim, beyond around the rim's circle. Returns how far
// along the axis its centre lies.
static f32 cone_sphere(f32 reach, f32 cos_half, f32 sin_half, f32 *radius) {
    if (cos_half > 0.70710678f) {
        *radius = reach / (2.0f * cos_half);
        return *radius;
    }
    *radius = reach * sin_half;
    return reach * cos_half;
}

static void job_candidates(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const CandidateJob *job = context;
    const LightTable *light = job->light;
    const LightCandidates *out = &job->out;
    for (u32 i = begin; i < end; i++) {
        f32 factor = light->intensity[i] * light->gain[i] * job->gain;
        f32 r = light->color_r[i] * factor, g = light->color_g[i] * factor,
            b = light->color_b[i] * factor;
        f32 x = light->x[i], y = light->y[i], z = light->z[i], radius = light->reach[i];
        if (light->kind[i] == LIGHT_SPOT) {
            f32 half_rad = DEG_TO_RAD(light->outer_angle[i]);
            f32 along = cone_sphere(radius, det_cos(half_rad), det_sin(half_rad), &radius);
            x += light->dir_x[i] * along;
            y += light->dir_y[i] * along;
            z += light->dir_z[i] * along;
        }
        // One that adds nothing is no light. (Negative colours cannot come from level text; a game
        // may use them: they darken.) A factor that overflowed is no light either.
        bool lights = (r != 0.0f || g != 0.0f || b != 0.0f) && fabsf(r) < 1e30f &&
                      fabsf(g) < 1e30f && fabsf(b) < 1e30f && radius > 0.0f;
        out->x[i] = x, out->y[i] = y, out->z[i] = z;
        out->r[i] = r, out->g[i] = g, out->b[i] = b;
        out->radius[i] = lights && light->kind[i] != LIGHT_DIRECTIONAL ? radius : -1.0f;
    }
}

static LightCandidates collect_candidates(const LightTable *light, f32 gain, Arena *scratch) {
    u64 padded = ALIGN_UP(light->table.count, SIMD_WIDTH);
    CandidateJob job = {.light = light, .gain = gain};
    f32 **columns[] = {&job.out.x, &job.out.y, &job.out.z, &job.out.radius,
                       &job.out.r, &job.out.g, &job.out.b};
    for (u32 i = 0; i < COUNT_OF(columns); i++)
        *columns[i] = ARENA_PUSH_COLUMN(scratch, f32, padded);
    jobs_for(light->table.count, LIGHTS_PER_JOB, job_candidates, &job);
    return job.out;
}

static LightRecord make_record(const LightTable *light, const LightCandidates *candidates,
                               u32 row) {
    f32 reach = light->reach[row];
    return (LightRecord){{light->x[row], light->y[row], light->z[row], 1.0f / (reach * reach)},
                         {candidates->r[row], candidates->g[row], candidates->b[row], 1.0f}};
}

static SpotRecord make_spot(const LightTable *light, u32 row) {
    f32 inner = det_cos(DEG_TO_RAD(light->inner_angle[row]));
    f32 outer = det_cos(DEG_TO_RAD(light->outer_angle[row]));
    // An inner angle at or beyond the outer one is a hard edge.
    return (SpotRecord){{light->dir_x[row], light->dir_y[row], light->dir_z[row], outer},
                        {1.0f / MAX(inner - outer, 1e-4f), 0.0f, 0.0f, 0.0f}};
}

// Lights far away whose window is closed everywhere: lanes without a light read it.
static const LightRecord dummy_light = {{0.0f, -1e6f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f, 0.0f}};

static void pack_local_lights(LightParts *parts, const LightTable *light,
                              const LightCandidates *candidates, const u32 *visible,
                              Arena *scratch) {
    u32 count = parts->visible;
    u32 *order = ARENA_PUSH(scratch, u32, count);
    for (u32 i = 0; i < count; i++)
        if (light->kind[visible[i]] == LIGHT_POINT) order[parts->point_count++] = visible[i];
    parts->spot_count = count - parts->point_count;
    for (u32 i = 0, spot = parts->point_count; i < count; i++)
        if (light->kind[visible[i]] != LIGHT_POINT) order[spot++] = visible[i];

    parts->lights = ARENA_PUSH(scratch, LightRecord, count + 1);
    parts->spots = ARENA_PUSH(scratch, SpotRecord, parts->spot_count);
    for (u32 i = 0; i < count; i++) {
        u32 row = order[i];
        parts->lights[i] = make_record(light, candidates, row);
        if (i >= parts->point_count) parts->spots[i - parts->point_count] = make_spot(light, row);
    }
    parts->lights[count] = dummy_light;
    parts->point_highlights = parts->point_count;
    parts->spot_highlights = parts->spot_count;
}

// The first that casts a shadow comes first, the others in row order.
static void collect_directionals(LightParts *parts, const LightTable *light,
                                 const LightCandidates *candidates) {
    u32 first = ROW_NONE, dropped = 0;
    for (u32 pass = 0; pass < 2; pass++) {
        for (u32 row = 0; row < light->table.count; row++) {
            if (light->kind[row] != LIGHT_DIRECTIONAL) continue;
            f32 r = candidates->r[row], g = candidates->g[row], b = candidates->b[row];
            bool dark = (r == 0.0f && g == 0.0f && b == 0.0f) || !(fabsf(r + g + b) < 1e30f);
            if (dark || row == first || (pass == 0 && !light->casts_shadow[row])) continue;
            if (parts->directional_count == DIRECTIONALS_CAP) {
                dropped++;
                continue;
            }
            parts->directionals[parts->directional_count++] = (DirectionalRecord){
                {-light->dir_x[row], -light->dir_y[row], -light->dir_z[row], 0.0f},
                {r, g, b, 0.0f}};
            if (pass == 1) continue;
            first = row;
            parts->casts_shadow = true;
            parts->shadow_direction = vec3(light->dir_x[row], light->dir_y[row], light->dir_z[row]);
            break;
        }
    }
    static bool told;
    if (dropped > 0 && !told)
        LOG(RENDER_LIMIT, "%u directional lights beyond the first %u are left out", dropped,
            DIRECTIONALS_CAP);
    told |= dropped > 0;
}

LightParts packet_collect_lights(const PacketBuildDesc *desc, const PacketView *view,
                                 Arena *scratch) {
    const LightTable *light = WORLD_TABLE(desc->world, Light, light);
    u32 count = light->table.count;
    LightParts parts = {0};
    LightCandidates candidates = collect_candidates(light, desc->settings.light_gain, scratch);

    u32 limit = desc->settings.light_limit ? desc->settings.light_limit : UINT32_MAX;
    for (u32 row = 0; row < count; row++) {
        if (light->kind[row] == LIGHT_DIRECTIONAL) continue;
        if (parts.total++ >= limit) candidates.radius[row] = -1.0f;
        parts.gi_count += candidates.radius[row] >= 0.0f && light->affects_gi[row];
    }
    parts.gi_lights = ARENA_PUSH(scratch, LightRecord, parts.gi_count);
    for (u32 row = 0, i = 0; i < parts.gi_count; row++)
        if (candidates.radius[row] >= 0.0f && light->affects_gi[row])
            parts.gi_lights[i++] = make_record(light, &candidates, row);

    u32 *visible = ARENA_PUSH(scratch, u32, ALIGN_UP(count, SIMD_WIDTH));
    Frustum everywhere = {.count = 0};
    parts.visible =
        cull_spheres(desc->settings.light_culling ? &view->frustum : &everywhere, candidates.x,
                     candidates.y, candidates.z, candidates.radius, count, visible);
    pack_local_lights(&parts, light, &candidates, visible, scratch);
    collect_directionals(&parts, light, &candidates);
    return parts;
}
