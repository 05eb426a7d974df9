// asset_lods.c: coarser levels are ranges of one index array that stay closed and near the surface.
#include "asset_fixture.h"
#include "../../engine/base/random.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SEED 0x10D5

static const Mesh *shape_mesh(AssetFixture *f, ShapeDesc desc) {
    return &f->store.meshes[f->store.models[asset_generate_model(&f->store, &desc)].parts[0].mesh];
}

static void assert_ranges(const Mesh *mesh) {
    assert_true(mesh->lod_count >= 1 && mesh->lod_count <= MESH_LODS_CAP);
    assert_true(mesh->lods[0].first_index == 0 && mesh->lods[0].index_count == mesh->index_count);
    assert_true(mesh->lods[0].error == 0);
    u32 next = 0;
    for (u32 i = 0; i < mesh->lod_count; i++) {
        const MeshLod *lod = &mesh->lods[i];
        assert_int_equal(lod->first_index, next);
        next += lod->index_count;
        assert_int_equal(lod->index_count % 3, 0);
        for (u32 k = lod->first_index; k < next; k++)
            assert_true(mesh->indices[k] < mesh->vertex_count);
        if (i == 0) continue;
        assert_true(lod->error >= lod[-1].error && isfinite(lod->error));
        assert_true(lod->index_count > 0 && lod->index_count * 4ull <= lod[-1].index_count * 3ull);
    }
    assert_int_equal(next, mesh->total_index_count);
}

static bool same_place(const MeshVertex *a, const MeshVertex *b) {
    return memcmp(a->position, b->position, sizeof a->position) == 0;
}

// Every edge has its reverse, by position.
static void assert_closed(const Mesh *mesh, const MeshLod *lod) {
    const u32 *indices = mesh->indices + lod->first_index;
    for (u32 i = 0; i < lod->index_count; i++) {
        const MeshVertex *from = &mesh->vertices[indices[i]],
                         *to = &mesh->vertices[indices[i % 3 == 2 ? i - 2 : i + 1]];
        bool found = false;
        for (u32 k = 0; k < lod->index_count && !found; k++)
            found = same_place(&mesh->vertices[indices[k]], to) &&
                    same_place(&mesh->vertices[indices[k % 3 == 2 ? k - 2 : k + 1]], from);
        assert_true(found);
    }
}

TEST(asset_lods, closed_shapes_stay_closed_and_near) {
    AssetFixture *f = fixture_open();
    const Shape shapes[] = {SHAPE_SPHERE, SHAPE_TORUS, SHAPE_CYLINDER};
    for (u32 s = 0; s < COUNT_OF(shapes); s++) {
        const Mesh *mesh =
            shape_mesh(f, (ShapeDesc){.shape = shapes[s], .segments = 40, .rings = 20});
        assert_ranges(mesh);
        assert_true(mesh->lod_count >= 3);
        for (u32 i = 0; i < mesh->lod_count; i++) assert_closed(mesh, &mesh->lods[i]);
        assert_true(mesh->lods[1].error < 0.02f);
    }
    fixture_close(f);
}

// The middle of a triangle of the sphere lies about `error` below it, not much more.
TEST(asset_lods, errors_tell_the_distance) {
    AssetFixture *f = fixture_open();
    const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = SHAPE_SPHERE, .segments = 64});
    for (u32 i = 1; i < mesh->lod_count; i++) {
        const MeshLod *lod = &mesh->lods[i];
        f64 sum = 0;
        for (u32 k = 0; k < lod->index_count; k += 3) {
            Vec3 middle = {0};
            for (u32 c = 0; c < 3; c++) {
                const f32 *p = mesh->vertices[mesh->indices[lod->first_index + k + c]].position;
                middle = vec3_add(middle, vec3_scale(vec3(p[0], p[1], p[2]), 1.0f / 3.0f));
            }
            sum += 0.5 - vec3_length(middle);
        }
        f64 mean = sum / (lod->index_count / 3);
        assert_true(mean < 2 * lod->error + 0.003);
    }
    fixture_close(f);
}

TEST(asset_lods, small_meshes_have_one_level) {
    AssetFixture *f = fixture_open();
    const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = SHAPE_CUBE});
    assert_ranges(mesh);
    assert_int_equal(mesh->lod_count, 1);
    assert_ranges(&f->store.meshes[0]);
    fixture_close(f);
}

// Squared distance of a point from a triangle: from its plane where the point is above it, else
// from its edges.
static f64 triangle_distance2(const f64 t[3][3], const f64 p[3]) {
    f64 e[3][3], n[3], best = INFINITY;
    bool above = true;
    for (u32 k = 0; k < 3; k++)
        for (u32 a = 0; a < 3; a++) e[k][a] = t[(k + 1) % 3][a] - t[k][a];
    for (u32 a = 0; a < 3; a++)
        n[a] = e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
    f64 n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], height = 0;
    for (u32 k = 0; k < 3; k++) {
        f64 d[3], along = 0, length2 = 0, side = 0, distance2 = 0;
        for (u32 a = 0; a < 3; a++) d[a] = p[a] - t[k][a];
        for (u32 a = 0; a < 3; a++) {
            along += d[a] * e[k][a], length2 += e[k][a] * e[k][a];
            side +=
                n[a] * (e[k][(a + 1) % 3] * d[(a + 2) % 3] - e[k][(a + 2) % 3] * d[(a + 1) % 3]);
        }
        above = above && side >= 0;
        f64 at = length2 > 0 ? CLAMP(along / length2, 0.0, 1.0) : 0.0;
        for (u32 a = 0; a < 3; a++) distance2 += (d[a] - at * e[k][a]) * (d[a] - at * e[k][a]);
        best = MIN(best, distance2);
        if (k == 0) height = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    }
    return above && n2 > 0 ? height * height / n2 : best;
}

// Levels remember only some of the vertices that are gone.
#define FORGOTTEN 1.5

TEST(asset_lods, no_vertex_is_farther_from_a_level_than_it_says) {
    AssetFixture *f = fixture_open();
    const Shape shapes[] = {SHAPE_SPHERE, SHAPE_TORUS, SHAPE_CYLINDER, SHAPE_CONE};
    for (u32 s = 0; s < COUNT_OF(shapes); s++) {
        const Mesh *mesh =
            shape_mesh(f, (ShapeDesc){.shape = shapes[s], .segments = 24, .rings = 12});
        assert_true(mesh->lod_count >= 2);
        for (u32 i = 1; i < mesh->lod_count; i++) {
            const MeshLod *lod = &mesh->lods[i];
            f64 worst = 0;
            for (u32 v = 0; v < mesh->vertex_count; v++) {
                f64 p[3], t[3][3], nearest = INFINITY;
                for (u32 a = 0; a < 3; a++) p[a] = mesh->vertices[v].position[a];
                for (u32 k = 0; k < lod->index_count; k += 3) {
                    for (u32 c = 0; c < 9; c++)
                        t[c / 3][c % 3] =
                            mesh->vertices[mesh->indices[lod->first_index + k + c / 3]]
                                .position[c % 3];
                    nearest = MIN(nearest, triangle_distance2(t, p));
                }
                worst = MAX(worst, nearest);
            }
            if (sqrt(worst) > FORGOTTEN * lod->error + 1e-6)
                fail_msg("%s level %u: %g m away, %g said", shape_names[shapes[s]], i, sqrt(worst),
                         (f64)lod->error);
        }
    }
    fixture_close(f);
}

// Corners keep the normal of their own side of an edge.
TEST(asset_lods, hard_edges_stay_hard) {
    AssetFixture *f = fixture_open();
    const Mesh *mesh = shape_mesh(f, (ShapeDesc){.shape = SHAPE_CYLINDER, .segments = 48});
    assert_true(mesh->lod_count >= 3);
    for (u32 i = 0; i < mesh->lod_count; i++)
        for (u32 k = 0; k < mesh->lods[i].index_count; k += 3) {
            const u32 *corners = &mesh->indices[mesh->lods[i].first_index + k];
            Vec3 p[3];
            for (u32 c = 0; c < 3; c++) memcpy(&p[c], mesh->vertices[corners[c]].position, 12);
            Vec3 flat = vec3_normalize(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
            for (u32 c = 0; c < 3; c++)
                assert_true(vec3_dot(flat, asset_unpack_normal(mesh->vertices[corners[c]].normal)) >
                            0.6f);
        }
    fixture_close(f);
}

TEST(asset_lods, rims_keep_their_line_and_the_same_mesh_gives_the_same_levels) {
    AssetFixture *f = fixture_open();
    const Mesh *a = shape_mesh(f, (ShapeDesc){.shape = SHAPE_PLANE, .segments = 16});
    assert_ranges(a);
    assert_true(a->lod_count >= 2 && a->lods[1].error < 1e-4f);
    for (u32 i = 0; i < a->lod_count && a->lods[i].error < 1e-4f; i++) {
        f64 area = 0; // a plane of one square metre, whole and without folds
        for (u32 k = 0; k < a->lods[i].index_count; k += 3) {
            const u32 *c = &a->indices[a->lods[i].first_index + k];
            const f32 *p = a->vertices[c[0]].position, *q = a->vertices[c[1]].position,
                      *r = a->vertices[c[2]].position;
            f64 twice = (f64)(q[2] - p[2]) * (r[0] - p[0]) - (f64)(q[0] - p[0]) * (r[2] - p[2]);
            assert_true(twice > 0);
            area += 0.5 * twice;
        }
        assert_true(fabs(area - 1) < 1e-5);
    }
    u32 id = asset_add_mesh(&f->store, a->vertices, a->vertex_count, a->indices, a->index_count);
    const Mesh *b = &f->store.meshes[id];
    assert_memory_equal(a->lods, b->lods, sizeof a->lods);
    assert_memory_equal(a->indices, b->indices, a->total_index_count * sizeof(u32));
    fixture_close(f);
}

// What a capture from a stranger may hold: any indices, any finite positions.
TEST(asset_lods, damaged_meshes_do_no_harm) {
    AssetFixture *f = fixture_open();
    enum { VERTICES = 60, INDICES = 900 };
    MeshVertex *v = calloc(VERTICES, sizeof *v);
    u32 *indices = calloc(INDICES, sizeof *indices);
    for (u32 round = 0; round < 100; round++) {
        f32 size = round % 3 == 0 ? 3e38f : round % 3 == 1 ? 1e-30f : 10.0f;
        for (u32 i = 0; i < VERTICES; i++)
            for (u32 a = 0; a < 3; a++)
                v[i].position[a] = random_range(SEED, round, i * 3 + a, -1, 1) * size;
        for (u32 i = 0; i < INDICES; i++) // different corners in a triangle, or not
            indices[i] = random_u32(SEED, 1000 + round, i) % (VERTICES / 3) +
                         (round % 2 ? i % 3 * (VERTICES / 3) : 0);
        assert_ranges(&f->store.meshes[asset_add_mesh(&f->store, v, VERTICES, indices, INDICES)]);
    }
    free(v);
    free(indices);
    fixture_close(f);
}
