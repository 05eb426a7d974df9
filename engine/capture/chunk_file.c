// chunk_file.c: writes and reads files of named, checksummed, perhaps compressed chunks.
// Data in: chunks of bytes; or a file from anybody. Data out: a file that is complete or absent; or
// the chunks, or a message. Called by: recording*.c, frame_file.c. Does not: know what is inside.
#include "chunk_file.h"
#include "../base/file.h"
#include "../base/hash.h"
#include "../base/log.h"
#include "capture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#define HEADER_SIZE       32u
#define HEADER_HASH_AT    24u
#define CHUNK_HEADER_SIZE 32u
#define CHUNK_ZSTD        1u
#define ZSTD_LEVEL        3

// --- bytes out ---

void byte_write(ByteWriter *writer, const void *data, u64 size) {
    if (writer->size + size > writer->cap) {
        writer->cap = MAX(MAX(writer->cap * 2, writer->size + size), 4096);
        writer->data = realloc(writer->data, writer->cap);
        LUZ_ASSERT(writer->data);
    }
    if (size) memcpy(writer->data + writer->size, data, size);
    writer->size += size;
}

void byte_write_u16(ByteWriter *writer, u16 value) {
    u8 bytes[2] = {(u8)value, (u8)(value >> 8)};
    byte_write(writer, bytes, sizeof bytes);
}

void byte_write_u32(ByteWriter *writer, u32 value) {
    u8 bytes[4];
    for (u32 i = 0; i < sizeof bytes; i++) bytes[i] = (u8)(value >> (8 * i));
    byte_write(writer, bytes, sizeof bytes);
}

void byte_write_u64(ByteWriter *writer, u64 value) {
    byte_write_u32(writer, (u32)value);
    byte_write_u32(writer, (u32)(value >> 32));
}

void byte_write_f32(ByteWriter *writer, f32 value) {
    u32 bits;
    memcpy(&bits, &value, sizeof bits);
    byte_write_u32(writer, bits);
}

void byte_write_text(ByteWriter *writer, const char *text) {
    u64 length = MIN(strlen(text), UINT16_MAX);
    byte_write_u16(writer, (u16)length);
    byte_write(writer, text, length);
}

void byte_writer_free(ByteWriter *writer) {
    free(writer->data);
    *writer = (ByteWriter){0};
}

// --- bytes in ---

const u8 *byte_read(ByteReader *reader, u64 size) {
    if (reader->failed || size > reader->size - reader->at) {
        reader->failed = true;
        return NULL;
    }
    const u8 *bytes = reader->data + reader->at;
    reader->at += size;
    return bytes;
}

static u64 byte_read_little(ByteReader *reader, u32 size) {
    const u8 *bytes = byte_read(reader, size);
    u64 value = 0;
    for (u32 i = 0; bytes && i < size; i++) value |= (u64)bytes[i] << (8 * i);
    return value;
}

u16 byte_read_u16(ByteReader *reader) { return (u16)byte_read_little(reader, 2); }
u32 byte_read_u32(ByteReader *reader) { return (u32)byte_read_little(reader, 4); }
u64 byte_read_u64(ByteReader *reader) { return byte_read_little(reader, 8); }

f32 byte_read_f32(ByteReader *reader) {
    u32 bits = byte_read_u32(reader);
    f32 value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void byte_read_text(ByteReader *reader, char *out, u64 out_cap) {
    out[0] = 0;
    u16 length = byte_read_u16(reader);
    const u8 *bytes = byte_read(reader, length);
    if (!bytes) return;
    bool bad = length + 1u > out_cap;
    for (u32 i = 0; i < length; i++) bad |= bytes[i] < 0x20 || bytes[i] == 0x7F;
    if (bad) {
        reader->failed = true;
        return;
    }
    memcpy(out, bytes, length);
    out[length] = 0;
}

// --- files out ---

void chunk_writer_begin(ChunkWriter *writer, u32 magic, u32 version) {
    *writer = (ChunkWriter){0};
    byte_write_u32(&writer->file, magic);
    byte_write_u32(&writer->file, version);
    for (u32 i = 8; i < HEADER_SIZE; i++) byte_write(&writer->file, "", 1); // filled at the end
}

void chunk_writer_add(ChunkWriter *writer, u32 tag, const void *data, u64 size, bool compress) {
    LUZ_ASSERT(writer->chunk_count < CHUNKS_MAX);
    const void *stored = data;
    u64 stored_size = size;
    u32 flags = 0;
    u8 *packed = NULL;
    if (compress && size > 0) {
        u64 bound = ZSTD_compressBound(size);
        packed = malloc(bound);
        LUZ_ASSERT(packed);
        size_t packed_size = ZSTD_compress(packed, bound, data, size, ZSTD_LEVEL);
        if (!ZSTD_isError(packed_size) && packed_size < size)
            stored = packed, stored_size = packed_size, flags = CHUNK_ZSTD;
    }
    byte_write_u32(&writer->file, tag);
    byte_write_u32(&writer->file, flags);
    byte_write_u64(&writer->file, size);
    byte_write_u64(&writer->file, stored_size);
    byte_write_u64(&writer->file, hash_bytes(stored, stored_size, 0));
    byte_write(&writer->file, stored, stored_size);
    writer->chunk_count++;
    free(packed);
}

// Of the whole file, with the place of the hash itself read as zero.
static u64 hash_file(const u8 *data, u64 size) {
    u8 header[HEADER_SIZE];
    memcpy(header, data, HEADER_SIZE);
    memset(header + HEADER_HASH_AT, 0, 8);
    return hash_bytes(data + HEADER_SIZE, size - HEADER_SIZE, hash_bytes(header, HEADER_SIZE, 0));
}

static void put_u64(u8 *at, u64 value) {
    for (u32 i = 0; i < 8; i++) at[i] = (u8)(value >> (8 * i));
}

bool chunk_writer_finish(ChunkWriter *writer, const char *path) {
    ByteWriter *file = &writer->file;
    put_u64(file->data + 8, file->size);
    put_u64(file->data + 16, writer->chunk_count); // upper half: reserved, zero
    put_u64(file->data + HEADER_HASH_AT, hash_file(file->data, file->size));
    bool ok = file->size <= CAPTURE_FILE_SIZE_MAX;
    if (!ok)
        LOG(CAPTURE_WRITE, "'%s' would be larger than %llu MiB", path,
            (unsigned long long)(CAPTURE_FILE_SIZE_MAX >> 20));
    ok = ok && file_write(path, file->data, file->size);
    byte_writer_free(file);
    return ok;
}

void chunk_writer_cancel(ChunkWriter *writer) { byte_writer_free(&writer->file); }

// --- files in ---

static void tag_text(u32 tag, char out[5]) {
    for (u32 i = 0; i < 4; i++) {
        u8 c = (u8)(tag >> (8 * i));
        out[i] = c > 0x20 && c < 0x7F ? (char)c : '?';
    }
    out[4] = 0;
}

bool capture_refuse(const char *path, u32 tag, u64 at, const char *why) {
    char name[5];
    tag_text(tag, name);
    if (tag)
        LOG(CAPTURE_READ, "'%s': chunk %s at byte %llu: %s", path, name, (unsigned long long)at,
            why);
    else
        LOG(CAPTURE_READ, "'%s': byte %llu: %s", path, (unsigned long long)at, why);
    return false;
}

static bool read_chunk(ChunkFile *out, ByteReader *reader) {
    u64 at = reader->at;
    Chunk *chunk = &out->chunks[out->chunk_count];
    chunk->tag = byte_read_u32(reader);
    chunk->flags = byte_read_u32(reader);
    chunk->raw_size = byte_read_u64(reader);
    chunk->stored_size = byte_read_u64(reader);
    u64 hash = byte_read_u64(reader);
    chunk->at = reader->at;
    chunk->stored = byte_read(reader, chunk->stored_size);
    if (!chunk->stored) return capture_refuse(out->path, 0, at, "the file ends within a chunk");
    if (hash_bytes(chunk->stored, chunk->stored_size, 0) != hash)
        return capture_refuse(out->path, chunk->tag, at, "is damaged (its checksum is wrong)");
    bool packed = chunk->flags & CHUNK_ZSTD;
    if ((chunk->flags & ~CHUNK_ZSTD) || (!packed && chunk->raw_size != chunk->stored_size))
        return capture_refuse(out->path, chunk->tag, at, "has a header that makes no sense");
    for (u32 i = 0; i < out->chunk_count; i++)
        if (out->chunks[i].tag == chunk->tag)
            return capture_refuse(out->path, chunk->tag, at, "is there twice");
    out->chunk_count++;
    return true;
}

bool chunk_file_read(const char *path, const char *kind, u32 magic, u32 version, Arena *arena,
                     ChunkFile *out) {
    *out = (ChunkFile){.path = path};
    Bytes bytes;
    if (!file_read(path, CAPTURE_FILE_SIZE_MAX, arena, &bytes)) return false;
    ByteReader reader = {.data = bytes.data, .size = bytes.size};
    u32 file_magic = byte_read_u32(&reader), file_version = byte_read_u32(&reader);
    u64 file_size = byte_read_u64(&reader);
    u32 chunk_count = byte_read_u32(&reader), reserved = byte_read_u32(&reader);
    u64 file_hash = byte_read_u64(&reader);
    char why[128];
    if (reader.failed || file_magic != magic) {
        snprintf(why, sizeof why, "this is no luz %s", kind);
        return capture_refuse(path, 0, 0, why);
    }
    if (file_version != version) {
        snprintf(why, sizeof why, "%s of version %u; this build reads version %u", kind,
                 file_version, version);
        return capture_refuse(path, 0, 4, why);
    }
    if (file_size != bytes.size) {
        snprintf(why, sizeof why, "the file has %llu bytes and should have %llu",
                 (unsigned long long)bytes.size, (unsigned long long)file_size);
        return capture_refuse(path, 0, 8, why);
    }
    if (chunk_count > CHUNKS_MAX || reserved != 0)
        return capture_refuse(path, 0, 16, "the count of chunks is out of range");
    for (u32 i = 0; i < chunk_count; i++)
        if (!read_chunk(out, &reader)) return false;
    if (reader.at != bytes.size)
        return capture_refuse(path, 0, reader.at, "bytes after the last chunk");
    if (hash_file(bytes.data, bytes.size) != file_hash)
        return capture_refuse(path, 0, HEADER_HASH_AT, "headers are damaged (wrong checksum)");
    return true;
}

bool chunk_file_open(const ChunkFile *file, u32 tag, u64 raw_size_max, Arena *arena, Bytes *out) {
    const Chunk *chunk = NULL;
    for (u32 i = 0; i < file->chunk_count; i++)
        if (file->chunks[i].tag == tag) chunk = &file->chunks[i];
    if (!chunk) return capture_refuse(file->path, tag, 0, "is missing");
    if (chunk->raw_size > raw_size_max || !arena_can_push(arena, chunk->raw_size + 1, CACHE_LINE))
        return capture_refuse(file->path, tag, chunk->at, "is larger than allowed");
    u8 *raw = arena_push(arena, chunk->raw_size + 1, CACHE_LINE);
    *out = (Bytes){raw, chunk->raw_size};
    if (!(chunk->flags & CHUNK_ZSTD)) {
        memcpy(raw, chunk->stored, chunk->raw_size);
        return true;
    }
    // The frame's own claim first: it bounds what the decoder will write.
    unsigned long long claimed = ZSTD_getFrameContentSize(chunk->stored, chunk->stored_size);
    if (claimed != chunk->raw_size)
        return capture_refuse(file->path, tag, chunk->at, "does not say its size right");
    size_t got = ZSTD_decompress(raw, chunk->raw_size, chunk->stored, chunk->stored_size);
    if (ZSTD_isError(got) || got != chunk->raw_size)
        return capture_refuse(file->path, tag, chunk->at, "does not unpack");
    return true;
}
