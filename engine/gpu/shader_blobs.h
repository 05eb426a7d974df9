// shader_blobs.h: the SPIR-V of every file of shaders/, embedded in the program by the build.
//
// Data in: none. Data out: the table. Plain C, included by the generated file that defines it and
// by engine/gpu/. Does not: compile (shader_compile.h) or reload (shader_reload.c).
#ifndef LUZ_SHADER_BLOBS_H
#define LUZ_SHADER_BLOBS_H
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShaderBlob {
    const char *name; // of the source: "gbuffer.vert"
    const uint32_t *words, *end; // `end` is a symbol of the linker: C has no constant for the size
} ShaderBlob;
extern const ShaderBlob shader_blobs[];
extern const uint32_t shader_blob_count;

// NULL if there is none with this name.
const ShaderBlob *shader_blob_find(const char *name);

#ifdef __cplusplus
}
#endif
#endif
