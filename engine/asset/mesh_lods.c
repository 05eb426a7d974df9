// mesh_lods.c: coarser versions of a mesh, for when it is small on the screen.
//
// Data in: a full mesh. Data out: index lists over the same vertices, each with the distance,
// about, between its surface and the full one. Called by asset_add_mesh for every mesh. Does not:
// choose a level for a frame (systems/packet_draws.c), or move vertices.
//
// Levels follow each other at even ratios: a coarser one is chosen as soon as its error is small on
// the screen, so many levels mean that few triangles more than needed are drawn.
#include "asset_internal.h"
#include "mesh_simplify.h"
#include <meshoptimizer.h>

#define LOD_INDICES_MIN (3 * 8) // meshes below gain nothing
#define LOD_RATIO       0.75f   // of the triangles of the level before
#define LOD_SLACK       1.15f   // a level goes on while its error grows by no more than this
#define LOD_ERROR_MAX   0.1f    // of the mesh's diameter: beyond, nothing is left of its shape
#define LOD_EXTENT_MAX  1e9f    // m; squares of squares stay finite

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
    // A geometric series of LOD_RATIO.
    u32 *out = scratch_try_push(scratch, 4 * (u64)full, sizeof *out);
    if (!out) return NULL;
    u64 mark = arena_mark(scratch);
    Simplifier *simplifier = simplify_begin(scratch, mesh);
    while (simplifier && mesh->lod_count < MESH_LODS_CAP) {
        const MeshLod *last = &mesh->lods[mesh->lod_count - 1];
        u32 target = (u32)((f32)(last->index_count / 3) * LOD_RATIO);
        f32 error =
            simplify_until(simplifier, target, LOD_ERROR_MAX * 2.0f * mesh->radius, LOD_SLACK);
        u32 count = 3 * simplify_triangles(simplifier);
        if (count == 0 || 4ull * count > 3ull * last->index_count) break;
        u32 *indices = out + (mesh->total_index_count - full);
        simplify_write(simplifier, indices);
        meshopt_optimizeVertexCache(indices, indices, count, mesh->vertex_count);
        mesh->lods[mesh->lod_count++] = (MeshLod){mesh->total_index_count, count, error};
        mesh->total_index_count += count;
    }
    arena_rewind(scratch, mark);
    return out;
}
