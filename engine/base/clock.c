// clock.c: POSIX clocks in milliseconds.
// Data in: none. Data out: f64 milliseconds since an arbitrary start (2^53 ns = 104 days keep
// nanosecond resolution). Called by: frame timing, benchmarks, the jobs' owners. Does not: feed
// the simulation, which counts ticks.
#include "clock.h"
#include <time.h>

static f64 clock_read_ms(clockid_t id) {
    struct timespec now;
    LUZ_ASSERT(clock_gettime(id, &now) == 0); // all three ids exist on every Linux
    return (f64)now.tv_sec * 1e3 + (f64)now.tv_nsec * 1e-6;
}

f64 clock_now_ms(void) { return clock_read_ms(CLOCK_MONOTONIC); }
f64 clock_process_cpu_ms(void) { return clock_read_ms(CLOCK_PROCESS_CPUTIME_ID); }
f64 clock_thread_cpu_ms(void) { return clock_read_ms(CLOCK_THREAD_CPUTIME_ID); }
