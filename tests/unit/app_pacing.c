// app_pacing.c: tests of the fixed step and of the resolution controller, on made-up frames.
#include "../../engine/app/pacing.h"
#include "../../engine/base/random.h"
#include "../../engine/world/input.h"
#include "../test.h"

TEST(app_pacing, sixty_ticks_a_second_at_any_frame_rate) {
    const f64 frame_ms[] = {4.0, 16.0, 16.6667, 21.0, 33.3, 50.0};
    for (u32 i = 0; i < COUNT_OF(frame_ms); i++) {
        StepClock clock = {0};
        u32 ticks = step_clock_advance(&clock, 500.0), frames = 0;
        assert_int_equal(ticks, 0);
        for (f64 now = 500.0; now < 10500.0; now += frame_ms[i], frames++)
            ticks += step_clock_advance(&clock, now);
        assert_in_range(ticks, 595, 600);
        assert_true(clock.dropped_ms == 0.0);
    }
}

TEST(app_pacing, a_long_stall_drops_time) {
    StepClock clock = {0};
    step_clock_advance(&clock, 0.0);
    assert_int_equal(step_clock_advance(&clock, 3000.0), PACING_TICKS_MAX);
    assert_true(clock.dropped_ms > 2800.0);
    assert_true(clock.pending_ms < 1000.0 / TICK_RATE);
    assert_in_range(step_clock_advance(&clock, 3017.0), 1, 2);
}

TEST(app_pacing, skipped_time_did_not_happen) {
    StepClock clock = {0};
    step_clock_advance(&clock, 0.0);
    step_clock_skip(&clock, 60000.0);
    assert_int_equal(step_clock_advance(&clock, 60001.0), 0);
    assert_true(clock.dropped_ms == 0.0);
}

TEST(app_pacing, a_clock_that_runs_backwards_is_harmless) {
    StepClock clock = {0};
    step_clock_advance(&clock, 1000.0);
    assert_int_equal(step_clock_advance(&clock, 900.0), 0);
    assert_int_equal(step_clock_advance(&clock, 917.0), 1);
}

// A machine whose frames cost fixed_ms + pixel_ms * scale^2, with some noise.
typedef struct Machine {
    f32 fixed_ms, pixel_ms, noise;
} Machine;

static f32 run_machine(ScaleControl *control, Machine machine, f32 target_ms, f32 scale, u32 frames,
                       u32 *changes) {
    for (u32 i = 0; i < frames; i++) {
        f32 noise = random_range(7, 1, i, -machine.noise, machine.noise);
        f32 ms = (machine.fixed_ms + machine.pixel_ms * scale * scale) * (1.0f + noise);
        f32 next = scale_control_update(control, ms, target_ms, scale);
        if (changes && next != scale) (*changes)++;
        scale = next;
        assert_true(scale >= SCALE_MIN && scale <= SCALE_MAX);
    }
    return scale;
}

TEST(app_pacing, scale_is_left_alone_without_a_target) {
    ScaleControl control = {0};
    assert_true(run_machine(&control, (Machine){5, 100, 0}, 0.0f, 0.83f, 100, NULL) == 0.83f);
}

TEST(app_pacing, scale_falls_fast_until_the_target_holds) {
    ScaleControl control = {0};
    Machine machine = {4.0f, 60.0f, 0.02f};
    f32 scale = run_machine(&control, machine, 33.0f, 1.0f, 60, NULL);
    assert_true(machine.fixed_ms + machine.pixel_ms * scale * scale <= 33.0f * SCALE_SLOW_FACTOR);
    assert_true(scale > 0.5f); // and not further than needed
}

TEST(app_pacing, scale_comes_back_when_there_is_room) {
    ScaleControl control = {0};
    f32 scale = run_machine(&control, (Machine){2, 120, 0.02f}, 33.0f, 1.0f, 120, NULL);
    assert_true(scale < 0.6f);
    scale = run_machine(&control, (Machine){2, 20, 0.02f}, 33.0f, scale, 2000, NULL);
    assert_true(scale == SCALE_MAX);
}

TEST(app_pacing, scale_does_not_flutter) {
    // Just at the edge between two steps: it settles, and asks again ever more seldom.
    for (u32 pixel_ms = 30; pixel_ms < 90; pixel_ms += 5) {
        ScaleControl control = {0};
        u32 changes = 0;
        Machine machine = {3.0f, (f32)pixel_ms, 0.05f};
        f32 scale = run_machine(&control, machine, 33.0f, 1.0f, 600, NULL);
        run_machine(&control, machine, 33.0f, scale, 3600, &changes);
        assert_true(changes <= 12);
    }
}

TEST(app_pacing, scale_gives_up_at_the_smallest) {
    ScaleControl control = {0};
    assert_true(run_machine(&control, (Machine){90, 900, 0}, 20.0f, 1.0f, 300, NULL) == SCALE_MIN);
}

TEST(app_pacing, scale_is_not_given_away_for_nothing) {
    // A scene of many triangles: fewer pixels would blur it and gain next to nothing.
    ScaleControl control = {0};
    u32 changes = 0;
    f32 scale = run_machine(&control, (Machine){90, 10, 0.02f}, 33.0f, 1.0f, 200, NULL);
    assert_true(scale == SCALE_MAX);
    run_machine(&control, (Machine){90, 10, 0.02f}, 33.0f, scale, 3600, &changes);
    assert_true(changes <= 10);
    // The same from a small picture on: it is not made smaller for long.
    control = (ScaleControl){0};
    assert_true(run_machine(&control, (Machine){90, 10, 0}, 33.0f, 0.5f, 200, NULL) == 0.5f);
    // Half and half: it goes as far down as pixels still matter.
    control = (ScaleControl){0};
    scale = run_machine(&control, (Machine){60, 60, 0.02f}, 33.0f, 1.0f, 200, NULL);
    assert_true(scale >= 0.45f && scale <= 0.7f);
}

TEST(app_pacing, one_slow_frame_changes_nothing) {
    ScaleControl control = {0};
    f32 scale = 0.75f;
    for (u32 i = 0; i < 40; i++)
        scale = scale_control_update(&control, i % 10 == 9 ? 200.0f : 30.0f, 31.0f, scale);
    assert_true(scale == 0.75f);
}
