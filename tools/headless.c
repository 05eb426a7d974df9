// headless.c: opens a device, loads a level, picks camera and settings, collects frame times.
// Data in: common options, names from the command line. Data out: a renderer, a loaded session,
// samples. Called by: shot, record, replay, bench, info. Does not: decide what is drawn or written.
#include "headless.h"
#include "../engine/base/log.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

Gpu *headless_gpu(const ToolCommon *common) {
    // Accurate timers: a plain timestamp blames the wrong pass on the software driver.
    Gpu *gpu = gpu_create(&(GpuDesc){.label = "luz tool",
                                     .device = common->device,
                                     .validation = common->validation,
                                     .accurate_timers = true});
    if (gpu) gpu_timers_enable(gpu, false); // but for frames that are measured
    // The engine takes the best device instead; who names one to a tool wants that one.
    if (!gpu || !common->device || strcasestr(gpu_info(gpu)->device_name, common->device))
        return gpu;
    LOG(GPU_NONE, "no usable device is called '%s'; there is '%s'", common->device,
        gpu_info(gpu)->device_name);
    gpu_destroy(gpu);
    return NULL;
}

bool headless_open(Headless *headless, const ToolCommon *common) {
    *headless = (Headless){.gpu = headless_gpu(common)};
    if (!headless->gpu) return false;
    const GpuInfo *info = gpu_info(headless->gpu);
    snprintf(headless->device, sizeof headless->device, "%s / %s", info->device_name,
             info->driver_info);
    headless->renderer = renderer_create(headless->gpu);
    if (headless->renderer) return true;
    headless_close(headless);
    return false;
}

void headless_close(Headless *headless) {
    if (headless->renderer) renderer_destroy(headless->renderer);
    if (headless->gpu) gpu_destroy(headless->gpu);
    *headless = (Headless){0};
}

const SessionDesc *tool_session(void) {
    static const SessionDesc engine_alone;
    return &luz_project ? &luz_project : &engine_alone;
}

void headless_explain(const Diagnostics *diagnostics) {
    for (u32 i = 0; i < diagnostics->count; i++) {
        const Diagnostic *item = &diagnostics->items[i];
        if (!item->is_error) continue;
        char text[1024];
        diagnostic_format(item, text, sizeof text);
        text[strcspn(text, "\n")] = 0;
        tool_explain(text);
        return;
    }
}

bool headless_load(Session *session, const char *path, const ToolCommon *common) {
    bool ok = session_load(session, path);
    const Diagnostics *diagnostics = session->diagnostics;
    bool show = !ok || (diagnostics && diagnostics->warning_count > 0 && !common->quiet);
    if (show && diagnostics) diagnostics_print(diagnostics, stderr);
    if (!ok && diagnostics) headless_explain(diagnostics);
    return ok;
}

const char *headless_camera(const Session *session, const char *asked) {
    if (asked) return asked;
    if (session_camera(session, "main") != ENTITY_NONE) return "main";
    const Table *cameras = session->world->tables[COMPONENT_camera];
    for (u32 i = 0; i < cameras->count; i++) {
        const char *name = world_name(session->world, cameras->entity[i]);
        if (cameras->entity[i] != session->player && name[0]) return name;
    }
    return NULL;
}

const char *headless_preset_help(void) {
    static char help[512]; // filled once a run
    u64 used = (u64)snprintf(help, sizeof help, "settings by a name, before --set:");
    for (u32 i = 0; i < setting_preset_count && used < sizeof help; i++)
        used += (u64)snprintf(help + used, sizeof help - used, "\n%s: %s", setting_presets[i].name,
                              setting_presets[i].help);
    return help;
}

bool headless_settings(RenderSettings *settings, const char *path, const char *view,
                       const ToolList *sets) {
    char text[128];
    const char *const named[2][2] = {{"path", path}, {"view", view}};
    for (u32 i = 0; i < 2; i++) {
        if (!named[i][1]) continue;
        snprintf(text, sizeof text, "%s=%s", named[i][0], named[i][1]);
        if (!settings_set(settings, text)) return false;
    }
    for (u32 i = 0; sets && i < sets->count; i++)
        if (!settings_set(settings, sets->items[i])) return false;
    return true;
}

void headless_internal_size(const RenderSettings *settings, const u32 size[2], u32 out[2]) {
    for (u32 i = 0; i < 2; i++) {
        u32 scaled = (u32)((f32)size[i] * settings->scale + 0.5f);
        out[i] = CLAMP(scaled, 1, size[i]);
    }
}

// --- measuring ---

void samples_add(Samples *samples, f64 value) {
    if (samples->count == samples->cap) {
        samples->cap = MAX(samples->cap * 2, 16);
        samples->values = realloc(samples->values, samples->cap * sizeof(f64));
        LUZ_ASSERT(samples->values);
    }
    samples->values[samples->count++] = value;
}

void samples_free(Samples *samples) {
    free(samples->values);
    *samples = (Samples){0};
}

static int compare_f64(const void *a, const void *b) {
    f64 x = *(const f64 *)a, y = *(const f64 *)b;
    return (x > y) - (x < y);
}

f64 samples_percentile(Samples *samples, f64 p) {
    if (samples->count == 0) return 0.0;
    qsort(samples->values, samples->count, sizeof(f64), compare_f64);
    f64 rank = p * (samples->count - 1);
    u32 below = (u32)floor(rank), above = MIN(below + 1, samples->count - 1);
    f64 share = rank - below;
    return samples->values[below] * (1.0 - share) + samples->values[above] * share;
}

void json_samples(Json *json, const char *key, Samples *samples) {
    json_open_flat_object(json, key);
    json_f64(json, "median", samples_percentile(samples, 0.5));
    json_f64(json, "min", samples_percentile(samples, 0.0));
    json_f64(json, "max", samples_percentile(samples, 1.0));
    json_close(json);
}

void frame_times_begin(const FrameTimes *times, Gpu *gpu) {
    gpu_timers_enable(gpu, times->frame_ms.count % 3 == 0);
}

void frame_times_add_passes(FrameTimes *times, const Gpu *gpu) {
    GpuTimer timers[GPU_TIMERS_CAP];
    u32 count = gpu_timers(gpu, timers, GPU_TIMERS_CAP);
    for (u32 i = 0; i < count; i++) {
        u32 p = 0;
        while (p < times->pass_count && strcmp(times->passes[p].name, timers[i].name) != 0) p++;
        if (p == GPU_TIMERS_CAP) continue;
        if (p == times->pass_count) {
            snprintf(times->passes[p].name, sizeof times->passes[p].name, "%s", timers[i].name);
            times->pass_count++;
        }
        samples_add(&times->passes[p].ms, (f64)timers[i].ms);
    }
}

void frame_times_free(FrameTimes *times) {
    samples_free(&times->frame_ms);
    samples_free(&times->cpu_ms);
    for (u32 i = 0; i < times->pass_count; i++) samples_free(&times->passes[i].ms);
    *times = (FrameTimes){0};
}
