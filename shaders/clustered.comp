#version 460
// clustered.comp: path `clustered_deferred`: the G-buffer is read once, then the lights of the
// pixel's cluster. A group is 8x8 pixels.
//
// Pixels of a subgroup may lie in several clusters: these take turns, so that light indices are
// uniform; all lanes go along, and those of other clusters keep their sum.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "subgroups.glsl"
#include "gbuffer.glsl"
#include "cells.glsl"
layout(local_size_x = 64) in;

layout(set = 0, binding = BINDING_HDR_STORAGE, rgba16f) writeonly uniform image2D hdr;

// Of the cell's list, or of all lights in order.
uint list_entry(bool all, uint at) { return all ? at : cell_index(at); }
const uint SURFACES = 1u;
#include "list_shade.glsl"

const uint NO_CELL = 0xFFFFFFFFu;

void main() {
    ivec2 size = ivec2(frame.viewport.xy);
    uint q = gl_LocalInvocationID.x;
    ivec2 pixel = ivec2(gl_WorkGroupID.xy * 8u) + ivec2(q & 7u, q >> 3u);
    ivec2 clamped = min(pixel, size - 1);
    GbufferPixel g = gbuffer_read(clamped);
    Surface s = gbuffer_surface(g);
    bool lit = g.depth > 0.0;
    uint cell = lit ? cell_of(uvec2(clamped), frame.camera.w / max(g.depth, 1e-30)) : NO_CELL;
    uvec4 list = lit ? cell_list(cell) : uvec4(0u);

    // So many clusters with so many lights that the loops would be cut: all lights instead, which
    // is the same sum (a light that is not in the list adds 0).
    uint total = 0u;
    for (uvec4 open = subgroupBallot(lit); subgroupBallotBitCount(open) > 0u;) {
        uint leader = subgroupBallotFindLSB(open);
        total += subgroupShuffle(list.y + list.z, leader);
        open &= ~subgroupBallot(cell == subgroupShuffle(cell, leader));
    }
    bool all = total > CELL_ITERATIONS_SAFE, in_order = all && CLUSTERED != 2u;
    if (all) {
        cell = lit ? CLUSTER_ALL : NO_CELL;
        list = CLUSTERED == 2u ? cell_list(CLUSTER_ALL) : cell_list_all();
    }

    Surfaces surfaces;
    surfaces.at[0] = s;
    vec3 sum = vec3(0.0);
    for (uvec4 open = subgroupBallot(lit); subgroupBallotBitCount(open) > 0u;) {
        uint leader = subgroupBallotFindLSB(open);
        uvec4 turn_list = subgroupShuffle(list, leader);
        bool turn = cell == subgroupShuffle(cell, leader);
        Sums turn_sum = shade_list(surfaces, in_order, turn_list.x, cell_classes(turn_list));
        sum = turn ? turn_sum.at[0] : sum;
        open &= ~subgroupBallot(turn);
    }
    vec3 radiance = gbuffer_radiance(g, s, sum);
    if (pixel.x < size.x && pixel.y < size.y)
        imageStore(hdr, pixel, vec4(lit ? radiance : vec3(0.0), 1.0));
}
