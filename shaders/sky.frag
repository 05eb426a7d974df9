#version 460
// sky.frag: gradient and stars where nothing was drawn (depth test, see fullscreen.vert).
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(location = 0) out vec4 out_color;

// Integer hash (PCG, Jarzynski and Olano 2020): the same bits on every device.
uvec3 hash3(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return v;
}

// One star in every third cell of a cube's faces, soft over about a pixel so it does not blink.
float stars(vec3 d) {
    vec3 a = abs(d);
    float m = max(a.x, max(a.y, a.z));
    vec2 uv = a.x == m ? d.yz / a.x : a.y == m ? d.xz / a.y : d.xy / a.z;
    uint face = a.x == m ? (d.x > 0.0 ? 0u : 1u) : a.y == m ? (d.y > 0.0 ? 2u : 3u)
                                                            : (d.z > 0.0 ? 4u : 5u);
    vec2 grid = uv * 48.0 + 48.0;
    uvec3 h = hash3(uvec3(uvec2(grid), face));
    vec2 center = vec2(h.xy & 1023u) / 1023.0 * 0.7 + 0.15;
    // Many faint ones, few bright ones.
    float brightness = max(float(h.z & 1023u) / 1023.0 * 3.0 - 2.0, 0.0);
    brightness *= brightness * brightness;
    vec2 offset = fract(grid) - center;
    float radius = 0.03 + 48.0 * frame.viewport.w;
    return brightness * max(1.0 - dot(offset, offset) / (radius * radius), 0.0);
}

void main() {
    vec2 ndc = vec2(gl_FragCoord.x * frame.viewport.z * 2.0 - 1.0,
                    1.0 - gl_FragCoord.y * frame.viewport.w * 2.0);
    vec3 d = normalize(frame.ray_right.xyz * ndc.x + frame.ray_up.xyz * ndc.y +
                       frame.ray_forward.xyz);
    float up = clamp(d.y, 0.0, 1.0);
    vec3 color = mix(frame.sky_horizon.rgb, frame.sky_zenith.rgb, sqrt(up));
    color += vec3(0.9, 0.95, 1.0) * (stars(d) * frame.sky_zenith.w * smoothstep(0.0, 0.3, up));
    out_color = vec4(color, 1.0);
}
