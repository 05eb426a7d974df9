// shapes.c: the seven shapes that need no file.
//
// Data in: a ShapeDesc. Data out: a model of one part with one plain material. Called through
// asset_generate_model by levels and tests. Does not: weld, order or pack (mesh_process.c does).
//
// Every surface is a grid of quads: columns run to the right seen from outside (u grows), rows
// run downwards (v grows), so right x up is the outward normal, quads are counter-clockwise and
// the bitangent cross(normal, tangent) points up, towards -v. Angles are taken modulo the number
// of segments, so that seams close bit for bit.
#include "asset_internal.h"
#include "../base/hash.h"
#include "../base/log.h"
#include <stdio.h>
#include <string.h>

const char *const shape_names[SHAPE_COUNT] = {"plane", "cube",     "sphere", "icosahedron",
                                              "cone",  "cylinder", "torus"};

#define SEGMENTS_DEFAULT 32
#define SEGMENTS_MAX     1024
#define TUBE_DEFAULT     0.2f
#define RADIUS           0.5f
#define HALF_HEIGHT      0.5f

typedef struct Builder {
    SourceVertex *vertices;
    u32 *indices;
    u32 vertex_count, index_count, vertex_cap, index_cap;
} Builder;

static u32 add_vertex(Builder *b, Vec3 position, Vec3 normal, Vec3 tangent, f32 u, f32 v) {
    LUZ_ASSERT(b->vertex_count < b->vertex_cap);
    b->vertices[b->vertex_count] =
        (SourceVertex){position, normal, {tangent.x, tangent.y, tangent.z, 1}, {u, v}, ~0u};
    return b->vertex_count++;
}

static void add_triangle(Builder *b, u32 i, u32 j, u32 k) {
    LUZ_ASSERT(b->index_count + 3 <= b->index_cap);
    b->indices[b->index_count++] = i;
    b->indices[b->index_count++] = j;
    b->indices[b->index_count++] = k;
}

// Sine and cosine of step / count of a turn; step == count is exactly step 0.
static Vec2 turn(u32 step, u32 count) {
    f32 angle = 2.0f * PI_F * (f32)(step % count) / (f32)count;
    return (Vec2){det_sin(angle), det_cos(angle)};
}

// A row of a surface of revolution about y: a circle, or a point at the axis.
typedef struct Ring {
    f32 radius, y;
    Vec2 normal; // x: away from the axis, y: up; unit
    f32 v;
} Ring;

// The band between two rings, upper one first. Where a ring is a point (radius 0) each column
// is one triangle, whose corner at the point has the angle of the column's middle.
static void add_band(Builder *b, Ring upper, Ring lower, u32 segments) {
    const Ring *rings[2] = {&upper, &lower};
    u32 first[2];
    for (u32 r = 0; r < 2; r++) {
        bool point = rings[r]->radius == 0.0f;
        first[r] = b->vertex_count;
        for (u32 c = 0; c < segments + (point ? 0 : 1); c++) {
            Vec2 d = point ? turn(2 * c + 1, 2 * segments) : turn(c, segments);
            Vec3 normal =
                vec3(rings[r]->normal.x * d.x, rings[r]->normal.y, rings[r]->normal.x * d.y);
            add_vertex(b, vec3(rings[r]->radius * d.x, rings[r]->y, rings[r]->radius * d.y), normal,
                       vec3(d.y, 0, -d.x), ((f32)c + (point ? 0.5f : 0.0f)) / (f32)segments,
                       rings[r]->v);
        }
    }
    for (u32 c = 0; c < segments; c++) {
        u32 top = first[0] + c, bottom = first[1] + c;
        if (lower.radius == 0.0f) {
            add_triangle(b, top, bottom, top + 1);
        } else {
            add_triangle(b, top, bottom, bottom + 1);
            if (upper.radius != 0.0f) add_triangle(b, top, bottom + 1, top + 1);
        }
    }
}

// A disc at height y facing up (+1) or down (-1).
static void add_disc(Builder *b, f32 y, f32 up, u32 segments) {
    Vec3 normal = vec3(0, up, 0), tangent = vec3(1, 0, 0);
    u32 center = add_vertex(b, vec3(0, y, 0), normal, tangent, 0.5f, 0.5f);
    for (u32 c = 0; c < segments; c++) {
        Vec2 d = turn(c, segments);
        add_vertex(b, vec3(RADIUS * d.x, y, RADIUS * d.y), normal, tangent, 0.5f + 0.5f * d.x,
                   0.5f + 0.5f * up * d.y);
    }
    for (u32 c = 0; c < segments; c++) {
        u32 here = center + 1 + c, next = center + 1 + (c + 1) % segments;
        if (up > 0)
            add_triangle(b, center, here, next);
        else
            add_triangle(b, center, next, here);
    }
}

// A square of side 1 about `middle`, facing right x up.
static void add_square(Builder *b, Vec3 middle, Vec3 right, Vec3 up, u32 steps) {
    Vec3 normal = vec3_cross(right, up);
    u32 first = b->vertex_count;
    for (u32 row = 0; row <= steps; row++)
        for (u32 column = 0; column <= steps; column++) {
            f32 u = (f32)column / (f32)steps, v = (f32)row / (f32)steps;
            Vec3 offset = vec3_add(vec3_scale(right, u - 0.5f), vec3_scale(up, 0.5f - v));
            add_vertex(b, vec3_add(middle, offset), normal, right, u, v);
        }
    for (u32 row = 0; row < steps; row++)
        for (u32 column = 0; column < steps; column++) {
            u32 top = first + row * (steps + 1) + column, bottom = top + steps + 1;
            add_triangle(b, top, bottom, bottom + 1);
            add_triangle(b, top, bottom + 1, top + 1);
        }
}

static void build_cube(Builder *b) {
    const Vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    const Vec3 back = {0, 0, -1}, left = {-1, 0, 0};
    add_square(b, vec3(0.5f, 0, 0), back, y, 1);
    add_square(b, vec3(-0.5f, 0, 0), z, y, 1);
    add_square(b, vec3(0, 0.5f, 0), x, back, 1);
    add_square(b, vec3(0, -0.5f, 0), x, z, 1);
    add_square(b, vec3(0, 0, 0.5f), x, y, 1);
    add_square(b, vec3(0, 0, -0.5f), left, y, 1);
}

static void build_sphere(Builder *b, u32 segments, u32 rings) {
    Ring upper = {0, RADIUS, {0, 1}, 0};
    for (u32 r = 1; r <= rings; r++) {
        Vec2 d = turn(r, 2 * rings); // from the pole down
        Ring lower = {RADIUS * d.x, RADIUS * d.y, d, (f32)r / (f32)rings};
        if (r == rings) lower = (Ring){0, -RADIUS, {0, -1}, 1};
        add_band(b, upper, lower, segments);
        upper = lower;
    }
}

// Twelve corners on three golden rectangles, twenty faces, each with its own normal.
static void build_icosahedron(Builder *b) {
    const f32 s = 0.26286556f, l = 0.42532540f; // radius 0.5: 0.5 / sqrt(1 + phi^2), times phi
    const Vec3 corner[12] = {{-s, l, 0}, {s, l, 0}, {-s, -l, 0}, {s, -l, 0},
                             {0, -s, l}, {0, s, l}, {0, -s, -l}, {0, s, -l},
                             {l, 0, -s}, {l, 0, s}, {-l, 0, -s}, {-l, 0, s}};
    static const u8 face[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (u32 f = 0; f < 20; f++) {
        Vec3 p = corner[face[f][0]], q = corner[face[f][1]], r = corner[face[f][2]];
        Vec3 right = vec3_normalize(vec3_sub(q, p));
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(q, p), vec3_sub(r, p)));
        u32 first = add_vertex(b, p, normal, right, 0, 1);
        add_vertex(b, q, normal, right, 1, 1);
        add_vertex(b, r, normal, right, 0.5f, 0);
        add_triangle(b, first, first + 1, first + 2);
    }
}

// Side from the top radius down to RADIUS; `slope` is the side's normal.
static void build_side(Builder *b, f32 top_radius, Vec2 slope, u32 segments, u32 rings) {
    Ring upper = {top_radius, HALF_HEIGHT, slope, 0};
    for (u32 r = 1; r <= rings; r++) {
        f32 v = (f32)r / (f32)rings;
        Ring lower = {f32_lerp(top_radius, RADIUS, v), HALF_HEIGHT - v, slope, v};
        if (r == rings) lower.radius = RADIUS, lower.y = -HALF_HEIGHT; // meets the disc exactly
        add_band(b, upper, lower, segments);
        upper = lower;
    }
    add_disc(b, -HALF_HEIGHT, -1, segments);
}

static void build_torus(Builder *b, f32 tube, u32 segments, u32 rings) {
    for (u32 r = 0; r < rings; r++) {
        Ring ring[2];
        for (u32 i = 0; i < 2; i++) {
            Vec2 d = turn(rings - (r + i) % rings, rings); // downwards on the outer side
            ring[i] =
                (Ring){RADIUS + tube * d.y, tube * d.x, {d.y, d.x}, (f32)(r + i) / (f32)rings};
        }
        add_band(b, ring[0], ring[1], segments);
    }
}

// Fills in defaults and drops what the shape does not use, so that equal shapes are equal.
static ShapeDesc canonical(const ShapeDesc *desc) {
    ShapeDesc d = {.shape = desc->shape, .inverted = desc->inverted};
    LUZ_ASSERT((u32)d.shape < SHAPE_COUNT);
    d.uv_repeat = desc->uv_repeat == 0.0f ? 1.0f : desc->uv_repeat;
    if (d.shape == SHAPE_CUBE || d.shape == SHAPE_ICOSAHEDRON) return d;
    bool plane = d.shape == SHAPE_PLANE;
    d.segments = desc->segments ? desc->segments : plane ? 1 : SEGMENTS_DEFAULT;
    d.segments = CLAMP(d.segments, plane ? 1u : 3u, (u32)SEGMENTS_MAX);
    if (plane) return d;
    bool straight = d.shape == SHAPE_CONE || d.shape == SHAPE_CYLINDER;
    u32 rings_min = d.shape == SHAPE_TORUS ? 3 : straight ? 1 : 2;
    d.rings = desc->rings ? desc->rings : straight ? 1 : d.segments / 2;
    d.rings = CLAMP(d.rings, rings_min, (u32)SEGMENTS_MAX);
    if (d.shape == SHAPE_TORUS) d.tube = desc->tube > 0.0f ? desc->tube : TUBE_DEFAULT;
    return d;
}

static void build(Builder *b, const ShapeDesc *d) {
    switch (d->shape) {
    case SHAPE_PLANE:
        add_square(b, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 0, -1), d->segments);
        break;
    case SHAPE_CUBE:
        build_cube(b);
        break;
    case SHAPE_SPHERE:
        build_sphere(b, d->segments, d->rings);
        break;
    case SHAPE_ICOSAHEDRON:
        build_icosahedron(b);
        break;
    case SHAPE_CONE: {
        const f32 cosine = 0.89442719f, sine = 0.44721360f; // normal of the side: (2, 1) / sqrt 5
        build_side(b, 0, (Vec2){cosine, sine}, d->segments, d->rings);
        break;
    }
    case SHAPE_CYLINDER:
        build_side(b, RADIUS, (Vec2){1, 0}, d->segments, d->rings);
        add_disc(b, HALF_HEIGHT, 1, d->segments);
        break;
    case SHAPE_TORUS:
        build_torus(b, d->tube, d->segments, d->rings);
        break;
    case SHAPE_COUNT:
        break;
    }
}

// Inside out: the bitangent keeps its direction, so its sign changes with the normal.
static void invert(Builder *b) {
    for (u32 i = 0; i < b->vertex_count; i++) {
        b->vertices[i].normal = vec3_scale(b->vertices[i].normal, -1);
        b->vertices[i].tangent.w = -1;
    }
    for (u32 i = 0; i < b->index_count; i += 3) {
        u32 swap = b->indices[i + 1];
        b->indices[i + 1] = b->indices[i + 2];
        b->indices[i + 2] = swap;
    }
}

u32 asset_generate_model(AssetStore *store, const ShapeDesc *desc) {
    ShapeDesc d = canonical(desc);
    char name[160];
    snprintf(name, sizeof name, "shape:%s segments=%u rings=%u tube=%.9g uv=%.9g%s",
             shape_names[d.shape], d.segments, d.rings, (double)d.tube, (double)d.uv_repeat,
             d.inverted ? " inverted" : "");
    u32 found = store_find_model(store, name);
    if (found) return found;

    // A band has two rows of its own; 64 covers the cube and the icosahedron.
    u64 columns = (u64)d.segments + 1, rows = MAX(d.rings, d.segments) + 1;
    u64 vertex_cap = 2 * columns * rows + 2 * columns + 64;
    StoreMark mark = store_mark(store);
    Builder b = {.vertex_cap = (u32)vertex_cap, .index_cap = (u32)(3 * vertex_cap)};
    b.vertices = ARENA_PUSH(&store->scratch, SourceVertex, b.vertex_cap);
    b.indices = ARENA_PUSH(&store->scratch, u32, b.index_cap);
    build(&b, &d);
    for (u32 i = 0; i < b.vertex_count; i++) {
        b.vertices[i].uv.x *= d.uv_repeat;
        b.vertices[i].uv.y *= d.uv_repeat;
    }
    if (d.inverted) invert(&b);

    char why[ASSET_MESSAGE_CAP] = "";
    MeshSource source = {b.vertices, b.indices, b.vertex_count, b.index_count, true, true, true};
    u32 mesh = mesh_process(store, &source, why), id = 0;
    if (mesh) {
        ModelPart *part = ARENA_PUSH(&store->arena, ModelPart, 1);
        *part = (ModelPart){.mesh = mesh, .local = mat34_identity()};
        ModelMaterial *material = ARENA_PUSH(&store->arena, ModelMaterial, 1);
        *material = (ModelMaterial){.name = shape_names[d.shape],
                                    .albedo = {0.8f, 0.8f, 0.8f, 1},
                                    .specular = {0.04f, 0.04f, 0.04f},
                                    .power = 32,
                                    .emissive_strength = 1,
                                    .alpha_cutoff = 0.5f};
        Model model = {.name = arena_copy_string(&store->arena, name),
                       .content_hash = hash_string(name),
                       .parts = part,
                       .materials = material,
                       .part_count = 1,
                       .material_count = 1};
        model_grow_bounds(&model, &store->meshes[mesh], &part->local, true);
        id = store_add_model(store, &model);
    } else {
        LOG(ASSET_LIMIT, "%s: %s", name, why);
    }
    if (id)
        arena_rewind(&store->scratch, mark.scratch);
    else
        store_rewind(store, mark);
    return id;
}
