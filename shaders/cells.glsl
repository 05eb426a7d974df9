// cells.glsl: which lights a pixel has: its cell of the light grid (tile or cluster), the cell's
// list, and the sum of that list's lights.
//
// Needs subgroups.glsl, included before anything else.
// Lists come from the packet or from buffers that the device filled (DEVICE_LISTS). CLUSTERED 0: a
// cell is a tile; 1: a tile and a slice of depth; 2: the pixel says which (PIXEL_CLUSTERS).
// Light indices are made uniform over the subgroup: then lights are scalar reads.
#ifndef CELLS_GLSL
#define CELLS_GLSL
#include "light.glsl"

// Shaders that make the lists define it as nothing.
#ifndef LIST_ACCESS
#define LIST_ACCESS readonly
#endif
layout(std430, set = 0, binding = BINDING_CELLS) readonly buffer CellBuffer { CellRecord cells[]; };
layout(std430, set = 0, binding = BINDING_LIGHT_INDICES) readonly buffer IndexBuffer {
    uint light_indices[];
};
layout(std430, set = 0, binding = BINDING_LIST_CELLS) LIST_ACCESS buffer ListCellBuffer {
    CellRecord list_cells[];
};
layout(std430, set = 0, binding = BINDING_LIST_INDICES) LIST_ACCESS buffer ListIndexBuffer {
    uint list_indices[];
};
layout(std430, set = 0, binding = BINDING_PIXEL_CLUSTERS) LIST_ACCESS buffer PixelClusterBuffer {
    uint pixel_clusters[];
};
layout(std430, set = 0, binding = BINDING_CLUSTERS) LIST_ACCESS buffer ClusterBuffer {
    uint clusters[];
};
layout(std430, set = 0, binding = BINDING_TILE_DEPTHS) LIST_ACCESS buffer TileDepthBuffer {
    TileDepthRecord tile_depths[];
};

// Slice of depth, see FrameRecord.slices.
uint cell_slice(float view_depth) {
    float slice = floor(log2(view_depth) * frame.slices.x + frame.slices.y);
    return uint(clamp(slice, 0.0, float(frame.grid.z) - 1.0));
}

// A pixel of several samples may lie in several clusters, and a fragment is shaded at the pixel's
// centre, whose depth no sample need have: its slice is looked up among those of the tile. One that
// is not there (a surface seen edge on, beyond whose rim the centre lies) uses all lights.
uint cell_of_slice(uint tile, uint slice) {
    uint first = tile_depths[tile].mask.w;
    uint count = first == CLUSTER_ALL ? 0u : tile_depths[tile].mask.z;
    uint place = count > 0u ? first : CLUSTER_ALL;
    uint key = tile << CLUSTER_TILE_SHIFT | slice;
    for (uint step = CLUSTER_SLICES_CAP / 2; step > 0u; step >>= 1u) {
        uint next = place + step;
        bool before = next < first + count && clusters[next] <= key;
        place = before ? next : place;
    }
    return count > 0u && clusters[place] == key ? place : CLUSTER_ALL;
}

// The cell of a pixel at a view depth in m.
uint cell_of(uvec2 pixel, float view_depth) {
    uvec2 at = pixel >> TILE_SHIFT;
    uint tile = at.y * frame.grid.x + at.x;
    if (CLUSTERED == 2u)
        return SAMPLES > 1u ? cell_of_slice(tile, cell_slice(view_depth))
                            : pixel_clusters[pixel.y * uint(frame.viewport.x) + pixel.x];
    return CLUSTERED == 1u ? tile + cell_slice(view_depth) * frame.grid.x * frame.grid.y : tile;
}

// CellRecord.list.
uvec4 cell_list(uint cell) {
    return DEVICE_LISTS != 0u ? list_cells[cell].list : cells[cell].list;
}
// Entry of a list: index of a light.
uint cell_index(uint at) { return DEVICE_LISTS != 0u ? list_indices[at] : light_indices[at]; }

// Where the four classes of a list end: points, diffuse points, spots, diffuse spots.
uvec4 cell_classes(uvec4 list) {
    uint points = list.x + list.y, all = points + list.z;
    return uvec4(points - (list.w & 0xFFFFu), points, all - (list.w >> 16u), all);
}

// The list of all lights, whose entries are their own places.
uvec4 cell_list_all() {
    uvec2 diffuse = flow.counts.xy - flow.counts3.xy;
    diffuse = mix(diffuse, uvec2(0u), greaterThan(diffuse, uvec2(0xFFFFu)));
    return uvec4(0u, flow.counts.xy, diffuse.x | diffuse.y << 16u);
}

// The software driver stops an invocation after 65,535 iterations of loops.
const uint CELL_ITERATIONS_SAFE = 60000u;

// Light at a place of a list, or (all) of the list of all lights; uniform over the subgroup. Lists
// made on the device have that list in their own order (CLUSTER_ALL).
uint cell_light_index(uint at, bool all) {
    uint index = cell_index(subgroupBroadcastFirst(at));
    return subgroupBroadcastFirst(all && DEVICE_LISTS == 0u ? at : index);
}

vec3 cell_light_list(Surface s, uvec4 list, bool all) {
    vec3 sum = vec3(0.0);
    uvec4 ends = cell_classes(list);
    uint point_count = flow.counts.x;
    uint at = list.x;
    for (; at < ends.x; at++) {
        uint index = cell_light_index(at, all);
        sum += light_point(s, light_position(index), light_color(index));
    }
    for (; at < ends.y; at++) {
        uint index = cell_light_index(at, all);
        sum += light_point_diffuse(s, light_position(index), light_color(index));
    }
    if (SPOTS == 0u) return sum;
    for (; at < ends.z; at++) {
        uint index = cell_light_index(at, all);
        sum += light_spot(s, light_position(index), light_color(index),
                          spot_direction(index - point_count), spot_edge(index - point_count));
    }
    for (; at < ends.w; at++) {
        uint index = cell_light_index(at, all);
        sum += light_spot_diffuse(s, light_position(index), light_color(index),
                                  spot_direction(index - point_count),
                                  spot_edge(index - point_count));
    }
    return sum;
}

// Sum of the lights of a cell, for fragment shaders and others whose lanes may be off. Pixels of a
// subgroup that lie in several cells take turns, a cell at a time; all lanes go along, and those of
// other cells keep their sum.
vec3 cell_light(Surface s, uint cell) {
    uvec4 list = cell_list(cell), lanes = subgroupBallot(true);
    bool all = false;
    if (CLUSTERED != 0u) {
        // So many cells with so many lights that the loops would be cut: all lights instead, which
        // is the same sum (a light that is not in the list adds 0). A subgroup of the software
        // driver lies in one tile.
        uint total = 0u;
        for (uvec4 open = lanes; subgroupBallotBitCount(open) > 0u;) {
            uint leader = subgroupBallotFindLSB(open);
            total += subgroupShuffle(list.y + list.z, leader);
            open &= ~subgroupBallot(cell == subgroupShuffle(cell, leader));
        }
        all = total > CELL_ITERATIONS_SAFE;
        if (all) {
            cell = CLUSTER_ALL;
            list = CLUSTERED == 2u ? cell_list(cell) : cell_list_all();
        }
    }
    vec3 sum = vec3(0.0);
    for (uvec4 open = lanes; subgroupBallotBitCount(open) > 0u;) {
        uint leader = subgroupBallotFindLSB(open);
        bool turn = cell == subgroupShuffle(cell, leader);
        vec3 turn_sum = cell_light_list(s, subgroupShuffle(list, leader), all);
        sum = turn ? turn_sum : sum;
        open &= ~subgroupBallot(turn);
    }
    return sum;
}
#endif
