// shader_blobs.c: look-up in the generated table of SPIR-V. Called by pipeline.c when a pipeline
// names a shader for the first time; a linear search over some dozens of names is enough there.
#include "shader_blobs.h"
#include <stddef.h>
#include <string.h>

const ShaderBlob *shader_blob_find(const char *name) {
    for (uint32_t i = 0; i < shader_blob_count; i++)
        if (strcmp(shader_blobs[i].name, name) == 0) return &shader_blobs[i];
    return NULL;
}
