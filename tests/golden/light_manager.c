// light_manager.c: the light manager in pictures: what is hidden lights nothing that is seen, what
// is simplified looks alike, and nothing pops along the tour.
#include "studio.h"
#include "../../engine/base/hash.h"
#include "../../engine/capture/image_compare.h"
#include "../../engine/systems/light_manager.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOISTER "data/levels/cloister.toml"

static const char *const cameras[] = {"main",          "corner",   "garden", "walk",
                                      "chapter_house", "fountain", "above",  "tour"};

// A packet with another light manager's state than the session's; NULL = decided afresh.
static const Packet *packet_of(Studio *studio, Entity camera, const RenderSettings *settings,
                               u32 width_px, u32 height_px, const LightManagerState *state) {
    session_frame_begin(&studio->session);
    PacketBuildDesc desc = {.world = studio->session.world,
                            .assets = &studio->session.assets,
                            .camera = camera,
                            .settings = *settings,
                            .width_px = width_px,
                            .height_px = height_px,
                            .light_manager = state};
    const Packet *packet =
        packet_build(&desc, &studio->session.frame, &studio->session.scratch, NULL);
    assert_null(packet_validate(packet, packet->size, studio->session.assets.mesh_count,
                                studio->session.assets.texture_count));
    return packet;
}

static RenderImage draw_with(Studio *studio, Entity camera, const RenderSettings *settings,
                             u32 width_px, u32 height_px, const LightManagerState *state) {
    const Packet *packet = packet_of(studio, camera, settings, width_px, height_px, state);
    RenderImage image = {0};
    assert_true(renderer_render_image(studio->renderer, packet, &studio->images, &image));
    return image;
}

// Light that bounces is not the manager's (studio_direct_light): it comes from the level's own
// lights, a share of it a frame.
static RenderSettings stages(bool merge, bool drop, bool lod) {
    RenderSettings settings = studio_direct_light();
    settings.merge = merge, settings.drop = drop, settings.light_lod = lod;
    return settings;
}

// ---- what is hidden ----

// What a light does to its list's order changes sums in the last bit: 1 of 255.
static u32 compare_occlusion(Studio *studio, Entity camera, const char *name, u32 width, u32 height,
                             PacketCounts *counts) {
    u64 mark = arena_mark(&studio->images);
    RenderSettings on = stages(false, false, false), off = on;
    off.occlusion = 0;
    const Packet *packet = packet_of(studio, camera, &on, width, height, NULL);
    *counts = packet->counts;
    RenderImage a = draw_with(studio, camera, &on, width, height, NULL);
    RenderImage b = draw_with(studio, camera, &off, width, height, NULL);
    ImageDifference d = image_compare(a.rgba, b.rgba, width, height, &studio->images);
    if (d.max > 1) fail_msg("%s: pixel %u,%u differs by %u", name, d.max_x, d.max_y, d.max);
    arena_rewind(&studio->images, mark);
    return counts->lights_occluded + counts->drawables_occluded;
}

TEST_GPU(golden, occlusion_hides_only_what_is_hidden) {
    Studio studio;
    studio_open(&studio, CLOISTER);
    session_advance(&studio.session, 90);
    PacketCounts c;
    u32 hidden = 0;
    for (u32 i = 0; i < COUNT_OF(cameras); i++) {
        hidden += compare_occlusion(&studio, session_camera(&studio.session, cameras[i]),
                                    cameras[i], 640, 360, &c);
        printf(
            "    %-14s lights in view %u, hidden %u; meshes in view %u, hidden %u; %u occluders\n",
            cameras[i], c.lights_visible, c.lights_occluded, c.drawables_visible,
            c.drawables_occluded, c.occluders);
    }
    // Along the tour, whose stops lie far apart; and from the player's eyes, turning.
    u32 hidden_on_tour = 0, most = 0;
    Entity tour = session_camera(&studio.session, "tour");
    for (u32 i = 0; i < 20; i++) {
        session_advance(&studio.session, 150);
        hidden_on_tour += compare_occlusion(&studio, tour, "on tour", 320, 180, &c);
        most = MAX(most, c.lights_occluded);
    }
    for (u32 i = 0; i < 8; i++) {
        session_tick(&studio.session, (Input){.look_x = 4500});
        compare_occlusion(&studio, studio.session.player, "player", 320, 180, &c);
        printf("    player turned by %u degrees: hidden %u lights, %u meshes\n", 45 * (i + 1),
               c.lights_occluded, c.drawables_occluded);
        most = MAX(most, c.lights_occluded);
    }
    printf("    hidden in all: cameras %u, tour %u; most lights %u\n", hidden, hidden_on_tour,
           most);
    assert_true(most > 30);
    studio_close(&studio);
}

// ---- what is simplified ----

// By the session, so with what it knows of surfaces; a camera that was not looked through before is
// a cut.
static ImageDifference compare_manager(Studio *studio, const char *camera, u32 budget,
                                       PacketCounts *counts) {
    u64 mark = arena_mark(&studio->images);
    RenderSettings on = studio_direct_light(), off = on;
    on.budget = budget;
    off.manager = 0;
    RenderImage a = studio_draw(studio, camera, &on, 640, 360);
    *counts =
        session_packet(
            &studio->session,
            &(SessionView){.camera = camera, .settings = on, .width_px = 640, .height_px = 360})
            ->counts;
    RenderImage b = studio_draw(studio, camera, &off, 640, 360);
    ImageDifference d = image_compare(a.rgba, b.rgba, 640, 360, &studio->images);
    arena_rewind(&studio->images, mark);
    return d;
}

static u32 shaded(const PacketCounts *c) {
    return c->lights_near + c->lights_between + c->lights_far;
}

TEST_GPU(golden, manager_looks_like_all_lights) {
    Studio studio;
    studio_open(&studio, CLOISTER);
    session_advance(&studio.session, 90);
    f64 least = 1;
    u64 kept = 0, full = 0, all = 0;
    for (u32 i = 0; i < COUNT_OF(cameras); i++) {
        PacketCounts c;
        ImageDifference d = compare_manager(&studio, cameras[i], 0, &c);
        printf(
            "    %-14s SSIM %.4f max %u mean %.3f | of %u in view: hidden %u, merged %u into %u, "
            "dropped %u, fading %u; near %u between %u far %u; error %.3f\n",
            cameras[i], d.ssim, d.max, d.mean, c.lights_visible, c.lights_occluded, c.lights_merged,
            c.lights_merged_pairs, c.lights_dropped, c.lights_fading, c.lights_near,
            c.lights_between, c.lights_far, (f64)c.merge_error);
        least = MIN(least, d.ssim);
        all += c.lights_visible, kept += shaded(&c), full += c.lights_near;
    }
    printf(
        "    least SSIM %.4f; of %llu lights in view %llu are shaded, %llu with full highlights\n",
        least, (unsigned long long)all, (unsigned long long)kept, (unsigned long long)full);
    assert_true(least >= 0.98);
    assert_true(kept * 100 < all * 95 && full * 10 < all * 7);
    static const u32 budgets[] = {64, 32, 16, 8};
    for (u32 i = 0; i < COUNT_OF(budgets); i++) {
        PacketCounts c;
        ImageDifference d = compare_manager(&studio, "main", budgets[i], &c);
        printf("    main, budget %2u: SSIM %.4f mean %.3f, %u of %u shaded\n", budgets[i], d.ssim,
               d.mean, shaded(&c), c.lights_visible);
    }
    studio_close(&studio);
}

// ---- popping ----

typedef struct Way {
    const char *level, *camera; // NULL = the player, who walks and turns
    u32 first, ticks, budget;
} Way;

static u32 largest_change(const u8 *a, const u8 *b, u32 bytes) {
    u32 most = 0;
    for (u32 i = 0; i < bytes; i++) most = MAX(most, (u32)abs(a[i] - b[i]));
    return most;
}

// Along the way, tick by tick: the same world, camera and packet, once with the manager as of the
// tick and once as of the tick before. The difference is what merging, dropping and the budget
// changed in that tick and nothing else; the world's own motion and parallax are not in it.
static void expect_no_pops(const Way *way) {
    enum { W = 160, H = 90, MOST = 3 };
    Studio studio;
    studio_open(&studio, way->level);
    LightManagerTable *manager = WORLD_TABLE(studio.session.world, LightManager, light_manager);
    manager->budget[world_singleton(studio.session.world, COMPONENT_light_manager)] = way->budget;
    Entity camera =
        way->camera ? session_camera(&studio.session, way->camera) : studio.session.player;
    RenderSettings settings = studio_direct_light();
    settings.view = VIEW_FINAL;
    studio.session.packet_camera = camera; // the state looks through it from here on
    session_advance(&studio.session, way->first);
    u32 worst = 0, changed = 0;
    for (u32 i = 0; i < way->ticks; i++) {
        LightManagerState *before = light_manager_clone(studio.session.light_manager);
        Input walk = {.move_z = 127, .look_x = i / 40 % 2 ? 40 : -60};
        session_tick(&studio.session, way->camera ? (Input){0} : walk);
        light_manager_delay(before, 1);
        RenderImage now = draw_with(&studio, camera, &settings, W, H, studio.session.light_manager);
        RenderImage was = draw_with(&studio, camera, &settings, W, H, before);
        u32 change = largest_change(now.rgba, was.rgba, W * H * 4);
        changed += change > 0;
        worst = MAX(worst, change);
        light_manager_destroy(before);
        arena_reset(&studio.images);
    }
    printf("    %s, budget %u: worst change of a pixel in a tick %u of 255; %u of %u ticks "
           "changed any\n",
           way->level, way->budget, worst, changed, way->ticks);
    assert_true(changed > way->ticks / 10);
    assert_in_range(worst, 1, MOST);
    studio_close(&studio);
}

TEST_GPU(golden, nothing_pops_on_the_tour) {
    expect_no_pops(&(Way){CLOISTER, "tour", .first = 60, .ticks = 240});
}
TEST_GPU(golden, nothing_pops_later_on_the_tour) {
    expect_no_pops(&(Way){CLOISTER, "tour", .first = 1500, .ticks = 120});
}
// Levels have none as they are. One that takes half of the lights moves hundreds at once.
TEST_GPU(golden, nothing_pops_with_a_budget) {
    expect_no_pops(&(Way){CLOISTER, "tour", .first = 60, .ticks = 240, .budget = 40});
}
// Thousands of pairs, hundreds of them over one pixel.
TEST_GPU(golden, nothing_pops_among_thousands_of_pairs) {
    expect_no_pops(&(Way){"data/levels/hall.toml", .first = 60, .ticks = 16});
}

// Highlights fade by distance, so their step in a tick is the camera's way over the band's width.
TEST_GPU(golden, highlights_do_not_jump_on_the_tour) {
    Studio studio;
    studio_open(&studio, CLOISTER);
    Entity tour = session_camera(&studio.session, "tour");
    RenderSettings settings = stages(false, false, true);
    settings.view = VIEW_LIGHT_LODS;
    settings.light_culling = settings.occlusion = 0;
    static f32 before[4096];
    f32 most = 0;
    u32 last_count = 0;
    for (u32 i = 0; i < 300; i++) {
        session_tick(&studio.session, (Input){0});
        const Packet *p = packet_of(&studio, tour, &settings, 160, 90, NULL);
        const PacketLightMark *marks = PACKET_DATA(p, light_marks, PacketLightMark);
        assert_in_range(p->light_marks.count, 100, COUNT_OF(before));
        // A light that goes out for a tick would shift the others.
        bool same = p->light_marks.count == last_count;
        for (u32 k = 0; k < p->light_marks.count; k++) {
            if (same) most = MAX(most, fabsf(marks[k].highlight - before[k]));
            before[k] = marks[k].highlight;
        }
        last_count = p->light_marks.count;
    }
    printf("    most in a tick %.4f\n", (f64)most);
    assert_true(most > 0 && most < 1.0f / 15);
    studio_close(&studio);
}
