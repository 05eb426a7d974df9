// list_shade.glsl: sums over a list's lights in compute shaders, all lanes on.
//
// Each lane loads one entry of the list; then the light loop takes them one by one: an index is
// made uniform by a shuffle, and a uniform block read at a uniform address is a scalar load on the
// software driver, a quarter of the price of shuffling the light's eight floats.
// The includer says what a list's entry is: uint list_entry(bool other, uint at).
#ifndef LIST_SHADE_GLSL
#define LIST_SHADE_GLSL

// Adds points [first, last) to the sum; highlight: a constant.
vec3 shade_points(vec3 sum, Surface s, bool other, uint first, uint last, bool highlight) {
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint mine = list_entry(other, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        if (LIGHT_BLOCKS != 0u) {
            for (uint j = 0u; j < end; j++) {
                uint index = subgroupShuffle(mine, j);
                vec4 position = light_position(index), color = light_color(index);
                sum += highlight ? light_point(s, position, color)
                                 : light_point_diffuse(s, position, color);
            }
        } else {
            vec4 own_position = light_position(mine), own_color = light_color(mine);
            for (uint j = 0u; j < end; j++) {
                vec4 position = subgroupShuffle(own_position, j);
                vec4 color = subgroupShuffle(own_color, j);
                sum += highlight ? light_point(s, position, color)
                                 : light_point_diffuse(s, position, color);
            }
        }
    }
    return sum;
}

vec3 shade_spots(vec3 sum, Surface s, bool other, uint first, uint last, bool highlight) {
    uint point_count = flow.counts.x;
    for (uint b = first; b < last; b += gl_SubgroupSize) {
        uint mine = list_entry(other, min(b + gl_SubgroupInvocationID, last - 1u));
        uint end = min(gl_SubgroupSize, last - b);
        for (uint j = 0u; j < end; j++) {
            uint index = subgroupShuffle(mine, j);
            vec4 position = light_position(index), color = light_color(index);
            vec4 direction = spot_direction(index - point_count);
            float edge = spot_edge(index - point_count);
            sum += highlight ? light_spot(s, position, color, direction, edge)
                             : light_spot_diffuse(s, position, color, direction, edge);
        }
    }
    return sum;
}

// A list whose classes (points, diffuse points, spots, diffuse spots) end where `ends` says.
vec3 shade_list(Surface s, bool other, uint first, uvec4 ends) {
    vec3 sum = shade_points(vec3(0.0), s, other, first, ends.x, true);
    sum = shade_points(sum, s, other, ends.x, ends.y, false);
    if (SPOTS == 0u) return sum;
    vec3 spots = shade_spots(vec3(0.0), s, other, ends.y, ends.z, true);
    return sum + shade_spots(spots, s, other, ends.z, ends.w, false);
}
#endif
