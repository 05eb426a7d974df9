// bench.c: `luz bench`: the measurements that the engine is judged by.
// Data in: row ids. Data out: tables on stdout, CSV, JSON, charts. Rows: bench_cpu.c, bench_gpu.c
// and the experiments (bench.h says where).
// Does not: compare with another day's numbers; the CSV is for that.
#include "bench_gi.h"
#include "../engine/base/file.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define BENCH_ARENA_CAP GIB(4)

static const BenchRow rows[] = {
    {"cull", "frustum culling of 100,000 spheres, against a naive loop", bench_cull, BENCH_CPU},
    {"grid", "light lists of 1,000 and 10,000 lights at 1280x720", bench_grid, BENCH_CPU},
    {"packet", "a frame packet of the level, by part", bench_packet, BENCH_CPU},
    {"level_load", "loading the level, with its models and textures", bench_level_load, BENCH_CPU},
    {"manager", "light manager and light lists of 1,000 and 10,000 lights in the hall",
     bench_manager, BENCH_CPU},
    {"cloister", "the level at 640x360, tiled_deferred: frame, CPU, passes", bench_cloister,
     BENCH_GPU},
    {"paths", "three paths under several light limits at 640x360", bench_paths, BENCH_GPU},
    {"atrium", "the --scene at 1280x720: frame, CPU, passes", bench_atrium, BENCH_GPU},
    {"claims", "the ratios that the engine promises", bench_claims, BENCH_EXPERIMENT},
    {"P1", "number of lights: multipass, deferred, deferred_volumes", bench_p1, BENCH_EXPERIMENT},
    {"P2", "size of the G-buffer by layout and screen size", bench_p2, BENCH_EXPERIMENT},
    {"P3", "each stage of the light manager: gain and error", bench_p3, BENCH_EXPERIMENT},
    {"K1", "number of lights and resolution: deferred", bench_k1, BENCH_EXPERIMENT},
    {"K2", "side of a tile, range of depths: tiled paths", bench_k2, BENCH_EXPERIMENT},
    {"K3", "all paths against the number of lights", bench_k3, BENCH_EXPERIMENT},
    {"gi", "what global illumination promises: presets, updates", bench_gi_claims,
     BENCH_EXPERIMENT},
    {"V1", "global illumination: each step, by scene", bench_gi_v1, BENCH_EXPERIMENT},
    {"V2", "global illumination: size of the grid", bench_gi_v2, BENCH_EXPERIMENT},
    {"V3", "cones: resolution and step factor", bench_gi_v3, BENCH_EXPERIMENT},
    {"V4", "shading of voxels: number of lights, rays", bench_gi_v4, BENCH_EXPERIMENT},
    {"V5", "shadows from voxels: time and error", bench_gi_v5, BENCH_EXPERIMENT},
    {"V6", "size of the grid and step factor: error", bench_gi_v6, BENCH_EXPERIMENT},
    {"V7", "memory by size of the grid", bench_gi_v7, BENCH_EXPERIMENT},
    {"V8", "features one by one: error to a path-traced picture", bench_gi_v8, BENCH_EXPERIMENT},
};

void bench_add(Bench *bench, const char *id, const char *what, Samples *samples, const char *unit,
               f64 ratio) {
    LUZ_ASSERT(bench->result_count < BENCH_RESULTS_CAP);
    BenchResult *result = &bench->results[bench->result_count++];
    *result = (BenchResult){.unit = unit, .ratio = ratio, .in_table = bench->in_experiment};
    snprintf(result->id, sizeof result->id, "%s", id);
    snprintf(result->what, sizeof result->what, "%s", what);
    result->median = samples_percentile(samples, 0.5);
    result->p10 = samples_percentile(samples, 0.1);
    result->p90 = samples_percentile(samples, 0.9);
}

void bench_verdict(Bench *bench, const char *id, f64 measured, BenchWish wish, f64 wanted,
                   const char *unit, const char *format, ...) {
    LUZ_ASSERT(bench->verdict_count < BENCH_VERDICTS_CAP);
    BenchVerdict *verdict = &bench->verdicts[bench->verdict_count++];
    *verdict = (BenchVerdict){.measured = measured, .wanted = wanted, .wish = wish, .unit = unit};
    snprintf(verdict->id, sizeof verdict->id, "%s", id);
    va_list args;
    va_start(args, format);
    vsnprintf(verdict->what, sizeof verdict->what, format, args);
    va_end(args);
}

void bench_variants(Bench *bench, const char *id, BenchVariant *variants, u32 count, u32 rounds) {
    Progress progress = progress_begin(id, rounds + 1, bench->common.quiet);
    for (u32 round = 0; round <= rounds; round++) {
        for (u32 i = 0; i < count; i++) {
            f64 ms = variants[i].function(variants[i].context);
            if (round > 0) samples_add(&variants[i].samples, ms);
        }
        progress_set(&progress, round + 1, NULL);
    }
    progress_end(&progress);
    f64 first = samples_percentile(&variants[0].samples, 0.5);
    for (u32 i = 0; i < count; i++) {
        f64 median = samples_percentile(&variants[i].samples, 0.5);
        bench_add(bench, id, variants[i].name, &variants[i].samples, "ms",
                  first > 0.0 ? median / first : 0.0);
        samples_free(&variants[i].samples);
    }
}

// --- the command ---

static const BenchRow *find_row(const char *id) {
    const char *names[COUNT_OF(rows)];
    for (u32 i = 0; i < COUNT_OF(rows); i++) {
        names[i] = rows[i].id;
        if (strcasecmp(id, rows[i].id) == 0) return &rows[i];
    }
    const char *near = tool_suggest(id, names, COUNT_OF(names));
    tool_fail(0, "bench", near ? "unknown row '%s'; did you mean '%s'?" : "unknown row '%s'", id,
              near);
    return NULL;
}

static int bench_row(Bench *bench, const BenchRow *row, bool asked) {
    if (strcmp(row->id, "atrium") == 0 && !bench->scene)
        return asked ? tool_fail(TOOL_USAGE, "bench", "row atrium needs --scene FILE") : TOOL_OK;
    if (row->kind != BENCH_CPU && !bench->has_device) {
        bench->has_device = headless_open(&bench->headless, &bench->common);
        if (!bench->has_device) return TOOL_ENVIRONMENT;
    }
    arena_reset(&bench->arena);
    bench->row = row->id;
    bench->in_experiment = row->kind == BENCH_EXPERIMENT;
    return row->run(bench, row->id) ? TOOL_OK : TOOL_DIFFERENT;
}

static int bench_rows(Bench *bench, const ToolList *ids) {
    int result = TOOL_OK;
    for (u32 i = 0; i < ids->count; i++)
        if (!find_row(ids->items[i])) return TOOL_USAGE;
    for (u32 i = 0; i < COUNT_OF(rows); i++) {
        bool asked = false;
        for (u32 k = 0; k < ids->count; k++) asked |= strcasecmp(ids->items[k], rows[i].id) == 0;
        if (!asked && (ids->count || rows[i].kind == BENCH_EXPERIMENT)) continue;
        int one = bench_row(bench, &rows[i], asked);
        result = MAX(result, one);
    }
    return result;
}

// Before minutes of measuring: can the charts be written?
static bool plots_writable(const char *directory) {
    char path[2048];
    snprintf(path, sizeof path, "%s/.writable", directory);
    if (!file_make_directories(directory) || !file_write(path, "", 0)) {
        tool_fail(0, "bench", "cannot write into '%s'", directory);
        return false;
    }
    remove(path);
    return true;
}

static int bench_run(int argc, char **argv) {
    static Bench bench;
    bench = (Bench){0};
    const char *csv = NULL;
    const ToolOption options[] = {
        {"quick", 0, OPTION_FLAG, &bench.quick, NULL, "fewer rounds: a look, not a measurement"},
        {"level", 0, OPTION_TEXT, &bench.level, "LEVEL",
         "instead of a row's own, which is " BENCH_LEVEL "\nor " BENCH_LEVEL_HALL},
        {"scene", 0, OPTION_TEXT, &bench.scene, "FILE",
         "a level or model: row atrium, rows V1 to V4, V7"},
        {"csv", 0, OPTION_TEXT, &csv, "FILE", "all medians as CSV"},
        {"plots", 0, OPTION_TEXT, &bench.plots, "DIR",
         "a chart and a CSV table of each experiment"},
    };
    char about[4096];
    u64 used = (u64)snprintf(
        about, sizeof about,
        "Measures. Variants of a row run alternately; numbers are medians with p10 "
        "and p90,\nratios are to the row's first variant. Rows (default: all but\nthe experiments, "
        "which are from claims on):\n");
    for (u32 i = 0; i < COUNT_OF(rows); i++)
        used += (u64)snprintf(about + used, sizeof about - used, "\n  %-11s %s", rows[i].id,
                              rows[i].help);
    const ToolSpec spec = {
        .command = "bench",
        .synopsis = "[ROW...] [options]",
        .about = about,
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_max = COUNT_OF(rows),
        .examples = "  luz bench cull grid\n"
                    "  luz bench --csv bench.csv\n"
                    "  luz bench P1 K2 --plots out/bench\n",
    };
    ToolList ids;
    ToolParse parsed = tool_parse(&spec, argc, argv, &bench.common, &ids);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    tool_begin(&bench.common);
    int result = TOOL_ENVIRONMENT;
    if (bench.plots && !plots_writable(bench.plots)) {
        // Told already.
    } else if (arena_create(&bench.arena, "bench", BENCH_ARENA_CAP)) {
        result = bench_rows(&bench, &ids);
        if (bench.common.json) {
            bench_print_json(&bench);
        } else {
            bench_print_results(&bench);
            bench_print_verdicts(&bench);
        }
        if (csv && !bench_write_csv(&bench, csv)) result = TOOL_ENVIRONMENT;
        arena_destroy(&bench.arena);
    }
    headless_close(&bench.headless);
    tool_end();
    return result;
}

const ToolCommand tool_bench = {"bench", "measure", bench_run};
