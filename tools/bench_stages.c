// bench_stages.c: rows about the light manager: P3 (each stage's gain and error), manager (its time
// on one core).
// Data in: two levels. Data out: tables, charts, verdicts. Does not: know how a stage decides.
#include "bench_stages.h"
#include "../engine/base/jobs.h"
#include "../engine/capture/image_compare.h"
#include "../engine/systems/light_manager.h"
#include "bench_frames.h"
#include "bench_table.h"
#include <stdio.h>
#include <string.h>

// --- manager ---

enum { PART_LIGHTS, PART_LISTS, PART_PACKET, PART_TICK, PART_DECISION_TICK, PART_COUNT };
typedef struct ManagerRun {
    const char *name;
    u32 level; // 0 the cloister (1,171 lights), 1 the hall (10,000)
    bool manager;
    u32 grid;
    Samples parts[PART_COUNT];
    u32 shaded;
} ManagerRun;

static bool manager_frames(Session *session, ManagerRun *run, u32 frames) {
    SessionView view = {.camera = headless_camera(session, NULL),
                        .settings = settings_default(),
                        .width_px = 1280,
                        .height_px = 720};
    view.settings.path = PATH_TILED_DEFERRED;
    view.settings.manager = run->manager;
    view.settings.grid = run->grid;
    for (u32 i = 0; i < frames; i++) {
        session_tick(session, (Input){0});
        session_frame_begin(session);
        const Packet *packet = session_packet(session, &view);
        if (!packet) return false;
        const PacketBuildTimes *times = &session->packet_times;
        samples_add(&run->parts[PART_LIGHTS], (f64)times->lights_ms);
        samples_add(&run->parts[PART_LISTS], (f64)times->grid_ms);
        samples_add(&run->parts[PART_PACKET], (f64)times->cull_ms + (f64)times->lights_ms +
                                                  (f64)times->grid_ms + (f64)times->pack_ms);
        // Every sixth tick the manager decides.
        bool decides = session->world->tick % LIGHT_MANAGER_STEP == 0;
        samples_add(&run->parts[decides ? PART_DECISION_TICK : PART_TICK], (f64)session->tick_ms);
        run->shaded = packet->counts.lights_shaded;
    }
    return true;
}

bool bench_measure_manager(Bench *bench, const char *id, ManagerCost *cost) {
    static const char *const part_names[PART_COUNT] = {"lights", "lists", "packet", "tick",
                                                       "tick with decision, 1 in 6"};
    ManagerRun runs[] = {
        {.name = "1,171 lights", .level = 0, .manager = true, .grid = GRID_RECT},
        {.name = "1,171, manager off", .level = 0, .grid = GRID_RECT},
        {.name = "1,171, off, frustum", .level = 0, .grid = GRID_FRUSTUM},
        {.name = "10,000 lights", .level = 1, .manager = true, .grid = GRID_RECT},
        {.name = "10,000, manager off", .level = 1, .grid = GRID_RECT},
        {.name = "10,000, off, frustum", .level = 1, .grid = GRID_FRUSTUM},
    };
    Session sessions[2];
    bool ok = true;
    for (u32 i = 0; i < COUNT_OF(sessions); i++)
        if (!session_create(&sessions[i], tool_session())) return false;
    ok = headless_load(&sessions[0], BENCH_LEVEL, &bench->common) &&
         headless_load(&sessions[1], BENCH_LEVEL_HALL, &bench->common);
    jobs_stop();
    jobs_start(1);
    u32 blocks = bench->quick ? 2 : 5, frames = bench->quick ? 5 : 40;
    Progress progress = progress_begin(id, blocks * COUNT_OF(runs), bench->common.quiet);
    for (u32 block = 0; ok && block < blocks; block++)
        for (u32 r = 0; ok && r < COUNT_OF(runs); r++) {
            ok = manager_frames(&sessions[runs[r].level], &runs[r], frames);
            progress_set(&progress, block * COUNT_OF(runs) + r + 1, runs[r].name);
        }
    progress_end(&progress);
    jobs_stop();
    jobs_start(bench->common.threads);
    for (u32 r = 0; r < COUNT_OF(runs); r++)
        for (u32 p = 0; p < PART_COUNT; p++) {
            char what[64];
            snprintf(what, sizeof what, "%s: %s", runs[r].name, part_names[p]);
            if (ok) bench_add(bench, id, what, &runs[r].parts[p], "ms", 0.0);
            f64 median = samples_percentile(&runs[r].parts[p], 0.5);
            if (runs[r].manager && (p == PART_LIGHTS || p == PART_LISTS))
                cost->frame_ms[runs[r].level] += median;
            // What deciding costs, spread over the ticks.
            if (runs[r].manager && p == PART_DECISION_TICK)
                cost->frame_ms[runs[r].level] += median / LIGHT_MANAGER_STEP;
            if (runs[r].manager && p == PART_TICK)
                cost->frame_ms[runs[r].level] -= median / LIGHT_MANAGER_STEP;
            if (r % 3 == 1 && p == PART_LISTS) cost->lists_ms[runs[r].level] = median;
            samples_free(&runs[r].parts[p]);
        }
    for (u32 i = 0; i < COUNT_OF(sessions); i++) session_destroy(&sessions[i]);
    return ok;
}

bool bench_manager(Bench *bench, const char *id) { return bench_manager_verdicts(bench, id); }

bool bench_manager_verdicts(Bench *bench, const char *id) {
    ManagerCost cost = {0};
    if (!bench_measure_manager(bench, id, &cost)) return false;
    bench_verdict(bench, id, cost.frame_ms[0], BENCH_AT_MOST, 0.5, " ms",
                  "manager and lists of 1,171 lights, one core");
    bench_verdict(bench, id, cost.frame_ms[1], BENCH_AT_MOST, 4.0, " ms",
                  "manager and lists of 10,000 lights, one core");
    bench_verdict(bench, id, cost.lists_ms[1], BENCH_AT_MOST, 10.0, " ms",
                  "lists of 10,000 lights, manager off, one core");
    return true;
}

// --- P3 ---

typedef enum Stage {
    STAGE_NONE,
    STAGE_CULLING,
    STAGE_OCCLUSION,
    STAGE_MERGE,
    STAGE_DROP,
    STAGE_LOD,
    STAGE_WIDE_BUDGET,
    STAGE_BUDGET,
    STAGE_ALL,
    STAGE_COUNT
} Stage;
static const char *const stage_names[STAGE_COUNT] = {"none",      "light_culling", "occlusion",
                                                     "merge",     "drop",          "light_lod",
                                                     "budget 64", "budget 10",     "all"};
// Lights for a region of 64 px: what a scene of very many wants, and the source's.
#define BUDGET_WIDE 64
#define BUDGET      10

static void use_stage(RenderSettings *settings, Stage stage) {
    bool all = stage == STAGE_ALL;
    settings->manager = stage != STAGE_NONE;
    settings->light_culling = all || stage == STAGE_CULLING;
    settings->occlusion = all || stage == STAGE_OCCLUSION;
    settings->merge = all || stage == STAGE_MERGE;
    settings->drop = all || stage == STAGE_DROP;
    settings->light_lod = all || stage == STAGE_LOD;
    settings->budget = stage == STAGE_BUDGET        ? BUDGET
                       : stage == STAGE_WIDE_BUDGET ? BUDGET_WIDE
                                                    : 0;
}

typedef struct StageScene {
    const char *name, *level, *camera; // camera NULL = the level's main one
    u32 lights;                        // at most, of the level's
    f64 shaded[STAGE_COUNT], manager_ms[STAGE_COUNT], frame_ms[STAGE_COUNT], gain[STAGE_COUNT];
    f64 p10[STAGE_COUNT], p90[STAGE_COUNT];
    PacketCounts counts[STAGE_COUNT];
    ImageDifference difference[STAGE_COUNT];
    f64 flip[STAGE_COUNT];
} StageScene;

static bool compare_pictures(FrameBench *run, const FrameVariant *variants, StageScene *scene) {
    Arena *arena = &run->bench->arena;
    for (u32 s = 0; s < STAGE_COUNT; s++) {
        u64 mark = arena_mark(arena);
        RenderImage image, reference;
        if (!frame_bench_picture(run, &variants[s], arena, &image) ||
            !frame_bench_picture(run, &variants[STAGE_NONE], arena, &reference))
            return false;
        scene->difference[s] =
            image_compare(reference.rgba, image.rgba, image.width_px, image.height_px, arena);
        scene->flip[s] = scene->difference[s].flip;
        arena_rewind(arena, mark);
    }
    return true;
}

static bool measure_scene(Bench *bench, const char *id, StageScene *scene) {
    u32 width = bench->quick ? 320 : 1280, height = bench->quick ? 180 : 720;
    FrameBench run;
    if (!frame_bench_open(&run, bench, scene->level, width, height, 1)) return false;
    if (scene->camera) run.view.camera = scene->camera;
    FrameRounds rounds = {5, 25, 60, 0};
    if (bench->quick) rounds = (FrameRounds){2, 5, 2, 0};
    FrameVariant variants[STAGE_COUNT] = {0};
    for (u32 s = 0; s < STAGE_COUNT; s++) {
        variants[s].settings = frame_bench_settings(&run, PATH_TILED_DEFERRED, scene->lights);
        use_stage(&variants[s].settings, (Stage)s);
        snprintf(variants[s].name, sizeof variants[s].name, "%s, %s", scene->name, stage_names[s]);
    }
    bool ok = frame_bench_measure(&run, variants, STAGE_COUNT, &rounds) &&
              compare_pictures(&run, variants, scene);
    for (u32 s = 0; ok && s < STAGE_COUNT; s++) {
        FrameVariant *variant = &variants[s];
        scene->counts[s] = variant->counts;
        scene->shaded[s] = 100.0 * variant->counts.lights_shaded /
                           CLAMP(scene->lights, 1, MAX(variant->counts.lights_total, 1));
        scene->manager_ms[s] = samples_percentile(&variant->lights_ms, 0.5);
        scene->frame_ms[s] = frame_variant_ms(variant);
        scene->p10[s] = samples_percentile(&variant->times.frame_ms, 0.1);
        scene->p90[s] = samples_percentile(&variant->times.frame_ms, 0.9);
        scene->gain[s] = scene->frame_ms[STAGE_NONE] / scene->frame_ms[s];
        frame_variant_add(bench, id, variant, 1.0 / scene->gain[s], false);
    }
    frame_variants_free(variants, STAGE_COUNT);
    frame_bench_close(&run);
    return ok;
}

static bool p3_table(Bench *bench, const StageScene *scenes, u32 count) {
    BenchTable table;
    bench_table_begin(&table, bench, "p3",
                      "scene,stage,lights,shaded,occluded,merged pairs,dropped,over budget,manager "
                      "ms,frame ms,p10,p90,gain,FLIP,SSIM,max");
    for (u32 i = 0; i < count; i++)
        for (u32 s = 0; s < STAGE_COUNT; s++) {
            const StageScene *scene = &scenes[i];
            const PacketCounts *counts = &scene->counts[s];
            bench_text(&table, "%s", scene->name);
            bench_text(&table, "%s", stage_names[s]);
            bench_number(&table, counts->lights_total);
            bench_number(&table, counts->lights_shaded);
            bench_number(&table, counts->lights_occluded);
            bench_number(&table, counts->lights_merged_pairs);
            bench_number(&table, counts->lights_dropped);
            bench_number(&table, counts->lights_over_budget);
            bench_number(&table, scene->manager_ms[s]);
            bench_number(&table, scene->frame_ms[s]);
            bench_number(&table, scene->p10[s]);
            bench_number(&table, scene->p90[s]);
            bench_number(&table, scene->gain[s]);
            bench_number(&table, scene->difference[s].flip);
            bench_number(&table, scene->difference[s].ssim);
            bench_number(&table, scene->difference[s].max);
        }
    return bench_table_end(&table);
}

static bool p3_plot(Bench *bench, const StageScene *scenes, u32 count) {
    PlotChart charts[4] = {{.title = "P3: lights shaded", .y_label = "% of the level's"},
                           {.title = "Frame time without manager / with the stage", .y_label = "x"},
                           {.title = "Manager on the CPU", .y_label = "milliseconds"},
                           {.title = "Image error against no manager", .y_label = "FLIP"}};
    for (u32 c = 0; c < 4; c++) {
        charts[c].kind = PLOT_BARS;
        charts[c].categories = stage_names;
        charts[c].category_count = STAGE_COUNT;
        for (u32 i = 0; i < count; i++) {
            const f64 *values[4] = {scenes[i].shaded, scenes[i].gain, scenes[i].manager_ms,
                                    scenes[i].flip};
            PlotSeries *series = plot_add(&charts[c], scenes[i].name);
            series->y = values[c];
            series->count = STAGE_COUNT;
        }
    }
    return bench_plot(bench, "p3", charts, 4, 2, 1600, 1000);
}

bool bench_p3(Bench *bench, const char *id) {
    StageScene scenes[3] = {
        {.name = "cloister", .level = BENCH_LEVEL, .lights = UINT32_MAX},
        {.name = "cloister, walk", .level = BENCH_LEVEL, .camera = "walk", .lights = UINT32_MAX},
        {.name = "hall", .level = BENCH_LEVEL_HALL, .lights = 4000},
    };
    u32 count = COUNT_OF(scenes);
    if (bench->level) {
        scenes[0] = (StageScene){.name = bench->level, .level = bench->level, .lights = UINT32_MAX};
        count = 1;
    }
    for (u32 i = 0; i < count; i++)
        if (!measure_scene(bench, id, &scenes[i])) return false;
    for (u32 i = 0; i < count; i++) {
        bench_verdict(bench, id, scenes[i].gain[STAGE_ALL], BENCH_AT_LEAST, 1.0, "x",
                      "%s, no manager / all stages", scenes[i].name);
        bench_verdict(bench, id, scenes[i].difference[STAGE_ALL].ssim, BENCH_AT_LEAST, 0.98, "",
                      "%s, SSIM of all stages", scenes[i].name);
    }
    return p3_table(bench, scenes, count) && p3_plot(bench, scenes, count);
}
