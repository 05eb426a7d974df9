#version 460
// gi_filter_mip.comp: images of half floats
#extension GL_GOOGLE_include_directive : require
#include "gi_filter_mip.glsl"
