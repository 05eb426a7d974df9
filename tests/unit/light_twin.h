// light_twin.h: the naive twins of light lists: random frames of lights as records, whether a light
// reaches a point, what a picture of depths says of a tile. The device's passes can be compared
// with them too.
#ifndef LUZ_TEST_LIGHT_TWIN_H
#define LUZ_TEST_LIGHT_TWIN_H
#include "../../engine/systems/systems.h"

typedef struct LightTwin {
    FrameRecord frame;
    LightRecord *lights; // points, diffuse points, spots, diffuse spots, dummy
    SpotRecord *spots;
    u32 count;
} LightTwin;

// A camera somewhere, turned somehow; lights around and before it up to `depth_m`, from tiny to
// those that hold the eye. One third spots, of all widths. Memory from malloc.
LightTwin *light_twin_create(u64 seed, u32 light_count, u32 width_px, u32 height_px, f32 near,
                             f32 depth_m, f32 range_max_m);
void light_twin_destroy(LightTwin *twin);

typedef struct TwinPoint {
    f64 world[3];
    f64 x, y, depth; // view space, depth = -z
    f64 x_px, y_px;  // from the upper left
    bool visible;    // in the picture and not before the near plane
} TwinPoint;
// By the frame record alone.
TwinPoint twin_point(const FrameRecord *frame, const f64 world[3]);
// The point of the picture's ray at a depth.
TwinPoint twin_unproject(const FrameRecord *frame, f64 x_px, f64 y_px, f64 depth);
// Random point in the light's volume, often near its surface.
void twin_point_in_light(const LightTwin *twin, u32 light, u64 seed, u64 draw, f64 world[3]);
// What the shader says: d^2 w < 1, and within the cone.
bool twin_light_reaches(const LightTwin *twin, u32 light, const f64 world[3]);
// The cell of a point that is visible, computed as a shader does.
u32 twin_cell(const FrameRecord *frame, const TwinPoint *point);

// --- What is seen in a tile (TileDepthRecord): the reference of the device's pass ---

// depths_m [height_px * width_px]: view depth in m, 0 = background.
TileDepthRecord twin_tile_depth(const f32 *depths_m, u32 width_px, u32 height_px, u32 tile_px,
                                u32 tile_x, u32 tile_y);
// May a light between these view depths touch a pixel of the tile? By the range, and by the mask of
// 32 slices of it: bit floor((depth - near) * 32 / (far - near)), clamped.
bool twin_depth_touches(const TileDepthRecord *tile, f32 front_m, f32 back_m, bool mask);
#endif
