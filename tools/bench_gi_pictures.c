// bench_gi_pictures.c: experiments V5, V6 and V8: shadows, resolution and features of global
// illumination, each with the error of its picture; and the row `gi`: what the engine promises.
// Data in: levels, path-traced pictures of them (reference.h). Data out: tables, charts, verdicts,
// with --plots the pictures. Does not: steps and memory (bench_gi.c).
#include "bench_gi.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PICTURES_CAP 16

typedef struct PictureError {
    f64 flip, ssim;
} PictureError;

static void keep_picture(const Bench *bench, const char *experiment, const char *scene,
                         const char *name, const RenderImage *image) {
    if (!bench->plots) return;
    char path[2048];
    i32 used =
        snprintf(path, sizeof path, "%s/%s_%s_%s.png", bench->plots, experiment, scene, name);
    for (char *c = path + strlen(bench->plots) + 1; *c; c++)
        if (*c == ' ' || *c == '/' || *c == '+') *c = '_';
    if (used > 0 && used < (i32)sizeof path)
        image_write_png(path, image->rgba, image->width_px, image->height_px, 4);
}

// Pictures of the variants against a reference; all memory is given back.
static bool picture_errors(GiBench *run, const char *experiment, const char *scene,
                           const GiVariant *variants, u32 count, const RenderImage *reference,
                           PictureError *out) {
    Bench *bench = run->frames.bench;
    for (u32 v = 0; v < count; v++) {
        u64 mark = arena_mark(&bench->arena);
        RenderImage image;
        if (!gi_bench_picture(run, &variants[v], &bench->arena, &image)) return false;
        ImageDifference difference = image_compare(reference->rgba, image.rgba, image.width_px,
                                                   image.height_px, &bench->arena);
        out[v] = (PictureError){difference.flip, difference.ssim};
        keep_picture(bench, experiment, scene, variants[v].frame.name, &image);
        arena_rewind(&bench->arena, mark);
    }
    return true;
}

static TraceOptions reference_options(const Bench *bench, u32 bounces) {
    TraceOptions options = TRACE_OPTIONS_DEFAULT;
    options.samples = bench->quick ? 48 : 768;
    options.bounces = bounces;
    options.shadows = TRACE_SHADOWS_ALL;
    options.largest = 30.0f; // a few paths that found the lamp's own surroundings
    return options;
}

// The variant's level, as a path tracer sees it.
static bool reference_of(GiBench *run, const char *experiment, const char *scene,
                         const GiVariant *variant, u32 bounces, RenderImage *out) {
    Bench *bench = run->frames.bench;
    TraceOptions options = reference_options(bench, bounces);
    if (variant->prepare) variant->prepare(&run->frames.session, variant);
    bool ok = gi_bench_reference(run, &options, &bench->arena, out);
    if (ok) keep_picture(bench, experiment, scene, "reference", out);
    return ok;
}

// --- V5 ---

static void prepare_shadows(Session *session, const GiVariant *variant) {
    bool is_map = variant->choice == SCREEN_SHADOW_MAP;
    gi_set_shadows(session->world, true, is_map ? 0 : 1 + VOXEL_SHADOW_RAY, variant->choice,
                   MAX((f32)variant->aperture_deg, 0.1f));
}

static GiVariant shadow_variant(u32 screen_shadow, f64 aperture_deg, const char *name) {
    GiVariant variant = gi_variant("thesis", "gi.ao=off,gi.policy=every_frame", "%s", name);
    variant.prepare = prepare_shadows;
    variant.choice = screen_shadow;
    variant.aperture_deg = aperture_deg;
    return variant;
}

static bool v5_scene(Bench *bench, const char *id, const GiScene *scene, u32 tick,
                     const char *first, BenchTable *table, f64 flips[6], f64 times[6]) {
    u32 width = bench->quick ? 160 : 320, height = bench->quick ? 90 : 180;
    GiVariant variants[] = {
        shadow_variant(SCREEN_SHADOW_MAP, 1, first),
        shadow_variant(SCREEN_SHADOW_VOLUME, 1, "visibility volume"),
        shadow_variant(SCREEN_SHADOW_CONE, 1, "cone 1 deg"),
        shadow_variant(SCREEN_SHADOW_CONE, 5, "cone 5 deg"),
        shadow_variant(SCREEN_SHADOW_CONE, 20, "cone 20 deg"),
        shadow_variant(SCREEN_SHADOW_CONE, 45, "cone 45 deg"),
    };
    GiBench run;
    if (!gi_bench_open(&run, bench, scene, width, height, 1)) return false;
    session_advance(&run.frames.session, tick);
    RenderImage reference;
    PictureError errors[COUNT_OF(variants)];
    FrameRounds rounds = {3, 11, 30, 0};
    if (bench->quick) rounds = (FrameRounds){2, 2, 3, 0};
    bool ok =
        reference_of(&run, "v5", scene->name, &variants[0], 8, &reference) &&
        picture_errors(&run, "v5", scene->name, variants, COUNT_OF(variants), &reference, errors) &&
        gi_bench_measure(&run, variants, COUNT_OF(variants), &rounds);
    for (u32 v = 0; ok && v < COUNT_OF(variants); v++) {
        frame_variant_add(bench, id, &variants[v].frame,
                          variants[v].frame_ms / variants[0].frame_ms, true);
        bench_text(table, "%s", scene->name);
        bench_text(table, "%s", variants[v].frame.name);
        bench_number(table, gi_pass_ms(&variants[v].frame.times, "shadow"));
        bench_number(table, variants[v].steps[GI_STEP_shadows]);
        bench_number(table, variants[v].steps[GI_STEP_shade]);
        bench_number(table, variants[v].frame_ms);
        bench_number(table, errors[v].flip);
        bench_number(table, errors[v].ssim);
        flips[v] = errors[v].flip;
        times[v] = variants[v].frame_ms;
    }
    gi_variants_free(variants, COUNT_OF(variants));
    gi_bench_close(&run);
    return ok;
}

bool bench_gi_v5(Bench *bench, const char *id) {
    static const char *const names[] = {"none / map", "volume", "1 deg",
                                        "5 deg",      "20 deg", "45 deg"};
    const GiScene cornell = {"cornell", "data/levels/cornell.toml", NULL};
    const GiScene door = {"moving_door", "data/levels/moving_door.toml", NULL};
    BenchTable table;
    bench_table_begin(&table, bench, "v5",
                      "scene,shadow,shadow map ms,traced lights ms,shade ms,frame ms,FLIP,SSIM");
    f64 flips[2][6], times[2][6];
    bool ok = v5_scene(bench, id, &cornell, 0, "no shadow", &table, flips[0], times[0]) &&
              v5_scene(bench, id, &door, 250, "shadow map", &table, flips[1], times[1]);
    PlotChart charts[2] = {{.title = "V5: frame", .y_label = "milliseconds"},
                           {.title = "V5: error to the path-traced picture", .y_label = "FLIP"}};
    for (u32 c = 0; ok && c < 2; c++) {
        charts[c].kind = PLOT_BARS;
        charts[c].categories = names;
        charts[c].category_count = COUNT_OF(names);
        for (u32 s = 0; s < 2; s++) {
            PlotSeries *series = plot_add(&charts[c], s ? door.name : cornell.name);
            series->y = c ? flips[s] : times[s];
            series->count = COUNT_OF(names);
        }
    }
    if (ok)
        bench_verdict(bench, id, MIN(flips[0][2], flips[0][3]) / flips[0][0], BENCH_AT_MOST, 1.0,
                      "x", "cornell, FLIP of cone shadows / of no shadow");
    return bench_table_end(&table) && ok && bench_plot(bench, "v5", charts, 2, 1, 1000, 1000);
}

// --- V6 ---

bool bench_gi_v6(Bench *bench, const char *id) {
    static const u32 grids[] = {32, 64, 128, 256};
    static const f64 factors[] = {0.25, 0.5, 1.0, 2.5};
    enum { GRIDS = COUNT_OF(grids), FACTORS = COUNT_OF(factors) };
    u32 grid_count = bench->quick ? 3 : GRIDS;
    u32 width = bench->quick ? 160 : 640, height = bench->quick ? 90 : 360;
    GiScene scene = {"cornell", bench_level(bench, "data/levels/cornell.toml"), NULL};
    GiVariant variants[GRIDS * FACTORS] = {0};
    for (u32 g = 0; g < grid_count; g++)
        for (u32 f = 0; f < FACTORS; f++) {
            char sets[64];
            snprintf(sets, sizeof sets, "gi.grid=%u,gi.step_factor=%g", grids[g], factors[f]);
            variants[g * FACTORS + f] =
                gi_variant("thesis", sets, "%u step %g", grids[g], factors[f]);
        }
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, width, height, 1)) return false;
    RenderImage finest;
    PictureError errors[GRIDS * FACTORS];
    bool ok =
        gi_bench_picture(&run, &variants[(grid_count - 1) * FACTORS + 1], &bench->arena, &finest) &&
        picture_errors(&run, "v6", scene.name, variants, grid_count * FACTORS, &finest, errors);
    gi_bench_close(&run);
    if (!ok) return false;
    BenchTable table;
    bench_table_begin(&table, bench, "v6", "grid,step factor,FLIP to the finest,SSIM");
    f64 x[GRIDS], y[FACTORS][GRIDS];
    for (u32 g = 0; g < grid_count; g++) {
        x[g] = grids[g];
        for (u32 f = 0; f < FACTORS; f++) {
            const PictureError *e = &errors[g * FACTORS + f];
            y[f][g] = e->flip;
            bench_number(&table, grids[g]);
            bench_number(&table, factors[f]);
            bench_number(&table, e->flip);
            bench_number(&table, e->ssim);
        }
    }
    for (u32 g = 1; g < grid_count; g++)
        bench_verdict(bench, id, y[1][g] / y[1][g - 1], BENCH_AT_MOST, 1.0, "x",
                      "FLIP at %u / at %u voxels a side, step 0.5", grids[g], grids[g - 1]);
    PlotChart chart = {.title = "V6: difference to the finest picture",
                       .x_label = "voxels along a side",
                       .y_label = "FLIP",
                       .x_log = true,
                       .y_from_zero = true,
                       .x_ticks = x,
                       .x_tick_count = grid_count};
    for (u32 f = 0; f < FACTORS; f++) {
        PlotSeries *series =
            plot_add(&chart, arena_format(&bench->arena, "step factor %g", factors[f]));
        series->x = x, series->y = y[f], series->count = grid_count;
    }
    return bench_table_end(&table) && bench_plot(bench, "v6", &chart, 1, 1, 960, 600);
}

// --- V8 ---

// Lamps cast no shadows, or traced ones (choice 1). The sun keeps its map, which is finer than
// cones.
static void prepare_feature(Session *session, const GiVariant *variant) {
    gi_set_shadows(session->world, true, 0, SCREEN_SHADOW_MAP, 2.0f);
    if (variant->choice)
        gi_set_shadows(session->world, false, 1 + VOXEL_SHADOW_RAY, SCREEN_SHADOW_CONE, 2.0f);
}

// What V8 adds one after the other. Occlusion has no verdict: it darkens direct light as well,
// which real light does not do.
typedef struct Feature {
    const char *name;
    u32 shadows;   // prepare_feature's choice
    u32 reference; // of lamps without shadows, or with them
    u32 after;     // the row that it is compared with; its own: none
    const char *sets;
} Feature;
#define BARE  "gi.specular=off,gi.ao=off"
#define APART "gi.faces=apart,gi.dither=on"
static const Feature features[] = {
    {"direct", 0, 0, 0, "gi.enabled=off"},
    {"one bounce", 0, 0, 0, BARE ",gi.bounces=1"},
    {"faces apart", 0, 0, 1, BARE ",gi.bounces=1," APART},
    {"two bounces", 0, 0, 2, BARE "," APART},
    {"more bounces", 0, 0, 3, BARE "," APART ",gi.feedback=on"},
    {"specular", 0, 0, 4, "gi.ao=off," APART ",gi.feedback=on"},
    {"occlusion", 0, 0, 5, APART ",gi.feedback=on"},
    {"no shadows", 0, 1, 7, "gi.ao=off," APART ",gi.feedback=on"},
    {"shadows", 1, 1, 7, "gi.ao=off," APART ",gi.feedback=on"},
};
#undef BARE
#undef APART
enum { FEATURES = COUNT_OF(features), ALL_FEATURES = 5 };

static bool v8_scene(Bench *bench, const GiScene *scene, u32 tick, f64 flips[FEATURES],
                     f64 ssims[FEATURES]) {
    GiVariant variants[FEATURES];
    for (u32 i = 0; i < FEATURES; i++) {
        variants[i] = gi_variant("thesis", features[i].sets, "%s", features[i].name);
        variants[i].prepare = prepare_feature;
        variants[i].choice = features[i].shadows;
    }
    u32 width = bench->quick ? 160 : 320, height = bench->quick ? 90 : 180;
    GiBench run;
    if (!gi_bench_open(&run, bench, scene, width, height, 1)) return false;
    session_advance(&run.frames.session, tick);
    bool ok = true;
    u64 mark = arena_mark(&bench->arena);
    for (u32 shadows = 0; shadows < 2 && ok; shadows++) {
        TraceOptions options = reference_options(bench, 8);
        options.shadows = TRACE_SHADOWS_LEVEL;
        prepare_feature(&run.frames.session, &(GiVariant){.choice = shadows});
        RenderImage reference;
        ok = gi_bench_reference(&run, &options, &bench->arena, &reference);
        if (ok)
            keep_picture(bench, "v8", scene->name, shadows ? "reference, shadows" : "reference",
                         &reference);
        for (u32 i = 0; i < FEATURES && ok; i++) {
            PictureError error;
            if (features[i].reference != shadows) continue;
            ok = picture_errors(&run, "v8", scene->name, &variants[i], 1, &reference, &error);
            flips[i] = error.flip, ssims[i] = error.ssim;
        }
    }
    arena_rewind(&bench->arena, mark);
    gi_bench_close(&run);
    return ok;
}

static void v8_verdicts(Bench *bench, const char *id, const char *scene,
                        const f64 flips[FEATURES]) {
    for (u32 i = 0; i < FEATURES; i++) {
        const f64 *with = &flips[i], *without = &flips[features[i].after];
        // One that changes nothing in a scene changes no error.
        if (features[i].reference != features[features[i].after].reference ||
            fabs(*with - *without) <= 1e-5 || strcmp(features[i].name, "occlusion") == 0)
            continue;
        bench_verdict(bench, id, *with / *without, BENCH_AT_MOST, 1.0, "x",
                      "%s, FLIP with %s / without", scene, features[i].name);
    }
    bench_verdict(bench, id, flips[ALL_FEATURES] / flips[0], BENCH_AT_MOST, 1.0, "x",
                  "%s, FLIP with all light that bounces / of direct light", scene);
}

bool bench_gi_v8(Bench *bench, const char *id) {
    static const GiScene scenes[] = {
        {"cornell", "data/levels/cornell.toml", NULL},
        {"emissive_teapot", "data/levels/emissive_teapot.toml", NULL},
        {"light_box", "data/levels/light_box.toml", NULL},
        {"moving_door", "data/levels/moving_door.toml", NULL},
    };
    static const u32 ticks[] = {0, 0, 0, 250};
    static const char *feature_names[FEATURES];
    for (u32 i = 0; i < FEATURES; i++) feature_names[i] = features[i].name;
    enum { SCENES = COUNT_OF(scenes) };
    f64 flips[SCENES][FEATURES], ssims[SCENES][FEATURES];
    BenchTable table;
    bench_table_begin(&table, bench, "v8", "scene,with,FLIP,SSIM");
    bool ok = true;
    Progress progress = progress_begin(id, SCENES, bench->common.quiet);
    for (u32 s = 0; ok && s < SCENES; s++) {
        ok = v8_scene(bench, &scenes[s], ticks[s], flips[s], ssims[s]);
        progress_set(&progress, s + 1, scenes[s].name);
        for (u32 i = 0; ok && i < FEATURES; i++) {
            bench_text(&table, "%s", scenes[s].name);
            bench_text(&table, "%s", feature_names[i]);
            bench_number(&table, flips[s][i]);
            bench_number(&table, ssims[s][i]);
        }
        if (ok) v8_verdicts(bench, id, scenes[s].name, flips[s]);
    }
    progress_end(&progress);
    PlotChart charts[2] = {{.title = "V8: error to the path-traced picture", .y_label = "FLIP"},
                           {.title = "V8: likeness", .y_label = "SSIM"}};
    for (u32 c = 0; ok && c < 2; c++) {
        charts[c].kind = PLOT_BARS;
        charts[c].categories = feature_names;
        charts[c].category_count = FEATURES;
        for (u32 s = 0; s < SCENES; s++) {
            PlotSeries *series = plot_add(&charts[c], scenes[s].name);
            series->y = c ? ssims[s] : flips[s];
            series->count = FEATURES;
        }
    }
    return bench_table_end(&table) && ok && bench_plot(bench, "v8", charts, 2, 1, 1200, 1000);
}

// --- What the engine promises ---

static bool claim_presets(Bench *bench, const char *id) {
    // Of the program of the source, its own shaders, on a machine with two cores; wall time. The
    // same cones are to be drawn in a third of it.
    static const f64 published[] = {451.0, 1190.0};
    const f64 thesis_share = 1.0 / 3.0;
    static const u32 sizes[2][2] = {{640, 360}, {1280, 720}};
    const GiScene scene = {"cornell", "data/levels/cornell.toml", NULL};
    GiVariant variants[4];
    for (u32 v = 0; v < 4; v++) {
        const u32 *size = sizes[v % 2];
        const char *preset = v < 2 ? "thesis" : "lavapipe";
        variants[v] =
            gi_variant(preset, "gi.policy=every_frame", "%ux%u %s", size[0], size[1], preset);
        variants[v].frame.width_px = size[0];
        variants[v].frame.height_px = size[1];
    }
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, sizes[0][0], sizes[0][1], 1)) return false;
    RenderImage images[4];
    bool ok = true;
    for (u32 v = 0; ok && v < 4; v++)
        ok = gi_bench_picture(&run, &variants[v], &bench->arena, &images[v]);
    // As in play: nothing static moves, and nothing else does in this room.
    run.nudged = ROW_NONE;
    run.at_rest = true;
    FrameRounds rounds = {5, 15, 60, 0};
    if (bench->quick) rounds = (FrameRounds){2, 3, 10, 0};
    ok = ok && gi_bench_measure(&run, variants, 4, &rounds);
    gi_bench_close(&run);
    for (u32 v = 0; ok && v < 4; v++) {
        const u32 *size = sizes[v % 2];
        frame_variant_add(bench, id, &variants[v].frame,
                          variants[v].frame_ms / variants[v % 2].frame_ms, true);
        if (v < 2) {
            bench_verdict(bench, id, variants[v].frame_ms, BENCH_AT_MOST,
                          published[v] * thesis_share, " ms",
                          "cornell, thesis, 64 voxels a side, %ux%u, frame; published %g ms",
                          size[0], size[1], published[v]);
            continue;
        }
        ImageDifference difference =
            image_compare(images[v - 2].rgba, images[v].rgba, size[0], size[1], &bench->arena);
        bench_verdict(bench, id, published[v - 2] / variants[v].frame_ms, BENCH_AT_LEAST, 15.0, "x",
                      "cornell, %ux%u, published %g ms / preset lavapipe", size[0], size[1],
                      published[v - 2]);
        bench_verdict(bench, id, variants[v - 2].frame_ms / variants[v].frame_ms, BENCH_AT_LEAST,
                      15.0, "x", "cornell, %ux%u, thesis / preset lavapipe", size[0], size[1]);
        bench_verdict(bench, id, difference.ssim, BENCH_AT_LEAST, 0.95, "",
                      "cornell, %ux%u, SSIM of preset lavapipe to thesis", size[0], size[1]);
    }
    gi_variants_free(variants, 4);
    return ok;
}

static bool claim_update(Bench *bench, const char *id) {
    const GiScene scene = GI_SCENE_CORNELL;
    GiVariant variant =
        gi_variant("lavapipe", "gi.policy=every_frame", "cornell, update at 64 voxels a side");
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, 640, 360, 1)) return false;
    run.nudged = ROW_NONE;
    FrameRounds rounds = {9, 31, 15, 0};
    if (bench->quick) rounds = (FrameRounds){3, 5, 3, 0};
    bool ok = gi_bench_measure(&run, &variant, 1, &rounds);
    gi_bench_close(&run);
    if (ok) {
        frame_variant_add(bench, id, &variant.frame, 1.0, true);
        bench_verdict(bench, id, variant.update_ms, BENCH_AT_MOST, 6.0, " ms",
                      "cornell, two boxes move: all passes that make and light voxels");
    }
    gi_variants_free(&variant, 1);
    return ok;
}

static bool claim_cloister(Bench *bench, const char *id) {
    const GiScene scene = {"cloister", BENCH_LEVEL, NULL};
    GiVariant variants[2] = {gi_variant("lavapipe", NULL, "cloister 640x360, preset lavapipe"),
                             gi_variant(NULL, "gi.enabled=off", "cloister 640x360, off")};
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, 640, 360, 1)) return false;
    run.nudged = ROW_NONE;
    FrameRounds rounds = {9, 41, 30, 0};
    if (bench->quick) rounds = (FrameRounds){3, 5, 5, 0};
    // One after the other: a frame after the other variant's would have all voxels to make.
    bool ok = gi_bench_measure(&run, &variants[0], 1, &rounds) &&
              gi_bench_measure(&run, &variants[1], 1, &rounds);
    gi_bench_close(&run);
    if (ok) {
        for (u32 v = 0; v < 2; v++)
            frame_variant_add(bench, id, &variants[v].frame,
                              variants[v].frame_ms / variants[1].frame_ms, true);
        bench_verdict(bench, id, 1000.0 / variants[0].frame_ms, BENCH_AT_LEAST, 20.0, " fps",
                      "cloister, 640x360, preset lavapipe");
    }
    gi_variants_free(variants, 2);
    return ok;
}

bool bench_gi_claims(Bench *bench, const char *id) {
    bench->in_experiment = false; // nothing else prints these
    return claim_presets(bench, id) && claim_update(bench, id) && claim_cloister(bench, id);
}
