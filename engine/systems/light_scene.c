// light_scene.c: what the light manager's decisions are made from.
// Data in: the light table (with derived columns), the camera, environment and light_manager
// columns. Data out: candidates (bounding sphere and colour of every row; radius -1 for those that
// cannot matter), the reference view. Called by: packet_lights.c, light_manager.c. Does not: cull
// or choose.
#include "light_decide.h"
#include "../base/jobs.h"

#define LIGHTS_PER_JOB 1024

typedef struct CandidateJob {
    const LightTable *light;
    LightCandidates out;
    f32 gain;
} CandidateJob;

static void job_candidates(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const CandidateJob *job = context;
    const LightTable *light = job->light;
    const LightCandidates *out = &job->out;
    for (u32 i = begin; i < end; i++) {
        f32 factor = light->intensity[i] * light->gain[i] * job->gain;
        f32 r = light->color_r[i] * factor, g = light->color_g[i] * factor,
            b = light->color_b[i] * factor;
        f32 x = light->x[i], y = light->y[i], z = light->z[i], radius = light->reach[i];
        if (light->kind[i] == LIGHT_SPOT) {
            f32 half_rad = DEG_TO_RAD(light->outer_angle[i]);
            f32 along = cone_bounding_sphere(radius, det_cos(half_rad), det_sin(half_rad), &radius);
            x += light->dir_x[i] * along;
            y += light->dir_y[i] * along;
            z += light->dir_z[i] * along;
        }
        // One that adds nothing is no light. (Negative colours cannot come from level text; a game
        // may use them: they darken.) A factor that overflowed is no light either.
        bool lights = (r != 0.0f || g != 0.0f || b != 0.0f) && fabsf(r) < 1e30f &&
                      fabsf(g) < 1e30f && fabsf(b) < 1e30f && radius > 0.0f;
        out->x[i] = x, out->y[i] = y, out->z[i] = z;
        out->r[i] = r, out->g[i] = g, out->b[i] = b;
        out->radius[i] = lights && light->kind[i] != LIGHT_DIRECTIONAL ? radius : -1.0f;
    }
}

LightCandidates light_candidates(const LightTable *light, f32 gain, Arena *scratch) {
    u64 padded = ALIGN_UP(light->table.count, SIMD_WIDTH);
    CandidateJob job = {.light = light, .gain = gain};
    f32 **columns[] = {&job.out.x, &job.out.y, &job.out.z, &job.out.radius,
                       &job.out.r, &job.out.g, &job.out.b};
    for (u32 i = 0; i < COUNT_OF(columns); i++)
        *columns[i] = ARENA_PUSH_COLUMN(scratch, f32, padded);
    jobs_for(light->table.count, LIGHTS_PER_JOB, job_candidates, &job);
    return job.out;
}

// The camera's view, opened to the reference picture with its rim.
static PacketView reference_view(const World *world, Entity camera, f32 *focal_px) {
    PacketView view = packet_make_view(world, camera, REFERENCE_HEIGHT_PX, REFERENCE_HEIGHT_PX);
    *focal_px = 0.5f * REFERENCE_HEIGHT_PX / view.tan_y;
    view.tan_x = 0.5f * REGIONS_X * REGION_PX / *focal_px;
    view.tan_y = 0.5f * REGIONS_Y * REGION_PX / *focal_px;
    view.height_px = REGIONS_Y * REGION_PX;
    Mat4 projection = {
        {[0] = 1.0f / view.tan_x, [5] = 1.0f / view.tan_y, [11] = -1.0f, [14] = view.near}};
    view.view_projection = mat4_mul(projection, view.view);
    view.frustum = frustum_from_matrix(&view.view_projection);
    return view;
}

LightScene light_scene_make(const World *world, Entity camera, const LightCandidates *candidates) {
    Environment e = environment_read(world);
    LightScene scene = {
        .light = WORLD_TABLE(world, Light, light),
        .candidates = *candidates,
        .white = e.exposure * 0.5f / PI_F,
        .attenuation = e.attenuation,
        .falloff = {e.attenuation_constant, e.attenuation_linear, e.attenuation_quadratic},
        .config = light_manager_config(world)};
    scene.count = scene.light->table.count;
    scene.view = reference_view(world, camera, &scene.focal_px);
    return scene;
}
