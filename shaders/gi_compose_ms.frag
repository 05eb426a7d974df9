#version 460
// gi_compose_ms.frag: indirect light into the picture, of several samples a pixel (gi_compose.glsl).
#extension GL_GOOGLE_include_directive : require
#define GI_SAMPLES
#include "gi_compose.glsl"
