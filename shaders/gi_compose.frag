#version 460
// gi_compose.frag: adds indirect light to the lit picture, and takes ambient occlusion from it:
// (direct + strength (diffuse + specular)) ao + emissive. The blend is there * alpha + colour.
//
// Where fewer pixels are traced than there are, each one takes from the four traced ones about it
// those that lie in its plane and face its way (joint bilateral upsampling, Kopf et al. 2007).
// Where none fits, it is traced by itself.
#extension GL_GOOGLE_include_directive : require
#include "gi_screen.glsl"

layout(set = 2, binding = BINDING_GI_TRACE_0) uniform sampler2D trace_0;
layout(set = 2, binding = BINDING_GI_TRACE_1) uniform sampler2D trace_1;

layout(location = 0) out vec4 out_color;

// What shines by itself, and is not occluded.
vec3 emission(GbufferPixel g) {
    if (LAYOUT <= GBUFFER_LAYOUT_HALF5) return palette_emissive(g.material).rgb;
    return max(g.accumulated - g.albedo * frame.ambient.rgb, vec3(0.0));
}

// How well the surface at another pixel stands for this one.
float fit(GbufferPixel g, GbufferPixel other, float tolerance) {
    float distance = abs(dot(g.normal, other.position - g.position));
    float facing = dot(g.normal, other.normal);
    return other.depth > 0.0
               ? clamp(2.0 - distance * tolerance, 0.0, 1.0) * clamp(facing * 4.0 - 3.0, 0.0, 1.0)
               : 0.0;
}

GiPixel upsample(ivec2 pixel, GbufferPixel g, Surface s) {
    ivec2 last = ivec2(gi.trace.xy) - 1;
    vec2 at = (vec2(pixel) - float((1 << GI_RESOLUTION) >> 1)) * (1.0 / float(1 << GI_RESOLUTION));
    ivec2 low = ivec2(floor(at));
    vec2 share = at - vec2(low);
    // A plane's distance counts in voxels, or pixels where these are larger.
    float view_depth = dot(g.position - frame.camera.xyz, frame.ray_forward.xyz);
    float footprint = view_depth * length(frame.ray_right.xyz) * frame.viewport.z * 2.0;
    float tolerance = 1.0 / max(0.25 * gi.origin[0].w, 2.0 * footprint);
    vec4 diffuse = vec4(0.0), specular = vec4(0.0);
    float weight = 0.0, best = 0.0;
    for (uint i = 0u; i < 4u; i++) {
        ivec2 corner = ivec2(i & 1u, i >> 1);
        ivec2 traced = clamp(low + corner, ivec2(0), last);
        vec2 near = mix(1.0 - share, share, vec2(corner)) + 0.02;
        float fits = fit(g, gbuffer_read(gi_traced_pixel(traced)), tolerance);
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

// With several samples a pixel, a surface may be seen only beside the pixel's middle: it takes the
// nearest neighbour's light. Samples of the sky are drawn over later.
ivec2 seen_pixel(ivec2 pixel) {
    if (SAMPLES == 1u) return pixel;
    ivec2 last = ivec2(frame.viewport.xy) - 1, found = pixel;
    float nearest = texelFetch(gbuffer_depth, pixel, 0).x;
    bool is_sky = nearest <= 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 other = clamp(pixel + ivec2(i % 3, i / 3) - 1, ivec2(0), last);
        float depth = texelFetch(gbuffer_depth, other, 0).x;
        found = is_sky && depth > nearest ? other : found;
        nearest = is_sky ? max(nearest, depth) : nearest;
    }
    return found;
}

void main() {
    ivec2 pixel = seen_pixel(ivec2(gl_FragCoord.xy));
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
    out_color = g.depth > 0.0 ? vec4(color, ao) : vec4(0.0, 0.0, 0.0, 1.0);
}
