// capture_recording.c: recordings come back as they were, and a check names what differs.
#include "capture_fixture.h"
#include "../../engine/base/log.h"
#include "../../engine/capture/recording_internal.h"
#include <stdlib.h>
#include <string.h>

static Arena test_arena(void) {
    Arena arena;
    assert_true(arena_create(&arena, "test", GIB(4)));
    return arena;
}

TEST(capture_recording, comes_back_as_written) {
    Arena arena = test_arena();
    const char *path = test_temp_path("a.luzr");
    capture_record(path, 321);
    Recording recording;
    assert_true(recording_read(path, &arena, &recording));
    RecordingInfo info = capture_info();
    assert_string_equal(recording.info.level, info.level);
    assert_string_equal(recording.info.build_id, info.build_id);
    assert_string_equal(recording.info.device, info.device);
    assert_true(recording.info.level_hash == info.level_hash);
    assert_true(recording.info.seed == info.seed);
    assert_int_equal(recording.info.width_px, 64);
    assert_int_equal(recording.info.height_px, 36);
    assert_memory_equal(&recording.info.settings, &info.settings, sizeof info.settings);
    assert_int_equal(recording.tick_count, 321);
    for (u32 tick = 0; tick < 321; tick++) {
        Input input = capture_input(tick);
        assert_memory_equal(&recording.inputs[tick], &input, sizeof input);
    }
    assert_int_equal(recording.image_count, 6);
    for (u32 i = 0; i < 6; i++) {
        assert_int_equal(recording.images[i].tick, (i + 1) * 50);
        assert_true(recording.images[i].hash == (i + 1) * 50000ull);
        for (u32 p = 0; p < THUMBNAIL_SIZE; p++)
            assert_int_equal(recording.images[i].thumbnail[p], (u8)((i + 1) * 50));
    }
    arena_destroy(&arena);
}

TEST(capture_recording, equal_runs_are_equal) {
    Arena arena = test_arena();
    const char *path = test_temp_path("a.luzr");
    capture_record(path, 200);
    Recording recording;
    assert_true(recording_read(path, &arena, &recording));
    RecordingDifference difference = capture_replay(&recording, UINT32_MAX, NULL, &arena);
    assert_string_equal(difference.text, "");
    arena_destroy(&arena);
}

TEST(capture_recording, run_lengths) {
    static const u32 counts[] = {0, 1, 2, 7, 8, 5000};
    Arena arena = test_arena();
    for (u32 i = 0; i < COUNT_OF(counts); i++)
        for (u32 kind = 0; kind < 2; kind++) { // all equal, all different
            const char *path = test_temp_path("a.luzr");
            World *world = world_create(1);
            RecordingInfo info = capture_info();
            RecordingWriter *writer = recording_writer_create(&info, world);
            for (u32 tick = 0; tick < counts[i]; tick++)
                recording_writer_tick(writer, (Input){.look_x = (i16)(kind * tick)}, world);
            assert_true(recording_writer_finish(writer, path));
            Recording recording;
            assert_true(recording_read(path, &arena, &recording));
            assert_int_equal(recording.tick_count, counts[i]);
            for (u32 tick = 0; tick < counts[i]; tick++)
                assert_int_equal(recording.inputs[tick].look_x, (i16)(kind * tick));
            world_destroy(world);
            arena_reset(&arena);
        }
    arena_destroy(&arena);
}

// --- naming differences ---

static RecordingDifference difference_of(u32 ticks, u32 at, CaptureChange change) {
    Arena arena = test_arena();
    const char *path = test_temp_path("a.luzr");
    capture_record(path, ticks);
    Recording recording;
    assert_true(recording_read(path, &arena, &recording));
    RecordingDifference difference = capture_replay(&recording, at, change, &arena);
    assert_true(difference.text[0] != 0);
    arena_destroy(&arena);
    return difference;
}

static void change_one(CaptureWorld *fixture) {
    TransformTable *transforms = WORLD_TABLE(fixture->world, Transform, transform);
    transforms->y[3] = 2.5f;
}

TEST(capture_recording, names_table_column_and_row) {
    RecordingDifference d = difference_of(100, 37, change_one);
    assert_int_equal(d.tick, 37);
    assert_string_equal(d.table, "transform");
    assert_string_equal(d.column, "y");
    assert_int_equal(d.row, 3);
    assert_string_equal(d.text, "tick 37: transform.y of 'light 3' (row 3) is 2.5, recorded 0");
}

TEST(capture_recording, names_a_difference_at_the_start) {
    RecordingDifference d = difference_of(10, 0, change_one);
    assert_int_equal(d.tick, 0);
    assert_string_equal(d.column, "y");
    assert_int_equal(d.row, 3);
}

static void change_last_bit(CaptureWorld *fixture) {
    TransformTable *transforms = WORLD_TABLE(fixture->world, Transform, transform);
    u32 bits;
    memcpy(&bits, &transforms->x[5], 4);
    bits ^= 1;
    memcpy(&transforms->x[5], &bits, 4);
}

TEST(capture_recording, names_one_bit) {
    RecordingDifference d = difference_of(60, 60, change_last_bit);
    assert_int_equal(d.tick, 60);
    assert_string_equal(d.table, "transform");
    assert_string_equal(d.column, "x");
    assert_int_equal(d.row, 5);
    assert_non_null(strstr(d.text, "'light 5'"));
}

static void change_two(CaptureWorld *fixture) {
    LightTable *lights = WORLD_TABLE(fixture->world, Light, light);
    lights->color_g[1] = 0.5f;
    lights->color_g[4] = 0.25f;
}

TEST(capture_recording, several_rows) {
    RecordingDifference d = difference_of(60, 12, change_two);
    assert_string_equal(d.table, "light");
    assert_string_equal(d.column, "color_g");
    assert_int_equal(d.row, ROW_NONE);
    assert_non_null(strstr(d.text, "several"));
}

static void swap_two(CaptureWorld *fixture) { // equal sums s0: only s1 tells
    LightTable *lights = WORLD_TABLE(fixture->world, Light, light);
    f32 keep = lights->intensity[0];
    lights->intensity[0] = lights->intensity[2];
    lights->intensity[2] = keep;
}

TEST(capture_recording, swapped_rows) {
    RecordingDifference d = difference_of(30, 9, swap_two);
    assert_string_equal(d.column, "intensity");
    assert_int_equal(d.row, ROW_NONE);
}

static void change_cause_and_effect(CaptureWorld *fixture) {
    TransformTable *transforms = WORLD_TABLE(fixture->world, Transform, transform);
    LightTable *lights = WORLD_TABLE(fixture->world, Light, light);
    transforms->w00[2] = 3.0f; // derived, in the first table
    lights->kind[2] = LIGHT_SPOT;
}

TEST(capture_recording, causes_come_before_effects) {
    RecordingDifference d = difference_of(30, 9, change_cause_and_effect);
    assert_string_equal(d.table, "light");
    assert_string_equal(d.column, "kind");
    assert_non_null(strstr(d.text, "is spot, recorded point"));
    assert_non_null(strstr(d.text, "1 more column differs"));
}

static void remove_row(CaptureWorld *fixture) {
    table_remove(fixture->world->tables[COMPONENT_light], fixture->lights[1]);
}

TEST(capture_recording, names_row_counts) {
    RecordingDifference d = difference_of(30, 15, remove_row);
    assert_string_equal(d.table, "light");
    assert_string_equal(d.text, "tick 15: table light has 5 rows, recorded 6");
}

static void change_points(CaptureWorld *fixture) {
    static const f32 xyz[3] = {1, 2, 3};
    world_add_points(fixture->world, xyz, 1);
}

TEST(capture_recording, names_what_is_outside_the_tables) {
    RecordingDifference d = difference_of(30, 15, change_points);
    assert_string_equal(d.table, "");
    assert_non_null(strstr(d.text, "all columns are equal"));
}

static void change_seed(CaptureWorld *fixture) { fixture->world->seed = 12; }

TEST(capture_recording, names_another_seed) {
    RecordingDifference d = difference_of(30, 0, change_seed);
    assert_string_equal(d.text,
                        "at the start: all columns are equal, and the seed is 12, recorded 11");
}

// Any one row of any size of column, any two values.
TEST(capture_recording, sums_find_any_row) {
    for (u32 n = 1; n <= 300; n += 13) {
        u32 values[300];
        for (u32 i = 0; i < n; i++) values[i] = i * 2654435761u;
        ColumnSum recorded = column_sum(values, n);
        for (u32 i = 0; i < n; i += 3) {
            u32 old = values[i], value;
            values[i] ^= 1u << (i % 32);
            ColumnSum now = column_sum(values, n);
            u64 d0 = now.s0 - recorded.s0, d1 = now.s1 - recorded.s1;
            assert_true(d1 == (i + 1ull) * d0);
            assert_true(column_sum_unmix(column_sum_mix(values[i]) - d0, &value));
            assert_int_equal(value, old);
            values[i] = old;
        }
    }
}
