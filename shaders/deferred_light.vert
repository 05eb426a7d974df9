#version 460
// deferred_light.vert: one full-screen triangle a light; the light itself comes as an attribute.
layout(location = 0) in vec4 in_position;
layout(location = 1) in vec4 in_light_color;
layout(location = 2) in vec4 in_direction;
layout(location = 3) in vec4 in_edge;
layout(location = 0) flat out vec4 out_position;
layout(location = 1) flat out vec4 out_light_color;
layout(location = 2) flat out vec4 out_direction;
layout(location = 3) flat out vec4 out_edge;

void main() {
    vec2 p = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    gl_Position = vec4(p * 2.0 - 1.0, 0.0, 1.0);
    out_position = in_position;
    out_light_color = in_light_color;
    out_direction = in_direction;
    out_edge = in_edge;
}
