// jobs.c: a pool of threads that share one loop at a time.
// Data in: a count, a grain and a function. Data out: the function was called once for every
// range. Called by: systems and loaders. Does not: queue, nest, or promise which thread runs what.
//
// Ranges are handed out by one atomic counter (dynamic: a thread that finishes early takes the
// next range). The loop itself is published under a mutex; a worker that wakes up after the
// caller has closed the loop goes back to sleep, so nobody waits for a late worker:
//
//   caller: publish (open = true) -> run ranges -> close -> wait until active == 0
//   worker: wait for a new serial; if open: active++ -> run ranges -> active--
//
// Everything that the ranges wrote happens before jobs_for returns: by the caller itself, or by
// workers that took the mutex to leave.
#include "jobs.h"
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>

typedef struct Loop {
    JobFunction function;
    void *context;
    u32 count, grain;
    u64 range_count;
} Loop;

static struct {
    pthread_mutex_t caller_mutex; // one jobs_for at a time, also from different threads
    pthread_mutex_t mutex;        // guards all below up to next_range
    pthread_cond_t wake, done;
    pthread_t threads[JOBS_THREADS_MAX];
    u32 thread_count; // with the caller; 0 = not started
    u32 active;       // workers inside the loop
    u64 serial;       // number of the loop, so that a worker enters each once
    bool open, stop;
    Loop loop;                // const while open or active > 0
    atomic_ullong next_range; // 64-bit: threads overshoot it without wrapping
} pool = {.caller_mutex = PTHREAD_MUTEX_INITIALIZER,
          .mutex = PTHREAD_MUTEX_INITIALIZER,
          .wake = PTHREAD_COND_INITIALIZER,
          .done = PTHREAD_COND_INITIALIZER};

static _Thread_local bool inside_job; // to refuse nesting, which would deadlock

static void loop_run_range(const Loop *loop, u64 range, u32 thread_index) {
    u64 begin = range * loop->grain, end = MIN(begin + loop->grain, (u64)loop->count);
    loop->function(loop->context, (u32)begin, (u32)end, thread_index);
}

static void loop_run_shared(const Loop *loop, u32 thread_index) {
    inside_job = true;
    for (;;) {
        // Relaxed: the counter orders nothing, the mutex does.
        u64 range = atomic_fetch_add_explicit(&pool.next_range, 1, memory_order_relaxed);
        if (range >= loop->range_count) break;
        loop_run_range(loop, range, thread_index);
    }
    inside_job = false;
}

static void *worker_main(void *argument) {
    u32 thread_index = (u32)(uintptr_t)argument;
    u64 seen = 0;
    pthread_mutex_lock(&pool.mutex);
    for (;;) {
        while (!pool.stop && pool.serial == seen) pthread_cond_wait(&pool.wake, &pool.mutex);
        if (pool.stop) break;
        seen = pool.serial;
        if (!pool.open) continue;
        pool.active++;
        pthread_mutex_unlock(&pool.mutex);
        loop_run_shared(&pool.loop, thread_index);
        pthread_mutex_lock(&pool.mutex);
        if (--pool.active == 0) pthread_cond_signal(&pool.done);
    }
    pthread_mutex_unlock(&pool.mutex);
    return NULL;
}

// Cores that this process may use (a container or taskset may give fewer than the machine has).
static u32 core_count(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    return (u32)MAX(CPU_COUNT(&set), 1);
}

void jobs_start(u32 thread_count) {
    LUZ_ASSERT(!inside_job);
    jobs_stop();
    if (thread_count == 0) thread_count = core_count();
    thread_count = MIN(thread_count, JOBS_THREADS_MAX);
    pthread_mutex_lock(&pool.caller_mutex);
    pool.stop = false;
    // Workers start with seen = 0: with a serial of 0 they wait for the first loop.
    pool.serial = 0;
    u32 started = 1; // the caller is thread 0
    for (; started < thread_count; started++) {
        if (pthread_create(&pool.threads[started], NULL, worker_main, (void *)(uintptr_t)started))
            break; // fewer threads give the same results, only later
        char name[16];
        snprintf(name, sizeof name, "luz job %u", started);
        pthread_setname_np(pool.threads[started], name);
    }
    pool.thread_count = started;
    pthread_mutex_unlock(&pool.caller_mutex);
}

void jobs_stop(void) {
    LUZ_ASSERT(!inside_job);
    pthread_mutex_lock(&pool.caller_mutex);
    pthread_mutex_lock(&pool.mutex);
    pool.stop = true;
    pthread_cond_broadcast(&pool.wake);
    pthread_mutex_unlock(&pool.mutex);
    for (u32 i = 1; i < pool.thread_count; i++) pthread_join(pool.threads[i], NULL);
    pool.thread_count = 0;
    pthread_mutex_unlock(&pool.caller_mutex);
}

u32 jobs_thread_count(void) {
    pthread_mutex_lock(&pool.caller_mutex);
    u32 thread_count = MAX(pool.thread_count, 1);
    pthread_mutex_unlock(&pool.caller_mutex);
    return thread_count;
}

void jobs_for(u32 count, u32 grain, JobFunction function, void *context) {
    LUZ_ASSERT(!inside_job);
    if (count == 0) return;
    Loop loop = {.function = function, .context = context, .count = count, .grain = MAX(grain, 1)};
    loop.range_count = ((u64)count + loop.grain - 1) / loop.grain;

    pthread_mutex_lock(&pool.caller_mutex);
    if (pool.thread_count <= 1 || loop.range_count == 1) {
        inside_job = true;
        for (u64 range = 0; range < loop.range_count; range++) loop_run_range(&loop, range, 0);
        inside_job = false;
    } else {
        pthread_mutex_lock(&pool.mutex);
        pool.loop = loop;
        atomic_store_explicit(&pool.next_range, 0, memory_order_relaxed);
        pool.serial++;
        pool.open = true;
        pthread_cond_broadcast(&pool.wake);
        pthread_mutex_unlock(&pool.mutex);

        loop_run_shared(&loop, 0);

        pthread_mutex_lock(&pool.mutex);
        pool.open = false;
        while (pool.active > 0) pthread_cond_wait(&pool.done, &pool.mutex);
        pthread_mutex_unlock(&pool.mutex);
    }
    pthread_mutex_unlock(&pool.caller_mutex);
}
