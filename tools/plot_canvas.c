// plot_canvas.c: anti-aliased lines, rectangles and discs on a page of pixels.
// Data in: shapes in pixels. Data out: RGBA8. A pixel's coverage is taken from its centre's
// distance to the shape's edge: exact for straight edges along the axes, close enough for others.
// Called by: plot.c, plot_text.c. Does not: curves (they come as short lines), transparency.
#include "plot.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool plot_canvas_create(PlotCanvas *canvas, u32 width, u32 height) {
    *canvas = (PlotCanvas){.width = width, .height = height};
    canvas->rgba = malloc((u64)width * height * 4);
    canvas->mask = calloc((u64)width * height, sizeof(f32));
    if (!canvas->rgba || !canvas->mask) {
        plot_canvas_destroy(canvas);
        return false;
    }
    memset(canvas->rgba, 255, (u64)width * height * 4);
    plot_canvas_no_clip(canvas);
    return true;
}

void plot_canvas_destroy(PlotCanvas *canvas) {
    free(canvas->rgba);
    free(canvas->mask);
    *canvas = (PlotCanvas){0};
}

static i32 clamp_px(f64 value, u32 side) { return (i32)CLAMP(value, 0.0, (f64)side); }

void plot_canvas_clip(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1) {
    canvas->clip_x0 = clamp_px(floor(x0), canvas->width);
    canvas->clip_y0 = clamp_px(floor(y0), canvas->height);
    canvas->clip_x1 = clamp_px(ceil(x1), canvas->width);
    canvas->clip_y1 = clamp_px(ceil(y1), canvas->height);
}

void plot_canvas_no_clip(PlotCanvas *canvas) {
    plot_canvas_clip(canvas, 0, 0, canvas->width, canvas->height);
}

typedef struct Box {
    i32 x0, y0, x1, y1;
} Box;

// Pixels that a shape can touch, within the clip; grows the part of the mask that is in use.
static Box touch(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1) {
    Box box = {MAX(clamp_px(floor(x0), canvas->width), canvas->clip_x0),
               MAX(clamp_px(floor(y0), canvas->height), canvas->clip_y0),
               MIN(clamp_px(ceil(x1), canvas->width), canvas->clip_x1),
               MIN(clamp_px(ceil(y1), canvas->height), canvas->clip_y1)};
    if (box.x0 >= box.x1 || box.y0 >= box.y1) return (Box){0};
    bool empty = canvas->x0 >= canvas->x1;
    canvas->x0 = empty ? box.x0 : MIN(canvas->x0, box.x0);
    canvas->y0 = empty ? box.y0 : MIN(canvas->y0, box.y0);
    canvas->x1 = empty ? box.x1 : MAX(canvas->x1, box.x1);
    canvas->y1 = empty ? box.y1 : MAX(canvas->y1, box.y1);
    return box;
}

static void cover(PlotCanvas *canvas, i32 x, i32 y, f64 coverage) {
    f32 *mask = &canvas->mask[(u64)y * canvas->width + (u32)x];
    *mask = MAX(*mask, (f32)CLAMP(coverage, 0.0, 1.0));
}

void plot_mask_line(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1, f64 width) {
    if (!isfinite(x0 + y0 + x1 + y1)) return;
    f64 radius = width / 2, reach = radius + 1;
    Box box = touch(canvas, MIN(x0, x1) - reach, MIN(y0, y1) - reach, MAX(x0, x1) + reach,
                    MAX(y0, y1) + reach);
    f64 dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
    for (i32 y = box.y0; y < box.y1; y++)
        for (i32 x = box.x0; x < box.x1; x++) {
            f64 px = x + 0.5 - x0, py = y + 0.5 - y0;
            f64 along = length2 > 0.0 ? CLAMP((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
            f64 ex = px - along * dx, ey = py - along * dy;
            cover(canvas, x, y, radius + 0.5 - sqrt(ex * ex + ey * ey));
        }
}

void plot_mask_disc(PlotCanvas *canvas, f64 x, f64 y, f64 radius) {
    plot_mask_line(canvas, x, y, x, y, radius * 2);
}

// The share of [at, at + 1] that lies in [from, to].
static f64 overlap(f64 from, f64 to, i32 at) {
    return MAX(MIN(to, at + 1.0) - MAX(from, (f64)at), 0.0);
}

void plot_mask_rect(PlotCanvas *canvas, f64 x0, f64 y0, f64 x1, f64 y1) {
    if (!isfinite(x0 + y0 + x1 + y1)) return;
    Box box = touch(canvas, x0, y0, x1, y1);
    for (i32 y = box.y0; y < box.y1; y++)
        for (i32 x = box.x0; x < box.x1; x++)
            cover(canvas, x, y, overlap(x0, x1, x) * overlap(y0, y1, y));
}

void plot_paint(PlotCanvas *canvas, u32 color) {
    const f32 rgb[3] = {(f32)(color >> 16 & 255), (f32)(color >> 8 & 255), (f32)(color & 255)};
    for (i32 y = canvas->y0; y < canvas->y1; y++)
        for (i32 x = canvas->x0; x < canvas->x1; x++) {
            u64 at = (u64)y * canvas->width + (u32)x;
            f32 share = canvas->mask[at];
            if (share <= 0.0f) continue;
            canvas->mask[at] = 0.0f;
            for (u32 c = 0; c < 3; c++) {
                f32 old = canvas->rgba[at * 4 + c];
                canvas->rgba[at * 4 + c] = (u8)(old + (rgb[c] - old) * share + 0.5f);
            }
        }
    canvas->x0 = canvas->y0 = canvas->x1 = canvas->y1 = 0;
}
