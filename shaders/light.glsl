// light.glsl: what one light adds to one surface. All paths use these functions and nothing else,
// so that they agree.
//
// Formulas: attenuation and spot factor as in the lights' specification (window: Puig 2006;
// polynomial: Kubovcik 2014, 3.5; inverse square: KHR_lights_punctual with a windowed range);
// Blinn-Phong normalisation (n + 8) / (8 pi) comes in the material's record; Oren-Nayar in the
// qualitative form (A + B max(0, cos) sin tan) without angles: s / t with s = l.v - n.l n.v,
// t = max(n.l, n.v) for s > 0, else 1.
#ifndef LIGHT_GLSL
#define LIGHT_GLSL
#include "common.glsl"
#include "attenuation.glsl"

layout(std430, set = 0, binding = BINDING_LIGHTS) readonly buffer LightBuffer {
    LightRecord lights[];
};
layout(std430, set = 0, binding = BINDING_SPOTS) readonly buffer SpotBuffer { SpotRecord spots[]; };
layout(std140, set = 0, binding = BINDING_DIRECTIONALS) uniform DirectionalBuffer {
    DirectionalRecord directionals[DIRECTIONALS_CAP];
};
layout(std140, set = 0, binding = BINDING_LIGHT_POSITIONS) uniform LightPositions {
    vec4 light_positions[LIGHT_BLOCK_CAP];
};
layout(std140, set = 0, binding = BINDING_LIGHT_COLORS) uniform LightColors {
    vec4 light_colors[LIGHT_BLOCK_CAP];
};
layout(std140, set = 0, binding = BINDING_SPOT_BLOCK) uniform SpotBlock {
    SpotRecord spot_block[SPOT_BLOCK_CAP];
};
layout(set = 0, binding = BINDING_SHADOW_MAP) uniform sampler2DShadow shadow_map;
layout(set = 0, binding = BINDING_ATTENUATION) uniform sampler2D falloff;

const uint LOBE_PHONG = 1u; // values of Brdf in MaterialRecord.lobes.x

struct Surface {
    vec3 position, normal, view; // world; view points to the eye
    vec3 diffuse;                // albedo / pi
    vec3 specular;
    float power;
    vec4 lobes;                  // MaterialRecord.lobes
    float fresnel;
    float n_dot_v;
};

// specular: rgb, w power; lobes: MaterialRecord.lobes.
Surface surface_from(vec3 position, vec3 normal, vec3 albedo, vec4 specular, vec4 lobes,
                     float fresnel) {
    Surface s;
    s.position = position;
    s.normal = normal;
    s.view = normalize(frame.camera.xyz - position);
    s.diffuse = albedo * (1.0 / PI);
    s.lobes = lobes;
    s.specular = specular.rgb * s.lobes.y;
    s.power = specular.w;
    s.fresnel = fresnel;
    s.n_dot_v = max(dot(normal, s.view), 1e-4);
    return s;
}

Surface surface_make(vec3 position, vec3 normal, vec3 albedo, uint material) {
    return surface_from(position, normal, albedo, palette_specular(material),
                        palette_lobes(material), palette_extra(material).x);
}

// (dot / sqrt(length2))^power, the cosine of a vector that need not be unit. The cheap way takes
// ln c = (c^2 - 1) / (c^2 + 1), the first Pade term: one division and one exp2, where pow() needs a
// square root and a logarithm more. It is off by at most 0.002 for powers from 32 on, 0.008 at 8,
// 0.14 at 2; a lobe that wide is faint.
float specular_power(float cosine, float length2, float power) {
    float c = max(cosine, 0.0);
    if (EXACT_POWER != 0u) return pow(max(c * inversesqrt(length2), 1e-6), power);
    float c2 = c * c;
    return exp2(power * 1.442695 * ((c2 - length2) / (c2 + length2)));
}

// The diffuse lobe alone.
vec3 brdf_diffuse(Surface s, vec3 l, float n_dot_l) {
    if ((BRDF_MASK & BRDF_MASK_OREN_NAYAR) == 0u) return s.diffuse;
    float c = dot(l, s.view) - n_dot_l * s.n_dot_v;
    float t = c > 0.0 ? max(n_dot_l, s.n_dot_v) : 1.0;
    return s.diffuse * (s.lobes.z + s.lobes.w * c / max(t, 1e-4));
}

// Reflected radiance for unit irradiance times n.l, of light from unit direction l. highlight: the
// light's factor on the specular lobe.
vec3 brdf(Surface s, vec3 l, float n_dot_l, float highlight) {
    vec3 h = s.view + l; // half vector, not normalised
    float length2 = max(dot(h, h), 1e-12);
    float cosine = dot(s.normal, h);
    if ((BRDF_MASK & 2u) != 0u) {
        // Phong among them: reflection vector against view instead of the half vector.
        float r_dot_v = 2.0 * n_dot_l * dot(s.normal, s.view) - dot(l, s.view);
        bool phong = uint(s.lobes.x) == LOBE_PHONG;
        cosine = phong ? r_dot_v : cosine;
        length2 = phong ? 1.0 : length2;
    }
    vec3 specular = s.specular;
    if ((BRDF_MASK & BRDF_MASK_FRESNEL) != 0u) {
        // Schlick; lobes.y (normalisation) is in s.specular already.
        float x = 1.0 - clamp(dot(s.view, h) * inversesqrt(dot(h, h)), 0.0, 1.0);
        float x2 = x * x;
        float f = x2 * x2 * x * s.fresnel;
        specular += (vec3(s.lobes.y) - specular) * f;
    }
    vec3 diffuse = brdf_diffuse(s, l, n_dot_l);
    if ((BRDF_MASK & BRDF_MASK_HIGHLIGHTS) == 0u) return diffuse; // no specular lobe in this level
    return diffuse + specular * (highlight * specular_power(cosine, length2, s.power));
}

// Falloff from the table (what it holds: render/lookups.c), filtered linearly; its first and last
// texels' centres are at 0 and 1.
float falloff_texel(float x) {
    return textureLod(falloff, vec2(clamp(x, 0.0, 1.0) * (255.0 / 256.0) + 0.5 / 256.0, 0.5), 0.0).x;
}
float attenuation_lookup(float d2, float inv_d, float x) {
    if (ATTENUATION == 1u) return falloff_texel(x);
    if (ATTENUATION == 2u) {
        float scale = frame.attenuation.w, rest = scale / (d2 * inv_d + scale);
        // The table may end at 0, where only closed windows are.
        return clamp(1.0 - x, 0.0, 1.0) * rest * rest * frame.coding.y /
               max(falloff_texel(1.0 - rest), 1e-7);
    }
    float window = falloff_texel(x);
    return window * window * min(inv_d * inv_d, 1e4);
}

// From the squared distance and its inverse square root.
float attenuation(float d2, float inv_d, float inv_range2) {
    float x = d2 * inv_range2;
    if (ATTENUATION_LOOKUP != 0u) return attenuation_lookup(d2, inv_d, x);
    return attenuation_exact(d2, inv_d, x, frame.attenuation.xyz);
}

// How a light's rays arrive at a surface: unit direction to the light, n.l, and the falloff times
// n.l.
struct Arrival {
    vec3 l;
    float n_dot_l, falloff;
};
Arrival light_arrival(Surface s, vec4 position) {
    Arrival a;
    vec3 to_light = position.xyz - s.position;
    float d2 = max(dot(to_light, to_light), 1e-8);
    float inv_d = inversesqrt(d2);
    a.l = to_light * inv_d;
    a.n_dot_l = max(dot(s.normal, a.l), 0.0);
    a.falloff = attenuation(d2, inv_d, position.w) * a.n_dot_l;
    return a;
}

vec3 light_point(Surface s, vec4 position, vec4 color) {
    Arrival a = light_arrival(s, position);
    return color.rgb * brdf(s, a.l, a.n_dot_l, color.w) * a.falloff;
}
vec3 light_spot(Surface s, vec4 position, vec4 color, vec4 direction, float edge) {
    Arrival a = light_arrival(s, position);
    return color.rgb * brdf(s, a.l, a.n_dot_l, color.w) *
           (a.falloff * spot_cone(a.l, direction, edge));
}

// The same lights without a highlight, for those whose color.w is 0: the same bits, cheaper.
vec3 light_point_diffuse(Surface s, vec4 position, vec4 color) {
    Arrival a = light_arrival(s, position);
    return color.rgb * brdf_diffuse(s, a.l, a.n_dot_l) * a.falloff;
}
vec3 light_spot_diffuse(Surface s, vec4 position, vec4 color, vec4 direction, float edge) {
    Arrival a = light_arrival(s, position);
    return color.rgb * brdf_diffuse(s, a.l, a.n_dot_l) *
           (a.falloff * spot_cone(a.l, direction, edge));
}

// Share of directional 0 that arrives: 4 taps of 2x2 hardware comparison around the point, which
// is moved along the normal against self-shadowing.
float shadow_visibility(vec3 position, vec3 normal) {
    vec4 p = frame.shadow_matrix * vec4(position + normal * frame.shadow.y, 1.0);
    vec2 uv = vec2(p.x * 0.5 + 0.5, 0.5 - p.y * 0.5);
    float reference = p.z + frame.shadow.w;
    vec2 o = vec2(frame.shadow.x * 0.75, 0.0);
    float sum = texture(shadow_map, vec3(uv + vec2(o.x, o.x), reference)) +
                texture(shadow_map, vec3(uv + vec2(-o.x, o.x), reference)) +
                texture(shadow_map, vec3(uv + vec2(o.x, -o.x), reference)) +
                texture(shadow_map, vec3(uv + vec2(-o.x, -o.x), reference));
    bool inside = all(lessThan(abs(p.xy), vec2(1.0))) && p.z > 0.0 && p.z < 1.0;
    return inside ? sum * 0.25 : 1.0;
}

float sun_visibility(Surface s) {
    return SHADOW != 0u ? shadow_visibility(s.position, s.normal) : 1.0;
}

// sun: visibility of directional 0.
vec3 light_directionals(Surface s, float sun) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < DIRECTIONAL_COUNT; i++) {
        vec3 l = directionals[i].direction.xyz;
        float n_dot_l = max(dot(s.normal, l), 0.0);
        float visibility = i == 0u ? sun : 1.0;
        sum += directionals[i].color.rgb * brdf(s, l, n_dot_l, 1.0) * (n_dot_l * visibility);
    }
    return sum;
}

// What does not come from local lights.
vec3 light_base(Surface s, vec3 albedo, uint material) {
    vec4 emissive = palette_emissive(material);
    return emissive.rgb + albedo * frame.ambient.rgb +
           light_directionals(s, sun_visibility(s)) * emissive.w;
}

// A light by index, from wherever this frame's lights fit.
vec4 light_position(uint index) {
    return LIGHT_BLOCKS != 0u ? light_positions[index] : lights[index].position;
}
vec4 light_color(uint index) {
    return LIGHT_BLOCKS != 0u ? light_colors[index] : lights[index].color;
}
vec4 spot_direction(uint spot) {
    return LIGHT_BLOCKS != 0u ? spot_block[spot].direction : spots[spot].direction;
}
float spot_edge(uint spot) {
    return LIGHT_BLOCKS != 0u ? spot_block[spot].edge.x : spots[spot].edge.x;
}
#endif
