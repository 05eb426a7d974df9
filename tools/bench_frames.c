// bench_frames.c: see bench_frames.h. Data in: a level, settings. Data out: samples of frame times.
// CPU times are user + system of the process, driver threads included. Called by: bench_gpu.c and
// the experiments. Does not: judge.
#include "bench_frames.h"
#include "../engine/base/clock.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WARM_UP_FRAMES 2
#define STEP_UNITS     100 // of the progress bar

bool frame_bench_open(FrameBench *run, Bench *bench, const char *level, u32 width_px, u32 height_px,
                      u32 step_count) {
    *run = (FrameBench){.bench = bench, .step_count = MAX(step_count, 1)};
    if (!session_create(&run->session, tool_session())) return false;
    if (!headless_load(&run->session, level, &bench->common) ||
        !renderer_set_assets(bench->headless.renderer, &run->session.assets)) {
        session_destroy(&run->session);
        return false;
    }
    run->view = (SessionView){.camera = headless_camera(&run->session, NULL),
                              .settings = settings_default(),
                              .width_px = width_px,
                              .height_px = height_px};
    const LightTable *lights = WORLD_TABLE(run->session.world, Light, light);
    for (u32 i = 0; i < lights->table.count; i++)
        run->light_count += lights->kind[i] != LIGHT_DIRECTIONAL;
    run->progress = progress_begin(bench->row, run->step_count * STEP_UNITS, bench->common.quiet);
    return true;
}

void frame_bench_close(FrameBench *run) {
    progress_end(&run->progress);
    gpu_wait_idle(run->bench->headless.gpu);
    session_destroy(&run->session);
}

void frame_bench_tick(FrameBench *run) { session_tick(&run->session, (Input){0}); }

bool frame_bench_draw(FrameBench *run, FrameSample *out, Arena *arena, RenderImage *image) {
    session_frame_begin(&run->session);
    run->view.cold = image != NULL; // timed frames are a player's
    f64 wall = clock_now_ms(), cpu = clock_process_cpu_ms();
    const Packet *packet = session_packet(&run->session, &run->view);
    out->packet_ms = clock_now_ms() - wall;
    bool ok = packet && renderer_render_image(run->bench->headless.renderer, packet, arena, image);
    out->cpu_ms = clock_process_cpu_ms() - cpu;
    out->wall_ms = clock_now_ms() - wall;
    out->build = run->session.packet_times;
    if (packet) out->counts = packet->counts;
    run->drawn = run->view;
    return ok;
}

bool frame_bench_warm_up(FrameBench *run) {
    session_frame_begin(&run->session);
    const Packet *packet = session_packet(&run->session, &run->view);
    bool ok = packet && renderer_warm_up_path(run->bench->headless.renderer, packet);
    FrameSample sample;
    for (u32 i = 0; ok && i < WARM_UP_FRAMES; i++) ok = frame_bench_draw(run, &sample, NULL, NULL);
    return ok;
}

// --- variants ---

// A first frame after these changed makes targets anew.
static bool needs_new_targets(const FrameBench *run) {
    const SessionView *a = &run->drawn, *b = &run->view;
    return a->width_px != b->width_px || a->height_px != b->height_px ||
           a->settings.layout != b->settings.layout || a->settings.msaa != b->settings.msaa;
}

static void use_variant(FrameBench *run, const FrameVariant *variant, u32 width, u32 height) {
    run->view.settings = variant->settings;
    run->view.width_px = variant->width_px ? variant->width_px : width;
    run->view.height_px = variant->height_px ? variant->height_px : height;
    frame_times_begin(&variant->times, run->bench->headless.gpu);
}

bool frame_bench_picture(FrameBench *run, const FrameVariant *variant, Arena *arena,
                         RenderImage *out) {
    u32 width = run->view.width_px, height = run->view.height_px;
    use_variant(run, variant, width, height);
    FrameSample sample;
    bool ok = frame_bench_draw(run, &sample, arena, out);
    run->view.width_px = width;
    run->view.height_px = height;
    return ok;
}

static void add_sample(FrameBench *run, FrameVariant *variant, const FrameSample *sample) {
    samples_add(&variant->times.frame_ms, sample->wall_ms);
    samples_add(&variant->times.cpu_ms, sample->cpu_ms);
    samples_add(&variant->packet_ms, sample->packet_ms);
    samples_add(&variant->lights_ms, (f64)sample->build.lights_ms);
    samples_add(&variant->grid_ms, (f64)sample->build.grid_ms);
    frame_times_add_passes(&variant->times, run->bench->headless.gpu);
    variant->counts = sample->counts;
}

// Compiles and draws each variant; those that are slow have their only sample then. Others draw
// again: the device's lists learn from a first frame how much room they need.
static bool first_frames(FrameBench *run, FrameVariant *variants, u32 count,
                         const FrameRounds *rounds, u32 width, u32 height) {
    FrameSample sample;
    for (u32 v = 0; v < count; v++) {
        FrameVariant *variant = &variants[v];
        use_variant(run, variant, width, height);
        session_frame_begin(&run->session);
        const Packet *packet = session_packet(&run->session, &run->view);
        if (!packet || !renderer_warm_up_path(run->bench->headless.renderer, packet)) return false;
        if (!frame_bench_draw(run, &sample, NULL, NULL)) return false;
        variant->slow = rounds->slow_ms > 0.0 && sample.wall_ms > rounds->slow_ms;
        if (variant->slow)
            add_sample(run, variant, &sample);
        else if (!frame_bench_draw(run, &sample, NULL, NULL))
            return false;
        progress_set(&run->progress, run->step * STEP_UNITS, variant->name);
    }
    return true;
}

bool frame_bench_measure(FrameBench *run, FrameVariant *variants, u32 count,
                         const FrameRounds *rounds) {
    u32 width = run->view.width_px, height = run->view.height_px;
    bool ok = first_frames(run, variants, count, rounds, width, height);
    f64 start_ms = clock_now_ms(), share = 0.0;
    FrameSample sample;
    for (u32 round = 0; ok && round < rounds->max && (share < 1.0 || round < rounds->min);
         round++) {
        frame_bench_tick(run);
        for (u32 v = 0; ok && v < count; v++) {
            FrameVariant *variant = &variants[v];
            if (variant->slow) continue;
            use_variant(run, variant, width, height);
            if (needs_new_targets(run)) ok = frame_bench_draw(run, &sample, NULL, NULL);
            ok = ok && frame_bench_draw(run, &sample, NULL, NULL);
            if (ok) add_sample(run, variant, &sample);
            share = (clock_now_ms() - start_ms) / 1000.0 / rounds->budget_s;
            f64 done = MAX(share, (f64)round / rounds->max);
            u32 units = (u32)(MIN(done, 1.0) * STEP_UNITS);
            progress_set(&run->progress, run->step * STEP_UNITS + units, variant->name);
        }
    }
    run->step++;
    progress_set(&run->progress, run->step * STEP_UNITS, NULL);
    run->view.width_px = width;
    run->view.height_px = height;
    return ok;
}

void frame_variants_free(FrameVariant *variants, u32 count) {
    for (u32 v = 0; v < count; v++) {
        frame_times_free(&variants[v].times);
        samples_free(&variants[v].packet_ms);
        samples_free(&variants[v].lights_ms);
        samples_free(&variants[v].grid_ms);
    }
}

RenderSettings frame_settings_direct(void) {
    RenderSettings settings = settings_default();
    settings_set(&settings, "gi.enabled=off");
    return settings;
}

RenderSettings frame_bench_settings(const FrameBench *run, RenderPath path, u32 lights) {
    RenderSettings settings = frame_settings_direct();
    settings.path = path;
    settings.light_limit = lights < run->light_count ? lights : 0;
    if (settings.light_limit)
        settings.light_gain = CLAMP((f32)run->light_count / (f32)lights, 1.0f, 10.0f);
    return settings;
}

void frame_settings_every_light(RenderSettings *settings) {
    settings->occlusion = settings->merge = settings->drop = settings->light_lod = 0;
}

f64 frame_variant_ms(FrameVariant *variant) {
    Samples *samples = &variant->times.frame_ms;
    return samples->count ? samples_percentile(samples, 0.5) : (f64)NAN;
}

static bool has_word(const char *name, const char *words) {
    char word[64];
    while (*words) {
        u64 length = strcspn(words, "|");
        snprintf(word, sizeof word, "%.*s", (int)length, words);
        if (strstr(name, word)) return true;
        words += length + (words[length] == '|');
    }
    return false;
}

f64 frame_variant_pass_ms(FrameVariant *variant, const char *words) {
    f64 sum = 0.0;
    for (u32 p = 0; p < variant->times.pass_count; p++)
        if (has_word(variant->times.passes[p].name, words))
            sum += samples_percentile(&variant->times.passes[p].ms, 0.5);
    return sum;
}

void frame_variant_add(Bench *bench, const char *id, FrameVariant *variant, f64 ratio,
                       bool passes) {
    bench_add(bench, id, variant->name, &variant->times.frame_ms, "ms", ratio);
    for (u32 p = 0; passes && p < variant->times.pass_count; p++) {
        char what[128];
        snprintf(what, sizeof what, "%s: %s", variant->name, variant->times.passes[p].name);
        bench_add(bench, id, what, &variant->times.passes[p].ms, "ms", 0.0);
    }
}
