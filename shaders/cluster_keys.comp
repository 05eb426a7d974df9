#version 460
// cluster_keys.comp: keys of the clusters that are seen, see cluster_keys.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "cluster_keys.glsl"
