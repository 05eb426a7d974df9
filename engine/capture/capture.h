// capture.h: recordings (input per tick) and frame files (one packet with its assets): written,
// read, verified. Both are versioned, checksummed and safe to read from a stranger.
//
// Recording (.luzr): header, then per tick the input (run-length coded), the world hash, and column
// sums of what changed; every n-th tick an image hash and a thumbnail. Frame (.luzf): a packet, the
// meshes and textures that it draws, zstd-compressed. Byte layouts: recording.c, frame_file.c.
#ifndef LUZ_CAPTURE_H
#define LUZ_CAPTURE_H
#include "../frame/packet.h"
#include "../asset/asset.h"
#include "../world/input.h"
#include "../world/world.h"
#ifdef __cplusplus
extern "C" {
#endif

#define CAPTURE_FILE_SIZE_MAX GIB(1)
#define RECORDING_TICKS_MAX   (60u * 60u * 60u * 4u) // four hours
#define THUMBNAIL_WIDTH       96
#define THUMBNAIL_HEIGHT      54

typedef struct RecordingInfo {
    char level[512];      // path as given when recording, relative to the working directory
    u64 level_hash;       // LevelInfo.content_hash
    char build_id[64];
    char device[128];     // driver that made the image hashes ("" if none)
    u64 seed;
    u32 width_px, height_px;
    RenderSettings settings; // of the images
} RecordingInfo;

typedef struct RecordedImage {
    u32 tick;
    u64 hash;
    const u8 *thumbnail; // RGB8, THUMBNAIL_WIDTH x THUMBNAIL_HEIGHT
} RecordedImage;

// Ticks are counted from the start of the recording: after the first simulated tick the tick is 1;
// 0 is the state before it (which a picture may show, too).

// --- Writing ---
typedef struct RecordingWriter RecordingWriter;
RecordingWriter *recording_writer_create(const RecordingInfo *info, const World *world_at_start);
// After the tick was simulated. The world's components stay the same from start to end.
void recording_writer_tick(RecordingWriter *writer, Input input, const World *world);
void recording_writer_image(RecordingWriter *writer, u32 tick, u64 image_hash, const u8 *rgba,
                            u32 width_px, u32 height_px);
// Writes the file (atomic) and frees the writer, whatever the result.
bool recording_writer_finish(RecordingWriter *writer, const char *path);
void recording_writer_cancel(RecordingWriter *writer);

// --- Reading ---
typedef struct Recording {
    RecordingInfo info;
    u32 tick_count, image_count;
    const Input *inputs;       // [tick_count]
    const u64 *world_hashes;   // [tick_count] after the tick
    u64 start_hash;            // before the first tick
    const RecordedImage *images;
    const void *column_sums;   // private: per tick, see recording.c
    u64 column_sums_size;
} Recording;
// Everything in the arena. False with LOG CAPTURE_READ that says what is wrong and where (byte).
bool recording_read(const char *path, Arena *arena, Recording *out);

// Feeds ticks to a world being replayed and compares. Call with tick 0 for the state at the start (or
// leave that out), then after each simulated tick, in order.
typedef struct RecordingCheck RecordingCheck;
RecordingCheck *recording_check_create(const Recording *recording, const World *world_at_start, Arena *arena);
typedef struct RecordingDifference {
    u32 tick;
    char table[64], column[64]; // "" if not known
    u32 row;                    // ROW_NONE: several rows or not known
    Entity entity;
    char text[256];             // one sentence
} RecordingDifference;
// True if the world equals the recorded one after this tick; else fills the difference.
bool recording_check_tick(RecordingCheck *check, u32 tick, const World *world,
                          RecordingDifference *difference);

// --- Frames ---
bool frame_file_write(const char *path, const Packet *packet, const AssetStore *assets);
// Packet in the arena (validated), assets into a fresh store.
bool frame_file_read(const char *path, Arena *arena, AssetStore *store, const Packet **packet);

#ifdef __cplusplus
}
#endif
#endif
