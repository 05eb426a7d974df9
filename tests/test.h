// test.h: what a test file needs: cmocka, self-registering tests, and a few helpers.
//
//   #include "../test.h"
//
//   TEST(arena, pushes_zeroed_memory) {
//       ...
//       assert_int_equal(arena.used, 16);   // cmocka's asserts
//   }
//
// A test registers itself by existing; tests/runner.c runs all of them in the order of their names,
// each in a process of its own, so a test may crash, change the working directory or leave threads
// behind without harming another. Fails also: a message of the validation layer during the test.
// Seeds are constants of the test; nothing here gives a random one.
//
// The working directory is the root of the repository.
#ifndef LUZ_TEST_H
#define LUZ_TEST_H
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include "../engine/base/base.h"
#include <math.h>

typedef enum TestKind {
    TEST_KIND_UNIT = 0,        // needs nothing but a CPU; runs in every variant of the build
    TEST_KIND_GPU = 1 << 0,    // needs a Vulkan device
    TEST_KIND_WINDOW = 1 << 1, // needs a display
    TEST_KIND_SLOW = 1 << 2,   // takes more than a second or two
    TEST_KIND_BAIT = 1 << 3,   // meant to fail: runs only if a filter is its whole name
} TestKind;

typedef struct TestCase {
    const char *suite, *name;
    u32 kind; // TestKind bits
    CMUnitTestFunction function;
    struct TestCase *next;
} TestCase;

void test_register(TestCase *test);

#define TEST_OF_KIND(suite, name, kind)                                                            \
    static void test_##suite##_##name(void **cmocka_state);                                        \
    static TestCase test_case_##suite##_##name = {#suite, #name, (kind), test_##suite##_##name,    \
                                                  NULL};                                           \
    __attribute__((constructor)) static void test_register_##suite##_##name(void) {                \
        test_register(&test_case_##suite##_##name);                                                \
    }                                                                                              \
    static void test_##suite##_##name(__attribute__((unused)) void **cmocka_state)

#define TEST(suite, name)        TEST_OF_KIND(suite, name, TEST_KIND_UNIT)
#define TEST_SLOW(suite, name)   TEST_OF_KIND(suite, name, TEST_KIND_SLOW)
#define TEST_GPU(suite, name)    TEST_OF_KIND(suite, name, TEST_KIND_GPU)
#define TEST_WINDOW(suite, name) TEST_OF_KIND(suite, name, TEST_KIND_GPU | TEST_KIND_WINDOW)

// Ends the test as skipped, with the reason in the runner's line. (cmocka's skip() counts as
// passed here: a skip without a reason is not one.)
#define TEST_SKIP(...) test_skip(__VA_ARGS__)
__attribute__((noreturn)) void test_skip(const char *format, ...) PRINTF_LIKE(1, 2);

// A fresh directory below build/tmp, the same for the whole test, removed after it. Static storage.
const char *test_temp_dir(void);
// "DIR/name" in static storage; four of them are valid at a time.
const char *test_temp_path(const char *name);

// |a - b| <= eps in double; NaN fails. The message has the values.
#define ASSERT_NEAR(a, b, eps) test_assert_near((a), (b), (eps), #a, #b, __FILE__, __LINE__)
void test_assert_near(f64 a, f64 b, f64 eps, const char *a_text, const char *b_text,
                      const char *file, int line);

// The call must end the program by LUZ_ASSERT (it runs in a child of its own, silenced).
#define ASSERT_DIES(call)                                                                          \
    do {                                                                                           \
        if (test_fork_for_death()) {                                                               \
            call;                                                                                  \
            test_survived();                                                                       \
        }                                                                                          \
        test_assert_died(#call, __FILE__, __LINE__);                                               \
    } while (0)
bool test_fork_for_death(void);
__attribute__((noreturn)) void test_survived(void);
void test_assert_died(const char *text, const char *file, int line);

#endif
