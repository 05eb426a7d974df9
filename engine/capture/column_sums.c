// column_sums.c: the two sums of a column by which a replay names the row that differs.
// Data in: a column's 4-byte values. Data out: a ColumnSum; and a value back from its mix.
// Called by: recording.c (each changed column of each tick), recording_check.c (at a mismatch).
// Does not: resist somebody who wants two columns to have one sum.
#include "recording_internal.h"

#define MIX_ADD 0x9E3779B97F4A7C15ull
#define MIX_1   0xBF58476D1CE4E5B9ull // odd: invertible mod 2^64
#define MIX_2   0x94D049BB133111EBull

u64 column_sum_mix(u32 value) {
    u64 x = ((u64)value ^ MIX_ADD) * MIX_1;
    x = (x ^ (x >> 32)) * MIX_2;
    return x ^ (x >> 32);
}

// Newton's iteration mod 2^64: each step doubles the number of right bits (a * a = 1 mod 8).
static u64 inverse_odd(u64 a) {
    u64 x = a;
    for (u32 i = 0; i < 5; i++) x *= 2 - a * x;
    return x;
}

bool column_sum_unmix(u64 mixed, u32 *value) {
    u64 x = (mixed ^ (mixed >> 32)) * inverse_odd(MIX_2);
    x = (x ^ (x >> 32)) * inverse_odd(MIX_1) ^ MIX_ADD;
    *value = (u32)x;
    return x <= UINT32_MAX;
}

ColumnSum column_sum(const u32 *values, u32 count) {
    ColumnSum sum = {0, 0};
    for (u32 i = 0; i < count; i++) {
        u64 mixed = column_sum_mix(values[i]);
        sum.s0 += mixed;
        sum.s1 += (i + 1ull) * mixed;
    }
    return sum;
}
