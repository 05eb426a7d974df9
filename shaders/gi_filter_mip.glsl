// gi_filter_mip.glsl: a level of the atlas from the one before, every texel of every block in one
// dispatch. Included by gi_filter_mip.comp and gi_filter_mip_byte.comp.
#define GI_BUILD
#include "gi_filter.glsl"
layout(local_size_x = 8, local_size_y = 4, local_size_z = 2) in;

layout(set = 0, binding = BUILD_MIP_SOURCE, GI_STORAGE_FORMAT) uniform readonly image3D source;
layout(set = 0, binding = BUILD_MIP_TARGET, GI_STORAGE_FORMAT) uniform writeonly image3D target;

vec4 pair(ivec3 front, ivec3 back) {
    return filter_over(filter_load(imageLoad(source, front)), filter_load(imageLoad(source, back)));
}

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID), size = imageSize(target);
    if (GI_MIPS == GI_READ_THIRDS) size.z >>= 1;
    if (any(greaterThanEqual(texel, size))) return;
    // Blocks are as wide as a power of two, so that twice a texel's place is its first child's.
    ivec3 front = texel * 2;
    if (GI_DIRECTIONS == 1u) {
        vec4 c[8];
        for (int i = 0; i < 8; i++)
            c[i] = imageLoad(source, front + ivec3(i & 1, i >> 1 & 1, i >> 2));
        imageStore(target, texel, filter_average(c));
        return;
    }
    // A direction's pairs by arithmetic: branches would run all six.
    int direction = texel.x / (size.x / 6), axis = direction >> 1;
    ivec3 depth = ivec3(axis == 0, axis == 1, axis == 2);
    ivec3 right = ivec3(axis == 1, axis == 2, axis == 0), up = ivec3(1) - depth - right;
    bool is_positive = (direction & 1) == 0; // what leaves towards +x is seen from there
    ivec3 back = front + depth * int(!is_positive);
    front += depth * int(is_positive);
    vec4 sum = pair(front, back) + pair(front + right, back + right) +
               pair(front + up, back + up) + pair(front + right + up, back + right + up);
    imageStore(target, texel, filter_result(sum * 0.25));
}
