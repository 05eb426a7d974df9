// bench.c: `luz bench`: the measurements that the engine is judged by.
// Data in: row ids. Data out: a table on stdout, CSV or JSON. Rows: bench_cpu.c, bench_gpu.c.
// Does not: compare with another day's numbers; the CSV is for that.
#include "bench.h"
#include "../engine/base/file.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BENCH_ARENA_CAP GIB(4)

static const BenchRow rows[] = {
    {"cull", "frustum culling of 100,000 spheres, against a naive loop", bench_cull, false},
    {"grid", "light lists of 1,000 and 10,000 lights at 1280x720", bench_grid, false},
    {"packet", "a frame packet of the level, by part", bench_packet, false},
    {"level_load", "loading the level, with its models and textures", bench_level_load, false},
    {"cloister", "the level at 640x360, tiled_deferred: frame, CPU, passes", bench_cloister, true},
    {"paths", "the three paths under several light limits at 640x360", bench_paths, true},
    {"atrium", "the --scene at 1280x720: frame, CPU, passes", bench_atrium, true},
};

void bench_add(Bench *bench, const char *id, const char *what, Samples *samples, const char *unit,
               f64 ratio) {
    LUZ_ASSERT(bench->result_count < BENCH_RESULTS_CAP);
    BenchResult *result = &bench->results[bench->result_count++];
    *result = (BenchResult){.unit = unit, .ratio = ratio};
    snprintf(result->id, sizeof result->id, "%s", id);
    snprintf(result->what, sizeof result->what, "%s", what);
    result->median = samples_percentile(samples, 0.5);
    result->p10 = samples_percentile(samples, 0.1);
    result->p90 = samples_percentile(samples, 0.9);
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

// --- output ---

static void print_table(const Bench *bench) {
    printf("%-10s  %-34s  %10s  %10s  %10s  %-4s  %s\n", "row", "what", "median", "p10", "p90",
           "unit", "ratio");
    const char *last = "";
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        printf("%-10s  %-34s  %10.4g  %10.4g  %10.4g  %-4s", strcmp(last, r->id) ? r->id : "",
               r->what, r->median, r->p10, r->p90, r->unit);
        if (r->ratio > 0.0) printf("  %.2f", r->ratio);
        putchar('\n');
        last = r->id;
    }
}

static void print_json(const Bench *bench) {
    Json json = json_begin();
    json_open_object(&json, NULL);
    json_text(&json, "build", luz_build_id);
    json_text(&json, "device", bench->has_device ? bench->headless.device : "");
    json_open_array(&json, "results");
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        json_open_flat_object(&json, NULL);
        json_text(&json, "row", r->id);
        json_text(&json, "what", r->what);
        json_f64(&json, "median", r->median);
        json_f64(&json, "p10", r->p10);
        json_f64(&json, "p90", r->p90);
        json_text(&json, "unit", r->unit);
        if (r->ratio > 0.0) json_f64(&json, "ratio", r->ratio);
        json_close(&json);
    }
    json_close(&json);
    json_close(&json);
    json_print(&json);
    json_free(&json);
}

static bool write_csv(const Bench *bench, const char *path) {
    u64 cap = 256 + (u64)bench->result_count * 256, used = 0;
    char *text = malloc(cap);
    LUZ_ASSERT(text);
    used += (u64)snprintf(text, cap, "row,what,median,p10,p90,unit,ratio\n");
    for (u32 i = 0; i < bench->result_count; i++) {
        const BenchResult *r = &bench->results[i];
        used += (u64)snprintf(text + used, cap - used, "%s,\"%s\",%.6g,%.6g,%.6g,%s,%.4g\n", r->id,
                              r->what, r->median, r->p10, r->p90, r->unit, r->ratio);
    }
    bool ok = file_write(path, text, used);
    free(text);
    return ok;
}

// --- the command ---

static const BenchRow *find_row(const char *id) {
    const char *names[COUNT_OF(rows)];
    for (u32 i = 0; i < COUNT_OF(rows); i++) {
        names[i] = rows[i].id;
        if (strcmp(id, rows[i].id) == 0) return &rows[i];
    }
    const char *near = tool_suggest(id, names, COUNT_OF(names));
    tool_fail(0, "bench", near ? "unknown row '%s'; did you mean '%s'?" : "unknown row '%s'", id,
              near);
    return NULL;
}

static int bench_row(Bench *bench, const BenchRow *row, bool asked) {
    if (strcmp(row->id, "atrium") == 0 && !bench->scene)
        return asked ? tool_fail(TOOL_USAGE, "bench", "row atrium needs --scene FILE") : TOOL_OK;
    if (row->needs_gpu && !bench->has_device) {
        bench->has_device = headless_open(&bench->headless, &bench->common);
        if (!bench->has_device) return TOOL_ENVIRONMENT;
    }
    arena_reset(&bench->arena);
    return row->run(bench, row->id) ? TOOL_OK : TOOL_DIFFERENT;
}

static int bench_rows(Bench *bench, const ToolList *ids) {
    int result = TOOL_OK;
    for (u32 i = 0; i < ids->count; i++)
        if (!find_row(ids->items[i])) return TOOL_USAGE;
    for (u32 i = 0; i < COUNT_OF(rows); i++) {
        bool asked = false;
        for (u32 k = 0; k < ids->count; k++) asked |= strcmp(ids->items[k], rows[i].id) == 0;
        if (ids->count && !asked) continue;
        int one = bench_row(bench, &rows[i], asked);
        result = MAX(result, one);
    }
    return result;
}

static int bench_run(int argc, char **argv) {
    static Bench bench;
    bench = (Bench){.level = "data/levels/cloister.toml"};
    const char *csv = NULL;
    const ToolOption options[] = {
        {"quick", 0, OPTION_FLAG, &bench.quick, NULL, "fewer rounds: a look, not a measurement"},
        {"level", 0, OPTION_TEXT, &bench.level, "LEVEL",
         "for packet, level_load, cloister and paths;\ndefault data/levels/cloister.toml"},
        {"scene", 0, OPTION_TEXT, &bench.scene, "FILE", "a level or model for row atrium"},
        {"csv", 0, OPTION_TEXT, &csv, "FILE", "the table as CSV"},
    };
    char about[2048];
    u64 used =
        (u64)snprintf(about, sizeof about,
                      "Measures. Variants of a row run alternately; numbers are medians with p10 "
                      "and p90,\nratios are to the row's first variant. Rows (default: all):\n");
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
                    "  luz bench --csv bench.csv\n",
    };
    ToolList ids;
    ToolParse parsed = tool_parse(&spec, argc, argv, &bench.common, &ids);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    tool_begin(&bench.common);
    int result = TOOL_ENVIRONMENT;
    if (arena_create(&bench.arena, "bench", BENCH_ARENA_CAP)) {
        result = bench_rows(&bench, &ids);
        if (bench.common.json)
            print_json(&bench);
        else if (bench.result_count)
            print_table(&bench);
        if (csv && !write_csv(&bench, csv)) result = TOOL_ENVIRONMENT;
        arena_destroy(&bench.arena);
    }
    headless_close(&bench.headless);
    tool_end();
    return result;
}

const ToolCommand tool_bench = {"bench", "measure", bench_run};
