// hash.c: 64-bit content hashes by XXH3 of libxxhash.
// Data in: bytes and a seed. Data out: a hash that is the same on every machine and build.
// Called by: world and packet hashes, captures, caches. Does not: resist an attacker; a checksum
// made with it finds damage, not forgery.
#include "hash.h"
#include <string.h>
#include <xxhash.h>

u64 hash_bytes(const void *data, u64 size, u64 seed) {
    // An empty range still depends on the seed, so that chained hashes keep their history.
    return XXH3_64bits_withSeed(data, (size_t)size, seed);
}

u64 hash_string(const char *text) { return hash_bytes(text, strlen(text), 0); }
