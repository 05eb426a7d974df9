#version 460
// gi_probes.comp: light that arrives at the probes of a grid over the box, one probe an invocation.
//
// A probe keeps an ambient cube (Mitchell, McTaggart and Green 2006, "Shading in Valve's Source
// engine"): for each of six directions the light that a surface facing it gets. Twelve cones through
// the voxels, towards the corners of an icosahedron, are shared by all six: each counts with the mean
// cosine over its own width. Besides a probe knows how far it is to the nearest occupied voxel along
// each axis: who looks it up leaves out probes behind walls. One that stands in a wall steps out of
// it, and its way back is 0; all ways of one that stands too deep are 0.
//
// Texel of block d (x = d * probes + x): rgb light for a surface that faces d, radiance; a: a code of
// 15 bits (gi_probe_code): d's axis' two distances and how open the probe is towards d.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
#include "gi_cones.glsl"
#include "gi_probe_code.glsl"
layout(local_size_x = 64) in;

layout(std140, set = 0, binding = BUILD_FRAME) uniform FrameBuffer { FrameRecord frame; };
layout(set = 0, binding = BUILD_PROBES_STORAGE, rgba16f) writeonly uniform image3D probes;
// Probes first, first + stride, ... (count of them) are traced.
layout(push_constant) uniform Push { uint first, stride, count; };

// Corners of an icosahedron: two of 0, +-A, +-B a coordinate plane.
const float A = 0.525731112, B = 0.850650808;
const vec3 CORNERS[12] =
    vec3[](vec3(0, A, B), vec3(0, A, -B), vec3(0, -A, B), vec3(0, -A, -B), vec3(A, B, 0),
           vec3(A, -B, 0), vec3(-A, B, 0), vec3(-A, -B, 0), vec3(B, 0, A), vec3(-B, 0, A),
           vec3(B, 0, -A), vec3(-B, 0, -A));

// Voxels to a cone's first sample. A probe has no surface of its own to get away from, but with faces
// apart what is behind a cone is opaque too: in a free voxel half a voxel is away from all voxels
// behind, and passes no wall ahead.
const float PROBE_START = GI_FACES != 0u ? 0.5 : GI_START;

// Mean of max(cosine, 0) over a cone of 60 degrees whose axis has one of the three cosines that
// occur, over their sum: 0.933 times the cosine, and 0.108 of a cone that is half behind.
float cosine_share(float cosine) {
    float share = cosine > 0.7 ? 0.793675 : cosine > 0.3 ? 0.490517 : 0.108253;
    return cosine < -0.3 ? 0.0 : share * (1.0 / 3.001396);
}

// --- Free ways ---

const int STEPS_CAP = 64, WALL_CAP = 3; // voxels: that are walked; of wall that a probe leaves

bool is_free(uint cascade, ivec3 at) {
    ivec3 dims = ivec3(gi.dims.xyz), held = clamp(at, ivec3(0), dims - 1);
    return at != held || !gi_occupied(gi_bit(uvec3(held) + uvec3(0u, 0u, gi.dims.z * cascade)));
}
ivec3 along(uint d) {
    ivec3 stride = ivec3(0);
    stride[d >> 1] = (d & 1u) == 0u ? 1 : -1;
    return stride;
}

// Voxels from a place in a free voxel to the next occupied one towards d; 1e9: none so near.
float free_way(uint cascade, vec3 place, uint d, int steps) {
    ivec3 stride = along(d), at = ivec3(floor(place));
    int i = 1;
    for (; i < steps && is_free(cascade, at + stride * i); i++) {}
    float within = fract(place[d >> 1]);
    return i < steps ? float(i) - ((d & 1u) == 0u ? within : 1.0 - within) : 1e9;
}

// A probe that stands in a wall steps out of it on the nearest side, of equal ones to where most room
// is. Returns the direction, 6: it is free, 7: too deep; place becomes the middle of the voxel there.
uint leave_wall(uint cascade, inout vec3 place, int steps) {
    ivec3 at = ivec3(floor(place)), found = at;
    int most = 0;
    uint way = is_free(cascade, at) ? 6u : 7u;
    for (uint d = 0u; d < (way == 6u ? 0u : 6u); d++) {
        ivec3 stride = along(d);
        int wall = 1;
        for (; wall < WALL_CAP && !is_free(cascade, at + stride * wall); wall++) {}
        int room = wall < WALL_CAP ? 0 : steps;
        for (; room < steps && is_free(cascade, at + stride * (wall + room)); room++) {}
        room = wall < WALL_CAP ? room + (WALL_CAP - wall) * (STEPS_CAP + 1) : 0;
        found = room > most ? at + stride * wall : found;
        way = room > most ? d : way;
        most = max(most, room);
    }
    vec3 middle = vec3(found) + 0.5;
    for (uint axis = 0u; axis < 3u; axis++)
        place[axis] = way >> 1 == axis ? middle[axis] : place[axis];
    return way;
}

void main() {
    if (gl_GlobalInvocationID.x >= count) return;
    uint index = first + stride * gl_GlobalInvocationID.x;
    uvec3 size = gi.probes.xyz;
    uvec3 at = uvec3(index % size.x, index / size.x % size.y, index / (size.x * size.y));
    vec3 world = gi.probe_origin.xyz + vec3(at) * gi.probe_origin.w;
    // As far as a code reaches.
    uint cascade = min(gi_cascade(world, 0.0), GI_CASCADES - 1u);
    float across = gi_flow.probe_origin.w / gi_flow.origin[cascade].w; // voxels to the next probe
    int steps = min(int(GI_PROBE_REACH * across) + 2, STEPS_CAP);
    vec3 place = gi_to_voxels(world, cascade);
    uint out_of = leave_wall(cascade, place, steps);
    world = gi_to_world(place, cascade);

    vec3 light[6] = vec3[](vec3(0), vec3(0), vec3(0), vec3(0), vec3(0), vec3(0));
    float open[6] = float[](0, 0, 0, 0, 0, 0);
    float reach = gi_reach(), tan_half = gi_flow.cone.x;
    for (uint i = 0u;;) { // ends with its test, which saves a round (gi_cones.glsl)
        vec3 direction = CORNERS[i];
        GiCone cone = gi_cone(world, direction, tan_half, PROBE_START, reach);
        vec3 arrives = cone.light.rgb + GI_SKY(frame, direction) * max(1.0 - cone.light.a, 0.0);
        for (uint d = 0u; d < 6u; d++) {
            float share = cosine_share((d & 1u) == 0u ? direction[d >> 1] : -direction[d >> 1]);
            light[d] += arrives * share;
            open[d] += (1.0 - cone.occlusion) * share;
        }
        if (++i >= 12u) break;
    }

    for (uint axis = 0u; axis < 3u; axis++) {
        // Each way as the probe's own place has it: what lies behind one that moved is wall.
        float ways[2];
        for (uint side = 0u; side < 2u; side++) {
            uint d = axis * 2u + side;
            float way = max(free_way(cascade, place, d, steps) / across, GI_PROBE_STEP);
            ways[side] = out_of == 7u || out_of == (d ^ 1u) ? 0.0 : way;
        }
        for (uint side = 0u; side < 2u; side++) {
            uint d = axis * 2u + side;
            imageStore(probes, ivec3(uvec3(at.x + d * size.x, at.yz)),
                       vec4(min(light[d], vec3(65000.0)),
                            gi_probe_code(ways[0], ways[1], open[d])));
        }
    }
}
