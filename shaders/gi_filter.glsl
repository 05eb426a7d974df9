// gi_filter.glsl: how eight texels become one (specification of voxel GI, 5).
#ifndef GI_FILTER_GLSL
#define GI_FILTER_GLSL
#include "gi.glsl"

const bool HAS_DENSITY = GI_FACES != 0u && GI_DIRECTIONS != 1u;

// As premultiplied light that is composited, from what texels hold and back.
vec4 filter_load(vec4 texel) { return HAS_DENSITY ? gi_solid(texel, 1.0) : texel; }
vec4 filter_result(vec4 light) { return HAS_DENSITY ? gi_dense(light) : light; }

// Both premultiplied.
vec4 filter_over(vec4 front, vec4 back) { return front + back * (1.0 - front.a); }

// Children by bits: 1 x, 2 y, 4 z. What leaves towards d: the child on d's side is in front. Four
// pairs along d, each composited front to back, then averaged.
vec4 filter_along(vec4 c[8], const int d) {
    const int depth = 1 << (d >> 1), right = d < 2 ? 2 : 1, up = 7 - depth - right;
    const int front = (d & 1) == 0 ? depth : 0, back = depth - front;
    return 0.25 * (filter_over(c[front], c[back]) + filter_over(c[front + right], c[back + right]) +
                   filter_over(c[front + up], c[back + up]) +
                   filter_over(c[front + right + up], c[back + right + up]));
}
vec4 filter_average(vec4 c[8]) {
    return (c[0] + c[1] + c[2] + c[3] + c[4] + c[5] + c[6] + c[7]) * 0.125;
}
#endif
