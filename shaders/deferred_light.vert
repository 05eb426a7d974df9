#version 460
// deferred_light.vert: one full-screen triangle a light (instance = light).
layout(location = 0) flat out uint out_light;

void main() {
    vec2 p = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    gl_Position = vec4(p * 2.0 - 1.0, 0.0, 1.0);
    out_light = gl_InstanceIndex;
}
