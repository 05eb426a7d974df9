// bench_lights.c: experiments P1, K1 and K3: frame time against the number of lights.
// Data in: a level with many lights, of which the setting light_limit takes the first N. Data out:
// tables, charts, verdicts. Does not: tiles (bench_tiles.c), stages of the manager
// (bench_stages.c).
//
// Except where a manager is what is measured, every light in view is shaded: nothing is merged or
// dropped, so that all paths do the same work.
#include "bench_frames.h"
#include "bench_table.h"
#include <math.h>
#include <stdio.h>

#define COUNTS_CAP 8
#define SERIES_CAP PATH_COUNT

typedef struct Sweep {
    const char *id;
    u32 counts[COUNTS_CAP], count_count;
    struct SweepSeries {
        char name[48];
        RenderPath path;
        bool manager; // simplifies lights
        u32 width_px, height_px;
        bool stopped; // grew too slow
        f64 ms[COUNTS_CAP], p10[COUNTS_CAP], p90[COUNTS_CAP], fps[COUNTS_CAP];
        f64 shaded[COUNTS_CAP];
    } series[SERIES_CAP];
    u32 series_count;
    FrameRounds rounds;
    f64 stop_ms; // a series ends when a frame took longer, or would take twice as long
    f64 x[COUNTS_CAP];
} Sweep;
typedef struct SweepSeries SweepSeries;

static SweepSeries *sweep_add(Sweep *sweep, const char *name, RenderPath path, bool manager,
                              u32 width, u32 height) {
    LUZ_ASSERT(sweep->series_count < SERIES_CAP);
    SweepSeries *series = &sweep->series[sweep->series_count++];
    *series =
        (SweepSeries){.path = path, .manager = manager, .width_px = width, .height_px = height};
    snprintf(series->name, sizeof series->name, "%s", name);
    for (u32 c = 0; c < COUNTS_CAP; c++)
        series->ms[c] = series->p10[c] = series->p90[c] = series->fps[c] = series->shaded[c] = NAN;
    return series;
}

static void sweep_add_path(Sweep *sweep, RenderPath path, u32 width, u32 height) {
    char word[48];
    sweep_add(sweep, settings_word("path", path, word, sizeof word), path, false, width, height);
}

static void sweep_counts(Sweep *sweep, const u32 *counts, u32 count) {
    for (u32 c = 0; c < count; c++) sweep->counts[sweep->count_count++] = counts[c];
}

static bool goes_on(const Sweep *sweep, const SweepSeries *series, u32 c) {
    if (c == 0) return true;
    f64 last = series->ms[c - 1];
    return !series->stopped && last <= sweep->stop_ms &&
           last * sweep->counts[c] / sweep->counts[c - 1] <= 2 * sweep->stop_ms;
}

static bool sweep_step(Bench *bench, Sweep *sweep, FrameBench *run, u32 c) {
    FrameVariant variants[SERIES_CAP] = {0};
    u32 of_variant[SERIES_CAP], count = 0;
    for (u32 s = 0; s < sweep->series_count; s++) {
        SweepSeries *series = &sweep->series[s];
        series->stopped = !goes_on(sweep, series, c);
        if (series->stopped) continue;
        FrameVariant *variant = &variants[count];
        of_variant[count++] = s;
        variant->settings = frame_bench_settings(run, series->path, sweep->counts[c]);
        if (!series->manager) frame_settings_every_light(&variant->settings);
        variant->width_px = series->width_px;
        variant->height_px = series->height_px;
        snprintf(variant->name, sizeof variant->name, "%5u lights, %s", sweep->counts[c],
                 series->name);
    }
    bool ok = frame_bench_measure(run, variants, count, &sweep->rounds);
    for (u32 v = 0; ok && v < count; v++) {
        SweepSeries *series = &sweep->series[of_variant[v]];
        Samples *frame_ms = &variants[v].times.frame_ms;
        series->ms[c] = frame_variant_ms(&variants[v]);
        series->p10[c] = samples_percentile(frame_ms, 0.1);
        series->p90[c] = samples_percentile(frame_ms, 0.9);
        series->fps[c] = 1000.0 / MAX(series->ms[c], 1e-3);
        series->shaded[c] = variants[v].counts.lights_shaded;
        frame_variant_add(bench, sweep->id, &variants[v],
                          series->ms[c] / frame_variant_ms(&variants[0]), false);
    }
    frame_variants_free(variants, count);
    return ok;
}

static bool sweep_run(Bench *bench, Sweep *sweep) {
    FrameBench run;
    if (!frame_bench_open(&run, bench, bench_level(bench, BENCH_LEVEL_HALL), 640, 360,
                          sweep->count_count))
        return false;
    // More lights than the level has would be the same picture again.
    while (sweep->count_count > 1 && sweep->counts[sweep->count_count - 2] >= run.light_count)
        sweep->count_count--;
    bool ok = true;
    for (u32 c = 0; ok && c < sweep->count_count; c++) {
        sweep->x[c] = sweep->counts[c];
        ok = sweep_step(bench, sweep, &run, c);
    }
    frame_bench_close(&run);
    return ok;
}

static bool sweep_table(Bench *bench, const Sweep *sweep, const char *name) {
    BenchTable table;
    char columns[128];
    snprintf(columns, sizeof columns, "path,lights,shaded,ms,p10,p90,fps,of %s",
             sweep->series[0].name);
    bench_table_begin(&table, bench, name, columns);
    for (u32 s = 0; s < sweep->series_count; s++)
        for (u32 c = 0; c < sweep->count_count; c++) {
            const SweepSeries *series = &sweep->series[s];
            if (isnan(series->ms[c])) continue;
            bench_text(&table, "%s", series->name);
            bench_number(&table, sweep->counts[c]);
            bench_number(&table, series->shaded[c]);
            bench_number(&table, series->ms[c]);
            bench_number(&table, series->p10[c]);
            bench_number(&table, series->p90[c]);
            bench_number(&table, series->fps[c]);
            bench_number(&table, series->ms[c] / sweep->series[0].ms[c]);
        }
    return bench_table_end(&table);
}

static PlotChart sweep_chart(const Sweep *sweep, const char *title, bool as_fps) {
    PlotChart chart = {.title = title,
                       .x_label = "lights",
                       .y_label = as_fps ? "frames a second" : "milliseconds a frame",
                       .x_log = true,
                       .y_log = true,
                       .x_ticks = sweep->x,
                       .x_tick_count = sweep->count_count};
    for (u32 s = 0; s < sweep->series_count; s++) {
        const SweepSeries *from = &sweep->series[s];
        PlotSeries *series = plot_add(&chart, from->name);
        series->x = sweep->x;
        series->y = as_fps ? from->fps : from->ms;
        series->low = as_fps ? NULL : from->p10;
        series->high = as_fps ? NULL : from->p90;
        series->count = sweep->count_count;
    }
    return chart;
}

// Smallest ratio of two series over all counts from `first` on; NAN if they never meet.
static f64 least_ratio(const Sweep *sweep, u32 slower, u32 faster, u32 first) {
    f64 least = NAN;
    for (u32 c = 0; c < sweep->count_count; c++) {
        f64 ratio = sweep->series[slower].ms[c] / sweep->series[faster].ms[c];
        if (sweep->counts[c] >= first && !isnan(ratio)) least = fmin(ratio, least);
    }
    return least;
}

// --- P1 ---

bool bench_p1(Bench *bench, const char *id) {
    Sweep sweep = {.id = id, .stop_ms = 4000, .rounds = {5, 25, 20, 2000}};
    if (bench->quick) {
        sweep_counts(&sweep, (u32[]){1, 16, 256}, 3);
        sweep.rounds = (FrameRounds){3, 9, 2, 500};
    } else {
        sweep_counts(&sweep, (u32[]){1, 4, 16, 64, 256}, 5);
    }
    u32 width = bench->quick ? 320 : 640, height = bench->quick ? 180 : 360;
    sweep_add_path(&sweep, PATH_MULTIPASS, width, height);
    sweep_add_path(&sweep, PATH_DEFERRED, width, height);
    sweep_add(&sweep, "deferred_volumes, manager", PATH_DEFERRED_VOLUMES, true, width, height);
    sweep_add(&sweep, "tiled_deferred, manager", PATH_TILED_DEFERRED, true, width, height);
    if (!sweep_run(bench, &sweep)) return false;
    bench_verdict(bench, id, least_ratio(&sweep, 0, 1, 16), BENCH_AT_LEAST, 1.0, "x",
                  "multipass / deferred, least from 16 lights on");
    bench_verdict(bench, id, least_ratio(&sweep, 1, 2, 16), BENCH_AT_LEAST, 1.0, "x",
                  "deferred / deferred_volumes with manager, least from 16 lights on");
    char title[96];
    snprintf(title, sizeof title, "P1: frame time against the number of lights, %ux%u", width,
             height);
    PlotChart chart = sweep_chart(&sweep, title, false);
    return sweep_table(bench, &sweep, "p1") && bench_plot(bench, "p1", &chart, 1, 1, 960, 540);
}

// --- K1 ---

bool bench_k1(Bench *bench, const char *id) {
    Sweep sweep = {.id = id, .stop_ms = 12000, .rounds = {3, 15, 15, 3000}};
    if (bench->quick) {
        sweep_counts(&sweep, (u32[]){100, 500, 1000}, 3);
        sweep_add(&sweep, "160x90", PATH_DEFERRED, false, 160, 90);
        sweep_add(&sweep, "320x180", PATH_DEFERRED, false, 320, 180);
        sweep.rounds = (FrameRounds){3, 7, 3, 1000};
        sweep.stop_ms = 3000;
    } else {
        sweep_counts(&sweep, (u32[]){100, 200, 500, 1000, 2000, 5000}, 6);
        sweep_add(&sweep, "640x360", PATH_DEFERRED, false, 640, 360);
        sweep_add(&sweep, "1280x720", PATH_DEFERRED, false, 1280, 720);
    }
    if (!sweep_run(bench, &sweep)) return false;
    f64 fall = NAN;
    for (u32 c = 0; c < sweep.count_count; c++)
        if (sweep.counts[c] == 1000) fall = sweep.series[0].ms[c] / sweep.series[0].ms[0];
    bench_verdict(bench, id, fall, BENCH_AT_LEAST, 2.0, "x",
                  "frames a second fall from 100 to 1000 lights, %s", sweep.series[0].name);
    PlotChart chart = sweep_chart(&sweep, "K1: deferred, one full-screen pass a light", true);
    return sweep_table(bench, &sweep, "k1") && bench_plot(bench, "k1", &chart, 1, 1, 960, 540);
}

// --- K3 ---

static bool is_culled_by_cells(RenderPath path) {
    return path >= PATH_TILED_DEFERRED; // tiled and clustered ones are the last four
}

// Fastest series at a count; `cells` tells which kind: -1 = any, 0 = without cells, 1 = with.
static i32 fastest(const Sweep *sweep, u32 c, i32 cells, i32 but) {
    i32 best = -1;
    for (u32 s = 0; s < sweep->series_count; s++) {
        const SweepSeries *series = &sweep->series[s];
        if (isnan(series->ms[c]) || (i32)s == but) continue;
        if (cells >= 0 && is_culled_by_cells(series->path) != (cells == 1)) continue;
        if (best < 0 || series->ms[c] < sweep->series[best].ms[c]) best = (i32)s;
    }
    return best;
}

static bool k3_winners(Bench *bench, const Sweep *sweep) {
    BenchTable table;
    bench_table_begin(&table, bench, "k3_winners",
                      "lights,fastest,ms,second,ms of it,ratio,best without cells,ms of that");
    for (u32 c = 0; c < sweep->count_count; c++) {
        i32 first = fastest(sweep, c, -1, -1), second = fastest(sweep, c, -1, first);
        i32 plain = fastest(sweep, c, 0, -1);
        if (first < 0 || second < 0) continue;
        const SweepSeries *a = &sweep->series[first], *b = &sweep->series[second];
        bench_number(&table, sweep->counts[c]);
        bench_text(&table, "%s", a->name);
        bench_number(&table, a->ms[c]);
        bench_text(&table, "%s", b->name);
        bench_number(&table, b->ms[c]);
        bench_number(&table, b->ms[c] / a->ms[c]);
        bench_text(&table, "%s", plain < 0 ? "" : sweep->series[plain].name);
        bench_number(&table, plain < 0 ? (f64)NAN : sweep->series[plain].ms[c]);
    }
    return bench_table_end(&table);
}

bool bench_k3(Bench *bench, const char *id) {
    Sweep sweep = {.id = id, .stop_ms = 4000, .rounds = {3, 21, 20, 2000}};
    if (bench->quick) {
        sweep_counts(&sweep, (u32[]){16, 256, 2048}, 3);
        sweep.rounds = (FrameRounds){3, 5, 2, 300};
        sweep.stop_ms = 600;
    } else {
        sweep_counts(&sweep, (u32[]){16, 64, 256, 1024, 4096}, 5);
    }
    u32 width = bench->quick ? 320 : 640, height = bench->quick ? 180 : 360;
    for (u32 p = 0; p < PATH_COUNT; p++) sweep_add_path(&sweep, (RenderPath)p, width, height);
    if (!sweep_run(bench, &sweep)) return false;
    f64 least = NAN;
    for (u32 c = 0; c < sweep.count_count; c++) {
        i32 plain = fastest(&sweep, c, 0, -1), cells = fastest(&sweep, c, 1, -1);
        if (sweep.counts[c] < 256 || plain < 0 || cells < 0) continue;
        least = fmin(sweep.series[plain].ms[c] / sweep.series[cells].ms[c], least);
    }
    bench_verdict(bench, id, least, BENCH_AT_LEAST, 1.0, "x",
                  "best path without cells / best tiled or clustered, from 256 lights on");
    char title[96];
    snprintf(title, sizeof title, "K3: all paths against the number of lights, %ux%u", width,
             height);
    PlotChart chart = sweep_chart(&sweep, title, false);
    return sweep_table(bench, &sweep, "k3") && k3_winners(bench, &sweep) &&
           bench_plot(bench, "k3", &chart, 1, 1, 960, 540);
}
