// Painters of what grows: grass, hedge, bark, wood and the four alpha-masked leaf cards.
//
// Data in: an empty Canvas. Data out: colour, height and, for cards, alpha. Called through the
// table in texture.c. Leaf cards keep a clear border, so that neighbouring repeats never bleed.
#include "noise.h"
#include "paint.h"

static float pick(int i, int salt, uint32_t seed) {
    return noise_random((uint32_t)i, (uint32_t)salt, seed);
}

void paint_grass(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            float u = (float)x / (float)n, v = (float)y / (float)n;
            float f = noise_fbm(u, v, 20, 3, 0.6f, 101);
            canvas_set(c, x, y, vec3_scale(rgb255(40, 44, 26), 1 + 0.3f * f), 0);
        }
    for (int i = 0; i < 9000; i++) {
        float x = pick(i, 1, 102) * (float)n, y = pick(i, 2, 102) * (float)n;
        float patch = noise_fbm(x / (float)n, y / (float)n, 4, 4, 0.55f, 103);
        float dry = pick(i, 4, 102) < 0.12f + 0.1f * patch ? 0.8f : 0.25f * pick(i, 5, 102);
        Vec3 root = vec3_lerp(rgb255(40, 54, 26), rgb255(70, 66, 36), dry);
        Vec3 tip = vec3_lerp(rgb255(74, 102, 44), rgb255(128, 118, 70), dry);
        float tone = 0.75f + 0.4f * pick(i, 6, 102) + 0.22f * patch;
        LeafBrush blade = {x,
                           y,
                           pick(i, 3, 102) * 2 * PI_F,
                           10 + 16 * pick(i, 7, 102),
                           2.2f + 1.6f * pick(i, 8, 102),
                           0.8f,
                           0.022f * pick(i, 9, 102),
                           0.006f,
                           vec3_scale(root, tone),
                           vec3_scale(tip, tone)};
        canvas_leaf(c, &blade, true);
    }
    for (int i = 0; i < 70; i++) { // clover, three leaflets each
        float x = pick(i, 1, 105) * (float)n, y = pick(i, 2, 105) * (float)n;
        float turn = pick(i, 3, 105) * 6.28f;
        for (int k = 0; k < 3; k++) {
            LeafBrush leaf = {x,
                              y,
                              turn + (float)k * 2.094f,
                              7,
                              6,
                              0,
                              0.02f,
                              0.004f,
                              rgb255(58, 84, 44),
                              rgb255(80, 110, 62)};
            canvas_leaf(c, &leaf, true);
        }
    }
    canvas_shade_cavities(c, 4, 32);
}

void paint_hedge(Canvas *c) {
    int n = c->size;
    for (int i = 0; i < n * n; i++) canvas_set(c, i % n, i / n, rgb255(14, 20, 11), 0);
    for (int i = 0; i < 2600; i++) {
        float depth = pick(i, 4, 111);
        float x = pick(i, 1, 111) * (float)n, y = pick(i, 2, 111) * (float)n;
        float tone = (0.45f + 0.6f * depth) * (0.8f + 0.35f * pick(i, 5, 111));
        bool young = pick(i, 6, 111) > 0.9f;
        Vec3 green = young ? rgb255(96, 118, 52) : rgb255(50, 76, 36);
        LeafBrush leaf = {x,
                          y,
                          pick(i, 3, 111) * 2 * PI_F,
                          9 + 5 * pick(i, 7, 111),
                          5.5f + 2 * pick(i, 8, 111),
                          0.15f,
                          0.03f * depth,
                          0.006f,
                          vec3_scale(green, tone * 0.8f),
                          vec3_scale(green, tone * 1.1f)};
        canvas_leaf(c, &leaf, true);
    }
    canvas_shade_cavities(c, 4, 22);
}

void paint_bark(Canvas *c) {
    int n = c->size;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            float u = (float)x / (float)n, v = (float)y / (float)n;
            float warp = noise_fbm(u, v, 4, 3, 0.5f, 121) * 0.06f;
            float ridge = 1 - fabsf(noise_fbm_stretched(u + warp, v, 9, 3, 3, 0.5f, 122)) * 2;
            float rough = noise_fbm(u, v, 16, 3, 0.6f, 123);
            Vec3 bark = vec3_lerp(rgb255(92, 76, 60), rgb255(48, 38, 30), float_clamp(ridge, 0, 1));
            canvas_set(c, x, y, vec3_scale(bark, 1 + 0.25f * rough),
                       -0.012f * float_clamp(ridge, 0, 1) + 0.003f * rough);
        }
    canvas_shade_cavities(c, 3, 30);
}

void paint_wood(Canvas *c) {
    int n = c->size, planks = 5;
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < n; x++) {
            float u = ((float)x + 0.5f) / (float)n, v = ((float)y + 0.5f) / (float)n;
            float pu = u * (float)planks;
            int plank = (int)pu;
            float px = pu - (float)plank;
            uint32_t id = (uint32_t)plank;
            float shift = noise_random(id, 1, 131), tone = noise_random(id, 2, 131);
            float edge = fminf(px, 1 - px) * c->tile_m / (float)planks;
            float body = float_smooth(0.0015f, 0.007f, edge);
            // Rings: distance from a heart line that wanders; a knot pulls the rings around it.
            float wander = noise_fbm_stretched(u, v, 2, 3, 3, 0.5f, 132 + id) * 0.5f;
            float kx = px - 0.3f - 0.4f * shift;
            float ky = v - noise_random(id, 3, 131);
            ky -= roundf(ky);
            float knot = expf(-(kx * kx * 40 + ky * ky * 700));
            float ring = (px - 0.5f + 0.35f * shift + wander * 0.5f + knot * 0.8f) * 11;
            float grain = 0.5f + 0.5f * sinf(ring * 2 * PI_F + wander * 8);
            float fiber = noise_fbm_stretched(u, v, 110, 5, 3, 0.6f, 133);
            float crack = float_smooth(
                0.42f, 0.6f, noise_fbm_stretched(u + 0.002f * fiber, v, 36, 2, 2, 0.5f, 134));
            Vec3 wood = vec3_lerp(rgb255(120, 84, 54), rgb255(82, 54, 34), grain);
            wood = vec3_scale(wood, (0.72f + 0.35f * tone) * (1 + 0.16f * fiber));
            wood = vec3_lerp(wood, rgb255(44, 28, 18), knot * 0.75f);
            float grey = float_smooth(-0.2f, 0.5f, noise_fbm_stretched(u, v, 4, 2, 4, 0.5f, 135));
            wood = vec3_lerp(wood, rgb255(98, 90, 80), grey * 0.28f);
            wood = vec3_scale(wood, (0.35f + 0.65f * body) * (1 - 0.55f * crack));
            canvas_set(c, x, y, wood,
                       body * 0.006f + 0.0008f * fiber - 0.0007f * grain - 0.003f * crack +
                           0.0015f * knot);
        }
    }
    canvas_shade_cavities(c, 3, 45);
}

void paint_leaf_cypress(Canvas *c) {
    float n = (float)c->size;
    // Many upright sprays that fan out from a stem: a cypress is all scales, no flat leaves.
    for (int i = 0; i < 420; i++) {
        float along = pick(i, 1, 141), side = pick(i, 2, 141) * 2 - 1;
        float half = 0.40f * sqrtf(along) * (1.1f - 0.75f * along);
        float x = n * (0.5f + side * half), y = n * (0.965f - 0.78f * along);
        float tone = (0.55f + 0.6f * pick(i, 3, 141)) * (1 - 0.3f * fabsf(side));
        LeafBrush spray = {x,
                           y,
                           -PI_F / 2 + side * 0.75f + (pick(i, 5, 141) - 0.5f) * 0.6f,
                           18 + 20 * pick(i, 4, 141),
                           4.5f + 3 * pick(i, 6, 141),
                           0.7f,
                           0.02f * pick(i, 7, 141),
                           0.004f,
                           vec3_scale(rgb255(34, 50, 32), tone),
                           vec3_scale(rgb255(66, 92, 54), tone)};
        canvas_leaf(c, &spray, false);
    }
}

// A leaf with a toothed look: a broad ellipse and two smaller ones at its sides.
static void lobed_leaf(Canvas *c, float x, float y, float angle, float length, float height,
                       Vec3 root, Vec3 end, float spread) {
    for (int k = -2; k <= 2; k++) {
        float part = k == 0 ? 1.0f : (k == 1 || k == -1 ? 0.8f : 0.55f);
        LeafBrush lobe = {x,
                          y,
                          angle + (float)k * spread,
                          length * part,
                          length * 0.5f * part,
                          0.5f,
                          height,
                          0.004f,
                          root,
                          end};
        canvas_leaf(c, &lobe, false);
    }
}

void paint_leaf_rose(Canvas *c) {
    float n = (float)c->size;
    for (int i = 0; i < 110; i++) {
        float a = pick(i, 1, 151) * 2 * PI_F, r = 0.37f * sqrtf(pick(i, 2, 151));
        float tone = 0.6f + 0.55f * pick(i, 3, 151), h = 0.02f * pick(i, 4, 151);
        float x = n * (0.5f + r * cosf(a)), y = n * (0.5f + r * sinf(a));
        LeafBrush leaf = {x,
                          y,
                          a + (pick(i, 5, 151) - 0.5f) * 2.2f,
                          20 + 8 * pick(i, 6, 151),
                          13,
                          0.35f,
                          h,
                          0.005f,
                          vec3_scale(rgb255(40, 66, 34), tone),
                          vec3_scale(rgb255(74, 104, 52), tone)};
        canvas_leaf(c, &leaf, false);
    }
    for (int i = 0; i < 7; i++) { // blossoms: rings of petals, the inner ones above the outer
        float a = (float)i * 2.4f, r = 0.31f * sqrtf(((float)i + 0.6f) / 7);
        float x = n * (0.5f + r * cosf(a)), y = n * (0.5f + r * sinf(a));
        Vec3 deep = i % 3 == 0 ? rgb255(150, 118, 112) : rgb255(112, 18, 30);
        Vec3 pale = i % 3 == 0 ? rgb255(206, 178, 166) : rgb255(176, 44, 56);
        for (int ring = 0; ring < 3; ring++)
            for (int k = 0; k < 6; k++) {
                float turn = (float)k * 1.047f + (float)ring * 0.6f;
                LeafBrush petal = {x,
                                   y,
                                   turn,
                                   13.5f - 3.6f * (float)ring,
                                   11 - 2.5f * (float)ring,
                                   0,
                                   0.03f + 0.006f * (float)ring,
                                   0.003f,
                                   deep,
                                   vec3_scale(pale, 1 - 0.12f * (float)ring)};
                canvas_leaf(c, &petal, false);
            }
    }
}

void paint_leaf_ivy(Canvas *c) {
    float n = (float)c->size;
    for (int i = 0; i < 62; i++) {
        float x = n * (0.09f + 0.82f * pick(i, 1, 161)), y = n * (0.06f + 0.76f * pick(i, 2, 161));
        float tone = 0.55f + 0.6f * pick(i, 3, 161);
        lobed_leaf(c, x, y, PI_F / 2 + (pick(i, 4, 161) - 0.5f) * 1.4f, 20 + 8 * pick(i, 5, 161),
                   0.03f * pick(i, 6, 161), vec3_scale(rgb255(62, 84, 46), tone),
                   vec3_scale(rgb255(38, 62, 32), tone), 0.75f);
    }
}

void paint_leaf_fern(Canvas *c) {
    float n = (float)c->size;
    for (int f = 0; f < 7; f++) {
        float lean = ((float)f - 3) * 0.30f;
        for (int i = 0; i < 26; i++) {
            float t = (float)i / 25, bend = lean * (0.4f + 0.8f * t);
            float x = n * 0.5f + sinf(bend) * t * n * 0.50f;
            float y = n * 0.97f - cosf(bend) * t * n * 0.86f;
            float len = (0.35f + 1.2f * sinf(PI_F * (0.15f + 0.85f * t))) * 15;
            float tone = 0.7f + 0.4f * pick(f, i, 171);
            for (int side = -1; side <= 1; side += 2) {
                LeafBrush leaf = {x,
                                  y,
                                  -PI_F / 2 + bend + (float)side * 0.95f,
                                  len,
                                  6,
                                  0.6f,
                                  0.02f * pick(f, 9, 171),
                                  0.003f,
                                  vec3_scale(rgb255(44, 74, 36), tone),
                                  vec3_scale(rgb255(86, 122, 56), tone)};
                canvas_leaf(c, &leaf, false);
            }
        }
    }
}
