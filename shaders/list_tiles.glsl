// list_tiles.glsl: lights of each tile, counted (list_count.comp) and then written
// (list_fill.comp, FILL), by the same test: the tile's sides, and the depths seen in it if
// TILE_DEPTH says so. One subgroup a tile, a light a lane.
#include "list_make.glsl"
layout(local_size_x = 64) in;

uint walk(Volume v, uint first, uint last, uint at, bool spot) {
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint index = b + gl_SubgroupInvocationID;
        ViewLight light = view_light(min(index, last - 1u), spot);
        bool hit =
            index < last && light_in_sides(v, light, spot) && light_in_depths(v, light, spot);
        uvec4 ballot = subgroupBallot(hit);
#ifdef FILL
        if (hit) list_indices[at + subgroupBallotExclusiveBitCount(ballot)] = index;
#endif
        at += subgroupBallotBitCount(ballot);
    }
    return at;
}

void main() {
#ifndef FILL
    write_list_of_all();
#endif
    uint points = flow.counts.x, all = light_total();
    uint bright_points = flow.counts3.x, bright_spots = points + flow.counts3.y;
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        Volume v = tile_volume_seen(tile);
        uint at = 0u;
        uvec4 ends = uvec4(bright_points, points, bright_spots, all);
#ifdef FILL
        at = list_cells[tile].list.x;
        if (at < all) ends = uvec4(0u); // uses the list of all lights; no loops
#endif
        uint start = at, middle;
        at = walk(v, 0u, ends.x, at, false);
        middle = at;
        at = walk(v, ends.x, ends.y, at, false);
        uint diffuse_points = at - middle, spots_start = at, diffuse_spots = 0u;
        if (SPOTS != 0u) {
            at = walk(v, ends.y, ends.z, at, true);
            middle = at;
            at = walk(v, ends.z, ends.w, at, true);
            diffuse_spots = at - middle;
        }
#ifndef FILL
        if (gl_SubgroupInvocationID == 0u)
            list_cells[tile].list = uvec4(0u, spots_start - start, at - spots_start,
                                          code_diffuse(diffuse_points, diffuse_spots));
#endif
    }
}
