// shader_compile.cpp: libglslang behind a C function.
//
// Data in: names and texts of sources. Data out: SPIR-V words, or the compiler's messages as
// file:line. Called by shader_reload.c. The only C++ here: the library's C interface has no include
// callback.
#include "shader_compile.h"
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

// Includes are looked up in the shader directory alone, as with -I of the build.
class Includer : public glslang::TShader::Includer {
  public:
    explicit Includer(const ShaderSources *from) : sources(from) {}
    IncludeResult *includeLocal(const char *name, const char *, size_t depth) override {
        return find(name, depth);
    }
    IncludeResult *includeSystem(const char *name, const char *, size_t depth) override {
        return find(name, depth);
    }
    void releaseInclude(IncludeResult *result) override { delete result; }

  private:
    IncludeResult *find(const char *name, size_t depth) {
        static const char too_deep[] = "includes are nested too deeply (a cycle?)";
        if (depth > SHADER_INCLUDE_DEPTH_MAX)
            return new IncludeResult("", too_deep, sizeof too_deep - 1, nullptr);
        Bytes text;
        if (!sources->read(sources->user, name, &text)) return nullptr;
        return new IncludeResult(name, static_cast<const char *>(text.data), text.size, nullptr);
    }
    const ShaderSources *sources;
};

// glslang says "ERROR: tiled.comp:12: 'x' : undeclared identifier"; people and editors want
// "tiled.comp:12: 'x' : undeclared identifier". Its closing count of errors says nothing.
void copy_messages(const char *log, const char *name, char *error, u64 cap) {
    std::string text;
    for (const char *line = log; *line;) {
        const char *end = strchr(line, '\n');
        std::string one(line, end ? end - line : strlen(line));
        line = end ? end + 1 : line + one.size();
        if (one.empty() || one.find("compilation errors.  No code generated") != std::string::npos)
            continue;
        for (const char *prefix : {"ERROR: ", "WARNING: "})
            if (one.compare(0, strlen(prefix), prefix) == 0) one.erase(0, strlen(prefix));
        if (!text.empty()) text += '\n';
        text += one;
    }
    if (text.empty()) text = std::string(name) + ": does not compile";
    snprintf(error, cap, "%s", text.c_str());
}

bool stage_of_name(const char *name, EShLanguage *stage) {
    const char *dot = strrchr(name, '.');
    if (!dot) return false;
    if (strcmp(dot, ".vert") == 0)
        *stage = EShLangVertex;
    else if (strcmp(dot, ".frag") == 0)
        *stage = EShLangFragment;
    else if (strcmp(dot, ".comp") == 0)
        *stage = EShLangCompute;
    else
        return false;
    return true;
}

bool compile(const char *name, const ShaderSources *sources, u32 spirv_version,
             std::vector<u32> &words, char *error, u64 error_cap) {
    EShLanguage stage;
    Bytes text;
    if (!stage_of_name(name, &stage)) {
        snprintf(error, error_cap, "%s: not a .vert, .frag or .comp", name);
        return false;
    }
    if (!sources->read(sources->user, name, &text)) {
        snprintf(error, error_cap, "%s: cannot be read", name);
        return false;
    }
    const char *strings[] = {static_cast<const char *>(text.data)};
    const int lengths[] = {static_cast<int>(text.size)};
    const char *names[] = {name};
    const EShMessages messages =
        static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules | EShMsgDebugInfo);
    glslang::TShader shader(stage);
    shader.setStringsWithLengthsAndNames(strings, lengths, names, 1);
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
    const bool is_13 = spirv_version >= glslang::EShTargetSpv_1_6;
    shader.setEnvClient(glslang::EShClientVulkan,
                        is_13 ? glslang::EShTargetVulkan_1_3 : glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv,
                        is_13 ? glslang::EShTargetSpv_1_6 : glslang::EShTargetSpv_1_5);
    // No setDebugInfo: with the plain debug information it crashes (glslang issue 3136); the
    // options below give what -g gives.
    Includer includer(sources);
    if (!shader.parse(GetDefaultResources(), 110, false, messages, includer)) {
        copy_messages(shader.getInfoLog(), name, error, error_cap);
        return false;
    }
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(messages)) {
        copy_messages(program.getInfoLog(), name, error, error_cap);
        return false;
    }
    glslang::SpvOptions options;
    options.generateDebugInfo = true;
    options.disableOptimizer = true;
    glslang::GlslangToSpv(*program.getIntermediate(stage), words, &options);
    return true;
}

struct Library {
    Library() { glslang::InitializeProcess(); }
    ~Library() { glslang::FinalizeProcess(); }
};

} // namespace

bool shader_compile(const char *name, const ShaderSources *sources, u32 spirv_version, u32 **words,
                    u32 *byte_count, char *error, u64 error_cap) {
    error[0] = 0;
    // Starting the library takes longer than compiling a shader: once, and only if used at all.
    static const Library library;
    bool ok = false;
    try {
        std::vector<u32> result;
        ok = compile(name, sources, spirv_version, result, error, error_cap);
        if (ok) {
            *byte_count = static_cast<u32>(result.size() * sizeof(u32));
            *words = static_cast<u32 *>(malloc(*byte_count));
            ok = *words != nullptr;
            if (ok) memcpy(*words, result.data(), *byte_count);
        }
    } catch (const std::exception &e) { // no exception crosses into C
        snprintf(error, error_cap, "%s: %s", name, e.what());
        ok = false;
    }
    return ok;
}
