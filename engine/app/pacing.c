// pacing.c: fixed-step accumulator and resolution controller.
//
// Data in: times of frames. Data out: a number of ticks, a scale. Called by: window.c, once a
// frame. Does not: read a clock.
#include "pacing.h"
#include "../world/input.h"
#include <math.h>

#define TICK_MS (1000.0 / TICK_RATE)

u32 step_clock_advance(StepClock *clock, f64 now_ms) {
    if (!clock->started) step_clock_skip(clock, now_ms);
    clock->pending_ms += MAX(now_ms - clock->last_ms, 0.0);
    clock->last_ms = now_ms;
    u32 ticks = 0;
    while (clock->pending_ms >= TICK_MS && ticks < PACING_TICKS_MAX) {
        clock->pending_ms -= TICK_MS;
        ticks++;
    }
    if (clock->pending_ms >= TICK_MS) {
        // Keep the fraction, so that the rhythm of later ticks does not jump.
        f64 keep = clock->pending_ms - TICK_MS * (f64)(u64)(clock->pending_ms / TICK_MS);
        clock->dropped_ms += clock->pending_ms - keep;
        clock->pending_ms = keep;
    }
    return ticks;
}

void step_clock_skip(StepClock *clock, f64 now_ms) {
    clock->started = true;
    clock->last_ms = now_ms;
}

// Frames right after a change pay for new render targets: they say nothing about the new size.
#define SETTLE_FRAMES 3

static f32 scale_on_grid(f32 scale) {
    f32 steps = (f32)(i32)((CLAMP(scale, SCALE_MIN, SCALE_MAX) - SCALE_MIN) / SCALE_STEP + 0.5f);
    return SCALE_MIN + steps * SCALE_STEP;
}

static f32 predicted_ms(f32 ms, f32 from, f32 to) { return ms * (to * to) / (from * from); }

static f32 scale_changed(ScaleControl *control, f32 scale) {
    control->slow_frames = control->fast_frames = 0;
    control->slow_ms = control->fast_ms = 0.0f;
    control->settle = SETTLE_FRAMES;
    return scale;
}

// Two points of ms = fixed + pixels * scale^2 tell both. Below the scale where `fixed` is
// SCALE_PIXELS_WORTH times the rest, a smaller picture gains next to nothing.
static void learn_floor(ScaleControl *control, f32 ms, f32 scale) {
    f32 before = control->before_scale;
    if (control->before_ms <= 0.0f || before <= scale) return;
    f32 pixels = (control->before_ms - ms) / (before * before - scale * scale);
    f32 fixed = ms - pixels * scale * scale;
    control->before_ms = 0.0f;
    control->floor_left = SCALE_FLOOR_FRAMES;
    control->floor = before; // it did not help at all
    if (pixels <= 0.0f) return;
    f32 worth = sqrtf(MAX(fixed, 0.0f) / (SCALE_PIXELS_WORTH * pixels));
    control->floor = MIN(scale_on_grid(worth), before);
}

// Too slow for some time: the smallest step down that should hold, but not below the floor.
static f32 step_down(ScaleControl *control, f32 target_ms, f32 scale) {
    f32 mean = control->slow_ms / (f32)control->slow_frames, smaller = scale - SCALE_STEP;
    learn_floor(control, mean, scale);
    while (smaller > SCALE_MIN && predicted_ms(mean, scale, smaller) > target_ms)
        smaller -= SCALE_STEP;
    smaller = MAX(smaller, control->floor); // at least SCALE_MIN; may be a step back up
    if (smaller == scale) {
        control->slow_frames = 0;
        control->slow_ms = 0.0f;
        return scale;
    }
    // The last step up was a mistake: think longer before the next one.
    if (control->since_up < control->up_wait)
        control->up_wait = MIN(control->up_wait * 2, SCALE_UP_WAIT_MAX);
    if (smaller < scale) {
        control->before_scale = scale;
        control->before_ms = mean;
    }
    return scale_changed(control, smaller);
}

// Fast enough for some time: one step up, if it should hold.
static f32 step_up(ScaleControl *control, f32 target_ms, f32 scale) {
    f32 mean = control->fast_ms / (f32)control->fast_frames, larger = scale + SCALE_STEP;
    if (predicted_ms(mean, scale, larger) >= target_ms * SCALE_ROOM_FACTOR) {
        control->fast_frames = 0;
        control->fast_ms = 0.0f;
        return scale;
    }
    // Steps up that held restore trust.
    if (control->since_up > SCALE_UP_WAIT_MAX) control->up_wait = SCALE_UP_FRAMES;
    control->since_up = 0;
    control->before_ms = 0.0f;
    return scale_changed(control, larger);
}

f32 scale_control_update(ScaleControl *control, f32 frame_ms, f32 target_ms, f32 scale) {
    if (target_ms <= 0.0f) return scale;
    if (!control->up_wait)
        *control =
            (ScaleControl){.up_wait = SCALE_UP_FRAMES, .since_up = UINT32_MAX, .floor = SCALE_MIN};
    control->since_up += control->since_up < UINT32_MAX;
    if (control->floor_left > 0 && --control->floor_left == 0) control->floor = SCALE_MIN;
    if (control->settle > 0) {
        control->settle--;
        return scale;
    }
    scale = scale_on_grid(scale);
    if (frame_ms > target_ms * SCALE_SLOW_FACTOR) {
        control->slow_frames++;
        control->slow_ms += frame_ms;
        control->fast_frames = 0;
        control->fast_ms = 0.0f;
    } else {
        control->slow_frames = 0;
        control->slow_ms = 0.0f;
        control->fast_frames++;
        control->fast_ms += frame_ms;
    }
    if (control->slow_frames >= SCALE_DOWN_FRAMES) return step_down(control, target_ms, scale);
    if (control->fast_frames >= control->up_wait && scale < SCALE_MAX)
        return step_up(control, target_ms, scale);
    return scale;
}
