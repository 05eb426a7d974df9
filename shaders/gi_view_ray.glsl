// gi_view_ray.glsl: what the debug pictures of voxels share: the pixel's ray, boxes, and the way from
// voxel to voxel. Include common.glsl and gi.glsl (with GI_SCREEN) first. Loops are steered by
// flow and gi_flow alone.
#ifndef GI_VIEW_RAY_GLSL
#define GI_VIEW_RAY_GLSL

const uint VIEW_STEPS = 4096u; // cells that a pixel's ray visits at most

// Unit direction through a pixel.
vec3 view_ray(vec2 pixel) {
    vec2 ndc = vec2(pixel.x * flow.viewport.z * 2.0 - 1.0, 1.0 - pixel.y * flow.viewport.w * 2.0);
    return normalize(flow.ray_right.xyz * ndc.x + flow.ray_up.xyz * ndc.y + flow.ray_forward.xyz);
}

vec3 view_safe(vec3 direction) {
    return mix(direction, vec3(1e-7), lessThan(abs(direction), vec3(1e-7)));
}

// Lengths at which a ray enters and leaves a box; x > y: it misses it. axis: of the side it enters.
vec2 view_box(vec3 from, vec3 direction, vec3 low, vec3 high, out uint axis) {
    vec3 inverse = 1.0 / view_safe(direction);
    vec3 a = (low - from) * inverse, b = (high - from) * inverse;
    vec3 near = min(a, b), far = max(a, b);
    float enter = max(max(near.x, near.y), near.z);
    axis = near.x >= enter ? 0u : near.y >= enter ? 1u : 2u;
    return vec2(max(enter, 0.0), min(min(far.x, far.y), far.z));
}

// Of the voxels' box. Lanes beside the pixels read 0 there (gi_cone, gi_cones.glsl): they miss it.
vec2 view_grid(vec3 from, vec3 direction, out uint axis) {
    vec4 origin = gi_flow.origin[GI_CASCADES - 1u];
    vec2 range = view_box(from, direction, origin.xyz,
                          origin.xyz + vec3(gi_flow.dims.xyz) * origin.w, axis);
    return origin.w > 0.0 ? range : vec2(0.0, -1.0);
}

// The finest cascade that a place lies in (the last one, where it lies in none).
uint view_cascade(vec3 world) {
    uint found = GI_CASCADES - 1u;
    for (uint i = GI_CASCADES; i-- > 0u;) {
        vec3 q = (world - gi_flow.origin[i].xyz) / gi_flow.origin[i].w;
        bool inside = all(greaterThanEqual(q, vec3(0.0))) &&
                      all(lessThan(q, vec3(gi_flow.dims.xyz)));
        found = inside ? i : found;
    }
    return found;
}

// A ray's way from cell to cell of `side` voxels (Amanatides and Woo 1987, "A fast voxel traversal
// algorithm"): one neighbour after another, so that it cuts no corner and knows the side it came by.
struct ViewWalk {
    vec3 from, direction, inverse;
    vec3 cells;   // of a cascade
    float side, t; // t: length at which the ray enters the cell, m
    uint cascade, axis; // axis: of the side that it enters through
    vec3 place;   // in cells
};
void view_place(inout ViewWalk walk) {
    vec3 world = walk.from + walk.direction * walk.t;
    walk.cascade = view_cascade(world);
    vec4 origin = gi_flow.origin[walk.cascade];
    walk.place = clamp(floor((world - origin.xyz) / (origin.w * walk.side)), vec3(0.0),
                       walk.cells - 1.0);
}
// t, axis: where the ray enters the grid.
ViewWalk view_walk(vec3 from, vec3 direction, float side, vec3 cells, float t, uint axis) {
    ViewWalk walk = ViewWalk(from, direction, 1.0 / view_safe(direction), cells, side, t, 0u, axis,
                             vec3(0.0));
    view_place(walk);
    return walk;
}
void view_next(inout ViewWalk walk) {
    vec4 origin = gi_flow.origin[walk.cascade];
    float size = origin.w * walk.side;
    vec3 ahead = vec3(greaterThan(walk.inverse, vec3(0.0)));
    vec3 way = (origin.xyz + (walk.place + ahead) * size - walk.from) * walk.inverse;
    float next = min(way.x, min(way.y, way.z));
    walk.axis = way.x <= next ? 0u : way.y <= next ? 1u : 2u;
    vec3 along = vec3(equal(uvec3(walk.axis), uvec3(0u, 1u, 2u)));
    walk.place += along * (ahead * 2.0 - 1.0);
    walk.t = max(next, walk.t);
    if (GI_CASCADES == 1u) return;
    float beyond = next + 1e-3 * size;
    bool stays = view_cascade(walk.from + walk.direction * beyond) == walk.cascade;
    ViewWalk other = walk;
    other.t = beyond;
    view_place(other);
    walk.cascade = stays ? walk.cascade : other.cascade;
    walk.place = stays ? walk.place : other.place;
}
// False: it left the grid.
bool view_is_inside(ViewWalk walk) {
    return all(greaterThanEqual(walk.place, vec3(0.0))) && all(lessThan(walk.place, walk.cells));
}

// As the picture shows radiance (tonemap.frag without its dither).
vec3 view_radiance(vec3 radiance) {
    vec3 c = max(radiance, vec3(0.0)) * frame.ambient.w;
    return srgb_encode_fast(c / (1.0 + c));
}
#endif
