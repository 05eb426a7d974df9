#version 460
// shadow.vert: depth of casters, seen from the directional light.
#extension GL_GOOGLE_include_directive : require
#include "mesh.glsl"

void main() { gl_Position = frame.shadow_matrix * vec4(mesh_world_position(), 1.0); }
