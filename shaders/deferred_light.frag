#version 460
// deferred_light.frag: one light's addition to every pixel, blended additively.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(location = 0) flat in uint in_light;
layout(location = 0) out vec4 out_color;

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    Surface s = surface_make(position_from_depth(gl_FragCoord.xy, g.depth), g.normal, g.albedo,
                             g.material);
    LightRecord light = lights[in_light];
    vec3 sum = in_light < frame.counts.x
                   ? light_point(s, light.position, light.color.rgb)
                   : light_spot(s, light.position, light.color,
                                spots[max(in_light, frame.counts.x) - frame.counts.x].direction);
    out_color = vec4(g.depth > 0.0 ? sum * materials[g.material].emissive.w : vec3(0.0), 0.0);
}
