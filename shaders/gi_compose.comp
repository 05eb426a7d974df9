#version 460
// gi_compose.comp: indirect light into the picture, of one sample a pixel (gi_compose.glsl).
//
// An invocation takes the square of pixels that lie between the same four traced ones, which it
// reads once. Pixels to which none of them is alike are written down and traced last, by all lanes of
// the subgroup: a lane may have many of them and its neighbours none, and tracing is dear.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "gi_screen.glsl"
#include "gi_compose.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) uniform image2D hdr;

// Pixels that are alone, x | y << 16, a part for each subgroup.
shared uint alone_list[64 * SIDE * SIDE];

void put(ivec2 pixel, vec4 color, bool wanted) {
    vec4 there = imageLoad(hdr, pixel);
    if (wanted) imageStore(hdr, pixel, vec4(there.rgb * color.a + color.rgb, there.a));
}

void main() {
    ivec2 size = ivec2(frame.viewport.xy), block = ivec2(gl_GlobalInvocationID.xy);
    if (GI_RESOLUTION == 0u) {
        ivec2 pixel = min(block, size - 1);
        GbufferPixel g = gbuffer_read(pixel);
        put(pixel, composed(g, gbuffer_surface(g), traced_light(pixel)),
            block == pixel && g.depth > 0.0);
        return;
    }
    ivec2 first = block * SIDE - (SIDE >> 1); // pixel
    Tap t00 = tap_read(block - 1), t10 = tap_read(block - ivec2(0, 1)),
        t01 = tap_read(block - ivec2(1, 0)), t11 = tap_read(block);
    uint left = 0u; // pixels that are alone, as bits
    for (int i = 0; i < SIDE * SIDE; i++) {
        ivec2 place = first + ivec2(i & (SIDE - 1), i >> GI_RESOLUTION);
        ivec2 pixel = clamp(place, ivec2(0), size - 1);
        GbufferPixel g = gbuffer_read(pixel);
        bool alone;
        GiPixel light = upsample(pixel, g, t00, t10, t01, t11, alone);
        bool wanted = place == pixel && g.depth > 0.0;
        left |= wanted && alone ? 1u << i : 0u;
        put(pixel, composed(g, gbuffer_surface(g), light), wanted && !alone);
    }
    uint mine = uint(bitCount(left)), list = gl_SubgroupID * gl_SubgroupSize * uint(SIDE * SIDE);
    uint count = subgroupAdd(mine), at = list + subgroupExclusiveAdd(mine);
    while (left != 0u) {
        int i = findLSB(left);
        left &= left - 1u;
        ivec2 pixel = first + ivec2(i & (SIDE - 1), i >> GI_RESOLUTION);
        alone_list[at++] = uint(pixel.x) | uint(pixel.y) << 16;
    }
    subgroupMemoryBarrierShared();
    subgroupBarrier();
    for (uint b = gl_SubgroupInvocationID;;) {
        bool is_on = b < count;
        uint place = is_on ? alone_list[list + b] : 0u;
        ivec2 pixel = ivec2(place & 0xFFFFu, place >> 16);
        GbufferPixel g = gbuffer_read(pixel);
        Surface s = gbuffer_surface(g);
        put(pixel, composed(g, s, gi_trace_pixel(g, s, uvec2(pixel), vec2(0.0), is_on)), is_on);
        b += gl_SubgroupSize;
        if (subgroupAll(b >= count)) break;
    }
}
