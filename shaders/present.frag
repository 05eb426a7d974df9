#version 460
// present.frag: the finished picture onto the window, scaled with bilinear filtering.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
layout(set = 0, binding = BINDING_LDR) uniform sampler2D ldr;
layout(push_constant) uniform Push { vec2 inverse_size; } push;
layout(location = 0) out vec4 out_color;

void main() { out_color = vec4(texture(ldr, gl_FragCoord.xy * push.inverse_size).rgb, 1.0); }
