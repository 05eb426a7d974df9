#version 460
// gi_tiled.comp: path `tiled_deferred` with indirect light, of one sample a pixel, on the software
// driver: what tiled.comp and gi_compose.comp do, by one read of the G-buffer and one store. Indirect
// light was traced before; pixels that are alone get it later (gi_alone.comp).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "subgroups.glsl"
#define TILED_GI
#include "tiled.glsl"
