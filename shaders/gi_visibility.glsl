// gi_visibility.glsl: does light reach a voxel? Rays from voxel to voxel through the masks, exactly
// those that they cross (Amanatides and Woo, "A fast voxel traversal algorithm", 1987).
// The includer has included gi.glsl and subgroups.glsl; all lanes of a subgroup call together.
#ifndef GI_VISIBILITY_GLSL
#define GI_VISIBILITY_GLSL

// A ray begins so many voxels away from the middle of its own one, whose surface is not in its way:
// two as published; where faces are apart, and light must not get through walls, one.
const float GI_RAY_FIRST = GI_FACES != 0u ? 1.0 : 2.0;
// ... and ends so many before a lamp: what the lamp is made of is not in its way either.
const float GI_RAY_LAST = 1.0;
// Less than this is as good as dark.
const float GI_RAY_DARK = 1.0 / 256.0;
// The software driver stops an invocation after 65,535 iterations of all its loops, without a word:
// a subgroup that has spent so many on rays takes the rest of its lights as seen.
const uint GI_RAY_BUDGET = 40000u;
uint gi_ray_spent = 0u;

// 1 where a ray meets something. bit: of a voxel in a layer.
uint gi_ray_meets(uint bit) {
    uint word = bit >> 5, layer = gi_layer_words();
    uint mask = gi_masks[GI_MASK_STATIC * layer + word] | gi_masks[GI_MASK_DYNAMIC * layer + word];
    if ((GI_VISIBILITY & GI_VISIBILITY_SOLID) != 0u)
        mask |= gi_masks[GI_MASK_SOLID * layer + word];
    return mask >> (bit & 31u) & 1u;
}

// What a ray's start is moved by, in voxels, from the middle of a voxel with this normal (or 0): off
// the voxels that a plane through its own one fills, half a voxel to each side along an axis, more at
// an angle. A start farther along the ray would do as well, and pass walls.
vec3 gi_ray_lift(vec3 normal, vec3 l) {
    float height = dot(abs(normal), vec3(1.0)) - 0.45;
    return dot(normal, l) > 0.0 ? normal * height : vec3(0.0);
}

// Share of a light that arrives at `start` (world; near the middle of a voxel of the cascade) from
// unit direction l, where the light is `reach` m away. soft: each voxel in the way takes
// min(hit / d, 1) of what is left, d its distance as a share of the grid's longest side, as the
// specification of voxel GI says in 4; hard: the first takes all. wanted: else 1, for nothing.
// A ray goes on through the coarser cascades.
float gi_ray(vec3 start, uint cascade, vec3 l, float reach, bool soft, bool wanted) {
    const uint steps = 4u; // in one iteration
    float seen = 1.0;
    float hit = gi_flow.strength.w;
    bool all_at_once = !soft || hit >= 1.0;
    vec3 slope = max(abs(l), vec3(1e-6)); // voxels of each axis that a voxel's length crosses
    bvec3 up = greaterThanEqual(l, vec3(0.0));
    float first = GI_RAY_FIRST * gi.origin[cascade].w; // m along the ray that are done
    uint coarser = 0u;
    do {
        uint c = min(cascade + coarser, GI_CASCADES - 1u);
        float voxel = gi.origin[c].w;
        vec3 from = (start - gi.origin[c].xyz) / voxel;
        bool mine = wanted && cascade + coarser < GI_CASCADES && seen > 0.0;
        float t = first / voxel, last = mine ? reach / voxel - GI_RAY_LAST : -1.0;
        float soft_hit = hit * float(max(gi.dims.x, max(gi.dims.y, gi.dims.z)));
        vec3 p = floor(from + l * t);
        // Where the ray leaves the voxel along each axis.
        vec3 leave = abs(p + mix(vec3(0.0), vec3(1.0), up) - from) / slope;
        vec3 every = 1.0 / slope;
        uvec3 place = uvec3(ivec3(p));
        uvec3 stride = mix(uvec3(0xffffffffu), uvec3(1u), up);
        uint spent = gi_ray_spent;
        bool goes_on = t < last && spent < GI_RAY_BUDGET && all(lessThan(place, gi_flow.dims.xyz));
        // All lanes stay until the last one is through: those that are take nothing in.
        if (subgroupAny(goes_on))
            do {
                spent++;
                for (uint i = 0u; i < steps; i++) {
                    bool is_inside = t < last && all(lessThan(place, gi.dims.xyz));
                    uvec3 held = min(place, gi.dims.xyz - 1u);
                    held.z += gi.dims.z * c;
                    float taken = all_at_once ? 1.0 : min(soft_hit / max(t, 1.0), 1.0);
                    bool met = is_inside && gi_ray_meets(gi_bit(held)) != 0u;
                    seen *= met ? 1.0 - taken : 1.0;
                    // On through the nearest border; outside it stays where it is.
                    float next = min(leave.x, min(leave.y, leave.z));
                    bool by_x = leave.x <= next, by_y = !by_x && leave.y <= next;
                    bvec3 crossed = bvec3(is_inside && by_x, is_inside && by_y,
                                          is_inside && !by_x && !by_y);
                    place += mix(uvec3(0u), stride, crossed);
                    leave += mix(vec3(0.0), every, crossed);
                    t = is_inside ? next : t;
                }
                seen = seen < GI_RAY_DARK ? 0.0 : seen;
                goes_on = seen > 0.0 && t < last && spent < GI_RAY_BUDGET &&
                          all(lessThan(place, gi_flow.dims.xyz));
            } while (subgroupAny(goes_on));
        gi_ray_spent = subgroupMax(spent);
        // Borders of nested grids coincide: a hair beyond.
        first = max(first, t * voxel + 1e-3 * voxel);
    } while (++coarser < GI_CASCADES);
    return seen;
}
#endif
