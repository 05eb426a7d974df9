// gi_meshes.c: what voxelisation wants to know of a mesh: how large its triangles are, and whether
// it is closed. Data in: a mesh. Data out: two answers for its GpuMesh. Called by render_assets.c,
// once a mesh. Does not: look at instances.
#include "render_internal.h"
#include "../base/hash.h"
#include <math.h>

static const f32 *position(const Mesh *mesh, u32 index) {
    return mesh->vertices[mesh->indices[index]].position;
}

f32 mesh_longest_edge(const Mesh *mesh) {
    f32 longest = 0.0f;
    for (u32 i = 0; i + 2 < mesh->index_count; i += 3)
        for (u32 k = 0; k < 3; k++) {
            const f32 *a = position(mesh, i + k), *b = position(mesh, i + (k + 1) % 3);
            f32 x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
            longest = MAX(longest, x * x + y * y + z * z);
        }
    return sqrtf(longest);
}

// Of an edge between positions, whichever way it goes; vertices that only differ in what is not
// position (seams, flat faces) are one here. Adding 0 makes -0 and 0 the same.
static u64 edge_hash(const f32 *a, const f32 *b) {
    f32 ends[2][3];
    for (u32 k = 0; k < 3; k++) ends[0][k] = a[k] + 0.0f, ends[1][k] = b[k] + 0.0f;
    u64 first = hash_bytes(ends[0], sizeof ends[0], 0);
    u64 second = hash_bytes(ends[1], sizeof ends[1], 0);
    u64 both[2] = {MIN(first, second), MAX(first, second)};
    return hash_bytes(both, sizeof both, 0);
}

bool mesh_is_closed(const Mesh *mesh) {
    // Exclusive-or of the edges' hashes: 0 if each lies between an even number of triangles, which
    // is what parity needs; chance makes it 0 once in 2^64.
    u64 odd = 0;
    f64 volume = 0.0; // six times; below 0 for a mesh that is seen from inside, as rooms are
    for (u32 i = 0; i + 2 < mesh->index_count; i += 3) {
        const f32 *a = position(mesh, i), *b = position(mesh, i + 1), *c = position(mesh, i + 2);
        odd ^= edge_hash(a, b) ^ edge_hash(b, c) ^ edge_hash(c, a);
        f64 x = (f64)b[1] * (f64)c[2] - (f64)b[2] * (f64)c[1];
        f64 y = (f64)b[2] * (f64)c[0] - (f64)b[0] * (f64)c[2];
        f64 z = (f64)b[0] * (f64)c[1] - (f64)b[1] * (f64)c[0];
        volume += (f64)a[0] * x + (f64)a[1] * y + (f64)a[2] * z;
    }
    return odd == 0 && volume > 0.0;
}
