// gi_compose.glsl: what indirect light adds to the lit picture, and how much of that its ambient
// occlusion leaves: (direct + strength (diffuse + specular)) ao + emissive = there * alpha + colour.
// For gi_compose.comp, gi_alone.comp, gi_compose_ms.frag and, as a part of shading, gi_block.glsl.
//
// Where fewer pixels are traced than there are, each one takes from the four traced ones about it
// those that lie in its plane and face its way (joint bilateral upsampling, Kopf et al. 2007).
// Where none fits, it is traced by itself; the includer does that.
#ifndef GI_COMPOSE_GLSL
#define GI_COMPOSE_GLSL
#ifndef GI_SCREEN
#define GI_SCREEN
#endif
#include "gbuffer.glsl"
#include "gi.glsl"
#include "gi_place.glsl"
#include "gi_pixel.glsl"

layout(set = 2, binding = BINDING_GI_TRACE_0) uniform sampler2D trace_0;
layout(set = 2, binding = BINDING_GI_TRACE_1) uniform sampler2D trace_1;

const int SIDE = 1 << GI_RESOLUTION; // pixels that a traced one stands for, along a side

// What shines by itself, and is not occluded.
vec3 emission(GbufferPixel g) {
    if (LAYOUT <= GBUFFER_LAYOUT_HALF5) return palette_emissive(g.material).rgb;
    return max(g.accumulated - g.albedo * frame.ambient.rgb, vec3(0.0));
}

// Colour and share of what is there.
vec4 composed(GbufferPixel g, Surface s, GiPixel light) {
    vec3 indirect = g.albedo * light.diffuse.rgb;
    if (gi_has_specular()) indirect += gi_specular_color(s) * light.specular.rgb;
    indirect *= gi.strength.x * gbuffer_receives(g);
    if ((GI_FEATURES & GI_FEATURE_AO) == 0u) return vec4(indirect, 1.0);
    float ao = light.diffuse.a;
    return vec4(indirect * ao + emission(g) * (1.0 - ao), ao);
}

GiPixel traced_light(ivec2 traced) {
    vec4 specular = gi_has_specular() ? texelFetch(trace_1, traced, 0) : vec4(0.0);
    return GiPixel(texelFetch(trace_0, traced, 0), specular);
}

// --- Upsampling ---

struct Tap {
    GiPixel light;
    Place place;
};
Tap tap_read(ivec2 traced) {
    traced = clamp(traced, ivec2(0), ivec2(gi.trace.xy) - 1);
    ivec2 pixel = gi_traced_pixel(traced);
    return Tap(traced_light(traced), place_of(pixel, gbuffer_read(pixel)));
}

// A sum over taps.
struct Blend {
    vec4 diffuse, specular;
    float weight, best;
};
// height: of the pixel's plane over the eye; near: how near the tap is on the screen.
void blend_tap(inout Blend sum, Tap tap, vec3 normal, float height, float tolerance, float near) {
    float fits = place_fits(tap.place, normal, height, tolerance), w = near * fits;
    sum.diffuse += tap.light.diffuse * w;
    if (gi_has_specular())
        sum.specular += vec4(tap.light.specular.rgb, 1.0) * (w * tap.light.specular.a);
    sum.weight += w;
    sum.best = max(sum.best, fits);
}

// The first of the four traced pixels about one.
ivec2 first_tap(ivec2 pixel) { return (pixel + SIDE - (SIDE >> 1)) / SIDE - 1; }

// alone: nothing fits.
GiPixel upsample(ivec2 pixel, GbufferPixel g, Tap t00, Tap t10, Tap t01, Tap t11, out bool alone) {
    Place place = place_of(pixel, g);
    float tolerance = place_tolerance(g);
    float height = dot(place.normal, place.at);
    vec2 within = vec2((pixel + SIDE - (SIDE >> 1)) & (SIDE - 1)) * (1.0 / float(SIDE));
    vec2 high = within + 0.02, low = 1.02 - within;
    Blend sum = Blend(vec4(0.0), vec4(0.0), 0.0, 0.0);
    blend_tap(sum, t00, place.normal, height, tolerance, low.x * low.y);
    blend_tap(sum, t10, place.normal, height, tolerance, high.x * low.y);
    blend_tap(sum, t01, place.normal, height, tolerance, low.x * high.y);
    blend_tap(sum, t11, place.normal, height, tolerance, high.x * high.y);
    alone = g.depth > 0.0 && sum.best < 0.25;
    return GiPixel(sum.diffuse / max(sum.weight, 1e-6),
                   vec4(sum.specular.rgb / max(sum.specular.a, 1e-6), sum.specular.a));
}
#endif
