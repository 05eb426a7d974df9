#version 460
// volume.vert: the volume of a light: a sphere, or for spots (SPOTS) a cone with a cap, drawn as an
// instance with the light itself as attributes. Meshes: render/volumes.c.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(location = 0) in vec4 in_position;
layout(location = 1) in vec4 in_light_color;
layout(location = 2) in vec4 in_direction;
layout(location = 3) in vec4 in_edge;
layout(location = 4) in vec4 in_corner;
layout(location = 0) flat out vec4 out_position;
layout(location = 1) flat out vec4 out_light_color;
layout(location = 2) flat out vec4 out_direction;
layout(location = 3) flat out vec4 out_edge;

// A corner of a spot's volume, in units of the range along (x, y, axis). in_corner.z: 0 tip, 1 rim
// of the cap, 2 ring where the cap's tangents at rim and pole meet, 3 pole. A wider cone than a
// half space takes the cylinder around the whole ball.
vec3 cone_corner(float cos_half) {
    float ring = in_corner.z;
    if (cos_half <= 0.0)
        return vec3(in_corner.xy, ring < 1.5 ? -1.0 : 1.0);
    float sin_half = sqrt(max(1.0 - cos_half * cos_half, 0.0));
    float radius = ring < 1.5 ? sin_half : sin_half / (1.0 + cos_half); // tan(half / 2)
    float along = ring < 0.5 ? 0.0 : ring < 1.5 ? cos_half : 1.0;
    return vec3(in_corner.xy * radius, along);
}

void main() {
    float range = inversesqrt(max(in_position.w, 1e-12));
    vec3 corner = in_corner.xyz;
    if (SPOTS != 0u) {
        // A basis around the axis without a special case but one sign (Duff et al. 2017).
        vec3 z = in_direction.xyz;
        float s = z.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + z.z), b = z.x * z.y * a;
        vec3 x = vec3(1.0 + s * z.x * z.x * a, s * b, -s * z.x);
        vec3 y = vec3(b, s + z.y * z.y * a, -z.y);
        // A little wider and longer: the light's own edge is rounded otherwise.
        vec3 c = cone_corner(in_direction.w - 1e-3) * 1.002;
        corner = x * c.x + y * c.y + z * c.z;
    }
    gl_Position = frame.view_projection * vec4(in_position.xyz + corner * range, 1.0);
    out_position = in_position;
    out_light_color = in_light_color;
    out_direction = in_direction;
    out_edge = in_edge;
}
