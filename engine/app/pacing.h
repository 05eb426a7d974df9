// pacing.h: how many ticks a frame gets, and how large a picture: two small controllers on time.
//
// Both are pure: time comes in as a number, so tests drive them with made-up frames.
#ifndef LUZ_PACING_H
#define LUZ_PACING_H
#include "../base/base.h"
#ifdef __cplusplus
extern "C" {
#endif

// --- Fixed step ---

#define PACING_TICKS_MAX                                                                           \
    5 // a frame; what is more is dropped: the game slows down, it never spirals

typedef struct StepClock {
    f64 last_ms, pending_ms;
    bool started;
    f64 dropped_ms; // in all, for the panel
} StepClock;

// Ticks to simulate now.
u32 step_clock_advance(StepClock *clock, f64 now_ms);
// Time that passed until now did not happen (minimised, paused, a level was loaded).
void step_clock_skip(StepClock *clock, f64 now_ms);

// --- Resolution that holds a frame time ---

#define SCALE_STEP        0.0625f
#define SCALE_MIN         0.25f
#define SCALE_MAX         1.0f
#define SCALE_DOWN_FRAMES 6  // so many frames in a row too slow: smaller
#define SCALE_UP_FRAMES   45 // so many with room to spare: larger
#define SCALE_UP_WAIT_MAX                                                                          \
    720 // after steps up that had to be taken back, the wait doubles up to this
#define SCALE_FLOOR_FRAMES 900   // so long it is remembered that smaller does not help
#define SCALE_SLOW_FACTOR  1.06f // of the target: slower is too slow
#define SCALE_ROOM_FACTOR  0.92f // of the target: what a step up may cost, as predicted
#define SCALE_PIXELS_WORTH                                                                         \
    3.0f // where all else costs so many times what pixels do, fewer pixels
         // only blur the picture

typedef struct ScaleControl {
    u32 slow_frames, fast_frames; // in a row
    f32 slow_ms, fast_ms;         // their sums
    u32 up_wait;                  // frames; 0 = SCALE_UP_FRAMES
    u32 since_up;                 // frames since the last step up
    u32 settle;                   // frames to ignore after a change
    f32 before_scale, before_ms;  // of the last step down; 0 = none
    f32 floor;                    // smallest scale that is worth it, as learnt
    u32 floor_left;               // frames until that is forgotten
} ScaleControl;

// The scale for the next frame, given the last frame's time. At first cost is taken to grow with
// the number of pixels; steps down go as far as that predicts and then learn how much it really
// helped; steps up are taken one at a time.
f32 scale_control_update(ScaleControl *control, f32 frame_ms, f32 target_ms, f32 scale);

#ifdef __cplusplus
}
#endif
#endif
