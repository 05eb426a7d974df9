// mesh.glsl: vertex input of every mesh, and the one expression that places it: passes that draw
// the same mesh again at equal depth need the same bits, hence `invariant`.
#ifndef MESH_GLSL
#define MESH_GLSL
#include "common.glsl"

layout(location = 0) in vec3 in_position;
layout(location = 1) in uint in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in uint in_tangent;
layout(location = 4) in vec4 in_color;
// InstanceRecord, one an instance.
layout(location = 5) in vec4 in_world_x;
layout(location = 6) in vec4 in_world_y;
layout(location = 7) in vec4 in_world_z;
layout(location = 8) in uvec4 in_ids;

invariant gl_Position;

vec3 mesh_world_position() {
    vec4 p = vec4(in_position, 1.0);
    return vec3(dot(in_world_x, p), dot(in_world_y, p), dot(in_world_z, p));
}

// Normals go by the cofactor matrix, so non-uniform scale keeps them perpendicular.
vec3 mesh_world_normal() {
    vec3 r0 = in_world_x.xyz, r1 = in_world_y.xyz, r2 = in_world_z.xyz;
    vec3 n = oct_decode(unpackSnorm2x16(in_normal));
    return normalize(vec3(dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)));
}

// xyz tangent, w the sign of the bitangent. Packing: see MeshVertex.
vec4 mesh_world_tangent() {
    int bits = int(in_tangent);
    vec2 e = vec2(float((bits << 16) >> 16) / 32767.0, float((bits << 1) >> 17) / 16383.0);
    vec3 t = oct_decode(clamp(e, vec2(-1.0), vec2(1.0)));
    t = vec3(dot(in_world_x.xyz, t), dot(in_world_y.xyz, t), dot(in_world_z.xyz, t));
    float len2 = dot(t, t);
    return vec4(t * inversesqrt(max(len2, 1e-20)), in_tangent >> 31 != 0u ? -1.0 : 1.0);
}
#endif
