// voxel_fixture.h: what tests of voxelisation share: scenes of a few meshes in a level's grid, and
// what the device made of them.
#ifndef LUZ_TEST_VOXEL_FIXTURE_H
#define LUZ_TEST_VOXEL_FIXTURE_H
#include "voxel_twin.h"
#include "../golden/studio.h"

// Memory of the studio's images.
typedef struct VoxelVolumes {
    u32 counters[GI_COUNTER_COUNT], words, slots;
    u32 *masks; // static, dynamic; [2 * words]
    u32 *ranks, *voxels, *attributes;
} VoxelVolumes;
// Draws the packet, until no voxel is lost.
VoxelVolumes voxel_draw(Studio *studio, const Packet *packet);
u32 *voxel_read_words(Studio *studio, GiVolume which, u32 count);
// Fails unless both are the same to the bit.
void voxel_assert_same(const VoxelVolumes *a, const VoxelVolumes *b, const char *what);
void voxel_assert_masks(const VoxelVolumes *v, const TwinVoxels *twin, const char *what);

// Of the level in the studio, with global illumination; more settings as settings_set_list has
// them.
const Packet *voxel_packet(Studio *studio, const char *settings_list);

// What takes the place of a level's meshes.
typedef struct VoxelScene {
    InstanceRecord instances[8];
    PacketDraw statics[8], dynamics[8];
    u32 instance_count, static_count, dynamic_count;
    MaterialRecord materials[4];
    PacketMaterial bindings[4];
} VoxelScene;
// A copy of the packet whose voxels come from the scene; nothing else is drawn. It may be changed,
// and has keys that no other packet has.
Packet *voxel_scene_packet(Studio *studio, const Packet *base, const VoxelScene *scene);
// Four colours; 2 emits light, 3 has two sides.
void voxel_scene_materials(VoxelScene *scene);
void voxel_place(InstanceRecord *out, const f32 axes[3][3], const f32 at[3], u32 material);
extern const f32 voxel_upright[3][3];
extern const f32 voxel_askew[3][3]; // turned about an odd axis, and stretched
#endif
