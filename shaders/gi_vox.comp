#version 460
// gi_vox.comp: voxels by compute: an invocation walks the columns of a triangle's box along its
// normal's largest axis. Small triangles have one each; large ones (GI_DRAW_WIDE) a group, whose
// invocations share the columns. Either is split by rows among the groups of y.
// Steps: 0 marks, 1 adds (gi_vox.glsl).
//
// An invocation goes on to the next voxel that its triangle touches, and only when all of the
// subgroup have found theirs (or have no more) are these marked or added to, which takes ten times
// as long: the software driver runs for all lanes what one of them needs. Loops end with their
// tests (one at the head runs the body once more there), the same for all lanes.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "gi_vox.glsl"
layout(local_size_x = 64) in;

void main() {
    bool is_wide = (draw.how.x & GI_DRAW_WIDE) != 0u;
    uint group = gl_WorkGroupID.z * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationIndex, at = is_wide ? group : group * 64u + lane;
    uint instance = at / draw.mesh.w, triangle = at - instance * draw.mesh.w;
    if (instance >= draw.how.w || vox_window_is_empty()) return;
    instance += draw.mesh.z;
    uvec3 vertices = uvec3(vox_vertex(triangle, 0u), vox_vertex(triangle, 1u),
                           vox_vertex(triangle, 2u));
    VoxTriangle t = vox_triangle(vox_corners(vox_world(vertices.x, instance),
                                             vox_world(vertices.y, instance),
                                             vox_world(vertices.z, instance)));
    if (vox_is_empty(t) || !vox_is_wanted(t)) return;
    VoxSurface s;
    if (vox_needs_surface()) s = vox_surface(vox_codes(vertices), instance);
    // Neighbours among the lanes take neighbouring columns: blocks of 4 x 2, of these 2 x 4.
    ivec2 own = ivec2(lane & 3u | lane >> 1 & 4u, lane >> 2 & 1u | lane >> 3 & 6u);
    ivec2 side = is_wide ? ivec2(8) : ivec2(1);
    own = is_wide ? own : ivec2(0);
    int first_x = t.low.x + own.x;
    ivec2 column = ivec2(first_x, t.low.y + own.y + side.y * int(gl_WorkGroupID.y));
    ivec2 stride = ivec2(side.x, side.y * int(gl_NumWorkGroups.y));
    bool has_more = all(lessThanEqual(column, t.high.xy));
    ivec2 range = vox_column(t, column);
    for (;;) {
        bool seeks = has_more, found = false;
        for (;;) {
            bool has_candidate = range.x <= range.y;
            found = found || (seeks && has_candidate && vox_touches(t, ivec3(column, range.x)));
            seeks = seeks && !found;
            range.x += seeks ? 1 : 0;
            // The next column.
            bool moves = seeks && range.x > range.y;
            bool wraps = column.x + stride.x > t.high.x;
            ivec2 next = wraps ? ivec2(first_x, column.y + stride.y)
                               : ivec2(column.x + stride.x, column.y);
            column = moves ? next : column;
            has_more = has_more && column.y <= t.high.y;
            seeks = seeks && has_more;
            ivec2 opened = vox_column(t, column);
            range = moves ? opened : range;
            if (!subgroupAny(seeks)) break;
        }
        if (found) vox_emit(t, s, ivec3(column, range.x));
        range.x += found ? 1 : 0; // may end the column: the next round sees
        if (!subgroupAny(has_more)) break;
    }
}
