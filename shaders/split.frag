#version 460
// split.frag: two pictures of one view as one: A left of a line, B right of it, or their difference.
// The pass's scissor leaves out the pixels where A stays as it is. SPEC_POST: SplitMode of render.h.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_HDR_OTHER) uniform sampler2D picture_a; // a copy
layout(set = 0, binding = BINDING_LDR_OTHER) uniform sampler2D picture_b;
layout(push_constant) uniform Push { float line_px, band_px, gain; } split;
layout(location = 0) out vec4 out_color;

// The largest channel's difference as brightness: black, red, yellow, white.
vec3 difference_color(vec3 a, vec3 b) {
    // The copy of A has 11 bits a channel: rounding gives back the 8 that it was made of.
    vec3 d = abs(round(a * 255.0) - round(b * 255.0)) * (split.gain / 255.0);
    float x = max(d.r, max(d.g, d.b));
    return clamp(vec3(x * 3.0, x * 3.0 - 1.0, x * 3.0 - 2.0), 0.0, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 b = texelFetch(picture_b, pixel, 0).rgb, color = b;
    float from_line = gl_FragCoord.x - split.line_px;
    if (POST != 0u) {
        vec3 difference = difference_color(texelFetch(picture_a, pixel, 0).rgb, b);
        color = POST == 1u || abs(from_line) < split.band_px ? difference : b;
    }
    // Thin lines: one at the middle, or one at each side of the band.
    float rim = POST == 2u ? abs(abs(from_line) - split.band_px) : abs(from_line);
    if (POST != 1u && rim <= 1.0) color = vec3(0.95, 0.85, 0.6);
    out_color = vec4(color, 1.0);
}
