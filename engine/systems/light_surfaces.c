// light_surfaces.c: a grid of distances to standing surfaces.
// Data in: drawables that stand still, their triangles, where the local lights are. Data out: the
// grid of light_surfaces.h. Called by: the light manager's state when a level is loaded; read when
// pairs are judged. Does not: follow doors or anything else that moves, or know small things'
// shapes better than a cell.
#include "light_surfaces.h"
#include <string.h>

#define MARGIN_M 3.0f // lights move about where they are

static bool find_region(const LightTable *light, Vec3 *low, Vec3 *high) {
    *low = vec3(INFINITY, INFINITY, INFINITY), *high = vec3(-INFINITY, -INFINITY, -INFINITY);
    for (u32 row = 0; row < light->table.count; row++) {
        if (light->kind[row] == LIGHT_DIRECTIONAL) continue;
        f32 x = light->x[row], y = light->y[row], z = light->z[row];
        if (!(fabsf(x) < 1e6f && fabsf(y) < 1e6f && fabsf(z) < 1e6f)) continue;
        low->x = MIN(low->x, x), low->y = MIN(low->y, y), low->z = MIN(low->z, z);
        high->x = MAX(high->x, x), high->y = MAX(high->y, y), high->z = MAX(high->z, z);
    }
    Vec3 margin = {MARGIN_M, MARGIN_M, MARGIN_M};
    bool any = low->x <= high->x;
    *low = vec3_sub(*low, margin), *high = vec3_add(*high, margin);
    return any;
}

static f32 axis_of(Vec3 v, u32 axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// Marks the cells that the triangle's box and plane both pass through: a few more than those that
// the triangle itself does.
static void mark_triangle(LightSurfaces *s, const Vec3 p[3]) {
    u32 size[3] = {s->nx, s->ny, s->nz}, first[3], last[3];
    for (u32 a = 0; a < 3; a++) {
        f32 x = axis_of(p[0], a), y = axis_of(p[1], a), z = axis_of(p[2], a);
        f32 low = (MIN(MIN(x, y), z) - axis_of(s->origin, a)) / s->cell_m,
            high = (MAX(MAX(x, y), z) - axis_of(s->origin, a)) / s->cell_m;
        if (!(high >= 1.0f && low < (f32)(size[a] - 1))) return;
        first[a] = low > 1.0f ? (u32)low : 1;
        last[a] = high < (f32)(size[a] - 1) ? (u32)high : size[a] - 2;
    }
    Vec3 n = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    f32 reach = 0.5f * s->cell_m * (fabsf(n.x) + fabsf(n.y) + fabsf(n.z)) * 1.001f;
    f32 offset = vec3_dot(n, p[0]);
    for (u32 z = first[2]; z <= last[2]; z++)
        for (u32 y = first[1]; y <= last[1]; y++)
            for (u32 x = first[0]; x <= last[0]; x++) {
                Vec3 middle = vec3_add(
                    s->origin,
                    vec3_scale(vec3((f32)x + 0.5f, (f32)y + 0.5f, (f32)z + 0.5f), s->cell_m));
                if (fabsf(vec3_dot(n, middle) - offset) <= reach)
                    s->distance[((u64)z * s->ny + y) * s->nx + x] = 0;
            }
}

static void mark_mesh(LightSurfaces *s, const Mesh *mesh, const Mat34 *place) {
    for (u32 i = 0; i + 2 < mesh->lods[0].index_count; i += 3) {
        Vec3 p[3];
        for (u32 k = 0; k < 3; k++) {
            const f32 *v = mesh->vertices[mesh->indices[i + k]].position;
            p[k] = mat34_point(place, vec3(v[0], v[1], v[2]));
        }
        mark_triangle(s, p);
    }
}

static bool stands_still(const World *world, Entity owner) {
    static const u32 movers[] = {COMPONENT_orbit, COMPONENT_path, COMPONENT_light,
                                 COMPONENT_walker};
    for (u32 i = 0; i < COUNT_OF(movers); i++)
        if (table_row(world->tables[movers[i]], owner) != ROW_NONE) return false;
    const InstanceTable *instances = WORLD_TABLE(world, Instance, instance);
    u32 row = table_row(&instances->table, owner);
    return row != ROW_NONE && instances->voxel_mode[row] != VOXEL_DYNAMIC;
}

// Chamfer distance 3-4-5 (Borgefors 1986) in two passes: neighbours before and after in memory. The
// rim of cells, which is only the cap, spares the question whether there is a neighbour.
static void spread(LightSurfaces *s) {
    i64 step[13];
    u32 cost[13];
    for (i32 n = 0; n < 13; n++) { // those before the middle of the 27
        i32 dx = n % 3 - 1, dy = n / 3 % 3 - 1, dz = n / 9 - 1;
        step[n] = ((i64)dz * s->ny + dy) * s->nx + dx;
        cost[n] = 2u + (u32)(dx != 0) + (u32)(dy != 0) + (u32)(dz != 0);
    }
    for (u32 pass = 0; pass < 2; pass++)
        for (u32 k = 1; k + 1 < s->nz; k++)
            for (u32 j = 1; j + 1 < s->ny; j++) {
                u32 y = pass ? s->ny - 1 - j : j, z = pass ? s->nz - 1 - k : k;
                u8 *row = s->distance + ((u64)z * s->ny + y) * s->nx;
                for (u32 i = 1; i + 1 < s->nx; i++) {
                    u8 *here = row + (pass ? s->nx - 1 - i : i);
                    u32 least = *here;
                    for (u32 n = 0; n < 13; n++) {
                        u32 there = here[pass ? -step[n] : step[n]] + cost[n];
                        least = MIN(least, there);
                    }
                    *here = (u8)least;
                }
            }
}

LightSurfaces *light_surfaces_build(const World *world, const AssetStore *assets, Arena *arena) {
    Vec3 low, high;
    if (!find_region(WORLD_TABLE(world, Light, light), &low, &high)) return NULL;
    LightSurfaces *s = ARENA_PUSH(arena, LightSurfaces, 1);
    Vec3 size = vec3_sub(high, low);
    // A region of any size ends below the limit.
    for (s->cell_m = LIGHT_SURFACES_CELL_M;; s->cell_m *= 1.25f) {
        f64 nx = ceil((f64)size.x / (f64)s->cell_m) + 2,
            ny = ceil((f64)size.y / (f64)s->cell_m) + 2,
            nz = ceil((f64)size.z / (f64)s->cell_m) + 2;
        if (nx * ny * nz > LIGHT_SURFACES_CELLS) continue;
        s->nx = (u32)nx, s->ny = (u32)ny, s->nz = (u32)nz;
        break;
    }
    s->origin = vec3_sub(low, vec3(s->cell_m, s->cell_m, s->cell_m));
    u64 cells = (u64)s->nx * s->ny * s->nz;
    s->distance = ARENA_PUSH(arena, u8, cells);
    memset(s->distance, LIGHT_SURFACES_CAP, cells);
    const DrawableTable *d = WORLD_TABLE(world, Drawable, drawable);
    for (u32 row = 0; row < d->table.count; row++) {
        if (d->bounds_radius[row] < 0.0f || d->mesh[row] >= assets->mesh_count ||
            !stands_still(world, d->owner[row]))
            continue;
        Mat34 place;
        columns_get_mat34(&d->w00, row, place.m);
        mark_mesh(s, &assets->meshes[d->mesh[row]], &place);
    }
    spread(s);
    return s;
}

f32 light_surface_distance(const LightSurfaces *s, Vec3 place, f32 unknown) {
    if (!s) return unknown;
    Vec3 at = vec3_scale(vec3_sub(place, s->origin), 1.0f / s->cell_m);
    if (!(at.x >= 0.0f && at.y >= 0.0f && at.z >= 0.0f && at.x < (f32)s->nx && at.y < (f32)s->ny &&
          at.z < (f32)s->nz))
        return unknown;
    u64 cell = ((u64)at.z * s->ny + (u64)at.y) * s->nx + (u64)at.x;
    return (f32)s->distance[cell] * s->cell_m / 3.0f;
}
