// bench.h: what the rows of `luz bench` are made of.
//
// A row measures variants of one thing: they run alternately, so that a slow moment of the machine
// hits all of them, and the table tells medians, the spread from p10 to p90, and ratios to the
// first variant.
#ifndef LUZ_TOOL_BENCH_H
#define LUZ_TOOL_BENCH_H
#include "headless.h"

#define BENCH_RESULTS_CAP  512
#define BENCH_VARIANTS_CAP 32

typedef struct BenchResult {
    char id[24], what[64];
    f64 median, p10, p90, ratio; // ratio 0: not one of several variants
    const char *unit;
} BenchResult;

typedef struct Bench {
    ToolCommon common;
    bool quick;
    const char *level, *scene; // scene NULL: row `atrium` is skipped
    Headless headless;
    bool has_device;
    Arena arena; // reset before each row
    BenchResult results[BENCH_RESULTS_CAP];
    u32 result_count;
} Bench;

typedef struct BenchRow {
    const char *id, *help;
    bool (*run)(Bench *bench, const char *id);
    bool needs_gpu;
} BenchRow;

// Milliseconds of one run.
typedef f64 (*BenchFunction)(void *context);
typedef struct BenchVariant {
    char name[64];
    BenchFunction function;
    void *context;
    Samples samples;
} BenchVariant;

// Runs the variants alternately, `rounds` times after one warm-up round, and adds a result each.
void bench_variants(Bench *bench, const char *id, BenchVariant *variants, u32 count, u32 rounds);
void bench_add(Bench *bench, const char *id, const char *what, Samples *samples, const char *unit,
               f64 ratio);

bool bench_cull(Bench *bench, const char *id);
bool bench_grid(Bench *bench, const char *id);
bool bench_packet(Bench *bench, const char *id);
bool bench_level_load(Bench *bench, const char *id);
bool bench_cloister(Bench *bench, const char *id);
bool bench_paths(Bench *bench, const char *id);
bool bench_atrium(Bench *bench, const char *id);
#endif
