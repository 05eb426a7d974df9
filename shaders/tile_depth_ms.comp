#version 460
// tile_depth_ms.comp: depths seen in each tile of a multisampled picture, see tile_depth.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define MULTISAMPLED
#include "tile_depth.glsl"
