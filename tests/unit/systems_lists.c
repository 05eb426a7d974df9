// systems_lists.c: a packet's lists by its settings, and made anew for others: the same bytes as if
// it had been built for them.
#include "systems_fixture.h"
#include "../test.h"
#include "../../engine/base/random.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *problem_of(const Packet *p) {
    return packet_validate(p, p->size, FIXTURE_MESH_COUNT, FIXTURE_TEXTURE_COUNT);
}

// Things and lights; with blended materials or without.
static SystemsFixture *make_world(u64 seed, u32 count, u32 more_lights, bool blended) {
    SystemsFixture *f = systems_fixture_create(1);
    fixture_fill(f, seed, count);
    if (!blended) {
        MaterialTable *materials = FIXTURE_TABLE(f, Material, material);
        for (u32 row = 0; row < materials->table.count; row++)
            materials->alpha_mode[row] = ALPHA_OPAQUE;
    }
    for (u32 i = 0; i < more_lights; i++)
        fixture_spawn_light(f, i % 3 ? LIGHT_POINT : LIGHT_SPOT,
                            vec3(random_range(seed, 50, i, -15, 15),
                                 random_range(seed, 51, i, -6, 6),
                                 random_range(seed, 52, i, -45, -1)),
                            random_range(seed, 53, i, 0.5f, 2));
    systems_settle(&f->systems, &f->context);
    return f;
}

// Every way to make lists.
static RenderSettings list_settings(u32 i) {
    RenderSettings s = settings_default();
    s.manager = 0; // all lights, so that there are many
    s.path = i % PATH_COUNT;
    s.grid = i / PATH_COUNT % GRID_METHOD_COUNT;
    s.tile_px = (i / 5) % TILE_SIZE_COUNT;
    s.clusters = i / 3 % 2;
    return s;
}
enum { LIST_SETTINGS = PATH_COUNT * GRID_METHOD_COUNT * 2 };

TEST(systems_lists, packets_have_the_lists_their_path_reads) {
    u32 without_cells = 0, clustered = 0, trees = 0;
    for (u32 kind = 0; kind < 4; kind++) {
        SystemsFixture *f = make_world(0x115 + kind, 40, kind & 2 ? 1100 : 0, kind & 1);
        for (u32 i = 0; i < LIST_SETTINGS; i++) {
            RenderSettings settings = list_settings(i);
            const Packet *p = fixture_packet(f, ENTITY_NONE, settings, 333, 217, 0);
            const char *problem = problem_of(p);
            if (problem) fail_msg("%u %u: %s", kind, i, problem);
            assert_int_equal(p->blend_draws.count > 0, kind & 1);
            bool empty = settings_lists_on_device(&settings) && !(kind & 1);
            const u32 *grid = p->frame.grid;
            assert_int_equal(p->cells.count, empty ? 0 : grid[0] * grid[1] * grid[2]);
            assert_int_equal(p->counts.cell_count, p->cells.count);
            assert_int_equal(grid[3], settings_tile_px(&settings));
            assert_true(settings_clustered(&settings) ? grid[2] > 1 : grid[2] == 1);
            bool tree =
                (kind & 2) && settings_clustered(&settings) && settings.clusters == CLUSTERS_GPU;
            assert_int_equal(p->grid_nodes.count > 0, tree);
            u32 lights = p->lights.count - 1;
            assert_int_equal(p->light_indices.count,
                             p->counts.light_index_count + (tree ? lights : 0));
            if (tree) assert_int_equal(p->frame.counts3[3], p->counts.light_index_count);
            without_cells += empty;
            clustered += grid[2] > 1;
            trees += tree;
            arena_reset(&f->arenas.frame);
        }
        systems_fixture_destroy(f);
    }
    printf("%u without cells, %u clustered, %u with a hierarchy\n", without_cells, clustered,
           trees);
    assert_true(without_cells > 10 && clustered > 20 && trees > 5);
}

TEST(systems_lists, lists_made_anew_equal_built_ones) {
    for (u32 kind = 0; kind < 2; kind++) {
        SystemsFixture *f = make_world(0x2E1 + kind, 40, 1100, kind);
        for (u32 i = 0; i < LIST_SETTINGS; i++) {
            RenderSettings from = list_settings(i * 7 + 3), to = list_settings(i);
            const Packet *built = fixture_packet(f, ENTITY_NONE, to, 320, 200, 0);
            const Packet *other = fixture_packet(f, ENTITY_NONE, from, 320, 200, 0);
            const Packet *anew = packet_relist(other, &to, &f->arenas.frame, &f->arenas.scratch);
            assert_null(problem_of(anew));
            assert_int_equal(anew->size, built->size);
            if (memcmp(anew, built, built->size) != 0) fail_msg("settings %u differ", i);
            arena_reset(&f->arenas.frame);
        }
        systems_fixture_destroy(f);
    }
}

TEST(systems_lists, what_shaped_the_packet_stays) {
    SystemsFixture *f = make_world(0x57A, 40, 0, true);
    RenderSettings from = settings_default(), to = from;
    from.light_limit = 10, from.exposure = 2, from.scale = 0.5f, from.merge = 0, from.shadows = 0;
    to.path = PATH_FORWARD, to.view = VIEW_NORMAL, to.tonemap = 0;
    const Packet *built = fixture_packet(f, ENTITY_NONE, from, 320, 200, 0);
    const Packet *anew = packet_relist(built, &to, &f->arenas.frame, &f->arenas.scratch);
    assert_int_equal(anew->settings.light_limit, 10);
    assert_true(anew->settings.exposure == 2 && anew->settings.scale == 0.5f);
    assert_true(!anew->settings.merge && !anew->settings.shadows && !anew->settings.tonemap);
    assert_int_equal(anew->settings.path, PATH_FORWARD);
    assert_int_equal(anew->settings.view, VIEW_NORMAL);
    assert_int_equal(anew->lights.count, built->lights.count);
    // The original is as it was, and lists made twice are the same.
    const Packet *back =
        packet_relist(anew, &built->settings, &f->arenas.frame, &f->arenas.scratch);
    assert_int_equal(back->size, built->size);
    assert_memory_equal(back, built, built->size);
    systems_fixture_destroy(f);
}

// Packets from strangers that pass the check can be listed anew without harm.
TEST(systems_lists, valid_damaged_packets_can_be_listed_anew) {
    const u64 seed = 0xDA3A6E;
    printf("seed %llx\n", (unsigned long long)seed);
    SystemsFixture *f = make_world(0xDA3, 24, 0, true);
    const Packet *good = fixture_packet(f, ENTITY_NONE, settings_default(), 320, 200, 0);
    Packet *copy = malloc(good->size);
    u32 taken = 0;
    for (u32 round = 0; round < 4000; round++) {
        memcpy(copy, good, good->size);
        // Camera, lens and lights: numbers of any size, but finite.
        f32 *lights = (f32 *)PACKET_WRITE(copy, lights, LightRecord);
        f32 *spots = (f32 *)PACKET_WRITE(copy, spots, SpotRecord);
        f32 *frame = (f32 *)&copy->frame;
        for (u32 hit = 0; hit < 4; hit++) {
            u64 draw = (u64)round * 4 + hit;
            static const f32 evil[] = {0, -1, 1e30f, -1e30f, 1e-30f, 3e38f, -3e38f, 1e-40f};
            f32 value = evil[random_u32(seed, 1, draw) % COUNT_OF(evil)];
            u32 at = random_u32(seed, 2, draw);
            switch (random_u32(seed, 3, draw) % 3) {
            case 0:
                lights[at % (copy->lights.count * 8)] = value;
                break;
            case 1:
                spots[at % (copy->spots.count * 8)] = value;
                break;
            case 2:
                frame[at % (offsetof(FrameRecord, counts) / 4)] = value;
                break;
            }
        }
        if (problem_of(copy)) continue;
        taken++;
        RenderSettings to = list_settings(round);
        const Packet *anew = packet_relist(copy, &to, &f->arenas.frame, &f->arenas.scratch);
        const char *problem = problem_of(anew);
        if (problem) fail_msg("round %u: %s", round, problem);
        arena_rewind(&f->arenas.frame, (u64)((const u8 *)anew - f->arenas.frame.memory));
    }
    printf("%u listed anew\n", taken);
    assert_true(taken > 1000);
    free(copy);
    systems_fixture_destroy(f);
}
