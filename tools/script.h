// script.h: inputs without hands: a built-in walk, or a text of steps.
//
// A script is a text of lines "TICKS WORD...", where # begins a comment:
//   60  forward               # a second straight on
//   30  forward turn=90 run   # half a second of a right turn at 90 degrees a second
//   1   jump
// Words: forward back left right up down, each at full or as word=0..127; turn= and pitch= in
// degrees a second (right and up are positive); run jump fly use fire (fly, use: pressed at the
// step's first tick). The name "walk" instead of a file is a wander by counter-based random
// numbers.
#ifndef LUZ_TOOL_SCRIPT_H
#define LUZ_TOOL_SCRIPT_H
#include "../engine/base/arena.h"
#include "../engine/world/input.h"

#define SCRIPT_STEPS_MAX 65536

typedef struct ScriptStep {
    u32 tick_count;
    Input input;               // without look
    i32 turn_cdeg, pitch_cdeg; // 1/100 degree a second
} ScriptStep;

typedef struct Script {
    bool is_walk;
    u64 seed; // of the walk
    const ScriptStep *steps;
    u32 step_count, tick_count; // tick_count 0: as long as one likes
} Script;

// name: "walk" or a path. False after a message with file and line.
bool script_load(Script *script, const char *name, u64 seed, Arena *arena);
// Of tick 0, 1, ...: behind the last step nothing is pressed.
Input script_input(const Script *script, u32 tick);
#endif
