// Textures: painted once per run, kept as encoded images.
//
// Data in: a texture number. Data out: bytes of a JPEG or PNG for albedo and for normals. Called
// by the .glb writer; the painters (texture_*.c) are called from here only. Images tile in both
// directions. Nothing is read from disk.
#ifndef MAKE_ASSETS_TEXTURE_H
#define MAKE_ASSETS_TEXTURE_H

#include <stdbool.h>
#include <stddef.h>

enum {
    TEXTURE_ASHLAR,
    TEXTURE_CARVED,
    TEXTURE_FLOOR,
    TEXTURE_ROOF,
    TEXTURE_GRAVEL,
    TEXTURE_GRASS,
    TEXTURE_HEDGE,
    TEXTURE_BARK,
    TEXTURE_WOOD,
    TEXTURE_IRON,
    TEXTURE_WATER,
    TEXTURE_LEAF_CYPRESS,
    TEXTURE_LEAF_ROSE,
    TEXTURE_LEAF_IVY,
    TEXTURE_LEAF_FERN,
    TEXTURE_GLASS_LANCET,
    TEXTURE_GLASS_ROSE,
    TEXTURE_TAPESTRY,
    TEXTURE_COUNT,
    TEXTURE_NONE = -1
};

// What a painter fills: size * size rows from the top. Colours are sRGB 0..1, heights in metres.
typedef struct Canvas {
    int size;
    float tile_m; // metres across, for slopes
    float *rgb;   // 3 per texel
    float *height;
    float *alpha; // 0 where nothing was painted; only masked textures use it
} Canvas;

typedef struct EncodedImage {
    unsigned char *bytes;
    size_t size;
    const char *mime;
} EncodedImage;

typedef struct EncodedTexture {
    const char *name;
    EncodedImage albedo, normal; // normal.bytes is NULL where the surface is flat
} EncodedTexture;

// The result belongs to the cache; texture_free_all ends it.
const EncodedTexture *texture_get(int texture);
void texture_free_all(void);

// Writes every texture as image files into a folder, to look at.
bool texture_dump(const char *folder);

#endif
