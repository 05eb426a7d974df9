// bench_frames.h: frames of a level under several settings, measured by turns.
//
//   FrameBench run;
//   if (!frame_bench_open(&run, bench, level, 640, 360, 1)) return false;
//   FrameVariant variants[2] = {...};   // settings, size, name
//   bool ok = frame_bench_measure(&run, variants, 2, &(FrameRounds){...});
//   ... samples_percentile(&variants[0].times.frame_ms, 0.5) ...
//   frame_variants_free(variants, 2);
//   frame_bench_close(&run);
//
// All variants of a round draw the same tick; ticks are not timed. Wall time is that of a frame as
// in play: packet, drawing, waiting.
#ifndef LUZ_TOOL_BENCH_FRAMES_H
#define LUZ_TOOL_BENCH_FRAMES_H
#include "bench.h"

typedef struct FrameBench {
    Bench *bench;
    Session session;
    SessionView view;
    u32 light_count;   // point and spot lights of the level
    SessionView drawn; // of the newest frame: whether targets must be made anew
    Progress progress;
    u32 step, step_count; // calls of frame_bench_measure so far, in all
} FrameBench;

typedef struct FrameSample {
    f64 wall_ms, cpu_ms, packet_ms;
    PacketBuildTimes build;
    PacketCounts counts;
} FrameSample;

typedef struct FrameVariant {
    char name[64];
    RenderSettings settings;
    u32 width_px, height_px; // 0 = as frame_bench_open
    // Results.
    FrameTimes times;
    Samples packet_ms, lights_ms, grid_ms; // parts on the CPU: the packet, its lights, its lists
    PacketCounts counts;                   // of the last frame
    bool slow;                             // took longer than slow_ms: measured once
} FrameVariant;

typedef struct FrameRounds {
    u32 min, max; // rounds; as many as fit into the budget
    f64 budget_s; // of all variants together, without warm-up
    f64 slow_ms;  // a frame that takes longer is drawn once; 0 = never
} FrameRounds;

// step_count: how often frame_bench_measure will be called, for the progress bar.
bool frame_bench_open(FrameBench *run, Bench *bench, const char *level, u32 width_px, u32 height_px,
                      u32 step_count);
void frame_bench_close(FrameBench *run);
// A frame of run->view; image may be NULL, else its pixels lie in `arena`.
bool frame_bench_draw(FrameBench *run, FrameSample *out, Arena *arena, RenderImage *image);
void frame_bench_tick(FrameBench *run);
// The picture of a variant at the session's tick, in `arena`.
bool frame_bench_picture(FrameBench *run, const FrameVariant *variant, Arena *arena,
                         RenderImage *out);
// Compiles what run->view needs and draws some frames.
bool frame_bench_warm_up(FrameBench *run);

bool frame_bench_measure(FrameBench *run, FrameVariant *variants, u32 count,
                         const FrameRounds *rounds);
void frame_variants_free(FrameVariant *variants, u32 count);
// Default settings without light that bounces: what the experiments with direct light compare.
RenderSettings frame_settings_direct(void);
// These under a path with the level's first `lights` lights, so bright that together
// they give as much light as all of them do (at most ten times).
RenderSettings frame_bench_settings(const FrameBench *run, RenderPath path, u32 lights);
// Median frame time; NAN if it was not measured.
f64 frame_variant_ms(FrameVariant *variant);
// Sum of the medians of passes whose name contains one of the words ("tile depth|lists"); 0 if
// none.
f64 frame_variant_pass_ms(FrameVariant *variant, const char *words);
// Default settings without what simplifies lights (but those outside the view are left out).
void frame_settings_every_light(RenderSettings *settings);
// Adds the frame time as a result, and its passes too if asked.
void frame_variant_add(Bench *bench, const char *id, FrameVariant *variant, f64 ratio, bool passes);
#endif
