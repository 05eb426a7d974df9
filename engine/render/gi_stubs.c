// gi_stubs.c: passes that are still to come; each row goes when its pass does.
#include "passes.h"

static bool never(const PassContext *c) {
    (void)c;
    return false;
}
#define STUB(id) const Pass id##_pass = {.name = #id, .needed = never}
