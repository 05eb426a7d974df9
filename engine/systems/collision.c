// collision.c: what a walker can bump into: static triangles in a grid, boxes that follow entities.
// Data in: instances with collision = mesh (through their drawables and meshes) once, after
// loading; instances with collision = box every time it is asked. Data out: the triangles and boxes
// near a place. Called by: session (create, destroy), walk.c. Does not: move anything (walk.c),
// measure distances (contact.c), or follow instances with collision = mesh that move.
//
// The grid is uniform, about a metre a cell, and in compressed rows: first[cell] .. first[cell + 1]
// index into items. Cells grow until the grid is small enough, so a huge level is only slower.
#include "collision.h"
#include "../base/log.h"
#include <math.h>
#include <string.h>

#define CELL_M         1.0f
#define CELLS_CAP      (1u << 21)
#define ITEMS_CAP      (1u << 25)
#define TRIANGLES_CAP  (1u << 23)
#define SPAWNS_CAP     64
#define FALL_M         20.0f
#define COORDINATE_MAX 1e6f // m; what lies beyond (or is not a number) is no obstacle

typedef struct Triangle {
    Vec3 a, b, c;
} Triangle;
typedef struct Box3 {
    Vec3 min, max;
} Box3;

struct CollisionWorld {
    Arena arena;
    const AssetStore *assets;
    Triangle *triangles;
    u32 *seen; // [triangle_count] query in which it was last found
    u32 triangle_count, query;
    Box3 bounds; // of triangles and boxes
    Vec3 origin;
    f32 cell_m;
    u32 size[3];
    u32 *first, *items; // [cells + 1], [first[cells]]
    struct {
        Entity walker;
        Vec3 position;
    } spawns[SPAWNS_CAP];
    u32 spawn_count;
};

static Vec3 vec3_min(Vec3 a, Vec3 b) { return vec3(MIN(a.x, b.x), MIN(a.y, b.y), MIN(a.z, b.z)); }
static Vec3 vec3_max(Vec3 a, Vec3 b) { return vec3(MAX(a.x, b.x), MAX(a.y, b.y), MAX(a.z, b.z)); }
static bool in_range(Vec3 p) { // false for NaN
    return fabsf(p.x) < COORDINATE_MAX && fabsf(p.y) < COORDINATE_MAX &&
           fabsf(p.z) < COORDINATE_MAX;
}
static Box3 triangle_box(const Triangle *t) {
    return (Box3){vec3_min(vec3_min(t->a, t->b), t->c), vec3_max(vec3_max(t->a, t->b), t->c)};
}
static bool boxes_touch(Vec3 a_min, Vec3 a_max, Vec3 b_min, Vec3 b_max) {
    return a_min.x <= b_max.x && b_min.x <= a_max.x && a_min.y <= b_max.y && b_min.y <= a_max.y &&
           a_min.z <= b_max.z && b_min.z <= a_max.z;
}

// ---- building ----

static bool is_static_mesh(const World *world, u32 drawable) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    u32 owner =
        table_row(&instances->table, WORLD_TABLE(world, Drawable, drawable)->owner[drawable]);
    return owner != ROW_NONE && instances->collision[owner] == COLLISION_MESH;
}

static const Mesh *drawable_mesh(const World *world, const AssetStore *assets, u32 drawable) {
    u32 mesh = WORLD_TABLE(world, Drawable, drawable)->mesh[drawable];
    return &assets->meshes[mesh < assets->mesh_count ? mesh : 0];
}

static void collect_triangles(CollisionWorld *collision, const World *world) {
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    u64 total = 0;
    for (u32 row = 0; row < d->table.count; row++)
        if (is_static_mesh(world, row))
            total += drawable_mesh(world, collision->assets, row)->index_count / 3;
    if (total > TRIANGLES_CAP)
        LOG(WORLD_LIMIT, "%llu triangles to collide with, only the first %u do",
            (unsigned long long)total, TRIANGLES_CAP);
    u32 cap = (u32)MIN(total, TRIANGLES_CAP);
    collision->triangles = ARENA_PUSH(&collision->arena, Triangle, cap);
    for (u32 row = 0; row < d->table.count; row++) {
        if (!is_static_mesh(world, row)) continue;
        const Mesh *mesh = drawable_mesh(world, collision->assets, row);
        Mat34 matrix;
        columns_get_mat34(&d->w00, row, matrix.m);
        for (u32 i = 0; i + 2 < mesh->index_count && collision->triangle_count < cap; i += 3) {
            Vec3 corners[3];
            for (u32 k = 0; k < 3; k++) {
                const f32 *p = mesh->vertices[mesh->indices[i + k]].position;
                corners[k] = mat34_point(&matrix, vec3(p[0], p[1], p[2]));
            }
            Vec3 normal =
                vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
            bool solid = vec3_dot(normal, normal) > 0.0f; // a needle without area stops nobody
            if (!solid || !in_range(corners[0]) || !in_range(corners[1]) || !in_range(corners[2]))
                continue;
            collision->triangles[collision->triangle_count++] =
                (Triangle){corners[0], corners[1], corners[2]};
        }
    }
    collision->seen = ARENA_PUSH(&collision->arena, u32, collision->triangle_count);
}

typedef struct CellRange {
    u32 min[3], max[3];
} CellRange; // inclusive

static u32 cell_at(f32 position, f32 origin, f32 cell_m, u32 size) {
    f32 cell = (position - origin) / cell_m;
    return cell <= 0.0f ? 0 : cell >= (f32)size ? size - 1 : (u32)cell;
}

static CellRange cells_of(const CollisionWorld *c, Vec3 min, Vec3 max) {
    CellRange range;
    const f32 lo[3] = {min.x, min.y, min.z}, hi[3] = {max.x, max.y, max.z},
              origin[3] = {c->origin.x, c->origin.y, c->origin.z};
    for (u32 a = 0; a < 3; a++) {
        range.min[a] = cell_at(lo[a], origin[a], c->cell_m, c->size[a]);
        range.max[a] = cell_at(hi[a], origin[a], c->cell_m, c->size[a]);
    }
    return range;
}

#define FOR_CELLS(range, collision, cell)                                                          \
    for (u32 z_ = (range).min[2]; z_ <= (range).max[2]; z_++)                                      \
        for (u32 y_ = (range).min[1]; y_ <= (range).max[1]; y_++)                                  \
            for (u32 cell =                                                                        \
                         (z_ * (collision)->size[1] + y_) * (collision)->size[0] + (range).min[0], \
                     end_ = cell + (range).max[0] - (range).min[0];                                \
                 cell <= end_; cell++)

// How many cell entries all triangles make at the present cell size.
static u64 count_items(const CollisionWorld *c) {
    u64 total = 0;
    for (u32 i = 0; i < c->triangle_count; i++) {
        Box3 box = triangle_box(&c->triangles[i]);
        CellRange r = cells_of(c, box.min, box.max);
        total +=
            (u64)(r.max[0] - r.min[0] + 1) * (r.max[1] - r.min[1] + 1) * (r.max[2] - r.min[2] + 1);
    }
    return total;
}

static void build_grid(CollisionWorld *c) {
    Vec3 extent = vec3_sub(c->bounds.max, c->bounds.min);
    c->origin = c->bounds.min;
    for (c->cell_m = CELL_M;; c->cell_m *= 2.0f) {
        const f32 sides[3] = {extent.x, extent.y, extent.z};
        u64 cells = 1;
        for (u32 a = 0; a < 3; a++) {
            c->size[a] = (u32)(sides[a] / c->cell_m) + 1;
            cells *= c->size[a];
        }
        if (cells <= CELLS_CAP && count_items(c) <= ITEMS_CAP) break;
    }
    u32 cell_count = c->size[0] * c->size[1] * c->size[2];
    c->first = ARENA_PUSH(&c->arena, u32, cell_count + 1);
    for (u32 i = 0; i < c->triangle_count; i++) {
        Box3 box = triangle_box(&c->triangles[i]);
        CellRange range = cells_of(c, box.min, box.max);
        FOR_CELLS(range, c, cell) c->first[cell + 1]++;
    }
    for (u32 i = 0; i < cell_count; i++) c->first[i + 1] += c->first[i];
    c->items = ARENA_PUSH(&c->arena, u32, c->first[cell_count]);
    // Filling moves first[cell] to its end, which is where first[cell + 1] was: shift back after.
    for (u32 i = 0; i < c->triangle_count; i++) {
        Box3 box = triangle_box(&c->triangles[i]);
        CellRange range = cells_of(c, box.min, box.max);
        FOR_CELLS(range, c, cell) c->items[c->first[cell]++] = i;
    }
    memmove(c->first + 1, c->first, cell_count * sizeof *c->first);
    c->first[0] = 0;
}

// ---- boxes ----

static const u8 box_faces[12][3] = {{0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3},
                                    {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                    {0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}};

// Corners of an instance's model box in the world: corner k takes bit 0 in x, 1 in y, 2 in z.
// False if the instance has no model or no place.
static bool box_corners(const World *world, const AssetStore *assets, u32 instance, Vec3 corners[8],
                        Mat34 *unit_to_world) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    const TransformTable *transforms = WORLD_TABLE(world, Transform, transform);
    const ModelTable *models = WORLD_TABLE(world, Model, model);
    u32 place = table_row(&transforms->table, instances->table.entity[instance]);
    u32 model_row = table_row(&models->table, instances->model[instance]);
    if (place == ROW_NONE || model_row == ROW_NONE) return false;
    if (models->model[model_row] >= assets->model_count) return false;
    const Model *model = &assets->models[models->model[model_row]];
    Vec3 center = vec3_scale(vec3_add(model->min, model->max), 0.5f);
    Vec3 half = vec3_scale(vec3_sub(model->max, model->min), 0.5f);
    Mat34 matrix;
    columns_get_mat34(&transforms->w00, place, matrix.m);
    *unit_to_world = mat34_mul(
        matrix, (Mat34){{half.x, 0, 0, center.x, 0, half.y, 0, center.y, 0, 0, half.z, center.z}});
    for (u32 k = 0; k < 8; k++) {
        Vec3 corner = {k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f};
        corners[k] = mat34_point(unit_to_world, corner);
        if (!in_range(corners[k])) return false;
    }
    return true;
}

static void grow_bounds(Box3 *bounds, Vec3 p) {
    bounds->min = vec3_min(bounds->min, p);
    bounds->max = vec3_max(bounds->max, p);
}

CollisionWorld *collision_create(const World *world, const AssetStore *assets) {
    Arena arena;
    LUZ_ASSERT(arena_create(&arena, "collision", GIB(1)));
    CollisionWorld *collision = ARENA_PUSH(&arena, CollisionWorld, 1);
    collision->arena = arena;
    collision->assets = assets;
    collect_triangles(collision, world);

    Box3 bounds = {vec3(INFINITY, INFINITY, INFINITY), vec3(-INFINITY, -INFINITY, -INFINITY)};
    for (u32 i = 0; i < collision->triangle_count; i++) {
        Box3 box = triangle_box(&collision->triangles[i]);
        grow_bounds(&bounds, box.min);
        grow_bounds(&bounds, box.max);
    }
    collision->bounds = bounds;
    if (collision->triangle_count > 0) build_grid(collision);

    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    for (u32 row = 0; row < instances->table.count; row++) {
        Vec3 corners[8];
        Mat34 unused;
        if (instances->collision[row] != COLLISION_BOX ||
            !box_corners(world, assets, row, corners, &unused))
            continue;
        for (u32 k = 0; k < 8; k++) grow_bounds(&collision->bounds, corners[k]);
    }
    const WalkerTable *walkers = WORLD_TABLE(world, Walker, walker);
    const TransformTable *t = WORLD_TABLE(world, Transform, transform);
    for (u32 i = 0; i < walkers->table.count; i++) {
        u32 row = table_row(&t->table, walkers->table.entity[i]);
        if (row != ROW_NONE)
            collision_spawn(collision, t->table.entity[row], vec3(t->x[row], t->y[row], t->z[row]));
    }
    return collision;
}

void collision_destroy(CollisionWorld *collision) {
    if (!collision) return;
    Arena arena = collision->arena; // it holds the struct itself
    arena_destroy(&arena);
}

Vec3 collision_spawn(CollisionWorld *collision, Entity walker, Vec3 position) {
    for (u32 i = 0; i < collision->spawn_count; i++)
        if (collision->spawns[i].walker == walker) return collision->spawns[i].position;
    if (collision->spawn_count < SPAWNS_CAP) {
        collision->spawns[collision->spawn_count].walker = walker;
        collision->spawns[collision->spawn_count++].position = position;
    }
    return position;
}

f32 collision_floor_y(const CollisionWorld *collision) {
    f32 lowest = collision->bounds.min.y; // infinite in a level without obstacles
    for (u32 i = 0; i < collision->spawn_count; i++)
        lowest = MIN(lowest, collision->spawns[i].position.y);
    return lowest - FALL_M;
}

// ---- asking ----

static void add_triangle(NearShapes *shapes, Triangle t) {
    Box3 box = triangle_box(&t);
    Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(t.b, t.a), vec3_sub(t.c, t.a)));
    shapes->triangles[shapes->triangle_count++] =
        (NearTriangle){box.min, box.max, t.a, t.b, t.c, normal};
}

static void add_box(NearShapes *shapes, const Vec3 corners[8], const Mat34 *unit_to_world) {
    for (u32 f = 0; f < 12; f++)
        add_triangle(shapes, (Triangle){corners[box_faces[f][0]], corners[box_faces[f][1]],
                                        corners[box_faces[f][2]]});
    NearBox *box = &shapes->boxes[shapes->box_count++];
    box->to_unit = mat34_inverse(*unit_to_world);
    for (u32 a = 0; a < 3; a++) {
        // Row a of the inverse is the face's normal, and its length one over the half width.
        Vec3 row = {box->to_unit.m[4 * a], box->to_unit.m[4 * a + 1], box->to_unit.m[4 * a + 2]};
        f32 length = vec3_length(row);
        box->axis[a] = vec3_normalize(row);
        box->half_m[a] = length > 0.0f ? 1.0f / length : 0.0f;
    }
}

NearShapes collision_gather(CollisionWorld *c, const World *world, Vec3 min, Vec3 max,
                            Arena *scratch) {
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    NearShapes shapes = {0};
    u32 *box_rows = ARENA_PUSH(scratch, u32, instances->table.count), box_row_count = 0;
    for (u32 row = 0; row < instances->table.count; row++) {
        Vec3 corners[8];
        Mat34 unused;
        if (instances->collision[row] != COLLISION_BOX ||
            !box_corners(world, c->assets, row, corners, &unused))
            continue;
        Box3 box = {corners[0], corners[0]};
        for (u32 k = 1; k < 8; k++) grow_bounds(&box, corners[k]);
        if (boxes_touch(box.min, box.max, min, max)) box_rows[box_row_count++] = row;
    }
    u32 cap = 12 * box_row_count;
    CellRange range = {{1, 1, 1}, {0, 0, 0}};
    bool inside = c->triangle_count > 0 && boxes_touch(c->bounds.min, c->bounds.max, min, max);
    if (inside) range = cells_of(c, min, max);
    if (inside) FOR_CELLS(range, c, cell) cap += c->first[cell + 1] - c->first[cell];
    shapes.triangles = ARENA_PUSH(scratch, NearTriangle, cap);
    shapes.boxes = ARENA_PUSH(scratch, NearBox, box_row_count);
    c->query++;
    if (inside) {
        FOR_CELLS(range, c, cell) {
            for (u32 i = c->first[cell]; i < c->first[cell + 1]; i++) {
                u32 item = c->items[i];
                if (c->seen[item] == c->query) continue;
                c->seen[item] = c->query;
                Box3 box = triangle_box(&c->triangles[item]);
                if (boxes_touch(box.min, box.max, min, max))
                    add_triangle(&shapes, c->triangles[item]);
            }
        }
    }
    for (u32 i = 0; i < box_row_count; i++) {
        Vec3 corners[8];
        Mat34 unit_to_world;
        box_corners(world, c->assets, box_rows[i], corners, &unit_to_world);
        add_box(&shapes, corners, &unit_to_world);
    }
    return shapes;
}
