// volumes.c: path `deferred_volumes`: a light touches only the part of the screen that it can
// light (specification of direct lighting, section 4, after Puig 2006).
// Data in: a packet's lights and settings. Data out: commands; meshes of a sphere and a cone, made
// once. Called by: pass_run (passes.c), renderer.c. Does not: light anything by itself: every way
// ends in deferred_light.frag, so that all give the same sum in the same order, the same bits.
//
// Ways, each with or without a scissor of the light's exact bounds:
//   quad     the full screen
//   back     back faces of the light's volume where they lie behind the surface: pixels that the
//            light floats in front of are left out, and the sky
//   front    front faces where they lie before the surface: lights behind walls are left out. A
//            volume that reaches behind the near plane has no front there: drawn by its back
//   auto     of both, for each light, what is likely to leave out more
//   stencil  first the pixels whose surface lies inside the volume are marked, then shaded
// Meshes contain the light's true shape: a chord of a sphere lies inside the sphere.
#include "passes.h"
#include "../base/sphere_bounds.h"
#include <math.h>
#include <string.h>

// --- Meshes ---

enum {
    SPHERE_VERTICES = 42, // an icosahedron's 12 and the middles of its 30 edges
    SPHERE_INDICES = 240,
    CONE_SIDES = 12,
    CONE_VERTICES = 2 + 2 * CONE_SIDES, // tip, rim, upper ring, pole
    CONE_INDICES = CONE_SIDES * 6 * 3,
    VOLUME_VERTICES = SPHERE_VERTICES + CONE_VERTICES,
    VOLUME_INDICES = SPHERE_INDICES + CONE_INDICES
};
#define CONE_GROWTH 1.03528f // 1 / cos(pi / CONE_SIDES): the sides touch the circle
#define SLACK       1.002f   // the shader's lights and these meshes round differently

typedef struct VolumeMesh {
    f32 vertices[VOLUME_VERTICES][4];
    u16 indices[VOLUME_INDICES];
    u32 vertex_count, index_count;
} VolumeMesh;

static u16 push_vertex(VolumeMesh *mesh, Vec3 p) {
    const f32 vertex[4] = {p.x, p.y, p.z, 0.0f};
    memcpy(mesh->vertices[mesh->vertex_count], vertex, sizeof vertex);
    return (u16)mesh->vertex_count++;
}

static Vec3 vertex_at(const VolumeMesh *mesh, u16 index) {
    const f32 *v = mesh->vertices[index];
    return vec3(v[0], v[1], v[2]);
}

static void push_triangle(VolumeMesh *mesh, u32 a, u32 b, u32 c) {
    mesh->indices[mesh->index_count++] = (u16)a;
    mesh->indices[mesh->index_count++] = (u16)b;
    mesh->indices[mesh->index_count++] = (u16)c;
}

// The middle of an edge, on the unit sphere; the same vertex from both sides.
static u16 edge_middle(VolumeMesh *mesh, u16 (*edges)[12], u16 a, u16 b) {
    u16 *known = &edges[MIN(a, b)][MAX(a, b)];
    if (!*known)
        *known =
            push_vertex(mesh, vec3_normalize(vec3_add(vertex_at(mesh, a), vertex_at(mesh, b))));
    return *known;
}

// An icosahedron cut once, grown until its faces touch the unit sphere from outside.
static void push_sphere(VolumeMesh *mesh) {
    static const u16 faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    const f32 g = 1.6180340f; // the golden ratio
    const Vec3 corners[12] = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                              {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                              {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    for (u32 i = 0; i < 12; i++) push_vertex(mesh, vec3_normalize(corners[i]));
    u16 edges[12][12] = {{0}};
    for (u32 i = 0; i < 20; i++) {
        u16 a = faces[i][0], b = faces[i][1], c = faces[i][2];
        u16 ab = edge_middle(mesh, edges, a, b), bc = edge_middle(mesh, edges, b, c),
            ca = edge_middle(mesh, edges, c, a);
        push_triangle(mesh, a, ab, ca);
        push_triangle(mesh, ab, b, bc);
        push_triangle(mesh, ca, bc, c);
        push_triangle(mesh, ab, bc, ca);
    }
    f32 nearest = 1.0f;
    for (u32 i = 0; i < mesh->index_count; i += 3) {
        Vec3 a = vertex_at(mesh, mesh->indices[i]), b = vertex_at(mesh, mesh->indices[i + 1]),
             c = vertex_at(mesh, mesh->indices[i + 2]);
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(b, a), vec3_sub(c, a)));
        nearest = MIN(nearest, vec3_dot(normal, a));
    }
    for (u32 i = 0; i < SPHERE_VERTICES; i++)
        for (u32 axis = 0; axis < 3; axis++) mesh->vertices[i][axis] *= SLACK / nearest;
}

// xy: place on the circle about the axis; z: which ring (volume.vert knows their sizes, which hang
// on the light's angle).
static void push_cone(VolumeMesh *mesh) {
    u32 tip = push_vertex(mesh, vec3(0, 0, 0)), pole = push_vertex(mesh, vec3(0, 0, 3));
    u32 first = mesh->vertex_count - SPHERE_VERTICES;
    for (u32 ring = 1; ring <= 2; ring++)
        for (u32 i = 0; i < CONE_SIDES; i++) {
            f32 angle = 2.0f * PI_F * (f32)i / CONE_SIDES;
            push_vertex(
                mesh, vec3(det_cos(angle) * CONE_GROWTH, det_sin(angle) * CONE_GROWTH, (f32)ring));
        }
    tip -= SPHERE_VERTICES, pole -= SPHERE_VERTICES; // indices count from the cone's first vertex
    for (u32 i = 0; i < CONE_SIDES; i++) {
        u32 next = (i + 1) % CONE_SIDES, rim = first, ring = first + CONE_SIDES;
        push_triangle(mesh, tip, rim + next, rim + i);
        push_triangle(mesh, rim + i, rim + next, ring + next);
        push_triangle(mesh, rim + i, ring + next, ring + i);
        push_triangle(mesh, ring + i, ring + next, pole);
    }
}

bool volumes_create(Renderer *renderer) {
    static VolumeMesh mesh;
    memset(&mesh, 0, sizeof mesh);
    push_sphere(&mesh);
    push_cone(&mesh);
    LUZ_ASSERT(mesh.vertex_count == VOLUME_VERTICES);
    // As long as one vertex an instance: synchronisation validation 1.3.239 takes instance streams
    // and vertex streams for each other.
    renderer->volume_vertices = gpu_create_buffer(
        renderer->gpu,
        &(GpuBufferDesc){.label = "volume vertices", .size = sizeof mesh.vertices, .vertex = true});
    renderer->volume_indices = gpu_create_buffer(
        renderer->gpu,
        &(GpuBufferDesc){.label = "volume indices", .size = sizeof mesh.indices, .index = true});
    if (!renderer->volume_vertices.id || !renderer->volume_indices.id) return false;
    gpu_upload_buffer(renderer->gpu, renderer->volume_vertices, 0, mesh.vertices,
                      sizeof mesh.vertices);
    gpu_upload_buffer(renderer->gpu, renderer->volume_indices, 0, mesh.indices,
                      sizeof mesh.indices);
    return true;
}

void volumes_destroy(Renderer *renderer) {
    if (renderer->volume_vertices.id) gpu_destroy_buffer(renderer->gpu, renderer->volume_vertices);
    if (renderer->volume_indices.id) gpu_destroy_buffer(renderer->gpu, renderer->volume_indices);
}

// --- What a light covers ---

typedef struct Bounds {
    f32 center[3], radius;       // view space: smallest sphere of what is lit
    f32 mesh_along, mesh_radius; // of the drawn volume: a sphere so far from the light
    f32 axis[3], tip[3];
    f32 reach, cos_half; // of the light itself; a point's cos_half is -1
} Bounds;

static Bounds light_bounds(const Packet *packet, u32 light, bool is_spot) {
    const FrameRecord *frame = &packet->frame;
    const LightRecord *record = &PACKET_DATA(packet, lights, LightRecord)[light];
    const f32 *m = frame->view, *p = record->position;
    Bounds b = {0};
    // The difference to the eye is exact in double; the view's own translation is rounded.
    f64 d[3];
    for (u32 a = 0; a < 3; a++) d[a] = (f64)p[a] - frame->camera[a];
    for (u32 a = 0; a < 3; a++) b.tip[a] = (f32)(m[a] * d[0] + m[4 + a] * d[1] + m[8 + a] * d[2]);
    f32 reach = SLACK / sqrtf(MAX(p[3], 1e-12f)), along = 0.0f; // where d^2 * w reaches 1
    b.radius = b.reach = reach;
    b.cos_half = -1.0f;
    b.mesh_radius = 1.2f * reach;
    if (is_spot) {
        const SpotRecord *spot =
            &PACKET_DATA(packet, spots, SpotRecord)[light - packet->frame.counts[0]];
        const f32 *w = spot->direction;
        for (u32 a = 0; a < 3; a++) b.axis[a] = m[a] * w[0] + m[4 + a] * w[1] + m[8 + a] * w[2];
        f32 cosine = CLAMP(w[3] - 1e-4f, -1.0f, 1.0f);
        f32 sine = sqrtf(MAX(1.0f - cosine * cosine, 0.0f));
        b.cos_half = cosine;
        along = cone_bounding_sphere(reach, cosine, sine, &b.radius);
        // Rings of volume.vert as seen from the middle of the axis, or the box of a whole ball.
        b.mesh_along = cosine > 0.0f ? 0.5f * reach : 0.0f;
        b.mesh_radius = cosine > 0.0f ? 1.25f * reach : 1.6f * reach;
    }
    for (u32 a = 0; a < 3; a++) b.center[a] = b.tip[a] + b.axis[a] * along;
    return b;
}

typedef struct Rect {
    i32 x, y;
    u32 width, height; // 0 = nothing of the light is seen
} Rect;

static f32 length3(const f32 *v) { return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static Rect light_rect(const Packet *packet, const Bounds *b) {
    const FrameRecord *frame = &packet->frame;
    f32 near = frame->camera[3], x0, x1, y0, y1;
    if (!cone_bounds_axis(b->tip, b->axis, b->cos_half, b->reach, 0, near,
                          1.0f / length3(frame->ray_right), &x0, &x1) ||
        !cone_bounds_axis(b->tip, b->axis, b->cos_half, b->reach, 1, near,
                          1.0f / length3(frame->ray_up), &y0, &y1))
        return (Rect){0};
    f32 half_x = 0.5f * (f32)packet->width_px, half_y = 0.5f * (f32)packet->height_px;
    // NDC y points up, rows go down. All pixels that are touched, in part or whole.
    i32 left = (i32)floorf((x0 + 1.0f) * half_x), right = (i32)ceilf((x1 + 1.0f) * half_x);
    i32 top = (i32)floorf((1.0f - y1) * half_y), bottom = (i32)ceilf((1.0f - y0) * half_y);
    left = CLAMP(left, 0, (i32)packet->width_px), right = CLAMP(right, 0, (i32)packet->width_px);
    top = CLAMP(top, 0, (i32)packet->height_px);
    bottom = CLAMP(bottom, 0, (i32)packet->height_px);
    if (right <= left || bottom <= top) return (Rect){0};
    return (Rect){left, top, (u32)(right - left), (u32)(bottom - top)};
}

// Does the drawn volume reach behind the near plane's rectangle?
static bool reaches_eye(const Packet *packet, const Bounds *b) {
    const FrameRecord *frame = &packet->frame;
    f32 near = frame->camera[3], right = length3(frame->ray_right), up = length3(frame->ray_up);
    f32 corner = near * sqrtf(1.0f + right * right + up * up);
    f32 to[3];
    for (u32 a = 0; a < 3; a++) to[a] = b->tip[a] + b->axis[a] * b->mesh_along;
    return !(length3(to) > b->mesh_radius + corner);
}

// --- Drawing ---

// Lights tell how far off surfaces are, for they hang near them: those before the middle of all
// lights rather float in the air, those beyond are rather hidden.
static f32 mean_depth(const Packet *packet) {
    const LightRecord *lights = PACKET_DATA(packet, lights, LightRecord);
    const FrameRecord *frame = &packet->frame;
    u32 count = frame->counts[0] + frame->counts[1];
    f64 sum = 0.0;
    for (u32 i = 0; i < count; i++)
        for (u32 a = 0; a < 3; a++)
            sum += ((f64)lights[i].position[a] - frame->camera[a]) * frame->ray_forward[a];
    return count ? (f32)(sum / count) : 0.0f;
}

// Which pipelines draw a light: kind of the points' one; spots come after.
static PipelineKind light_kind(const Packet *packet, const Bounds *b, f32 middle) {
    switch (packet->settings.light_volume) {
    case VOLUME_QUAD:
        return PIPELINE_DEFERRED_POINTS;
    case VOLUME_BACK:
        return PIPELINE_VOLUME_BACK_POINTS;
    case VOLUME_STENCIL:
        return PIPELINE_VOLUME_MARK_POINTS;
    default:
        break;
    }
    bool back = packet->settings.light_volume == VOLUME_AUTO && -b->center[2] < middle;
    return back || reaches_eye(packet, b) ? PIPELINE_VOLUME_BACK_POINTS
                                          : PIPELINE_VOLUME_FRONT_POINTS;
}

typedef struct Brush {
    const PassContext *c;
    bool is_spots;
    PipelineKind bound; // PIPELINE_COUNT = none yet
} Brush;

static void brush_draw(Brush *brush, PipelineKind kind, u32 first, u32 count) {
    const PassContext *c = brush->c;
    if (count == 0) return;
    if (brush->bound != kind) {
        GpuPipeline pipeline =
            pipeline_get(c->renderer, c->packet, kind + brush->is_spots, PIPELINE_PLAIN);
        if (!pipeline.id) return;
        bind_frame(c, pipeline);
        brush->bound = kind;
    }
    bool is_quad = kind == PIPELINE_DEFERRED_POINTS;
    u32 indices = brush->is_spots ? CONE_INDICES : SPHERE_INDICES;
    if (is_quad)
        gpu_cmd_draw(c->cmd, 3, count, 0, first);
    else
        gpu_cmd_draw_indexed(c->cmd, indices, count, brush->is_spots ? SPHERE_INDICES : 0,
                             brush->is_spots ? SPHERE_VERTICES : 0, first);
    c->renderer->stats.draw_calls++;
    c->renderer->stats.triangles += (is_quad ? 1 : indices / 3) * count;
    if (kind == PIPELINE_VOLUME_MARK_POINTS)
        brush_draw(brush, PIPELINE_VOLUME_SHADE_POINTS, first, count);
}

// Lights [first, first + count) of the stream; in their order, as `deferred` adds them.
static void draw_class(const PassContext *c, bool is_spots, u32 first, u32 count, f32 middle) {
    if (count == 0) return;
    const Packet *packet = c->packet;
    Renderer *r = c->renderer;
    gpu_cmd_bind_vertices(c->cmd, 0, r->buffers[FRAME_BUFFER_LIGHTS], first * sizeof(LightRecord));
    // Points have no spot record; something of the same size must be there.
    gpu_cmd_bind_vertices(c->cmd, 1,
                          r->buffers[is_spots ? FRAME_BUFFER_SPOTS : FRAME_BUFFER_LIGHTS], 0);
    gpu_cmd_bind_vertices(c->cmd, 2, r->volume_vertices, 0);
    gpu_cmd_bind_indices(c->cmd, r->volume_indices, true);
    Brush brush = {c, is_spots, PIPELINE_COUNT};
    u32 way = packet->settings.light_volume;
    if (r->is_warming_up && (way == VOLUME_AUTO || way == VOLUME_FRONT)) {
        brush_draw(&brush, PIPELINE_VOLUME_BACK_POINTS, 0, 1);
        brush_draw(&brush, PIPELINE_VOLUME_FRONT_POINTS, 0, 1);
    }
    bool scissor = packet->settings.light_scissor;
    // Without a scissor a run of lights that are drawn alike is one draw. Marks of two lights must
    // not mix.
    u32 run_first = 0, run_count = 0;
    PipelineKind run_kind = PIPELINE_COUNT;
    for (u32 i = 0; i < count; i++) {
        Bounds bounds = light_bounds(packet, first + i, is_spots);
        PipelineKind kind = light_kind(packet, &bounds, middle);
        if (scissor) {
            Rect rect = light_rect(packet, &bounds);
            if (rect.width == 0) continue;
            gpu_cmd_scissor(c->cmd, rect.x, rect.y, rect.width, rect.height);
            brush_draw(&brush, kind, i, 1);
            continue;
        }
        if (kind != run_kind || kind == PIPELINE_VOLUME_MARK_POINTS) {
            brush_draw(&brush, run_kind, run_first, run_count);
            run_kind = kind, run_first = i, run_count = 0;
        }
        run_count++;
    }
    brush_draw(&brush, run_kind, run_first, run_count);
}

static void volumes_record(const PassContext *c) {
    const FrameRecord *frame = &c->packet->frame;
    u32 way = c->packet->settings.light_volume;
    GpuRendering rendering = {.targets = {TARGET(ACCUMULATION)}, .target_count = 1};
    if (way != VOLUME_QUAD) {
        rendering.depth = (GpuTarget)TARGET(DEPTH);
        rendering.depth_read_only = true;
        rendering.stencil = way == VOLUME_STENCIL;
    }
    begin(c, &rendering);
    f32 middle = mean_depth(c->packet);
    draw_class(c, false, 0, frame->counts[0], middle);
    draw_class(c, true, frame->counts[0], frame->counts[1], middle);
    gpu_cmd_end_rendering(c->cmd);
}

static bool uses_stencil(const PassContext *c) {
    return c->packet->settings.light_volume == VOLUME_STENCIL;
}
static bool uses_none(const PassContext *c) { return !uses_stencil(c); }

const Pass volumes_pass = {"light volumes",
                           {USE(ACCUMULATION, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT),
                            USE(DEPTH, DEPTH_TEST), USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                           8,
                           volumes_record,
                           uses_none,
                           NULL};
const Pass volumes_stencil_pass = {"light volumes",
                                   {USE(ACCUMULATION, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT),
                                    USE(DEPTH, DEPTH_STENCIL), USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                                   8,
                                   volumes_record,
                                   uses_stencil,
                                   NULL};

// --- What is there without local lights ---

static void base_record(const PassContext *c) {
    begin(c, &(GpuRendering){.targets = {CLEARED(ACCUMULATION)}, .target_count = 1});
    draw_fullscreen(c, PIPELINE_DEFERRED_BASE);
    gpu_cmd_end_rendering(c->cmd);
}
const Pass base_pass = {"base",
                        {OVERWRITE(ACCUMULATION, COLOR_TARGET), USE_GBUFFER(SAMPLED_FRAGMENT),
                         USE(DEPTH, SAMPLED_FRAGMENT), USE(SHADOW_MAP, SAMPLED_FRAGMENT)},
                        8,
                        base_record,
                        NULL,
                        NULL};
