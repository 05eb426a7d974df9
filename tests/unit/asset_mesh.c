// asset_mesh.c: packing, tangents and mirrored copies.
#include "asset_fixture.h"
#include "../../engine/asset/asset_internal.h"
#include "../../engine/base/random.h"
#include <string.h>

#define SEED 20240611

static Vec3 random_direction(u64 counter) {
    Vec3 v;
    do {
        v = vec3(random_range(SEED, 0, counter, -1, 1), random_range(SEED, 1, counter, -1, 1),
                 random_range(SEED, 2, counter, -1, 1));
        counter += 1000003;
    } while (vec3_length(v) < 0.05f || vec3_length(v) > 1);
    return vec3_normalize(v);
}

// As a shader reads it.
static Vec3 decode_tangent(u32 packed, f32 *sign) {
    f32 x = (f32)(int16_t)(packed & 0xFFFF) / 32767.0f;
    i32 y_bits = (i32)(packed >> 16 & 0x7FFF);
    f32 y = (f32)(y_bits >= 16384 ? y_bits - 32768 : y_bits) / 16383.0f;
    *sign = packed >> 31 ? -1.0f : 1.0f;
    Vec3 n = {x, y, 1.0f - fabsf(x) - fabsf(y)};
    f32 t = fmaxf(-n.z, 0);
    n.x += n.x >= 0 ? -t : t;
    n.y += n.y >= 0 ? -t : t;
    return vec3_normalize(n);
}

TEST(asset_mesh, packed_normals_are_near) {
    f32 worst = 0;
    for (u32 i = 0; i < 20000; i++) {
        Vec3 n = random_direction(i);
        Vec3 back = asset_unpack_normal(asset_pack_normal(n));
        worst = fmaxf(worst, vec3_length(vec3_sub(n, back)));
        ASSERT_NEAR(vec3_length(back), 1, 1e-6);
    }
    // Half a step of 1 / 32767 in x and y moves z by both: sqrt(1 + 1 + 4) / 65534, and the
    // octahedron's faces are 1 / sqrt 3 from the centre.
    assert_true(worst < 6.5e-5f);
    static const Vec3 axes[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                 {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    for (u32 i = 0; i < 6; i++) {
        Vec3 back = asset_unpack_normal(asset_pack_normal(axes[i]));
        ASSERT_NEAR(vec3_length(vec3_sub(axes[i], back)), 0, 1e-6);
    }
    assert_int_equal(asset_pack_normal(vec3(0, 0, 0)), asset_pack_normal(vec3(0, 0, 1)));
}

TEST(asset_mesh, packed_tangents_keep_direction_and_sign) {
    f32 worst = 0;
    for (u32 i = 0; i < 20000; i++) {
        Vec3 t = random_direction(i);
        f32 sign = i % 2 ? 1.0f : -1.0f, sign_back;
        Vec3 back = decode_tangent(asset_pack_tangent(t, sign), &sign_back);
        worst = fmaxf(worst, vec3_length(vec3_sub(t, back)));
        assert_true(sign == sign_back);
    }
    assert_true(worst < 1.0e-4f); // as above with steps of 1 / 32767 and 1 / 16383
}

// A square in xy facing +z; `mirror` runs u to the left.
static u32 make_square(AssetStore *store, bool mirror, bool tangents, char *why) {
    SourceVertex v[4];
    memset(v, 0, sizeof v);
    for (u32 i = 0; i < 4; i++) {
        f32 x = i & 1 ? 1.0f : 0.0f, y = i & 2 ? 1.0f : 0.0f;
        v[i] = (SourceVertex){.position = {x, y, 0}, .normal = {0, 0, 1}, .color = ~0u};
        v[i].uv = (Vec2){mirror ? 1 - x : x, 1 - y};
        v[i].tangent = (Vec4){0, 1, 0, -1};
    }
    u32 indices[6] = {0, 1, 3, 0, 3, 2};
    MeshSource source = {v, indices, 4, 6, true, tangents, true};
    return mesh_process(store, &source, why);
}

TEST(asset_mesh, tangents_follow_u_and_bitangents_point_up) {
    AssetFixture *f = fixture_open();
    char why[ASSET_MESSAGE_CAP] = "";
    for (u32 mirror = 0; mirror < 2; mirror++) {
        const Mesh *mesh = &f->store.meshes[make_square(&f->store, mirror, false, why)];
        assert_int_equal(mesh->vertex_count, 4);
        for (u32 i = 0; i < 4; i++) {
            f32 sign;
            Vec3 t = decode_tangent(mesh->vertices[i].tangent, &sign);
            Vec3 n = asset_unpack_normal(mesh->vertices[i].normal);
            Vec3 b = vec3_scale(vec3_cross(n, t), sign);
            ASSERT_NEAR(t.x, mirror ? -1 : 1, 1e-3);
            ASSERT_NEAR(b.y, 1, 1e-3); // v runs down, the picture's up is +y
        }
    }
    const Mesh *given = &f->store.meshes[make_square(&f->store, false, true, why)];
    f32 sign;
    ASSERT_NEAR(decode_tangent(given->vertices[0].tangent, &sign).y, 1, 1e-3);
    assert_true(sign == -1);
    fixture_close(f);
}

// Two triangles side by side whose pictures mirror each other in the shared edge.
TEST(asset_mesh, mirrored_halves_are_split) {
    AssetFixture *f = fixture_open();
    char why[ASSET_MESSAGE_CAP] = "";
    SourceVertex v[4] = {{.position = {0, 0, 0}, .normal = {0, 0, 1}, .uv = {0, 1}, .color = ~0u},
                         {.position = {0, 1, 0}, .normal = {0, 0, 1}, .uv = {0, 0}, .color = ~0u},
                         {.position = {1, 0, 0}, .normal = {0, 0, 1}, .uv = {1, 1}, .color = ~0u},
                         {.position = {-1, 0, 0}, .normal = {0, 0, 1}, .uv = {1, 1}, .color = ~0u}};
    u32 indices[6] = {0, 2, 1, 0, 1, 3};
    MeshSource source = {v, indices, 4, 6, true, false, true};
    const Mesh *mesh = &f->store.meshes[mesh_process(&f->store, &source, why)];
    assert_int_equal(mesh->index_count, 6);
    assert_int_equal(mesh->vertex_count, 6);
    for (u32 t = 0; t < 2; t++) {
        f32 sign, side = 0;
        for (u32 k = 0; k < 3; k++) side += mesh_position(mesh, t, k).x;
        for (u32 k = 0; k < 3; k++) {
            Vec3 tangent = decode_tangent(mesh_corner(mesh, t, k)->tangent, &sign);
            ASSERT_NEAR(tangent.x, side > 0 ? 1 : -1, 1e-3);
            assert_true(sign == (side > 0 ? 1.0f : -1.0f));
        }
    }
    fixture_close(f);
}

TEST(asset_mesh, missing_normals_are_flat) {
    AssetFixture *f = fixture_open();
    char why[ASSET_MESSAGE_CAP] = "";
    SourceVertex v[4] = {{.position = {0, 0, 0}},
                         {.position = {1, 0, 0}},
                         {.position = {0, 1, 0}},
                         {.position = {0, 0, 1}}};
    u32 indices[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}; // a corner of a cube, outwards
    MeshSource source = {v, indices, 4, 12, false, false, false};
    const Mesh *mesh = &f->store.meshes[mesh_process(&f->store, &source, why)];
    assert_int_equal(mesh->vertex_count, 12);
    for (u32 t = 0; t < 4; t++) {
        Vec3 face = vec3_normalize(
            vec3_cross(vec3_sub(mesh_position(mesh, t, 1), mesh_position(mesh, t, 0)),
                       vec3_sub(mesh_position(mesh, t, 2), mesh_position(mesh, t, 0))));
        for (u32 k = 0; k < 3; k++) {
            f32 sign;
            const MeshVertex *corner = mesh_corner(mesh, t, k);
            Vec3 n = asset_unpack_normal(corner->normal);
            ASSERT_NEAR(vec3_dot(n, face), 1, 1e-5);
            ASSERT_NEAR(vec3_dot(n, decode_tangent(corner->tangent, &sign)), 0, 1e-3);
        }
    }
    fixture_close(f);
}

TEST(asset_mesh, loose_triangles_are_welded_and_empty_ones_dropped) {
    AssetFixture *f = fixture_open();
    char why[ASSET_MESSAGE_CAP] = "";
    SourceVertex v[9];
    memset(v, 0, sizeof v);
    static const f32 xy[9][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}, // a square
                                 {2, 2}, {2, 2}, {3, 3}};                        // nothing
    for (u32 i = 0; i < 9; i++)
        v[i] = (SourceVertex){.position = {xy[i][0], xy[i][1], 0}, .normal = {0, 0, 2}};
    MeshSource source = {v, NULL, 9, 0, true, false, false};
    const Mesh *mesh = &f->store.meshes[mesh_process(&f->store, &source, why)];
    assert_int_equal(mesh->vertex_count, 4);
    assert_int_equal(mesh->index_count, 6);
    MeshSource nothing = {v + 6, NULL, 3, 0, true, false, false};
    assert_int_equal(mesh_process(&f->store, &nothing, why), 0);
    assert_string_equal(why, "");
    fixture_close(f);
}

TEST(asset_mesh, a_mirrored_copy_behind_a_mirror_is_the_same_surface) {
    AssetFixture *f = fixture_open();
    char why[ASSET_MESSAGE_CAP] = "";
    u32 id = make_square(&f->store, false, false, why);
    u32 mirrored_id = mesh_add_mirrored(&f->store, id);
    const Mesh *mesh = &f->store.meshes[id], *copy = &f->store.meshes[mirrored_id];
    assert_int_equal(copy->index_count, mesh->index_count);
    ASSERT_NEAR(copy->min.x, -1, 0);
    for (u32 t = 0; t < 2; t++) {
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) p[k] = mesh_position(copy, t, k);
        // Seen directly it faces +z as before: mirrored places, reversed winding.
        assert_true(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])).z > 0);
    }
    f32 sign;
    Vec3 tangent = decode_tangent(copy->vertices[0].tangent, &sign);
    Vec3 bitangent = vec3_scale(vec3_cross(vec3(0, 0, 1), tangent), sign);
    ASSERT_NEAR(tangent.x, -1, 1e-3);
    ASSERT_NEAR(bitangent.y, 1, 1e-3);
    fixture_close(f);
}

TEST(asset_mesh, colours_are_noticed) {
    AssetFixture *f = fixture_open();
    MeshVertex v[3] = {{.position = {0, 0, 0}, .color = ~0u},
                       {.position = {3, 0, 0}, .color = ~0u},
                       {.position = {0, 4, 0}, .color = 0xFF0000FF}};
    u32 indices[3] = {0, 1, 2};
    u32 id = asset_add_mesh(&f->store, v, 3, indices, 3);
    assert_true(f->store.meshes[id].has_color);
    ASSERT_NEAR(f->store.meshes[id].radius, 2.5, 1e-6);
    assert_memory_equal(f->store.meshes[id].vertices, v, sizeof v);
    fixture_close(f);
}
