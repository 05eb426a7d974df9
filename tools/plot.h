// plot.h: charts of measurements as PNG: lines over numbers, bars over categories, several charts
// on one page.
//
//   PlotChart chart = {.title = "Frame time", .x_label = "lights", .y_label = "ms",
//                      .x_log = true, .y_log = true};
//   PlotSeries *series = plot_add(&chart, "deferred");
//   series->x = lights; series->y = ms; series->count = 5;
//   plot_write_png("k3.png", &chart, 1, 1, 960, 540);
//
// Values that are no numbers, or not positive on a logarithmic axis, are left out: a line has a gap
// there, a bar is missing. Axes choose their range from what is left; a range without width is
// widened, no values at all give 0..1 (1..10). Text is ASCII.
//
// Does not: date axes, stacked bars, more than PLOT_SERIES_CAP series.
#ifndef LUZ_TOOL_PLOT_H
#define LUZ_TOOL_PLOT_H
#include "../engine/base/base.h"

#define PLOT_SERIES_CAP 12
#define PLOT_TICKS_CAP  64
#define PLOT_SIDE_MAX   8192 // px

typedef struct PlotSeries {
    const char *name;
    const f64 *x;          // [count]; bars ignore it: value i belongs to category i
    const f64 *y;          // [count]
    const f64 *low, *high; // [count] ends of the spread, or NULL
    u32 count;
} PlotSeries;

typedef enum PlotKind { PLOT_LINES, PLOT_BARS } PlotKind;
typedef struct PlotChart {
    PlotKind kind;
    const char *title, *x_label, *y_label; // each may be NULL
    bool x_log, y_log;
    bool y_from_zero;              // linear axis: begins at 0 even if all values are large
    const char *const *categories; // of bars: [category_count]
    u32 category_count;
    const f64 *x_ticks; // where to put numbers below instead of round ones, or NULL
    u32 x_tick_count;
    PlotSeries series[PLOT_SERIES_CAP];
    u32 series_count;
} PlotChart;
// The next series of a chart, in the next colour; asserts if there are too many.
PlotSeries *plot_add(PlotChart *chart, const char *name);

// Charts in rows of `columns`, each of the same size, on a page of width x height pixels, as RGBA8
// rows from the top; freed with free(). NULL if the page is not 64..PLOT_SIDE_MAX px wide and high.
u8 *plot_draw(const PlotChart *charts, u32 chart_count, u32 columns, u32 width, u32 height);
// The same into a file. False if it cannot be written (LOG).
bool plot_write_png(const char *path, const PlotChart *charts, u32 chart_count, u32 columns,
                    u32 width, u32 height);

// --- Axes (plot_axis.c) ---

typedef struct PlotAxis {
    f64 min, max; // what the two ends show; min < max; on a logarithmic axis both > 0
    bool log;
    f64 ticks[PLOT_TICKS_CAP];
    u32 tick_count;
    i32 decimals; // that tell all ticks apart; on a logarithmic axis each number has its own
} PlotAxis;
// A range over values that count: begin, add all, then finish.
typedef struct PlotRange {
    f64 min, max;
    bool log, any;
} PlotRange;
PlotRange plot_range_begin(bool log);
void plot_range_add(PlotRange *range, f64 value);
// Ticks are 1, 2 or 5 times a power of ten, about `wanted` of them, and the ends are ticks
// (after Heckbert, "Nice numbers for graph labels", Graphics Gems, 1990). On a logarithmic axis:
// powers of ten, with 2 and 5 between them where there are few.
PlotAxis plot_axis(const PlotRange *range, bool from_zero, u32 wanted);
// 0..1 between the ends (may lie outside), NAN for what the axis cannot show.
f64 plot_axis_place(const PlotAxis *axis, f64 value);
void plot_axis_format(const PlotAxis *axis, f64 value, char *out, u64 out_cap);

// --- Drawing (plot_canvas.c) ---

// A page, and a mask of how much of each pixel a shape covers: shapes are added to the mask, then
// the mask is painted, so that overlapping pieces of one shape are not seen.
typedef struct PlotCanvas {
    u8 *rgba;
    f32 *mask;
    u32 width, height;
    i32 x0, y0, x1, y1; // of the mask that is not zero; x0 >= x1: none
    // Nothing is painted outside.
    i32 clip_x0, clip_y0, clip_x1, clip_y1;
} PlotCanvas;
bool plot_canvas_create(PlotCanvas *canvas, u32 width, u32 height); // white
void plot_canvas_destroy(PlotCanvas *canvas);                       // also frees rgba
void plot_canvas_clip(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1);
void plot_canvas_no_clip(PlotCanvas *canvas);
// Pixel centres are at .5. Not finite coordinates are ignored.
void plot_mask_line(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1, f64 width);
void plot_mask_rect(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1);
void plot_mask_disc(PlotCanvas *canvas, f64 x, f64 y, f64 radius);
// color: 0xRRGGBB. Empties the mask.
void plot_paint(PlotCanvas *canvas, u32 color);

// --- Text (plot_text.c): a stroke font of our own, so any size and direction ---

typedef enum PlotAlign { PLOT_LEFT, PLOT_CENTER, PLOT_RIGHT } PlotAlign;
typedef enum PlotTurn { PLOT_LEVEL, PLOT_UPWARDS } PlotTurn;
// size: height of a capital in px. (x, y): on the line that letters stand on; y grows downwards.
void plot_text(PlotCanvas *canvas, f64 x, f64 y, f64 size, PlotAlign align, PlotTurn turn,
               u32 color, const char *text);
f64 plot_text_width(f64 size, const char *text);
#endif
