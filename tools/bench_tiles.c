// bench_tiles.c: experiment K2: side of a tile and range of depths, for the tiled paths.
// Data in: a level with many lights. Data out: times of the passes that make and use the lists,
// charts, verdicts. Does not: clusters.
//
// The finer culling of our own shaders (each subgroup against its tile's list) finds most of what
// the range of depths finds, and the source had none: the comparison is made with it off, and shown
// once more with it on.
#include "bench_frames.h"
#include "bench_table.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define LIGHTS 1000

// Passes by what they do.
#define WORDS_DOWN_SAMPLE "tile depth"
#define WORDS_LISTS       "list"
#define WORDS_SHADING     "lighting|forward"

static const RenderPath paths[2] = {PATH_TILED_FORWARD, PATH_TILED_DEFERRED};
static const u32 sides[3] = {TILE_16, TILE_32, TILE_64};

typedef struct TileCase {
    u32 path, side, depth; // indices into paths and sides; TileDepth
    bool subgroup_cull;
    f64 down_sample_ms, lists_cpu_ms, lists_ms, shading_ms, frame_ms, p10, p90;
    u32 longest;
} TileCase;
#define CASES_CAP 24

static u32 list_cases(TileCase *cases, bool quick) {
    u32 count = 0;
    for (u32 cull = 0; cull < 2; cull++)
        for (u32 path = 0; path < 2; path++)
            for (u32 side = 0; side < 3; side++)
                for (u32 depth = 0; depth < TILE_DEPTH_COUNT; depth++) {
                    if ((cull || quick) && sides[side] != TILE_32) continue;
                    cases[count++] = (TileCase){
                        .path = path, .side = side, .depth = depth, .subgroup_cull = cull};
                }
    LUZ_ASSERT(count <= CASES_CAP);
    return count;
}

static bool measure(Bench *bench, const char *id, TileCase *cases, u32 count, u32 width,
                    u32 height) {
    FrameBench run;
    if (!frame_bench_open(&run, bench, bench_level(bench, BENCH_LEVEL_HALL), width, height, 1))
        return false;
    FrameVariant variants[CASES_CAP] = {0};
    for (u32 v = 0; v < count; v++) {
        const TileCase *c = &cases[v];
        RenderSettings *settings = &variants[v].settings;
        *settings = frame_bench_settings(&run, paths[c->path], LIGHTS);
        frame_settings_every_light(settings);
        settings->tile_px = sides[c->side];
        settings->tile_depth = c->depth;
        settings->subgroup_cull = c->subgroup_cull;
        char path[20], depth[12];
        settings_word("path", settings->path, path, sizeof path);
        settings_word("tile_depth", settings->tile_depth, depth, sizeof depth);
        snprintf(variants[v].name, sizeof variants[v].name, "%s, %u px, %s%s", path,
                 settings_tile_px(settings), depth, c->subgroup_cull ? ", subgroups" : "");
    }
    FrameRounds rounds = {5, 31, 150, 0};
    if (bench->quick) rounds = (FrameRounds){2, 5, 6, 0};
    bool ok = frame_bench_measure(&run, variants, count, &rounds);
    for (u32 v = 0; ok && v < count; v++) {
        TileCase *c = &cases[v];
        c->down_sample_ms = frame_variant_pass_ms(&variants[v], WORDS_DOWN_SAMPLE);
        c->lists_cpu_ms = samples_percentile(&variants[v].grid_ms, 0.5);
        c->lists_ms = frame_variant_pass_ms(&variants[v], WORDS_LISTS);
        c->shading_ms = frame_variant_pass_ms(&variants[v], WORDS_SHADING);
        c->frame_ms = frame_variant_ms(&variants[v]);
        c->p10 = samples_percentile(&variants[v].times.frame_ms, 0.1);
        c->p90 = samples_percentile(&variants[v].times.frame_ms, 0.9);
        c->longest = variants[v].counts.cell_light_max;
        frame_variant_add(bench, id, &variants[v], c->frame_ms / frame_variant_ms(&variants[0]),
                          true);
    }
    frame_variants_free(variants, count);
    frame_bench_close(&run);
    return ok;
}

static const TileCase *find_case(const TileCase *cases, u32 count, u32 path, u32 side, u32 depth,
                                 bool subgroup_cull) {
    static const TileCase not_measured = {.frame_ms = NAN, .shading_ms = NAN};
    for (u32 i = 0; i < count; i++)
        if (cases[i].path == path && cases[i].side == side && cases[i].depth == depth &&
            cases[i].subgroup_cull == subgroup_cull)
            return &cases[i];
    return &not_measured;
}

static const char *path_word(u32 path) { return path ? "tiled_deferred" : "tiled_forward"; }

static bool k2_table(Bench *bench, const TileCase *cases, u32 count) {
    BenchTable table;
    bench_table_begin(&table, bench, "k2",
                      "path,tile px,depth,subgroups,down-sample ms,lists CPU ms,lists ms,shading "
                      "ms,frame ms,p10,p90,fps,frame gain,shading gain,longest list");
    for (u32 i = 0; i < count; i++) {
        const TileCase *c = &cases[i];
        const TileCase *off =
            find_case(cases, count, c->path, c->side, TILE_DEPTH_OFF, c->subgroup_cull);
        char depth[32];
        bench_text(&table, "%s", path_word(c->path));
        bench_number(&table, 8u << sides[c->side]);
        bench_text(&table, "%s", settings_word("tile_depth", c->depth, depth, sizeof depth));
        bench_text(&table, "%s", c->subgroup_cull ? "on" : "off");
        bench_number(&table, c->down_sample_ms);
        bench_number(&table, c->lists_cpu_ms);
        bench_number(&table, c->lists_ms);
        bench_number(&table, c->shading_ms);
        bench_number(&table, c->frame_ms);
        bench_number(&table, c->p10);
        bench_number(&table, c->p90);
        bench_number(&table, 1000.0 / MAX(c->frame_ms, 1e-3));
        bench_number(&table, off->frame_ms / c->frame_ms);
        bench_number(&table, c->shading_ms > 0.0 ? off->shading_ms / c->shading_ms : (f64)NAN);
        bench_number(&table, c->longest);
    }
    return bench_table_end(&table);
}

static bool k2_plot(Bench *bench, const TileCase *cases, u32 count) {
    static const char *const side_names[3] = {"16 px", "32 px", "64 px"};
    static const char *const depth_names[3] = {"off", "minmax", "mask"};
    f64 fps[2][3][3], shading[2][3][3]; // path, depth, side
    PlotChart charts[4] = {0};
    for (u32 path = 0; path < 2; path++)
        for (u32 depth = 0; depth < 3; depth++) {
            for (u32 side = 0; side < 3; side++) {
                const TileCase *c = find_case(cases, count, path, side, depth, false);
                fps[path][depth][side] = 1000.0 / c->frame_ms;
                shading[path][depth][side] = c->shading_ms;
            }
            for (u32 what = 0; what < 2; what++) {
                PlotChart *chart = &charts[path + what * 2];
                chart->kind = PLOT_BARS;
                chart->categories = side_names;
                chart->category_count = 3;
                chart->y_label = what ? "milliseconds" : "frames a second";
                chart->title = arena_format(&bench->arena, "%s%s: %s", what ? "" : "K2, ",
                                            path_word(path), what ? "shading" : "frames");
                PlotSeries *series = plot_add(chart, depth_names[depth]);
                series->y = what ? shading[path][depth] : fps[path][depth];
                series->count = 3;
            }
        }
    return bench_plot(bench, "k2", charts, 4, 2, 1400, 900);
}

bool bench_k2(Bench *bench, const char *id) {
    TileCase cases[CASES_CAP];
    u32 count = list_cases(cases, bench->quick);
    u32 width = bench->quick ? 320 : 1280, height = bench->quick ? 180 : 720;
    if (!measure(bench, id, cases, count, width, height)) return false;
    f64 lists_ms = 0.0;
    for (u32 path = 0; path < 2; path++) {
        const TileCase *off = find_case(cases, count, path, 1, TILE_DEPTH_OFF, false);
        const TileCase *minmax = find_case(cases, count, path, 1, TILE_DEPTH_MINMAX, false);
        bench_verdict(bench, id, off->frame_ms / minmax->frame_ms, BENCH_AT_LEAST, 1.28, "x",
                      "%s, 32 px, frame, depth off / minmax", path_word(path));
        bench_verdict(bench, id, off->shading_ms / minmax->shading_ms, BENCH_AT_LEAST, 1.8, "x",
                      "%s, 32 px, shading, depth off / minmax", path_word(path));
        lists_ms = MAX(lists_ms, off->lists_cpu_ms + off->lists_ms);
    }
    bench_verdict(bench, id, lists_ms, BENCH_AT_MOST, LIGHTS / 1000.0, " ms",
                  "lists of %u lights, 32 px", LIGHTS);
    return k2_table(bench, cases, count) && k2_plot(bench, cases, count);
}
