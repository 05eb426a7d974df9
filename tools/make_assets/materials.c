// The material table: see materials.h. Albedo factors stay at or below 1 so that the painted
// textures keep the natural range (0.04 .. 0.6 linear) in which they were made.
#include "materials.h"

#include <stddef.h>

// name, texture, tile_m, colour, metallic, roughness, emissive, strength, textured, masked
static const Material MATERIALS[MAT_COUNT] = {
    [MAT_ASHLAR] = {"ashlar", TEXTURE_ASHLAR, 2.0f, {1, 1, 1}, 0, 0.88f, {0, 0, 0}, 0, 0, 0},
    [MAT_CARVED] = {"carved", TEXTURE_CARVED, 1.0f, {1, 1, 1}, 0, 0.72f, {0, 0, 0}, 0, 0, 0},
    [MAT_CARVED_DARK] =
        {"carved_dark", TEXTURE_CARVED, 1.0f, {0.62f, 0.63f, 0.62f}, 0, 0.45f, {0, 0, 0}, 0, 0, 0},
    [MAT_MARBLE] = {"marble", TEXTURE_CARVED, 0.8f, {1, 1, 1}, 0, 0.38f, {0, 0, 0}, 0, 0, 0},
    [MAT_FLOOR] = {"floor", TEXTURE_FLOOR, 1.5f, {1, 1, 1}, 0, 0.42f, {0, 0, 0}, 0, 0, 0},
    [MAT_ROOF] = {"roof", TEXTURE_ROOF, 1.5f, {1, 1, 1}, 0, 0.8f, {0, 0, 0}, 0, 0, 0},
    [MAT_GRAVEL] = {"gravel", TEXTURE_GRAVEL, 1.2f, {1, 1, 1}, 0, 0.9f, {0, 0, 0}, 0, 0, 0},
    [MAT_GRASS] = {"grass", TEXTURE_GRASS, 1.6f, {1, 1, 1}, 0, 0.85f, {0, 0, 0}, 0, 0, 0},
    [MAT_MEADOW] =
        {"meadow", TEXTURE_GRASS, 3.0f, {0.75f, 0.8f, 0.7f}, 0, 0.95f, {0, 0, 0}, 0, 0, 0},
    [MAT_HEDGE] = {"hedge", TEXTURE_HEDGE, 0.8f, {1, 1, 1}, 0, 0.92f, {0, 0, 0}, 0, 0, 0},
    [MAT_BARK] = {"bark", TEXTURE_BARK, 0.6f, {1, 1, 1}, 0, 0.92f, {0, 0, 0}, 0, 0, 0},
    [MAT_WOOD] = {"wood", TEXTURE_WOOD, 1.2f, {1, 1, 1}, 0, 0.62f, {0, 0, 0}, 0, 0, 0},
    [MAT_IRON] = {"iron", TEXTURE_IRON, 0.25f, {1, 1, 1}, 0.85f, 0.5f, {0, 0, 0}, 0, 0, 0},
    [MAT_PLAIN] = {"plain", TEXTURE_NONE, 1, {1, 1, 1}, 0, 0.45f, {0, 0, 0}, 0, 0, 0},
    [MAT_SOIL] = {"soil", TEXTURE_NONE, 1, {0.05f, 0.036f, 0.026f}, 0, 0.95f, {0, 0, 0}, 0, 0, 0},
    [MAT_WATER] = {"water", TEXTURE_WATER, 1.1f, {1, 1, 1}, 0, 0.06f, {0, 0, 0}, 0, 0, 0},
    [MAT_SPRAY] =
        {"spray", TEXTURE_NONE, 1, {0.5f, 0.6f, 0.66f}, 0, 0.15f, {0.3f, 0.55f, 0.7f}, 0.12f, 0, 0},
    [MAT_LEAF_CYPRESS] =
        {"leaf_cypress", TEXTURE_LEAF_CYPRESS, 1, {1, 1, 1}, 0, 0.85f, {0, 0, 0}, 0, 0, 1},
    [MAT_LEAF_ROSE] = {"leaf_rose", TEXTURE_LEAF_ROSE, 1, {1, 1, 1}, 0, 0.85f, {0, 0, 0}, 0, 0, 1},
    [MAT_LEAF_IVY] = {"leaf_ivy", TEXTURE_LEAF_IVY, 1, {1, 1, 1}, 0, 0.85f, {0, 0, 0}, 0, 0, 1},
    [MAT_LEAF_FERN] = {"leaf_fern", TEXTURE_LEAF_FERN, 1, {1, 1, 1}, 0, 0.85f, {0, 0, 0}, 0, 0, 1},
    [MAT_GLASS_LANCET] = {"glass_lancet",
                          TEXTURE_GLASS_LANCET,
                          1,
                          {0.25f, 0.25f, 0.25f},
                          0,
                          0.2f,
                          {1, 1, 1},
                          1.6f,
                          1,
                          0},
    [MAT_GLASS_ROSE] = {"glass_rose",
                        TEXTURE_GLASS_ROSE,
                        1,
                        {0.25f, 0.25f, 0.25f},
                        0,
                        0.2f,
                        {1, 1, 1},
                        3.0f,
                        1,
                        0},
    [MAT_LANTERN_GLASS] = {"lantern_glass",
                           TEXTURE_NONE,
                           1,
                           {0.6f, 0.4f, 0.2f},
                           0,
                           0.25f,
                           {1, 0.46f, 0.13f},
                           3.2f,
                           0,
                           0},
    [MAT_FLAME] =
        {"flame", TEXTURE_NONE, 1, {0.1f, 0.06f, 0.03f}, 0, 1, {1, 0.44f, 0.1f}, 6.5f, 0, 0},
    [MAT_EMBER] =
        {"ember", TEXTURE_NONE, 1, {0.04f, 0.02f, 0.015f}, 0, 1, {1, 0.2f, 0.03f}, 2.2f, 0, 0},
    [MAT_WAX] =
        {"wax", TEXTURE_NONE, 1, {0.72f, 0.62f, 0.45f}, 0, 0.5f, {1, 0.55f, 0.2f}, 0.12f, 0, 0},
    [MAT_FIREFLY] =
        {"firefly", TEXTURE_NONE, 1, {0.3f, 0.3f, 0.1f}, 0, 1, {0.72f, 1, 0.16f}, 3.2f, 0, 0},
    [MAT_CRYSTAL] =
        {"crystal", TEXTURE_NONE, 1, {0.25f, 0.35f, 0.5f}, 0, 0.12f, {0.3f, 0.6f, 1}, 2.5f, 0, 0},
    [MAT_TAPESTRY] = {"tapestry", TEXTURE_TAPESTRY, 1, {1, 1, 1}, 0, 0.95f, {0, 0, 0}, 0, 0, 0},
    [MAT_HILL] = {"hill", TEXTURE_NONE, 1, {0.022f, 0.034f, 0.026f}, 0, 1, {0, 0, 0}, 0, 0, 0},
    [MAT_MOON] = {"moon", TEXTURE_NONE, 1, {0, 0, 0}, 0, 1, {0.95f, 0.96f, 1}, 3.5f, 0, 0},
    [MAT_PLASTER_WHITE] =
        {"plaster_white", TEXTURE_NONE, 1, {0.73f, 0.73f, 0.72f}, 0, 0.9f, {0, 0, 0}, 0, 0, 0},
};

typedef struct Tint {
    int material;
    float tile_m;
    float color[3]; // times the material's
} Tint;

static const Tint TINTS[SURFACE_COUNT - MAT_COUNT] = {
    [TINT_ASHLAR_DARK - MAT_COUNT] = {MAT_ASHLAR, 2.0f, {0.72f, 0.74f, 0.78f}},
    [TINT_VAULT - MAT_COUNT] = {MAT_ASHLAR, 1.35f, {1, 0.96f, 0.9f}},
    [TINT_CARVED_RED - MAT_COUNT] = {MAT_CARVED, 1.0f, {0.78f, 0.5f, 0.4f}},
    [TINT_CARVED_DARK - MAT_COUNT] = {MAT_CARVED, 1.0f, {0.62f, 0.63f, 0.62f}},
    [TINT_CARVED_CLAY - MAT_COUNT] = {MAT_CARVED, 1.0f, {0.9f, 0.42f, 0.28f}},
    [TINT_IRON - MAT_COUNT] = {MAT_PLAIN, 1.0f, {0.05f, 0.047f, 0.044f}},
    [TINT_BRASS - MAT_COUNT] = {MAT_PLAIN, 1.0f, {0.5f, 0.31f, 0.1f}},
    [TINT_WAX - MAT_COUNT] = {MAT_PLAIN, 1.0f, {0.78f, 0.68f, 0.5f}},
    [TINT_BARK - MAT_COUNT] = {MAT_PLAIN, 1.0f, {0.11f, 0.07f, 0.045f}},
    [TINT_STONE - MAT_COUNT] = {MAT_PLAIN, 1.0f, {0.24f, 0.22f, 0.18f}},
    [TINT_DISH - MAT_COUNT] = {MAT_WAX, 1.0f, {0.6f, 0.42f, 0.2f}},
};

static uint32_t pack_byte(float v) { return (uint32_t)(v * 255 + 0.5f); }

Surface surface_get(int surface) {
    if (surface < MAT_COUNT) return (Surface){surface, MATERIALS[surface].tile_m, TINT_NONE};
    const Tint *t = TINTS + (surface - MAT_COUNT);
    uint32_t tint = pack_byte(t->color[0]) | pack_byte(t->color[1]) << 8 |
                    pack_byte(t->color[2]) << 16 | 0xFF000000u;
    return (Surface){t->material, t->tile_m, tint};
}

const Material *material_get(int material) {
    return material >= 0 && material < MAT_COUNT ? MATERIALS + material : NULL;
}
