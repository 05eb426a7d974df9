// gi.glsl: the voxels as every shader of global illumination sees them: bindings, addresses, codes,
// and the reading of filtered light. What makes them defines GI_BUILD before including this (set 0 is
// the voxels' own), what reads them for the screen GI_SCREEN (set 2, beside the frame's).
//
// Terms. A position "in voxels" counts voxels of one cascade from its lower corner: 0..dims. A place
// counts the same in whole voxels, with z + dims.z * cascade where all cascades are addressed.
// Directions: 0 +x, 1 -x, 2 +y, 3 -y, 4 +z, 5 -z. Face d of a voxel, and block d of the atlas, is
// the light that LEAVES TOWARDS d: it is seen when looking along -d, so a ray that travels towards
// -x reads block 0, one that travels towards +x block 1.
// Radiance is premultiplied everywhere: rgb is already times the opacity a, so that blending is
// front + back * (1 - front.a). In the images rgb is also divided by gi.scale.x with format byte:
// gi_encode and gi_decode.
#ifndef GI_GLSL
#define GI_GLSL
#include "shared.h"

layout(constant_id = SPEC_GI_DIRECTIONS) const uint GI_DIRECTIONS = 6;
layout(constant_id = SPEC_GI_FACES) const uint GI_FACES = 0;
layout(constant_id = SPEC_GI_MIPS) const uint GI_MIPS = GI_READ_LINEAR;
layout(constant_id = SPEC_GI_CASCADES) const uint GI_CASCADES = 1;
layout(constant_id = SPEC_GI_DIFFUSE) const uint GI_DIFFUSE = 1;
layout(constant_id = SPEC_GI_FEATURES) const uint GI_FEATURES = 0;
layout(constant_id = SPEC_GI_COSINE) const uint GI_COSINE = 1;
layout(constant_id = SPEC_GI_STEP) const uint GI_STEP = 0;
layout(constant_id = SPEC_GI_VISIBILITY) const uint GI_VISIBILITY = 0;
layout(constant_id = SPEC_GI_FORMAT) const uint GI_FORMAT = 0;
layout(constant_id = SPEC_GI_RESOLUTION) const uint GI_RESOLUTION = 0;
layout(constant_id = SPEC_GI_TRACED) const uint GI_TRACED = 0;
layout(constant_id = SPEC_GI_BRICKS) const uint GI_BRICKS = 0;
layout(constant_id = SPEC_GI_WAVES) const uint GI_WAVES = 0;

// --- Bindings ---

// The images of filtered light have two formats. A shader that writes one is compiled twice: its
// body is a .glsl file, and X.comp and X_byte.comp include it, the latter after #define GI_BYTE.
#ifdef GI_BYTE
#define GI_STORAGE_FORMAT rgba8
#else
#define GI_STORAGE_FORMAT rgba16f
#endif

#ifdef GI_BUILD
#define GI_SET 0
layout(std140, set = 0, binding = BUILD_GI) uniform GiBuffer { GiRecord gi; };
layout(std430, set = 0, binding = BUILD_FLOW) readonly buffer GiFlowBuffer { GiRecord gi_flow; };
layout(std430, set = 0, binding = BUILD_MASKS) buffer GiMaskBuffer { uint gi_masks[]; };
layout(std430, set = 0, binding = BUILD_RANKS) buffer GiRankBuffer { uint gi_ranks[]; };
layout(std430, set = 0, binding = BUILD_VOXELS) buffer GiVoxelBuffer { uint gi_voxels[]; };
layout(std430, set = 0, binding = BUILD_ATTRIBUTES) buffer GiAttributeBuffer {
    uint gi_attributes[];
};
layout(std430, set = 0, binding = BUILD_ACCUMULATORS) buffer GiAccumulatorBuffer {
    uint gi_accumulators[];
};
layout(std430, set = 0, binding = BUILD_RADIANCE) buffer GiRadianceBuffer { uint gi_radiance[]; };
layout(std430, set = 0, binding = BUILD_RADIANCE_2) buffer GiRadiance2Buffer {
    uint gi_radiance_2[];
};
layout(std430, set = 0, binding = BUILD_COUNTERS) buffer GiCounterBuffer { uint gi_counters[]; };
layout(set = 0, binding = BUILD_BASE) uniform sampler3D gi_base;
layout(set = 0, binding = BUILD_ATLAS) uniform sampler3D gi_atlas;
layout(set = 0, binding = BUILD_BRICKS) uniform sampler3D gi_bricks;
#endif

#ifdef GI_SCREEN
#define GI_SET 2
layout(std140, set = 2, binding = BINDING_GI) uniform GiBuffer { GiRecord gi; };
layout(std140, set = 2, binding = BINDING_GI_TRACED) uniform GiTracedBuffer {
    TracedLightRecord gi_traced[GI_TRACED_CAP];
};
layout(std430, set = 2, binding = BINDING_GI_FLOW) readonly buffer GiFlowBuffer {
    GiRecord gi_flow;
};
layout(std430, set = 2, binding = BINDING_GI_MASKS) readonly buffer GiMaskBuffer {
    uint gi_masks[];
};
layout(std430, set = 2, binding = BINDING_GI_RANKS) readonly buffer GiRankBuffer {
    uint gi_ranks[];
};
layout(std430, set = 2, binding = BINDING_GI_ATTRIBUTES) readonly buffer GiAttributeBuffer {
    uint gi_attributes[];
};
layout(set = 2, binding = BINDING_GI_BASE) uniform sampler3D gi_base;
layout(set = 2, binding = BINDING_GI_ATLAS) uniform sampler3D gi_atlas;
layout(set = 2, binding = BINDING_GI_ATLAS_NEAREST_MIP) uniform sampler3D gi_atlas_nearest_mip;
layout(set = 2, binding = BINDING_GI_BRICKS) uniform sampler3D gi_bricks;
#endif

// --- What loops read of the record ---

// Read before all loops: within one the software driver reads buffers lane by lane; four numbers of a
// storage buffer take as long there as a filtered texel.
vec3 gi_dims = vec3(gi.dims.xyz), gi_atlas_half_texel = 0.5 / vec3(gi.atlas.xyz);
float gi_atlas_last = float(gi.atlas.w) - 1.0; // its coarsest level
vec4 gi_first_origin = gi.origin[0];

vec4 gi_origin(uint cascade) { return GI_CASCADES == 1u ? gi_first_origin : gi.origin[cascade]; }

// --- World and voxels: the one pair that everybody uses ---

vec3 gi_to_voxels(vec3 world, uint cascade) {
    vec4 origin = gi_origin(cascade);
    return (world - origin.xyz) / origin.w;
}
vec3 gi_to_world(vec3 voxels, uint cascade) {
    return voxels * gi.origin[cascade].w + gi.origin[cascade].xyz;
}

// --- Masks and slots ---

// Bit of a voxel in a layer of the masks; place: z with the cascade's offset.
uint gi_bit(uvec3 place) { return place.x + gi.dims.x * (place.y + gi.dims.y * place.z); }
uint gi_layer_bits() { return gi.dims.x * gi.dims.y * gi.dims.z * gi.dims.w; }
uint gi_layer_words() { return gi_layer_bits() >> 5; }
uint gi_mask_word(uint layer, uint bit) { return layer * gi_layer_words() + (bit >> 5); }

bool gi_has(uint layer, uint bit) {
    return (gi_masks[gi_mask_word(layer, bit)] >> (bit & 31u) & 1u) != 0u;
}
// Has a surface in it, static or dynamic.
bool gi_occupied(uint bit) {
    return ((gi_masks[gi_mask_word(GI_MASK_STATIC, bit)] |
             gi_masks[gi_mask_word(GI_MASK_DYNAMIC, bit)]) >> (bit & 31u) & 1u) != 0u;
}

// Slots are ranks: set bits before a voxel's own, in the static layer first, then in the dynamic one.
// So static voxels have slots 0.., dynamic ones follow, in the order of their bits. gi_ranks tells the
// bits before every GI_RANK_WORDS words of a layer (a layer is a whole number of them); the few words
// between are counted.
uint gi_rank(uint layer, uint bit) {
    uint word = gi_mask_word(layer, bit), first = word & ~(GI_RANK_WORDS - 1u);
    uint rank = gi_ranks[first / GI_RANK_WORDS];
    for (uint i = 0u; i < GI_RANK_WORDS - 1u; i++)
        rank += first + i < word ? uint(bitCount(gi_masks[first + i])) : 0u;
    return rank + uint(bitCount(gi_masks[word] & ((1u << (bit & 31u)) - 1u)));
}
const uint GI_NO_SLOT = 0xffffffffu;
// Of an occupied voxel; GI_NO_SLOT for empty ones and those that found no room.
uint gi_slot(uint bit) {
    bool is_fixed = gi_has(GI_MASK_STATIC, bit);
    uint slot = gi_rank(is_fixed ? GI_MASK_STATIC : GI_MASK_DYNAMIC, bit);
    return gi_occupied(bit) && slot < gi.counts.z ? slot : GI_NO_SLOT;
}

uint gi_pack_place(uvec3 place) {
    return place.x << GI_VOXEL_X_SHIFT | place.y << GI_VOXEL_Y_SHIFT |
           place.z << GI_VOXEL_Z_SHIFT;
}
uvec3 gi_unpack_place(uint word) {
    return uvec3(word >> GI_VOXEL_X_SHIFT & 511u, word >> GI_VOXEL_Y_SHIFT & 511u,
                 word >> GI_VOXEL_Z_SHIFT & 2047u);
}

// --- Attributes of a slot ---

uint gi_attribute(uint slot, uint which) {
    return gi_attributes[slot * GI_ATTRIBUTE_WORDS + which];
}

// Mean of unit normals: shorter than 1 where they disagree.
uint gi_pack_normal(vec3 n) {
    uvec3 q = uvec3(clamp(n * 0.5 + 0.5, 0.0, 1.0) * 1023.0 + 0.5);
    return q.x | q.y << 10 | q.z << 20;
}
vec3 gi_unpack_normal(uint word) {
    vec3 q = vec3(word & 1023u, word >> 10 & 1023u, word >> 20 & 1023u);
    return q * (2.0 / 1023.0) - 1.0;
}

// Three positive numbers with 9 bits each and one exponent (as EXT_texture_shared_exponent says,
// with N = 9, B = 15): up to 65,408, the largest of the three within 0.2 %.
uint gi_pack_emission(vec3 e) {
    e = clamp(e, vec3(0.0), vec3(65408.0));
    float largest = max(max(e.x, e.y), max(e.z, 1e-9));
    // floor(log2), exactly: the exponent's bits.
    int exponent = max(-16, int(floatBitsToUint(largest) >> 23) - 127) + 16;
    float unit = uintBitsToFloat(uint(exponent - 24 + 127) << 23);
    if (floor(largest / unit + 0.5) > 511.0) {
        exponent += 1;
        unit *= 2.0;
    }
    uvec3 q = uvec3(e / unit + 0.5);
    return q.x | q.y << 9 | q.z << 18 | uint(exponent) << 27;
}
vec3 gi_unpack_emission(uint word) {
    float unit = uintBitsToFloat((word >> 27) + uint(127 - 24) << 23);
    return vec3(word & 511u, word >> 9 & 511u, word >> 18 & 511u) * unit;
}

// How much of the voxel's surface faces +x -x +y -y (first word) and +z -z, 0..1.
uvec2 gi_pack_faces(float faces[6]) {
    return uvec2(packUnorm4x8(vec4(faces[0], faces[1], faces[2], faces[3])),
                 packUnorm4x8(vec4(faces[4], faces[5], 0.0, 0.0)));
}
float gi_face(uvec2 words, uint face) {
    return float((face < 4u ? words.x : words.y) >> (8u * (face & 3u)) & 255u) * (1.0 / 255.0);
}

// --- Radiance of a slot: half floats, rgb premultiplied, a opacity ---

// Of a slot's numbers for a face; with faces apart those of 3..5 lie in the second buffer.
uint gi_radiance_word(uint slot, uint face) {
    return GI_FACES != 0u ? (slot * 3u + face % 3u) * 2u : slot * 2u;
}
uvec2 gi_pack_radiance(vec4 radiance) {
    vec4 c = clamp(radiance, vec4(0.0), vec4(65000.0, 65000.0, 65000.0, 1.0));
    return uvec2(packHalf2x16(c.xy), packHalf2x16(c.zw));
}
vec4 gi_unpack_radiance(uvec2 words) {
    return vec4(unpackHalf2x16(words.x), unpackHalf2x16(words.y));
}
#ifdef GI_BUILD
vec4 gi_load_radiance(uint slot, uint face) {
    uint word = gi_radiance_word(slot, face);
    if (GI_FACES != 0u && face >= 3u)
        return gi_unpack_radiance(uvec2(gi_radiance_2[word], gi_radiance_2[word + 1u]));
    return gi_unpack_radiance(uvec2(gi_radiance[word], gi_radiance[word + 1u]));
}
void gi_store_radiance(uint slot, uint face, vec4 radiance) {
    uint word = gi_radiance_word(slot, face);
    uvec2 packed = gi_pack_radiance(radiance);
    if (GI_FACES != 0u && face >= 3u) {
        gi_radiance_2[word] = packed.x;
        gi_radiance_2[word + 1u] = packed.y;
    } else {
        gi_radiance[word] = packed.x;
        gi_radiance[word + 1u] = packed.y;
    }
}
#endif

// --- The images of filtered light ---

// With faces apart a texel's a is not its opacity but its density: light gets through a texel by
// exp2(-GI_DENSEST a), and rgb is premultiplied by the density. Samplers blend what they read; of a
// wall between two samples each has a part, and parts of a density add up to it wherever the samples
// lie, where parts of an opacity let light through. Densities also follow a ray's step and what it
// meets a surface at (gi_cones.glsl). What is sparse or smaller than a texel has little of it.
// Directions isotropic: the mean density of what a texel holds.
const float GI_DENSEST = 10.0; // a wall a texel thick lets 2^-GI_DENSEST through
float gi_opacity(float density) { return 1.0 - exp2(-GI_DENSEST * density); }
float gi_density(float opacity) {
    return min(log2(max(1.0 - opacity, exp2(-GI_DENSEST))) * (-1.0 / GI_DENSEST), 1.0);
}
// Premultiplied by density: by opacity, through a way of so many texels.
vec4 gi_solid(vec4 texel, float way) {
    float opacity = gi_opacity(texel.a * way);
    return vec4(texel.rgb * (opacity / max(texel.a, 1e-6)), opacity);
}
// And back, a way of one.
vec4 gi_dense(vec4 light) {
    float density = gi_density(light.a);
    return vec4(light.rgb * (density / max(light.a, 1e-6)), density);
}

vec4 gi_encode(vec4 radiance) {
    return GI_FORMAT != 0u ? vec4(min(radiance.rgb / gi.scale.x, vec3(1.0)), radiance.a)
                           : vec4(min(radiance.rgb, vec3(65000.0)), radiance.a);
}
vec4 gi_decode(vec4 texel) {
    return GI_FORMAT != 0u ? vec4(texel.rgb * gi.scale.x, texel.a) : texel;
}

// The atlas: level 0 of a direction's block of one cascade is gi.atlas.xyz texels, and level l is
// that >> l, down to where the smallest side is 1. Blocks lie along x, cascades along z. With faces
// shared a texel of level 0 is two voxels wide, with faces apart one. With GI_READ_THIRDS (one cascade,
// faces shared) this is its lower half along z.

float gi_atlas_lod() { return GI_FACES != 0u ? 0.0 : 1.0; } // lod of its level 0

// The blocks that face somebody who travels along a unit vector, and what each counts.
struct GiAxes {
    vec3 block;  // of x, y, z: 0..5
    vec3 weight; // faces shared: sum 1; apart: how often a ray crosses faces of the axis
};
GiAxes gi_axes(vec3 direction) {
    GiAxes axes;
    axes.block = vec3(direction.x < 0.0 ? 0.0 : 1.0, direction.y < 0.0 ? 2.0 : 3.0,
                      direction.z < 0.0 ? 4.0 : 5.0);
    axes.weight = GI_FACES != 0u ? abs(direction) : direction * direction;
    return axes;
}

// What the three blocks say together. Faces apart: of a flat thing across an axis a ray meets |d| of
// what it covers along it, of a round one that covers as much along each as much again. So densities
// add up as lengths do that are perpendicular; their sum would make round things 1.5 times as large.
vec4 gi_axes_blend(vec4 x, vec4 y, vec4 z, GiAxes axes) {
    vec4 sum = x * axes.weight.x + y * axes.weight.y + z * axes.weight.z;
    if (GI_FACES == 0u) return sum;
    vec3 each = vec3(x.a, y.a, z.a) * axes.weight;
    return sum * (length(each) / max(sum.a, 1e-6));
}

// is_whole: the level is, and the sampler need not look at two.
vec4 gi_atlas_fetch(vec3 p, float level, bool is_whole) {
#ifdef GI_SCREEN
    if (is_whole) return textureLod(gi_atlas_nearest_mip, p, level);
#endif
    return textureLod(gi_atlas, p, level);
}
vec4 gi_atlas_fetch(vec3 p, float level) {
    return gi_atlas_fetch(p, level, GI_MIPS == GI_READ_NEAREST);
}

// exp2 of a whole number.
float gi_exp2_whole(float x) { return uintBitsToFloat(uint(x + 127.0) << 23); }

// The atlas at p (in voxels of the cascade), of a level that need not be whole.
vec4 gi_atlas_sample(vec3 p, uint cascade, float level, GiAxes axes) {
    level = clamp(level, 0.0, gi_atlas_last);
    if (GI_MIPS == GI_READ_NEAREST) level = floor(level + 0.5);
    // Neighbouring blocks and cascades must not be blended with: half a texel of the coarser level
    // that is read stays between.
    vec3 half_texel = gi_exp2_whole(ceil(level)) * gi_atlas_half_texel;
    vec3 q = clamp(p / gi_dims, half_texel, 1.0 - half_texel);
    if (GI_CASCADES > 1u) q.z = (q.z + float(cascade)) / float(GI_CASCADES);
    if (GI_MIPS == GI_READ_THIRDS) q.z *= 0.5;
    vec4 sum;
    if (GI_DIRECTIONS == 1u) {
        sum = gi_atlas_fetch(q, level);
    } else {
        vec3 x = (axes.block + q.x) * (1.0 / 6.0);
        sum = gi_axes_blend(gi_atlas_fetch(vec3(x.x, q.yz), level),
                            gi_atlas_fetch(vec3(x.y, q.yz), level),
                            gi_atlas_fetch(vec3(x.z, q.yz), level), axes);
    }
    return gi_decode(sum);
}

// The base volume: the unfiltered voxels; faces shared only. Whole, it has a texel a voxel. In bricks
// it has texels only where voxels are: a cell of GI_BRICK_CELL voxels along each side has a brick of
// one texel more, which is the next cell's first one, so that any eight neighbours that are blended
// lie in one brick. gi_bricks says which: xyz in bytes, its place in the image in bricks. Cells
// with nothing in them all have the first, which stays empty (gi_bricks.comp).

// Place of a cell's brick, in bricks; 0 = empty.
ivec3 gi_brick(ivec3 cell) { return ivec3(texelFetch(gi_bricks, cell, 0).xyz * 255.0 + 0.5); }
// Texel of a voxel.
ivec3 gi_base_texel(ivec3 place) {
    if (GI_BRICKS == 0u) return place;
    return gi_brick(place / GI_BRICK_CELL) * GI_BRICK_SIDE + place % GI_BRICK_CELL;
}
// Axes (bits x 1, y 2, z 4) along which the voxel is also the last texel of the brick before.
uint gi_brick_edges(ivec3 place) {
    uvec3 edge = uvec3(equal(place % GI_BRICK_CELL, ivec3(0))) *
                 uvec3(greaterThan(place, ivec3(0)));
    return edge.x | edge.y << 1 | edge.z << 2;
}
// Undecoded, at q (0..1 of all cascades' box).
vec4 gi_base_fetch(vec3 q) {
    if (GI_BRICKS == 0u) return textureLod(gi_base, q, 0.0);
    vec3 size = vec3(gi.dims.xy, gi.dims.z * GI_CASCADES);
    vec3 p = clamp(q * size - 0.5, vec3(0.0), size - 1.0);
    vec3 cell = floor(p * (1.0 / float(GI_BRICK_CELL)));
    vec3 texel = texelFetch(gi_bricks, ivec3(cell), 0).xyz * (255.0 * float(GI_BRICK_SIDE)) +
                 (p - cell * float(GI_BRICK_CELL) + 0.5);
    return textureLod(gi_base, texel / vec3(textureSize(gi_base, 0)), 0.0);
}
vec4 gi_base_sample(vec3 p, uint cascade) {
    vec3 half_texel = 0.5 / gi_dims;
    vec3 q = clamp(p / gi_dims, half_texel, 1.0 - half_texel);
    if (GI_CASCADES > 1u) q.z = (q.z + float(cascade)) / float(GI_CASCADES);
    return gi_decode(gi_base_fetch(q));
}

// What arrives at somebody who travels along axes (gi_axes(direction)) from around p (in voxels of
// the cascade, inside its box), blurred over a diameter of 2^lod voxels: rgb premultiplied radiance,
// a opacity. Specification of voxel GI, 6.
vec4 gi_sample(vec3 p, uint cascade, float lod, GiAxes axes) {
    vec4 filtered = gi_atlas_sample(p, cascade, lod - gi_atlas_lod(), axes);
    if (GI_FACES != 0u) return filtered;
    float share = clamp(lod, 0.0, 1.0);
    if (GI_MIPS == GI_READ_NEAREST) share = floor(share + 0.5);
    return mix(gi_base_sample(p, cascade), filtered, share);
}
vec4 gi_sample(vec3 p, uint cascade, float lod, vec3 direction) {
    return gi_sample(p, cascade, lod, gi_axes(direction));
}

// The finest cascade that holds a sample of this diameter (m) with what is blended into it;
// GI_CASCADES = none does.
uint gi_cascade(vec3 world, float diameter) {
    uint found = GI_CASCADES;
    for (uint i = GI_CASCADES; i-- > 0u;) {
        vec4 origin = gi_origin(i);
        vec3 middle = 0.5 * gi_dims * origin.w;
        vec3 room = middle - abs(world - origin.xyz - middle);
        // The last one has nothing beyond it: it is read up to its border.
        float margin = i + 1u < GI_CASCADES ? diameter + origin.w : 0.0;
        if (min(min(room.x, room.y), room.z) >= margin) found = i;
    }
    return found;
}

#endif
