// gi_compose.glsl: adds indirect light to the lit picture, and takes ambient occlusion from it:
// (direct + strength (diffuse + specular)) ao + emissive. The blend is there * alpha + colour.
//
// Where fewer pixels are traced than there are, each one takes from the four traced ones about it
// those that lie in its plane and face its way (joint bilateral upsampling, Kopf et al. 2007).
// Where none fits, it is traced by itself. GI_SAMPLES is defined by gi_compose_ms.frag.
#include "gi_screen.glsl"

layout(set = 2, binding = BINDING_GI_TRACE_0) uniform sampler2D trace_0;
layout(set = 2, binding = BINDING_GI_TRACE_1) uniform sampler2D trace_1;

layout(location = 0) out vec4 out_color;

// What shines by itself, and is not occluded.
vec3 emission(GbufferPixel g) {
    if (LAYOUT <= GBUFFER_LAYOUT_HALF5) return palette_emissive(g.material).rgb;
    return max(g.accumulated - g.albedo * frame.ambient.rgb, vec3(0.0));
}

// What of a pixel tells whether two show the same surface: depth, and how alike two normals are, 1 to
// less than 0. The lean layout's normals need no decoding for that: neighbours on the octahedron are
// neighbours in its map, but for the seams about -z, where they count as strangers.
float alike(GbufferPixel g, vec2 code, ivec2 other) {
    if (LAYOUT == GBUFFER_LAYOUT_LEAN) {
        vec2 apart = texelFetch(gbuffer_1, other, 0).xy - code;
        return 1.0 - 12.0 * dot(apart, apart);
    }
    return dot(g.normal, gbuffer_read(other).normal) * 4.0 - 3.0;
}

// Along a pixel's ray a surface with normal n lies dot(n, ray) * near / depth before the eye: what
// the traced pixels' surfaces have there in common with this one's is how far they are from its
// plane. dot(n, ray) is linear over the screen.
GiPixel upsample(ivec2 pixel, GbufferPixel g, Surface s) {
    ivec2 last = ivec2(gi.trace.xy) - 1;
    vec2 at = (vec2(pixel) - float((1 << GI_RESOLUTION) >> 1)) * (1.0 / float(1 << GI_RESOLUTION));
    ivec2 low = ivec2(floor(at));
    vec2 share = at - vec2(low);
    // A plane's distance counts in voxels, or pixels where these are larger.
    float view_depth = frame.camera.w / max(g.depth, 1e-9);
    float footprint = view_depth * length(frame.ray_right.xyz) * frame.viewport.z * 2.0;
    float tolerance = 1.0 / max(0.25 * gi.origin[0].w, 2.0 * footprint);
    vec2 slope = vec2(dot(g.normal, frame.ray_right.xyz) * frame.viewport.z,
                      -dot(g.normal, frame.ray_up.xyz) * frame.viewport.w) * 2.0;
    float middle = dot(g.normal, pixel_ray(pixel));
    vec2 code = texelFetch(gbuffer_1, pixel, 0).xy;
    vec4 diffuse = vec4(0.0), specular = vec4(0.0);
    float weight = 0.0, best = 0.0;
    for (uint i = 0u; i < 4u; i++) {
        ivec2 corner = ivec2(i & 1u, i >> 1);
        ivec2 traced = clamp(low + corner, ivec2(0), last), other = gi_traced_pixel(traced);
        float depth = texelFetch(gbuffer_depth, other, 0).x;
        float along = middle + dot(slope, vec2(other - pixel));
        float distance = abs(along * frame.camera.w / max(depth, 1e-9) - middle * view_depth);
        float fits = clamp(2.0 - distance * tolerance, 0.0, 1.0) *
                     clamp(alike(g, code, other), 0.0, 1.0);
        fits = depth > 0.0 ? fits : 0.0;
        vec2 near = mix(1.0 - share, share, vec2(corner)) + 0.02;
        float w = near.x * near.y * fits;
        diffuse += texelFetch(trace_0, traced, 0) * w;
        if (gi_has_specular()) {
            vec4 t = texelFetch(trace_1, traced, 0);
            specular += vec4(t.rgb, 1.0) * (w * t.a);
        }
        weight += w;
        best = max(best, fits);
    }
    GiPixel result = GiPixel(diffuse / max(weight, 1e-6),
                             vec4(specular.rgb / max(specular.a, 1e-6), specular.a));
    bool alone = g.depth > 0.0 && best < 0.25;
    GiPixel own = gi_trace_pixel(g, s, uvec2(pixel), alone);
    result.diffuse = alone ? own.diffuse : result.diffuse;
    result.specular = alone ? own.specular : result.specular;
    return result;
}

// Colour and ambient visibility of what a pixel of the G-buffer shows.
vec4 compose(ivec2 pixel) {
    GbufferPixel g = gbuffer_read(pixel);
    Surface s = gbuffer_surface(g);
    GiPixel light;
    if (GI_RESOLUTION == 0u)
        light = GiPixel(texelFetch(trace_0, pixel, 0), texelFetch(trace_1, pixel, 0));
    else
        light = upsample(pixel, g, s);
    vec3 indirect = g.albedo * light.diffuse.rgb;
    if (gi_has_specular()) indirect += gi_specular_color(s) * light.specular.rgb;
    indirect *= gi.strength.x * gbuffer_receives(g);
    float ao = light.diffuse.a;
    vec3 color = indirect * ao + emission(g) * (1.0 - ao);
    return g.depth > 0.0 ? vec4(color, ao) : vec4(0.0, 0.0, 0.0, 1.0);
}

#ifdef GI_SAMPLES
// --- Several samples a pixel, but one of the G-buffer's ---
//
// Where a pixel's samples show other surfaces than its middle, each sample takes the light of the
// pixel about it whose plane it lies in, and the pixel gets their mean. Samples of the sky do not
// count: it is drawn over them later.

layout(set = 0, binding = BINDING_DEPTH_MS) uniform sampler2DMS depth_ms;

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

vec4 compose_samples(ivec2 pixel) {
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
    return count > 0.0 ? sum / count : vec4(0.0, 0.0, 0.0, 1.0);
}
#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef GI_SAMPLES
    out_color = compose_samples(pixel);
#else
    out_color = compose(pixel);
#endif
}
