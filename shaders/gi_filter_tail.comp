#version 460
// gi_filter_tail.comp: the last mips of an atlas of half floats by one group (gi_filter_mip.glsl).
#extension GL_GOOGLE_include_directive : require
#define GI_FILTER_TAIL
#include "gi_filter_mip.glsl"
