#version 460
// post_fog.frag: fog over the radiance, by alpha blending: the share of light that the way from the
// eye to the surface takes away is replaced by the fog's colour.
//
// Density at height y: full up to `height`, above it falling as exp(-falloff * (y - height)). The
// optical depth along the ray is the density's antiderivative at both ends over their difference in
// height, times the length: exact, without steps. SPEC_POST 1: has a falloff.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D depth_texture;
layout(push_constant) uniform Push {
    float r, g, b, density, start, height, falloff;
} fog;
layout(location = 0) out vec4 out_color;

const float LOG2_E = 1.44269504;
const float FAR_M = 2000.0; // how far the sky is for fog that fills the world

// Antiderivative of the density over the height above `height`.
float column(float y) {
    return y < 0.0 ? y : (1.0 - exp2(-LOG2_E * fog.falloff * y)) / fog.falloff;
}

void main() {
    float depth = texelFetch(depth_texture, ivec2(gl_FragCoord.xy), 0).r;
    vec2 ndc = vec2(gl_FragCoord.x * frame.viewport.z * 2.0 - 1.0,
                    1.0 - gl_FragCoord.y * frame.viewport.w * 2.0);
    vec3 ray = frame.ray_right.xyz * ndc.x + frame.ray_up.xyz * ndc.y + frame.ray_forward.xyz;
    float stretch = length(ray);
    float far = min(depth > 0.0 ? stretch * frame.camera.w / depth : FAR_M, FAR_M);
    float way = max(far - fog.start, 0.0), share = 1.0;
    if (POST != 0u) {
        float up = ray.y / stretch, y0 = frame.camera.y + up * min(fog.start, far) - fog.height;
        float rise = up * way, y1 = y0 + rise;
        // Nearly level rays: the difference of the two antiderivatives has no digits left.
        float level = y0 < 0.0 ? 1.0 : exp2(-LOG2_E * fog.falloff * y0);
        share = abs(rise) > 1e-3 ? (column(y1) - column(y0)) / rise : level;
    }
    float opacity = 1.0 - exp2(-LOG2_E * fog.density * way * share);
    out_color = vec4(fog.r, fog.g, fog.b, clamp(opacity, 0.0, 1.0));
}
