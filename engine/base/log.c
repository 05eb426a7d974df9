// log.c: messages with ids, counted and printed.
// Data in: LOG(ID, ...) from any thread. Data out: a line on stderr, a counter per id, the text
// of the newest error, and a call of the sink. Called by: everybody. Does not: allocate, buffer,
// or stop the program.
//
// One recursive mutex guards the text state: a sink may itself log (its message is printed and
// counted, but not handed to the sink again). Counters and the level are atomics, so that a
// suppressed message costs no lock.
#include "log.h"
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Longer messages are cut: a validation message fits, a dumped file does not.
#define LOG_TEXT_CAP 8192

static const struct {
    const char *name;
    LogLevel level;
} log_ids[LOG_ID_COUNT] = {
#define X(id, level, about) {#id, LOG_SEVERITY_##level},
    LOG_IDS(X)
#undef X
};

static const char *const log_level_names[] = {"debug", "info", "warning", "error", "none"};

#define LEVEL_UNSET -1
static atomic_int log_level = LEVEL_UNSET; // LEVEL_UNSET: take LUZ_LOG at the first message
static atomic_uint log_counts[LOG_ID_COUNT];
static _Thread_local LogLevel log_hushed = LOG_SEVERITY_NONE;

static pthread_mutex_t log_mutex = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;
// All below are guarded by log_mutex.
static char log_error_text[LOG_TEXT_CAP];
static LogSink log_sink;
static void *log_sink_user;
static bool log_in_sink;

static LogLevel log_level_from_environment(void) {
    const char *text = getenv("LUZ_LOG");
    for (u32 i = 0; text && i < COUNT_OF(log_level_names); i++)
        if (strcmp(text, log_level_names[i]) == 0) return (LogLevel)i;
    return LOG_SEVERITY_INFO;
}

static LogLevel log_current_level(void) {
    int level = atomic_load_explicit(&log_level, memory_order_relaxed);
    if (level == LEVEL_UNSET) {
        // Two threads may both come here; they find the same value, and an explicit
        // log_set_level in between wins.
        int expected = LEVEL_UNSET;
        level = (int)log_level_from_environment();
        if (!atomic_compare_exchange_strong(&log_level, &expected, level)) level = expected;
    }
    return (LogLevel)level;
}

void log_set_level(LogLevel level) { atomic_store(&log_level, (int)level); }

void log_hush(LogLevel level) { log_hushed = level; }

static const char *log_file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void log_write(LogId id, const char *file, int line, const char *format, ...) {
    LUZ_ASSERT((u32)id < LOG_ID_COUNT);
    LogLevel level = log_ids[id].level;
    atomic_fetch_add_explicit(&log_counts[id], 1, memory_order_relaxed);
    LogLevel current = log_current_level();
    bool hushed = level >= log_hushed;
    bool print = level >= current && (!hushed || current == LOG_SEVERITY_DEBUG);

    char text[LOG_TEXT_CAP];
    va_list args;
    va_start(args, format);
    if (vsnprintf(text, sizeof text, format, args) < 0) text[0] = 0;
    va_end(args);

    pthread_mutex_lock(&log_mutex);
    if (level == LOG_SEVERITY_ERROR || hushed) memcpy(log_error_text, text, strlen(text) + 1);
    // One call of fprintf, so that lines of other programs on this stderr do not mix in.
    if (print)
        fprintf(stderr, "%s %s %s:%d: %s\n", log_level_names[level], log_ids[id].name,
                log_file_name(file), line, text);
    if (log_sink && !log_in_sink) {
        log_in_sink = true;
        log_sink(id, level, text, log_sink_user);
        log_in_sink = false;
    }
    pthread_mutex_unlock(&log_mutex);
}

u32 log_count(LogId id) {
    LUZ_ASSERT((u32)id < LOG_ID_COUNT);
    return atomic_load_explicit(&log_counts[id], memory_order_relaxed);
}

void log_reset_counts(void) {
    for (u32 i = 0; i < LOG_ID_COUNT; i++) atomic_store(&log_counts[i], 0);
}

const char *log_id_name(LogId id) {
    LUZ_ASSERT((u32)id < LOG_ID_COUNT);
    return log_ids[id].name;
}

void log_last_error(char *out, u64 out_cap) {
    if (out_cap == 0) return;
    pthread_mutex_lock(&log_mutex);
    u64 length = MIN(strlen(log_error_text), out_cap - 1);
    memcpy(out, log_error_text, length);
    out[length] = 0;
    pthread_mutex_unlock(&log_mutex);
}

void log_set_sink(LogSink sink, void *user) {
    pthread_mutex_lock(&log_mutex);
    log_sink = sink;
    log_sink_user = user;
    pthread_mutex_unlock(&log_mutex);
}
