// plot_text.c: ASCII text in strokes of a pen.
// Data in: characters. Data out: coverage on a canvas. Called by: plot.c.
//
// A glyph is a list of strokes separated by ';'; a stroke is a list of points "x,y" on a grid in
// which capitals are 14 high, small letters 9.5, tails reach to -4. A point after '~' is the
// control point of a quadratic curve; between two of them in a row lies a point on the curve,
// half-way (as in TrueType). Does not: kerning, characters beyond ASCII (they become '?').
#include "plot.h"
#include <math.h>
#include <stdlib.h>

#define CAPITAL      14.0
#define GAP          2.9  // between glyphs
#define PEN          1.75 // width of the stroke
#define CURVE_PIECES 6

typedef struct Glyph {
    f64 width;
    const char *strokes;
} Glyph;

#define BOWL_LEFT  "7.5,6.5 ~6.5,9.5 4,9.5 ~0,9.5 0,4.7 ~0,0 4,0 ~6.5,0 7.5,3"
#define BOWL_RIGHT "0,6.5 ~1,9.5 3.6,9.5 ~7.6,9.5 7.6,4.7 ~7.6,0 3.6,0 ~1,0 0,3"
#define ROUND      "5.5,14 ~11,14 ~11,0 5.5,0 ~0,0 ~0,14 5.5,14"
#define CURVE_S                                                                                    \
    "8,11.5 ~7,14 4.2,14 ~0.5,14 0.5,10.7 ~0.5,8.3 4.2,7.4 ~8.3,6.4 8.3,3.7 ~8.3,0 4.2,0 ~0.8,0 "  \
    "0,2.8"
static const Glyph glyphs[95] = {
    {3.4, ""},                                              // space
    {2, "1,14 1,4.5;1,0.2 1,0"},                            // !
    {3, "0,14 0,10.5;3,14 3,10.5"},                         // "
    {10, "2.5,0 4,14;6,0 7.5,14;0,4.5 9,4.5;1,9.5 10,9.5"}, // #
    {9, CURVE_S ";4.2,16 4.2,-2"},                          // $
    {11, "10,14 1,0;2.5,14 ~5,14 5,10.9 ~5,7.8 2.5,7.8 ~0,7.8 0,10.9 ~0,14 2.5,14;"
         "8.5,6.2 ~11,6.2 11,3.1 ~11,0 8.5,0 ~6,0 6,3.1 ~6,6.2 8.5,6.2"}, // %
    {10, "10,0 2.2,9.2 ~0.8,14 4,14 ~7,14 6.8,11.4 ~6.8,9.5 3.5,7.8 ~0,6 0,3.6 ~0,0 4,0 ~8,0 "
         "9.5,6"},                                                    // &
    {1, "0.5,14 0.5,10.5"},                                           // '
    {3, "3,15.5 ~0,12 0,6 ~0,0 3,-3.5"},                              // (
    {3, "0,15.5 ~3,12 3,6 ~3,0 0,-3.5"},                              // )
    {6, "3,14 3,8;0.4,12.5 5.6,9.5;5.6,12.5 0.4,9.5"},                // *
    {8, "4,11 4,3;0,7 8,7"},                                          // +
    {2, "1.3,0.6 0.2,-2.8"},                                          // ,
    {5, "0,5.5 5,5.5"},                                               // -
    {2, "1,0.2 1,0"},                                                 // .
    {6, "0,-2 6,15"},                                                 // /
    {8, "4,14 ~8,14 ~8,0 4,0 ~0,0 ~0,14 4,14"},                       // 0
    {8, "1.2,11 4.7,14 4.7,0"},                                       // 1
    {8, "0.3,10.5 ~0.3,14 4,14 ~7.8,14 7.8,10.5 ~7.8,8 5,5 0,0 8,0"}, // 2
    {8, "0.5,12 ~1.5,14 4,14 ~7.5,14 7.5,10.7 ~7.5,7.5 3.6,7.5;"
        "3.6,7.5 ~8,7.5 8,3.8 ~8,0 4,0 ~1,0 0,2.5"},                                    // 3
    {8, "6.2,0 6.2,14 0,4 8.2,4"},                                                      // 4
    {8, "7.3,14 1,14 0.5,7.3 ~1.8,9 4,9 ~8,9 8,4.5 ~8,0 4,0 ~1,0 0,2.5"},               // 5
    {8, "7,12.5 ~6,14 4.3,14 ~0,14 0,5;0,5 ~0,0 4,0 ~8,0 8,4.5 ~8,9 4.2,9 ~0.5,9 0,5"}, // 6
    {8, "0,14 8,14 3,0"},                                                               // 7
    {8, "4,7.5 ~0.5,7.5 0.5,10.8 ~0.5,14 4,14 ~7.5,14 7.5,10.8 ~7.5,7.5 4,7.5 ~0,7.5 0,3.8 ~0,0 "
        "4,0 ~8,0 8,3.8 ~8,7.5 4,7.5"},                                                // 8
    {8, "1,1.5 ~2,0 3.7,0 ~8,0 8,9;8,9 ~8,14 4,14 ~0,14 0,9.5 ~0,5 3.8,5 ~7.5,5 8,9"}, // 9
    {2, "1,0.2 1,0;1,8.7 1,8.5"},                                                      // :
    {2, "1.3,0.6 0.2,-2.8;1,8.7 1,8.5"},                                               // ;
    {8, "8,12 0,7 8,2"},                                                               // <
    {8, "0,9 8,9;0,5 8,5"},                                                            // =
    {8, "0,12 8,7 0,2"},                                                               // >
    {7, "0,11.5 ~0.5,14 3.6,14 ~7,14 7,11 ~7,8.7 3.6,6.8 3.6,4.3;3.6,0.2 3.6,0"},      // ?
    {13, "9.5,9 9.5,4.5 ~10,2.6 11.5,3 ~13,4 13,7.5 ~13,14 6.5,14 ~0,14 0,6 ~0,-2 6.5,-2 ~9,-2 "
         "10.5,-1;9.5,6 ~9.5,9 6.6,9 ~3.6,9 3.6,6 ~3.6,3 6.4,3 ~9.5,3 9.5,6"}, // @
    {10, "0,0 5,14 10,0;1.8,5 8.2,5"},                                         // A
    {8.3, "0,0 0,14 4.5,14 ~7.5,14 7.5,10.8 ~7.5,7.5 4.5,7.5 0,7.5;"
          "4.5,7.5 ~8.3,7.5 8.3,3.8 ~8.3,0 4.5,0 0,0"},                           // B
    {10, "10,11 ~8.5,14 5.2,14 ~0,14 0,7 ~0,0 5.2,0 ~8.5,0 10,3"},                // C
    {9, "0,0 0,14 3.5,14 ~9,14 9,7 ~9,0 3.5,0 0,0"},                              // D
    {8, "8,14 0,14 0,0 8,0;0,7.3 6.5,7.3"},                                       // E
    {7.5, "7.5,14 0,14 0,0;0,7.3 6.3,7.3"},                                       // F
    {10, "10,11 ~8.5,14 5.2,14 ~0,14 0,7 ~0,0 5.2,0 ~8.5,0 10,2.5 10,6.5 6,6.5"}, // G
    {9, "0,0 0,14;9,0 9,14;0,7.3 9,7.3"},                                         // H
    {1.6, "0.8,0 0.8,14"},                                                        // I
    {6, "6,14 6,4 ~6,0 3,0 ~0.5,0 0,3"},                                          // J
    {9, "0,0 0,14;9,14 0,5.5;3.2,8.5 9,0"},                                       // K
    {7, "0,14 0,0 7,0"},                                                          // L
    {11, "0,0 0,14 5.5,3 11,14 11,0"},                                            // M
    {9, "0,0 0,14 9,0 9,14"},                                                     // N
    {11, ROUND},                                                                  // O
    {8.5, "0,0 0,14 4.5,14 ~8.5,14 8.5,10.3 ~8.5,6.5 4.5,6.5 0,6.5"},             // P
    {11, ROUND ";6.5,3.5 10.5,-1"},                                               // Q
    {9, "0,0 0,14 4.5,14 ~8.5,14 8.5,10.3 ~8.5,6.5 4.5,6.5 0,6.5;4.8,6.5 9,0"},   // R
    {8.5, CURVE_S},                                                               // S
    {9, "0,14 9,14;4.5,14 4.5,0"},                                                // T
    {9, "0,14 0,5 ~0,0 4.5,0 ~9,0 9,5 9,14"},                                     // U
    {10, "0,14 5,0 10,14"},                                                       // V
    {14, "0,14 3.5,0 7,13 10.5,0 14,14"},                                         // W
    {9, "0,14 9,0;9,14 0,0"},                                                     // X
    {10, "0,14 5,7 10,14;5,7 5,0"},                                               // Y
    {9, "0,14 9,14 0,0 9,0"},                                                     // Z
    {3, "3,15.5 0,15.5 0,-3.5 3,-3.5"},                                           // [
    {6, "0,15 6,-2"},                                                             // backslash
    {3, "0,15.5 3,15.5 3,-3.5 0,-3.5"},                                           // ]
    {7, "0,9 3.5,14 7,9"},                                                        // ^
    {8, "0,-2.5 8,-2.5"},                                                         // _
    {3, "0,14 2.5,11.5"},                                                         // `
    {7.5, "7.5,9.5 7.5,0;" BOWL_LEFT},                                            // a
    {7.6, "0,14 0,0;" BOWL_RIGHT},                                                // b
    {7, "7,7.5 ~6,9.5 3.8,9.5 ~0,9.5 0,4.7 ~0,0 3.8,0 ~6,0 7,2"},                 // c
    {7.5, "7.5,14 7.5,0;" BOWL_LEFT},                                             // d
    {7.5, "0,5 7.5,5 ~7.5,9.5 3.9,9.5 ~0,9.5 0,4.7 ~0,0 4,0 ~6.3,0 7.2,2"},       // e
    {4.6, "5,14 ~2,14.2 2,11 2,0;0,9.5 4.6,9.5"},                                 // f
    {7.5, "7.5,9.5 7.5,-0.5 ~7.5,-4.3 3.8,-4.3 ~1.3,-4.3 0.5,-3;" BOWL_LEFT},     // g
    {7, "0,14 0,0;0,6 ~1,9.5 3.8,9.5 ~7,9.5 7,6 7,0"},                            // h
    {1.6, "0.8,9.5 0.8,0;0.8,13.2 0.8,13"},                                       // i
    {2.4, "1.6,9.5 1.6,-2 ~1.6,-4.3 -0.5,-4.3;1.6,13.2 1.6,13"},                  // j
    {7, "0,14 0,0;6.6,9.5 0,3.5;2.6,6 7,0"},                                      // k
    {1.6, "0.8,14 0.8,0"},                                                        // l
    {12, "0,9.5 0,0;0,6 ~0.8,9.5 3.2,9.5 ~6,9.5 6,6 6,0;6,6 ~6.8,9.5 9.2,9.5 ~12,9.5 12,6 12,0"},
    {7, "0,9.5 0,0;0,6 ~1,9.5 3.8,9.5 ~7,9.5 7,6 7,0"},           // n
    {8, "4,9.5 ~8,9.5 8,4.75 ~8,0 4,0 ~0,0 0,4.75 ~0,9.5 4,9.5"}, // o
    {7.6, "0,9.5 0,-4;" BOWL_RIGHT},                              // p
    {7.5, "7.5,9.5 7.5,-4;" BOWL_LEFT},                           // q
    {4.6, "0,9.5 0,0;0,5.5 ~1,9.5 4.6,9.4"},                      // r
    {6.5, "6.3,7.6 ~5.6,9.5 3.3,9.5 ~0.4,9.5 0.4,7.2 ~0.4,5.5 3.3,4.9 ~6.6,4.2 6.6,2.5 ~6.6,0 "
          "3.3,0 ~0.7,0 0,2"},                                                           // s
    {4.8, "2,13 2,3 ~2,0 4.8,0;0,9.5 4.6,9.5"},                                          // t
    {7, "0,9.5 0,3.5 ~0,0 3.2,0 ~6,0 7,3.5;7,9.5 7,0"},                                  // u
    {8, "0,9.5 4,0 8,9.5"},                                                              // v
    {11, "0,9.5 2.8,0 5.5,9 8.2,0 11,9.5"},                                              // w
    {7.5, "0,9.5 7.5,0;7.5,9.5 0,0"},                                                    // x
    {8, "0,9.5 4,0;8,9.5 3,-3 ~2.4,-4.3 0.5,-4.2"},                                      // y
    {7, "0,9.5 7,9.5 0,0 7,0"},                                                          // z
    {4, "4,15.5 ~1.8,15.5 1.8,12 1.8,8 ~1.8,6 0,6 ~1.8,6 1.8,4 1.8,0 ~1.8,-3.5 4,-3.5"}, // {
    {1.6, "0.8,16 0.8,-4"},                                                              // |
    {4, "0,15.5 ~2.2,15.5 2.2,12 2.2,8 ~2.2,6 4,6 ~2.2,6 2.2,4 2.2,0 ~2.2,-3.5 0,-3.5"}, // }
    {8, "0,6 ~1,8.5 2.7,8.2 4,7 5.3,5.8 ~7,5.5 8,8"},                                    // ~
};

static const Glyph *glyph_of(char character) {
    u8 code = (u8)character;
    return &glyphs[(code >= 32 && code < 127 ? code : '?') - 32];
}

f64 plot_text_width(f64 size, const char *text) {
    f64 width = 0.0;
    for (; *text; text++) width += glyph_of(*text)->width + (text[1] ? GAP : 0.0);
    return width * size / CAPITAL;
}

typedef struct Pen {
    PlotCanvas *canvas;
    f64 x, y, scale, width; // where the glyph's origin is
    PlotTurn turn;
} Pen;
typedef struct Point {
    f64 x, y;
} Point;

static void pen_line(const Pen *pen, Point a, Point b) {
    f64 s = pen->scale;
    if (pen->turn == PLOT_UPWARDS)
        plot_mask_line(pen->canvas, pen->x - a.y * s, pen->y - a.x * s, pen->x - b.y * s,
                       pen->y - b.x * s, pen->width);
    else
        plot_mask_line(pen->canvas, pen->x + a.x * s, pen->y - a.y * s, pen->x + b.x * s,
                       pen->y - b.y * s, pen->width);
}

static void pen_curve(const Pen *pen, Point a, Point control, Point b) {
    Point last = a;
    for (u32 i = 1; i <= CURVE_PIECES; i++) {
        f64 t = (f64)i / CURVE_PIECES, u = 1 - t;
        Point p = {u * u * a.x + 2 * u * t * control.x + t * t * b.x,
                   u * u * a.y + 2 * u * t * control.y + t * t * b.y};
        pen_line(pen, last, p);
        last = p;
    }
}

static void pen_glyph(const Pen *pen, const char *c) {
    Point at = {0}, control = {0};
    bool has_at = false, has_control = false;
    while (*c) {
        if (*c == ';') has_at = has_control = false;
        if (*c == ';' || *c == ' ') {
            c++;
            continue;
        }
        bool is_control = *c == '~';
        char *end;
        Point p;
        p.x = strtod(c + is_control, &end);
        p.y = strtod(end + 1, &end); // over the comma
        c = end;
        if (is_control && !has_control) {
            control = p;
            has_control = true;
            continue;
        }
        Point to = is_control ? (Point){(control.x + p.x) / 2, (control.y + p.y) / 2} : p;
        if (has_control)
            pen_curve(pen, at, control, to);
        else if (has_at)
            pen_line(pen, at, to);
        at = to;
        has_at = true;
        has_control = is_control;
        control = p;
    }
}

void plot_text(PlotCanvas *canvas, f64 x, f64 y, f64 size, PlotAlign align, PlotTurn turn,
               u32 color, const char *text) {
    f64 shift =
        align == PLOT_LEFT ? 0.0 : plot_text_width(size, text) * (align == PLOT_CENTER ? 0.5 : 1.0);
    Pen pen = {.canvas = canvas,
               .x = turn == PLOT_LEVEL ? x - shift : x,
               .y = turn == PLOT_LEVEL ? y : y + shift,
               .scale = size / CAPITAL,
               .width = MAX(PEN * size / CAPITAL, 1.15),
               .turn = turn};
    for (; *text; text++) {
        pen_glyph(&pen, glyph_of(*text)->strokes);
        f64 advance = (glyph_of(*text)->width + GAP) * pen.scale;
        if (turn == PLOT_UPWARDS)
            pen.y -= advance;
        else
            pen.x += advance;
    }
    plot_paint(canvas, color);
}
