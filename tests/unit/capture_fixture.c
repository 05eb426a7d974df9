// capture_fixture.c: see capture_fixture.h.
#include "capture_fixture.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

CaptureWorld capture_world_create(void) {
    CaptureWorld fixture = {.world = world_create(11)};
    TransformTable *transforms = WORLD_TABLE(fixture.world, Transform, transform);
    LightTable *lights = WORLD_TABLE(fixture.world, Light, light);
    for (u32 i = 0; i < FIXTURE_LIGHTS; i++) {
        char name[32];
        snprintf(name, sizeof name, "light %u", i);
        Entity entity = fixture.lights[i] = world_spawn(fixture.world);
        world_set_name(fixture.world, entity, name);
        u32 t = table_add(&transforms->table, entity), l = table_add(&lights->table, entity);
        transforms->x[t] = (f32)i;
        lights->intensity[l] = 1.0f + (f32)i;
    }
    return fixture;
}

void capture_world_tick(CaptureWorld *fixture, Input input) {
    World *world = fixture->world;
    world_advance_stamp(world);
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    LightTable *lights = WORLD_TABLE(world, Light, light);
    for (u32 i = 0; i < transforms->table.count; i++) {
        transforms->x[i] += (f32)input.move_x * 0.01f + (f32)i * 0.001f;
        transforms->z[i] -= (f32)input.move_z * 0.01f;
        table_touch(&transforms->table, i);
    }
    for (u32 i = 0; i < lights->table.count; i++) {
        u32 row = table_row(&transforms->table, lights->table.entity[i]);
        lights->x[i] = transforms->x[row];
        table_touch(&lights->table, i);
    }
    // Structure changes as well: a spark now and then.
    if (world->tick % 40 == 20) {
        Entity spark = world_spawn(world);
        table_add(&transforms->table, spark);
        table_add(&lights->table, spark);
        if (world->tick % 80 == 60) world_despawn(world, spark);
    }
    world->tick++;
}

Input capture_input(u32 tick) {
    u32 segment = tick / 7;
    return (Input){.look_x = (i16)(tick % 3 == 0 ? -32768 : 32767),
                   .look_y = (i16)(random_u32(5, 0, segment) % 1000),
                   .move_x = (i8)(random_u32(5, 1, segment) % 255 - 127),
                   .move_y = -128,
                   .move_z = 127,
                   .buttons = segment % 2 ? 0xFFFFFFFFu : INPUT_RUN};
}

RecordingInfo capture_info(void) {
    RecordingInfo info = {.level = "data/levels/some.toml",
                          .level_hash = 0x0123456789ABCDEFull,
                          .build_id = "a build",
                          .device = "a device",
                          .seed = 11,
                          .width_px = 64,
                          .height_px = 36,
                          .settings = settings_default()};
    info.settings.path = PATH_FORWARD;
    info.settings.exposure = 1.25f;
    return info;
}

void capture_record(const char *path, u32 tick_count) {
    CaptureWorld fixture = capture_world_create();
    RecordingInfo info = capture_info();
    RecordingWriter *writer = recording_writer_create(&info, fixture.world);
    u8 *pixels = malloc(64 * 36 * 4);
    assert_non_null(pixels);
    for (u32 tick = 1; tick <= tick_count; tick++) {
        capture_world_tick(&fixture, capture_input(tick - 1));
        recording_writer_tick(writer, capture_input(tick - 1), fixture.world);
        if (tick % 50) continue;
        memset(pixels, (int)tick, 64 * 36 * 4);
        recording_writer_image(writer, tick, tick * 1000ull, pixels, 64, 36);
    }
    free(pixels);
    assert_true(recording_writer_finish(writer, path));
    world_destroy(fixture.world);
}

RecordingDifference capture_replay(const Recording *recording, u32 at, CaptureChange change,
                                   Arena *arena) {
    CaptureWorld fixture = capture_world_create();
    RecordingDifference difference = {0};
    RecordingCheck *check = recording_check_create(recording, fixture.world, arena);
    if (at == 0 && change) change(&fixture);
    bool equal = recording_check_tick(check, 0, fixture.world, &difference);
    for (u32 tick = 1; equal && tick <= recording->tick_count; tick++) {
        capture_world_tick(&fixture, recording->inputs[tick - 1]);
        if (tick == at && change) change(&fixture);
        equal = recording_check_tick(check, tick, fixture.world, &difference);
    }
    world_destroy(fixture.world);
    return difference;
}

u8 *capture_read_bytes(const char *path, u64 *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (u64)ftell(file);
    rewind(file);
    u8 *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

void capture_write_bytes(const char *path, const u8 *bytes, u64 size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}
