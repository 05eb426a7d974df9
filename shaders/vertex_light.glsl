// vertex_light.glsl: local lights at a vertex: the diffuse lobe for white, to be multiplied with the
// albedo by the fragment.
#ifndef VERTEX_LIGHT_GLSL
#define VERTEX_LIGHT_GLSL
#include "light.glsl"

layout(std430, set = 0, binding = BINDING_CELLS) readonly buffer CellBuffer { CellRecord cells[]; };
layout(std430, set = 0, binding = BINDING_LIGHT_INDICES) readonly buffer IndexBuffer {
    uint light_indices[];
};

// Without the view: light_point_diffuse of a white Lambert surface.
Surface vertex_surface(vec3 position, vec3 normal) {
    Surface s;
    s.position = position;
    s.normal = normal;
    s.view = normal;
    s.diffuse = vec3(1.0 / PI);
    s.specular = vec3(0.0);
    s.power = 1.0;
    s.lobes = vec4(0.0, 0.0, 1.0, 0.0);
    s.fresnel = 0.0;
    s.n_dot_v = 1.0;
    return s;
}

// The packet's list of the vertex's cell; all lights where there is none: beside the screen, or
// when lists are made on the device, for what is seen only.
vec3 vertex_light(vec3 position, vec3 normal, vec4 clip) {
    Surface s = vertex_surface(position, normal);
    uint point_count = flow.counts.x;
    uvec3 list = uvec3(0u, flow.counts.xy);
    bool in_cell = false;
    if (CELL_LISTS != 0u && DEVICE_LISTS == 0u && CLUSTERED != 2u) {
        vec2 pixel = (clip.xy * vec2(0.5, -0.5) / clip.w + 0.5) * frame.viewport.xy;
        in_cell = clip.w > frame.camera.w && all(greaterThanEqual(pixel, vec2(0.0))) &&
                  all(lessThan(pixel, frame.viewport.xy));
        uvec2 tile = uvec2(in_cell ? pixel : vec2(0.0)) >> TILE_SHIFT;
        uint cell = tile.y * flow.grid.x + tile.x;
        if (CLUSTERED == 1u) {
            float slice = floor(log2(max(clip.w, 1e-9)) * frame.slices.x + frame.slices.y);
            cell += uint(clamp(slice, 0.0, float(flow.grid.z) - 1.0)) * flow.grid.x * flow.grid.y;
        }
        if (in_cell) list = cells[cell].list.xyz;
    }
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < list.y; i++) {
        uint index = in_cell ? light_indices[list.x + i] : i;
        sum += light_point_diffuse(s, light_position(index), light_color(index));
    }
    if (SPOTS == 0u) return sum;
    for (uint i = list.y; i < list.y + list.z; i++) {
        uint index = in_cell ? light_indices[list.x + i] : i;
        sum += light_spot_diffuse(s, light_position(index), light_color(index),
                                  spot_direction(index - point_count),
                                  spot_edge(index - point_count));
    }
    return sum;
}
#endif
