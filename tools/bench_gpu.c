// bench_gpu.c: rows that draw: a level, a scene, the paths against each other.
// Data in: a level. Data out: frame times, CPU times, times of passes. Frames show advancing ticks,
// as in play. Does not: experiments (bench_lights.c and others).
#include "bench_frames.h"
#include <stdio.h>

static bool bench_frames(Bench *bench, const char *id, const char *level, u32 width, u32 height,
                         u32 rounds) {
    FrameBench run;
    if (!frame_bench_open(&run, bench, level, width, height, 1)) return false;
    FrameVariant variant = {.name = "frame", .settings = settings_default()};
    bool ok = frame_bench_warm_up(&run) &&
              frame_bench_measure(&run, &variant, 1,
                                  &(FrameRounds){.min = rounds, .max = rounds, .budget_s = 1e9});
    if (ok) {
        Samples fps = {0};
        for (u32 i = 0; i < variant.times.frame_ms.count; i++)
            samples_add(&fps, 1000.0 / MAX(variant.times.frame_ms.values[i], 1e-3));
        bench_add(bench, id, "frames per second", &fps, "1/s", 0.0);
        bench_add(bench, id, "frame", &variant.times.frame_ms, "ms", 0.0);
        bench_add(bench, id, "CPU, all threads", &variant.times.cpu_ms, "ms", 0.0);
        for (u32 p = 0; p < variant.times.pass_count; p++) {
            char what[96];
            snprintf(what, sizeof what, "pass %s", variant.times.passes[p].name);
            bench_add(bench, id, what, &variant.times.passes[p].ms, "ms", 0.0);
        }
        samples_free(&fps);
    }
    frame_variants_free(&variant, 1);
    frame_bench_close(&run);
    return ok;
}

bool bench_cloister(Bench *bench, const char *id) {
    return bench_frames(bench, id, bench_level(bench, BENCH_LEVEL), 640, 360,
                        bench->quick ? 15 : 120);
}

bool bench_atrium(Bench *bench, const char *id) {
    return bench_frames(bench, id, bench->scene, 1280, 720, bench->quick ? 5 : 30);
}

bool bench_paths(Bench *bench, const char *id) {
    // Beyond 256 lights the two paths without tiles take seconds a frame.
    static const u32 limits[] = {16, 64, 256};
    static const RenderPath order[] = {PATH_TILED_DEFERRED, PATH_DEFERRED, PATH_FORWARD};
    u32 limit_count = bench->quick ? 2 : COUNT_OF(limits);
    FrameBench run;
    if (!frame_bench_open(&run, bench, bench_level(bench, BENCH_LEVEL), 640, 360, limit_count))
        return false;
    bool ok = true;
    u32 rounds = bench->quick ? 3 : 9;
    for (u32 l = 0; ok && l < limit_count; l++) {
        if (l > 0 && limits[l - 1] >= run.light_count) break; // the same picture again
        FrameVariant variants[COUNT_OF(order)] = {0};
        for (u32 p = 0; p < COUNT_OF(order); p++) {
            variants[p].settings = frame_settings_direct();
            variants[p].settings.path = order[p];
            variants[p].settings.light_limit = limits[l];
            char word[64];
            snprintf(variants[p].name, sizeof variants[p].name, "%4u lights, %s",
                     MIN(limits[l], run.light_count),
                     settings_word("path", order[p], word, sizeof word));
        }
        ok = frame_bench_measure(&run, variants, COUNT_OF(order),
                                 &(FrameRounds){.min = rounds, .max = rounds, .budget_s = 1e9});
        for (u32 p = 0; ok && p < COUNT_OF(order); p++)
            frame_variant_add(bench, id, &variants[p],
                              frame_variant_ms(&variants[p]) / frame_variant_ms(&variants[0]),
                              false);
        frame_variants_free(variants, COUNT_OF(order));
    }
    frame_bench_close(&run);
    return ok;
}
