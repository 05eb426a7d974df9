// gbuffer.glsl: reading layout `lean` back.
#ifndef GBUFFER_GLSL
#define GBUFFER_GLSL
#include "light.glsl"

layout(set = 0, binding = BINDING_GBUFFER_0) uniform sampler2D gbuffer_0;
layout(set = 0, binding = BINDING_GBUFFER_1) uniform sampler2D gbuffer_1;
layout(set = 0, binding = BINDING_DEPTH) uniform sampler2D gbuffer_depth;

struct GbufferPixel {
    vec3 albedo, normal;
    uint material;
    float depth; // 0 = background
};

GbufferPixel gbuffer_read(ivec2 pixel) {
    GbufferPixel g;
    vec4 albedo = texelFetch(gbuffer_0, pixel, 0);
    g.albedo = albedo.rgb;
    g.material = uint(albedo.a * 255.0 + 0.5);
    g.normal = oct_decode(texelFetch(gbuffer_1, pixel, 0).xy * 2.0 - 1.0);
    g.depth = texelFetch(gbuffer_depth, pixel, 0).x;
    return g;
}
#endif
