// gltf_raw.h: the glTF importer's inner arrays, between the C++ parser and the C that builds.
//
// The way of a file: gltf_files.c reads it -> gltf_scan.c looks at its container and JSON before
// any parser does -> gltf.cpp parses it into GltfRaw (plain arrays, indices as written) ->
// gltf_check.c refuses what does not hold together -> gltf_read.c, gltf_mesh.c,
// gltf_material.c, gltf_model.c build from it. All arrays lie in the store's scratch arena; buffer
// and image bytes belong to `owner` and live until gltf_free.
#ifndef LUZ_GLTF_RAW_H
#define LUZ_GLTF_RAW_H
#include "asset_internal.h"
#ifdef __cplusplus
extern "C" {
#endif

// Limits of the text, checked before it is parsed. Arrays at the top level have their own limits
// (gltf_scan.c), because each of their elements becomes a large C++ object.
#define GLTF_JSON_SIZE_MAX    MIB(128)
#define GLTF_JSON_DEPTH_MAX   64
#define GLTF_JSON_VALUES_MAX  (1u << 23)
#define GLTF_JSON_OBJECTS_MAX (1u << 20)
#define GLTF_PATH_CAP         1024
#define GLTF_COORDINATE_MAX   1e9f         // m; keeps sums and squares of coordinates finite
#define GLTF_PIXELS_MAX       (1ull << 30) // of all images of a file, before scaling down

typedef struct GltfView {
    i32 buffer;
    u64 offset, length, stride; // stride 0: packed
} GltfView;

typedef struct GltfAccessor {
    i32 view; // -1: zeros
    u64 offset, count;
    u32 component_type, rows, columns; // columns 1 unless a matrix
    bool normalized, sparse;
    i64 sparse_count, sparse_index_offset, sparse_value_offset;
    i32 sparse_index_view, sparse_value_view;
    u32 sparse_index_type;
} GltfAccessor;

typedef struct GltfImage {
    Bytes bytes; // embedded or read; empty where `view` is set or reading failed
    i32 view;
    Bytes uri; // as written; empty for embedded images
} GltfImage;

typedef struct GltfTexture {
    i32 image, sampler;
} GltfTexture;

typedef struct GltfTextureRef {
    i32 texture; // -1: none
    i32 set;     // TEXCOORD_n
    bool has_transform;
    f32 offset[2], rotation_rad, scale[2]; // KHR_texture_transform
} GltfTextureRef;

typedef struct GltfMaterial {
    const char *name;
    f32 base[4], metallic, roughness, emissive[3], emissive_strength, cutoff, normal_scale;
    f32 specular_factor, specular_color[3]; // KHR_materials_specular
    u32 alpha_mode;                         // 3: unknown word
    bool double_sided, unlit, has_specular_textures;
    GltfTextureRef base_texture, metallic_roughness_texture, normal_texture, emissive_texture;
} GltfMaterial;

enum { GLTF_ABSENT = -1 };       // accessor of an attribute that is not there
enum { GLTF_PARENT_SCENE = -2 }; // instead of a parent

typedef struct GltfPrimitive {
    i32 position, normal, tangent, color, uv[2]; // accessors
    i32 indices, material, mode;
    bool morphs;
} GltfPrimitive;

typedef struct GltfMesh {
    u32 first_primitive, primitive_count;
} GltfMesh;

typedef struct GltfNode {
    const char *name;
    u32 first_child, child_count; // in GltfRaw.children
    i32 mesh, camera, light, skin;
    bool malformed; // a matrix, translation ... of a wrong length
    f32 local[16];  // column-major
    i32 parent;     // filled by gltf_check; -1 none, GLTF_PARENT_SCENE a root of the scene
} GltfNode;

typedef struct GltfCamera {
    const char *name;
    bool perspective;
    f32 fov_y_rad, near;
} GltfCamera;

typedef struct GltfLight {
    const char *name;
    u32 kind; // ModelLight.kind; 3: unknown word
    f32 color[3], intensity, range, inner_rad, outer_rad;
    bool malformed;
} GltfLight;

typedef struct GltfRaw {
    void *owner;        // tinygltf's model
    const char *remark; // what the parser left out of skins and animations, "" = nothing
    const char *version, *min_version;
    const char **required; // extensionsRequired
    Bytes *buffers, *buffer_uris;
    GltfView *views;
    GltfAccessor *accessors;
    GltfImage *images;
    GltfTexture *textures;
    GltfMaterial *materials;
    GltfPrimitive *primitives;
    GltfMesh *meshes;
    GltfNode *nodes;
    i32 *children, *roots; // node indices; roots of the scene that is shown
    GltfCamera *cameras;
    GltfLight *lights;
    u32 required_count, buffer_count, view_count, accessor_count, image_count, texture_count,
        material_count, primitive_count, mesh_count, node_count, child_count, root_count,
        camera_count, light_count, skin_count, animation_count, sampler_count, scene_count;
    i32 scene; // -1: the file names none
} GltfRaw;

// ---- gltf_files.c: everything that is read from disk on behalf of a model ----

typedef struct GltfFiles {
    const FileRoot *root;
    Arena *scratch;
    char directory[GLTF_PATH_CAP]; // of the model below the root, "" for the root itself
    u64 bytes_left;                // of ASSET_FILE_SIZE_MAX for all files together
    u64 hash;                      // of all bytes read, in order
} GltfFiles;

// A file named by a uri, already percent-decoded, relative to the model. False with `why`.
bool gltf_files_read(GltfFiles *files, const char *name, u64 name_size, Bytes *out, char *why);
typedef enum GltfUri { GLTF_URI_OK, GLTF_URI_SCHEME, GLTF_URI_BAD } GltfUri;
// Percent-decodes a raw uri once into out (GLTF_PATH_CAP bytes). BAD: NUL, control characters,
// encoded slashes, absolute, or climbing out of the root. SCHEME: "http:" and the like.
GltfUri gltf_uri_decode(const GltfFiles *files, Bytes uri, char *out, char *why);
// A printable copy of text from a file, cut to at most 120 bytes.
const char *gltf_copy_text(Arena *arena, const char *text, u64 size);

// ---- gltf_scan.c: before parsing ----

// The JSON of a file and whether it is a binary container; checks container and text.
bool gltf_scan(Bytes file, Bytes *json, bool *binary, char *why);

// ---- gltf.cpp: parsing ----

bool gltf_parse(Bytes file, Bytes json, bool binary, GltfFiles *files, GltfRaw *raw, char *why);
void gltf_free(GltfRaw *raw);

// ---- gltf_check.c: every index, range and number that later code relies on ----

bool gltf_check(GltfRaw *raw, const GltfFiles *files, char *why);
// Bytes of one element in memory (matrix columns are padded to 4 bytes). 0: unknown type.
u32 gltf_element_size(const GltfAccessor *accessor);
u32 gltf_component_size(u32 component_type);

// ---- gltf_read.c: accessors to plain arrays (after gltf_check) ----

// count * width floats, `stride` bytes apart; normalised integers become 0..1 or -1..1. Fewer
// components in the accessor than width: the rest is left as it is. False with `why`: not finite
// or over GLTF_COORDINATE_MAX.
bool gltf_read_floats(const GltfRaw *raw, i32 accessor, u32 width, void *out, u64 stride,
                      char *why);
bool gltf_read_indices(const GltfRaw *raw, i32 accessor, u32 vertex_count, u32 *out, char *why);
Bytes gltf_view_bytes(const GltfRaw *raw, i32 view);

// ---- gltf_material.c ----

// Decodes images, adds textures and fills model->materials (one more than the file's: the default
// material of parts without one, last). False with `why`.
bool gltf_build_materials(AssetStore *store, GltfFiles *files, const GltfRaw *raw, const char *path,
                          Model *model, char *why);

// ---- gltf_mesh.c ----

// mesh_of[primitive], in: not 0 where it is wanted; out: its mesh id, 0 where it is skipped.
bool gltf_build_meshes(AssetStore *store, const GltfRaw *raw, const char *path, u32 *mesh_of,
                       char *why);

#ifdef __cplusplus
}
#endif
#endif
