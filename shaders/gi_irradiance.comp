#version 460
// gi_irradiance.comp: what arrives at each occupied voxel, kept for surfaces to look up
// (diffuse = voxels): rgb irradiance / pi about the voxel's mean normal, a 1. Free voxels hold 0, so
// that a filtered look-up divides by a (gi_irradiance_lookup.glsl). One invocation a slot.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
#include "gi_gather.glsl"
layout(local_size_x = 64) in;
layout(set = 0, binding = BUILD_IRRADIANCE, rgba16f) writeonly uniform image3D
    gi_irradiance_storage;

void main() {
    uint slot = gl_GlobalInvocationID.x, count = voxel_count();
    if (slot >= count) return;
    voxel_load(slot);
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    uint faces = gather_faces(true);
    if (faces != 0u) for (;;) { // ends with its test, which saves a round (gi_cones.glsl)
        uint face = uint(findLSB(faces));
        faces &= faces - 1u;
        float share = face == GATHER_MEAN ? 1.0 : voxel_face(face);
        sum += gather(face) * share;
        weight += share;
        if (faces == 0u) break;
    }
    uvec3 place = gi_unpack_place(gi_voxels[slot]);
    imageStore(gi_irradiance_storage, ivec3(place), vec4(sum / max(weight, 1e-6), 1.0));
}
