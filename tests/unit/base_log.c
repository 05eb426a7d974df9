// base_log.c: log ids, levels, counters, the sink, many threads; hashes and clocks beside.
#include "../test.h"
#include "../../engine/base/clock.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/log.h"
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

TEST(log, counts_ids_also_below_the_level) {
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    LOG(NOTE, "one");
    LOG(NOTE, "two %d", 2);
    LOG(DEBUG_NOTE, "three");
    LOG(FILE_READ, "four");
    assert_int_equal(log_count(LOG_NOTE), 2);
    assert_int_equal(log_count(LOG_DEBUG_NOTE), 1);
    assert_int_equal(log_count(LOG_FILE_READ), 1);
    assert_int_equal(log_count(LOG_GPU_NONE), 0);
    log_reset_counts();
    assert_int_equal(log_count(LOG_NOTE), 0);
}

TEST(log, ids_have_their_names) {
    assert_string_equal(log_id_name(LOG_NOTE), "NOTE");
    assert_string_equal(log_id_name(LOG_LEVEL_ERROR), "LEVEL_ERROR");
    assert_string_equal(log_id_name(LOG_USAGE), "USAGE");
    for (u32 i = 0; i < LOG_ID_COUNT; i++)
        for (u32 j = 0; j < i; j++)
            assert_string_not_equal(log_id_name((LogId)i), log_id_name((LogId)j));
    ASSERT_DIES(log_count(LOG_ID_COUNT));
}

TEST(log, keeps_the_last_error) {
    char text[64];
    log_set_level(LOG_SEVERITY_NONE);
    log_last_error(text, sizeof text);
    assert_string_equal(text, "");
    LOG(FILE_READ, "disk %s", "on fire");
    LOG(ASSET_IMAGE, "only a warning");
    log_last_error(text, sizeof text);
    assert_string_equal(text, "disk on fire");
    log_last_error(text, 5);
    assert_string_equal(text, "disk");
    log_last_error(text, 0); // nothing to write to
    char *endless = calloc(1, 100000);
    memset(endless, 'x', 99999);
    LOG(FILE_READ, "%s", endless); // cut, not overrun
    free(endless);
    log_last_error(text, sizeof text);
    assert_int_equal(strlen(text), sizeof text - 1);
}

TEST(log, hushed_messages_are_kept) {
    char text[64];
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    log_hush(LOG_SEVERITY_WARNING);
    LOG(ASSET_IMAGE, "half a picture");
    LOG(NOTE, "not kept");
    log_hush(LOG_SEVERITY_NONE);
    log_last_error(text, sizeof text);
    assert_string_equal(text, "half a picture");
    assert_int_equal(log_count(LOG_ASSET_IMAGE), 1);
    LOG(ASSET_IMAGE, "only a warning");
    log_last_error(text, sizeof text);
    assert_string_equal(text, "half a picture");
}

typedef struct Seen {
    u32 count;
    LogId id;
    LogLevel level;
    char text[64];
} Seen;

static void sink(LogId id, LogLevel level, const char *text, void *user) {
    Seen *seen = user;
    seen->count++;
    seen->id = id;
    seen->level = level;
    strncpy(seen->text, text, sizeof seen->text - 1);
    LOG(NOTE, "from the sink"); // counted, not observed: no recursion
}

TEST(log, hands_messages_to_the_sink) {
    Seen seen = {0};
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    log_set_sink(sink, &seen);
    LOG(GPU_LOST, "surface %d", 3);
    log_set_sink(NULL, NULL);
    LOG(GPU_LOST, "unseen");
    assert_int_equal(seen.count, 1);
    assert_int_equal(seen.id, LOG_GPU_LOST);
    assert_int_equal(seen.level, LOG_SEVERITY_WARNING);
    assert_string_equal(seen.text, "surface 3");
    assert_int_equal(log_count(LOG_NOTE), 1);
}

static void *log_often(void *argument) {
    for (u32 i = 0; i < 1000; i++) LOG(FILE_READ, "thread %d line %u", *(int *)argument, i);
    return NULL;
}

TEST(log, is_thread_safe) {
    log_set_level(LOG_SEVERITY_NONE);
    log_reset_counts();
    pthread_t threads[4];
    int ids[4] = {0, 1, 2, 3};
    for (u32 i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, log_often, &ids[i]), 0);
    for (u32 i = 0; i < 4; i++) pthread_join(threads[i], NULL);
    assert_int_equal(log_count(LOG_FILE_READ), 4000);
    char text[64];
    log_last_error(text, sizeof text);
    assert_memory_equal(text, "thread ", 7);
}

TEST(hash, is_the_published_xxh3) {
    // Reference values of XXH3_64bits (xxhsum -H3): blocks and levels refer to them for ever.
    assert_true(hash_bytes("", 0, 0) == 0x2D06800538D394C2ull);
    assert_true(hash_string("") == hash_bytes("", 0, 0));
    assert_true(hash_string("abc") == 0x78AF5F94892F3950ull);
    u8 bytes[300] = {0};
    u64 before = hash_bytes(bytes, sizeof bytes, 5);
    for (u32 i = 0; i < sizeof bytes; i++) {
        bytes[i] ^= 1;
        assert_true(hash_bytes(bytes, sizeof bytes, 5) != before);
        bytes[i] ^= 1;
    }
    assert_true(hash_bytes(bytes, sizeof bytes, 6) != before);
    assert_true(hash_bytes(bytes, 0, 1) != hash_bytes(bytes, 0, 2)); // a chain keeps its history
}

TEST(clock, moves_forward) {
    f64 wall = clock_now_ms(), process = clock_process_cpu_ms(), thread = clock_thread_cpu_ms();
    volatile u32 work = 0;
    for (u32 i = 0; i < 2000000; i++) work += i;
    assert_true(work > 0);
    assert_true(clock_now_ms() > wall);
    assert_true(clock_process_cpu_ms() > process);
    assert_true(clock_thread_cpu_ms() > thread);
}
