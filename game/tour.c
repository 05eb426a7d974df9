// tour.c: a camera flies from one camera of the level to the next, in name order, round and round.
//
// Data in: the level's cameras (names, world places, fields of view), the world's tick. Data out:
// the touring camera's transform and fov. Called by: the system table; on_load. A function of the
// tick alone: no state, so it can be cut, rewound and replayed. Does not: look out for walls; who
// places cameras such that the straight way is open gets a fine tour.
#include "tour.h"
#include <string.h>

COMPONENT_DEFINE(Tour, tour, TOUR_COLUMNS, false, "visits all cameras of the level")

#define STOPS_CAP 64

typedef struct Stop {
    const char *name;
    Vec3 position, rotation_deg;
    f32 fov;
} Stop;

// The cameras to visit, sorted by name; touring cameras and walkers' eyes are none.
static u32 gather_stops(const World *world, Stop *stops) {
    const CameraTable *cameras = WORLD_TABLE(world, Camera, camera);
    const TransformTable *places = WORLD_TABLE(world, Transform, transform);
    const Table *tours = world_find_table(world, "tour");
    const Table *walkers = world->tables[COMPONENT_walker];
    u32 count = 0;
    for (u32 i = 0; i < cameras->table.count && count < STOPS_CAP; i++) {
        Entity entity = cameras->table.entity[i];
        const char *name = world_name(world, entity);
        u32 row = table_row(&places->table, entity);
        if (!name[0] || row == ROW_NONE) continue;
        if (table_row(tours, entity) != ROW_NONE || table_row(walkers, entity) != ROW_NONE)
            continue;
        Mat34 place;
        columns_get_mat34(&places->w00, row, place.m);
        Stop stop = {name, mat34_translation(&place), mat34_rotation_deg(&place), cameras->fov[i]};
        u32 at = count++;
        for (; at > 0 && strcmp(stops[at - 1].name, name) > 0; at--) stops[at] = stops[at - 1];
        stops[at] = stop;
    }
    return count;
}

// Angles go the short way round.
static f32 lerp_deg(f32 from, f32 to, f32 t) {
    f32 turn = to - from;
    while (turn > 180.0f) turn -= 360.0f;
    while (turn < -180.0f) turn += 360.0f;
    return from + turn * t;
}

// Catmull-Rom: through b at t = 0 and c at t = 1, with the directions that a and d suggest.
static f32 spline(f32 a, f32 b, f32 c, f32 d, f32 t) {
    f32 t2 = t * t, t3 = t2 * t;
    return 0.5f * (2.0f * b + (c - a) * t + (2.0f * a - 5.0f * b + 4.0f * c - d) * t2 +
                   (3.0f * (b - c) + d - a) * t3);
}

static Stop between(const Stop *stops, u32 count, u32 index, f32 t) {
    const Stop *a = &stops[(index + count - 1) % count], *b = &stops[index];
    const Stop *c = &stops[(index + 1) % count], *d = &stops[(index + 2) % count];
    Vec3 pa = a->position, pb = b->position, pc = c->position, pd = d->position;
    return (Stop){.position =
                      vec3(spline(pa.x, pb.x, pc.x, pd.x, t), spline(pa.y, pb.y, pc.y, pd.y, t),
                           spline(pa.z, pb.z, pc.z, pd.z, t)),
                  .rotation_deg = vec3(lerp_deg(b->rotation_deg.x, c->rotation_deg.x, t),
                                       lerp_deg(b->rotation_deg.y, c->rotation_deg.y, t),
                                       lerp_deg(b->rotation_deg.z, c->rotation_deg.z, t)),
                  .fov = f32_lerp(b->fov, c->fov, t)};
}

// Every touring camera to where it is at this tick.
static void place_tours(World *world) {
    TourTable *tours = (TourTable *)world_find_table(world, "tour");
    if (tours->table.count == 0) return;
    Stop stops[STOPS_CAP];
    u32 count = gather_stops(world, stops);
    if (count == 0) return;
    CameraTable *cameras = WORLD_TABLE(world, Camera, camera);
    TransformTable *places = WORLD_TABLE(world, Transform, transform);
    for (u32 i = 0; i < tours->table.count; i++) {
        u32 row = table_row(&places->table, tours->table.entity[i]);
        u32 camera = table_row(&cameras->table, tours->table.entity[i]);
        if (row == ROW_NONE || camera == ROW_NONE) continue;
        // Whole ticks a leg: the division is exact however long the game runs.
        u32 stay = (u32)(tours->stay[i] * TICK_RATE), leg = (u32)(tours->leg[i] * TICK_RATE) + 1;
        u32 in_leg = world->tick % (stay + leg), index = world->tick / (stay + leg) % count;
        f32 way = in_leg > stay ? (f32)(in_leg - stay) / (f32)leg : 0.0f;
        Stop here = between(stops, count, index, f32_smoothstep(0.0f, 1.0f, way));
        places->x[row] = here.position.x;
        places->y[row] = here.position.y;
        places->z[row] = here.position.z;
        places->pitch[row] = here.rotation_deg.x;
        places->yaw[row] = here.rotation_deg.y;
        places->roll[row] = here.rotation_deg.z;
        cameras->fov[camera] = here.fov;
        table_touch(&places->table, row);
        table_touch(&cameras->table, camera);
    }
}

void system_tour(SystemContext *context) { place_tours(context->world); }

void tour_on_load(Session *session) {
    World *world = session->world;
    if (world_find(world, TOUR_CAMERA) == ENTITY_NONE) {
        Entity entity = luz_add_camera(world, TOUR_CAMERA, vec3(0, 0, 0), 0, 0);
        if (entity != ENTITY_NONE) table_add(world_find_table(world, "tour"), entity);
    }
    place_tours(world);
}
