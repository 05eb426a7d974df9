#version 460
// gi_compose_ms.frag: indirect light into the picture, of several samples a pixel but one of the
// G-buffer's (gi_compose.glsl). The blend is there * alpha + colour.
//
// Where a pixel's samples show other surfaces than its middle, each sample takes the light of the
// pixel about it whose plane it lies in, and the pixel gets their mean. Samples of the sky do not
// count: it is drawn over them later.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"
#include "gi_compose.glsl"

layout(set = 0, binding = BINDING_DEPTH_MS) uniform sampler2DMS depth_ms;

layout(location = 0) out vec4 out_color;

// Vulkan's standard sample locations.
const vec2 SAMPLE_AT[4] = vec2[](vec2(0.375, 0.125), vec2(0.875, 0.375), vec2(0.125, 0.625),
                                 vec2(0.625, 0.875));

float plane_distance(GbufferPixel g, vec3 position) {
    return g.depth > 0.0 ? abs(dot(g.normal, position - g.position)) : 1e9;
}
vec3 sample_position(ivec2 pixel, int at, out bool is_sky) {
    float depth = texelFetch(depth_ms, pixel, at).x;
    is_sky = depth <= 0.0;
    return position_from_depth(vec2(pixel) + SAMPLE_AT[at], depth);
}

// Of what a pixel of the G-buffer shows.
vec4 compose(ivec2 pixel) {
    GbufferPixel g = gbuffer_read(pixel);
    Surface s = gbuffer_surface(g);
    GiPixel light;
    if (GI_RESOLUTION == 0u) {
        light = traced_light(pixel);
    } else {
        ivec2 tap = first_tap(pixel);
        bool alone;
        light = upsample(pixel, g, tap_read(tap), tap_read(tap + ivec2(1, 0)),
                         tap_read(tap + ivec2(0, 1)), tap_read(tap + 1), alone);
        GiPixel own = gi_trace_pixel(g, s, uvec2(pixel), vec2(0.0), alone);
        light.diffuse = alone ? own.diffuse : light.diffuse;
        light.specular = alone ? own.specular : light.specular;
    }
    return g.depth > 0.0 ? composed(g, s, light) : vec4(0.0, 0.0, 0.0, 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    GbufferPixel g = gbuffer_read(pixel);
    float per_depth = length(frame.ray_right.xyz) * frame.viewport.z * 2.0;
    float tolerance = 0.25 * per_depth * frame.camera.w / max(g.depth, 1e-9);
    bool is_edge = false, is_sky;
    for (int i = 0; i < 4; i++) {
        vec3 position = sample_position(pixel, i, is_sky);
        is_edge = is_edge || (!is_sky && plane_distance(g, position) > tolerance);
    }
    ivec2 last = ivec2(frame.viewport.xy) - 1;
    vec4 sum = vec4(0.0);
    float count = 0.0;
    for (int i = 0; i < (is_edge ? 4 : 1); i++) {
        vec3 position = sample_position(pixel, i, is_sky);
        ivec2 found = pixel;
        float nearest = 1e8;
        for (int k = 0; k < (is_edge ? 9 : 0); k++) { // its own first, then all around
            int n = k == 0 ? 4 : k == 4 ? 0 : k;
            ivec2 other = clamp(pixel + ivec2(n % 3, n / 3) - 1, ivec2(0), last);
            float distance = plane_distance(gbuffer_read(other), position);
            found = distance < nearest ? other : found;
            nearest = min(nearest, distance);
        }
        bool counts = !is_edge || (!is_sky && nearest < 1e8);
        vec4 light = compose(found);
        sum += counts ? light : vec4(0.0);
        count += counts ? 1.0 : 0.0;
    }
    out_color = count > 0.0 ? sum / count : vec4(0.0, 0.0, 0.0, 1.0);
}
