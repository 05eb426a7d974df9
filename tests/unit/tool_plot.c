// tool_plot.c: the charts of `luz bench`: ticks, ranges, pixels, files.
#include "../test.h"
#include "../../engine/asset/asset.h"
#include "../../tools/plot.c"
#include "../../tools/plot_axis.c"
#include "../../tools/plot_canvas.c"
#include "../../tools/plot_text.c"
#include <string.h>

static PlotAxis axis_over(bool log, const f64 *values, u32 count) {
    PlotRange range = plot_range_begin(log);
    for (u32 i = 0; i < count; i++) plot_range_add(&range, values[i]);
    return plot_axis(&range, false, 5);
}

static void assert_axis(const PlotAxis *axis, const f64 *values, u32 count) {
    assert_true(axis->max > axis->min);
    assert_in_range(axis->tick_count, 2, PLOT_TICKS_CAP);
    for (u32 i = 1; i < axis->tick_count; i++) assert_true(axis->ticks[i] > axis->ticks[i - 1]);
    for (u32 i = 0; i < count; i++) {
        if (!isfinite(values[i]) || (axis->log && values[i] < 1e-300)) continue;
        f64 place = plot_axis_place(axis, values[i]);
        if (!(place >= -1e-6 && place <= 1 + 1e-6))
            fail_msg("%g lies at %g between %g and %g", values[i], place, axis->min, axis->max);
    }
}

TEST(tool_plot, ticks_are_round_and_hold_the_values) {
    PlotAxis axis = axis_over(false, (f64[]){0.0, 97.0}, 2);
    static const f64 expected[] = {0, 20, 40, 60, 80, 100};
    assert_int_equal(axis.tick_count, COUNT_OF(expected));
    for (u32 i = 0; i < COUNT_OF(expected); i++)
        assert_true(fabs(axis.ticks[i] - expected[i]) < 1e-9);
    char text[32];
    plot_axis_format(&axis, axis.ticks[1], text, sizeof text);
    assert_string_equal(text, "20");
    axis = axis_over(false, (f64[]){-0.013, 0.021}, 2);
    plot_axis_format(&axis, axis.ticks[0], text, sizeof text);
    assert_string_equal(text, "-0.015");
    assert_true(axis.ticks[3] == 0.0);
    plot_axis_format(&axis, -1e-18, text, sizeof text);
    assert_string_equal(text, "0.000");
}

TEST(tool_plot, ranges_of_any_values) {
    static const f64 cases[][3] = {
        {0, 0, 0},       {5, 5, 5},          {-3, -3, -3},           {1e-12, 1e-12, 1e-12},
        {1e12, 1e12, 1}, {1, 1 + 1e-15, 1},  {NAN, 4, INFINITY},     {NAN, NAN, NAN},
        {-1e300, 1, 2},  {1e-300, 0, 1e300}, {0.1, 0.30000001, 0.2}, {999, 1000, 1001},
        {-5, 0, 0},      {0, 0, 1e-320},
    };
    for (u32 i = 0; i < COUNT_OF(cases); i++) {
        PlotAxis axis = axis_over(false, cases[i], 3);
        assert_axis(&axis, cases[i], 3);
        axis = axis_over(true, cases[i], 3);
        assert_true(axis.min > 0.0);
        assert_axis(&axis, cases[i], 3);
    }
    // Many values of all sizes; wanted numbers of ticks of any size.
    for (u32 i = 0; i < 2000; i++) {
        f64 low = pow(10, (i % 37) * 0.5 - 9) * (i % 3 ? 1 : -1);
        f64 values[2] = {low, low + pow(10, (i % 23) * 0.7 - 8)};
        PlotRange range = plot_range_begin(i % 2);
        plot_range_add(&range, values[0]);
        plot_range_add(&range, values[1]);
        PlotAxis axis = plot_axis(&range, i % 5 == 0, i % 90);
        assert_axis(&axis, values, 2);
    }
}

TEST(tool_plot, logarithmic_axis) {
    f64 values[] = {16, 64, 256, 1024, 4096, 0, -5};
    PlotAxis axis = axis_over(true, values, COUNT_OF(values));
    assert_axis(&axis, values, COUNT_OF(values));
    assert_true(axis.min >= 10 - 1e-9 && axis.max <= 5000 + 1e-6);
    assert_true(isnan(plot_axis_place(&axis, 0.0)));
    assert_true(isnan(plot_axis_place(&axis, -1.0)));
    char text[32];
    plot_axis_format(&axis, 1000, text, sizeof text);
    assert_string_equal(text, "1000");
    plot_axis_format(&axis, 0.05, text, sizeof text);
    assert_string_equal(text, "0.05");
    // Many decades: only powers of ten.
    axis = axis_over(true, (f64[]){1e-6, 1e6}, 2);
    assert_in_range(axis.tick_count, 3, 13);
}

typedef struct Page {
    PlotChart chart;
    f64 x[4], y[4];
} Page;

static void page_fill(Page *page) {
    *page = (Page){.x = {1, 2, 3, 4}, .y = {10, 20, 15, 30}};
    page->chart.title = "Title";
    page->chart.x_label = "lights";
    page->chart.y_label = "ms";
    PlotSeries *series = plot_add(&page->chart, "one");
    *series = (PlotSeries){.name = "one", .x = page->x, .y = page->y, .count = 4};
}

static u32 count_color(const u8 *rgba, u32 count, u32 color) {
    u32 found = 0;
    for (u32 i = 0; i < count; i++)
        found += rgba[i * 4] == (color >> 16) && rgba[i * 4 + 1] == (color >> 8 & 255) &&
                 rgba[i * 4 + 2] == (color & 255);
    return found;
}

TEST(tool_plot, draws_curve_and_bars) {
    Page page;
    page_fill(&page);
    u8 *rgba = plot_draw(&page.chart, 1, 1, 400, 300);
    assert_non_null(rgba);
    assert_true(count_color(rgba, 400 * 300, colors[0]) > 200);
    assert_true(count_color(rgba, 400 * 300, 0xFFFFFF) > 80000);
    free(rgba);
    static const char *const names[] = {"a", "a very long name of a category", "c", "d"};
    page.chart.kind = PLOT_BARS;
    page.chart.categories = names;
    page.chart.category_count = 4;
    rgba = plot_draw(&page.chart, 1, 1, 400, 300);
    assert_true(count_color(rgba, 400 * 300, colors[0]) > 2000);
    free(rgba);
}

// The same picture whatever the series' other points are: gaps draw nothing and break nothing.
TEST(tool_plot, values_that_cannot_be_shown) {
    Page page;
    page_fill(&page);
    page.chart.y_log = page.chart.x_log = true;
    page.y[1] = NAN;
    page.x[2] = 0;
    page.y[3] = -1;
    u8 *rgba = plot_draw(&page.chart, 1, 1, 400, 300);
    assert_true(count_color(rgba, 400 * 300, colors[0]) > 4); // a lone mark
    free(rgba);
    for (u32 i = 0; i < 4; i++) page.y[i] = INFINITY;
    rgba = plot_draw(&page.chart, 1, 1, 400, 300);
    assert_int_equal(count_color(rgba, 400 * 300, colors[0]), 0);
    free(rgba);
    rgba = plot_draw(NULL, 0, 1, 64, 64);
    assert_int_equal(count_color(rgba, 64 * 64, 0xFFFFFF), 64 * 64);
    free(rgba);
}

TEST(tool_plot, more_points_than_pixels) {
    enum { COUNT = 100000 };
    f64 *x = malloc(COUNT * sizeof(f64)), *y = malloc(COUNT * sizeof(f64));
    for (u32 i = 0; i < COUNT; i++) {
        x[i] = i;
        y[i] = i % 1000;
    }
    PlotChart chart = {0};
    PlotSeries *series = plot_add(&chart, "saw");
    *series = (PlotSeries){.name = "saw", .x = x, .y = y, .count = COUNT};
    u8 *rgba = plot_draw(&chart, 1, 1, 200, 100);
    assert_true(count_color(rgba, 200 * 100, 0xFFFFFF) < 14000);
    free(rgba);
    free(x);
    free(y);
}

TEST(tool_plot, small_and_wrong_pages) {
    Page page;
    page_fill(&page);
    assert_null(plot_draw(&page.chart, 1, 1, 63, 400));
    assert_null(plot_draw(&page.chart, 1, 1, 400, PLOT_SIDE_MAX + 1));
    for (u32 columns = 0; columns < 4; columns++) {
        PlotChart charts[5];
        for (u32 i = 0; i < 5; i++) charts[i] = page.chart;
        u8 *rgba = plot_draw(charts, 5, columns, 64, 64);
        assert_non_null(rgba);
        free(rgba);
    }
}

// Letters stay within their width and between the line above and the one below.
TEST(tool_plot, every_character_in_its_box) {
    for (char c = 33; c < 127; c++) {
        PlotCanvas canvas;
        assert_true(plot_canvas_create(&canvas, 80, 80));
        const char text[2] = {c, 0};
        plot_text(&canvas, 30, 50, 20, PLOT_LEFT, PLOT_LEVEL, 0, text);
        f64 width = plot_text_width(20, text);
        u32 dark = 0;
        for (u32 y = 0; y < 80; y++)
            for (u32 x = 0; x < 80; x++) {
                if (canvas.rgba[(y * 80 + x) * 4] > 128) continue;
                dark++;
                if (x < 26 || x > 30 + width + 4 || y < 24 || y > 58)
                    fail_msg("'%c' has a pixel at %u %u (width %g)", c, x, y, width);
            }
        if (dark < 6) fail_msg("'%c' is not drawn", c);
        plot_canvas_destroy(&canvas);
    }
    assert_true(plot_text_width(10, "caf\xC3\xA9") > plot_text_width(10, "caf"));
    assert_true(plot_text_width(10, "") == 0.0);
}

TEST(tool_plot, text_is_on_the_page) {
    Page page;
    page_fill(&page);
    u8 *with = plot_draw(&page.chart, 1, 1, 400, 300);
    page.chart.title = NULL;
    u8 *without = plot_draw(&page.chart, 1, 1, 400, 300);
    assert_true(count_color(with, 400 * 30, 0xFFFFFF) < 400 * 30 - 50);
    assert_true(memcmp(with, without, 400 * 300 * 4) != 0);
    free(with);
    free(without);
}

TEST(tool_plot, file_loads_again) {
    Page page;
    page_fill(&page);
    char path[512];
    snprintf(path, sizeof path, "%s/chart.png", test_temp_dir());
    assert_true(plot_write_png(path, &page.chart, 1, 1, 321, 123));
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(16)));
    u8 *rgba, *drawn = plot_draw(&page.chart, 1, 1, 321, 123);
    u32 width, height;
    assert_true(image_read(path, &arena, &rgba, &width, &height));
    assert_int_equal(width, 321);
    assert_int_equal(height, 123);
    assert_memory_equal(rgba, drawn, 321 * 123 * 4);
    free(drawn);
    arena_destroy(&arena);
    assert_false(plot_write_png("/nowhere/chart.png", &page.chart, 1, 1, 321, 123));
}
