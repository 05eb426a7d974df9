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

TEST(asset_lods, rims_stay_and_the_same_mesh_gives_the_same_levels) {
    AssetFixture *f = fixture_open();
    const Mesh *a = shape_mesh(f, (ShapeDesc){.shape = SHAPE_PLANE, .segments = 16});
    assert_ranges(a);
    assert_true(a->lod_count >= 2 && a->lods[1].error < 1e-4f);
    for (u32 i = 0; i < a->lod_count; i++) {
        u32 rim = 0; // edges of the full mesh along x = -0.5
        for (u32 k = 0; k < a->lods[i].index_count; k++) {
            u32 at = a->lods[i].first_index + k;
            const f32 *p = a->vertices[a->indices[at]].position,
                      *q = a->vertices[a->indices[k % 3 == 2 ? at - 2 : at + 1]].position;
            rim += p[0] == -0.5f && q[0] == -0.5f && fabsf(p[2] - q[2]) < 0.07f;
        }
        assert_int_equal(rim, 16);
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
