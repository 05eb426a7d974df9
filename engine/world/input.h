// input.h: what a player did during one 60 Hz tick: the only thing from outside that the
// simulation sees, and therefore what a recording holds. Small integers, so that it is exact.
#ifndef LUZ_INPUT_H
#define LUZ_INPUT_H
#include "../base/base.h"

typedef enum InputButton {
    INPUT_JUMP = 1 << 0,
    INPUT_RUN = 1 << 1,
    INPUT_FLY = 1 << 2, // pressed this tick: toggles free flight
    INPUT_USE = 1 << 3, // pressed this tick
    INPUT_FIRE = 1 << 4,
} InputButton;

typedef struct Input {
    i16 look_x, look_y;            // 1/100 degree: yaw to the right, pitch up, since last tick
    i8 move_x, move_y, move_z;     // -127..127: right, up (flight), forward
    u8 reserved;                   // 0
    u32 buttons;                   // InputButton
} Input;

#define TICK_RATE    60
#define TICK_SECONDS (1.0f / 60.0f)
#endif
