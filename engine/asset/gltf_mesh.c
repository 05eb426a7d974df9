// gltf_mesh.c: glTF primitives to meshes of the store.
//
// Data in: checked GltfRaw. Data out: one mesh per primitive that has triangles, texture transforms
// baked into its uvs. Called by asset_load_model. Does not: place meshes (gltf_model.c) or look at
// textures. Vertices that share an accessor between primitives are read again for each: a mesh
// owns what it draws.
#include "gltf_raw.h"
#include "../base/log.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6 };

static u8 unorm8(f32 x) { return (u8)(f32_saturate(x) * 255.0f + 0.5f); }

// Linear colour as RGBA8; three components leave alpha at 1.
static bool read_colors(const GltfRaw *raw, Arena *scratch, i32 accessor, SourceVertex *vertices,
                        u32 count, char *why) {
    u64 mark = arena_mark(scratch);
    f32(*colors)[4] = scratch_try_push(scratch, count, sizeof *colors);
    if (!colors) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u vertex colours", count);
        return false;
    }
    for (u32 i = 0; i < count; i++) colors[i][3] = 1;
    bool ok = gltf_read_floats(raw, accessor, 4, colors, sizeof *colors, why);
    for (u32 i = 0; ok && i < count; i++)
        vertices[i].color = (u32)unorm8(colors[i][0]) | (u32)unorm8(colors[i][1]) << 8 |
                            (u32)unorm8(colors[i][2]) << 16 | (u32)unorm8(colors[i][3]) << 24;
    arena_rewind(scratch, mark);
    return ok;
}

// KHR_texture_transform: uv' = offset + R(rotation) * (scale * uv).
static void transform_uvs(SourceVertex *vertices, u32 count, const GltfTextureRef *ref) {
    f32 s = det_sin(ref->rotation_rad), c = det_cos(ref->rotation_rad);
    for (u32 i = 0; i < count; i++) {
        f32 u = vertices[i].uv.x * ref->scale[0], v = vertices[i].uv.y * ref->scale[1];
        u = CLAMP(u, -GLTF_COORDINATE_MAX, GLTF_COORDINATE_MAX);
        v = CLAMP(v, -GLTF_COORDINATE_MAX, GLTF_COORDINATE_MAX);
        vertices[i].uv = (Vec2){ref->offset[0] + c * u + s * v, ref->offset[1] - s * u + c * v};
    }
}

// The texture whose uv set and transform the mesh follows: the engine has one uv for all.
static const GltfTextureRef *leading_texture(const GltfMaterial *m) {
    if (m->base_texture.texture >= 0) return &m->base_texture;
    if (m->normal_texture.texture >= 0) return &m->normal_texture;
    return m->emissive_texture.texture >= 0 ? &m->emissive_texture : NULL;
}

static bool read_vertices(const GltfRaw *raw, Arena *scratch, const GltfPrimitive *p,
                          MeshSource *out, char *why) {
    u32 count = (u32)raw->accessors[p->position].count;
    u64 stride = sizeof(SourceVertex);
    SourceVertex *v = scratch_try_push(scratch, count, stride);
    if (!v) {
        snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u vertices", count);
        return false;
    }
    for (u32 i = 0; i < count; i++) v[i].color = 0xFFFFFFFFu;
    const GltfTextureRef *lead =
        p->material >= 0 ? leading_texture(&raw->materials[p->material]) : NULL;
    i32 uv = p->uv[lead && lead->set == 1 ? 1 : 0];
    *out = (MeshSource){.vertices = v,
                        .vertex_count = count,
                        .has_normals = p->normal >= 0,
                        .has_tangents = p->tangent >= 0 && p->normal >= 0,
                        .has_uvs = uv >= 0};
    if (!gltf_read_floats(raw, p->position, 3, &v->position, stride, why) ||
        (p->normal >= 0 && !gltf_read_floats(raw, p->normal, 3, &v->normal, stride, why)) ||
        (p->tangent >= 0 && !gltf_read_floats(raw, p->tangent, 4, &v->tangent, stride, why)) ||
        (uv >= 0 && !gltf_read_floats(raw, uv, 2, &v->uv, stride, why)) ||
        (p->color >= 0 && !read_colors(raw, scratch, p->color, v, count, why)))
        return false;
    if (lead && lead->has_transform && uv >= 0) {
        transform_uvs(v, count, lead);
        out->has_tangents = false; // they may have turned
    }
    return true;
}

// Corner list of a strip or fan: every other triangle of a strip is turned round.
static u32 *list_triangles(Arena *scratch, const u32 *corners, u32 count, i32 mode,
                           u32 *out_count) {
    u32 triangles = count >= 3 ? count - 2 : 0;
    u32 *list = scratch_try_push(scratch, 3 * (u64)triangles, sizeof *list);
    for (u32 t = 0; list && t < triangles; t++) {
        u32 a = mode == MODE_FAN ? 0 : t, b = t + 1, c = t + 2;
        if (mode == MODE_STRIP && t % 2) b = t + 2, c = t + 1;
        list[t * 3] = corners[a];
        list[t * 3 + 1] = corners[b];
        list[t * 3 + 2] = corners[c];
    }
    *out_count = triangles * 3;
    return list;
}

static bool read_corners(const GltfRaw *raw, Arena *scratch, const GltfPrimitive *p,
                         MeshSource *source, char *why) {
    bool indexed = p->indices >= 0;
    u32 count = indexed ? (u32)raw->accessors[p->indices].count : source->vertex_count;
    u32 *corners = scratch_try_push(scratch, count, sizeof *corners);
    if (!corners) goto no_memory;
    for (u32 i = 0; !indexed && i < count; i++) corners[i] = i;
    if (indexed && !gltf_read_indices(raw, p->indices, source->vertex_count, corners, why))
        return false;
    if (p->mode != MODE_TRIANGLES) {
        corners = list_triangles(scratch, corners, count, p->mode, &count);
        if (!corners) goto no_memory;
    }
    source->indices = corners;
    source->index_count = count;
    return true;

no_memory:
    snprintf(why, ASSET_MESSAGE_CAP, "no memory for %u indices", count);
    return false;
}

// 0 with an empty `why`: nothing to draw in it, which is not an error.
static u32 build_primitive(AssetStore *store, const GltfRaw *raw, const GltfPrimitive *p,
                           const char *path, u32 index, char *why) {
    MeshSource source;
    if (!read_vertices(raw, &store->scratch, p, &source, why) ||
        !read_corners(raw, &store->scratch, p, &source, why))
        return 0;
    u32 mesh = source.index_count >= 3 ? mesh_process(store, &source, why) : 0;
    if (!mesh && !why[0])
        LOG(ASSET_MODEL_WARNING, "%s: primitive %u is left out: it covers nothing", path, index);
    return mesh;
}

bool gltf_build_meshes(AssetStore *store, const GltfRaw *raw, const char *path, u32 *mesh_of,
                       char *why) {
    u32 other_modes = 0, without_position = 0, morphed = 0, far_uvs = 0;
    for (u32 i = 0; i < raw->primitive_count; i++) {
        const GltfPrimitive *p = &raw->primitives[i];
        const GltfTextureRef *lead =
            p->material >= 0 ? leading_texture(&raw->materials[p->material]) : NULL;
        if (!mesh_of[i]) continue;
        mesh_of[i] = 0;
        morphed += p->morphs;
        far_uvs += lead && lead->set > 1;
        without_position += p->position < 0;
        other_modes += p->mode < MODE_TRIANGLES;
        if (p->position < 0 || p->mode < MODE_TRIANGLES) continue;
        u64 mark = arena_mark(&store->scratch);
        mesh_of[i] = build_primitive(store, raw, p, path, i, why);
        arena_rewind(&store->scratch, mark);
        if (why[0]) return false;
    }
    if (other_modes)
        LOG(ASSET_MODEL_WARNING, "%s: %u primitives of points or lines are left out", path,
            other_modes);
    if (without_position)
        LOG(ASSET_MODEL_WARNING, "%s: %u primitives without POSITION are left out", path,
            without_position);
    if (morphed)
        LOG(ASSET_MODEL_WARNING, "%s: morph targets are ignored (%u primitives)", path, morphed);
    if (far_uvs)
        LOG(ASSET_MODEL_WARNING, "%s: TEXCOORD_2 and above are not read, TEXCOORD_0 is used", path);
    return true;
}
