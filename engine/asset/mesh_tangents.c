// mesh_tangents.c: tangents from texture coordinates, in the manner of MikkTSpace.
//
// Data in: welded vertices with normals and uvs, triangle indices. Data out: a tangent and a sign
// in every vertex; vertices between mirrored halves of a texture are split in two. Called by
// mesh_process. Does not: weld, or change positions, normals and uvs.
//
// As there (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008): a triangle's direction
// of growing u is projected into each corner's tangent plane, normalised and weighted by the
// corner's angle; handedness never mixes. Unlike there, all triangles of one handedness at a
// vertex are one group, whether they share an edge or not; the difference shows only where two
// texture islands touch in one vertex with equal uvs.
//
// The sign follows glTF: v grows downwards, the bitangent cross(normal, tangent) * sign points
// upwards in the picture, so an unmirrored mapping has sign +1.
#include "asset_internal.h"
#include <math.h>

// What one vertex gathers, for each handedness (0: sign +1, 1: sign -1).
typedef struct Gather {
    Vec3 sum[2];
    u32 split; // index of the vertex's second half, 0 = none
    u8 used[2];
} Gather;

static Vec3 project(Vec3 v, Vec3 normal) {
    return vec3_normalize(vec3_sub(v, vec3_scale(normal, vec3_dot(v, normal))));
}

// Direction of growing u on the triangle, not unit. False where the mapping has no area.
static bool u_direction(const SourceVertex *const corner[3], Vec3 *direction, u32 *hand) {
    Vec3 e1 = vec3_sub(corner[1]->position, corner[0]->position);
    Vec3 e2 = vec3_sub(corner[2]->position, corner[0]->position);
    f32 u1 = corner[1]->uv.x - corner[0]->uv.x, v1 = corner[1]->uv.y - corner[0]->uv.y;
    f32 u2 = corner[2]->uv.x - corner[0]->uv.x, v2 = corner[2]->uv.y - corner[0]->uv.y;
    f32 area = u1 * v2 - u2 * v1; // negative where the picture is not mirrored: v runs downwards
    *hand = area > 0.0f;
    if (area == 0.0f || !isfinite(area)) return false;
    f32 flip = area > 0.0f ? 1.0f : -1.0f;
    *direction = vec3_normalize(vec3_scale(vec3_sub(vec3_scale(e1, v2), vec3_scale(e2, v1)), flip));
    return vec3_dot(*direction, *direction) > 0.5f;
}

static void gather_corner(Gather *gather, const SourceVertex *const corner[3], u32 k,
                          Vec3 direction, u32 hand) {
    const SourceVertex *v = corner[k];
    gather->used[hand] = 1;
    Vec3 tangent = project(direction, v->normal);
    Vec3 a = project(vec3_sub(corner[(k + 1) % 3]->position, v->position), v->normal);
    Vec3 b = project(vec3_sub(corner[(k + 2) % 3]->position, v->position), v->normal);
    f32 angle = det_atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
    gather->sum[hand] = vec3_add(gather->sum[hand], vec3_scale(tangent, angle));
}

static void set_tangent(SourceVertex *v, Vec3 sum, u32 hand) {
    Vec3 t = project(sum, v->normal);
    if (!(vec3_dot(t, t) > 0.5f)) t = mesh_any_tangent(v->normal);
    v->tangent = (Vec4){t.x, t.y, t.z, hand ? -1.0f : 1.0f};
}

u32 mesh_make_tangents(Arena *scratch, SourceVertex *vertices, u32 vertex_count, u32 *indices,
                       u32 index_count) {
    u64 mark = arena_mark(scratch);
    Gather *gather = scratch_try_push(scratch, vertex_count, sizeof *gather);
    u8 *hands = scratch_try_push(scratch, index_count / 3, 1); // 2: no area in the picture
    if (!gather || !hands) {
        arena_rewind(scratch, mark);
        return 0;
    }
    for (u32 t = 0; t < index_count / 3; t++) {
        const u32 *triangle = indices + t * 3;
        const SourceVertex *const corner[3] = {&vertices[triangle[0]], &vertices[triangle[1]],
                                               &vertices[triangle[2]]};
        Vec3 direction;
        u32 hand;
        bool mapped = u_direction(corner, &direction, &hand);
        hands[t] = mapped ? (u8)hand : 2;
        for (u32 k = 0; mapped && k < 3; k++)
            gather_corner(&gather[triangle[k]], corner, k, direction, hand);
    }
    u32 new_count = vertex_count;
    for (u32 i = 0; i < vertex_count; i++) {
        bool both = gather[i].used[0] && gather[i].used[1];
        if (both) {
            vertices[new_count] = vertices[i];
            set_tangent(&vertices[new_count], gather[i].sum[1], 1);
            gather[i].split = new_count++;
        }
        u32 hand = gather[i].used[0] ? 0 : gather[i].used[1] ? 1 : 0;
        set_tangent(&vertices[i], gather[i].sum[hand], hand);
    }
    for (u32 i = 0; i < index_count; i++) {
        u32 split = gather[indices[i]].split;
        if (split && hands[i / 3] == 1) indices[i] = split;
    }
    arena_rewind(scratch, mark);
    return new_count;
}
