#version 460
// test_draw.vert: of tests/gpu: positions are clip space already.
layout(location = 0) in vec3 in_position;
layout(location = 4) in vec4 in_color;
layout(location = 0) out vec4 out_color;

void main() {
    gl_Position = vec4(in_position, 1.0);
    out_color = in_color;
}
