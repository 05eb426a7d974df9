#version 460
// debug.frag: what lies in the G-buffer and the tile lists, as a picture.
#extension GL_GOOGLE_include_directive : require
#include "gbuffer.glsl"

layout(std430, set = 0, binding = BINDING_CELLS) readonly buffer CellBuffer { CellRecord cells[]; };
layout(location = 0) out vec4 out_color;

// Blue, cyan, green, yellow, red, white for 0..1.
vec3 heat(float x) {
    return clamp(vec3(3.0 * x - 1.2, 2.2 - abs(3.2 * x - 1.6), 1.4 - 4.0 * abs(x - 0.2)) +
                     vec3(max(x - 0.85, 0.0) * 6.0),
                 0.0, 1.0);
}

void main() {
    GbufferPixel g = gbuffer_read(ivec2(gl_FragCoord.xy));
    vec3 p = position_from_depth(gl_FragCoord.xy, g.depth);
    vec3 color = vec3(0.0);
    if (DEBUG_VIEW == 1u) color = srgb_encode(g.albedo);
    if (DEBUG_VIEW == 2u) color = g.normal * 0.5 + 0.5;
    if (DEBUG_VIEW == 3u) color = vec3(1.0 / (1.0 + 0.15 * frame.camera.w / max(g.depth, 1e-9)));
    if (DEBUG_VIEW == 4u) {
        uint h = (g.material + 1u) * 2654435761u;
        color = vec3(uvec3(h >> 8u, h >> 16u, h >> 24u) & 255u) / 255.0;
    }
    if (DEBUG_VIEW == 5u) color = fract(p * 0.25);
    if (DEBUG_VIEW == 6u) {
        vec3 e = materials[g.material].emissive.rgb + materials[g.material].extra.yzw;
        color = srgb_encode(e / (1.0 + e));
    }
    if (g.depth <= 0.0) color = vec3(0.0);
    if (DEBUG_VIEW == 14u) {
        uvec2 tile = uvec2(gl_FragCoord.xy) >> TILE_SHIFT;
        uvec4 list = cells[tile.y * frame.grid.x + tile.x].list;
        color = list.y + list.z == 0u ? vec3(0.0) : heat(log2(float(list.y + list.z)) / 8.0);
        float shade = 0.35 + 0.65 * dot(g.albedo, vec3(0.3, 0.6, 0.1));
        color *= g.depth > 0.0 ? shade : 0.35;
        uvec2 inside = uvec2(gl_FragCoord.xy) & ((1u << TILE_SHIFT) - 1u);
        if (inside.x == 0u || inside.y == 0u) color *= 0.75;
    }
    out_color = vec4(color, 1.0);
}
