// gi_filter_base.glsl: from lit voxels to the finest filtered texels, touching only what is occupied
// or was so (empty space costs a bit). Steps (SPEC_GI_STEP), each a dispatch:
//   0  one invocation a word of the masks: voxels whose light is in the images but which are there no
//      more, and the texels above them, become 0; layer GI_MASK_LIT then says what is there now.
//   1  (faces apart) one invocation a slot: its faces go to level 0 of the atlas.
//   2  a group for GI_PARENT_CHUNKS rows of 32 x 2 x 2 voxels: each eight voxels with one that is
//      occupied make the texel over them, from the base volume to level 0 of the atlas or (faces apart) from its
//      level 0 to level 1.
//   3  both 0 and 2, where a row is whole words: a group's own voxels make all of its texels.
// Included by gi_filter_base.comp and gi_filter_base_byte.comp.
#define GI_BUILD
#include "gi_filter.glsl"
layout(local_size_x = 64) in;

layout(set = 0, binding = BUILD_BASE_STORAGE, GI_STORAGE_FORMAT) coherent uniform image3D base;
layout(set = 0, binding = BUILD_MIP_SOURCE, GI_STORAGE_FORMAT) coherent uniform image3D source;
layout(set = 0, binding = BUILD_MIP_TARGET, GI_STORAGE_FORMAT) coherent uniform image3D target;

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

// Eight voxels have one parent. A group goes through a stretch of them, lists those with anything
// occupied below, and its lanes share what is on the list: the software driver runs for all lanes what
// one of them needs. The order of the list does not matter.
const uint PARENTS_LISTED = GI_PARENT_CHUNKS * 16u;
shared uint parent_count;
shared uint parents[PARENTS_LISTED]; // x, y, z: 8, 8 and 16 bits

// Occupied voxels of a chunk: up to 32 in a row.
uint chunk_row(uvec3 place, uint width) {
    uint bit = gi_bit(place);
    uint word = gi_masks[gi_mask_word(GI_MASK_STATIC, bit)] |
                gi_masks[gi_mask_word(GI_MASK_DYNAMIC, bit)];
    return word >> (bit & 31u) & (0xffffffffu >> (32u - width));
}

// Step 0 for four rows of whole words. What is zero over them and has something below is made anew
// after the barrier. The software driver runs the body of a loop that begins with its test once more
// than it should: one loop, not four.
void forget_rows(uvec3 place, uvec4 now) {
    uint first = GI_MASK_LIT * gi_layer_words() + (gi_bit(place) >> 5);
    uint row = gi_flow.dims.x >> 5, slice = row * gi_flow.dims.y;
    uvec4 words = first + uvec4(0u, row, slice, slice + row);
    uvec4 lit = uvec4(gi_masks[words.x], gi_masks[words.y], gi_masks[words.z], gi_masks[words.w]);
    gi_masks[words.x] = now.x;
    gi_masks[words.y] = now.y;
    gi_masks[words.z] = now.z;
    gi_masks[words.w] = now.w;
    uvec4 gone = lit & ~now;
    while (gone != uvec4(0u)) {
        uint i = gone.x != 0u ? 0u : gone.y != 0u ? 1u : gone.z != 0u ? 2u : 3u;
        uint word = gone.x != 0u ? gone.x : gone.y != 0u ? gone.y : gone.z != 0u ? gone.z : gone.w;
        forget(ivec3(place + uvec3(uint(findLSB(word)), i & 1u, i >> 1)));
        word &= word - 1u;
        gone = uvec4(i == 0u ? word : gone.x, i == 1u ? word : gone.y, i == 2u ? word : gone.z,
                     i == 3u ? word : gone.w);
    }
}

void list_parents() {
    uvec4 dims = gi_flow.dims;
    uint width = min(dims.x, 32u), across = dims.x / width;
    uint chunks = across * (dims.y >> 1) * (dims.z * dims.w >> 1);
    if (gl_LocalInvocationIndex == 0u) parent_count = 0u;
    barrier();
    for (uint k = 0u; k < GI_PARENT_CHUNKS / 64u; k++) {
        uint chunk = gl_WorkGroupID.x * GI_PARENT_CHUNKS + k * 64u + gl_LocalInvocationIndex;
        uint row = chunk / across, slice = row / (dims.y >> 1);
        uvec3 place = uvec3((chunk - row * across) * width, (row - slice * (dims.y >> 1)) * 2u,
                            slice * 2u);
        uint found = 0u;
        if (chunk < chunks) {
            uvec4 rows = uvec4(chunk_row(place, width), chunk_row(place + uvec3(0u, 1u, 0u), width),
                               chunk_row(place + uvec3(0u, 0u, 1u), width),
                               chunk_row(place + uvec3(0u, 1u, 1u), width));
            found = rows.x | rows.y | rows.z | rows.w;
            if (GI_STEP == 3u) forget_rows(place, rows);
        }
        found = (found | found >> 1) & 0x55555555u;
        uint at = atomicAdd(parent_count, uint(bitCount(found)));
        if (found != 0u) for (;;) {
            uint x = place.x + uint(findLSB(found));
            parents[at++] = x >> 1 | place.y << 7 | place.z << 15;
            found &= found - 1u;
            if (found == 0u) break;
        }
    }
    if (GI_STEP == 3u) memoryBarrierImage();
    barrier();
}

// Written out for each direction, so that what is composited is known to the compiler.
#define PARENT(d)                                                                                 \
    {                                                                                             \
        if (GI_FACES != 0u)                                                                       \
            for (int i = 0; i < 8; i++)                                                           \
                c[i] = filter_load(                                                               \
                    imageLoad(source, child(corner, i) + ivec3(d * int(gi.dims.x), 0, 0)));       \
        imageStore(target, parent + ivec3(d * int(gi.dims.x >> 1), 0, 0),                         \
                   filter_result(GI_DIRECTIONS == 1u ? filter_average(c) : filter_along(c, d)));  \
    }
ivec3 child(ivec3 corner, int i) { return corner + ivec3(i & 1, i >> 1 & 1, i >> 2); }

void make_parent(ivec3 parent) {
    ivec3 corner = parent * 2;
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
    if (GI_STEP >= 2u) {
        list_parents();
        uint i = gl_LocalInvocationIndex, end = parent_count;
        if (i < end) for (;;) {
            uint packed = parents[i];
            make_parent(ivec3(packed & 255u, packed >> 8 & 255u, packed >> 16));
            i += 64u;
            if (i >= end) break;
        }
        return;
    }
    uint slot = gl_GlobalInvocationID.x;
    uint count = min(gi_counters[GI_COUNTER_STATIC] + gi_counters[GI_COUNTER_DYNAMIC],
                     gi_flow.counts.z);
    if (slot < count) scatter(slot);
}
