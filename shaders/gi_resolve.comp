#version 460
// gi_resolve.comp: from the sums of a window of slots to their attributes; the sums are zero again
// after it. A voxel into which nothing falls is the inside of a solid: black, facing nowhere.
#extension GL_GOOGLE_include_directive : require
#define GI_BUILD
#include "gi.glsl"
layout(local_size_x = 64) in;
layout(push_constant) uniform GiDrawBuffer { GiDrawRecord draw; };

void resolve(uint place, uint slot, uint layer) {
    uint at = place * GI_SUM_WORDS;
    float sums[GI_SUM_WORDS];
    for (uint i = 0u; i < GI_SUM_WORDS; i++) {
        sums[i] = float(gi_accumulators[at + i]);
        gi_accumulators[at + i] = 0u;
    }
    uint bits = draw.how.x >> GI_DRAW_BITS_SHIFT & 15u;
    precise float unit = sums[GI_SUM_COUNT] * float((1u << bits) - 1u);
    unit = 1.0 / max(unit, 1.0);
    vec3 albedo = vec3(sums[GI_SUM_ALBEDO], sums[GI_SUM_ALBEDO + 1], sums[GI_SUM_ALBEDO + 2]) * unit;
    vec3 normal = vec3(sums[GI_SUM_NORMAL], sums[GI_SUM_NORMAL + 1], sums[GI_SUM_NORMAL + 2]) *
                  (unit * 2.0) - 1.0;
    if (sums[GI_SUM_COUNT] == 0.0) normal = vec3(0.0);
    float faces[6];
    for (uint i = 0u; i < 6u; i++) faces[i] = sums[GI_SUM_FACES + i] * unit;
    vec3 low = vec3(sums[GI_SUM_EMISSION_LOW], sums[GI_SUM_EMISSION_LOW + 1],
                    sums[GI_SUM_EMISSION_LOW + 2]);
    vec3 high = vec3(sums[GI_SUM_EMISSION_HIGH], sums[GI_SUM_EMISSION_HIGH + 1],
                     sums[GI_SUM_EMISSION_HIGH + 2]);
    precise float whole = max(sums[GI_SUM_COUNT], 1.0) * float((1u << 2u * bits) - 1u);
    precise vec3 emission = high * float(1u << bits) + low;
    emission = emission / whole;
    emission = emission * uintBitsToFloat(draw.how.z);
    uint to = slot * GI_ATTRIBUTE_WORDS;
    uvec2 packed_faces = gi_pack_faces(faces);
    gi_attributes[to + GI_ATTRIBUTE_ALBEDO] =
        packUnorm4x8(vec4(albedo, layer == 0u ? 1.0 : 0.0));
    gi_attributes[to + GI_ATTRIBUTE_NORMAL] = gi_pack_normal(normal);
    gi_attributes[to + GI_ATTRIBUTE_EMISSION] = gi_pack_emission(emission);
    gi_attributes[to + GI_ATTRIBUTE_FACES_0] = packed_faces.x;
    gi_attributes[to + GI_ATTRIBUTE_FACES_1] = packed_faces.y;
}

void main() {
    uint place = gl_GlobalInvocationID.x, layer = draw.how.x & GI_DRAW_DYNAMIC;
    uint first = layer == 0u ? 0u : gi_counters[GI_COUNTER_STATIC];
    uint count = gi_counters[layer == 0u ? GI_COUNTER_STATIC : GI_COUNTER_DYNAMIC];
    uint slot = first + draw.how.y + place;
    bool is_there = place < GI_WINDOW_SLOTS && draw.how.y + place < count &&
                    slot < gi_flow.counts.z;
    if (is_there) resolve(place, slot, layer);
}
