// list_make.glsl: what the shaders that make light lists share: their buffers, which tile a
// subgroup works on, and the tests of lights against tiles.
//
// One subgroup works on one tile, so that lists are compacted by ballots, in order, without shared
// memory or global appends: the same lists on every run. View coordinates here: x right, y up,
// z depth along the view, from the eye.
// Tests are conservative: what falls out adds exactly 0 to every pixel of the tile.
#ifndef LIST_MAKE_GLSL
#define LIST_MAKE_GLSL
#define LIST_ACCESS
#include "cells.glsl"

layout(std430, set = 0, binding = BINDING_GRID_COUNTERS) buffer CounterBuffer {
    uint grid_counters[];
};

// Samples of a pixel that have keys or depths.
const uint CELL_SAMPLES = SAMPLES > 1u ? SAMPLES : 1u;
// Subgroups of a group of 64; subgroups have 4 lanes at least.
const uint SUBGROUPS_CAP = 16u;

uint tile_total() { return flow.grid.x * flow.grid.y; }
uint tile_first() { return gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID; }
uint tile_stride() { return gl_NumWorkGroups.x * gl_NumSubgroups; }
uint light_total() { return flow.counts.x + flow.counts.y; }

// The list of all lights lies in front of the others, for cells that get no own one: in the order
// of the hierarchy, where there is one, as every list is then.
bool has_hierarchy() { return CLUSTERED == 2u && flow.counts.w > 0u; }
uint light_in_order(uint place) {
    return has_hierarchy() ? light_indices[flow.counts3.w + place] : place;
}
uvec4 list_of_all() {
    uvec4 list = cell_list_all();
    return has_hierarchy() ? uvec4(list.xyz, 0u) : list;
}
void write_list_of_all() {
    uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    uint end = gl_WorkGroupID.y == 0u ? light_total() : 0u;
    for (uint i = gl_GlobalInvocationID.x; i < end; i += stride)
        list_indices[i] = light_in_order(i);
}

// Diffuse points and spots of a list in CellRecord's coding.
uint code_diffuse(uint points, uint spots) {
    return (points > 0xFFFFu ? 0u : points) | (spots > 0xFFFFu ? 0u : spots) << 16u;
}

// --- Lights ---

vec3 to_view(vec3 v) { return vec3(1.0, 1.0, -1.0) * (mat3(frame.view) * v); }

struct ViewLight {
    vec3 at;    // centre, or tip of the cone
    float reach;
    float slack; // what rounding may lose in m
    vec3 axis;  // spots
    float cos_half, sin_half;
};

ViewLight view_light(uint index, bool spot) {
    vec4 position = light_position(index);
    vec3 from_eye = position.xyz - frame.camera.xyz;
    ViewLight light;
    light.at = to_view(from_eye);
    light.reach = inversesqrt(position.w);
    light.slack = 1e-4 * light.reach + 1e-5 * (abs(from_eye.x) + abs(from_eye.y) + abs(from_eye.z));
    light.axis = vec3(0.0);
    light.cos_half = -1.0;
    light.sin_half = 0.0;
    if (spot) {
        vec4 direction = spot_direction(index - flow.counts.x);
        light.axis = to_view(direction.xyz);
        light.cos_half = direction.w;
        light.sin_half = sqrt(max(1.0 - direction.w * direction.w, 0.0));
    }
    return light;
}

// How far the light reaches along a unit vector, from its centre or tip: of a cone, the cap of the
// ball if the vector is inside, else the rim, else the tip.
float light_extent(ViewLight light, vec3 along, bool spot) {
    if (!spot) return light.reach + light.slack;
    float c = dot(along, light.axis), s = sqrt(max(1.0 - c * c, 0.0));
    float rim = max(c * light.cos_half + s * light.sin_half + 1e-3, 0.0);
    return light.reach * (c >= light.cos_half ? 1.0 : rim) + light.slack;
}

// --- Tiles ---

struct Volume {
    vec4 side;    // left, right, bottom, top: x or y per m of depth
    vec4 inverse; // 1 / length of the side's normal
    float near, far;
    float scale;  // of slices, see TileDepthRecord
    uint mask;
};

// The tile's four sides, from the near plane on without end.
Volume tile_volume(uint tile) {
    uvec2 at = uvec2(tile % flow.grid.x, tile / flow.grid.x);
    vec2 low = vec2(at << TILE_SHIFT);
    vec2 high = min(vec2((at + 1u) << TILE_SHIFT), frame.viewport.xy);
    vec2 tangent = vec2(length(frame.ray_right.xyz), length(frame.ray_up.xyz));
    low = (low * frame.viewport.zw * 2.0 - 1.0) * tangent;
    high = (high * frame.viewport.zw * 2.0 - 1.0) * tangent;
    Volume v;
    v.side = vec4(low.x, high.x, -high.y, -low.y); // rows go down
    v.inverse = inversesqrt(1.0 + v.side * v.side);
    v.near = frame.camera.w;
    v.far = 1e30;
    v.scale = 0.0;
    v.mask = 0xFFFFFFFFu;
    return v;
}

// The same with what the tile's depths say. A tile of background only: near > far.
Volume tile_volume_seen(uint tile) {
    Volume v = tile_volume(tile);
    if (TILE_DEPTH != 0u) {
        TileDepthRecord seen = tile_depths[tile];
        v.near = seen.range.x;
        v.far = seen.range.y;
        v.scale = seen.range.z;
        v.mask = seen.mask.x;
    }
    return v;
}

bool light_in_sides(Volume v, ViewLight light, bool spot) {
    vec4 inside = vec4(light.at.x - v.side.x * light.at.z, v.side.y * light.at.z - light.at.x,
                       light.at.y - v.side.z * light.at.z, v.side.w * light.at.z - light.at.y) *
                  v.inverse;
    vec4 extent = vec4(
        light_extent(light, vec3(v.inverse.x, 0.0, -v.side.x * v.inverse.x), spot),
        light_extent(light, vec3(-v.inverse.y, 0.0, v.side.y * v.inverse.y), spot),
        light_extent(light, vec3(0.0, v.inverse.z, -v.side.z * v.inverse.z), spot),
        light_extent(light, vec3(0.0, -v.inverse.w, v.side.w * v.inverse.w), spot));
    return all(greaterThanEqual(inside, -extent));
}

// Slice of 32 between a tile's near and far; rises with depth, so what lies between two depths lies
// between their slices.
uint depth_slice(float depth, float near, float scale) {
    return uint(clamp((depth - near) * scale, 0.0, 31.0));
}

bool light_in_depths(Volume v, ViewLight light, bool spot) {
    float low = light.at.z - light_extent(light, vec3(0.0, 0.0, -1.0), spot);
    float high = light.at.z + light_extent(light, vec3(0.0, 0.0, 1.0), spot);
    bool hit = high >= v.near && low <= v.far;
    if (TILE_DEPTH == 2u) {
        uint first = depth_slice(low, v.near, v.scale), last = depth_slice(high, v.near, v.scale);
        hit = hit && (v.mask & (0xFFFFFFFFu << first) & (0xFFFFFFFFu >> (31u - last))) != 0u;
    }
    return hit;
}
#endif
