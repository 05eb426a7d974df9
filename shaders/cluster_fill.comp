#version 460
// cluster_fill.comp: the lights of each occupied cluster, see cluster_lists.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define FILL
#include "cluster_lists.glsl"
