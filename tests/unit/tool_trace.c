// tool_trace.c: tests of the path tracer: against sums that can be done by hand, and its hierarchy
// against a plain loop.
#include "../test.h"
#include "../../engine/base/jobs.h"
#include "../../engine/base/random.h"
#include "../../engine/luz.h"
#include "../../tools/reference_draw.c"
#include "../../tools/trace_path.c"
#include "../../tools/trace_scene.c"
#include "../../tools/trace_surface.c"
#include <string.h>

#define SIDE 8 // px

typedef struct Room {
    Shape shape;
    f32 albedo, emission, lamp_cd, size;
    bool inverted, has_blocker;
} Room;

// A closed shape about the camera, or a floor below it; a lamp in the middle.
static bool fill(World *world, AssetStore *assets, void *user) {
    const Room *room = user;
    ShapeDesc shape = {.shape = room->shape, .segments = 96, .inverted = room->inverted};
    bool flat = room->shape == SHAPE_PLANE;
    Entity walls = luz_add_shape(world, assets, "walls", &shape, vec3(0, flat ? -1 : 0, 0),
                                 vec3(room->size, flat ? 1 : room->size, room->size),
                                 vec3(room->albedo, room->albedo, room->albedo));
    MaterialTable *m = WORLD_TABLE(world, Material, material);
    for (u32 i = 0; i < m->table.count; i++) {
        m->brdf[i] = BRDF_LAMBERT;
        m->specular_r[i] = m->specular_g[i] = m->specular_b[i] = 0.0f;
        m->emissive_r[i] = m->emissive_g[i] = m->emissive_b[i] = 1.0f;
        m->emissive_strength[i] = room->emission;
    }
    if (room->lamp_cd > 0.0f) {
        Entity lamp =
            luz_add_light(world, "lamp", vec3(0, flat ? 1 : 0, 0), vec3(1, 1, 1), room->lamp_cd);
        LightTable *lights = WORLD_TABLE(world, Light, light);
        lights->range[table_row(&lights->table, lamp)] = 1e4f;
    }
    if (room->has_blocker)
        luz_add_shape(world, assets, "blocker", &(ShapeDesc){.shape = SHAPE_CUBE}, vec3(0, 0.6f, 0),
                      vec3(0.2f, 0.1f, 0.2f), vec3(0, 0, 0));
    // Not in the middle, where the lamp is.
    luz_add_camera(world, "main", vec3(0, 0.2f, 0.4f), 0, flat ? -89.9f : 0);
    EnvironmentTable *e = WORLD_TABLE(world, Environment, environment);
    u32 row = world_singleton(world, COMPONENT_environment);
    e->ambient_r[row] = e->ambient_g[row] = e->ambient_b[row] = 0.0f;
    return walls != ENTITY_NONE;
}

typedef struct Fixture {
    Session session;
    Arena arena;
    const Packet *packet;
    TraceScene scene;
} Fixture;

static void open_room(Fixture *f, Room *room) {
    memset(f, 0, sizeof *f);
    assert_true(arena_create(&f->arena, "trace", GIB(1)));
    assert_true(session_create(&f->session, &(SessionDesc){0}));
    assert_true(session_fill(&f->session, fill, room));
    session_frame_begin(&f->session);
    SessionView view = {
        .camera = "main", .settings = settings_default(), .width_px = SIDE, .height_px = SIDE};
    reference_settings(&view.settings);
    f->packet = session_packet(&f->session, &view);
    assert_non_null(f->packet);
    assert_true(trace_scene_create(&f->scene, f->packet, &f->session.assets,
                                   reference_flags(f->session.world, f->packet, &f->arena),
                                   &f->arena));
}

static void close_room(Fixture *f) {
    session_destroy(&f->session);
    arena_destroy(&f->arena);
}

static void draw_room(Fixture *f, const TraceOptions *options, f32 rgb[SIDE * SIDE * 3]) {
    trace_picture(&f->scene, options, rgb, &f->arena, NULL, NULL);
}

static f64 mean(const f32 rgb[SIDE * SIDE * 3]) {
    f64 sum = 0.0;
    for (u32 i = 0; i < SIDE * SIDE * 3; i++) sum += (f64)rgb[i];
    return sum / (SIDE * SIDE * 3);
}

// A closed box whose walls shine evenly: every bounce adds the same light times the albedo.
TEST(tool_trace, furnace_sums_up_the_bounces) {
    Room room = {.shape = SHAPE_CUBE, .albedo = 0.5f, .emission = 1, .size = 4, .inverted = true};
    static const u32 bounces[] = {0, 1, 2, 6};
    Fixture f;
    open_room(&f, &room);
    for (u32 i = 0; i < COUNT_OF(bounces); i++) {
        f32 rgb[SIDE * SIDE * 3];
        TraceOptions options = TRACE_OPTIONS_DEFAULT;
        options.bounces = bounces[i];
        options.samples = 256;
        draw_room(&f, &options, rgb);
        f64 expected = (1.0 - pow(0.5, bounces[i] + 1.0)) / (1.0 - 0.5);
        ASSERT_NEAR(mean(rgb), expected, bounces[i] ? 0.01 * expected : 1e-6);
    }
    close_room(&f);
}

// A lamp in the middle of a sphere: indirect light is the same everywhere, and all light is taken
// in the end: L = albedo / pi * I / r^2 / (1 - albedo).
TEST(tool_trace, lamp_in_a_sphere_keeps_its_energy) {
    Room room = {.shape = SHAPE_SPHERE, .albedo = 0.6f, .lamp_cd = 5, .size = 6, .inverted = true};
    Fixture f;
    open_room(&f, &room);
    f32 rgb[SIDE * SIDE * 3];
    TraceOptions options = TRACE_OPTIONS_DEFAULT;
    options.bounces = 24;
    options.samples = 256;
    for (u32 shadows = 0; shadows < TRACE_SHADOWS_COUNT; shadows++) {
        options.shadows = (TraceShadows)shadows;
        draw_room(&f, &options, rgb);
        f64 direct = 0.6 / (f64)PI_F * 5.0 / 9.0;
        ASSERT_NEAR(mean(rgb), direct / (1.0 - 0.6), 0.015 * direct / 0.4);
    }
    options.bounces = 0;
    options.samples = 1;
    draw_room(&f, &options, rgb);
    ASSERT_NEAR(mean(rgb), 0.6 / (f64)PI_F * 5.0 / 9.0, 2e-3); // flat faces lie a little nearer
    close_room(&f);
}

TEST(tool_trace, shadows_only_where_asked) {
    Room room = {
        .shape = SHAPE_PLANE, .albedo = 0.8f, .lamp_cd = 3, .size = 20, .has_blocker = true};
    Fixture f;
    open_room(&f, &room);
    f32 rgb[SIDE * SIDE * 3];
    f64 means[TRACE_SHADOWS_COUNT];
    TraceOptions options = TRACE_OPTIONS_DEFAULT;
    options.bounces = 0;
    options.samples = 4;
    for (u32 shadows = 0; shadows < TRACE_SHADOWS_COUNT; shadows++) {
        options.shadows = (TraceShadows)shadows;
        draw_room(&f, &options, rgb);
        means[shadows] = mean(rgb);
    }
    // The level's point lights have no shadow maps.
    assert_true(means[TRACE_SHADOWS_LEVEL] == means[TRACE_SHADOWS_NONE]);
    assert_true(means[TRACE_SHADOWS_ALL] < 0.9 * means[TRACE_SHADOWS_NONE]);
    close_room(&f);
}

TEST(tool_trace, same_bits_with_any_number_of_threads) {
    Room room = {.shape = SHAPE_CUBE,
                 .albedo = 0.7f,
                 .emission = 0.2f,
                 .lamp_cd = 2,
                 .size = 4,
                 .inverted = true};
    f32 rgb[2][SIDE * SIDE * 3];
    for (u32 run = 0; run < 2; run++) {
        jobs_start(1 + 2 * run);
        Fixture f;
        open_room(&f, &room);
        TraceOptions options = TRACE_OPTIONS_DEFAULT;
        options.samples = 8;
        options.smooth = true;
        options.shadows = TRACE_SHADOWS_ALL;
        draw_room(&f, &options, rgb[run]);
        close_room(&f);
        jobs_stop();
    }
    assert_memory_equal(rgb[0], rgb[1], sizeof rgb[0]);
}

// Every triangle in turn.
static f32 nearest_plainly(const TraceScene *scene, Vec3 from, Vec3 to) {
    f32 best = 1e30f;
    for (u32 i = 0; i < scene->triangle_count; i++) {
        const TraceTriangle *t = &scene->triangles[i];
        Vec3 corner = {t->corner[0], t->corner[1], t->corner[2]};
        Vec3 a = {t->edge1[0], t->edge1[1], t->edge1[2]},
             b = {t->edge2[0], t->edge2[1], t->edge2[2]};
        Vec3 n = vec3_cross(a, b);
        f32 slope = vec3_dot(n, to);
        if (slope == 0.0f) continue;
        f32 along = vec3_dot(n, vec3_sub(corner, from)) / slope;
        Vec3 p = vec3_sub(vec3_add(from, vec3_scale(to, along)), corner);
        f32 area2 = vec3_dot(n, n), u = vec3_dot(vec3_cross(p, b), n) / area2,
            v = vec3_dot(vec3_cross(a, p), n) / area2;
        if (along > 0.0f && along < best && u >= -1e-5f && v >= -1e-5f && u + v <= 1.00001f)
            best = along;
    }
    return best;
}

TEST(tool_trace, hierarchy_finds_what_a_plain_loop_finds) {
    Room room = {.shape = SHAPE_TORUS, .albedo = 0.5f, .size = 3, .has_blocker = true};
    Fixture f;
    open_room(&f, &room);
    assert_true(f.scene.triangle_count > 4000 && f.scene.node_count > 1000);
    u32 hits = 0;
    for (u32 i = 0; i < 1000; i++) {
        f32 r[6];
        for (u32 k = 0; k < 6; k++) r[k] = random_range(7, i, k, -2.0f, 2.0f);
        Vec3 from = {r[0], r[1], r[2]}, to = vec3_sub(vec3(r[3], r[4], r[5]), from);
        TraceHit hit = trace_nearest(&f.scene, from, to, 1e30f, TRACE_BOUNCES);
        f32 expected = nearest_plainly(&f.scene, from, to);
        bool met = hit.triangle != UINT32_MAX;
        assert_int_equal(met, expected < 1e30f);
        assert_int_equal(met, trace_blocked(&f.scene, from, to, 1e30f, TRACE_BOUNCES));
        if (met) ASSERT_NEAR(hit.t, expected, 1e-4 * (f64)expected + 1e-5);
        hits += met;
    }
    assert_in_range(hits, 100, 900);
    close_room(&f);
}

TEST(tool_trace, encodes_as_the_engine_does) {
    Room room = {.shape = SHAPE_PLANE, .albedo = 0.5f, .size = 1};
    Fixture f;
    open_room(&f, &room);
    f32 rgb[SIDE * SIDE * 3];
    u8 rgba[SIDE * SIDE * 4];
    for (u32 i = 0; i < SIDE * SIDE * 3; i++) rgb[i] = 1.0f;
    trace_encode(f.packet, rgb, rgba);
    // Reinhard: 1 -> 0.5; sRGB of it is 187.5, with half a step of dither either way.
    for (u32 i = 0; i < SIDE * SIDE; i++) {
        assert_in_range(rgba[4 * i], 187, 188);
        assert_int_equal(rgba[4 * i + 3], 255);
    }
    close_room(&f);
}
