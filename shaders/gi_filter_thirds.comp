#version 460
// gi_filter_thirds.comp: images of half floats
#extension GL_GOOGLE_include_directive : require
#include "gi_filter_thirds.glsl"
