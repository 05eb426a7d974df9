// replay.h: what the two halves of `luz replay` share: recordings (replay.c), frames
// (replay_frame.c).
#ifndef LUZ_TOOL_REPLAY_H
#define LUZ_TOOL_REPLAY_H
#include "../engine/capture/capture.h"
#include "headless.h"
#include "split.h"

typedef struct ReplayOptions {
    const char *file, *out, *path, *view, *preset, *level, *diff;
    bool images, no_images; // forced on, off
    u32 shard[2];           // i of n, 1-based
    ToolList sets;
    SplitOptions split;
} ReplayOptions;

int replay_frame(const ReplayOptions *options, const ToolCommon *common, Arena *arena);
#endif
