// Materials: the one table of every surface in the level, and the textures behind them.
//
// Data in: a material or surface number. Data out: its constants. Called by the models (soup_use),
// the mesh builder (texture scale, tint) and the .glb writer. It paints nothing: see texture.h.
//
// A surface is a material, or a material with another colour and texture scale: these differ by
// vertex colours only, so that a model needs one draw for all of them.
#ifndef MAKE_ASSETS_MATERIALS_H
#define MAKE_ASSETS_MATERIALS_H

#include "texture.h"

#include <stdint.h>

enum {
    MAT_ASHLAR,      // wall of squared blocks
    MAT_CARVED,      // dressed limestone: columns, mouldings
    MAT_CARVED_DARK, // wet stone: basins, steps, kerbs
    MAT_MARBLE,      // statue, altar
    MAT_FLOOR,
    MAT_ROOF,
    MAT_GRAVEL,
    MAT_GRASS,
    MAT_MEADOW,
    MAT_HEDGE,
    MAT_BARK,
    MAT_WOOD,
    MAT_IRON,
    MAT_PLAIN, // small things without a texture, in any colour
    MAT_SOIL,
    MAT_WATER,
    MAT_SPRAY, // falling threads of water
    MAT_LEAF_CYPRESS,
    MAT_LEAF_ROSE,
    MAT_LEAF_IVY,
    MAT_LEAF_FERN,
    MAT_GLASS_LANCET, // stained glass, lit from behind
    MAT_GLASS_ROSE,
    MAT_LANTERN_GLASS,
    MAT_FLAME,
    MAT_EMBER,
    MAT_WAX,
    MAT_FIREFLY,
    MAT_CRYSTAL,
    MAT_TAPESTRY,
    MAT_HILL,
    MAT_MOON,
    MAT_PLASTER_WHITE,
    MAT_COUNT,
    // Tinted materials.
    TINT_ASHLAR_DARK = MAT_COUNT, // weathered: outer walls, tower
    TINT_VAULT,                   // small courses: vault webs
    TINT_CARVED_RED,              // every second voussoir
    TINT_CARVED_DARK,             // shaded stone: copings, thresholds
    TINT_CARVED_CLAY,             // ridge tiles
    TINT_IRON,
    TINT_BRASS,
    TINT_WAX,
    TINT_BARK,
    TINT_STONE,
    TINT_DISH, // of wax, since the candle on it shines through
    SURFACE_COUNT
};

#define TINT_NONE 0xFFFFFFFFu

typedef struct Material {
    const char *name;
    int texture; // TEXTURE_NONE or a number of texture.h; brings albedo and, if painted, normals
    float tile_m;
    float color[3]; // linear factor
    float metallic, roughness;
    float emissive[3];
    float emissive_strength;
    bool emissive_textured; // the albedo image also scales the emission
    bool masked;            // alpha test at 0.5, double sided
} Material;

typedef struct Surface {
    int material;
    float tile_m;
    uint32_t tint; // linear RGBA8, red lowest; TINT_NONE for a material as it is
} Surface;

const Material *material_get(int material); // below MAT_COUNT
Surface surface_get(int surface);           // below SURFACE_COUNT

#endif
