// asset_fixture.h: a store over a temporary folder, small glTF files made from text, and asserts
// about what was said. Used by the asset_*.c tests.
#ifndef LUZ_TEST_ASSET_FIXTURE_H
#define LUZ_TEST_ASSET_FIXTURE_H
#include "../test.h"
#include "../../engine/asset/asset.h"
#include "../../engine/base/log.h"

typedef struct AssetFixture {
    AssetStore store;
    FileRoot root; // the test's temporary folder
    u32 file_count;
    u32 id_count[LOG_ID_COUNT];   // messages since fixture_open or fixture_forget
    char text[LOG_ID_COUNT][512]; // the last one of each id
} AssetFixture;

// One fixture per test at a time; messages are caught, not printed.
AssetFixture *fixture_open(void);
void fixture_close(AssetFixture *f);
void fixture_forget(AssetFixture *f);

void fixture_write(const char *name, const void *data, u64 size);
// Writes under a fresh name and loads. Ids as from asset_load_model.
u32 fixture_load_text(AssetFixture *f, const char *json);
u32 fixture_load_bytes(AssetFixture *f, const void *data, u64 size);
u32 fixture_load_glb(AssetFixture *f, const char *json, const void *bin, u64 bin_size);

// A container in static storage (one at a time).
const u8 *fixture_make_glb(const char *json, const void *bin, u64 bin_size, u64 *size);
// "data:application/octet-stream;base64,..." in static storage (one at a time).
const char *fixture_data_uri(const void *data, u64 size);
// `text` with the first occurrence of `from`, which must be there, replaced; static storage, four
// of them are valid at a time.
const char *fixture_replace(const char *text, const char *from, const char *to);

// One triangle: TRIANGLE_JSON names a buffer without a uri (GLB); positions and u16 indices.
#define TRIANGLE_JSON                                                                              \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"                   \
    "\"nodes\":[{\"mesh\":0}],"                                                                    \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"             \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"      \
    "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}],"                  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},"                                           \
    "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"                                          \
    "\"buffers\":[{\"byteLength\":44}]}"
typedef struct TriangleBin {
    f32 positions[3][3];
    u16 indices[4]; // the last one pads
} TriangleBin;
extern const TriangleBin triangle_bin; // (0 0 0) (1 0 0) (0 1 0)

// The load failed, the last ASSET_MODEL message holds `words`, the store is as it was before.
typedef struct StoreShape {
    u64 arena_used, mesh_count, texture_count, model_count; // no padding: compared as bytes
} StoreShape;
StoreShape fixture_shape(const AssetFixture *f);
#define ASSERT_REFUSED(f, before, id, words)                                                       \
    fixture_assert_refused((f), (before), (id), (words), __FILE__, __LINE__)
void fixture_assert_refused(const AssetFixture *f, StoreShape before, u32 id, const char *words,
                            const char *file, int line);
// The last message of this id holds `words`.
#define ASSERT_SAID(f, id, words) fixture_assert_said((f), LOG_##id, (words), __FILE__, __LINE__)
void fixture_assert_said(const AssetFixture *f, LogId id, const char *words, const char *file,
                         int line);

// Corner k of triangle t of a mesh.
static inline const MeshVertex *mesh_corner(const Mesh *mesh, u32 t, u32 k) {
    return &mesh->vertices[mesh->indices[t * 3 + k]];
}
static inline Vec3 mesh_position(const Mesh *mesh, u32 t, u32 k) {
    const f32 *p = mesh_corner(mesh, t, k)->position;
    return vec3(p[0], p[1], p[2]);
}
#endif
