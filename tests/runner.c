// runner.c: finds every registered test, runs it alone, and says how it went.
// Data in: command line, the list that the TEST macros fill before main. Data out: a line a test,
// then "N passed, N failed[, N skipped]"; exit status 0 only if something ran and nothing failed.
// Called by: build.sh test, people, debuggers. Does not: choose seeds, or retry.
//
//   luz_tests [--list] [--unit] [--jobs N] [--no-fork] [--verbose] [filter...]
//
// Several workers (--jobs) take tests from one list: compiling shaders, which is most of what a
// drawing test does on a fresh machine, fills one core only. Tests with a window wait for real time
// and run alone, at the end.
// Each test runs in a forked child under cmocka, its output caught in an anonymous file and shown
// only if it fails. The child tells its outcome by a page of shared memory; a child that dies
// before that (signal, exit, time-out) has failed. With --no-fork a test runs in this process with
// its output untouched: for debuggers, and it ends at the first crash.
#include "test.h"
#include "../engine/base/log.h"
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define TIMEOUT_S    300
#define TEMP_ROOT    "build/tmp"
#define OUTPUT_SHOWN KIB(64) // of a failing test; the end of it
#define JOBS_CAP     16

typedef enum Outcome { OUTCOME_NONE, OUTCOME_PASSED, OUTCOME_FAILED, OUTCOME_SKIPPED } Outcome;

// What a child leaves for its parent.
typedef struct Shared {
    Outcome outcome;
    u32 validation_count; // messages of the validation layer
    bool skipped;
    char reason[256]; // of skipping
} Shared;

// What the workers share.
typedef struct Board {
    u32 next; // test to take
    u32 totals[4];
} Board;

static int print_lock = -1; // a file whose lock is held while a test's lines are printed
static TestCase *first_test;
static u32 test_count;
static Shared *shared;
static char temp_dir[256]; // of the running test; made at first use
static pid_t death_child;

void test_register(TestCase *test) {
    test->next = first_test;
    first_test = test;
    test_count++;
}

// ---- helpers for tests ----

void test_skip(const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(shared->reason, sizeof shared->reason, format, args);
    va_end(args);
    shared->skipped = true;
    skip();
    abort(); // skip() jumps away
}

const char *test_temp_dir(void) {
    LUZ_ASSERT(temp_dir[0]);
    if ((mkdir("build", 0777) != 0 && errno != EEXIST) ||
        (mkdir(TEMP_ROOT, 0777) != 0 && errno != EEXIST) ||
        (mkdir(temp_dir, 0777) != 0 && errno != EEXIST))
        fail_msg("cannot make %s: %s", temp_dir, strerror(errno));
    return temp_dir;
}

const char *test_temp_path(const char *name) {
    static char paths[4][1024];
    static u32 next;
    char *path = paths[next++ % COUNT_OF(paths)];
    snprintf(path, sizeof paths[0], "%s/%s", test_temp_dir(), name);
    return path;
}

void test_assert_near(f64 a, f64 b, f64 eps, const char *a_text, const char *b_text,
                      const char *file, int line) {
    if (fabs(a - b) <= eps) return;
    print_error("%s = %.9g, %s = %.9g: %.3g apart, %.3g allowed\n", a_text, a, b_text, b,
                fabs(a - b), eps);
    _fail(file, line);
}

bool test_fork_for_death(void) {
    fflush(NULL);
    death_child = fork();
    LUZ_ASSERT(death_child >= 0);
    if (death_child != 0) return false;
    int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (null >= 0) dup2(null, STDERR_FILENO);
    return true;
}

void test_survived(void) { _exit(0); }

void test_assert_died(const char *text, const char *file, int line) {
    int status = 0;
    while (waitpid(death_child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) return;
    print_error("%s did not stop the program by an assertion\n", text);
    _fail(file, line);
}

// ---- running one test ----

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *ftw) {
    (void)info, (void)ftw;
    // A test may have taken the directory's permissions away.
    if (type == FTW_DP || type == FTW_D) chmod(path, 0700);
    return remove(path);
}

static void remove_temp_dir(void) {
    struct stat info;
    if (stat(temp_dir, &info) == 0) nftw(temp_dir, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

// In the child (or in this process with --no-fork).
static Outcome run_under_cmocka(const TestCase *test) {
    char name[256];
    snprintf(name, sizeof name, "%s.%s", test->suite, test->name);
    const struct CMUnitTest group[] = {{name, test->function, NULL, NULL, NULL}};
    u32 messages = log_count(LOG_GPU_VALIDATION);
    int failures = cmocka_run_group_tests_name(name, group, NULL, NULL);
    // A test that resets the counters can only lower the first number.
    u32 now = log_count(LOG_GPU_VALIDATION);
    shared->validation_count = now > messages ? now - messages : 0;
    if (failures != 0 || shared->validation_count > 0) return OUTCOME_FAILED;
    return shared->skipped ? OUTCOME_SKIPPED : OUTCOME_PASSED;
}

// Never returns. exit, not _exit: leak checkers and coverage counters work at exit, and a leak
// found there turns the status around.
__attribute__((noreturn)) static void child_main(const TestCase *test, int output) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0); // so that programs started by the test end with it
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    setvbuf(stdout, NULL, _IOLBF, 0); // what was said before a crash is kept
    alarm(TIMEOUT_S);                 // its default action ends the child, whatever it hangs in
    shared->outcome = run_under_cmocka(test);
    exit(shared->outcome == OUTCOME_FAILED ? 1 : 0);
}

static void lock_printing(bool lock) {
    struct flock range = {.l_type = lock ? F_WRLCK : F_UNLCK, .l_whence = SEEK_SET};
    while (print_lock >= 0 && fcntl(print_lock, F_SETLKW, &range) != 0 && errno == EINTR) {
    }
}

static void show_output(int output) {
    off_t size = lseek(output, 0, SEEK_END);
    off_t at = size > (off_t)OUTPUT_SHOWN ? size - (off_t)OUTPUT_SHOWN : 0;
    char buffer[4096];
    ssize_t got;
    fflush(stdout);
    while ((got = pread(output, buffer, sizeof buffer, at)) > 0) {
        fwrite(buffer, 1, (size_t)got, stdout);
        at += got;
    }
}

static Outcome run_forked(const TestCase *test, bool verbose, char *note, size_t note_cap) {
    int output = memfd_create("luz test output", MFD_CLOEXEC);
    LUZ_ASSERT(output >= 0);
    fflush(NULL); // or the child would print our buffer again
    pid_t child = fork();
    LUZ_ASSERT(child >= 0);
    if (child == 0) child_main(test, output);
    setpgid(child, child); // whichever of the two comes first
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    kill(-child, SIGKILL); // what it left running; usually nobody

    Outcome outcome = shared->outcome;
    if (WIFSIGNALED(status)) {
        outcome = OUTCOME_FAILED;
        if (WTERMSIG(status) == SIGALRM)
            snprintf(note, note_cap, "no end after %d s", TIMEOUT_S);
        else
            snprintf(note, note_cap, "ended by signal %d (%s)", WTERMSIG(status),
                     strsignal(WTERMSIG(status)));
    } else if (outcome == OUTCOME_NONE) {
        outcome = OUTCOME_FAILED;
        snprintf(note, note_cap, "left by exit(%d)", WEXITSTATUS(status));
    } else if (outcome != OUTCOME_FAILED && WEXITSTATUS(status) != 0) {
        outcome = OUTCOME_FAILED; // a sanitizer's verdict at exit
        snprintf(note, note_cap, "exit status %d at the end", WEXITSTATUS(status));
    }
    lock_printing(true); // until the test's own line is printed
    if (outcome == OUTCOME_FAILED || verbose) show_output(output);
    close(output);
    return outcome;
}

static f64 now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (f64)now.tv_sec + (f64)now.tv_nsec * 1e-9;
}

static Outcome run_one(const TestCase *test, bool do_fork, bool verbose) {
    memset(shared, 0, sizeof *shared);
    snprintf(temp_dir, sizeof temp_dir, TEMP_ROOT "/%s.%s.%d", test->suite, test->name,
             (int)getpid());
    char note[320] = "";
    f64 start = now_s();
    Outcome outcome =
        do_fork ? run_forked(test, verbose, note, sizeof note) : run_under_cmocka(test);
    f64 seconds = now_s() - start;
    remove_temp_dir();

    if (outcome == OUTCOME_SKIPPED) snprintf(note, sizeof note, "%s", shared->reason);
    if (shared->validation_count > 0)
        snprintf(note, sizeof note, "%u validation messages", shared->validation_count);
    static const char *const words[] = {"?", "pass", "FAIL", "skip"};
    printf("%s %7.3f s  %s.%s%s%s\n", words[outcome], seconds, test->suite, test->name,
           note[0] ? ": " : "", note);
    fflush(stdout);
    lock_printing(false);
    return outcome;
}

// ---- all tests ----

static int compare_tests(const void *a, const void *b) {
    const TestCase *x = *(const TestCase *const *)a, *y = *(const TestCase *const *)b;
    int order = strcmp(x->suite, y->suite);
    return order ? order : strcmp(x->name, y->name);
}

static bool test_is_chosen(const TestCase *test, bool unit_only, char **filters, int filter_count) {
    if (unit_only && (test->kind & ~(u32)TEST_KIND_BAIT)) return false;
    char name[256];
    snprintf(name, sizeof name, "%s.%s", test->suite, test->name);
    bool is_bait = test->kind & TEST_KIND_BAIT;
    for (int i = 0; i < filter_count; i++)
        if (is_bait ? strcmp(name, filters[i]) == 0 : strstr(name, filters[i]) != NULL) return true;
    return filter_count == 0 && !is_bait;
}

static void print_test(const TestCase *test) {
    printf("%s.%s%s%s%s\n", test->suite, test->name, test->kind & TEST_KIND_GPU ? " [gpu]" : "",
           test->kind & TEST_KIND_WINDOW ? " [window]" : "",
           test->kind & TEST_KIND_SLOW ? " [slow]" : "");
}

static void *shared_page(u64 size) {
    void *page = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    LUZ_ASSERT(page != MAP_FAILED);
    return page;
}

// Tests without a window, by `jobs` processes; their totals.
static void run_by_workers(TestCase **tests, u32 count, u32 jobs, bool verbose, u32 *totals) {
    Board *board = shared_page(sizeof *board);
    print_lock = memfd_create("luz test lock", MFD_CLOEXEC);
    LUZ_ASSERT(print_lock >= 0);
    fflush(NULL);
    pid_t workers[JOBS_CAP];
    for (u32 job = 0; job < jobs; job++) {
        workers[job] = fork();
        LUZ_ASSERT(workers[job] >= 0);
        if (workers[job] != 0) continue;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        shared = shared_page(sizeof *shared);
        for (u32 i; (i = __atomic_fetch_add(&board->next, 1, __ATOMIC_RELAXED)) < count;) {
            Outcome outcome = run_one(tests[i], true, verbose);
            __atomic_fetch_add(&board->totals[outcome], 1, __ATOMIC_RELAXED);
        }
        fflush(NULL);
        _exit(0);
    }
    for (u32 job = 0; job < jobs; job++) {
        int status = 0;
        while (waitpid(workers[job], &status, 0) < 0 && errno == EINTR) {
        }
        // A worker that died took a test with it.
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) totals[OUTCOME_FAILED]++;
    }
    for (u32 i = 0; i < 4; i++) totals[i] += board->totals[i];
    close(print_lock);
    print_lock = -1;
}

int main(int argc, char **argv) {
    u32 jobs = (u32)CLAMP(sysconf(_SC_NPROCESSORS_ONLN), 1, JOBS_CAP);
    bool list = false, unit_only = false, do_fork = true, verbose = false;
    int filter_count = 0;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--list") == 0)
            list = true;
        else if (strcmp(argv[i], "--unit") == 0)
            unit_only = true;
        else if (strcmp(argv[i], "--no-fork") == 0)
            do_fork = false;
        else if (strcmp(argv[i], "--jobs") == 0 && i + 1 < argc && atoi(argv[i + 1]) > 0)
            i++, jobs = (u32)CLAMP(atoi(argv[i]), 1, JOBS_CAP);
        else if (strcmp(argv[i], "--verbose") == 0)
            verbose = true;
        else if (argv[i][0] == '-') {
            fprintf(stderr,
                    "usage: %s [--list] [--unit] [--jobs N] [--no-fork] [--verbose] [filter...]\n"
                    "  filter     run tests whose suite.name contains one of these\n"
                    "  --unit     only tests without GPU, window, or long runs\n"
                    "  --jobs     tests at a time, default one a core\n"
                    "  --no-fork  in this process, for a debugger\n"
                    "  --verbose  show the output of passing tests too\n",
                    argv[0]);
            return 2;
        } else
            argv[1 + filter_count++] = argv[i]; // never overtakes i
    }

    TestCase **tests = calloc(MAX(test_count, 1), sizeof *tests);
    shared = shared_page(sizeof *shared);
    LUZ_ASSERT(tests);
    u32 count = 0;
    for (TestCase *test = first_test; test; test = test->next)
        if (test_is_chosen(test, unit_only, argv + 1, filter_count)) tests[count++] = test;
    qsort(tests, count, sizeof *tests, compare_tests);

    u32 totals[4] = {0}, done = 0;
    if (do_fork && !list) {
        // Those with a window to the end, in their order.
        TestCase **sorted = calloc(MAX(count, 1), sizeof *sorted);
        LUZ_ASSERT(sorted);
        u32 place = 0;
        for (u32 window = 0; window < 2; window++) {
            for (u32 i = 0; i < count; i++)
                if (((tests[i]->kind & TEST_KIND_WINDOW) != 0) == window)
                    sorted[place++] = tests[i];
            if (!window) done = place;
        }
        memcpy(tests, sorted, count * sizeof *tests);
        free(sorted);
        run_by_workers(tests, done, MIN(jobs, MAX(done, 1)), verbose, totals);
    }
    for (u32 i = done; i < count; i++) {
        if (list)
            print_test(tests[i]);
        else
            totals[run_one(tests[i], do_fork, verbose)]++;
    }
    free(tests);
    if (list) return 0;
    u32 passed = totals[OUTCOME_PASSED], failed = totals[OUTCOME_FAILED];
    if (passed + failed == 0) printf("no test ran\n");
    printf("%u passed, %u failed", passed, failed);
    if (totals[OUTCOME_SKIPPED] > 0) printf(", %u skipped", totals[OUTCOME_SKIPPED]);
    printf("\n");
    return passed > 0 && failed == 0 ? 0 : 1;
}
