// gi_filter_base.glsl: from lit voxels to the finest filtered texels, touching only what is occupied
// or was so (empty space costs a bit). Steps (SPEC_GI_STEP), each a dispatch:
//   0  one invocation a word of the masks: voxels whose light is in the images but which are there no
//      more, and the texels above them, become 0; layer GI_MASK_LIT then says what is there now.
//   1  (faces apart) one invocation a slot: its faces go to level 0 of the atlas.
//   2  one invocation a slot: the first occupied voxel of each eight makes the texel over them, from
//      the base volume to level 0 of the atlas or (faces apart) from its level 0 to level 1.
// Included by gi_filter_base.comp and gi_filter_base_byte.comp.
#define GI_BUILD
#include "gi_filter.glsl"
layout(local_size_x = 64) in;

layout(set = 0, binding = BUILD_BASE_STORAGE, GI_STORAGE_FORMAT) uniform image3D base;
layout(set = 0, binding = BUILD_MIP_SOURCE, GI_STORAGE_FORMAT) uniform image3D source;
layout(set = 0, binding = BUILD_MIP_TARGET, GI_STORAGE_FORMAT) uniform image3D target;

ivec3 place_of_bit(uint bit) {
    uint row = bit / gi_flow.dims.x, slice = row / gi_flow.dims.y;
    return ivec3(bit - row * gi_flow.dims.x, row - slice * gi_flow.dims.y, slice);
}

void forget(ivec3 place) {
    ivec3 parent = place >> 1;
    // Bricks were all cleared.
    if (GI_FACES == 0u && GI_BRICKS == 0u) imageStore(base, place, vec4(0.0));
    for (int d = 0; d < int(GI_DIRECTIONS); d++) {
        if (GI_FACES != 0u)
            imageStore(source, place + ivec3(d * int(gi.dims.x), 0, 0), vec4(0.0));
        imageStore(target, parent + ivec3(d * int(gi.dims.x >> 1), 0, 0), vec4(0.0));
    }
}

void forget_word() {
    uint word = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x) +
                gl_GlobalInvocationID.x;
    if (word >= gi_layer_words()) return;
    uint lit_word = GI_MASK_LIT * gi_layer_words() + word;
    uint now = gi_masks[GI_MASK_STATIC * gi_layer_words() + word] |
               gi_masks[GI_MASK_DYNAMIC * gi_layer_words() + word];
    uint gone = gi_masks[lit_word] & ~now;
    gi_masks[lit_word] = now;
    while (gone != 0u) {
        int bit = findLSB(gone);
        gone &= gone - 1u;
        forget(place_of_bit(word * 32u + uint(bit)));
    }
}

// --- Step 1 ---

void scatter(uint slot) {
    ivec3 place = ivec3(gi_unpack_place(gi_voxels[slot]));
    if (GI_DIRECTIONS == 1u) {
        // One block for all sides: as bright as the sides are on average, as dense as the densest.
        vec4 sum = vec4(0.0);
        float most = 0.0;
        for (uint d = 0u; d < 6u; d++) {
            vec4 light = gi_load_radiance(slot, d);
            sum += light;
            most = max(most, light.a);
        }
        imageStore(target, place, gi_encode(sum * (most / max(sum.a, 1e-6))));
        return;
    }
    for (uint d = 0u; d < 6u; d++)
        imageStore(target, place + ivec3(d * gi.dims.x, 0, 0), gi_encode(gi_load_radiance(slot, d)));
}

// --- Step 2 ---

// Is this the first occupied voxel of its eight? Rows of x lie together: of each pair of bits the
// even one comes first.
bool is_first(uvec3 place) {
    uvec3 corner = place & ~1u;
    uint earlier = 0u;
    for (uint i = 0u; i < 8u; i++) {
        uvec3 other = corner + uvec3(i & 1u, i >> 1 & 1u, i >> 2);
        uint own = (place.x & 1u) | (place.y & 1u) << 1 | (place.z & 1u) << 2;
        uint bit = gi_bit(other);
        uint occupied = (gi_masks[gi_mask_word(GI_MASK_STATIC, bit)] |
                         gi_masks[gi_mask_word(GI_MASK_DYNAMIC, bit)]) >> (bit & 31u) & 1u;
        earlier |= i < own ? occupied : 0u;
    }
    return earlier == 0u;
}

// Written out for each direction, so that what is composited is known to the compiler.
#define PARENT(d)                                                                                 \
    {                                                                                             \
        if (GI_FACES != 0u)                                                                       \
            for (int i = 0; i < 8; i++)                                                           \
                c[i] = imageLoad(source, child(corner, i) + ivec3(d * int(gi.dims.x), 0, 0));     \
        imageStore(target, parent + ivec3(d * int(gi.dims.x >> 1), 0, 0),                         \
                   GI_DIRECTIONS == 1u ? filter_average(c) : filter_along(c, d));                 \
    }
ivec3 child(ivec3 corner, int i) { return corner + ivec3(i & 1, i >> 1 & 1, i >> 2); }

void make_parent(uvec3 place) {
    ivec3 corner = ivec3(place & ~1u), parent = corner >> 1;
    vec4 c[8];
    ivec3 first = gi_base_texel(corner); // all eight lie in one brick
    if (GI_FACES == 0u)
        for (int i = 0; i < 8; i++) c[i] = imageLoad(base, child(first, i));
    PARENT(0)
    if (GI_DIRECTIONS == 1u) return;
    PARENT(1)
    PARENT(2)
    PARENT(3)
    PARENT(4)
    PARENT(5)
}

void main() {
    if (GI_STEP == 0u) {
        forget_word();
        return;
    }
    uint slot = gl_GlobalInvocationID.x;
    uint count = min(gi_counters[GI_COUNTER_STATIC] + gi_counters[GI_COUNTER_DYNAMIC],
                     gi_flow.counts.z);
    if (slot >= count) return;
    if (GI_STEP == 1u) {
        scatter(slot);
    } else {
        uvec3 place = gi_unpack_place(gi_voxels[slot]);
        if (!is_first(place)) return;
        make_parent(place);
    }
}
