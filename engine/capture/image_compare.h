// image_compare.h: how different two pictures are, in the numbers that people use.
//
// Pictures are RGBA8, sRGB encoded, rows from the top; alpha is ignored. Memory comes from scratch
// and is given back.
#ifndef LUZ_IMAGE_COMPARE_H
#define LUZ_IMAGE_COMPARE_H
#include "../base/arena.h"

typedef struct ImageDifference {
    u32 different_pixels; // any channel
    u32 max;              // largest difference of a channel, 0..255
    u32 max_x, max_y;     // where (the first one)
    f64 mean;             // over all channels of all pixels, 0..255
    f64 psnr;             // dB over RGB; INFINITY for equal pictures
    // Structural similarity of the luma, 11x11 Gaussian window, sigma 1.5 (Wang, Bovik, Sheikh,
    // Simoncelli 2004, section III.B); 1 for equal pictures. At the rims the window is cut.
    f64 ssim;
    // Mean of LDR-FLIP (Andersson et al. 2020) at 67 pixels per degree; 0 for equal pictures.
    f64 flip;
} ImageDifference;

ImageDifference image_compare(const u8 *a, const u8 *b, u32 width, u32 height, Arena *scratch);

// A picture of the differences into out (RGBA8): the largest channel difference, times gain,
// as brightness from black over red and yellow to white.
void image_difference_picture(const u8 *a, const u8 *b, u32 width, u32 height, f32 gain, u8 *out);

// LDR-FLIP's error of every pixel (0..1) into out; `reference` is the one that is right.
// Returns the mean. pixels_per_degree 0 = 67.02 (0.7 m from a 0.7 m wide screen of 3840 pixels).
f64 image_flip(const u8 *reference, const u8 *test, u32 width, u32 height, f32 pixels_per_degree,
               f32 *out, Arena *scratch);

// Box-filtered RGB8 copy of any size (in sRGB values: for looking at, not for measuring).
void image_reduce(const u8 *rgba, u32 width, u32 height, u8 *rgb, u32 out_width, u32 out_height);
#endif
