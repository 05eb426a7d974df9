// light_grid_input.c: a packet's light records as the light grids want them.
// Data in: the frame record (camera, lens, counts), light and spot records, settings. Data out:
// view-space bounding spheres and cones in columns. Called by: packet_lists.c, tests.
// Does not: decide cells, or know the world: a packet read from a file serves as well.
#include "light_grid.h"
#include "../base/jobs.h"

#define LIGHTS_PER_JOB 1024
// Shading and these columns round differently; a light is taken to be this much larger.
#define REACH_SLACK 1e-5f

typedef struct InputJob {
    const FrameRecord *frame;
    const LightRecord *lights;
    const SpotRecord *spots;
    u32 point_count;
    f32 *x, *y, *z, *radius;
    LightCones cones;
} InputJob;

static void job_input(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const InputJob *job = context;
    const f32 *m = job->frame->view, *eye = job->frame->camera;
    for (u32 i = begin; i < end; i++) {
        const f32 *p = job->lights[i].position;
        // The difference to the eye is exact in double; view's own translation is rounded.
        f64 d[3] = {(f64)p[0] - eye[0], (f64)p[1] - eye[1], (f64)p[2] - eye[2]};
        f32 at[3];
        for (u32 a = 0; a < 3; a++) at[a] = (f32)(m[a] * d[0] + m[4 + a] * d[1] + m[8 + a] * d[2]);
        // The shader's light ends where d^2 * w reaches 1.
        f32 reach = p[3] > 0.0f ? 1.0f / sqrtf(p[3]) : 0.0f;
        reach += reach * REACH_SLACK;
        f32 radius = reach, along = 0.0f, axis[3] = {0, 0, 0};
        if (i >= job->point_count) {
            u32 s = i - job->point_count;
            const f32 *w = job->spots[s].direction;
            for (u32 a = 0; a < 3; a++) axis[a] = m[a] * w[0] + m[4 + a] * w[1] + m[8 + a] * w[2];
            f32 length = sqrtf(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
            f32 cos_half = CLAMP(w[3] - REACH_SLACK, -1.0f, 1.0f);
            // A direction that is none (a stranger's): the whole ball.
            if (!(length > 0.5f && length < 2.0f)) cos_half = -1.0f, length = 1.0f;
            for (u32 a = 0; a < 3; a++) axis[a] /= length;
            f32 sin_half = sqrtf(MAX(1.0f - cos_half * cos_half, 0.0f));
            along = cone_bounding_sphere(reach, cos_half, sin_half, &radius);
            radius += radius * REACH_SLACK;
            const LightCones *c = &job->cones;
            c->tip_x[s] = at[0], c->tip_y[s] = at[1], c->tip_z[s] = at[2];
            c->axis_x[s] = axis[0], c->axis_y[s] = axis[1], c->axis_z[s] = axis[2];
            c->cos_half[s] = cos_half, c->sin_half[s] = sin_half, c->reach[s] = reach;
        }
        job->x[i] = at[0] + axis[0] * along;
        job->y[i] = at[1] + axis[1] * along;
        job->z[i] = at[2] + axis[2] * along;
        job->radius[i] = radius;
    }
}

static f32 length3(const f32 *v) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

LightGridInput light_grid_input(const FrameRecord *frame, const LightRecord *lights,
                                const SpotRecord *spots, const RenderSettings *settings,
                                Arena *arena) {
    u32 points = frame->counts[0], spot_count = frame->counts[1], count = points + spot_count;
    InputJob job = {.frame = frame, .lights = lights, .spots = spots, .point_count = points};
    f32 **columns[] = {&job.x, &job.y, &job.z, &job.radius};
    for (u32 i = 0; i < COUNT_OF(columns); i++)
        *columns[i] = ARENA_PUSH_COLUMN(arena, f32, ALIGN_UP(count, SIMD_WIDTH));
    LightCones *c = &job.cones;
    f32 **cones[] = {&c->tip_x,  &c->tip_y,    &c->tip_z,    &c->axis_x, &c->axis_y,
                     &c->axis_z, &c->cos_half, &c->sin_half, &c->reach};
    for (u32 i = 0; i < COUNT_OF(cones); i++)
        *cones[i] = ARENA_PUSH_COLUMN(arena, f32, ALIGN_UP(spot_count, SIMD_WIDTH));
    jobs_for(count, LIGHTS_PER_JOB, job_input, &job);
    return (LightGridInput){.x = job.x,
                            .y = job.y,
                            .z = job.z,
                            .radius = job.radius,
                            .count = count,
                            .point_count = points,
                            .width_px = (u32)frame->viewport[0],
                            .height_px = (u32)frame->viewport[1],
                            .tile_px = settings_tile_px(settings),
                            .near = frame->camera[3],
                            .scale_x = 1.0f / length3(frame->ray_right),
                            .scale_y = 1.0f / length3(frame->ray_up),
                            .highlight_points = frame->counts3[0],
                            .highlight_spots = frame->counts3[1],
                            .cones = job.cones};
}
