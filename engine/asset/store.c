// store.c: the arrays that own everything loaded.
//
// Data in: meshes, images and models that are complete and checked. Data out: ids, which are
// indices into the store's arrays. Called by the loaders of this folder, by levels and captures.
// Does not: read glTF, make shapes, decode images, or give single assets back.
#include "asset_internal.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

// Address space, committed on touch; halved down to the minimum where the system says no.
#define STORE_ARENA_SIZE     GIB(8)
#define STORE_SCRATCH_SIZE   GIB(4)
#define STORE_ARENA_SIZE_MIN MIB(256)

// First thing in the store's arena: what only this file needs to know.
typedef struct StorePrivate {
    const char *texture_paths[ASSET_TEXTURES_MAX]; // NULL: not loaded by path
    u64 texture_hashes[ASSET_TEXTURES_MAX];        // of the encoded bytes; 0: not to be shared
} StorePrivate;

static StorePrivate *store_private(const AssetStore *store) {
    return (StorePrivate *)(void *)store->arena.memory;
}

static bool create_arena(Arena *arena, const char *name, u64 size) {
    for (; size > STORE_ARENA_SIZE_MIN; size /= 2)
        if (arena_create(arena, name, size)) return true;
    return arena_create(arena, name, size);
}

static void add_checker(AssetStore *store) {
    enum { SIDE = 64, CELL = 8 };
    u8 pixels[SIDE * SIDE * 4];
    for (u32 y = 0; y < SIDE; y++)
        for (u32 x = 0; x < SIDE; x++) {
            u8 on = ((x / CELL) ^ (y / CELL)) & 1 ? 255 : 0;
            u8 pixel[4] = {on, 0, on, 255};
            memcpy(pixels + (y * SIDE + x) * 4, pixel, 4);
        }
    u32 id = asset_add_texture(store, pixels, SIDE, SIDE, TEXTURE_SRGB, true);
    LUZ_ASSERT(id == ASSET_TEXTURE_CHECKER);
}

bool asset_store_create(AssetStore *store) {
    static _Atomic u64 stamps = 0;
    *store = (AssetStore){.texture_side_cap = ASSET_TEXTURE_SIDE_CAP};
    if (!create_arena(&store->arena, "assets", STORE_ARENA_SIZE)) return false;
    if (!create_arena(&store->scratch, "asset scratch", STORE_SCRATCH_SIZE)) {
        arena_destroy(&store->arena);
        return false;
    }
    store->stamp = atomic_fetch_add(&stamps, 1) + 1;
    StorePrivate *private = ARENA_PUSH(&store->arena, StorePrivate, 1);
    LUZ_ASSERT(private == store_private(store));
    store->meshes = ARENA_PUSH(&store->arena, Mesh, ASSET_MESHES_MAX);
    store->textures = ARENA_PUSH(&store->arena, Texture, ASSET_TEXTURES_MAX);
    store->models = ARENA_PUSH(&store->arena, Model, ASSET_MODELS_MAX);

    // The dummies: an empty mesh, a white texel, an empty model.
    static const MeshVertex no_vertices[1];
    static const u32 no_indices[1];
    static const u8 white[4] = {255, 255, 255, 255};
    static const ModelMaterial plain = {.name = "", .albedo = {0.8f, 0.8f, 0.8f, 1}, .power = 1};
    store->meshes[0] = (Mesh){.vertices = no_vertices, .indices = no_indices, .lod_count = 1};
    store->textures[0] = (Texture){.pixels = white, .width = 1, .height = 1, .mip_count = 1};
    store->models[0] = (Model){.name = "", .materials = &plain, .material_count = 1};
    store->mesh_count = store->texture_count = store->model_count = 1;
    add_checker(store);
    return true;
}

void asset_store_destroy(AssetStore *store) {
    arena_destroy(&store->arena);
    arena_destroy(&store->scratch);
    *store = (AssetStore){0};
}

StoreMark store_mark(const AssetStore *store) {
    return (StoreMark){arena_mark(&store->arena), arena_mark(&store->scratch), store->mesh_count,
                       store->texture_count, store->model_count};
}

void store_rewind(AssetStore *store, StoreMark mark) {
    for (u32 i = mark.texture_count; i < store->texture_count; i++) {
        store_private(store)->texture_paths[i] = NULL;
        store_private(store)->texture_hashes[i] = 0;
    }
    store->mesh_count = mark.mesh_count;
    store->texture_count = mark.texture_count;
    store->model_count = mark.model_count;
    arena_rewind(&store->arena, mark.arena);
    arena_rewind(&store->scratch, mark.scratch);
}

void *scratch_try_push(Arena *arena, u64 count, u64 size) {
    u64 bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || !arena_can_push(arena, bytes, 16))
        return NULL;
    return arena_push(arena, bytes, 16);
}

u32 store_find_model(const AssetStore *store, const char *name) {
    for (u32 i = 1; i < store->model_count; i++)
        if (strcmp(store->models[i].name, name) == 0) return i;
    return 0;
}

u32 store_add_model(AssetStore *store, const Model *model) {
    if (store->model_count >= ASSET_MODELS_MAX) {
        LOG(ASSET_LIMIT, "%s: more than %u models", model->name, ASSET_MODELS_MAX);
        return 0;
    }
    store->models[store->model_count] = *model;
    return store->model_count++;
}

void model_grow_bounds(Model *model, const Mesh *mesh, const Mat34 *local, bool first) {
    for (u32 corner = 0; corner < 8; corner++) {
        Vec3 p = mat34_point(local, vec3(corner & 1 ? mesh->max.x : mesh->min.x,
                                         corner & 2 ? mesh->max.y : mesh->min.y,
                                         corner & 4 ? mesh->max.z : mesh->min.z));
        if (first && corner == 0) model->min = model->max = p;
        model->min =
            vec3(fminf(model->min.x, p.x), fminf(model->min.y, p.y), fminf(model->min.z, p.z));
        model->max =
            vec3(fmaxf(model->max.x, p.x), fmaxf(model->max.y, p.y), fmaxf(model->max.z, p.z));
    }
}

// ---- meshes ----

// Box, and the sphere about the box's centre (not the smallest, never more than sqrt 3 of it).
static void mesh_find_bounds(Mesh *mesh) {
    const MeshVertex *v = mesh->vertices;
    f32 lo[3], hi[3];
    memcpy(lo, v[0].position, sizeof lo);
    memcpy(hi, v[0].position, sizeof hi);
    for (u32 i = 1; i < mesh->vertex_count; i++)
        for (u32 axis = 0; axis < 3; axis++) {
            lo[axis] = fminf(lo[axis], v[i].position[axis]);
            hi[axis] = fmaxf(hi[axis], v[i].position[axis]);
        }
    mesh->min = vec3(lo[0], lo[1], lo[2]);
    mesh->max = vec3(hi[0], hi[1], hi[2]);
    mesh->center = vec3(lo[0] + (hi[0] - lo[0]) * 0.5f, lo[1] + (hi[1] - lo[1]) * 0.5f,
                        lo[2] + (hi[2] - lo[2]) * 0.5f);
    f32 squared = 0;
    for (u32 i = 0; i < mesh->vertex_count; i++) {
        Vec3 d = vec3_sub(vec3(v[i].position[0], v[i].position[1], v[i].position[2]), mesh->center);
        squared = fmaxf(squared, vec3_dot(d, d));
        mesh->has_color |= v[i].color != 0xFFFFFFFFu;
    }
    mesh->radius = sqrtf(squared);
}

// Points the mesh at copies of its own. False: no room.
static bool copy_mesh(AssetStore *store, Mesh *mesh, const u32 *coarser) {
    u64 vertex_size = sizeof(MeshVertex) * (u64)mesh->vertex_count;
    u64 index_size = sizeof(u32) * (u64)mesh->index_count;
    u64 total_size = sizeof(u32) * (u64)mesh->total_index_count;
    if (!arena_can_push(&store->arena, vertex_size + total_size + 4 * CACHE_LINE, CACHE_LINE))
        return false;
    MeshVertex *vertices = ARENA_PUSH_COLUMN(&store->arena, MeshVertex, MAX(mesh->vertex_count, 1));
    u32 *indices = ARENA_PUSH_COLUMN(&store->arena, u32, MAX(mesh->total_index_count, 1));
    if (vertex_size) memcpy(vertices, mesh->vertices, vertex_size);
    if (index_size) memcpy(indices, mesh->indices, index_size);
    if (total_size > index_size)
        memcpy(indices + mesh->index_count, coarser, total_size - index_size);
    mesh->vertices = vertices;
    mesh->indices = indices;
    return true;
}

u32 asset_add_mesh(AssetStore *store, const MeshVertex *vertices, u32 vertex_count,
                   const u32 *indices, u32 index_count) {
    if (store->mesh_count >= ASSET_MESHES_MAX) {
        LOG(ASSET_LIMIT, "more than %u meshes", ASSET_MESHES_MAX);
        return 0;
    }
    Mesh mesh = {.vertices = vertices,
                 .indices = indices,
                 .vertex_count = vertex_count,
                 .index_count = index_count};
    u64 mark = arena_mark(&store->scratch);
    bool fits = vertex_count <= ASSET_VERTICES_MAX && index_count <= ASSET_INDICES_MAX;
    if (fits) {
        if (vertex_count) mesh_find_bounds(&mesh);
        const u32 *coarser = mesh_make_lods(&store->scratch, &mesh);
        fits = copy_mesh(store, &mesh, coarser);
    }
    arena_rewind(&store->scratch, mark);
    if (!fits) {
        LOG(ASSET_LIMIT, "a mesh of %u vertices and %u indices is too large", vertex_count,
            index_count);
        return 0;
    }
    store->meshes[store->mesh_count] = mesh;
    return store->mesh_count++;
}

// ---- textures ----

u32 store_find_texture(const AssetStore *store, u64 hash, TextureKind kind) {
    const u64 *hashes = store_private(store)->texture_hashes;
    for (u32 i = 1; i < store->texture_count && hash; i++)
        if (hashes[i] == hash && store->textures[i].kind == kind) return i;
    return 0;
}

void store_share_texture(AssetStore *store, u32 texture, u64 hash) {
    store_private(store)->texture_hashes[texture] = hash;
}

u32 store_reserve_texture(AssetStore *store, u32 width, u32 height, TextureKind kind,
                          bool with_mips, u8 **pixels) {
    if (store->texture_count >= ASSET_TEXTURES_MAX) {
        LOG(ASSET_LIMIT, "more than %u textures", ASSET_TEXTURES_MAX);
        return 0;
    }
    LUZ_ASSERT(width && height && width <= ASSET_IMAGE_SIDE_MAX && height <= ASSET_IMAGE_SIDE_MAX);
    u32 mip_count = with_mips ? image_mip_count(width, height) : 1;
    u64 size = image_mips_size(width, height, mip_count);
    if (!arena_can_push(&store->arena, ALIGN_UP(size, CACHE_LINE), CACHE_LINE)) {
        LOG(ASSET_LIMIT, "no room for a texture of %u x %u", width, height);
        return 0;
    }
    *pixels = ARENA_PUSH_COLUMN(&store->arena, u8, size);
    store->textures[store->texture_count] = (Texture){
        .pixels = *pixels, .width = width, .height = height, .mip_count = mip_count, .kind = kind};
    return store->texture_count++;
}

u32 asset_add_texture(AssetStore *store, const u8 *rgba, u32 width, u32 height, TextureKind kind,
                      bool with_mips) {
    if (!width || !height || width > ASSET_IMAGE_SIDE_MAX || height > ASSET_IMAGE_SIDE_MAX) {
        LOG(ASSET_LIMIT, "a texture of %u x %u is over %u px a side", width, height,
            ASSET_IMAGE_SIDE_MAX);
        return 0;
    }
    u8 *pixels;
    u32 id = store_reserve_texture(store, width, height, kind, with_mips, &pixels);
    if (!id) return 0;
    memcpy(pixels, rgba, (u64)width * height * 4);
    if (with_mips) image_build_mips(pixels, width, height, kind);
    store->textures[id].has_alpha = image_has_alpha(pixels, (u64)width * height);
    return id;
}

// Texture id, or 0 with `why`: the file is no image; or with a logged limit and an empty `why`.
static u32 add_encoded(AssetStore *store, Bytes file, TextureKind kind, char *why) {
    u32 width, height;
    if (!image_probe(file, &width, &height, why)) return 0;
    image_fit(&width, &height, store->texture_side_cap);
    StoreMark mark = store_mark(store);
    u8 *pixels;
    u32 id = store_reserve_texture(store, width, height, kind, true, &pixels);
    if (!id) return 0;
    if (!image_decode(file, width, height, kind, pixels, why)) {
        store_rewind(store, mark);
        return 0;
    }
    image_build_mips(pixels, width, height, kind);
    store->textures[id].has_alpha = image_has_alpha(pixels, (u64)width * height);
    return id;
}

u32 asset_load_texture(AssetStore *store, const FileRoot *root, const char *path,
                       TextureKind kind) {
    const char **paths = store_private(store)->texture_paths;
    for (u32 i = 1; i < store->texture_count; i++)
        if (paths[i] && store->textures[i].kind == kind && strcmp(paths[i], path) == 0) return i;

    char why[ASSET_MESSAGE_CAP] = "";
    u64 scratch_mark = arena_mark(&store->scratch);
    Bytes file;
    u32 id = 0;
    if (!file_root_read(root, path, ASSET_FILE_SIZE_MAX, &store->scratch, &file))
        log_last_error(why, sizeof why);
    else
        id = add_encoded(store, file, kind, why);
    arena_rewind(&store->scratch, scratch_mark);
    if (!id) {
        LOG(ASSET_IMAGE, "%s: %s", path, why[0] ? why : "no room");
        return ASSET_TEXTURE_CHECKER;
    }
    paths[id] = arena_copy_string(&store->arena, path);
    return id;
}

const char *asset_texture_path(const AssetStore *store, u32 texture) {
    const char *path =
        texture < store->texture_count ? store_private(store)->texture_paths[texture] : NULL;
    return path ? path : "";
}
