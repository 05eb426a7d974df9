#version 460
// deferred_light.frag: one light's addition to every pixel, blended additively. Points and spots
// are two draws with pipelines of their own (SPOTS).
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(location = 0) flat in vec4 in_position;
layout(location = 1) flat in vec4 in_light_color;
layout(location = 2) flat in vec4 in_direction;
layout(location = 3) flat in vec4 in_edge;
layout(location = 0) out vec4 out_color;

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    Surface s = gbuffer_surface(g);
    vec3 sum = SPOTS != 0u ? light_spot(s, in_position, in_light_color, in_direction, in_edge.x)
                           : light_point(s, in_position, in_light_color);
    out_color = vec4(g.depth > 0.0 ? sum * gbuffer_receives(g) : vec3(0.0), 0.0);
}
