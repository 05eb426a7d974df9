// occlusion.c: a small depth buffer on the CPU, and spheres tested against it.
// Data in: occluders (boxes, meshes as convex polygons), the view. Data out: nearness per texel,
// its pyramids; which spheres are hidden. Called by: packet_build, the light manager's step, tests.
// Does not: hide anything that could be seen (occlusion.h says why), test boxes, or look at the
// frame before.
//
// A box is one convex piece although three of its faces may show: its outline covers the texel, and
// where the ray of a pixel enters it is the farthest of the planes that face the eye. Edges
// between its faces therefore leave no gaps, as they would if each face were drawn alone.
#include "occlusion.h"
#include "../base/jobs.h"
#include "../base/simd.h"

#define SPHERES_PER_JOB 512
#define EDGES_CAP       (OCCLUDER_POINTS_MAX + 2)
// Of a texel: taken off both ends of a covered run, what rounding may take.
#define COVERAGE_SLACK 1e-3f
// A plane that the eye is nearer to hides nothing: its nearness on the screen is too steep, m.
#define PLANE_DISTANCE_MIN 1e-2f

// A convex piece in view space: points (x right, y up, z depth), and the planes that face the eye:
// normal . point = offset < 0.
typedef struct Piece {
    Vec3 points[EDGES_CAP];
    u32 point_count;
    Vec3 normals[3];
    f32 offsets[3];
    u32 plane_count;
} Piece;

static Vec3 to_view(const PacketView *view, Vec3 point_ws) {
    Vec3 from_eye = vec3_sub(point_ws, view->position);
    return vec3(vec3_dot(from_eye, view->right), vec3_dot(from_eye, view->up),
                vec3_dot(from_eye, view->forward));
}
static Vec3 direction_to_view(const PacketView *view, Vec3 v) {
    return vec3(vec3_dot(v, view->right), vec3_dot(v, view->up), vec3_dot(v, view->forward));
}

// ---- drawing ----

// a x + b y + c >= 0 inside; texels.
typedef struct Edge {
    f64 a, b, c;
} Edge;

// Texels; a point near the eye may lie millions of them outside.
typedef struct Point2 {
    f64 x, y;
} Point2;

static Point2 project(const OcclusionBuffer *buffer, Vec3 p) {
    const PacketView *v = &buffer->view;
    f64 depth = (f64)p.z;
    return (Point2){((f64)p.x / (depth * (f64)v->tan_x) * 0.5 + 0.5) * buffer->width[0],
                    (0.5 - (f64)p.y / (depth * (f64)v->tan_y) * 0.5) * buffer->height[0]};
}

static f64 turn(Point2 a, Point2 b, Point2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Andrew's monotone chain; the outline runs so that the inside is where `turn` is positive. in is
// sorted in place; out has room for count + 1.
static u32 convex_hull(Point2 *in, u32 count, Point2 *out) {
    for (u32 i = 1; i < count; i++)
        for (u32 k = i;
             k > 0 && (in[k].x < in[k - 1].x || (in[k].x == in[k - 1].x && in[k].y < in[k - 1].y));
             k--) {
            Point2 swap = in[k];
            in[k] = in[k - 1], in[k - 1] = swap;
        }
    u32 n = 0;
    for (u32 i = 0; i < count; i++) {
        while (n >= 2 && turn(out[n - 2], out[n - 1], in[i]) <= 0.0) n--;
        out[n++] = in[i];
    }
    for (u32 i = count - 1, lower = n + 1; i-- > 0;) {
        while (n >= lower && turn(out[n - 2], out[n - 1], in[i]) <= 0.0) n--;
        out[n++] = in[i];
    }
    return n > 0 ? n - 1 : 0; // the first point came again
}

// Nearness at texel coordinates: at + x * right + y * down (1 / depth is linear on the screen).
typedef struct Nearness {
    f32 at, right, down;
} Nearness;

static Nearness plane_nearness(const OcclusionBuffer *buffer, Vec3 n, f32 offset) {
    f32 w = (f32)buffer->width[0], h = (f32)buffer->height[0], k = 1.0f / offset;
    f32 tx = buffer->view.tan_x, ty = buffer->view.tan_y;
    return (Nearness){(n.x * -tx + n.y * ty + n.z) * k, n.x * 2.0f * tx / w * k,
                      n.y * -2.0f * ty / h * k};
}

// Writes texels [x0, x1) of a row: the nearer of what is there and the piece, whose nearness in a
// texel is the least of its planes at that texel's worst corner. slack: what rounding may add.
SIMD_CLONES
static void fill_run(f32 *row, u32 x0, u32 x1, f32 y, const Nearness planes[3], f32 slack) {
    f32 base[3], step[3];
    for (u32 k = 0; k < 3; k++) {
        const Nearness *p = &planes[k];
        base[k] = p->at + (p->right < 0.0f ? p->right : 0.0f) +
                  p->down * (p->down < 0.0f ? y + 1.0f : y) - slack;
        step[k] = p->right;
    }
    for (u32 x = x0; x < x1; x++) {
        f32 at = (f32)(i32)x;
        f32 n0 = base[0] + step[0] * at, n1 = base[1] + step[1] * at, n2 = base[2] + step[2] * at;
        f32 n = n0 < n1 ? n0 : n1;
        n = n < n2 ? n : n2;
        row[x] = n > row[x] ? n : row[x];
    }
}

static bool fill_outline(OcclusionBuffer *buffer, const Point2 *outline, u32 count,
                         const Nearness planes[3]) {
    if (count < 3 || count > EDGES_CAP) return false;
    Edge edges[EDGES_CAP];
    f64 top = INFINITY, bottom = -INFINITY, width = buffer->width[0], height = buffer->height[0];
    f32 slack = 0.0f;
    for (u32 k = 0; k < 3; k++)
        slack = MAX(slack, 4e-7f * (fabsf(planes[k].at) + fabsf(planes[k].right) * (f32)width +
                                    fabsf(planes[k].down) * (f32)height));
    for (u32 i = 0; i < count; i++) {
        Point2 p = outline[i], q = outline[(i + 1) % count];
        edges[i] = (Edge){p.y - q.y, q.x - p.x, 0.0};
        edges[i].c = -(edges[i].a * p.x + edges[i].b * p.y);
        top = MIN(top, p.y), bottom = MAX(bottom, p.y);
    }
    if (!(bottom > 0.0 && top < height)) return false;
    u32 y0 = top > 0.0 ? (u32)top : 0, y1 = bottom < height ? (u32)bottom : (u32)height;
    bool any = false;
    for (u32 y = y0; y < y1; y++) {
        f64 low = 0.0, high = width;
        for (u32 i = 0; i < count; i++) {
            const Edge *e = &edges[i];
            // The worse of the row's two borders decides for both.
            f64 rest = e->c + e->b * (e->b < 0.0 ? y + 1 : y);
            if (e->a > 0.0)
                low = MAX(low, -rest / e->a);
            else if (e->a < 0.0)
                high = MIN(high, rest / -e->a);
            else if (rest < 0.0)
                high = -1.0;
        }
        low = ceil(low > 0.0 ? low + COVERAGE_SLACK : 0.0);
        high = floor(high < width ? high - COVERAGE_SLACK : width);
        if (!(low < high)) continue;
        fill_run(buffer->low[0] + (u64)y * buffer->width[0], (u32)low, (u32)high, (f32)y, planes,
                 slack);
        any = true;
    }
    return any;
}

// All points must be in front of the near plane.
static bool draw_piece(OcclusionBuffer *buffer, const Piece *piece) {
    if (piece->plane_count == 0 || piece->point_count < 3) return false;
    Point2 points[EDGES_CAP], outline[EDGES_CAP + 1];
    Nearness planes[3];
    for (u32 i = 0; i < piece->point_count; i++) points[i] = project(buffer, piece->points[i]);
    for (u32 k = 0; k < 3; k++) {
        u32 plane = k < piece->plane_count ? k : 0;
        planes[k] = plane_nearness(buffer, piece->normals[plane], piece->offsets[plane]);
    }
    u32 count = convex_hull(points, piece->point_count, outline);
    return fill_outline(buffer, outline, count, planes);
}

// One polygon, cut at the near plane (Sutherland and Hodgman 1974). normal_ws points to its front.
// A hull of the cut polygon is the polygon itself, whichever way it winds.
static bool draw_polygon(OcclusionBuffer *buffer, const Vec3 *points_ws, u32 count,
                         Vec3 normal_ws) {
    const PacketView *view = &buffer->view;
    f32 length = vec3_length(normal_ws), near = view->near * 1.0001f;
    f32 offset = vec3_dot(normal_ws, vec3_sub(points_ws[0], view->position));
    if (count > OCCLUDER_POINTS_MAX || !(length > 0.0f) || !(offset < -PLANE_DISTANCE_MIN * length))
        return false;
    Piece piece = {.plane_count = 1};
    piece.normals[0] = direction_to_view(view, vec3_scale(normal_ws, 1.0f / length));
    piece.offsets[0] = offset / length;
    Vec3 from = to_view(view, points_ws[count - 1]);
    for (u32 i = 0; i < count; i++) {
        Vec3 to = to_view(view, points_ws[i]);
        if ((from.z < near) != (to.z < near)) {
            f32 t = (near - from.z) / (to.z - from.z);
            piece.points[piece.point_count++] =
                vec3(f32_lerp(from.x, to.x, t), f32_lerp(from.y, to.y, t), near);
        }
        if (to.z >= near) piece.points[piece.point_count++] = to;
        if (piece.point_count > OCCLUDER_POINTS_MAX) return false; // not convex, so not ours
        from = to;
    }
    return draw_piece(buffer, &piece);
}

// ---- boxes ----

static Vec3 box_corner(Vec3 middle, const Vec3 half[3], u32 corner) {
    for (u32 axis = 0; axis < 3; axis++)
        middle = vec3_add(middle, vec3_scale(half[axis], corner >> axis & 1 ? 1.0f : -1.0f));
    return middle;
}

static bool draw_box(OcclusionBuffer *buffer, Vec3 middle, const Vec3 half[3]) {
    const PacketView *view = &buffer->view;
    Piece box = {.point_count = 8};
    bool cut = false;
    for (u32 i = 0; i < 8; i++) {
        box.points[i] = to_view(view, box_corner(middle, half, i));
        cut |= box.points[i].z < view->near * 1.0001f;
    }
    bool any = false;
    for (u32 face = 0; face < 6; face++) {
        u32 axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3 out = vec3_scale(half[axis], face & 1 ? 1.0f : -1.0f);
        Vec3 normal = vec3_cross(half[u], half[v]);
        if (vec3_dot(normal, out) < 0.0f) normal = vec3_scale(normal, -1.0f);
        f32 length = vec3_length(normal);
        Vec3 on_face = vec3_add(middle, out);
        f32 offset = vec3_dot(normal, vec3_sub(on_face, view->position));
        // A flat box has faces without a direction: it hides nothing.
        if (!(length > 0.0f) || !(vec3_dot(normal, out) > 1e-6f * length)) return false;
        if (!(offset < 0.0f)) continue;
        if (!(offset < -PLANE_DISTANCE_MIN * length)) return any;
        if (cut) { // what the near plane cuts open shows the inside: only faces hide
            Vec3 a = half[u], b = half[v], c = on_face;
            Vec3 points[4] = {vec3_sub(vec3_sub(c, a), b), vec3_sub(vec3_add(c, a), b),
                              vec3_add(vec3_add(c, a), b), vec3_add(vec3_sub(c, a), b)};
            any |= draw_polygon(buffer, points, 4, normal);
        } else if (box.plane_count < 3) { // more than three never face the eye
            box.normals[box.plane_count] =
                direction_to_view(view, vec3_scale(normal, 1.0f / length));
            box.offsets[box.plane_count++] = offset / length;
        }
    }
    return cut ? any : draw_piece(buffer, &box);
}

// ---- occluders ----

static bool draw_mesh(OcclusionBuffer *buffer, const OccluderPolygons *polygons, u32 mesh,
                      const Mat34 *world) {
    bool any = false;
    if (mesh >= polygons->mesh_count) return false;
    for (u32 i = polygons->first[mesh]; i < polygons->first[mesh + 1]; i++) {
        Vec3 points[OCCLUDER_POINTS_MAX], normal = {0};
        u32 count = polygons->begin[i + 1] - polygons->begin[i];
        for (u32 k = 0; k < count; k++)
            points[k] = mat34_point(world, polygons->points[polygons->begin[i] + k]);
        for (u32 k = 2; k < count; k++)
            normal = vec3_add(normal, vec3_cross(vec3_sub(points[k - 1], points[0]),
                                                 vec3_sub(points[k], points[0])));
        any |= draw_polygon(buffer, points, count, normal);
    }
    return any;
}

// Only opaque surfaces hide; those of a hidden instance have a negative radius.
static bool draw_instance(OcclusionBuffer *buffer, const World *world,
                          const OccluderPolygons *polygons, Entity entity) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    const MaterialTable *m = WORLD_TABLE(world, Material, material);
    bool any = false;
    for (u32 row = 0; row < d->table.count; row++) {
        if (d->owner[row] != entity || d->bounds_radius[row] < 0.0f) continue;
        u32 material = table_row(&m->table, d->material[row]);
        if (material != ROW_NONE && m->alpha_mode[material] != ALPHA_OPAQUE) continue;
        Mat34 place;
        columns_get_mat34(&d->w00, row, place.m);
        any |= draw_mesh(buffer, polygons, d->mesh[row], &place);
    }
    return any;
}

static bool draw_box_row(OcclusionBuffer *buffer, const World *world, u32 row) {
    const OccluderTable *o = WORLD_TABLE(world, Occluder, occluder);
    const TransformTable *t = WORLD_TABLE(world, Transform, transform);
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    Entity entity = o->table.entity[row];
    u32 place = table_row(&t->table, entity), shown = table_row(&instances->table, entity);
    if (place == ROW_NONE || (shown != ROW_NONE && !instances->visible[shown])) return false;
    Mat34 m;
    columns_get_mat34(&t->w00, place, m.m);
    const f32 size[3] = {o->size_x[row], o->size_y[row], o->size_z[row]};
    Vec3 half[3];
    for (u32 axis = 0; axis < 3; axis++)
        half[axis] = vec3_scale(vec3(m.m[axis], m.m[4 + axis], m.m[8 + axis]), 0.5f * size[axis]);
    Vec3 center = {o->center_x[row], o->center_y[row], o->center_z[row]};
    return draw_box(buffer, mat34_point(&m, center), half);
}

static void build_pyramids(OcclusionBuffer *buffer) {
    for (u32 level = 1; level < buffer->level_count; level++) {
        u32 w = buffer->width[level], h = buffer->height[level];
        u32 below_w = buffer->width[level - 1], below_h = buffer->height[level - 1];
        for (u32 y = 0; y < h; y++) {
            u64 upper = (u64)(2 * y) * below_w, lower = (u64)MIN(2 * y + 1, below_h - 1) * below_w;
            for (u32 x = 0; x < w; x++) {
                u32 left = 2 * x, right = MIN(2 * x + 1, below_w - 1);
                const f32 *low = buffer->low[level - 1], *high = buffer->high[level - 1];
                f32 a = MIN(low[upper + left], low[upper + right]),
                    b = MIN(low[lower + left], low[lower + right]),
                    c = MAX(high[upper + left], high[upper + right]),
                    d = MAX(high[lower + left], high[lower + right]);
                buffer->low[level][(u64)y * w + x] = MIN(a, b);
                buffer->high[level][(u64)y * w + x] = MAX(c, d);
            }
        }
    }
}

OcclusionBuffer *occlusion_draw(const World *world, const AssetStore *assets,
                                const OccluderPolygons *polygons, const PacketView *view,
                                Arena *arena) {
    const OccluderTable *o = WORLD_TABLE(world, Occluder, occluder);
    if (o->table.count == 0) return NULL;
    bool any_mesh = false;
    for (u32 row = 0; row < o->table.count; row++) any_mesh |= o->shape[row] == OCCLUDER_MESH;
    OcclusionBuffer *buffer = ARENA_PUSH(arena, OcclusionBuffer, 1);
    buffer->view = *view;
    f32 height = (f32)OCCLUSION_WIDTH * view->tan_y / view->tan_x + 0.5f;
    buffer->width[0] = OCCLUSION_WIDTH;
    buffer->height[0] = (u32)CLAMP(height, 8.0f, (f32)OCCLUSION_HEIGHT_MAX);
    for (u32 level = 0;; level++) {
        u64 texels = (u64)buffer->width[level] * buffer->height[level];
        buffer->low[level] = ARENA_PUSH_COLUMN(arena, f32, texels);
        buffer->high[level] = level ? ARENA_PUSH_COLUMN(arena, f32, texels) : buffer->low[level];
        buffer->level_count = level + 1;
        if (texels == 1 || buffer->level_count == OCCLUSION_LEVELS_CAP) break;
        buffer->width[level + 1] = (buffer->width[level] + 1) / 2;
        buffer->height[level + 1] = (buffer->height[level] + 1) / 2;
    }
    if (any_mesh && !polygons) {
        Arena local; // scratch of the joining; this way is for tests and tools only
        LUZ_ASSERT(arena_create(&local, "occluder polygons", GIB(1)));
        polygons = occluder_polygons_build(world, assets, arena, &local);
        arena_destroy(&local);
    }
    for (u32 row = 0; row < o->table.count; row++)
        buffer->occluders += o->shape[row] == OCCLUDER_MESH
                                 ? draw_instance(buffer, world, polygons, o->table.entity[row])
                                 : draw_box_row(buffer, world, row);
    build_pyramids(buffer);
    return buffer;
}

// ---- testing ----

typedef struct TexelRect {
    i32 x0, y0, x1, y1; // inclusive, level 0
} TexelRect;

// Is every texel of the rectangle that lies in this node nearer than `limit`?
static bool node_covers(const OcclusionBuffer *buffer, u32 level, i32 x, i32 y, TexelRect r,
                        f32 limit) {
    u64 at = (u64)y * buffer->width[level] + (u64)x;
    if (buffer->low[level][at] > limit) return true;
    if (level == 0 || !(buffer->high[level][at] > limit)) return false;
    i32 below = (i32)level - 1;
    i32 x0 = MAX(2 * x, r.x0 >> below), x1 = MIN(2 * x + 1, r.x1 >> below);
    i32 y0 = MAX(2 * y, r.y0 >> below), y1 = MIN(2 * y + 1, r.y1 >> below);
    for (i32 j = y0; j <= y1; j++)
        for (i32 i = x0; i <= x1; i++)
            if (!node_covers(buffer, level - 1, i, j, r, limit)) return false;
    return true;
}

bool occlusion_hides_sphere(const OcclusionBuffer *buffer, Vec3 center, f32 radius) {
    const PacketView *view = &buffer->view;
    Vec3 c = to_view(view, center);
    f32 nearest = c.z - radius * (1.0f + 1e-5f);
    if (!(nearest > view->near)) return false;
    f32 limit = 1.0f / nearest;
    // Most spheres are seen at their middle, which needs no exact bounds.
    f32 mx = (c.x / (c.z * view->tan_x) * 0.5f + 0.5f) * (f32)buffer->width[0],
        my = (0.5f - c.y / (c.z * view->tan_y) * 0.5f) * (f32)buffer->height[0];
    if (mx >= 0.0f && my >= 0.0f && mx < (f32)buffer->width[0] && my < (f32)buffer->height[0] &&
        !(buffer->low[0][(u32)my * buffer->width[0] + (u32)mx] > limit))
        return false;
    f32 x0, x1, y0, y1;
    if (!sphere_bounds_axis(c.x, -c.z, radius, view->near, 1.0f / view->tan_x, &x0, &x1) ||
        !sphere_bounds_axis(c.y, -c.z, radius, view->near, 1.0f / view->tan_y, &y0, &y1))
        return false; // outside the view: somebody else's business
    f32 w = (f32)buffer->width[0] * 0.5f, h = (f32)buffer->height[0] * 0.5f;
    i32 right = (i32)buffer->width[0] - 1, bottom = (i32)buffer->height[0] - 1;
    // A rectangle that ends on a texel's border takes the next one as well: never less.
    TexelRect r = {
        (i32)floorf(x0 * w + w - COVERAGE_SLACK), (i32)floorf(h - y1 * h - COVERAGE_SLACK),
        (i32)floorf(x1 * w + w + COVERAGE_SLACK), (i32)floorf(h - y0 * h + COVERAGE_SLACK)};
    r = (TexelRect){CLAMP(r.x0, 0, right), CLAMP(r.y0, 0, bottom), CLAMP(r.x1, 0, right),
                    CLAMP(r.y1, 0, bottom)};
    u32 top = 0; // the level at which the rectangle is at most two texels wide and high
    while (top + 1 < buffer->level_count &&
           ((r.x1 >> top) - (r.x0 >> top) > 1 || (r.y1 >> top) - (r.y0 >> top) > 1))
        top++;
    for (i32 j = r.y0 >> top; j <= r.y1 >> top; j++)
        for (i32 i = r.x0 >> top; i <= r.x1 >> top; i++)
            if (!node_covers(buffer, top, i, j, r, limit)) return false;
    return true;
}

typedef struct CullJob {
    const OcclusionBuffer *buffer;
    const f32 *x, *y, *z, *radius;
    const u32 *rows;
    u8 *hidden;
} CullJob;

static void job_cull(void *context, u32 begin, u32 end, u32 thread_index) {
    (void)thread_index;
    const CullJob *job = context;
    for (u32 i = begin; i < end; i++) {
        u32 row = job->rows[i];
        job->hidden[i] = occlusion_hides_sphere(
            job->buffer, vec3(job->x[row], job->y[row], job->z[row]), job->radius[row]);
    }
}

u32 occlusion_cull(const OcclusionBuffer *buffer, const f32 *x, const f32 *y, const f32 *z,
                   const f32 *radius, u32 *rows, u32 count, Arena *scratch) {
    if (!buffer || buffer->occluders == 0) return count;
    u64 mark = arena_mark(scratch);
    CullJob job = {buffer, x, y, z, radius, rows, ARENA_PUSH(scratch, u8, count)};
    jobs_for(count, SPHERES_PER_JOB, job_cull, &job);
    u32 kept = 0;
    for (u32 i = 0; i < count; i++) {
        rows[kept] = rows[i];
        kept += !job.hidden[i];
    }
    arena_rewind(scratch, mark);
    return kept;
}
