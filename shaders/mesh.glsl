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

invariant gl_Position;

vec3 mesh_world_position() {
    vec4 p = vec4(in_position, 1.0);
    InstanceRecord instance = instances[gl_InstanceIndex];
    return vec3(dot(instance.world[0], p), dot(instance.world[1], p), dot(instance.world[2], p));
}

// Normals go by the cofactor matrix, so non-uniform scale keeps them perpendicular.
vec3 mesh_world_normal() {
    InstanceRecord instance = instances[gl_InstanceIndex];
    vec3 r0 = instance.world[0].xyz, r1 = instance.world[1].xyz, r2 = instance.world[2].xyz;
    vec3 n = oct_decode(unpackSnorm2x16(in_normal));
    return normalize(vec3(dot(cross(r1, r2), n), dot(cross(r2, r0), n), dot(cross(r0, r1), n)));
}

// xyz tangent, w the sign of the bitangent. Packing: see MeshVertex.
vec4 mesh_world_tangent() {
    InstanceRecord instance = instances[gl_InstanceIndex];
    int bits = int(in_tangent);
    vec2 e = vec2(float((bits << 16) >> 16) / 32767.0, float((bits << 1) >> 17) / 16383.0);
    vec3 t = oct_decode(clamp(e, vec2(-1.0), vec2(1.0)));
    t = vec3(dot(instance.world[0].xyz, t), dot(instance.world[1].xyz, t),
             dot(instance.world[2].xyz, t));
    float len2 = dot(t, t);
    return vec4(t * inversesqrt(max(len2, 1e-20)), in_tangent >> 31 != 0u ? -1.0 : 1.0);
}
#endif
