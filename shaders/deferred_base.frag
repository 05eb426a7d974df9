#version 460
// deferred_base.frag: ambient, emission and directional lights, over the whole screen once.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(location = 0) out vec4 out_color;

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    Surface s = surface_make(position_from_depth(gl_FragCoord.xy, g.depth), g.normal, g.albedo,
                             g.material);
    vec3 base = light_base(s, g.albedo, g.material);
    out_color = vec4(g.depth > 0.0 ? base : vec3(0.0), 1.0);
}
