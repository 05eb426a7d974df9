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

vec2 view_grid(vec3 from, vec3 direction, out uint axis) {
    vec4 origin = gi_flow.origin[GI_CASCADES - 1u];
    return view_box(from, direction, origin.xyz, origin.xyz + vec3(gi_flow.dims.xyz) * origin.w,
                    axis);
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

// A cell of `side` voxels around a place, and how far the ray still is in it, m.
struct ViewCell {
    uint cascade, axis; // axis: of the side that it leaves through
    vec3 inside;        // 0..1
    ivec3 place;        // in cells
    float rest;
};
ViewCell view_cell(vec3 world, vec3 direction, float side, vec3 cells) {
    ViewCell cell;
    cell.cascade = view_cascade(world);
    vec4 origin = gi_flow.origin[cell.cascade];
    vec3 q = (world - origin.xyz) / (origin.w * side);
    vec3 low = clamp(floor(q), vec3(0.0), cells - 1.0);
    vec3 border = low + mix(vec3(0.0), vec3(1.0), greaterThan(direction, vec3(0.0)));
    vec3 way = (border - q) / view_safe(direction);
    float rest = min(way.x, min(way.y, way.z));
    cell.axis = way.x <= rest ? 0u : way.y <= rest ? 1u : 2u;
    cell.inside = q - low;
    cell.place = ivec3(low);
    cell.rest = (max(rest, 0.0) + 1e-3) * side * origin.w; // a little beyond the border
    return cell;
}

// As the picture shows radiance (tonemap.frag without its dither).
vec3 view_radiance(vec3 radiance) {
    vec3 c = max(radiance, vec3(0.0)) * frame.ambient.w;
    return srgb_encode_fast(c / (1.0 + c));
}
#endif
