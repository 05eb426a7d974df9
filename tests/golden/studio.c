// studio.c: see studio.h. Data in: a level's path. Data out: pictures. Called by the golden and
// replay tests. Does not compare: that is the tests' own business.
#include "studio.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

const char *const studio_levels[] = {
    "data/levels/cloister.toml",       "data/levels/cornell.toml",
    "data/levels/cornell_empty.toml",  "data/levels/hall.toml",
    "data/levels/light_box.toml",      "data/levels/lights_4096.toml",
    "data/levels/plane_test.toml",     "data/levels/emissive_teapot.toml",
    "data/levels/moving_door.toml",    "data/levels/sealed_room.toml",
    "data/levels/red_green_wall.toml", "data/levels/uniform_wall.toml",
    "data/levels/white_furnace.toml",
};
const u32 studio_level_count = COUNT_OF(studio_levels);

void studio_open(Studio *studio, const char *level) {
    memset(studio, 0, sizeof *studio);
    // Tests count on the software driver: it is the one that every machine has.
    setenv("VK_DRIVER_FILES", "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", 0);
    assert_true(arena_create(&studio->images, "images", GIB(1)));
    assert_true(session_create(&studio->session, &luz_project));
    if (!session_load(&studio->session, level)) {
        if (studio->session.diagnostics) diagnostics_print(studio->session.diagnostics, stderr);
        fail_msg("%s does not load", level);
    }
    studio->gpu = gpu_create(&(GpuDesc){.label = "test", .validation = true});
    assert_non_null(studio->gpu);
    studio->renderer = renderer_create(studio->gpu);
    assert_non_null(studio->renderer);
    assert_true(renderer_set_assets(studio->renderer, &studio->session.assets));
}

void studio_close(Studio *studio) {
    assert_int_equal(gpu_validation_message_count(studio->gpu), 0);
    renderer_destroy(studio->renderer);
    gpu_destroy(studio->gpu);
    session_destroy(&studio->session);
    arena_destroy(&studio->images);
}

RenderSettings studio_direct_light(void) {
    RenderSettings settings = settings_default();
    assert_true(settings_set(&settings, "gi.enabled=off"));
    return settings;
}

RenderImage studio_draw(Studio *studio, const char *camera, const RenderSettings *settings,
                        u32 width_px, u32 height_px) {
    session_frame_begin(&studio->session);
    const Packet *packet = session_packet(&studio->session, &(SessionView){.camera = camera,
                                                                           .settings = *settings,
                                                                           .width_px = width_px,
                                                                           .height_px = height_px,
                                                                           .cold = true});
    assert_non_null(packet);
    assert_null(packet_validate(packet, packet->size, studio->session.assets.mesh_count,
                                studio->session.assets.texture_count));
    RenderImage image = {0};
    assert_true(renderer_render_image(studio->renderer, packet, &studio->images, &image));
    return image;
}

const char *studio_shell(int *exit_code, const char *format, ...) {
    static char output[65536];
    char command[4096];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(command, sizeof command - 8, format, args);
    va_end(args);
    assert_in_range(length, 1, sizeof command - 9);
    strcat(command, " 2>&1");
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t size = fread(output, 1, sizeof output - 1, pipe);
    output[size] = 0;
    // Drain what does not fit, so that the child is not killed by a closed pipe.
    char rest[4096];
    while (fread(rest, 1, sizeof rest, pipe) > 0) {
    }
    int status = pclose(pipe);
    *exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return output;
}

const char *studio_build_directory(void) {
    static char path[4096];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    assert_true(length > 0);
    path[length] = 0;
    *strrchr(path, '/') = 0;
    return path;
}
