#version 460
// tile_depth.comp: depths seen in each tile, see tile_depth.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "tile_depth.glsl"
