// headless.c: the shell without a display: a tour of the level's cameras as pictures in a
// directory.
//
// Data in: an App with a level. Data out: OUT/tour/NN_camera.png, a table on stdout (name, lights,
// milliseconds, hash). Called by: luz.c, when there is no display or the desc asks for it.
// Does not: need a window system; nor, for a replay, a device: a replay only simulates and checks.
#include "../base/clock.h"
#include "../base/file.h"
#include "../base/log.h"
#include "app.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Between two pictures the world goes on for so long, so that what moves has moved.
#define TICKS_BETWEEN_PICTURES 60u
// A camera given by name is followed for so many pictures.
#define PICTURES_OF_ONE_CAMERA 12u
#define BAR_WIDTH              40u

// A bar on a terminal; elsewhere (a file, a pipe) the table is enough.
static void show_progress(u32 done, u32 total, const char *what) {
    if (!isatty(STDERR_FILENO)) return;
    u32 filled = total ? done * BAR_WIDTH / total : BAR_WIDTH;
    char bar[BAR_WIDTH + 1];
    for (u32 i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    fprintf(stderr, "\r[%s] %u/%u %-24.24s%s", bar, done, total, what, done == total ? "\n" : "");
}

static int headless_replay(App *app) {
    f64 start = clock_now_ms();
    while (app_tick(app, (Input){0})) {
    }
    f64 seconds = (clock_now_ms() - start) / 1000.0;
    if (app->replay_differences > 0) {
        printf("replay: %u ticks, not all as recorded\n", app->replay_tick);
        return APP_FAILED;
    }
    printf("replay: %u ticks in %.1f s, every one as recorded\n", app->replay_tick, seconds);
    return APP_OK;
}

// A camera's name may hold anything; a file's name only what every system takes.
static void picture_path(const App *app, u32 index, const char *name, char *out, u64 out_cap) {
    char safe[64];
    u32 length = 0;
    for (; name[length] && length + 1 < sizeof safe; length++) {
        char c = name[length];
        safe[length] = isalnum((unsigned char)c) || c == '-' || c == '_' ? c : '_';
    }
    safe[length] = 0;
    snprintf(out, out_cap, "%s/tour/%02u_%s.png", app->desc.out_directory, index, safe);
}

typedef struct TourRow {
    char name[48];
    PacketCounts counts;
    u32 tick;
    f32 ms;
    u64 hash;
} TourRow;

// *write becomes false if the picture cannot be written. False: nothing was drawn.
static bool tour_picture(App *app, u32 index, const char *camera, bool *write, TourRow *row) {
    RenderImage image;
    f64 start = clock_now_ms();
    if (!app_picture(app, camera, app->desc.width_px, app->desc.height_px, &image)) return false;
    *row = (TourRow){.counts = app->counts,
                     .tick = app->session.world->tick,
                     .ms = (f32)(clock_now_ms() - start),
                     .hash = image.hash};
    snprintf(row->name, sizeof row->name, "%s", camera ? camera : "player");
    if (!*write) return true;
    char path[1024];
    picture_path(app, index, row->name, path, sizeof path);
    *write = image_write_png(path, image.rgba, image.width_px, image.height_px, 4);
    return true;
}

// Shaders are compiled at their first use: that time belongs to no picture.
static void warm_up(App *app, const char *camera) {
    RenderImage image;
    app_picture(app, camera, app->desc.width_px, app->desc.height_px, &image);
}

static void print_tour(const TourRow *rows, u32 count, bool written, const char *directory) {
    printf("%-3s %-24s %7s %7s %7s %9s %8s  %s\n", "#", "camera", "tick", "lights", "shaded",
           "triangles", "ms", "hash");
    for (u32 i = 0; i < count; i++) {
        const TourRow *row = &rows[i];
        printf("%-3u %-24s %7u %7u %7u %9u %8.1f  %016llx\n", i, row->name, row->tick,
               row->counts.lights_total, row->counts.lights_shaded, row->counts.triangles,
               (f64)row->ms, (unsigned long long)row->hash);
    }
    if (written) printf("%u pictures in %s/tour\n", count, directory);
}

static int headless_tour(App *app) {
    const char *names[APP_CAMERAS_CAP];
    u32 count = 0;
    if (app->camera[0]) {
        for (; count < PICTURES_OF_ONE_CAMERA; count++) names[count] = app->camera;
    } else {
        count = app_cameras(app, names, APP_CAMERAS_CAP);
        if (count == 0) names[count++] = NULL; // the player's eyes
    }
    char directory[600];
    snprintf(directory, sizeof directory, "%s/tour", app->desc.out_directory);
    bool write = file_make_directories(directory);
    warm_up(app, names[0]);
    TourRow rows[APP_CAMERAS_CAP];
    u32 done = 0;
    bool ok = true;
    for (; ok && done < count; done++) {
        show_progress(done, count, names[done] ? names[done] : "player");
        if (done > 0)
            for (u32 i = 0; i < TICKS_BETWEEN_PICTURES; i++) app_tick(app, (Input){0});
        ok = tour_picture(app, done, names[done], &write, &rows[done]);
        app_write_status(app, app->desc.width_px, app->desc.height_px);
    }
    if (ok) show_progress(count, count, "done");
    print_tour(rows, ok ? done : done - 1, write, app->desc.out_directory);
    u32 messages = gpu_validation_message_count(app->gpu);
    if (messages > 0) fprintf(stderr, "luz: %u messages of the validation layer\n", messages);
    if (!write)
        fprintf(stderr, "luz: pictures cannot be written to %s; --out names another directory\n",
                directory);
    if (!ok || messages > 0) return APP_FAILED;
    return write ? APP_OK : APP_ENVIRONMENT;
}

int app_run_headless(App *app) {
    app->desc.headless = true;
    if (!app->session.world) return APP_FAILED;
    if (app->has_replay) return headless_replay(app);
    u32 ticks = (u32)(app->desc.seconds * TICK_RATE);
    for (u32 i = 0; i < ticks; i++) app_tick(app, (Input){0});
    if (!app->gpu && !app_open_device(app, NULL)) return APP_ENVIRONMENT;
    if (!app_upload_assets(app)) LOG(RENDER_LIMIT, "not everything fits into the device's memory");
    return headless_tour(app);
}
