#version 460
// deferred_base.frag: ambient, emission and directional lights, over the whole screen once.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(location = 0) out vec4 out_color;

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    vec3 base = gbuffer_radiance(g, gbuffer_surface(g), vec3(0.0));
    out_color = vec4(g.depth > 0.0 ? base : vec3(0.0), 1.0);
}
