// bench_gi_run.c: see bench_gi.h. Data in: a level, settings. Data out: times of the steps of
// global illumination, pictures. Called by: bench_gi.c, bench_gi_pictures.c. Does not: judge.
#include "bench_gi.h"
#include "../engine/base/clock.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define NUDGE_M 1e-3f

const char *const gi_step_titles[GI_STEP_COUNT] = {
#define X(id, title, passes) title,
    GI_STEPS(X)
#undef X
};
static const char *const step_passes[GI_STEP_COUNT] = {
#define X(id, title, passes) passes,
    GI_STEPS(X)
#undef X
};

static bool is_listed(const char *names, char separator, const char *name) {
    u64 length = strlen(name);
    while (names && *names) {
        const char *end = strchr(names, separator);
        u64 here = end ? (u64)(end - names) : strlen(names);
        if (here == length && strncmp(names, name, length) == 0) return true;
        names += here + (end != NULL);
    }
    return false;
}

f64 gi_pass_ms(FrameTimes *times, const char *passes) {
    f64 sum = 0.0;
    for (u32 p = 0; p < times->pass_count; p++)
        if (is_listed(passes, '|', times->passes[p].name))
            sum += samples_percentile(&times->passes[p].ms, 0.5);
    return sum;
}

// --- The level ---

u32 gi_make_dynamic(World *world, const char *names) {
    InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    u32 count = 0;
    for (u32 row = 0; row < instances->table.count; row++) {
        const char *name = world_name(world, instances->table.entity[row]);
        if (!name[0] || !is_listed(names, ' ', name)) continue;
        instances->voxel_mode[row] = VOXEL_DYNAMIC;
        table_touch(&instances->table, row);
        count++;
    }
    return count;
}

void gi_set_shadows(World *world, bool suns, u32 voxel_shadow, u32 screen_shadow,
                    f32 aperture_deg) {
    LightTable *lights = WORLD_TABLE(world, Light, light);
    for (u32 row = 0; row < lights->table.count; row++) {
        if (!suns && lights->kind[row] == LIGHT_DIRECTIONAL) continue;
        lights->voxel_shadow[row] = voxel_shadow;
        lights->screen_shadow[row] = screen_shadow;
        lights->shadow_aperture[row] = aperture_deg;
        table_touch(&lights->table, row);
    }
}

// Something static without a parent: it can be moved by its own position.
static u32 find_nudged(const World *world) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const TransformTable *places = WORLD_TABLE(world, Transform, transform);
    for (u32 row = 0; row < instances->table.count; row++) {
        u32 place = table_row(&places->table, instances->table.entity[row]);
        if (instances->voxel_mode[row] == VOXEL_STATIC && place != ROW_NONE &&
            places->parent[place] == ENTITY_NONE)
            return place;
    }
    return ROW_NONE;
}

static void nudge(GiBench *run) {
    TransformTable *places = WORLD_TABLE(run->frames.session.world, Transform, transform);
    if (run->nudged != ROW_NONE) {
        places->y[run->nudged] += run->is_off ? -NUDGE_M : NUDGE_M;
        run->is_off = !run->is_off;
        table_touch(&places->table, run->nudged);
    }
    frame_bench_tick(&run->frames);
}

bool gi_bench_open(GiBench *run, Bench *bench, const GiScene *scene, u32 width_px, u32 height_px,
                   u32 step_count) {
    *run = (GiBench){0};
    if (!frame_bench_open(&run->frames, bench, scene->level, width_px, height_px, step_count))
        return false;
    World *world = run->frames.session.world;
    // A level that says nothing of it has the columns' values.
    world_singleton(world, COMPONENT_gi);
    if (scene->dynamic) gi_make_dynamic(world, scene->dynamic);
    run->nudged = find_nudged(world);
    return true;
}

void gi_bench_close(GiBench *run) { frame_bench_close(&run->frames); }

// --- Variants ---

GiVariant gi_variant(const char *preset, const char *sets, const char *format, ...) {
    GiVariant variant = {.frame = {.settings = settings_default()}};
    RenderSettings *settings = &variant.frame.settings;
    bool ok = settings_set(settings, "gi.enabled=on") && settings_set(settings, "post=off");
    if (preset) ok = ok && settings_set_preset(settings, preset);
    if (sets && sets[0]) ok = ok && settings_set_list(settings, sets);
    LUZ_ASSERT(ok); // names of this program's own
    va_list args;
    va_start(args, format);
    vsnprintf(variant.frame.name, sizeof variant.frame.name, format, args);
    va_end(args);
    return variant;
}

static void use(GiBench *run, const GiVariant *variant, u32 width, u32 height) {
    SessionView *view = &run->frames.view;
    view->settings = variant->frame.settings;
    view->width_px = variant->frame.width_px ? variant->frame.width_px : width;
    view->height_px = variant->frame.height_px ? variant->frame.height_px : height;
    if (variant->prepare) variant->prepare(&run->frames.session, variant);
    frame_times_begin(&variant->frame.times, run->frames.bench->headless.gpu);
}

static void add_sample(GiBench *run, GiVariant *variant, const FrameSample *sample) {
    FrameVariant *frame = &variant->frame;
    samples_add(&frame->times.frame_ms, sample->wall_ms);
    samples_add(&frame->times.cpu_ms, sample->cpu_ms);
    samples_add(&frame->packet_ms, sample->packet_ms);
    frame_times_add_passes(&frame->times, run->frames.bench->headless.gpu);
    frame->counts = sample->counts;
}

static void finish(GiVariant *variant) {
    variant->update_ms = 0.0;
    for (u32 s = 0; s < GI_STEP_COUNT; s++) {
        variant->steps[s] = gi_pass_ms(&variant->frame.times, step_passes[s]);
        if (s >= GI_STEP_dynamic_voxels && s <= GI_STEP_gather)
            variant->update_ms += variant->steps[s];
    }
    variant->frame_ms = frame_variant_ms(&variant->frame);
}

// Draws until no frame lights voxels or traces probes again.
static bool settle(GiBench *run) {
    FrameSample sample;
    RendererStats before, after = renderer_stats(run->frames.bench->headless.renderer);
    do {
        before = after;
        if (!frame_bench_draw(&run->frames, &sample, NULL, NULL)) return false;
        after = renderer_stats(run->frames.bench->headless.renderer);
    } while (after.gi_relit != before.gi_relit ||
             after.gi_probes_traced != before.gi_probes_traced);
    return true;
}

bool gi_bench_measure(GiBench *run, GiVariant *variants, u32 count, const FrameRounds *rounds) {
    FrameBench *frames = &run->frames;
    u32 width = frames->view.width_px, height = frames->view.height_px;
    FrameSample sample;
    bool ok = true;
    for (u32 v = 0; ok && v < count; v++) {
        use(run, &variants[v], width, height);
        ok = frame_bench_warm_up(frames);
        progress_set(&frames->progress, frames->progress.done, variants[v].frame.name);
    }
    f64 start_ms = clock_now_ms(), share = 0.0;
    for (u32 round = 0; ok && round < rounds->max && (share < 1.0 || round < rounds->min);
         round++) {
        for (u32 v = 0; ok && v < count; v++) {
            GiVariant *variant = &variants[v];
            use(run, variant, width, height);
            // What another variant left behind is made anew in a frame of its own.
            if (count > 1) ok = frame_bench_draw(frames, &sample, NULL, NULL);
            if (ok && run->at_rest) ok = settle(run);
            nudge(run);
            ok = ok && frame_bench_draw(frames, &sample, NULL, NULL);
            if (!ok) break;
            add_sample(run, variant, &sample);
            variant->stats = renderer_stats(frames->bench->headless.renderer);
            variant->bytes = variant->stats.gi_bytes;
            share = (clock_now_ms() - start_ms) / 1000.0 / rounds->budget_s;
            f64 done = ((f64)frames->step + MIN(MAX(share, (f64)round / rounds->max), 1.0)) /
                       MAX(frames->step_count, 1);
            progress_set(&frames->progress, (u32)(done * frames->progress.total),
                         variant->frame.name);
        }
    }
    for (u32 v = 0; ok && v < count; v++) finish(&variants[v]);
    frames->step++;
    frames->view.width_px = width;
    frames->view.height_px = height;
    return ok;
}

void gi_variants_free(GiVariant *variants, u32 count) {
    for (u32 v = 0; v < count; v++) frame_variants_free(&variants[v].frame, 1);
}

// --- Pictures ---

bool gi_bench_picture(GiBench *run, const GiVariant *variant, Arena *arena, RenderImage *out) {
    FrameBench *frames = &run->frames;
    u32 width = frames->view.width_px, height = frames->view.height_px;
    use(run, variant, width, height);
    frames->view.cold = true;
    FrameSample sample;
    // Buffers that turn out too small grow after a frame.
    bool ok = frame_bench_warm_up(frames) && frame_bench_draw(frames, &sample, arena, out);
    frames->view.cold = false;
    frames->view.width_px = width;
    frames->view.height_px = height;
    return ok;
}

bool gi_bench_reference(GiBench *run, const TraceOptions *options, Arena *arena, RenderImage *out) {
    SessionView view = run->frames.view;
    view.settings = settings_default();
    return settings_set(&view.settings, "post=off") &&
           reference_draw(&run->frames.session, &view, options, NULL, NULL, arena, out);
}
