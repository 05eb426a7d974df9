// bench_cpu.c: rows that need no GPU: culling, light grids, packets, loading.
// Data in: random arrays with a fixed seed, or a level. Data out: bench results.
#include "../engine/base/clock.h"
#include "../engine/base/random.h"
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

typedef struct GridData {
    LightGridInput input;
    Arena *arena;
} GridData;

static f64 grid_build(void *context) {
    GridData *data = context;
    u64 mark = arena_mark(data->arena);
    f64 start = clock_now_ms();
    light_grid_build(&data->input, data->arena);
    f64 ms = clock_now_ms() - start;
    arena_rewind(data->arena, mark);
    return ms;
}

// Lights spread over the view volume up to 40 m, half a metre to three metres large.
static void grid_fill(GridData *data, u32 count, Arena *arena) {
    f32 *columns[4];
    for (u32 c = 0; c < 4; c++) columns[c] = ARENA_PUSH_COLUMN(arena, f32, count + SIMD_WIDTH);
    f32 tan_y = det_tan(DEG_TO_RAD(30.0f)), aspect = 1280.0f / 720.0f;
    for (u32 i = 0; i < count; i++) {
        f32 z = random_range(SEED, 2, i, -40, -0.5f);
        columns[0][i] = random_range(SEED, 0, i, -1, 1) * -z * tan_y * aspect;
        columns[1][i] = random_range(SEED, 1, i, -1, 1) * -z * tan_y;
        columns[2][i] = z;
        columns[3][i] = random_range(SEED, 3, i, 0.5f, 3);
    }
    data->arena = arena;
    data->input = (LightGridInput){.x = columns[0],
                                   .y = columns[1],
                                   .z = columns[2],
                                   .radius = columns[3],
                                   .count = count,
                                   .point_count = count,
                                   .width_px = 1280,
                                   .height_px = 720,
                                   .tile_px = 16,
                                   .near = 0.1f,
                                   .scale_x = 1.0f / (tan_y * aspect),
                                   .scale_y = 1.0f / tan_y};
}

bool bench_grid(Bench *bench, const char *id) {
    GridData data[2];
    grid_fill(&data[0], 1000, &bench->arena);
    grid_fill(&data[1], 10000, &bench->arena);
    BenchVariant variants[] = {{"1,000 lights", grid_build, &data[0], {0}},
                               {"10,000 lights", grid_build, &data[1], {0}}};
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
