// collision.h: what walk.c asks of the collision world. Private to systems/.
#ifndef LUZ_COLLISION_H
#define LUZ_COLLISION_H
#include "systems.h"

// A triangle near a walker, with its box for a quick refusal.
typedef struct NearTriangle {
    Vec3 min, max;
    Vec3 a, b, c;
    Vec3 normal; // unit; either side may be the outer one
} NearTriangle;

// A box that follows an instance: anything inside is pushed out of it.
typedef struct NearBox {
    Mat34 to_unit; // world to the cube -1..1
    Vec3 axis[3];  // unit normals of its faces, world (up to sign)
    f32 half_m[3]; // distance from its centre to the faces, along axis
} NearBox;

typedef struct NearShapes {
    NearTriangle *triangles; // of the static grid, then twelve a box
    u32 triangle_count;
    NearBox *boxes;
    u32 box_count;
} NearShapes;

// All that touches the box [min, max]. Lives in scratch.
NearShapes collision_gather(CollisionWorld *collision, const World *world, Vec3 min, Vec3 max,
                            Arena *scratch);

// Where a walker is put back to: its position when the collision world was made, or when this was
// first asked for.
Vec3 collision_spawn(CollisionWorld *collision, Entity walker, Vec3 position);
// Below this height a walker has fallen out of the level.
f32 collision_floor_y(const CollisionWorld *collision);

// A capsule that stands upright: the ball of `radius` moved from low to high.
typedef struct Capsule {
    Vec3 low, high;
    f32 radius;
} Capsule;
typedef struct Contact {
    f32 depth;    // how far they overlap; <= 0 = do not touch
    Vec3 normal;  // unit, from the obstacle to the capsule
    Vec3 point;   // on the obstacle
    Vec3 facing;  // normal of the obstacle's face, on the capsule's side
    bool at_foot; // the lower end of the capsule's axis is nearest
} Contact;
// Deepest one; of equally deep ones that which faces up most.
Contact collision_deepest(const NearShapes *shapes, const Capsule *capsule);

Vec3 closest_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);
#endif
