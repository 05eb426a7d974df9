// light_merge.c: lights that are far and close together become one.
// Data in: candidates, the reference view, pairs that are held. Data out: partners, the light that
// stands for a pair, its predicted error. Called by: light_rank.c (the decision), packet_lights.c
// (the merged light). Does not: merge more than two, or know time (light_manager.c blends).
//
// Pairs are found by spatial hash grids, one for each octave of range, whose cells are as
// wide as what two lights of that range may be apart; each light, in row order, takes the free
// light after it that gives the least error. Linear in the number of lights as long as they do not
// crowd.
#include "light_decide.h"
#include <string.h>

// Farther apart than this part of the smaller range, two lights do not light the same region.
#define SEPARATION_MAX 0.5f
// A range that is less than this part of the other's.
#define RANGE_RATIO_MIN 0.5f
#define SPOT_COS_MIN    0.990268f // 8 degrees between directions
#define SPOT_OUTER_DEG  2.0f
#define SPOT_INNER_DEG  4.0f
// What a held pair is forgiven.
#define HELD_ERROR    1.5f
#define HELD_DISTANCE 0.9f
#define HELD_RANGE    1.2f
#define HELD_PEAK     4.0f
// Largest predicted change of one pixel: pairs near a surface would look different, and blend
// slowly (light_fade.c).
#define PEAK_MAX           0.08f
#define PEAK_SURFACE_MIN_M 0.1f
// Where no surface is known, one is taken to pass a light at this part of its range, but not
// nearer.
#define SURFACE_PART  0.25f
#define SURFACE_MIN_M 0.25f

bool light_pinned(const LightTable *light, u32 row) {
    return light->priority[row] >= LIGHT_PINNED_PRIORITY;
}

static Vec3 row_position(const LightTable *light, u32 row) {
    return vec3(light->x[row], light->y[row], light->z[row]);
}

static f32 row_energy(const LightCandidates *c, u32 row) {
    return c->radius[row] < 0.0f ? 0.0f : fabsf(c->r[row]) + fabsf(c->g[row]) + fabsf(c->b[row]);
}

// Share of the full sphere that a spot lights, up to a factor.
static f32 spot_solid_angle(f32 outer_deg) { return 1.0f - det_cos(DEG_TO_RAD(outer_deg)); }

static void merge_spots(MergedLight *merged, const LightTable *light, u32 a, u32 b, f32 share_b,
                        f32 *scale_a, f32 *scale_b) {
    Vec3 da = {light->dir_x[a], light->dir_y[a], light->dir_z[a]},
         db = {light->dir_x[b], light->dir_y[b], light->dir_z[b]};
    merged->direction =
        vec3_normalize(vec3_add(vec3_scale(da, 1.0f - share_b), vec3_scale(db, share_b)));
    if (!(vec3_dot(merged->direction, merged->direction) > 0.5f)) merged->direction = da;
    merged->inner_deg = MAX(light->inner_angle[a], light->inner_angle[b]);
    merged->outer_deg = MAX(light->outer_angle[a], light->outer_angle[b]);
    if (light->outer_angle[a] != light->outer_angle[b]) {
        f32 whole = spot_solid_angle(merged->outer_deg);
        *scale_a = spot_solid_angle(light->outer_angle[a]) / whole;
        *scale_b = spot_solid_angle(light->outer_angle[b]) / whole;
    }
}

MergedLight light_merge_pair(const LightTable *light, const LightCandidates *candidates, u32 a,
                             u32 b) {
    f32 energy_a = row_energy(candidates, a), energy_b = row_energy(candidates, b);
    f32 energy = energy_a + energy_b;
    MergedLight merged = {.kind = light->kind[a], .radius = -1.0f};
    if (!(energy > 0.0f)) return merged;
    f32 share_b = energy_b / energy, scale_a = energy_a > 0.0f, scale_b = energy_b > 0.0f;
    Vec3 pa = row_position(light, a), pb = row_position(light, b);
    Vec3 apart = vec3_sub(pb, pa);
    f32 separation = vec3_length(apart);
    merged.position = vec3_add(pa, vec3_scale(apart, share_b));
    // What is dark has no sphere to cover.
    f32 range_a = energy_a > 0.0f ? light->reach[a] + separation * share_b : 0.0f;
    f32 range_b = energy_b > 0.0f ? light->reach[b] + separation * (1.0f - share_b) : 0.0f;
    merged.range = MAX(range_a, range_b) * (1.0f + 1e-6f);
    if (merged.kind == LIGHT_SPOT) merge_spots(&merged, light, a, b, share_b, &scale_a, &scale_b);
    const LightCandidates *c = candidates;
    merged.color =
        vec3(c->r[a] * scale_a + c->r[b] * scale_b, c->g[a] * scale_a + c->g[b] * scale_b,
             c->b[a] * scale_a + c->b[b] * scale_b);
    merged.center = merged.position;
    merged.radius = merged.range;
    if (merged.kind == LIGHT_SPOT) {
        f32 half_rad = DEG_TO_RAD(merged.outer_deg);
        f32 along = cone_bounding_sphere(merged.range, det_cos(half_rad), det_sin(half_rad),
                                         &merged.radius);
        merged.center = vec3_add(merged.position, vec3_scale(merged.direction, along));
    }
    return merged;
}

// What a pair's change of place and range does to the lit surface, summed over the surface: the
// parts that each light has in it, by channel.
//
// A point light at height h over a plane makes the irradiance E(x) = I h / (h^2 + x^2)^(3/2) there;
// summed over the plane that is 2 pi I. By Taylor, a step s along the plane changes the sum of
// |E| by at most s * sum |E'| + s^2 / 2 * sum |E''| = 4 I s / h + 2.70 I s^2 / h^2, and never by
// more than 4 I s / h. Merging moves the two in opposite directions by steps that their energies
// weigh: the first-order terms cancel, but for what their colours differ. A wider range lets in
// what the window cut off beyond the old one, of 2 pi I at most the part h / sqrt(h^2 + R^2). The
// other falloffs have no peak: with the window alone the sum is I pi R^2 / 2, and a step changes it
// by 8 / 3 I R s.
#define STEP_FIRST  4.0f
#define STEP_SECOND 2.7f

static f32 widened(const LightScene *scene, f32 range, f32 wide) {
    if (scene->attenuation != ATTENUATION_INVERSE_SQUARE)
        return 0.5f * PI_F * (wide * wide - range * range) / MAX(scene->falloff[0], 1e-2f);
    f32 h = MAX(SURFACE_PART * range, SURFACE_MIN_M);
    return 2.0f * PI_F * 2.0f * (h / sqrtf(h * h + range * range) - h / sqrtf(h * h + wide * wide));
}

// One channel: intensities a, b; steps sa < 0 < sb along the line between the two.
static f32 moved(const LightScene *scene, f32 a, f32 b, f32 sa, f32 sb, f32 range) {
    f32 each = fabsf(a * sa) + fabsf(b * sb);
    if (scene->attenuation != ATTENUATION_INVERSE_SQUARE)
        return 8.0f / 3.0f * range * each / MAX(scene->falloff[0], 1e-2f);
    f32 h = MAX(SURFACE_PART * range, SURFACE_MIN_M);
    f32 first = STEP_FIRST / h * fabsf(a * sa + b * sb);
    f32 second = STEP_SECOND / (h * h) * (fabsf(a) * sa * sa + fabsf(b) * sb * sb);
    return MIN(first + second, STEP_FIRST / h * each);
}

// Sine of the angle over the tangent of the cone's half angle: how far its disc moves, of its
// radius.
static f32 turned(const LightTable *light, u32 row, const MergedLight *merged) {
    if (merged->kind != LIGHT_SPOT) return 0.0f;
    Vec3 d = {light->dir_x[row], light->dir_y[row], light->dir_z[row]};
    f32 tangent = det_tan(DEG_TO_RAD(MIN(light->outer_angle[row], 80.0f)));
    return vec3_length(vec3_cross(d, merged->direction)) / MAX(tangent, 1e-3f);
}

f32 light_merge_error(const LightScene *scene, u32 a, u32 b) {
    const LightTable *light = scene->light;
    const LightCandidates *c = &scene->candidates;
    MergedLight merged = light_merge_pair(light, c, a, b);
    if (c->radius[a] < 0.0f || c->radius[b] < 0.0f) return 0.0f; // the other one, where it is
    Vec3 pa = row_position(light, a), pb = row_position(light, b);
    f32 sa = -vec3_length(vec3_sub(merged.position, pa)),
        sb = vec3_length(vec3_sub(merged.position, pb));
    f32 range_a = light->reach[a], range_b = light->reach[b], range = MIN(range_a, range_b);
    f32 wide_a = widened(scene, range_a, merged.range) + 4.0f * turned(light, a, &merged),
        wide_b = widened(scene, range_b, merged.range) + 4.0f * turned(light, b, &merged);
    const f32 *channels[3] = {c->r, c->g, c->b};
    f32 change = 0.0f;
    for (u32 k = 0; k < 3; k++) {
        f32 ia = channels[k][a], ib = channels[k][b];
        f32 here = moved(scene, ia, ib, sa, sb, range) + fabsf(ia) * wide_a + fabsf(ib) * wide_b;
        change = MAX(change, here);
    }
    // A surface that reflects half, seen face on, as pixels: (focal / distance)^2 to a square
    // metre.
    f32 distance = vec3_length(vec3_sub(merged.position, scene->view.position));
    f32 scale = scene->focal_px / MAX(distance, scene->view.near);
    return change * scene->white * scale * scale / (f32)(REGION_PX * REGION_PX);
}

// At height h over a plane |E'| is at most 0.859 I / h^3, and |E| at most I / h^2.
f32 light_merge_peak(const LightScene *scene, u32 a, u32 b) {
    const LightTable *light = scene->light;
    const LightCandidates *c = &scene->candidates;
    MergedLight merged = light_merge_pair(light, c, a, b);
    if (c->radius[a] < 0.0f || c->radius[b] < 0.0f) return 0.0f;
    f32 guess = MAX(SURFACE_PART * MIN(light->reach[a], light->reach[b]), SURFACE_MIN_M);
    f32 around = light_surface_distance(scene->surfaces, merged.position, guess), sum = 0.0f;
    u32 rows[2] = {a, b};
    for (u32 i = 0; i < 2; i++) {
        Vec3 place = row_position(light, rows[i]);
        f32 h = MIN(light_surface_distance(scene->surfaces, place, guess), around);
        h = MAX(h, PEAK_SURFACE_MIN_M);
        f32 step = vec3_length(vec3_sub(merged.position, place));
        f32 brightest = MAX(MAX(fabsf(c->r[rows[i]]), fabsf(c->g[rows[i]])), fabsf(c->b[rows[i]]));
        sum = MAX(sum, brightest * MIN(0.859f * step / h, 1.0f) / (h * h));
    }
    return sum * scene->white;
}

bool light_may_merge(const LightScene *scene, u32 a, u32 b, bool held, f32 *error) {
    const LightTable *light = scene->light;
    *error = 0.0f;
    if (light->kind[a] != light->kind[b] || light->kind[a] == LIGHT_DIRECTIONAL) return false;
    if (light_pinned(light, a) || light_pinned(light, b)) return false;
    // A light that stands for two has no shadow from the voxels.
    if (light->screen_shadow[a] != SCREEN_SHADOW_MAP ||
        light->screen_shadow[b] != SCREEN_SHADOW_MAP)
        return false;
    bool dark = scene->candidates.radius[a] < 0.0f || scene->candidates.radius[b] < 0.0f;
    if (dark && !held) return false; // one that goes out for a moment stays with its partner
    f32 range_a = light->reach[a], range_b = light->reach[b];
    f32 smaller = MIN(range_a, range_b), larger = MAX(range_a, range_b);
    f32 separation = SEPARATION_MAX * smaller * (held ? HELD_RANGE : 1.0f);
    Vec3 pa = row_position(light, a), pb = row_position(light, b), apart = vec3_sub(pb, pa);
    if (!(vec3_dot(apart, apart) <= separation * separation)) return false;
    if (smaller * (held ? HELD_RANGE : 1.0f) < RANGE_RATIO_MIN * larger) return false;
    f32 nearest = scene->config.merge_distance * (held ? HELD_DISTANCE : 1.0f);
    Vec3 to_a = vec3_sub(pa, scene->view.position), to_b = vec3_sub(pb, scene->view.position);
    if (vec3_dot(to_a, to_a) < nearest * nearest || vec3_dot(to_b, to_b) < nearest * nearest)
        return false;
    if (light->kind[a] == LIGHT_SPOT) {
        f32 slack = held ? 2.0f : 1.0f;
        f32 cosine = light->dir_x[a] * light->dir_x[b] + light->dir_y[a] * light->dir_y[b] +
                     light->dir_z[a] * light->dir_z[b];
        if (1.0f - cosine > (1.0f - SPOT_COS_MIN) * slack ||
            fabsf(light->outer_angle[a] - light->outer_angle[b]) > SPOT_OUTER_DEG * slack ||
            fabsf(light->inner_angle[a] - light->inner_angle[b]) > SPOT_INNER_DEG * slack)
            return false;
    }
    if (scene->attenuation == ATTENUATION_INVERSE_SQUARE &&
        light_merge_peak(scene, a, b) > PEAK_MAX * (held ? HELD_PEAK : 1.0f))
        return false;
    *error = light_merge_error(scene, a, b);
    return *error <= scene->config.merge_error * (held ? HELD_ERROR : 1.0f);
}

// ---- the grid ----

// Octave of the range: ranges in [2^n, 2^(n+1)).
static i32 range_octave(f32 range) {
    u32 bits;
    memcpy(&bits, &range, sizeof bits);
    return (i32)(bits >> 23) - 127;
}

// Cells of an octave are 2^n m wide: two lights, the smaller of which is of it, are at most a cell
// apart, so the 27 cells around a point hold all partners.
static f32 octave_cells_per_m(i32 octave) {
    u32 bits = (u32)CLAMP(127 - octave, 1, 254) << 23;
    f32 scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale;
}

static u32 cell_hash(i32 x, i32 y, i32 z, i32 octave) {
    u32 h = (u32)x * 0x8DA6B343u ^ (u32)y * 0xD8163841u ^ (u32)z * 0xCB1AB31Fu ^
            (u32)octave * 0x165667B1u;
    h ^= h >> 15;
    h *= 0x2C1B3C6Du;
    return h ^ h >> 13;
}

// What a first look at a pair needs.
typedef struct GridLight {
    Vec3 at;
    f32 energy;
    f32 peak, peak_per_m; // light_merge_peak is at least MIN(peak, peak_per_m * step); 0 = any step
} GridLight;

typedef struct MergeGrid {
    u32 mask;          // buckets - 1
    u32 *first;        // [buckets + 1] into `rows`
    u32 *rows;         // [count] ascending within a bucket
    GridLight *lights; // [count] the same ones
} MergeGrid;

static u32 bucket_of(const LightTable *light, u32 row, u32 mask) {
    i32 octave = range_octave(light->reach[row]);
    f32 k = octave_cells_per_m(octave);
    return cell_hash((i32)floorf(light->x[row] * k), (i32)floorf(light->y[row] * k),
                     (i32)floorf(light->z[row] * k), octave) &
           mask;
}

static GridLight grid_light(const LightScene *scene, u32 row) {
    const LightCandidates *c = &scene->candidates;
    GridLight light = {.at = row_position(scene->light, row), .energy = row_energy(c, row)};
    if (scene->attenuation != ATTENUATION_INVERSE_SQUARE) return light;
    // The larger of two guesses: a lower bound, whoever the partner is.
    f32 guess = MAX(SURFACE_PART * scene->light->reach[row], SURFACE_MIN_M);
    f32 h = MAX(light_surface_distance(scene->surfaces, light.at, guess), PEAK_SURFACE_MIN_M);
    f32 brightest = MAX(MAX(fabsf(c->r[row]), fabsf(c->g[row])), fabsf(c->b[row]));
    light.peak = brightest * scene->white / (h * h);
    light.peak_per_m = light.peak * 0.859f / h;
    return light;
}

static MergeGrid grid_build(const LightScene *scene, const u32 *rows, u32 count, Arena *scratch) {
    const LightTable *light = scene->light;
    MergeGrid grid = {.mask = 63};
    while (grid.mask < 2 * count) grid.mask = grid.mask * 2 + 1;
    grid.first = ARENA_PUSH(scratch, u32, grid.mask + 2);
    grid.rows = ARENA_PUSH(scratch, u32, count);
    grid.lights = ARENA_PUSH(scratch, GridLight, count);
    u32 *bucket = ARENA_PUSH(scratch, u32, count);
    for (u32 i = 0; i < count; i++) {
        bucket[i] = bucket_of(light, rows[i], grid.mask);
        grid.first[bucket[i] + 1]++;
    }
    for (u32 i = 0; i <= grid.mask; i++) grid.first[i + 1] += grid.first[i];
    // Filled from the back, each bucket's end walks down to its begin of the next bucket's.
    for (u32 i = count; i-- > 0;) grid.rows[--grid.first[bucket[i] + 1]] = rows[i];
    for (u32 i = 0; i <= grid.mask; i++) grid.first[i] = grid.first[i + 1];
    grid.first[grid.mask + 1] = count;
    for (u32 i = 0; i < count; i++) grid.lights[i] = grid_light(scene, grid.rows[i]);
    return grid;
}

typedef struct Partner {
    u32 row;
    f32 error;
} Partner;

// Would one of the two change a pixel too much, by itself? Spares the full judgement.
static bool peaks(const GridLight *a, const GridLight *b, f32 distance2) {
    f32 distance = sqrtf(distance2), energy = a->energy + b->energy;
    f32 step_a = distance * b->energy / energy, step_b = distance - step_a;
    // A part of a thousand for rounding: what is judged in full decides.
    return MIN(a->peak, a->peak_per_m * step_a) > PEAK_MAX * 1.001f ||
           MIN(b->peak, b->peak_per_m * step_b) > PEAK_MAX * 1.001f;
}

// The best of a bucket's lights after `row`, if better than what there is; of equal ones the first.
static void search_bucket(const LightScene *scene, const MergeGrid *grid, u32 bucket, u32 row,
                          const GridLight *own, const u32 *partner, Partner *best) {
    f32 reach = SEPARATION_MAX * scene->light->reach[row], reach2 = reach * reach;
    for (u32 i = grid->first[bucket + 1]; i-- > grid->first[bucket];) {
        u32 other = grid->rows[i];
        if (other <= row) break; // so are all before it
        Vec3 apart = vec3_sub(grid->lights[i].at, own->at);
        f32 distance2 = vec3_dot(apart, apart), error;
        if (distance2 > reach2 || partner[other] != ROW_NONE ||
            peaks(own, &grid->lights[i], distance2) ||
            !light_may_merge(scene, row, other, false, &error))
            continue;
        if (error < best->error || (error == best->error && other < best->row))
            *best = (Partner){other, error};
    }
}

static Partner best_partner(const LightScene *scene, const MergeGrid *grid, u32 row,
                            const u32 *partner) {
    Partner best = {ROW_NONE, INFINITY};
    GridLight light = grid_light(scene, row);
    Vec3 at = light.at;
    i32 own = range_octave(scene->light->reach[row]);
    for (i32 octave = own - 1; octave <= own + 1; octave++) {
        f32 k = octave_cells_per_m(octave);
        i32 x = (i32)floorf(at.x * k), y = (i32)floorf(at.y * k), z = (i32)floorf(at.z * k);
        for (i32 n = 0; n < 27; n++) {
            u32 bucket = cell_hash(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1, octave);
            search_bucket(scene, grid, bucket & grid->mask, row, &light, partner, &best);
        }
    }
    return best;
}

static void set_pair(LightDecision *d, u32 a, u32 b, f32 error, f32 weight) {
    d->partner[a] = b, d->partner[b] = a;
    d->pair_error[a] = d->pair_error[b] = error;
    d->pair_weight[a] = d->pair_weight[b] = weight;
}

void light_merge_find(const LightScene *scene, const u32 *held, const u32 *rows, u32 row_count,
                      LightDecision *decision, Arena *scratch) {
    const LightTable *light = scene->light;
    for (u32 row = 0; held && row < scene->count; row++) {
        if (held[row] == ROW_NONE || held[row] < row) continue;
        f32 error;
        bool stays = light_may_merge(scene, row, held[row], true, &error);
        set_pair(decision, row, held[row], error, stays ? 1.0f : 0.0f);
    }
    u64 mark = arena_mark(scratch);
    u32 *free_rows = ARENA_PUSH(scratch, u32, row_count), free_count = 0;
    f32 nearest2 = scene->config.merge_distance * scene->config.merge_distance;
    for (u32 i = 0; i < row_count; i++) {
        u32 row = rows[i];
        Vec3 to = vec3_sub(row_position(light, row), scene->view.position);
        if (decision->partner[row] == ROW_NONE && !light_pinned(light, row) &&
            vec3_dot(to, to) >= nearest2)
            free_rows[free_count++] = row;
    }
    MergeGrid grid = grid_build(scene, free_rows, free_count, scratch);
    for (u32 i = 0; i < free_count; i++) {
        u32 row = free_rows[i];
        if (decision->partner[row] != ROW_NONE) continue;
        Partner best = best_partner(scene, &grid, row, decision->partner);
        if (best.row != ROW_NONE) set_pair(decision, row, best.row, best.error, 1.0f);
    }
    arena_rewind(scratch, mark);
}
