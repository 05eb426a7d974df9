#version 460
// fullscreen.vert: one triangle over the screen at depth 0 (the far end of reversed depth), so a
// depth test GREATER_OR_EQUAL lets it through only where nothing was drawn.
#extension GL_GOOGLE_include_directive : require

void main() {
    vec2 p = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    gl_Position = vec4(p * 2.0 - 1.0, 0.0, 1.0);
}
