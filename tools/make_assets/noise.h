// Tileable noise and a counter-based random number: the only source of chance in the generator.
//
// Data in: coordinates and a seed. Data out: floats. Called by the texture painters and by models
// that scatter or dent things. Nothing here keeps state or reads a clock, so the same call gives
// the same number in every run.
#ifndef MAKE_ASSETS_NOISE_H
#define MAKE_ASSETS_NOISE_H

#include <stdint.h>

uint32_t noise_hash(uint32_t a, uint32_t b, uint32_t seed);

// Uniform in [0, 1).
float noise_random(uint32_t a, uint32_t b, uint32_t seed);

// Gradient noise of about -1..1 that repeats after `period` cells on both axes (period >= 1).
float noise_gradient(float x, float y, int period_x, int period_y, uint32_t seed);

// Sum of octaves, each twice as fine and `gain` as strong; x and y in units of one texture (0..1),
// `cells` cells of the first octave. Result about -1..1, tileable over the unit square.
float noise_fbm(float x, float y, int cells, int octaves, float gain, uint32_t seed);
float noise_fbm_stretched(float x, float y, int cells_x, int cells_y, int octaves, float gain,
                          uint32_t seed);

// Cellular noise over the unit square. Distances are in cells.
typedef struct NoiseCell {
    float nearest, second; // distance to the nearest and the second nearest feature point
    uint32_t id;           // stable number of the nearest cell
} NoiseCell;
NoiseCell noise_cells(float x, float y, int cells, float jitter, uint32_t seed);

// Plain 3D value noise of 0..1, not tileable: for dents in geometry.
float noise_value3(float x, float y, float z, uint32_t seed);

#endif
