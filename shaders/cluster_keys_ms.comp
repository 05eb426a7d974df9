#version 460
// cluster_keys_ms.comp: keys of the clusters that any sample sees, see cluster_keys.glsl.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#define MULTISAMPLED
#include "cluster_keys.glsl"
