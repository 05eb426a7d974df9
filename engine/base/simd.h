// simd.h: 8-wide vectors on GCC vector extensions; no intrinsics, no -march=native.
//
// A hot loop is written once on f32x8 and marked SIMD_CLONES: GCC then compiles it for SSE2,
// AVX2 and AVX-512 and picks at load time (function multiversioning). All three give the same
// bits: no contraction (-ffp-contract=off), no reassociation.
#ifndef LUZ_SIMD_H
#define LUZ_SIMD_H
#include "base.h"

typedef f32 f32x8 __attribute__((vector_size(32), aligned(32), may_alias));
typedef i32 i32x8 __attribute__((vector_size(32), aligned(32), may_alias));

// ThreadSanitizer and clang cannot follow the resolver; they get the plain function.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) &&                             \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
// Whether the clone that runs here can shuffle the lanes of a vector by a variable in one
// instruction; without, a shuffle is many.
#define SIMD_HAS_SHUFFLE (__builtin_cpu_supports("avx2") != 0)
#else
#define SIMD_CLONES
#define SIMD_HAS_SHUFFLE false
#endif

// A macro: a function that returns a vector would have another ABI in each clone.
#define f32x8_set(x) ((f32)(x) - (f32x8){0})
// One bit a lane, from a comparison result (all ones or zero in each lane).
static inline u32 i32x8_mask(i32x8 v) {
    u32 bits = 0;
    for (u32 lane = 0; lane < 8; lane++) bits |= (u32)(v[lane] & 1) << lane;
    return bits;
}
#endif
