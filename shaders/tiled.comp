#version 460
// tiled.comp: path `tiled_deferred`: see tiled.glsl.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "subgroups.glsl"
#include "tiled.glsl"
