// hash.h: 64-bit content hashes (XXH3) for worlds, images, files. Not for secrets.
#ifndef LUZ_HASH_H
#define LUZ_HASH_H
#include "base.h"
#ifdef __cplusplus
extern "C" {
#endif
// Hash of bytes, chained by seed: hash_bytes(b, n, hash_bytes(a, m, 0)).
u64 hash_bytes(const void *data, u64 size, u64 seed);
u64 hash_string(const char *text);
#ifdef __cplusplus
}
#endif
#endif
