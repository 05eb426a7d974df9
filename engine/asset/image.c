// image.c: image files to RGBA8 pixels and back.
//
// Data in: bytes of a PNG, JPEG, TGA or BMP. Data out: RGBA8 pixels of a bounded size; PNG files.
// Called by the store, the glTF importer, tools and tests. Does not: filter (image_mips.c), read
// other formats, or believe a header before looking at its numbers.
//
// stb_image is compiled here, privately, with only four formats and with an allocator that
// refuses what the declared size of the picture does not explain (a small picture may hold a
// deflate bomb) and hands out zeros (tables that a file never defined are then harmless).
#include "asset_internal.h"
#include "../base/log.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Largest block that the decoder may ask for, set by the thread that decodes.
static _Thread_local u64 decode_block_max;

static void *decode_malloc(size_t size) {
    return size <= decode_block_max ? calloc(1, size) : NULL;
}
static void *decode_realloc(void *old, size_t old_size, size_t size) {
    (void)old_size;
    return size <= decode_block_max ? realloc(old, size) : NULL;
}

// Both headers declare functions that these switches leave out; GCC tells at the end of the file.
#pragma GCC diagnostic ignored "-Wunused-function"

#define STBI_MALLOC(size)                       decode_malloc(size)
#define STBI_REALLOC_SIZED(old, old_size, size) decode_realloc(old, old_size, size)
#define STBI_REALLOC(old, size)                 decode_realloc(old, 0, size)
#define STBI_FREE(block)                        free(block)
#define STBI_ASSERT(x)                          ((void)0) // a file must not stop the program
#define STBI_MAX_DIMENSIONS                     ASSET_IMAGE_SIDE_MAX
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#define DECODE_BLOCK_SMALL MIB(1) // tables and rows of any picture

// What the largest block may be: 16-bit RGBA while decoding, doubled because buffers grow by
// doubling, or the compressed bytes collected, doubled as well.
static u64 block_max(u64 width, u64 height, u64 file_size) {
    return DECODE_BLOCK_SMALL + 2 * MAX(width * height * 8 + height * 16, file_size);
}

bool image_probe(Bytes file, u32 *width, u32 *height, char *why) {
    int w = 0, h = 0, channels = 0;
    *width = *height = 0;
    if (file.size == 0) {
        snprintf(why, ASSET_MESSAGE_CAP, "no bytes");
        return false;
    }
    if (file.size > ASSET_FILE_SIZE_MAX) {
        snprintf(why, ASSET_MESSAGE_CAP, "over %llu bytes",
                 (unsigned long long)ASSET_FILE_SIZE_MAX);
        return false;
    }
    if (*(const u8 *)file.data == 0xFF && !image_check_jpeg(file, why)) return false;
    decode_block_max = DECODE_BLOCK_SMALL;
    if (!stbi_info_from_memory(file.data, (int)file.size, &w, &h, &channels) || w <= 0 || h <= 0) {
        const char *reason = stbi_failure_reason();
        snprintf(why, ASSET_MESSAGE_CAP, "not a PNG, JPEG, TGA or BMP image that can be read (%s)",
                 reason ? reason : "no size");
        return false;
    }
    // The header readers of some formats do not look at the limit themselves.
    if (w > ASSET_IMAGE_SIDE_MAX || h > ASSET_IMAGE_SIDE_MAX) {
        snprintf(why, ASSET_MESSAGE_CAP, "%d x %d is over %d px a side", w, h,
                 ASSET_IMAGE_SIDE_MAX);
        return false;
    }
    *width = (u32)w;
    *height = (u32)h;
    return true;
}

void image_fit(u32 *width, u32 *height, u32 side_cap) {
    while (*width > side_cap || *height > side_cap) {
        if (*width == 1 && *height == 1) return; // a cap of 0
        *width = MAX(*width / 2, 1);
        *height = MAX(*height / 2, 1);
    }
}

// Pixels from stb_image, freed with free(). NULL with a reason.
static u8 *decode_full(Bytes file, u32 *width, u32 *height, char *why) {
    u32 probed_w, probed_h;
    if (!image_probe(file, &probed_w, &probed_h, why)) return NULL;
    int w = 0, h = 0, channels = 0;
    decode_block_max = block_max(probed_w, probed_h, file.size);
    u8 *pixels = stbi_load_from_memory(file.data, (int)file.size, &w, &h, &channels, 4);
    if (!pixels) {
        const char *reason = stbi_failure_reason();
        snprintf(why, ASSET_MESSAGE_CAP, "damaged (%s)", reason ? reason : "no reason given");
        return NULL;
    }
    // A second header inside a file must not change the size that memory was reserved for.
    if ((u32)w != probed_w || (u32)h != probed_h) {
        snprintf(why, ASSET_MESSAGE_CAP, "its size changes from %u x %u to %d x %d", probed_w,
                 probed_h, w, h);
        free(pixels);
        return NULL;
    }
    *width = probed_w;
    *height = probed_h;
    return pixels;
}

bool image_decode(Bytes file, u32 width, u32 height, TextureKind kind, u8 *out, char *why) {
    u32 w, h;
    u8 *pixels = decode_full(file, &w, &h, why);
    if (!pixels) return false;
    while (w > width || h > height) {
        image_halve(pixels, w, h, kind, pixels);
        w = MAX(w / 2, 1);
        h = MAX(h / 2, 1);
    }
    bool fits = w == width && h == height;
    if (fits)
        memcpy(out, pixels, (u64)w * h * 4);
    else
        snprintf(why, ASSET_MESSAGE_CAP, "cannot be halved to %u x %u", width, height);
    free(pixels);
    return fits;
}

bool image_read(const char *path, Arena *arena, u8 **rgba, u32 *width, u32 *height) {
    char why[ASSET_MESSAGE_CAP] = "";
    u64 mark = arena_mark(arena);
    Bytes file;
    *rgba = NULL;
    *width = *height = 0;
    if (!file_read(path, ASSET_FILE_SIZE_MAX, arena, &file)) return false;
    u8 *pixels = decode_full(file, width, height, why);
    arena_rewind(arena, mark); // the encoded bytes
    if (!pixels) {
        LOG(ASSET_IMAGE, "%s: %s", path, why);
        return false;
    }
    u64 size = (u64)*width * *height * 4;
    *rgba = scratch_try_push(arena, size, 1);
    if (*rgba) memcpy(*rgba, pixels, size);
    free(pixels);
    if (*rgba) return true;
    LOG(ASSET_LIMIT, "%s: no room for %u x %u pixels", path, *width, *height);
    return false;
}

bool image_write_png(const char *path, const u8 *pixels, u32 width, u32 height, u32 channels) {
    if ((channels != 3 && channels != 4) || !width || !height || width > 65535 || height > 65535 ||
        (u64)width * height * channels > MIB(1024)) {
        LOG(FILE_WRITE, "'%s': cannot write %u x %u pixels of %u channels as PNG", path, width,
            height, channels);
        return false;
    }
    int size = 0;
    u8 *png = stbi_write_png_to_mem(pixels, (int)(width * channels), (int)width, (int)height,
                                    (int)channels, &size);
    if (!png) {
        LOG(FILE_WRITE, "'%s': no memory to compress %u x %u pixels", path, width, height);
        return false;
    }
    bool ok = file_write(path, png, (u64)size);
    free(png);
    return ok;
}
