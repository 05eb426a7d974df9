#version 460
// gi_light_byte.comp: images of bytes
#extension GL_GOOGLE_include_directive : require
#define GI_BYTE
#include "gi_light.glsl"
