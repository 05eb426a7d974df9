// controls.h: what hands did, as Input: pure bookkeeping, no window system (controls_glfw.c has
// it).
//
// Between two ticks the mouse may move many times and a key may go down and up again; a frame may
// have no tick or five. Nothing is lost: looks add up as fractions of a degree, what does not fit
// into a tick's whole hundredths stays for the next one, and a short press lasts until a tick has
// seen it.
#ifndef LUZ_CONTROLS_H
#define LUZ_CONTROLS_H
#include "../world/input.h"
#ifdef __cplusplus
extern "C" {
#endif

#define CONTROLS_PAD_LOOK_DEG_S 160.0 // turning speed at full stick
#define CONTROLS_PAD_DEADZONE   0.16f

typedef struct Controls {
    f64 look_x_deg, look_y_deg;   // pending
    u32 keys_held, keys_pressed;  // bit per row of the key table: down now; gone down since a tick
    f32 pad_move[3], pad_look[2]; // right up forward; right up: -1..1, as they are now
    u32 pad_held, pad_pressed;    // InputButton
} Controls;

// Turned by hand (mouse): degrees to the right and up.
void controls_look(Controls *controls, f64 right_deg, f64 up_deg);
// A key (GLFW's number) went down or up. False: it is none of those that walk.
bool controls_key(Controls *controls, int key, bool down);
// Buttons of the gamepad that are down now.
void controls_pad_buttons(Controls *controls, u32 buttons);
// The axis of a stick, without its dead zone and with a gentle middle: -1..1 to -1..1.
f32 controls_stick(f32 raw);
// Everything let go, pending looks forgotten: focus lost, mouse released.
void controls_clear(Controls *controls);
// The input of the next tick; takes what it reports out of the pending.
Input controls_take(Controls *controls);

#ifdef __cplusplus
}
#endif
#endif
