// capture_frame.c: a frame file holds what its packet draws, and nothing else.
#include "capture_fixture.h"
#include "../../engine/app/session.h"
#include <string.h>

static const Packet *packet_of(Session *session) {
    session_frame_begin(session);
    SessionView view = {.settings = settings_default(), .width_px = 80, .height_px = 45};
    assert_true(settings_set(&view.settings, "gi.enabled=on")); // draws more than is seen
    const Packet *packet = session_packet(session, &view);
    assert_non_null(packet);
    return packet;
}

static void assert_draws_equal(const Packet *a, const AssetStore *a_store, const Packet *b,
                               const AssetStore *b_store, PacketSection section) {
    const PacketDraw *draws_a = (const PacketDraw *)((const u8 *)a + section.offset);
    const PacketDraw *draws_b = (const PacketDraw *)((const u8 *)b + section.offset);
    for (u32 i = 0; i < section.count; i++) {
        const Mesh *mesh_a = &a_store->meshes[draws_a[i].mesh];
        const Mesh *mesh_b = &b_store->meshes[draws_b[i].mesh];
        assert_int_equal(draws_a[i].material, draws_b[i].material);
        assert_int_equal(draws_a[i].lod, draws_b[i].lod);
        assert_int_equal(mesh_a->lod_count, mesh_b->lod_count);
        assert_memory_equal(mesh_a->lods, mesh_b->lods, sizeof mesh_a->lods);
        assert_int_equal(draws_a[i].first_instance, draws_b[i].first_instance);
        assert_int_equal(mesh_a->vertex_count, mesh_b->vertex_count);
        assert_int_equal(mesh_a->index_count, mesh_b->index_count);
        assert_memory_equal(mesh_a->vertices, mesh_b->vertices,
                            mesh_a->vertex_count * sizeof(MeshVertex));
        assert_memory_equal(mesh_a->indices, mesh_b->indices,
                            mesh_a->total_index_count * sizeof(u32));
        assert_true(mesh_a->radius == mesh_b->radius);
        assert_int_equal(mesh_a->has_color, mesh_b->has_color);
    }
}

static void assert_textures_equal(const Texture *a, const Texture *b) {
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->mip_count, b->mip_count);
    assert_int_equal(a->kind, b->kind);
    assert_int_equal(a->has_alpha, b->has_alpha);
    u64 size = 0, width = a->width, height = a->height;
    for (u32 mip = 0; mip < a->mip_count; mip++) {
        size += width * height * 4;
        width = MAX(width / 2, 1), height = MAX(height / 2, 1);
    }
    assert_memory_equal(a->pixels, b->pixels, size); // the mips are made again, to the same bits
}

static void check_level(const char *level, u32 least_textures) {
    Session session;
    assert_true(session_create(&session, &luz_project));
    assert_true(session_load(&session, level));
    const Packet *packet = packet_of(&session);
    const char *path = test_temp_path("a.luzf");
    assert_true(frame_file_write(path, packet, &session.assets));
    Arena arena;
    assert_true(arena_create(&arena, "test", GIB(4)));
    AssetStore store;
    const Packet *again;
    assert_true(frame_file_read(path, &arena, &store, &again));
    assert_true(again->size == packet->size);
    assert_memory_equal(&again->frame, &packet->frame, sizeof packet->frame);
    assert_memory_equal(&again->settings, &packet->settings, sizeof packet->settings);
    assert_memory_equal(PACKET_DATA(again, lights, u8), PACKET_DATA(packet, lights, u8),
                        packet->lights.count * sizeof(LightRecord));
    assert_draws_equal(packet, &session.assets, again, &store, packet->opaque_draws);
    assert_draws_equal(packet, &session.assets, again, &store, packet->mask_draws);
    assert_draws_equal(packet, &session.assets, again, &store, packet->shadow_draws);
    assert_true(packet->gi_static_draws.count > 0);
    assert_draws_equal(packet, &session.assets, again, &store, packet->gi_static_draws);
    assert_draws_equal(packet, &session.assets, again, &store, packet->gi_dynamic_draws);
    const PacketMaterial *a = PACKET_DATA(packet, material_bindings, PacketMaterial);
    const PacketMaterial *b = PACKET_DATA(again, material_bindings, PacketMaterial);
    u32 textures = 0;
    for (u32 i = 0; i < packet->material_bindings.count; i++) {
        const u32 ids[3][2] = {{a[i].albedo_texture, b[i].albedo_texture},
                               {a[i].normal_texture, b[i].normal_texture},
                               {a[i].emissive_texture, b[i].emissive_texture}};
        for (u32 k = 0; k < 3; k++) {
            assert_int_equal(ids[k][0] == 0, ids[k][1] == 0);
            if (ids[k][0] == 0) continue;
            textures++;
            assert_textures_equal(&session.assets.textures[ids[k][0]], &store.textures[ids[k][1]]);
        }
    }
    assert_true(textures >= least_textures);
    asset_store_destroy(&store);
    arena_destroy(&arena);
    session_destroy(&session);
}

TEST(capture_frame, comes_back_as_written) { check_level("data/levels/cornell.toml", 0); }
TEST_SLOW(capture_frame, with_textures) { check_level("data/levels/cloister.toml", 3); }

TEST(capture_frame, cannot_be_written) {
    Session session;
    assert_true(session_create(&session, &luz_project));
    assert_true(session_load(&session, "data/levels/cornell.toml"));
    assert_false(
        frame_file_write("build/no/such/directory/a.luzf", packet_of(&session), &session.assets));
    session_destroy(&session);
}
