// systems_visibility.c: culling against its plain twin.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>

// One sphere, one plane at a time, in the same order of operations.
static u32 cull_plainly(const Frustum *frustum, const f32 *x, const f32 *y, const f32 *z,
                        const f32 *radius, u32 count, u32 *out) {
    u32 visible = 0;
    for (u32 i = 0; i < count; i++) {
        bool inside = radius[i] >= 0.0f;
        for (u32 p = 0; p < frustum->count && inside; p++) {
            const f32 *plane = frustum->planes[p];
            f32 distance = x[i] * plane[0] + y[i] * plane[1] + z[i] * plane[2] + plane[3];
            inside = distance >= -radius[i];
        }
        if (inside) out[visible++] = i;
    }
    return visible;
}

static Frustum perspective_frustum(Mat4 *matrix) {
    *matrix = mat4_perspective_reversed(1.1f, 16.0f / 9.0f, 0.1f);
    return frustum_from_matrix(matrix);
}

TEST(systems_visibility, frustum_planes_are_unit_and_bound_the_clip_volume) {
    Mat4 matrix;
    Frustum frustum = perspective_frustum(&matrix);
    assert_int_equal(frustum.count, 5); // no far plane
    for (u32 p = 0; p < 5; p++) {
        const f32 *n = frustum.planes[p];
        ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 1e-6);
    }
    const u64 seed = 0x5EED1;
    u32 inside_count = 0;
    for (u32 i = 0; i < 20000; i++) {
        Vec4 p = {random_range(seed, 1, i, -20, 20), random_range(seed, 2, i, -10, 10),
                  random_range(seed, 3, i, -20, 2), 1};
        Vec4 clip = mat4_mul_vec4(matrix, p);
        f32 margin = 1e-3f, least = INFINITY;
        for (u32 k = 0; k < 5; k++) {
            const f32 *n = frustum.planes[k];
            least = MIN(least, n[0] * p.x + n[1] * p.y + n[2] * p.z + n[3]);
        }
        bool inside =
            clip.w > 0 && fabsf(clip.x) <= clip.w && fabsf(clip.y) <= clip.w && clip.z <= clip.w;
        if (least > margin) assert_true(inside);
        if (least < -margin) assert_false(inside);
        inside_count += inside;
    }
    assert_in_range(inside_count, 1000, 19000);
    Mat4 box = mat4_ortho_reversed(-1, 1, -1, 1, 0, 10);
    assert_int_equal(frustum_from_matrix(&box).count, 6); // a far plane that exists
}

TEST(systems_visibility, culling_equals_its_plain_twin) {
    const u64 seed = 0x5EED2;
    printf("seed %llx\n", (unsigned long long)seed);
    enum { CAP = 1024 };
    static f32 columns[4][CAP] __attribute__((aligned(64)));
    static u32 fast[CAP], plain[CAP];
    Mat4 matrix;
    Frustum frustum = perspective_frustum(&matrix);
    Mat4 box = mat4_ortho_reversed(-4, 4, -4, 4, -10, 10);
    Frustum six = frustum_from_matrix(&box), none = {.count = 0};
    const Frustum *frusta[] = {&frustum, &six, &none};
    u32 seen = 0;
    for (u32 round = 0; round < 600; round++) {
        u32 count = random_u32(seed, 9, round) % (CAP - 8);
        if (round < 20) count = round; // every tail
        for (u32 i = 0; i < CAP; i++) {
            u64 c = (u64)round * CAP + i;
            columns[0][i] = random_range(seed, 1, c, -12, 12);
            columns[1][i] = random_range(seed, 2, c, -8, 8);
            columns[2][i] = random_range(seed, 3, c, -12, 4);
            columns[3][i] = random_range(seed, 4, c, -0.3f, 2);
            if (random_u32(seed, 5, c) % 97 == 0) columns[i % 4][i] = NAN;
        }
        const Frustum *f = frusta[round % 3];
        u32 a = cull_spheres(f, columns[0], columns[1], columns[2], columns[3], count, fast);
        u32 b = cull_plainly(f, columns[0], columns[1], columns[2], columns[3], count, plain);
        // NaN in a place: with no planes nothing looks at the place, so the plain twin keeps it.
        if (f->count == 0) {
            u32 kept = 0;
            for (u32 i = 0; i < b; i++) {
                u32 row = plain[i];
                f32 sum = columns[0][row] + columns[1][row] + columns[2][row];
                if (sum == sum) plain[kept++] = row;
            }
            b = kept;
        }
        assert_int_equal(a, b);
        assert_memory_equal(fast, plain, a * sizeof(u32));
        seen += a;
    }
    assert_true(seen > 10000);
}
