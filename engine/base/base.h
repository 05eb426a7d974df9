// base.h: the words every file uses. Data in, data out: none; this header only names things.
//
// Conventions of the whole engine (stated here once, every name follows them):
//   right-handed, y up, metres; view space looks down -z; clip depth 0..1, reversed (near 1, far 0);
//   matrices are column-major float[16], column vectors (clip = projection * view * world * p);
//   colour is linear RGB inside, sRGB only at the edges; angles are radians in code (_rad where in
//   doubt), degrees in level text and in columns whose unit says "deg".
//   Suffixes: _count _cap _px _ms _rad _ws (world space) _vs (view space) _ndc.
#ifndef LUZ_BASE_H
#define LUZ_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef uint8_t u8;
typedef uint16_t u16;
typedef uint32_t u32;
typedef uint64_t u64;
typedef int8_t i8;
typedef int16_t i16;
typedef int32_t i32;
typedef int64_t i64;
typedef float f32;
typedef double f64;

#define COUNT_OF(a)      (sizeof(a) / sizeof((a)[0]))
#define MIN(a, b)        ((a) < (b) ? (a) : (b))
#define MAX(a, b)        ((a) > (b) ? (a) : (b))
#define CLAMP(x, lo, hi) ((x) < (lo) ? (lo) : (x) > (hi) ? (hi) : (x))
#define KIB(n)           ((u64)(n) << 10)
#define MIB(n)           ((u64)(n) << 20)
#define GIB(n)           ((u64)(n) << 30)
#define ALIGN_UP(x, a)   (((x) + ((a)-1)) & ~(u64)((a)-1))

// SoA columns and packet sections start on cache lines and are padded to the SIMD width.
#define CACHE_LINE 64
#define SIMD_WIDTH 8

// A view of bytes owned by somebody else.
typedef struct Bytes {
    const void *data;
    u64 size;
} Bytes;

// Impossible states stop the program with file:line, in release builds as well. Never for bad
// data from outside: that is a diagnostic and a false.
__attribute__((noreturn)) void luz_assert_fail(const char *expression, const char *file, int line);
#define LUZ_ASSERT(x) ((x) ? (void)0 : luz_assert_fail(#x, __FILE__, __LINE__))

#define PRINTF_LIKE(format_index, first) __attribute__((format(printf, format_index, first)))

#ifdef __cplusplus
}
#endif
#endif
