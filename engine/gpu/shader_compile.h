// shader_compile.h: GLSL to SPIR-V while the program runs, the same as the build does it
// (glslangValidator -V --target-env vulkan1.x -g).
//
// For development only: a hostile shader can make the compiler use all memory. Sources come through
// a function of the caller, so this knows no files.
#ifndef LUZ_SHADER_COMPILE_H
#define LUZ_SHADER_COMPILE_H
#include "../base/base.h"
#ifdef __cplusplus
extern "C" {
#endif

#define SHADER_INCLUDE_DEPTH_MAX 16       // an include cycle would hang the compiler
#define SHADER_SOURCE_SIZE_MAX   KIB(256) // a file; so would an expression of 100,000 terms

// Finds a source by name ("gbuffer.frag", "shared.h"): text that lives until shader_compile
// returns.
typedef struct ShaderSources {
    bool (*read)(void *user, const char *name, Bytes *out);
    void *user;
} ShaderSources;

// The stage comes from the name's ending (.vert, .frag, .comp); spirv_version is the second word of
// the module that is to be replaced (0x00010600 = what Vulkan 1.3 brought), so that the result fits
// where the build's fitted. True: *words is malloc'd, the caller frees it. False: `error` says why,
// one "file:line: text" a line.
bool shader_compile(const char *name, const ShaderSources *sources, u32 spirv_version, u32 **words,
                    u32 *byte_count, char *error, u64 error_cap);

#ifdef __cplusplus
}
#endif
#endif
