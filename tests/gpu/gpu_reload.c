// gpu_reload.c: shaders recompiled while running, good ones and broken ones.
#include "gpu_fixture.h"
#include "../../engine/base/file.h"
#include "../../engine/gpu/gpu_internal.h"
#include "../../engine/gpu/shader_compile.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

// Writes a source that is newer than all before, whatever the clock of the file system.
static void write_source(const char *name, const char *text) {
    assert_true(file_write(test_temp_path(name), text, strlen(text)));
    nanosleep(&(struct timespec){.tv_nsec = 20 * 1000 * 1000}, NULL);
}

#define HEAD "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
#define BODY                                                                                       \
    "layout(local_size_x = 64) in;\n"                                                              \
    "layout(set = 0, binding = 0) readonly buffer In { uint a[]; };\n"                             \
    "layout(set = 0, binding = 1) buffer Out { uint b[]; };\n"                                     \
    "layout(push_constant) uniform Push { uint count, add; };\n"                                   \
    "void main() { uint i = gl_GlobalInvocationID.x; if (i < count) b[i] = FORMULA; }\n"

static u32 run(Gpu *gpu, GpuPipeline pipeline, GpuBindGroup group, GpuBuffer out) {
    GpuCommands *cmd = gpu_frame_begin(gpu);
    gpu_cmd_bind_pipeline(cmd, pipeline);
    gpu_cmd_bind_group(cmd, 0, group);
    gpu_cmd_push(cmd, (u32[]){1, 100}, 8);
    gpu_cmd_dispatch(cmd, 1, 1, 1);
    assert_true(gpu_frame_end(gpu, true));
    return *(const u32 *)gpu_buffer_map(gpu, out);
}

TEST_GPU(gpu, reload_replaces_and_survives) {
    Gpu *gpu = gpu_fixture_create("reload");
    GpuBuffer in = gpu_create_buffer(gpu, &(GpuBufferDesc){.label = "in", .size = 64});
    gpu_upload_buffer(gpu, in, 0, &(u32){5}, 4);
    GpuBuffer out = gpu_fixture_readback(gpu, 64);
    GpuBindLayout layout =
        gpu_fixture_layout(gpu, GPU_BINDING_STORAGE_BUFFER, GPU_BINDING_STORAGE_BUFFER, 2);
    GpuPipeline first = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    GpuPipeline second = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 1, (u32[]){2});
    GpuBindGroup group = gpu_create_bind_group(
        gpu, &(GpuBindGroupDesc){.label = "group", .layout = layout, .bindings = {{in}, {out}}});
    assert_int_equal(run(gpu, first, group, out), 105);
    const char *directory = test_temp_dir();
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0); // no source there: nothing is newer

    write_source("formula.glsl", "#define FORMULA a[i] + add + 1000\n");
    write_source("test_buffer.comp", HEAD "#include \"formula.glsl\"\n" BODY);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 2);
    assert_string_equal(gpu_shader_error(gpu), "");
    assert_int_equal(run(gpu, first, group, out), 1105);
    assert_int_equal(run(gpu, second, group, out), 1105);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0); // nothing changed since

    // A change of the included file alone.
    write_source("formula.glsl", "#define FORMULA a[i] * add\n");
    assert_int_equal(gpu_reload_shaders(gpu, directory), 2);
    assert_int_equal(run(gpu, first, group, out), 500);

    // Broken: the old one stays, the message has file and line, and is said once.
    log_set_level(LOG_SEVERITY_NONE);
    write_source("test_buffer.comp", HEAD "#include \"formula.glsl\"\n\nbroken;\n" BODY);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0);
    assert_int_equal(log_count(LOG_SHADER_ERROR), 1);
    assert_non_null(strstr(gpu_shader_error(gpu), "test_buffer.comp:5:"));
    assert_int_equal(run(gpu, first, group, out), 500);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0);
    assert_int_equal(log_count(LOG_SHADER_ERROR), 1);
    assert_non_null(strstr(gpu_shader_error(gpu), "test_buffer.comp:5:"));

    // A mistake in the included file is told with that file's name.
    write_source("test_buffer.comp", HEAD "#include \"formula.glsl\"\n" BODY);
    write_source("formula.glsl", "#define FORMULA a[i]\n\nfloat f() { return nothing; }\n");
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0);
    assert_non_null(strstr(gpu_shader_error(gpu), "formula.glsl:3:"));

    // Cycles and absent files end as errors.
    write_source("formula.glsl", "#include \"formula.glsl\"\n");
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0);
    assert_true(gpu_shader_error(gpu)[0]);
    write_source("test_buffer.comp", HEAD "#include \"../../etc/passwd\"\n" BODY);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 0);
    assert_non_null(strstr(gpu_shader_error(gpu), "test_buffer.comp:3:"));
    log_set_level(LOG_SEVERITY_INFO);

    write_source("formula.glsl", "#define FORMULA a[i] * add * 2\n");
    write_source("test_buffer.comp", HEAD "#include \"formula.glsl\"\n" BODY);
    assert_int_equal(gpu_reload_shaders(gpu, directory), 2);
    assert_string_equal(gpu_shader_error(gpu), "");
    assert_int_equal(run(gpu, second, group, out), 1000);

    // A pipeline made after the reload uses what runs now.
    GpuPipeline third = gpu_fixture_compute(gpu, "test_buffer.comp", layout, 0, NULL);
    assert_int_equal(run(gpu, third, group, out), 1000);
    gpu_destroy_bind_group(gpu, group);
    gpu_destroy_pipeline(gpu, first);
    gpu_destroy_pipeline(gpu, second);
    gpu_destroy_pipeline(gpu, third);
    gpu_destroy_buffer(gpu, in);
    gpu_destroy_buffer(gpu, out);
    gpu_fixture_destroy(gpu);
}

// --- The run-time compiler against the build's ---

static bool read_shader(void *user, const char *name, Bytes *out) {
    FileRoot root;
    if (!file_root_open(&root, "shaders")) return false;
    bool ok = file_root_stamp(&root, name) &&
              file_root_read(&root, name, SHADER_SOURCE_SIZE_MAX, user, out);
    file_root_close(&root);
    return ok;
}

// Same source, same compiler: the same code, apart from strings of the debug information.
TEST(gpu, shaders_compile_as_in_the_build) {
    Arena arena;
    assert_true(arena_create(&arena, "sources", MIB(16)));
    assert_true(shader_blob_count > 0);
    for (u32 i = 0; i < shader_blob_count; i++) {
        const ShaderBlob *blob = &shader_blobs[i];
        u32 *words = NULL, byte_count = 0;
        char error[1024];
        ShaderSources sources = {read_shader, &arena};
        if (!shader_compile(blob->name, &sources, blob->words[1], &words, &byte_count, error,
                            sizeof error))
            fail_msg("%s", error);
        assert_int_equal(words[0], blob->words[0]);
        assert_int_equal(words[1], blob->words[1]); // version of SPIR-V
        // Opcodes of everything from the first function on, in order.
        const u32 *a = words + 5, *a_end = words + byte_count / 4;
        const u32 *b = blob->words + 5;
        enum { OP_FUNCTION = 54, OP_LINE = 8, OP_NO_LINE = 317 };
        while ((*a & 0xFFFF) != OP_FUNCTION) a += *a >> 16;
        while ((*b & 0xFFFF) != OP_FUNCTION) b += *b >> 16;
        while (a < a_end && b < blob->end) {
            if (*a != *b) fail_msg("%s: the run-time compiler makes other code", blob->name);
            a += *a >> 16;
            b += *b >> 16;
        }
        assert_true(a == a_end && b == blob->end);
        free(words);
        arena_reset(&arena);
    }
    arena_destroy(&arena);
}
