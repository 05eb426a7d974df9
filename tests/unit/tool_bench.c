// tool_bench.c: tables, verdicts and files of `luz bench`; mistakes on its command line.
#include "../test.h"
#include "../../tools/bench_table.c"
#include "../../tools/bench_output.c"
#include "../golden/studio.h"
#include <string.h>
#include <unistd.h>

static Bench bench; // large

static void begin(void) {
    bench = (Bench){.common.json = true}; // prints nothing
    assert_true(arena_create(&bench.arena, "test", MIB(16)));
}

TEST(tool_bench, csv_quotes_and_gaps) {
    begin();
    BenchTable table;
    bench_table_begin(&table, &bench, "t", "name,a ms,b");
    bench_text(&table, "plain");
    bench_number(&table, 1.5);
    bench_number(&table, 3);
    bench_text(&table, "with, comma and \"quotes\"");
    bench_number(&table, (f64)NAN);
    bench_number(&table, 1234567.25);
    bench_text(&table, "%s", "");
    bench_number(&table, (f64)INFINITY);
    bench_number(&table, 120000000);
    char *csv = bench_table_csv(&table);
    assert_string_equal(csv, "name,a ms,b\n"
                             "plain,1.5,3\n"
                             "\"with, comma and \"\"quotes\"\"\",,1.23457e+06\n"
                             ",,120000000\n");
    free(csv);
    assert_true(bench_table_end(&table));
    arena_destroy(&bench.arena);
}

TEST(tool_bench, columns_are_aligned) {
    begin();
    BenchTable table;
    bench_table_begin(&table, &bench, "t", "path,ms");
    bench_text(&table, "a");
    bench_number(&table, 1);
    bench_text(&table, "long name");
    bench_number(&table, 12.5);
    char *text = bench_table_aligned(&table);
    assert_string_equal(text, "path         ms\n"
                              "a             1\n"
                              "long name  12.5\n");
    free(text);
    bench_table_end(&table);
    arena_destroy(&bench.arena);
}

TEST(tool_bench, many_rows_and_a_file) {
    begin();
    bench.plots = test_temp_dir();
    BenchTable table;
    bench_table_begin(&table, &bench, "many", "i,square");
    for (u32 i = 0; i < 1000; i++) {
        bench_number(&table, i);
        bench_number(&table, (f64)i * i);
    }
    assert_true(bench_table_end(&table));
    char path[512];
    snprintf(path, sizeof path, "%s/many.csv", test_temp_dir());
    Bytes bytes;
    assert_true(file_read(path, MIB(1), &bench.arena, &bytes));
    assert_non_null(strstr((const char *)bytes.data, "\n999,998001\n"));
    f64 x[2] = {1, 2};
    PlotChart chart = {.title = "t"};
    PlotSeries *series = plot_add(&chart, "s");
    *series = (PlotSeries){.name = "s", .x = x, .y = x, .count = 2};
    assert_true(bench_plot(&bench, "many", &chart, 1, 1, 320, 200));
    snprintf(path, sizeof path, "%s/many.png", test_temp_dir());
    assert_true(file_exists(path));
    bench.plots = "/nowhere";
    assert_false(bench_plot(&bench, "many", &chart, 1, 1, 320, 200));
    bench.plots = NULL;
    assert_true(bench_plot(&bench, "many", &chart, 1, 1, 320, 200));
    arena_destroy(&bench.arena);
}

TEST(tool_bench, verdicts) {
    BenchVerdict verdict = {.measured = 1.28, .wanted = 1.28, .wish = BENCH_AT_LEAST};
    assert_true(bench_verdict_ok(&verdict));
    verdict.measured = 1.27;
    assert_false(bench_verdict_ok(&verdict));
    verdict.wish = BENCH_AT_MOST;
    assert_true(bench_verdict_ok(&verdict));
    verdict.measured = (f64)NAN;
    assert_false(bench_verdict_ok(&verdict));
    verdict.wish = BENCH_AT_LEAST;
    assert_false(bench_verdict_ok(&verdict));
}

// --- the command ---

static const char *run_bench(int *code, const char *arguments) {
    char luz[4200];
    snprintf(luz, sizeof luz, "%s/luz", studio_build_directory());
    if (access(luz, X_OK) != 0) TEST_SKIP("%s is not built", luz);
    return studio_shell(code, "%s bench %s", luz, arguments);
}

TEST(tool_bench, unknown_rows) {
    int code;
    const char *output = run_bench(&code, "P9");
    assert_int_equal(code, 2);
    assert_non_null(strstr(output, "unknown row 'P9'; did you mean 'P"));
    output = run_bench(&code, "cul");
    assert_int_equal(code, 2);
    assert_non_null(strstr(output, "did you mean 'cull'?"));
    // Nothing is measured before all names are known.
    output = run_bench(&code, "cull k4");
    assert_int_equal(code, 2);
    assert_null(strstr(output, "median"));
}

TEST(tool_bench, plots_want_a_directory) {
    int code;
    const char *output = run_bench(&code, "cull --quick --plots /proc/nowhere");
    assert_int_equal(code, 3);
    assert_non_null(strstr(output, "cannot write into '/proc/nowhere'"));
    assert_null(strstr(output, "median"));
    char arguments[600];
    snprintf(arguments, sizeof arguments, "cull --quick -q --plots %s/file", test_temp_dir());
    char path[512];
    snprintf(path, sizeof path, "%s/file", test_temp_dir());
    assert_true(file_write(path, "x", 1));
    run_bench(&code, arguments);
    assert_int_equal(code, 3);
    run_bench(&code, "cull --plots");
    assert_int_equal(code, 2);
}

TEST(tool_bench, rows_in_any_case_and_csv) {
    int code;
    char arguments[600], path[512];
    snprintf(path, sizeof path, "%s/a.csv", test_temp_dir());
    snprintf(arguments, sizeof arguments, "CULL --quick -q --csv %s", path);
    const char *output = run_bench(&code, arguments);
    assert_int_equal(code, 0);
    assert_non_null(strstr(output, "median"));
    begin();
    Bytes bytes;
    assert_true(file_read(path, MIB(1), &bench.arena, &bytes));
    assert_int_equal(
        strncmp((const char *)bytes.data, "row,what,median,p10,p90,unit,ratio\ncull,", 40), 0);
    arena_destroy(&bench.arena);
}

// An experiment from end to end: the smallest one.
TEST_GPU(tool_bench, experiment_leaves_table_and_chart) {
    int code;
    char arguments[1024];
    snprintf(arguments, sizeof arguments,
             "p2 --quick -q --level data/levels/cornell.toml --plots %s/deep/er", test_temp_dir());
    const char *output = run_bench(&code, arguments);
    if (code != 0) fail_msg("status %d: %s", code, output);
    assert_non_null(strstr(output, "starcraft2"));
    assert_non_null(strstr(output, "P2      ok           position and normal"));
    char path[512];
    snprintf(path, sizeof path, "%s/deep/er/p2.csv", test_temp_dir());
    assert_true(file_exists(path));
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(64)));
    u8 *rgba;
    u32 width, height;
    snprintf(path, sizeof path, "%s/deep/er/p2.png", test_temp_dir());
    assert_true(image_read(path, &arena, &rgba, &width, &height));
    assert_in_range(width, 600, 2000);
    arena_destroy(&arena);
}

TEST_GPU(tool_bench, json_of_an_experiment) {
    int code;
    const char *output =
        run_bench(&code, "P2 --quick -q --json --level data/levels/cornell.toml 2>/dev/null");
    assert_int_equal(code, 0);
    assert_int_equal(output[0], '{');
    assert_non_null(strstr(output, "\"verdicts\": ["));
    assert_non_null(strstr(output, "\"ok\": true"));
}
