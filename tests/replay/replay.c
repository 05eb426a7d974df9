// replay.c: determinism as a user sees it: the programs are run, with other thread counts, and
// their hashes compared; a recording replays; a damaged one says so.
#include "../golden/studio.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The value of "key": "text" in JSON output.
static void json_text(const char *json, const char *key, char *out, u64 cap) {
    char pattern[128];
    snprintf(pattern, sizeof pattern, "\"%s\"", key);
    const char *at = strstr(json, pattern);
    if (!at) fail_msg("no %s in: %.200s", key, json);
    at = strchr(at + strlen(pattern), '"');
    assert_non_null(at);
    const char *end = strchr(at + 1, '"');
    assert_non_null(end);
    snprintf(out, cap, "%.*s", (int)(end - at - 1), at + 1);
}

TEST_GPU(replay, hashes_do_not_depend_on_threads) {
    static const char *const variants[][2] = {
        {"1", "1"}, {"1", "2"}, {"2", "1"}, {"2", "2"}, {"2", "2"}};
    char image[COUNT_OF(variants)][64], world[COUNT_OF(variants)][64];
    for (u32 i = 0; i < COUNT_OF(variants); i++) {
        int code;
        const char *stats = test_temp_path("stats.json"), *png = test_temp_path("shot.png");
        const char *output =
            studio_shell(&code,
                         "LP_NUM_THREADS=%s %s/luz shot data/levels/cloister.toml -o %s --size "
                         "320x180 --tick 45 "
                         "--camera main --threads %s --validation --stats %s",
                         variants[i][0], studio_build_directory(), png, variants[i][1], stats);
        if (code != 0) fail_msg("luz shot ended with %d: %s", code, output);
        output = studio_shell(&code, "cat %s", stats);
        json_text(output, "image_hash", image[i], sizeof image[i]);
        json_text(output, "world_hash", world[i], sizeof world[i]);
        assert_string_equal(image[i], image[0]);
        assert_string_equal(world[i], world[0]);
    }
    printf("    image %s world %s\n", image[0], world[0]);
}

TEST_GPU(replay, recording_of_20_seconds) {
    int code;
    const char *file = test_temp_path("walk.luzr");
    const char *output = studio_shell(
        &code, "%s/luz record data/levels/cloister.toml -o %s --seconds 20 --size 320x180",
        studio_build_directory(), file);
    if (code != 0) fail_msg("luz record ended with %d: %s", code, output);
    output = studio_shell(&code, "%s/luz replay %s --threads 2", studio_build_directory(), file);
    if (code != 0) fail_msg("luz replay ended with %d: %s", code, output);
    // The player really walked: start and end of the recording are different places.
    output = studio_shell(&code, "%s/luz replay %s --threads 1 --no-images",
                          studio_build_directory(), file);
    if (code != 0) fail_msg("luz replay with one thread ended with %d: %s", code, output);

    // One bit of the file changed, at many places: each is refused or named, none passes or
    // crashes.
    FILE *in = fopen(file, "rb");
    assert_non_null(in);
    fseek(in, 0, SEEK_END);
    long size = ftell(in);
    rewind(in);
    u8 *bytes = malloc((size_t)size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, (size_t)size, in), size);
    fclose(in);
    for (u32 k = 0; k < 6; k++) {
        long at = (long)((u64)size * (2 * k + 1) / 12);
        bytes[at] ^= (u8)(1u << k);
        const char *broken = test_temp_path("broken.luzr");
        FILE *out = fopen(broken, "wb");
        assert_non_null(out);
        assert_int_equal(fwrite(bytes, 1, (size_t)size, out), size);
        fclose(out);
        bytes[at] ^= (u8)(1u << k);
        output =
            studio_shell(&code, "%s/luz replay %s --no-images", studio_build_directory(), broken);
        if (code != 1) fail_msg("bit %u of byte %ld: code %d: %s", k, at, code, output);
        assert_true(strlen(output) > 20);
    }
    free(bytes);
}

TEST_GPU(replay, frame_file_in_all_paths) {
    int code;
    const char *frame = test_temp_path("frame.luzf"), *png = test_temp_path("a.png");
    const char *other = test_temp_path("b.png");
    const char *output = studio_shell(
        &code,
        "%s/luz shot data/levels/cornell.toml -o %s --size 160x90 --camera main --record-frame %s",
        studio_build_directory(), png, frame);
    if (code != 0) fail_msg("luz shot ended with %d: %s", code, output);
    static const char *const paths[] = {"tiled_deferred", "deferred", "forward"};
    for (u32 i = 0; i < COUNT_OF(paths); i++) {
        output = studio_shell(&code, "%s/luz replay %s --path %s -o %s", studio_build_directory(),
                              frame, paths[i], other);
        if (code != 0) fail_msg("luz replay --path %s ended with %d: %s", paths[i], code, output);
        output = studio_shell(&code, "%s/luz compare %s %s --max %d", studio_build_directory(), png,
                              other, i == 0 ? 0 : 2);
        if (code != 0) fail_msg("%s: %s", paths[i], output);
    }
}
