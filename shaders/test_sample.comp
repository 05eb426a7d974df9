#version 460
// test_sample.comp: of tests/gpu: one mip of a texture, texel by texel, into a buffer.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D source;
layout(set = 0, binding = 1) writeonly buffer Out { vec4 values_out[]; };
layout(push_constant) uniform Push { uint width, height, mip; };

void main() {
    uvec2 p = gl_GlobalInvocationID.xy;
    if (p.x >= width || p.y >= height) return;
    vec2 uv = (vec2(p) + 0.5) / vec2(width, height);
    values_out[p.y * width + p.x] = textureLod(source, uv, float(mip));
}
