#version 460
// gi_clear.comp: what the last dynamic voxels leave behind beside their bits (a command fills the
// layer) and their filtered light (gi_filter_base.glsl sees to it).
// Steps: 0: their texels in images by voxel, by their list. 1: the insides of dynamic solids; those
// of static ones lie in the static layer too.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 64) in;

layout(set = 0, binding = BUILD_IRRADIANCE, rgba16f) uniform writeonly image3D irradiance_image;
layout(set = 0, binding = BUILD_VISIBILITY, r8) uniform writeonly image3D visibility_image;

// Images that the packet has no use for are stand-ins of another size.
bool is_whole(ivec3 size) {
    uvec4 dims = gi_flow.dims;
    return size == ivec3(dims.xy, dims.z * dims.w);
}

void main() {
    if (GI_STEP == 0u) {
        uint first = gi_counters[GI_COUNTER_STATIC], place = gl_GlobalInvocationID.x;
        uint slot = first + place;
        if (place >= gi_counters[GI_COUNTER_DYNAMIC] || slot >= gi_flow.counts.z) return;
        ivec3 at = ivec3(gi_unpack_place(gi_voxels[slot]));
        if (is_whole(imageSize(irradiance_image))) imageStore(irradiance_image, at, vec4(0.0));
        // Nothing is in the way of what is not voxelised.
        if (is_whole(imageSize(visibility_image))) imageStore(visibility_image, at, vec4(1.0));
    } else {
        uvec4 dims = gi_flow.dims;
        uint words = (dims.x * dims.y * dims.z * dims.w) >> 5;
        uint at = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
                  gl_LocalInvocationIndex;
        if (at >= words) return;
        gi_masks[GI_MASK_SOLID * words + at] &= gi_masks[GI_MASK_STATIC * words + at];
    }
}
