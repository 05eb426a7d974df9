#version 460
// test_draw.frag: of tests/gpu: the vertex colour times a pushed factor.
layout(location = 0) in vec4 in_color;
layout(location = 0) out vec4 out_color;
layout(push_constant) uniform Push { vec4 factor; };

void main() { out_color = in_color * factor; }
