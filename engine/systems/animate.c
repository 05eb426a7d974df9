// animate.c: movement and flicker that hang on nothing but the tick.
// Data in: orbit, path, flicker, pulse; the world's tick and seed. Data out: transform.offset_* and
// light.gain, computed anew each tick from 0 and 1: offsets add up, gains multiply. Called by: the
// system table, first. Does not: integrate anything, so any tick can be computed without those
// before it, and errors do not grow in a world that runs for days.
//
// Each entity has its own random numbers (stream = entity), so a hundred fireflies with the same
// columns fly a hundred different curves.
#include "systems.h"
#include "../base/jobs.h"
#include "../base/random.h"
#include <math.h>
#include <string.h>

#define ROWS_PER_JOB 512

// ---- time ----

// Where in its period an animation is, in [0, 1). The remainder tick mod period is exact, however
// late it is: a period has 24 bits (28 in ticks) and a quotient 32, so the quotient is taken off in
// two halves whose products fit the 53 bits of a double; both differences are then exact as well.
static f64 phase_at(u32 tick, f32 period_s, f32 phase_deg) {
    f64 period = (f64)period_s * TICK_RATE, time = tick;
    if (!(period > 0.0)) return 0.0;
    u64 rounds = (u64)(time / period);
    time -= (f64)(rounds & ~0xFFFFull) * period;
    time -= (f64)(rounds & 0xFFFFull) * period;
    // The rounded quotient may be one too large or too small.
    if (time < 0.0) time += period;
    if (time >= period) time -= period;
    f64 phase = time / period + (f64)phase_deg / 360.0;
    phase -= floor(phase);
    return phase < 1.0 ? phase : 0.0; // a tiny negative phase rounds up to 1
}

// ---- movement ----

typedef struct Offsets {
    f32 *x, *y, *z; // [transform rows]
} Offsets;

typedef struct MoveJob {
    const World *world;
    const TransformTable *transforms;
    Offsets out;
    const Vec2 *circle; // [CIRCLE_STEPS] cosine, sine
} MoveJob;

// A closed curve that does not look like one: per axis three sine waves, whose frequencies are
// whole multiples of the round and whose shifts are the entity's own. The shares add up to 1, so it
// stays in the box of the half-axes.
#define WAVES        3
#define CIRCLE_STEPS 256 // shifts are a random number's byte
static const u32 wave_frequency[3][WAVES] = {{1, 2, 5}, {1, 3, 4}, {1, 2, 3}};
static const f32 wave_share[3][WAVES] = {
    {0.62f, 0.26f, 0.12f}, {0.55f, 0.3f, 0.15f}, {0.62f, 0.26f, 0.12f}};
#define FREQUENCY_TOP 5

static void job_orbit(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const MoveJob *job = context;
    const OrbitTable *orbit = WORLD_TABLE(job->world, Orbit, orbit);
    for (u32 i = begin; i < end; i++) {
        Entity entity = orbit->table.entity[i];
        u32 row = table_row(&job->transforms->table, entity);
        if (row == ROW_NONE) continue;
        f32 angle =
            (f32)(phase_at(job->world->tick, orbit->period[i], orbit->phase[i]) * (2.0 * PI_F));
        // Sine and cosine of the multiples by the addition theorem: one det_sin for nine waves.
        f32 c[FREQUENCY_TOP + 1] = {1.0f, det_cos(angle)},
                              s[FREQUENCY_TOP + 1] = {0.0f, det_sin(angle)};
        for (u32 k = 2; k <= FREQUENCY_TOP; k++) {
            c[k] = c[k - 1] * c[1] - s[k - 1] * s[1];
            s[k] = s[k - 1] * c[1] + c[k - 1] * s[1];
        }
        u64 shifts = random_u64(job->world->seed, entity, 0);
        u64 more_shifts = random_u64(job->world->seed, entity, 1);
        f32 axis[3] = {0, 0, 0};
        for (u32 k = 0; k < 3 * WAVES; k++) {
            u32 a = k / WAVES, wave = k % WAVES, frequency = wave_frequency[a][wave];
            Vec2 shift = job->circle[k < 8 ? (shifts >> (8 * k)) & 255 : more_shifts & 255];
            axis[a] += wave_share[a][wave] * (s[frequency] * shift.x + c[frequency] * shift.y);
        }
        job->out.x[row] += orbit->radius_x[i] * CLAMP(axis[0], -1.0f, 1.0f);
        job->out.y[row] += orbit->radius_y[i] * CLAMP(axis[1], -1.0f, 1.0f);
        job->out.z[row] += orbit->radius_z[i] * CLAMP(axis[2], -1.0f, 1.0f);
    }
}

// Uniform Catmull-Rom spline (Catmull and Rom 1974), closed: it passes through every point.
static f32 catmull_rom(f32 p0, f32 p1, f32 p2, f32 p3, f32 t) {
    f32 a = 2.0f * p1, b = p2 - p0, c = 2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3,
        d = 3.0f * (p1 - p2) + p3 - p0;
    return 0.5f * (a + (b + (c + d * t) * t) * t);
}

static void job_path(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const MoveJob *job = context;
    const PathTable *path = WORLD_TABLE(job->world, Path, path);
    for (u32 i = begin; i < end; i++) {
        u32 row = table_row(&job->transforms->table, path->table.entity[i]);
        const f32 *points;
        u32 count = world_points(job->world, path->points[i], &points);
        if (row == ROW_NONE || count == 0) continue;
        f64 place = phase_at(job->world->tick, path->period[i], path->phase[i]) * count;
        u32 at = MIN((u32)place, count - 1);
        f32 t = (f32)(place - at), offset[3];
        const f32 *p0 = points + 3 * ((at + count - 1) % count), *p1 = points + 3 * at,
                  *p2 = points + 3 * ((at + 1) % count), *p3 = points + 3 * ((at + 2) % count);
        for (u32 a = 0; a < 3; a++) offset[a] = catmull_rom(p0[a], p1[a], p2[a], p3[a], t);
        job->out.x[row] += offset[0];
        job->out.y[row] += offset[1];
        job->out.z[row] += offset[2];
    }
}

static void animate_offsets(SystemContext *context) {
    const World *world = context->world;
    TransformTable *t = WORLD_TABLE(world, Transform, transform);
    const Table *orbits = &WORLD_TABLE(world, Orbit, orbit)->table;
    const Table *paths = &WORLD_TABLE(world, Path, path)->table;
    u32 count = t->table.count, since = context->last_stamp + 1;
    bool idle = orbits->count == 0 && paths->count == 0 && !table_changed_since(orbits, since) &&
                !table_changed_since(paths, since) && !table_changed_since(&t->table, since);
    if (count == 0 || idle) return;

    MoveJob job = {.world = world, .transforms = t};
    job.out.x = ARENA_PUSH(context->scratch, f32, count);
    job.out.y = ARENA_PUSH(context->scratch, f32, count);
    job.out.z = ARENA_PUSH(context->scratch, f32, count);
    Vec2 *circle = ARENA_PUSH(context->scratch, Vec2, CIRCLE_STEPS);
    job.circle = circle;
    for (u32 i = 0; i < CIRCLE_STEPS && orbits->count > 0; i++) {
        f32 angle = (f32)i * (2.0f * PI_F / CIRCLE_STEPS);
        circle[i] = (Vec2){det_cos(angle), det_sin(angle)};
    }
    // An entity has at most one row of each, so within a loop all write different rows.
    jobs_for(orbits->count, ROWS_PER_JOB, job_orbit, &job);
    jobs_for(paths->count, ROWS_PER_JOB, job_path, &job);

    for (u32 row = 0; row < count; row++) {
        if (t->offset_x[row] == job.out.x[row] && t->offset_y[row] == job.out.y[row] &&
            t->offset_z[row] == job.out.z[row])
            continue;
        t->offset_x[row] = job.out.x[row];
        t->offset_y[row] = job.out.y[row];
        t->offset_z[row] = job.out.z[row];
        table_touch(&t->table, row);
    }
}

// ---- light ----

// Value noise: random numbers at whole times, joined smoothly. In [0, 1).
static f32 value_noise(u64 seed, u64 stream, f64 time) {
    u64 cell = (u64)time;
    f32 t = (f32)(time - (f64)cell);
    t = t * t * (3.0f - 2.0f * t);
    return f32_lerp(random_f32(seed, stream, cell), random_f32(seed, stream, cell + 1), t);
}

typedef struct GainJob {
    const World *world;
    const LightTable *lights;
    f32 *gain; // [light rows]
} GainJob;

static void job_flicker(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const GainJob *job = context;
    const FlickerTable *flicker = WORLD_TABLE(job->world, Flicker, flicker);
    for (u32 i = begin; i < end; i++) {
        Entity entity = flicker->table.entity[i];
        u32 row = table_row(&job->lights->table, entity);
        if (row == ROW_NONE) continue;
        f64 time = (f64)job->world->tick * flicker->rate[i] / TICK_RATE;
        // A slow and a fast part, as of a flame: streams beside those of the orbit.
        u64 stream = (u64)entity << 2;
        f32 noise = 0.65f * value_noise(job->world->seed, stream | 1, time) +
                    0.35f * value_noise(job->world->seed, stream | 2, time * 2.75);
        job->gain[row] *= 1.0f - flicker->amount[i] * noise;
    }
}

static void job_pulse(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const GainJob *job = context;
    const PulseTable *pulse = WORLD_TABLE(job->world, Pulse, pulse);
    for (u32 i = begin; i < end; i++) {
        u32 row = table_row(&job->lights->table, pulse->table.entity[i]);
        if (row == ROW_NONE) continue;
        f64 phase = phase_at(job->world->tick, pulse->period[i], pulse->phase[i]);
        f32 swell = 0.5f - 0.5f * det_cos((f32)(phase * (2.0 * PI_F)));
        job->gain[row] *= 1.0f - pulse->amount[i] * swell;
    }
}

static void animate_gains(SystemContext *context) {
    const World *world = context->world;
    LightTable *lights = WORLD_TABLE(world, Light, light);
    const Table *flickers = &WORLD_TABLE(world, Flicker, flicker)->table;
    const Table *pulses = &WORLD_TABLE(world, Pulse, pulse)->table;
    u32 count = lights->table.count, since = context->last_stamp + 1;
    bool idle = flickers->count == 0 && pulses->count == 0 &&
                !table_changed_since(flickers, since) && !table_changed_since(pulses, since) &&
                !table_changed_since(&lights->table, since);
    if (count == 0 || idle) return;

    GainJob job = {world, lights, ARENA_PUSH(context->scratch, f32, count)};
    for (u32 row = 0; row < count; row++) job.gain[row] = 1.0f;
    jobs_for(flickers->count, ROWS_PER_JOB, job_flicker, &job);
    jobs_for(pulses->count, ROWS_PER_JOB, job_pulse, &job);
    for (u32 row = 0; row < count; row++) {
        if (lights->gain[row] == job.gain[row]) continue;
        lights->gain[row] = job.gain[row];
        table_touch(&lights->table, row);
    }
}

void system_animate(SystemContext *context) {
    animate_offsets(context);
    animate_gains(context);
}
