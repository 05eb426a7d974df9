// capture_damage.c: captures from strangers: flipped bits, cut files, forged chunks with right
// checksums. Each is refused with a message or is a sound capture; none crashes.
#include "capture_fixture.h"
#include "../../engine/app/session.h"
#include "../../engine/base/log.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/recording_internal.h"
#include <stdlib.h>
#include <string.h>

#define SEED 77u

static Arena test_arena(void) {
    Arena arena;
    assert_true(arena_create(&arena, "test", GIB(8)));
    return arena;
}

typedef bool (*ReadCapture)(const char *path, Arena *arena);

static bool read_recording(const char *path, Arena *arena) {
    Recording recording;
    if (!recording_read(path, arena, &recording)) return false;
    // What is accepted must be safe to use.
    capture_replay(&recording, UINT32_MAX, NULL, arena);
    return true;
}

static bool read_frame(const char *path, Arena *arena) {
    AssetStore store;
    const Packet *packet;
    if (!frame_file_read(path, arena, &store, &packet)) return false;
    assert_null(packet_validate(packet, packet->size, store.mesh_count, store.texture_count));
    asset_store_destroy(&store);
    return true;
}

static void write_frame(const char *path) {
    Session session;
    assert_true(session_create(&session, &(SessionDesc){0}));
    assert_true(session_load(&session, "data/levels/cornell_empty.toml"));
    const Packet *packet = session_packet(
        &session, &(SessionView){.settings = settings_default(), .width_px = 80, .height_px = 45});
    assert_non_null(packet);
    assert_true(frame_file_write(path, packet, &session.assets));
    session_destroy(&session);
}

static void refuse_damage(const char *path, ReadCapture read) {
    Arena arena = test_arena();
    const char *broken = test_temp_path("broken");
    u64 size;
    u8 *bytes = capture_read_bytes(path, &size);
    assert_true(read(path, &arena));
    log_set_level(LOG_SEVERITY_NONE);
    for (u64 at = 0; at < size; at += at < 256 ? 1 : 1 + size / 300) {
        bytes[at] ^= (u8)(1u << (at % 8));
        capture_write_bytes(broken, bytes, size);
        bytes[at] ^= (u8)(1u << (at % 8));
        u32 said = log_count(LOG_CAPTURE_READ);
        arena_reset(&arena);
        if (read(broken, &arena)) fail_msg("a flipped bit of byte %u passes", (u32)at);
        assert_int_equal(log_count(LOG_CAPTURE_READ), said + 1);
    }
    for (u64 length = 0; length < size; length += length < 128 ? 1 : 1 + size / 150) {
        capture_write_bytes(broken, bytes, length);
        arena_reset(&arena);
        if (read(broken, &arena)) fail_msg("a file cut at %u passes", (u32)length);
    }
    bytes[size] = 0;
    capture_write_bytes(broken, bytes, size + 1);
    assert_false(read(broken, &arena));
    free(bytes);
    arena_destroy(&arena);
}

TEST(capture_damage, recording_bits_and_lengths) {
    const char *path = test_temp_path("a.luzr");
    capture_record(path, 60);
    refuse_damage(path, read_recording);
}

TEST(capture_damage, frame_bits_and_lengths) {
    const char *path = test_temp_path("a.luzf");
    write_frame(path);
    refuse_damage(path, read_frame);
}

TEST(capture_damage, says_which_chunk) {
    const char *path = test_temp_path("a.luzr");
    capture_record(path, 60);
    u64 size;
    u8 *bytes = capture_read_bytes(path, &size);
    bytes[size - 1] ^= 1; // the last chunk: pictures
    capture_write_bytes(path, bytes, size);
    free(bytes);
    Arena arena = test_arena();
    assert_false(read_recording(path, &arena));
    char text[512];
    log_last_error(text, sizeof text);
    assert_non_null(strstr(text, "IMGS"));
    assert_non_null(strstr(text, "checksum"));
    arena_destroy(&arena);
}

// --- forged files: the checksums are right, the contents are not ---

static void put_u32(u8 *at, u32 value) { memcpy(at, &value, sizeof value); }

static void damage(u8 *data, u64 size, u32 round) {
    static const u32 interesting[] = {0,           1,           0x7F,        0x80,
                                      0xFF,        0x7FFF,      0xFFFF,      0x7FFFFFFF,
                                      0x80000000u, 0xFFFFFFFFu, 0x7F800000u, 0x7FC00000u};
    u32 changes = 1 + random_u32(SEED, 1, round) % 4;
    for (u32 i = 0; i < changes && size >= 4; i++) {
        u64 counter = (u64)round * 8 + i;
        // The beginning holds the counts: half of the changes go there.
        u64 reach = random_u32(SEED, 2, counter) % 2 ? MIN(size, 64) : size;
        u64 at = random_u64(SEED, 3, counter) % (reach - 3);
        u32 kind = random_u32(SEED, 4, counter) % 3;
        if (kind == 0)
            data[at] = (u8)random_u32(SEED, 5, counter);
        else if (kind == 1)
            put_u32(data + at, interesting[random_u32(SEED, 6, counter) % COUNT_OF(interesting)]);
        else
            data[at] += (u8)(random_u32(SEED, 7, counter) % 2 ? 1 : 255);
    }
}

// Takes the file apart, damages the contents of one chunk, and puts it together soundly.
static void forge(const char *path, const char *kind, u32 magic, ReadCapture read, u32 rounds) {
    Arena arena = test_arena(), parts = test_arena();
    const char *forged = test_temp_path("forged");
    ChunkFile file;
    assert_true(chunk_file_read(path, kind, magic, 1, &parts, &file));
    Bytes raw[CHUNKS_MAX];
    for (u32 i = 0; i < file.chunk_count; i++)
        assert_true(chunk_file_open(&file, file.chunks[i].tag, GIB(1), &parts, &raw[i]));
    log_set_level(LOG_SEVERITY_NONE);
    u32 refused = 0;
    for (u32 round = 0; round < rounds; round++) {
        u32 victim = random_u32(SEED, 0, round) % file.chunk_count;
        ChunkWriter writer;
        chunk_writer_begin(&writer, magic, 1);
        for (u32 i = 0; i < file.chunk_count; i++) {
            u64 size = raw[i].size;
            u8 *copy = malloc(size + 1);
            assert_non_null(copy);
            memcpy(copy, raw[i].data, size);
            if (i == victim) {
                damage(copy, size, round);
                if (random_u32(SEED, 8, round) % 8 == 0)
                    size = random_u64(SEED, 9, round) % (size + 1);
            }
            chunk_writer_add(&writer, file.chunks[i].tag, copy, size, round % 2);
            free(copy);
        }
        assert_true(chunk_writer_finish(&writer, forged));
        arena_reset(&arena);
        refused += !read(forged, &arena);
    }
    // A forger who changes a pixel is not found out; one who changes a count is.
    assert_in_range(refused, rounds / 20, rounds);
    arena_destroy(&arena);
    arena_destroy(&parts);
}

TEST(capture_damage, forged_recordings) {
    const char *path = test_temp_path("a.luzr");
    capture_record(path, 60);
    forge(path, "recording", RECORDING_MAGIC, read_recording, 300);
}

TEST(capture_damage, forged_frames) {
    const char *path = test_temp_path("a.luzf");
    write_frame(path);
    forge(path, "frame", CHUNK_TAG('L', 'U', 'Z', 'F'), read_frame, 300);
}

// A chunk that claims to unpack to more than is allowed takes no memory.
TEST(capture_damage, unpacks_no_bombs) {
    const char *path = test_temp_path("bomb.luzr");
    u64 size = MIB(64);
    u8 *zeros = calloc(1, size);
    assert_non_null(zeros);
    ChunkWriter writer;
    chunk_writer_begin(&writer, RECORDING_MAGIC, RECORDING_VERSION);
    chunk_writer_add(&writer, TAG_INFO, zeros, size, true);
    assert_true(chunk_writer_finish(&writer, path));
    free(zeros);
    u64 file_size;
    free(capture_read_bytes(path, &file_size));
    assert_in_range(file_size, 0, KIB(64));
    Arena arena = test_arena();
    log_set_level(LOG_SEVERITY_NONE);
    assert_false(read_recording(path, &arena));
    assert_in_range(arena.high_water, 0, MIB(1));
    arena_destroy(&arena);
}

TEST(capture_damage, refuses_strangers) {
    const char *path = test_temp_path("text.luzr");
    const char *texts[] = {"", "LUZR", "LUZF",
                           "PK\003\004 this is no capture, but long enough to be one"};
    Arena arena = test_arena();
    log_set_level(LOG_SEVERITY_NONE);
    for (u32 i = 0; i < COUNT_OF(texts); i++) {
        capture_write_bytes(path, (const u8 *)texts[i], strlen(texts[i]));
        assert_false(read_recording(path, &arena));
        assert_false(read_frame(path, &arena));
    }
    assert_false(read_recording(test_temp_path("absent"), &arena));
    assert_false(read_recording(test_temp_dir(), &arena));
    // A recording is no frame, nor the other way round.
    capture_record(path, 3);
    assert_false(read_frame(path, &arena));
    arena_destroy(&arena);
}
