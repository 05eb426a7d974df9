#version 460
// gi_vox.vert: voxels by rasterising: a triangle, seen along its normal's largest axis, one pixel a
// column of voxels, made larger so that every column that it touches has its pixel's centre inside.
// There is no geometry stage: each of the three vertices fetches the whole triangle.
#extension GL_GOOGLE_include_directive : require
#include "gi_vox.glsl"

layout(location = 0) flat out vec3 out_a;
layout(location = 1) flat out vec3 out_b;
layout(location = 2) flat out vec3 out_c;
layout(location = 3) flat out float out_slack;
layout(location = 4) flat out uint out_instance;
layout(location = 5) flat out uvec3 out_normals;
layout(location = 6) flat out uvec3 out_colors;
layout(location = 7) flat out vec4 out_uv01;
layout(location = 8) flat out vec2 out_uv2;

// Edge of a triangle as a line: dot(line, (p, 1)) >= 0 inside, moved out by half a pixel's diagonal
// as the edge sees it (Hasselgren et al. 2005), and by what the rasteriser rounds positions to.
vec3 moved_line(vec2 from, vec2 to, float side) {
    vec3 line = cross(vec3(from, 1.0), vec3(to, 1.0)) * side;
    line.z += (0.5 + 1.0 / 16.0) * (abs(line.x) + abs(line.y));
    return line;
}

void main() {
    uint triangle = uint(gl_VertexIndex) / 3u, corner = uint(gl_VertexIndex) - triangle * 3u;
    uint instance = uint(gl_InstanceIndex);
    uvec3 vertices = uvec3(vox_vertex(triangle, 0u), vox_vertex(triangle, 1u),
                           vox_vertex(triangle, 2u));
    VoxCorners corners = vox_corners(vox_world(vertices.x, instance),
                                     vox_world(vertices.y, instance),
                                     vox_world(vertices.z, instance));
    VoxTriangle t = vox_triangle(corners);
    out_a = corners.a;
    out_b = corners.b;
    out_c = corners.c;
    out_slack = corners.slack;
    out_instance = instance;
    out_normals = out_colors = uvec3(0u);
    out_uv01 = vec4(0.0);
    out_uv2 = vec2(0.0);
    if (vox_needs_surface()) {
        VoxCodes s = vox_codes(vertices);
        out_normals = s.normals;
        out_colors = s.colors;
        out_uv01 = vec4(s.uv0, s.uv1);
        out_uv2 = s.uv2;
    }
    // From the box's corner, so that the numbers are small where the box is.
    vec2 base = vec2(t.low.xy), size = vec2(t.high.xy - t.low.xy + 1);
    vec2 a = t.a.xy - base, b = t.b.xy - base, c = t.c.xy - base;
    float side = t.n.z < 0.0 ? -1.0 : 1.0;
    vec3 ab = moved_line(a, b, side), bc = moved_line(b, c, side), ca = moved_line(c, a, side);
    // Corner a is where ca and ab meet now.
    vec3 at_a = cross(ca, ab), at_b = cross(ab, bc), at_c = cross(bc, ca);
    // Corners that are too acute, and slivers: a triangle about the whole box instead.
    vec3 lengths = vec3(length(ab.xy), length(bc.xy), length(ca.xy));
    vec3 sines = abs(vec3(at_a.z, at_b.z, at_c.z)) / max(lengths.zxy * lengths, vec3(1e-20));
    bool is_plain = min(min(sines.x, sines.y), sines.z) > 0.02 &&
                    min(min(lengths.x, lengths.y), lengths.z) > 1e-3;
    vec3 own = corner == 0u ? at_a : corner == 1u ? at_b : at_c;
    vec2 around = (corner == 1u ? vec2(2.0, 0.0) : corner == 2u ? vec2(0.0, 2.0) : vec2(0.0)) *
                      (size + 0.5) - 0.25;
    vec2 pixel = base + (is_plain ? own.xy / own.z : around);
    bool is_drawn = !vox_is_empty(t) && vox_is_wanted(t) && !vox_window_is_empty();
    // The viewport is as large as the longest axis; its y points up, rows go down.
    uvec3 dims = gi_flow.dims.xyz;
    float extent = float(max(max(dims.x, dims.y), dims.z));
    vec2 ndc = pixel * (2.0 / extent) - 1.0;
    gl_Position = is_drawn ? vec4(ndc.x, -ndc.y, 0.5, 1.0) : vec4(2.0, 2.0, 0.5, 1.0);
}
