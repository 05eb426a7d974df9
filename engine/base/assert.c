// assert.c: the end of the program when an impossible state is met.
// Data in: the text of the condition and its place. Data out: one line on stderr, then SIGABRT.
// Called by: LUZ_ASSERT, in debug and release builds alike. Does not: unwind, free, or use the
// log (whose lock the caller may hold).
#include "base.h"
#include <stdio.h>
#include <stdlib.h>

void luz_assert_fail(const char *expression, const char *file, int line) {
    // stdout first, so that the assertion comes after what the program said before it.
    fflush(stdout);
    fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, expression);
    fflush(stderr);
    abort();
}
