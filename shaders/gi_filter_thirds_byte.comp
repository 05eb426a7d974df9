#version 460
// gi_filter_thirds_byte.comp: images of bytes
#extension GL_GOOGLE_include_directive : require
#define GI_BYTE
#include "gi_filter_thirds.glsl"
