// bench.h: what the rows of `luz bench` are made of.
//
// A row measures variants of one thing: they run alternately, so that a slow moment of the machine
// hits all of them, and the table tells medians, the spread from p10 to p90, and ratios to the
// first variant. Experiments are rows that repeat a published one: they add a table of their own
// (bench_table.h), charts, and verdicts on what must show.
#ifndef LUZ_TOOL_BENCH_H
#define LUZ_TOOL_BENCH_H
#include "headless.h"

#define BENCH_RESULTS_CAP  1024
#define BENCH_VARIANTS_CAP 32
#define BENCH_VERDICTS_CAP 64

#define BENCH_LEVEL      "data/levels/cloister.toml"
#define BENCH_LEVEL_HALL "data/levels/hall.toml"

typedef struct BenchResult {
    char id[24], what[64];
    f64 median, p10, p90, ratio; // ratio 0: not one of several variants
    const char *unit;
    bool in_table; // of an experiment, which prints its own
} BenchResult;

// What a row must show, and whether it did. It is a report: a row that misses it is no failure.
typedef enum BenchWish { BENCH_AT_LEAST, BENCH_AT_MOST } BenchWish;
typedef struct BenchVerdict {
    char id[24], what[96];
    f64 measured, wanted; // measured NAN: could not be told
    BenchWish wish;
    const char *unit;
} BenchVerdict;

typedef struct Bench {
    ToolCommon common;
    bool quick;
    const char *level; // as asked, NULL = each row's own
    const char *scene; // NULL: row `atrium` is skipped
    const char *plots; // directory for charts and tables of experiments, or NULL
    Headless headless;
    bool has_device;
    Arena arena;     // reset before each row
    const char *row; // being measured
    bool in_experiment;
    BenchResult results[BENCH_RESULTS_CAP];
    u32 result_count;
    BenchVerdict verdicts[BENCH_VERDICTS_CAP];
    u32 verdict_count;
} Bench;

typedef enum BenchRowKind {
    BENCH_CPU,
    BENCH_GPU,        // draws
    BENCH_EXPERIMENT, // draws, takes minutes: only if asked for by name
} BenchRowKind;
typedef struct BenchRow {
    const char *id, *help;
    bool (*run)(Bench *bench, const char *id);
    BenchRowKind kind;
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
void bench_verdict(Bench *bench, const char *id, f64 measured, BenchWish wish, f64 wanted,
                   const char *unit, const char *format, ...) PRINTF_LIKE(7, 8);
static inline bool bench_verdict_ok(const BenchVerdict *verdict) {
    // NAN is neither.
    return verdict->wish == BENCH_AT_LEAST ? verdict->measured >= verdict->wanted
                                           : verdict->measured <= verdict->wanted;
}
// The level of a row: as asked, else its own.
static inline const char *bench_level(const Bench *bench, const char *own) {
    return bench->level ? bench->level : own;
}

// bench_output.c
void bench_print_results(const Bench *bench);
void bench_print_verdicts(const Bench *bench);
void bench_print_json(const Bench *bench);
bool bench_write_csv(const Bench *bench, const char *path);

bool bench_cull(Bench *bench, const char *id);
bool bench_grid(Bench *bench, const char *id);
bool bench_packet(Bench *bench, const char *id);
bool bench_level_load(Bench *bench, const char *id);
bool bench_cloister(Bench *bench, const char *id);
bool bench_paths(Bench *bench, const char *id);
bool bench_atrium(Bench *bench, const char *id);
bool bench_manager(Bench *bench, const char *id);
bool bench_claims(Bench *bench, const char *id);
// Experiments: bench_lights.c, bench_layouts.c, bench_stages.c, bench_tiles.c
bool bench_p1(Bench *bench, const char *id);
bool bench_p2(Bench *bench, const char *id);
bool bench_p3(Bench *bench, const char *id);
bool bench_k1(Bench *bench, const char *id);
bool bench_k2(Bench *bench, const char *id);
bool bench_k3(Bench *bench, const char *id);
#endif
