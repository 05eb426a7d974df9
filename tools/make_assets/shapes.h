// Shapes: boxes, lathes, sweeps, arches and surfaces, written as triangles into a Soup.
//
// Data in: dimensions in metres in the soup's current transform. Data out: triangles appended to
// the soup, outward faces counter-clockwise. Called by the models. Shapes do not weld or smooth:
// soup_build does that for the whole model.
#ifndef MAKE_ASSETS_SHAPES_H
#define MAKE_ASSETS_SHAPES_H

#include "mesh.h"

// Faces that a box leaves out because a neighbour hides them.
enum {
    SKIP_LEFT = 1,   // -x
    SKIP_RIGHT = 2,  // +x
    SKIP_BOTTOM = 4, // -y
    SKIP_TOP = 8,    // +y
    SKIP_BACK = 16,  // -z
    SKIP_FRONT = 32, // +z
    SKIP_ENDS = SKIP_LEFT | SKIP_RIGHT
};

void shape_box(Soup *s, Vec3 lo, Vec3 hi, unsigned skip);

// A box whose edges are cut by `bevel`: the cut edges catch light, which is what tells stone.
void shape_bevel_box(Soup *s, Vec3 lo, Vec3 hi, float bevel);

// A post whose four upright edges are cut by `bevel`; no bottom, and no top where `open`.
void shape_post(Soup *s, Vec3 lo, Vec3 hi, float bevel, bool open);

// A box that narrows upwards: `inset_x`, `inset_z` per side at the top.
void shape_taper_box(Soup *s, Vec3 lo, Vec3 hi, float inset_x, float inset_z, unsigned skip);

// Turns profile points (radius, y) around y. Going upwards the surface faces outwards. Angles
// start at +x and grow counter-clockwise seen from above; a whole turn closes itself.
void shape_lathe(Soup *s, const Vec2 *profile, int count, int segments, float start_deg,
                 float sweep_deg);
void shape_turn(Soup *s, const Vec2 *profile, int count, int segments); // a whole turn

// A parametric surface over u, v in 0..1; faces cross(dP/du, dP/dv). `repeat` texture repeats.
typedef Vec3 (*ShapeSurface)(const void *context, float u, float v);
void shape_surface(Soup *s, ShapeSurface surface, const void *context, int nu, int nv, Vec2 repeat);

// Sweeps a profile along frames: point = origin + a * profile.x + b * profile.y. The profile runs
// counter-clockwise in (a, b) where the path runs along cross(a, b).
typedef struct SweepFrame {
    Vec3 origin, a, b;
} SweepFrame;
void shape_sweep(Soup *s, const SweepFrame *frames, int frame_count, const Vec2 *profile,
                 int point_count, bool closed);

// Sweeps a profile of (outwards from the wall, y) along x from x0 to x1, facing -z: cornices and
// string courses. The profile runs upwards.
void shape_moulding_x(Soup *s, float x0, float x1, float z, const Vec2 *profile, int count);

// A tube between two points with different radii.
void shape_tube(Soup *s, Vec3 from, Vec3 to, float r0, float r1, int segments, bool caps);

// A ring around y at the origin of the current transform.
void shape_torus(Soup *s, float major, float minor, int segments, int sides);

void shape_ball(Soup *s, Vec3 center, Vec3 radius, int segments, int rings);
void shape_octahedron(Soup *s, Vec3 center, float radius);

// One quad; texture corners (0,0)..(1,1), seen from cross(right, up).
void shape_card(Soup *s, Vec3 center, Vec3 half_right, Vec3 half_up);
void shape_card_uv(Soup *s, Vec3 center, Vec3 half_right, Vec3 half_up, Vec2 lo, Vec2 hi);

// Arches stand in the xy plane, centred on x = 0. `pointed` moves the arcs' centres across the
// axis, in half spans: 0 is round, 1 equilateral.
typedef struct Arch {
    float half_span, spring_y, pointed;
} Arch;

// Point of the arc that is `offset` outside of the intrados; t from 0 (left) to 1 (right).
Vec2 arch_point(const Arch *a, float offset, float t);
float arch_rise(const Arch *a, float offset);

// Sweeps points (offset outwards, z) over the arch. The profile runs from high z to low z to face
// the opening. Every second stone of `stones` takes material `other` (other < 0: none).
void shape_arch_moulding(Soup *s, const Arch *a, const Vec2 *profile, int count, int segments,
                         int stones, int other);

// The same profile straight down from the springs to y_bottom, on both sides.
void shape_jambs(Soup *s, const Arch *a, const Vec2 *profile, int count, float y_bottom);

// The wall between the arch's extrados (+ offset) and the rectangle x_lo..x_hi, up to y_top, in
// the plane z, facing +z or -z by `facing`. Below the spring it fills down to y_bottom.
void shape_spandrel(Soup *s, const Arch *a, float offset, float x_lo, float x_hi, float y_bottom,
                    float y_top, float z, float facing, int segments);

// A plate that closes the opening of the arch from y_bottom up, in the plane z.
void shape_arch_plate(Soup *s, const Arch *a, float offset, float y_bottom, float z, float facing,
                      int segments);

#endif
