// controls.c: pending looks and presses become one tick's Input.
//
// Data in: what controls_glfw.c saw. Data out: Input, in whole numbers. Called by: window.c, once a
// tick. Does not: know a window system or the clock.
#include "controls.h"
#include <math.h>

// Buttons that act when they go down, however long they stay down.
#define EDGE_BUTTONS ((u32)(INPUT_FLY | INPUT_USE))

typedef struct ControlKey {
    int key;    // GLFW's number: the character, or from 256 up
    i8 move[3]; // right, up, forward
    u32 button; // InputButton
} ControlKey;

static const ControlKey control_keys[] = {
    {'W', {0, 0, 1}, 0},          {'S', {0, 0, -1}, 0},
    {'A', {-1, 0, 0}, 0},         {'D', {1, 0, 0}, 0},
    {265, {0, 0, 1}, 0},  // up
    {264, {0, 0, -1}, 0}, // down
    {263, {-1, 0, 0}, 0}, // left
    {262, {1, 0, 0}, 0},  // right
    {' ', {0, 1, 0}, INPUT_JUMP}, {'C', {0, -1, 0}, 0},
    {340, {0, 0, 0}, INPUT_RUN}, // shift, left and right
    {344, {0, 0, 0}, INPUT_RUN},  {'F', {0, 0, 0}, INPUT_FLY},
    {'E', {0, 0, 0}, INPUT_USE},
};
_Static_assert(COUNT_OF(control_keys) <= 32, "Controls has a bit per key");

void controls_look(Controls *controls, f64 right_deg, f64 up_deg) {
    controls->look_x_deg += right_deg;
    controls->look_y_deg += up_deg;
}

bool controls_key(Controls *controls, int key, bool down) {
    for (u32 i = 0; i < COUNT_OF(control_keys); i++) {
        if (control_keys[i].key != key) continue;
        if (down)
            controls->keys_pressed |= 1u << i, controls->keys_held |= 1u << i;
        else
            controls->keys_held &= ~(1u << i);
        return true;
    }
    return false;
}

void controls_pad_buttons(Controls *controls, u32 buttons) {
    controls->pad_pressed |= buttons & ~controls->pad_held;
    controls->pad_held = buttons;
}

f32 controls_stick(f32 raw) {
    f32 size = fabsf(raw);
    if (!(size > CONTROLS_PAD_DEADZONE)) return 0.0f;
    f32 t = (MIN(size, 1.0f) - CONTROLS_PAD_DEADZONE) / (1.0f - CONTROLS_PAD_DEADZONE);
    return copysignf(t * t, raw);
}

void controls_clear(Controls *controls) { *controls = (Controls){0}; }

// Whole hundredths of a degree that fit into the field; the rest stays.
static i16 take_look(f64 *pending_deg) {
    f64 hundredths = nearbyint(*pending_deg * 100.0);
    i16 taken = (i16)CLAMP(hundredths, INT16_MIN, INT16_MAX);
    *pending_deg -= taken / 100.0;
    return taken;
}

static i8 take_move(i32 keys, f32 pad) {
    return (i8)lrintf(CLAMP((f32)keys + pad, -1.0f, 1.0f) * 127.0f);
}

Input controls_take(Controls *controls) {
    const f64 pad_deg = CONTROLS_PAD_LOOK_DEG_S * (f64)TICK_SECONDS;
    controls_look(controls, controls->pad_look[0] * pad_deg, controls->pad_look[1] * pad_deg);

    // A press shorter than a tick counts as one tick.
    u32 keys = controls->keys_held | controls->keys_pressed;
    i32 move[3] = {0};
    u32 held = controls->pad_held, pressed = controls->pad_pressed;
    for (u32 i = 0; i < COUNT_OF(control_keys); i++) {
        if (!(keys >> i & 1)) continue;
        const ControlKey *key = &control_keys[i];
        for (u32 axis = 0; axis < 3; axis++) move[axis] += key->move[axis];
        held |= key->button;
        if (controls->keys_pressed >> i & 1) pressed |= key->button;
    }
    // Two keys for one direction are not twice as fast.
    for (u32 axis = 0; axis < 3; axis++) move[axis] = CLAMP(move[axis], -1, 1);

    Input input = {
        .look_x = take_look(&controls->look_x_deg),
        .look_y = take_look(&controls->look_y_deg),
        .move_x = take_move(move[0], controls->pad_move[0]),
        .move_y = take_move(move[1], controls->pad_move[1]),
        .move_z = take_move(move[2], controls->pad_move[2]),
        .buttons = (held & ~EDGE_BUTTONS) | pressed,
    };
    controls->keys_pressed = controls->pad_pressed = 0;
    return input;
}
