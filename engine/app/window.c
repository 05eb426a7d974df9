// window.c: the shell with a window: events, frames, full screen, lost surfaces and devices.
//
// Data in: an App with a level, GLFW's events, the clock. Data out: ticks, pictures on the screen.
// Called by: luz.c. The world never notices what happens here: a lost device or surface is made
// anew, a minimised window waits without drawing.
// Does not: know Vulkan (gpu.h does), or what keys mean beyond F11 and Escape (app_keys.c).
#include "../base/clock.h"
#include "../base/log.h"
#include "app.h"
#include "controls_glfw.h"
#include "debug_ui.h"
#include "pacing.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// GLFW declares this only after Vulkan's headers, which nobody outside gpu/ includes. The same
// function in plain types: VkInstance is a pointer, VkSurfaceKHR 64 bits, VkResult an int.
extern int glfwCreateWindowSurface(void *vk_instance, GLFWwindow *window, const void *allocator,
                                   u64 *vk_surface);

#define FRAME_MS_MIN          3.0 // some systems do not throttle: 333 pictures a second are plenty
#define STATUS_MS             1000.0
#define RESIZE_RETRY_MS       20.0
#define RESIZE_FAILURES_MAX   50    // then the device is made anew
#define SPLIT_GRAB_SHARE      0.02f // so near to the line a free pointer drags it
#define BAR_AFTER_MS          150.0 // what is prepared in less shows no bar
#define BAR_EVERY_MS          50.0
#define WARM_KEYS             64 // settings whose pipelines are known to be there
#define DEVICE_LOSSES_MAX     3  // within DEVICE_LOSS_WINDOW_MS: then the driver is hopeless
#define DEVICE_LOSS_WINDOW_MS 10000.0

typedef struct Window {
    App *app;
    GLFWwindow *handle;
    DebugUi *ui;
    Controls controls;
    ControlsDevice device;
    StepClock clock;
    ScaleControl scale;
    bool ui_ready, must_resize, was_panel, drags_line, quit;
    u32 resize_failures, device_losses;
    f64 first_loss_ms;
    int restore_x, restore_y, restore_width, restore_height; // before full screen
    f64 frame_start_ms, wait_ms; // waited for the device or the screen this frame
    u64 frame_count;
    u64 warm_keys[WARM_KEYS]; // settings_switches_hash, the newest ones
    u32 warm_count;
    f64 warm_start_ms, bar_ms;
    int exit_code;
} Window;

static Window *window_of(GLFWwindow *handle) { return glfwGetWindowUserPointer(handle); }

// --- Full screen, mouse ---

static void toggle_fullscreen(Window *window) {
    GLFWwindow *handle = window->handle;
    if (glfwGetWindowMonitor(handle)) {
        glfwSetWindowMonitor(handle, NULL, window->restore_x, window->restore_y,
                             window->restore_width, window->restore_height, GLFW_DONT_CARE);
        return;
    }
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    if (!mode) {
        app_say(window->app, "no monitor for full screen");
        return;
    }
    glfwGetWindowPos(handle, &window->restore_x, &window->restore_y);
    glfwGetWindowSize(handle, &window->restore_width, &window->restore_height);
    glfwSetWindowMonitor(handle, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

static void capture_mouse(Window *window, bool capture) {
    if (window->device.captured == capture) return;
    controls_clear(&window->controls);
    controls_device_capture(&window->device, window->handle, capture);
}

// --- Events ---

static void on_glfw_error(int code, const char *text) {
    // A missing display is no error: the caller says so and goes on without.
    if (code == GLFW_PLATFORM_ERROR && strstr(text, "DISPLAY")) return;
    LOG(APP_WINDOW, "%s (%d)", text, code);
}

static void on_key(GLFWwindow *handle, int key, int scancode, int action, int mods) {
    (void)scancode, (void)mods;
    Window *window = window_of(handle);
    if (action == GLFW_REPEAT) return;
    bool down = action == GLFW_PRESS;
    if (down && debug_ui_wants_keyboard(window->ui)) return;
    if (down && key == GLFW_KEY_ESCAPE) {
        if (!window->device.captured)
            window->quit = true;
        else
            app_say(window->app, "the mouse is free; click to look around again, Escape quits");
        capture_mouse(window, false);
        return;
    }
    if (down && key == GLFW_KEY_F11) {
        toggle_fullscreen(window);
        return;
    }
    if (controls_key(&window->controls, key, down) || !down) return;
    app_key(window->app, key);
}

// The pointer's place, 0..1 of the window's width.
static f32 pointer_at(const Window *window) {
    f64 x, y;
    int width, height;
    glfwGetCursorPos(window->handle, &x, &y);
    glfwGetWindowSize(window->handle, &width, &height);
    return width > 0 ? (f32)(x / width) : 0.0f;
}

static bool is_at_split_line(const Window *window) {
    return window->app->split &&
           fabsf(pointer_at(window) - window->app->split_view.at) < SPLIT_GRAB_SHARE;
}

static void on_mouse_button(GLFWwindow *handle, int button, int action, int mods) {
    (void)button, (void)mods;
    Window *window = window_of(handle);
    window->drags_line = false;
    if (action != GLFW_PRESS || debug_ui_wants_mouse(window->ui)) return;
    window->drags_line = !window->device.captured && is_at_split_line(window);
    if (!window->drags_line) capture_mouse(window, true);
}

static void on_focus(GLFWwindow *handle, int focused) {
    // A key that goes up in another window would never go up here.
    if (!focused) {
        controls_clear(&window_of(handle)->controls);
        window_of(handle)->device.has_last = false;
    }
}

static void on_framebuffer_size(GLFWwindow *handle, int width, int height) {
    (void)width, (void)height;
    window_of(handle)->must_resize = true;
}

// --- Device ---

static int create_surface(void *vk_instance, void *window, const void *allocator, u64 *surface) {
    return glfwCreateWindowSurface(vk_instance, window, allocator, surface);
}

static bool open_device(Window *window) {
    GpuDesc desc = {.window = window->handle, .create_surface = create_surface};
    desc.instance_extensions = glfwGetRequiredInstanceExtensions(&desc.instance_extension_count);
    if (!app_open_device(window->app, &desc)) return false;
    window->must_resize = true;
    window->ui_ready = debug_ui_upload(window->ui, window->app->renderer);
    return true;
}

static void choose_resolution(Window *window) {
    App *app = window->app;
    if (app->desc.fixed_resolution || !gpu_info(app->gpu)->is_software) return;
    app->settings.target_ms = APP_SOFTWARE_MS;
    app->settings.scale = APP_SOFTWARE_SCALE;
    app_say(app, "software driver: the resolution follows the frame time; + and - choose it");
}

// False: the program must end.
static bool renew_device(Window *window) {
    f64 now = clock_now_ms();
    if (now - window->first_loss_ms > DEVICE_LOSS_WINDOW_MS) {
        window->first_loss_ms = now;
        window->device_losses = 0;
    }
    if (++window->device_losses > DEVICE_LOSSES_MAX) {
        LOG(APP_WINDOW, "the device is lost again and again; please check the driver");
        return false;
    }
    LOG(GPU_LOST, "making the device anew; the game goes on where it is");
    app_close_device(window->app);
    if (!open_device(window)) return false;
    app_say(window->app, "the graphics device was lost and made anew");
    return true;
}

// False: nothing to draw to at the moment.
static bool make_swapchain(Window *window) {
    if (!window->must_resize) return true;
    int width, height;
    glfwGetFramebufferSize(window->handle, &width, &height);
    if (width <= 0 || height <= 0) return false;
    if (gpu_swapchain_resize(window->app->gpu, (u32)width, (u32)height, true)) {
        window->must_resize = false;
        window->resize_failures = 0;
        return true;
    }
    window->resize_failures++;
    glfwWaitEventsTimeout(RESIZE_RETRY_MS / 1000.0);
    return false;
}

// --- Loading screen ---

// A bar along the top, made of two clears: it needs no pipeline, and pipelines are what is missing.
static void draw_bar(Window *window, f32 share) {
    Gpu *gpu = window->app->gpu;
    if (!make_swapchain(window)) return;
    u32 width, height;
    gpu_swapchain_size(gpu, &width, &height);
    // A warm-up asks in the middle of a frame of its own.
    bool is_inside = gpu_frame_is_open(gpu);
    GpuCommands *cmd = is_inside ? gpu_frame_continue(gpu) : gpu_frame_begin(gpu);
    if (!cmd) return;
    if (gpu_swapchain_acquire(gpu, cmd)) {
        GpuRendering back = {.to_swapchain = true, .width = width, .height = height};
        back.targets[0] = (GpuTarget){.clear = true, .clear_value = {0.02f, 0.025f, 0.04f, 1.0f}};
        gpu_cmd_begin_rendering(cmd, &back);
        gpu_cmd_end_rendering(cmd);
        GpuRendering bar = {.to_swapchain = true,
                            .width = MAX((u32)((f32)width * share), 1),
                            .height = MIN(6, height)};
        bar.targets[0] = (GpuTarget){.clear = true, .clear_value = {1.0f, 0.75f, 0.35f, 1.0f}};
        gpu_cmd_begin_rendering(cmd, &bar);
        gpu_cmd_end_rendering(cmd);
    }
    if (is_inside)
        gpu_frame_continue(gpu);
    else
        gpu_frame_end(gpu, true);
    if (!gpu_swapchain_present(gpu)) window->must_resize = true;
}

static void on_progress(void *user, u32 done, u32 total, const char *what) {
    Window *window = user;
    f64 now = clock_now_ms();
    bool is_first = window->frame_count == 0;
    if (!is_first && now - window->warm_start_ms < BAR_AFTER_MS) return;
    if (now - window->bar_ms < BAR_EVERY_MS) return;
    window->bar_ms = now;
    char title[256];
    snprintf(title, sizeof title, "%s: preparing %s (%u of %u)", window->app->desc.title, what,
             done, total);
    glfwSetWindowTitle(window->handle, title);
    glfwPollEvents(); // the system must not think that we hang
    draw_bar(window, total ? (f32)done / (f32)total : 1.0f);
}

// Uploads the level.
static void skip_time(Window *window) {
    App *app = window->app;
    // None of this time was played.
    f64 now = clock_now_ms();
    step_clock_skip(&window->clock, now);
    app->next_status_ms = now + STATUS_MS;
    app->status_frames = 0;
}

static void prepare_level(Window *window) {
    App *app = window->app;
    u64 stamp = app->session.assets.stamp;
    if (!app->session.world || app->assets_in_use == stamp) return;
    if (!app_upload_assets(app)) app_say(app, "not everything fits into the device's memory");
    window->warm_count = 0;
    skip_time(window);
}

// Makes the pipelines of settings that are new, with a bar. False: there was nothing to do.
static bool prepare_pipelines(Window *window, const Packet *packet) {
    if (!packet) return false;
    u64 key = settings_switches_hash(&packet->settings);
    for (u32 i = 0; i < MIN(window->warm_count, WARM_KEYS); i++)
        if (window->warm_keys[i] == key) return false;
    window->warm_keys[window->warm_count++ % WARM_KEYS] = key;
    window->warm_start_ms = clock_now_ms();
    renderer_warm_up(window->app->renderer, packet, on_progress, window);
    glfwSetWindowTitle(window->handle, window->app->desc.title);
    skip_time(window);
    return true;
}

// --- A frame ---

static void simulate(Window *window) {
    App *app = window->app;
    f64 start = clock_now_ms();
    u32 ticks = app->desc.fixed_step ? 1 : step_clock_advance(&window->clock, start);
    if (app->paused) {
        // Time stands still, and what hands do meanwhile is not done all at once afterwards.
        controls_take(&window->controls);
        return;
    }
    for (u32 i = 0; i < ticks && !window->quit; i++) {
        Input input = controls_take(&window->controls);
        // Who looks through another camera does not walk blindly.
        if (app->camera[0]) input = (Input){0};
        if (!app_tick(app, input)) window->quit = true;
    }
    app->ticks_ms = (f32)(clock_now_ms() - start);
}

static void grant_wishes(Window *window, const Packet *packet, const Packet *other) {
    App *app = window->app;
    if (app->want_screenshot) app_write_screenshot(app, packet, other);
    if (app->want_frame_file) app_write_frame_file(app, packet);
    app->want_screenshot = app->want_frame_file = false;
}

// False: nothing was shown.
static bool draw(Window *window) {
    App *app = window->app;
    Gpu *gpu = app->gpu;
    if (!make_swapchain(window)) return false;
    u32 width, height;
    gpu_swapchain_size(gpu, &width, &height);
    const Packet *other, *packet = app_packets(app, width, height, &other);
    if (!packet) return false;
    // Time has passed: the next frame shows what is true then.
    if (prepare_pipelines(window, packet) || prepare_pipelines(window, other)) return false;
    bool pointer = !window->device.captured;
    const Overlay *overlay =
        window->ui_ready ? debug_ui_frame(window->ui, app, width, height, pointer) : NULL;
    f64 wait_start = clock_now_ms();
    // Who reads them: the panel, and the controller of the scale.
    gpu_timers_enable(gpu, app->panel || app->settings.target_ms > 0.0f);
    GpuCommands *cmd = gpu_frame_begin(gpu);
    if (!cmd) return false;
    bool shown = gpu_swapchain_acquire(gpu, cmd);
    window->wait_ms += clock_now_ms() - wait_start;
    if (shown && other)
        renderer_draw_split(app->renderer, cmd, packet, other, &app->split_view, true, overlay);
    else if (shown)
        renderer_draw(app->renderer, cmd, packet, true, overlay);
    if (!gpu_frame_end(gpu, false)) return false;
    wait_start = clock_now_ms();
    if (!shown || !gpu_swapchain_present(gpu)) window->must_resize = true;
    window->wait_ms += clock_now_ms() - wait_start;
    grant_wishes(window, packet, other);
    return shown;
}

static void sleep_ms(f64 ms) {
    struct timespec time = {.tv_nsec = (long)(ms * 1e6)};
    nanosleep(&time, NULL);
}

// What the frame took without waiting for the screen: with it, a fast machine at 60 pictures a
// second would always look busy. The device's share comes from its timers, because a busy device
// and a slow screen make us wait in the same places.
static f32 work_ms(const Window *window, f32 frame_ms) {
    GpuTimer timers[GPU_TIMERS_CAP];
    u32 count = gpu_timers(window->app->gpu, timers, GPU_TIMERS_CAP);
    if (count == 0) return frame_ms;
    f32 device_ms = 0.0f;
    for (u32 i = 0; i < count; i++) device_ms += timers[i].ms;
    return MIN(frame_ms, frame_ms - (f32)window->wait_ms + device_ms);
}

static void measure(Window *window) {
    App *app = window->app;
    f64 now = clock_now_ms();
    f32 ms = (f32)(now - window->frame_start_ms);
    app->frame_index = (app->frame_index + 1) % APP_FRAMES_SHOWN;
    app->frame_ms[app->frame_index] = ms;
    app->status_frames++;
    app->settings.scale = scale_control_update(&window->scale, work_ms(window, ms),
                                               app->settings.target_ms, app->settings.scale);
    if (now < app->next_status_ms) return;
    app->fps = (f32)(app->status_frames * 1000.0 / (now - app->next_status_ms + STATUS_MS));
    app->status_frames = 0;
    app->next_status_ms = now + STATUS_MS;
    u32 width, height;
    gpu_swapchain_size(app->gpu, &width, &height);
    app_write_status(app, width, height);
}

static void frame(Window *window) {
    App *app = window->app;
    window->frame_start_ms = clock_now_ms();
    window->wait_ms = 0.0;
    glfwPollEvents();
    if (glfwGetWindowAttrib(window->handle, GLFW_ICONIFIED)) {
        glfwWaitEventsTimeout(STATUS_MS / 1000.0);
        step_clock_skip(&window->clock, clock_now_ms());
        return;
    }
    controls_device_poll(&window->device, window->handle, &window->controls);
    if (window->drags_line) app->split_view.at = CLAMP(pointer_at(window), 0.0f, 1.0f);
    // An open panel wants a pointer; closing it goes back to walking.
    if (app->panel != window->was_panel) capture_mouse(window, !app->panel);
    window->was_panel = app->panel;
    app_poll_files(app, window->frame_start_ms);
    if (app->want_restart && !app->has_replay && !app_restart(app))
        app_say(app, "the level cannot be started anew");
    app->want_restart = false;
    prepare_level(window);
    simulate(window);
    bool drawn = draw(window);
    if (gpu_is_lost(app->gpu) || window->resize_failures > RESIZE_FAILURES_MAX) {
        window->resize_failures = 0;
        if (!renew_device(window)) window->quit = true, window->exit_code = APP_ENVIRONMENT;
        return;
    }
    f64 spent = clock_now_ms() - window->frame_start_ms;
    if (spent < FRAME_MS_MIN) sleep_ms(FRAME_MS_MIN - spent);
    if (drawn) {
        window->frame_count++;
        measure(window);
    }
}

static bool time_is_up(const Window *window) {
    const AppDesc *desc = &window->app->desc;
    if (desc->seconds <= 0.0f) return false;
    if (desc->fixed_step) return window->app->session.world->tick >= desc->seconds * TICK_RATE;
    return clock_now_ms() - window->app->start_ms > desc->seconds * 1000.0;
}

// --- Life ---

static bool open_window(Window *window) {
    const AppDesc *desc = &window->app->desc;
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window->handle =
        glfwCreateWindow((int)desc->width_px, (int)desc->height_px, desc->title, NULL, NULL);
    if (!window->handle) return false;
    glfwSetWindowUserPointer(window->handle, window);
    glfwSetWindowSizeLimits(window->handle, 64, 64, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwSetKeyCallback(window->handle, on_key);
    glfwSetMouseButtonCallback(window->handle, on_mouse_button);
    glfwSetWindowFocusCallback(window->handle, on_focus);
    glfwSetFramebufferSizeCallback(window->handle, on_framebuffer_size);
    window->ui = debug_ui_create(window->handle); // chains the callbacks above
    if (desc->fullscreen) toggle_fullscreen(window);
    return true;
}

static int report_end(const Window *window) {
    const App *app = window->app;
    if (app->has_replay)
        printf("replay: %u ticks, %s\n", app->replay_tick,
               app->replay_differences ? "not all as recorded" : "every one as recorded");
    u32 messages = app->gpu ? gpu_validation_message_count(app->gpu) : 0;
    if (messages > 0) fprintf(stderr, "luz: %u messages of the validation layer\n", messages);
    return messages > 0 || app->replay_differences > 0 ? APP_FAILED : window->exit_code;
}

int app_run_window(App *app) {
    glfwSetErrorCallback(on_glfw_error);
    if (!glfwInit()) {
        LOG(APP_NO_DISPLAY, "no display: writing a tour of the cameras to %s/tour instead",
            app->desc.out_directory);
        return APP_NO_WINDOW;
    }
    Window *window = calloc(1, sizeof *window);
    LUZ_ASSERT(window);
    window->app = app;
    bool ok = open_window(window) && open_device(window);
    if (ok) {
        window->was_panel = app->panel;
        capture_mouse(window, !app->panel);
        choose_resolution(window);
        app->start_ms = clock_now_ms();
        draw_bar(window, 0.0f); // the level takes its time to come up
    }
    while (ok && !window->quit && !glfwWindowShouldClose(window->handle) && !time_is_up(window))
        frame(window);
    int code = ok ? report_end(window) : APP_ENVIRONMENT;
    app_close_device(app); // the surface goes before its window
    debug_ui_destroy(window->ui);
    if (window->handle) glfwDestroyWindow(window->handle);
    free(window);
    glfwTerminate();
    return code;
}
