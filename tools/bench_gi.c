// bench_gi.c: experiments V1 to V4 and V7: what the steps of global illumination cost, by scene,
// size of the grid, resolution, step of the cones and number of lights, and the memory it takes.
// Data in: levels. Data out: tables, charts, verdicts. Does not: look at pictures
// (bench_gi_pictures.c).
#include "bench_gi.h"
#include <math.h>
#include <stdio.h>

#define SETS_EVERY_FRAME "gi.policy=every_frame"

static FrameRounds rounds_of(const Bench *bench, f64 budget_s) {
    return bench->quick ? (FrameRounds){2, 2, 5, 0} : (FrameRounds){3, 15, budget_s, 0};
}

static void add_results(Bench *bench, const char *id, GiVariant *variants, u32 count) {
    for (u32 v = 0; v < count; v++)
        frame_variant_add(bench, id, &variants[v].frame,
                          variants[v].frame_ms / variants[0].frame_ms, true);
}

// Columns of a table: what comes before them, then every step, the sum of an update, the frame.
static void steps_table_begin(BenchTable *table, Bench *bench, const char *name,
                              const char *before) {
    char columns[1024];
    u64 used = (u64)snprintf(columns, sizeof columns, "%s", before);
    for (u32 s = 0; s < GI_STEP_COUNT; s++)
        used += (u64)snprintf(columns + used, sizeof columns - used, ",%s ms", gi_step_titles[s]);
    snprintf(columns + used, sizeof columns - used, ",dynamic total ms,frame ms,voxels,MiB");
    bench_table_begin(table, bench, name, columns);
}

static void steps_row(BenchTable *table, const GiVariant *variant) {
    for (u32 s = 0; s < GI_STEP_COUNT; s++) bench_number(table, variant->steps[s]);
    bench_number(table, variant->update_ms + variant->steps[GI_STEP_trace]);
    bench_number(table, variant->frame_ms);
    bench_number(table, variant->stats.gi_voxels);
    bench_number(table, (f64)variant->bytes / (f64)MIB(1));
}

// --- V1, V2 ---

#define SCENES_CAP 6
static u32 list_scenes(const Bench *bench, GiScene *out) {
    u32 count = 0;
    if (bench->level) {
        out[count++] = (GiScene){"level", bench->level, NULL};
        return count;
    }
    out[count++] = (GiScene)GI_SCENE_CORNELL;
    out[count++] = (GiScene){"cornell_empty", "data/levels/cornell_empty.toml", NULL};
    out[count++] = (GiScene){"light_box", "data/levels/light_box.toml", NULL};
    out[count++] = (GiScene){"cloister", BENCH_LEVEL, NULL};
    if (bench->scene) out[count++] = (GiScene){"atrium", bench->scene, NULL};
    return count;
}

bool bench_gi_v1(Bench *bench, const char *id) {
    GiScene scenes[SCENES_CAP];
    GiVariant variants[SCENES_CAP] = {0};
    u32 count = list_scenes(bench, scenes), grid = bench->quick ? 64 : 256;
    u32 width = bench->quick ? 320 : 1280, height = bench->quick ? 180 : 720;
    char sets[64];
    snprintf(sets, sizeof sets, SETS_EVERY_FRAME ",gi.grid=%u", grid);
    bool ok = true;
    for (u32 i = 0; ok && i < count; i++) {
        GiBench run;
        variants[i] = gi_variant("thesis", sets, "%s, %u", scenes[i].name, grid);
        FrameRounds rounds = rounds_of(bench, 40);
        if (!gi_bench_open(&run, bench, &scenes[i], width, height, 1)) return false;
        ok = gi_bench_measure(&run, &variants[i], 1, &rounds);
        gi_bench_close(&run);
    }
    if (ok) {
        add_results(bench, id, variants, count);
        BenchTable table;
        steps_table_begin(&table, bench, "v1", "scene,grid");
        const char *names[SCENES_CAP];
        PlotChart chart = {.kind = PLOT_BARS,
                           .title = "V1: steps by scene",
                           .y_label = "milliseconds",
                           .y_log = true,
                           .categories = gi_step_titles,
                           .category_count = GI_STEP_COUNT};
        for (u32 i = 0; i < count; i++) {
            names[i] = scenes[i].name;
            bench_text(&table, "%s", names[i]);
            bench_number(&table, grid);
            steps_row(&table, &variants[i]);
            PlotSeries *series = plot_add(&chart, names[i]);
            series->y = variants[i].steps;
            series->count = GI_STEP_COUNT;
        }
        ok = bench_table_end(&table) && bench_plot(bench, "v1", &chart, 1, 1, 1800, 700);
    }
    gi_variants_free(variants, count);
    return ok;
}

bool bench_gi_v2(Bench *bench, const char *id) {
    static const u32 grids[] = {64, 128, 256, 512};
    GiScene scene = GI_SCENE_CORNELL;
    if (bench->level || bench->scene)
        scene = (GiScene){"scene", bench->level ? bench->level : bench->scene, NULL};
    u32 count = bench->quick ? 2 : COUNT_OF(grids), width = bench->quick ? 320 : 1280,
        height = bench->quick ? 180 : 720;
    GiVariant variants[COUNT_OF(grids)] = {0};
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, width, height, count)) return false;
    bool ok = true;
    f64 x[COUNT_OF(grids)], cones[COUNT_OF(grids)], update[COUNT_OF(grids)];
    for (u32 i = 0; ok && i < count; i++) {
        char sets[96];
        // The largest fits no device's buffers in halves.
        snprintf(sets, sizeof sets, SETS_EVERY_FRAME ",gi.grid=%u%s", grids[i],
                 grids[i] == 512 ? ",gi.format=byte" : "");
        variants[i] = gi_variant("thesis", sets, "%s, %u", scene.name, grids[i]);
        FrameRounds rounds = rounds_of(bench, 40);
        // One after another: two of the largest do not fit beside each other.
        ok = gi_bench_measure(&run, &variants[i], 1, &rounds);
        x[i] = grids[i];
        cones[i] = variants[i].steps[GI_STEP_trace];
        update[i] = variants[i].update_ms;
    }
    gi_bench_close(&run);
    if (ok) {
        add_results(bench, id, variants, count);
        BenchTable table;
        steps_table_begin(&table, bench, "v2", "grid,cones growth,update growth");
        for (u32 i = 0; i < count; i++) {
            bench_number(&table, grids[i]);
            bench_number(&table, i ? cones[i] / cones[i - 1] : (f64)NAN);
            bench_number(&table, i ? update[i] / update[i - 1] : (f64)NAN);
            steps_row(&table, &variants[i]);
        }
        PlotChart chart = {.title = "V2: size of the grid",
                           .x_label = "voxels along a side",
                           .y_label = "milliseconds",
                           .x_log = true,
                           .y_log = true,
                           .x_ticks = x,
                           .x_tick_count = count};
        PlotSeries *series = plot_add(&chart, "cones");
        series->x = x, series->y = cones, series->count = count;
        series = plot_add(&chart, "update of the voxels");
        series->x = x, series->y = update, series->count = count;
        ok = bench_table_end(&table) && bench_plot(bench, "v2", &chart, 1, 1, 960, 600);
        // Empty space costs little: less than the eightfold of the number of voxels.
        for (u32 i = 1; ok && i < count; i++)
            bench_verdict(bench, id, update[i] / update[i - 1], BENCH_AT_MOST, 8.0, "x",
                          "update at %u / at %u voxels a side", grids[i], grids[i - 1]);
    }
    gi_variants_free(variants, count);
    return ok;
}

// --- V3 ---

bool bench_gi_v3(Bench *bench, const char *id) {
    static const f64 factors[] = {0.1, 0.25, 0.5, 2.5};
    static const f64 published[] = {29.8, 12.9, 7.0, 2.8}; // ms at 1280x720
    const f64 published_large = 16.7;                      // at 1920x1080, factor 0.5
    const u32 sizes[2][2] = {{bench->quick ? 320 : 1280, bench->quick ? 180 : 720},
                             {bench->quick ? 480 : 1920, bench->quick ? 270 : 1080}};
    u32 count = 2 * COUNT_OF(factors);
    GiScene scene = GI_SCENE_CORNELL;
    if (bench->level || bench->scene)
        scene = (GiScene){"scene", bench->level ? bench->level : bench->scene, NULL};
    GiVariant variants[2 * COUNT_OF(factors)] = {0};
    for (u32 v = 0; v < count; v++) {
        const u32 *size = sizes[v / COUNT_OF(factors)];
        f64 factor = factors[v % COUNT_OF(factors)];
        char sets[64];
        snprintf(sets, sizeof sets, "gi.step_factor=%g", factor);
        variants[v] = gi_variant("thesis", sets, "%ux%u, step %g", size[0], size[1], factor);
        variants[v].frame.width_px = size[0];
        variants[v].frame.height_px = size[1];
    }
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, sizes[0][0], sizes[0][1], 1)) return false;
    FrameRounds rounds = rounds_of(bench, 150);
    bool ok = gi_bench_measure(&run, variants, count, &rounds);
    gi_bench_close(&run);
    if (ok) {
        add_results(bench, id, variants, count);
        BenchTable table;
        bench_table_begin(&table, bench, "v3",
                          "width,height,step factor,cones ms,of step 0.5,published of step 0.5");
        f64 y[2][COUNT_OF(factors)];
        for (u32 v = 0; v < count; v++) {
            u32 f = v % COUNT_OF(factors), half = v - f + 2;
            f64 ms = variants[v].steps[GI_STEP_trace], base = variants[half].steps[GI_STEP_trace];
            y[v / COUNT_OF(factors)][f] = ms;
            bench_number(&table, variants[v].frame.width_px);
            bench_number(&table, variants[v].frame.height_px);
            bench_number(&table, factors[f]);
            bench_number(&table, ms);
            bench_number(&table, ms / base);
            bench_number(&table, published[f] / published[2]);
        }
        bench_verdict(bench, id, y[1][2] / y[0][2], BENCH_AT_MOST, published_large / published[2],
                      "x", "cones at 2.25 times the pixels, step 0.5");
        for (u32 f = 0; f < COUNT_OF(factors); f++)
            if (f != 2)
                bench_verdict(bench, id, y[0][f] / y[0][2], BENCH_AT_MOST,
                              published[f] / published[2], "x", "cones, step %g / step 0.5",
                              factors[f]);
        PlotChart chart = {.title = "V3: resolution and step of the cones",
                           .x_label = "step factor",
                           .y_label = "cones, milliseconds",
                           .x_log = true,
                           .y_log = true,
                           .x_ticks = factors,
                           .x_tick_count = COUNT_OF(factors)};
        for (u32 s = 0; s < 2; s++) {
            PlotSeries *series =
                plot_add(&chart, arena_format(&bench->arena, "%ux%u", sizes[s][0], sizes[s][1]));
            series->x = factors, series->y = y[s], series->count = COUNT_OF(factors);
        }
        ok = bench_table_end(&table) && bench_plot(bench, "v3", &chart, 1, 1, 960, 600);
    }
    gi_variants_free(variants, count);
    return ok;
}

// --- V4 ---

static void prepare_rays(Session *session, const GiVariant *variant) {
    LightTable *lights = WORLD_TABLE(session->world, Light, light);
    for (u32 row = 0; row < lights->table.count; row++) {
        if (lights->voxel_shadow[row] == variant->choice) continue;
        lights->voxel_shadow[row] = variant->choice;
        table_touch(&lights->table, row);
    }
}

bool bench_gi_v4(Bench *bench, const char *id) {
    static const u32 counts[] = {1, 16, 256};
    enum { COUNTS = COUNT_OF(counts) };
    GiScene scene = {"hall", bench_level(bench, BENCH_LEVEL_HALL), NULL};
    if (bench->scene) scene = (GiScene){"scene", bench->scene, NULL};
    GiVariant variants[2 * COUNTS] = {0};
    for (u32 v = 0; v < 2 * COUNTS; v++) {
        bool rays = v >= COUNTS;
        char sets[96];
        snprintf(sets, sizeof sets, SETS_EVERY_FRAME ",gi.grid=%u,light_limit=%u",
                 bench->quick ? 64 : 128, counts[v % COUNTS]);
        variants[v] = gi_variant("thesis", sets, "%u lights, %s", counts[v % COUNTS],
                                 rays ? "rays" : "no rays");
        variants[v].prepare = prepare_rays;
        variants[v].choice = rays ? 1 + VOXEL_SHADOW_RAY : 1 + VOXEL_SHADOW_NONE;
    }
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, 320, 180, 1)) return false;
    FrameRounds rounds = rounds_of(bench, 60);
    bool ok = gi_bench_measure(&run, variants, 2 * COUNTS, &rounds);
    gi_bench_close(&run);
    if (ok) {
        add_results(bench, id, variants, 2 * COUNTS);
        BenchTable table;
        bench_table_begin(&table, bench, "v4",
                          "lights,lights in lists,shade ms,shade with rays ms,rays / none");
        f64 x[COUNTS], y[2][COUNTS];
        for (u32 i = 0; i < COUNTS; i++) {
            x[i] = counts[i];
            y[0][i] = variants[i].steps[GI_STEP_shade];
            y[1][i] = variants[COUNTS + i].steps[GI_STEP_shade];
            bench_number(&table, counts[i]);
            bench_number(&table, variants[i].frame.counts.gi_light_indices);
            bench_number(&table, y[0][i]);
            bench_number(&table, y[1][i]);
            bench_number(&table, y[1][i] / y[0][i]);
        }
        for (u32 r = 0; r < 2; r++)
            bench_verdict(bench, id, y[r][2] / y[r][0], BENCH_AT_MOST, 256.0 / 4.0, "x",
                          "shading of voxels, 256 lights / 1 light, %s", r ? "rays" : "no rays");
        PlotChart chart = {.title = "V4: shading of voxels",
                           .x_label = "lights",
                           .y_label = "milliseconds",
                           .x_log = true,
                           .y_log = true,
                           .x_ticks = x,
                           .x_tick_count = COUNTS};
        for (u32 r = 0; r < 2; r++) {
            PlotSeries *series = plot_add(&chart, r ? "with rays" : "without");
            series->x = x, series->y = y[r], series->count = COUNTS;
        }
        ok = bench_table_end(&table) && bench_plot(bench, "v4", &chart, 1, 1, 960, 600);
    }
    gi_variants_free(variants, 2 * COUNTS);
    return ok;
}

// --- V7 ---

// What the renderer keeps for the voxels, by resource; what is small is summed up.
static void v7_parts(BenchTable *table, u32 grid, const char *format, const char *faces,
                     const Bench *bench) {
    RendererGiPart parts[32];
    u32 count = renderer_gi_parts(bench->headless.renderer, parts, COUNT_OF(parts));
    f64 rest = 0.0;
    for (u32 i = 0; i <= count; i++) {
        f64 mb = i < count ? (f64)parts[i].bytes / 1e6 : rest;
        if (i < count && mb < 0.5) {
            rest += mb;
            continue;
        }
        bench_number(table, grid);
        bench_text(table, "%s", format);
        bench_text(table, "%s", faces);
        bench_text(table, "%s", i < count ? parts[i].name : "others");
        bench_number(table, mb);
    }
}

bool bench_gi_v7(Bench *bench, const char *id) {
    static const u32 grids[] = {64, 128, 256, 512};
    static const f64 published[] = {216.7, 253.0, 540.3, 2800.0}; // MB
    static const f64 wanted[] = {1.0, 1.0, 0.6, 0.4};
    // Faces apart at 512 is left out: an atlas of the full size takes 3.7 GB in bytes, 7.4 in
    // halves, and the software driver has no room for it.
    static const char *const kinds[][2] = {
        {"half", "shared"}, {"byte", "shared"}, {"half", "apart"}, {"byte", "apart"}};
    enum { GRIDS = COUNT_OF(grids), KINDS = COUNT_OF(kinds), SHARED = 2 };
    GiScene scene = GI_SCENE_CORNELL;
    if (bench->level || bench->scene)
        scene = (GiScene){"scene", bench->level ? bench->level : bench->scene, NULL};
    GiBench run;
    if (!gi_bench_open(&run, bench, &scene, 64, 36, KINDS * GRIDS)) return false;
    BenchTable table, parts;
    bench_table_begin(&table, bench, "v7", "grid,format,faces,MB,published MB,share,voxels,drawn");
    bench_table_begin(&parts, bench, "v7_parts", "grid,format,faces,resource,MB");
    f64 x[GRIDS], y[KINDS + 1][GRIDS];
    bool ok = true;
    u32 count = bench->quick ? 3 : GRIDS;
    for (u32 i = 0; ok && i < count; i++) {
        x[i] = grids[i];
        y[KINDS][i] = published[i];
        for (u32 f = 0; f < KINDS; f++) y[f][i] = (f64)NAN;
        for (u32 f = 0; ok && f < (grids[i] < 512 ? KINDS : SHARED); f++) {
            const char *format = kinds[f][0], *faces = kinds[f][1];
            char sets[96];
            snprintf(sets, sizeof sets, "gi.grid=%u,gi.format=%s,gi.faces=%s,gi.bounces=1",
                     grids[i], format, faces);
            // One bounce: memory is the same, and large grids take their time.
            GiVariant variant = gi_variant("thesis", sets, "%u, %s, %s", grids[i], format, faces);
            ok = gi_bench_picture(&run, &variant, NULL, NULL);
            variant.stats = renderer_stats(bench->headless.renderer);
            variant.bytes = variant.stats.gi_bytes;
            // No room: drawn without global illumination, and it then holds nothing.
            y[f][i] = variant.bytes ? (f64)variant.bytes / 1e6 : (f64)NAN;
            bench_number(&table, grids[i]);
            bench_text(&table, "%s", format);
            bench_text(&table, "%s", faces);
            bench_number(&table, y[f][i]);
            bench_number(&table, published[i]);
            bench_number(&table, y[f][i] / published[i]);
            bench_number(&table, variant.stats.gi_voxels);
            bench_text(&table, "%s", variant.bytes ? "yes" : "no room");
            v7_parts(&parts, grids[i], format, faces, bench);
            gi_variants_free(&variant, 1);
        }
        // The published volumes are bytes.
        bench_verdict(bench, id, y[1][i] / published[i], BENCH_AT_MOST, wanted[i], "",
                      "memory at %u, format byte, of the published %g MB", grids[i], published[i]);
        if (i < 3)
            bench_verdict(bench, id, y[0][i] / published[i], BENCH_AT_MOST, wanted[i], "",
                          "memory at %u, format half, of the published %g MB", grids[i],
                          published[i]);
    }
    gi_bench_close(&run);
    PlotChart chart = {.title = "V7: memory",
                       .x_label = "voxels along a side",
                       .y_label = "MB",
                       .x_log = true,
                       .y_log = true,
                       .x_ticks = x,
                       .x_tick_count = count};
    static const char *const names[] = {"half", "byte", "half, faces apart", "byte, faces apart",
                                        "published"};
    for (u32 s = 0; s < KINDS + 1; s++) {
        PlotSeries *series = plot_add(&chart, names[s]);
        series->x = x, series->y = y[s], series->count = count;
    }
    ok = bench_table_end(&table) && bench_table_end(&parts) && ok;
    return ok && bench_plot(bench, "v7", &chart, 1, 1, 960, 600);
}
