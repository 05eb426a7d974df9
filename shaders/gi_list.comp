#version 460
// gi_list.comp: the place of each slot's voxel: an invocation takes a word of the layer's mask. What
// has no slot (the buffers are too small) is left out.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 64) in;
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; };

void main() {
    uvec4 dims = gi_flow.dims;
    uint words = (dims.x * dims.y * dims.z * dims.w) >> 5;
    uint at = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
              gl_LocalInvocationIndex;
    if (at >= words) return;
    uint word = (draw.how.x & GI_DRAW_DYNAMIC) * words + at, mask = gi_masks[word];
    if (mask == 0u) return;
    uint slot = gi_rank(draw.how.x & GI_DRAW_DYNAMIC, at << 5), cap = gi_flow.counts.z;
    uint shift_x = uint(findMSB(dims.x)), shift_y = uint(findMSB(dims.y));
    for (; mask != 0u && slot < cap; slot++) {
        uint bit = at << 5 | uint(findLSB(mask));
        mask &= mask - 1u;
        gi_voxels[slot] = gi_pack_place(uvec3(bit & (dims.x - 1u), bit >> shift_x & (dims.y - 1u),
                                              bit >> (shift_x + shift_y)));
    }
}
