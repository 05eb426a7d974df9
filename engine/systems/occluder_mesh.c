// occluder_mesh.c: triangles of occluding meshes, joined to convex polygons.
// Data in: the meshes of instances whose entity is an occluder of shape `mesh`. Data out: per mesh
// its largest convex polygons. Called by: the light manager's state when occluders come or go,
// occlusion.c. Does not: simplify, close holes, or move a point: a polygon is exactly a union of
// the mesh's own triangles.
//
// Joining matters because a texel counts only where one polygon covers it: two triangles of a wall
// would leave its diagonal open.
#include "occlusion.h"
#include <string.h>

#define COPLANAR_COS    0.99999f
#define COPLANAR_OFFSET 1e-4f // of the mesh's radius
#define EDGE_NONE       UINT32_MAX

typedef struct MeshWork {
    const Mesh *mesh;
    u32 triangle_count;
    u32 *corner;     // [3 * triangles] welded vertex of each corner
    u32 *neighbour;  // [3 * triangles] triangle across edge (corner k to k + 1), or EDGE_NONE
    Vec3 *normal;    // [triangles] unit, or zero for a degenerate one
    u8 *used;        // [triangles]
    u32 seed_cursor; // triangles before it are used
} MeshWork;

typedef struct Outline {
    u32 corner[OCCLUDER_POINTS_MAX];   // welded vertices in order
    u32 triangle[OCCLUDER_POINTS_MAX]; // the triangle that edge i (corner i to i + 1) is of
    u32 count;
    f32 area;
} Outline;

static Vec3 vertex_position(const Mesh *mesh, u32 index) {
    const f32 *p = mesh->vertices[index].position;
    return vec3(p[0], p[1], p[2]);
}

static u32 hash_words(const u32 *words, u32 count) {
    u32 h = 2166136261u;
    for (u32 i = 0; i < count; i++) h = (h ^ words[i]) * 0x9E3779B1u, h ^= h >> 15;
    return h;
}

// The first vertex with the same position stands for all.
static void weld(MeshWork *work, Arena *scratch) {
    const Mesh *mesh = work->mesh;
    u32 slots = 16;
    while (slots < 2 * mesh->vertex_count) slots *= 2;
    u32 *table = ARENA_PUSH(scratch, u32, slots),
        *first = ARENA_PUSH(scratch, u32, mesh->vertex_count);
    for (u32 v = 0; v < mesh->vertex_count; v++) {
        u32 bits[3];
        memcpy(bits, mesh->vertices[v].position, sizeof bits);
        u32 slot = hash_words(bits, 3) & (slots - 1);
        while (table[slot] &&
               memcmp(mesh->vertices[table[slot] - 1].position, bits, sizeof bits) != 0)
            slot = (slot + 1) & (slots - 1);
        if (!table[slot]) table[slot] = v + 1;
        first[v] = table[slot] - 1;
    }
    for (u32 i = 0; i < 3 * work->triangle_count; i++) work->corner[i] = first[mesh->indices[i]];
}

// Two triangles that run along an edge in opposite directions. An edge of more than two stays open.
static void find_neighbours(MeshWork *work, Arena *scratch) {
    u32 edge_count = 3 * work->triangle_count, slots = 16;
    while (slots < 2 * edge_count) slots *= 2;
    u32 *table = ARENA_PUSH(scratch, u32, slots); // edge + 1 by its directed corners
    u8 *doubled = ARENA_PUSH(scratch, u8, edge_count);
    for (u32 e = 0; e < edge_count; e++) {
        u32 ends[2] = {work->corner[e], work->corner[e - e % 3 + (e + 1) % 3]};
        u32 slot = hash_words(ends, 2) & (slots - 1);
        for (; table[slot]; slot = (slot + 1) & (slots - 1)) {
            u32 other = table[slot] - 1;
            if (work->corner[other] == ends[0] &&
                work->corner[other - other % 3 + (other + 1) % 3] == ends[1])
                break;
        }
        if (table[slot])
            doubled[table[slot] - 1] = 1;
        else
            table[slot] = e + 1;
    }
    for (u32 e = 0; e < edge_count; e++) {
        u32 ends[2] = {work->corner[e - e % 3 + (e + 1) % 3], work->corner[e]}; // the other way
        work->neighbour[e] = EDGE_NONE;
        for (u32 slot = hash_words(ends, 2) & (slots - 1); table[slot];
             slot = (slot + 1) & (slots - 1)) {
            u32 other = table[slot] - 1;
            if (work->corner[other] != ends[0] ||
                work->corner[other - other % 3 + (other + 1) % 3] != ends[1])
                continue;
            if (!doubled[other]) work->neighbour[e] = other / 3;
            break;
        }
    }
}

static Vec3 corner_position(const MeshWork *work, u32 corner) {
    return vertex_position(work->mesh, corner);
}

static bool turns_outwards(const MeshWork *work, Vec3 normal, u32 a, u32 b, u32 c) {
    Vec3 pa = corner_position(work, a), pb = corner_position(work, b),
         pc = corner_position(work, c);
    return vec3_dot(vec3_cross(vec3_sub(pb, pa), vec3_sub(pc, pb)), normal) >= 0.0f;
}

// Joins the neighbour across edge i if the outline stays convex and flat.
static bool join(MeshWork *work, Outline *outline, u32 i, Vec3 normal, f32 offset) {
    u32 n = outline->count, from = outline->corner[i], to = outline->corner[(i + 1) % n];
    u32 own = outline->triangle[i], other = EDGE_NONE;
    for (u32 k = 0; k < 3; k++)
        if (work->corner[3 * own + k] == from && work->corner[3 * own + (k + 1) % 3] == to)
            other = work->neighbour[3 * own + k];
    if (other == EDGE_NONE || work->used[other] || n == OCCLUDER_POINTS_MAX) return false;
    if (!(vec3_dot(work->normal[other], normal) > COPLANAR_COS)) return false;
    u32 tip = EDGE_NONE;
    for (u32 k = 0; k < 3; k++)
        if (work->corner[3 * other + k] != from && work->corner[3 * other + k] != to)
            tip = work->corner[3 * other + k];
    if (tip == EDGE_NONE) return false;
    Vec3 p = corner_position(work, tip);
    if (fabsf(vec3_dot(normal, p) - offset) > COPLANAR_OFFSET * work->mesh->radius) return false;
    for (u32 k = 0; k < n; k++)
        if (outline->corner[k] == tip) return false; // it closes a ring
    u32 before = outline->corner[(i + n - 1) % n], after = outline->corner[(i + 2) % n];
    if (!turns_outwards(work, normal, before, from, tip) ||
        !turns_outwards(work, normal, tip, to, after))
        return false;
    memmove(&outline->corner[i + 2], &outline->corner[i + 1], (n - i - 1) * sizeof(u32));
    memmove(&outline->triangle[i + 2], &outline->triangle[i + 1], (n - i - 1) * sizeof(u32));
    outline->corner[i + 1] = tip;
    outline->triangle[i] = outline->triangle[i + 1] = other;
    outline->count = n + 1;
    work->used[other] = 1;
    return true;
}

static f32 outline_area(const MeshWork *work, const Outline *outline) {
    Vec3 sum = {0}, first = corner_position(work, outline->corner[0]);
    for (u32 k = 2; k < outline->count; k++)
        sum =
            vec3_add(sum, vec3_cross(vec3_sub(corner_position(work, outline->corner[k - 1]), first),
                                     vec3_sub(corner_position(work, outline->corner[k]), first)));
    return 0.5f * vec3_length(sum);
}

static bool grow_outline(MeshWork *work, Outline *outline) {
    while (work->seed_cursor < work->triangle_count && work->used[work->seed_cursor])
        work->seed_cursor++;
    if (work->seed_cursor == work->triangle_count) return false;
    u32 seed = work->seed_cursor;
    work->used[seed] = 1;
    *outline = (Outline){.count = 3};
    for (u32 k = 0; k < 3; k++) {
        outline->corner[k] = work->corner[3 * seed + k];
        outline->triangle[k] = seed;
    }
    Vec3 normal = work->normal[seed];
    f32 offset = vec3_dot(normal, corner_position(work, outline->corner[0]));
    for (u32 i = 0; i < outline->count;) i = join(work, outline, i, normal, offset) ? 0 : i + 1;
    outline->area = outline_area(work, outline);
    return true;
}

static void find_normals(MeshWork *work) {
    for (u32 t = 0; t < work->triangle_count; t++) {
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) p[k] = corner_position(work, work->corner[3 * t + k]);
        work->normal[t] = vec3_normalize(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
        work->used[t] = !(vec3_dot(work->normal[t], work->normal[t]) > 0.5f);
    }
}

// The largest outlines of a mesh, largest first; equal ones in the order of their seeds. Returns
// how many.
static u32 mesh_outlines(const Mesh *mesh, Outline *out, Arena *scratch) {
    MeshWork work = {.mesh = mesh, .triangle_count = mesh->lods[0].index_count / 3};
    if (work.triangle_count == 0 || work.triangle_count > OCCLUDER_TRIANGLES_MAX) return 0;
    u64 mark = arena_mark(scratch);
    work.corner = ARENA_PUSH(scratch, u32, 3 * work.triangle_count);
    work.neighbour = ARENA_PUSH(scratch, u32, 3 * work.triangle_count);
    work.normal = ARENA_PUSH(scratch, Vec3, work.triangle_count);
    work.used = ARENA_PUSH(scratch, u8, work.triangle_count);
    weld(&work, scratch);
    find_neighbours(&work, scratch);
    find_normals(&work);
    u32 count = 0;
    Outline outline;
    while (grow_outline(&work, &outline)) {
        u32 at = count < OCCLUDER_POLYGONS_MAX ? count++ : count;
        if (at == OCCLUDER_POLYGONS_MAX && out[--at].area >= outline.area) continue;
        for (; at > 0 && out[at - 1].area < outline.area; at--) out[at] = out[at - 1];
        out[at] = outline;
    }
    arena_rewind(scratch, mark);
    return count;
}

OccluderPolygons *occluder_polygons_build(const World *world, const AssetStore *assets,
                                          Arena *arena, Arena *scratch) {
    const OccluderTable *o = WORLD_TABLE(world, Occluder, occluder);
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    u64 mark = arena_mark(scratch);
    u8 *wanted = ARENA_PUSH(scratch, u8, assets->mesh_count);
    u32 wanted_count = 0;
    for (u32 row = 0; row < d->table.count; row++) {
        u32 at = table_row(&o->table, d->owner[row]), mesh = d->mesh[row];
        if (at == ROW_NONE || o->shape[at] != OCCLUDER_MESH || mesh >= assets->mesh_count) continue;
        wanted_count += !wanted[mesh];
        wanted[mesh] = 1;
    }
    Outline *outlines = ARENA_PUSH(scratch, Outline, (u64)wanted_count * OCCLUDER_POLYGONS_MAX + 1);
    OccluderPolygons *polygons = ARENA_PUSH(arena, OccluderPolygons, 1);
    polygons->mesh_count = assets->mesh_count;
    polygons->first = ARENA_PUSH(arena, u32, assets->mesh_count + 1);
    u32 count = 0, point_count = 0;
    for (u32 mesh = 0; mesh < assets->mesh_count; mesh++) {
        polygons->first[mesh] = count;
        if (wanted[mesh]) count += mesh_outlines(&assets->meshes[mesh], outlines + count, scratch);
    }
    polygons->first[assets->mesh_count] = polygons->polygon_count = count;
    for (u32 i = 0; i < count; i++) point_count += outlines[i].count;
    polygons->begin = ARENA_PUSH(arena, u32, count + 1);
    polygons->points = ARENA_PUSH(arena, Vec3, point_count);
    for (u32 mesh = 0, at = 0; mesh < assets->mesh_count; mesh++)
        for (u32 i = polygons->first[mesh]; i < polygons->first[mesh + 1]; i++)
            for (u32 k = 0; k < outlines[i].count; k++) {
                polygons->points[at++] =
                    vertex_position(&assets->meshes[mesh], outlines[i].corner[k]);
                polygons->begin[i + 1] = at;
            }
    arena_rewind(scratch, mark);
    return polygons;
}
