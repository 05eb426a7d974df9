// shot.c: `luz shot`: a level as pictures, without a window.
// Data in: a level, camera, settings, ticks. Data out: PNG files, a frame file, measurements.
// Does not: simulate while it measures: the timed frames show the same tick.
#include "../engine/base/clock.h"
#include "../engine/base/log.h"
#include "../engine/capture/capture.h"
#include "headless.h"
#include "split.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WARM_UP_FRAMES 2
#define STATS_FRAMES   9 // unless --frames says otherwise
#define TICKS_MAX      (60u * 60u * 60u * 24u)
#define HEAP_STATS_CAP 32

typedef struct ShotOptions {
    const char *out, *path, *view, *preset, *camera, *stats, *frame_file, *frames;
    u32 size[2], tick;
    bool has_range;
    u32 frame_count, range[2];
    ToolList sets;
    SplitOptions split;
} ShotOptions;

typedef struct Shot {
    ShotOptions options;
    ToolCommon common;
    const char *level;
    Session session;
    Headless headless;
    SessionView view;
    FrameTimes times;
    PacketCounts counts;
    PacketGi gi;
    u64 image_hash;
    Split split;
} Shot;

// --- options ---

// "9" or "0..59".
static bool parse_frames(ShotOptions *options) {
    const char *text = options->frames;
    if (!text) {
        options->frame_count = options->stats ? STATS_FRAMES : 1;
        return true;
    }
    char rest;
    if (sscanf(text, "%u..%u%c", &options->range[0], &options->range[1], &rest) == 2) {
        options->has_range = true;
        if (options->range[0] <= options->range[1] && options->range[1] <= TICKS_MAX) return true;
        tool_fail(0, "shot", "the range of ticks '%s' is empty or too long", text);
        return false;
    }
    if (text[0] != '-' && sscanf(text, "%u%c", &options->frame_count, &rest) == 1 &&
        options->frame_count >= 1 && options->frame_count <= 100000)
        return true;
    tool_fail(0, "shot", "option '--frames' expects a count or A..B, not '%s'", text);
    return false;
}

// The place of "%d", "%04d" in a name: its length, 0 if there is none. No other % may be in it.
static u32 find_number(const char *name, const char **at, u32 *digits) {
    const char *percent = strchr(name, '%');
    u32 width = 0;
    char d;
    int used = 0;
    if (!percent || strchr(percent + 1, '%')) return 0;
    *at = percent;
    *digits = 0;
    if (percent[1] == 'd') return 2;
    if (percent[1] == '0' && sscanf(percent + 2, "%1u%c%n", &width, &d, &used) == 2 && d == 'd') {
        *digits = width;
        return 2 + (u32)used;
    }
    return 0;
}

static void number_name(const char *name, u32 number, char *out, u64 out_cap) {
    const char *at;
    u32 digits, length = find_number(name, &at, &digits);
    snprintf(out, out_cap, "%.*s%0*u%s", (int)(at - name), name, (int)digits, number, at + length);
}

static bool options_are_sound(ShotOptions *options, const ToolCommon *common) {
    if (!parse_frames(options)) return false;
    const char *at;
    u32 digits;
    if (options->has_range && (!options->out || !find_number(options->out, &at, &digits))) {
        tool_fail(0, "shot", "a range of ticks needs a name with a number: -o name_%%04d.png");
        return false;
    }
    if (options->has_range && (options->tick || options->stats || options->frame_file)) {
        tool_fail(0, "shot", "--frames A..B goes with neither --tick, --stats nor --record-frame");
        return false;
    }
    bool is_split = options->split.ways[0] != NULL;
    if (options->split.mode && !is_split) {
        tool_fail(0, "shot", "--split-mode goes with --split A B");
        return false;
    }
    if (is_split && (options->has_range || options->stats || options->frame_file)) {
        tool_fail(0, "shot", "--split goes with neither --frames A..B, --stats nor --record-frame");
        return false;
    }
    if (options->tick > TICKS_MAX) {
        tool_fail(0, "shot", "--tick is at most %u", TICKS_MAX);
        return false;
    }
    if (options->out || options->stats || options->frame_file || common->json || is_split)
        return true;
    tool_fail(0, "shot", "nothing to write: give -o, --stats, --record-frame or --json");
    return false;
}

// --- drawing ---

static bool write_image(Shot *shot, const RenderImage *image, const char *path) {
    if (!image_write_png(path, image->rgba, image->width_px, image->height_px, 4)) return false;
    if (!shot->common.quiet && !shot->common.json)
        printf("%s: %ux%u, tick %u, image hash %016llx\n", path, image->width_px, image->height_px,
               shot->session.world->tick, (unsigned long long)image->hash);
    return true;
}

static const Packet *next_packet(Shot *shot) {
    session_frame_begin(&shot->session);
    return session_packet(&shot->session, &shot->view);
}

static void keep_counts(Shot *shot, const Packet *packet) {
    shot->counts = packet->counts;
    shot->gi = packet->gi;
}

// Frames as a player's machine would make them: packet and drawing, without reading back.
static bool time_frames(Shot *shot) {
    u32 count = WARM_UP_FRAMES + shot->options.frame_count;
    Progress progress = progress_begin("frames", count, shot->common.quiet);
    for (u32 i = 0; i < count; i++) {
        frame_times_begin(&shot->times, shot->headless.gpu);
        f64 wall = clock_now_ms(), cpu = clock_process_cpu_ms();
        const Packet *packet = next_packet(shot);
        if (!renderer_render_image(shot->headless.renderer, packet, NULL, NULL)) return false;
        cpu = clock_process_cpu_ms() - cpu;
        wall = clock_now_ms() - wall;
        if (i >= WARM_UP_FRAMES) {
            samples_add(&shot->times.frame_ms, wall);
            samples_add(&shot->times.cpu_ms, cpu);
            frame_times_add_passes(&shot->times, shot->headless.gpu);
        }
        progress_set(&progress, i + 1, NULL);
    }
    progress_end(&progress);
    return true;
}

static int draw_one(Shot *shot) {
    const ShotOptions *options = &shot->options;
    session_advance(&shot->session, options->tick);
    const Packet *packet = next_packet(shot);
    if (!renderer_warm_up_path(shot->headless.renderer, packet)) return TOOL_ENVIRONMENT;
    if ((options->stats || shot->common.json) && !time_frames(shot)) return TOOL_ENVIRONMENT;
    shot->view.cold = true; // those that were timed were not: a player's are not either
    packet = next_packet(shot);
    keep_counts(shot, packet);
    RenderImage image;
    if (!renderer_render_image(shot->headless.renderer, packet, &shot->session.frame, &image))
        return TOOL_ENVIRONMENT;
    shot->image_hash = image.hash;
    if (options->out && !write_image(shot, &image, options->out)) return TOOL_ENVIRONMENT;
    if (options->frame_file &&
        !frame_file_write(options->frame_file, packet, &shot->session.assets))
        return TOOL_ENVIRONMENT;
    return TOOL_OK;
}

static int draw_split(Shot *shot) {
    session_advance(&shot->session, shot->options.tick);
    Split *split = &shot->split;
    const Packet *a, *b;
    session_frame_begin(&shot->session);
    shot->view.settings = split->settings[0];
    shot->view.cold = true;
    if (!session_packet_split(&shot->session, &shot->view, &split->settings[1], &a, &b))
        return TOOL_USAGE;
    if (!split_draw(split, shot->headless.renderer, a, b, &shot->session.frame))
        return TOOL_ENVIRONMENT;
    keep_counts(shot, a);
    shot->image_hash = split->image.hash;
    if (shot->options.out && !write_image(shot, &split->image, shot->options.out))
        return TOOL_ENVIRONMENT;
    if (!shot->common.json) split_print(split);
    return TOOL_OK;
}

static int draw_range(Shot *shot) {
    const u32 *range = shot->options.range;
    shot->view.cold = true; // whatever the range begins with
    session_advance(&shot->session, range[0]);
    const Packet *packet = next_packet(shot);
    if (!renderer_warm_up_path(shot->headless.renderer, packet)) return TOOL_ENVIRONMENT;
    Progress progress = progress_begin("ticks", range[1] - range[0] + 1, shot->common.quiet);
    // Each picture is its own: the notes of single files would drown the bar.
    bool quiet = shot->common.quiet;
    shot->common.quiet = true;
    int result = TOOL_OK;
    for (u32 tick = range[0]; tick <= range[1] && result == TOOL_OK; tick++) {
        if (tick > range[0]) session_advance(&shot->session, 1);
        packet = next_packet(shot);
        RenderImage image;
        char name[4096];
        number_name(shot->options.out, tick, name, sizeof name);
        if (!renderer_render_image(shot->headless.renderer, packet, &shot->session.frame, &image) ||
            !write_image(shot, &image, name))
            result = TOOL_ENVIRONMENT;
        shot->image_hash = image.hash;
        keep_counts(shot, packet);
        progress_set(&progress, tick - range[0] + 1, name);
    }
    progress_end(&progress);
    shot->common.quiet = quiet;
    return result;
}

// --- stats ---

static void json_memory(Json *json, const Gpu *gpu) {
    GpuHeapStat heaps[HEAP_STATS_CAP];
    u32 count = gpu_heap_stats(gpu, heaps, HEAP_STATS_CAP);
    json_open_object(json, "memory_bytes");
    for (u32 i = 0; i < MIN(count, HEAP_STATS_CAP); i++)
        json_u64(json, heaps[i].name, heaps[i].used);
    json_close(json);
}

// What each stage of the light manager took away.
static void json_manager(Json *json, const PacketCounts *counts) {
    json_open_flat_object(json, "light_manager");
    json_u64(json, "occluded", counts->lights_occluded);
    json_u64(json, "merged", counts->lights_merged);
    json_u64(json, "merged_pairs", counts->lights_merged_pairs);
    json_f64(json, "merge_error", (f64)counts->merge_error);
    json_u64(json, "dropped", counts->lights_dropped);
    json_u64(json, "over_budget", counts->lights_over_budget);
    json_u64(json, "fading", counts->lights_fading);
    json_u64(json, "near", counts->lights_near);
    json_u64(json, "between", counts->lights_between);
    json_u64(json, "far", counts->lights_far);
    json_u64(json, "occluders", counts->occluders);
    json_u64(json, "drawables_occluded", counts->drawables_occluded);
    json_close(json);
}

static void json_gi(Json *json, const PacketCounts *counts, const PacketGi *gi,
                    const RendererStats *stats) {
    const u32 *dims = gi->record.dims;
    json_open_object(json, "gi");
    json_open_flat_array(json, "grid");
    for (u32 a = 0; a < 3; a++) json_u64(json, NULL, dims[a]);
    json_close(json);
    json_u64(json, "cascades", dims[3]);
    json_f64(json, "voxel_m", (f64)gi->record.origin[0][3]);
    json_u64(json, "instances", gi->record.counts[1]);
    json_u64(json, "lights", counts->gi_lights);
    json_u64(json, "light_indices", counts->gi_light_indices);
    json_u64(json, "traced_lights", gi->record.counts[0]);
    json_u64(json, "voxels", stats->gi_voxels);
    json_u64(json, "dynamic_voxels", stats->gi_dynamic_voxels);
    json_u64(json, "lost_voxels", stats->gi_lost_voxels);
    json_u64(json, "static_voxelised", stats->gi_static_voxelised);
    json_u64(json, "dynamic_voxelised", stats->gi_dynamic_voxelised);
    json_u64(json, "relit", stats->gi_relit);
    json_u64(json, "probes_traced", stats->gi_probes_traced);
    json_u64(json, "probes_refreshed", stats->gi_probes_refreshed);
    json_u64(json, "bytes", stats->gi_bytes);
    json_hash(json, "static_key", gi->static_key);
    json_hash(json, "dynamic_key", gi->dynamic_key);
    json_hash(json, "light_key", gi->light_key);
    json_close(json);
}

static void json_counts(Json *json, const Shot *shot) {
    const PacketCounts *counts = &shot->counts;
    RendererStats stats = renderer_stats(shot->headless.renderer);
    json_open_flat_object(json, "lights");
    json_u64(json, "total", counts->lights_total);
    json_u64(json, "visible", counts->lights_visible);
    json_u64(json, "shaded", counts->lights_shaded);
    json_close(json);
    json_manager(json, counts);
    json_open_flat_object(json, "drawables");
    json_u64(json, "total", counts->drawables_total);
    json_u64(json, "visible", counts->drawables_visible);
    json_u64(json, "shadow_casters", counts->shadow_casters);
    json_close(json);
    json_u64(json, "triangles", counts->triangles);
    json_u64(json, "draw_calls", stats.draw_calls);
    json_u64(json, "list_indices", stats.list_indices);
    json_u64(json, "list_longest", stats.list_longest);
    json_u64(json, "list_fallbacks", stats.list_fallbacks);
    json_u64(json, "list_clusters", stats.clusters);
    json_open_flat_object(json, "tiles");
    json_u64(json, "count", counts->cell_count);
    json_u64(json, "longest", counts->cell_light_max);
    json_u64(json, "light_indices", counts->light_index_count);
    json_close(json);
    if (shot->gi.params.enabled) json_gi(json, counts, &shot->gi, &stats);
}

static Json shot_stats(Shot *shot) {
    const GpuInfo *info = gpu_info(shot->headless.gpu);
    Json json = json_begin();
    char word[64], driver[520];
    snprintf(driver, sizeof driver, "%s %s", info->driver_name, info->driver_info);
    json_open_object(&json, NULL);
    json_text(&json, "device", info->device_name);
    json_text(&json, "driver", driver);
    json_text(&json, "build", luz_build_id);
    json_text(&json, "level", shot->level);
    json_text(&json, "camera", shot->view.camera ? shot->view.camera : "");
    json_text(&json, "path", settings_word("path", shot->view.settings.path, word, sizeof word));
    json_open_flat_array(&json, "size");
    json_u64(&json, NULL, shot->view.width_px);
    json_u64(&json, NULL, shot->view.height_px);
    json_close(&json);
    json_f64(&json, "scale", (f64)shot->view.settings.scale);
    json_u64(&json, "tick", shot->session.world->tick);
    json_u64(&json, "frames", shot->times.frame_ms.count);
    json_samples(&json, "frame_ms", &shot->times.frame_ms);
    json_samples(&json, "cpu_ms", &shot->times.cpu_ms);
    json_open_object(&json, "passes");
    for (u32 i = 0; i < shot->times.pass_count; i++)
        json_f64(&json, shot->times.passes[i].name,
                 samples_percentile(&shot->times.passes[i].ms, 0.5));
    json_close(&json);
    const PacketBuildTimes *packet = &shot->session.packet_times;
    json_open_flat_object(&json, "packet_ms");
    json_f64(&json, "cull", (f64)packet->cull_ms);
    json_f64(&json, "lights", (f64)packet->lights_ms);
    json_f64(&json, "grid", (f64)packet->grid_ms);
    json_f64(&json, "pack", (f64)packet->pack_ms);
    json_f64(&json, "gi", (f64)packet->gi_ms);
    json_close(&json);
    json_counts(&json, shot);
    json_memory(&json, shot->headless.gpu);
    json_hash(&json, "world_hash", world_hash(shot->session.world));
    json_hash(&json, "image_hash", shot->image_hash);
    if (shot->options.split.ways[0]) split_json(&shot->split, &json);
    json_u64(&json, "validation_messages", gpu_validation_message_count(shot->headless.gpu));
    json_close(&json);
    return json;
}

static int write_stats(Shot *shot) {
    if (!shot->options.stats && !shot->common.json) return TOOL_OK;
    Json json = shot_stats(shot);
    bool ok = !shot->options.stats || json_save(&json, shot->options.stats);
    if (shot->common.json) json_print(&json);
    json_free(&json);
    return ok ? TOOL_OK : TOOL_ENVIRONMENT;
}

// --- the command ---

static int shot_draw(Shot *shot) {
    if (!headless_load(&shot->session, shot->level, &shot->common)) return TOOL_DIFFERENT;
    const char *camera = headless_camera(&shot->session, shot->options.camera);
    u32 internal[2];
    headless_internal_size(&shot->view.settings, shot->options.size, internal);
    shot->view.camera = camera;
    shot->view.width_px = internal[0];
    shot->view.height_px = internal[1];
    if (!next_packet(shot)) return TOOL_USAGE; // no such camera: said by the session
    if (!headless_open(&shot->headless, &shot->common)) return TOOL_ENVIRONMENT;
    if (!renderer_set_assets(shot->headless.renderer, &shot->session.assets))
        return TOOL_ENVIRONMENT;
    int result = shot->options.split.ways[0] ? draw_split(shot)
                 : shot->options.has_range   ? draw_range(shot)
                                             : draw_one(shot);
    if (result == TOOL_OK) result = write_stats(shot);
    u32 messages = gpu_validation_message_count(shot->headless.gpu);
    if (result == TOOL_OK && messages)
        result = tool_fail(TOOL_DIFFERENT, "shot", "%u validation messages", messages);
    return result;
}

static int shot_run(int argc, char **argv) {
    static Shot shot; // large arrays
    shot = (Shot){.options = {.size = {1280, 720}, .split = SPLIT_OPTIONS_DEFAULT},
                  .view = {.settings = settings_default()}};
    ShotOptions *o = &shot.options;
    const ToolOption options[] = {
        {"out", 'o', OPTION_TEXT, &o->out, "FILE", "the picture (PNG)"},
        {"size", 's', OPTION_SIZE, &o->size, "WxH", "window size, default 1280x720"},
        {"path", 'p', OPTION_TEXT, &o->path, "P", "one of: " PATH_WORDS},
        {"view", 0, OPTION_TEXT, &o->view, "V",
         "picture shown, final or a debug one: see `luz info`"},
        {"camera", 'c', OPTION_TEXT, &o->camera, "NAME",
         "default: \"main\", else the first, else the player"},
        {"tick", 0, OPTION_U32, &o->tick, "N", "simulate N ticks (1/60 s) first"},
        {"frames", 'n', OPTION_TEXT, &o->frames, "N|A..B",
         "time N frames of one tick (default 1, with --stats 9);\n"
         "or draw ticks A to B into -o name_%04d.png"},
        {"preset", 0, OPTION_TEXT, &o->preset, "NAME", headless_preset_help()},
        {"set", 0, OPTION_LIST, &o->sets, "KEY=VALUE", "a render setting, repeatable"},
        SPLIT_TOOL_OPTIONS(o->split),
        {"stats", 0, OPTION_TEXT, &o->stats, "FILE", "measurements as JSON"},
        {"record-frame", 0, OPTION_TEXT, &o->frame_file, "FILE",
         "the frame as .luzf, for `luz replay`"},
    };
    const ToolSpec spec = {
        .command = "shot",
        .synopsis = "LEVEL -o OUT.png [options]",
        .about = "Draws a level (.toml, .gltf, .glb) without a window. The picture has the "
                 "internal size:\n"
                 "--size times the setting `scale`. Settings: see `luz info`.",
        .options = options,
        .option_count = COUNT_OF(options),
        .positional_min = 1,
        .positional_max = 1,
        .examples = "  luz shot data/levels/cloister.toml -o cloister.png\n"
                    "  luz shot model.glb -o model.png --size 640x360 --set exposure=2\n"
                    "  luz shot data/levels/cloister.toml -o t_%03d.png --frames 0..59\n"
                    "  luz shot data/levels/cloister.toml --stats stats.json --frames 31\n"
                    "  luz shot data/levels/cloister.toml -o split.png --split forward "
                    "deferred,layout=packed\n",
    };
    ToolList positional;
    ToolParse parsed = tool_parse(&spec, argc, argv, &shot.common, &positional);
    if (parsed != PARSE_RUN) return parsed == PARSE_HELP ? TOOL_OK : TOOL_USAGE;
    if (!options_are_sound(o, &shot.common) ||
        (o->preset && !settings_set_preset(&shot.view.settings, o->preset)) ||
        !headless_settings(&shot.view.settings, o->path, o->view, &o->sets))
        return TOOL_USAGE;
    if (o->split.ways[0] && !split_begin(&shot.split, &o->split, &shot.view.settings, spec.command))
        return TOOL_USAGE;
    shot.level = positional.items[0];
    if (!o->frames && shot.common.json) o->frame_count = STATS_FRAMES;
    tool_begin(&shot.common);
    int result = TOOL_ENVIRONMENT;
    if (session_create(&shot.session, tool_session())) result = shot_draw(&shot);
    headless_close(&shot.headless);
    session_destroy(&shot.session);
    frame_times_free(&shot.times);
    tool_end();
    return result;
}

const ToolCommand tool_shot = {"shot", "draw a level into a picture, and measure it", shot_run};
