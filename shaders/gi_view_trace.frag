#version 460
// gi_view_trace.frag: indirect light of the screen in parts: what gi_trace.comp left, as it is
// (coarse where fewer pixels are traced), how many steps its cones take, and where light leaks.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"
#include "gi_view_ray.glsl"

layout(set = 2, binding = BINDING_GI_TRACE_0) uniform sampler2D trace_0;
layout(set = 2, binding = BINDING_GI_TRACE_1) uniform sampler2D trace_1;

layout(location = 0) out vec4 out_color;

const float STEPS_HOT = 128.0; // red: steps of a pixel's cones together
const float LEAK_SHARE = 0.05; // less light than this by rays: what cones bring has leaked

float steps_of(GbufferPixel g, Surface s, bool is_on) {
    vec3 start = gi_start(g);
    float sum = 0.0;
    if (GI_DIFFUSE == 1u || (GI_DIFFUSE != 2u && (GI_FEATURES & GI_FEATURE_AO) != 0u))
        sum += gi_hemisphere(start, g.normal, vec2(0.0), GI_START, gi_reach(), is_on ? 6u : 0u, vec3(0.0),
                             vec3(0.0))
                   .steps;
    if (gi_has_specular()) {
        vec3 color = gi_specular_color(s);
        bool shines = is_on && max(max(color.r, color.g), color.b) > 0.0;
        vec3 mirrored = reflect(-s.view, g.normal);
        mirrored = normalize(mirrored + g.normal * max(-dot(mirrored, g.normal), 0.0) * 2.0);
        sum += gi_cone(start, mirrored, gi_specular_tan(s), GI_START, shines ? gi_reach() : 0.0)
                   .steps;
    }
    return sum;
}

// Radiance of the first voxel on a ray, without any filter: nothing passes it.
vec3 first_light(vec3 from, vec3 direction, bool is_on) {
    GiAxes axes = gi_axes(direction);
    uint axis;
    vec2 range = view_grid(from, direction, axis);
    float end = is_on ? range.y : -1.0;
    ViewWalk walk = view_walk(from, direction, 1.0, vec3(gi_flow.dims.xyz),
                              gi_flow.origin[0].w * GI_START, axis);
    vec4 met = vec4(0.0);
    for (uint i = 0u; i < VIEW_STEPS && walk.t < end && met.a < 0.25; i++) {
        ivec3 place = ivec3(walk.place) + ivec3(0, 0, int(gi_flow.dims.z * walk.cascade));
        if (GI_FACES == 0u) {
            met = texelFetch(gi_base, gi_base_texel(place), 0);
        } else {
            ivec3 block = GI_DIRECTIONS == 1u ? ivec3(0) : ivec3(axes.block) * int(gi_flow.atlas.x);
            met = texelFetch(gi_atlas, place + ivec3(block.x, 0, 0), 0) * axes.weight.x +
                  texelFetch(gi_atlas, place + ivec3(block.y, 0, 0), 0) * axes.weight.y +
                  texelFetch(gi_atlas, place + ivec3(block.z, 0, 0), 0) * axes.weight.z;
            met = gi_solid(met, 1.0);
        }
        view_next(walk);
        end = view_is_inside(walk) ? end : -1.0;
    }
    return gi_decode(met).rgb;
}

// As gi_hemisphere, by five rays a cone instead.
vec3 light_by_rays(vec3 start, vec3 normal, bool is_on) {
    vec3 u = normalize(cross(normal, GI_TANGENT_POLE)), v = cross(normal, u), sum = vec3(0.0);
    float spread = gi_flow.cone.x * 0.7;
    for (uint i = 0u; i < 30u; i++) {
        uint cone = i / 5u, part = i % 5u;
        float turn = float(cone) * 1.256637061;
        vec3 axis = cone == 0u ? normal
                               : normal * 0.5 + (u * cos(turn) + v * sin(turn)) * 0.866025404;
        vec3 a = normalize(cross(axis, GI_TANGENT_POLE)), b = cross(axis, a);
        vec3 aside = part == 0u   ? vec3(0.0)
                     : part == 1u ? a
                     : part == 2u ? -a
                     : part == 3u ? b
                                  : -b;
        vec3 direction = normalize(axis + aside * spread);
        sum += first_light(start, direction, is_on) * (cone == 0u ? 0.25 : 0.15) * 0.2;
    }
    return sum;
}

float luminance_of(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    Surface s = gbuffer_surface(g);
    bool is_on = g.depth > 0.0;
    ivec2 traced = min(pixel >> int(GI_RESOLUTION), ivec2(gi.trace.xy) - 1);
    vec4 diffuse = texelFetch(trace_0, traced, 0), specular = texelFetch(trace_1, traced, 0);
    vec3 mirrored = gi_has_specular() ? gi_specular_color(s) * specular.rgb : vec3(0.0);
    float factor = gi.strength.x * gbuffer_receives(g);
    vec3 color = vec3(0.0);
    if (DEBUG_VIEW == DEBUG_GI_INDIRECT)
        color = view_radiance((g.albedo * diffuse.rgb + mirrored) * factor * diffuse.a);
    if (DEBUG_VIEW == DEBUG_GI_DIFFUSE) color = view_radiance(diffuse.rgb * factor);
    if (DEBUG_VIEW == DEBUG_GI_SPECULAR) color = view_radiance(mirrored * factor);
    if (DEBUG_VIEW == DEBUG_GI_AO) color = vec3(diffuse.a);
    if (DEBUG_VIEW == DEBUG_GI_STEPS) {
        float steps = steps_of(g, s, is_on);
        color = steps > 0.0 ? heat_map(steps / STEPS_HOT) : vec3(0.0);
    }
    if (DEBUG_VIEW == DEBUG_GI_LEAKS) {
        float by_rays = luminance_of(light_by_rays(gi_start(g), g.normal, is_on));
        float all = luminance_of(diffuse.rgb);
        float leaked = 1.0 - clamp(by_rays / max(all * LEAK_SHARE, 1e-6), 0.0, 1.0);
        float grey = 0.03 + 0.12 * luminance_of(g.albedo) * (0.6 + 0.4 * abs(g.normal.y));
        color = vec3(grey) + vec3(1.0, 0.15, 0.6) * luminance_of(view_radiance(diffuse.rgb)) * leaked;
    }
    out_color = vec4(is_on ? color : vec3(0.0), 1.0);
}
