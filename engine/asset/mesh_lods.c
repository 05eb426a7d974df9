// mesh_lods.c: coarser versions of a mesh, for when it is small on the screen.
//
// Data in: a full mesh. Data out: index lists over the same vertices, each with the distance,
// about, between its surface and the full one. Called by asset_add_mesh for every mesh. Does not:
// choose a level for a frame (systems/packet_draws.c), or move vertices.
//
// Edges collapse onto vertices that stay as they are (Garland and Heckbert, "Surface simplification
// using quadric error metrics", SIGGRAPH 1997, as meshoptimizer does it). Vertices that differ in
// normals or uvs at one place move together, so surfaces do not open along seams; the rim of an
// open surface stays, because another material's surface may begin there.
#include "asset_internal.h"
#include <meshoptimizer.h>

#define LOD_INDICES_MIN (3 * 200) // meshes below gain nothing
#define LOD_KEEP        0.75f     // a level has at most this share of the indices of the one before
#define LOD_ERROR_MAX   0.1f      // of the mesh's extent: beyond, nothing is left of its shape
#define LOD_EXTENT_MAX  1e9f      // m; squares of squares stay finite

static const f32 lod_ratios[MESH_LODS_CAP - 1] = {0.5f, 0.25f, 0.12f};

// A triangle with two equal corners is no surface that could be simplified.
static bool has_surface(const Mesh *mesh) {
    for (u32 i = 0; i + 2 < mesh->index_count; i += 3) {
        const u32 *c = &mesh->indices[i];
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return false;
    }
    return mesh->index_count >= LOD_INDICES_MIN && mesh->index_count % 3 == 0 &&
           mesh->radius > 0.0f && mesh->radius <= LOD_EXTENT_MAX;
}

const u32 *mesh_make_lods(Arena *scratch, Mesh *mesh) {
    u32 full = mesh->index_count;
    mesh->lods[0] = (MeshLod){0, full, 0};
    mesh->lod_count = 1;
    mesh->total_index_count = full;
    if (!has_surface(mesh)) return NULL;
    // Two levels with LOD_KEEP and room for the worst case of the third.
    u32 *out = scratch_try_push(scratch, 3 * (u64)full, sizeof *out);
    if (!out) return NULL;
    const f32 *positions = mesh->vertices[0].position;
    f32 scale = meshopt_simplifyScale(positions, mesh->vertex_count, sizeof(MeshVertex));
    for (u32 i = 0; i < COUNT_OF(lod_ratios); i++) {
        const MeshLod *last = &mesh->lods[mesh->lod_count - 1];
        u32 target = (u32)((f32)(full / 3) * lod_ratios[i]) * 3;
        u32 *indices = out + (mesh->total_index_count - full);
        f32 error = 0.0f;
        u32 count = (u32)meshopt_simplify(indices, mesh->indices, full, positions,
                                          mesh->vertex_count, sizeof(MeshVertex), target,
                                          LOD_ERROR_MAX, meshopt_SimplifyLockBorder, &error);
        if (count > 0 && (f32)count <= LOD_KEEP * (f32)last->index_count) {
            meshopt_optimizeVertexCache(indices, indices, count, mesh->vertex_count);
            mesh->lods[mesh->lod_count++] =
                (MeshLod){mesh->total_index_count, count, MAX(error * scale, last->error)};
            mesh->total_index_count += count;
        }
        if (count > target) break; // nothing more may collapse
    }
    return out;
}
