#version 460
// test_buffer.comp: of tests/gpu: out = in * MULTIPLY + add.
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint MULTIPLY = 1;
layout(constant_id = 1) const uint EXTRA = 0;
layout(set = 0, binding = 0) readonly buffer In { uint values_in[]; };
layout(set = 0, binding = 1) buffer Out { uint values_out[]; };
layout(push_constant) uniform Push { uint count, add; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    values_out[i] = values_in[i] * MULTIPLY + add + EXTRA;
}
