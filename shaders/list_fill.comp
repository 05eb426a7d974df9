#version 460
// list_fill.comp: the lights of each tile, see list_tiles.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define FILL
#include "list_tiles.glsl"
