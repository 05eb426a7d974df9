#version 460
// split_copy.frag: picture A, pixel by pixel, so that the difference can be written over it.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"

layout(set = 0, binding = BINDING_LDR) uniform sampler2D ldr;
layout(location = 0) out vec4 out_color;

void main() { out_color = texelFetch(ldr, ivec2(gl_FragCoord.xy), 0); }
