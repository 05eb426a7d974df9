#version 460
// deferred_resolve.frag: the full-precision sum of `deferred` into the HDR target of all paths. A
// thousand additions in half floats would lose the small ones.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
layout(set = 0, binding = BINDING_ACCUMULATION) uniform sampler2D accumulation;
layout(location = 0) out vec4 out_color;

void main() { out_color = texelFetch(accumulation, ivec2(gl_FragCoord.xy), 0); }
