#version 460
// list_count.comp: how many lights each tile has, see list_tiles.glsl; and the list of all lights.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "list_tiles.glsl"
