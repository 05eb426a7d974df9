// jobs.h: a pool of threads for loops over whole arrays.
//
// jobs_for splits [0, count) into ranges of `grain` items; every range is run once, by any
// thread; the call returns when all are done. Results must not depend on who ran what: ranges
// write disjoint slots and the caller joins them in index order (determinism). With one thread
// (serial mode) the same ranges run in order in the caller.
#ifndef LUZ_JOBS_H
#define LUZ_JOBS_H
#include "base.h"

typedef void (*JobFunction)(void *context, u32 begin, u32 end, u32 thread_index);

// thread_count 0 = number of cores, 1 = serial. Capped at JOBS_THREADS_MAX.
#define JOBS_THREADS_MAX 64
void jobs_start(u32 thread_count);
void jobs_stop(void);
u32 jobs_thread_count(void);
// Not reentrant: a job does not start jobs. Works (serially) before jobs_start.
void jobs_for(u32 count, u32 grain, JobFunction function, void *context);
#endif
