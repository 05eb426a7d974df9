// gi_filter_mip.glsl: a level of the atlas from the one before, every texel of every block in one
// dispatch; or (GI_STEP > 0) the last GI_STEP levels, small ones, in one group that makes one after
// the other: of dispatches that wait for each other the software driver makes more than of their
// texels. Included by gi_filter_mip.comp and gi_filter_mip_byte.comp, and with GI_FILTER_TAIL by
// gi_filter_tail.comp and gi_filter_tail_byte.comp.
#define GI_BUILD
#include "gi_filter.glsl"

#ifdef GI_FILTER_TAIL
// They read what they wrote.
#define SOURCE_ACCESS coherent
#define TARGET_ACCESS coherent
layout(local_size_x = 256) in;
#else
#define SOURCE_ACCESS readonly
#define TARGET_ACCESS writeonly
layout(local_size_x = 8, local_size_y = 4, local_size_z = 2) in;
#endif

layout(set = 0, binding = BUILD_MIP_SOURCE, GI_STORAGE_FORMAT) SOURCE_ACCESS uniform image3D source;
layout(set = 0, binding = BUILD_MIP_TARGET, GI_STORAGE_FORMAT) TARGET_ACCESS uniform image3D target;

#define PAIR(from, front, back)                                                                   \
    filter_over(filter_load(imageLoad(from, front)), filter_load(imageLoad(from, back)))

// A texel of the level `to`, which is `size` large.
// Blocks are as wide as a power of two, so that twice a texel's place is its first child's. A
// direction's pairs by arithmetic: branches would run all six. What leaves towards +x is seen from
// there.
#define MAKE_TEXEL(from, to, texel, size)                                                         \
    {                                                                                             \
        ivec3 front = texel * 2;                                                                  \
        if (GI_DIRECTIONS == 1u) {                                                                \
            vec4 c[8];                                                                            \
            for (int i = 0; i < 8; i++)                                                           \
                c[i] = imageLoad(from, front + ivec3(i & 1, i >> 1 & 1, i >> 2));                 \
            imageStore(to, texel, filter_average(c));                                             \
        } else {                                                                                  \
            int direction = texel.x / (size.x / 6), axis = direction >> 1;                        \
            ivec3 depth = ivec3(axis == 0, axis == 1, axis == 2);                                 \
            ivec3 right = ivec3(axis == 1, axis == 2, axis == 0), up = ivec3(1) - depth - right;  \
            bool is_positive = (direction & 1) == 0;                                              \
            ivec3 back = front + depth * int(!is_positive);                                       \
            front += depth * int(is_positive);                                                    \
            vec4 sum = PAIR(from, front, back) + PAIR(from, front + right, back + right) +        \
                       PAIR(from, front + up, back + up) +                                        \
                       PAIR(from, front + right + up, back + right + up);                         \
            imageStore(to, texel, filter_result(sum * 0.25));                                     \
        }                                                                                         \
    }

ivec3 level_size(ivec3 size) {
    if (GI_MIPS == GI_READ_THIRDS) size.z >>= 1;
    return size;
}

#ifdef GI_FILTER_TAIL
layout(set = 0, binding = BUILD_MIP_TARGET_1, GI_STORAGE_FORMAT) coherent uniform image3D target_1;
layout(set = 0, binding = BUILD_MIP_TARGET_2, GI_STORAGE_FORMAT) coherent uniform image3D target_2;
layout(set = 0, binding = BUILD_MIP_TARGET_3, GI_STORAGE_FORMAT) coherent uniform image3D target_3;

#define MAKE_LEVEL(number, from, to)                                                              \
    if (GI_STEP > number) {                                                                       \
        ivec3 size = level_size(imageSize(to));                                                   \
        for (int i = int(gl_LocalInvocationIndex); i < size.x * size.y * size.z; i += 256) {      \
            int row = i / size.x, slice = row / size.y;                                           \
            ivec3 texel = ivec3(i - row * size.x, row - slice * size.y, slice);                   \
            MAKE_TEXEL(from, to, texel, size)                                                     \
        }                                                                                         \
        memoryBarrierImage();                                                                     \
        barrier();                                                                                \
    }

void main() {
    MAKE_LEVEL(0u, source, target)
    MAKE_LEVEL(1u, target, target_1)
    MAKE_LEVEL(2u, target_1, target_2)
    MAKE_LEVEL(3u, target_2, target_3)
}
#else
void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID), size = level_size(imageSize(target));
    if (any(greaterThanEqual(texel, size))) return;
    MAKE_TEXEL(source, target, texel, size)
}
#endif
