// cluster_lists.glsl: lights of each occupied cluster, counted (cluster_count.comp) and then
// written (cluster_fill.comp, FILL), by the same tests.
//
// One subgroup a tile. First the lights that touch the tile's part of the view that is seen are
// gathered, in order: by the hierarchy over Morton-ordered lights if the packet has one (8 children
// at a time, one a lane, depth first, so that lights come in the order of the leaves), else one by
// one. Then each of the tile's clusters tests the gathered ones against its box and, if clusters
// are told apart by normals, leaves out lights behind all of them. When more are gathered than fit
// into shared memory, the clusters take them in several goes. A tile with many clusters is dealt
// out to several groups (y), so that no invocation has more iterations of loops than the software
// driver allows.
#include "list_make.glsl"
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = BINDING_GRID_NODES) readonly buffer GridNodeBuffer {
    GridNode grid_nodes[];
};

const uint GATHERED_CAP = 256u;
const uint STACK_CAP = 16u; // 8^16 lights
shared uint gathered[SUBGROUPS_CAP * GATHERED_CAP];
shared uint stack_first[SUBGROUPS_CAP * STACK_CAP]; // a level's children that are yet to be visited
shared uint stack_mask[SUBGROUPS_CAP * STACK_CAP];

// --- A cluster's box ---

struct Cluster {
    vec3 low, high;  // view coordinates, see list_make.glsl
    vec3 center;
    float radius;
    uint direction;  // of normals, see cluster_keys.glsl
    vec3 center_world; // from the eye, in the world's axes
};

// Ends of a slice, a tenth of a slice further on both sides: log2 is not exact.
float slice_near(uint slice) {
    return slice == 0u ? 0.0 : frame.slices.z * pow(frame.slices.w, float(slice) - 1.1);
}
float slice_far(uint slice) {
    bool last = slice + 1u == flow.grid.z;
    return last ? 1e18 : frame.slices.z * pow(frame.slices.w, float(slice) + 0.1);
}

Cluster cluster_of(Volume v, uint key) {
    uint slice = key & 255u;
    Cluster c;
    float near = max(slice_near(slice), v.near * 0.9999);
    float far = min(slice_far(slice), v.far * 1.0001);
    c.low = vec3(min(v.side.xz * near, v.side.xz * far), near);
    c.high = vec3(max(v.side.yw * near, v.side.yw * far), far);
    c.center = (c.low + c.high) * 0.5;
    c.radius = length(c.high - c.center);
    c.direction = (key >> 8u) & 7u;
    c.center_world = (c.center * vec3(1.0, 1.0, -1.0)) * mat3(frame.view); // its inverse
    return c;
}

// Behind every normal of the cluster's direction, seen from anywhere in it? Normals whose longest
// part is along x are n = nx (1, u, v), |u|, |v| <= 1, so n.l > 0 for some of them only if
// lx + |ly| + |lz| > 0, which changes by at most sqrt(3) times what l changes.
bool light_behind(Cluster c, uint index) {
    vec3 l = light_position(index).xyz - frame.camera.xyz - c.center_world;
    vec3 a = abs(l);
    uint axis = c.direction >> 1u;
    float along = axis == 0u ? l.x : axis == 1u ? l.y : l.z;
    float across = a.x + a.y + a.z - abs(along);
    along = (c.direction & 1u) != 0u ? -along : along;
    return along + across < -1.7330 * c.radius - 1e-4 * (a.x + a.y + a.z);
}

bool light_in_cluster(Cluster c, uint index, bool spot) {
    ViewLight light = view_light(index, spot);
    vec3 outside = max(c.low - light.at, vec3(0.0)) + max(light.at - c.high, vec3(0.0));
    float reach = light.reach + light.slack;
    bool hit = dot(outside, outside) <= reach * reach;
    if (spot) {
        // The cone against the box's ball: how far its centre is outside the cone's side.
        vec3 to = c.center - light.at;
        float along = dot(to, light.axis);
        float across = sqrt(max(dot(to, to) - along * along, 0.0));
        bool miss = across * light.cos_half - along * light.sin_half >
                    c.radius * 1.001 + light.slack;
        hit = hit && !miss;
    }
    if (CLUSTER_NORMALS != 0u) hit = hit && !light_behind(c, index);
    return hit;
}

bool is_diffuse(uint index) {
    uint points = flow.counts.x;
    return index < points ? index >= flow.counts3.x : index - points >= flow.counts3.y;
}

// --- The tile's clusters take what was gathered ---

void take(Volume v, uint first, uint last, uint count, bool spot) {
    subgroupMemoryBarrierShared();
    subgroupBarrier();
    uint base = gl_SubgroupID * GATHERED_CAP;
    for (uint place = first; place < last; place++) {
        Cluster c = cluster_of(v, subgroupBroadcastFirst(clusters[place]));
        uint at = 0u, diffuse = 0u, hits = 0u;
#ifdef FILL
        // Only lane 0 reads and writes it, so that it sees its own writes.
        if (gl_SubgroupInvocationID == 0u) at = list_cells[place].list.x;
        at = subgroupBroadcastFirst(at);
        uint end = at < light_total() ? 0u : count; // uses the list of all lights
#else
        uint end = count;
#endif
        for (uint b = 0u; b < end; b += gl_SubgroupSize) {
            uint k = b + gl_SubgroupInvocationID;
            uint index = gathered[base + min(k, end - 1u)];
            bool hit = k < end && light_in_cluster(c, index, spot);
            uvec4 ballot = subgroupBallot(hit);
#ifdef FILL
            if (hit) list_indices[at + hits + subgroupBallotExclusiveBitCount(ballot)] = index;
#else
            diffuse += subgroupBallotBitCount(subgroupBallot(hit && is_diffuse(index)));
#endif
            hits += subgroupBallotBitCount(ballot);
        }
        if (gl_SubgroupInvocationID == 0u) {
#ifdef FILL
            if (end > 0u) list_cells[place].list.x = at + hits;
#else
            uvec4 list = list_cells[place].list;
            // The hierarchy's order does not tell classes apart: then all have highlights.
            bool by_class = !has_hierarchy() && light_total() <= 0xFFFFu;
            if (spot) list.z += hits;
            else list.y += hits;
            if (by_class) list.w += diffuse << (spot ? 16u : 0u);
            list_cells[place].list = list;
#endif
        }
    }
    subgroupMemoryBarrierShared();
    subgroupBarrier();
}

// --- Gathering ---

uint gather(uint count, bool hit, uint index) {
    uvec4 ballot = subgroupBallot(hit);
    uint at = gl_SubgroupID * GATHERED_CAP + count + subgroupBallotExclusiveBitCount(ballot);
    if (hit) gathered[at] = index;
    return count + subgroupBallotBitCount(ballot);
}

bool node_in_volume(Volume v, GridNode node) {
    vec3 low = vec3(node.low.xy, -node.high.z), high = vec3(node.high.xy, -node.low.z);
    float slack = 1e-4 * (abs(low.x) + abs(low.y) + abs(low.z) + abs(high.x) + abs(high.y) +
                          abs(high.z));
    // The corner that lies deepest within each side.
    vec4 side = v.side;
    vec4 depth = mix(vec4(high.z, low.z, high.z, low.z), vec4(low.z, high.z, low.z, high.z),
                     greaterThanEqual(side, vec4(0.0)));
    vec4 inside = vec4(high.x - side.x * depth.x, side.y * depth.y - low.x,
                       high.y - side.z * depth.z, side.w * depth.w - low.y);
    return all(greaterThanEqual(inside, vec4(-slack))) && high.z >= v.near - slack &&
           low.z <= v.far + slack;
}

// All lights [first, last), one by one.
void gather_flat(Volume v, uint first, uint last, uint place, uint end, bool spot) {
    uint next = first;
    while (next < last) {
        uint count = 0u;
        for (; next < last && count + gl_SubgroupSize <= GATHERED_CAP; next += gl_SubgroupSize) {
            uint index = next + gl_SubgroupInvocationID;
            ViewLight light = view_light(min(index, last - 1u), spot);
            bool hit = index < last && light_in_sides(v, light, spot) &&
                       light_in_depths(v, light, spot);
            count = gather(count, hit, index);
        }
        take(v, place, end, count, spot);
    }
}

// The tree below a node.
void gather_tree(Volume v, uint root, bool any, uint place, uint end, bool spot) {
    uint stack = gl_SubgroupID * STACK_CAP, depth = any ? 1u : 0u;
    if (gl_SubgroupInvocationID == 0u) {
        stack_first[stack] = root;
        stack_mask[stack] = 1u;
    }
    while (depth > 0u) {
        uint count = 0u;
        while (depth > 0u && count + GRID_NODE_WIDTH <= GATHERED_CAP) {
            subgroupMemoryBarrierShared();
            subgroupBarrier();
            uint top = stack + depth - 1u;
            uint mask = subgroupBroadcastFirst(stack_mask[top]);
            uint at = subgroupBroadcastFirst(stack_first[top]) + uint(findLSB(mask));
            uint rest = mask & (mask - 1u);
            subgroupBarrier();
            if (gl_SubgroupInvocationID == 0u) stack_mask[top] = rest;
            depth -= rest == 0u ? 1u : 0u;

            GridNode node = grid_nodes[at];
            uint first = floatBitsToUint(node.low.w), children = floatBitsToUint(node.high.w);
            bool leaves = (children & 0x80000000u) != 0u;
            children &= 0x7FFFFFFFu;
            uint inner = 0u;
            for (uint b = 0u; b < GRID_NODE_WIDTH; b += gl_SubgroupSize) {
                uint child = b + gl_SubgroupInvocationID;
                bool there = child < min(children, GRID_NODE_WIDTH);
                // Both kinds of test are made, on something harmless where they do not apply: a
                // branch would not save the work on the software driver.
                uint light = light_indices[flow.counts3.w + (leaves && there ? first + child : 0u)];
                uint inner_child = leaves || !there ? at : first + child;
                ViewLight tested = view_light(leaves ? light : spot ? flow.counts.x : 0u, spot);
                bool hit_light = light_in_sides(v, tested, spot) && light_in_depths(v, tested, spot);
                bool hit_node = node_in_volume(v, grid_nodes[inner_child]);
                bool hit = there && (leaves ? hit_light : hit_node);
                count = gather(count, hit && leaves, light);
                // Subgroups of 4 take two goes; wider ones leave lanes idle.
                inner |= (subgroupBallot(hit && !leaves).x & 0xFFu) << b;
            }
            if (gl_SubgroupInvocationID == 0u && inner != 0u) {
                stack_first[stack + depth] = first;
                stack_mask[stack + depth] = inner;
            }
            depth += inner != 0u ? 1u : 0u;
        }
        take(v, place, end, count, spot);
    }
}

void main() {
#ifndef FILL
    write_list_of_all();
#endif
    uint points = flow.counts.x, all = light_total();
    for (uint tile = tile_first(); tile < tile_total(); tile += tile_stride()) {
        Volume v = tile_volume(tile);
        TileDepthRecord seen = tile_depths[tile];
        v.near = seen.range.x;
        v.far = seen.range.y;
        if (CELL_SAMPLES > 1u) {
            // Fragments are shaded at pixels' centres, at depths that no sample need have.
            v.near = slice_near(cell_slice(seen.range.x));
            v.far = slice_far(cell_slice(seen.range.y));
        }
        uint count = seen.mask.w >= CLUSTER_FIRST ? seen.mask.z : 0u;
        uint part = (count + gl_NumWorkGroups.y - 1u) / gl_NumWorkGroups.y;
        uint skipped = min(gl_WorkGroupID.y * part, count);
        uint place = seen.mask.w + skipped, end = place + min(part, count - skipped);
        bool any = end > place;
#ifndef FILL
        for (uint i = place; i < end; i++)
            if (gl_SubgroupInvocationID == 0u) list_cells[i].list = uvec4(0u);
#endif
        bool tree = flow.counts.w > 0u;
        gather_flat(v, 0u, any && !tree ? points : 0u, place, end, false);
        gather_tree(v, 0u, any && tree && points > 0u, place, end, false);
        if (SPOTS != 0u) {
            gather_flat(v, points, any && !tree ? all : points, place, end, true);
            gather_tree(v, flow.counts3.z, any && tree && all > points, place, end, true);
        }
#ifdef FILL
        // Cursors back to where the lists begin.
        for (uint i = place; i < end; i++) {
            uvec4 list = list_cells[i].list;
            if (gl_SubgroupInvocationID == 0u && list.x >= all)
                list_cells[i].list.x = list.x - list.y - list.z;
        }
#endif
    }
}
