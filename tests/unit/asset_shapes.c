// asset_shapes.c: the seven shapes are closed, face outwards, and are where they should be.
#include "asset_fixture.h"
#include <stdlib.h>
#include <string.h>

static const Mesh *shape_mesh(AssetFixture *f, ShapeDesc desc) {
    u32 id = asset_generate_model(&f->store, &desc);
    assert_int_not_equal(id, 0);
    const Model *model = &f->store.models[id];
    assert_int_equal(model->part_count, 1);
    assert_int_equal(model->material_count, 1);
    return &f->store.meshes[model->parts[0].mesh];
}

// Vertices by position: for every index the first vertex at the same place.
static u32 *weld_positions(const Mesh *mesh, u32 *unique_count) {
    u32 *first = malloc(mesh->vertex_count * sizeof *first);
    *unique_count = 0;
    for (u32 i = 0; i < mesh->vertex_count; i++) {
        first[i] = i;
        for (u32 k = 0; k < i && first[i] == i; k++)
            if (memcmp(mesh->vertices[i].position, mesh->vertices[k].position, 12) == 0)
                first[i] = k;
        *unique_count += first[i] == i;
    }
    return first;
}

typedef struct Edge {
    u32 from, to;
} Edge;

static int compare_edges(const void *a, const void *b) { return memcmp(a, b, sizeof(Edge)); }

// Every directed edge once, and its reverse once: closed, two-sided, wound the same way.
static void assert_closed(const Mesh *mesh, i32 euler) {
    u32 vertex_count, edge_count = mesh->index_count;
    u32 *first = weld_positions(mesh, &vertex_count);
    Edge *edges = calloc(edge_count, sizeof *edges);
    for (u32 i = 0; i < edge_count; i++) {
        u32 next = i % 3 == 2 ? i - 2 : i + 1;
        edges[i] = (Edge){first[mesh->indices[i]], first[mesh->indices[next]]};
        assert_int_not_equal(edges[i].from, edges[i].to);
    }
    qsort(edges, edge_count, sizeof *edges, compare_edges);
    for (u32 i = 0; i < edge_count; i++) {
        if (i) assert_true(compare_edges(&edges[i - 1], &edges[i]) != 0);
        Edge reverse = {edges[i].to, edges[i].from};
        assert_non_null(bsearch(&reverse, edges, edge_count, sizeof *edges, compare_edges));
    }
    i32 found = (i32)vertex_count - (i32)edge_count / 2 + (i32)mesh->index_count / 3;
    assert_int_equal(found, euler);
    free(edges);
    free(first);
}

// Winding agrees with normals; tangents are at right angles and give u and v their directions.
static void assert_oriented(const Mesh *mesh) {
    for (u32 t = 0; t < mesh->index_count / 3; t++) {
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) p[k] = mesh_position(mesh, t, k);
        Vec3 e1 = vec3_sub(p[1], p[0]), e2 = vec3_sub(p[2], p[0]);
        Vec3 face = vec3_cross(e1, e2);
        assert_true(vec3_length(face) > 1e-7f);
        face = vec3_normalize(face);
        const MeshVertex *c[3];
        for (u32 k = 0; k < 3; k++) {
            c[k] = mesh_corner(mesh, t, k);
            assert_true(vec3_dot(asset_unpack_normal(c[k]->normal), face) > 0.7f);
        }
        f32 area = (c[1]->uv[0] - c[0]->uv[0]) * (c[2]->uv[1] - c[0]->uv[1]) -
                   (c[2]->uv[0] - c[0]->uv[0]) * (c[1]->uv[1] - c[0]->uv[1]);
        // v runs downwards: an unmirrored picture turns the other way round than the triangle.
        u32 sign = c[0]->tangent >> 31;
        assert_true(sign ? area > 0 : area < 0);
    }
}

static f64 mesh_volume(const Mesh *mesh) {
    f64 sum = 0;
    for (u32 t = 0; t < mesh->index_count / 3; t++)
        sum += vec3_dot(mesh_position(mesh, t, 0),
                        vec3_cross(mesh_position(mesh, t, 1), mesh_position(mesh, t, 2)));
    return sum / 6;
}

static void assert_box(const Mesh *mesh, f32 x, f32 y, f32 z, f32 eps) {
    ASSERT_NEAR(mesh->max.x, x, eps);
    ASSERT_NEAR(mesh->max.y, y, eps);
    ASSERT_NEAR(mesh->max.z, z, eps);
    ASSERT_NEAR(mesh->min.x, -x, eps);
    ASSERT_NEAR(mesh->min.y, -y, eps);
    ASSERT_NEAR(mesh->min.z, -z, eps);
    for (u32 i = 0; i < mesh->vertex_count; i++) {
        const f32 *p = mesh->vertices[i].position;
        assert_true(vec3_length(vec3_sub(vec3(p[0], p[1], p[2]), mesh->center)) <=
                    mesh->radius * 1.00001f);
    }
}

typedef struct Expected {
    Shape shape;
    i32 euler;
    f32 x, y, z;
    f64 volume, volume_eps;
} Expected;

static const Expected solids[] = {
    {SHAPE_CUBE, 2, 0.5f, 0.5f, 0.5f, 1, 1e-6},
    {SHAPE_SPHERE, 2, 0.5f, 0.5f, 0.5f, 0.5236, 0.012},
    {SHAPE_ICOSAHEDRON, 2, 0.42532f, 0.42532f, 0.42532f, 0.317, 1e-3},
    {SHAPE_CONE, 2, 0.5f, 0.5f, 0.5f, 0.2618, 0.003},
    {SHAPE_CYLINDER, 2, 0.5f, 0.5f, 0.5f, 0.7854, 0.006},
    {SHAPE_TORUS, 0, 0.7f, 0.2f, 0.7f, 0.3948, 0.015},
};

TEST(asset_shapes, solids_are_closed_and_face_outwards) {
    AssetFixture *f = fixture_open();
    for (u32 i = 0; i < COUNT_OF(solids); i++) {
        const Expected *e = &solids[i];
        const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = e->shape});
        assert_closed(mesh, e->euler);
        assert_oriented(mesh);
        assert_box(mesh, e->x, e->y, e->z, 1e-4f);
        ASSERT_NEAR(mesh_volume(mesh), e->volume, e->volume_eps);
        assert_false(mesh->has_color);
    }
    fixture_close(f);
}

TEST(asset_shapes, inverted_solids_face_inwards) {
    AssetFixture *f = fixture_open();
    for (u32 i = 0; i < COUNT_OF(solids); i++) {
        const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = solids[i].shape, .inverted = true});
        assert_closed(mesh, solids[i].euler);
        assert_oriented(mesh);
        ASSERT_NEAR(mesh_volume(mesh), -solids[i].volume, solids[i].volume_eps);
    }
    fixture_close(f);
}

TEST(asset_shapes, few_and_many_segments_stay_closed) {
    AssetFixture *f = fixture_open();
    static const u32 segments[] = {1, 3, 7, 48};
    for (u32 i = 0; i < COUNT_OF(solids); i++)
        for (u32 s = 0; s < COUNT_OF(segments); s++) {
            const Mesh *mesh = shape_mesh(
                f, (ShapeDesc){.shape = solids[i].shape, .segments = segments[s], .rings = 5});
            assert_closed(mesh, solids[i].euler);
        }
    fixture_close(f);
}

TEST(asset_shapes, the_plane_faces_up) {
    AssetFixture *f = fixture_open();
    const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = SHAPE_PLANE, .segments = 4});
    assert_int_equal(mesh->index_count, 4 * 4 * 6);
    assert_int_equal(mesh->vertex_count, 25);
    assert_oriented(mesh);
    assert_box(mesh, 0.5f, 0, 0.5f, 0);
    for (u32 i = 0; i < mesh->vertex_count; i++)
        assert_true(asset_unpack_normal(mesh->vertices[i].normal).y > 0.9999f);
    fixture_close(f);
}

TEST(asset_shapes, uvs_repeat) {
    AssetFixture *f = fixture_open();
    const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = SHAPE_CUBE, .uv_repeat = 3});
    f32 most = 0;
    for (u32 i = 0; i < mesh->vertex_count; i++) most = fmaxf(most, mesh->vertices[i].uv[0]);
    ASSERT_NEAR(most, 3, 0);
    fixture_close(f);
}

TEST(asset_shapes, equal_descriptions_are_one_model) {
    AssetFixture *f = fixture_open();
    u32 plain = asset_generate_model(&f->store, &(ShapeDesc){.shape = SHAPE_SPHERE});
    u32 spelt = asset_generate_model(&f->store, &(ShapeDesc){.shape = SHAPE_SPHERE,
                                                             .segments = 32,
                                                             .rings = 16,
                                                             .tube = 5, // of no meaning here
                                                             .uv_repeat = 1});
    u32 other = asset_generate_model(&f->store, &(ShapeDesc){.shape = SHAPE_SPHERE, .rings = 8});
    assert_int_equal(plain, spelt);
    assert_int_not_equal(plain, other);
    assert_true(f->store.models[plain].content_hash != f->store.models[other].content_hash);
    fixture_close(f);
}
