// Painters: one function per texture, and the brushes that they share.
//
// Data in: an empty Canvas. Data out: its colour, height and alpha planes. Called by texture.c.
// Painters know nothing of encoding or of materials.
#ifndef MAKE_ASSETS_PAINT_H
#define MAKE_ASSETS_PAINT_H

#include "texture.h"
#include "vec.h"

#include <stdint.h>

void paint_ashlar(Canvas *c);
void paint_carved(Canvas *c);
void paint_floor(Canvas *c);
void paint_roof(Canvas *c);
void paint_gravel(Canvas *c);
void paint_grass(Canvas *c);
void paint_hedge(Canvas *c);
void paint_bark(Canvas *c);
void paint_wood(Canvas *c);
void paint_iron(Canvas *c);
void paint_water(Canvas *c);
void paint_leaf_cypress(Canvas *c);
void paint_leaf_rose(Canvas *c);
void paint_leaf_ivy(Canvas *c);
void paint_leaf_fern(Canvas *c);
void paint_glass_lancet(Canvas *c);
void paint_glass_rose(Canvas *c);
void paint_tapestry(Canvas *c);

static inline Vec3 rgb255(int r, int g, int b) {
    return vec3((float)r / 255, (float)g / 255, (float)b / 255);
}

// Fills one texel.
void canvas_set(Canvas *c, int x, int y, Vec3 rgb, float height);

// Darkens hollows and lightens edges by comparing the height with its blurred self; `reach` in
// texels, `amount` of change per metre of difference. Call it after heights are complete.
void canvas_shade_cavities(Canvas *c, int reach, float amount);

// One leaf or blade: an ellipse with a pointed tip from (x, y), texels, wrapping at the borders.
// It covers what lies lower. `tip` 0 is round, 1 is sharp.
typedef struct LeafBrush {
    float x, y, angle, length, width, tip;
    float height, bulge; // metres at the stem, and added in the middle
    Vec3 root, end;      // colour along the leaf
} LeafBrush;
void canvas_leaf(Canvas *c, const LeafBrush *leaf, bool wrap);

#endif
