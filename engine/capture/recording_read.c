// recording_read.c: reads a recording from anybody.
// Data in: a file. Data out: a Recording in the arena, or a message with chunk and byte.
// Called by: replay (tools, shells), `luz info`, tests and the fuzzer. Does not: trust any count:
// each is compared with the bytes that are there before memory is taken for it.
#include "../base/log.h"
#include "recording_internal.h"
#include <stdio.h>
#include <string.h>

typedef struct RecordingReader {
    ChunkFile file;
    Arena *arena;
    Recording *out;
} RecordingReader;

static bool refuse(const RecordingReader *in, u32 tag, const ByteReader *reader, const char *why) {
    return capture_refuse(in->file.path, tag, reader->at, why);
}

static bool open_chunk(const RecordingReader *in, u32 tag, u64 raw_size_max, ByteReader *reader) {
    Bytes bytes;
    if (!chunk_file_open(&in->file, tag, raw_size_max, in->arena, &bytes)) return false;
    *reader = (ByteReader){.data = bytes.data, .size = bytes.size};
    return true;
}

static bool read_info(const RecordingReader *in) {
    ByteReader reader;
    if (!open_chunk(in, TAG_INFO, KIB(64), &reader)) return false;
    RecordingInfo *info = &in->out->info;
    byte_read_text(&reader, info->level, sizeof info->level);
    info->level_hash = byte_read_u64(&reader);
    byte_read_text(&reader, info->build_id, sizeof info->build_id);
    byte_read_text(&reader, info->device, sizeof info->device);
    info->seed = byte_read_u64(&reader);
    info->width_px = byte_read_u32(&reader);
    info->height_px = byte_read_u32(&reader);
    info->settings = settings_default();
    u32 setting_count = byte_read_u32(&reader);
    // Each takes at least 6 bytes, so the loop ends with the chunk. Names of other builds are
    // skipped.
    for (u32 i = 0; i < setting_count && !reader.failed; i++) {
        char name[64];
        byte_read_text(&reader, name, sizeof name);
        u32 bits = byte_read_u32(&reader);
        for (u32 s = 0; s < render_setting_count && !reader.failed; s++)
            if (strcmp(name, render_setting_descs[s].name) == 0)
                memcpy((u8 *)&info->settings + render_setting_descs[s].offset, &bits, sizeof bits);
    }
    settings_clamp(&info->settings);
    if (reader.failed || reader.at != reader.size)
        return refuse(in, TAG_INFO, &reader, "its fields do not fill it");
    if (info->width_px > PACKET_SIDE_MAX || info->height_px > PACKET_SIDE_MAX)
        return refuse(in, TAG_INFO, &reader, "the size of pictures is out of range");
    return true;
}

static bool read_inputs(const RecordingReader *in) {
    ByteReader reader;
    u64 size_max = 8 + (u64)RECORDING_TICKS_MAX * INPUT_RUN_SIZE;
    if (!open_chunk(in, TAG_INPUTS, size_max, &reader)) return false;
    u32 tick_count = byte_read_u32(&reader), run_count = byte_read_u32(&reader);
    if (reader.failed || tick_count > RECORDING_TICKS_MAX)
        return refuse(in, TAG_INPUTS, &reader, "the count of ticks is out of range");
    if (run_count > tick_count || reader.size - reader.at != (u64)run_count * INPUT_RUN_SIZE)
        return refuse(in, TAG_INPUTS, &reader, "the count of runs does not fit its size");
    if (!arena_can_push(in->arena, (u64)tick_count * sizeof(Input) + 64, 64))
        return refuse(in, TAG_INPUTS, &reader, "no memory for so many ticks");
    Input *inputs = ARENA_PUSH(in->arena, Input, MAX(tick_count, 1));
    u32 tick = 0;
    for (u32 run = 0; run < run_count; run++) {
        u32 length = byte_read_u32(&reader);
        Input input = {.look_x = (i16)byte_read_u16(&reader),
                       .look_y = (i16)byte_read_u16(&reader)};
        const u8 *moves = byte_read(&reader, 4);
        input.move_x = (i8)moves[0], input.move_y = (i8)moves[1], input.move_z = (i8)moves[2];
        input.buttons = byte_read_u32(&reader);
        if (moves[3] != 0) return refuse(in, TAG_INPUTS, &reader, "a reserved byte is not zero");
        if (length == 0 || length > tick_count - tick)
            return refuse(in, TAG_INPUTS, &reader, "a run is empty or goes beyond the last tick");
        for (u32 i = 0; i < length; i++) inputs[tick++] = input;
    }
    if (tick != tick_count) return refuse(in, TAG_INPUTS, &reader, "runs end before the last tick");
    in->out->tick_count = tick_count;
    in->out->inputs = inputs;
    return true;
}

static bool read_hashes(const RecordingReader *in) {
    ByteReader reader;
    u64 size = 8 * (1 + (u64)in->out->tick_count);
    if (!open_chunk(in, TAG_HASHES, size, &reader)) return false;
    if (reader.size != size || !arena_can_push(in->arena, size + 64, 64))
        return refuse(in, TAG_HASHES, &reader, "its size does not fit the count of ticks");
    in->out->start_hash = byte_read_u64(&reader);
    u64 *hashes = ARENA_PUSH(in->arena, u64, MAX(in->out->tick_count, 1));
    for (u32 i = 0; i < in->out->tick_count; i++) hashes[i] = byte_read_u64(&reader);
    in->out->world_hashes = hashes;
    return true;
}

// Walks the whole chunk, so that the check may read it without looking.
static bool read_sums(const RecordingReader *in) {
    ByteReader reader;
    if (!open_chunk(in, TAG_SUMS, RECORDING_SUMS_MAX, &reader)) return false;
    u32 ticks = byte_read_u32(&reader), table_count = byte_read_u16(&reader), column_count = 0;
    if (ticks > in->out->tick_count || table_count > WORLD_COMPONENTS_CAP)
        return refuse(in, TAG_SUMS, &reader, "the count of ticks or tables is out of range");
    u32 table_columns[WORLD_COMPONENTS_CAP] = {0};
    char name[64];
    for (u32 t = 0; t < table_count && !reader.failed; t++) {
        byte_read_text(&reader, name, sizeof name);
        table_columns[t] = byte_read_u16(&reader);
        column_count += table_columns[t];
        for (u32 c = 0; c < table_columns[t] && !reader.failed; c++)
            byte_read_text(&reader, name, sizeof name);
    }
    if (reader.failed || column_count > RECORDING_COLUMNS_MAX)
        return refuse(in, TAG_SUMS, &reader, "the names of tables are damaged");
    for (u32 t = 0; t < table_count; t++) byte_read(&reader, 4 + 16ull * table_columns[t]);
    for (u32 tick = 0; tick < ticks && !reader.failed; tick++) {
        u32 changed = byte_read_u16(&reader);
        for (u32 i = 0; i < changed && !reader.failed; i++) {
            if (byte_read_u16(&reader) >= table_count) reader.failed = true;
            byte_read_u32(&reader);
        }
        changed = byte_read_u16(&reader);
        for (u32 i = 0; i < changed && !reader.failed; i++) {
            if (byte_read_u16(&reader) >= column_count) reader.failed = true;
            byte_read(&reader, 16);
        }
    }
    if (reader.failed || reader.at != reader.size)
        return refuse(in, TAG_SUMS, &reader, "sums are damaged");
    in->out->column_sums = reader.data;
    in->out->column_sums_size = reader.size;
    return true;
}

static bool read_images(const RecordingReader *in) {
    ByteReader reader;
    u64 size_max = 4 + (u64)RECORDING_IMAGES_MAX * IMAGE_RECORD_SIZE;
    if (!open_chunk(in, TAG_IMAGES, size_max, &reader)) return false;
    u32 count = byte_read_u32(&reader);
    if (reader.failed || count > RECORDING_IMAGES_MAX ||
        reader.size - reader.at != (u64)count * IMAGE_RECORD_SIZE)
        return refuse(in, TAG_IMAGES, &reader, "the count of pictures does not fit its size");
    if (!arena_can_push(in->arena, (u64)count * sizeof(RecordedImage) + 64, 64))
        return refuse(in, TAG_IMAGES, &reader, "no memory for so many pictures");
    RecordedImage *images = ARENA_PUSH(in->arena, RecordedImage, MAX(count, 1));
    for (u32 i = 0; i < count; i++) {
        images[i].tick = byte_read_u32(&reader);
        images[i].hash = byte_read_u64(&reader);
        images[i].thumbnail = byte_read(&reader, THUMBNAIL_SIZE);
        bool late = images[i].tick > in->out->tick_count;
        if (late || (i > 0 && images[i].tick < images[i - 1].tick))
            return refuse(in, TAG_IMAGES, &reader, "pictures are out of order");
    }
    in->out->images = images;
    in->out->image_count = count;
    return true;
}

bool recording_read(const char *path, Arena *arena, Recording *out) {
    *out = (Recording){0};
    RecordingReader in = {.arena = arena, .out = out};
    u64 mark = arena_mark(arena);
    bool ok =
        chunk_file_read(path, "recording", RECORDING_MAGIC, RECORDING_VERSION, arena, &in.file) &&
        read_info(&in) && read_inputs(&in) && read_hashes(&in) && read_sums(&in) &&
        read_images(&in);
    if (ok) return true;
    *out = (Recording){0};
    arena_rewind(arena, mark);
    return false;
}
