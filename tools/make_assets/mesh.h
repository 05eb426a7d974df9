// Mesh builder: a soup of triangles that becomes indexed vertices with normals and tangents.
//
// Data in: triangles with positions, texture coordinates and a material number, placed through a
// current transform. Data out: one Mesh with a run of indices per material. Called by shapes.c
// (which turns boxes, lathes and sweeps into triangles) and by the models. It does not simplify,
// does not reorder for a vertex cache, and knows no files.
//
// Use: soup_init, then soup_use a material, add triangles, soup_build, soup_free.
#ifndef MAKE_ASSETS_MESH_H
#define MAKE_ASSETS_MESH_H

#include "vec.h"

#include <stdbool.h>
#include <stdint.h>

#define MESH_MATERIALS_MAX 64
#define CREASE_VALLEYS     128 // added to an angle

typedef struct Vertex {
    Vec3 position, normal;
    float tangent[4]; // bitangent = cross(normal, tangent.xyz) * tangent.w, glTF's convention
    Vec2 uv;          // v grows downwards, as in the image
    uint32_t tint;    // linear RGBA8, red lowest
} Vertex;

// Indices of material m are indices[first[m] .. first[m] + count[m]).
typedef struct Mesh {
    Vertex *vertices;
    uint32_t *indices;
    uint32_t vertex_count, index_count;
    uint32_t first[MESH_MATERIALS_MAX], count[MESH_MATERIALS_MAX];
} Mesh;

// The first three columns have three rows per triangle. `normal` is zero where soup_build shall
// compute it.
typedef struct Soup {
    Vec3 *position;
    Vec3 *normal;
    Vec2 *uv; // here v grows upwards
    uint8_t *material;
    uint8_t *crease_deg; // 0: the whole mesh's; with CREASE_VALLEYS
    uint32_t *tint;
    uint32_t triangle_count, triangle_cap;
    Affine transform;
    int surface_now;
    float tile_m; // metres that one texture repeat spans, from the surface
    uint8_t crease_now_deg;
} Soup;

void soup_init(Soup *s);
void soup_free(Soup *s);

// Sets the surface (materials.h) of the triangles that follow: their material and tint.
void soup_use(Soup *s, int surface);

// Triangles that follow are smooth where they meet each other at less than crease_deg; 0 goes back
// to the angle that soup_build gets. soup_carve rounds ridges only and keeps valleys sharp.
void soup_smooth(Soup *s, int crease_deg);
void soup_carve(Soup *s, int crease_deg);

// Counter-clockwise seen from outside, in the current transform's space; a mirroring transform
// keeps faces outward. uv in texture repeats. Triangles without area are dropped.
void soup_triangle(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec2 ua, Vec2 ub, Vec2 uc);
void soup_quad(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec2 ua, Vec2 ub, Vec2 uc, Vec2 ud);

// The same with texture coordinates by box projection of the transformed position, so that
// courses of stone line up across neighbouring pieces.
void soup_triangle_box(Soup *s, Vec3 a, Vec3 b, Vec3 c);
void soup_quad_box(Soup *s, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

// Points the normals of triangles [first, end) away from `center`, squashed towards up: foliage
// cards are lit like the round crown that they stand for.
void soup_set_crown_normals(Soup *s, uint32_t first, Vec3 center, float up);

// Welds corners, averages normals over faces that meet at less than crease_deg, adds tangents.
// The caller frees the mesh with mesh_free.
Mesh soup_build(const Soup *s, float crease_deg);
void mesh_free(Mesh *m);

#endif
