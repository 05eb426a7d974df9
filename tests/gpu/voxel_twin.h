// voxel_twin.h: voxelisation on the CPU: the same test of a triangle and a voxel as
// shaders/gi_vox.glsl, operation for operation; the same in double precision, asked of every voxel;
// and what a voxel gets from its triangles.
#ifndef LUZ_TEST_VOXEL_TWIN_H
#define LUZ_TEST_VOXEL_TWIN_H
#include "../../engine/asset/asset.h"
#include "../../engine/frame/packet.h"

typedef struct TwinTriangle {
    u32 axis; // which axis is z: all that follows is turned so
    f32 corners[3][3], edges[3][3], normal[3];
    i32 low[3], high[3];
    f32 edge_low[3][3], edge_high[3][3], normal_low, normal_high;
    f32 slack;
} TwinTriangle;

// Of world corners in a cascade of the record.
TwinTriangle twin_triangle(const GiRecord *record, u32 cascade, f32 world[3][3]);
// v: turned, within low and high.
bool twin_touches(const TwinTriangle *t, const i32 v[3]);
void twin_turn_back(const TwinTriangle *t, const i32 v[3], u32 out[3]);
// Exactly, as far as double precision goes: corners in voxels, not turned; the box of the voxel is
// larger by `slack` on all sides.
bool twin_touches_exactly(f64 corners[3][3], const u32 voxel[3], f64 slack);

// World corner of an instance's mesh as the shaders have it, and in double precision.
void twin_world(const InstanceRecord *instance, const f32 position[3], f32 out[3]);
void twin_world_exactly(const InstanceRecord *instance, const f32 position[3], f64 out[3]);

// Everything that a packet voxelises: masks by layer (GI_MASK_STATIC, GI_MASK_DYNAMIC), as the
// device has them. Holes of masked materials are not made here.
typedef struct TwinVoxels {
    u32 words; // of a layer
    u32 *masks[2];
    // By voxel of the static layer (bit): fragments, sums of albedo, normal, faces, emission.
    u32 *counts;
    f32 (*albedo)[3], (*normal)[3], (*faces)[6], (*emission)[3];
} TwinVoxels;
// Memory from the arena. Sums only if wanted; textures are not looked at.
TwinVoxels twin_voxelise(const Packet *packet, const AssetStore *assets, bool sums, Arena *arena);
#endif
