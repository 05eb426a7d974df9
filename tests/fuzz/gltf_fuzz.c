// gltf_fuzz.c: a libFuzzer target for the model importer: container, JSON, buffers, images, meshes.
//
// Data in: bytes from the fuzzer. Data out: nothing, or a sanitizer's report. Built by hand, never
// by build.sh:
//
//   mkdir -p build/fuzz/corpus && cp some/small.glb some/small.gltf build/fuzz/corpus/
//   for f in engine/base/*.c engine/asset/*.c tests/fuzz/gltf_fuzz.c; do
//     clang -std=c17 -D_GNU_SOURCE -O1 -g -fsanitize=fuzzer-no-link,address,undefined \
//       -ffp-contract=off -c $f -o build/fuzz/$(basename $f).o; done
//   clang++ -std=c++17 -D_GNU_SOURCE -O1 -g -fsanitize=fuzzer,address,undefined \
//     -ffp-contract=off engine/asset/gltf.cpp build/fuzz/*.o -o build/fuzz/gltf_fuzz \
//     -ltinygltf -lmeshoptimizer -lxxhash -lm
//   LUZ_LOG=none build/fuzz/gltf_fuzz -max_len=65536 -timeout=10 -rss_limit_mb=4096 \
//     build/fuzz/corpus
//
// The input goes the real way, asset_load_model through a FileRoot: into the one file of a fresh
// folder in $TMPDIR (default /dev/shm, so that no disk is worn).
#include "../../engine/asset/asset_internal.h"
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static AssetStore store;
static FileRoot root;
static int file = -1;

static void start(void) {
    const char *folder = getenv("TMPDIR");
    char path[512], name[600];
    snprintf(path, sizeof path, "%.400s/luz_fuzz_XXXXXX", folder ? folder : "/dev/shm");
    LUZ_ASSERT(mkdtemp(path) && file_root_open(&root, path) && asset_store_create(&store));
    snprintf(name, sizeof name, "%s/input", path);
    file = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    LUZ_ASSERT(file >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (file < 0) start();
    LUZ_ASSERT(ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size);
    StoreMark mark = store_mark(&store);
    u32 id = asset_load_model(&store, &root, "input");
    if (!id) {
        StoreMark after = store_mark(&store);
        LUZ_ASSERT(after.arena == mark.arena && after.scratch == mark.scratch &&
                   after.mesh_count == mark.mesh_count && after.model_count == mark.model_count);
    }
    store_rewind(&store, mark);
    return 0;
}
