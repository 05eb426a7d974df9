// arena.c: linear allocators over reserved address space.
// Data in: sizes and alignments. Data out: zeroed memory that is given back all at once.
// Called by: everything that allocates after start-up. Does not: free single blocks, lock, or
// grow past its cap (that is an assert that names the arena).
//
// The address space is mapped PROT_NONE and made writable in COMMIT_CHUNK steps, so a stray
// access ahead of the arena faults in every build. No field counts what is writable: that is
// always high_water rounded up to the chunk (arena_committed).
//
// Zeroed memory costs nothing the first time: pages beyond high_water come as zeros from the
// kernel and nobody has written to them; only what lies below is cleared again.
#include "arena.h"
#include "log.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#define ASAN_POISON(p, n)   __asan_poison_memory_region((p), (n))
#define ASAN_UNPOISON(p, n) __asan_unpoison_memory_region((p), (n))
#else
#define ASAN_POISON(p, n)   ((void)(p), (void)(n))
#define ASAN_UNPOISON(p, n) ((void)(p), (void)(n))
#endif

#define PAGE_SIZE    4096u // at least; a power of two that divides COMMIT_CHUNK
#define COMMIT_CHUNK MIB(2)
#define POISON_BYTE  0xDD

// What arenas_create asks for. Address space only, and NORESERVE keeps it out of the kernel's
// commit accounting; under a limit (ulimit -v, a small container) each is halved down to
// ARENA_SIZE_MIN before we give up.
#define PERMANENT_SIZE GIB(1)
#define LEVEL_SIZE     GIB(8)
#define FRAME_SIZE     GIB(1)
#define SCRATCH_SIZE   GIB(4)
#define ARENA_SIZE_MIN MIB(64)

static u64 arena_mapped(const Arena *arena) { return ALIGN_UP(arena->cap, COMMIT_CHUNK); }
static u64 arena_committed(u64 high_water) { return ALIGN_UP(high_water, COMMIT_CHUNK); }

static bool arena_try_create(Arena *arena, const char *name, u64 cap) {
    *arena = (Arena){.name = name};
    if (cap == 0 || cap > (u64)1 << 46) return false; // ALIGN_UP must not wrap
    void *memory = mmap(NULL, ALIGN_UP(cap, COMMIT_CHUNK), PROT_NONE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) return false;
    arena->memory = memory;
    arena->cap = cap;
    return true;
}

bool arena_create(Arena *arena, const char *name, u64 cap) {
    if (arena_try_create(arena, name, cap)) return true;
    LOG(ARENA_RESERVE, "arena '%s': %llu MiB of address space refused: %s", name,
        (unsigned long long)(cap >> 20), strerror(errno));
    return false;
}

void arena_destroy(Arena *arena) {
    if (arena->memory) {
        // The shadow must be clean again for whatever the kernel maps here next.
        ASAN_UNPOISON(arena->memory, arena_committed(arena->high_water));
        LUZ_ASSERT(munmap(arena->memory, arena_mapped(arena)) == 0);
    }
    *arena = (Arena){.name = arena->name};
}

bool arena_can_push(const Arena *arena, u64 size, u64 align) {
    // Written so that no sum wraps: used <= cap <= 2^46 and align is small.
    u64 start = ALIGN_UP(arena->used, align);
    return start <= arena->cap && size <= arena->cap - start;
}

__attribute__((noreturn, cold)) static void arena_fail(const Arena *arena, const char *what,
                                                       u64 size) {
    char text[256];
    snprintf(text, sizeof text, "arena '%s' %s: %llu bytes wanted, %llu of %llu in use",
             arena->name ? arena->name : "?", what, (unsigned long long)size,
             (unsigned long long)arena->used, (unsigned long long)arena->cap);
    luz_assert_fail(text, __FILE__, __LINE__);
}

// Makes [committed so far, needed) writable. Failing here means that the machine is out of
// memory or mappings, which nothing above can repair.
static void arena_commit(Arena *arena, u64 end) {
    u64 committed = arena_committed(arena->high_water), needed = arena_committed(end);
    if (needed <= committed) return;
    if (mprotect(arena->memory + committed, needed - committed, PROT_READ | PROT_WRITE) != 0)
        arena_fail(arena, "cannot commit memory", end - arena->used);
    ASAN_POISON(arena->memory + committed, needed - committed);
}

void *arena_push_unset(Arena *arena, u64 size, u64 align) {
    LUZ_ASSERT(align > 0 && (align & (align - 1)) == 0 && align <= PAGE_SIZE);
    if (!arena_can_push(arena, size, align)) arena_fail(arena, "is full", size);
    u64 start = ALIGN_UP(arena->used, align), end = start + size;
    arena_commit(arena, end);
    ASAN_UNPOISON(arena->memory + start, size);
    arena->used = end;
    arena->high_water = MAX(arena->high_water, end);
    return arena->memory + start;
}

void *arena_push(Arena *arena, u64 size, u64 align) {
    u64 touched = arena->high_water;
    u8 *memory = arena_push_unset(arena, size, align);
    u64 start = (u64)(memory - arena->memory);
    if (start < touched) memset(memory, 0, MIN(start + size, touched) - start);
    return memory;
}

u64 arena_mark(const Arena *arena) { return arena->used; }

void arena_rewind(Arena *arena, u64 mark) {
    LUZ_ASSERT(mark <= arena->used);
#ifdef LUZ_POISON
    // Alignment gaps are poisoned already under ASAN; unpoison before writing over them.
    ASAN_UNPOISON(arena->memory + mark, arena->used - mark);
    if (arena->used > mark) memset(arena->memory + mark, POISON_BYTE, arena->used - mark);
#endif
    ASAN_POISON(arena->memory + mark, arena->used - mark);
    arena->used = mark;
}

void arena_reset(Arena *arena) { arena_rewind(arena, 0); }

char *arena_copy_string(Arena *arena, const char *text) {
    u64 size = strlen(text) + 1;
    return memcpy(arena_push(arena, size, 1), text, size);
}

char *arena_format(Arena *arena, const char *format, ...) {
    LUZ_ASSERT(format); // also tells GCC, whose sanitizer builds fear a NULL here
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    LUZ_ASSERT(length >= 0); // only a broken format or wide character can do that
    char *text = arena_push(arena, (u64)length + 1, 1);
    vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    return text;
}

static bool arena_create_shrinking(Arena *arena, const char *name, u64 cap) {
    for (; cap > ARENA_SIZE_MIN; cap /= 2)
        if (arena_try_create(arena, name, cap)) return true;
    return arena_create(arena, name, ARENA_SIZE_MIN); // the last attempt reports
}

bool arenas_create(Arenas *arenas) {
    *arenas = (Arenas){0};
    bool ok = arena_create_shrinking(&arenas->permanent, "permanent", PERMANENT_SIZE) &&
              arena_create_shrinking(&arenas->level, "level", LEVEL_SIZE) &&
              arena_create_shrinking(&arenas->frame, "frame", FRAME_SIZE) &&
              arena_create_shrinking(&arenas->scratch, "scratch", SCRATCH_SIZE);
    if (!ok) arenas_destroy(arenas);
    return ok;
}

void arenas_destroy(Arenas *arenas) {
    arena_destroy(&arenas->permanent);
    arena_destroy(&arenas->level);
    arena_destroy(&arenas->frame);
    arena_destroy(&arenas->scratch);
}
