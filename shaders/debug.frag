#version 460
// debug.frag: what lies in the G-buffer and the tile lists, as a picture.
#extension GL_GOOGLE_include_directive : require
#include "subgroups.glsl"
#include "gbuffer.glsl"
#include "cells.glsl"

layout(location = 0) out vec4 out_color;

vec3 specular_of(GbufferPixel g) {
    return LAYOUT < GBUFFER_LAYOUT_HALF5 ? palette_specular(g.material).rgb : g.specular.rgb;
}
float power_of(GbufferPixel g) {
    return LAYOUT < GBUFFER_LAYOUT_HALF5 ? palette_specular(g.material).w : g.specular.w;
}
// What a pixel shines with by itself: the material's emission, or what the layout has summed up.
vec3 emission_of(GbufferPixel g) {
    return LAYOUT < GBUFFER_LAYOUT_HALF5
               ? palette_emissive(g.material).rgb + palette_extra(g.material).yzw
               : g.accumulated;
}
// Something that differs between materials: the index, or the bits of the attributes.
uint material_key(GbufferPixel g) {
    if (LAYOUT <= GBUFFER_LAYOUT_HALF5) return g.material;
    return floatBitsToUint(g.specular.w) ^ (floatBitsToUint(g.specular.x) * 747796405u) ^
           (floatBitsToUint(g.oren_nayar.x) >> 5u) ^ (floatBitsToUint(g.receives) >> 7u);
}

// One target as it is, made visible: whole colours as they are, signed numbers around grey, metres
// in stripes, light by Reinhard.
vec3 target_color(vec3 t) { return srgb_encode(t); }
vec3 target_signed(vec3 t) { return t * 0.5 + 0.5; }
vec3 target_metres(vec3 t) { return fract(t * 0.25 + 0.01); } // floors at 0 m do not flicker
vec3 target_light(vec3 t) { return srgb_encode(t / (1.0 + t)); }
vec3 target_power(float t) { return vec3(log2(max(t, 1.0)) / 11.0); }

vec3 target_visible(uint index, ivec2 pixel) {
    vec4 t = index == 0u   ? texelFetch(gbuffer_0, pixel, 0)
             : index == 1u ? texelFetch(gbuffer_1, pixel, 0)
             : index == 2u ? texelFetch(gbuffer_2, pixel, 0)
             : index == 3u ? texelFetch(gbuffer_3, pixel, 0)
                           : texelFetch(gbuffer_4, pixel, 0);
    if (LAYOUT == GBUFFER_LAYOUT_LEAN && index == 0u) return target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_WIDE)
        return index == 0u   ? target_metres(t.xyz)
               : index == 1u ? target_signed(t.xyz)
                             : target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_PACKED && index == 1u) return target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_PACKED24 && index == 2u) return target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_HALF5)
        return index == 0u   ? target_metres(t.xyz)
               : index == 1u ? target_signed(t.xyz)
               : index == 4u ? target_light(t.rgb)
                             : target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_KILLZONE2 && index == 1u) return target_signed(vec3(t.xy, 0.0));
    if (LAYOUT == GBUFFER_LAYOUT_KILLZONE2 && index == 3u) return target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_STARCRAFT2)
        return index == 0u   ? target_light(t.rgb)
               : index == 1u ? target_signed(t.xyz)
                             : target_color(t.rgb);
    if (LAYOUT == GBUFFER_LAYOUT_IL)
        return index == 0u   ? target_color(t.rgb)
               : index == 1u ? vec3(target_signed(vec3(t.xy, 0.0)).xy, target_power(t.z).x)
               : index == 2u ? vec3(t.x / 100.0, fract(t.x), fract(t.y * 0.25))
                             : target_light(t.rgb);
    return t.rgb; // bytes
}

vec3 hashed(uint key) {
    uint h = (key + 1u) * 2654435761u;
    h = (h ^ (h >> 15u)) * 2246822519u;
    return vec3(uvec3(h >> 8u, h >> 16u, h >> 24u) & 255u) / 255.0;
}

// Lights of the pixel's tile or cluster, as it is shaded.
vec3 view_cell_lights(uint cell) {
    uvec4 list = cell_list(cell);
    return list.y + list.z == 0u ? vec3(0.0) : heat_map(log2(float(list.y + list.z)) / 8.0);
}
// A tile's nearest depth upper left of the diagonal, its farthest lower right, and along the lower
// rim which of the 32 slices between them are occupied.
vec3 view_tile_depth(uvec2 pixel) {
    uvec2 tile = pixel >> TILE_SHIFT, inside = pixel & ((1u << TILE_SHIFT) - 1u);
    TileDepthRecord seen = tile_depths[tile.y * frame.grid.x + tile.x];
    if (seen.range.x > seen.range.y) return vec3(0.0, 0.0, 0.15); // background only
    uint side = 1u << TILE_SHIFT;
    if (side >= 16u && inside.y + 2u >= side)
        return (seen.mask.x & 1u << (inside.x * 32u >> TILE_SHIFT)) != 0u ? vec3(1.0, 0.8, 0.2)
                                                                         : vec3(0.1);
    float depth = inside.x + inside.y < side ? seen.range.x : seen.range.y;
    return vec3(1.0 / (1.0 + 0.15 * depth));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    vec3 color = vec3(0.0);
    if (DEBUG_VIEW == DEBUG_ALBEDO) color = srgb_encode(g.albedo);
    if (DEBUG_VIEW == DEBUG_NORMAL) color = g.normal * 0.5 + 0.5;
    if (DEBUG_VIEW == DEBUG_DEPTH)
        color = vec3(
            1.0 / (1.0 + 0.15 * dot(g.position - frame.camera.xyz, frame.ray_forward.xyz)));
    if (DEBUG_VIEW == DEBUG_MATERIAL) {
        uint h = (material_key(g) + 1u) * 2654435761u;
        color = vec3(uvec3(h >> 8u, h >> 16u, h >> 24u) & 255u) / 255.0;
    }
    if (DEBUG_VIEW == DEBUG_POSITION) color = target_metres(g.position);
    if (DEBUG_VIEW == DEBUG_EMISSIVE) {
        vec3 e = emission_of(g);
        color = srgb_encode(e / (1.0 + e));
    }
    // Highlights: colour, and power as a grey added to it.
    if (DEBUG_VIEW == DEBUG_SPECULAR)
        color = srgb_encode(clamp(specular_of(g), 0.0, 1.0)) * 0.75 + target_power(power_of(g)) * 0.25;
    if (DEBUG_VIEW == DEBUG_MOTION) { // grey = none; roots, so that slow motion shows
        vec2 m = LAYOUT == GBUFFER_LAYOUT_KILLZONE2 ? g.motion : camera_motion(g.position);
        color = vec3(sign(m) * sqrt(min(abs(m), vec2(1.0))) * 0.5 + 0.5, 0.5);
    }
    if (DEBUG_VIEW >= DEBUG_GBUFFER_0 && DEBUG_VIEW < DEBUG_GBUFFER_0 + 5)
        color = target_visible(DEBUG_VIEW - DEBUG_GBUFFER_0, pixel);
    if (g.depth <= 0.0) color = vec3(0.0);
    if (DEBUG_VIEW == DEBUG_TILE_DEPTH) color = view_tile_depth(uvec2(pixel));
    if (DEBUG_VIEW == DEBUG_CELL_LIGHTS || DEBUG_VIEW == DEBUG_CLUSTERS) {
        uint cell = cell_of(uvec2(pixel), frame.camera.w / max(g.depth, 1e-9));
        color = DEBUG_VIEW == DEBUG_CLUSTERS ? hashed(cell) : view_cell_lights(cell);
        float shade = 0.35 + 0.65 * dot(g.albedo, vec3(0.3, 0.6, 0.1));
        color *= g.depth > 0.0 ? shade : 0.35;
        uvec2 inside = uvec2(gl_FragCoord.xy) & ((1u << TILE_SHIFT) - 1u);
        if (inside.x == 0u || inside.y == 0u) color *= 0.75;
    }
    out_color = vec4(color, 1.0);
}
