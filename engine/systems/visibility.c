// visibility.c: which spheres touch the view.
// Data in: a world-to-clip matrix; columns of sphere centres and radii. Data out: the indices of
// those that touch the frustum, ascending. Called by: packet_build (drawables, lights, shadow
// casters); any thread. Does not: test boxes or occluders; a sphere near a frustum's edge may pass
// although it lies outside (planes are tested one by one), never the other way.
#include "systems.h"
#include "../base/simd.h"
#include <string.h>

// Planes of the clip volume as rows of the matrix (Gribb and Hartmann 2001, "Fast extraction of
// viewing frustum planes"), for depth 0..1 reversed: near is z <= w, far is z >= 0. With an
// infinite far plane the far row has no direction and is left out.
Frustum frustum_from_matrix(const Mat4 *view_projection) {
    const f32 *m = view_projection->m;
    Frustum frustum = {.count = 0};
    static const f32 combinations[6][4] = {// of rows x, y, z, w
                                           {1, 0, 0, 1},  {-1, 0, 0, 1}, {0, 1, 0, 1},
                                           {0, -1, 0, 1}, {0, 0, -1, 1}, {0, 0, 1, 0}};
    for (u32 i = 0; i < COUNT_OF(combinations); i++) {
        const f32 *c = combinations[i];
        f32 plane[4];
        for (u32 k = 0; k < 4; k++)
            plane[k] =
                c[0] * m[k * 4] + c[1] * m[k * 4 + 1] + c[2] * m[k * 4 + 2] + c[3] * m[k * 4 + 3];
        f32 length = sqrtf(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
        if (!(length > 0.0f)) continue;
        for (u32 k = 0; k < 4; k++) frustum.planes[frustum.count][k] = plane[k] / length;
        frustum.count++;
    }
    return frustum;
}

typedef i32 i32x4 __attribute__((vector_size(16), may_alias));
typedef i32 i32x4_unaligned __attribute__((vector_size(16), aligned(4), may_alias));
typedef u64 u64x4 __attribute__((vector_size(32)));

// Lanes of the set bits of a nibble, packed to the front; what follows is overwritten later.
static const i32x4 packed_lanes[16] = {{0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0},
                                       {2, 0, 0, 0}, {0, 2, 0, 0}, {1, 2, 0, 0}, {0, 1, 2, 0},
                                       {3, 0, 0, 0}, {0, 3, 0, 0}, {1, 3, 0, 0}, {0, 1, 3, 0},
                                       {2, 3, 0, 0}, {0, 2, 3, 0}, {1, 2, 3, 0}, {0, 1, 2, 3}};
static const u8 bit_counts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};

// Eight lanes' results become eight bits: each lane keeps its own bit, then all are joined.
#define MASK_BITS(inside)                                                                          \
    ({                                                                                             \
        u64x4 own = (u64x4)((inside) & (i32x8){1, 2, 4, 8, 16, 32, 64, 128});                      \
        u64 joined = own[0] | own[1] | own[2] | own[3];                                            \
        (u32)(joined | joined >> 32);                                                              \
    })

SIMD_CLONES
u32 cull_spheres(const Frustum *frustum, const f32 *x, const f32 *y, const f32 *z,
                 const f32 *radius, u32 count, u32 *out) {
    u32 visible = 0, plane_count = MIN(frustum->count, 6);
    // Missing planes become one that nothing lies outside of: five tests are always made.
    f32 p[6][4] = {{0, 0, 0, 1e30f}, {0, 0, 0, 1e30f}, {0, 0, 0, 1e30f},
                   {0, 0, 0, 1e30f}, {0, 0, 0, 1e30f}, {0, 0, 0, 1e30f}};
    memcpy(p, frustum->planes, plane_count * sizeof p[0]);
    for (u32 first = 0; first < count; first += SIMD_WIDTH) {
        f32x8 cx = *(const f32x8 *)(x + first), cy = *(const f32x8 *)(y + first),
              cz = *(const f32x8 *)(z + first), r = *(const f32x8 *)(radius + first);
        f32x8 limit = -r;
        i32x8 inside = r >= 0.0f; // a NaN anywhere compares false
#define TEST_PLANE(i) inside &= cx * p[i][0] + cy * p[i][1] + cz * p[i][2] + p[i][3] >= limit
        TEST_PLANE(0);
        TEST_PLANE(1);
        TEST_PLANE(2);
        TEST_PLANE(3);
        TEST_PLANE(4);
        if (plane_count == 6) TEST_PLANE(5);
#undef TEST_PLANE
        u32 bits = MASK_BITS(inside);
        if (count - first < SIMD_WIDTH) bits &= (1u << (count - first)) - 1; // padding
        // Four indices are written at once and those that count are stepped over: no branch to
        // guess. Room: visible <= first, so the two stores end within the step's own eight slots.
        *(i32x4_unaligned *)(out + visible) = packed_lanes[bits & 15] + (i32)first;
        visible += bit_counts[bits & 15];
        *(i32x4_unaligned *)(out + visible) = packed_lanes[bits >> 4] + (i32)(first + 4);
        visible += bit_counts[bits >> 4];
    }
    return visible;
}
