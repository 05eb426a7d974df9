// gi_block.glsl: the upsampling of indirect light for 8 x 8 pixels that one subgroup shades (tiled.glsl
// with TILED_GI): PIXELS_PER_LANE times the subgroup's size must be 64.
//
// The block's pixels lie between 4 x 4 traced ones (of a quarter's resolution; 6 x 6 of half's). Each
// lane reads its share of these once; a pixel gets its four by shuffles, one instruction a number on
// the software driver, where shared memory is a gather.
#ifndef GI_BLOCK_GLSL
#define GI_BLOCK_GLSL
#include "gi_compose.glsl"

layout(std430, set = 2, binding = BINDING_GI_ALONE) buffer GiAloneBuffer { uint gi_alone[]; };

const uint LANES = 64u / PIXELS_PER_LANE; // of the subgroup
const uint TAP_ROW = GI_RESOLUTION == 2u ? 4u : 8u; // places for taps side by side
const uint TAP_ROWS = GI_RESOLUTION == 2u ? 4u : 6u;
const uint TAPS_PER_LANE = (TAP_ROW * TAP_ROWS * PIXELS_PER_LANE + 63u) / 64u;
// Lane l has tap i * (lanes) + l as its i-th.
const uint TAPS_CAP = 6u;
struct BlockTaps {
    Tap at[TAPS_CAP];
};

ivec2 block_pixel() { return ivec2(gl_WorkGroupID.xy * 8u); }
// The first tap of the lane's i-th pixel, counted from the block's. Of 8 lanes the row is a constant,
// so that rows between the same taps share them.
uvec2 block_place(uint i) {
    uint q = i * gl_SubgroupSize + gl_SubgroupInvocationID;
    uvec2 pixel =
        PIXELS_PER_LANE == 8u ? uvec2(gl_SubgroupInvocationID, i) : uvec2(q & 7u, q >> 3u);
    return (pixel + uint(SIDE >> 1)) >> GI_RESOLUTION;
}

BlockTaps block_taps() {
    BlockTaps block;
    if (GI_RESOLUTION == 0u) return block;
    ivec2 first = first_tap(block_pixel());
    [[unroll]] for (uint i = 0u; i < TAPS_PER_LANE; i++) {
        uint tap = i * LANES + gl_SubgroupInvocationID;
        block.at[i] = tap_read(first + ivec2(tap % TAP_ROW, tap / TAP_ROW));
    }
    return block;
}

Tap tap_shuffle(Tap tap, uint lane) {
    vec4 specular = gi_has_specular() ? subgroupShuffle(tap.light.specular, lane) : vec4(0.0);
    return Tap(GiPixel(subgroupShuffle(tap.light.diffuse, lane), specular),
               Place(subgroupShuffle(tap.place.at, lane), subgroupShuffle(tap.place.normal, lane)));
}
Tap tap_choose(Tap a, Tap b, bool second) {
    a.light.diffuse = second ? b.light.diffuse : a.light.diffuse;
    a.light.specular = second ? b.light.specular : a.light.specular;
    a.place.at = second ? b.place.at : a.place.at;
    a.place.normal = second ? b.place.normal : a.place.normal;
    return a;
}
// What of a lane's taps is asked for is mostly a constant.
Tap block_tap(BlockTaps block, uvec2 at) {
    uint rows = LANES / TAP_ROW; // that a lane's taps lie apart: a row at least is one tap of each
    uint lane = at.y % rows * TAP_ROW + at.x, of_lane = at.y / rows;
    Tap found = tap_shuffle(block.at[0], lane);
    [[unroll]] for (uint i = 1u; i < TAPS_PER_LANE; i++)
        found = tap_choose(found, tap_shuffle(block.at[i], lane), of_lane == i);
    return found;
}

// Radiance with indirect light; alone: nothing that was traced fits, it is as it was. i: of the lane's
// pixels, a constant.
vec3 block_compose(BlockTaps block, uint i, ivec2 pixel, GbufferPixel g, Surface s, vec3 radiance,
                   out bool alone) {
    GiPixel light;
    alone = false;
    if (GI_RESOLUTION == 0u) {
        light = traced_light(pixel);
    } else {
        uvec2 at = block_place(i);
        light = upsample(pixel, g, block_tap(block, at), block_tap(block, at + uvec2(1u, 0u)),
                         block_tap(block, at + uvec2(0u, 1u)), block_tap(block, at + 1u), alone);
    }
    vec4 color = composed(g, s, light);
    return alone ? radiance : radiance * color.a + color.rgb;
}

// Writes a lane's pixels that are alone down for gi_alone.comp. In which order hangs on the threads,
// what becomes of each does not.
void block_list_alone(uint alone) {
    if (GI_RESOLUTION == 0u) return;
    uint mine = uint(bitCount(alone)), count = subgroupAdd(mine), first = 0u;
    if (subgroupElect() && count > 0u) {
        first = atomicAdd(gi_alone[GI_ALONE_COUNT], count);
        atomicMax(gi_alone[GI_ALONE_GROUPS], (first + count + GI_ALONE_GROUP - 1u) / GI_ALONE_GROUP);
    }
    uint at = GI_ALONE_FIRST + subgroupBroadcastFirst(first) + subgroupExclusiveAdd(mine);
    while (alone != 0u) {
        uint i = uint(findLSB(alone));
        alone &= alone - 1u;
        ivec2 pixel = pixel_of(i);
        gi_alone[at++] = uint(pixel.x) | uint(pixel.y) << 16;
    }
}
#endif
