// forward_paths.c: the forward paths and what only they can: samples, blended surfaces by every
// kind of list, lighting at the vertices; and all paths by turns.
// Data in: levels, settings. Data out: pictures compared. Called by: the runner.
#include "studio.h"
#include "../../engine/base/random.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static RenderSettings settings_from(const char *list) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    return settings;
}

static RenderImage draw(Studio *studio, const char *camera, const char *list, u32 width,
                        u32 height) {
    RenderSettings settings = settings_from(list);
    return studio_draw(studio, camera, &settings, width, height);
}

// Every way to shade, each with the kinds of lists it can take.
static const char *const ways[] = {
    "forward",
    "multipass",
    "deferred",
    "deferred_volumes",
    "tiled_deferred",
    "tiled_forward",
    "tiled_forward,grid=frustum,tile_px=32",
    "tiled_forward,grid=gpu",
    "tiled_forward,tile_depth=minmax",
    "tiled_forward,tile_depth=mask,tile_px=64",
    "clustered_deferred",
    "clustered_forward",
    "clustered_forward,clusters=gpu",
    "clustered_forward,clusters=gpu,tile_px=8",
};

static void check_ways(Studio *studio, const char *camera, u32 width, u32 height,
                       const char *more) {
    RenderImage reference = {0};
    for (u32 i = 0; i < COUNT_OF(ways); i++) {
        char list[256];
        snprintf(list, sizeof list, "%s%s", ways[i], more);
        RenderImage image = draw(studio, camera, list, width, height);
        if (i == 0) reference = image;
        ImageDifference d =
            image_compare(reference.rgba, image.rgba, width, height, &studio->images);
        if (d.max > 2)
            fail_msg("%s at %u x %u: max %u at %u,%u", list, width, height, d.max, d.max_x,
                     d.max_y);
    }
}

TEST_GPU(golden, forward_paths_take_every_list) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    session_advance(&studio.session, 90);
    check_ways(&studio, "main", 160, 90, "");
    check_ways(&studio, "garden", 96, 54, "");
    studio_close(&studio);
}

// Leaves and a wall become glass: they are drawn last, far to near, with the packet's lists in all
// paths; also where the device makes its own lists.
TEST_GPU(golden, blended_surfaces_in_all_paths) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    session_advance(&studio.session, 30);
    RenderImage before = draw(&studio, "main", "forward", 160, 90);
    MaterialTable *materials = WORLD_TABLE(studio.session.world, Material, material);
    u32 changed = 0;
    for (u32 row = 0; row < materials->table.count; row++)
        if (materials->alpha_mode[row] == ALPHA_MASK || row % 3 == 0) {
            materials->alpha_mode[row] = ALPHA_BLEND;
            table_touch(&materials->table, row);
            changed++;
        }
    assert_true(changed > 0);
    const Packet *packet = session_packet(
        &studio.session,
        &(SessionView){
            .camera = "main", .settings = settings_default(), .width_px = 160, .height_px = 90});
    assert_true(packet->blend_draws.count > 0);
    RenderImage after = draw(&studio, "main", "forward", 160, 90);
    assert_true(after.hash != before.hash);
    check_ways(&studio, "main", 160, 90, "");
    studio_close(&studio);
}

// No lights at all; only spots; sizes that no tile or group divides.
TEST_GPU(golden, forward_paths_at_the_edges) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_advance(&studio.session, 10);
    static const u32 sizes[][2] = {{1, 1}, {3, 2}, {17, 33}, {65, 9}};
    for (u32 i = 0; i < COUNT_OF(sizes); i++)
        check_ways(&studio, "main", sizes[i][0], sizes[i][1], "");
    check_ways(&studio, "main", 64, 36, ",light_gain=0");
    // Each point light goes out: where there are spots, only they are left.
    LightTable *light = WORLD_TABLE(studio.session.world, Light, light);
    for (u32 row = 0; row < light->table.count; row++)
        if (light->kind[row] == LIGHT_POINT) {
            light->intensity[row] = 0.0f;
            table_touch(&light->table, row);
        }
    session_advance(&studio.session, 1);
    check_ways(&studio, "main", 64, 36, "");
    studio_close(&studio);
}

// --- Samples ---

// Half the size by the mean of 2 x 2.
static u8 *half_size(const u8 *rgba, u32 width, u32 height, Arena *arena) {
    u8 *out = ARENA_PUSH(arena, u8, width / 2 * (height / 2) * 4);
    for (u32 y = 0; y < height / 2; y++)
        for (u32 x = 0; x < width / 2; x++)
            for (u32 c = 0; c < 4; c++) {
                u32 sum = 2;
                for (u32 k = 0; k < 4; k++)
                    sum += rgba[((y * 2 + k / 2) * width + x * 2 + k % 2) * 4 + c];
                out[(y * (width / 2) + x) * 4 + c] = (u8)(sum / 4);
            }
    return out;
}

// Largest step of a channel among a pixel and its neighbours.
static u32 contrast_around(const u8 *rgba, u32 width, u32 height, u32 x, u32 y) {
    u32 low[3] = {255, 255, 255}, high[3] = {0}, most = 0;
    for (u32 v = y ? y - 1 : 0; v <= MIN(y + 1, height - 1); v++)
        for (u32 u = x ? x - 1 : 0; u <= MIN(x + 1, width - 1); u++)
            for (u32 c = 0; c < 3; c++) {
                u32 value = rgba[(v * width + u) * 4 + c];
                low[c] = MIN(low[c], value), high[c] = MAX(high[c], value);
            }
    for (u32 c = 0; c < 3; c++) most = MAX(most, high[c] - low[c]);
    return most;
}

// Four samples come nearer to a picture of four times the pixels, and change nothing where nothing
// ends.
static void check_samples(const char *level, const char *way) {
    enum { WIDTH = 256, HEIGHT = 144 };
    Studio studio;
    char one[128], four[128];
    studio_open(&studio, level);
    session_advance(&studio.session, 30);
    snprintf(one, sizeof one, "%s,lod_error_px=0", way);
    snprintf(four, sizeof four, "%s,msaa=4", one);
    RenderImage single = draw(&studio, "main", one, WIDTH, HEIGHT);
    RenderImage sampled = draw(&studio, "main", four, WIDTH, HEIGHT);
    RenderImage large = draw(&studio, "main", one, WIDTH * 2, HEIGHT * 2);
    RenderImage again = draw(&studio, "main", one, WIDTH, HEIGHT);
    assert_true(again.hash == single.hash);
    u8 *reference = half_size(large.rgba, WIDTH * 2, HEIGHT * 2, &studio.images);
    ImageDifference a = image_compare(reference, single.rgba, WIDTH, HEIGHT, &studio.images);
    ImageDifference b = image_compare(reference, sampled.rgba, WIDTH, HEIGHT, &studio.images);
    u32 changed = 0, changed_flat = 0, flat = 0;
    for (u32 y = 0; y < HEIGHT; y++)
        for (u32 x = 0; x < WIDTH; x++) {
            u32 step = 0;
            for (u32 c = 0; c < 3; c++) {
                u32 at = (y * WIDTH + x) * 4 + c;
                step = MAX(step, (u32)abs(single.rgba[at] - sampled.rgba[at]));
            }
            bool is_flat = contrast_around(single.rgba, WIDTH, HEIGHT, x, y) <= 6 &&
                           contrast_around(reference, WIDTH, HEIGHT, x, y) <= 6;
            changed += step > 2;
            flat += is_flat;
            changed_flat += is_flat && step > 4;
        }
    printf("    %s %s: SSIM %.5f with one sample, %.5f with four; %u of %u pixels changed, %u of "
           "%u flat ones\n",
           level, way, a.ssim, b.ssim, changed, WIDTH * HEIGHT, changed_flat, flat);
    assert_true(changed > 0 && changed < WIDTH * HEIGHT / 2);
    assert_true(changed_flat * 200 <= flat);
    assert_true(b.ssim > a.ssim);
    studio_close(&studio);
}

TEST_GPU(golden, samples_cornell_forward) { check_samples("data/levels/cornell.toml", "forward"); }
TEST_GPU(golden, samples_plane_test_tiled) {
    check_samples("data/levels/plane_test.toml", "tiled_forward");
}
TEST_GPU(golden, samples_cloister_clustered) {
    check_samples("data/levels/cloister.toml", "clustered_forward,post=off");
}

// All forward paths, and all lists, average the same samples.
TEST_GPU(golden, samples_agree) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    session_advance(&studio.session, 30);
    static const char *const lists[] = {"forward",
                                        "tiled_forward",
                                        "tiled_forward,tile_depth=minmax",
                                        "tiled_forward,tile_depth=mask",
                                        "tiled_forward,grid=gpu",
                                        "clustered_forward",
                                        "clustered_forward,clusters=gpu"};
    RenderImage reference = {0};
    for (u32 i = 0; i < COUNT_OF(lists); i++) {
        char list[128];
        snprintf(list, sizeof list, "%s,msaa=4", lists[i]);
        RenderImage image = draw(&studio, "main", list, 160, 90);
        if (i == 0) reference = image;
        ImageDifference d = image_compare(reference.rgba, image.rgba, 160, 90, &studio.images);
        if (d.max > 2) fail_msg("%s: max %u at %u,%u", list, d.max, d.max_x, d.max_y);
    }
    studio_close(&studio);
}

// --- Lighting at the vertices ---

static void set_vertex_distance(Studio *studio, f32 distance_m) {
    World *world = studio->session.world;
    u32 row = world_singleton(world, COMPONENT_light_manager);
    LightManagerTable *manager = WORLD_TABLE(world, LightManager, light_manager);
    manager->vertex_lighting[row] = distance_m;
    table_touch(&manager->table, row);
}

// Drawables that take light from vertices lie wholly beyond the distance; shares rise with theirs.
static u32 check_shares(const Packet *packet, const World *world, f32 distance_m) {
    const InstanceRecord *instances = PACKET_DATA(packet, instances, InstanceRecord);
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    const PacketSection lists[] = {packet->opaque_draws, packet->mask_draws};
    const f32 *eye = packet->frame.camera;
    u32 lit = 0;
    for (u32 l = 0; l < COUNT_OF(lists); l++) {
        const PacketDraw *draws = (const PacketDraw *)((const u8 *)packet + lists[l].offset);
        for (u32 i = 0; i < lists[l].count; i++)
            for (u32 k = 0; k < draws[i].instance_count; k++) {
                const InstanceRecord *instance = &instances[draws[i].first_instance + k];
                u32 row = table_row(&d->table, instance->ids[1]);
                f32 share;
                memcpy(&share, &instance->ids[2], sizeof share);
                assert_int_equal(draws[i].vertex_lit, share <= 0.0f ? 0 : share < 1.0f ? 1 : 2);
                f32 x = d->bounds_x[row] - eye[0], y = d->bounds_y[row] - eye[1],
                    z = d->bounds_z[row] - eye[2];
                f32 nearest = sqrtf(x * x + y * y + z * z) - d->bounds_radius[row];
                if (share > 0.0f) assert_true(nearest > distance_m * 0.9999f);
                if (share >= 1.0f) assert_true(nearest > distance_m * 1.2499f);
                lit += share > 0.0f;
            }
    }
    return lit;
}

TEST_GPU(golden, vertex_lighting_of_far_surfaces) {
    Studio studio;
    studio_open(&studio, "data/levels/cloister.toml");
    session_advance(&studio.session, 90);
    static const char *const paths[] = {"forward", "tiled_forward", "clustered_forward"};
    for (u32 i = 0; i < COUNT_OF(paths); i++) {
        char off[64];
        snprintf(off, sizeof off, "%s,vertex_lighting=off", paths[i]);
        set_vertex_distance(&studio, 25.0f);
        RenderSettings settings = settings_from(paths[i]);
        const Packet *packet = session_packet(&studio.session, &(SessionView){.camera = "main",
                                                                              .settings = settings,
                                                                              .width_px = 256,
                                                                              .height_px = 144});
        u32 lit = check_shares(packet, studio.session.world, 25.0f);
        RenderImage exact = draw(&studio, "main", off, 256, 144);
        RenderImage lodded = draw(&studio, "main", paths[i], 256, 144);
        set_vertex_distance(&studio, 1000.0f);
        RenderImage beyond = draw(&studio, "main", paths[i], 256, 144);
        ImageDifference d = image_compare(exact.rgba, lodded.rgba, 256, 144, &studio.images);
        printf("    %s: %u drawables lit at their vertices; max %u, mean %.4f, FLIP %.5f\n",
               paths[i], lit, d.max, d.mean, d.flip);
        assert_true(lit > 0 && lodded.hash != exact.hash);
        assert_true(d.mean < 0.5 && d.flip < 0.02);
        assert_true(beyond.hash == exact.hash); // nothing is that far
    }
    studio_close(&studio);
}

// --- By turns ---

// A hundred frames, each with other settings, sizes and paths: what an earlier frame left behind
// must not show, nor worry the validation layer.
TEST_GPU(golden, a_hundred_turns) {
    static const char *const turns[] = {
        "forward,msaa=4",
        "deferred_volumes,light_volume=stencil",
        "tiled_forward,msaa=4,tile_depth=mask",
        "multipass",
        "deferred_volumes,light_volume=auto,light_scissor=off",
        "clustered_forward,clusters=gpu",
        "clustered_forward,msaa=4",
        "deferred_volumes,light_volume=quad",
        "tiled_deferred,msaa=4",
        "deferred",
        "clustered_deferred,clusters=gpu",
        "forward",
        "deferred_volumes,light_volume=stencil,light_branch=on",
        "tiled_forward,grid=gpu",
        "tiled_forward,msaa=4,grid=gpu",
        "clustered_forward,msaa=4,clusters=gpu",
        "multipass,msaa=4",
    };
    static const u32 sizes[][2] = {{64, 36}, {64, 36}, {64, 36}, {49, 27}};
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    session_advance(&studio.session, 10);
    u64 hashes[COUNT_OF(turns)][COUNT_OF(sizes)] = {{0}};
    for (u32 frame = 0; frame < 100; frame++) {
        u32 turn = (u32)(random_u32(7, 0, frame) % COUNT_OF(turns));
        u32 size = (u32)(random_u32(7, 1, frame) % COUNT_OF(sizes));
        RenderImage image = draw(&studio, "main", turns[turn], sizes[size][0], sizes[size][1]);
        u64 *known = &hashes[turn][size];
        if (*known && *known != image.hash)
            fail_msg("frame %u, %s: another picture than before", frame, turns[turn]);
        *known = image.hash;
    }
    studio_close(&studio);
}
