// app_keys.c: what keys mean: one table of key, words for the help, function.
//
// Data in: keys that went down. Data out: changes of an App (settings, camera, wishes). Called by:
// window.c. Does not: walk (controls_glfw.c) or handle the window's own keys (F11, Escape).
#include "app.h"
#include <stdio.h>
#include <string.h>

// GLFW's numbers of the keys that have no character; equal for all of GLFW 3.
enum {
    KEY_F1 = 290,
    KEY_F2,
    KEY_F3,
    KEY_F4,
    KEY_F5,
    KEY_F6,
    KEY_F12 = 301,
    KEY_TAB = 258,
    KEY_KP_SUBTRACT = 333,
    KEY_KP_ADD = 334
};

static void say_setting(App *app, const char *name, u32 value) {
    char word[64];
    app_say(app, "%s: %s", name, settings_word(name, value, word, sizeof word));
}

static void set_path(App *app, RenderPath path) {
    app->settings.path = path;
    say_setting(app, "path", path);
}
// Keys 1 to 8: the paths in the order of RenderPath.
_Static_assert(PATH_COUNT == 8, "a key for each path");
static void key_path_1(App *app) { set_path(app, 0); }
static void key_path_2(App *app) { set_path(app, 1); }
static void key_path_3(App *app) { set_path(app, 2); }
static void key_path_4(App *app) { set_path(app, 3); }
static void key_path_5(App *app) { set_path(app, 4); }
static void key_path_6(App *app) { set_path(app, 5); }
static void key_path_7(App *app) { set_path(app, 6); }
static void key_path_8(App *app) { set_path(app, 7); }

static void turn_view(App *app, u32 by) {
    app->settings.view = (app->settings.view + by) % VIEW_COUNT;
    say_setting(app, "view", app->settings.view);
}
static void key_next_view(App *app) { turn_view(app, 1); }
static void key_last_view(App *app) { turn_view(app, VIEW_COUNT - 1); }

static void key_subgroup_cull(App *app) {
    app->settings.subgroup_cull = !app->settings.subgroup_cull;
    app_say(app, "subgroup light culling: %s", app->settings.subgroup_cull ? "on" : "off");
}

// By hand, so the controller must not change it back.
static void change_scale(App *app, f32 by) {
    app->settings.target_ms = 0.0f;
    app->settings.scale += by;
    settings_clamp(&app->settings);
    app_say(app, "resolution: %.0f %%", (f64)app->settings.scale * 100.0);
}
static void key_scale_up(App *app) { change_scale(app, 2 * APP_SCALE_STEP); }
static void key_scale_down(App *app) { change_scale(app, -2 * APP_SCALE_STEP); }

// The second way keeps its settings while the picture is whole.
static void key_split(App *app) {
    app->split = !app->split;
    if (!app->split) app_say(app, "one picture");
}
static void move_split(App *app, f32 by) {
    app->split_view.at = CLAMP(app->split_view.at + by, 0.0f, 1.0f);
}
static void key_split_left(App *app) { move_split(app, -APP_SPLIT_STEP); }
static void key_split_right(App *app) { move_split(app, APP_SPLIT_STEP); }
static void key_split_mode(App *app) {
    app->split_view.mode = (app->split_view.mode + 1) % SPLIT_MODE_COUNT;
    app->split = true;
}

static void key_pause(App *app) { app->paused = !app->paused; }
static void key_panel(App *app) { app->panel = !app->panel; }
static void key_help(App *app) { app->help = !app->help; }

static void key_next_camera(App *app) {
    const char *names[APP_CAMERAS_CAP];
    u32 count = app_cameras(app, names, APP_CAMERAS_CAP), next = 0;
    for (u32 i = 0; i < count; i++)
        if (strcmp(names[i], app->camera) == 0) next = i + 1;
    app_set_camera(app, next < count ? names[next] : NULL);
    app_say(app, "camera: %s", app->camera[0] ? app->camera : "your own eyes");
}

static void key_record(App *app) {
    if (app->writer)
        app_record_stop(app);
    else
        app_record_start(app, NULL);
}
static void key_frame_file(App *app) { app->want_frame_file = true; }
static void key_screenshot(App *app) { app->want_screenshot = true; }

typedef struct Key {
    int key;
    const char *help; // NULL: told by another row
    void (*function)(App *app);
} Key;

static const Key keys[] = {
    {'1', "1 .. 4     forward, multipass, deferred, deferred volumes", key_path_1},
    {'2', NULL, key_path_2},
    {'3', NULL, key_path_3},
    {'4', NULL, key_path_4},
    {'5', "5 .. 8     tiled deferred, tiled forward, clustered deferred, forward", key_path_5},
    {'6', NULL, key_path_6},
    {'7', NULL, key_path_7},
    {'8', NULL, key_path_8},
    {'V', "V B        next, previous debug view", key_next_view},
    {'B', NULL, key_last_view},
    {'L', "L          light culling in subgroups", key_subgroup_cull},
    {'=', "+ -        resolution", key_scale_up}, // + without shift
    {'+', NULL, key_scale_up},
    {KEY_KP_ADD, NULL, key_scale_up},
    {'-', NULL, key_scale_down},
    {KEY_KP_SUBTRACT, NULL, key_scale_down},
    {'X', "X          two ways beside each other; again: one", key_split},
    {'[', "[ ]        move the line between them (or drag it)", key_split_left},
    {']', NULL, key_split_right},
    {'N', "N          their difference as a picture, or a band of it", key_split_mode},
    {'P', "P          pause", key_pause},
    {KEY_F1, "F1 or Tab  debug panel", key_panel},
    {KEY_TAB, NULL, key_panel},
    {KEY_F2, "F2         next camera", key_next_camera},
    {KEY_F5, "F5         record from the level's start; again: stop", key_record},
    {KEY_F6, "F6         save this frame for a replay", key_frame_file},
    {KEY_F12, "F12        screenshot", key_screenshot},
    {'H', "H          these lines", key_help},
};

bool app_key(App *app, int key) {
    if (app->desc.key && app->desc.key(app, key, app->desc.user)) return true;
    for (u32 i = 0; i < COUNT_OF(keys); i++) {
        if (keys[i].key != key) continue;
        keys[i].function(app);
        return true;
    }
    return false;
}

const char *const *app_key_help(void) {
    static const char *const walking[] = {
        "W A S D    walk (or the arrows; mouse looks; or a gamepad)",
        "Shift      run",
        "Space C    jump; fly up and down",
        "F          fly or walk",
    };
    static const char *const window[] = {
        "F11        full screen",
        "Escape     frees the mouse; again: quits",
    };
    static const char *lines[COUNT_OF(walking) + COUNT_OF(keys) + COUNT_OF(window) + 1];
    u32 count = 0;
    for (u32 i = 0; i < COUNT_OF(walking); i++) lines[count++] = walking[i];
    for (u32 i = 0; i < COUNT_OF(keys); i++)
        if (keys[i].help) lines[count++] = keys[i].help;
    for (u32 i = 0; i < COUNT_OF(window); i++) lines[count++] = window[i];
    lines[count] = NULL;
    return lines;
}
