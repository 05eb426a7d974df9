// bench_layouts.c: experiment P2: what the layouts of the G-buffer cost.
// Data in: the renderer's table of layouts, a level. Data out: bytes a pixel and in all by screen
// size, the G-buffer pass at two sizes. Does not: what a layout loses (the golden tests measure
// it).
#include "bench_frames.h"
#include "bench_table.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const u32 screen_sizes[][2] = {
    {800, 600}, {1024, 768}, {1280, 960}, {1600, 1200}, {2048, 1536}};
#define SIZE_COUNT COUNT_OF(screen_sizes)

typedef struct LayoutCost {
    RendererLayoutInfo info;
    f64 mib[SIZE_COUNT];
    f64 pass_ms[2], frame_ms[2];
} LayoutCost;

static bool measure(Bench *bench, const char *id, LayoutCost costs[LAYOUT_COUNT],
                    const u32 sizes[2][2]) {
    FrameBench run;
    if (!frame_bench_open(&run, bench, bench_level(bench, BENCH_LEVEL), sizes[0][0], sizes[0][1],
                          2))
        return false;
    FrameRounds rounds = {5, 31, 40, 0};
    if (bench->quick) rounds = (FrameRounds){3, 5, 3, 0};
    bool ok = true;
    for (u32 size = 0; ok && size < 2; size++) {
        FrameVariant variants[LAYOUT_COUNT] = {0};
        for (u32 v = 0; v < LAYOUT_COUNT; v++) {
            variants[v].settings = frame_settings_direct();
            variants[v].settings.layout = v;
            variants[v].width_px = sizes[size][0];
            variants[v].height_px = sizes[size][1];
            snprintf(variants[v].name, sizeof variants[v].name, "%ux%u, %s", sizes[size][0],
                     sizes[size][1], costs[v].info.name);
        }
        ok = frame_bench_measure(&run, variants, LAYOUT_COUNT, &rounds);
        for (u32 v = 0; ok && v < LAYOUT_COUNT; v++) {
            costs[v].pass_ms[size] = frame_variant_pass_ms(&variants[v], "gbuffer");
            costs[v].frame_ms[size] = frame_variant_ms(&variants[v]);
            frame_variant_add(bench, id, &variants[v],
                              costs[v].frame_ms[size] / costs[0].frame_ms[size], true);
        }
        frame_variants_free(variants, LAYOUT_COUNT);
    }
    frame_bench_close(&run);
    return ok;
}

static bool p2_table(Bench *bench, const LayoutCost *costs, const u32 sizes[2][2]) {
    const RendererLayoutInfo *wide = &costs[LAYOUT_WIDE].info;
    char columns[512];
    u64 used =
        (u64)snprintf(columns, sizeof columns, "layout,B/px,position+normal B/px,of wide %%");
    for (u32 i = 0; i < SIZE_COUNT; i++)
        used += (u64)snprintf(columns + used, sizeof columns - used, ",%ux%u MiB",
                              screen_sizes[i][0], screen_sizes[i][1]);
    for (u32 i = 0; i < 2; i++)
        used +=
            (u64)snprintf(columns + used, sizeof columns - used, ",pass ms %ux%u,frame ms %ux%u",
                          sizes[i][0], sizes[i][1], sizes[i][0], sizes[i][1]);
    BenchTable table;
    bench_table_begin(&table, bench, "p2", columns);
    for (u32 v = 0; v < LAYOUT_COUNT; v++) {
        const LayoutCost *cost = &costs[v];
        bench_text(&table, "%s", cost->info.name);
        bench_number(&table, cost->info.bytes);
        bench_number(&table, cost->info.position_normal_bytes);
        bench_number(&table,
                     100.0 * cost->info.position_normal_bytes / wide->position_normal_bytes);
        for (u32 i = 0; i < SIZE_COUNT; i++) bench_number(&table, cost->mib[i]);
        for (u32 i = 0; i < 2; i++) {
            bench_number(&table, cost->pass_ms[i]);
            bench_number(&table, cost->frame_ms[i]);
        }
    }
    return bench_table_end(&table);
}

static bool p2_plot(Bench *bench, const LayoutCost *costs, const u32 sizes[2][2]) {
    const char *names[LAYOUT_COUNT], *size_names[SIZE_COUNT];
    f64 all[LAYOUT_COUNT], part[LAYOUT_COUNT], ms[2][LAYOUT_COUNT];
    for (u32 v = 0; v < LAYOUT_COUNT; v++) {
        names[v] = costs[v].info.name;
        all[v] = costs[v].info.bytes;
        part[v] = costs[v].info.position_normal_bytes;
        for (u32 i = 0; i < 2; i++) ms[i][v] = costs[v].pass_ms[i];
    }
    PlotChart charts[3] = {
        {.kind = PLOT_BARS,
         .title = "P2: bytes a pixel, without the depth buffer",
         .y_label = "bytes"},
        {.kind = PLOT_BARS, .title = "Size of the G-buffer", .y_label = "MiB"},
        {.kind = PLOT_BARS, .title = "G-buffer pass", .y_label = "milliseconds"}};
    *plot_add(&charts[0], "all") = (PlotSeries){.name = "all", .y = all, .count = LAYOUT_COUNT};
    *plot_add(&charts[0], "") =
        (PlotSeries){.name = "position, normal", .y = part, .count = LAYOUT_COUNT};
    for (u32 i = 0; i < SIZE_COUNT; i++)
        size_names[i] =
            arena_format(&bench->arena, "%ux%u", screen_sizes[i][0], screen_sizes[i][1]);
    for (u32 v = 0; v < LAYOUT_COUNT; v++) {
        PlotSeries *series = plot_add(&charts[1], names[v]);
        series->y = costs[v].mib;
        series->count = SIZE_COUNT;
    }
    for (u32 i = 0; i < 2; i++) {
        PlotSeries *series =
            plot_add(&charts[2], arena_format(&bench->arena, "%ux%u", sizes[i][0], sizes[i][1]));
        series->y = ms[i];
        series->count = LAYOUT_COUNT;
    }
    for (u32 i = 0; i < 3; i++) {
        charts[i].categories = i == 1 ? size_names : names;
        charts[i].category_count = i == 1 ? SIZE_COUNT : LAYOUT_COUNT;
    }
    return bench_plot(bench, "p2", charts, 3, 1, 1000, 1350);
}

bool bench_p2(Bench *bench, const char *id) {
    static const u32 full[2][2] = {{640, 360}, {1280, 720}}, small[2][2] = {{160, 90}, {320, 180}};
    LayoutCost costs[LAYOUT_COUNT] = {0};
    for (u32 v = 0; v < LAYOUT_COUNT; v++) {
        costs[v].info = renderer_layout_info((GbufferLayout)v);
        for (u32 i = 0; i < SIZE_COUNT; i++)
            costs[v].mib[i] =
                (f64)costs[v].info.bytes * screen_sizes[i][0] * screen_sizes[i][1] / MIB(1);
    }
    const u32(*sizes)[2] = bench->quick ? small : full;
    if (!measure(bench, id, costs, sizes)) return false;
    bench_verdict(bench, id,
                  100.0 * costs[LAYOUT_PACKED].info.position_normal_bytes /
                      costs[LAYOUT_WIDE].info.position_normal_bytes,
                  BENCH_AT_MOST, 17.0, " %", "position and normal, packed against wide");
    bench_verdict(bench, id, LAYOUT_COUNT, BENCH_AT_LEAST, 8, "", "layouts in the table");
    return p2_table(bench, costs, sizes) && p2_plot(bench, costs, sizes);
}
