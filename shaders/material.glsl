// material.glsl: a fragment's surface from its material's textures and palette row.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL
#include "common.glsl"

layout(set = 1, binding = BINDING_ALBEDO_TEXTURE) uniform sampler2D albedo_texture;
layout(set = 1, binding = BINDING_NORMAL_TEXTURE) uniform sampler2D normal_texture;
layout(set = 1, binding = BINDING_EMISSIVE_TEXTURE) uniform sampler2D emissive_texture;

// Albedo (linear rgb) and alpha; discards holes when the pipeline is for masked materials.
vec4 material_albedo(uint material, vec2 uv, vec4 color) {
    vec4 texel = (TEXTURES & 1u) != 0u ? texture(albedo_texture, uv) : vec4(1.0);
    vec4 factor = palette_albedo(material);
    if (ALPHA_MASK != 0u && texel.a * color.a < factor.w) discard;
    return vec4(texel.rgb * factor.rgb * color.rgb, texel.a * color.a);
}

// The texture's neutral texel is (128, 128, 255): decoded so that it means "straight up" exactly.
vec3 material_normal(vec2 uv, vec3 normal, vec4 tangent) {
    vec3 n = normalize(normal);
    if ((TEXTURES & 2u) == 0u) return gl_FrontFacing ? n : -n;
    vec3 t = tangent.xyz - n * dot(n, tangent.xyz);
    t *= inversesqrt(max(dot(t, t), 1e-12));
    vec3 b = cross(n, t) * tangent.w;
    vec3 s = texture(normal_texture, uv).xyz * (255.0 / 127.0) - (128.0 / 127.0);
    vec3 mapped = t * s.x + b * s.y + n * s.z;
    mapped *= inversesqrt(max(dot(mapped, mapped), 1e-12));
    return gl_FrontFacing ? mapped : -mapped;
}
#endif
