// bench_cpu.c: rows that need no GPU: culling, light grids, packets, loading.
// Data in: random arrays with a fixed seed, or a level. Data out: bench results.
#include "../engine/base/clock.h"
#include "../engine/base/random.h"
#include "../engine/systems/light_hierarchy.h"
#include "bench.h"
#include <stdio.h>
#include <string.h>

#define SEED 20240229u

// --- cull ---

#define CULL_COUNT   100000u
#define CULL_REPEATS 8

typedef struct Sphere {
    f32 x, y, z, radius;
} Sphere;
typedef struct CullData {
    Frustum frustum;
    f32 *columns[4]; // x y z radius
    Sphere *spheres; // the same
    u32 *out;
    u32 found;
} CullData;

static f64 cull_columns(void *context) {
    CullData *data = context;
    f64 start = clock_now_ms();
    for (u32 i = 0; i < CULL_REPEATS; i++)
        data->found = cull_spheres(&data->frustum, data->columns[0], data->columns[1],
                                   data->columns[2], data->columns[3], CULL_COUNT, data->out);
    return (clock_now_ms() - start) / CULL_REPEATS;
}

// How it is usually written: one sphere after the other, out at the first plane.
static f64 cull_naive(void *context) {
    CullData *data = context;
    f64 start = clock_now_ms();
    for (u32 repeat = 0; repeat < CULL_REPEATS; repeat++) {
        u32 found = 0;
        for (u32 i = 0; i < CULL_COUNT; i++) {
            const Sphere *s = &data->spheres[i];
            bool inside = s->radius >= 0.0f;
            for (u32 p = 0; p < data->frustum.count && inside; p++) {
                const f32 *plane = data->frustum.planes[p];
                inside =
                    plane[0] * s->x + plane[1] * s->y + plane[2] * s->z + plane[3] >= -s->radius;
            }
            if (inside) data->out[found++] = i;
        }
        data->found = found;
    }
    return (clock_now_ms() - start) / CULL_REPEATS;
}

bool bench_cull(Bench *bench, const char *id) {
    CullData data;
    for (u32 c = 0; c < 4; c++)
        data.columns[c] = ARENA_PUSH_COLUMN(&bench->arena, f32, CULL_COUNT + SIMD_WIDTH);
    data.spheres = ARENA_PUSH(&bench->arena, Sphere, CULL_COUNT);
    data.out = ARENA_PUSH_COLUMN(&bench->arena, u32, CULL_COUNT + SIMD_WIDTH);
    for (u32 i = 0; i < CULL_COUNT; i++) {
        Sphere *s = &data.spheres[i];
        s->x = data.columns[0][i] = random_range(SEED, 0, i, -100, 100);
        s->y = data.columns[1][i] = random_range(SEED, 1, i, -20, 20);
        s->z = data.columns[2][i] = random_range(SEED, 2, i, -100, 100);
        s->radius = data.columns[3][i] = random_range(SEED, 3, i, 0.1f, 3);
    }
    Mat4 projection = mat4_perspective_reversed(DEG_TO_RAD(60.0f), 16.0f / 9.0f, 0.1f);
    data.frustum = frustum_from_matrix(&projection);
    BenchVariant variants[] = {{"columns, 8 wide", cull_columns, &data, {0}},
                               {"naive loop over structs", cull_naive, &data, {0}}};
    bench_variants(bench, id, variants, COUNT_OF(variants), bench->quick ? 9 : 41);
    return true;
}

// --- grid ---

typedef struct GridLights {
    FrameRecord frame;
    LightRecord *lights;
    SpotRecord *spots;
} GridLights;

typedef enum GridWay { GRID_WAY_RECT, GRID_WAY_FRUSTUM, GRID_WAY_CLUSTERS, GRID_WAY_TREE } GridWay;
typedef struct GridData {
    const GridLights *lights;
    GridWay way;
    TileSize tile_px;
    Arena *arena;
} GridData;

// The whole step of a frame: from records to lists.
static f64 grid_build(void *context) {
    GridData *data = context;
    u64 mark = arena_mark(data->arena);
    RenderSettings settings = settings_default();
    settings.tile_px = data->tile_px;
    f64 start = clock_now_ms();
    LightGridInput input = light_grid_input(&data->lights->frame, data->lights->lights,
                                            data->lights->spots, &settings, data->arena);
    input.method = data->way == GRID_WAY_RECT ? GRID_RECT : GRID_FRUSTUM;
    if (data->way == GRID_WAY_CLUSTERS)
        input.slices = light_cluster_slices(&input, CLUSTER_CELLS_CAP);
    if (data->way == GRID_WAY_TREE)
        light_hierarchy_build(&input, data->arena);
    else
        light_grid_build(&input, data->arena);
    f64 ms = clock_now_ms() - start;
    arena_rewind(data->arena, mark);
    return ms;
}

// Lights spread over the view volume up to 40 m, half a metre to three metres large; a quarter of
// them spots of 10 to 60 degrees to either side. The camera stands in the origin and looks down -z.
static void grid_fill(GridLights *out, u32 count, Arena *arena) {
    f32 tan_y = det_tan(DEG_TO_RAD(30.0f)), tan_x = tan_y * 1280.0f / 720.0f;
    Mat4 view = mat4_identity();
    memcpy(out->frame.view, view.m, sizeof out->frame.view);
    out->frame.camera[3] = 0.1f;
    out->frame.ray_right[0] = tan_x;
    out->frame.ray_up[1] = tan_y;
    out->frame.viewport[0] = 1280, out->frame.viewport[1] = 720;
    u32 points = count - count / 4;
    out->frame.counts[0] = out->frame.counts3[0] = points;
    out->frame.counts[1] = out->frame.counts3[1] = count - points;
    out->lights = ARENA_PUSH(arena, LightRecord, count);
    out->spots = ARENA_PUSH(arena, SpotRecord, count - points);
    for (u32 i = 0; i < count; i++) {
        f32 depth = random_range(SEED, 2, i, 0.5f, 40), range = random_range(SEED, 3, i, 0.5f, 3);
        f32 *at = out->lights[i].position;
        at[0] = random_range(SEED, 0, i, -1, 1) * depth * tan_x;
        at[1] = random_range(SEED, 1, i, -1, 1) * depth * tan_y;
        at[2] = -depth;
        at[3] = 1.0f / (range * range);
        if (i < points) continue;
        Vec3 way =
            vec3_normalize(vec3(random_range(SEED, 4, i, -1, 1), random_range(SEED, 5, i, -1, 1),
                                random_range(SEED, 6, i, -1, 1)));
        f32 *direction = out->spots[i - points].direction;
        direction[0] = way.x, direction[1] = way.y, direction[2] = way.z;
        direction[3] = det_cos(DEG_TO_RAD(random_range(SEED, 7, i, 10, 60)));
    }
}

bool bench_grid(Bench *bench, const char *id) {
    GridLights few = {0}, many = {0};
    grid_fill(&few, 1000, &bench->arena);
    grid_fill(&many, 10000, &bench->arena);
#define ROW(lights, way, tile) &(GridData){&lights, GRID_WAY_##way, tile, &bench->arena}
    BenchVariant variants[] = {
        {"1,000 lights, rectangles", grid_build, ROW(few, RECT, TILE_16), {0}},
        {"1,000 lights, frustums", grid_build, ROW(few, FRUSTUM, TILE_16), {0}},
        {"1,000 lights, clusters of 32 px", grid_build, ROW(few, CLUSTERS, TILE_32), {0}},
        {"1,000 lights, clusters of 64 px", grid_build, ROW(few, CLUSTERS, TILE_64), {0}},
        {"10,000 lights, rectangles", grid_build, ROW(many, RECT, TILE_16), {0}},
        {"10,000 lights, frustums", grid_build, ROW(many, FRUSTUM, TILE_16), {0}},
        {"10,000 lights, clusters of 32 px", grid_build, ROW(many, CLUSTERS, TILE_32), {0}},
        {"10,000 lights, clusters of 64 px", grid_build, ROW(many, CLUSTERS, TILE_64), {0}},
        {"10,000 lights, hierarchy", grid_build, ROW(many, TREE, TILE_32), {0}},
    };
#undef ROW
    bench_variants(bench, id, variants, COUNT_OF(variants), bench->quick ? 9 : 41);
    return true;
}

// --- packet ---

bool bench_packet(Bench *bench, const char *id) {
    Session session;
    if (!session_create(&session, tool_session())) return false;
    bool ok = headless_load(&session, bench_level(bench, BENCH_LEVEL), &bench->common);
    enum { TICK, WHOLE, CULL, LIGHTS, GRID, PACK, PARTS };
    static const char *const names[PARTS] = {"one tick",           "packet",
                                             "packet: culling",    "packet: lights",
                                             "packet: light grid", "packet: packing"};
    Samples samples[PARTS] = {0};
    if (ok) {
        SessionView view = {.camera = headless_camera(&session, NULL),
                            .settings = settings_default(),
                            .width_px = 640,
                            .height_px = 360};
        u32 rounds = bench->quick ? 30 : 300;
        for (u32 i = 0; ok && i < rounds; i++) {
            session_tick(&session, (Input){0});
            session_frame_begin(&session);
            f64 start = clock_now_ms();
            ok = session_packet(&session, &view) != NULL;
            f64 ms = clock_now_ms() - start;
            const PacketBuildTimes *times = &session.packet_times;
            const f64 values[PARTS] = {(f64)session.tick_ms, ms,
                                       (f64)times->cull_ms,  (f64)times->lights_ms,
                                       (f64)times->grid_ms,  (f64)times->pack_ms};
            for (u32 p = 0; p < PARTS; p++) samples_add(&samples[p], values[p]);
        }
        for (u32 p = 0; p < PARTS; p++) bench_add(bench, id, names[p], &samples[p], "ms", 0.0);
    }
    for (u32 p = 0; p < PARTS; p++) samples_free(&samples[p]);
    session_destroy(&session);
    return ok;
}

// --- level_load ---

bool bench_level_load(Bench *bench, const char *id) {
    Samples samples = {0};
    bool ok = true;
    for (u32 i = 0; ok && i < (bench->quick ? 2u : 7u); i++) {
        Session session;
        if (!session_create(&session, tool_session())) return false;
        f64 start = clock_now_ms();
        ok = session_load(&session, bench_level(bench, BENCH_LEVEL));
        samples_add(&samples, clock_now_ms() - start);
        if (!ok) diagnostics_print(session.diagnostics, stderr);
        session_destroy(&session);
    }
    if (ok) bench_add(bench, id, bench_level(bench, BENCH_LEVEL), &samples, "ms", 0.0);
    samples_free(&samples);
    return ok;
}
