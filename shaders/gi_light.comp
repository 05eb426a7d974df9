#version 460
// gi_light.comp: images of half floats
#extension GL_GOOGLE_include_directive : require
#include "gi_light.glsl"
