// gi_light_stage.h: random voxels lit by shaders/gi_light.glsl on the device, without a renderer,
// and by plain loops on the CPU.
#ifndef LUZ_GI_LIGHT_STAGE_H
#define LUZ_GI_LIGHT_STAGE_H
#include "gpu_fixture.h"

// All that the shader reads, as it reads it. Set by voxel_scene_voxels and changed by tests.
typedef struct VoxelScene {
    GiRecord gi;
    FrameRecord frame;
    DirectionalRecord directionals[DIRECTIONALS_CAP];
    u32 spec[SPEC_COUNT];
    u32 slot_count; // static ones first
    u32 static_count;
    u32 *masks;      // GI_MASK_COUNT layers
    u32 *places;     // by slot
    u32 *attributes; // GI_ATTRIBUTE_WORDS a slot
    GiLightRecord *lights;
    u32 light_count, light_cap; // the latter are there
    u32 *lists, list_words;
    f32 map_depth; // of every texel of the shadow map
} VoxelScene;

typedef struct LightResult {
    f32 *radiance; // 4 floats a slot and face
    u8 *base;      // texels of the base volume, as they are
    u8 *visibility;
    u64 base_bytes;
} LightResult;

// Occupied voxels at random places with random surfaces; dims: powers of two. share: of 1,000
// voxels, how many are full. The box is dims times 0.25 m.
void voxel_scene_voxels(VoxelScene *stage, u64 seed, u32 x, u32 y, u32 z, u32 cascades, u32 share);
// Lights at random places in and around the box, all kinds mixed; ways: of VoxelShadow, as bits.
void voxel_scene_lights(VoxelScene *stage, u64 seed, u32 count, f32 range_m, u32 ways);
// All lights in one cell.
void voxel_scene_list_all(VoxelScene *stage);
void voxel_scene_free(VoxelScene *stage);

// On the device; spec[SPEC_GI_STEP] etc. as set. Validation must stay silent.
LightResult voxel_scene_run(VoxelScene *stage);
void light_result_free(LightResult *result);

// The naive twin: radiance of a slot's face (0 if faces are shared), and the mean visibility.
typedef struct LightSum {
    f32 face[6][3], opacity[6];
    f32 visibility;
} LightSum;
LightSum light_twin(const VoxelScene *stage, u32 slot);
f32 half_to_float(u16 half);
// From GI_RADIANCE and GI_RADIANCE_2 (faces 3..5 of six): out has 4 numbers a slot and face, in
// order.
void gi_radiance_floats(const u16 *const halves[2], u32 slots, u32 faces, f32 *out);
#endif
