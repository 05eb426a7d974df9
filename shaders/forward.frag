#version 460
// forward.frag: surfaces that are shaded where they are drawn (forward.glsl).
#extension GL_GOOGLE_include_directive : require
#include "forward.glsl"
