// list_shade.glsl: sums over a list's lights in compute shaders, all lanes on.
//
// Each lane loads one light of the list; then the light loop takes them one by one, by shuffles. A
// uniform block read in the loop would be a gather of the same address for every lane, on the
// software driver: 25 instructions a float, where a shuffle is one.
// Loops end with their test: on the software driver, one that begins with it runs its body once more
// with all lanes off. There an empty list costs as much as one light, as branches skip nothing.
// The includer says what a list's entry is: uint list_entry(bool other, uint at).
#ifndef LIST_SHADE_GLSL
#define LIST_SHADE_GLSL

// Adds points [first, last) to the sum; highlight: a constant.
vec3 shade_points(vec3 sum, Surface s, bool other, uint first, uint last, bool highlight) {
    if (first >= last) return sum;
    for (uint b = first;;) {
        uint mine = list_entry(other, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        vec4 own_position = light_position(mine), own_color = light_color(mine);
        for (uint j = 0u;;) {
            vec4 position = subgroupShuffle(own_position, j);
            vec4 color = subgroupShuffle(own_color, j);
            sum += highlight ? light_point(s, position, color)
                             : light_point_diffuse(s, position, color);
            if (++j >= end) break;
        }
        b += gl_SubgroupSize;
        if (b >= last) break;
    }
    return sum;
}

vec3 shade_spots(vec3 sum, Surface s, bool other, uint first, uint last, bool highlight) {
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
            sum += highlight ? light_spot(s, position, color, direction, edge)
                             : light_spot_diffuse(s, position, color, direction, edge);
            if (++j >= end) break;
        }
        b += gl_SubgroupSize;
        if (b >= last) break;
    }
    return sum;
}

// The sum over a list whose classes (points, diffuse points, spots, diffuse spots) end where `ends`
// says, by half the code: for lists that are seldom shaded or have no diffuse lights, whose factor
// on the highlight is 0.
vec3 shade_list_merged(Surface s, bool other, uint first, uvec4 ends) {
    vec3 sum = shade_points(vec3(0.0), s, other, first, ends.y, true);
    return SPOTS == 0u ? sum : sum + shade_spots(vec3(0.0), s, other, ends.y, ends.w, true);
}

// The same sum to the bit.
vec3 shade_list(Surface s, bool other, uint first, uvec4 ends) {
    if ((LIST_KINDS & LIST_KIND_DIFFUSE) == 0u) return shade_list_merged(s, other, first, ends);
    vec3 sum = shade_points(vec3(0.0), s, other, first, ends.x, true);
    sum = shade_points(sum, s, other, ends.x, ends.y, false);
    if (SPOTS == 0u) return sum;
    vec3 spots = shade_spots(vec3(0.0), s, other, ends.y, ends.z, true);
    return sum + shade_spots(spots, s, other, ends.z, ends.w, false);
}
#endif
