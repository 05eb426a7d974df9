// shader_blobs.h: the shaders compiled by build.sh, embedded in the library. The table itself is
// generated (build/<variant>/gen/shader_blobs.c).
#ifndef LUZ_SHADER_BLOBS_H
#define LUZ_SHADER_BLOBS_H
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif
typedef struct ShaderBlob {
    const char *name;            // "gbuffer.vert" = shaders/gbuffer.vert
    const uint32_t *words, *end; // SPIR-V
} ShaderBlob;
extern const ShaderBlob shader_blobs[];
extern const uint32_t shader_blob_count;
#ifdef __cplusplus
}
#endif
#endif
