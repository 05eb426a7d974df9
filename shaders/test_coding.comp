#version 460
// test_coding.comp: of tests/gpu: what test_coding.frag wrote, decoded into a buffer.
#extension GL_GOOGLE_include_directive : require
#include "coding.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint CODING = 0;
layout(set = 0, binding = 0) uniform sampler2D codes;
layout(set = 0, binding = 1) writeonly buffer Out { vec4 values_out[]; };
layout(push_constant) uniform Push { uint side; float reach; };

void main() {
    uvec2 p = gl_GlobalInvocationID.xy;
    if (p.x >= side || p.y >= side) return;
    vec4 t = texelFetch(codes, ivec2(p), 0), v = vec4(0.0);
    if (CODING == 0u) v.x = distance16_decode(t.xy, reach);
    if (CODING == 1u) v.x = distance24_decode(t.xyz, reach);
    if (CODING == 2u) v.xyz = oct_decode(t.xy * 2.0 - 1.0);
    if (CODING == 3u) v.xyz = facing_decode(signed8_decode(t.xy), facing_z(signed8_decode(t.xy)));
    if (CODING == 4u) v.xy = oren_nayar_decode(t.x);
    if (CODING == 5u) v.rgb = light8_decode(t);
    if (CODING == 6u) v.x = power8_decode(t.x);
    if (CODING == 7u) v.xy = motion8_decode(t.xy);
    if (CODING == 8u) v.rgb = albedo8_decode(t.rgb);
    values_out[p.y * side + p.x] = v;
}
