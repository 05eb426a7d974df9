// base_jobs.c: the thread pool: every index once, the same result with any number of threads.
#include "../test.h"
#include "../../engine/base/hash.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#define ITEMS 10007 // a prime: no grain divides it

typedef struct Marks {
    u8 hits[ITEMS]; // disjoint slots, no atomics: that is the contract
    u64 values[ITEMS];
    u32 grain, count, threads;
    atomic_uint ranges, wrong, thread_mask;
} Marks;

static void mark(void *context, u32 begin, u32 end, u32 thread_index) {
    Marks *marks = context;
    // Ranges start at multiples of the grain and are whole but for the last.
    if (begin % marks->grain || end <= begin || end > marks->count ||
        (end - begin != marks->grain && end != marks->count) || thread_index >= marks->threads)
        atomic_fetch_add(&marks->wrong, 1);
    atomic_fetch_add(&marks->ranges, 1);
    atomic_fetch_or(&marks->thread_mask, 1u << (thread_index & 31));
    for (u32 i = begin; i < end; i++) {
        marks->hits[i]++;
        marks->values[i] = random_u64(7, 0, i);
    }
}

static u64 run_loop(Marks *marks, u32 count, u32 grain) {
    memset(marks, 0, sizeof *marks);
    marks->count = count;
    marks->grain = grain;
    marks->threads = jobs_thread_count();
    jobs_for(count, grain, mark, marks);
    assert_int_equal(marks->wrong, 0);
    assert_int_equal(marks->ranges, (count + grain - 1) / grain);
    for (u32 i = 0; i < ITEMS; i++) assert_int_equal(marks->hits[i], i < count ? 1 : 0);
    return hash_bytes(marks->values, sizeof marks->values, 0);
}

TEST(jobs, every_index_once_with_any_thread_count) {
    static const u32 threads[] = {1, 2, 3, 8, JOBS_THREADS_MAX};
    static const u32 grains[] = {1, 7, 64, ITEMS - 1, ITEMS, ITEMS * 2};
    static const u32 counts[] = {0, 1, 63, 64, ITEMS};
    static Marks marks;
    u64 expected[COUNT_OF(counts)];
    for (u32 c = 0; c < COUNT_OF(counts); c++) expected[c] = run_loop(&marks, counts[c], 64);
    for (u32 t = 0; t < COUNT_OF(threads); t++) {
        jobs_start(threads[t]);
        assert_int_equal(jobs_thread_count(), threads[t]);
        for (u32 g = 0; g < COUNT_OF(grains); g++)
            for (u32 c = 0; c < COUNT_OF(counts); c++)
                assert_true(run_loop(&marks, counts[c], grains[g]) == expected[c]);
        jobs_stop();
        assert_int_equal(jobs_thread_count(), 1);
    }
}

TEST(jobs, serial_mode_runs_in_order_in_the_caller) {
    static Marks marks;
    jobs_start(1);
    run_loop(&marks, ITEMS, 10);
    assert_int_equal(marks.thread_mask, 1);
    jobs_stop();
}

TEST(jobs, many_short_loops) {
    static Marks marks;
    jobs_start(4);
    for (u32 i = 0; i < 500; i++) run_loop(&marks, 8 + i % 50, 1);
    jobs_stop();
    jobs_stop(); // harmless
}

TEST(jobs, thread_count_defaults_and_is_capped) {
    jobs_start(0);
    assert_true(jobs_thread_count() >= 1);
    jobs_start(1000); // restarts
    assert_int_equal(jobs_thread_count(), JOBS_THREADS_MAX);
    jobs_stop();
}

static void mark_slowly(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    usleep(begin % 3 * 1000); // somebody is always late
    for (u32 i = begin; i < end; i++) ((u8 *)context)[i]++;
}

TEST(jobs, returns_after_the_slowest_range) {
    jobs_start(4);
    for (u32 round = 0; round < 20; round++) {
        u8 hits[9] = {0};
        jobs_for(9, 1, mark_slowly, hits);
        for (u32 i = 0; i < 9; i++) assert_int_equal(hits[i], 1);
    }
    jobs_stop();
}

static void count_range(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    atomic_fetch_add((atomic_uint *)context, end - begin);
}

static void *loop_from_a_thread(void *context) {
    for (u32 i = 0; i < 100; i++) jobs_for(100, 3, count_range, context);
    return NULL;
}

// Two callers take turns; none loses a range.
TEST(jobs, loops_from_two_threads) {
    atomic_uint total = 0;
    pthread_t thread;
    jobs_start(3);
    assert_int_equal(pthread_create(&thread, NULL, loop_from_a_thread, &total), 0);
    loop_from_a_thread(&total);
    pthread_join(thread, NULL);
    jobs_stop();
    assert_int_equal(total, 20000);
}

static void nest(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)begin, (void)end, (void)thread_index;
    jobs_for(1, 1, count_range, context);
}

TEST(jobs, nesting_is_refused) {
    atomic_uint total = 0;
    ASSERT_DIES(jobs_for(1, 1, nest, &total));
}
