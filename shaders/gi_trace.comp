#version 460
// gi_trace.comp: indirect light of the screen's pixels, or of one in 2 x 2 or 4 x 4
// (gi_traced_pixel): cones from the surface that the G-buffer holds.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define GI_WAVE
#include "gi_screen.glsl"
layout(local_size_x = 64) in; // 8 x 8 pixels

layout(set = 2, binding = BINDING_GI_TRACE_0_STORAGE, rgba16f) writeonly uniform image2D trace_0;
layout(set = 2, binding = BINDING_GI_TRACE_RAW_STORAGE, rgba16f) writeonly uniform image2D
    trace_raw; // in place of the first, if gi_smooth.comp comes between
layout(set = 2, binding = BINDING_GI_TRACE_1_STORAGE, rgba16f) writeonly uniform image2D trace_1;

void main() {
    // Pixels of a wave lie together, so that their cones end together: 4 x 2 of 8 lanes.
    uint i = gl_LocalInvocationIndex;
    uvec2 at = uvec2((i & 3u) | (i >> 1 & 4u), (i >> 2 & 1u) | (i >> 3 & 6u));
    ivec2 traced = ivec2(gl_WorkGroupID.xy * 8u + at), size = ivec2(gi.trace.xy);
    GbufferPixel g = gbuffer_read(gi_traced_pixel(min(traced, size - 1)));
    GiPixel result = gi_trace_pixel(g, gbuffer_surface(g), uvec2(traced), gi_lean(uvec2(traced)),
                                    g.depth > 0.0);
    if (traced.x < size.x && traced.y < size.y) {
        if ((GI_FEATURES & GI_FEATURE_DITHER) != 0u)
            imageStore(trace_raw, traced, result.diffuse);
        else
            imageStore(trace_0, traced, result.diffuse);
        imageStore(trace_1, traced, result.specular);
    }
}
