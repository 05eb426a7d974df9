// gi_probes.c: the grid of probes: what a share of them a frame ends with, their free ways against
// a naive walk through the masks, their light against cones from every pixel. Data in: small
// levels. Data out: read-backs, pictures. Called by: the runner.
#include "../golden/studio.h"
#include "../../engine/capture/image_compare.h"
#include <stdio.h>
#include <string.h>

#define WIDTH  160
#define HEIGHT 90
#define COMMON                                                                                     \
    "gi.enabled=on,gi.grid=32,gi.bounces=1,gi.feedback=off,gi.diffuse=probes,gi.probe_spacing=0.8"

typedef struct Probes {
    u32 size[3], count;
    u16 *texels; // RGBA halves: [z][y][6 * x][4]
    u64 bytes;
} Probes;

// Not cold: what is spread over frames stays so.
static const Packet *draw(Studio *studio, const char *list, RenderImage *out) {
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    session_frame_begin(&studio->session);
    const Packet *packet = session_packet(&studio->session, &(SessionView){.camera = "main",
                                                                           .settings = settings,
                                                                           .width_px = WIDTH,
                                                                           .height_px = HEIGHT});
    assert_non_null(packet);
    assert_true(renderer_render_image(studio->renderer, packet, &studio->images, out));
    return packet;
}

static Probes read_probes(Studio *studio, const Packet *packet) {
    Probes p = {0};
    const u32 *size = packet->gi.record.probes;
    memcpy(p.size, size, sizeof p.size);
    p.count = size[0] * size[1] * size[2];
    p.bytes = (u64)p.count * 6 * 4 * sizeof(u16);
    p.texels = ARENA_PUSH(&studio->images, u16, p.count * 6 * 4);
    assert_true(renderer_read_gi(studio->renderer, GI_VOLUME_PROBES, p.texels, p.bytes) == p.bytes);
    return p;
}
static const u16 *texel(const Probes *p, u32 x, u32 y, u32 z, u32 block) {
    return &p->texels[(((u64)z * p->size[1] + y) * p->size[0] * 6 + block * p->size[0] + x) * 4];
}

static void dim_lights(Studio *studio) {
    LightTable *lights = WORLD_TABLE(studio->session.world, Light, light);
    for (u32 i = 0; i < lights->table.count; i++) {
        lights->intensity[i] *= 0.5f;
        table_touch(&lights->table, i);
    }
}

// One probe in four a frame: after four frames of a still scene the bits are those of a cold frame,
// and then nothing is left to do.
TEST_GPU(gi_probes, share) {
    const char *list = COMMON ",gi.share=4";
    Studio studio;
    RenderImage image;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *packet = draw(&studio, list, &image);
    u32 all =
        packet->gi.record.probes[0] * packet->gi.record.probes[1] * packet->gi.record.probes[2];
    assert_int_equal(renderer_stats(studio.renderer).gi_probes_refreshed, all);
    draw(&studio, list, &image);
    assert_int_equal(renderer_stats(studio.renderer).gi_probes_refreshed, 0);
    dim_lights(&studio);
    u32 sum = 0;
    Probes stale = read_probes(&studio, packet);
    for (u32 frame = 0; frame < 4; frame++) {
        packet = draw(&studio, list, &image);
        u32 fresh = renderer_stats(studio.renderer).gi_probes_refreshed;
        assert_in_range(fresh, all / 4, (all + 3) / 4);
        sum += fresh;
    }
    assert_int_equal(sum, all);
    Probes spread = read_probes(&studio, packet);
    assert_true(memcmp(stale.texels, spread.texels, spread.bytes) != 0);
    packet = draw(&studio, list, &image);
    assert_int_equal(renderer_stats(studio.renderer).gi_probes_refreshed, 0);
    Probes kept = read_probes(&studio, packet);
    assert_memory_equal(kept.texels, spread.texels, spread.bytes);
    // Two cold runs.
    for (u32 run = 0; run < 2; run++) {
        Studio other;
        RenderImage cold_image;
        studio_open(&other, "data/levels/cornell.toml");
        dim_lights(&other);
        Probes cold = read_probes(&other, draw(&other, list, &cold_image));
        assert_memory_equal(cold.texels, spread.texels, spread.bytes);
        assert_true(cold_image.hash == image.hash);
        studio_close(&other);
    }
    studio_close(&studio);
}

// --- Free ways ---

// Inverse of gi_probe_code.glsl; half float bits in, steps of 1.5 / 31 spacings out, 31 = free.
static void decode(u16 half, u32 *up, u32 *down, u32 *open) {
    u32 code = (half & 1023u) | ((half >> 10 & 31u) - 1u) << 10 | (u32)(half >> 15) << 14;
    *up = code & 31, *down = code >> 5 & 31, *open = code >> 10 & 31;
}

typedef struct Masks {
    const u32 *words;
    const GiRecord *record;
    u64 layer_words;
} Masks;
static bool is_occupied(const Masks *m, const i64 at[3]) {
    const u32 *dims = m->record->dims;
    for (u32 a = 0; a < 3; a++)
        if (at[a] < 0 || at[a] >= (i64)dims[a]) return false;
    u64 bit = (u64)at[0] + dims[0] * ((u64)at[1] + dims[1] * (u64)at[2]);
    u32 word = m->words[bit >> 5] | m->words[m->layer_words + (bit >> 5)];
    return word >> (bit & 31) & 1;
}

// Voxels between a place and the next occupied voxel, by tiny steps; a voxel's border is met up to
// one step late.
static f64 walk(const Masks *m, const f64 from[3], u32 axis, i32 sign, f64 farthest) {
    const f64 step = 1.0 / 64;
    for (f64 t = 0; t < farthest; t += step) {
        i64 at[3];
        for (u32 a = 0; a < 3; a++) at[a] = (i64)floor(from[a] + (a == axis ? sign * t : 0.0));
        if (is_occupied(m, at)) return t;
    }
    return farthest;
}

// A probe in a wall: it stepped out, so the way back is 0 and no other, or all ways are.
static bool left_wall(const Probes *p, const u32 at[3]) {
    u32 zeros = 0;
    for (u32 axis = 0; axis < 3; axis++) {
        u32 up, down, open;
        decode(texel(p, at[0], at[1], at[2], axis * 2)[3], &up, &down, &open);
        zeros += (up == 0) + (down == 0);
    }
    assert_true(zeros == 1 || zeros == 6);
    return zeros == 1;
}

TEST_GPU(gi_probes, free_ways) {
    Studio studio;
    RenderImage image;
    studio_open(&studio, "data/levels/cornell.toml");
    const Packet *packet = draw(&studio, COMMON, &image);
    const GiRecord *record = &packet->gi.record;
    Probes p = read_probes(&studio, packet);
    u64 layer = (u64)record->dims[0] * record->dims[1] * record->dims[2] / 32;
    u32 *words = ARENA_PUSH(&studio.images, u32, layer * 2);
    assert_true(renderer_read_gi(studio.renderer, GI_VOLUME_MASKS, words, layer * 2 * 4) > 0);
    Masks masks = {words, record, layer};
    f64 voxel = (f64)record->origin[0][3], spacing = (f64)record->probe_origin[3];
    u32 in_walls = 0, left = 0, near_walls = 0;
    for (u32 i = 0; i < p.count; i++) {
        u32 at[3] = {i % p.size[0], i / p.size[0] % p.size[1], i / (p.size[0] * p.size[1])};
        f64 place[3], border = 1;
        for (u32 a = 0; a < 3; a++) {
            place[a] =
                ((f64)record->probe_origin[a] + at[a] * spacing - (f64)record->origin[0][a]) /
                voxel;
            border = MIN(border, fabs(place[a] - round(place[a])));
        }
        if (border < 1e-3) continue; // rounding decides which voxel it stands in
        if (walk(&masks, place, 0, 1, 1) == 0) {
            in_walls++;
            left += left_wall(&p, at);
            continue;
        }
        for (u32 axis = 0; axis < 3; axis++) {
            u32 ways[2], open, up, down;
            decode(texel(&p, at[0], at[1], at[2], axis * 2)[3], &ways[0], &ways[1], &open);
            // Both blocks of an axis tell the same ways.
            decode(texel(&p, at[0], at[1], at[2], axis * 2 + 1)[3], &up, &down, &open);
            assert_true(up == ways[0] && down == ways[1]);
            for (u32 side = 0; side < 2; side++) {
                f64 unit = 31.0 / 1.5 * voxel / spacing;
                f64 way = walk(&masks, place, axis, side ? -1 : 1, 1.6 * spacing / voxel) * unit;
                u32 least = (u32)MAX(way - unit / 32 - 1e-2, 1.0), most = (u32)(way + 1e-2);
                assert_in_range(ways[side], MIN(least, 31), CLAMP(most, 1, 31));
                near_walls += ways[side] < 31;
            }
        }
    }
    printf("%u probes: %u ways end at a wall; %u in walls, %u of them step out\n", p.count,
           near_walls, in_walls, left);
    assert_true(left > 0 && near_walls > p.count / 4);
    studio_close(&studio);
}

// --- Light ---

// Pictures by probes against cones from each pixel.
static void check_light(const char *level, const char *spacing, f64 ssim, f64 mean) {
    char list[256];
    Studio studio;
    RenderImage by_probes, by_cones;
    studio_open(&studio, level);
    const char *rest = "gi.enabled=on,gi.grid=32,gi.bounces=1,gi.specular=off,gi.ao=off,gi."
                       "resolution=full,gi.mips=linear";
    snprintf(list, sizeof list, "%s,gi.diffuse=probes,gi.probe_spacing=%s", rest, spacing);
    draw(&studio, list, &by_probes);
    snprintf(list, sizeof list, "%s,gi.diffuse=cones", rest);
    draw(&studio, list, &by_cones);
    ImageDifference d = image_compare(by_cones.rgba, by_probes.rgba, WIDTH, HEIGHT, &studio.images);
    printf("%s, probes %s m apart: ssim %.4f, mean %.2f, max %u, flip %.4f\n", level, spacing,
           d.ssim, d.mean, d.max, d.flip);
    assert_true(d.ssim >= ssim);
    assert_true(d.mean <= mean);
    studio_close(&studio);
}
TEST_GPU(gi_probes, light_as_by_cones) {
    check_light("data/levels/cornell.toml", "0.6", 0.97, 3.0);
    check_light("data/levels/light_box.toml", "0.6", 0.97, 3.0);
}

// --- Leaks ---

// Mean light that arrives at what a camera sees.
static f64 arriving(Studio *studio, const char *room, const char *eye, const char *list) {
    static u16 texels[WIDTH * HEIGHT * 4];
    char camera[64];
    RenderSettings settings = settings_default();
    assert_true(settings_set_list(&settings, list));
    snprintf(camera, sizeof camera, "%s/%s", room, eye);
    studio_draw(studio, camera, &settings, WIDTH, HEIGHT);
    assert_true(renderer_read_gi(studio->renderer, GI_VOLUME_DIFFUSE, texels, sizeof texels) ==
                sizeof texels);
    f64 sum = 0;
    for (u32 i = 0; i < WIDTH * HEIGHT; i++)
        for (u32 k = 0; k < 3; k++) {
            u16 half = texels[4 * i + k];
            sum += ldexp(half >> 10 ? half % 1024 + 1024 : half % 1024, MAX(half >> 10, 1) - 25);
        }
    return sum / (3.0 * WIDTH * HEIGHT);
}

// Sealed rooms in bright surroundings: what arrives inside over what arrives outside, for walls of
// half a voxel, one, two and three. The cones of the probes leak as all cones do; looking probes up
// must not add to it.
TEST_GPU(gi_probes, sealed_rooms) {
    static const char *const rooms[] = {"half", "one", "two", "three"};
    static const char *const ways[] = {"cones", "probes"};
    Studio studio;
    studio_open(&studio, "data/levels/sealed_room.toml");
    for (u32 r = 0; r < COUNT_OF(rooms); r++) {
        f64 leaks[2];
        for (u32 w = 0; w < 2; w++) {
            char list[256];
            snprintf(list, sizeof list,
                     "gi.diffuse=%s,gi.probe_spacing=1,gi.faces=apart,gi.resolution=full,gi.ao=off",
                     ways[w]);
            f64 outside = arriving(&studio, rooms[r], "out_left", list);
            leaks[w] = arriving(&studio, rooms[r], "in_a", list) / outside;
        }
        printf("walls of %s: cones %.3f %%, probes %.3f %%\n", rooms[r], 100 * leaks[0],
               100 * leaks[1]);
        assert_true(leaks[1] <= 1.5 * leaks[0] + 0.02);
    }
    studio_close(&studio);
}
