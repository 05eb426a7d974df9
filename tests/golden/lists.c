// lists.c: light lists made on the device: every way of making them gives the picture of brute
// force, and the same bits as the packet's own lists; no light is missing from a list.
//
// All draws of a level are of one packet, listed anew for each way (packet_relist): what differs
// are the lists alone.
#include "studio.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/image_compare.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A stream of random numbers.
typedef struct Random {
    u64 seed, stream, counter;
} Random;
static u32 draw_below(Random *random, u32 end) {
    return random_u32(random->seed, random->stream, random->counter++) % end;
}
static f32 draw_sign(Random *random) { // -1..1
    return random_range(random->seed, random->stream, random->counter++, -1.0f, 1.0f);
}

typedef struct Bench {
    Studio studio;
    const Packet *packet; // forward, all lights
    Arena packets, scratch;
} Bench;

static void bench_open(Bench *bench, const char *level, u32 width, u32 height,
                       RenderSettings settings) {
    memset(bench, 0, sizeof *bench);
    studio_open(&bench->studio, level);
    session_advance(&bench->studio.session, 90);
    assert_true(arena_create(&bench->packets, "packets", GIB(1)));
    assert_true(arena_create(&bench->scratch, "scratch", GIB(1)));
    settings.path = PATH_FORWARD;
    settings.vertex_lighting = 0;
    session_frame_begin(&bench->studio.session);
    bench->packet = session_packet(&bench->studio.session, &(SessionView){.camera = "main",
                                                                          .settings = settings,
                                                                          .width_px = width,
                                                                          .height_px = height});
    assert_non_null(bench->packet);
}
static void bench_close(Bench *bench) {
    arena_destroy(&bench->packets);
    arena_destroy(&bench->scratch);
    studio_close(&bench->studio);
}

// The packet's own settings with those named: "path=tiled_deferred,grid=gpu".
static RenderSettings settings_with(const Bench *bench, const char *list) {
    RenderSettings settings = bench->packet->settings;
    assert_true(settings_set_list(&settings, list));
    return settings;
}

static RenderImage bench_draw(Bench *bench, const RenderSettings *settings) {
    arena_reset(&bench->packets);
    const Packet *packet = packet_relist(bench->packet, settings, &bench->packets, &bench->scratch);
    assert_null(packet_validate(packet, packet->size, bench->studio.session.assets.mesh_count,
                                bench->studio.session.assets.texture_count));
    RenderImage image = {0};
    assert_true(
        renderer_render_image(bench->studio.renderer, packet, &bench->studio.images, &image));
    return image;
}

static u32 difference(Bench *bench, const RenderImage *a, const RenderImage *b) {
    return image_compare(a->rgba, b->rgba, a->width_px, a->height_px, &bench->studio.images).max;
}

// --- Every way, every level ---

// thorough: all sizes of tiles, and without the shader's own culling; else the usual and the
// largest.
static void compare_tiles(Bench *bench, const RenderImage *brute, u64 *hash, bool thorough) {
    RenderSettings settings = settings_with(bench, "path=tiled_deferred");
    u32 draws = 0;
    for (u32 tile = 0; tile < TILE_SIZE_COUNT; tile++)
        for (u32 grid = 0; grid < GRID_METHOD_COUNT; grid++)
            for (u32 depth = 0; depth < TILE_DEPTH_COUNT; depth++)
                for (u32 cull = 0; cull < 2; cull++) {
                    bool usual = tile == TILE_16 || tile == TILE_64;
                    if (thorough ? !cull && !usual : !cull || !usual) continue;
                    settings.tile_px = tile, settings.grid = grid;
                    settings.tile_depth = depth, settings.subgroup_cull = cull;
                    RenderImage image = bench_draw(bench, &settings);
                    if (!*hash) *hash = image.hash;
                    if (image.hash != *hash || difference(bench, &image, brute) > 2)
                        fail_msg("tile %u px, grid %u, depth %u, cull %u: %u / 255 from brute "
                                 "force, hash %016llx, not %016llx",
                                 8u << tile, grid, depth, cull, difference(bench, &image, brute),
                                 (unsigned long long)image.hash, (unsigned long long)*hash);
                    draws++;
                }
    assert_int_equal(draws, thorough ? 4 * 9 + 2 * 9 : 2 * 9);
}

static void compare_clusters(Bench *bench, const RenderImage *brute, u64 hash, bool thorough) {
    RenderSettings settings = settings_with(bench, "path=clustered_deferred");
    for (u32 tile = 0; tile < TILE_SIZE_COUNT; tile++)
        for (u32 way = 0; way < 3; way++) {
            if (!thorough && tile != TILE_16 && tile != TILE_64) continue;
            settings.tile_px = tile;
            settings.clusters = way > 0, settings.cluster_normals = way > 1;
            RenderImage image = bench_draw(bench, &settings);
            // The hierarchy's order is another one: sums may differ in their last bit.
            bool same_order = bench->packet->lights.count <= 1001 || way == 0;
            if ((same_order && image.hash != hash) || difference(bench, &image, brute) > 2)
                fail_msg("cluster %u px, way %u: %u / 255 from brute force, hash %016llx, not "
                         "%016llx",
                         8u << tile, way, difference(bench, &image, brute),
                         (unsigned long long)image.hash, (unsigned long long)hash);
            // Again, after others: the same bits.
            if (way > 0) assert_true(bench_draw(bench, &settings).hash == image.hash);
        }
}

// Forward paths share every expression with brute force: the same bits, with samples as well.
static void compare_forward(Bench *bench) {
    static const char *const ways[] = {
        "tiled_forward",
        "tiled_forward,tile_depth=minmax",
        "tiled_forward,tile_depth=mask,tile_px=32",
        "tiled_forward,grid=gpu",
        "tiled_forward,grid=gpu,tile_depth=mask,tile_px=64",
        "clustered_forward",
        "clustered_forward,clusters=gpu",
        "clustered_forward,clusters=gpu,tile_px=64,cluster_normals=on",
        "clustered_forward,clusters=gpu,tile_px=8",
    };
    for (u32 msaa = 0; msaa < MSAA_COUNT; msaa++) {
        RenderSettings settings = settings_with(bench, "forward");
        settings.msaa = msaa;
        RenderImage brute = bench_draw(bench, &settings);
        for (u32 i = 0; i < COUNT_OF(ways); i++) {
            settings = settings_with(bench, ways[i]);
            settings.msaa = msaa;
            RenderImage image = bench_draw(bench, &settings);
            bool same_order = bench->packet->lights.count <= 1001 || !settings.clusters;
            u32 most = same_order ? 0 : 1;
            if (difference(bench, &image, &brute) > most)
                fail_msg("%s, %u samples: %u / 255 from brute force", ways[i], msaa ? 4 : 1,
                         difference(bench, &image, &brute));
        }
    }
}

static void compare_ways(const char *level, bool thorough) {
    Bench bench;
    bench_open(&bench, level, 128, 72, studio_direct_light());
    RenderSettings settings = settings_with(&bench, "forward");
    RenderImage brute = bench_draw(&bench, &settings);
    u64 hash = 0;
    compare_tiles(&bench, &brute, &hash, thorough);
    compare_clusters(&bench, &brute, hash, thorough);
    if (thorough) compare_forward(&bench);
    bench_close(&bench);
}
TEST_GPU(golden_lists, every_way_cloister) { compare_ways("data/levels/cloister.toml", true); }
TEST_GPU(golden_lists, every_way_cornell) { compare_ways("data/levels/cornell.toml", false); }
TEST_GPU(golden_lists, every_way_cornell_empty) {
    compare_ways("data/levels/cornell_empty.toml", false);
}
TEST_GPU(golden_lists, every_way_light_box) { compare_ways("data/levels/light_box.toml", false); }
TEST_GPU(golden_lists, every_way_lights_4096) {
    compare_ways("data/levels/lights_4096.toml", true);
}
TEST_GPU(golden_lists, every_way_plane_test) { compare_ways("data/levels/plane_test.toml", false); }
TEST_GPU(golden_lists, every_way_hall) { compare_ways("data/levels/hall.toml", false); }

// --- Memory that is short ---

TEST_GPU(golden_lists, without_room_all_lights_and_the_same_bits) {
    static const char *const ways[] = {"tiled_deferred,grid=gpu,tile_px=8",
                                       "tiled_deferred,grid=gpu,tile_px=16,tile_depth=mask",
                                       "clustered_deferred,clusters=gpu,tile_px=8",
                                       "clustered_deferred,clusters=gpu,cluster_normals=on",
                                       "clustered_forward,clusters=gpu,msaa=4"};
    static const char *const levels[] = {"data/levels/cloister.toml",
                                         "data/levels/lights_4096.toml"};
    for (u32 level = 0; level < COUNT_OF(levels); level++) {
        Bench bench;
        // All lights for all pixels are slow: a small picture.
        bench_open(&bench, levels[level], level ? 32 : 96, level ? 18 : 54, studio_direct_light());
        Renderer *renderer = bench.studio.renderer;
        u32 light_count = bench.packet->lights.count - 1;
        for (u32 i = 0; i < COUNT_OF(ways); i++) {
            RenderSettings settings = settings_with(&bench, ways[i]);
            bench_draw(&bench, &settings);
            RenderImage whole = bench_draw(&bench, &settings);
            RendererStats full = renderer_stats(renderer);
            assert_int_equal(full.list_fallbacks, 0);
            assert_in_range(full.list_longest, 1, light_count);
            bool clusters = settings.path != PATH_TILED_DEFERRED;
            assert_true((full.clusters > 0) == clusters);
            for (u32 part = 0; part < 4; part += part ? 2 : 1) {
                // None of the lists, few of them, most of them and places for half the clusters.
                u32 own = full.list_indices - light_count;
                renderer_limit_lists(renderer, light_count + own * part / 4,
                                     part == 3 ? 2 + full.clusters / 2 : 0);
                RenderImage image = bench_draw(&bench, &settings);
                RendererStats stats = renderer_stats(renderer);
                if (image.hash != whole.hash)
                    fail_msg("%s with %u/4 of its memory: other bits", ways[i], part);
                assert_true(stats.list_fallbacks > 0);
                assert_int_equal(stats.list_longest, light_count);
                // It stays so: the limit is a limit.
                assert_true(bench_draw(&bench, &settings).hash == whole.hash);
                assert_true(renderer_stats(renderer).list_fallbacks > 0);
            }
            renderer_limit_lists(renderer, 0, 0);
        }
        bench_close(&bench);
    }
}

// The first frame's lists do not fit into the first buffer; the second one's do.
TEST_GPU(golden_lists, buffers_grow_by_what_was_wanted) {
    Bench bench;
    bench_open(&bench, "data/levels/lights_4096.toml", 400, 225, studio_direct_light());
    RenderSettings settings = settings_with(&bench, "tiled_deferred,grid=gpu,tile_px=8");
    RenderImage first = bench_draw(&bench, &settings);
    RendererStats stats = renderer_stats(bench.studio.renderer);
    printf("    %u list entries, %u of %u tiles without room at first\n", stats.list_indices,
           stats.list_fallbacks, 50 * 29);
    assert_in_range(stats.list_fallbacks, 1, 50 * 29 - 1);
    RenderImage second = bench_draw(&bench, &settings);
    assert_int_equal(renderer_stats(bench.studio.renderer).list_fallbacks, 0);
    assert_true(first.hash == second.hash);
    bench_close(&bench);
}

// --- What the lists hold ---

typedef struct DeviceListsRead {
    CellRecord *cells;
    u32 *indices, *clusters, *pixels;
    TileDepthRecord *depths;
    u64 cell_count, index_count;
} DeviceListsRead;

static DeviceListsRead read_lists(Bench *bench, bool clusters) {
    Arena *arena = &bench->studio.images;
    Renderer *renderer = bench->studio.renderer;
    DeviceListsRead r = {0};
    u64 cap = MIB(4);
    r.cells = arena_push(arena, cap, CACHE_LINE);
    r.indices = arena_push(arena, cap, CACHE_LINE);
    r.depths = arena_push(arena, cap, CACHE_LINE);
    r.clusters = arena_push(arena, cap, CACHE_LINE);
    r.pixels = arena_push(arena, cap, CACHE_LINE);
    r.cell_count =
        renderer_read_lists(renderer, LIST_BUFFER_CELLS, r.cells, cap) / sizeof(CellRecord);
    r.index_count =
        renderer_read_lists(renderer, LIST_BUFFER_INDICES, r.indices, cap) / sizeof(u32);
    assert_true(r.cell_count && r.index_count);
    assert_true(renderer_read_lists(renderer, LIST_BUFFER_TILE_DEPTHS, r.depths, cap) > 0);
    if (!clusters) return r;
    assert_true(renderer_read_lists(renderer, LIST_BUFFER_CLUSTERS, r.clusters, cap) > 0);
    assert_true(renderer_read_lists(renderer, LIST_BUFFER_PIXEL_CLUSTERS, r.pixels, cap) > 0);
    return r;
}

static bool list_has(const DeviceListsRead *r, u32 cell, u32 light) {
    assert_true(cell < r->cell_count);
    const u32 *list = r->cells[cell].list;
    assert_true((u64)list[0] + list[1] + list[2] <= r->index_count);
    for (u32 i = 0; i < list[1] + list[2]; i++)
        if (r->indices[list[0] + i] == light) return true;
    return false;
}

// A list is ascending, each light in its class.
static void check_list(const DeviceListsRead *r, u32 cell, const FrameRecord *frame) {
    const u32 *list = r->cells[cell].list, *indices = r->indices + list[0];
    u32 points = list[1], spots = list[2];
    u32 bright_points = points - (list[3] & 0xFFFF), bright_spots = spots - (list[3] >> 16);
    for (u32 i = 0; i < points + spots; i++) {
        assert_true(i == 0 || indices[i] > indices[i - 1]);
        u32 first = i < bright_points           ? 0
                    : i < points                ? frame->counts3[0]
                    : i < points + bright_spots ? frame->counts[0]
                                                : frame->counts[0] + frame->counts3[1];
        u32 end = i < bright_points           ? frame->counts3[0]
                  : i < points                ? frame->counts[0]
                  : i < points + bright_spots ? frame->counts[0] + frame->counts3[1]
                                              : frame->counts[0] + frame->counts[1];
        assert_in_range(indices[i], first, end - 1);
    }
}

// A point of the light's ball, and of its cone if it is a spot. World.
static bool random_point(Random *random, const Packet *packet, u32 light, Vec3 *point) {
    const LightRecord *record = &PACKET_DATA(packet, lights, LightRecord)[light];
    f32 reach = 1.0f / sqrtf(record->position[3]);
    Vec3 d = vec3(draw_sign(random), draw_sign(random), draw_sign(random));
    f32 length = sqrtf(vec3_dot(d, d));
    if (length > 1.0f || length < 1e-3f) return false;
    *point = vec3_add(vec3(record->position[0], record->position[1], record->position[2]),
                      vec3_scale(d, reach));
    u32 point_count = packet->frame.counts[0];
    if (light < point_count) return true;
    const f32 *axis = PACKET_DATA(packet, spots, SpotRecord)[light - point_count].direction;
    return vec3_dot(d, vec3(axis[0], axis[1], axis[2])) > axis[3] * length;
}

// Tile and view depth of a point; false if it is not in the picture.
static bool project(const FrameRecord *frame, Vec3 p, u32 *tile, f32 *depth) {
    Vec3 q = vec3_sub(p, vec3(frame->camera[0], frame->camera[1], frame->camera[2]));
    Vec3 right = vec3(frame->ray_right[0], frame->ray_right[1], frame->ray_right[2]);
    Vec3 up = vec3(frame->ray_up[0], frame->ray_up[1], frame->ray_up[2]);
    *depth = vec3_dot(q, vec3(frame->ray_forward[0], frame->ray_forward[1], frame->ray_forward[2]));
    if (*depth <= frame->camera[3]) return false;
    f32 x = vec3_dot(q, right) / vec3_dot(right, right) / *depth;
    f32 y = vec3_dot(q, up) / vec3_dot(up, up) / *depth;
    f32 px = (x * 0.5f + 0.5f) * frame->viewport[0], py = (0.5f - y * 0.5f) * frame->viewport[1];
    if (px < 0.0f || py < 0.0f || px >= frame->viewport[0] || py >= frame->viewport[1])
        return false;
    *tile = (u32)py / frame->grid[3] * frame->grid[0] + (u32)px / frame->grid[3];
    return true;
}

// Points of lights against the lists: where a point lies in a tile, at a depth that the tile may
// show, its light is in the tile's list.
static void check_tiles(Bench *bench, const char *way, u32 *entries) {
    RenderSettings settings = settings_with(bench, way);
    bench_draw(bench, &settings);
    bench_draw(bench, &settings); // with room
    const Packet *packet =
        packet_relist(bench->packet, &settings, &bench->packets, &bench->scratch);
    const FrameRecord *frame = &packet->frame;
    DeviceListsRead r = read_lists(bench, false);
    u32 tiles = frame->grid[0] * frame->grid[1], light_count = packet->lights.count - 1, tested = 0;
    *entries = 0;
    for (u32 tile = 0; tile < tiles; tile++) {
        check_list(&r, tile, frame);
        *entries += r.cells[tile].list[1] + r.cells[tile].list[2];
    }
    Random random = {20061120, 6, 0};
    for (u32 i = 0; i < 200000; i++) {
        u32 light = draw_below(&random, light_count), tile;
        Vec3 point;
        f32 depth;
        if (!random_point(&random, packet, light, &point) || !project(frame, point, &tile, &depth))
            continue;
        const f32 *range = r.depths[tile].range;
        if (settings.tile_depth != TILE_DEPTH_OFF && !(depth >= range[0] && depth <= range[1]))
            continue;
        if (settings.tile_depth == TILE_DEPTH_MASK) {
            f32 slice = (depth - range[0]) * range[2];
            if (!(r.depths[tile].mask[0] >> (u32)CLAMP(slice, 0.0f, 31.0f) & 1)) continue;
        }
        tested++;
        if (!list_has(&r, tile, light))
            fail_msg("%s: light %u is not in the list of tile %u at depth %f", way, light, tile,
                     depth);
    }
    printf("    %-40s %6u entries, %u points tested\n", way, *entries, tested);
    assert_true(tested > 100);
}

TEST_GPU(golden_lists, no_light_is_missing_from_a_tile) {
    static const char *const levels[] = {"data/levels/cloister.toml", "data/levels/cornell.toml",
                                         "data/levels/lights_4096.toml"};
    for (u32 level = 0; level < COUNT_OF(levels); level++) {
        Bench bench;
        bench_open(&bench, levels[level], 200, 113, studio_direct_light());
        u32 off, gpu_minmax, gpu_mask, rect_minmax, rect_mask, small;
        check_tiles(&bench, "tiled_deferred,grid=gpu", &off);
        check_tiles(&bench, "tiled_deferred,grid=gpu,tile_depth=minmax", &gpu_minmax);
        check_tiles(&bench, "tiled_deferred,grid=gpu,tile_depth=mask", &gpu_mask);
        check_tiles(&bench, "tiled_deferred,tile_depth=minmax", &rect_minmax);
        check_tiles(&bench, "tiled_deferred,tile_depth=mask", &rect_mask);
        check_tiles(&bench, "tiled_forward,grid=gpu,tile_depth=mask,tile_px=8", &small);
        // Depths narrow lists; a list narrowed by the range is no longer than before.
        assert_true(gpu_minmax <= off && gpu_mask <= gpu_minmax && rect_mask <= rect_minmax);
        assert_true(gpu_mask < off);
        bench_close(&bench);
    }
}

TEST_GPU(golden_lists, no_light_is_missing_from_a_cluster) {
    static const char *const levels[] = {"data/levels/cloister.toml",
                                         "data/levels/lights_4096.toml"};
    for (u32 level = 0; level < COUNT_OF(levels); level++) {
        Bench bench;
        bench_open(&bench, levels[level], 200, 113, studio_direct_light());
        RenderSettings settings = settings_with(&bench, "clustered_deferred,clusters=gpu");
        bench_draw(&bench, &settings);
        bench_draw(&bench, &settings);
        RendererStats stats = renderer_stats(bench.studio.renderer);
        const Packet *packet =
            packet_relist(bench.packet, &settings, &bench.packets, &bench.scratch);
        const FrameRecord *frame = &packet->frame;
        DeviceListsRead r = read_lists(&bench, true);
        // Keys rise; every pixel's cluster is of the pixel's tile; each cluster has a pixel.
        u32 last = CLUSTER_FIRST + stats.clusters;
        assert_true(stats.clusters > 0 && last <= r.cell_count);
        u8 *used = ARENA_PUSH(&bench.studio.images, u8, last);
        for (u32 i = CLUSTER_FIRST + 1; i < last; i++)
            assert_true(r.clusters[i] > r.clusters[i - 1]);
        for (u32 i = 0; i < 200 * 113; i++) {
            assert_true(r.pixels[i] < last && r.pixels[i] != CLUSTER_ALL);
            used[r.pixels[i]] = 1;
            if (r.pixels[i] == CLUSTER_EMPTY) continue;
            u32 tile = i / 200 / 16 * frame->grid[0] + i % 200 / 16;
            assert_int_equal(r.clusters[r.pixels[i]] >> CLUSTER_TILE_SHIFT, tile);
        }
        for (u32 i = CLUSTER_FIRST; i < last; i++) assert_true(used[i]);

        Random random = {20061121, 7, 0};
        u32 tested = 0, light_count = packet->lights.count - 1;
        for (u32 i = 0; i < 1000000; i++) {
            u32 light = draw_below(&random, light_count), tile;
            Vec3 point;
            f32 depth;
            if (!random_point(&random, packet, light, &point) ||
                !project(frame, point, &tile, &depth))
                continue;
            const f32 *range = r.depths[tile].range;
            if (!(depth >= range[0] && depth <= range[1])) continue;
            f32 slice = floorf(log2f(depth) * frame->slices[0] + frame->slices[1]);
            u32 key =
                tile << CLUSTER_TILE_SHIFT | (u32)CLAMP(slice, 0.0f, (f32)frame->grid[2] - 1.0f);
            const u32 *depths = r.depths[tile].mask;
            for (u32 k = depths[3]; k < depths[3] + depths[2]; k++) {
                if (r.clusters[k] != key) continue;
                tested++;
                if (!list_has(&r, k, light))
                    fail_msg("light %u is not in cluster %u (tile %u, slice %u), depth %f", light,
                             k, tile, key & 255, depth);
            }
        }
        printf("    %u clusters, %u list entries, longest %u, %u points tested\n", stats.clusters,
               stats.list_indices, stats.list_longest, tested);
        assert_true(tested > 100);
        bench_close(&bench);
    }
}

// Nearest and farthest of each tile, and the occupied slices, against the picture of depths, which
// shows 1 / (1 + 0.15 d) in 255 steps.
TEST_GPU(golden_lists, tile_depths_are_those_of_the_picture) {
    Bench bench;
    bench_open(&bench, "data/levels/cloister.toml", 200, 113, studio_direct_light());
    RenderSettings settings = settings_with(&bench, "view=depth");
    RenderImage picture = bench_draw(&bench, &settings);
    static const char *const ways[] = {"tiled_deferred,tile_depth=mask,tile_px=8",
                                       "tiled_deferred,tile_depth=mask,tile_px=32",
                                       "tiled_forward,tile_depth=mask,tile_px=64"};
    for (u32 way = 0; way < COUNT_OF(ways); way++) {
        settings = settings_with(&bench, ways[way]);
        bench_draw(&bench, &settings);
        DeviceListsRead r = read_lists(&bench, false);
        u32 side = settings_tile_px(&settings), tiles_x = (200 + side - 1) / side;
        // Below the view's legend.
        for (u32 y = side < 32 ? 32 : side; y < 113; y += side)
            for (u32 x = 0; x < 200; x += side) {
                const TileDepthRecord *seen = &r.depths[y / side * tiles_x + x / side];
                u32 brightest = 0, darkest = 255, covered = 0, missing = 0;
                for (u32 v = y; v < MIN(y + side, 113); v++)
                    for (u32 u = x; u < MIN(x + side, 200); u++) {
                        u32 shade = picture.rgba[(v * 200 + u) * 4];
                        if (!shade) continue; // background (or very far)
                        covered++;
                        brightest = MAX(brightest, shade), darkest = MIN(darkest, shade);
                        f32 d = (255.0f / (f32)shade - 1.0f) / 0.15f;
                        f32 error = 255.0f / (f32)(shade * shade) / 0.15f;
                        f32 slice = (d - seen->range[0]) * seen->range[2];
                        f32 reach = error * seen->range[2] + 1.0f;
                        bool found = false;
                        for (u32 bit = 0; bit < 32; bit++)
                            found |= (seen->mask[0] >> bit & 1) &&
                                     fabsf((f32)bit + 0.5f - slice) <= reach + 0.5f;
                        missing += !found;
                    }
                if (seen->mask[1] != covered)
                    fail_msg("tile at %u, %u: %u pixels are covered, in the picture %u", x, y,
                             seen->mask[1], covered);
                if (!covered) {
                    assert_true(seen->range[0] > seen->range[1]);
                    continue;
                }
                if (missing)
                    fail_msg("tile at %u, %u (%f to %f m, mask %08x): %u of %u pixels are in no "
                             "slice",
                             x, y, seen->range[0], seen->range[1], seen->mask[0], missing, covered);
                ASSERT_NEAR(255.0 / (1.0 + 0.15 * seen->range[0]), brightest, 0.75);
                ASSERT_NEAR(255.0 / (1.0 + 0.15 * seen->range[1]), darkest, 0.75);
            }
    }
    bench_close(&bench);
}

// --- Extremes ---

static void draw_ways(Bench *bench) {
    static const char *const ways[] = {
        "tiled_deferred,tile_depth=minmax",
        "tiled_deferred,grid=gpu,tile_depth=mask",
        "tiled_forward,grid=gpu,msaa=4,tile_depth=mask",
        "clustered_deferred,clusters=gpu",
        "clustered_deferred,clusters=gpu,cluster_normals=on,tile_px=64",
        "clustered_forward,clusters=gpu,msaa=4"};
    RenderSettings settings = settings_with(bench, "forward");
    RenderImage brute = bench_draw(bench, &settings);
    settings.msaa = MSAA_4;
    RenderImage brute_samples = bench_draw(bench, &settings);
    for (u32 i = 0; i < COUNT_OF(ways); i++) {
        settings = settings_with(bench, ways[i]);
        RenderImage image = bench_draw(bench, &settings);
        u32 d = difference(bench, &image, settings.msaa ? &brute_samples : &brute);
        if (d > 2) fail_msg("%s: %u / 255 from brute force", ways[i], d);
    }
}

TEST_GPU(golden_lists, odd_sizes) {
    static const u32 sizes[][2] = {{1, 1}, {7, 5}, {65, 64}, {17, 33}, {3, 200}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++) {
        Bench bench;
        bench_open(&bench, "data/levels/cornell.toml", sizes[i][0], sizes[i][1],
                   studio_direct_light());
        draw_ways(&bench);
        bench_close(&bench);
    }
}

TEST_GPU(golden_lists, no_lights) {
    Bench bench;
    RenderSettings settings = studio_direct_light();
    settings.light_gain = 0.0f;
    bench_open(&bench, "data/levels/plane_test.toml", 64, 36, settings);
    assert_int_equal(bench.packet->lights.count, 1);
    draw_ways(&bench);
    bench_close(&bench);
}

// More lights than uniform blocks hold, and than a shader's loop may go over 8 times.
TEST_GPU(golden_lists, nine_thousand_lights) {
    Bench bench;
    RenderSettings settings = studio_direct_light();
    assert_true(settings_set_list(&settings, "manager=off,light_culling=off,light_limit=9000"));
    bench_open(&bench, "data/levels/hall.toml", 48, 27, settings);
    assert_true(bench.packet->lights.count > 9000);
    draw_ways(&bench);
    bench_close(&bench);
}

// Frames in flight, settings and sizes changed with each: buffers are made anew while earlier
// frames still read the old ones.
TEST_GPU(golden_lists, settings_switched_every_frame) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    Random random = {20140601, 8, 0};
    for (u32 i = 0; i < 300; i++) {
        RenderSettings settings = settings_default();
        settings.path = PATH_TILED_DEFERRED + draw_below(&random, 4);
        settings.grid = draw_below(&random, GRID_METHOD_COUNT);
        settings.tile_px = draw_below(&random, 2) ? TILE_16 : TILE_64; // each is compiled anew
        settings.tile_depth = draw_below(&random, TILE_DEPTH_COUNT);
        settings.clusters = draw_below(&random, 2);
        settings.cluster_normals = draw_below(&random, 2);
        settings.msaa = draw_below(&random, 4) == 0;
        if (draw_below(&random, 8) == 0) settings.view = VIEW_CELL_LIGHTS + draw_below(&random, 3);
        if (draw_below(&random, 16) == 0) renderer_limit_lists(studio.renderer, i * 8, i);
        u32 width = draw_below(&random, 4) ? 64 : 1 + draw_below(&random, 96);
        session_frame_begin(&studio.session);
        const Packet *packet = session_packet(&studio.session, &(SessionView){.camera = "main",
                                                                              .settings = settings,
                                                                              .width_px = width,
                                                                              .height_px = 36});
        assert_non_null(packet);
        GpuCommands *cmd = gpu_frame_begin(studio.gpu);
        assert_non_null(cmd);
        assert_true(renderer_draw(studio.renderer, cmd, packet, false, NULL));
        assert_true(gpu_frame_end(studio.gpu, false));
    }
    gpu_wait_idle(studio.gpu);
    studio_close(&studio);
}
