// gi_filter_twin.h: the atlas of filtered light as plain loops make it, and the reading of it: the
// naive twin of shaders/gi_filter_*.glsl and of gi_sample in shaders/gi.glsl.
#ifndef LUZ_GI_FILTER_TWIN_H
#define LUZ_GI_FILTER_TWIN_H
#include "../../engine/base/base.h"

#define GI_TWIN_LEVELS_CAP 10

typedef struct GiTwin {
    u32 dims[3], cascades;        // voxels of a cascade
    bool apart, isotropic, bytes; // faces, filter, format
    bool exact;                   // images hold floats: what the filter itself does
    f32 scale;                    // radiance that 1 means in bytes
    // Made by gi_twin_filter.
    u32 block[3], levels; // level 0 of one block
    f32 *base;            // dims, cascades along z; 4 floats a voxel (faces shared)
    f32 *level[GI_TWIN_LEVELS_CAP];
} GiTwin;

// light: premultiplied radiance and opacity of every voxel, cascades along z, x first; 4 floats, or
// with faces apart 6 times 4. What an image cannot hold is rounded to what it can.
void gi_twin_filter(GiTwin *twin, const f32 *light);
void gi_twin_free(GiTwin *twin);
// Width of a level in texels, all blocks; its rows and slices are block[1] >> level, and (block[2]
// >> level) * cascades.
u32 gi_twin_width(const GiTwin *twin, u32 level);
u64 gi_twin_texels(const GiTwin *twin, u32 level);
// Encoded texel of a block at a place within it.
const f32 *gi_twin_texel(const GiTwin *twin, u32 level, u32 block, u32 x, u32 y, u32 z);
// gi_sample of the first cascade, with linear mips: p in voxels.
void gi_twin_sample(const GiTwin *twin, const f32 p[3], f32 lod, const f32 direction[3],
                    f32 out[4]);
f32 gi_twin_half(f32 value); // to the nearest half float and back
#endif
