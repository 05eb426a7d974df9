// images.c: golden pictures. On the driver that made them the hash must be equal bit for bit; on
// another one FLIP against the picture must stay small. LUZ_GOLDEN_UPDATE=1 writes them anew (look
// at them before committing).
//
// data/golden/NAME.png is the picture, data/golden/hashes.txt has "NAME hash driver" lines.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include "../../engine/asset/asset.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH  320
#define HEIGHT 180
// Another rasteriser rounds otherwise: edges move by a pixel, gradients by a step. Measured between
// subgroup sizes 4 and 8 of the software driver: equal; the bound leaves room for real GPUs.
#define FLIP_LIMIT 0.03

static void driver_name(const Gpu *gpu, char *out, u64 cap) {
    const GpuInfo *info = gpu_info(gpu);
    snprintf(out, cap, "%s / %s", info->device_name, info->driver_info);
}

static bool golden_hash(const char *name, u64 *hash, char *driver, u64 driver_cap) {
    FILE *file = fopen("data/golden/hashes.txt", "r");
    if (!file) return false;
    char line[1024], line_name[256];
    bool found = false;
    while (!found && fgets(line, sizeof line, file)) {
        int at = 0;
        if (sscanf(line, "%255s %" SCNx64 " %n", line_name, hash, &at) == 2 && at > 0 &&
            strcmp(line_name, name) == 0) {
            line[strcspn(line, "\n")] = 0;
            snprintf(driver, driver_cap, "%s", line + at);
            found = true;
        }
    }
    fclose(file);
    return found;
}

static void golden_update(const char *name, const RenderImage *image, const char *driver) {
    char path[512], text[65536] = "", line[1024], line_name[256];
    snprintf(path, sizeof path, "data/golden/%s.png", name);
    assert_true(image_write_png(path, image->rgba, image->width_px, image->height_px, 4));
    FILE *file = fopen("data/golden/hashes.txt", "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%255s", line_name) == 1 && strcmp(line_name, name) != 0)
            strncat(text, line, sizeof text - strlen(text) - 1);
    if (file) fclose(file);
    snprintf(line, sizeof line, "%s %016" PRIx64 " %s\n", name, image->hash, driver);
    strncat(text, line, sizeof text - strlen(text) - 1);
    assert_true(file_write("data/golden/hashes.txt", text, strlen(text)));
}

static void check_golden(const char *level, const char *camera, u32 ticks, const char *name) {
    Studio studio;
    char driver[600], golden_driver[600];
    studio_open(&studio, level);
    session_advance(&studio.session, ticks);
    RenderSettings settings = settings_default();
    RenderImage image = studio_draw(&studio, camera, &settings, WIDTH, HEIGHT);
    driver_name(studio.gpu, driver, sizeof driver);
    if (getenv("LUZ_GOLDEN_UPDATE")) golden_update(name, &image, driver);
    u64 hash = 0;
    if (!golden_hash(name, &hash, golden_driver, sizeof golden_driver))
        fail_msg("data/golden/hashes.txt has no line for %s", name);
    if (strcmp(driver, golden_driver) == 0) {
        if (hash != image.hash) {
            char path[512];
            snprintf(path, sizeof path, "build/golden_%s.png", name);
            image_write_png(path, image.rgba, WIDTH, HEIGHT, 4);
            fail_msg("%s: picture differs from the golden one (drawn: %s)", name, path);
        }
    } else {
        char path[512];
        u8 *rgba;
        u32 width, height;
        snprintf(path, sizeof path, "data/golden/%s.png", name);
        assert_true(image_read(path, &studio.images, &rgba, &width, &height));
        assert_int_equal(width, WIDTH);
        assert_int_equal(height, HEIGHT);
        ImageDifference d = image_compare(rgba, image.rgba, WIDTH, HEIGHT, &studio.images);
        printf("    %s on another driver (%s): FLIP %.4f, max %u\n", name, driver, d.flip, d.max);
        assert_true(d.flip < FLIP_LIMIT);
    }
    studio_close(&studio);
}

TEST_GPU(golden, image_cloister) {
    check_golden("data/levels/cloister.toml", "main", 60, "cloister");
}
TEST_GPU(golden, image_cloister_garden) {
    check_golden("data/levels/cloister.toml", "garden", 0, "cloister_garden");
}
TEST_GPU(golden, image_cornell) { check_golden("data/levels/cornell.toml", "main", 0, "cornell"); }
TEST_GPU(golden, image_hall) { check_golden("data/levels/hall.toml", "main", 60, "hall"); }
TEST_GPU(golden, image_light_box) {
    check_golden("data/levels/light_box.toml", "main", 30, "light_box");
}
TEST_GPU(golden, image_lights_4096) {
    check_golden("data/levels/lights_4096.toml", "main", 30, "lights_4096");
}
TEST_GPU(golden, image_plane_test) {
    check_golden("data/levels/plane_test.toml", "main", 0, "plane_test");
}
