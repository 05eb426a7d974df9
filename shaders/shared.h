// shared.h: what C and GLSL must agree on: structs, bindings, limits. Included by both; a test
// compares it with SPIR-V reflection. Only 4-byte scalars and vec4 (std430 without padding).
#ifndef LUZ_SHARED_H
#define LUZ_SHARED_H

#ifdef GL_core_profile
#define SHARED_STRUCT(Name) struct Name
#define SHARED_END(Name)    ;
#else
#include <stdint.h>
typedef float vec4[4];
typedef uint32_t uvec4[4];
typedef float mat4[16]; // column-major
#define SHARED_STRUCT(Name) typedef struct Name
#define SHARED_END(Name)    Name;

// Vertex of every mesh: 32 bytes, one interleaved stream. The depth-only passes read it as well:
// 12 of 32 bytes are used there, measured cheaper than a second stream on few vertices.
typedef struct MeshVertex {
    float position[3];
    uint32_t normal;  // octahedral, 2 x snorm16 (x low)
    float uv[2];
    uint32_t tangent; // octahedral, snorm16 x low, snorm15 y, highest bit: sign is -1
    uint32_t color;   // RGBA8 unorm, linear
} MeshVertex;
#endif

// --- Set 0: the frame. Every pipeline has the same layout, every binding is always written.
// Uniform buffers hold what many invocations read alike, and materials: on the software driver a
// vec4 costs 43 ns a pixel from a storage buffer in a fragment shader (a loop over the lanes), and
// hardly anything from a uniform buffer. But values that steer control flow must not come from
// a uniform buffer (that driver recompiles the shader whenever they change): those are read from
// BINDING_FLOW, the same FrameRecord as a storage buffer, or are specialisation constants. ---
#define BINDING_FRAME           0  // FrameRecord, uniform
#define BINDING_MATERIALS       1  // MaterialRecord[MATERIALS_CAP], uniform
#define BINDING_DIRECTIONALS    2  // DirectionalRecord[DIRECTIONALS_CAP], uniform
#define BINDING_LIGHT_BLOCK_0   3  // LightRecord[LIGHT_BLOCK_CAP], uniform: lights from 0
#define BINDING_LIGHT_BLOCK_1   4  // LightRecord[LIGHT_BLOCK_CAP], uniform: the next
#define BINDING_SPOT_BLOCK      5  // SpotRecord[SPOT_BLOCK_CAP], uniform
#define BINDING_FLOW            6  // FrameRecord, storage
#define BINDING_LIGHTS          7  // LightRecord[], storage: points first, then spots; one dummy last
#define BINDING_SPOTS           8  // SpotRecord[], storage: of light index - point_count
#define BINDING_TILES           9  // TileRecord[], storage
#define BINDING_LIGHT_INDICES   10 // uint[], storage: lists of all tiles, ascending within a tile
#define BINDING_GBUFFER_ALBEDO  11 // sampled
#define BINDING_GBUFFER_NORMAL  12 // sampled
#define BINDING_DEPTH           13 // sampled
#define BINDING_SHADOW_MAP      14 // sampled, comparison
#define BINDING_HDR             15 // sampled
#define BINDING_HDR_STORAGE     16 // storage image rgba16f
#define BINDING_LDR             17 // sampled (for the upscaling blit)
#define BINDING_ACCUMULATION    18 // sampled: deferred's full-precision light sum
#define BINDING_OVERLAY         19 // sampled: font and UI atlas
#define BINDING_FRAME_COUNT     20
// --- Set 1: one group a material. ---
#define BINDING_ALBEDO_TEXTURE   0
#define BINDING_NORMAL_TEXTURE   1
#define BINDING_EMISSIVE_TEXTURE 2
#define BINDING_MATERIAL_COUNT   3

// --- Specialisation constants (feature switches: an off feature behind a uniform costs as much
// as on, on the software driver). ---
#define SPEC_BRDF_MASK     0 // bit Brdf: specular lobes that the level uses; bit 4: Oren-Nayar; bit 5: Fresnel
#define SPEC_ATTENUATION   1 // Attenuation
#define SPEC_SHADOW        2 // 1: directional 0 has a shadow map
#define SPEC_ALPHA_MASK    3 // geometry: discard under the cutoff
#define SPEC_SPOTS         4 // 1: there are spot lights (deferred_light: this draw is of spots)
#define SPEC_DEBUG_VIEW    5 // DebugView of the debug pass
#define SPEC_SUBGROUP_CULL 6 // tiled: per-subgroup culling of the tile's list
#define SPEC_TILE_LISTS    7 // forward shading: 1 = lights of the pixel's tile, 0 = all lights
#define SPEC_TONEMAP       8 // 1 = Reinhard, 0 = clamp
#define SPEC_DIRECTIONALS  9 // how many directional lights
#define SPEC_LIGHT_BLOCKS  10 // uniform blocks that hold all lights: 1, 2; 0 = too many, use storage
#define SPEC_PIXELS_PER_LANE 11 // tiled: pixels that an invocation shades in turn (1..8)
#define SPEC_TILED_GROUP   12 // tiled: invocations of a group, 64 / pixels per lane
#define SPEC_TEXTURES      13 // geometry: bit 0 has an albedo texture, bit 1 a normal map
#define SPEC_EXACT_POWER   14 // 1 = pow() for highlights, 0 = the cheap one
#define SPEC_COUNT         15

#define BRDF_MASK_OREN_NAYAR 16
#define BRDF_MASK_FRESNEL    32

// Tile side in pixels of the light grid (edge tiles are cut by the screen).
#define TILE_SIZE_PX 16
// Lights of a tile that a subgroup keeps after culling; if more survive it shades the whole list.
#define SURVIVORS_CAP     512
#define MATERIALS_CAP     256
#define MESH_LODS_CAP     4 // levels of detail of a mesh, with the full one
// 64 KiB of uniform buffer, what every device offers.
#define LIGHT_BLOCK_CAP   2048
#define SPOT_BLOCK_CAP    4096
#define DIRECTIONALS_CAP  8
#define OVERLAY_PUSH_SIZE 16 // vec2 1 / size, padded: overlay and present

SHARED_STRUCT(FrameRecord) {
    mat4 view_projection; // world to clip, reversed depth, infinite far
    mat4 view;            // world to view
    mat4 shadow_matrix;   // world to shadow clip (directional 0)
    // World position of a pixel = camera + (ray_right * ndc.x + ray_up * ndc.y + ray_forward)
    // * near / depth: no inverse matrix per pixel. ndc.y points up.
    vec4 camera;          // xyz world, w near
    vec4 ray_right;       // camera right * tan(fov_x / 2)
    vec4 ray_up;          // camera up * tan(fov_y / 2)
    vec4 ray_forward;     // unit
    vec4 viewport;        // width, height in px, 1 / width, 1 / height
    vec4 ambient;         // radiance times albedo; w exposure
    vec4 sky_zenith;      // rgb; w stars
    vec4 sky_horizon;     // rgb; w time in s (for the shader's own sparkle)
    vec4 attenuation;     // polynomial kc, kl, kq
    vec4 shadow;          // 1 / size_px, normal offset in m, distance in m, depth bias
    uvec4 counts;         // points, spots, directionals, tiles per row
    uvec4 counts2;        // materials, instances, lights of the dummy index, tick
} SHARED_END(FrameRecord)

SHARED_STRUCT(InstanceRecord) {
    vec4 world[3];   // rows of the affine world matrix
    uvec4 ids;       // material index, drawable's entity, 0, 0
} SHARED_END(InstanceRecord)

SHARED_STRUCT(MaterialRecord) {
    vec4 albedo;     // linear rgb, w alpha cutoff
    vec4 specular;   // linear rgb, w power
    vec4 emissive;   // rgb radiance (0 if it has an emissive texture: drawn by its own pass);
                     // w: 1 = receives dynamic light
    vec4 lobes;      // x Brdf, y normalisation of the specular lobe, z Oren-Nayar A, w B (A = 1,
                     // B = 0 is Lambert)
    vec4 extra;      // x fresnel 0/1, yzw emissive radiance factor for the textured pass
} SHARED_END(MaterialRecord)

SHARED_STRUCT(LightRecord) {
    vec4 position;   // xyz world, w 1 / range^2
    vec4 color;      // rgb * intensity, w spot: 1 / (cos inner - cos outer)
} SHARED_END(LightRecord)

SHARED_STRUCT(SpotRecord) {
    vec4 direction;  // xyz unit, the way it shines; w cos outer
} SHARED_END(SpotRecord)

SHARED_STRUCT(DirectionalRecord) {
    vec4 direction;  // xyz unit, towards the light
    vec4 color;      // rgb * intensity; w 1 = has the shadow map
} SHARED_END(DirectionalRecord)

SHARED_STRUCT(TileRecord) {
    uvec4 list;      // offset into light indices, count of points, count of spots, 0
} SHARED_END(TileRecord)

#endif
