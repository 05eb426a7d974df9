#version 460
// cluster_count.comp: how many lights each occupied cluster has, see cluster_lists.glsl; and the
// list of all lights.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "cluster_lists.glsl"
