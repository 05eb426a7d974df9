// base_arena.c: arenas: alignment, zeroing, rewinding, poison, limits.
#include "../test.h"
#include "../../engine/base/arena.h"
#include "../../engine/base/log.h"
#include "../../engine/base/random.h"
#include <string.h>

static bool all_bytes_are(const u8 *bytes, u64 size, u8 value) {
    for (u64 i = 0; i < size; i++)
        if (bytes[i] != value) return false;
    return true;
}

// What is not zeroed moves the arena like what is, and what is pushed later is zero all the same.
TEST(arena, unset_memory_keeps_what_lay_there) {
    Arena arena;
    assert_true(arena_create(&arena, "unset", MIB(64)));
    u8 *first = arena_push(&arena, 5000, 64);
    memset(first, 0xA5, 5000);
    arena_rewind(&arena, 0);
    u8 *unset = arena_push_unset(&arena, 3000, 64);
    assert_ptr_equal(unset, first);
    assert_int_equal(arena.used, 3000);
#if !defined(LUZ_POISON) && !defined(__SANITIZE_ADDRESS__)
    assert_int_equal(unset[2999], 0xA5);
#endif
    memset(unset, 0xA5, 3000);
    arena_rewind(&arena, 1000);
    u8 *zeroed = arena_push(&arena, 9000, 16);
    for (u32 i = 0; i < 9000; i++) assert_int_equal(zeroed[i], 0);
    arena_destroy(&arena);
}

TEST(arena, pushes_aligned_zeroed_memory_again_and_again) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(32)));
    for (u64 round = 0; round < 3; round++) {
        for (u64 i = 0; i < 2000; i++) {
            u64 align = 1ull << (random_u32(1, round, i) % 13);
            u64 size = random_u32(2, round, i) % 5000;
            u8 *memory = arena_push(&arena, size, align);
            assert_int_equal((uintptr_t)memory % align, 0);
            assert_true(all_bytes_are(memory, size, 0));
            memset(memory, 0xAB, size); // dirt for the next round
        }
        assert_true(arena.used <= arena.high_water && arena.high_water <= arena.cap);
        arena_reset(&arena);
        assert_int_equal(arena.used, 0);
    }
    arena_destroy(&arena);
    assert_null(arena.memory);
}

TEST(arena, blocks_do_not_overlap) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(8)));
    u8 *blocks[200];
    u64 sizes[200];
    for (u64 i = 0; i < 200; i++) {
        sizes[i] = 1 + random_u32(3, 0, i) % 20000;
        blocks[i] = arena_push(&arena, sizes[i], 16);
        memset(blocks[i], (int)i, sizes[i]);
    }
    for (u64 i = 0; i < 200; i++) assert_true(all_bytes_are(blocks[i], sizes[i], (u8)i));
    arena_destroy(&arena);
}

TEST(arena, fills_to_the_last_byte_and_not_beyond) {
    Arena arena;
    assert_true(arena_create(&arena, "odd", 100001));
    assert_true(arena_can_push(&arena, 100001, 1));
    assert_false(arena_can_push(&arena, 100002, 1));
    assert_false(arena_can_push(&arena, UINT64_MAX, 1));
    assert_false(arena_can_push(&arena, UINT64_MAX - 15, 16));
    u8 *memory = arena_push(&arena, 100001, 1);
    memory[100000] = 1;
    assert_true(arena_can_push(&arena, 0, 1));
    assert_false(arena_can_push(&arena, 1, 1));
    assert_false(arena_can_push(&arena, 0, 16)); // the start itself would lie outside
    ASSERT_DIES(arena_push(&arena, 1, 1));
    ASSERT_DIES(arena_push(&arena, UINT64_MAX, 1));
    arena_reset(&arena);
    ASSERT_DIES(arena_push(&arena, 1, 3)); // not a power of two
    ASSERT_DIES(arena_push(&arena, 1, 0));
    ASSERT_DIES(arena_rewind(&arena, 1)); // ahead of used
    arena_destroy(&arena);
}

TEST(arena, rewinds_to_a_mark) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(1)));
    u32 *kept = ARENA_PUSH(&arena, u32, 10);
    kept[9] = 7;
    u64 mark = arena_mark(&arena);
    u8 *first = arena_push(&arena, 1000, 8);
    arena_rewind(&arena, mark);
    assert_int_equal(arena.used, mark);
    assert_ptr_equal(arena_push(&arena, 1000, 8), first);
    assert_int_equal(kept[9], 7);
    assert_true(arena.high_water >= mark + 1000);
    arena_destroy(&arena);
}

// Only in the poisoning variants, and not where reading poison is itself an error.
TEST(arena, memory_given_back_is_poisoned) {
#if defined(LUZ_POISON) && !defined(__SANITIZE_ADDRESS__)
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(1)));
    u8 *memory = arena_push(&arena, 100, 1);
    arena_rewind(&arena, 40);
    assert_true(all_bytes_are(memory, 40, 0));
    assert_true(all_bytes_are(memory + 40, 60, 0xDD));
    assert_true(all_bytes_are(arena_push(&arena, 60, 1), 60, 0));
    arena_destroy(&arena);
#elif defined(__SANITIZE_ADDRESS__)
    extern int __asan_address_is_poisoned(const volatile void *address);
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(1)));
    u8 *memory = arena_push(&arena, 128, 16);
    assert_false(__asan_address_is_poisoned(memory + 127));
    assert_true(__asan_address_is_poisoned(memory + 128)); // never pushed
    arena_rewind(&arena, 64);
    assert_false(__asan_address_is_poisoned(memory + 63));
    assert_true(__asan_address_is_poisoned(memory + 64));
    arena_push(&arena, 8, 8);
    assert_false(__asan_address_is_poisoned(memory + 71));
    assert_true(__asan_address_is_poisoned(memory + 72));
    arena_destroy(&arena);
#else
    TEST_SKIP("only with --debug and --asan");
#endif
}

TEST(arena, columns_are_whole_cache_lines) {
    Arena arena;
    assert_true(arena_create(&arena, "test", MIB(1)));
    f32 *a = ARENA_PUSH_COLUMN(&arena, f32, 3), *b = ARENA_PUSH_COLUMN(&arena, f32, 17);
    assert_int_equal((uintptr_t)a % CACHE_LINE, 0);
    assert_int_equal((u8 *)b - (u8 *)a, CACHE_LINE);
    assert_int_equal(arena.used % CACHE_LINE, 0);
    arena_destroy(&arena);
}

TEST(arena, copies_and_formats_text) {
    Arena arena;
    assert_true(arena_create(&arena, "test", KIB(64)));
    assert_string_equal(arena_copy_string(&arena, ""), "");
    char *copy = arena_copy_string(&arena, "light");
    char *text = arena_format(&arena, "%s %d %.2f", copy, -3, 0.5);
    assert_string_equal(text, "light -3 0.50");
    char *wide = arena_format(&arena, "%05000d", 1);
    assert_int_equal(strlen(wide), 5000);
    arena_destroy(&arena);
}

TEST(arena, refuses_absurd_sizes_with_a_message) {
    Arena arena;
    log_reset_counts();
    assert_false(arena_create(&arena, "absurd", UINT64_MAX));
    assert_false(arena_create(&arena, "none", 0));
    assert_int_equal(log_count(LOG_ARENA_RESERVE), 2);
    assert_null(arena.memory);
    arena_destroy(&arena); // harmless
}

TEST(arena, four_lifetimes_are_made_together) {
    Arenas arenas;
    assert_true(arenas_create(&arenas));
    assert_true(arenas.permanent.cap >= MIB(64) && arenas.level.cap >= MIB(64));
    assert_true(arenas.frame.cap >= MIB(64) && arenas.scratch.cap >= MIB(64));
    assert_string_equal(arenas.scratch.name, "scratch");
    u8 *far_away = (u8 *)arena_push(&arenas.scratch, MIB(40), 64) + MIB(40) - 1;
    assert_int_equal(*far_away, 0);
    arenas_destroy(&arenas);
    assert_null(arenas.level.memory);
}
