// post.c: each step of the post chain alone, on pictures.
#include "studio.h"
#include "../../engine/capture/image_compare.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH  192
#define HEIGHT 108

// A step at a place of the world; the row, for its numbers.
static u32 add_post(Studio *studio, u32 kind, i32 order, f32 x, f32 y, f32 z) {
    World *world = studio->session.world;
    Entity entity = world_spawn(world);
    TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    u32 place = table_add(&transforms->table, entity);
    transforms->x[place] = x, transforms->y[place] = y, transforms->z[place] = z;
    PostTable *posts = WORLD_TABLE(world, Post, post);
    u32 row = table_add(&posts->table, entity);
    posts->kind[row] = kind;
    posts->order[row] = order;
    return row;
}

static PostTable *posts_of(Studio *studio) {
    return WORLD_TABLE(studio->session.world, Post, post);
}

static RenderImage draw(Studio *studio, const char *changes) {
    RenderSettings settings = studio_direct_light(); // draws are counted
    if (changes) assert_true(settings_set_list(&settings, changes));
    return studio_draw(studio, "main", &settings, WIDTH, HEIGHT);
}

// Off is as without; nothing costs a pass when it is absent; the picture of a chain of tone mapping
// and gamma alone is the picture of no chain.
TEST_GPU(golden, post_off_is_as_without) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    session_advance(&studio.session, 3);
    RenderImage without = draw(&studio, NULL);
    u32 draws = renderer_stats(studio.renderer).draw_calls;
    add_post(&studio, POST_TONEMAP, 0, 0, 0, 0);
    add_post(&studio, POST_GAMMA, 0, 0, 0, 0);
    RenderImage plain = draw(&studio, NULL);
    assert_true(plain.hash == without.hash);
    assert_int_equal(renderer_stats(studio.renderer).draw_calls, draws);
    u32 fog = add_post(&studio, POST_FOG, 0, 0, 0, 0);
    posts_of(&studio)->density[fog] = 0.3f;
    assert_true(draw(&studio, NULL).hash != without.hash);
    assert_true(draw(&studio, "post=off").hash == without.hash);
    assert_int_equal(renderer_stats(studio.renderer).draw_calls, draws);
    posts_of(&studio)->density[fog] = 0.0f;
    assert_true(draw(&studio, NULL).hash == without.hash);
    assert_int_equal(renderer_stats(studio.renderer).draw_calls, draws);
    studio_close(&studio);
}

// The naive twin of post_fog.frag: the density summed up in small steps along the ray.
static f64 fog_opacity(const FrameRecord *frame, f64 ndc_x, f64 ndc_y, f64 depth, const f32 *v) {
    f64 ray[3], square = 0;
    for (u32 i = 0; i < 3; i++) {
        ray[i] = (f64)frame->ray_right[i] * ndc_x + (f64)frame->ray_up[i] * ndc_y +
                 (f64)frame->ray_forward[i];
        square += ray[i] * ray[i];
    }
    f64 length = sqrt(square), far = depth > 0 ? length * (f64)frame->camera[3] / depth : 2000;
    const u32 steps = 20000;
    f64 sum = 0, step = (far - (f64)v[4]) / steps;
    for (u32 i = 0; i < steps && step > 0; i++) {
        f64 t = (f64)v[4] + (i + 0.5) * step;
        f64 y = (f64)frame->camera[1] + ray[1] / length * t - (f64)v[5];
        sum += (v[6] > 0 && y > 0 ? exp(-(f64)v[6] * y) : 1.0) * step;
    }
    return 1.0 - exp(-(f64)v[3] * sum);
}

// A black level in white fog shows the fog's opacity, which is compared with the sum.
static void check_fog(f32 density, f32 start, f32 height, f32 falloff) {
    Studio studio;
    studio_open(&studio, "data/levels/plane_test.toml");
    u32 row = add_post(&studio, POST_FOG, 0, 0, 0, 0);
    PostTable *posts = posts_of(&studio);
    posts->color_r[row] = posts->color_g[row] = posts->color_b[row] = 1.0f;
    posts->density[row] = density, posts->start[row] = start;
    posts->height[row] = height, posts->falloff[row] = falloff;
    // Nothing emits, nothing is lit; a linear picture.
    MaterialTable *materials = WORLD_TABLE(studio.session.world, Material, material);
    for (u32 i = 0; i < materials->table.count; i++) materials->emissive_strength[i] = 0;
    EnvironmentTable *e = WORLD_TABLE(studio.session.world, Environment, environment);
    u32 one = world_singleton(studio.session.world, COMPONENT_environment);
    e->ambient_intensity[one] = 0;
    e->sky_zenith_r[one] = e->sky_zenith_g[one] = e->sky_zenith_b[one] = 0;
    e->sky_horizon_r[one] = e->sky_horizon_g[one] = e->sky_horizon_b[one] = 0;
    e->stars[one] = 0, e->exposure[one] = 1;
    u32 gamma = add_post(&studio, POST_GAMMA, 0, 0, 0, 0);
    posts_of(&studio)->gamma[gamma] = 1.0f;
    RenderImage fog = draw(&studio, "forward,light_gain=0,tonemap=off");
    // Depth from the debug view: 1 / (1 + 0.15 z), 8 bits; so only far from edges and with slack.
    session_frame_begin(&studio.session);
    SessionView view = {
        .camera = "main", .settings = settings_default(), .width_px = WIDTH, .height_px = HEIGHT};
    const Packet *packet = session_packet(&studio.session, &view);
    FrameRecord frame = packet->frame;
    const f32 v[7] = {1, 1, 1, density, start, height, falloff};
    RenderImage depth = draw(&studio, "view=depth");
    u32 checked = 0;
    f64 worst = 0;
    for (u32 y = 30; y < HEIGHT; y += 7)
        for (u32 x = 3; x < WIDTH; x += 11) {
            f64 d = depth.rgba[(y * WIDTH + x) * 4] / 255.0;
            if (d < 0.1) continue; // far: too few steps of depth
            f64 near_by_depth[2];
            f64 got = fog.rgba[(y * WIDTH + x) * 4] / 255.0;
            for (u32 k = 0; k < 2; k++) { // half a step of the coded depth to each side
                f64 z = (1.0 / (d + (k ? -0.6 : 0.6) / 255.0) - 1.0) / 0.15;
                near_by_depth[k] =
                    fog_opacity(&frame, (x + 0.5) / WIDTH * 2 - 1, 1 - (y + 0.5) / HEIGHT * 2,
                                (f64)frame.camera[3] / z, v);
            }
            f64 low = near_by_depth[0] - 2.5 / 255, high = near_by_depth[1] + 2.5 / 255;
            f64 off = got < low ? low - got : got > high ? got - high : 0;
            worst = MAX(worst, off);
            checked++;
        }
    printf("    fog %g %g %g %g: %u pixels, worst %.4f beyond the bounds\n", (f64)density,
           (f64)start, (f64)height, (f64)falloff, checked, worst);
    assert_true(checked > 50);
    assert_true(worst == 0.0);
    studio_close(&studio);
}
TEST_GPU(golden, post_fog_by_distance) { check_fog(0.08f, 0, 0, 0); }
TEST_GPU(golden, post_fog_from_a_start) { check_fog(0.15f, 6, 0, 0); }
TEST_GPU(golden, post_fog_that_thins_out) { check_fog(0.2f, 0, 0.3f, 0.8f); }
TEST_GPU(golden, post_fog_below_and_above) { check_fog(0.1f, 2, 1.5f, 2.0f); }

// Heat moves only pixels within its reach, and none whose surface lies before it.
TEST_GPU(golden, post_heat_stays_in_its_sphere) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    session_advance(&studio.session, 10);
    session_frame_begin(&studio.session);
    SessionView view = {
        .camera = "main", .settings = settings_default(), .width_px = WIDTH, .height_px = HEIGHT};
    const Packet *packet = session_packet(&studio.session, &view);
    // 60 % of the way to what the middle of the picture shows, 0.25 m.
    FrameRecord frame = packet->frame;
    f32 way = 2.0f, center[3];
    for (u32 i = 0; i < 3; i++) center[i] = frame.camera[i] + frame.ray_forward[i] * way;
    u32 row = add_post(&studio, POST_HEAT, 0, center[0], center[1], center[2]);
    PostTable *posts = posts_of(&studio);
    session_advance(&studio.session, 1); // world matrices
    posts->reach[row] = 0.25f, posts->amount[row] = 30, posts->scale[row] = 3;
    RenderImage off = draw(&studio, "post=off"), on = draw(&studio, NULL);
    f32 tangent = 0.25f / sqrtf(way * way - 0.25f * 0.25f); // of the angle that the sphere fills
    f32 up = sqrtf(frame.ray_up[0] * frame.ray_up[0] + frame.ray_up[1] * frame.ray_up[1] +
                   frame.ray_up[2] * frame.ray_up[2]);
    f32 radius_px = tangent / up * HEIGHT / 2;
    u32 inside = 0, outside = 0;
    for (u32 y = 0; y < HEIGHT; y++)
        for (u32 x = 0; x < WIDTH; x++) {
            if (memcmp(&off.rgba[(y * WIDTH + x) * 4], &on.rgba[(y * WIDTH + x) * 4], 4) == 0)
                continue;
            f32 dx = (f32)x + 0.5f - WIDTH / 2, dy = (f32)y + 0.5f - HEIGHT / 2;
            bool within = sqrtf(dx * dx + dy * dy) <= radius_px + 0.5f;
            inside += within, outside += !within;
        }
    printf("    heat: radius %.1f px, %u pixels inside changed, %u outside\n", (f64)radius_px,
           inside, outside);
    assert_true(inside > 20);
    assert_int_equal(outside, 0);
    // The same picture twice, and in every path.
    assert_true(draw(&studio, NULL).hash == on.hash);
    for (u32 path = 0; path < PATH_COUNT; path++) {
        RenderSettings settings = studio_direct_light();
        settings.path = path;
        RenderImage other = studio_draw(&studio, "main", &settings, WIDTH, HEIGHT);
        ImageDifference d = image_compare(on.rgba, other.rgba, WIDTH, HEIGHT, &studio.images);
        assert_in_range(d.max, 0, 3);
    }
    // Behind everything: nothing moves.
    TransformTable *transforms = WORLD_TABLE(studio.session.world, Transform, transform);
    u32 place = table_row(&transforms->table, posts->table.entity[row]);
    for (u32 i = 0; i < 3; i++) center[i] = frame.camera[i] + frame.ray_forward[i] * 500.0f;
    transforms->x[place] = center[0], transforms->y[place] = center[1];
    transforms->z[place] = center[2];
    posts->reach[row] = 40;
    table_touch(&transforms->table, place);
    session_advance(&studio.session, 1);
    assert_true(draw(&studio, NULL).hash == draw(&studio, "post=off").hash);
    studio_close(&studio);
}

// Fog then heat is another picture than heat then fog would be, if the fog has structure; and the
// order column decides, not the sequence of rows.
TEST_GPU(golden, post_order) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    u32 blue = add_post(&studio, POST_FOG, 1, 0, 0, 0),
        red = add_post(&studio, POST_FOG, 2, 0, 0, 0);
    PostTable *posts = posts_of(&studio);
    posts->density[blue] = posts->density[red] = 0.4f;
    posts->color_r[blue] = posts->color_g[blue] = 0, posts->color_b[blue] = 1;
    posts->color_b[red] = posts->color_g[red] = 0, posts->color_r[red] = 1;
    RenderImage red_last = draw(&studio, NULL);
    posts->order[red] = 0;
    RenderImage blue_last = draw(&studio, NULL);
    u64 sums[2][2] = {{0}};
    for (u32 i = 0; i < WIDTH * HEIGHT; i++) {
        sums[0][0] += red_last.rgba[i * 4], sums[0][1] += red_last.rgba[i * 4 + 2];
        sums[1][0] += blue_last.rgba[i * 4], sums[1][1] += blue_last.rgba[i * 4 + 2];
    }
    assert_true(sums[0][0] > sums[1][0]); // more red when red came last
    assert_true(sums[0][1] < sums[1][1]);
    studio_close(&studio);
}

// An exponent instead of the sRGB curve.
TEST_GPU(golden, post_gamma_exponent) {
    Studio studio;
    studio_open(&studio, "data/levels/cornell.toml");
    u32 row = add_post(&studio, POST_GAMMA, 0, 0, 0, 0);
    RenderImage srgb = draw(&studio, NULL);
    posts_of(&studio)->gamma[row] = 2.2f;
    RenderImage power = draw(&studio, NULL);
    ImageDifference d = image_compare(srgb.rgba, power.rgba, WIDTH, HEIGHT, &studio.images);
    assert_in_range(d.max, 1, 12); // the two curves are near each other
    posts_of(&studio)->gamma[row] = 1.0f;
    RenderImage linear = draw(&studio, NULL);
    for (u32 i = 0; i < WIDTH * HEIGHT; i += 37)
        for (u32 k = 0; k < 3; k++) {
            f64 expected = pow(power.rgba[i * 4 + k] / 255.0, 2.2) * 255.0;
            assert_true(fabs(expected - linear.rgba[i * 4 + k]) < 2.5);
        }
    studio_close(&studio);
}
