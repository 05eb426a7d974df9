// systems_animate.c: animations are periodic, bounded, independent of what ran before and of the
// number of threads, and as smooth after years as in the first minute.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/jobs.h"
#include <string.h>

static Entity spawn_orbit(SystemsFixture *f, f32 period, Vec3 radius) {
    Entity entity = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, 0), 1);
    u32 row = FIXTURE_ADD(f, orbit, entity);
    OrbitTable *orbit = FIXTURE_TABLE(f, Orbit, orbit);
    orbit->period[row] = period;
    orbit->radius_x[row] = radius.x, orbit->radius_y[row] = radius.y,
    orbit->radius_z[row] = radius.z;
    return entity;
}

static Vec3 offset_at(SystemsFixture *f, Entity entity, u32 tick) {
    const TransformTable *t = FIXTURE_TABLE(f, Transform, transform);
    f->world->tick = tick;
    systems_tick(&f->systems, &f->context);
    u32 row = FIXTURE_ROW(f, transform, entity);
    return vec3(t->offset_x[row], t->offset_y[row], t->offset_z[row]);
}

static f32 gain_at(SystemsFixture *f, Entity entity, u32 tick) {
    f->world->tick = tick;
    systems_tick(&f->systems, &f->context);
    return FIXTURE_TABLE(f, Light, light)->gain[FIXTURE_ROW(f, light, entity)];
}

TEST(systems_animate, orbits_are_periodic_bounded_and_their_own) {
    SystemsFixture *f = systems_fixture_create(3);
    Vec3 radius = {1, 2, 3};
    Entity a = spawn_orbit(f, 8, radius), b = spawn_orbit(f, 8, radius);
    Vec3 low = {0, 0, 0}, high = {0, 0, 0}, last = offset_at(f, a, 479);
    u32 equal = 0;
    f32 fastest = 0;
    for (u32 tick = 0; tick < 480; tick++) {
        Vec3 p = offset_at(f, a, tick), q = offset_at(f, b, tick);
        assert_true(fabsf(p.x) <= radius.x && fabsf(p.y) <= radius.y && fabsf(p.z) <= radius.z);
        // Rounds later, hours later: the same bits.
        if (tick % 37 == 0) {
            Vec3 later = offset_at(f, a, tick + 480), late = offset_at(f, a, tick + 480 * 8000000u);
            assert_memory_equal(&p, &later, sizeof p);
            assert_memory_equal(&p, &late, sizeof p);
        }
        equal += memcmp(&p, &q, sizeof p) == 0;
        Vec3 way = vec3_sub(p, last);
        fastest = MAX(fastest, vec3_length(way));
        last = p;
        low = vec3(MIN(low.x, p.x), MIN(low.y, p.y), MIN(low.z, p.z));
        high = vec3(MAX(high.x, p.x), MAX(high.y, p.y), MAX(high.z, p.z));
    }
    assert_int_equal(equal, 0);
    assert_true(fastest < 0.15f); // no jump, not even where the round closes
    assert_true(high.x - low.x > radius.x && high.y - low.y > radius.y &&
                high.z - low.z > radius.z);
    systems_fixture_destroy(f);
}

// A period that is no whole number of ticks: neighbours stay as near as ever after two years.
TEST(systems_animate, late_ticks_are_as_smooth_as_early_ones) {
    SystemsFixture *f = systems_fixture_create(3);
    Entity a = spawn_orbit(f, 7.3f, vec3(1, 1, 1));
    Entity light = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, 0), 1);
    FIXTURE_ADD(f, flicker, light);
    const u32 starts[] = {0, 1000, 216000, 2000000000u, 4294960000u};
    for (u32 s = 0; s < COUNT_OF(starts); s++) {
        Vec3 before = offset_at(f, a, starts[s]), p = offset_at(f, a, starts[s] + 1);
        f32 gain = gain_at(f, light, starts[s] + 1);
        for (u32 tick = 2; tick < 500; tick++) {
            Vec3 next = offset_at(f, a, starts[s] + tick);
            // Second difference: a coarse phase would make it as large as the first.
            Vec3 bend = vec3_sub(vec3_add(next, before), vec3_scale(p, 2));
            assert_true(vec3_length(bend) < 2e-3f);
            before = p, p = next;
            f32 next_gain = gain_at(f, light, starts[s] + tick);
            assert_true(fabsf(next_gain - gain) < 0.2f);
            gain = next_gain;
        }
    }
    systems_fixture_destroy(f);
}

TEST(systems_animate, paths_pass_through_their_points) {
    SystemsFixture *f = systems_fixture_create(3);
    const f32 points[] = {0, 0, 0, 4, 1, 0, 4, 2, -4, 0, 1, -4};
    Entity entity = fixture_spawn_light(f, LIGHT_POINT, vec3(9, 9, 9), 1);
    u32 row = FIXTURE_ADD(f, path, entity);
    PathTable *path = FIXTURE_TABLE(f, Path, path);
    path->points[row] = world_add_points(f->world, points, 4);
    path->period[row] = 4;
    Vec3 last = offset_at(f, entity, 239);
    for (u32 tick = 0; tick < 240; tick++) {
        Vec3 p = offset_at(f, entity, tick);
        if (tick % 60 == 0) {
            const f32 *want = points + 3 * (tick / 60);
            ASSERT_NEAR(p.x, want[0], 1e-5);
            ASSERT_NEAR(p.y, want[1], 1e-5);
            ASSERT_NEAR(p.z, want[2], 1e-5);
        }
        assert_true(vec3_length(vec3_sub(p, last)) < 0.2f);
        last = p;
    }
    // Orbit and path add up; taking both away leaves nothing.
    Vec3 alone = offset_at(f, entity, 100);
    FIXTURE_ADD(f, orbit, entity);
    Vec3 both = offset_at(f, entity, 100);
    table_remove(f->world->tables[COMPONENT_path], entity);
    Vec3 orbit = offset_at(f, entity, 100);
    ASSERT_NEAR(both.x, alone.x + orbit.x, 1e-5);
    table_remove(f->world->tables[COMPONENT_orbit], entity);
    Vec3 none = offset_at(f, entity, 100);
    assert_true(none.x == 0 && none.y == 0 && none.z == 0);
    systems_fixture_destroy(f);
}

TEST(systems_animate, gains_multiply_and_stay_in_range) {
    SystemsFixture *f = systems_fixture_create(3);
    Entity light = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, 0), 1);
    Entity other = fixture_spawn_light(f, LIGHT_POINT, vec3(0, 0, 0), 1);
    u32 flicker = FIXTURE_ADD(f, flicker, light), pulse = FIXTURE_ADD(f, pulse, light);
    FIXTURE_ADD(f, flicker, other);
    FIXTURE_TABLE(f, Flicker, flicker)->amount[flicker] = 0.4f;
    FIXTURE_TABLE(f, Pulse, pulse)->amount[pulse] = 0.5f;
    f32 low = 2, high = 0;
    u32 equal = 0;
    for (u32 tick = 0; tick < 1200; tick++) {
        f32 gain = gain_at(f, light, tick);
        assert_true(gain >= 0.6f * 0.5f && gain <= 1.0f);
        low = MIN(low, gain), high = MAX(high, gain);
        equal += gain == gain_at(f, other, tick);
    }
    assert_true(low < 0.45f && high > 0.8f && equal < 20);
    // At a whole period the pulse is at its brightest: only the flicker is left.
    f32 with = gain_at(f, light, 240);
    table_remove(f->world->tables[COMPONENT_pulse], light);
    assert_true(with == gain_at(f, light, 240));
    table_remove(f->world->tables[COMPONENT_flicker], light);
    assert_true(gain_at(f, light, 241) == 1.0f);
    systems_fixture_destroy(f);
}

static u64 run(u32 threads) {
    jobs_start(threads);
    SystemsFixture *f = systems_fixture_create(3);
    fixture_fill(f, 0xA11, 3000);
    for (u32 i = 0; i < 10; i++) systems_tick(&f->systems, &f->context);
    u64 hash = world_hash(f->world);
    systems_fixture_destroy(f);
    jobs_stop();
    return hash;
}

TEST(systems_animate, threads_do_not_matter) {
    u64 one = run(1);
    assert_true(one == run(2) && one == run(8));
}
