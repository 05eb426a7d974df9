#version 460
// overdraw_show.frag: the counts of overdraw.frag in HDR as colours; debug_draw.c draws their legend.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_HDR) uniform sampler2D hdr;
layout(location = 0) out vec4 out_color;

// Black for none; blue, cyan, green, yellow, red for 1 to 9; then to white at 16.
void main() {
    float count = texelFetch(hdr, ivec2(gl_FragCoord.xy), 0).r, x = (count - 1.0) / 8.0;
    vec3 color = clamp(vec3(4.0 * x - 1.5, 2.0 - abs(4.0 * x - 2.0), 1.5 - 4.0 * x), 0.0, 1.0);
    color = mix(color, vec3(1.0), clamp((x - 1.0) * 8.0 / 7.0, 0.0, 1.0));
    out_color = vec4(count < 0.5 ? vec3(0.0) : color * 0.9 + 0.1, 1.0);
}
