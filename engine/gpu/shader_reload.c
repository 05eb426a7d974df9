// shader_reload.c: shaders change while the program runs (development).
//
// Data in: a directory of sources and their modification times. Data out: pipelines rebuilt behind
// their handles. Called once in a while by the shells (a key, or a look every half second). A
// broken shader leaves everything as it was: LOG SHADER_ERROR, and the text for the screen.
//
// "Newer than what runs": a source's stamp is the newest of the file and all it includes. What runs
// was made at the last reload, or with the program itself.
#include "gpu_internal.h"
#include "shader_compile.h"
#include "../base/file.h"
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Reads sources below one directory.
typedef struct SourceReader {
    FileRoot root;
    Arena *arena;
} SourceReader;

static bool source_read(void *user, const char *name, Bytes *out) {
    SourceReader *reader = user;
    if (!file_root_stamp(&reader->root, name)) return false; // no log: the compiler tells it better
    return file_root_read(&reader->root, name, SHADER_SOURCE_SIZE_MAX, reader->arena, out);
}

// The name between the quotes of an #include line, or NULL.
static const char *include_name(const char *line, const char *end, char *name, u64 cap) {
    while (line < end && (*line == ' ' || *line == '\t')) line++;
    if (end - line < 8 || strncmp(line, "#include", 8) != 0) return NULL;
    const char *open = memchr(line, '"', (size_t)(end - line));
    const char *close = open ? memchr(open + 1, '"', (size_t)(end - open - 1)) : NULL;
    if (!close || (u64)(close - open) >= cap) return NULL;
    snprintf(name, cap, "%.*s", (int)(close - open - 1), open + 1);
    return name;
}

static u64 modified_ns(int directory_fd, const char *name) {
    struct stat info;
    if (fstatat(directory_fd, name, &info, 0) != 0) return 0;
    return (u64)info.st_mtim.tv_sec * 1000000000ull + (u64)info.st_mtim.tv_nsec;
}

// Newest time of a source and of what it includes; 0 if it is not there. (Not file_root_stamp: that
// tells different from same, and the first look needs newer from older than the program.)
static u64 source_stamp(SourceReader *reader, const char *name, u32 depth) {
    u64 newest = modified_ns(reader->root.fd, name);
    Bytes text;
    if (!newest || depth > SHADER_INCLUDE_DEPTH_MAX || !source_read(reader, name, &text))
        return newest;
    const char *end_of_text = (const char *)text.data + text.size;
    for (const char *line = text.data; line < end_of_text;) {
        const char *end = memchr(line, '\n', (size_t)(end_of_text - line));
        if (!end) end = end_of_text;
        char included[256];
        if (include_name(line, end, included, sizeof included)) {
            u64 stamp = source_stamp(reader, included, depth + 1);
            newest = MAX(newest, stamp);
        }
        line = end + 1;
    }
    return newest;
}

static u64 program_stamp(void) {
    static u64 stamp;
    if (!stamp) stamp = modified_ns(AT_FDCWD, "/proc/self/exe");
    return stamp;
}

static bool shader_recompile(Gpu *gpu, GpuShader *shader, SourceReader *reader, u64 stamp) {
    char error[GPU_SHADER_ERROR_CAP];
    u32 *words, byte_count;
    ShaderSources sources = {source_read, reader};
    if (!shader_compile(shader->name, &sources, shader->words[1], &words, &byte_count, error,
                        sizeof error)) {
        shader->refused_stamp = stamp;
        shader->is_broken = true;
        snprintf(gpu->shader_error, sizeof gpu->shader_error, "%s", error);
        LOG(SHADER_ERROR, "%s", error);
        return false;
    }
    free(shader->owned);
    shader->owned = words;
    shader->words = words;
    shader->byte_count = byte_count;
    shader->stamp = stamp;
    shader->is_broken = false;
    shader->is_changed = true;
    LOG(SHADER_RELOADED, "%s", shader->name);
    return true;
}

static bool pipeline_uses_changed(const Gpu *gpu, const GpuPipelineItem *item) {
    bool has_second = !item->is_compute && item->desc.fragment;
    return gpu->shaders[item->shaders[0]].is_changed ||
           (has_second && gpu->shaders[item->shaders[1]].is_changed);
}

static u32 pipelines_rebuild(Gpu *gpu) {
    u32 rebuilt = 0;
    for (u32 i = 0; i < gpu->pipelines.count; i++) {
        GpuPipelineItem *item = gpu_pool_at(&gpu->pipelines, i);
        VkPipeline pipeline;
        if (!item || !pipeline_uses_changed(gpu, item)) continue;
        if (!gpu_pipeline_build(gpu, item, &pipeline)) {
            snprintf(gpu->shader_error, sizeof gpu->shader_error,
                     "pipeline \"%s\" cannot be built from the new shader", item->pool.label);
            continue; // the old one stays
        }
        gpu_destroy_later(gpu, VK_OBJECT_TYPE_PIPELINE, GPU_HANDLE(item->pipeline));
        item->pipeline = pipeline;
        rebuilt++;
    }
    for (u32 i = 0; i < gpu->shader_count; i++) gpu->shaders[i].is_changed = false;
    return rebuilt;
}

u32 gpu_reload_shaders(Gpu *gpu, const char *directory) {
    Arena *arena = &gpu->reload_arena;
    if (!arena->memory && !arena_create(arena, "shader reload", MIB(64))) return 0;
    SourceReader reader = {.arena = arena};
    if (!file_root_open(&reader.root, directory)) return 0;
    bool was_broken = false, is_broken = false, any_changed = false;
    for (u32 i = 0; i < gpu->shader_count; i++) {
        GpuShader *shader = &gpu->shaders[i];
        was_broken |= shader->is_broken;
        u64 mark = arena_mark(arena);
        u64 stamp = source_stamp(&reader, shader->name, 0);
        bool is_new = shader->stamp ? stamp != shader->stamp : stamp > program_stamp();
        if (stamp && is_new && stamp != shader->refused_stamp)
            any_changed |= shader_recompile(gpu, shader, &reader, stamp);
        else if (!is_new)
            shader->is_broken = false; // the edit was taken back
        arena_rewind(arena, mark);
        is_broken |= shader->is_broken;
    }
    file_root_close(&reader.root);
    if (!is_broken && (was_broken || any_changed)) gpu->shader_error[0] = 0;
    return any_changed ? pipelines_rebuild(gpu) : 0;
}

const char *gpu_shader_error(const Gpu *gpu) { return gpu->shader_error; }
