// gi_filter_twin.c: see gi_filter_twin.h.
#include "gi_filter_twin.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

f32 gi_twin_half(f32 value) {
    if (!(fabsf(value) >= 0x1p-24f))
        return fabsf(value) > 0x1p-25f ? copysignf(0x1p-24f, value) : 0;
    int exponent;
    frexpf(value, &exponent);
    // 11 significant bits, fewer below the smallest normal number 2^-14.
    f32 unit = ldexpf(1.0f, MAX(exponent, -13) - 11);
    return nearbyintf(value / unit) * unit; // ties to even
}

static void store(const GiTwin *twin, f32 *texel, const f32 value[4]) {
    for (u32 i = 0; i < 4; i++) {
        f32 clamped = CLAMP(value[i], 0.0f, 1.0f);
        texel[i] = twin->exact   ? value[i]
                   : twin->bytes ? nearbyintf(clamped * 255.0f) / 255.0f
                                 : gi_twin_half(value[i]);
    }
}

static void encode(const GiTwin *twin, f32 *texel, const f32 light[4]) {
    f32 scale = twin->bytes ? 1.0f / twin->scale : 1.0f;
    f32 most = twin->bytes ? 1.0f : 65000.0f;
    store(twin, texel,
          (f32[4]){MIN(light[0] * scale, most), MIN(light[1] * scale, most),
                   MIN(light[2] * scale, most), light[3]});
}

u32 gi_twin_width(const GiTwin *twin, u32 level) {
    return (twin->block[0] >> level) * (twin->isotropic ? 1 : 6);
}
u64 gi_twin_texels(const GiTwin *twin, u32 level) {
    return (u64)gi_twin_width(twin, level) * (twin->block[1] >> level) * (twin->block[2] >> level) *
           twin->cascades;
}
static f32 *texel_of(const GiTwin *twin, u32 level, u32 block, u32 x, u32 y, u32 z) {
    u64 width = gi_twin_width(twin, level), height = twin->block[1] >> level;
    return twin->level[level] +
           4 * (block * (twin->block[0] >> level) + x + width * (y + height * z));
}
const f32 *gi_twin_texel(const GiTwin *twin, u32 level, u32 block, u32 x, u32 y, u32 z) {
    return texel_of(twin, level, block, x, y, z);
}

static void over(const f32 *front, const f32 *back, f32 out[4]) {
    for (u32 i = 0; i < 4; i++) out[i] += front[i] + back[i] * (1.0f - front[3]);
}

// Faces apart: premultiplied by a density, 1 lets 2^-10 through; as light premultiplied by its
// opacity, and back.
static void solid(const f32 texel[4], f32 out[4]) {
    f32 opacity = 1.0f - exp2f(-10.0f * texel[3]);
    for (u32 k = 0; k < 3; k++) out[k] = texel[k] * opacity / MAX(texel[3], 1e-6f);
    out[3] = opacity;
}
static void dense(f32 light[4]) {
    f32 density = MIN(log2f(MAX(1.0f - light[3], 0x1p-10f)) / -10.0f, 1.0f);
    for (u32 k = 0; k < 3; k++) light[k] *= density / MAX(light[3], 1e-6f);
    light[3] = density;
}

// children: 8, by bits 1 x, 2 y, 4 z. What leaves towards direction d (+x -x +y -y +z -z).
static void combine(const f32 *const children[8], bool isotropic, u32 d, f32 out[4]) {
    memset(out, 0, 4 * sizeof(f32));
    u32 axis = 1u << (d / 2), front_bit = d % 2 == 0 ? axis : 0;
    for (u32 i = 0; i < 8; i++) {
        if (isotropic)
            for (u32 k = 0; k < 4; k++) out[k] += children[i][k] * 0.5f;
        else if ((i & axis) == front_bit)
            over(children[i], children[i ^ axis], out);
    }
    for (u32 k = 0; k < 4; k++) out[k] *= 0.25f;
}

static u64 voxel_of(const GiTwin *twin, u32 x, u32 y, u32 z) {
    return x + (u64)twin->dims[0] * (y + (u64)twin->dims[1] * z);
}

// Level 0 with faces apart: the voxels themselves.
static void scatter(GiTwin *twin, const f32 *light) {
    for (u32 z = 0; z < twin->dims[2] * twin->cascades; z++)
        for (u32 y = 0; y < twin->dims[1]; y++)
            for (u32 x = 0; x < twin->dims[0]; x++) {
                const f32 *faces = light + voxel_of(twin, x, y, z) * 24;
                for (u32 d = 0; d < 6 && !twin->isotropic; d++)
                    encode(twin, texel_of(twin, 0, d, x, y, z), faces + 4 * d);
                if (!twin->isotropic) continue;
                f32 sum[4] = {0}, most = 0;
                for (u32 d = 0; d < 6; d++) {
                    for (u32 k = 0; k < 4; k++) sum[k] += faces[4 * d + k];
                    most = MAX(most, faces[4 * d + 3]);
                }
                for (u32 k = 0; k < 4; k++) sum[k] *= most / MAX(sum[3], 1e-6f);
                sum[3] = most;
                encode(twin, texel_of(twin, 0, 0, x, y, z), sum);
            }
}

static void make_level(GiTwin *twin, u32 level) {
    bool from_base = level == 0;
    u32 blocks = twin->isotropic ? 1 : 6;
    for (u32 z = 0; z < (twin->block[2] >> level) * twin->cascades; z++)
        for (u32 y = 0; y < twin->block[1] >> level; y++)
            for (u32 x = 0; x < twin->block[0] >> level; x++)
                for (u32 d = 0; d < blocks; d++) {
                    const f32 *children[8];
                    for (u32 i = 0; i < 8; i++) {
                        u32 cx = 2 * x + (i & 1), cy = 2 * y + (i >> 1 & 1), cz = 2 * z + (i >> 2);
                        children[i] = from_base ? twin->base + 4 * voxel_of(twin, cx, cy, cz)
                                                : texel_of(twin, level - 1, d, cx, cy, cz);
                    }
                    f32 made[4], clear[8][4];
                    bool has_density = twin->apart && !twin->isotropic;
                    for (u32 i = 0; i < 8 && has_density; i++) {
                        solid(children[i], clear[i]);
                        children[i] = clear[i];
                    }
                    combine(children, twin->isotropic, d, made);
                    if (has_density) dense(made);
                    store(twin, texel_of(twin, level, d, x, y, z), made);
                }
}

void gi_twin_filter(GiTwin *twin, const f32 *light) {
    u32 shift = twin->apart ? 0 : 1, smallest = UINT32_MAX;
    for (u32 i = 0; i < 3; i++) {
        twin->block[i] = twin->dims[i] >> shift;
        smallest = MIN(smallest, twin->block[i]);
    }
    for (twin->levels = 1; smallest >> twin->levels; twin->levels++) {
    }
    u64 voxels = (u64)twin->dims[0] * twin->dims[1] * twin->dims[2] * twin->cascades;
    for (u32 l = 0; l < twin->levels; l++)
        twin->level[l] = malloc(gi_twin_texels(twin, l) * 4 * sizeof(f32));
    if (twin->apart) {
        scatter(twin, light);
    } else {
        twin->base = malloc(voxels * 4 * sizeof(f32));
        for (u64 i = 0; i < voxels; i++) encode(twin, twin->base + 4 * i, light + 4 * i);
    }
    for (u32 l = twin->apart ? 1 : 0; l < twin->levels; l++) make_level(twin, l);
}

void gi_twin_free(GiTwin *twin) {
    free(twin->base);
    for (u32 l = 0; l < twin->levels; l++) free(twin->level[l]);
    twin->base = NULL;
    twin->levels = 0;
}

// --- Reading ---

// Trilinear within one block of size texels; at: 0..1 of it. Reads at its border end there.
static void sample_block(const GiTwin *twin, i32 level, u32 block, const f32 at[3], f32 weight,
                         f32 out[4]) {
    u32 low[3], high[3];
    f32 share[3];
    for (u32 i = 0; i < 3; i++) {
        u32 size = level < 0 ? twin->dims[i] : twin->block[i] >> level;
        f32 texel = at[i] * (f32)size - 0.5f;
        texel = CLAMP(texel, 0.0f, (f32)size - 1.0f);
        low[i] = (u32)texel;
        high[i] = MIN(low[i] + 1, size - 1);
        share[i] = texel - (f32)low[i];
    }
    for (u32 c = 0; c < 8; c++) {
        u32 p[3];
        f32 w = weight;
        for (u32 i = 0; i < 3; i++) {
            p[i] = c >> i & 1 ? high[i] : low[i];
            w *= c >> i & 1 ? share[i] : 1.0f - share[i];
        }
        const f32 *texel = level < 0 ? twin->base + 4 * voxel_of(twin, p[0], p[1], p[2])
                                     : texel_of(twin, (u32)level, block, p[0], p[1], p[2]);
        for (u32 k = 0; k < 4; k++) out[k] += texel[k] * w;
    }
}

static void sample_level(const GiTwin *twin, i32 level, const f32 at[3], const f32 direction[3],
                         f32 weight, f32 out[4]) {
    if (level < 0 || twin->isotropic) {
        sample_block(twin, level, 0, at, weight, out);
        return;
    }
    for (u32 i = 0; i < 3; i++)
        sample_block(twin, level, 2 * i + (direction[i] < 0.0f ? 0 : 1), at,
                     weight * direction[i] * direction[i], out);
}

void gi_twin_sample(const GiTwin *twin, const f32 p[3], f32 lod, const f32 direction[3],
                    f32 out[4]) {
    f32 at[3];
    for (u32 i = 0; i < 3; i++) at[i] = p[i] / (f32)twin->dims[i];
    // Level -1 is the base.
    f32 first = twin->apart ? 0.0f : -1.0f;
    f32 level = CLAMP(lod + first, first, (f32)twin->levels - 1.0f);
    f32 whole = floorf(level), share = level - whole;
    memset(out, 0, 4 * sizeof(f32));
    sample_level(twin, (i32)whole, at, direction, 1.0f - share, out);
    if (share > 0.0f) sample_level(twin, (i32)whole + 1, at, direction, share, out);
    for (u32 k = 0; k < 3 && twin->bytes; k++) out[k] *= twin->scale;
}
