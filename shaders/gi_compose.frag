#version 460
// gi_compose.frag: indirect light into the picture, of one sample a pixel (gi_compose.glsl).
#extension GL_GOOGLE_include_directive : require
#include "gi_compose.glsl"
