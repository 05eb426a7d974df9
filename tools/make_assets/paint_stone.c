// Painters of stone and clay: ashlar walls, dressed stone, floor tiles, roof tiles, gravel.
//
// Data in: an empty Canvas. Data out: colour and height. Called through the table in texture.c.
#include "noise.h"
#include "paint.h"

#define COURSES 6

// Edge distance and identity of the block under a point of the wall, in metres.
typedef struct Block {
    float edge_m;
    uint32_t id;
    float u, v; // place inside the block, 0..1
} Block;

static Block ashlar_block(float x, float y) {
    // Heights of the courses, fractions of the tile: unequal, as quarries deliver.
    static const float TOPS[COURSES + 1] = {0, 0.155f, 0.34f, 0.49f, 0.67f, 0.835f, 1};
    int row = 0;
    while (row < COURSES - 1 && y >= TOPS[row + 1]) row++;
    int blocks = 4 + (int)(noise_hash((uint32_t)row, 3, 11) % 2);
    float shift = noise_random((uint32_t)row, 1, 12);
    float at = x + shift;
    at -= floorf(at);
    // Joints at i + jitter; the last joint is the first one, a tile further.
    float left = 0, right = 1;
    int index = 0;
    for (int i = 0; i < blocks; i++) {
        float a = ((float)i + 0.3f * (noise_random((uint32_t)i, (uint32_t)row, 13) - 0.5f)) /
                  (float)blocks;
        float b = ((float)(i + 1) +
                   0.3f * (noise_random((uint32_t)((i + 1) % blocks), (uint32_t)row, 13) - 0.5f)) /
                  (float)blocks;
        float p = at;
        if (i == blocks - 1 && p < a) p += 1;
        if (i == 0 && p >= b && p - 1 >= a) p -= 1;
        if (p >= a && p < b) {
            left = p - a;
            right = b - p;
            index = i;
        }
    }
    float bottom = y - TOPS[row], top = TOPS[row + 1] - y;
    float e = fminf(fminf(left, right), fminf(bottom, top)) * 2.0f;
    // Rounded corners: near two edges at once the distance shrinks.
    float ex = fminf(left, right) * 2.0f, ey = fminf(bottom, top) * 2.0f;
    if (ex < 0.04f && ey < 0.04f) {
        float cx = 0.04f - ex, cy = 0.04f - ey;
        e = fminf(e, 0.04f - sqrtf(cx * cx + cy * cy));
    }
    return (Block){e, (uint32_t)(row * 16 + index), left / (left + right), bottom / (bottom + top)};
}

void paint_ashlar(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float wx = noise_fbm(u, v, 12, 3, 0.5f, 21) * 0.004f;
            float wy = noise_fbm(u, v, 12, 3, 0.5f, 22) * 0.004f;
            float vv = v + wy - floorf(v + wy);
            Block b = ashlar_block(u + wx, vv);
            float wear = 0.5f + 0.5f * noise_fbm(u, v, 8, 3, 0.5f, 23);
            float joint = 0.005f + 0.005f * wear;
            float body = float_smooth(joint * 0.6f, joint + 0.012f + 0.01f * wear, b.edge_m);
            float tone = noise_random(b.id, 5, 31), warm = noise_random(b.id, 6, 32);
            float tilt = (b.u - 0.5f) * (noise_random(b.id, 7, 33) - 0.5f) +
                         (b.v - 0.5f) * (noise_random(b.id, 8, 34) - 0.5f);
            float tooled = noise_fbm_stretched(u, v, 14 + (b.id % 3 ? 0 : 70),
                                               60 - (b.id % 3 ? 0 : 40), 3, 0.55f, 35 + b.id % 5);
            float rough = noise_fbm(u, v, 10, 5, 0.6f, 41);
            float pits = noise_cells(u, v, 64, 1, 43).nearest;
            float pit = (noise_fbm(u, v, 6, 2, 0.5f, 44) > 0.05f ? 1.0f : 0.0f) *
                        (1 - float_smooth(0.12f, 0.34f, pits));
            float height = body * (0.016f + 0.006f * (tone - 0.5f) + 0.010f * tilt) +
                           body * (0.0022f * tooled + 0.0035f * rough - 0.0022f * pit) +
                           (1 - body) * 0.0016f * noise_fbm(u, v, 60, 2, 0.6f, 45);
            Vec3 light = rgb255(176, 165, 142), ochre = rgb255(166, 142, 108);
            Vec3 grey = rgb255(146, 146, 138);
            Vec3 stone = vec3_lerp(light, warm < 0.5f ? ochre : grey, fabsf(warm - 0.5f) * 1.1f);
            stone = vec3_scale(stone, 0.89f + 0.17f * tone);
            stone = vec3_scale(stone, 1 + 0.10f * rough + 0.05f * tooled - 0.12f * pit);
            float stain = float_smooth(0.1f, 0.65f, noise_fbm_stretched(u, v, 5, 2, 4, 0.5f, 51));
            stone = vec3_lerp(stone, vec3_scale(rgb255(104, 100, 88), 0.95f), stain * 0.35f);
            float lichen = float_smooth(0.28f, 0.5f, noise_fbm(u, v, 7, 5, 0.6f, 52));
            stone = vec3_lerp(stone, rgb255(150, 148, 112), lichen * 0.3f);
            Vec3 mortar =
                vec3_scale(rgb255(150, 140, 120), 0.85f + 0.15f * noise_fbm(u, v, 50, 2, 0.5f, 53));
            canvas_set(c, x, y, vec3_lerp(mortar, stone, body), height);
        }
    }
    canvas_shade_cavities(c, 5, 21);
}

void paint_carved(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float warp = noise_fbm(u, v, 3, 3, 0.5f, 61);
            float bed = noise_fbm_stretched(u + 0.03f * warp, v + 0.05f * warp, 2, 9, 4, 0.5f, 62);
            float cloud = noise_fbm(u, v, 3, 4, 0.5f, 63), grain = noise_fbm(u, v, 48, 2, 0.6f, 64);
            NoiseCell cell = noise_cells(u, v, 22, 1, 65);
            float pit = noise_random(cell.id, 1, 66) > 0.9f
                            ? 1 - float_smooth(0.08f, 0.22f, cell.nearest)
                            : 0;
            Vec3 stone = vec3_lerp(rgb255(178, 168, 148), rgb255(158, 141, 112),
                                   float_clamp(0.5f + 0.7f * bed, 0, 1));
            stone = vec3_scale(stone, 1 + 0.09f * cloud + 0.05f * grain - 0.12f * pit);
            float damp = float_smooth(0.2f, 0.6f, noise_fbm(u, v, 4, 4, 0.55f, 67));
            stone = vec3_lerp(stone, rgb255(118, 114, 100), damp * 0.35f);
            canvas_set(c, x, y, stone,
                       0.0011f * grain + 0.0022f * cloud + 0.0012f * bed - 0.0012f * pit);
        }
    }
    canvas_shade_cavities(c, 4, 60);
}

// Inlay of a floor tile: signed, positive where cream clay fills the pattern. p in -1..1.
static float tile_motif(int kind, float px, float py) {
    float r = sqrtf(px * px + py * py), a = atan2f(py, px);
    switch (kind) {
    case 0: { // quatrefoil in a ring
        float lobes = 0.46f + 0.17f * cosf(4 * a);
        float foil = fabsf(r - lobes) - 0.065f, ring = fabsf(r - 0.84f) - 0.05f;
        float dot = r - 0.15f;
        return -fminf(fminf(foil, ring), dot);
    }
    case 1: { // eight-pointed star
        float star = 0.52f + 0.2f * cosf(8 * a), inner = 0.27f + 0.08f * cosf(8 * a + PI_F);
        float shape = fmaxf(r - star, inner - r);
        float corner = fabsf(px) + fabsf(py) - 1.55f;
        return -fminf(shape, -corner);
    }
    default: { // quarter arcs that join four tiles into circles
        float best = -1;
        for (int k = 0; k < 4; k++) {
            float cx = (k & 1) ? 1.0f : -1.0f, cy = (k & 2) ? 1.0f : -1.0f;
            float d = sqrtf((px - cx) * (px - cx) + (py - cy) * (py - cy));
            best = fmaxf(best, 0.07f - fabsf(d - 0.85f));
            best = fmaxf(best, 0.05f - fabsf(d - 0.55f));
        }
        return fmaxf(best, 0.16f - (fabsf(px) + fabsf(py)));
    }
    }
}

void paint_floor(Canvas *c) {
    int n = c->size, tiles = 6;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float wx = noise_fbm(u, v, 24, 2, 0.5f, 71) * 0.0016f;
            float tu = (u + wx) * (float)tiles, tv = (v - wx) * (float)tiles;
            int ix = ((int)floorf(tu) + tiles) % tiles, iy = ((int)floorf(tv) + tiles) % tiles;
            float px = (tu - floorf(tu)) * 2 - 1, py = (tv - floorf(tv)) * 2 - 1;
            uint32_t id = (uint32_t)(iy * tiles + ix);
            float tone = noise_random(id, 1, 72);
            float edge = (1 - fmaxf(fabsf(px), fabsf(py))) * 0.125f; // metres
            float body = float_smooth(0.003f, 0.009f, edge);
            float rough = noise_fbm(u, v, 16, 5, 0.6f, 73), fine = noise_fbm(u, v, 64, 2, 0.6f, 74);
            // Two rows of plain dark tiles cross; figured tiles fill the squares between.
            bool dark = ix % 3 == 0 || iy % 3 == 0;
            bool crossing = ix % 3 == 0 && iy % 3 == 0;
            Vec3 clay = vec3_scale(rgb255(142, 74, 50), 0.82f + 0.3f * tone);
            Vec3 cream = vec3_scale(rgb255(196, 168, 118), 0.92f + 0.12f * tone);
            Vec3 glaze = vec3_scale(rgb255(50, 58, 52), 0.8f + 0.5f * tone);
            float inlay;
            Vec3 ground;
            if (crossing) {
                ground = clay;
                inlay = tile_motif(1, px, py);
            } else if (dark) {
                ground = glaze;
                inlay = -1;
            } else {
                ground = clay;
                inlay = tile_motif((ix / 3 + iy / 3) % 2 ? 0 : 2, px, py);
            }
            float worn = float_smooth(-0.1f, 0.45f, noise_fbm(u, v, 5, 5, 0.55f, 75));
            float mask = float_smooth(-0.02f, 0.03f, inlay + 0.02f * fine) * (1 - 0.55f * worn);
            Vec3 col = vec3_lerp(ground, cream, mask);
            col = vec3_lerp(col, rgb255(120, 92, 70), worn * 0.30f);
            col = vec3_scale(col, 1 + 0.14f * rough + 0.05f * fine);
            Vec3 grout = vec3_scale(rgb255(92, 84, 72), 1 + 0.2f * fine);
            float tilt =
                px * (noise_random(id, 2, 76) - 0.5f) + py * (noise_random(id, 3, 77) - 0.5f);
            float height = body * (0.0045f + 0.0016f * tilt + 0.0018f * (tone - 0.5f)) +
                           0.0007f * rough * body + 0.0003f * fine - 0.0003f * mask;
            canvas_set(c, x, y, vec3_lerp(grout, col, body), height);
        }
    }
    canvas_shade_cavities(c, 3, 60);
}

void paint_roof(Canvas *c) {
    int n = c->size, columns = 6, rows = 4;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float tu = (u + 0.002f * noise_fbm(u, v, 12, 2, 0.5f, 81)) * (float)columns;
            int column = ((int)floorf(tu) + columns) % columns;
            float px = tu - floorf(tu); // cover tile in the middle, pans at both sides
            bool cover = px > 0.24f && px < 0.76f;
            uint32_t seed = (uint32_t)column * 2 + (cover ? 1 : 0);
            if (!cover && px > 0.5f) seed = (uint32_t)((column + 1) % columns) * 2;
            float slip = 0.16f * (noise_random(seed, 1, 82) - 0.5f) + (cover ? 0.0f : 0.5f);
            float tv = v * (float)rows + slip;
            int row = ((int)floorf(tv) % rows + rows) % rows;
            float py = tv - floorf(tv); // 0 at the upper end, 1 at the lower lip (image down)
            uint32_t id = seed * 16 + (uint32_t)row;
            float tone = noise_random(id, 2, 83), hue = noise_random(id, 3, 84);
            float across = cover ? (px - 0.5f) / 0.26f : (px < 0.5f ? px : px - 1) / 0.24f;
            float dome = sqrtf(float_clamp(1 - across * across, 0, 1));
            float height = cover ? 0.03f + 0.05f * dome : 0.018f - 0.018f * dome;
            height += 0.016f * py;
            float lip = 1 - float_smooth(0.0f, 0.05f, 1 - py);
            float shadow = 1 - 0.55f * (1 - float_smooth(0.0f, 0.16f, py));
            float rough = noise_fbm(u, v, 14, 5, 0.6f, 85);
            Vec3 clay = vec3_lerp(rgb255(152, 84, 58), rgb255(126, 84, 64), hue);
            if (noise_random(id, 4, 86) > 0.86f) clay = rgb255(106, 84, 72);
            clay = vec3_scale(clay, (0.74f + 0.38f * tone) * (1 + 0.16f * rough) * shadow);
            clay = vec3_scale(clay, cover ? 1.0f : 0.62f + 0.2f * fabsf(across));
            float moss = float_smooth(0.12f, 0.5f, noise_fbm(u, v, 6, 5, 0.6f, 87));
            clay = vec3_lerp(clay, rgb255(82, 86, 66), moss * (cover ? 0.35f : 0.6f));
            clay = vec3_lerp(clay, rgb255(176, 128, 98), lip * 0.25f);
            canvas_set(c, x, y, clay, height + 0.0025f * rough);
        }
    }
    canvas_shade_cavities(c, 6, 9);
}

void paint_gravel(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float patch = noise_fbm(u, v, 4, 3, 0.5f, 91);
            NoiseCell big = noise_cells(u, v, 34, 0.9f, 92), small = noise_cells(u, v, 66, 1, 93);
            bool use_big = noise_random(big.id, 1, 94) > 0.45f && big.nearest < 0.5f;
            NoiseCell s = use_big ? big : small;
            float dome = float_clamp(1 - s.nearest * (use_big ? 1.9f : 1.6f), 0, 1);
            float gap = float_smooth(0.02f, 0.16f, s.second - s.nearest);
            float height = sqrtf(dome) * gap * (use_big ? 0.012f : 0.006f);
            float tone = noise_random(s.id, 2, 95), hue = noise_random(s.id, 3, 96);
            Vec3 stone = vec3_lerp(rgb255(150, 142, 126), rgb255(134, 116, 94), hue);
            if (hue > 0.9f) stone = rgb255(112, 112, 114);
            stone = vec3_scale(stone, 0.72f + 0.42f * tone + 0.1f * patch);
            Vec3 sand = rgb255(96, 86, 70);
            canvas_set(c, x, y, vec3_lerp(sand, stone, gap * float_smooth(0.0f, 0.3f, dome)),
                       height + 0.004f * patch);
        }
    }
    canvas_shade_cavities(c, 3, 55);
}
