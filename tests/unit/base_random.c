// base_random.c: the counter-based generator: uniform, and independent across streams and seeds.
#include "../test.h"
#include "../../engine/base/random.h"

#define DRAWS 100000

// 256 buckets of the low and of the high byte. Chi square with 255 degrees of freedom: mean 255,
// sigma 22.6; the seeds are fixed, so a bound of 5 sigma cannot flicker.
static f64 chi_square(u64 seed, u64 stream, u32 shift) {
    u32 buckets[256] = {0};
    for (u64 i = 0; i < DRAWS; i++) buckets[random_u64(seed, stream, i) >> shift & 255]++;
    f64 sum = 0, expected = DRAWS / 256.0;
    for (u32 i = 0; i < 256; i++) sum += (buckets[i] - expected) * (buckets[i] - expected);
    return sum / expected;
}

TEST(random, bytes_are_uniform) {
    for (u64 seed = 0; seed < 3; seed++)
        for (u32 shift = 0; shift < 64; shift += 14)
            ASSERT_NEAR(chi_square(seed, seed * 1000, shift), 255.0, 5 * 22.6);
}

TEST(random, floats_fill_the_unit_interval) {
    f64 sum = 0, square = 0;
    f32 low = 1, high = 0;
    for (u64 i = 0; i < DRAWS; i++) {
        f32 x = random_f32(42, 1, i);
        assert_true(x >= 0.0f && x < 1.0f);
        sum += x;
        square += (f64)x * x;
        low = MIN(low, x);
        high = MAX(high, x);
    }
    ASSERT_NEAR(sum / DRAWS, 0.5, 0.005); // 5 sigma of the mean: 5 * 0.289 / sqrt(DRAWS)
    ASSERT_NEAR(square / DRAWS, 1.0 / 3, 0.005);
    assert_true(low < 1e-4f && high > 1 - 1e-4f);
    for (u64 i = 0; i < 1000; i++) {
        f32 x = random_range(1, 2, i, -3, 5);
        assert_true(x >= -3 && x <= 5);
    }
}

// Pearson's r of two sequences: sigma is 1 / sqrt(DRAWS) = 0.0032.
static f64 correlation(u64 seed_a, u64 stream_a, u64 lag_a, u64 seed_b, u64 stream_b) {
    f64 sum = 0;
    for (u64 i = 0; i < DRAWS; i++)
        sum += ((f64)random_f32(seed_a, stream_a, i + lag_a) - 0.5) *
               ((f64)random_f32(seed_b, stream_b, i) - 0.5);
    return sum / DRAWS * 12;
}

TEST(random, streams_seeds_and_counters_are_uncorrelated) {
    for (u64 other = 1; other <= 8; other *= 2) {
        ASSERT_NEAR(correlation(9, 0, 0, 9, other), 0, 0.016);     // neighbouring streams
        ASSERT_NEAR(correlation(9, 5, 0, 9 + other, 5), 0, 0.016); // neighbouring seeds
        ASSERT_NEAR(correlation(9, 5, other, 9, 5), 0, 0.016);     // shifted against itself
        ASSERT_NEAR(correlation(9, 5, 0, 9 ^ (other << 40), 5), 0, 0.016);
    }
}

// One bit of any input turns half of the output bits, on average.
TEST(random, every_input_bit_matters) {
    for (u32 input = 0; input < 3; input++) {
        for (u32 bit = 0; bit < 64; bit++) {
            u32 flipped = 0;
            for (u64 i = 0; i < 200; i++) {
                u64 a[3] = {i * 3 + 1, i * 5 + 2, i * 7 + 3}, b[3] = {a[0], a[1], a[2]};
                b[input] ^= 1ull << bit;
                flipped += (u32)__builtin_popcountll(random_u64(a[0], a[1], a[2]) ^
                                                     random_u64(b[0], b[1], b[2]));
            }
            ASSERT_NEAR(flipped / 200.0, 32.0, 2.0); // sigma 4 / sqrt(200) = 0.28
        }
    }
}

TEST(random, values_never_change) {
    // Recordings and scattered levels depend on these.
    assert_true(random_u64(0, 0, 0) == 0);
    assert_true(random_u64(1, 2, 3) == 0xE93A3903576BB373ull);
}
