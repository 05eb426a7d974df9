// Materials: the one table of every surface in the level, and the textures behind them.
//
// Data in: a material number. Data out: its constants. Called by the models (soup_use), the mesh
// builder (texture scale) and the .glb writer. It paints nothing: see texture.h.
#ifndef MAKE_ASSETS_MATERIALS_H
#define MAKE_ASSETS_MATERIALS_H

#include "texture.h"

enum {
    MAT_ASHLAR,      // wall of squared blocks
    MAT_ASHLAR_DARK, // the same, weathered: outer walls, tower
    MAT_VAULT,       // the same in small courses: vault webs
    MAT_CARVED,      // dressed limestone: columns, mouldings
    MAT_CARVED_RED,  // every second voussoir
    MAT_CARVED_DARK, // wet or shaded stone: basins, steps
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
    MAT_BRASS,
    MAT_CLAY,
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
    MAT_FLAME_CORE,
    MAT_EMBER,
    MAT_WAX,
    MAT_FIREFLY,
    MAT_CRYSTAL,
    MAT_TAPESTRY,
    MAT_HILL,
    MAT_MOON,
    MAT_PLASTER_WHITE,
    MAT_COUNT
};

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

const Material *material_get(int material);

#endif
