#version 460
// gi_alone.comp: indirect light into the picture for pixels that gi_tiled.comp found alone: traced
// each by itself.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"
#include "gi_compose.glsl"
layout(local_size_x = GI_ALONE_GROUP) in;

layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) uniform image2D hdr;
layout(std430, set = 2, binding = BINDING_GI_ALONE) readonly buffer GiAloneBuffer {
    uint gi_alone[];
};

void main() {
    uint i = gl_GlobalInvocationID.x;
    bool is_on = i < gi_alone[GI_ALONE_COUNT];
    uint place = is_on ? gi_alone[GI_ALONE_FIRST + i] : 0u;
    ivec2 pixel = ivec2(place & 0xFFFFu, place >> 16);
    GbufferPixel g = gbuffer_read(pixel);
    Surface s = gbuffer_surface(g);
    vec4 color = composed(g, s, gi_trace_pixel(g, s, uvec2(pixel), vec2(0.0), is_on));
    vec4 there = imageLoad(hdr, pixel);
    if (is_on) imageStore(hdr, pixel, vec4(there.rgb * color.a + color.rgb, there.a));
}
