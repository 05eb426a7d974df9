// systems_light_manager_state.c: the light manager in time: nothing jumps, nothing flickers, the
// same ticks and cameras give the same, whatever was drawn between.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/app/session.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/systems/light_manager_state.h"
#include <stdio.h>
#include <stdlib.h>

static LightManagerTable *manager_columns(SystemsFixture *f) {
    world_singleton(f->world, COMPONENT_light_manager);
    return FIXTURE_TABLE(f, LightManager, light_manager);
}

static void tick(SystemsFixture *f, LightManagerState *state, Entity camera) {
    systems_tick(&f->systems, &f->context);
    light_manager_tick(state, f->world, &f->assets, camera, &f->arenas.scratch);
}

static void cut(SystemsFixture *f, LightManagerState *state, Entity camera) {
    light_manager_cut(state, f->world, &f->assets, camera, &f->arenas.scratch);
}

// Two lights whose distance the test sets.
static void place_pair(SystemsFixture *f, const Entity *pair, f32 apart) {
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    for (u32 i = 0; i < 2; i++) {
        u32 row = FIXTURE_ROW(f, transform, pair[i]);
        t->x[row] = i ? apart : 0;
        table_touch(&t->table, row);
    }
}

TEST(systems_light_manager_state, a_pair_at_the_threshold_does_not_flicker) {
    SystemsFixture *f = systems_fixture_create(5);
    Entity pair[2];
    for (u32 i = 0; i < 2; i++)
        pair[i] = fixture_spawn_light(f, LIGHT_POINT, vec3((f32)i, 0, -30), 4);
    LightManagerTable *m = manager_columns(f);
    m->merge_error[0] = 0.01f;
    LightManagerState *state = light_manager_create();
    place_pair(f, pair, 1.9f);
    systems_settle(&f->systems, &f->context);
    cut(f, state, ENTITY_NONE);
    // The limit, by coming nearer until they merge.
    f32 limit = 1.9f, weight = 0;
    for (; limit > 0.01f && !light_manager_partner(state, f->world, pair[0], &weight);
         limit -= 0.01f) {
        place_pair(f, pair, limit);
        for (u32 i = 0; i < 6; i++) tick(f, state, ENTITY_NONE);
    }
    printf("    merges at %.2f m\n", (f64)limit);
    assert_true(limit > 0.1f && limit < 1.8f);
    // Twelve per cent more and less about the limit: error goes by half as much again at most.
    u32 changes = 0;
    f32 before = 0;
    for (u32 i = 0; i < 600; i++) {
        place_pair(f, pair, limit * (i / 9 % 2 ? 0.9f : 1.12f));
        tick(f, state, ENTITY_NONE);
        assert_true(light_manager_partner(state, f->world, pair[0], &weight) == pair[1]);
        assert_true(weight >= before); // never back
        changes += weight != before;
        before = weight;
    }
    assert_true(weight == 1.0f);
    printf("    in %u ticks\n", changes);
    assert_in_range(changes, 12, 200);
    // Far apart it splits, and both are back.
    place_pair(f, pair, 1.9f);
    for (u32 i = 0; i < 360; i++) tick(f, state, ENTITY_NONE);
    assert_int_equal(light_manager_partner(state, f->world, pair[0], &weight), ENTITY_NONE);
    for (u32 i = 0; i < 2; i++) assert_true(light_manager_weight(state, f->world, pair[i]) == 1.0f);
    light_manager_destroy(state);
    systems_fixture_destroy(f);
}

// ---- pace ----

// What a pixel shows, 0..255.
static f64 shown(f64 radiance) {
    f64 x = radiance / (1 + radiance);
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055);
}

// However bright a light is where it shines, and whatever else lights the pixel: in no tick of a
// fade does the pixel change by 3 of 255. Nor where a lamp nearly touches its wall, nor where a
// hundred lights go at once.
TEST(systems_light_manager_state, a_fading_light_changes_no_pixel_much) {
    static const f64 others[] = {0, 0.001, 0.02, 0.3, 5};
    static const f64 counts[] = {1, 30};
    f64 most = 0;
    u32 longest = 0;
    for (f64 brightest = 1e-5; brightest < 2e4; brightest *= 1.7)
        for (u32 i = 0; i < COUNT_OF(others) * COUNT_OF(counts); i++) {
            // Pixels that many lights reach are not the brightest of each.
            f64 count = counts[i % 2], here = count > 1 ? brightest * 0.1 : brightest;
            f32 share = 1, tail = light_fade_tail((f32)brightest);
            f64 before = shown(others[i / 2] + here * count);
            if (count > 1 && brightest < 0.02) continue; // dark ones add up
            for (u32 ticks = 0; share != 1 || ticks < 300; ticks++) {
                share = light_share_step(share, ticks < 300 ? 0 : 1, tail, false);
                f64 now = shown(others[i / 2] + here * count * (f64)share);
                most = MAX(most, fabs(now - before));
                before = now;
                if (share > 0 && ticks < 300) longest = MAX(longest, ticks);
                assert_true(ticks < 600 && (ticks != 299 || share == 0));
            }
        }
    printf("    most in a tick %.3f of 255, at most %u ticks\n", most, longest);
    assert_true(most < 3);
}

// A pair's two lights and the merged one add up to one at every tick, also when they turn round.
TEST(systems_light_manager_state, a_pair_and_its_light_stay_in_step) {
    const u64 seed = 0x57AA;
    f64 most = 0, off = 0;
    for (u32 round = 0; round < 300; round++) {
        f64 pair = pow(10, (f64)random_range(seed, 1, round, -4, 2)),
            merged = pair * (f64)random_range(seed, 2, round, 0, 2),
            other = (f64)random_range(seed, 3, round, 0, 0.1f);
        LightSlot slot = {.weight = 1, .takes_place = true, .in_step = true};
        slot.tail = light_fade_tail((f32)fabs(pair - merged));
        u32 until = 40 + random_u32(seed, 4, round) % 200;
        f64 before = shown(pair + other);
        for (u32 ticks = 0; ticks < 900; ticks++) {
            slot.pair_target = ticks < until ? 1 : 0;
            slot.target = 1 - slot.pair_target;
            f32 own = light_slot_weight(&slot, 1), one = light_slot_pair_weight(&slot, 1);
            slot.weight = own, slot.pair_weight = one;
            f64 now = shown(pair * (f64)own + merged * (f64)one + other);
            most = MAX(most, fabs(now - before));
            off = MAX(off, fabs((f64)own + (f64)one - 1));
            before = now;
        }
        assert_true(slot.weight == 1 && slot.pair_weight == 0);
    }
    printf("    most in a tick %.3f of 255; off by %.1e\n", most, off);
    assert_true(most < 3 && off < 1e-6);
}

// From none to all takes as long as it can be seen.
TEST(systems_light_manager_state, what_nobody_sees_fades_fast) {
    static const f32 brightest[] = {0, 0.001f, 0.1f, 10, 300};
    u32 before = 0;
    for (u32 i = 0; i < COUNT_OF(brightest); i++) {
        u32 ticks[2] = {0, 0};
        for (u32 k = 0; k < 2; k++)
            for (f32 share = 1; share > 0 && ticks[k] < 999; ticks[k]++)
                share = light_share_step(share, 0, light_fade_tail(brightest[i]), k == 1);
        printf("    %8.3f: %3u ticks, a pair %3u\n", (f64)brightest[i], ticks[0], ticks[1]);
        assert_in_range(ticks[0], MAX(before, 12), 240);
        assert_in_range(ticks[1], ticks[0], 2 * ticks[0] + 2);
        before = ticks[0];
    }
}

typedef struct Seen {
    f32 own, pair;
    Entity partner;
} Seen;

static Seen see(const SystemsFixture *f, const LightManagerState *state, Entity light) {
    Seen seen = {.own = light_manager_weight(state, f->world, light)};
    seen.partner = light_manager_partner(state, f->world, light, &seen.pair);
    return seen;
}

// A camera that walks and turns among moving lights; lights die and come, so rows swap.
TEST(systems_light_manager_state, nothing_jumps) {
    const u64 seed = 0x57A7;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, seed, 1200);
    Entity camera = fixture_spawn(f, vec3(0, 0, 8));
    FIXTURE_ADD(f, camera, camera);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    for (u32 i = 0; i < 30; i++) light->priority[i * 7] = 100;
    LightManagerTable *m = manager_columns(f);
    m->merge_distance[0] = 6, m->merge_error[0] = 0.2f, m->budget[0] = 6;
    m->drop_contribution[0] = 0.03f;
    LightManagerState *state = light_manager_create();
    systems_settle(&f->systems, &f->context);
    cut(f, state, camera);
    Seen *before = calloc(f->world->entity_slots + 64, sizeof *before);
    Entity *known = calloc(f->world->entity_slots + 64, sizeof *known);
    TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    u32 pairs = 0, part = 0, none = 0, moves = 0;
    f32 most = 0;
    for (u32 k = 0; k < 240; k++) {
        u32 place = FIXTURE_ROW(f, transform, camera);
        t->z[place] -= 0.06f, t->yaw[place] += k % 80 < 40 ? 1.5f : -1.5f;
        table_touch(&t->table, place);
        if (k % 5 == 0) {
            world_despawn(f->world, light->table.entity[random_u32(seed, 1, k) % 900]);
            fixture_spawn_light(f, LIGHT_POINT, vec3(random_range(seed, 2, k, -9, 9), 0, -9), 3);
        }
        tick(f, state, camera);
        for (u32 row = 0; row < light->table.count; row++) {
            Entity e = light->table.entity[row];
            if (light->kind[row] == LIGHT_DIRECTIONAL) continue;
            u32 index = ENTITY_INDEX(e);
            Seen now = see(f, state, e), was = before[index];
            if (known[index] == e) {
                f32 step = fabsf(now.own - was.own);
                moves += step > 0;
                // A pair whose other light is gone is gone with it; else both ways in steps.
                if (now.partner == was.partner)
                    step = MAX(step, fabsf(now.pair - was.pair));
                else if (!now.partner && world_alive(f->world, was.partner))
                    step = MAX(step, was.pair);
                else if (!was.partner)
                    step = MAX(step, now.pair);
                most = MAX(most, step);
            }
            if (light->priority[row] >= 100) {
                assert_true(now.own == 1.0f && !now.partner);
            }
            if (now.partner) {
                Seen other = see(f, state, now.partner);
                if (world_alive(f->world, now.partner))
                    assert_true(other.partner == e && other.pair == now.pair);
            }
            pairs += now.partner != ENTITY_NONE;
            part += now.own > 0 && now.own < 1;
            none += now.own == 0;
            before[index] = now, known[index] = e;
        }
    }
    printf("    most in a tick %.5f; pairs %u, in part %u, none %u, moves %u\n", (f64)most, pairs,
           part, none, moves);
    assert_true(most <= LIGHT_FADE_RATE + 1e-6f);
    assert_true(pairs > 1000 && part > 1000 && none > 1000 && moves > 1000);
    free(before);
    free(known);
    light_manager_destroy(state);
    systems_fixture_destroy(f);
}

// Steady: after the fades every region has at most the budget's lights.
TEST(systems_light_manager_state, settles_to_what_is_decided_afresh) {
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, 0x57A8, 900);
    LightTable *light = FIXTURE_TABLE(f, Light, light);
    Table *const moving[] = {f->world->tables[COMPONENT_orbit], f->world->tables[COMPONENT_flicker],
                             f->world->tables[COMPONENT_pulse]};
    for (u32 i = 0; i < COUNT_OF(moving); i++) // a world that stands still
        while (moving[i]->count) table_remove(moving[i], moving[i]->entity[0]);
    world_singleton(f->world, COMPONENT_environment);
    FIXTURE_TABLE(f, Environment, environment)->exposure[0] = 0.1f;
    manager_columns(f)->budget[0] = 5;
    LightManagerState *slow = light_manager_create(), *fresh = light_manager_create();
    manager_columns(f)->merge_distance[0] = 1e5f;
    manager_columns(f)->drop_area[0] = 0;
    systems_settle(&f->systems, &f->context);
    cut(f, slow, ENTITY_NONE);
    manager_columns(f)->merge_distance[0] = 8;
    manager_columns(f)->merge_error[0] = 0.3f;
    manager_columns(f)->drop_area[0] = 3000;
    for (u32 i = 0; i < 400; i++) tick(f, slow, ENTITY_NONE);
    cut(f, fresh, ENTITY_NONE);
    u32 pairs = 0, none = 0;
    for (u32 row = 0; row < light->table.count; row++) {
        Seen a = see(f, slow, light->table.entity[row]),
             b = see(f, fresh, light->table.entity[row]);
        assert_true(a.partner == b.partner && a.own == b.own && a.pair == b.pair);
        pairs += a.partner != 0, none += a.own == 0;
    }
    assert_true(pairs > 20 && none > 50);
    light_manager_destroy(slow);
    light_manager_destroy(fresh);
    systems_fixture_destroy(f);
}

TEST(systems_light_manager_state, cuts_are_noticed) {
    SystemsFixture *f = systems_fixture_create(5);
    fixture_fill(f, 0x57A9, 100);
    Entity cameras[2];
    for (u32 i = 0; i < 2; i++) {
        cameras[i] = fixture_spawn(f, vec3((f32)i * 20, 0, 0));
        FIXTURE_ADD(f, camera, cameras[i]);
    }
    systems_settle(&f->systems, &f->context);
    LightManagerState *state = light_manager_create();
    assert_false(light_manager_knows(state, f->world, cameras[0]));
    cut(f, state, cameras[0]);
    assert_true(light_manager_knows(state, f->world, cameras[0]));
    assert_false(light_manager_knows(state, f->world, cameras[1]));
    for (u32 i = 0; i < 40; i++) {
        tick(f, state, cameras[0]);
        assert_true(light_manager_knows(state, f->world, cameras[0]));
    }
    f->world->tick += 100; // a saved world came back
    assert_false(light_manager_knows(state, f->world, cameras[0]));
    tick(f, state, cameras[0]);
    assert_true(light_manager_knows(state, f->world, cameras[0]));
    tick(f, state, cameras[1]);
    assert_true(light_manager_knows(state, f->world, cameras[1]));
    light_manager_destroy(state);
    light_manager_destroy(NULL);
    systems_fixture_destroy(f);
}

// ---- sessions ----

static u64 packet_hash(Session *session, const char *camera, const char *set, u32 width_px,
                       PacketCounts *counts) {
    RenderSettings settings = settings_default();
    if (set) assert_true(settings_set(&settings, set));
    session_frame_begin(session);
    const Packet *p = session_packet(session, &(SessionView){.camera = camera,
                                                             .settings = settings,
                                                             .width_px = width_px,
                                                             .height_px = 180});
    assert_non_null(p);
    if (counts) *counts = p->counts;
    return hash_bytes(PACKET_DATA(p, lights, LightRecord), p->lights.count * sizeof(LightRecord),
                      0);
}

// What is drawn between, with what settings and of what size, does not change what is drawn then.
TEST(systems_light_manager_state, pictures_between_do_not_matter) {
    u64 hashes[3][4];
    for (u32 run = 0; run < 3; run++) {
        jobs_start(run + 1);
        Session session;
        assert_true(session_create(&session, &luz_project));
        assert_true(session_load(&session, "data/levels/cloister.toml"));
        for (u32 k = 0, at = 0; k < 121; k++) {
            if (run == 1) packet_hash(&session, NULL, k % 3 ? "merge=off" : "budget=3", 100, NULL);
            if (run == 2 && k % 7 == 0) packet_hash(&session, NULL, NULL, 640, NULL);
            if (k == 20 || k == 61 || k == 90 || k == 120)
                hashes[run][at++] = packet_hash(&session, NULL, NULL, 320, NULL);
            Input input = {.move_z = 127};
            session_tick(&session, input);
        }
        session_destroy(&session);
        jobs_stop();
    }
    for (u32 i = 0; i < 4; i++)
        assert_true(hashes[0][i] == hashes[1][i] && hashes[0][i] == hashes[2][i]);
}
