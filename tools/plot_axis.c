// plot_axis.c: ranges and round numbers for the axes of charts.
// Data in: values. Data out: ends, ticks, their texts. Called by: plot.c.
// Does not: draw.
#include "plot.h"
#include <float.h>
#include <math.h>
#include <stdio.h>

PlotRange plot_range_begin(bool log) { return (PlotRange){DBL_MAX, -DBL_MAX, log, false}; }

void plot_range_add(PlotRange *range, f64 value) {
    // Beyond these the arithmetic of ticks would overflow.
    if (!isfinite(value) || fabs(value) > 1e300) return;
    if (fabs(value) < 1e-300) value = 0.0;
    if (range->log && value <= 0.0) return;
    range->min = MIN(range->min, value);
    range->max = MAX(range->max, value);
    range->any = true;
}

// The nearest of 1, 2, 5, 10 times a power of ten.
static f64 nice_step(f64 step) {
    f64 power = pow(10.0, floor(log10(step))), share = step / power;
    return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

static PlotAxis linear_axis(f64 min, f64 max, u32 wanted) {
    // Values that are equal but for rounding have no room for ticks between them.
    f64 size = MAX(fabs(min), fabs(max));
    if (max - min <= size * 1e-9) {
        f64 half = size > 0.0 ? size / 2 : 0.5;
        if (min == 0.0) half = 0.5;
        min -= half;
        max += half;
    }
    f64 step = nice_step((max - min) / MAX(wanted, 2));
    f64 first = floor(min / step + 1e-9), last = ceil(max / step - 1e-9);
    // Few enough whatever `wanted` is.
    while (last - first + 1 > PLOT_TICKS_CAP) {
        step = nice_step(step * 2.1);
        first = floor(min / step + 1e-9);
        last = ceil(max / step - 1e-9);
    }
    PlotAxis axis = {.min = first * step, .max = last * step};
    for (f64 k = first; k <= last && axis.tick_count < PLOT_TICKS_CAP; k++)
        axis.ticks[axis.tick_count++] = k * step;
    axis.decimals = (i32)CLAMP(-floor(log10(step) + 1e-9), 0.0, 12.0);
    return axis;
}

static PlotAxis log_axis(f64 min, f64 max, u32 wanted) {
    static const f64 factors[] = {1, 2, 5};
    f64 decades = log10(max) - log10(min);
    // Powers of ten alone where they are many, 1 2 5 where they are few.
    bool fine = decades * 3 <= (f64)MAX(wanted, 3) * 1.5;
    f64 every = MAX(ceil(decades / MAX(wanted, 2)), 1.0);
    PlotAxis axis = {.log = true};
    f64 first = floor(log10(min) + 1e-9), last = ceil(log10(max) - 1e-9);
    if (last <= first) last = first + 1;
    // A whole decade is much: the ends are the nearest ticks around the values.
    f64 ends[2] = {pow(10, first), pow(10, last)};
    for (f64 d = first; d <= last; d++)
        for (u32 f = 0; f < (fine ? COUNT_OF(factors) : 1); f++) {
            f64 tick = pow(10, d) * factors[f];
            if (tick <= min * (1 + 1e-9)) ends[0] = MAX(ends[0], tick);
            if (tick >= max * (1 - 1e-9)) ends[1] = MIN(ends[1], tick);
        }
    if (ends[1] <= ends[0] * (1 + 1e-9)) ends[1] = ends[0] * 10;
    axis.min = ends[0];
    axis.max = ends[1];
    for (f64 d = first; d <= last + 1; d += every)
        for (u32 f = 0; f < (fine ? COUNT_OF(factors) : 1); f++) {
            f64 tick = pow(10, d) * factors[f];
            bool inside = tick >= axis.min * (1 - 1e-9) && tick <= axis.max * (1 + 1e-9);
            if (inside && axis.tick_count < PLOT_TICKS_CAP) axis.ticks[axis.tick_count++] = tick;
        }
    return axis;
}

PlotAxis plot_axis(const PlotRange *range, bool from_zero, u32 wanted) {
    if (range->log)
        return range->any ? log_axis(range->min, range->max, wanted) : log_axis(1, 10, wanted);
    f64 min = range->any ? range->min : 0.0, max = range->any ? range->max : 1.0;
    if (from_zero) {
        min = MIN(min, 0.0);
        max = MAX(max, 0.0);
        if (min == max) max = 1.0;
    }
    return linear_axis(min, max, wanted);
}

f64 plot_axis_place(const PlotAxis *axis, f64 value) {
    if (!isfinite(value)) return NAN;
    if (!axis->log) return (value - axis->min) / (axis->max - axis->min);
    if (value <= 0.0) return NAN;
    return (log(value) - log(axis->min)) / (log(axis->max) - log(axis->min));
}

void plot_axis_format(const PlotAxis *axis, f64 value, char *out, u64 out_cap) {
    // Not "-0".
    if (!axis->log && fabs(value) < pow(10, -axis->decimals) / 2) value = 0.0;
    f64 size = fabs(value);
    bool huge = size >= 1e7 || (size > 0.0 && size < 1e-4);
    if (axis->log || (huge && axis->decimals <= 4)) {
        snprintf(out, out_cap, size < 1e7 && size >= 1e-4 ? "%.10g" : "%.3g", value);
        return;
    }
    snprintf(out, out_cap, "%.*f", axis->decimals, value);
}
