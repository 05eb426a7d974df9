// mesh_process.c: loose triangles in, a mesh in the store out; and the packing of vertices.
//
// Data in: SourceVertex arrays with valid indices and finite numbers. Data out: a mesh id whose
// vertices are welded, complete (normals, tangents), ordered and packed. Called by the shapes and
// the glTF importer; the packing by every maker of meshes. Does not: check what a file says, or
// simplify.
#include "asset_internal.h"
#include "../base/log.h"
#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <string.h>

#define OVERDRAW_THRESHOLD 1.05f // up to 5 % more vertex work for less overdraw

// ---- packing ----

static f32 sign_not_zero(f32 x) { return x < 0.0f ? -1.0f : 1.0f; }

// Unit vector to the octahedron's unfolded square, -1..1. Cigolle et al., "A Survey of Efficient
// Representations for Independent Unit Vectors", JCGT 3(2), 2014, listing 2.
static Vec2 octahedral_encode(Vec3 n) {
    f32 norm = fabsf(n.x) + fabsf(n.y) + fabsf(n.z);
    if (!(norm > 0.0f)) return (Vec2){0, 0}; // +z
    Vec2 p = {n.x / norm, n.y / norm};
    if (n.z < 0.0f)
        p = (Vec2){(1.0f - fabsf(p.y)) * sign_not_zero(p.x),
                   (1.0f - fabsf(p.x)) * sign_not_zero(p.y)};
    return p;
}

static Vec3 octahedral_decode(Vec2 p) {
    Vec3 n = {p.x, p.y, 1.0f - fabsf(p.x) - fabsf(p.y)};
    if (n.z < 0.0f) {
        n.x = (1.0f - fabsf(p.y)) * sign_not_zero(p.x);
        n.y = (1.0f - fabsf(p.x)) * sign_not_zero(p.y);
    }
    return vec3_normalize(n);
}

static u32 pack_snorm(f32 value, f32 scale, u32 mask) {
    f32 scaled = CLAMP(value, -1.0f, 1.0f) * scale;
    return (u32)(i32)(scaled + (scaled < 0.0f ? -0.5f : 0.5f)) & mask;
}

u32 asset_pack_normal(Vec3 normal) {
    Vec2 p = octahedral_encode(normal);
    return pack_snorm(p.x, 32767.0f, 0xFFFF) | pack_snorm(p.y, 32767.0f, 0xFFFF) << 16;
}

u32 asset_pack_tangent(Vec3 tangent, f32 sign) {
    Vec2 p = octahedral_encode(tangent);
    return pack_snorm(p.x, 32767.0f, 0xFFFF) | pack_snorm(p.y, 16383.0f, 0x7FFF) << 16 |
           (sign < 0.0f ? 0x80000000u : 0);
}

Vec3 asset_unpack_normal(u32 packed) {
    Vec2 p = {(f32)(int16_t)(packed & 0xFFFF) / 32767.0f, (f32)(int16_t)(packed >> 16) / 32767.0f};
    return octahedral_decode((Vec2){fmaxf(p.x, -1.0f), fmaxf(p.y, -1.0f)});
}

static Vec3 unpack_tangent(u32 packed) {
    i32 y = (i32)(packed << 1) >> 17; // 15 bits, sign-extended
    return octahedral_decode((Vec2){(f32)(int16_t)(packed & 0xFFFF) / 32767.0f, (f32)y / 16383.0f});
}

Vec3 mesh_any_tangent(Vec3 n) {
    Vec3 axis = fabsf(n.x) < 0.9f ? vec3(1, 0, 0) : vec3(0, 0, 1);
    return vec3_normalize(vec3_sub(axis, vec3_scale(n, vec3_dot(axis, n))));
}

// ---- steps ----

static bool same_position(const SourceVertex *a, const SourceVertex *b) {
    return a->position.x == b->position.x && a->position.y == b->position.y &&
           a->position.z == b->position.z;
}

// Triangles with two equal corners cover nothing. (Slivers with an area of zero but three
// different corners stay: they may close a T-junction.)
static u32 drop_degenerate(const SourceVertex *vertices, u32 *indices, u32 index_count) {
    u32 kept = 0;
    for (u32 i = 0; i + 2 < index_count; i += 3) {
        const SourceVertex *a = &vertices[indices[i]], *b = &vertices[indices[i + 1]],
                           *c = &vertices[indices[i + 2]];
        if (same_position(a, b) || same_position(b, c) || same_position(c, a)) continue;
        for (u32 k = 0; k < 3; k++) indices[kept + k] = indices[i + k];
        kept += 3;
    }
    return kept;
}

// Each corner its own vertex, each triangle its own normal (glTF 2.0, 3.7.2.1: flat where a
// primitive has no normals).
static SourceVertex *make_flat(Arena *scratch, const SourceVertex *vertices, const u32 *indices,
                               u32 index_count) {
    SourceVertex *flat = scratch_try_push(scratch, index_count, sizeof *flat);
    for (u32 i = 0; flat && i + 2 < index_count; i += 3) {
        for (u32 k = 0; k < 3; k++) flat[i + k] = vertices[indices[i + k]];
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(flat[i + 1].position, flat[i].position),
                                                vec3_sub(flat[i + 2].position, flat[i].position)));
        for (u32 k = 0; k < 3; k++) flat[i + k].normal = normal;
    }
    return flat;
}

static void add_zero(f32 *values, u32 count) { // -0 to +0: welding compares bytes
    for (u32 i = 0; i < count; i++) values[i] += 0.0f;
}

static void clean_vertices(MeshSource *source) {
    for (u32 i = 0; i < source->vertex_count; i++) {
        SourceVertex *v = &source->vertices[i];
        v->normal = vec3_normalize(v->normal);
        if (!(vec3_dot(v->normal, v->normal) > 0.5f)) v->normal = vec3(0, 1, 0);
        if (source->has_tangents) {
            Vec3 t = vec3(v->tangent.x, v->tangent.y, v->tangent.z);
            t = vec3_normalize(vec3_sub(t, vec3_scale(v->normal, vec3_dot(v->normal, t))));
            if (!(vec3_dot(t, t) > 0.5f)) t = mesh_any_tangent(v->normal);
            v->tangent = (Vec4){t.x, t.y, t.z, v->tangent.w < 0.0f ? -1.0f : 1.0f};
        } else {
            v->tangent = (Vec4){0};
        }
        if (!source->has_uvs) v->uv = (Vec2){0};
        add_zero(&v->position.x, 3);
        add_zero(&v->normal.x, 3);
        add_zero(&v->tangent.x, 3);
        add_zero(&v->uv.x, 2);
    }
}

static void pack_vertices(const SourceVertex *in, u32 count, MeshVertex *out) {
    for (u32 i = 0; i < count; i++) {
        const SourceVertex *v = &in[i];
        out[i] = (MeshVertex){.position = {v->position.x, v->position.y, v->position.z},
                              .normal = asset_pack_normal(v->normal),
                              .uv = {v->uv.x, v->uv.y},
                              .tangent = asset_pack_tangent(
                                  vec3(v->tangent.x, v->tangent.y, v->tangent.z), v->tangent.w),
                              .color = v->color};
    }
}

// Vertex cache first, then overdraw within its clusters, then vertices in order of use.
static u32 finish(AssetStore *store, const SourceVertex *vertices, u32 vertex_count, u32 *indices,
                  u32 index_count, char *why) {
    Arena *scratch = &store->scratch;
    MeshVertex *packed = scratch_try_push(scratch, vertex_count, sizeof *packed);
    MeshVertex *ordered = scratch_try_push(scratch, vertex_count, sizeof *ordered);
    u32 *order = scratch_try_push(scratch, index_count, sizeof *order);
    if (!packed || !ordered || !order) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory to order %u vertices", vertex_count);
        return 0;
    }
    pack_vertices(vertices, vertex_count, packed);
    meshopt_optimizeVertexCache(order, indices, index_count, vertex_count);
    meshopt_optimizeOverdraw(indices, order, index_count, packed[0].position, vertex_count,
                             sizeof *packed, OVERDRAW_THRESHOLD);
    u32 used = (u32)meshopt_optimizeVertexFetch(ordered, indices, index_count, packed, vertex_count,
                                                sizeof *packed);
    u32 mesh = asset_add_mesh(store, ordered, used, indices, index_count);
    if (!mesh) snprintf(why, ASSET_MESSAGE_CAP, "a limit of the store is reached");
    return mesh;
}

static u32 process(AssetStore *store, MeshSource *source, char *why) {
    Arena *scratch = &store->scratch;
    u32 index_count = source->indices ? source->index_count : source->vertex_count;
    index_count -= index_count % 3;
    u32 *indices = scratch_try_push(scratch, index_count, sizeof *indices);
    if (!indices) goto no_memory;
    for (u32 i = 0; i < index_count; i++) indices[i] = source->indices ? source->indices[i] : i;
    index_count = drop_degenerate(source->vertices, indices, index_count);
    if (index_count == 0) return 0;

    if (!source->has_normals) {
        if (index_count > ASSET_VERTICES_MAX) {
            snprintf(why, ASSET_MESSAGE_CAP, "flat normals need %u vertices, over %u", index_count,
                     ASSET_VERTICES_MAX);
            return 0;
        }
        source->vertices = make_flat(scratch, source->vertices, indices, index_count);
        if (!source->vertices) goto no_memory;
        source->vertex_count = index_count;
        source->has_tangents = false;
        for (u32 i = 0; i < index_count; i++) indices[i] = i;
    }
    clean_vertices(source);

    u32 *remap = scratch_try_push(scratch, source->vertex_count, sizeof *remap);
    if (!remap) goto no_memory;
    u32 welded_count =
        (u32)meshopt_generateVertexRemap(remap, indices, index_count, source->vertices,
                                         source->vertex_count, sizeof *source->vertices);
    // Twice the room: making tangents may split every vertex.
    SourceVertex *welded = scratch_try_push(scratch, 2 * (u64)welded_count, sizeof *welded);
    if (!welded) goto no_memory;
    meshopt_remapVertexBuffer(welded, source->vertices, source->vertex_count, sizeof *welded,
                              remap);
    meshopt_remapIndexBuffer(indices, indices, index_count, remap);

    // Made for every mesh with uvs, normal map or not: a level may give it another material.
    if (!source->has_tangents && source->has_uvs) {
        welded_count = mesh_make_tangents(scratch, welded, welded_count, indices, index_count);
        if (!welded_count) goto no_memory;
    } else if (!source->has_tangents) {
        for (u32 i = 0; i < welded_count; i++) {
            Vec3 t = mesh_any_tangent(welded[i].normal);
            welded[i].tangent = (Vec4){t.x, t.y, t.z, 1};
        }
    }
    return finish(store, welded, welded_count, indices, index_count, why);

no_memory:
    snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u vertices and %u indices",
             source->vertex_count, index_count);
    return 0;
}

u32 mesh_process(AssetStore *store, MeshSource *source, char *why) {
    _Static_assert(sizeof(SourceVertex) == 52, "welding compares bytes: no padding");
    u64 mark = arena_mark(&store->scratch);
    why[0] = 0;
    u32 mesh = process(store, source, why);
    arena_rewind(&store->scratch, mark);
    return mesh;
}

u32 mesh_add_mirrored(AssetStore *store, u32 mesh) {
    const Mesh *in = &store->meshes[mesh];
    u64 mark = arena_mark(&store->scratch);
    u32 id = 0;
    MeshVertex *vertices = scratch_try_push(&store->scratch, in->vertex_count, sizeof *vertices);
    u32 *indices = scratch_try_push(&store->scratch, in->index_count, sizeof *indices);
    if (!vertices || !indices) {
        LOG(ASSET_LIMIT, "no memory to mirror a mesh of %u vertices", in->vertex_count);
    } else {
        for (u32 i = 0; i < in->vertex_count; i++) {
            MeshVertex v = in->vertices[i];
            Vec3 n = asset_unpack_normal(v.normal), t = unpack_tangent(v.tangent);
            v.position[0] = -v.position[0];
            v.normal = asset_pack_normal(vec3(-n.x, n.y, n.z));
            // cross(normal, tangent) turns round in a mirror, the bitangent does not.
            v.tangent =
                asset_pack_tangent(vec3(-t.x, t.y, t.z), v.tangent & 0x80000000u ? 1.0f : -1.0f);
            vertices[i] = v;
        }
        for (u32 i = 0; i + 2 < in->index_count; i += 3) {
            indices[i] = in->indices[i];
            indices[i + 1] = in->indices[i + 2];
            indices[i + 2] = in->indices[i + 1];
        }
        id = asset_add_mesh(store, vertices, in->vertex_count, indices, in->index_count);
    }
    arena_rewind(&store->scratch, mark);
    return id;
}
