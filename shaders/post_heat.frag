#version 460
// post_heat.frag: hot air: the picture behind a sphere shimmers in waves that rise.
//
// Reads a copy of the picture (valid within the pass's scissor, which holds all of the sphere and
// the widest shift) and the depth buffer. A pixel is moved by as much hot air as lies between the
// eye and its surface; it never takes the colour of a surface that is before the air.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D depth_texture;
layout(set = 0, binding = BINDING_HDR_OTHER) uniform sampler2D copy;
layout(push_constant) uniform Push {
    float x, y, z, reach, shift_px, waves, speed;
} heat;
layout(location = 0) out vec4 out_color;

const float TWO_PI = 6.28318531;

// Distance along the pixel's ray (in units of the ray's forward component) by depth.
float distance_of(float depth) { return frame.camera.w / max(depth, 1e-9); }

void main() {
    vec2 ndc = vec2(gl_FragCoord.x * frame.viewport.z * 2.0 - 1.0,
                    1.0 - gl_FragCoord.y * frame.viewport.w * 2.0);
    vec3 ray = frame.ray_right.xyz * ndc.x + frame.ray_up.xyz * ndc.y + frame.ray_forward.xyz;
    vec3 to_center = vec3(heat.x, heat.y, heat.z) - frame.camera.xyz;
    // The ray's part within the sphere: middle -+ half_chord, in lengths of `ray`.
    float square = dot(ray, ray), middle = dot(to_center, ray) / square;
    vec3 off = ray * middle - to_center;
    float inside = 1.0 - dot(off, off) / (heat.reach * heat.reach); // 1 centre, 0 rim
    float half_chord = heat.reach * sqrt(max(inside, 0.0) / square);
    float enter = max(middle - half_chord, 0.0), leave = middle + half_chord;

    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float surface = distance_of(texelFetch(depth_texture, pixel, 0).r);
    float before = clamp((min(surface, leave) - enter) / max(leave - enter, 1e-6), 0.0, 1.0);
    float strength = max(inside, 0.0) * max(inside, 0.0) * before * heat.shift_px;

    // Two waves that rise at different speeds; the phases are wrapped before sin for its digits.
    vec3 p = frame.camera.xyz + ray * middle;
    float time = frame.sky_horizon.w * heat.speed;
    float a = fract(p.y * heat.waves + dot(p.xz, vec2(0.7, 0.4)) * heat.waves - time);
    float b = fract(p.y * heat.waves * 1.7 - dot(p.xz, vec2(0.3, 0.9)) * heat.waves - time * 1.3);
    vec2 offset = strength * vec2(0.6 * sin(TWO_PI * a) + 0.4 * sin(TWO_PI * b),
                                  0.4 * sin(TWO_PI * (b + 0.25)));

    vec2 uv = (gl_FragCoord.xy + offset) * frame.viewport.zw;
    vec4 depths = textureGather(depth_texture, uv);
    float nearest = distance_of(max(max(depths.x, depths.y), max(depths.z, depths.w)));
    bool moved = strength > 0.0 && nearest >= enter && dot(offset, offset) > 1e-6;
    vec3 own = texelFetch(copy, pixel, 0).rgb, other = texture(copy, uv).rgb;
    out_color = vec4(moved ? other : own, 1.0);
}
