// app.h: a session with a device: the program that a window or a directory of pictures shows.
//
// Data in: an AppDesc. Data out: a running App. Called by: luz.c (the public face, which gives
// these types their public names), window.c, headless.c, debug_ui.cpp. An App can be opened without
// a window and stepped and drawn by hand; app_run_window and app_run_headless are the two shells.
// Does not: simulate (session.h) or draw (render.h); it puts them together and survives mishaps:
// a lost device, a broken level, a directory that cannot be written.
#ifndef LUZ_APP_H
#define LUZ_APP_H
#include "../capture/capture.h"
#include "../render/render.h"
#include "session.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct App App;

// What a HUD may want to know. All sizes are pixels of the window (or picture); times are of the
// last second.
typedef struct AppHud {
    const Session *session;
    const RenderSettings *settings;
    const PacketCounts *counts; // of the last frame
    f32 fps, frame_ms;
    f64 seconds; // since the level was loaded, in simulated time
    u32 width_px, height_px;
    bool paused;
    Arena *arena; // for the texts: lives for this frame
} AppHud;

// In every field zero means default. Texts must outlive the App.
typedef struct AppDesc {
    const char *title; // NULL = "luz"
    const char *help;  // more lines for --help; NULL = none
    const char *level; // NULL = `fill` makes the world
    // Fills an empty world from code, when there is no level; the session gives a player a place
    // afterwards, as for a level. Called again by a reload.
    bool (*fill)(World *world, AssetStore *assets, void *user);
    const ComponentDesc *const *components; // the program's own
    u32 component_count;
    const SystemPlacement *systems; // the program's own; before NULL = before "walk"
    u32 system_count;
    const RenderSettings *settings; // NULL = settings_default()
    // Windows: the same view drawn in these settings too, right of a line; NULL = not at first.
    const RenderSettings *split;
    u32 width_px, height_px;   // 0 = 1280 x 720
    u32 threads;               // 0 = all cores
    const char *device;        // part of a device's name; NULL = the best one
    const char *camera;        // to look through at first; NULL = the player's eyes
    const char *out_directory; // pictures and recordings; NULL = "out"
    f32 seconds;               // quits after so many; 0 = never
    bool validation;
    bool fullscreen;
    bool headless;   // no window even if there is a display
    bool panel;      // the debug panel is open at the start
    bool fixed_step; // exactly one tick a frame, whatever the clock says
    // Windows: scale and target_ms stay as they are in the settings. Else a software driver gets a
    // resolution that follows the frame time, because few machines draw a whole window in time.
    bool fixed_resolution;
    const char *record_path; // records from the first tick on, until the end
    const char *replay_path; // plays a recording and checks every tick
    const char *status_path; // a line of JSON a second, for tests and curious people
    // Fills out[0 .. cap) with lines of text in window pixels; returns how many.
    u32 (*hud)(const AppHud *hud, PacketText2D *out, u32 cap, void *user);
    // A key went down that does not walk (controls.c): upper-case ASCII for printable ones, else
    // GLFW's number. True = used, the engine's own meaning is skipped.
    bool (*key)(App *app, int key, void *user);
    // A level has been loaded or reloaded: world filled, derived columns set.
    void (*on_load)(Session *session, void *user);
    void *user;
} AppDesc;

#define APP_CAMERAS_CAP     256
#define APP_HUD_CAP         64
#define APP_MESSAGES_CAP    4
#define APP_MESSAGE_SECONDS 4.0
#define APP_FRAMES_SHOWN    120
#define APP_DEFAULT_WIDTH   1280
#define APP_DEFAULT_HEIGHT  720
#define APP_RELOAD_POLL_MS  250.0
#define APP_SHADER_POLL_MS  500.0
#define APP_SOFTWARE_MS     40.0f // target_ms on a software driver
#define APP_SOFTWARE_SCALE  0.5f  // where it starts
#define APP_SCALE_STEP      0.0625f
#define APP_SIDE_MIN_PX     16
#define APP_SPLIT_STEP      0.05f // of the line, by a key

typedef struct AppMessage {
    char text[256];
    f64 until_ms;
} AppMessage;

struct App {
    AppDesc desc;
    Session session;
    RenderSettings settings;
    // The picture is split: settings left of a line, other_settings right of it (same resolution).
    bool split;
    RenderSettings other_settings;
    SplitView split_view;
    Gpu *gpu; // NULL until app_open_device
    Renderer *renderer;
    u64 assets_in_use; // AssetStore.stamp that the renderer holds

    // What is looked through, and what is shown over the picture.
    char camera[128]; // "" = the player's eyes
    bool paused, help, panel;
    AppMessage messages[APP_MESSAGES_CAP];
    char level_error[4096]; // diagnostics of the newest load, while it is broken
    char shader_error[2048];
    bool has_shader_directory;
    f64 next_poll_ms, next_shader_poll_ms;

    // Recording and replay.
    RecordingWriter *writer;
    char record_path[512];
    bool record_lost; // a recording could not be written
    bool has_replay;
    Arena replay_arena;
    Recording replay;
    RecordingCheck *replay_check;
    u32 replay_tick;
    u32 replay_differences;

    // Wishes that a key voiced, granted when the frame is drawn.
    bool want_screenshot, want_frame_file, want_restart;

    // Measured.
    f64 start_ms, next_status_ms;
    u32 status_frames;
    f32 fps;
    f32 frame_ms[APP_FRAMES_SHOWN]; // a ring
    u32 frame_index;
    f32 ticks_ms, packet_ms; // CPU, last frame
    PacketCounts counts;     // of the last packet
    u32 internal_width_px, internal_height_px;
};

// --- Life ---

// Threads, session, level (if the desc has one). False with messages on stderr; then nothing stays.
bool app_create(App *app, const AppDesc *desc);
void app_destroy(App *app);

// Device and renderer. `window` adds what a surface needs to the desc (may be NULL). False with
// messages; a missing device is explained in one sentence.
bool app_open_device(App *app, const GpuDesc *window);
void app_close_device(App *app);
// Uploads the session's assets if the renderer has other ones.
bool app_upload_assets(App *app);

// --- Running ---

// Loads a level; on failure the old one stays, diagnostics are printed and shown.
bool app_load(App *app, const char *path);
// Level files every APP_RELOAD_POLL_MS, shaders every APP_SHADER_POLL_MS.
void app_poll_files(App *app, f64 now_ms);
// One tick: the given input, or the replayed one; recorded if a recording runs. False: the
// replay is over.
bool app_tick(App *app, Input input);
// Compares the world with the replayed recording after replay_tick ticks.
void app_check_replay(App *app);
// Loads the level again from its start; the player stands where it begins.
bool app_restart(App *app);
// The frame packet of what is looked at, for a picture of width x height pixels at settings.scale.
// NULL if there is no world. Valid until the next call.
const Packet *app_packet(App *app, u32 width_px, u32 height_px);
// The same; *other gets the second packet of a split picture, NULL if it is not split.
const Packet *app_packets(App *app, u32 width_px, u32 height_px, const Packet **other);
// HUD, messages, errors and help, in window pixels: after app_packet, valid as long as the packet.
// They are not in the packet, so that small internal resolutions do not blur them. The first *boxed
// of them (errors, help) want a dark ground. Returns how many.
u32 app_texts(App *app, u32 width_px, u32 height_px, const PacketText2D **out, u32 *boxed);
// One picture of what the camera sees, without a window; out's pixels lie in the session's frame
// arena, beside the packet. camera NULL = the player's eyes.
bool app_picture(App *app, const char *camera, u32 width_px, u32 height_px, RenderImage *out);
// Internal resolution for a window's: settings.scale, at least APP_SIDE_MIN_PX.
void app_internal_size(f32 scale, u32 width_px, u32 height_px, u32 *internal_width_px,
                       u32 *internal_height_px);

// Line on the screen for some seconds, and on stderr.
void app_say(App *app, const char *format, ...) PRINTF_LIKE(2, 3);
// Named cameras of the level in name order, without the player. Returns how many.
u32 app_cameras(const App *app, const char **out, u32 out_cap);
// Looks through a camera by name; NULL or "" = the player's eyes.
void app_set_camera(App *app, const char *name);

// --- Files (app_files.c). None of these ends the program: they say what went wrong. ---

void app_record_start(App *app, const char *path); // NULL = the next free out/recording_NNN.luzr
void app_record_stop(App *app);
bool app_replay_open(App *app, const char *path); // loads the level that it names
// other: the second packet of a split picture, or NULL.
void app_write_screenshot(App *app, const Packet *packet, const Packet *other);
void app_write_frame_file(App *app, const Packet *packet);
// One line of JSON, replacing the file. `text` is what is wrong at the moment ("" = nothing).
void app_write_status(App *app, u32 width_px, u32 height_px);
// out/stem_NNN.extension with the first free number. False: the directory cannot be made.
bool app_next_path(App *app, const char *stem, const char *extension, char *out, u64 out_cap);

// --- Keys (app_keys.c) ---

// Does what the key means (AppDesc.key first). False: no meaning. F11 and Escape are the window's.
bool app_key(App *app, int key);
// Lines of help: "key  what it does". NULL-terminated.
const char *const *app_key_help(void);

// --- Shells ---

// Exit codes of the program. APP_NO_WINDOW: there is no display, nothing was done.
enum {
    APP_OK = 0,
    APP_FAILED = 1,      // a level with errors, a replay that differs, validation messages
    APP_ENVIRONMENT = 3, // no device, files that cannot be written
    APP_NO_WINDOW = -1
};
int app_run_window(App *app);
int app_run_headless(App *app);

#ifdef __cplusplus
}
#endif
#endif
