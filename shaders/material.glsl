// material.glsl: a fragment's surface from its material's textures and palette row.
#ifndef MATERIAL_GLSL
#define MATERIAL_GLSL
#include "common.glsl"

layout(set = 1, binding = BINDING_ALBEDO_TEXTURE) uniform sampler2D albedo_texture;
layout(set = 1, binding = BINDING_NORMAL_TEXTURE) uniform sampler2D normal_texture;
layout(set = 1, binding = BINDING_EMISSIVE_TEXTURE) uniform sampler2D emissive_texture;

// The albedo texture; discards holes when the pipeline is for masked materials. alpha: the vertex's.
vec4 material_texel(uint material, vec2 uv, float alpha) {
    vec4 texel = (TEXTURES & 1u) != 0u ? texture(albedo_texture, uv) : vec4(1.0);
    if (ALPHA_MASK != 0u && texel.a * alpha < palette_albedo(material).w) discard;
    return texel;
}

// Albedo (linear rgb) and alpha; discards holes likewise.
vec4 material_albedo(uint material, vec2 uv, vec4 color) {
    vec4 texel = material_texel(material, uv, color.a);
    return vec4(texel.rgb * palette_albedo(material).rgb * color.rgb, texel.a * color.a);
}

// Along the surface's normal, of any length. The texture's neutral texel is (128, 128, 255): decoded
// so that it means "straight up" exactly. Tangent, bitangent and normal come out equally long
// (|n| |t|) without a division.
vec3 material_direction(vec2 uv, vec3 normal, vec4 tangent) {
    if ((TEXTURES & 2u) == 0u) return gl_FrontFacing ? normal : -normal;
    float n2 = dot(normal, normal);
    vec3 t = tangent.xyz * n2 - normal * dot(normal, tangent.xyz);
    vec3 b = cross(normal, t) * tangent.w;
    vec3 s = texture(normal_texture, uv).xyz * (255.0 / 127.0) - (128.0 / 127.0);
    vec3 mapped = t * (s.x * sqrt(n2)) + b * s.y + normal * (s.z * sqrt(max(dot(t, t), 1e-12)));
    return gl_FrontFacing ? mapped : -mapped;
}
vec3 material_normal(vec2 uv, vec3 normal, vec4 tangent) {
    vec3 n = material_direction(uv, normal, tangent);
    return n * inversesqrt(max(dot(n, n), 1e-20));
}
#endif
