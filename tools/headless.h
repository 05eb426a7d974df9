// headless.h: a level or a frame file drawn without a window: what shot, record, replay and bench
// have in common.
#ifndef LUZ_TOOL_HEADLESS_H
#define LUZ_TOOL_HEADLESS_H
#include "../engine/app/session.h"
#include "../engine/render/render.h"
#include "json.h"
#include "tool.h"

// --- Device ---
typedef struct Headless {
    Gpu *gpu;
    Renderer *renderer;
    char device[800]; // "llvmpipe (LLVM 15.0.6, 256 bits) / llvmpipe Mesa 22.3.6"
} Headless;
// The device that the options ask for, or NULL after a message.
Gpu *headless_gpu(const ToolCommon *common);
// False with messages of the engine on stderr (then: TOOL_ENVIRONMENT).
bool headless_open(Headless *headless, const ToolCommon *common);
void headless_close(Headless *headless);

// --- Level ---
// The project's components and systems (luz_project), or none.
const SessionDesc *tool_session(void);
// Prints diagnostics on stderr: all of a failed load, warnings of a good one unless quiet.
bool headless_load(Session *session, const char *path, const ToolCommon *common);
// The first error, for --json.
void headless_explain(const Diagnostics *diagnostics);
// NULL (the player's eyes) or a name: as asked, else "main", else the first camera with a name.
const char *headless_camera(const Session *session, const char *asked);

// --- Settings ---
// path and view may be NULL; sets are "key=value". False after a message.
bool headless_settings(RenderSettings *settings, const char *path, const char *view,
                       const ToolList *sets);
// The help of option --preset, with all names: call settings_set_preset before headless_settings.
const char *headless_preset_help(void);
// Pixels drawn for a picture of `size` under settings.scale.
void headless_internal_size(const RenderSettings *settings, const u32 size[2], u32 out[2]);

// --- Measuring ---
// Values of one thing over some frames.
typedef struct Samples {
    f64 *values;
    u32 count, cap;
} Samples;
void samples_add(Samples *samples, f64 value);
void samples_free(Samples *samples);
// p in 0..1 by linear interpolation between ranks; 0 for none. Sorts the values.
f64 samples_percentile(Samples *samples, f64 p);
void json_samples(Json *json, const char *key, Samples *samples); // {median, min, max}

typedef struct FrameTimes {
    Samples frame_ms, cpu_ms; // wall; user + system of the whole process, driver threads included
    struct {
        char name[64];
        Samples ms;
    } passes[GPU_TIMERS_CAP];
    u32 pass_count;
} FrameTimes;
// Before a frame is drawn: whether it has timers. One in three has, the first among them: medians
// of frame times are of frames as a player sees them, without.
void frame_times_begin(const FrameTimes *times, Gpu *gpu);
// After it. A frame without timers adds nothing.
void frame_times_add_passes(FrameTimes *times, const Gpu *gpu);
void frame_times_free(FrameTimes *times);
#endif
