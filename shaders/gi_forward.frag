#version 460
// gi_forward.frag: blended surfaces with what the voxels give to them (forward.glsl).
#extension GL_GOOGLE_include_directive : require
#define GI_SCREEN
#include "forward.glsl"
