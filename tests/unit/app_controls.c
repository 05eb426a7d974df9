// app_controls.c: tests of hands to Input: nothing is lost, nothing happens twice.
#include "../../engine/app/controls.h"
#include "../../engine/base/random.h"
#include "../test.h"

TEST(app_controls, looks_keep_their_fractions) {
    Controls controls = {0};
    // A third of a hundredth of a degree each tick: after 300 ticks exactly one degree was taken.
    i32 sum = 0;
    for (u32 i = 0; i < 300; i++) {
        controls_look(&controls, 1.0 / 300.0, -1.0 / 300.0);
        Input input = controls_take(&controls);
        sum += input.look_x;
        assert_true(input.look_x >= 0 && input.look_x <= 1);
        assert_int_equal(input.look_y, -input.look_x);
    }
    assert_int_equal(sum, 100);
}

TEST(app_controls, random_looks_add_up) {
    const u64 seed = 0xC0417;
    for (u32 run = 0; run < 20; run++) {
        Controls controls = {0};
        f64 given = 0.0, taken = 0.0;
        for (u32 i = 0; i < 500; i++) {
            f64 degrees = (f64)random_range(seed, run, i, -7.0f, 7.0f);
            given += degrees;
            controls_look(&controls, degrees, 0.0);
            if (random_u32(seed, run + 100, i) % 3)
                taken += controls_take(&controls).look_x / 100.0;
        }
        taken += controls_take(&controls).look_x / 100.0;
        ASSERT_NEAR(taken, given, 0.00501); // half a hundredth is still pending
    }
}

TEST(app_controls, a_violent_turn_is_spread_over_ticks) {
    Controls controls = {0};
    controls_look(&controls, 1000.0, -700.0);
    f64 x = 0.0, y = 0.0;
    for (u32 i = 0; i < 4; i++) {
        Input input = controls_take(&controls);
        x += input.look_x / 100.0, y += input.look_y / 100.0;
    }
    ASSERT_NEAR(x, 1000.0, 1e-9);
    ASSERT_NEAR(y, -700.0, 1e-9);
}

TEST(app_controls, keys_walk) {
    Controls controls = {0};
    assert_true(controls_key(&controls, 'W', true));
    assert_true(controls_key(&controls, 'A', true));
    Input input = controls_take(&controls);
    assert_int_equal(input.move_z, 127);
    assert_int_equal(input.move_x, -127);
    assert_int_equal(input.move_y, 0);
    controls_key(&controls, 'A', false);
    input = controls_take(&controls);
    assert_int_equal(input.move_z, 127);
    assert_int_equal(input.move_x, 0);
    assert_false(controls_key(&controls, 'Q', true));
}

TEST(app_controls, two_keys_for_one_way_are_one) {
    Controls controls = {0};
    controls_key(&controls, 'W', true);
    controls_key(&controls, 265, true); // the arrow
    assert_int_equal(controls_take(&controls).move_z, 127);
    controls_key(&controls, 'W', false);
    assert_int_equal(controls_take(&controls).move_z, 127);
    controls_key(&controls, 'S', true);
    assert_int_equal(controls_take(&controls).move_z, 0);
}

TEST(app_controls, a_short_press_lasts_one_tick) {
    Controls controls = {0};
    controls_key(&controls, ' ', true);
    controls_key(&controls, ' ', false);
    Input input = controls_take(&controls);
    assert_int_equal(input.buttons, INPUT_JUMP);
    assert_int_equal(input.move_y, 127);
    input = controls_take(&controls);
    assert_int_equal(input.buttons, 0);
    assert_int_equal(input.move_y, 0);
}

TEST(app_controls, fly_counts_presses_run_lasts) {
    Controls controls = {0};
    controls_key(&controls, 'F', true);
    controls_key(&controls, 340, true);
    assert_int_equal(controls_take(&controls).buttons, INPUT_FLY | INPUT_RUN);
    assert_int_equal(controls_take(&controls).buttons, INPUT_RUN);
    controls_key(&controls, 'F', false);
    controls_key(&controls, 'F', true);
    assert_int_equal(controls_take(&controls).buttons, INPUT_FLY | INPUT_RUN);
}

TEST(app_controls, gamepad_moves_and_looks) {
    Controls controls = {.pad_move = {0.5f, 0.0f, -1.0f}, .pad_look = {1.0f, 0.0f}};
    Input input = controls_take(&controls);
    assert_int_equal(input.move_x, 64);
    assert_int_equal(input.move_z, -127);
    i32 sum = input.look_x;
    for (u32 i = 1; i < TICK_RATE; i++) sum += controls_take(&controls).look_x;
    ASSERT_NEAR(sum / 100.0, CONTROLS_PAD_LOOK_DEG_S, 0.05);
    controls_pad_buttons(&controls, INPUT_FLY | INPUT_JUMP);
    assert_int_equal(controls_take(&controls).buttons, INPUT_FLY | INPUT_JUMP);
    controls_pad_buttons(&controls, INPUT_FLY | INPUT_JUMP);
    assert_int_equal(controls_take(&controls).buttons, INPUT_JUMP);
}

TEST(app_controls, sticks_have_a_dead_zone_and_ends) {
    assert_true(controls_stick(0.1f) == 0.0f);
    assert_true(controls_stick(-CONTROLS_PAD_DEADZONE) == 0.0f);
    assert_true(controls_stick(1.0f) == 1.0f);
    assert_true(controls_stick(-1.2f) == -1.0f);
    assert_true(controls_stick(NAN) == 0.0f);
    f32 last = 0.0f;
    for (u32 i = 0; i <= 100; i++) {
        f32 now = controls_stick((f32)i / 100.0f);
        assert_true(now >= last && now <= 1.0f);
        last = now;
    }
}

TEST(app_controls, clear_lets_everything_go) {
    Controls controls = {0};
    controls_key(&controls, 'W', true);
    controls_look(&controls, 5.0, 5.0);
    controls_clear(&controls);
    Input input = controls_take(&controls), nothing = {0};
    assert_memory_equal(&input, &nothing, sizeof input);
}
