// asset.h: everything that is loaded and then only read: meshes, images, models.
//
// An AssetStore lives as long as a level: it owns arrays of meshes, textures and models in one
// arena; ids are indices (0 = none/default, so the arrays start with a dummy). Loading is safe on
// hostile files: every limit below has a name, every failure is a message with the file's name,
// and a failed load leaves the store as it was. Nothing here knows the world or the GPU.
//
// Use: asset_store_create; asset_load_model / asset_generate_model / asset_load_texture; read
// store->meshes[id] ...; asset_store_destroy. Single-threaded.
#ifndef LUZ_ASSET_H
#define LUZ_ASSET_H
#include "../base/arena.h"
#include "../base/file.h"
#include "../base/maths.h"
#include "../../shaders/shared.h"
#ifdef __cplusplus
extern "C" {
#endif

// Limits on what comes from outside (per file unless said otherwise).
#define ASSET_FILE_SIZE_MAX      MIB(512)
#define ASSET_IMAGE_SIDE_MAX     8192  // px, before decoding; then scaled down to the texture cap
#define ASSET_TEXTURE_SIDE_CAP   2048  // px, larger images are halved until they fit
#define ASSET_VERTICES_MAX       (1u << 24)
#define ASSET_INDICES_MAX        (1u << 26)
#define ASSET_MESHES_MAX         65536 // per store
#define ASSET_TEXTURES_MAX       4096  // per store
#define ASSET_MODELS_MAX         4096  // per store
#define ASSET_PARTS_MAX          65536 // per model (nodes x primitives)
#define ASSET_MATERIALS_MAX      255   // per model
#define ASSET_LIGHTS_MAX         65536 // per model
#define ASSET_NODE_DEPTH_MAX     256

// A range of a mesh's indices. error: how far its surface lies from the full mesh, about, in
// metres of mesh space; 0 for the full mesh.
typedef struct MeshLod {
    u32 first_index, index_count;
    f32 error;
} MeshLod;

// One triangle list. Vertices are MeshVertex of shaders/shared.h (32 bytes), already ordered for
// the vertex cache and overdraw. Bounds in mesh space. Levels of detail share the vertices; their
// indices lie after each other, lods[0] is the full mesh, errors never fall.
typedef struct Mesh {
    const MeshVertex *vertices;
    const u32 *indices;            // [total_index_count]
    u32 vertex_count, index_count; // index_count: of the full mesh
    u32 total_index_count, lod_count;
    MeshLod lods[MESH_LODS_CAP];
    Vec3 min, max;      // box
    Vec3 center;        // sphere
    f32 radius;
    bool has_color;     // vertex colours differ from white
} Mesh;

typedef enum TextureKind { TEXTURE_SRGB, TEXTURE_LINEAR } TextureKind;

// RGBA8, mips tightly packed after each other, level 0 first, each level max(1, side / 2).
typedef struct Texture {
    const u8 *pixels;
    u32 width, height, mip_count;
    TextureKind kind;
    bool has_alpha; // some alpha < 255
} Texture;

// A surface as the file describes it, in the engine's terms (the columns of `material`).
typedef struct ModelMaterial {
    const char *name;
    f32 albedo[4];   // linear rgb, alpha
    f32 specular[3]; // linear; metals: base colour
    f32 power;       // 2/a^2 - 2 with a = roughness^2, clamped to 1..2048
    f32 emissive[3]; // linear, factor
    f32 emissive_strength;
    u32 alpha_mode; // 0 opaque, 1 mask, 2 blend
    f32 alpha_cutoff;
    bool double_sided;
    u32 albedo_texture, normal_texture, emissive_texture; // texture ids, 0 = none
} ModelMaterial;

typedef struct ModelPart {
    u32 mesh;     // mesh id
    u32 material; // index into the model's materials
    Mat34 local;  // part to model space
} ModelPart;

typedef struct ModelLight {
    const char *name;
    u32 kind;         // 0 point, 1 spot, 2 directional
    f32 color[3];     // linear
    f32 intensity;    // candela / lux
    f32 range;        // 0 = not given
    f32 inner_rad, outer_rad;
    Mat34 local;      // shines along -z
} ModelLight;

typedef struct ModelCamera {
    const char *name;
    f32 fov_y_rad, near;
    Mat34 local;      // looks along -z
} ModelCamera;

typedef struct Model {
    const char *name; // path below the root, or the shape's description
    u64 content_hash; // of the file (with its buffers and images) or of the shape's parameters
    const ModelPart *parts;
    const ModelMaterial *materials; // at least one
    const ModelLight *lights;
    const ModelCamera *cameras;
    u32 part_count, material_count, light_count, camera_count;
    Vec3 min, max; // of all parts, model space
} Model;

typedef struct AssetStore {
    Arena arena;   // owns everything below
    Arena scratch; // for decoding; empty between calls
    Mesh *meshes;
    Texture *textures;
    Model *models;
    u32 mesh_count, texture_count, model_count; // including the dummies at 0
    u64 stamp;     // a number that no other store ever had: tells the renderer to upload again
    u32 texture_side_cap;
} AssetStore;

typedef enum Shape {
    SHAPE_PLANE,       // 1 x 1 in xz, facing +y
    SHAPE_CUBE,        // side 1
    SHAPE_SPHERE,      // radius 0.5
    SHAPE_ICOSAHEDRON, // radius 0.5, flat
    SHAPE_CONE,        // radius 0.5, height 1, base at y = -0.5
    SHAPE_CYLINDER,    // radius 0.5, height 1, centred
    SHAPE_TORUS,       // in xz: radius 0.5 to the tube's middle, tube 0.2
    SHAPE_COUNT
} Shape;
extern const char *const shape_names[SHAPE_COUNT];

typedef struct ShapeDesc {
    Shape shape;
    u32 segments;   // around; 0 = 32 (plane: subdivisions per side, 0 = 1)
    u32 rings;      // along; 0 = segments / 2 (cone, cylinder: 1)
    f32 tube;       // torus: tube radius, 0 = 0.2
    f32 uv_repeat;  // texture repeats, 0 = 1
    bool inverted;  // faces look inwards
} ShapeDesc;

bool asset_store_create(AssetStore *store);
void asset_store_destroy(AssetStore *store);

// Model id, or 0 with a message (LOG ASSET_MODEL). Reads path and what it refers to below root.
// The same path twice gives the same id.
u32 asset_load_model(AssetStore *store, const FileRoot *root, const char *path);
// Always succeeds except at a limit (0). The same desc twice gives the same id.
u32 asset_generate_model(AssetStore *store, const ShapeDesc *desc);
// PNG, JPEG, TGA, BMP. Texture id; a damaged or missing file gives the magenta checker (id 1) and a
// warning. Same path and kind twice: same id.
u32 asset_load_texture(AssetStore *store, const FileRoot *root, const char *path,
                       TextureKind kind);
// Path below the root that the texture was loaded from; "" for those of models and for raw data.
const char *asset_texture_path(const AssetStore *store, u32 texture);

// Copies raw data into the store (captures put meshes and textures back this way). Ids, 0 at a
// limit. The caller has checked indices < vertex_count and sizes. Coarser levels of detail are made
// here, always the same for the same mesh. with_mips: rgba is level 0 alone and the chain behind
// it is made here, always the same for the same level 0.
u32 asset_add_mesh(AssetStore *store, const MeshVertex *vertices, u32 vertex_count,
                   const u32 *indices, u32 index_count);
u32 asset_add_texture(AssetStore *store, const u8 *rgba, u32 width, u32 height, TextureKind kind,
                      bool with_mips);

// Vertex packing, shared by all makers of meshes. Inputs: unit normal, tangent with sign w (+1/-1).
u32 asset_pack_normal(Vec3 normal);
u32 asset_pack_tangent(Vec3 tangent, f32 sign);
Vec3 asset_unpack_normal(u32 packed);

// PNG in and out for tools and tests: 8-bit RGB(A). Loading checks ASSET_IMAGE_SIDE_MAX first.
bool image_write_png(const char *path, const u8 *pixels, u32 width, u32 height, u32 channels);
bool image_read(const char *path, Arena *arena, u8 **rgba, u32 *width, u32 *height);

#ifdef __cplusplus
}
#endif
#endif
