// plot.c: a page of charts: what goes where.
// Data in: series of numbers. Data out: RGBA8 pixels, PNG. Called by: bench_table.c, tests.
// Does not: choose what to show; decide ticks (plot_axis.c), pixels (plot_canvas.c), letters
// (plot_text.c).
#include "plot.h"
#include "../engine/asset/asset.h"
#include "../engine/base/log.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define INK       0x24292Fu
#define INK_PALE  0x57606Au
#define GRID_LINE 0xE4E8ECu
#define MARKS_MAX 64 // a line of more points has no marks on them

// Told apart also by those who do not see red and green as different (after Okabe and Ito, 2008,
// darkened where white shines through).
static const u32 colors[PLOT_SERIES_CAP] = {
    0x0072B2, 0xD55E00, 0x009E73, 0xB1459B, 0x222222, 0xE0A000,
    0x56B4E9, 0x8B5A2B, 0x7570B3, 0x66A61E, 0xC2185B, 0x888888,
};

PlotSeries *plot_add(PlotChart *chart, const char *name) {
    LUZ_ASSERT(chart->series_count < PLOT_SERIES_CAP);
    PlotSeries *series = &chart->series[chart->series_count++];
    *series = (PlotSeries){.name = name};
    return series;
}

typedef struct Layout {
    const PlotChart *chart;
    PlotCanvas *canvas;
    PlotAxis x_axis, y_axis;
    f64 x0, y0, x1, y1;           // the page's part for this chart
    f64 left, top, right, bottom; // of the area with the curves
    f64 size;                     // height of a capital
    bool turned;                  // categories stand upright
    f64 number_size;              // of what stands over bars; 0 = there is no room
} Layout;

static f64 place_x(const Layout *l, f64 value) {
    return l->left + plot_axis_place(&l->x_axis, value) * (l->right - l->left);
}

static f64 place_y(const Layout *l, f64 value) {
    return l->bottom - plot_axis_place(&l->y_axis, value) * (l->bottom - l->top);
}

static void choose_axes(Layout *l) {
    const PlotChart *chart = l->chart;
    PlotRange x = plot_range_begin(chart->x_log), y = plot_range_begin(chart->y_log);
    bool bars = chart->kind == PLOT_BARS;
    for (u32 s = 0; s < chart->series_count; s++) {
        const PlotSeries *series = &chart->series[s];
        u32 count = bars ? MIN(series->count, chart->category_count) : series->count;
        for (u32 i = 0; i < count; i++) {
            // A point that the other axis cannot show does not stretch this one.
            if (!isfinite(series->y[i]) || (chart->y_log && series->y[i] <= 0.0)) continue;
            if (!bars) {
                if (!isfinite(series->x[i]) || (chart->x_log && series->x[i] <= 0.0)) continue;
                plot_range_add(&x, series->x[i]);
            }
            plot_range_add(&y, series->y[i]);
            if (series->low) plot_range_add(&y, series->low[i]);
            if (series->high) plot_range_add(&y, series->high[i]);
        }
    }
    f64 height = l->y1 - l->y0, width = l->x1 - l->x0;
    l->y_axis = plot_axis(&y, bars || chart->y_from_zero, (u32)(height / 70));
    l->x_axis = plot_axis(&x, false, (u32)(width / 110));
    if (chart->x_tick_count && !bars) {
        // Numbers stand exactly where values are; the ends lie a little outside of them.
        l->x_axis.tick_count = MIN(chart->x_tick_count, PLOT_TICKS_CAP);
        for (u32 i = 0; i < l->x_axis.tick_count; i++) l->x_axis.ticks[i] = chart->x_ticks[i];
        if (x.any && x.max > x.min) {
            f64 room = x.log ? pow(x.max / x.min, 0.03) : (x.max - x.min) * 0.03;
            l->x_axis.min = x.log ? x.min / room : x.min - room;
            l->x_axis.max = x.log ? x.max * room : x.max + room;
        }
    }
}

static f64 widest_y_tick(const Layout *l) {
    f64 widest = 0.0;
    for (u32 i = 0; i < l->y_axis.tick_count; i++) {
        char text[32];
        plot_axis_format(&l->y_axis, l->y_axis.ticks[i], text, sizeof text);
        widest = MAX(widest, plot_text_width(l->size, text));
    }
    return widest;
}

static bool has_legend(const PlotChart *chart) { return chart->series_count > 1; }

static void choose_areas(Layout *l) {
    const PlotChart *chart = l->chart;
    f64 s = l->size, legend = 0.0, categories = 0.0;
    for (u32 i = 0; has_legend(chart) && i < chart->series_count; i++)
        legend = MAX(legend, plot_text_width(s, chart->series[i].name));
    l->left = l->x0 + s * 1.6 + (chart->y_label ? s * 2.4 : 0.0) + widest_y_tick(l) + s * 0.8;
    l->right = l->x1 - s * 2 - (legend > 0.0 ? legend + s * 5 : 0.0);
    // A page too small for its texts shows curves at least.
    if (l->right < l->left + s * 4) l->right = MIN(l->left + s * 4, l->x1);
    l->top = l->y0 + s * 2 + (chart->title ? s * 2.4 : 0.0);
    f64 slot = chart->category_count ? (l->right - l->left) / chart->category_count : 0.0;
    for (u32 i = 0; i < chart->category_count; i++) {
        f64 width = plot_text_width(s, chart->categories[i]);
        categories = MAX(categories, width);
        if (width > slot - s * 0.6) l->turned = true;
    }
    f64 below = l->turned ? categories + s * 0.8 : s * 1.9;
    l->bottom = l->y1 - s * 1.4 - below - (chart->x_label ? s * 2.2 : 0.0);
    if (l->bottom < l->top + s * 2) l->bottom = MIN(l->top + s * 2, l->y1);
}

static void line(Layout *l, f64 x0, f64 y0, f64 x1, f64 y1, u32 color) {
    plot_mask_line(l->canvas, x0, y0, x1, y1, 1.0);
    plot_paint(l->canvas, color);
}

static void draw_axes(Layout *l) {
    const PlotChart *chart = l->chart;
    f64 s = l->size;
    char text[32];
    for (u32 i = 0; i < l->y_axis.tick_count; i++) {
        f64 y = floor(place_y(l, l->y_axis.ticks[i])) + 0.5;
        line(l, l->left, y, l->right, y, GRID_LINE);
        plot_axis_format(&l->y_axis, l->y_axis.ticks[i], text, sizeof text);
        plot_text(l->canvas, l->left - s * 0.8, y + s * 0.5, s, PLOT_RIGHT, PLOT_LEVEL, INK_PALE,
                  text);
    }
    f64 last_end = -1e9; // of the number before, so that numbers do not overlap
    for (u32 i = 0; chart->kind == PLOT_LINES && i < l->x_axis.tick_count; i++) {
        f64 place = place_x(l, l->x_axis.ticks[i]);
        if (!(place >= l->left - 1 && place <= l->right + 1)) continue;
        f64 x = floor(place) + 0.5;
        line(l, x, l->top, x, l->bottom, GRID_LINE);
        plot_axis_format(&l->x_axis, l->x_axis.ticks[i], text, sizeof text);
        if (chart->x_tick_count) snprintf(text, sizeof text, "%g", l->x_axis.ticks[i]);
        f64 half = plot_text_width(s, text) / 2;
        if (x - half < last_end + s * 0.6) continue;
        last_end = x + half;
        plot_text(l->canvas, x, l->bottom + s * 1.9, s, PLOT_CENTER, PLOT_LEVEL, INK_PALE, text);
    }
    for (u32 i = 0; chart->kind == PLOT_BARS && i < chart->category_count; i++) {
        f64 x = l->left + (i + 0.5) * (l->right - l->left) / chart->category_count;
        if (l->turned)
            plot_text(l->canvas, x + s * 0.5, l->bottom + s * 0.8, s, PLOT_RIGHT, PLOT_UPWARDS, INK,
                      chart->categories[i]);
        else
            plot_text(l->canvas, x, l->bottom + s * 1.9, s, PLOT_CENTER, PLOT_LEVEL, INK,
                      chart->categories[i]);
    }
    line(l, l->left, floor(l->bottom) + 0.5, l->right, floor(l->bottom) + 0.5, INK_PALE);
    if (chart->title)
        plot_text(l->canvas, l->left, l->y0 + s * 3, s * 1.25, PLOT_LEFT, PLOT_LEVEL, INK,
                  chart->title);
    if (chart->x_label)
        plot_text(l->canvas, (l->left + l->right) / 2, l->y1 - s * 1.2, s, PLOT_CENTER, PLOT_LEVEL,
                  INK, chart->x_label);
    if (chart->y_label)
        plot_text(l->canvas, l->x0 + s * 2.2, (l->top + l->bottom) / 2, s, PLOT_CENTER,
                  PLOT_UPWARDS, INK, chart->y_label);
}

static void draw_legend(Layout *l) {
    f64 s = l->size, x = l->right + s * 1.6, y = l->top + s;
    for (u32 i = 0; has_legend(l->chart) && i < l->chart->series_count; i++, y += s * 2.1) {
        if (l->chart->kind == PLOT_BARS) {
            plot_mask_rect(l->canvas, x, y - s, x + s * 1.6, y);
        } else {
            plot_mask_line(l->canvas, x, y - s / 2, x + s * 2, y - s / 2, s * 0.22);
            plot_mask_disc(l->canvas, x + s, y - s / 2, s * 0.36);
        }
        plot_paint(l->canvas, colors[i]);
        plot_text(l->canvas, x + s * 2.8, y, s, PLOT_LEFT, PLOT_LEVEL, INK,
                  l->chart->series[i].name);
    }
}

static void draw_lines(Layout *l, const PlotSeries *series, u32 color) {
    f64 s = l->size;
    for (u32 i = 0; series->low && series->high && i < series->count; i++) {
        f64 x = place_x(l, series->x[i]);
        f64 low = place_y(l, series->low[i]), high = place_y(l, series->high[i]);
        plot_mask_line(l->canvas, x, low, x, high, s * 0.14);
    }
    bool has_last = false;
    f64 last_x = 0.0, last_y = 0.0;
    for (u32 i = 0; i < series->count; i++) {
        f64 x = place_x(l, series->x[i]), y = place_y(l, series->y[i]);
        bool shown = isfinite(x) && isfinite(y);
        if (shown && has_last) plot_mask_line(l->canvas, last_x, last_y, x, y, s * 0.22);
        if (shown && (series->count <= MARKS_MAX || !has_last))
            plot_mask_disc(l->canvas, x, y, series->count <= MARKS_MAX ? s * 0.36 : s * 0.11);
        has_last = shown;
        last_x = x;
        last_y = y;
    }
    plot_paint(l->canvas, color);
}

// A number in three digits: what fits over a bar.
static void bar_number(f64 value, char *out, u64 cap) {
    f64 size = fabs(value);
    if (size >= 100.0 && size < 1e6)
        snprintf(out, cap, "%.0f", value);
    else
        snprintf(out, cap, "%.3g", value);
}

// The same size for all numbers over bars: neighbours must not run into each other.
static void choose_number_size(Layout *l) {
    const PlotChart *chart = l->chart;
    f64 width =
        (l->right - l->left) / MAX(chart->category_count, 1) * 0.8 / MAX(chart->series_count, 1);
    l->number_size = l->size * 0.85;
    for (u32 s = 0; s < chart->series_count; s++)
        for (u32 i = 0; i < MIN(chart->series[s].count, chart->category_count); i++) {
            char text[32];
            bar_number(chart->series[s].y[i], text, sizeof text);
            f64 full = plot_text_width(1.0, text);
            l->number_size = MIN(l->number_size, (width - 3) / full);
        }
    if (l->number_size < l->size * 0.55) l->number_size = 0.0;
}

static void draw_bars(Layout *l, u32 s_index) {
    const PlotChart *chart = l->chart;
    const PlotSeries *series = &chart->series[s_index];
    f64 slot = (l->right - l->left) / MAX(chart->category_count, 1);
    f64 width = slot * 0.8 / chart->series_count;
    u32 count = MIN(series->count, chart->category_count);
    f64 base = chart->y_log ? l->bottom : place_y(l, CLAMP(0.0, l->y_axis.min, l->y_axis.max));
    for (u32 i = 0; i < count; i++) {
        f64 y = place_y(l, series->y[i]);
        if (!isfinite(y)) continue;
        f64 x = l->left + slot * (i + 0.1) + width * s_index;
        plot_mask_rect(l->canvas, x + 0.5, MIN(y, base), x + width - 0.5, MAX(y, base));
    }
    plot_paint(l->canvas, colors[s_index]);
    for (u32 i = 0; i < count; i++) {
        f64 y = place_y(l, series->y[i]), x = l->left + slot * (i + 0.1) + width * (s_index + 0.5);
        if (!isfinite(y)) continue;
        if (series->low && series->high) {
            plot_mask_line(l->canvas, x, place_y(l, series->low[i]), x, place_y(l, series->high[i]),
                           l->size * 0.14);
            plot_paint(l->canvas, INK);
            y = MIN(y, place_y(l, series->high[i]));
        }
        char text[32];
        bar_number(series->y[i], text, sizeof text);
        if (l->number_size > 0.0)
            plot_text(l->canvas, x, y - l->size * 0.5, l->number_size, PLOT_CENTER, PLOT_LEVEL, INK,
                      text);
    }
}

static void draw_chart(PlotCanvas *canvas, const PlotChart *chart, f64 x0, f64 y0, f64 x1, f64 y1) {
    Layout l = {.chart = chart, .canvas = canvas, .x0 = x0, .y0 = y0, .x1 = x1, .y1 = y1};
    l.size = CLAMP(MIN(y1 - y0, (x1 - x0) * 0.7) / 48, 6.0, 15.0);
    plot_canvas_clip(canvas, x0, y0, x1, y1);
    choose_axes(&l);
    choose_areas(&l);
    draw_axes(&l);
    draw_legend(&l);
    choose_number_size(&l);
    // Marks at the rim may stand out of the area by their radius.
    if (chart->kind == PLOT_LINES)
        plot_canvas_clip(canvas, l.left - l.size / 2, l.top - l.size / 2, l.right + l.size / 2,
                         l.bottom + l.size / 2);
    for (u32 s = 0; s < chart->series_count; s++) {
        if (chart->kind == PLOT_BARS)
            draw_bars(&l, s);
        else
            draw_lines(&l, &chart->series[s], colors[s]);
    }
    plot_canvas_no_clip(canvas);
}

u8 *plot_draw(const PlotChart *charts, u32 chart_count, u32 columns, u32 width, u32 height) {
    if (width < 64 || height < 64 || width > PLOT_SIDE_MAX || height > PLOT_SIDE_MAX) return NULL;
    PlotCanvas canvas;
    if (!plot_canvas_create(&canvas, width, height)) return NULL;
    columns = CLAMP(columns, 1, MAX(chart_count, 1));
    u32 rows = (chart_count + columns - 1) / columns;
    f64 w = (f64)width / columns, h = (f64)height / MAX(rows, 1);
    for (u32 i = 0; i < chart_count; i++) {
        f64 x = (i % columns) * w, y = (u32)(i / columns) * h;
        draw_chart(&canvas, &charts[i], x, y, x + w, y + h);
    }
    u8 *rgba = canvas.rgba;
    canvas.rgba = NULL;
    plot_canvas_destroy(&canvas);
    return rgba;
}

bool plot_write_png(const char *path, const PlotChart *charts, u32 chart_count, u32 columns,
                    u32 width, u32 height) {
    u8 *rgba = plot_draw(charts, chart_count, columns, width, height);
    if (!rgba) {
        LOG(USAGE, "%s: a page of %u x %u px cannot be drawn", path, width, height);
        return false;
    }
    bool ok = image_write_png(path, rgba, width, height, 4);
    free(rgba);
    return ok;
}
