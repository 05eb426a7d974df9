#version 460
// gi_vox.comp: voxels by compute: an invocation walks the columns of a triangle's box along its
// normal's largest axis. Large triangles are split by rows among the groups of y.
// Steps: 0 marks, 1 adds (gi_vox.glsl). Loops end with their test: one at the head runs the body once
// more on the software driver, and most have one round.
#extension GL_GOOGLE_include_directive : require
#include "gi_vox.glsl"
layout(local_size_x = 64) in;

void main() {
    uint at = (gl_WorkGroupID.z * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
              gl_LocalInvocationIndex;
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
    uint rows = uint(t.high.y - t.low.y + 1), parts = gl_NumWorkGroups.y;
    int stretch = int((rows + parts - 1u) / parts);
    int first = t.low.y + int(gl_WorkGroupID.y) * stretch;
    int last = min(t.high.y, first + stretch - 1);
    int y = first;
    if (y <= last) for (;;) {
        int x = t.low.x; // not empty
        for (;;) {
            ivec2 range = vox_column(t, ivec2(x, y));
            int z = range.x;
            if (z <= range.y) for (;;) {
                ivec3 v = ivec3(x, y, z);
                if (vox_touches(t, v)) vox_emit(t, s, v);
                if (++z > range.y) break;
            }
            if (++x > t.high.x) break;
        }
        if (++y > last) break;
    }
}
