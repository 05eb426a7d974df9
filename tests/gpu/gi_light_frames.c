// gi_light_frames.c: light of voxels in whole frames: what makes it run again, bounces, feedback,
// irradiance. Data in: small levels. Data out: read-backs and counters. Called by: the runner.
#include "gi_light_stage.h"
#include "../golden/studio.h"
#include <stdio.h>
#include <string.h>

#define WIDTH  64
#define HEIGHT 36

typedef struct Lit {
    u32 slots, faces, *places;
    f32 *radiance; // 4 a slot and face
} Lit;

static RenderSettings settings_of(const char *list) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, "gi.enabled=on,gi.grid=32,gi.feedback=off"));
    if (list[0]) assert_true(settings_set_list(&settings, list));
    return settings;
}
// cold: the picture must not hang on what was drawn before; else as a player's frames.
static u64 draw_as(Studio *studio, const char *camera, const char *list, bool cold) {
    RenderSettings settings = settings_of(list);
    session_frame_begin(&studio->session);
    const Packet *packet = session_packet(&studio->session, &(SessionView){.camera = camera,
                                                                           .settings = settings,
                                                                           .width_px = WIDTH,
                                                                           .height_px = HEIGHT,
                                                                           .cold = cold});
    assert_non_null(packet);
    RenderImage image = {0};
    assert_true(renderer_render_image(studio->renderer, packet, &studio->images, &image));
    return image.hash;
}
static u64 draw(Studio *studio, const char *camera, const char *list) {
    return draw_as(studio, camera, list, false);
}
static void *read_volume(Studio *studio, GiVolume which, u64 size) {
    void *out = ARENA_PUSH(&studio->images, u8, size);
    assert_true(renderer_read_gi(studio->renderer, which, out, size) == size);
    return out;
}
static Lit read_lit(Studio *studio, u32 faces) {
    const u32 *counters = read_volume(studio, GI_VOLUME_COUNTERS, GI_COUNTER_COUNT * sizeof(u32));
    Lit lit = {counters[GI_COUNTER_STATIC] + counters[GI_COUNTER_DYNAMIC], faces, NULL, NULL};
    assert_true(lit.slots > 0);
    lit.places = read_volume(studio, GI_VOLUME_VOXELS, lit.slots * sizeof(u32));
    u64 numbers = (u64)lit.slots * faces * 4;
    u64 bytes = numbers * sizeof(u16);
    const u16 *halves[2] = {read_volume(studio, GI_VOLUME_RADIANCE, faces > 1 ? bytes / 2 : bytes),
                            faces > 1 ? read_volume(studio, GI_VOLUME_RADIANCE_2, bytes / 2)
                                      : NULL};
    lit.radiance = ARENA_PUSH(&studio->images, f32, numbers);
    gi_radiance_floats(halves, lit.slots, faces, lit.radiance);
    return lit;
}
static f64 total(const Lit *lit) {
    f64 sum = 0;
    for (u64 i = 0; i < (u64)lit->slots * lit->faces; i++)
        for (u32 k = 0; k < 3; k++) sum += (f64)lit->radiance[4 * i + k];
    return sum;
}
static f64 lit_total(Studio *studio) {
    Lit lit = read_lit(studio, 1);
    return total(&lit);
}

static void change_lights(Studio *studio, f32 factor, f32 up_m) {
    LightTable *lights = WORLD_TABLE(studio->session.world, Light, light);
    for (u32 i = 0; i < lights->table.count; i++) {
        lights->intensity[i] *= factor;
        lights->y[i] += up_m;
        table_touch(&lights->table, i);
    }
}

// A lamp that moves is lit anew, and nothing is voxelised; a still frame does nothing.
TEST_GPU(gi_light_frames, moving_a_lamp_only_relights) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    draw(&studio, "main", "");
    RendererStats first = renderer_stats(studio.renderer);
    f64 before = lit_total(&studio);
    draw(&studio, "main", "");
    assert_int_equal(renderer_stats(studio.renderer).gi_relit, first.gi_relit);
    change_lights(&studio, 1.0f, -0.5f);
    draw(&studio, "main", "");
    RendererStats moved = renderer_stats(studio.renderer);
    assert_int_equal(moved.gi_relit, first.gi_relit + 1);
    assert_int_equal(moved.gi_static_voxelised, first.gi_static_voxelised);
    assert_int_equal(moved.gi_dynamic_voxelised, first.gi_dynamic_voxelised);
    assert_true(fabs(lit_total(&studio) - before) > before * 0.01);
    change_lights(&studio, 1.0f, 0.5f);
    draw(&studio, "main", "");
    assert_true(lit_total(&studio) == before); // and back again: the same bits
    studio_close(&studio);
}

// What the view sees makes no difference.
TEST_GPU(gi_light_frames, lights_outside_the_view_light_voxels) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    TransformTable *transforms = WORLD_TABLE(studio.session.world, Transform, transform);
    draw(&studio, "main", "gi.bounces=1");
    Lit a = read_lit(&studio, 1);
    Entity eye = world_find(studio.session.world, "main");
    u32 row = table_row(&transforms->table, eye);
    assert_true(row != ROW_NONE);
    transforms->y[row] -= 300.0f; // nothing of the level is in view
    table_touch(&transforms->table, row);
    draw(&studio, "main", "gi.bounces=1,light_gain=1.5");
    Lit b = read_lit(&studio, 1);
    assert_int_equal(a.slots, b.slots);
    f64 lamps = 0;
    for (u64 i = 0; i < (u64)a.slots * 4; i++) lamps += b.radiance[i] > a.radiance[i] ? 1 : 0;
    assert_true(lamps > a.slots);
    studio_close(&studio);
}

// Emission alone fills the atlas: what leaves downwards, level by level (the floor hides it in
// coarse ones).
TEST_GPU(gi_light_frames, emission_reaches_the_atlas) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    change_lights(&studio, 0.0f, 0.0f);
    draw(&studio, "main", "gi.bounces=1");
    u64 texels = 0, at = 0;
    for (u32 l = 0; l < 5; l++) texels += 6ull * (16 >> l) * (16 >> l) * (16 >> l);
    const u16 *atlas = read_volume(&studio, GI_VOLUME_ATLAS, texels * 8);
    for (u32 l = 0; l < 3; l++) {
        u32 side = 16 >> l;
        f64 down = 0;
        for (u32 i = 0; i < side * side * side; i++)
            down += (f64)half_to_float(atlas[4 * (at + i / side * side * 6 + 3 * side + i % side)]);
        // 12 cd/m2 over 1.3 x 1.05 m of a box 6 m wide.
        down /= side * side;
        assert_true(down > 0.1 && down < 2.0);
        at += 6ull * side * side * side;
    }
    studio_close(&studio);
}

TEST_GPU(gi_light_frames, second_bounce_adds) {
    for (u32 faces = 0; faces < 2; faces++) {
        Studio studio;
        studio_open(&studio, "data/levels/cornell.toml");
        char list[64];
        Lit lit[2];
        for (u32 i = 0; i < 2; i++) {
            snprintf(list, sizeof list, "gi.bounces=%u,gi.faces=%s", i + 1,
                     faces ? "apart" : "shared");
            draw(&studio, "main", list);
            lit[i] = read_lit(&studio, faces ? 6 : 1);
        }
        assert_int_equal(lit[0].slots, lit[1].slots);
        for (u64 i = 0; i < (u64)lit[0].slots * lit[0].faces * 4; i++)
            assert_true(lit[1].radiance[i] >= lit[0].radiance[i]);
        assert_true(total(&lit[1]) > total(&lit[0]) * 1.1);
        studio_close(&studio);
    }
}

// Mean radiance of the walls' inner voxels, and of what arrives there (NULL: is not kept by voxel).
static void furnace_means(Studio *studio, u32 faces, f64 *sent, f64 *arrived) {
    Lit lit = read_lit(studio, faces);
    u64 voxels = 32 * 32 * 32;
    const u16 *irradiance = arrived ? read_volume(studio, GI_VOLUME_IRRADIANCE, voxels * 8) : NULL;
    f64 sums[2] = {0};
    u32 count = 0;
    for (u32 slot = 0; slot < lit.slots; slot++) {
        u32 place = lit.places[slot];
        u32 x = place & 511, y = place >> 9 & 511, z = place >> 18;
        u64 at = x + 32 * (y + 32ull * z);
        // The middle of the floor's upper side: cones stay inside.
        if (x < 12 || x >= 20 || z < 12 || z >= 20) continue;
        f32 found = arrived ? half_to_float(irradiance[at * 4]) : 1.0f;
        if (found <= 0.0f || y >= 16) continue;
        u32 face = faces == 6 ? 2 : 0; // +y
        f32 up = lit.radiance[((u64)slot * faces + face) * 4];
        if (faces == 6 && up <= 0.0f) continue;
        if (faces == 1 && y < 5) continue; // the floor's lower side sends its emission alone
        sums[0] += (f64)up, sums[1] += (f64)found;
        count++;
    }
    assert_true(count > 10);
    *sent = sums[0] / count;
    if (arrived) *arrived = sums[1] / count;
}

// In a closed room whose walls send out 1 and reflect half of what arrives, 2 goes round in the
// end: 1 by emission, 1.5 after one bounce. Feedback ends there, and each frame is nearer. What
// cones see of walls is mixed with what lies behind: the bounds are as wide as that is measured.
TEST_GPU(gi_light_frames, furnace) {
    for (u32 apart = 0; apart < 2; apart++) {
        Studio studio;
        studio_open(&studio, "tests/gpu/furnace.toml");
        f64 sent, arrived;
        char list[64];
        for (u32 bounces = 1; bounces < 3; bounces++) {
            snprintf(list, sizeof list, "gi.faces=%s,gi.bounces=%u", apart ? "apart" : "shared",
                     bounces);
            draw(&studio, "main", list);
            furnace_means(&studio, apart ? 6 : 1, &sent, &arrived);
            f64 wanted = bounces == 1 ? 1.0 : 1.5;
            assert_true(fabs(sent - wanted) < 0.05);
            assert_true(arrived > wanted * 0.85 && arrived < wanted * 1.03);
        }
        f64 last = sent;
        snprintf(list, sizeof list, "gi.faces=%s,gi.feedback=on", apart ? "apart" : "shared");
        for (u32 frame = 0; frame < 5; frame++) {
            draw(&studio, "main", list);
            furnace_means(&studio, apart ? 6 : 1, &sent, &arrived);
            assert_true(frame == 0 ? sent > last : sent >= last - 0.002);
            if (frame > 3) assert_true(sent < last + 0.02);
            last = sent;
        }
        assert_true(last > 1.6 && last < 2.1);
        studio_close(&studio);
    }
}

// The same room, when the probes keep what goes round: a cold frame makes five rounds, each frame
// with all probes one more.
TEST_GPU(gi_light_frames, furnace_by_probes) {
    for (u32 apart = 0; apart < 2; apart++) {
        Studio studio;
        studio_open(&studio, "tests/gpu/furnace.toml");
        char list[128];
        f64 sent, last = 1.0;
        for (u32 frame = 0; frame < 6; frame++) {
            snprintf(list, sizeof list,
                     "gi.faces=%s,gi.diffuse=probes,gi.probe_spacing=0.8,gi.share=1,gi.feedback=on",
                     apart ? "apart" : "shared");
            draw(&studio, "main", list);
            furnace_means(&studio, apart ? 6 : 1, &sent, NULL);
            assert_true(frame == 0 ? sent > 1.6 : sent >= last - 0.002);
            if (frame > 3) assert_true(sent < last + 0.02);
            last = sent;
        }
        printf("    faces %s: %.3f goes round\n", apart ? "apart" : "shared", last);
        assert_true(last > 1.6 && last < 2.1);
        studio_close(&studio);
    }
}

// The same frames give the same bits, with feedback too; a cold frame's do not hang on what was
// before.
static void feedback_replays(const char *list) {
    u64 hashes[2][6], cold[2];
    for (u32 run = 0; run < 2; run++) {
        Studio studio;
        studio_open(&studio, "data/levels/cornell.toml");
        for (u32 frame = 0; frame < 6; frame++) {
            hashes[run][frame] = draw(&studio, "main", list);
            if (frame == 2) change_lights(&studio, 0.5f, 0.0f);
        }
        if (run == 1)
            for (u32 frame = 0; frame < 3; frame++) draw(&studio, "main", list);
        cold[run] = draw_as(&studio, "main", list, true);
        if (run == 1) { // and it comes to rest
            u32 relit = 0;
            for (u32 frame = 0; frame < 40; frame++) {
                relit = renderer_stats(studio.renderer).gi_relit;
                draw(&studio, "main", list);
            }
            assert_int_equal(renderer_stats(studio.renderer).gi_relit, relit);
        }
        studio_close(&studio);
    }
    assert_memory_equal(hashes[0], hashes[1], sizeof hashes[0]);
    assert_true(hashes[0][0] != hashes[0][1] && hashes[0][2] != hashes[0][3]);
    assert_true(cold[0] == cold[1]);
}
// With share 4 a frame lights one group of 64 static voxels in four, and all dynamic ones; when it
// has come to rest, voxels send out what they do with share 1, whatever the order.
TEST_GPU(gi_light_frames, feedback_by_probes_takes_turns) {
    const char *lists[] = {"gi.feedback=on,gi.diffuse=probes,gi.share=1",
                           "gi.feedback=on,gi.diffuse=probes,gi.share=4"};
    f64 sent[2];
    for (u32 run = 0; run < 2; run++) {
        Studio studio;
        studio_open(&studio, "data/levels/cornell.toml");
        InstanceTable *instances = WORLD_TABLE(studio.session.world, Instance, instance);
        u32 row = table_row(&instances->table, world_find(studio.session.world, "short_box"));
        instances->voxel_mode[row] = VOXEL_DYNAMIC;
        table_touch(&instances->table, row);
        draw(&studio, "main", lists[run]);
        Lit before = read_lit(&studio, 1);
        const u32 *counters =
            read_volume(&studio, GI_VOLUME_COUNTERS, GI_COUNTER_COUNT * sizeof(u32));
        u32 fixed = counters[GI_COUNTER_STATIC], turns[4] = {0}, moving = 0;
        change_lights(&studio, 0.5f, 0.0f);
        draw(&studio, "main", lists[run]);
        Lit after = read_lit(&studio, 1);
        assert_int_equal(after.slots, before.slots);
        for (u32 slot = 0; slot < after.slots; slot++) {
            if (memcmp(&before.radiance[4 * slot], &after.radiance[4 * slot], 4 * sizeof(f32)) == 0)
                continue;
            if (slot < fixed)
                turns[slot / 64 % 4]++;
            else
                moving++;
        }
        u32 busy = 0, changed = turns[0] + turns[1] + turns[2] + turns[3];
        for (u32 i = 0; i < 4; i++) busy += turns[i] > 0;
        assert_int_equal(busy, run == 0 ? 4 : 1);
        assert_in_range(changed, fixed / (run == 0 ? 4 : 16), run == 0 ? fixed : (fixed + 255) / 4);
        assert_true(moving > (after.slots - fixed) / 4); // as many as see light
        for (u32 frame = 0; frame < 70; frame++) draw(&studio, "main", lists[run]);
        sent[run] = lit_total(&studio);
        studio_close(&studio);
    }
    printf("    sent with share 1: %.3f, with share 4: %.3f\n", sent[0], sent[1]);
    ASSERT_NEAR(sent[1], sent[0], sent[0] * 2e-3);
}

TEST_GPU(gi_light_frames, feedback_replays) { feedback_replays("gi.feedback=on,gi.diffuse=cones"); }
TEST_GPU(gi_light_frames, feedback_by_probes_replays) {
    feedback_replays("gi.feedback=on,gi.diffuse=probes,gi.share=2");
}
