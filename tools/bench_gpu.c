// bench_gpu.c: rows that draw: a level, a scene, the paths against each other.
// Data in: a level. Data out: frame times (wall), CPU times (user + system of the process, driver
// threads included), times of passes. Frames show advancing ticks, as in play; ticks are not timed.
#include "../engine/base/clock.h"
#include "bench.h"
#include <stdio.h>
#include <string.h>

#define WARM_UP_FRAMES 3

typedef struct GpuBench {
    Bench *bench;
    Session session;
    SessionView view;
} GpuBench;

static bool gpu_bench_begin(GpuBench *run, Bench *bench, const char *level, u32 width, u32 height) {
    *run = (GpuBench){.bench = bench};
    if (!session_create(&run->session, tool_session())) return false;
    if (!headless_load(&run->session, level, &bench->common) ||
        !renderer_set_assets(bench->headless.renderer, &run->session.assets)) {
        session_destroy(&run->session);
        return false;
    }
    run->view = (SessionView){.camera = headless_camera(&run->session, NULL),
                              .settings = settings_default(),
                              .width_px = width,
                              .height_px = height};
    return true;
}

static void gpu_bench_end(GpuBench *run) {
    gpu_wait_idle(run->bench->headless.gpu);
    session_destroy(&run->session);
}

// One frame as in play: packet, drawing, waiting. Wall and CPU milliseconds.
static bool gpu_bench_frame(GpuBench *run, f64 *wall_ms, f64 *cpu_ms) {
    session_tick(&run->session, (Input){0});
    session_frame_begin(&run->session);
    f64 wall = clock_now_ms(), cpu = clock_process_cpu_ms();
    const Packet *packet = session_packet(&run->session, &run->view);
    bool ok = packet && renderer_render_image(run->bench->headless.renderer, packet, NULL, NULL);
    *cpu_ms = clock_process_cpu_ms() - cpu;
    *wall_ms = clock_now_ms() - wall;
    return ok;
}

static bool gpu_bench_warm_up(GpuBench *run) {
    session_frame_begin(&run->session);
    const Packet *packet = session_packet(&run->session, &run->view);
    bool ok = packet && renderer_warm_up_path(run->bench->headless.renderer, packet);
    f64 wall, cpu;
    for (u32 i = 0; ok && i < WARM_UP_FRAMES; i++) ok = gpu_bench_frame(run, &wall, &cpu);
    return ok;
}

static bool bench_frames(Bench *bench, const char *id, const char *level, u32 width, u32 height,
                         u32 rounds) {
    GpuBench run;
    if (!gpu_bench_begin(&run, bench, level, width, height)) return false;
    FrameTimes times = {0};
    Samples fps = {0};
    bool ok = gpu_bench_warm_up(&run);
    Progress progress = progress_begin(id, rounds, bench->common.quiet);
    for (u32 i = 0; ok && i < rounds; i++) {
        f64 wall, cpu;
        ok = gpu_bench_frame(&run, &wall, &cpu);
        samples_add(&times.frame_ms, wall);
        samples_add(&times.cpu_ms, cpu);
        samples_add(&fps, wall > 0.0 ? 1000.0 / wall : 0.0);
        frame_times_add_passes(&times, bench->headless.gpu);
        progress_set(&progress, i + 1, NULL);
    }
    progress_end(&progress);
    if (ok) {
        char what[96];
        bench_add(bench, id, "frames per second", &fps, "1/s", 0.0);
        bench_add(bench, id, "frame", &times.frame_ms, "ms", 0.0);
        bench_add(bench, id, "CPU, all threads", &times.cpu_ms, "ms", 0.0);
        for (u32 p = 0; p < times.pass_count; p++) {
            snprintf(what, sizeof what, "pass %s", times.passes[p].name);
            bench_add(bench, id, what, &times.passes[p].ms, "ms", 0.0);
        }
    }
    samples_free(&fps);
    frame_times_free(&times);
    gpu_bench_end(&run);
    return ok;
}

bool bench_cloister(Bench *bench, const char *id) {
    return bench_frames(bench, id, bench->level, 640, 360, bench->quick ? 15 : 120);
}

bool bench_atrium(Bench *bench, const char *id) {
    return bench_frames(bench, id, bench->scene, 1280, 720, bench->quick ? 5 : 30);
}

// --- paths ---

typedef struct PathVariant {
    GpuBench *run;
    RenderSettings settings;
    bool failed;
} PathVariant;

static f64 draw_path(void *context) {
    PathVariant *variant = context;
    variant->run->view.settings = variant->settings;
    f64 wall = 0.0, cpu = 0.0;
    if (!gpu_bench_frame(variant->run, &wall, &cpu)) variant->failed = true;
    return wall;
}

bool bench_paths(Bench *bench, const char *id) {
    // Beyond 256 lights the two paths without tiles take seconds a frame.
    static const u32 limits[] = {16, 64, 256};
    u32 limit_count = bench->quick ? 2 : COUNT_OF(limits);
    static const RenderPath order[] = {PATH_TILED_DEFERRED, PATH_DEFERRED, PATH_FORWARD};
    GpuBench run;
    if (!gpu_bench_begin(&run, bench, bench->level, 640, 360)) return false;
    u32 light_count = WORLD_TABLE(run.session.world, Light, light)->table.count;
    bool ok = true;
    for (u32 l = 0; ok && l < limit_count; l++) {
        if (l > 0 && limits[l - 1] >= light_count) break; // the same picture again
        BenchVariant variants[COUNT_OF(order)];
        PathVariant contexts[COUNT_OF(order)];
        for (u32 p = 0; ok && p < COUNT_OF(order); p++) {
            contexts[p] = (PathVariant){.run = &run, .settings = settings_default()};
            contexts[p].settings.path = order[p];
            contexts[p].settings.light_limit = limits[l];
            variants[p] = (BenchVariant){.function = draw_path, .context = &contexts[p]};
            char word[64];
            snprintf(variants[p].name, sizeof variants[p].name, "%4u lights, %s",
                     MIN(limits[l], light_count),
                     settings_word("path", order[p], word, sizeof word));
            run.view.settings = contexts[p].settings;
            ok = gpu_bench_warm_up(&run);
        }
        if (ok) bench_variants(bench, id, variants, COUNT_OF(order), bench->quick ? 3 : 9);
        for (u32 p = 0; ok && p < COUNT_OF(order); p++) ok = !contexts[p].failed;
    }
    gpu_bench_end(&run);
    return ok;
}
