// mesh_simplify.h: takes triangles out of a mesh, those that are missed least first.
//
// Use: simplify_begin, then any number of times simplify_until and simplify_write. Memory is the
// caller's arena; nothing is given back. The same mesh gives the same triangles.
#ifndef LUZ_MESH_SIMPLIFY_H
#define LUZ_MESH_SIMPLIFY_H
#include "asset.h"

typedef struct Simplifier Simplifier;

// NULL: no memory. The mesh has a radius, and stays as it is meanwhile.
Simplifier *simplify_begin(Arena *scratch, const Mesh *mesh);
// Goes on until no more than so many triangles are left, or the error would be larger than
// error_max (m); then on while the error grows by no more than the factor slack. Returns the error
// (m): no vertex of the full mesh is, about, farther from the surface.
f32 simplify_until(Simplifier *s, u32 triangles, f32 error_max, f32 slack);
u32 simplify_triangles(const Simplifier *s);
// Indices of the mesh's vertices; returns how many.
u32 simplify_write(const Simplifier *s, u32 *indices);

#endif
