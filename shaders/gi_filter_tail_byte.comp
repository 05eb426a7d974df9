#version 460
// gi_filter_tail_byte.comp: images of bytes
#extension GL_GOOGLE_include_directive : require
#define GI_BYTE
#define GI_FILTER_TAIL
#include "gi_filter_mip.glsl"
