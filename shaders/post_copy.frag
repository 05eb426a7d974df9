#version 460
// post_copy.frag: the radiance so far, pixel by pixel, for a step that reads other pixels than its
// own.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(set = 0, binding = BINDING_HDR) uniform sampler2D hdr;
layout(location = 0) out vec4 out_color;

void main() { out_color = texelFetch(hdr, ivec2(gl_FragCoord.xy), 0); }
