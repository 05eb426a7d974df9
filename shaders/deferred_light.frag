#version 460
// deferred_light.frag: one light's addition to every pixel, blended additively. Points and spots
// are two draws with pipelines of their own (SPOTS).
//
// LIGHT_BRANCH: pixels outside the range or the cone stop before the light is evaluated. The branch
// is a loop of one round or none, for only the exit of a loop saves work on the software driver.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(location = 0) flat in vec4 in_position;
layout(location = 1) flat in vec4 in_light_color;
layout(location = 2) flat in vec4 in_direction;
layout(location = 3) flat in vec4 in_edge;
layout(location = 0) out vec4 out_color;

vec3 light_one(Surface s) {
    return SPOTS != 0u ? light_spot(s, in_position, in_light_color, in_direction, in_edge.x)
                       : light_point(s, in_position, in_light_color);
}

// The same terms as in light_point and light_spot: outside, they give 0.
bool light_reaches(vec3 position) {
    vec3 l = in_position.xyz - position;
    float d2 = max(dot(l, l), 1e-8);
    bool reaches = d2 * in_position.w < 1.0;
    if (SPOTS != 0u)
        reaches = reaches && -dot(l * inversesqrt(d2), in_direction.xyz) > in_direction.w;
    return reaches;
}

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    vec3 sum = vec3(0.0);
    if (LIGHT_BRANCH != 0u) {
        uint rounds = g.depth > 0.0 && light_reaches(g.position) ? 1u : 0u;
        for (uint i = 0u; i < rounds; i++) sum += light_one(gbuffer_surface(g));
    } else {
        sum = light_one(gbuffer_surface(g));
    }
    out_color = vec4(g.depth > 0.0 ? sum * gbuffer_receives(g) : vec3(0.0), 0.0);
}
