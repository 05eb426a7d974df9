#version 460
// tonemap.frag: HDR radiance to the sRGB-encoded picture: exposure, Reinhard a channel, gamma, and
// a dither of half a step against bands in the dark.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_HDR) uniform sampler2D hdr;
layout(push_constant) uniform Push { float exponent; } gamma; // SPEC_POST 1: instead of sRGB
layout(location = 0) out vec4 out_color;

void main() {
    vec3 c = texelFetch(hdr, ivec2(gl_FragCoord.xy), 0).rgb * frame.ambient.w;
    c = TONEMAP != 0u ? c / (1.0 + c) : clamp(c, 0.0, 1.0);
    // Interleaved gradient noise (Jimenez 2014).
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec3 encoded = POST != 0u ? pow(c, vec3(gamma.exponent)) : srgb_encode_fast(c);
    out_color = vec4(encoded + (noise - 0.5) / 255.0, 1.0);
}
