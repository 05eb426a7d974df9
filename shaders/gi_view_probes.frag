#version 460
// gi_view_probes.frag: each probe as a ball that is lit by what the probe says, before the dimmed
// picture. A ball fits into the cell of its probe, so the pixel's ray visits cells and looks for one.
#extension GL_GOOGLE_include_directive : require
#define GI_SCREEN
#include "gbuffer.glsl"
#include "gi.glsl"
#include "gi_probe_code.glsl"
#include "gi_view_ray.glsl"

layout(set = 2, binding = BINDING_GI_PROBES) uniform sampler3D gi_probes;

layout(location = 0) out vec4 out_color;

const float RADIUS = 0.12; // spacings

// What arrives at a surface at the probe that faces n.
vec3 probe_light(ivec3 probe, vec3 n) {
    ivec3 x = ivec3(n.x < 0.0 ? 1 : 0, n.y < 0.0 ? 3 : 2, n.z < 0.0 ? 5 : 4) * int(gi.probes.x);
    vec3 light = texelFetch(gi_probes, ivec3(probe.x + x.x, probe.yz), 0).rgb * n.x * n.x +
                 texelFetch(gi_probes, ivec3(probe.x + x.y, probe.yz), 0).rgb * n.y * n.y +
                 texelFetch(gi_probes, ivec3(probe.x + x.z, probe.yz), 0).rgb * n.z * n.z;
    float code = texelFetch(gi_probes, ivec3(probe.x + x.x, probe.yz), 0).a;
    bool is_valid = gi_probe_decode(code).up > 0.0;
    // In a wall: nobody asks it.
    return is_valid ? view_radiance(light) : vec3(0.45, 0.05, 0.05) * (0.6 + 0.4 * n.y);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    vec3 ray = view_ray(gl_FragCoord.xy), eye = flow.camera.xyz;
    float shade = dot(g.albedo, vec3(0.3, 0.6, 0.1)) * (0.6 + 0.4 * abs(g.normal.y));
    vec3 color = g.depth > 0.0 ? vec3(0.05 + 0.35 * shade) : vec3(0.02, 0.02, 0.05);
    float surface = g.depth > 0.0 ? distance(g.position, eye) : 1e9;
    // In spacings from half a cell before the first probe.
    float rate = 1.0 / gi_flow.probe_origin.w;
    vec3 from = (eye - gi_flow.probe_origin.xyz) * rate + 0.5, last = vec3(gi_flow.probes.xyz) - 1.0;
    uint axis;
    vec2 range = view_box(from, ray, vec3(0.0), last + 1.0, axis);
    range.y = min(range.y, surface * rate);
    float t = range.x + 1e-4;
    bool hit = false;
    vec3 normal = vec3(0.0), cell = vec3(0.0);
    for (uint i = 0u; i < VIEW_STEPS && t < range.y && !hit; i++) {
        cell = clamp(floor(from + ray * t), vec3(0.0), last);
        vec3 to = from - (cell + 0.5);
        float b = dot(to, ray), root = b * b - dot(to, to) + RADIUS * RADIUS;
        float near = -b - sqrt(max(root, 0.0));
        hit = root > 0.0 && near > 0.0 && near < range.y;
        normal = normalize(to + ray * near);
        vec3 border = cell + mix(vec3(0.0), vec3(1.0), greaterThan(ray, vec3(0.0)));
        vec3 way = (border - from) / view_safe(ray);
        t = max(min(way.x, min(way.y, way.z)), t) + 1e-3;
    }
    out_color = vec4(hit ? probe_light(ivec3(cell), normal) : color, 1.0);
}
