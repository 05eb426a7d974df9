// tool_cli.c: `luz` as a shell sees it: exit status and output of commands that need no GPU.
#include "../test.h"
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct Run {
    int status;
    char output[8192]; // stdout and stderr
} Run;

// The toolbox lies beside this program. `redirect` takes the place of the usual 2>&1.
static Run luz(const char *redirect, const char *arguments) {
    char self[512] = {0}, command[2048];
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    const char *directory = dirname(self);
    snprintf(command, sizeof command, "%s/luz", directory);
    if (access(command, X_OK) != 0) TEST_SKIP("%s is not built", command);
    snprintf(command, sizeof command, "%s/luz %s %s", directory, arguments, redirect);
    Run run = {0};
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    run.output[fread(run.output, 1, sizeof run.output - 1, pipe)] = 0;
    int status = pclose(pipe);
    run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return run;
}

static u32 line_count(const char *text) {
    u32 count = 0;
    for (; *text; text++) count += *text == '\n';
    return count;
}

// Whatever should be a file and is none: one sentence, status 1, whoever asks.
TEST(tool_cli, what_is_no_file_is_one_sentence) {
    static const char *const commands[] = {"check", "info", "import", "replay --no-images"};
    static const char *const files[] = {"none.glb", "folder.glb", "pipe.glb"};
    char arguments[1024];
    snprintf(arguments, sizeof arguments, "cd %s && mkdir -p folder.glb && mkfifo pipe.glb",
             test_temp_dir());
    assert_int_equal(system(arguments), 0);
    for (u32 i = 0; i < COUNT_OF(commands); i++)
        for (u32 k = 0; k < COUNT_OF(files); k++) {
            snprintf(arguments, sizeof arguments, "%s %s/%s", commands[i], test_temp_dir(),
                     files[k]);
            Run run = luz("2>&1", arguments);
            // Levels add a line that counts the errors.
            bool is_level = i < 3;
            if (run.status != 1 || line_count(run.output) != (is_level ? 2 : 1))
                fail_msg("luz %s: status %d: %s", arguments, run.status, run.output);
            assert_non_null(strstr(run.output, files[k]));
        }
}

TEST(tool_cli, lost_output_is_no_success) {
    if (access("/dev/full", W_OK) != 0) TEST_SKIP("there is no /dev/full");
    Run run = luz("2>&1 >/dev/full", "schema");
    assert_int_equal(run.status, 3);
    assert_non_null(strstr(run.output, "cannot be written"));
}

TEST(tool_cli, json_of_text_commands) {
    Run run = luz("2>/dev/null", "fmt --check --json data/levels/light_box.toml none.toml");
    assert_int_equal(run.status, 1);
    assert_non_null(strstr(run.output, "\"file\": \"none.toml\", \"ok\": false"));
    run = luz("2>/dev/null", "import --json data/models/torch.glb");
    assert_int_equal(run.status, 0);
    assert_int_equal(run.output[0], '{');
    assert_non_null(strstr(run.output, "\"text\": \"# Made by"));
}

TEST(tool_cli, json_of_failures) {
    static const char *const commands[] = {
        "info none.toml",   "shot none.toml -o none.png",
        "replay none.luzr", "compare none.png none.png",
        "import none.glb",  "record none.toml -o none.luzr",
    };
    for (u32 i = 0; i < COUNT_OF(commands); i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "%s --json", commands[i]);
        Run run = luz("2>/dev/null", arguments);
        assert_int_equal(run.status, 1);
        const char *error = strstr(run.output, "\"error\": ");
        if (run.output[0] != '{' || !error || !strstr(error, "none."))
            fail_msg("luz %s: %s", arguments, run.output);
        assert_non_null(strstr(run.output, "\"ok\": false"));
    }
}

TEST(tool_cli, record_wants_a_length) {
    static const char *const lengths[] = {"-1", "0.001", "1e9", "1e300"};
    for (u32 i = 0; i < COUNT_OF(lengths); i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments,
                 "record data/levels/light_box.toml -o %s/a.luzr --image-every 0 --seconds %s",
                 test_temp_dir(), lengths[i]);
        Run run = luz("2>&1", arguments);
        assert_int_equal(run.status, 2);
        assert_non_null(strstr(run.output, "from one tick to four hours"));
    }
}

TEST(tool_cli, mistakes_of_split) {
    static const struct {
        const char *arguments, *says;
    } mistakes[] = {
        {"--split forward", "needs two values"},
        {"--split forward foward", "did you mean 'forward'"},
        {"--split pth=forward deferred", "did you mean 'path'"},
        {"--split forward deferred,layout=leen", "did you mean 'lean'"},
        {"--split forward deferred,", "has no value ''"},
        {"--split forward deferred,scale=0.5", "one size"},
        {"--split forward deferred --split-at 1.5", "from 0 to 1"},
        {"--split forward deferred --split-mode lines", "line difference both"},
        {"--split-mode line -o x.png", "goes with --split"},
        {"--split forward deferred --frames 0..3 -o x_%d.png", "--split goes with neither"},
        {"--split forward deferred --stats x.json", "--split goes with neither"},
    };
    for (u32 i = 0; i < COUNT_OF(mistakes); i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments, "shot data/levels/light_box.toml %s",
                 mistakes[i].arguments);
        Run run = luz("2>&1", arguments);
        if (run.status != 2 || !strstr(run.output, mistakes[i].says))
            fail_msg("luz %s: status %d: %s", arguments, run.status, run.output);
    }
    Run run = luz("2>&1", "replay none.luzr --split forward deferred");
    assert_int_equal(run.status, 2);
    assert_non_null(strstr(run.output, "--split is for frames"));
}

// Settings come in groups, each once.
TEST(tool_cli, info_lists_settings_by_group) {
    Run run = luz("2>&1", "info | sed -n '/settings (/,$p' | grep -v '^ '");
    const char *at = run.output;
    static const char *const groups[] = {"\npicture\n", "\nlight manager\n", "\nlight lists\n",
                                         "\npost chain\n"};
    for (u32 i = 0; i < COUNT_OF(groups); i++) {
        at = strstr(at, groups[i]);
        if (!at) fail_msg("no group '%s' in: %s", groups[i], run.output);
    }
}
