// log.h: every message has an id from one table, a level and file:line; tests assert ids.
//
// Data in: LOG(ID, format, ...). Data out: one line on stderr ("warning ASSET_IMAGE gltf.cpp:120:
// text"), counters per id, and the last error for a caller that wants to show it on the screen.
// Thread-safe. Does not: colour, rotate, or buffer across a crash.
#ifndef LUZ_LOG_H
#define LUZ_LOG_H
#include "base.h"
#ifdef __cplusplus
extern "C" {
#endif

// Not LOG_LEVEL_*: those would clash with ids (LEVEL_ERROR).
typedef enum LogLevel {
    LOG_SEVERITY_DEBUG,
    LOG_SEVERITY_INFO,
    LOG_SEVERITY_WARNING,
    LOG_SEVERITY_ERROR,
    LOG_SEVERITY_NONE
} LogLevel;

// id, level, what it is about
#define LOG_IDS(X)                                                                   \
    X(DEBUG_NOTE, DEBUG, "developer's note")                                     \
    X(NOTE, INFO, "progress and facts")                                          \
    X(ARENA_RESERVE, ERROR, "address space refused")                             \
    X(FILE_OPEN, ERROR, "file cannot be opened")                                 \
    X(FILE_READ, ERROR, "file cannot be read")                                   \
    X(FILE_WRITE, ERROR, "file cannot be written")                               \
    X(FILE_OUTSIDE_ROOT, ERROR, "path leaves the data root")                     \
    X(WORLD_LIMIT, ERROR, "a world limit is reached")                            \
    X(WORLD_LOAD, ERROR, "saved world is damaged")                               \
    X(LEVEL_ERROR, DEBUG, "level text has errors (whoever loads prints them)")   \
    X(LEVEL_WARNING, WARNING, "level text has doubtful places")                  \
    X(LEVEL_RELOADED, INFO, "level reloaded")                                    \
    X(ASSET_MODEL, ERROR, "model refused")                                       \
    X(ASSET_MODEL_WARNING, WARNING, "model loaded with a remark")                \
    X(ASSET_IMAGE, WARNING, "image refused, a checker takes its place")          \
    X(ASSET_LIMIT, ERROR, "an asset limit is reached")                           \
    X(GPU_NONE, ERROR, "no usable Vulkan device")                                \
    X(GPU_RESULT, ERROR, "a Vulkan call failed")                                 \
    X(GPU_VALIDATION, ERROR, "message of the validation layer")                  \
    X(GPU_DEVICE, INFO, "device in use")                                         \
    X(GPU_LIMIT, ERROR, "a device limit is reached")                             \
    X(GPU_LOST, WARNING, "device or surface lost, recreated")                    \
    X(SHADER_ERROR, ERROR, "shader does not compile, the old one stays")         \
    X(SHADER_RELOADED, INFO, "shader recompiled")                                \
    X(RENDER_LIMIT, WARNING, "a renderer limit is reached")                      \
    X(RENDER_SETTING, WARNING, "unknown setting")                                \
    X(CAPTURE_READ, ERROR, "capture refused")                                    \
    X(CAPTURE_WRITE, ERROR, "capture cannot be written")                         \
    X(CAPTURE_MISMATCH, ERROR, "replay differs from its recording")              \
    X(APP_NO_DISPLAY, INFO, "no display, running headless")                      \
    X(APP_WINDOW, ERROR, "window system error")                                  \
    X(USAGE, ERROR, "wrong command line")

typedef enum LogId {
#define X(id, level, about) LOG_##id,
    LOG_IDS(X)
#undef X
        LOG_ID_COUNT
} LogId;

#define LOG(id, ...) log_write(LOG_##id, __FILE__, __LINE__, __VA_ARGS__)
void log_write(LogId id, const char *file, int line, const char *format, ...) PRINTF_LIKE(4, 5);

// Messages below this level are counted and not printed. Default info, or what the environment
// says: LUZ_LOG=debug|info|warning|error|none.
void log_set_level(LogLevel level);
// For a caller that tells of the failure itself, with its place: until log_hush(LOG_SEVERITY_NONE),
// messages of this thread of `level` and above are counted, observed and kept (log_last_error), and
// not printed unless the level is debug.
void log_hush(LogLevel level);
// Messages seen with this id since start or the last log_reset_counts.
u32 log_count(LogId id);
void log_reset_counts(void);
const char *log_id_name(LogId id);
// Text of the newest message of level error, or that was hushed ("" if none), copied into out.
void log_last_error(char *out, u64 out_cap);
// An observer beside stderr (the debug panel, a test); NULL removes it. Called under the log's
// lock, from the thread that logs; what it logs itself is printed, not observed.
typedef void (*LogSink)(LogId id, LogLevel level, const char *text, void *user);
void log_set_sink(LogSink sink, void *user);

#ifdef __cplusplus
}
#endif
#endif
