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

typedef enum RenderPath {
    PATH_FORWARD,
    PATH_MULTIPASS,
    PATH_DEFERRED,
    PATH_DEFERRED_VOLUMES,
    PATH_TILED_DEFERRED,
    PATH_TILED_FORWARD,
    PATH_CLUSTERED_DEFERRED,
    PATH_CLUSTERED_FORWARD,
    PATH_COUNT
} RenderPath;
#define PATH_WORDS                                                                                 \
    "forward multipass deferred deferred_volumes tiled_deferred tiled_forward "                    \
    "clustered_deferred clustered_forward"

// Layout of the G-buffer; what each holds and loses: render/layouts.c.
typedef enum GbufferLayout {
    LAYOUT_LEAN,
    LAYOUT_WIDE,
    LAYOUT_PACKED,
    LAYOUT_PACKED24,
    LAYOUT_HALF5,
    LAYOUT_KILLZONE2,
    LAYOUT_STARCRAFT2,
    LAYOUT_IL,
    LAYOUT_COUNT
} GbufferLayout;
#define LAYOUT_WORDS "lean wide packed packed24 half5 killzone2 starcraft2 il"

typedef enum DebugView {
    VIEW_FINAL,
    VIEW_ALBEDO,
    VIEW_NORMAL,
    VIEW_DEPTH,
    VIEW_MATERIAL,
    VIEW_POSITION,
    VIEW_EMISSIVE,
    VIEW_SPECULAR,
    VIEW_MOTION,
    VIEW_GBUFFER_0, // targets of the layout as they are
    VIEW_GBUFFER_1,
    VIEW_GBUFFER_2,
    VIEW_GBUFFER_3,
    VIEW_GBUFFER_4,
    VIEW_CELL_LIGHTS,   // heat map of the lengths of the tiles' or clusters' lists
    VIEW_TILE_DEPTH,    // nearest and farthest of each tile
    VIEW_CLUSTERS,      // a colour each
    VIEW_OVERDRAW,      // how often each pixel is drawn: fragments that pass the depth test
    VIEW_LIGHT_RECTS,   // over the final picture: screen bounds of lights
    VIEW_LIGHT_VOLUMES, // spheres and cones
    VIEW_LIGHT_STATES,  // kept, merged, dropped, by colour; why
    VIEW_LIGHT_LODS,    // near, between, far
    VIEW_OCCLUDERS,     // the depth buffer that lights are tested against
    VIEW_LAYERS,        // as overdraw, without the depth test: all that lies behind a pixel
    VIEW_GI_VOXELS,     // the voxels themselves, from the camera: what of them is setting gi.show
    VIEW_GI_INDIRECT,   // indirect light alone
    VIEW_GI_DIFFUSE,    // its parts; diffuse without albedo
    VIEW_GI_SPECULAR,
    VIEW_GI_AO,
    VIEW_GI_STEPS,  // heat map of the cones' steps
    VIEW_GI_PROBES, // each probe as a ball
    VIEW_GI_LEAKS,  // indirect light where every light that arrives has passed a surface
    VIEW_COUNT
} DebugView;
#define VIEW_WORDS                                                                                 \
    "final albedo normal depth material position emissive specular motion gbuffer_0 gbuffer_1 "    \
    "gbuffer_2 gbuffer_3 gbuffer_4 cell_lights tile_depth clusters overdraw light_rects "          \
    "light_volumes light_states light_lods occluders layers gi_voxels gi_indirect gi_diffuse "     \
    "gi_specular gi_ao gi_steps gi_probes gi_leaks"

typedef enum SpecularPower { SPECULAR_FAST, SPECULAR_EXACT, SPECULAR_COUNT } SpecularPower;
// Who decides which lights touch a tile, and how (specification of direct lighting, 6.2).
typedef enum GridMethod { GRID_RECT, GRID_FRUSTUM, GRID_GPU, GRID_METHOD_COUNT } GridMethod;
typedef enum TileDepth {
    TILE_DEPTH_OFF,
    TILE_DEPTH_MINMAX,
    TILE_DEPTH_MASK,
    TILE_DEPTH_COUNT
} TileDepth;
typedef enum TileSize { TILE_8, TILE_16, TILE_32, TILE_64, TILE_SIZE_COUNT } TileSize;
typedef enum ClusterBuild { CLUSTERS_CPU, CLUSTERS_GPU, CLUSTER_BUILD_COUNT } ClusterBuild;
// What of the screen a light of `deferred_volumes` touches: a quad, or its volume, in one of the
// ways.
typedef enum VolumeFaces {
    VOLUME_QUAD,
    VOLUME_BACK,    // back faces behind the surface: lights in the air go
    VOLUME_FRONT,   // front faces before the surface: buried lights go
    VOLUME_AUTO,    // front faces, back faces for lights that the camera is in
    VOLUME_STENCIL, // marked first, then shaded
    VOLUME_COUNT
} VolumeFaces;
typedef enum Palette { PALETTE_BUFFER, PALETTE_TEXTURE, PALETTE_COUNT } Palette;
typedef enum Msaa { MSAA_1, MSAA_4, MSAA_COUNT } Msaa;

// --- Global illumination ---
typedef enum GiFormat { GI_FORMAT_HALF, GI_FORMAT_BYTE } GiFormat;
typedef enum GiBase { GI_BASE_AUTO, GI_BASE_WHOLE, GI_BASE_BRICKS, GI_BASE_COUNT } GiBase;
typedef enum GiVoxeliser {
    GI_VOXELISER_AUTO,
    GI_VOXELISER_RASTER,
    GI_VOXELISER_COMPUTE
} GiVoxeliser;
typedef enum GiPolicy {
    GI_POLICY_ON_CHANGE,
    GI_POLICY_EVERY_FRAME,
    GI_POLICY_EVERY_N,
    GI_POLICY_NEVER // only when nothing is there yet
} GiPolicy;
typedef enum GiCosine { GI_COSINE_AVERAGE, GI_COSINE_WEIGHTED } GiCosine;
typedef enum GiFaces { GI_FACES_SHARED, GI_FACES_APART } GiFaces;
typedef enum GiFilter { GI_FILTER_DIRECTIONAL, GI_FILTER_ISOTROPIC } GiFilter;
typedef enum GiDiffuse {
    GI_DIFFUSE_NONE,
    GI_DIFFUSE_CONES,
    GI_DIFFUSE_PROBES,
    GI_DIFFUSE_VOXELS
} GiDiffuse;
typedef enum GiResolution {
    GI_RESOLUTION_FULL,
    GI_RESOLUTION_HALF,
    GI_RESOLUTION_QUARTER
} GiResolution;
typedef enum GiMips { GI_MIPS_LINEAR, GI_MIPS_NEAREST } GiMips;
typedef enum GiShow { // what VIEW_GI_VOXELS shows
    GI_SHOW_RADIANCE,
    GI_SHOW_ALBEDO,
    GI_SHOW_NORMAL,
    GI_SHOW_EMISSION,
    GI_SHOW_STATIC,
    GI_SHOW_VISIBILITY,
    GI_SHOW_IRRADIANCE,
    GI_SHOW_COUNT
} GiShow;
#define GI_SHOW_WORDS      "radiance albedo normal emission static visibility irradiance"
#define GI_DIRECTION_WORDS "+x -x +y -y +z -z"

// What the level says of GI (world/components.h, GI_COLUMNS; meaning there) and a setting "gi.NAME"
// can overrule: B(name) switch, E(name, words, how many), U(name, min, max) whole number, F(name,
// min, max). A setting's first word "level", or a number below its range (0 or -1), leaves it to
// the level.
#define GI_PARAMS(B, E, U, F)                                                                      \
    B(enabled)                                                                                     \
    E(grid, "32 64 128 256 512", 5)                                                                \
    U(cascades, 1, 3)                                                                              \
    E(format, "half byte", 2)                                                                      \
    F(byte_radiance, 0.01, 1e5)                                                                    \
    E(voxeliser, "auto raster compute", 3)                                                         \
    B(solid)                                                                                       \
    E(policy, "on_change every_frame every_n never", 4)                                            \
    U(every_n, 1, 3600)                                                                            \
    E(cosine, "average weighted", 2)                                                               \
    F(hit, 0, 1)                                                                                   \
    E(faces, "shared apart", 2)                                                                    \
    E(filter, "directional isotropic", 2)                                                          \
    U(bounces, 1, 2)                                                                               \
    B(feedback)                                                                                    \
    E(diffuse, "none cones probes voxels", 4)                                                      \
    B(specular)                                                                                    \
    B(ao)                                                                                          \
    B(cone_shadows)                                                                                \
    E(resolution, "full half quarter", 3)                                                          \
    B(dither)                                                                                      \
    E(mips, "linear nearest", 2)                                                                   \
    U(share, 1, 64)                                                                                \
    F(probe_spacing, 0.05, 100)                                                                    \
    F(strength, 0, 100)                                                                            \
    F(ao_lambda, 0, 100)                                                                           \
    F(ao_floor, 0, 1)                                                                              \
    F(step_factor, 0.1, 2.5)                                                                       \
    F(diffuse_aperture, 10, 120)                                                                   \
    F(specular_aperture, 1, 90)                                                                    \
    F(distance, 0, 1e5)                                                                            \
    F(offset, 0, 4)                                                                                \
    F(sky, 0, 100)                                                                                 \
    F(ambient, 0, 100)
// What holds for a packet: the settings' word, else the level's.
typedef struct GiParams {
#define GI_FIELD_U32(name, ...) u32 name;
#define GI_FIELD_F32(name, ...) f32 name;
    GI_PARAMS(GI_FIELD_U32, GI_FIELD_U32, GI_FIELD_U32, GI_FIELD_F32)
#undef GI_FIELD_U32
#undef GI_FIELD_F32
} GiParams;

// What belongs together, for lists and the panel: X(id, title).
#define SETTING_GROUPS(X)                                                                          \
    X(PICTURE, "picture")                                                                          \
    X(MANAGER, "light manager")                                                                    \
    X(GRID, "light lists")                                                                         \
    X(VOLUMES, "deferred volumes")                                                                 \
    X(GI, "global illumination")                                                                   \
    X(LOOKUPS, "look-ups")                                                                         \
    X(POST, "post chain")
typedef enum SettingGroup {
#define X(id, title) SETTING_GROUP_##id,
    SETTING_GROUPS(X)
#undef X
        SETTING_GROUP_COUNT
} SettingGroup;
extern const char *const setting_group_titles[SETTING_GROUP_COUNT];

// S(type, name, group, default, min, max, words, help): type F32 | BOOL | ENUM | U32
#define RENDER_SETTINGS(S)                                                                         \
    S(ENUM, path, PICTURE, PATH_TILED_DEFERRED, 0, PATH_COUNT - 1, PATH_WORDS,                     \
      "how lit pixels are made")                                                                   \
    S(ENUM, layout, PICTURE, LAYOUT_LEAN, 0, LAYOUT_COUNT - 1, LAYOUT_WORDS,                       \
      "what the G-buffer holds")                                                                   \
    S(ENUM, view, PICTURE, VIEW_FINAL, 0, VIEW_COUNT - 1, VIEW_WORDS, "picture shown")             \
    S(F32, scale, PICTURE, 1.0f, 0.25f, 1.0f, "", "internal resolution / window resolution")       \
    S(F32, target_ms, PICTURE, 0.0f, 0.0f, 1000.0f, "",                                            \
      "frame time that a controller holds by changing scale; 0 = off (window only)")               \
    S(BOOL, shadows, PICTURE, 1, 0, 1, "", "shadow map of the first directional light that casts") \
    S(BOOL, mesh_culling, PICTURE, 1, 0, 1, "", "drawables outside the view are left out")         \
    S(F32, lod_error_px, PICTURE, 0.7f, 0.0f, 16.0f, "",                                           \
      "how far a simpler mesh may lie from the full one on the screen; 0 = always full detail")    \
    S(BOOL, manager, MANAGER, 1, 0, 1, "",                                                         \
      "light manager; off = every light of the level is shaded")                                   \
    S(BOOL, light_culling, MANAGER, 1, 0, 1, "", "manager: lights outside the view are left out")  \
    S(BOOL, occlusion, MANAGER, 1, 0, 1, "",                                                       \
      "manager: lights (and drawables) behind occluders are left out")                             \
    S(BOOL, merge, MANAGER, 1, 0, 1, "", "manager: far lights that are close together become one") \
    S(BOOL, drop, MANAGER, 1, 0, 1, "",                                                            \
      "manager: lights that are too small or too faint fade out")                                  \
    S(BOOL, light_lod, MANAGER, 1, 0, 1, "", "manager: far lights lose their highlights")          \
    S(U32, budget, MANAGER, 0, 0, 4096, "",                                                        \
      "manager: lights that a region of 64 px may have; 0 = what the level says")                  \
    S(BOOL, vertex_lighting, MANAGER, 1, 0, 1, "",                                                 \
      "forward paths: far surfaces are lit per vertex, if the level says from where")              \
    S(ENUM, grid, GRID, GRID_RECT, 0, GRID_METHOD_COUNT - 1, "rect frustum gpu",                   \
      "tiles: a light's screen rectangle, the tile's frustum, or the frustum on the GPU")          \
    S(ENUM, tile_px, GRID, TILE_16, 0, TILE_SIZE_COUNT - 1, "8 16 32 64",                          \
      "side of a tile or cluster")                                                                 \
    S(ENUM, tile_depth, GRID, TILE_DEPTH_OFF, 0, TILE_DEPTH_COUNT - 1, "off minmax mask",          \
      "tiles: lists are narrowed by what depths are seen: their range, or 32 slices of it")        \
    S(BOOL, subgroup_cull, GRID, 1, 0, 1, "",                                                      \
      "tiled: each subgroup culls its tile's list by its box")                                     \
    S(ENUM, clusters, GRID, CLUSTERS_CPU, 0, CLUSTER_BUILD_COUNT - 1, "cpu gpu",                   \
      "clusters: all on the CPU, or those that are seen on the GPU")                               \
    S(BOOL, cluster_normals, GRID, 0, 0, 1, "",                                                    \
      "gpu clusters: told apart by the normal's direction too")                                    \
    S(BOOL, light_scissor, VOLUMES, 1, 0, 1, "",                                                   \
      "deferred_volumes: scissor of the light's exact bounds")                                     \
    S(ENUM, light_volume, VOLUMES, VOLUME_AUTO, 0, VOLUME_COUNT - 1,                               \
      "quad back front auto stencil", "deferred_volumes: what is drawn for a light")               \
    S(BOOL, light_branch, VOLUMES, 0, 0, 1, "",                                                    \
      "deferred_volumes: the shader stops outside the light")                                      \
    S(ENUM, msaa, PICTURE, MSAA_1, 0, MSAA_COUNT - 1, "1 4", "forward paths: samples a pixel")     \
    S(BOOL, attenuation_lookup, LOOKUPS, 0, 0, 1, "",                                              \
      "falloff from a texture instead of arithmetic")                                              \
    S(BOOL, normal_lookup, LOOKUPS, 0, 0, 1, "", "packed layouts: a normal's z from a texture")    \
    S(ENUM, palette, LOOKUPS, PALETTE_BUFFER, 0, PALETTE_COUNT - 1, "buffer texture",              \
      "where shaders read materials")                                                              \
    S(ENUM, specular, PICTURE, SPECULAR_FAST, 0, SPECULAR_COUNT - 1, "fast exact",                 \
      "power of highlights: exp2 of a Pade logarithm, or pow() itself")                            \
    S(BOOL, post, POST, 1, 0, 1, "", "the level's post chain; off = tone mapping and gamma alone") \
    S(BOOL, tonemap, POST, 1, 0, 1, "", "Reinhard; off = clamp")                                   \
    S(F32, exposure, PICTURE, 1.0f, 0.0f, 1000.0f, "", "factor on the level's exposure")           \
    S(F32, light_gain, PICTURE, 1.0f, 0.0f, 1000.0f, "", "factor on all lights (not on ambient)")  \
    S(U32, light_limit, PICTURE, 0, 0, 1000000, "",                                                \
      "only the first N point and spot lights; 0 = all")
// The same of global illumination; the key is "gi." and the name, the field gi_ and the name.
#define GI_SETTINGS(S)                                                                             \
    S(ENUM, show, GI, GI_SHOW_RADIANCE, 0, GI_SHOW_COUNT - 1, GI_SHOW_WORDS,                       \
      "view gi_voxels: what of the voxels is shown")                                               \
    S(U32, show_level, GI, 0, 0, 9, "", "view gi_voxels: level of filtered radiance; 0 = none")    \
    S(ENUM, show_direction, GI, 0, 0, 5, GI_DIRECTION_WORDS,                                       \
      "view gi_voxels: direction of filtered radiance")                                            \
    S(ENUM, base, GI, GI_BASE_AUTO, 0, GI_BASE_COUNT - 1, "auto whole bricks",                     \
      "faces shared: the finest radiance has a texel for every voxel, or bricks of them where "    \
      "there are surfaces (less memory, dearer to read); auto = bricks from 512 voxels on")

#define SETTING_FIELD_F32(name)  f32 name;
#define SETTING_FIELD_BOOL(name) u32 name;
#define SETTING_FIELD_ENUM(name) u32 name;
#define SETTING_FIELD_U32(name)  u32 name;
typedef struct RenderSettings {
#define S(type, name, ...) SETTING_FIELD_##type(name)
    RENDER_SETTINGS(S)
#undef S
#define S(type, name, ...) SETTING_FIELD_##type(gi_##name)
    GI_SETTINGS(S)
#undef S
#define GI_FIELD_U32(name, ...) u32 gi_##name;
#define GI_FIELD_F32(name, ...) f32 gi_##name;
    GI_PARAMS(GI_FIELD_U32, GI_FIELD_U32, GI_FIELD_U32, GI_FIELD_F32)
#undef GI_FIELD_U32
#undef GI_FIELD_F32
} RenderSettings;

typedef enum SettingType { SETTING_F32, SETTING_BOOL, SETTING_ENUM, SETTING_U32 } SettingType;
typedef struct SettingDesc {
    const char *name, *words, *help; // words: of an ENUM, separated by blanks
    SettingType type;
    SettingGroup group;
    f64 initial, min, max;
    u32 offset; // of the 4-byte value in RenderSettings
} SettingDesc;
extern const SettingDesc render_setting_descs[];
extern const u32 render_setting_count;

RenderSettings settings_default(void);
// Of the words, the switches, and the counts of group GI: all that pipelines can hang on.
u64 settings_switches_hash(const RenderSettings *settings);

// What settings ask of the light grid.
static inline u32 settings_tile_px(const RenderSettings *settings) {
    return 8u << settings->tile_px;
}
static inline bool settings_clustered(const RenderSettings *settings) {
    return settings->path == PATH_CLUSTERED_DEFERRED || settings->path == PATH_CLUSTERED_FORWARD;
}
static inline bool settings_tiled(const RenderSettings *settings) {
    return settings->path == PATH_TILED_DEFERRED || settings->path == PATH_TILED_FORWARD;
}
// The renderer makes the lists itself. The packet then holds lists only for blended surfaces, if
// there are any (they lie before what the depth buffer shows).
static inline bool settings_lists_on_device(const RenderSettings *settings) {
    return (settings_tiled(settings) && settings->grid == GRID_GPU) ||
           (settings_clustered(settings) && settings->clusters == CLUSTERS_GPU);
}
// "key=value" (ENUM by word, BOOL true/false/on/off/1/0). On a mistake: LOG RENDER_SETTING with a
// suggestion, false, settings unchanged.
bool settings_set(RenderSettings *settings, const char *key_equals_value);
// Several, separated by commas; a word alone is a path: "deferred,layout=packed". On a mistake:
// LOG RENDER_SETTING, false, settings unchanged.
bool settings_set_list(RenderSettings *settings, const char *list);
// A preset: settings by a name (--preset NAME). False with LOG RENDER_SETTING and a suggestion if
// there is none. What a preset does not name stays as it is.
typedef struct SettingPreset {
    const char *name, *list, *help; // list: as settings_set_list reads it
} SettingPreset;
extern const SettingPreset setting_presets[];
extern const u32 setting_preset_count;
bool settings_set_preset(RenderSettings *settings, const char *name);
// Does the setting change what is drawn, or how, with the others as they are (say, the path)?
bool setting_has_effect(const RenderSettings *settings, const SettingDesc *desc);
// Brings every value into its range (what comes from a file is not trusted).
void settings_clamp(RenderSettings *settings);
// A setting's value as settings_set reads it.
const char *setting_text(const RenderSettings *settings, const SettingDesc *desc, char *out,
                         u64 out_cap);
// The word of an ENUM setting's value, e.g. settings_word("path", 2) = "tiled_deferred".
const char *settings_word(const char *name, u32 value, char *out, u64 out_cap);

#ifdef __cplusplus
}
#endif
#endif
