// runner_self.c: the runner itself: whatever goes wrong in a test is counted, and running nothing
// is no success. The baits below fail on purpose; they run only when named in full.
#include "../test.h"
#include "../../engine/base/log.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define BAIT(name) TEST_OF_KIND(bait, name, TEST_KIND_BAIT)
BAIT(fails) { assert_true(getpid() == 0); }
BAIT(is_not_near) { ASSERT_NEAR(1.0, NAN, 1e9); }
BAIT(aborts) {
    printf("said before the end\n");
    abort();
}
BAIT(breaks_an_assertion) { LUZ_ASSERT(getpid() == 0); }
BAIT(is_killed) { raise(SIGKILL); }
BAIT(exits) { exit(0); }
BAIT(times_out) {
    alarm(1); // the runner's own alarm, only sooner
    for (;;) pause();
}
BAIT(has_a_validation_message) { LOG(GPU_VALIDATION, "a bait's message"); }
BAIT(survives_what_should_kill) { ASSERT_DIES((void)0); }
BAIT(skips) { TEST_SKIP("no %s here", "moon"); }
BAIT(passes) { assert_non_null(fopen(test_temp_path("left_behind"), "w")); }

// Runs this program again; its exit status, and all that it printed.
static int run_again(const char *arguments, char *output, u64 output_cap) {
    char command[512];
    // The sanitizers' leak check at exit would call the baits' leaks by name; that is not the
    // point.
    snprintf(command, sizeof command, "ASAN_OPTIONS=detect_leaks=0 /proc/%d/exe %s </dev/null 2>&1",
             (int)getpid(), arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    output[fread(output, 1, output_cap - 1, pipe)] = 0;
    int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void assert_last_line(const char *output, const char *line) {
    u64 length = strlen(output), line_length = strlen(line);
    assert_true(length > line_length + 1 && output[length - 1] == '\n');
    assert_memory_equal(output + length - 1 - line_length, line, line_length);
    assert_int_equal(output[length - 2 - line_length], '\n');
}

TEST(runner, running_nothing_is_a_failure) {
    static char output[4096];
    assert_int_equal(run_again("no.test.has.this.name", output, sizeof output), 1);
    assert_string_equal(output, "no test ran\n0 passed, 0 failed\n");
    assert_int_equal(run_again("bait.skips", output, sizeof output), 1);
    assert_last_line(output, "0 passed, 0 failed, 1 skipped");
    assert_non_null(strstr(output, "bait.skips: no moon here\n"));
    assert_int_equal(run_again("--no-such-option", output, sizeof output), 2);
}

TEST(runner, counts_every_way_to_fail_and_goes_on) {
    static char output[65536];
    static const char *const baits[] = {"fails",
                                        "is_not_near",
                                        "aborts",
                                        "breaks_an_assertion",
                                        "is_killed",
                                        "exits",
                                        "times_out",
                                        "has_a_validation_message",
                                        "survives_what_should_kill"};
    char arguments[512] = "bait.passes bait.skips";
    for (u32 i = 0; i < COUNT_OF(baits); i++) {
        u64 used = strlen(arguments);
        snprintf(arguments + used, sizeof arguments - used, " bait.%s", baits[i]);
    }
    assert_int_equal(run_again(arguments, output, sizeof output), 1);
    assert_last_line(output, "1 passed, 9 failed, 1 skipped");
    assert_non_null(strstr(output, "said before the end\n"));
    assert_non_null(strstr(output, "bait.is_killed: ended by signal 9"));
    assert_non_null(strstr(output, "bait.exits: left by exit(0)"));
    assert_non_null(strstr(output, "bait.times_out: no end after"));
    assert_non_null(strstr(output, "bait.has_a_validation_message: 1 validation messages"));
}

TEST(runner, passing_is_quiet_and_cleans_up) {
    static char output[4096];
    assert_int_equal(run_again("--unit bait.passes", output, sizeof output), 0);
    assert_memory_equal(output, "pass ", 5);
    assert_last_line(output, "1 passed, 0 failed");
    assert_int_equal(system("ls build/tmp | grep -q '^bait.passes'") != 0, 1);
}

TEST(runner, lists_tests_in_the_order_of_their_names) {
    static char output[KIB(256)];
    assert_int_equal(run_again("--list", output, sizeof output), 0);
    assert_non_null(strstr(output, "runner.lists_tests_in_the_order_of_their_names\n"));
    assert_null(strstr(output, "bait."));
    char previous_suite[128] = "", *state = NULL;
    for (char *line = strtok_r(output, "\n", &state); line; line = strtok_r(NULL, "\n", &state)) {
        char suite[128];
        snprintf(suite, sizeof suite, "%.*s", (int)MIN(strcspn(line, "."), 127), line);
        assert_true(strcmp(previous_suite, suite) <= 0);
        memcpy(previous_suite, suite, sizeof suite);
    }
}
