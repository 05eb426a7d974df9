#version 460
// test_coding.frag: of tests/gpu: a buffer's values, encoded into a target by one coding of
// coding.glsl.
#extension GL_GOOGLE_include_directive : require
#include "coding.glsl"
layout(constant_id = 0) const uint CODING = 0;
layout(set = 0, binding = 0) readonly buffer In { vec4 values_in[]; };
layout(push_constant) uniform Push { uint side; float reach; };
layout(location = 0) out vec4 out_code;

void main() {
    vec4 v = values_in[uint(gl_FragCoord.y) * side + uint(gl_FragCoord.x)];
    vec4 t = vec4(0.0);
    if (CODING == 0u) t.xy = distance16_encode(v.x, reach);
    if (CODING == 1u) t.xyz = distance24_encode(v.x, reach);
    if (CODING == 2u) t.xy = oct_encode(v.xyz) * 0.5 + 0.5;
    if (CODING == 3u) t.xy = signed8_encode(v.xy);
    if (CODING == 4u) t.x = oren_nayar_encode(v.xy);
    if (CODING == 5u) t = light8_encode(v.rgb);
    if (CODING == 6u) t.x = power8_encode(v.x);
    if (CODING == 7u) t.xy = motion8_encode(v.xy);
    if (CODING == 8u) t.rgb = albedo8_encode(v.rgb);
    out_code = t;
}
