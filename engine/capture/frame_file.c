// frame_file.c: one frame in a file: the packet and the meshes and textures that it draws.
// Data in: a packet with its asset store; or a file from anybody. Data out: a .luzf file; or a
// validated packet and a fresh store. Called by: `luz shot --record-frame`, `luz replay`, a key of
// the shells, tests. Does not: hold the world; GI history is not in it.
//
// Byte layout (container: chunk_file.h; all little-endian), ids counted from 1 within the file:
//   PACK  the packet as it lies in memory, ids replaced
//   MESH  u32 meshes, then u32 vertices, u32 indices, MeshVertex[], u32[]
//   TEXS  u32 textures, then u32 width, u32 height, u32 kind, u32 has mips, RGBA8 of level 0 (mips
//         are made again: the same function of the same pixels)
#include "../base/log.h"
#include "capture.h"
#include "chunk_file.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FRAME_MAGIC        CHUNK_TAG('L', 'U', 'Z', 'F')
#define FRAME_VERSION      1u
#define TAG_PACKET         CHUNK_TAG('P', 'A', 'C', 'K')
#define TAG_MESHES         CHUNK_TAG('M', 'E', 'S', 'H')
#define TAG_TEXTURES       CHUNK_TAG('T', 'E', 'X', 'S')
#define FRAME_PACKET_MAX   MIB(512)
#define FRAME_MESHES_MAX   GIB(1)
#define FRAME_TEXTURES_MAX GIB(1)
#define FRAME_TEXTURE_HEAD 16u
#define FRAME_MESH_HEAD    8u

// X(section): those that name meshes.
#define FRAME_DRAWS(X)                                                                             \
    X(opaque_draws)                                                                                \
    X(mask_draws)                                                                                  \
    X(blend_draws)                                                                                 \
    X(emissive_draws)                                                                              \
    X(shadow_draws)                                                                                \
    X(shadow_mask_draws)                                                                           \
    X(gi_static_draws)                                                                             \
    X(gi_dynamic_draws)

// The frame file's structs are the engine's own: a change of them is a change of the version.
_Static_assert(sizeof(MeshVertex) == 32, "MeshVertex is part of the format");
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "packets are written as they lie");

// --- ids ---

typedef struct IdMap {
    u32 *to;   // [count] new id, 0 = not used
    u32 *used; // [used_count] old ids in order of their new ones, which begin at 1
    u32 count, used_count;
} IdMap;

static IdMap id_map_create(u32 count) {
    IdMap map = {.count = count};
    map.to = calloc(MAX(count, 1), sizeof *map.to);
    map.used = calloc(MAX(count, 1), sizeof *map.used);
    LUZ_ASSERT(map.to && map.used);
    return map;
}

static void id_map_free(IdMap *map) {
    free(map->to);
    free(map->used);
}

static u32 id_map_add(IdMap *map, u32 id) {
    if (id == 0) return 0;
    LUZ_ASSERT(id < map->count);
    if (map->to[id] == 0) {
        map->used[map->used_count] = id;
        map->to[id] = ++map->used_count;
    }
    return map->to[id];
}

typedef u32 (*IdFunction)(void *context, u32 id);

static void replace_ids(Packet *packet, IdFunction mesh, void *meshes, IdFunction texture,
                        void *textures) {
#define X(section)                                                                                 \
    for (u32 i = 0; i < packet->section.count; i++) {                                              \
        PacketDraw *draw = &PACKET_WRITE(packet, section, PacketDraw)[i];                          \
        draw->mesh = mesh(meshes, draw->mesh);                                                     \
    }
    FRAME_DRAWS(X)
#undef X
    PacketMaterial *materials = PACKET_WRITE(packet, material_bindings, PacketMaterial);
    for (u32 i = 0; i < packet->material_bindings.count; i++) {
        materials[i].albedo_texture = texture(textures, materials[i].albedo_texture);
        materials[i].normal_texture = texture(textures, materials[i].normal_texture);
        materials[i].emissive_texture = texture(textures, materials[i].emissive_texture);
    }
}

static u32 collect_id(void *context, u32 id) { return id_map_add(context, id); }

// --- writing ---

static void write_meshes(ChunkWriter *file, const AssetStore *assets, const IdMap *map) {
    ByteWriter out = {0};
    byte_write_u32(&out, map->used_count);
    for (u32 i = 0; i < map->used_count; i++) {
        const Mesh *mesh = &assets->meshes[map->used[i]];
        byte_write_u32(&out, mesh->vertex_count);
        byte_write_u32(&out, mesh->index_count);
        byte_write(&out, mesh->vertices, (u64)mesh->vertex_count * sizeof(MeshVertex));
        byte_write(&out, mesh->indices, (u64)mesh->index_count * sizeof(u32));
    }
    chunk_writer_add(file, TAG_MESHES, out.data, out.size, true);
    byte_writer_free(&out);
}

static void write_textures(ChunkWriter *file, const AssetStore *assets, const IdMap *map) {
    ByteWriter out = {0};
    byte_write_u32(&out, map->used_count);
    for (u32 i = 0; i < map->used_count; i++) {
        const Texture *texture = &assets->textures[map->used[i]];
        byte_write_u32(&out, texture->width);
        byte_write_u32(&out, texture->height);
        byte_write_u32(&out, texture->kind);
        byte_write_u32(&out, texture->mip_count > 1);
        byte_write(&out, texture->pixels, 4ull * texture->width * texture->height);
    }
    chunk_writer_add(file, TAG_TEXTURES, out.data, out.size, true);
    byte_writer_free(&out);
}

bool frame_file_write(const char *path, const Packet *packet, const AssetStore *assets) {
    Packet *copy = malloc(packet->size);
    LUZ_ASSERT(copy);
    memcpy(copy, packet, packet->size);
    IdMap meshes = id_map_create(assets->mesh_count);
    IdMap textures = id_map_create(assets->texture_count);
    replace_ids(copy, collect_id, &meshes, collect_id, &textures);
    ChunkWriter file;
    chunk_writer_begin(&file, FRAME_MAGIC, FRAME_VERSION);
    chunk_writer_add(&file, TAG_PACKET, copy, copy->size, true);
    write_meshes(&file, assets, &meshes);
    write_textures(&file, assets, &textures);
    id_map_free(&meshes);
    id_map_free(&textures);
    free(copy);
    return chunk_writer_finish(&file, path);
}

// --- reading ---

typedef struct FrameReader {
    ChunkFile file;
    Arena *arena;
    AssetStore *store;
    // Store id of each id of the file; [0] = 0.
    u32 *mesh_ids, *texture_ids;
    u32 mesh_count, texture_count; // with the 0
} FrameReader;

static bool refuse(const FrameReader *in, u32 tag, const ByteReader *reader, const char *why) {
    return capture_refuse(in->file.path, tag, reader->at, why);
}

static bool open_chunk(const FrameReader *in, u32 tag, u64 raw_size_max, ByteReader *reader) {
    Bytes bytes;
    if (!chunk_file_open(&in->file, tag, raw_size_max, in->arena, &bytes)) return false;
    *reader = (ByteReader){.data = bytes.data, .size = bytes.size};
    return true;
}

static const char *check_mesh(const MeshVertex *vertices, u32 vertex_count, const u32 *indices,
                              u32 index_count) {
    for (u32 i = 0; i < vertex_count; i++) {
        const MeshVertex *v = &vertices[i];
        bool finite = isfinite(v->position[0]) && isfinite(v->position[1]) &&
                      isfinite(v->position[2]) && isfinite(v->uv[0]) && isfinite(v->uv[1]);
        if (!finite) return "a vertex is not finite";
    }
    for (u32 i = 0; i < index_count; i++)
        if (indices[i] >= vertex_count) return "an index is beyond the last vertex";
    return NULL;
}

static bool read_mesh(FrameReader *in, ByteReader *reader, u32 id) {
    u32 vertex_count = byte_read_u32(reader), index_count = byte_read_u32(reader);
    if (vertex_count > ASSET_VERTICES_MAX || index_count > ASSET_INDICES_MAX || index_count % 3)
        return refuse(in, TAG_MESHES, reader, "the size of a mesh is out of range");
    u64 vertex_size = (u64)vertex_count * sizeof(MeshVertex);
    u64 index_size = (u64)index_count * sizeof(u32);
    const u8 *vertex_bytes = byte_read(reader, vertex_size);
    const u8 *index_bytes = byte_read(reader, index_size);
    if (!vertex_bytes || !index_bytes)
        return refuse(in, TAG_MESHES, reader, "the chunk ends within a mesh");
    // In the file nothing is aligned. The copies are given back: the store keeps its own.
    u64 mark = arena_mark(in->arena);
    if (!arena_can_push(in->arena, vertex_size + index_size + 128, 64))
        return refuse(in, TAG_MESHES, reader, "no memory for a mesh");
    MeshVertex *vertices = ARENA_PUSH(in->arena, MeshVertex, MAX(vertex_count, 1));
    u32 *indices = ARENA_PUSH(in->arena, u32, MAX(index_count, 1));
    memcpy(vertices, vertex_bytes, vertex_size);
    memcpy(indices, index_bytes, index_size);
    const char *why = check_mesh(vertices, vertex_count, indices, index_count);
    if (!why) {
        in->mesh_ids[id] = asset_add_mesh(in->store, vertices, vertex_count, indices, index_count);
        if (in->mesh_ids[id] == 0) why = "no room for a mesh";
    }
    arena_rewind(in->arena, mark);
    return why ? refuse(in, TAG_MESHES, reader, why) : true;
}

static bool read_texture(FrameReader *in, ByteReader *reader, u32 id) {
    u32 width = byte_read_u32(reader), height = byte_read_u32(reader);
    u32 kind = byte_read_u32(reader), has_mips = byte_read_u32(reader);
    if (width < 1 || width > ASSET_TEXTURE_SIDE_CAP || height < 1 ||
        height > ASSET_TEXTURE_SIDE_CAP || kind > TEXTURE_LINEAR || has_mips > 1)
        return refuse(in, TAG_TEXTURES, reader, "the size or kind of a texture is out of range");
    const u8 *pixels = byte_read(reader, 4ull * width * height);
    if (!pixels) return refuse(in, TAG_TEXTURES, reader, "the chunk ends within a texture");
    in->texture_ids[id] =
        asset_add_texture(in->store, pixels, width, height, (TextureKind)kind, has_mips);
    if (in->texture_ids[id] == 0) return refuse(in, TAG_TEXTURES, reader, "no room for a texture");
    return true;
}

typedef bool (*ReadAsset)(FrameReader *in, ByteReader *reader, u32 id);

// A chunk of `count` assets, each of at least head_size bytes.
static bool read_assets(FrameReader *in, u32 tag, u64 raw_size_max, u32 head_size, u32 count_max,
                        ReadAsset read, u32 **ids, u32 *id_count) {
    ByteReader reader;
    u64 mark = arena_mark(in->arena);
    u32 *map = ARENA_PUSH(in->arena, u32, count_max + 1);
    u64 keep = arena_mark(in->arena);
    if (!open_chunk(in, tag, raw_size_max, &reader)) return false;
    u32 count = byte_read_u32(&reader);
    if (reader.failed || count > count_max || (u64)count * head_size > reader.size - reader.at) {
        arena_rewind(in->arena, mark);
        return refuse(in, tag, &reader, "their count does not fit its size");
    }
    *ids = map;
    *id_count = count + 1;
    for (u32 id = 1; id <= count; id++)
        if (!read(in, &reader, id)) return false;
    if (reader.at != reader.size) return refuse(in, tag, &reader, "bytes after the last one");
    arena_rewind(in->arena, keep); // the store has copies
    return true;
}

typedef struct StoreIds {
    const u32 *ids;
} StoreIds;
static u32 store_id(void *context, u32 id) { return ((const StoreIds *)context)->ids[id]; }

static bool read_packet(FrameReader *in, const Packet **out) {
    Bytes bytes;
    if (!chunk_file_open(&in->file, TAG_PACKET, FRAME_PACKET_MAX, in->arena, &bytes)) return false;
    const char *why = packet_validate(bytes.data, bytes.size, in->mesh_count, in->texture_count);
    if (why) return capture_refuse(in->file.path, TAG_PACKET, 0, why);
    Packet *packet = (Packet *)(uintptr_t)bytes.data; // ours: just unpacked into the arena
    StoreIds meshes = {in->mesh_ids}, textures = {in->texture_ids};
    replace_ids(packet, store_id, &meshes, store_id, &textures);
    *out = packet;
    return true;
}

bool frame_file_read(const char *path, Arena *arena, AssetStore *store, const Packet **packet) {
    *packet = NULL;
    FrameReader in = {.arena = arena, .store = store};
    u64 mark = arena_mark(arena);
    if (!asset_store_create(store)) return false;
    u32 mesh_room = ASSET_MESHES_MAX - store->mesh_count;
    u32 texture_room = ASSET_TEXTURES_MAX - store->texture_count;
    bool ok = chunk_file_read(path, "frame", FRAME_MAGIC, FRAME_VERSION, arena, &in.file) &&
              read_assets(&in, TAG_MESHES, FRAME_MESHES_MAX, FRAME_MESH_HEAD, mesh_room, read_mesh,
                          &in.mesh_ids, &in.mesh_count) &&
              read_assets(&in, TAG_TEXTURES, FRAME_TEXTURES_MAX, FRAME_TEXTURE_HEAD, texture_room,
                          read_texture, &in.texture_ids, &in.texture_count) &&
              read_packet(&in, packet);
    if (ok) return true;
    asset_store_destroy(store);
    arena_rewind(arena, mark);
    return false;
}
