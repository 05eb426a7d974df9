#version 460
// surfaces.vert: one triangle over the screen a hair before the far end (reversed depth), so a depth
// test LESS_OR_EQUAL lets it through only where something was drawn.
#extension GL_GOOGLE_include_directive : require

void main() {
    vec2 p = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    gl_Position = vec4(p * 2.0 - 1.0, 1e-7, 1.0);
}
