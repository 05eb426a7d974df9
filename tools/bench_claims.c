// bench_claims.c: the row `claims`: the ratios that the engine promises, in one run.
// Data in: the cloister and the hall. Data out: frame times, verdicts.
// Does not: charts; the experiments have them.
#include "../engine/capture/image_compare.h"
#include "bench_frames.h"
#include "bench_stages.h"
#include <math.h>
#include <stdio.h>

#define WIDTH  1280
#define HEIGHT 720
#define LIGHTS 256

static void name_variant(FrameVariant *variant, const char *scene) {
    char word[48];
    settings_word("path", variant->settings.path, word, sizeof word);
    snprintf(variant->name, sizeof variant->name, "%s, %s", scene, word);
}

// Tiled against one pass a light and one pass for eight of them.
static bool claim_paths(Bench *bench, const char *id, const char *scene, const char *level) {
    static const RenderPath order[] = {PATH_TILED_DEFERRED, PATH_DEFERRED, PATH_MULTIPASS};
    FrameBench run;
    u32 width = bench->quick ? 320 : WIDTH, height = bench->quick ? 180 : HEIGHT;
    if (!frame_bench_open(&run, bench, level, width, height, 1)) return false;
    FrameVariant variants[COUNT_OF(order)] = {0};
    for (u32 v = 0; v < COUNT_OF(order); v++) {
        variants[v].settings = frame_bench_settings(&run, order[v], LIGHTS);
        // The same lights for all.
        frame_settings_every_light(&variants[v].settings);
        name_variant(&variants[v], scene);
    }
    FrameRounds rounds = {3, 15, 45, 5000};
    if (bench->quick) rounds = (FrameRounds){2, 3, 2, 1000};
    bool ok = frame_bench_measure(&run, variants, COUNT_OF(order), &rounds);
    f64 base = frame_variant_ms(&variants[0]);
    for (u32 v = 0; ok && v < COUNT_OF(order); v++)
        frame_variant_add(bench, id, &variants[v], frame_variant_ms(&variants[v]) / base, true);
    if (ok) {
        bench_verdict(bench, id, frame_variant_ms(&variants[1]) / base, BENCH_AT_LEAST, 5.0, "x",
                      "%s, %u lights, deferred / tiled_deferred", scene, LIGHTS);
        bench_verdict(bench, id, frame_variant_ms(&variants[2]) / base, BENCH_AT_LEAST, 20.0, "x",
                      "%s, %u lights, multipass / tiled_deferred", scene, LIGHTS);
    }
    frame_variants_free(variants, COUNT_OF(order));
    frame_bench_close(&run);
    return ok;
}

// The light manager against shading every light of the level, from one camera in one path. Tiled
// lists leave out by themselves what lies elsewhere; the paths without lists depend on the manager.
static bool claim_view(FrameBench *run, const char *id, const char *camera, RenderPath path) {
    Bench *bench = run->bench;
    run->view.camera = camera;
    FrameVariant variants[2] = {0};
    for (u32 v = 0; v < 2; v++) {
        variants[v].settings = frame_settings_direct();
        variants[v].settings.path = path;
        variants[v].settings.manager = v == 0;
        char word[48];
        settings_word("path", path, word, sizeof word);
        snprintf(variants[v].name, sizeof variants[v].name, "%s, %s, manager %s", camera, word,
                 v == 0 ? "on" : "off");
    }
    FrameRounds rounds = {5, 31, 12, 3000};
    if (bench->quick) rounds = (FrameRounds){2, 3, 1, 0};
    u64 mark = arena_mark(&bench->arena);
    RenderImage on, off;
    bool ok = frame_bench_measure(run, variants, 2, &rounds) &&
              frame_bench_picture(run, &variants[0], &bench->arena, &on) &&
              frame_bench_picture(run, &variants[1], &bench->arena, &off);
    if (ok) {
        f64 ratio = frame_variant_ms(&variants[1]) / frame_variant_ms(&variants[0]);
        ImageDifference difference =
            image_compare(off.rgba, on.rgba, on.width_px, on.height_px, &bench->arena);
        frame_variant_add(bench, id, &variants[0], 1.0, true);
        frame_variant_add(bench, id, &variants[1], ratio, true);
        bench_verdict(bench, id, ratio, BENCH_AT_LEAST, 1.5, "x", "%s off / on, %u of %u lights",
                      variants[0].name, variants[0].counts.lights_shaded,
                      variants[0].counts.lights_total);
        bench_verdict(bench, id, difference.ssim, BENCH_AT_LEAST, 0.98, "", "%s, SSIM",
                      variants[0].name);
    }
    arena_rewind(&bench->arena, mark);
    frame_variants_free(variants, 2);
    return ok;
}

static bool claim_manager(Bench *bench, const char *id) {
    static const char *const cameras[] = {"main", "chapter_house", "walk"};
    FrameBench run;
    static const RenderPath paths[] = {PATH_TILED_DEFERRED, PATH_DEFERRED_VOLUMES, PATH_FORWARD};
    u32 width = bench->quick ? 320 : WIDTH / 2, height = bench->quick ? 180 : HEIGHT / 2;
    u32 steps = COUNT_OF(cameras) * COUNT_OF(paths);
    if (!frame_bench_open(&run, bench, BENCH_LEVEL, width, height, steps)) return false;
    bool ok = true;
    for (u32 p = 0; p < COUNT_OF(paths); p++)
        for (u32 i = 0; ok && i < COUNT_OF(cameras); i++)
            ok = claim_view(&run, id, cameras[i], paths[p]);
    frame_bench_close(&run);
    return ok;
}

bool bench_claims(Bench *bench, const char *id) {
    // Nothing else prints these.
    bench->in_experiment = false;
    if (!claim_paths(bench, id, "hall", BENCH_LEVEL_HALL) ||
        !claim_paths(bench, id, "cloister", BENCH_LEVEL))
        return false;
    return claim_manager(bench, id) && bench_manager_verdicts(bench, id);
}
