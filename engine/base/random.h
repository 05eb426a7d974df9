// random.h: counter-based random numbers: a pure function of (seed, stream, counter).
//
// No state, so any thread can draw number n of stream s in any order and replays agree.
// Not cryptographic. Mixer: two rounds of the murmur3/splitmix 64-bit finaliser.
#ifndef LUZ_RANDOM_H
#define LUZ_RANDOM_H
#include "base.h"

static inline u64 random_u64(u64 seed, u64 stream, u64 counter) {
    u64 x = seed * 0x9E3779B97F4A7C15ull + stream;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    x ^= (x >> 31) ^ (counter * 0xD1B54A32D192ED03ull);
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
}
static inline u32 random_u32(u64 seed, u64 stream, u64 counter) {
    return (u32)(random_u64(seed, stream, counter) >> 32);
}
// Uniform in [0, 1), 24 bits.
static inline f32 random_f32(u64 seed, u64 stream, u64 counter) {
    return (f32)(random_u64(seed, stream, counter) >> 40) * 0x1p-24f;
}
static inline f32 random_range(u64 seed, u64 stream, u64 counter, f32 lo, f32 hi) {
    return lo + (hi - lo) * random_f32(seed, stream, counter);
}
#endif
