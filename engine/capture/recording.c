// recording.c: writes a recording while a level runs.
// Data in: the input of every tick and the world after it, a picture now and then. Data out: a
// .luzr file. Called by: the shells (a key starts and stops it), `luz record`, tests.
// Does not: store worlds: a replay makes them again, and column sums name what differs.
//
// Byte layout (container: chunk_file.h; all little-endian; text = u16 length, bytes):
//   INFO  text level, u64 level hash, text build id, text device, u64 seed, u32 width, u32 height,
//         u32 setting count, then text name, u32 value bits
//   INPT  u32 ticks, u32 runs, then runs of u32 ticks, i16 look_x, look_y, i8 move_x, move_y,
//         move_z, u8 0, u32 buttons
//   HASH  u64 world hash before the first tick, then u64 after each tick
//   SUMS  u32 ticks that have sums, u16 tables, then tables of text name, u16 columns, text names
//         (the last is "entity"); then for each table u32 rows and for each column u64 s0, s1 at
//         the start; then for each tick u16 tables whose row count changed: u16 table, u32 rows;
//         u16 columns whose content changed: u16 column (counted over all tables), u64 s0, s1
//   IMGS  u32 images, then u32 tick, u64 hash, thumbnail of 96 x 54 RGB8
#include "../base/hash.h"
#include "../base/log.h"
#include "image_compare.h"
#include "recording_internal.h"
#include <stdlib.h>
#include <string.h>

struct RecordingWriter {
    RecordingInfo info;
    // Inputs, the last run still open.
    ByteWriter runs;
    Input run_input;
    u32 run_length, run_count, tick_count;
    ByteWriter hashes, sums, images;
    u32 image_count;
    // What the sums were made from: content hashes to see which columns changed.
    u32 sum_tick_count, table_count, column_count;
    u32 *row_counts;    // [table_count]
    u64 *column_hashes; // [column_count]
    bool full;          // said once that no more ticks fit
};

static u64 values_hash(const Table *table, u32 column) {
    return hash_bytes(sum_column_values(table, column), (u64)table->count * sizeof(u32), 0);
}

static void write_sum(ByteWriter *out, const Table *table, u32 column) {
    ColumnSum sum = column_sum(sum_column_values(table, column), table->count);
    byte_write_u64(out, sum.s0);
    byte_write_u64(out, sum.s1);
}

// Names, then counts and sums of the state before the first tick.
static void write_start(RecordingWriter *writer, const World *world) {
    ByteWriter *out = &writer->sums;
    byte_write_u16(out, (u16)world->component_count);
    for (u32 t = 0; t < world->component_count; t++) {
        const Table *table = world->tables[t];
        byte_write_text(out, table->desc->name);
        byte_write_u16(out, (u16)sum_column_count(table));
        for (u32 c = 0; c < sum_column_count(table); c++)
            byte_write_text(out, sum_column_name(table, c));
    }
    u32 flat = 0;
    for (u32 t = 0; t < world->component_count; t++) {
        const Table *table = world->tables[t];
        writer->row_counts[t] = table->count;
        byte_write_u32(out, table->count);
        for (u32 c = 0; c < sum_column_count(table); c++) {
            writer->column_hashes[flat++] = values_hash(table, c);
            write_sum(out, table, c);
        }
    }
}

RecordingWriter *recording_writer_create(const RecordingInfo *info, const World *world) {
    RecordingWriter *writer = calloc(1, sizeof *writer);
    LUZ_ASSERT(writer);
    writer->info = *info;
    writer->table_count = world->component_count;
    for (u32 t = 0; t < world->component_count; t++)
        writer->column_count += sum_column_count(world->tables[t]);
    LUZ_ASSERT(writer->column_count <= RECORDING_COLUMNS_MAX);
    writer->row_counts = calloc(writer->table_count + 1, sizeof *writer->row_counts);
    writer->column_hashes = calloc(writer->column_count + 1, sizeof *writer->column_hashes);
    LUZ_ASSERT(writer->row_counts && writer->column_hashes);
    byte_write_u64(&writer->hashes, world_hash(world));
    write_start(writer, world);
    return writer;
}

static void close_run(RecordingWriter *writer) {
    if (writer->run_length == 0) return;
    const Input *input = &writer->run_input;
    ByteWriter *out = &writer->runs;
    byte_write_u32(out, writer->run_length);
    byte_write_u16(out, (u16)input->look_x);
    byte_write_u16(out, (u16)input->look_y);
    const u8 moves[4] = {(u8)input->move_x, (u8)input->move_y, (u8)input->move_z, 0};
    byte_write(out, moves, sizeof moves);
    byte_write_u32(out, input->buttons);
    writer->run_count++;
    writer->run_length = 0;
}

static bool inputs_equal(const Input *a, const Input *b) {
    return a->look_x == b->look_x && a->look_y == b->look_y && a->move_x == b->move_x &&
           a->move_y == b->move_y && a->move_z == b->move_z && a->buttons == b->buttons;
}

static void write_changes(RecordingWriter *writer, const World *world) {
    ByteWriter *out = &writer->sums;
    LUZ_ASSERT(world->component_count == writer->table_count);
    // Counts come first in the file and are known last: their place is filled afterwards.
    u64 count_at = out->size;
    u32 changed = 0;
    byte_write_u16(out, 0);
    for (u32 t = 0; t < writer->table_count; t++) {
        u32 rows = world->tables[t]->count;
        if (rows == writer->row_counts[t]) continue;
        writer->row_counts[t] = rows;
        byte_write_u16(out, (u16)t);
        byte_write_u32(out, rows);
        changed++;
    }
    out->data[count_at] = (u8)changed;
    out->data[count_at + 1] = (u8)(changed >> 8);

    count_at = out->size;
    changed = 0;
    byte_write_u16(out, 0);
    u32 flat = 0;
    for (u32 t = 0; t < writer->table_count; t++) {
        const Table *table = world->tables[t];
        for (u32 c = 0; c < sum_column_count(table); c++, flat++) {
            // Hashing is ten times faster than summing, and most columns never change.
            u64 hash = values_hash(table, c);
            if (hash == writer->column_hashes[flat]) continue;
            writer->column_hashes[flat] = hash;
            byte_write_u16(out, (u16)flat);
            write_sum(out, table, c);
            changed++;
        }
    }
    out->data[count_at] = (u8)changed;
    out->data[count_at + 1] = (u8)(changed >> 8);
    writer->sum_tick_count++;
}

void recording_writer_tick(RecordingWriter *writer, Input input, const World *world) {
    if (writer->tick_count == RECORDING_TICKS_MAX) {
        if (!writer->full)
            LOG(CAPTURE_WRITE, "the recording is full (%u ticks); what follows is left out",
                RECORDING_TICKS_MAX);
        writer->full = true;
        return;
    }
    if (writer->run_length == 0 || !inputs_equal(&input, &writer->run_input)) {
        close_run(writer);
        writer->run_input = input;
    }
    writer->run_length++;
    writer->tick_count++;
    byte_write_u64(&writer->hashes, world_hash(world));
    bool sums_complete = writer->sum_tick_count + 1 == writer->tick_count;
    if (sums_complete && writer->sums.size < RECORDING_SUMS_MAX / 2) write_changes(writer, world);
}

void recording_writer_image(RecordingWriter *writer, u32 tick, u64 image_hash, const u8 *rgba,
                            u32 width_px, u32 height_px) {
    if (writer->image_count == RECORDING_IMAGES_MAX || writer->full) return;
    u8 thumbnail[THUMBNAIL_SIZE] = {0};
    if (rgba) image_reduce(rgba, width_px, height_px, thumbnail, THUMBNAIL_WIDTH, THUMBNAIL_HEIGHT);
    byte_write_u32(&writer->images, tick);
    byte_write_u64(&writer->images, image_hash);
    byte_write(&writer->images, thumbnail, sizeof thumbnail);
    writer->image_count++;
}

static void write_info(const RecordingInfo *info, ByteWriter *out) {
    byte_write_text(out, info->level);
    byte_write_u64(out, info->level_hash);
    byte_write_text(out, info->build_id);
    byte_write_text(out, info->device);
    byte_write_u64(out, info->seed);
    byte_write_u32(out, info->width_px);
    byte_write_u32(out, info->height_px);
    byte_write_u32(out, render_setting_count);
    for (u32 i = 0; i < render_setting_count; i++) {
        u32 bits;
        memcpy(&bits, (const u8 *)&info->settings + render_setting_descs[i].offset, sizeof bits);
        byte_write_text(out, render_setting_descs[i].name);
        byte_write_u32(out, bits);
    }
}

// A chunk that begins with one or two counts.
static void add_counted(ChunkWriter *file, u32 tag, u32 count, const u32 *second,
                        const ByteWriter *body) {
    ByteWriter chunk = {0};
    byte_write_u32(&chunk, count);
    if (second) byte_write_u32(&chunk, *second);
    byte_write(&chunk, body->data, body->size);
    chunk_writer_add(file, tag, chunk.data, chunk.size, true);
    byte_writer_free(&chunk);
}

bool recording_writer_finish(RecordingWriter *writer, const char *path) {
    close_run(writer);
    ChunkWriter file;
    chunk_writer_begin(&file, RECORDING_MAGIC, RECORDING_VERSION);
    ByteWriter info = {0};
    write_info(&writer->info, &info);
    chunk_writer_add(&file, TAG_INFO, info.data, info.size, false);
    byte_writer_free(&info);
    add_counted(&file, TAG_INPUTS, writer->tick_count, &writer->run_count, &writer->runs);
    chunk_writer_add(&file, TAG_HASHES, writer->hashes.data, writer->hashes.size, false);
    add_counted(&file, TAG_SUMS, writer->sum_tick_count, NULL, &writer->sums);
    add_counted(&file, TAG_IMAGES, writer->image_count, NULL, &writer->images);
    bool ok = chunk_writer_finish(&file, path);
    recording_writer_cancel(writer);
    return ok;
}

void recording_writer_cancel(RecordingWriter *writer) {
    byte_writer_free(&writer->runs);
    byte_writer_free(&writer->hashes);
    byte_writer_free(&writer->sums);
    byte_writer_free(&writer->images);
    free(writer->row_counts);
    free(writer->column_hashes);
    free(writer);
}
