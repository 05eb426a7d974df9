// settings.h: what can be chosen while running, declared once; command line (--set key=value),
// panel, captures and defaults come from this list.
//
// Every feature is a toggle, so that it can be measured on and off.
#ifndef LUZ_SETTINGS_H
#define LUZ_SETTINGS_H
#include "../base/base.h"
#ifdef __cplusplus
extern "C" {
#endif

typedef enum RenderPath { PATH_FORWARD, PATH_DEFERRED, PATH_TILED_DEFERRED, PATH_COUNT } RenderPath;
typedef enum DebugView {
    VIEW_FINAL,
    VIEW_ALBEDO,
    VIEW_NORMAL,
    VIEW_DEPTH,
    VIEW_MATERIAL,
    VIEW_POSITION,
    VIEW_EMISSIVE,
    VIEW_TILE_LIGHTS, // heat map of the tile lists' lengths
    VIEW_COUNT
} DebugView;

typedef enum SpecularPower { SPECULAR_FAST, SPECULAR_EXACT, SPECULAR_COUNT } SpecularPower;

// S(type, name, default, min, max, words, help): type F32 | BOOL | ENUM | U32
#define RENDER_SETTINGS(S)                                                                         \
    S(ENUM, path, PATH_TILED_DEFERRED, 0, PATH_COUNT - 1, "forward deferred tiled_deferred",       \
      "how lit pixels are made")                                                                   \
    S(ENUM, view, VIEW_FINAL, 0, VIEW_COUNT - 1,                                                   \
      "final albedo normal depth material position emissive tile_lights", "picture shown")        \
    S(F32, scale, 1.0f, 0.25f, 1.0f, "", "internal resolution / window resolution")                \
    S(F32, target_ms, 0.0f, 0.0f, 1000.0f, "",                                                     \
      "frame time that a controller holds by changing scale; 0 = off (window only)")               \
    S(BOOL, shadows, 1, 0, 1, "", "shadow map of the first directional light that casts")          \
    S(BOOL, light_culling, 1, 0, 1, "", "lights outside the view are left out")                    \
    S(BOOL, mesh_culling, 1, 0, 1, "", "drawables outside the view are left out")                  \
    S(F32, lod_error_px, 0.7f, 0.0f, 16.0f, "",                                                    \
      "how far a simpler mesh may lie from the full one on the screen; 0 = always full detail")    \
    S(BOOL, subgroup_cull, 1, 0, 1, "", "tiled: each subgroup culls its tile's list by its box")   \
    S(ENUM, specular, SPECULAR_FAST, 0, SPECULAR_COUNT - 1, "fast exact",                          \
      "power of highlights: exp2 of a Pade logarithm, or pow() itself")                            \
    S(BOOL, tonemap, 1, 0, 1, "", "Reinhard; off = clamp")                                         \
    S(F32, exposure, 1.0f, 0.0f, 1000.0f, "", "factor on the level's exposure")                    \
    S(F32, light_gain, 1.0f, 0.0f, 1000.0f, "", "factor on all lights (not on ambient)")           \
    S(U32, light_limit, 0, 0, 1000000, "", "only the first N point and spot lights; 0 = all")

#define SETTING_FIELD_F32(name) f32 name;
#define SETTING_FIELD_BOOL(name) u32 name;
#define SETTING_FIELD_ENUM(name) u32 name;
#define SETTING_FIELD_U32(name) u32 name;
typedef struct RenderSettings {
#define S(type, name, ...) SETTING_FIELD_##type(name)
    RENDER_SETTINGS(S)
#undef S
} RenderSettings;

typedef enum SettingType { SETTING_F32, SETTING_BOOL, SETTING_ENUM, SETTING_U32 } SettingType;
typedef struct SettingDesc {
    const char *name, *words, *help; // words: of an ENUM, separated by blanks
    SettingType type;
    f64 initial, min, max;
    u32 offset; // of the 4-byte value in RenderSettings
} SettingDesc;
extern const SettingDesc render_setting_descs[];
extern const u32 render_setting_count;

RenderSettings settings_default(void);
// "key=value" (ENUM by word, BOOL true/false/on/off/1/0). On a mistake: LOG RENDER_SETTING with a
// suggestion, false, settings unchanged.
bool settings_set(RenderSettings *settings, const char *key_equals_value);
// Brings every value into its range (what comes from a file is not trusted).
void settings_clamp(RenderSettings *settings);
// The word of an ENUM setting's value, e.g. settings_word("path", 2) = "tiled_deferred".
const char *settings_word(const char *name, u32 value, char *out, u64 out_cap);

#ifdef __cplusplus
}
#endif
#endif
