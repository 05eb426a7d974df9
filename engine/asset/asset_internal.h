// asset_internal.h: what the files of engine/asset share and nobody else includes.
//
// Three inner interfaces: the store's private part (store.c), meshes on their way from loose
// vertices to packed ones (mesh_process.c), images from a file's bytes to mip chains (image.c,
// image_mips.c). The glTF importer's own header is gltf_raw.h.
#ifndef LUZ_ASSET_INTERNAL_H
#define LUZ_ASSET_INTERNAL_H
#include "asset.h"
#ifdef __cplusplus
extern "C" {
#endif

#define ASSET_MESSAGE_CAP 256 // bytes of a reason handed up to the one place that logs it

// ---- store.c ----

#define ASSET_TEXTURE_CHECKER 1 // stands in for a damaged or missing image

// State of a store at one moment: taken before a load, put back when the load fails.
typedef struct StoreMark {
    u64 arena, scratch;
    u32 mesh_count, texture_count, model_count;
} StoreMark;
StoreMark store_mark(const AssetStore *store);
void store_rewind(AssetStore *store, StoreMark mark);
// The model of this name, or 0.
u32 store_find_model(const AssetStore *store, const char *name);
// Copies the struct (its arrays must live in store->arena). 0 with a message at the limit.
u32 store_add_model(AssetStore *store, const Model *model);
// Room for level 0 and its mips in the store's arena; the caller fills level 0 and calls
// image_build_mips. 0 with a message at a limit. The pixels may be written until the load ends.
u32 store_reserve_texture(AssetStore *store, u32 width, u32 height, TextureKind kind,
                          bool with_mips, u8 **pixels);
// Models share textures: the one of this kind that was made from encoded bytes of this hash, or 0;
// and makes a complete texture one that can be found.
u32 store_find_texture(const AssetStore *store, u64 hash, TextureKind kind);
void store_share_texture(AssetStore *store, u32 texture, u64 hash);
// Memory that may be refused, for sizes that come from outside: NULL instead of an assert.
void *scratch_try_push(Arena *arena, u64 count, u64 size);
// The box of eight transformed corners grows the model's box.
void model_grow_bounds(Model *model, const Mesh *mesh, const Mat34 *local, bool first);

// ---- mesh_process.c, mesh_tangents.c ----

// A vertex before packing. Plain floats without padding: welding compares bytes.
typedef struct SourceVertex {
    Vec3 position;
    Vec3 normal;  // unit, or zero where the source has none (then +y)
    Vec4 tangent; // xyz unit, w +1 or -1: bitangent = cross(normal, tangent) * w, towards -v
    Vec2 uv;      // v grows downwards, as in glTF
    u32 color;    // RGBA8, linear
} SourceVertex;

typedef struct MeshSource {
    SourceVertex *vertices; // changed by processing
    u32 *indices;           // NULL: every three vertices are a triangle
    u32 vertex_count, index_count;
    bool has_normals, has_tangents, has_uvs;
} MeshSource;

// Loose triangles to a mesh: flat normals where there are none, equal vertices welded,
// degenerate triangles dropped, tangents made where there are none, order for the vertex cache,
// overdraw and fetch, packing. Indices must be < vertex_count and numbers finite. Works in the
// store's scratch (given back). A mesh id; 0 with `why` filled, or empty: no triangle is left.
u32 mesh_process(AssetStore *store, MeshSource *source, char *why);
// Fills tangents from uvs; vertices whose triangles disagree in handedness are split. `vertices`
// has room for 2 * vertex_count. Returns the new vertex count; 0: no scratch memory.
u32 mesh_make_tangents(Arena *scratch, SourceVertex *vertices, u32 vertex_count, u32 *indices,
                       u32 index_count);
// Any unit vector at a right angle to a unit normal.
Vec3 mesh_any_tangent(Vec3 normal);
// A mirrored copy: x negated, winding reversed, so that with a mirroring matrix in front of it
// (local * mirror) the product looks the same and its determinant is positive. 0 at a limit.
u32 mesh_add_mirrored(AssetStore *store, u32 mesh);

// ---- mesh_lods.c ----

// Coarser levels of a full mesh: vertices, indices, counts and bounds are filled in. Fills lods,
// lod_count and total_index_count. The indices of the coarser levels, total_index_count -
// index_count of them, in scratch memory; NULL if there are none.
const u32 *mesh_make_lods(Arena *scratch, Mesh *mesh);

// ---- image.c, image_check.c, image_mips.c ----

// Reads the header only. False with a reason: not an image we read, or over the side limit.
bool image_probe(Bytes file, u32 *width, u32 *height, char *why);
// The size after halving until both sides fit the cap.
void image_fit(u32 *width, u32 *height, u32 side_cap);
// Decodes to RGBA8 and halves to `width` x `height` (from image_fit) into out. Thread-safe.
bool image_decode(Bytes file, u32 width, u32 height, TextureKind kind, u8 *out, char *why);
// Walks a JPEG's segments before any decoder sees them.
bool image_check_jpeg(Bytes file, char *why);

u32 image_mip_count(u32 width, u32 height);
u64 image_mips_size(u32 width, u32 height, u32 mip_count);
// Fills levels 1.. behind level 0. A pure function of level 0, so a saved level 0 is enough.
void image_build_mips(u8 *pixels, u32 width, u32 height, TextureKind kind);
// One halving, in place allowed. out has max(1, w/2) * max(1, h/2) pixels.
void image_halve(const u8 *in, u32 width, u32 height, TextureKind kind, u8 *out);
bool image_has_alpha(const u8 *rgba, u64 pixel_count);

#ifdef __cplusplus
}
#endif
#endif
