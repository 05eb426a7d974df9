// level_fuzz.c: libFuzzer target for level text: parser, reader, formatter, writer.
// Data in: bytes. Data out: nothing, or a crash. Compiled by hand (clang, libclang-rt-14-dev):
//
//   F="-g -O1 -D_GNU_SOURCE -fsanitize=fuzzer-no-link,address,undefined -ffp-contract=off"
//   mkdir -p out/fuzz && cd out/fuzz
//   for s in ../../engine/{base,world,asset,level}/*.c; do clang -std=c17 $F -c $s; done
//   for s in ../../engine/asset/gltf.cpp ../../engine/level/toml.cpp; do
//       clang++ -std=c++17 $F -DTOML_HEADER_ONLY=0 -DTOML_SHARED_LIB=1 -c $s; done
//   clang -std=c17 $F -c ../../tests/fuzz/level_fuzz.c
//   clang++ -fsanitize=fuzzer,address,undefined *.o -o level_fuzz \
//       -ltomlplusplus $(pkg-config --libs tinygltf) -lmeshoptimizer -lxxhash -lm -lpthread
//   mkdir -p corpus && cp ../../data/levels/*.toml corpus/
//   LUZ_LOG=none ASAN_OPTIONS=detect_leaks=0 ./level_fuzz -max_len=4096 -timeout=10 corpus
//
// Text reaches level_load through a file in memory (/dev/shm), because it reads files and nothing
// else.
#include "../../engine/level/level.h"
#include "../../engine/level/level_format.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const u8 *data, size_t size);

int LLVMFuzzerTestOneInput(const u8 *data, size_t size) {
    static Arena arena;
    static FileRoot root;
    static char directory[] = "/dev/shm/level_fuzz_XXXXXX";
    static char path[64];
    static Diagnostics diagnostics;
    if (!arena.memory) {
        if (!mkdtemp(directory) || !arena_create(&arena, "fuzz", GIB(4)) ||
            !file_root_open(&root, directory))
            abort();
        snprintf(path, sizeof path, "%s/l.toml", directory);
    }
    FILE *file = fopen(path, "wb");
    if (!file) abort();
    fwrite(data, 1, size, file);
    fclose(file);
    World *world = world_create(0);
    AssetStore store;
    if (!asset_store_create(&store)) abort();
    LevelInfo info;
    bool is_good = level_load(&root, "l.toml", world, &store, &arena, &info, &diagnostics);
    world_check(world);
    char line[1024];
    for (u32 i = 0; i < diagnostics.count; i++)
        diagnostic_format(&diagnostics.items[i], line, sizeof line);
    // A good level, written and read again, is the same level.
    if (is_good && info.entity_count < 1000) {
        const char *text = level_write(world, &store, &arena);
        file = fopen(path, "wb");
        if (!file) abort();
        fputs(text, file);
        fclose(file);
        World *again = world_create(0);
        AssetStore store_again;
        if (!asset_store_create(&store_again)) abort();
        if (!level_load(&root, "l.toml", again, &store_again, &arena, &info, &diagnostics) ||
            world_hash(again) != world_hash(world))
            abort();
        world_destroy(again);
        asset_store_destroy(&store_again);
    }
    char *text = malloc(size + 1);
    if (!text) abort();
    memcpy(text, data, size);
    text[size] = 0;
    const char *formatted, *twice;
    if (level_format_text(text, &arena, &formatted) &&
        (!level_format_text(formatted, &arena, &twice) || strcmp(formatted, twice) != 0))
        abort();
    free(text);
    world_destroy(world);
    asset_store_destroy(&store);
    arena_reset(&arena);
    return 0;
}
