// chunk_file.h: the container of both kinds of captures: named chunks with checksums.
//
// Layout, little-endian, nothing aligned:
//   header  magic[4]  version u32  file size u64  chunk count u32  reserved u32  file hash u64
//   chunk   tag[4]  flags u32 (1 = zstd)  raw size u64  stored size u64  hash u64  bytes
// A chunk's hash is XXH3 of its stored bytes; the file hash is that of the header with the hash's
// own eight bytes zero, chained with that of all that follows. So a flipped bit is refused, and its chunk is named.
// Strangers' files: every size is checked against the file and a cap before memory is taken.
#ifndef LUZ_CHUNK_FILE_H
#define LUZ_CHUNK_FILE_H
#include "../base/arena.h"
#ifdef __cplusplus
extern "C" {
#endif

#define CHUNK_TAG(a, b, c, d) ((u32)(a) | (u32)(b) << 8 | (u32)(c) << 16 | (u32)(d) << 24)
#define CHUNKS_MAX            64

// --- Bytes out: grows by malloc; values little-endian ---
typedef struct ByteWriter {
    u8 *data;
    u64 size, cap;
} ByteWriter;
void byte_write(ByteWriter *writer, const void *data, u64 size);
void byte_write_u16(ByteWriter *writer, u16 value);
void byte_write_u32(ByteWriter *writer, u32 value);
void byte_write_u64(ByteWriter *writer, u64 value);
void byte_write_f32(ByteWriter *writer, f32 value);
void byte_write_text(ByteWriter *writer, const char *text); // u16 length, bytes
void byte_writer_free(ByteWriter *writer);

// --- Bytes in: never reads past the end; after a failure everything reads as zero ---
typedef struct ByteReader {
    const u8 *data;
    u64 size, at;
    bool failed;
} ByteReader;
const u8 *byte_read(ByteReader *reader, u64 size); // NULL if fewer are left
u16 byte_read_u16(ByteReader *reader);
u32 byte_read_u32(ByteReader *reader);
u64 byte_read_u64(ByteReader *reader);
f32 byte_read_f32(ByteReader *reader);
// Fails on texts that do not fit with their terminating zero, and on control characters.
void byte_read_text(ByteReader *reader, char *out, u64 out_cap);

// --- Files out ---
typedef struct ChunkWriter {
    ByteWriter file;
    u32 chunk_count;
} ChunkWriter;
void chunk_writer_begin(ChunkWriter *writer, u32 magic, u32 version);
// Compressed where that makes it smaller.
void chunk_writer_add(ChunkWriter *writer, u32 tag, const void *data, u64 size, bool compress);
// Writes the file (atomic) and frees the writer, whatever the result.
bool chunk_writer_finish(ChunkWriter *writer, const char *path);
void chunk_writer_cancel(ChunkWriter *writer);

// --- Files in ---
typedef struct Chunk {
    u32 tag, flags;
    u64 at; // of the stored bytes in the file
    u64 raw_size, stored_size;
    const u8 *stored;
} Chunk;
typedef struct ChunkFile {
    const char *path;
    Chunk chunks[CHUNKS_MAX];
    u32 chunk_count;
} ChunkFile;
// Reads the file into the arena and checks everything but the contents of the chunks. False with
// LOG CAPTURE_READ (what is wrong, at which byte). `kind` is for messages: "recording".
bool chunk_file_read(const char *path, const char *kind, u32 magic, u32 version, Arena *arena,
                     ChunkFile *out);
// The unpacked bytes of a chunk (in the arena, aligned to CACHE_LINE). False with a message if it
// is absent, over raw_size_max, or does not unpack.
bool chunk_file_open(const ChunkFile *file, u32 tag, u64 raw_size_max, Arena *arena, Bytes *out);
// LOG CAPTURE_READ in the form of this folder; returns false.
bool capture_refuse(const char *path, u32 tag, u64 at, const char *why);

#ifdef __cplusplus
}
#endif
#endif
