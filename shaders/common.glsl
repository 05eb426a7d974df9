// common.glsl: the frame's bindings and the small functions that every shader shares.
#ifndef COMMON_GLSL
#define COMMON_GLSL
#include "shared.h"
#include "coding.glsl"

layout(std140, set = 0, binding = BINDING_FRAME) uniform FrameBuffer { FrameRecord frame; };
layout(std140, set = 0, binding = BINDING_MATERIALS) uniform MaterialBuffer {
    MaterialRecord materials[MATERIALS_CAP];
};
// The frame again, for values that steer loops (see shared.h).
layout(std430, set = 0, binding = BINDING_FLOW) readonly buffer FlowBuffer { FrameRecord flow; };

layout(constant_id = SPEC_BRDF_MASK) const uint BRDF_MASK = 8;
layout(constant_id = SPEC_ATTENUATION) const uint ATTENUATION = 0;
layout(constant_id = SPEC_SHADOW) const uint SHADOW = 0;
layout(constant_id = SPEC_ALPHA_MASK) const uint ALPHA_MASK = 0;
layout(constant_id = SPEC_SPOTS) const uint SPOTS = 1;
layout(constant_id = SPEC_DEBUG_VIEW) const uint DEBUG_VIEW = 0;
layout(constant_id = SPEC_SUBGROUP_CULL) const uint SUBGROUP_CULL = 1;
layout(constant_id = SPEC_CELL_LISTS) const uint CELL_LISTS = 0;
layout(constant_id = SPEC_TONEMAP) const uint TONEMAP = 1;
layout(constant_id = SPEC_DIRECTIONALS) const uint DIRECTIONAL_COUNT = 0;
layout(constant_id = SPEC_TEXTURES) const uint TEXTURES = 3;
layout(constant_id = SPEC_EXACT_POWER) const uint EXACT_POWER = 0;
layout(constant_id = SPEC_LAYOUT) const uint LAYOUT = 0;
layout(constant_id = SPEC_TILE_SHIFT) const uint TILE_SHIFT = 4;
layout(constant_id = SPEC_DEVICE_LISTS) const uint DEVICE_LISTS = 0;
layout(constant_id = SPEC_CLUSTERED) const uint CLUSTERED = 0;
layout(constant_id = SPEC_TILE_DEPTH) const uint TILE_DEPTH = 0;
layout(constant_id = SPEC_ATTENUATION_LOOKUP) const uint ATTENUATION_LOOKUP = 0;
layout(constant_id = SPEC_NORMAL_LOOKUP) const uint NORMAL_LOOKUP = 0;
layout(constant_id = SPEC_PALETTE_TEXTURE) const uint PALETTE_TEXTURE = 0;
layout(constant_id = SPEC_LIGHT_BRANCH) const uint LIGHT_BRANCH = 0;
layout(constant_id = SPEC_SAMPLES) const uint SAMPLES = 1;
layout(constant_id = SPEC_CLUSTER_NORMALS) const uint CLUSTER_NORMALS = 0;
layout(constant_id = SPEC_VERTEX_LIGHTING) const uint VERTEX_LIGHTING = 0;
layout(constant_id = SPEC_POST) const uint POST = 0;
layout(constant_id = SPEC_LIGHT_BLOCKS) const uint LIGHT_BLOCKS = 0;
layout(constant_id = SPEC_LIST_KINDS) const uint LIST_KINDS = 3;

const float PI = 3.14159265358979;

// --- The palette: rows of MaterialRecord, from the uniform buffer or from a texture (one row of
// texels a material, the members from left to right) ---
layout(set = 0, binding = BINDING_PALETTE) uniform sampler2D palette;

vec4 palette_texel(uint material, int member) {
    return texelFetch(palette, ivec2(member, int(material)), 0);
}
#ifdef PALETTE_BY_LANES
// Shaders of whole subgroups, all lanes on: each lane keeps a few materials, and one asks for those of
// the others by shuffles. A buffer read by an index of each lane's own is a gather, 25 instructions a
// float on the software driver; a shuffle is one.
layout(constant_id = SPEC_PALETTE_LANES) const uint PALETTE_LANES = 0;
vec4 palette_kept[PALETTE_LANES_CAP * 5];
#define MEMBER(m, name)                                                                            \
    palette_kept[i * 5u + m] = materials[min(i * gl_SubgroupSize + gl_SubgroupInvocationID,        \
                                             uint(MATERIALS_CAP) - 1u)].name
void palette_keep() {
    [[unroll]] for (uint i = 0u; i < PALETTE_LANES; i++) {
        MEMBER(0u, albedo);
        MEMBER(1u, specular);
        MEMBER(2u, emissive);
        MEMBER(3u, lobes);
        MEMBER(4u, extra);
    }
}
#undef MEMBER
vec4 palette_of_lanes(uint material, uint member) {
    uint lane = material % gl_SubgroupSize, of_lane = material / gl_SubgroupSize;
    vec4 found = subgroupShuffle(palette_kept[member], lane);
    [[unroll]] for (uint i = 1u; i < PALETTE_LANES; i++) {
        vec4 other = subgroupShuffle(palette_kept[i * 5u + member], lane);
        found = of_lane == i ? other : found;
    }
    return found;
}
#else
const uint PALETTE_LANES = 0u;
vec4 palette_of_lanes(uint material, uint member) { return vec4(0.0); }
#endif
#define PALETTE_MEMBER(name, member)                                                               \
    vec4 palette_##name(uint material) {                                                           \
        return PALETTE_TEXTURE != 0u ? palette_texel(material, member)                             \
               : PALETTE_LANES != 0u ? palette_of_lanes(material, uint(member))                    \
                                     : materials[material].name;                                   \
    }
PALETTE_MEMBER(albedo, 0)
PALETTE_MEMBER(specular, 1)
PALETTE_MEMBER(emissive, 2)
PALETTE_MEMBER(lobes, 3)
PALETTE_MEMBER(extra, 4)
#undef PALETTE_MEMBER

// Debug pictures: blue, cyan, green, yellow, red for 0..1, then to white at 2. The legends have the
// same colours (heat_color of render/debug_views.c).
vec3 heat_map(float x) {
    vec3 color = clamp(vec3(4.0 * x - 1.5, 2.0 - abs(4.0 * x - 2.0), 1.5 - 4.0 * x), 0.0, 1.0);
    return mix(color, vec3(1.0), clamp(x - 1.0, 0.0, 1.0)) * 0.9 + 0.1;
}

// World position of a pixel from its depth, see FrameRecord.
vec3 position_from_depth(vec2 pixel_center, float depth) {
    vec2 ndc = vec2(pixel_center.x * frame.viewport.z * 2.0 - 1.0,
                    1.0 - pixel_center.y * frame.viewport.w * 2.0);
    vec3 ray = frame.ray_right.xyz * ndc.x + frame.ray_up.xyz * ndc.y + frame.ray_forward.xyz;
    return frame.camera.xyz + ray * (frame.camera.w / max(depth, 1e-9));
}

// The sRGB curve from square roots, a quarter of the price of the three pow() (Chilliant 2012);
// within 0.25 / 255 of the exact one.
vec3 srgb_encode_fast(vec3 c) {
    vec3 a = sqrt(max(c, vec3(0.0))), b = sqrt(a), d = sqrt(b);
    return mix(0.662002687 * a + 0.684122060 * b - 0.323583601 * d - 0.0225411470 * c, 12.92 * c,
               lessThanEqual(c, vec3(0.0031308)));
}

// Exact piecewise sRGB curve (IEC 61966-2-1).
vec3 srgb_encode(vec3 c) {
    return mix(1.055 * pow(max(c, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c,
               lessThanEqual(c, vec3(0.0031308)));
}
#endif
