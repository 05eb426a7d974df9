// app.c: a session and a device together: opening, ticking, packets, errors on the screen.
//
// Data in: AppDesc, inputs. Data out: a world that advances, frame packets, pictures. Called by:
// luz.c, window.c, headless.c. Does not: know a window system; write files (app_files.c); know what
// keys mean (app_keys.c).
#include "app.h"
#include "../base/clock.h"
#include "../base/jobs.h"
#include "../base/log.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SHADER_DIRECTORY "shaders"
#define REPLAY_ARENA_CAP GIB(2)

// Lines of the on-screen texts, in window pixels.
#define TEXT_SIZE_PX    13.0f
#define TEXT_LEFT_PX    12.0f
#define TEXT_TOP_PX     10.0f
#define TEXT_LINE_PX    16.0f
#define TEXTS_CAP       160
#define ERROR_LINES_MAX 14
#define SPLIT_TEXT_CAP  256
#define COLOR_MESSAGE   0xFFFFFFFFu // red in the low byte
#define COLOR_ERROR     0xFF6060FFu
#define COLOR_HELP      0xFFF0E8D8u

// --- Life ---

static bool directory_exists(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

bool app_create(App *app, const AppDesc *desc) {
    *app = (App){.desc = *desc, .panel = desc->panel, .start_ms = clock_now_ms()};
    if (!app->desc.title) app->desc.title = "luz";
    if (!app->desc.width_px) app->desc.width_px = APP_DEFAULT_WIDTH;
    if (!app->desc.height_px) app->desc.height_px = APP_DEFAULT_HEIGHT;
    if (!app->desc.out_directory) app->desc.out_directory = "out";
    app->settings = desc->settings ? *desc->settings : settings_default();
    app->split = desc->split != NULL;
    app->split_view.at = 0.5f;
    app->other_settings = app->split ? *desc->split : app->settings;
    // Something else to see, and fast enough for every level on every device.
    if (!app->split) app->other_settings.path = PATH_TILED_FORWARD;
    app->has_shader_directory = directory_exists(SHADER_DIRECTORY);
    jobs_start(desc->threads);
    SessionDesc session = {.components = desc->components,
                           .component_count = desc->component_count,
                           .systems = desc->systems,
                           .system_count = desc->system_count,
                           .user = desc->user,
                           .on_load = desc->on_load};
    bool ok = session_create(&app->session, &session) &&
              arena_create(&app->replay_arena, "replay", REPLAY_ARENA_CAP);
    if (ok && desc->replay_path)
        ok = app_replay_open(app, desc->replay_path);
    else if (ok && desc->level)
        ok = app_load(app, desc->level);
    else if (ok && desc->fill)
        ok = session_fill(&app->session, desc->fill, desc->user);
    if (ok && desc->camera) app_set_camera(app, desc->camera);
    if (ok && desc->record_path) app_record_start(app, desc->record_path);
    if (!ok) app_destroy(app);
    return ok;
}

void app_destroy(App *app) {
    app_record_stop(app);
    app_close_device(app);
    if (app->replay_arena.memory) arena_destroy(&app->replay_arena);
    if (app->session.frame.memory) session_destroy(&app->session);
    jobs_stop();
    *app = (App){0};
}

bool app_open_device(App *app, const GpuDesc *window) {
    GpuDesc desc = window ? *window : (GpuDesc){0};
    desc.label = app->desc.title;
    desc.device = app->desc.device;
    desc.validation = app->desc.validation;
    // The panel shows what a pass costs, also on a driver that would blame its neighbour. Passes
    // wait for each other anyway.
    desc.accurate_timers = true;
    app->gpu = gpu_create(&desc);
    if (!app->gpu) return false; // the log says which package to install
    app->renderer = renderer_create(app->gpu);
    if (!app->renderer) {
        app_close_device(app);
        return false;
    }
    return true;
}

void app_close_device(App *app) {
    if (app->renderer) renderer_destroy(app->renderer);
    if (app->gpu) gpu_destroy(app->gpu);
    app->renderer = NULL;
    app->gpu = NULL;
    app->assets_in_use = 0;
}

bool app_upload_assets(App *app) {
    if (!app->session.world || app->assets_in_use == app->session.assets.stamp) return true;
    app->assets_in_use = app->session.assets.stamp;
    return renderer_set_assets(app->renderer, &app->session.assets);
}

// --- Levels and shaders ---

static void app_collect_level_error(App *app) {
    const Diagnostics *diagnostics = app->session.diagnostics;
    u64 used = 0;
    app->level_error[0] = 0;
    for (u32 i = 0; diagnostics && i < MIN(diagnostics->count, LEVEL_DIAGNOSTICS_MAX); i++) {
        const Diagnostic *item = &diagnostics->items[i];
        if (!item->is_error) continue;
        u64 left = sizeof app->level_error - used;
        if (left < 2) break;
        diagnostic_format(item, app->level_error + used, left);
        used += strlen(app->level_error + used);
    }
    if (!app->level_error[0]) snprintf(app->level_error, sizeof app->level_error, "unknown error");
}

// The camera that was looked through may be gone.
static void app_check_camera(App *app) {
    if (app->camera[0] && session_camera(&app->session, app->camera) == ENTITY_NONE)
        app_set_camera(app, NULL);
}

bool app_load(App *app, const char *path) {
    // A recording is of one level, from its start on.
    app_record_stop(app);
    bool ok = session_load(&app->session, path);
    const Diagnostics *diagnostics = app->session.diagnostics;
    if (diagnostics && diagnostics->count > 0) diagnostics_print(diagnostics, stderr);
    if (ok) {
        app->level_error[0] = 0;
        app_check_camera(app);
    } else {
        app_collect_level_error(app);
    }
    return ok;
}

bool app_restart(App *app) {
    if (app->desc.fill && !app->session.level_path[0]) {
        app_record_stop(app);
        return session_fill(&app->session, app->desc.fill, app->desc.user);
    }
    char path[sizeof app->session.root_path + sizeof app->session.level_path + 1];
    snprintf(path, sizeof path, "%s/%s", app->session.root_path, app->session.level_path);
    return app_load(app, path);
}

static void app_poll_level(App *app) {
    int result = session_poll_reload(&app->session);
    if (result == 0) return;
    if (app->session.diagnostics->count > 0) diagnostics_print(app->session.diagnostics, stderr);
    if (result > 0) {
        app->level_error[0] = 0;
        app_record_stop(app);
        app_check_camera(app);
        app_say(app, "level reloaded");
    } else {
        app_collect_level_error(app);
    }
}

void app_poll_files(App *app, f64 now_ms) {
    // A replay needs the level as it was.
    if (now_ms >= app->next_poll_ms && app->session.world && !app->has_replay) {
        app->next_poll_ms = now_ms + APP_RELOAD_POLL_MS;
        app_poll_level(app);
    }
    if (now_ms < app->next_shader_poll_ms || !app->has_shader_directory || !app->gpu) return;
    app->next_shader_poll_ms = now_ms + APP_SHADER_POLL_MS;
    u32 rebuilt = gpu_reload_shaders(app->gpu, SHADER_DIRECTORY);
    if (rebuilt > 0) app_say(app, "shaders reloaded: %u pipelines", rebuilt);
    snprintf(app->shader_error, sizeof app->shader_error, "%s", gpu_shader_error(app->gpu));
}

// --- Time ---

void app_check_replay(App *app) {
    RecordingDifference difference;
    bool same =
        recording_check_tick(app->replay_check, app->replay_tick, app->session.world, &difference);
    // The first difference tells; those that follow come from it.
    if (!same && app->replay_differences++ == 0) app_say(app, "%s", difference.text);
}

bool app_tick(App *app, Input input) {
    if (app->has_replay) {
        if (app->replay_tick >= app->replay.tick_count) return false;
        input = app->replay.inputs[app->replay_tick];
    }
    session_tick(&app->session, input);
    if (app->has_replay) {
        app->replay_tick++;
        app_check_replay(app);
    }
    if (app->writer) recording_writer_tick(app->writer, input, app->session.world);
    return true;
}

// --- Cameras ---

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

u32 app_cameras(const App *app, const char **out, u32 out_cap) {
    const World *world = app->session.world;
    if (!world) return 0;
    const Table *cameras = world->tables[COMPONENT_camera];
    u32 count = 0;
    for (u32 row = 0; row < cameras->count && count < out_cap; row++) {
        if (cameras->entity[row] == app->session.player) continue;
        const char *name = world_name(world, cameras->entity[row]);
        if (name[0]) out[count++] = name;
    }
    qsort(out, count, sizeof *out, compare_names);
    return count;
}

void app_set_camera(App *app, const char *name) {
    if (name && name[0] && session_camera(&app->session, name) == ENTITY_NONE) {
        app_say(app, "there is no camera '%s' in this level", name);
        name = NULL;
    }
    snprintf(app->camera, sizeof app->camera, "%s", name ? name : "");
}

// --- Texts ---

void app_say(App *app, const char *format, ...) {
    char text[sizeof app->messages[0].text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    LOG(NOTE, "%s", text);
    memmove(&app->messages[1], &app->messages[0], sizeof app->messages - sizeof app->messages[0]);
    memcpy(app->messages[0].text, text, sizeof text);
    app->messages[0].until_ms = clock_now_ms() + APP_MESSAGE_SECONDS * 1000.0;
}

typedef struct TextList {
    PacketText2D items[TEXTS_CAP];
    u32 count;
    f32 y_px; // of the next line
} TextList;

static void texts_add_line(TextList *list, u32 color, const char *text) {
    if (list->count >= TEXTS_CAP) return;
    list->items[list->count++] =
        (PacketText2D){TEXT_LEFT_PX, list->y_px, TEXT_SIZE_PX, color, text};
    list->y_px += TEXT_LINE_PX;
}

// A text of several lines, cut off (with a word about it) when it would fill the screen.
static void texts_add_block(TextList *list, Arena *arena, u32 color, const char *text) {
    u32 lines = 0;
    while (*text && lines < ERROR_LINES_MAX) {
        u32 length = (u32)strcspn(text, "\n");
        texts_add_line(list, color, arena_format(arena, "%.*s", (int)length, text));
        text += length + (text[length] == '\n');
        lines++;
    }
    if (*text) texts_add_line(list, color, "...");
}

// Where A and B differ, in words.
static void texts_add_split(App *app, TextList *list) {
    static const char *const modes[SPLIT_MODE_COUNT] = {"left A, right B", "difference of A and B",
                                                        "left A, difference, right B"};
    Arena *arena = &app->session.frame;
    char *text = arena_push(arena, SPLIT_TEXT_CAP, 1);
    u32 used =
        (u32)snprintf(text, SPLIT_TEXT_CAP,
                      "%s (X ends it):", modes[MIN(app->split_view.mode, SPLIT_MODE_COUNT - 1)]);
    u32 count = 0;
    for (u32 i = 0; i < render_setting_count; i++) {
        const SettingDesc *desc = &render_setting_descs[i];
        const RenderSettings *ways[2] = {&app->settings, &app->other_settings};
        char a[64], b[64];
        if (desc->offset == offsetof(RenderSettings, scale) ||
            desc->offset == offsetof(RenderSettings, target_ms))
            continue;
        setting_text(ways[0], desc, a, sizeof a);
        setting_text(ways[1], desc, b, sizeof b);
        if (strcmp(a, b) == 0 || used + 1 >= SPLIT_TEXT_CAP) continue;
        used += (u32)snprintf(text + used, SPLIT_TEXT_CAP - used, "%s %s %s | %s",
                              count++ ? "," : "", desc->name, a, b);
    }
    texts_add_line(list, COLOR_MESSAGE, count ? text : "A and B are the same (X ends it)");
}

static void texts_add_states(App *app, TextList *list) {
    Arena *arena = &app->session.frame;
    f64 now = clock_now_ms();
    if (app->level_error[0]) {
        texts_add_line(list, COLOR_ERROR, "the level has errors; the last good one goes on:");
        texts_add_block(list, arena, COLOR_ERROR, app->level_error);
    }
    if (app->shader_error[0]) {
        texts_add_line(list, COLOR_ERROR, "a shader has errors; the last good one goes on:");
        texts_add_block(list, arena, COLOR_ERROR, app->shader_error);
    }
    for (u32 i = APP_MESSAGES_CAP; i-- > 0;)
        if (app->messages[i].until_ms > now)
            texts_add_line(list, COLOR_MESSAGE, app->messages[i].text);
    if (app->split) texts_add_split(app, list);
    if (app->paused) texts_add_line(list, COLOR_MESSAGE, "paused (P goes on)");
    if (app->writer) texts_add_line(list, COLOR_ERROR, "recording (F5 stops)");
    if (app->help)
        for (const char *const *line = app_key_help(); *line; line++)
            texts_add_line(list, COLOR_HELP, *line);
}

u32 app_texts(App *app, u32 width_px, u32 height_px, const PacketText2D **out, u32 *boxed) {
    Arena *arena = &app->session.frame;
    TextList *list = ARENA_PUSH(arena, TextList, 1);
    list->y_px = TEXT_TOP_PX;
    *out = list->items;
    texts_add_states(app, list);
    bool covered = app->help || app->level_error[0] || app->shader_error[0];
    *boxed = covered ? list->count : 0;
    if (!app->desc.hud || covered || !app->session.world) return list->count;
    AppHud hud = {.session = &app->session,
                  .settings = &app->settings,
                  .counts = &app->counts,
                  .fps = app->fps,
                  .frame_ms = app->frame_ms[app->frame_index],
                  .seconds = app->session.world->tick * (f64)TICK_SECONDS,
                  .width_px = width_px,
                  .height_px = height_px,
                  .paused = app->paused,
                  .arena = arena};
    u32 room = MIN(TEXTS_CAP - list->count, APP_HUD_CAP);
    u32 added = app->desc.hud(&hud, list->items + list->count, room, app->desc.user);
    LUZ_ASSERT(added <= room);
    return list->count + added;
}

// --- Packets and pictures ---

void app_internal_size(f32 scale, u32 width_px, u32 height_px, u32 *internal_width_px,
                       u32 *internal_height_px) {
    f32 width = (f32)width_px * scale + 0.5f, height = (f32)height_px * scale + 0.5f;
    *internal_width_px = (u32)CLAMP(width, APP_SIDE_MIN_PX, PACKET_SIDE_MAX);
    *internal_height_px = (u32)CLAMP(height, APP_SIDE_MIN_PX, PACKET_SIDE_MAX);
}

// other: NULL = none is wanted. cold: see SessionView.
static const Packet *app_packet_of(App *app, const char *camera, u32 width_px, u32 height_px,
                                   bool cold, const Packet **other) {
    if (other) *other = NULL;
    session_frame_begin(&app->session);
    if (!app->session.world) return NULL;
    app_internal_size(app->settings.scale, width_px, height_px, &app->internal_width_px,
                      &app->internal_height_px);
    SessionView view = {.camera = camera,
                        .settings = app->settings,
                        .width_px = app->internal_width_px,
                        .height_px = app->internal_height_px,
                        .cold = cold};
    f64 start = clock_now_ms();
    const Packet *packet = NULL;
    if (!other || !app->split)
        packet = session_packet(&app->session, &view);
    else
        session_packet_split(&app->session, &view, &app->other_settings, &packet, other);
    app->packet_ms = (f32)(clock_now_ms() - start);
    if (packet) app->counts = packet->counts;
    return packet;
}

const Packet *app_packets(App *app, u32 width_px, u32 height_px, const Packet **other) {
    return app_packet_of(app, app->camera[0] ? app->camera : NULL, width_px, height_px, false,
                         other);
}

const Packet *app_packet(App *app, u32 width_px, u32 height_px) {
    return app_packets(app, width_px, height_px, NULL);
}

bool app_picture(App *app, const char *camera, u32 width_px, u32 height_px, RenderImage *out) {
    if (!app_upload_assets(app)) return false;
    const Packet *other, *packet = app_packet_of(app, camera, width_px, height_px, true, &other);
    if (!packet) return false;
    return other ? renderer_render_split(app->renderer, packet, other, &app->split_view,
                                         &app->session.frame, out)
                 : renderer_render_image(app->renderer, packet, &app->session.frame, out);
}
