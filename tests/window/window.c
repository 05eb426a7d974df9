// window.c: the demo played in a window on a virtual display: see window.sh.
#include "../test.h"
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static bool have_program(const char *name) {
    char command[128];
    snprintf(command, sizeof command, "command -v %s >/dev/null 2>&1", name);
    return system(command) == 0;
}

// The demo lies beside this program.
static void demo_path(char *out, u64 out_cap) {
    char self[512] = {0};
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    snprintf(out, out_cap, "%s/luz_demo", dirname(self));
}

static int run(const char *format, ...) PRINTF_LIKE(1, 2);
static int run(const char *format, ...) {
    char command[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(command, sizeof command, format, args);
    va_end(args);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_WINDOW(window, play) {
    static const char *const needed[] = {"xvfb-run", "xauth",   "xdotool",
                                         "import",   "convert", "awk"};
    for (u32 i = 0; i < COUNT_OF(needed); i++)
        if (!have_program(needed[i])) TEST_SKIP("%s is not installed", needed[i]);
    char demo[600];
    demo_path(demo, sizeof demo);
    if (access(demo, X_OK) != 0) TEST_SKIP("%s is not built", demo);
    assert_int_equal(run("xvfb-run -a -s '-screen 0 1024x768x24' bash tests/window/window.sh %s %s",
                         demo, test_temp_dir()),
                     0);
}

// Without a display the demo says so, and leaves pictures.
TEST_WINDOW(window, no_display) {
    char demo[600];
    demo_path(demo, sizeof demo);
    if (access(demo, X_OK) != 0) TEST_SKIP("%s is not built", demo);
    const char *out = test_temp_dir();
    assert_int_equal(run("env -u DISPLAY -u WAYLAND_DISPLAY %s --level tests/window/room.toml "
                         "--size 160x90 --validation --out %s > %s/log 2>&1",
                         demo, out, out),
                     0);
    assert_int_equal(run("grep -q APP_NO_DISPLAY %s/log", out), 0);
    assert_int_equal(run("test -s %s/tour/00_main.png && test -s %s/tour/01_side.png", out, out),
                     0);
    assert_int_equal(run("! grep -q GPU_VALIDATION %s/log", out), 0);
}

// Nothing can be written: the tour goes on without, and the exit status says so.
TEST_WINDOW(window, read_only_out) {
    char demo[600];
    demo_path(demo, sizeof demo);
    if (access(demo, X_OK) != 0) TEST_SKIP("%s is not built", demo);
    const char *work = test_temp_dir();
    assert_int_equal(run("%s --headless --level tests/window/room.toml --size 160x90 "
                         "--out /proc/nowhere > %s/log 2>&1",
                         demo, work),
                     3);
    assert_int_equal(run("grep -q FILE_WRITE %s/log", work), 0);
    assert_int_equal(run("grep -q 'main .* 12 ' %s/log", work), 0);
    assert_int_equal(run("%s --headless --level tests/window/room.toml --size 64x64 --out %s "
                         "--record /proc/nowhere/r.luzr > %s/log 2>&1",
                         demo, work, work),
                     3);
}

TEST(window, no_device) {
    char demo[600];
    demo_path(demo, sizeof demo);
    if (access(demo, X_OK) != 0) TEST_SKIP("%s is not built", demo);
    const char *work = test_temp_dir();
    assert_int_equal(run("env VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent %s "
                         "--headless --level tests/window/room.toml --out %s > %s/log 2>&1",
                         demo, work, work),
                     3);
    assert_int_equal(run("grep -q 'GPU_NONE.*install' %s/log", work), 0);
}

// A mistake on the command line: a suggestion and exit status 2.
TEST(window, mistaken_option) {
    char demo[600];
    demo_path(demo, sizeof demo);
    if (access(demo, X_OK) != 0) TEST_SKIP("%s is not built", demo);
    const char *work = test_temp_dir();
    assert_int_equal(run("%s --headles > %s/log 2>&1", demo, work), 2);
    assert_int_equal(run("grep -q -- '--headless' %s/log", work), 0);
}
