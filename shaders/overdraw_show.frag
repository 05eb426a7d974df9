#version 460
// overdraw_show.frag: the counts of overdraw.frag in HDR as colours; debug_draw.c draws their legend.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_HDR) uniform sampler2D hdr;
layout(location = 0) out vec4 out_color;

// Black for none, red for 9.
void main() {
    float count = texelFetch(hdr, ivec2(gl_FragCoord.xy), 0).r;
    out_color = vec4(count < 0.5 ? vec3(0.0) : heat_map((count - 1.0) / 8.0), 1.0);
}
