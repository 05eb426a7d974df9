// script.c: reads input scripts, and walks by itself.
// Data in: a script text, or a seed. Data out: the Input of any tick, in any order.
// Called by: record, tests. Does not: see the world; whoever walks into a wall walks on.
#include "script.h"
#include "../engine/base/file.h"
#include "../engine/base/log.h"
#include "../engine/base/random.h"
#include "../engine/level/suggest.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCRIPT_SIZE_MAX  MIB(16)
#define SCRIPT_TICKS_MAX (60u * 60u * 60u * 4u)
#define TURN_MAX         3600.0 // degrees a second
#define WALK_SEGMENT     48     // ticks: the walk makes up its mind this often
#define WALK_TURN_CDEG   9000.0f
#define FULL             127

// --- the built-in walk ---

enum { DRAW_KIND, DRAW_TURN, DRAW_PITCH, DRAW_SIDE, DRAW_RUN, DRAW_JUMP, DRAW_COUNT };

static i16 look_step(i32 cdeg_per_second, u32 tick) {
    // Differences of rounded sums: the angle after n ticks is exact however odd the rate.
    i64 now = (i64)cdeg_per_second * (tick + 1) / TICK_RATE;
    i64 before = (i64)cdeg_per_second * tick / TICK_RATE;
    return (i16)(now - before);
}

static Input walk_input(u64 seed, u32 tick) {
    u32 segment = tick / WALK_SEGMENT, within = tick % WALK_SEGMENT;
    f32 draws[DRAW_COUNT];
    for (u32 i = 0; i < DRAW_COUNT; i++) draws[i] = random_f32(seed, i, segment);
    Input input = {0};
    bool looks_around = draws[DRAW_KIND] < 0.15f;
    if (!looks_around) {
        input.move_z = FULL;
        if (draws[DRAW_SIDE] < 0.2f) input.move_x = draws[DRAW_SIDE] < 0.1f ? FULL : -FULL;
        if (draws[DRAW_RUN] < 0.3f) input.buttons |= INPUT_RUN;
        if (draws[DRAW_JUMP] < 0.1f && within == WALK_SEGMENT / 2) input.buttons |= INPUT_JUMP;
    }
    i32 turn = (i32)((draws[DRAW_TURN] * 2.0f - 1.0f) * WALK_TURN_CDEG);
    input.look_x = look_step(turn, within);
    // The pitch of every second segment takes back that of the one before.
    f32 pitch = random_f32(seed, DRAW_PITCH, segment & ~1u) * 2.0f - 1.0f;
    i32 nod = (i32)(pitch * 1500.0f) * (segment & 1 ? -1 : 1);
    input.look_y = look_step(nod, within);
    return input;
}

// --- texts ---

typedef enum WordKind {
    WORD_MOVE_X,
    WORD_MOVE_Y,
    WORD_MOVE_Z,
    WORD_TURN,
    WORD_PITCH,
    WORD_BUTTON
} WordKind;
static const struct {
    const char *name;
    WordKind kind;
    i32 value; // sign of a move, or the button
} words[] = {
    {"forward", WORD_MOVE_Z, 1},
    {"back", WORD_MOVE_Z, -1},
    {"right", WORD_MOVE_X, 1},
    {"left", WORD_MOVE_X, -1},
    {"up", WORD_MOVE_Y, 1},
    {"down", WORD_MOVE_Y, -1},
    {"turn", WORD_TURN, 0},
    {"pitch", WORD_PITCH, 0},
    {"run", WORD_BUTTON, INPUT_RUN},
    {"jump", WORD_BUTTON, INPUT_JUMP},
    {"fly", WORD_BUTTON, INPUT_FLY},
    {"use", WORD_BUTTON, INPUT_USE},
    {"fire", WORD_BUTTON, INPUT_FIRE},
};

static bool script_error(const char *path, u32 line, const char *format, const char *word) {
    char text[256];
    snprintf(text, sizeof text, format, word);
    LOG(USAGE, "%s:%u: %s", path, line, text);
    return false;
}

static bool parse_word(ScriptStep *step, char *word, const char *path, u32 line) {
    char *value = strchr(word, '=');
    if (value) *value++ = 0;
    u32 i = 0;
    while (i < COUNT_OF(words) && strcmp(words[i].name, word) != 0) i++;
    if (i == COUNT_OF(words)) {
        Suggestion suggestion = suggest_begin(word);
        for (u32 w = 0; w < COUNT_OF(words); w++) suggest_offer(&suggestion, words[w].name);
        char text[160], hint[96];
        snprintf(text, sizeof text, "unknown word '%.40s'; %s", word,
                 suggest_hint(&suggestion, hint, sizeof hint));
        return script_error(path, line, "%s", text);
    }
    f64 number = 0.0;
    bool wants_number = words[i].kind == WORD_TURN || words[i].kind == WORD_PITCH;
    if (wants_number && !value) return script_error(path, line, "'%.40s' needs =degrees", word);
    if (words[i].kind == WORD_BUTTON && value)
        return script_error(path, line, "'%.40s' takes no value", word);
    if (value) {
        char *end;
        number = strtod(value, &end);
        f64 max = wants_number ? TURN_MAX : FULL;
        if (end == value || *end || !(fabs(number) <= max) || (!wants_number && number < 0))
            return script_error(path, line, "'%.40s' is out of range or no number", value);
    } else {
        number = FULL;
    }
    i8 move = (i8)(number * words[i].value);
    switch (words[i].kind) {
    case WORD_MOVE_X:
        step->input.move_x = move;
        break;
    case WORD_MOVE_Y:
        step->input.move_y = move;
        break;
    case WORD_MOVE_Z:
        step->input.move_z = move;
        break;
    case WORD_TURN:
        step->turn_cdeg = (i32)(number * 100.0);
        break;
    case WORD_PITCH:
        step->pitch_cdeg = (i32)(number * 100.0);
        break;
    case WORD_BUTTON:
        step->input.buttons |= (u32)words[i].value;
        break;
    }
    return true;
}

static bool parse_line(ScriptStep *step, char *line, const char *path, u32 number) {
    const char *blanks = " \t\r";
    char *rest, *word = strtok_r(line, blanks, &rest), *end;
    unsigned long ticks = strtoul(word, &end, 10);
    if (*end || word[0] == '-' || ticks < 1 || ticks > SCRIPT_TICKS_MAX)
        return script_error(path, number, "a line begins with a count of ticks, not '%.40s'", word);
    *step = (ScriptStep){.tick_count = (u32)ticks};
    while ((word = strtok_r(NULL, blanks, &rest)))
        if (!parse_word(step, word, path, number)) return false;
    return true;
}

bool script_load(Script *script, const char *name, u64 seed, Arena *arena) {
    *script = (Script){.is_walk = strcmp(name, "walk") == 0, .seed = seed};
    if (script->is_walk) return true;
    Bytes text;
    if (!file_read(name, SCRIPT_SIZE_MAX, arena, &text)) return false;
    ScriptStep *steps = ARENA_PUSH(arena, ScriptStep, SCRIPT_STEPS_MAX);
    script->steps = steps;
    u32 number = 0;
    char *next = (char *)(uintptr_t)text.data; // ours: just read into the arena
    while (next) {
        char *line = next;
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        number++;
        line[strcspn(line, "#")] = 0;
        if (line[strspn(line, " \t\r")] == 0) continue;
        if (script->step_count == SCRIPT_STEPS_MAX)
            return script_error(name, number, "%s", "too many steps");
        ScriptStep *step = &steps[script->step_count++];
        if (!parse_line(step, line, name, number)) return false;
        if (step->tick_count > SCRIPT_TICKS_MAX - script->tick_count)
            return script_error(name, number, "%s", "longer than four hours");
        script->tick_count += step->tick_count;
    }
    if (script->tick_count == 0) return script_error(name, number, "%s", "has no steps");
    return true;
}

Input script_input(const Script *script, u32 tick) {
    if (script->is_walk) return walk_input(script->seed, tick);
    u32 first = 0;
    for (u32 i = 0; i < script->step_count; i++) {
        const ScriptStep *step = &script->steps[i];
        if (tick >= first + step->tick_count) {
            first += step->tick_count;
            continue;
        }
        Input input = step->input;
        u32 within = tick - first;
        if (within > 0) input.buttons &= ~(u32)(INPUT_FLY | INPUT_USE);
        input.look_x = look_step(step->turn_cdeg, within);
        input.look_y = look_step(step->pitch_cdeg, within);
        return input;
    }
    return (Input){0};
}
