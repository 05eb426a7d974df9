// Painters of what hands made: hammered iron, stained glass, tapestry; and the ripples of water.
//
// Data in: an empty Canvas. Data out: colour and height. Called through the table in texture.c.
// The glass images are emissive as well: their colours are those of light that passes through.
#include "noise.h"
#include "paint.h"

void paint_iron(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            float u = (float)x / (float)n, v = (float)y / (float)n;
            NoiseCell dent = noise_cells(u, v, 9, 1, 181);
            float rough = noise_fbm(u, v, 16, 4, 0.6f, 182);
            float rust = float_smooth(0.1f, 0.45f, noise_fbm(u, v, 5, 5, 0.6f, 183));
            Vec3 iron = vec3_scale(rgb255(98, 96, 94), 0.85f + 0.3f * dent.nearest + 0.15f * rough);
            iron = vec3_lerp(iron, rgb255(104, 66, 44), rust * 0.55f);
            canvas_set(c, x, y, iron,
                       0.0016f * dent.nearest * dent.nearest + 0.0003f * rough - 0.0002f * rust);
        }
}

void paint_water(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            float u = (float)x / (float)n, v = (float)y / (float)n;
            float warp = noise_fbm(u, v, 3, 3, 0.5f, 191) * 0.05f;
            float wave = noise_fbm(u + warp, v - warp, 5, 4, 0.42f, 192);
            canvas_set(c, x, y, vec3_scale(rgb255(24, 38, 42), 1 + 0.2f * wave), 0.010f * wave);
        }
}

static const unsigned char JEWELS[8][3] = {{38, 66, 196}, {196, 26, 34},  {232, 166, 40},
                                           {24, 132, 96}, {122, 40, 160}, {40, 140, 210},
                                           {226, 96, 30}, {214, 208, 178}};

static Vec3 jewel(uint32_t id, uint32_t seed) {
    const unsigned char *j = JEWELS[noise_hash(id, 1, seed) % 8];
    float tone = 0.7f + 0.4f * noise_random(id, 2, seed);
    return vec3_scale(rgb255(j[0], j[1], j[2]), tone);
}

// Lancet: a border of small panes, a field of lozenges, medallions stacked along the axis.
void paint_glass_lancet(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float streak = noise_fbm(u, v, 24, 3, 0.6f, 201);
            float lead, side = fminf(u, 1 - u);
            Vec3 glass;
            float my = v * 2 - floorf(v * 2) - 0.5f; // two medallions a repeat
            float r = sqrtf((u - 0.5f) * (u - 0.5f) + my * my * 0.25f),
                  a = atan2f(my * 0.5f, u - 0.5f);
            if (side < 0.11f) {
                float p = v * 16;
                uint32_t id = (uint32_t)p;
                lead = fminf(fminf(p - floorf(p), 1 - (p - floorf(p))) / 16, 0.11f - side);
                glass = id % 2 ? rgb255(196, 30, 36) : rgb255(226, 170, 60);
            } else if (r < 0.30f) {
                float sector = (a + PI_F) / (2 * PI_F) * 8;
                uint32_t id = (uint32_t)sector % 8 + (uint32_t)(v * 2) * 8;
                float f = sector - floorf(sector);
                float ring = r > 0.2f ? 1 : (r > 0.085f ? 2 : 3);
                lead = fminf(fabsf(r - 0.2f), fminf(fabsf(r - 0.085f), 0.30f - r));
                if (r > 0.085f) lead = fminf(lead, fminf(f, 1 - f) * r * 0.78f);
                glass = ring == 3
                            ? rgb255(236, 190, 90)
                            : (ring == 1 ? (id % 2 ? rgb255(30, 70, 200) : rgb255(40, 130, 200))
                                         : jewel(id, 203));
            } else {
                float p = (u + v * 0.5f) * 8, q = (u - v * 0.5f) * 8;
                float fp = p - floorf(p), fq = q - floorf(q);
                uint32_t id =
                    (uint32_t)((int)floorf(p) + 64) % 4 * 8 + (uint32_t)((int)floorf(q) + 64) % 4;
                lead = fminf(fminf(fminf(fp, 1 - fp), fminf(fq, 1 - fq)) / 9,
                             fminf(r - 0.30f, side - 0.11f));
                glass = noise_hash(id, 4, 204) % 5 ? rgb255(26, 52, 150) : rgb255(38, 112, 108);
                glass = vec3_scale(glass, 0.75f + 0.5f * noise_random(id, 5, 204));
            }
            float open = float_smooth(0.003f, 0.009f, lead);
            glass = vec3_scale(glass, 0.9f + 0.22f * streak);
            canvas_set(c, x, y, vec3_lerp(rgb255(10, 10, 11), glass, open),
                       0.004f * (1 - open) + 0.0004f * streak);
        }
    }
}

// Rose window: twelve petals around a hub; the stone tracery of the same plan is real geometry.
void paint_glass_rose(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float px = ((float)x + 0.5f) / (float)n * 2 - 1,
                  py = 1 - ((float)y + 0.5f) / (float)n * 2;
            float r = sqrtf(px * px + py * py), a = atan2f(py, px) / (2 * PI_F) + 0.5f;
            float streak = noise_fbm((float)x / (float)n, (float)y / (float)n, 40, 3, 0.6f, 211);
            float sector = a * 12, f = sector - floorf(sector) - 0.5f;
            uint32_t petal = (uint32_t)sector % 12;
            Vec3 glass;
            float lead;
            if (r < 0.2f) {
                lead = fminf(0.2f - r, fabsf(r - 0.09f));
                float s = a * 6;
                if (r > 0.09f) lead = fminf(lead, fminf(s - floorf(s), 1 - s + floorf(s)) * r);
                glass = r < 0.09f ? rgb255(250, 214, 120)
                                  : ((uint32_t)s % 2 ? rgb255(206, 36, 40) : rgb255(40, 80, 214));
            } else if (r < 0.72f) {
                int band = (int)((r - 0.2f) / 0.13f);
                float fr = (r - 0.2f) / 0.13f - (float)band;
                float fs = f * 2 + 0.5f - floorf(f * 2 + 0.5f);
                int half = f > 0;
                lead = fminf(fminf(fr, 1 - fr) * 0.13f, fminf(fs, 1 - fs) * r * 0.26f);
                uint32_t kind = (petal + (uint32_t)band) % 3;
                glass = kind == 0 ? rgb255(34, 62, 206)
                                  : (kind == 1 ? rgb255(198, 30, 48) : rgb255(120, 44, 172));
                if (band == 1 || band == 3)
                    glass = half ? rgb255(238, 168, 50) : rgb255(36, 150, 150);
                glass = vec3_scale(glass,
                                   0.8f + 0.35f * noise_random(petal * 8 + (uint32_t)band, 3, 212));
            } else {
                float s = a * 24, fs = s - floorf(s) - 0.5f;
                float q = sqrtf((r - 0.85f) * (r - 0.85f) + fs * fs * 0.05f);
                lead = fminf(fabsf(q - 0.09f), fabsf(r - 0.72f));
                lead = fminf(lead, (0.5f - fabsf(fs)) * r * 0.26f);
                uint32_t id = (uint32_t)s;
                glass = q < 0.09f ? (id % 2 ? rgb255(240, 180, 64) : rgb255(60, 170, 222))
                                  : (id % 2 ? rgb255(32, 48, 160) : rgb255(150, 24, 52));
            }
            float open = float_smooth(0.004f, 0.011f, lead);
            glass = vec3_scale(glass, 0.88f + 0.25f * streak);
            canvas_set(c, x, y, vec3_lerp(rgb255(8, 8, 9), glass, open), 0);
        }
    }
}

// One hanging, not a tile: border, field of stars, a tree of life with a moon above.
void paint_tapestry(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = 1 - ((float)y + 0.5f) / (float)n;
            float edge = fminf(fminf(u, 1 - u), fminf(v, 1 - v));
            Vec3 gold = rgb255(178, 134, 58), red = rgb255(104, 20, 26), blue = rgb255(26, 36, 84);
            Vec3 col = blue;
            if (edge < 0.12f) {
                float p = (u + v) * 14, q = (u - v) * 14;
                bool check = ((int)floorf(p) + (int)floorf(q)) & 1;
                col = check ? red : vec3_scale(red, 0.7f);
                float d = fabsf(p - floorf(p) - 0.5f) + fabsf(q - floorf(q) - 0.5f);
                if (d < 0.3f) col = gold;
                if (edge > 0.105f || edge < 0.015f) col = gold;
            } else {
                float su = u * 9 - floorf(u * 9) - 0.5f, sv = v * 9 - floorf(v * 9) - 0.5f;
                float a = atan2f(sv, su), r = sqrtf(su * su + sv * sv);
                if (r < 0.10f + 0.06f * cosf(5 * a)) col = rgb255(150, 140, 110);
                float trunk = fabsf(u - 0.5f) - 0.018f - 0.05f * float_smooth(0.34f, 0.16f, v);
                if (v > 0.16f && v < 0.5f && trunk < 0) col = gold;
                for (int k = 0; k < 19; k++) { // crown of round leaves on a sunflower spiral
                    float ka = (float)k * 2.399f, kr = 0.042f * sqrtf((float)k + 0.5f);
                    float dx = u - 0.5f - kr * cosf(ka), dy = v - 0.55f - kr * sinf(ka);
                    float d = sqrtf(dx * dx + dy * dy);
                    if (d < 0.027f)
                        col = k % 4 == 0 ? rgb255(150, 34, 34) : rgb255(60, 98, 52);
                    else if (d < 0.033f)
                        col = gold;
                }
                float m = sqrtf((u - 0.5f) * (u - 0.5f) + (v - 0.81f) * (v - 0.81f));
                float cut = sqrtf((u - 0.53f) * (u - 0.53f) + (v - 0.825f) * (v - 0.825f));
                if (m < 0.055f && cut > 0.045f) col = rgb255(206, 200, 170);
            }
            float warp = (float)((x + y) % 3) / 3, weft = (float)(y % 2);
            float worn = noise_fbm(u, v, 6, 4, 0.5f, 221);
            col = vec3_scale(col, 0.85f + 0.12f * warp + 0.08f * weft + 0.15f * worn);
            canvas_set(c, x, y, col, 0.002f * warp + 0.004f * noise_fbm(u, v, 4, 2, 0.5f, 222));
        }
    }
}
