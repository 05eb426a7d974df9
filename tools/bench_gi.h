// bench_gi.h: frames with global illumination, step by step: what the rows V1 to V8 and `gi` share.
//
//   GiBench run;
//   if (!gi_bench_open(&run, bench, &scene, 640, 360, 1)) return false;
//   GiVariant variants[2] = {...};      // gi_variant(&run, "name", "preset", "key=value,...")
//   bool ok = gi_bench_measure(&run, variants, 2, &rounds);
//   ... variants[0].steps.trace ...
//   gi_variants_free(variants, 2);
//   gi_bench_close(&run);
//
// Voxels are kept as long as nothing changes: before each frame that is timed a static thing moves
// by a hair and back, and dynamic ones are voxelised by the policy, so that every step runs in it.
#ifndef LUZ_TOOL_BENCH_GI_H
#define LUZ_TOOL_BENCH_GI_H
#include "../engine/capture/image_compare.h"
#include "bench_frames.h"
#include "bench_table.h"
#include "reference.h"

// A level, and what of it is made dynamic for the measurement: names separated by blanks, or NULL.
typedef struct GiScene {
    const char *name, *level, *dynamic;
} GiScene;
#define GI_SCENE_CORNELL                                                                           \
    { "cornell", "data/levels/cornell.toml", "tall_box short_box" }

// Steps of a frame by what they do, ms (medians), and the passes that each is made of. Where indirect
// light is added while tiles are shaded (gi_tiled_pass), that is in "lighting".
#define GI_STEPS(X)                                                                                \
    X(static_voxels, "static voxelise", "voxelise static")                                         \
    X(dynamic_voxels, "clear and voxelise dynamic", "voxelise dynamic")                            \
    X(shade, "shade", "voxel light|voxel light again")                                             \
    X(filter, "filter", "voxel filter start|voxel filter")                                         \
    X(bounce, "bounce", "voxel bounce")                                                            \
    X(refilter, "filter again", "voxel filter 2")                                                  \
    X(gather, "probes or irradiance", "probes|voxel irradiance")                                   \
    X(trace, "cones", "gi trace")                                                                  \
    X(shadows, "traced lights", "gi traced lights")                                                \
    X(compose, "compose", "gi compose|gi compose of samples|gi alone")
typedef enum GiStep {
#define X(id, title, passes) GI_STEP_##id,
    GI_STEPS(X)
#undef X
        GI_STEP_COUNT
} GiStep;
extern const char *const gi_step_titles[GI_STEP_COUNT];

typedef struct GiVariant {
    FrameVariant frame; // name, settings, size; times
    // Changes the level for this variant, before its frames and its picture. May be NULL.
    void (*prepare)(Session *session, const struct GiVariant *variant);
    u32 choice; // for prepare
    f64 aperture_deg;
    // Results.
    f64 steps[GI_STEP_COUNT];
    f64 update_ms; // sum of the steps that a moving thing costs: dynamic voxels to gather
    f64 frame_ms;
    u64 bytes;
    RendererStats stats;
} GiVariant;

typedef struct GiBench {
    FrameBench frames;
    u32 nudged;   // row of the transform that moves, ROW_NONE = nothing static
    bool at_rest; // light has gone round when a frame is measured, as where nothing moves
    bool is_off;  // where it is
} GiBench;

bool gi_bench_open(GiBench *run, Bench *bench, const GiScene *scene, u32 width_px, u32 height_px,
                   u32 step_count);
void gi_bench_close(GiBench *run);
// Settings: tiled_deferred with global illumination, then a preset, then settings_set_list(sets);
// both may be NULL. format: the name.
GiVariant gi_variant(const char *preset, const char *sets, const char *format, ...)
    PRINTF_LIKE(3, 4);
// Fills the results; the samples stay in variant.frame.
bool gi_bench_measure(GiBench *run, GiVariant *variants, u32 count, const FrameRounds *rounds);
void gi_variants_free(GiVariant *variants, u32 count);
// The picture of a variant, as it is whatever was drawn before.
bool gi_bench_picture(GiBench *run, const GiVariant *variant, Arena *arena, RenderImage *out);
// The path-traced picture of what the level is now.
bool gi_bench_reference(GiBench *run, const TraceOptions *options, Arena *arena, RenderImage *out);

// Median of the passes of a name list "a|b" of exact names, summed; 0 if none ran.
f64 gi_pass_ms(FrameTimes *times, const char *passes);
// Things of this name (blank-separated list) get a voxel mode; returns how many there were.
u32 gi_make_dynamic(World *world, const char *names);
// Lights of the level (suns: directional ones too) ask the voxels, and are asked on the screen, in
// this way.
void gi_set_shadows(World *world, bool suns, u32 voxel_shadow, u32 screen_shadow, f32 aperture_deg);

bool bench_gi_v1(Bench *bench, const char *id);
bool bench_gi_v2(Bench *bench, const char *id);
bool bench_gi_v3(Bench *bench, const char *id);
bool bench_gi_v4(Bench *bench, const char *id);
bool bench_gi_v5(Bench *bench, const char *id);
bool bench_gi_v6(Bench *bench, const char *id);
bool bench_gi_v7(Bench *bench, const char *id);
bool bench_gi_v8(Bench *bench, const char *id);
bool bench_gi_claims(Bench *bench, const char *id);
#endif
