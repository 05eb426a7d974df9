// gi_light.glsl: light that voxels send out (specification of voxel GI, 4): emission + albedo / pi *
// sum over lights of colour * falloff * cosine * visibility. One invocation a slot; a subgroup takes
// the cells of the light grid that its slots lie in one after the other, so that each light is
// loaded once for all of them. A voxel's sum runs over its cell's list in order, whatever the size
// of a subgroup, and lights out of reach add 0: the same bits as with all lights in one list. Loops
// end with their test: of one that begins with it the software driver runs the body once more, with
// nobody in it. Such a test must be the same for all lanes: what is computed in the body of a lane
// that has left goes on changing.
//
// Cosine, by faces. Face f sees max(+-l_axis, 0). shared: `average` takes the mean normal N instead,
// `weighted` the faces on N's side, each counted with N_axis^2; where normals cancel out (thin
// walls) the faces count by how much of the surface they have. apart: six sums; a face that the
// surface does not have sends nothing. Where one surface alone fills the voxel all its faces show
// what it is lit by, N.L: by max(+-l_axis, 0) one that lies aslant would be up to 1.7 times too dark.
// Included by gi_light.comp and gi_light_byte.comp.
#define GI_BUILD
#include "subgroups.glsl"
#include "gi.glsl"
#include "gi_voxel.glsl"
#include "gi_visibility.glsl"
#include "gi_probe_lookup.glsl"
layout(constant_id = SPEC_ATTENUATION) const uint ATTENUATION = 0;
layout(constant_id = SPEC_SHADOW) const uint SHADOW = 0;
layout(constant_id = SPEC_DIRECTIONALS) const uint DIRECTIONAL_COUNT = 0;
#include "attenuation.glsl"
layout(local_size_x = 64) in;

layout(std140, set = 0, binding = BUILD_FRAME) uniform GiFrameBuffer { FrameRecord gi_frame; };
layout(std140, set = 0, binding = BUILD_DIRECTIONALS) uniform GiDirectionalBuffer {
    DirectionalRecord gi_directionals[DIRECTIONALS_CAP];
};
layout(std430, set = 0, binding = BUILD_LIGHTS) readonly buffer GiLightBuffer {
    GiLightRecord gi_lights[];
};
layout(std140, set = 0, binding = BUILD_LIGHT_BLOCK) uniform GiLightBlock {
    GiLightRecord gi_light_block[GI_LIGHT_BLOCK_CAP];
};
layout(std430, set = 0, binding = BUILD_LISTS) readonly buffer GiListBuffer { uint gi_lists[]; };
layout(set = 0, binding = BUILD_SHADOW_MAP) uniform sampler2DShadow gi_shadow_map;
layout(set = 0, binding = BUILD_BASE_STORAGE, GI_STORAGE_FORMAT) writeonly uniform image3D
    gi_base_storage;
layout(set = 0, binding = BUILD_VISIBILITY, r8) writeonly uniform image3D gi_visibility_storage;

// Step 4: groups of 64 slots first, first + stride, ... are lit: of all slots with stride 1, else of
// the static ones; 0: the dynamic ones.
layout(push_constant) uniform Push { uint first, stride; };

const uint SHADOW_MAP = 1u, SHADOW_RAY = 2u, SHADOW_SOFT_RAY = 3u; // VoxelShadow
const bool HAS_RAYS = (GI_VISIBILITY & (1u << SHADOW_RAY | 1u << SHADOW_SOFT_RAY)) != 0u;
const bool HAS_SPOTS = (GI_VISIBILITY & GI_VISIBILITY_SPOTS) != 0u;
const bool IN_BLOCK = (GI_VISIBILITY & GI_VISIBILITY_BLOCK) != 0u;
const float PI = 3.14159265358979;
// Steps: 0 light; 1 light, but the base volume stays as it is, which the bounce still reads; 2 the
// whole image of visibility becomes 1; 3 RADIANCE goes to the base volume (faces shared); 4 light, and
// what the probes say of light that went round (feedback).
const uint STEP_KEEP_BASE = 1u, STEP_CLEAR_VISIBILITY = 2u, STEP_STORE_BASE = 3u,
           STEP_ADD_PROBES = 4u;

// Sums; faces shared: `whole` alone. Not an array: the software driver would keep it in memory.
vec3 whole, light_0, light_1, light_2, light_3, light_4, light_5;
float asked, seen; // lights that arrive and may be hidden; how much of them is seen

// How a voxel as a whole faces a light; 0 = it does not.
float cosine(vec3 l) {
    if (GI_FACES == 0u && GI_COSINE == 0u && normal != vec3(0.0)) return max(dot(normal, l), 0.0);
    float by_faces = dot(ahead, max(l, vec3(0.0))) + dot(behind, max(-l, vec3(0.0)));
    return GI_FACES != 0u ? mix(by_faces, max(dot(normal, l), 0.0), facet) : by_faces;
}

// Light of this irradiance (across its rays) from unit direction l.
void voxel_add(vec3 irradiance, vec3 l, float facing) {
    if (GI_FACES == 0u) {
        whole += irradiance * facing;
        return;
    }
    float slanted = max(dot(normal, l), 0.0);
    vec3 p = mix(max(l, vec3(0.0)), vec3(slanted), facet);
    vec3 q = mix(max(-l, vec3(0.0)), vec3(slanted), facet);
    light_0 += irradiance * p.x;
    light_1 += irradiance * q.x;
    light_2 += irradiance * p.y;
    light_3 += irradiance * q.y;
    light_4 += irradiance * p.z;
    light_5 += irradiance * q.z;
}

// Share of a light that arrives, and the books of it. reach: m to the light.
float voxel_visibility(uint way, vec3 l, float reach, bool arrives) {
    if (!HAS_RAYS) return 1.0;
    bool is_asked = arrives && way >= SHADOW_RAY;
    vec3 start = position + gi_ray_lift(normal, l) * gi.origin[cascade].w;
    float visible = gi_ray(start, cascade, l, reach, way == SHADOW_SOFT_RAY, is_asked);
    asked += is_asked ? 1.0 : 0.0;
    seen += is_asked ? visible : 0.0;
    return visible;
}

// --- Lights ---

void add_local(GiLightRecord a) {
    vec3 to_light = a.position.xyz - position;
    float d2 = max(dot(to_light, to_light), 1e-8), inv_d = inversesqrt(d2);
    vec3 l = to_light * inv_d;
    float falloff = attenuation_exact(d2, inv_d, d2 * a.position.w, gi_frame.attenuation.xyz);
    if (HAS_SPOTS) falloff *= a.extra.y != 0.0 ? spot_cone(l, a.direction, a.extra.x) : 1.0;
    float facing = cosine(l);
    falloff *= voxel_visibility(uint(a.color.w), l, d2 * inv_d, falloff * facing > 0.0);
    voxel_add(a.color.rgb * falloff, l, facing);
}

// Lights [first, end) of the lists, the same for all lanes; for those lanes whose turn it is. Each
// lane loads one, and a shuffle tells the others: of the index, if the lights fit into the uniform
// block, else of all. (The software driver reads a storage buffer within a loop lane by lane, at an
// address that is the same for all lanes too.)
void add_list(uint first, uint end, bool is_mine) {
    uint b = first;
    if (b < end)
        do {
            uint own_index = gi_lists[min(b + gl_SubgroupInvocationID, end - 1u)];
            GiLightRecord own;
            if (!IN_BLOCK) own = gi_lights[own_index];
            uint count = min(gl_SubgroupSize, end - b), j = 0u;
            do {
                GiLightRecord a;
                if (IN_BLOCK) {
                    a = gi_light_block[subgroupShuffle(own_index, j)];
                } else {
                    a.position = subgroupShuffle(own.position, j);
                    a.color = subgroupShuffle(own.color, j);
                    if (HAS_SPOTS) {
                        a.direction = subgroupShuffle(own.direction, j);
                        a.extra.xy = subgroupShuffle(own.extra.xy, j);
                    }
                }
                // Out of reach of everybody else.
                a.position.w = is_mine ? a.position.w : 1e30;
                add_local(a);
            } while (++j < count);
            b += gl_SubgroupSize;
        } while (b < end);
}

void add_locals() {
    vec3 cell = (position - gi.light_grid_origin.xyz) * gi.light_grid_rate.xyz;
    uvec3 at = uvec3(clamp(cell, vec3(0.0), vec3(gi.light_grid.xyz) - 1.0));
    uint index = at.x + gi.light_grid.x * (at.y + gi.light_grid.y * at.z);
    uint next = subgroupBroadcastFirst(subgroupMin(index));
    do {
        uint first = subgroupBroadcastFirst(gi_lists[2u * next]);
        uint count = subgroupBroadcastFirst(gi_lists[2u * next + 1u]);
        add_list(first, first + count, index == next);
        next = subgroupBroadcastFirst(subgroupMin(index > next ? index : 0xffffffffu));
    } while (next != 0xffffffffu);
}

// The shadow map tells about a point half a voxel off the surface; voxels that it does not cover
// are lit.
float map_visibility() {
    vec3 moved = position + normal * (0.5 * gi.origin[cascade].w);
    vec4 p = gi_frame.shadow_matrix * vec4(moved, 1.0);
    vec3 uv = vec3(p.x * 0.5 + 0.5, 0.5 - p.y * 0.5, p.z + gi_frame.shadow.w);
    bool inside = all(lessThan(abs(p.xy), vec2(1.0))) && p.z > 0.0 && p.z < 1.0;
    float visible = textureLod(gi_shadow_map, uv, 0.0);
    return inside ? visible : 1.0;
}

void add_directionals() {
    bool has_map = SHADOW != 0u && (GI_VISIBILITY & 1u << SHADOW_MAP) != 0u;
    float mapped = has_map ? map_visibility() : 1.0;
    if (DIRECTIONAL_COUNT == 0u) return;
    uint i = 0u;
    do {
        vec4 direction = gi_directionals[i].direction, color = gi_directionals[i].color;
        float facing = direction.w < 0.0 ? 0.0 : cosine(direction.xyz);
        uint way = uint(max(direction.w, 0.0));
        float visible = voxel_visibility(way, direction.xyz, 1e30, facing > 0.0);
        bool by_map = has_map && way == SHADOW_MAP && color.w > 0.0;
        visible = by_map ? mapped : visible;
        asked += by_map && facing > 0.0 ? 1.0 : 0.0;
        seen += by_map && facing > 0.0 ? mapped : 0.0;
        voxel_add(direction.w < 0.0 ? vec3(0.0) : color.rgb * visible, direction.xyz, facing);
    } while (++i < DIRECTIONAL_COUNT);
}

// --- Light that went round ---

// Probes know the six axes apart. With a mean normal one look-up serves all; else one for the faces
// on the positive side, and one for the others.
void add_probes(uint slot) {
    vec3 albedo = voxel_albedo(slot);
    vec3 share = PI * min(vec3(1.0), FEEDBACK_ALBEDO / max(albedo, vec3(1e-3)));
    bool by_mean = GI_FACES == 0u && normal != vec3(0.0);
    vec3 on = by_mean ? ahead + behind : ahead;
    uint side = 0u, sides = subgroupAny(!by_mean) ? 2u : 1u;
    do {
        vec3 facing = by_mean ? normal : side == 0u ? on : -on;
        facing *= inversesqrt(max(dot(facing, facing), 1e-12));
        uint count = on != vec3(0.0) ? 4u : 0u;
        GiProbeLight axes = gi_probe_axes(voxel_front(facing), facing, count, true);
        vec3 x = axes.x.rgb * share, y = axes.y.rgb * share, z = axes.z.rgb * share;
        if (GI_FACES == 0u) {
            whole += x * on.x + y * on.y + z * on.z;
        } else {
            light_0 += side == 0u ? x : vec3(0.0);
            light_1 += side == 1u ? x : vec3(0.0);
            light_2 += side == 0u ? y : vec3(0.0);
            light_3 += side == 1u ? y : vec3(0.0);
            light_4 += side == 0u ? z : vec3(0.0);
            light_5 += side == 1u ? z : vec3(0.0);
        }
        on = by_mean ? vec3(0.0) : behind;
    } while (++side < sides);
}

// --- The result ---

void store_face(uint slot, uint f, vec3 sent) {
    gi_store_radiance(slot, f, vec4(sent * voxel_face(f), voxel_density(f)));
}

void base_store(ivec3 place, vec4 texel) {
    if (GI_BRICKS == 0u) {
        imageStore(gi_base_storage, place, texel);
        return;
    }
    // Into its own brick, and those that end with it: every subset of the axes.
    uint edges = gi_brick_edges(place), subset = edges, more = 1u;
    for (; more != 0u; subset = (subset - 1u) & edges) {
        ivec3 before = ivec3(subset & 1u, subset >> 1 & 1u, subset >> 2);
        ivec3 brick = gi_brick(place / GI_BRICK_CELL - before);
        ivec3 at = brick * GI_BRICK_SIDE + place % GI_BRICK_CELL + before * GI_BRICK_CELL;
        if (brick != ivec3(0)) imageStore(gi_base_storage, at, texel); // it found no room
        more = subset;
    }
}

void store(uint slot) {
    uvec3 place = gi_unpack_place(gi_voxels[slot]);
    vec3 albedo = voxel_albedo(slot) * (1.0 / PI);
    vec3 emission = gi_unpack_emission(gi_attribute(slot, GI_ATTRIBUTE_EMISSION));
    if (GI_FACES != 0u) {
        store_face(slot, 0u, emission + albedo * light_0);
        store_face(slot, 1u, emission + albedo * light_1);
        store_face(slot, 2u, emission + albedo * light_2);
        store_face(slot, 3u, emission + albedo * light_3);
        store_face(slot, 4u, emission + albedo * light_4);
        store_face(slot, 5u, emission + albedo * light_5);
    } else {
        vec4 radiance = vec4(emission + albedo * whole, 1.0);
        gi_store_radiance(slot, 0u, radiance);
        if (GI_STEP != STEP_KEEP_BASE)
            base_store(ivec3(place), gi_encode(radiance));
    }
    if ((GI_VISIBILITY & GI_VISIBILITY_KEPT) != 0u)
        imageStore(gi_visibility_storage, ivec3(place), vec4(asked > 0.0 ? seen / asked : 1.0));
}

void store_base(uint slot) {
    uvec3 place = gi_unpack_place(gi_voxels[slot]);
    base_store(ivec3(place), gi_encode(gi_load_radiance(slot, 0u)));
}

void main() {
    if (GI_STEP == STEP_CLEAR_VISIBILITY) {
        ivec3 place = ivec3(gl_GlobalInvocationID);
        if (place.x < imageSize(gi_visibility_storage).x)
            imageStore(gi_visibility_storage, place, vec4(1.0));
        return;
    }
    uint count = voxel_count();
    if (gl_WorkGroupID.x * gl_WorkGroupSize.x >= count) return;
    if (GI_STEP == STEP_STORE_BASE) {
        if (gl_GlobalInvocationID.x < count) store_base(gl_GlobalInvocationID.x);
        return;
    }
    uint slot = gl_GlobalInvocationID.x;
    if (GI_STEP == STEP_ADD_PROBES) {
        uint fixed_count = min(gi_counters[GI_COUNTER_STATIC], count);
        slot = (gl_WorkGroupID.x * stride + first) * 64u + gl_LocalInvocationIndex;
        slot = stride == 0u ? fixed_count + gl_GlobalInvocationID.x : slot;
        count = stride > 1u ? fixed_count : count;
        if (slot - gl_LocalInvocationIndex >= count) return;
    }
    // All lanes stay on: what they load is shared.
    uint held = min(slot, count - 1u);
    voxel_load(held);
    whole = light_0 = light_1 = light_2 = light_3 = light_4 = light_5 = vec3(0.0);
    asked = seen = 0.0;
    add_directionals();
    add_locals();
    if (GI_STEP == STEP_ADD_PROBES) add_probes(held);
    if (slot < count) store(slot);
}
