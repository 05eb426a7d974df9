#version 460
// prepass.vert: depth of opaque meshes, before anything is shaded.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

void main() { gl_Position = frame.view_projection * vec4(mesh_world_position(), 1.0); }
