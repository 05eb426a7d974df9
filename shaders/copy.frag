#version 460
// copy.frag: a picture into another, pixel by pixel. SPEC_POST says which: COPY_HDR, COPY_LDR.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_HDR) uniform sampler2D hdr;
layout(set = 0, binding = BINDING_LDR) uniform sampler2D ldr;
layout(location = 0) out vec4 out_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (POST == COPY_HDR)
        out_color = texelFetch(hdr, pixel, 0);
    else
        out_color = texelFetch(ldr, pixel, 0);
}
