// progress.c: how far a long command is.
// Data in: done of total. Data out: a bar that redraws itself on a terminal, else a line for every
// tenth (for logs of batch jobs). On stderr, so that stdout stays the result.
// Called by: shot, replay, record, bench. Does not: run in a thread, estimate before 5 %.
#include "../engine/base/clock.h"
#include "tool.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BAR_WIDTH      30
#define REDRAW_MIN_MS  50.0
#define ESTIMATE_SHARE 0.05

Progress progress_begin(const char *what, u32 total, bool quiet) {
    Progress progress = {.what = what, .total = MAX(total, 1), .quiet = quiet};
    progress.terminal = isatty(STDERR_FILENO);
    progress.start_ms = clock_now_ms();
    progress.drawn_ms = progress.start_ms - REDRAW_MIN_MS;
    return progress;
}

static void draw_bar(const Progress *progress, const char *note) {
    f64 share = (f64)progress->done / progress->total;
    char bar[BAR_WIDTH + 1];
    u32 filled = (u32)(share * BAR_WIDTH);
    for (u32 i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    char left[32] = "";
    f64 elapsed_s = (clock_now_ms() - progress->start_ms) / 1000.0;
    if (share >= ESTIMATE_SHARE && share < 1.0)
        snprintf(left, sizeof left, " %.0f s left", elapsed_s / share * (1.0 - share));
    // \033[K clears what a longer line left behind.
    fprintf(stderr, "\r%s [%s] %u/%u%s %.40s\033[K", progress->what, bar, progress->done,
            progress->total, left, note ? note : "");
    fflush(stderr);
}

void progress_set(Progress *progress, u32 done, const char *note) {
    progress->done = MIN(done, progress->total);
    if (progress->quiet) return;
    if (progress->terminal) {
        f64 now = clock_now_ms();
        bool last = progress->done == progress->total;
        if (!last && now - progress->drawn_ms < REDRAW_MIN_MS) return;
        progress->drawn_ms = now;
        draw_bar(progress, note);
        return;
    }
    u32 tenth = (u32)((u64)progress->done * 10 / progress->total);
    if (tenth <= progress->shown) return;
    progress->shown = tenth;
    fprintf(stderr, "%s: %u %% (%u/%u)\n", progress->what, tenth * 10, progress->done,
            progress->total);
}

void progress_end(Progress *progress) {
    if (progress->quiet || !progress->terminal) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
}
