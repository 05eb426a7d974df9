// list_shade.glsl: sums over a list's lights in compute shaders, all lanes on.
//
// Each lane loads one light of the list; then the light loop takes them one by one, by shuffles. A
// uniform block read in the loop would be a gather of the same address for every lane, on the
// software driver: 25 instructions a float, where a shuffle is one.
// Loops end with their test: on the software driver, one that begins with it runs its body once more
// with all lanes off. There an empty list costs as much as one light, as branches skip nothing.
// A lane shades several surfaces by each light: what fetching it and the loop cost is paid once, and
// long chains of arithmetic go side by side.
// The includer says how many surfaces (SURFACES, a constant) and what a list's entry is: uint
// list_entry(bool other, uint at).
#ifndef LIST_SHADE_GLSL
#define LIST_SHADE_GLSL

// The surfaces that a lane shades at once, and what they got.
const uint SURFACES_CAP = 8u;
struct Surfaces {
    Surface at[SURFACES_CAP];
};
struct Sums {
    vec3 at[SURFACES_CAP];
};
Sums sums_zero() {
    Sums zero;
    [[unroll]] for (uint i = 0u; i < SURFACES; i++) zero.at[i] = vec3(0.0);
    return zero;
}
Sums sums_add(Sums a, Sums b) {
    [[unroll]] for (uint i = 0u; i < SURFACES; i++) a.at[i] += b.at[i];
    return a;
}

// Adds points [first, last) to the sums; highlight: a constant.
Sums shade_points(Sums sum, Surfaces s, bool other, uint first, uint last, bool highlight) {
    if (first >= last) return sum;
    for (uint b = first;;) {
        uint mine = list_entry(other, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        vec4 own_position = light_position(mine), own_color = light_color(mine);
        for (uint j = 0u;;) {
            vec4 position = subgroupShuffle(own_position, j);
            vec4 color = subgroupShuffle(own_color, j);
            [[unroll]] for (uint i = 0u; i < SURFACES; i++)
                sum.at[i] += highlight ? light_point(s.at[i], position, color)
                                       : light_point_diffuse(s.at[i], position, color);
            if (++j >= end) break;
        }
        b += gl_SubgroupSize;
        if (b >= last) break;
    }
    return sum;
}

Sums shade_spots(Sums sum, Surfaces s, bool other, uint first, uint last, bool highlight) {
    uint point_count = flow.counts.x;
    if (first >= last) return sum;
    for (uint b = first;;) {
        uint mine = list_entry(other, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        vec4 own_position = light_position(mine), own_color = light_color(mine);
        vec4 own_direction = spot_direction(mine - point_count);
        float own_edge = spot_edge(mine - point_count);
        for (uint j = 0u;;) {
            vec4 position = subgroupShuffle(own_position, j);
            vec4 color = subgroupShuffle(own_color, j);
            vec4 direction = subgroupShuffle(own_direction, j);
            float edge = subgroupShuffle(own_edge, j);
            [[unroll]] for (uint i = 0u; i < SURFACES; i++)
                sum.at[i] += highlight
                                 ? light_spot(s.at[i], position, color, direction, edge)
                                 : light_spot_diffuse(s.at[i], position, color, direction, edge);
            if (++j >= end) break;
        }
        b += gl_SubgroupSize;
        if (b >= last) break;
    }
    return sum;
}

// The sums over a list whose classes (points, diffuse points, spots, diffuse spots) end where `ends`
// says, by half the code: for lists that are seldom shaded or have no diffuse lights, whose factor
// on the highlight is 0.
Sums shade_list_merged(Surfaces s, bool other, uint first, uvec4 ends) {
    Sums sum = shade_points(sums_zero(), s, other, first, ends.y, true);
    if (SPOTS == 0u) return sum;
    return sums_add(sum, shade_spots(sums_zero(), s, other, ends.y, ends.w, true));
}

// The same sums to the bit.
Sums shade_list(Surfaces s, bool other, uint first, uvec4 ends) {
    if ((LIST_KINDS & LIST_KIND_DIFFUSE) == 0u) return shade_list_merged(s, other, first, ends);
    Sums sum = shade_points(sums_zero(), s, other, first, ends.x, true);
    sum = shade_points(sum, s, other, ends.x, ends.y, false);
    if (SPOTS == 0u) return sum;
    Sums spots = shade_spots(sums_zero(), s, other, ends.y, ends.z, true);
    return sums_add(sum, shade_spots(spots, s, other, ends.z, ends.w, false));
}
#endif
