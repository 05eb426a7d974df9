#version 460
// gi_vox.frag: voxels by rasterising: a pixel is a column of voxels; those that the triangle touches
// are marked (step 0) or added to (step 1). Writes no picture.
#extension GL_GOOGLE_include_directive : require
#include "gi_vox.glsl"

layout(location = 0) flat in vec3 in_a;
layout(location = 1) flat in vec3 in_b;
layout(location = 2) flat in vec3 in_c;
layout(location = 3) flat in float in_slack;
layout(location = 4) flat in uint in_instance;
layout(location = 5) flat in uvec3 in_normals;
layout(location = 6) flat in uvec3 in_colors;
layout(location = 7) flat in vec4 in_uv01;
layout(location = 8) flat in vec2 in_uv2;

void main() {
    VoxTriangle t = vox_triangle(VoxCorners(in_a, in_b, in_c, in_slack));
    VoxSurface s;
    if (vox_needs_surface())
        s = vox_surface(VoxCodes(in_normals, in_colors, in_uv01.xy, in_uv01.zw, in_uv2),
                        in_instance);
    ivec2 column = ivec2(gl_FragCoord.xy);
    bool is_inside = all(greaterThanEqual(column, t.low.xy)) &&
                     all(lessThanEqual(column, t.high.xy));
    ivec2 range = vox_column(t, column);
    int last = is_inside ? range.y : range.x - 1;
    int z = range.x;
    if (z <= last) for (;;) { // tested at the end: see gi_vox.comp
        ivec3 v = ivec3(column, z);
        if (vox_touches(t, v)) vox_emit(t, s, v);
        if (++z > last) break;
    }
}
