// systems_light_manager.c: each stage of the light manager against a naive twin, and what a packet
// says of it: energy, ranges, counts, order, level of detail.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/light_decide.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static LightManagerTable *manager_columns(SystemsFixture *f) {
    u32 row = world_singleton(f->world, COMPONENT_light_manager);
    assert_int_equal(row, 0);
    return FIXTURE_TABLE(f, LightManager, light_manager);
}

// A dim picture: surfaces that are close spoil fewer pairs.
static void set_exposure(SystemsFixture *f, f32 exposure) {
    world_singleton(f->world, COMPONENT_environment);
    FIXTURE_TABLE(f, Environment, environment)->exposure[0] = exposure;
}

// Lights in a slab before the camera, some of them in tight groups. The camera looks from the
// origin to -z.
static void spawn_lights(SystemsFixture *f, u64 seed, u32 count, f32 extent) {
    for (u32 i = 0; i < count; i++) {
        u32 group = i % 3 == 0 ? i : i - i % 3; // threes share a neighbourhood
        Vec3 p = {random_range(seed, 1, group, -extent, extent),
                  random_range(seed, 2, group, -0.2f * extent, 0.2f * extent),
                  random_range(seed, 3, group, -2.0f * extent, 0.2f * extent)};
        p.x += random_range(seed, 4, i, -0.5f, 0.5f);
        p.y += random_range(seed, 5, i, -0.5f, 0.5f);
        p.z += random_range(seed, 6, i, -0.5f, 0.5f);
        LightKind kind = group % 4 == 3 ? LIGHT_SPOT : LIGHT_POINT;
        Entity e = fixture_spawn_light(f, kind, p, random_range(seed, 7, i, 0.4f, 5));
        LightTable *light = FIXTURE_TABLE(f, Light, light);
        u32 row = FIXTURE_ROW(f, light, e);
        light->intensity[row] = i % 13 == 5 ? 0.0f : random_range(seed, 8, i, 0.01f, 4);
        light->color_r[row] = random_range(seed, 9, i, 0, 1);
        light->color_g[row] = random_range(seed, 10, i, 0, 1);
        light->priority[row] = i % 29 == 7 ? 100.0f : random_range(seed, 11, i, 0.5f, 2);
        light->outer_angle[row] = 30.0f + (f32)(i % 3);
        light->inner_angle[row] = 20.0f;
        TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
        t->pitch[FIXTURE_ROW(f, transform, e)] = -90.0f + random_range(seed, 12, i, -3, 3);
    }
    for (u32 i = 0; i < 2; i++) fixture_spawn_light(f, LIGHT_DIRECTIONAL, vec3(0, 0, 0), 0);
    systems_settle(&f->systems, &f->context);
}

static LightScene scene_of(SystemsFixture *f) {
    const LightTable *light = FIXTURE_TABLE(f, Light, light);
    LightCandidates c = light_candidates(light, 1.0f, &f->arenas.level);
    return light_scene_make(f->world, ENTITY_NONE, &c);
}

static u32 lit_rows(const LightScene *scene, u32 *rows) {
    u32 count = 0;
    for (u32 i = 0; i < scene->count; i++)
        if (scene->candidates.radius[i] >= 0) rows[count++] = i;
    return count;
}

// ---- merging ----

// Each light in row order takes the best of all free lights after it.
static void naive_pairs(const LightScene *scene, const u32 *rows, u32 count, u32 *partner) {
    for (u32 i = 0; i < scene->count; i++) partner[i] = ROW_NONE;
    for (u32 i = 0; i < count; i++) {
        f32 best = INFINITY, error;
        u32 other = ROW_NONE;
        if (partner[rows[i]] != ROW_NONE) continue;
        for (u32 k = i + 1; k < count; k++)
            if (partner[rows[k]] == ROW_NONE &&
                light_may_merge(scene, rows[i], rows[k], false, &error) && error < best)
                other = rows[k], best = error;
        if (other != ROW_NONE) partner[rows[i]] = other, partner[other] = rows[i];
    }
}

TEST(systems_light_manager, merging_finds_what_a_search_finds) {
    const u64 seed = 0x3E6;
    printf("seed %llx\n", (unsigned long long)seed);
    u32 pairs = 0, spots = 0;
    for (u32 round = 0; round < 30; round++) {
        SystemsFixture *f = systems_fixture_create(5);
        spawn_lights(f, seed + round, 600, round % 2 ? 12.0f : 40.0f);
        LightManagerTable *m = manager_columns(f);
        m->merge_distance[0] = (f32)(round % 5) * 3.0f;
        m->merge_error[0] = round % 3 ? 0.05f : 1.0f;
        LightScene scene = scene_of(f);
        static u32 rows[1024], partner[1024];
        u32 count = lit_rows(&scene, rows);
        LightDecision d = light_decision_make(scene.count, &f->arenas.level);
        light_merge_find(&scene, NULL, rows, count, &d, &f->arenas.scratch);
        naive_pairs(&scene, rows, count, partner);
        assert_memory_equal(d.partner, partner, scene.count * sizeof(u32));
        for (u32 i = 0; i < scene.count; i++) {
            if (d.partner[i] == ROW_NONE) continue;
            pairs++;
            spots += scene.light->kind[i] == LIGHT_SPOT;
            assert_int_equal(scene.light->kind[i], scene.light->kind[d.partner[i]]);
            assert_true(scene.light->priority[i] < LIGHT_PINNED_PRIORITY);
            assert_true(d.pair_error[i] <= m->merge_error[0] && d.pair_weight[i] == 1.0f);
        }
        assert_int_equal(f->arenas.scratch.used, 0);
        systems_fixture_destroy(f);
    }
    printf("    %u lights in pairs, %u of them spots\n", pairs, spots);
    assert_true(pairs > 1000 && spots > 100);
}

TEST(systems_light_manager, merging_keeps_energy_and_covers_both) {
    const u64 seed = 0x3E7;
    SystemsFixture *f = systems_fixture_create(5);
    spawn_lights(f, seed, 900, 20.0f);
    set_exposure(f, 0.02f);
    manager_columns(f)->merge_error[0] = 1.0f;
    manager_columns(f)->merge_distance[0] = 0.0f;
    LightScene s = scene_of(f);
    const LightTable *light = s.light;
    u32 checked = 0;
    for (u32 a = 0; a + 1 < s.count; a++) {
        for (u32 b = a + 1; b < MIN(a + 3, s.count); b++) {
            f32 error;
            if (!light_may_merge(&s, a, b, false, &error)) continue;
            checked++;
            MergedLight m = light_merge_pair(light, &s.candidates, a, b);
            const f32 *columns[3] = {s.candidates.r, s.candidates.g, s.candidates.b};
            const f32 merged[3] = {m.color.x, m.color.y, m.color.z};
            for (u32 k = 0; k < 3; k++) {
                f64 angle = 1, angle_a = 1, angle_b = 1; // solid angles, up to one factor
                if (light->kind[a] == LIGHT_SPOT) {
                    angle = 1 - cos(m.outer_deg * (f32)M_PI / 180);
                    angle_a = 1 - cos(light->outer_angle[a] * (f32)M_PI / 180);
                    angle_b = 1 - cos(light->outer_angle[b] * (f32)M_PI / 180);
                }
                f64 want = (f64)columns[k][a] * angle_a + (f64)columns[k][b] * angle_b;
                ASSERT_NEAR((f64)merged[k] * angle, want, 1e-4 * want + 1e-6);
            }
            // Both spheres lie in the merged one.
            u32 rows[2] = {a, b};
            for (u32 i = 0; i < 2; i++) {
                u32 r = rows[i];
                Vec3 from = vec3_sub(vec3(light->x[r], light->y[r], light->z[r]), m.position);
                assert_true(vec3_length(from) + light->reach[r] <= m.range * 1.00001f);
                if (light->kind[r] == LIGHT_SPOT) assert_true(m.outer_deg >= light->outer_angle[r]);
            }
            // On the line between them, nearer to the stronger.
            f64 ea = (f64)s.candidates.r[a] + s.candidates.g[a] + s.candidates.b[a],
                eb = (f64)s.candidates.r[b] + s.candidates.g[b] + s.candidates.b[b];
            ASSERT_NEAR(m.position.x, (light->x[a] * ea + light->x[b] * eb) / (ea + eb), 1e-4);
            ASSERT_NEAR(m.position.z, (light->z[a] * ea + light->z[b] * eb) / (ea + eb), 1e-4);
        }
    }
    assert_true(checked > 100);
    systems_fixture_destroy(f);
}

// The documented integral, done numerically: two lights over a plane, against the merged one.
TEST(systems_light_manager, predicted_error_is_that_of_a_lit_plane) {
    static const f32 apart[] = {0.02f, 0.1f, 0.3f, 0.8f};
    for (u32 i = 0; i < COUNT_OF(apart); i++) {
        SystemsFixture *f = systems_fixture_create(5);
        for (u32 k = 0; k < 2; k++)
            fixture_spawn_light(f, LIGHT_POINT, vec3(k ? apart[i] : 0, 0, -20), 4);
        systems_settle(&f->systems, &f->context);
        LightScene s = scene_of(f);
        f64 predicted = (f64)light_merge_error(&s, 0, 1);
        MergedLight m = light_merge_pair(s.light, &s.candidates, 0, 1);
        f64 sum = 0, step = 0.02, height = 1.0;
        for (f64 x = -12; x < 12; x += step)
            for (f64 z = -12; z < 12; z += step) {
                f64 e[3], at[3] = {0, (f64)apart[i], (f64)m.position.x};
                for (u32 k = 0; k < 3; k++) {
                    f64 range = k < 2 ? 4.0 : (f64)m.range, dx = x - at[k];
                    f64 d2 = dx * dx + z * z + height * height, w = 1 - d2 * d2 / pow(range, 4);
                    e[k] = w > 0 ? w * w / d2 * height / sqrt(d2) : 0;
                }
                sum += fabs(e[0] + e[1] - 2 * e[2]) * step * step;
            }
        f64 px = (f64)s.focal_px / 20, real = sum * (f64)s.white * px * px / (64.0 * 64.0);
        printf("    %.2f m apart: predicted %.5f, real %.5f\n", (f64)apart[i], predicted, real);
        assert_true(predicted >= real * 0.95);
        assert_true(predicted < real * 3 + 1e-4);
        systems_fixture_destroy(f);
    }
}

TEST(systems_light_manager, held_pairs_have_slack) {
    SystemsFixture *f = systems_fixture_create(5);
    for (u32 k = 0; k < 2; k++) fixture_spawn_light(f, LIGHT_POINT, vec3((f32)k * 0.3f, 0, -30), 4);
    systems_settle(&f->systems, &f->context);
    LightManagerTable *m = manager_columns(f);
    LightScene s = scene_of(f);
    f32 error = light_merge_error(&s, 0, 1), unused;
    const struct {
        f32 threshold, distance;
        bool fresh, held;
    } cases[] = {{error * 1.01f, 15, true, true},  {error * 0.99f, 15, false, true},
                 {error / 1.49f, 15, false, true}, {error / 1.51f, 15, false, false},
                 {error * 1.01f, 31, false, true}, {error * 1.01f, 34, false, false}};
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        m->merge_error[0] = cases[i].threshold;
        m->merge_distance[0] = cases[i].distance;
        s = scene_of(f);
        assert_int_equal(light_may_merge(&s, 0, 1, false, &unused), cases[i].fresh);
        assert_int_equal(light_may_merge(&s, 0, 1, true, &unused), cases[i].held);
    }
    systems_fixture_destroy(f);
}

// ---- dropping ----

TEST(systems_light_manager, dropping_follows_area_and_contribution) {
    const u64 seed = 0x3E8;
    u32 faded = 0, gone = 0, full = 0;
    for (u32 round = 0; round < 12; round++) {
        SystemsFixture *f = systems_fixture_create(5);
        spawn_lights(f, seed + round, 400, 60.0f);
        EnvironmentTable *e = FIXTURE_TABLE(f, Environment, environment);
        if (round % 3) {
            world_singleton(f->world, COMPONENT_environment);
            e->attenuation[0] = round % 3;
        }
        LightManagerTable *m = manager_columns(f);
        m->drop_area[0] = round % 2 ? 900.0f : 0.0f;
        m->drop_contribution[0] = round % 4 < 2 ? 0.3f : 0.004f;
        LightScene s = scene_of(f);
        f64 focal = 360 / tan(30 * M_PI / 180), white = 0.5 / M_PI;
        for (u32 i = 0; i < s.count; i++) {
            const LightCandidates *c = &s.candidates;
            if (c->radius[i] < 0) continue;
            Vec3 center = {c->x[i], c->y[i], c->z[i]};
            f32 got = light_drop_weight(&s, center, c->radius[i], vec3(c->r[i], c->g[i], c->b[i]),
                                        s.light->reach[i]);
            f64 r = c->radius[i], range = s.light->reach[i],
                d2 = (f64)center.x * center.x + (f64)center.y * center.y + (f64)center.z * center.z;
            f64 want = 1;
            if (d2 > r * r && m->drop_area[0] > 0)
                want = MIN(want, M_PI * focal * focal * r * r / (d2 - r * r) / m->drop_area[0] - 1);
            f64 at = MAX(MAX(sqrt(d2) - r, 0.1) / focal, 0.25);
            at = MIN(at, range / 2);
            f64 x = at / range, attenuation = pow(1 - pow(x, 4), 2) / (at * at);
            if (round % 3) attenuation = 1 - x * x;
            if (round % 3 == 2) attenuation /= 1 + at * at;
            f64 bright = MAX(MAX(c->r[i], c->g[i]), c->b[i]);
            want = MIN(want, bright * attenuation * white / (f64)m->drop_contribution[0] - 1);
            want = CLAMP(want, 0.0, 1.0);
            ASSERT_NEAR(got, want, 2e-3);
            faded += got > 0 && got < 1, gone += got == 0, full += got == 1;
        }
        systems_fixture_destroy(f);
    }
    printf("    full %u faded %u gone %u\n", full, faded, gone);
    assert_true(faded > 100 && gone > 100 && full > 100);
}

// ---- budget ----

static bool covers_region(const LightScene *s, const BudgetLight *l, u32 x, u32 y) {
    const PacketView *v = &s->view;
    Vec3 d = vec3_sub(l->center, v->position);
    f32 z = -vec3_dot(d, v->forward), a0, a1, b0, b1;
    if (!sphere_bounds_axis(vec3_dot(d, v->right), z, l->radius, v->near, 1 / v->tan_x, &a0, &a1) ||
        !sphere_bounds_axis(vec3_dot(d, v->up), z, l->radius, v->near, 1 / v->tan_y, &b0, &b1))
        return false;
    f32 left = (a0 * 0.5f + 0.5f) * REGIONS_X, right = (a1 * 0.5f + 0.5f) * REGIONS_X;
    f32 top = (-b1 * 0.5f + 0.5f) * REGIONS_Y, bottom = (-b0 * 0.5f + 0.5f) * REGIONS_Y;
    return (f32)(x + 1) > left && (f32)x <= right && (f32)(y + 1) > top && (f32)y <= bottom;
}

// Again and again the most important light that is left: in if none of its regions is full.
static void naive_budget(const LightScene *s, const BudgetLight *l, u32 count, u32 budget,
                         f64 *weight) {
    static u32 taken[REGION_COUNT];
    static f64 refused[REGION_COUNT];
    memset(taken, 0, sizeof taken);
    memset(refused, 0, sizeof refused);
    u8 *done = calloc(count, 1);
    for (u32 turn = 0; turn < count; turn++) {
        u32 best = UINT32_MAX;
        for (u32 i = 0; i < count; i++)
            if (!done[i] && (best == UINT32_MAX || (l[i].pinned && !l[best].pinned) ||
                             (l[i].pinned == l[best].pinned && !l[i].pinned &&
                              l[i].importance > l[best].importance)))
                best = i;
        done[best] = 1;
        bool fits = true;
        for (u32 k = 0; k < REGION_COUNT; k++) {
            if (!covers_region(s, &l[best], k % REGIONS_X, k / REGIONS_X)) continue;
            if (taken[k] < budget || l[best].pinned) continue;
            fits = false;
            if (refused[k] == 0) refused[k] = l[best].importance;
        }
        weight[best] = fits;
        for (u32 k = 0; k < REGION_COUNT && fits; k++)
            taken[k] += covers_region(s, &l[best], k % REGIONS_X, k / REGIONS_X);
    }
    for (u32 i = 0; i < count; i++)
        for (u32 k = 0; k < REGION_COUNT && !l[i].pinned; k++)
            if (weight[i] > 0 && refused[k] > 0 &&
                covers_region(s, &l[i], k % REGIONS_X, k / REGIONS_X))
                weight[i] = MIN(weight[i], (l[i].importance / refused[k] - 1) / 0.25);
    free(done);
}

TEST(systems_light_manager, budget_keeps_the_most_important) {
    const u64 seed = 0x3E9;
    u32 refused = 0, faded = 0, pinned = 0;
    for (u32 round = 0; round < 8; round++) {
        SystemsFixture *f = systems_fixture_create(5);
        spawn_lights(f, seed + round, 150, 20.0f);
        LightScene s = scene_of(f);
        static BudgetLight lights[256];
        static f32 weight[256];
        static f64 want[256];
        u32 count = 0, budget = 1 + round * 2;
        for (u32 i = 0; i < s.count; i++) {
            const LightCandidates *c = &s.candidates;
            if (c->radius[i] < 0) continue;
            Vec3 center = {c->x[i], c->y[i], c->z[i]};
            lights[count] = (BudgetLight){center, c->radius[i], 0, light_pinned(s.light, i)};
            // Equal ones among them: the order of rows decides.
            lights[count++].importance =
                i % 5 == 0
                    ? 1.0f
                    : light_importance(&s, center, c->radius[i], vec3(c->r[i], c->g[i], c->b[i]),
                                       s.light->reach[i], s.light->priority[i]);
        }
        light_budget(&s, lights, count, budget, weight, &f->arenas.scratch);
        naive_budget(&s, lights, count, budget, want);
        for (u32 i = 0; i < count; i++) {
            ASSERT_NEAR(weight[i], CLAMP(want[i], 0.0, 1.0), 1e-4);
            if (lights[i].pinned) assert_true(weight[i] == 1.0f);
            refused += weight[i] == 0, faded += weight[i] > 0 && weight[i] < 1;
            pinned += lights[i].pinned;
        }
        for (u32 k = 0; k < REGION_COUNT; k++) {
            u32 here = 0, fixed = 0;
            for (u32 i = 0; i < count; i++)
                if (weight[i] > 0 && covers_region(&s, &lights[i], k % REGIONS_X, k / REGIONS_X))
                    here++, fixed += lights[i].pinned;
            assert_true(here <= MAX(budget, fixed));
        }
        systems_fixture_destroy(f);
    }
    printf("    refused %u faded %u pinned %u\n", refused, faded, pinned);
    assert_true(refused > 100 && faded > 5 && pinned > 20);
}

// ---- the packet ----

static const Packet *packet_with(SystemsFixture *f, const char *const *sets, u32 set_count) {
    RenderSettings settings = settings_default();
    settings.view = VIEW_LIGHT_STATES;
    for (u32 i = 0; i < set_count; i++) assert_true(settings_set(&settings, sets[i]));
    const Packet *p = fixture_packet(f, ENTITY_NONE, settings, 640, 360, 0);
    assert_null(packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT));
    return p;
}

TEST(systems_light_manager, counters_add_up_and_marks_say_the_same) {
    static const char *const variants[][2] = {
        {"manager=on", "budget=6"},        {"merge=off", "budget=6"},
        {"drop=off", "budget=4"},          {"budget=0", "merge=on"},
        {"light_culling=off", "budget=9"}, {"occlusion=off", "budget=6"},
        {"manager=off", "budget=6"}};
    SystemsFixture *f = systems_fixture_create(5);
    spawn_lights(f, 0x3EA, 1500, 50.0f);
    for (u32 i = 0; i < 3; i++) {
        Entity wall = fixture_spawn(f, vec3((f32)i * 12 - 12, 0, -12));
        u32 row = FIXTURE_ADD(f, occluder, wall);
        OccluderTable *o = FIXTURE_TABLE(f, Occluder, occluder);
        o->size_x[row] = 4, o->size_y[row] = 7;
    }
    systems_settle(&f->systems, &f->context);
    LightManagerTable *m = manager_columns(f);
    m->merge_distance[0] = 5, m->merge_error[0] = 0.1f, m->drop_contribution[0] = 0.03f;
    set_exposure(f, 0.1f);
    for (u32 v = 0; v < COUNT_OF(variants); v++) {
        const Packet *p = packet_with(f, variants[v], 2);
        const PacketCounts *c = &p->counts;
        u32 fates[LIGHT_FATE_COUNT] = {0}, merging = 0;
        const PacketLightMark *marks = PACKET_DATA(p, light_marks, PacketLightMark);
        u32 shown = p->lights.count - 1;
        u8 *named = calloc(shown + 1, 1);
        for (u32 i = 0; i < p->light_marks.count; i++) {
            fates[marks[i].fate]++;
            // A partner is still shown while the pair blends; without memory it never is.
            if (marks[i].fate == LIGHT_MERGED) merging++, assert_true(marks[i].weight == 0);
            bool is_shown = marks[i].fate == LIGHT_KEPT ||
                            (marks[i].fate == LIGHT_MERGER && marks[i].weight > 0);
            assert_int_equal(marks[i].light != UINT32_MAX, is_shown);
            if (is_shown) assert_int_equal(named[marks[i].light]++, 0);
        }
        for (u32 i = 0; i < shown; i++) assert_int_equal(named[i], 1);
        free(named);
        u32 kept = shown - c->lights_merged_pairs;
        printf("    %-18s %u of %u in view, hidden %u merged %u (%u pairs) dropped %u budget %u "
               "fading %u kept %u\n",
               variants[v][0], c->lights_visible, c->lights_total, c->lights_occluded,
               c->lights_merged, c->lights_merged_pairs, c->lights_dropped, c->lights_over_budget,
               c->lights_fading, kept);
        assert_int_equal(c->lights_visible, c->lights_occluded + c->lights_merged +
                                                c->lights_dropped + c->lights_over_budget + kept);
        assert_int_equal(fates[LIGHT_KEPT], kept);
        assert_int_equal(fates[LIGHT_OCCLUDED], c->lights_occluded);
        assert_int_equal(fates[LIGHT_MERGED], c->lights_merged);
        assert_int_equal(fates[LIGHT_MERGER], c->lights_merged_pairs);
        assert_int_equal(fates[LIGHT_DROPPED], c->lights_dropped);
        assert_int_equal(fates[LIGHT_OVER_BUDGET], c->lights_over_budget);
        assert_int_equal(c->lights_near + c->lights_between + c->lights_far, shown);
        assert_int_equal(p->directionals.count, 2);
        if (v == 0)
            assert_true(c->lights_occluded > 20 && c->lights_merged_pairs > 20 &&
                        c->lights_dropped > 10 && c->lights_over_budget > 10 &&
                        c->lights_between > 10 && c->lights_far > 10);
        if (v == 1) assert_int_equal(c->lights_merged + c->lights_merged_pairs, 0);
        if (v == 2) assert_int_equal(c->lights_dropped, 0);
        if (v == 3) assert_int_equal(c->lights_over_budget, 0);
        if (v == 5) assert_int_equal(c->lights_occluded, 0);
        if (v == 6) {
            u32 lit = 0;
            for (u32 i = 0; i < p->light_marks.count; i++) lit += marks[i].weight == 1;
            assert_int_equal(kept, lit);
            assert_int_equal(lit, p->light_marks.count);
            assert_int_equal(c->lights_near, kept);
        }
    }
    systems_fixture_destroy(f);
}

// Points, diffuse points, spots, diffuse spots; within a class by row, a merged light at its first
// partner's place. Rows are told by the level's order here: nothing was removed.
TEST(systems_light_manager, records_keep_a_stable_order) {
    SystemsFixture *f = systems_fixture_create(5);
    spawn_lights(f, 0x3EB, 1200, 40.0f);
    set_exposure(f, 0.1f);
    manager_columns(f)->merge_distance[0] = 5;
    manager_columns(f)->merge_error[0] = 0.05f;
    const Packet *p = packet_with(f, NULL, 0);
    const LightRecord *r = PACKET_DATA(p, lights, LightRecord);
    const u32 *counts = p->frame.counts, *highlights = p->frame.counts3;
    assert_int_equal(counts[0] + counts[1], p->lights.count - 1);
    for (u32 i = 0; i < counts[0] + counts[1]; i++) {
        u32 at = i < counts[0] ? i : i - counts[0];
        assert_int_equal(r[i].color[3] > 0, at < highlights[i < counts[0] ? 0 : 1]);
        assert_true(r[i].color[3] >= 0 && r[i].color[3] <= 1);
    }
    const PacketLightMark *marks = PACKET_DATA(p, light_marks, PacketLightMark);
    // Unmerged ones: marks lie in row order, so indices rise within each class.
    u32 ends[4] = {highlights[0], counts[0], counts[0] + highlights[1], counts[0] + counts[1]};
    i64 last[4] = {-1, -1, -1, -1};
    u32 seen[4] = {0};
    for (u32 i = 0; i < p->light_marks.count && marks[i].fate != LIGHT_MERGER; i++) {
        if (marks[i].light == UINT32_MAX) continue;
        u32 class = 0;
        while (marks[i].light >= ends[class]) class ++;
        assert_true((i64)marks[i].light > last[class]);
        last[class] = marks[i].light;
        seen[class]++;
        for (u32 k = 0; k < 3; k++)
            assert_true(r[marks[i].light].position[k] == marks[i].position[k]);
        assert_int_equal(marks[i].cos_outer >= -1.0f, class >= 2);
    }
    for (u32 k = 0; k < 4; k++) assert_true(seen[k] > 5);
    assert_true(p->counts.lights_merged_pairs > 10 && p->counts.merge_error > 0);
    // The dummy lights nothing and comes last.
    assert_true(r[p->lights.count - 1].color[0] == 0 && r[p->lights.count - 1].color[3] == 0);
    systems_fixture_destroy(f);
}

TEST(systems_light_manager, highlights_fade_with_distance) {
    SystemsFixture *f = systems_fixture_create(5);
    static const f32 depth[] = {5, 21.9f, 22.1f, 27, 32, 41, 43, 60};
    for (u32 i = 0; i < COUNT_OF(depth); i++)
        fixture_spawn_light(f, LIGHT_POINT, vec3((f32)i * 0.1f, 0, -depth[i]), 2);
    systems_settle(&f->systems, &f->context);
    static const char *const sets[] = {"merge=off", "drop=off"};
    const Packet *p = packet_with(f, sets, 2);
    const PacketLightMark *marks = PACKET_DATA(p, light_marks, PacketLightMark);
    assert_int_equal(p->light_marks.count, COUNT_OF(depth));
    for (u32 i = 0; i < COUNT_OF(depth); i++) {
        f64 to = sqrt((f64)depth[i] * depth[i] + 0.01 * i * i) - 2; // nearest point of the volume
        ASSERT_NEAR(marks[i].highlight, CLAMP((40 - to) / 20, 0.0, 1.0), 1e-4);
        ASSERT_NEAR(PACKET_DATA(p, lights, LightRecord)[marks[i].light].color[3],
                    marks[i].highlight, 0);
    }
    assert_int_equal(p->counts.lights_near, 2);
    assert_int_equal(p->counts.lights_far, 2);
    static const char *const off[] = {"light_lod=off", "merge=off", "drop=off"};
    p = packet_with(f, off, 3);
    assert_int_equal(p->counts.lights_near, COUNT_OF(depth));
    systems_fixture_destroy(f);
}

TEST(systems_light_manager, vertex_lighting_distance_goes_along) {
    SystemsFixture *f = systems_fixture_create(5);
    manager_columns(f)->vertex_lighting[0] = 33.0f;
    assert_true(packet_with(f, NULL, 0)->frame.vertex_lighting[0] == 33.0f);
    static const char *const off[] = {"vertex_lighting=off"};
    assert_true(packet_with(f, off, 1)->frame.vertex_lighting[0] == 0.0f);
    systems_fixture_destroy(f);
}

TEST(systems_light_manager, threads_do_not_matter) {
    u64 hash[3];
    for (u32 i = 0; i < 3; i++) {
        static const u32 threads[] = {1, 2, 7};
        jobs_start(threads[i]);
        SystemsFixture *f = systems_fixture_create(5);
        spawn_lights(f, 0x3EC, 4000, 60.0f);
        manager_columns(f)->budget[0] = 8;
        const Packet *p = packet_with(f, NULL, 0);
        hash[i] = hash_bytes(p, p->size, 0);
        systems_fixture_destroy(f);
        jobs_stop();
    }
    assert_true(hash[0] == hash[1] && hash[1] == hash[2]);
}

TEST(systems_light_manager, nothing_and_nonsense) {
    SystemsFixture *f = systems_fixture_create(5);
    packet_with(f, NULL, 0); // no lights
    for (u32 i = 0; i < 40; i++)
        fixture_spawn_light(f, i % 2 ? LIGHT_SPOT : LIGHT_POINT, vec3(0, 0, i < 20 ? 0.0f : -30),
                            5);
    systems_settle(&f->systems, &f->context);
    LightManagerTable *m = manager_columns(f);
    m->merge_distance[0] = 0, m->merge_error[0] = 1, m->lod_near[0] = 50, m->lod_far[0] = 10;
    m->drop_area[0] = 1e6f, m->budget[0] = 1;
    packet_with(f, NULL, 0); // all in one place, in the eye, thresholds upside down
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    light->x[3] = NAN, light->reach[5] = INFINITY, light->intensity[7] = INFINITY;
    light->reach[9] = 0, light->priority[11] = -1, light->outer_angle[13] = 0;
    RenderSettings settings = settings_default();
    fixture_packet(f, ENTITY_NONE, settings, 640, 360, 0); // must not crash or hang
    systems_fixture_destroy(f);
}

// ---- surfaces ----

TEST(systems_light_manager, surfaces_are_about_as_far_as_they_are) {
    const u64 seed = 0x3ED;
    AssetStore store;
    assert_true(asset_store_create(&store));
    u32 model = asset_generate_model(&store, &(ShapeDesc){.shape = SHAPE_CUBE});
    u32 mesh = store.models[model].parts[0].mesh;
    SystemsFixture *f = systems_fixture_create(5);
    f->context.assets = &store;
    for (u32 i = 0; i < 2; i++)
        fixture_spawn_light(f, LIGHT_POINT,
                            vec3(i ? 4.0f : -4.0f, i ? 2.0f : -2.0f, i ? 3.0f : -3.0f), 2);
    fixture_spawn_mesh(f, mesh, vec3(0, -1, 0), vec3(6, 1, 4), 0, COLLISION_NONE);
    Entity flying = fixture_spawn_mesh(f, mesh, vec3(0, 2, 0), vec3(1, 1, 1), 0, COLLISION_NONE);
    FIXTURE_ADD(f, orbit, flying); // moves: not counted
    systems_settle(&f->systems, &f->context);
    LightSurfaces *s = light_surfaces_build(f->world, &store, &f->arenas.level);
    assert_true((u64)s->nx * s->ny * s->nz <= LIGHT_SURFACES_CELLS);
    f64 cap = LIGHT_SURFACES_CAP * (f64)s->cell_m / 3;
    for (u32 i = 0; i < 4000; i++) {
        Vec3 p = {random_range(seed, 1, i, -7, 7), random_range(seed, 2, i, -5, 5),
                  random_range(seed, 3, i, -6, 6)};
        f64 out[3] = {fabs((f64)p.x) - 3, fabs((f64)p.y + 1) - 0.5, fabs((f64)p.z) - 2}, to = 0;
        f64 inside = MAX(MAX(out[0], out[1]), out[2]);
        for (u32 k = 0; k < 3; k++) to += MAX(out[k], 0) * MAX(out[k], 0);
        to = inside > 0 ? sqrt(to) : -inside;
        f64 got = light_surface_distance(s, p, 99);
        // A chamfer distance is off by a tenth, a cell has a diagonal.
        if (got < cap - 1e-3)
            ASSERT_NEAR(got, to, 0.12 * to + 1.9 * (f64)s->cell_m);
        else
            assert_true(to > cap * 0.85);
    }
    assert_true(light_surface_distance(s, vec3(100, 0, 0), 99) == 99);
    assert_true(light_surface_distance(NULL, vec3(0, 0, 0), 7) == 7);
    systems_fixture_destroy(f);
    asset_store_destroy(&store);
}

// Two lights that would be merged in the open are not where a wall passes close by.
TEST(systems_light_manager, close_surfaces_keep_pairs_apart) {
    SystemsFixture *f = systems_fixture_create(5);
    for (u32 k = 0; k < 2; k++) fixture_spawn_light(f, LIGHT_POINT, vec3((f32)k * 0.3f, 0, -30), 4);
    systems_settle(&f->systems, &f->context);
    manager_columns(f)->merge_error[0] = 1;
    LightScene scene = scene_of(f);
    f32 error;
    assert_true(light_may_merge(&scene, 0, 1, false, &error));
    u8 distance = 0;
    LightSurfaces wall = {
        .origin = {-50, -50, -80}, .cell_m = 100, .nx = 1, .ny = 1, .nz = 1, .distance = &distance};
    scene.surfaces = &wall;
    assert_false(light_may_merge(&scene, 0, 1, false, &error));
    // Numerically: the largest change on a plane at the height that the grid says.
    f64 h = 0.6, worst = 0;
    distance = 3, wall.cell_m = (f32)h, wall.origin = vec3(-0.1f, -0.1f, -30.1f);
    MergedLight m = light_merge_pair(scene.light, &scene.candidates, 0, 1);
    for (f64 x = -3; x < 3; x += 0.005) {
        f64 sum = 0, at[3] = {0, (f64)0.3f, (f64)m.position.x};
        for (u32 k = 0; k < 3; k++)
            sum += (k < 2 ? 1 : -2) * h / pow(h * h + (x - at[k]) * (x - at[k]), 1.5);
        worst = MAX(worst, fabs(sum));
    }
    f64 peak = (f64)light_merge_peak(&scene, 0, 1), real = worst * (f64)scene.white;
    printf("    peak predicted %.4f, real %.4f\n", peak, real);
    assert_true(peak >= real && peak < 4 * real);
    systems_fixture_destroy(f);
}
