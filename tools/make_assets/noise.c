// Tileable noise: see noise.h. Integer hashing only, so no table has to be shuffled or kept.
#include "noise.h"

#include <math.h>

uint32_t noise_hash(uint32_t a, uint32_t b, uint32_t seed) {
    uint32_t h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
    h ^= h >> 16;
    h *= 0x7FEB352Du;
    h ^= h >> 15;
    h *= 0x846CA68Bu;
    return h ^ (h >> 16);
}

float noise_random(uint32_t a, uint32_t b, uint32_t seed) {
    return (float)(noise_hash(a, b, seed) >> 8) * (1.0f / 16777216.0f);
}

static int wrap_index(int i, int period) {
    int m = i % period;
    return m < 0 ? m + period : m;
}

static float corner_dot(int ix, int iy, float fx, float fy, int px, int py, uint32_t seed) {
    uint32_t h = noise_hash((uint32_t)wrap_index(ix, px), (uint32_t)wrap_index(iy, py), seed);
    float a = (float)(h & 0xFFFF) * (6.2831853f / 65536.0f);
    return cosf(a) * fx + sinf(a) * fy;
}

float noise_gradient(float x, float y, int period_x, int period_y, uint32_t seed) {
    int ix = (int)floorf(x), iy = (int)floorf(y);
    float fx = x - (float)ix, fy = y - (float)iy;
    float u = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
    float v = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
    float a = corner_dot(ix, iy, fx, fy, period_x, period_y, seed);
    float b = corner_dot(ix + 1, iy, fx - 1, fy, period_x, period_y, seed);
    float c = corner_dot(ix, iy + 1, fx, fy - 1, period_x, period_y, seed);
    float d = corner_dot(ix + 1, iy + 1, fx - 1, fy - 1, period_x, period_y, seed);
    float ab = a + (b - a) * u, cd = c + (d - c) * u;
    return (ab + (cd - ab) * v) * 1.5f;
}

float noise_fbm_stretched(float x, float y, int cells_x, int cells_y, int octaves, float gain,
                          uint32_t seed) {
    float sum = 0, weight = 1, total = 0;
    for (int o = 0; o < octaves; o++) {
        sum += weight * noise_gradient(x * (float)cells_x, y * (float)cells_y, cells_x, cells_y,
                                       seed + (uint32_t)o * 17u);
        total += weight;
        weight *= gain;
        cells_x *= 2;
        cells_y *= 2;
    }
    return sum / total;
}

float noise_fbm(float x, float y, int cells, int octaves, float gain, uint32_t seed) {
    return noise_fbm_stretched(x, y, cells, cells, octaves, gain, seed);
}

NoiseCell noise_cells(float x, float y, int cells, float jitter, uint32_t seed) {
    float sx = x * (float)cells, sy = y * (float)cells;
    int ix = (int)floorf(sx), iy = (int)floorf(sy);
    NoiseCell r = {1e9f, 1e9f, 0};
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            uint32_t cx = (uint32_t)wrap_index(ix + dx, cells);
            uint32_t cy = (uint32_t)wrap_index(iy + dy, cells);
            float px = (float)(ix + dx) + 0.5f + (noise_random(cx, cy, seed) - 0.5f) * jitter;
            float py = (float)(iy + dy) + 0.5f + (noise_random(cx, cy, seed + 1) - 0.5f) * jitter;
            float d = sqrtf((px - sx) * (px - sx) + (py - sy) * (py - sy));
            if (d < r.nearest) {
                r.second = r.nearest;
                r.nearest = d;
                r.id = cx * 7919u + cy * 104729u + seed;
            } else if (d < r.second) {
                r.second = d;
            }
        }
    }
    return r;
}

float noise_value3(float x, float y, float z, uint32_t seed) {
    float base[3] = {floorf(x), floorf(y), floorf(z)};
    float f[3] = {x - base[0], y - base[1], z - base[2]};
    float sum = 0;
    for (int i = 0; i < 3; i++) f[i] = f[i] * f[i] * (3 - 2 * f[i]);
    for (int c = 0; c < 8; c++) {
        int dx = c & 1, dy = (c >> 1) & 1, dz = c >> 2;
        uint32_t ux = (uint32_t)((int)base[0] + dx), uy = (uint32_t)((int)base[1] + dy);
        uint32_t uz = (uint32_t)((int)base[2] + dz);
        float w = (dx ? f[0] : 1 - f[0]) * (dy ? f[1] : 1 - f[1]) * (dz ? f[2] : 1 - f[2]);
        sum += w * noise_random(ux + uz * 4099u, uy, seed);
    }
    return sum;
}
