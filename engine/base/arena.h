// arena.h: linear allocators over reserved address space. Nothing in a frame calls malloc.
//
// Four lifetimes (Arenas): permanent (the program), level (until the next level), frame (one
// frame), scratch (one function: mark, use, rewind). Memory is reserved once and committed on
// touch, so a capacity costs nothing until used. In builds with LUZ_POISON, memory given back
// is filled with 0xDD; under AddressSanitizer it is poisoned as well.
// Not thread-safe: one arena has one owner.
#ifndef LUZ_ARENA_H
#define LUZ_ARENA_H
#include "base.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef struct Arena {
    const char *name; // for messages, static storage
    u8 *memory;
    u64 used, cap, high_water; // bytes
} Arena;

typedef struct Arenas {
    Arena permanent, level, frame, scratch;
} Arenas;

// Reserves cap bytes of address space. False (and a log line) if the system refuses.
bool arena_create(Arena *arena, const char *name, u64 cap);
void arena_destroy(Arena *arena);
// Zeroed memory, aligned to align (a power of two). Overflow is an assert that names the arena:
// sizes that come from outside must be checked by the caller first (arena_can_push).
void *arena_push(Arena *arena, u64 size, u64 align);
// The same, but with whatever bytes lie there: for large arrays that are written as a whole.
void *arena_push_unset(Arena *arena, u64 size, u64 align);
bool arena_can_push(const Arena *arena, u64 size, u64 align);
// Position to return to; arena_rewind gives back (and poisons) everything after it.
u64 arena_mark(const Arena *arena);
void arena_rewind(Arena *arena, u64 mark);
void arena_reset(Arena *arena);
char *arena_copy_string(Arena *arena, const char *text);
char *arena_format(Arena *arena, const char *format, ...) PRINTF_LIKE(2, 3);

bool arenas_create(Arenas *arenas);
void arenas_destroy(Arenas *arenas);

#define ARENA_PUSH(arena, Type, count) \
    ((Type *)arena_push((arena), sizeof(Type) * (u64)(count), MAX(__alignof__(Type), 16)))
#define ARENA_PUSH_UNSET(arena, Type, count) \
    ((Type *)arena_push_unset((arena), sizeof(Type) * (u64)(count), MAX(__alignof__(Type), 16)))
#define ARENA_PUSH_COLUMN(arena, Type, count) \
    ((Type *)arena_push((arena), ALIGN_UP(sizeof(Type) * (u64)(count), CACHE_LINE), CACHE_LINE))

#ifdef __cplusplus
}
#endif
#endif
