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
#define BINDING_LIGHT_POSITIONS 3  // vec4[LIGHT_BLOCK_CAP], uniform: LightRecord.position
#define BINDING_LIGHT_COLORS    4  // vec4[LIGHT_BLOCK_CAP], uniform: LightRecord.color
#define BINDING_SPOT_BLOCK      5  // SpotRecord[SPOT_BLOCK_CAP], uniform
#define BINDING_FLOW            6  // FrameRecord, storage
#define BINDING_LIGHTS          7  // LightRecord[], storage, in classes (LIGHT_CLASSES); one dummy last
#define BINDING_SPOTS           8  // SpotRecord[], storage: of light index - point_count
#define BINDING_CELLS           9  // CellRecord[], storage: the packet's light grid
#define BINDING_LIGHT_INDICES   10 // uint[], storage: lists of all cells, ascending within a cell
#define BINDING_LIST_CELLS      11 // CellRecord[], storage: cells whose lists the device made
#define BINDING_LIST_INDICES    12 // uint[], storage: their lists
#define BINDING_TILE_DEPTHS     13 // TileDepthRecord[], storage
#define BINDING_CLUSTERS        14 // uint[], storage: keys of the occupied clusters, ascending
#define BINDING_PIXEL_CLUSTERS  15 // uint[], storage: a pixel's place in CLUSTERS, row by row
#define BINDING_GRID_NODES      16 // GridNode[], storage: hierarchy over the lights
#define BINDING_GRID_COUNTERS   17 // uint[GRID_COUNTER_COUNT], storage
#define BINDING_FIRST_IMAGE     18
#define BINDING_GBUFFER_0       18 // sampled; what they hold: render/layouts.c
#define BINDING_GBUFFER_1       19
#define BINDING_GBUFFER_2       20
#define BINDING_GBUFFER_3       21
#define BINDING_GBUFFER_4       22
#define BINDING_DEPTH           23 // sampled
#define BINDING_DEPTH_MS        24 // sampled, multisampled (a stand-in without MSAA)
#define BINDING_SHADOW_MAP      25 // sampled, comparison
#define BINDING_HDR             26 // sampled
#define BINDING_HDR_STORAGE     27 // storage image rgba16f
#define BINDING_HDR_OTHER       28 // sampled: the post chain's second picture
#define BINDING_LDR             29 // sampled (for the upscaling blit)
#define BINDING_LDR_OTHER       30 // sampled: the second way of a split picture
#define BINDING_ACCUMULATION    31 // sampled: deferred's full-precision light sum
#define BINDING_OVERLAY         32 // sampled: font and UI atlas
#define BINDING_PALETTE         33 // sampled: MaterialRecord as a texture, one row a material
#define BINDING_ATTENUATION     34 // sampled: 256 x 1 falloff
#define BINDING_NORMAL_Z        35 // sampled: 256 x 256, z of a normal by its x and y
#define BINDING_FRAME_COUNT     36
// --- Set 1: one group a material. ---
#define BINDING_ALBEDO_TEXTURE   0
#define BINDING_NORMAL_TEXTURE   1
#define BINDING_EMISSIVE_TEXTURE 2
#define BINDING_MATERIAL_COUNT   3

// --- Set 2 of passes that read the voxels for the screen: global illumination (render/gi.h). ---
#define BINDING_GI             0  // GiRecord, uniform
#define BINDING_GI_TRACED      1  // TracedLightRecord[GI_TRACED_CAP], uniform
#define BINDING_GI_FLOW        2  // GiRecord, storage: for values that steer loops
#define BINDING_GI_MASKS       3  // uint[], storage: see BUILD_MASKS
#define BINDING_GI_RANKS       4  // uint[], storage
#define BINDING_GI_ATTRIBUTES  5  // uint[], storage
#define BINDING_GI_ALONE       6  // uint[], storage: GI_ALONE_*
#define BINDING_GI_FIRST_IMAGE 7
#define BINDING_GI_BASE        7  // sampled 3D: radiance and opacity, one a voxel
#define BINDING_GI_ATLAS       8  // sampled 3D with mips: six directions side by side along x
#define BINDING_GI_ATLAS_NEAREST_MIP 9 // the same, the nearest mip alone
#define BINDING_GI_IRRADIANCE  10  // sampled 3D: of voxels, see gi.glsl
#define BINDING_GI_VISIBILITY  11 // sampled 3D: mean visibility of the lights
#define BINDING_GI_PROBES      12 // sampled 3D: six directions side by side along x
#define BINDING_GI_BRICKS      13 // sampled 3D: see BUILD_BRICKS
#define BINDING_GI_TRACE_0     14 // sampled: indirect diffuse (without albedo), w ambient visibility
#define BINDING_GI_TRACE_1     15 // sampled: indirect specular (without the specular colour)
#define BINDING_GI_TRACE_RAW   16 // sampled: BINDING_GI_TRACE_0 before it is smoothed (dithered cones)
#define BINDING_GI_TRACE_0_STORAGE 17 // the same, storage images rgba16f
#define BINDING_GI_TRACE_1_STORAGE 18
#define BINDING_GI_TRACE_RAW_STORAGE 19
#define BINDING_GI_COUNT       20
// --- Set 0 of passes that make the voxels (they do not see the frame's set; set 1 as ever). ---
#define BUILD_GI            0  // GiRecord, uniform
#define BUILD_FRAME         1  // FrameRecord, uniform
#define BUILD_MATERIALS     2  // MaterialRecord[], uniform
#define BUILD_DIRECTIONALS  3  // DirectionalRecord[], uniform
#define BUILD_LIGHT_BLOCK   4  // GiLightRecord[GI_LIGHT_BLOCK_CAP], uniform: the first of BUILD_LIGHTS
#define BUILD_FIRST_STORAGE 5
#define BUILD_FLOW          5  // GiRecord, storage
#define BUILD_VERTICES      6  // MeshVertex[] as uint[], storage: all meshes
#define BUILD_MESH_INDICES  7  // uint[], storage: all meshes
#define BUILD_INSTANCES     8  // InstanceRecord[], storage: the packet's gi_instances
#define BUILD_MASKS         9  // uint[], storage: a bit a voxel, in layers (GI_MASK_*)
#define BUILD_RANKS         10 // uint[], storage: set bits before every GI_RANK_WORDS words of the masks
#define BUILD_VOXELS        11 // uint[], storage: place of each occupied voxel (GI_VOXEL_*), by slot
#define BUILD_ATTRIBUTES    12 // uint[], storage: GI_ATTRIBUTE_WORDS a slot
#define BUILD_ACCUMULATORS  13 // uint[], storage: sums of what falls into a voxel
#define BUILD_RADIANCE      14 // uint[], storage: what voxels send out, half floats, by slot and face (0..2)
#define BUILD_RADIANCE_2    15 // the other three faces: one buffer of 128 MB would not hold all six
#define BUILD_COUNTERS      16 // uint[], storage: GI_COUNTER_*, and arguments of dispatches
#define BUILD_LIGHTS        17 // GiLightRecord[], storage: the packet's gi_lights
#define BUILD_LISTS         18 // uint[], storage: lights of the cells of a grid over the volume
#define BUILD_FIRST_IMAGE   19
#define BUILD_SHADOW_MAP    19 // sampled, comparison
#define BUILD_BASE          20 // sampled
#define BUILD_ATLAS         21 // sampled
#define BUILD_PROBES        22 // sampled
#define BUILD_BRICKS        23 // sampled 3D, a texel a cell of the base volume: its brick
#define BUILD_FIRST_STORAGE_IMAGE 24
#define BUILD_BASE_STORAGE  24 // storage image, format of SPEC_GI_FORMAT
#define BUILD_IRRADIANCE    25 // storage image rgba16f
#define BUILD_VISIBILITY    26 // storage image r8
#define BUILD_PROBES_STORAGE 27 // storage image rgba16f
#define BUILD_MIP_SOURCE    28 // storage image: a level of the atlas
#define BUILD_MIP_TARGET    29 // the next one
#define BUILD_BRICKS_STORAGE 30 // storage image rgba8 of BUILD_BRICKS
#define BUILD_MIP_TARGET_1  31 // those after BUILD_MIP_TARGET, up to the last level
#define BUILD_MIP_TARGET_2  32
#define BUILD_MIP_TARGET_3  33
#define BUILD_COUNT         34

// --- Specialisation constants (feature switches: an off feature behind a uniform costs as much
// as on, on the software driver). ---
#define SPEC_BRDF_MASK     0 // bit Brdf: specular lobes that the level uses; bit 4: Oren-Nayar; bit 5: Fresnel
#define SPEC_ATTENUATION   1 // Attenuation
#define SPEC_SHADOW        2 // 1: directional 0 has a shadow map (voxels: the one that says so)
#define SPEC_ALPHA_MASK    3 // geometry: discard under the cutoff
#define SPEC_SPOTS         4 // 1: there are spot lights (deferred_light: this draw is of spots)
#define SPEC_DEBUG_VIEW    5 // DebugView of the debug pass
#define SPEC_SUBGROUP_CULL 6 // tiled: per-subgroup culling of the tile's list
#define SPEC_CELL_LISTS    7 // forward shading: 1 = lights of the pixel's tile, 0 = all lights
#define SPEC_TONEMAP       8 // 1 = Reinhard, 0 = clamp
#define SPEC_DIRECTIONALS  9 // how many directional lights: of the screen; voxels: all of them
#define SPEC_LIGHT_BLOCKS  10 // 1 = the uniform blocks hold all lights, 0 = too many: use storage
#define SPEC_PIXELS_PER_LANE 11 // tiled: pixels that an invocation shades side by side (1..8)
#define SPEC_TILED_GROUP   12 // tiled: invocations of a group, 64 / pixels per lane
#define SPEC_TEXTURES      13 // geometry: bit 0 has an albedo texture, bit 1 a normal map
#define SPEC_EXACT_POWER   14 // 1 = pow() for highlights, 0 = the cheap one
#define SPEC_LAYOUT        15 // GbufferLayout
#define SPEC_TILE_SHIFT    16 // log2 of a tile's side in px: 3..6
#define SPEC_DEVICE_LISTS  17 // 1 = lists made on the device, 0 = the packet's
#define SPEC_CLUSTERED     18 // 0 = cells are tiles, 1 = clusters by slice, 2 = by PIXEL_CLUSTERS
#define SPEC_TILE_DEPTH    19 // TileDepth: 0 off, 1 min and max, 2 mask of 32 slices
#define SPEC_ATTENUATION_LOOKUP 20 // 1 = falloff from a texture
#define SPEC_NORMAL_LOOKUP 21 // 1 = z of a two-number normal from a texture
#define SPEC_PALETTE_TEXTURE 22 // 1 = materials from a texture, 0 = from the uniform buffer
#define SPEC_LIGHT_BRANCH  23 // deferred_light: stop outside range or cone
#define SPEC_SAMPLES       24 // samples a pixel: 1 or 4
#define SPEC_CLUSTER_NORMALS 25 // 1 = cluster keys have bits of the normal's direction
#define SPEC_VERTEX_LIGHTING 26 // forward shading: PacketDraw.vertex_lit
#define SPEC_POST          27 // of a post pass: a switch of its own (post_fog.frag, split.frag, tonemap.frag)
#define SPEC_GI_DIRECTIONS 28 // blocks of the atlas: 6, 1 = isotropic
#define SPEC_GI_FACES      29 // 0 = base volume and an atlas of half its size, 1 = atlas alone, of full size
#define SPEC_GI_MIPS       30 // GI_READ_*: how cones read levels of the atlas
#define SPEC_GI_CASCADES   31 // 1..GI_CASCADES_CAP
#define SPEC_GI_DIFFUSE    32 // GiDiffuse: 0 none, 1 cones, 2 probes, 3 voxels
#define SPEC_GI_FEATURES   33 // GI_FEATURE_*
#define SPEC_GI_COSINE     34 // 0 average, 1 weighted
#define SPEC_GI_STEP       35 // of a pass that runs in several steps: which
#define SPEC_GI_VISIBILITY 36 // bit VoxelShadow: ways in which voxels ask whether a light is seen
#define SPEC_GI_FORMAT     37 // 0 = rgba16f, 1 = rgba8 of radiance / GiRecord.scale.x
#define SPEC_GI_RESOLUTION 38 // log2 of pixels a traced one covers along a side: 0, 1, 2
#define SPEC_GI_TRACED     39 // bit 0: cones, bit 1: visibility volume; of lights with traced shadows
#define SPEC_GI_BRICKS     40 // 1 = the base volume has bricks where voxels are, 0 = it is whole
#define SPEC_LIST_KINDS    41 // LIST_KIND_*: what shading by lists must be ready for
#define SPEC_PALETTE_LANES 42 // tiled: materials that a lane keeps for its subgroup, 0 = none: too many
#define SPEC_GI_WAVES      43 // 1 = lanes of a subgroup, which has 8, read the atlas together (gi_cones_wave.glsl)
#define SPEC_COUNT         44

// GbufferLayout and DebugView of frame/settings.h as shaders say them (layouts.c compares).
#define GBUFFER_LAYOUT_LEAN       0
#define GBUFFER_LAYOUT_WIDE       1
#define GBUFFER_LAYOUT_PACKED     2
#define GBUFFER_LAYOUT_PACKED24   3
#define GBUFFER_LAYOUT_HALF5      4
#define GBUFFER_LAYOUT_KILLZONE2  5
#define GBUFFER_LAYOUT_STARCRAFT2 6
#define GBUFFER_LAYOUT_IL         7
#define DEBUG_ALBEDO    1
#define DEBUG_NORMAL    2
#define DEBUG_DEPTH     3
#define DEBUG_MATERIAL  4
#define DEBUG_POSITION  5
#define DEBUG_EMISSIVE  6
#define DEBUG_SPECULAR  7
#define DEBUG_MOTION    8
#define DEBUG_GBUFFER_0 9 // to 13
#define DEBUG_CELL_LIGHTS 14
#define DEBUG_TILE_DEPTH  15
#define DEBUG_CLUSTERS    16
// The pictures of global illumination, and what of the voxels is shown (setting gi.show).
#define DEBUG_GI_VOXELS   24
#define DEBUG_GI_INDIRECT 25
#define DEBUG_GI_DIFFUSE  26
#define DEBUG_GI_SPECULAR 27
#define DEBUG_GI_AO       28
#define DEBUG_GI_STEPS    29
#define DEBUG_GI_PROBES   30
#define DEBUG_GI_LEAKS    31

#define BRDF_MASK_HIGHLIGHTS 14 // all but Lambert's
#define BRDF_MASK_OREN_NAYAR 16
#define BRDF_MASK_FRESNEL    32

// Lights lie in four classes, so that those without a highlight have a loop of their own:
// points, diffuse points, spots, diffuse spots. "Points" means both first classes together.
#define LIGHT_CLASSES     4
// Lights of a tile that a subgroup keeps after culling; if more survive it shades the whole list.
#define SURVIVORS_CAP     512
// SPEC_LIST_KINDS. A loop for what is not there costs as much as one for a light.
#define LIST_KIND_LONG    1 // lists may be longer than SURVIVORS_CAP
#define LIST_KIND_DIFFUSE 2 // there are lights without a highlight, and surfaces that show one
#define MULTIPASS_LIGHTS  8 // lights of a group of path `multipass`
#define MATERIALS_CAP     256
#define PALETTE_LANES_CAP 4 // see SPEC_PALETTE_LANES
#define MESH_LODS_CAP     8 // levels of detail of a mesh, with the full one
// 64 KiB of uniform buffer, what every device offers.
#define LIGHT_BLOCK_CAP   4096
#define SPOT_BLOCK_CAP    2048
#define DIRECTIONALS_CAP  8
#define PUSH_SIZE         32 // bytes that every pipeline can be pushed
// Counters that the device writes (BINDING_GRID_COUNTERS).
#define GRID_COUNTER_INDICES   0 // list entries that the frame's lights ask for
#define GRID_COUNTER_FALLBACKS 1 // cells that got the list of all lights instead of their own
#define GRID_COUNTER_LONGEST   2 // lights of the fullest cell
#define GRID_COUNTER_CLUSTERS  3 // occupied clusters
#define GRID_COUNTER_COUNT     8
#define GRID_NODE_WIDTH        8 // children of a node of the light hierarchy
#define CLUSTER_SLICES_CAP     256
// Places in CLUSTERS and, for clusters made on the device, in LIST_CELLS.
#define CLUSTER_EMPTY          0 // of background pixels: no lights
#define CLUSTER_ALL            1 // of those that found no room: all lights
#define CLUSTER_FIRST          2 // the first occupied one
// Key of an occupied cluster: tile << 11 | direction of the normal (0..5, see cluster_keys.glsl)
// << 8 | slice.
#define CLUSTER_TILE_SHIFT     11


// --- Global illumination ---
#define GI_CASCADES_CAP 3
#define GI_TRACED_CAP   16 // lights whose shadows on the screen come from the voxels
// SPEC_GI_MIPS. Thirds: as linear, from an atlas whose upper half along z holds, in level l, what is
// a third of the way (of odd levels two thirds) to level l + 1: see gi_filter_thirds.glsl.
#define GI_READ_LINEAR  0
#define GI_READ_NEAREST 1
#define GI_READ_THIRDS  2
#define GI_FEATURE_SPECULAR 1
#define GI_FEATURE_AO       2
#define GI_FEATURE_DITHER   4
// Pixels to which no traced one is alike (gi_tiled.comp): how many there are; dispatch arguments; then
// x | y << 16 of each.
#define GI_ALONE_COUNT  0
#define GI_ALONE_GROUPS 1 // 3 words
#define GI_ALONE_FIRST  4
#define GI_ALONE_GROUP  128 // pixels of a group: even if all of 3840 x 2160 are, 65,535 groups do
// SPEC_GI_VISIBILITY, beside a bit for each VoxelShadow.
#define GI_VISIBILITY_SOLID 16 // there is a layer of solid voxels, which rays meet
#define GI_VISIBILITY_KEPT  32 // the mean over a voxel's lights is wanted
// And of the lights: some are spots; all fit into the uniform block.
#define GI_VISIBILITY_SPOTS 64
#define GI_VISIBILITY_BLOCK 128
#define GI_LIGHT_BLOCK_CAP  1024 // lights in 64 KiB
// Layers of the masks; each has a bit for every voxel of all cascades (they lie one after another
// along z): bit x + dims.x * (y + dims.y * (z + dims.z * cascade)).
#define GI_MASK_STATIC  0
#define GI_MASK_DYNAMIC 1 // of voxels that are not static
#define GI_MASK_LIT     2 // whose light is in the filtered images: the filter's own, nobody clears it
#define GI_MASK_SOLID   3 // inside of closed meshes, not on their surface; there with solid alone
#define GI_MASK_COUNT   4
// A voxel's place in one word.
#define GI_VOXEL_X_SHIFT 0  // 9 bits
#define GI_VOXEL_Y_SHIFT 9  // 9 bits
#define GI_VOXEL_Z_SHIFT 18 // 11 bits, with the cascade's offset
// What a slot holds: albedo RGBA8 (a: 255 = static), normal (3 x 10 bits, 0..1 coded; length tells
// how well the fragments agree), emission (shared exponent, see gi.glsl), then how much of the
// surface faces each axis: +x -x +y -y in bytes, +z -z in the next word.
#define GI_ATTRIBUTE_ALBEDO   0
#define GI_ATTRIBUTE_NORMAL   1
#define GI_ATTRIBUTE_EMISSION 2
#define GI_ATTRIBUTE_FACES_0  3
#define GI_ATTRIBUTE_FACES_1  4
#define GI_ATTRIBUTE_WORDS    5
// Counters. The dispatch arguments are groups of 64 slots, y = z = 1.
#define GI_COUNTER_STATIC       0 // occupied static voxels (slots 0..)
#define GI_COUNTER_DYNAMIC      1 // occupied dynamic ones (their slots follow the static ones)
#define GI_COUNTER_LOST         2 // voxels that found no slot
#define GI_COUNTER_BRICKS       3 // bricks that are wanted, with the empty one
#define GI_COUNTER_ALL_ARGS     4 // 3 words: dispatch over all slots
#define GI_COUNTER_DYNAMIC_ARGS 8 // 3 words: over the dynamic ones
#define GI_COUNTER_COUNT        16

// Bricks of the base volume (see gi.glsl): voxels along a side of a cell, texels along that of a brick,
// and how many lie in the image along x and y.
#define GI_BRICK_CELL  8
#define GI_BRICK_SIDE  (GI_BRICK_CELL + 1)
#define GI_BRICK_ROW   32
#define GI_BRICK_LAYER (GI_BRICK_ROW * GI_BRICK_ROW)

// Sums of what falls into a slot while voxels are made (BUILD_ACCUMULATORS), GI_SUM_WORDS a slot, for
// GI_WINDOW_SLOTS slots at a time. All are zero between uses. A fragment adds whole numbers below
// 2^sum_bits, which are as many as no number of triangles can make overflow (gi_voxelise.c).
#define GI_WINDOW_SLOTS      262144
#define GI_SUM_COUNT         0  // fragments
#define GI_SUM_ALBEDO        1  // rgb
#define GI_SUM_NORMAL        4  // xyz, 0..1 coded
#define GI_SUM_FACES         7  // +x -x +y -y +z -z
#define GI_SUM_EMISSION_LOW  13 // rgb: the low sum_bits bits
#define GI_SUM_EMISSION_HIGH 16 // and the bits above
#define GI_SUM_WORDS         19
#define GI_RANK_WORDS        4    // words of the masks that share a rank
#define GI_RANK_BLOCK        2048 // words of the masks that a group counts
#define GI_MIP_TAIL          4    // levels that one group of the filter makes, at most
#define GI_PARENT_CHUNKS     128  // rows of 32 x 2 x 2 voxels that a group of the filter goes through
// BUILD_COUNTERS goes on behind its counters: set bits of each block of words.
#define GI_COUNTER_BLOCKS    GI_COUNTER_COUNT
// GiDrawRecord.how.x
#define GI_DRAW_DYNAMIC       1u  // layer
#define GI_DRAW_CASCADE_SHIFT 1   // 2 bits
#define GI_DRAW_SMALL         8u  // triangles of few columns are wanted
#define GI_DRAW_LARGE         16u // those of many are
#define GI_DRAW_TWO_SIDED     32u
#define GI_DRAW_WIDE          64u // by compute: a group a triangle, not an invocation
#define GI_DRAW_BITS_SHIFT    8   // sum_bits, 4 bits
#define GI_LARGE_COLUMNS      64  // a triangle whose box covers more columns of voxels is large

// Pushed to the passes that make voxels.
SHARED_STRUCT(GiDrawRecord) {
    uvec4 mesh; // first index, vertex offset, first instance, triangles
    uvec4 how;  // GI_DRAW_*, first slot of the window in its layer, bits of the largest emission,
                // instances
} SHARED_END(GiDrawRecord)

SHARED_STRUCT(GiRecord) {
    vec4 origin[GI_CASCADES_CAP]; // xyz lower corner, world; w voxel size, m. 0 is the finest
    uvec4 dims;        // voxels of one cascade in x, y, z (powers of two), w cascades
    uvec4 atlas;       // level 0 of one direction's block, one cascade: x, y, z; w levels
    vec4 strength;     // x of indirect light, y AO lambda 1/m, z AO floor, w hit of soft rays
    vec4 cone;         // x tan(diffuse aperture / 2), y step factor, z longest distance m,
                       // w offset of the start along the normal, voxels
    vec4 specular;     // x tan(smallest aperture / 2)
    vec4 scale;        // x radiance that 1 means in format byte, y factor on the sky's light
    uvec4 light_grid;  // cells in x, y, z over all cascades' box; w lights
    vec4 light_grid_origin; // xyz world; w unused
    vec4 light_grid_rate;   // xyz cells a metre
    uvec4 probes;      // probes in x, y, z; w every so many frames a probe's turn comes
    vec4 probe_origin; // xyz of probe 0; w spacing m
    vec4 trace;        // traced pixels: width, height, 1 / width, 1 / height
    uvec4 counts;      // traced lights, instances, slots that buffers hold, tick
    uvec4 show;        // debug picture of voxels: what (GiShow), level, direction
} SHARED_END(GiRecord)

// A light as voxels see it.
SHARED_STRUCT(GiLightRecord) {
    vec4 position;   // xyz world, w 1 / range^2
    vec4 color;      // rgb * intensity; w VoxelShadow: 0 none, 1 shadow_map, 2 ray, 3 soft_ray
    vec4 direction;  // xyz unit, the way it shines; w cos outer (less than -1: a point)
    vec4 extra;      // x 1 / (cos inner - cos outer), y kind: 0 point, 1 spot, 2 directional
} SHARED_END(GiLightRecord)

// A light of the screen whose shadow comes from the voxels; the packet's other lights lack it.
SHARED_STRUCT(TracedLightRecord) {
    GiLightRecord light; // color.w: factor on the highlight
    vec4 shadow;         // x tan(aperture / 2), y softness, z 0 cone, 1 visibility volume
} SHARED_END(TracedLightRecord)

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
    vec4 attenuation;     // polynomial kc, kl, kq; w distance scale of its table (render/lookups.c)
    vec4 shadow;          // 1 / size_px, normal offset in m, distance in m, depth bias
    vec4 slices;          // slice of a cluster = clamp(floor(log2(view depth) * x + y), 0, grid.z - 1);
                          // z: view depth at which slice 0 ends, w: factor from slice to slice
    vec4 vertex_lighting; // x: local lights come from the vertices beyond this distance in m
    mat4 previous_view_projection; // of the view's last packet (its own at first): motion
    vec4 common_lobes;    // for G-buffers without a material index, the level's most common: x Brdf
                          // (of those with a highlight), y Fresnel 0/1, z Oren-Nayar A, w B
    vec4 coding;          // x: reach of coded distances in m, a power of two; y: factor of the
                          // polynomial's table
    uvec4 counts;         // points, spots, directionals, clusters' hierarchy nodes (0 = none)
    uvec4 counts2;        // materials, instances, lights of the dummy index, tick
    uvec4 counts3;        // points with a highlight, spots with a highlight, node of the spots' root
                          // (0 if there are no points), place of the hierarchy's order in the indices
    uvec4 grid;           // cells in x, y, z (1 = tiles), side in px
} SHARED_END(FrameRecord)

SHARED_STRUCT(InstanceRecord) {
    vec4 world[3];   // rows of the affine world matrix
    uvec4 ids;       // material index, drawable's entity, bits of the share (0..1) of local light
                     // that comes from the vertices, 0
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
    vec4 color;      // rgb * intensity, w factor on the highlight, 0..1
} SHARED_END(LightRecord)

SHARED_STRUCT(SpotRecord) {
    vec4 direction;  // xyz unit, the way it shines; w cos outer
    vec4 edge;       // x 1 / (cos inner - cos outer)
} SHARED_END(SpotRecord)

SHARED_STRUCT(DirectionalRecord) {
    vec4 direction;  // xyz unit, towards the light; w for voxels: VoxelShadow as in GiLightRecord,
                     // -1 = it does not light them
    vec4 color;      // rgb * intensity; w 1 = has the shadow map
} SHARED_END(DirectionalRecord)

// A cell of the light grid: a tile of the screen, or a cluster (tile and slice of depth); cells
// count x first, then y, then z. The list is ascending: points, diffuse points, spots, diffuse
// spots.
SHARED_STRUCT(CellRecord) {
    uvec4 list;      // offset into the indices, count of points, count of spots, diffuse ones of
                     // these: points in the low, spots in the high 16 bits (more than 65,535 are
                     // counted as having a highlight, whose factor is 0)
} SHARED_END(CellRecord)

// What is seen in a tile. Background does not count; a tile of background only has near > far.
SHARED_STRUCT(TileDepthRecord) {
    vec4 range;      // x near, y far: view depth in m; z 32 / (far - near)
    uvec4 mask;      // x: bit of each occupied slice of 32 between near and far; y: pixels covered
                     // (by any sample); of clusters: z how many are in the tile, w the first's place
                     // (CLUSTER_ALL: they found no room)
} SHARED_END(TileDepthRecord)

// Hierarchy over lights in Morton order (systems/light_hierarchy.c): GRID_NODE_WIDTH children a
// node (the last of a level may have fewer), leaves are lights: light_indices[counts3.w + place].
// Points have a tree of their own with node 0 as its root, then spots with the root that counts3.z
// says; a tree's levels follow each other from the root down.
SHARED_STRUCT(GridNode) {
    vec4 low;        // view-space box; w: bits of the first child (node, or place in the order)
    vec4 high;       // w: bits of the count of children; the highest bit set = children are lights
} SHARED_END(GridNode)

#endif
