#version 460
// gi_solid.comp: the inside of one closed mesh: a row of voxels' centres along x enters and leaves
// it where it crosses its surface.
// Steps: 0: a bit for each crossing, at the first voxel whose centre lies behind it (a second
// crossing there takes it back). 1: from left to right the bits' parity says what is inside; what
// has no surface in it, static or dynamic, joins the layer and the solid layer. The bits, which lie
// in the accumulators, are zero again.
// Crossings are exact: corners are rounded to 1/256 voxel across the row, an edge is always asked
// about from its lower end, and a row through an edge counts as beside it (towards -y, then +z), the
// same for all triangles. So rows enter a closed mesh as often as they leave it.
#extension GL_GOOGLE_include_directive : require
#include "gi_vox.glsl"
layout(local_size_x = 64) in;

const float SNAP = 256.0;

ivec2 snap(vec3 p) { return ivec2(floor(clamp(p.yz, -16384.0, 16384.0) * SNAP + 0.5)); }

// Is the point left of the edge from a to b? All in y, z.
bool is_left(ivec2 a, ivec2 b, ivec2 p) {
    bool is_swapped = b.x < a.x || (b.x == a.x && b.y < a.y);
    ivec2 low = is_swapped ? b : a, high = is_swapped ? a : b;
    int s_high, s_low, t_high, t_low;
    imulExtended(high.x - low.x, p.y - low.y, s_high, s_low);
    imulExtended(high.y - low.y, p.x - low.x, t_high, t_low);
    bool left = s_high > t_high || (s_high == t_high && uint(s_low) >= uint(t_low));
    return left != is_swapped;
}

void cross_surface() {
    uint triangle = (gl_WorkGroupID.z * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
                    gl_LocalInvocationIndex;
    uint instance = draw.mesh.z;
    if (triangle >= draw.mesh.w) return;
    VoxCorners corners = vox_corners(vox_world(vox_vertex(triangle, 0u), instance),
                                     vox_world(vox_vertex(triangle, 1u), instance),
                                     vox_world(vox_vertex(triangle, 2u), instance));
    vec3 low = min(min(corners.a, corners.b), corners.c);
    vec3 high = max(max(corners.a, corners.b), corners.c);
    ivec2 dims = ivec2(gi_flow.dims.yz);
    ivec2 first = ivec2(clamp(floor(low.yz) - 1.0, vec2(0.0), vec2(dims)));
    ivec2 last = ivec2(clamp(floor(high.yz) + 1.0, vec2(-1.0), vec2(dims - 1)));
    vec3 n = vox_across(corners.c - corners.a, corners.b - corners.a);
    float inverse = abs(n.x) > 1e-18 ? 1.0 / n.x : 0.0;
    ivec2 a = snap(corners.a), b = snap(corners.b), c = snap(corners.c);
    uvec3 size = gi_flow.dims.xyz;
    int rows = last.y - first.y + 1, parts = int(gl_NumWorkGroups.y);
    int stretch = (rows + parts - 1) / parts;
    first.y += int(gl_WorkGroupID.y) * stretch;
    last.y = min(last.y, first.y + stretch - 1);
    for (int z = first.y; z <= last.y; z++) {
        for (int y = first.x; y <= last.x; y++) {
            ivec2 p = ivec2(y, z) * int(SNAP) + int(SNAP) / 2;
            bool left = is_left(a, b, p);
            if (left == is_left(b, c, p) && left == is_left(c, a, p)) {
                vec2 d = vec2(y, z) + 0.5 - corners.a.yz;
                float x = corners.a.x - (n.y * d.x + n.z * d.y) * inverse;
                x = clamp(x, low.x, high.x);
                uint behind = uint(clamp(floor(x + 0.5), 0.0, float(size.x)));
                uint bit = behind + size.x * (uint(y) + size.y * uint(z));
                if (behind < size.x) atomicXor(gi_accumulators[bit >> 5], 1u << (bit & 31u));
            }
        }
    }
}

void fill_row() {
    uvec4 dims = gi_flow.dims;
    uint row_words = max(dims.x >> 5, 1u), cascade_words = (dims.x * dims.y * dims.z) >> 5;
    uint row = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
               gl_LocalInvocationIndex;
    if (row * row_words >= cascade_words) return;
    // Rows shorter than a word lie several in one.
    uint length = min(dims.x, 32u), carry = 0u;
    uint whole = 0xffffffffu >> (32u - length), ones = 0u;
    for (uint i = 0u; i < 32u; i += length) ones |= 1u << i;
    uint layer_words = cascade_words * dims.w, before = draw_cascade() * cascade_words;
    for (uint i = 0u; i < row_words; i++) {
        uint at = row * row_words + i, x = gi_accumulators[at];
        for (uint s = 1u; s < length; s <<= 1) x ^= (x << s) & ((whole & (whole << s)) * ones);
        x ^= carry;
        carry = length == 32u ? 0u - (x >> 31) : 0u;
        uint word = before + at;
        x &= ~gi_masks[word] & ~gi_masks[GI_MASK_DYNAMIC * layer_words + word];
        if (x != 0u) {
            gi_masks[draw_layer() * layer_words + word] |= x;
            gi_masks[GI_MASK_SOLID * layer_words + word] |= x;
        }
        gi_accumulators[at] = 0u;
    }
}

void main() {
    if (GI_STEP == 0u)
        cross_surface();
    else
        fill_row();
}
